//! A pair of equal bodies, one on the CPU and one on a GPU, compared bit for bit.

use crate::params::set_ground;
use incise_mesh::Surface;
use incise_pbd_gpu::{
    GpuBackend, GpuBody, InteriorSprings, Material, PatchParams, Schedule, Solver, SolverParams,
    Stiffness, Volume,
};

/// Duration of a frame \[s\].
pub const DT: f32 = 1.0 / 60.0;

/// The GPU schedules of undivided and of divided bodies.
pub const SCHEDULES: [Schedule; 2] = [Schedule::WholeBody, Schedule::Patches];

/// Returns settings that use most solver features: compliance, bending, pressure and damping.
#[must_use]
pub fn with_most_features() -> (Material, SolverParams) {
    let material = Material {
        stretch: Stiffness::Compliance(1e-6),
        bending: Some(Stiffness::Compliance(1e-3)),
        volume: Some(Volume {
            compressibility: 1e-5,
            pressure: 1.1,
        }),
        interior_springs: Some(InteriorSprings::default()),
        damping: 0.1,
        ..Material::default()
    };
    let params = SolverParams {
        iterations: 2,
        substep: Some(1.0 / 180.0),
        lift: 0.48,
        ..SolverParams::paper()
    };
    (material, params)
}

/// Returns settings of an inextensible body with volume and long range attachments.
#[must_use]
pub fn with_attachments() -> (Material, SolverParams) {
    let (material, params) = with_most_features();
    let material = Material {
        stretch: Stiffness::Compliance(0.0),
        bending: Some(Stiffness::Pbd(0.3)),
        volume: Some(Volume::default()),
        ..material
    };
    let params = SolverParams {
        attachments: true,
        ..params
    };
    (material, params)
}

/// Creates a solver that supports a schedule, with small patches, random interior springs and a
/// horizontal plane at -1.1 m.
///
/// # Panics
/// If the surface is invalid.
#[must_use]
pub fn solver_for(surface: &mut Surface, material: &Material, schedule: Schedule) -> Solver {
    let patches = (schedule == Schedule::Patches).then_some(PatchParams {
        vertices: 24,
        room: 4,
    });
    let mut solver =
        Solver::with_patches(surface, material, patches.as_ref()).expect("a valid body");
    if material.interior_springs.is_some() {
        // Random pairs, about 3 per vertex, some of them adjacent.
        let all: Vec<_> = surface.topology().vertices().collect();
        let ends = (0..all.len()).map(|i| [all[i], all[(i * i + 7) % all.len()]]);
        let ends: Vec<_> = ends.step_by(2).collect();
        (solver.add_interior_springs(surface, &ends)).expect("vertices of the body");
    }
    set_ground(&mut solver, -1.1);
    solver
}

/// A pair of equal bodies.
#[derive(Debug)]
pub struct CpuGpuPair {
    /// Surface of the CPU body.
    pub on_cpu: Surface,
    /// Solver of the CPU body.
    pub cpu: Solver,
    /// CPU copy of the GPU body's surface.
    pub on_gpu: Surface,
    /// CPU copy of the GPU body's solver.
    pub solver: Solver,
    /// GPU body.
    pub body: GpuBody,
}

impl CpuGpuPair {
    /// Adds a body to the GPU backend and keeps a copy on the CPU.
    ///
    /// # Panics
    /// If the body does not fit or does not support the schedule.
    pub fn add(
        gpu: &mut GpuBackend,
        mut surface: Surface,
        material: &Material,
        schedule: Schedule,
    ) -> Self {
        let solver = solver_for(&mut surface, material, schedule);
        gpu.force_schedule(Some(schedule));
        let pair = Self::from_solver(gpu, surface, solver);
        assert_eq!(gpu.schedule(pair.body), Ok(schedule), "it can have it");
        pair
    }

    /// Adds a body and its solver to the GPU backend and keeps a copy on the CPU.
    ///
    /// # Panics
    /// If the body does not fit.
    pub fn from_solver(gpu: &mut GpuBackend, surface: Surface, mut solver: Solver) -> Self {
        let body = gpu.add(&surface, &mut solver).expect("room");
        Self {
            on_cpu: surface.clone(),
            cpu: solver.clone(),
            on_gpu: surface,
            solver,
            body,
        }
    }

    /// Applies an edit to both bodies. The CPU copy of the GPU body must be up to date.
    ///
    /// # Panics
    /// If the results differ.
    pub fn edit<T: PartialEq>(&mut self, edit: impl Fn(&mut Surface, &mut Solver) -> T) -> T {
        let there = edit(&mut self.on_cpu, &mut self.cpu);
        let here = edit(&mut self.on_gpu, &mut self.solver);
        assert!(here == there, "the same edit of the same body");
        here
    }

    /// Uploads edits to the GPU.
    ///
    /// # Panics
    /// If the upload fails.
    pub fn update(&mut self, gpu: &mut GpuBackend) {
        gpu.update(self.body, &self.on_gpu, &mut self.solver)
            .expect("room");
    }

    /// Steps both bodies by one frame.
    ///
    /// # Panics
    /// If a step fails.
    pub fn step(&mut self, gpu: &mut GpuBackend, params: &SolverParams) {
        self.cpu
            .step(&mut self.on_cpu, DT, params)
            .expect("a step on the CPU");
        gpu.step([(self.body, &mut self.solver)], DT, params)
            .expect("a step on the GPU");
    }

    /// Reads the state of the GPU body back.
    ///
    /// # Panics
    /// If the readback fails.
    pub fn read(&mut self, gpu: &mut GpuBackend) {
        gpu.read(self.body, &mut self.on_gpu, &mut self.solver)
            .expect("a state");
    }

    /// Reads the GPU body back and compares it with the CPU body, bit for bit.
    ///
    /// # Panics
    /// If they differ.
    pub fn assert_equal(&mut self, gpu: &mut GpuBackend, when: &str) {
        self.read(gpu);
        assert_same(
            (&self.on_gpu, &self.solver),
            (&self.on_cpu, &self.cpu),
            when,
        );
    }
}

/// Compares positions, inverse masses and velocities, also of the nodes of solids, bit for bit.
///
/// # Panics
/// If they differ.
pub fn assert_same(a: (&Surface, &Solver), b: (&Surface, &Solver), when: &str) {
    let bits = |vectors: &[[f32; 4]]| -> Vec<[u32; 4]> {
        vectors.iter().map(|v| v.map(f32::to_bits)).collect()
    };
    let parts = [
        ("nodes", a.1.nodes(), b.1.nodes()),
        ("positions", a.0.positions(), b.0.positions()),
        ("velocities", a.1.velocities(), b.1.velocities()),
    ];
    for (what, here, there) in parts {
        let (here, there) = (bits(here), bits(there));
        assert_eq!(here.len(), there.len(), "{what} {when}");
        let first = here.iter().zip(&there).position(|(a, b)| a != b);
        assert_eq!(first, None, "the first vertex whose {what} differ {when}");
    }
}
