//! A body on a device and the same one on the CPU.
#![allow(dead_code, reason = "every test file uses a part of it")]

use incise_mesh::Surface;
use incise_pbd_gpu::{
    GpuBackend, GpuBody, Material, PatchParams, Schedule, Solver, SolverParams, Stiffness, Struts,
    Volume,
};

/// The length of a frame \[s\].
pub(crate) const DT: f32 = 1.0 / 60.0;

/// All schedules.
pub(crate) const SCHEDULES: [Schedule; 3] =
    [Schedule::WholeBody, Schedule::Colors, Schedule::Patches];

/// Everything that a solver does, at once: compliance with multipliers, bending, pressure, damping, friction.
pub(crate) fn busy() -> (Material, SolverParams) {
    let material = Material {
        stretch: Stiffness::Compliance(1e-6),
        bending: Some(Stiffness::Compliance(1e-3)),
        volume: Some(Volume {
            compressibility: 1e-5,
            pressure: 1.1,
        }),
        struts: Some(Struts::default()),
        damping: 0.1,
        ..Material::default()
    };
    let params = SolverParams {
        iterations: 2,
        substeps: 3,
        ground: Some(-1.1),
        ..SolverParams::paper()
    };
    (material, params)
}

/// A body that does not stretch and keeps its volume, held to within reach of its pins, and that leaves old errors in short frames.
pub(crate) fn tethered() -> (Material, SolverParams) {
    let (material, params) = busy();
    let material = Material {
        stretch: Stiffness::Compliance(0.0),
        bending: Some(Stiffness::Pbd(0.3)),
        volume: Some(Volume::default()),
        ..material
    };
    let params = SolverParams {
        tethers: true,
        ..params
    };
    (material, params)
}

/// A solver that can have the schedule; patches are small, so that there are many.
pub(crate) fn solver_for(surface: &mut Surface, material: &Material, schedule: Schedule) -> Solver {
    let solver = if schedule == Schedule::Patches {
        let patches = PatchParams {
            vertices: 24,
            room: 4,
        };
        Solver::with_patches(surface, material, &patches)
    } else {
        Solver::new(surface, material)
    };
    let mut solver = solver.expect("the body is sound");
    if material.struts.is_some() {
        // Anywhere: some 3 at a vertex, and short ones among them.
        let all: Vec<_> = surface.topology().vertices().collect();
        let ends = (0..all.len()).map(|i| [all[i], all[(i * i + 7) % all.len()]]);
        let ends: Vec<_> = ends.step_by(2).collect();
        (solver.add_struts(surface, &ends)).expect("vertices of the body");
    }
    solver
}

/// A pair of equal bodies.
#[derive(Debug)]
pub(crate) struct Twin {
    pub(crate) on_cpu: Surface,
    pub(crate) cpu: Solver,
    pub(crate) on_gpu: Surface,
    pub(crate) solver: Solver,
    pub(crate) body: GpuBody,
}

impl Twin {
    /// Puts a body on the device; the CPU's is a copy.
    pub(crate) fn add(
        gpu: &mut GpuBackend,
        mut surface: Surface,
        material: &Material,
        schedule: Schedule,
    ) -> Self {
        let mut solver = solver_for(&mut surface, material, schedule);
        gpu.force_schedule(Some(schedule));
        let body = gpu.add(&surface, &mut solver).expect("room");
        assert_eq!(gpu.schedule(body), Ok(schedule), "it can have it");
        Self {
            on_cpu: surface.clone(),
            cpu: solver.clone(),
            on_gpu: surface,
            solver,
            body,
        }
    }

    /// Does the same to both of them; the host's copy of the device's has to be up to date.
    pub(crate) fn edit<T: PartialEq>(
        &mut self,
        edit: impl Fn(&mut Surface, &mut Solver) -> T,
    ) -> T {
        let there = edit(&mut self.on_cpu, &mut self.cpu);
        let here = edit(&mut self.on_gpu, &mut self.solver);
        assert!(here == there, "the same edit of the same body");
        here
    }

    /// Tells the device of edits.
    pub(crate) fn update(&mut self, gpu: &mut GpuBackend) {
        gpu.update(self.body, &self.on_gpu, &mut self.solver)
            .expect("room");
    }

    /// Steps both by a frame.
    pub(crate) fn step(&mut self, gpu: &mut GpuBackend, params: &SolverParams) {
        self.cpu
            .step(&mut self.on_cpu, DT, params)
            .expect("a step on the CPU");
        gpu.step([(self.body, &mut self.solver)], DT, params)
            .expect("a step on the device");
    }

    /// Brings the device's state to the host.
    pub(crate) fn read(&mut self, gpu: &mut GpuBackend) {
        gpu.read(self.body, &mut self.on_gpu, &mut self.solver)
            .expect("a state");
    }

    /// Reads the device's state and compares it with the CPU's, to the bit.
    pub(crate) fn assert_equal(&mut self, gpu: &mut GpuBackend, when: &str) {
        self.read(gpu);
        assert_same(
            (&self.on_gpu, &self.solver),
            (&self.on_cpu, &self.cpu),
            when,
        );
    }
}

/// Compares positions, inverse masses and velocities, to the bit.
pub(crate) fn assert_same(a: (&Surface, &Solver), b: (&Surface, &Solver), when: &str) {
    let bits = |vectors: &[[f32; 4]]| -> Vec<[u32; 4]> {
        vectors.iter().map(|v| v.map(f32::to_bits)).collect()
    };
    let parts = [
        ("positions", &a.0.positions[..], &b.0.positions[..]),
        ("velocities", a.1.velocities(), b.1.velocities()),
    ];
    for (what, here, there) in parts {
        let (here, there) = (bits(here), bits(there));
        assert_eq!(here.len(), there.len(), "{what} {when}");
        let first = here.iter().zip(&there).position(|(a, b)| a != b);
        assert_eq!(first, None, "the first vertex whose {what} differ {when}");
    }
}

/// Numbers that look random: a linear congruence's upper bits.
#[derive(Debug)]
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 0 to `n` - 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).expect("31 bits") % n
    }

    /// From 0.1 to 0.9.
    pub(crate) fn part(&mut self) -> f32 {
        0.1 + 0.8 * self.below(1000) as f32 / 1000.0
    }
}
