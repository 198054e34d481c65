// A step of Jolt Physics: edges and dihedral angles of a soft body, 10 iterations, free fall.
//
// jolt_bench MESH.obj THREADS
#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemThreadPool.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/SoftBody/SoftBodyCreationSettings.h>
#include <Jolt/Physics/SoftBody/SoftBodySharedSettings.h>
#include <Jolt/RegisterTypes.h>

#include "surface.h"

using namespace JPH;

struct OneLayer final : BroadPhaseLayerInterface {
    uint GetNumBroadPhaseLayers() const override { return 1; }
    BroadPhaseLayer GetBroadPhaseLayer(ObjectLayer) const override { return BroadPhaseLayer(0); }
    const char *GetBroadPhaseLayerName(BroadPhaseLayer) const { return "all"; }
};

int main(int count, char **words) {
    if (count != 3) return 2;
    Surface surface = read_surface(words[1]);
    int threads = std::atoi(words[2]);
    RegisterDefaultAllocator();
    Factory::sInstance = new Factory();
    RegisterTypes();
    TempAllocatorImpl memory(64 << 20);
    // The calling thread works, too.
    JobSystemThreadPool jobs(cMaxPhysicsJobs, cMaxPhysicsBarriers, threads - 1);
    OneLayer layers;
    ObjectVsBroadPhaseLayerFilter against_layers;
    ObjectLayerPairFilter pairs;
    PhysicsSystem physics;
    physics.Init(16, 0, 16, 16, layers, against_layers, pairs);

    Ref<SoftBodySharedSettings> settings = new SoftBodySharedSettings;
    for (size_t i = 0; i < surface.positions.size(); i += 3) {
        const float *p = &surface.positions[i];
        settings->mVertices.push_back(SoftBodySharedSettings::Vertex(Float3(p[0], p[1], p[2])));
    }
    for (size_t i = 0; i < surface.triangles.size(); i += 3) {
        const int *t = &surface.triangles[i];
        settings->AddFace(SoftBodySharedSettings::Face(t[0], t[1], t[2]));
    }
    SoftBodySharedSettings::VertexAttributes compliance(1e-6f, 1e-6f, 1e-6f);
    // With an angle tolerance of 0 no edge is taken for the diagonal of a quad.
    auto bend = SoftBodySharedSettings::EBendType::Dihedral;
    settings->CreateConstraints(&compliance, 1, bend, 0.0f);
    settings->Optimize();
    SoftBodyCreationSettings body(settings, RVec3::sZero(), Quat::sIdentity(), 0);
    body.mNumIterations = 10;
    body.mAllowSleeping = false;
    physics.GetBodyInterface().CreateAndAddSoftBody(body, EActivation::Activate);

    double ms = fastest([&] { physics.Update(1.0f / 60, 1, &memory, &jobs); });
    printf("Jolt %d.%d.%d, %zu edges, %zu hinges, %d threads: %.3f ms\n", JPH_VERSION_MAJOR,
           JPH_VERSION_MINOR, JPH_VERSION_PATCH, settings->mEdgeConstraints.size(),
           settings->mDihedralBendConstraints.size(), threads, ms);
}
