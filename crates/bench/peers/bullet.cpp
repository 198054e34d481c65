// A step of Bullet: edges and bending links of a soft body, 10 iterations, free fall.
//
// bullet_bench MESH.obj
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "surface.h"

int main(int count, char **words) {
    if (count != 2) return 2;
    Surface surface = read_surface(words[1]);
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broad_phase;
    btSequentialImpulseConstraintSolver solver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broad_phase, &solver, &configuration);
    btSoftBodyWorldInfo &info = world.getWorldInfo();
    info.m_broadphase = &broad_phase;
    info.m_dispatcher = &dispatcher;
    info.m_gravity = btVector3(0, -9.81f, 0);
    info.m_sparsesdf.Initialize();

    std::vector<btScalar> positions(surface.positions.begin(), surface.positions.end());
    int triangles = int(surface.triangles.size() / 3);
    btSoftBody *body = btSoftBodyHelpers::CreateFromTriMesh(
        info, positions.data(), surface.triangles.data(), triangles, false);
    int edges = body->m_links.size();
    // Links of vertices that are two edges apart; Bullet has no dihedral angles.
    body->generateBendingConstraints(2);
    int bending = body->m_links.size() - edges;
    body->m_cfg.piterations = 10;
    body->m_cfg.collisions = 0;
    body->setTotalMass(1, false);
    body->randomizeConstraints();
    body->setActivationState(DISABLE_DEACTIVATION);
    world.addSoftBody(body);

    double ms = fastest([&] { world.stepSimulation(1.0f / 60, 0); });
    printf("Bullet %d.%02d, %d edges, %d bending links, 1 thread: %.3f ms\n", btGetVersion() / 100,
           btGetVersion() % 100, edges, bending, ms);
    // Without destructors, which need an order of their own.
    fflush(stdout);
    std::_Exit(0);
}
