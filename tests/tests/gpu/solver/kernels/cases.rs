//! Test cases of the kernel comparison: small bodies in all states that kernels distinguish.

use super::DT;
use incise_mesh::geometry::round_to_f32;
use incise_mesh::{Surface, VertexId};
use incise_models::double_cone;
use incise_pbd_gpu::{MAX_COLORS, Material, PatchParams, Solver, SolverParams, Stiffness};
use incise_test_support::params::set_ground;
use incise_test_support::random::Random;
use incise_test_support::surfaces::sphere;

/// A stiffness that moves nothing.
const LIMP: Stiffness = Stiffness::Pbd(0.0);

pub(crate) type Body = (Surface, Solver);

/// Material and parameters of a comparison; bodies get random displacements and velocities.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case {
    pub(crate) stretch: Stiffness,
    pub(crate) bending: Option<Stiffness>,
    pub(crate) iterations: u32,
    pub(crate) substeps: u32,
    pub(crate) ground: Option<f32>,
    pub(crate) gravity: f32,
    /// Interval of pinned vertices; 0 pins none.
    pub(crate) pinned: usize,
    /// Maximum random speed [m/s].
    pub(crate) speed: f32,
    /// Scale of bodies before the random displacement; small ones expand.
    pub(crate) size: f32,
    /// Maximum number of vertices of a patch; 0 for no patches and one layer of colors.
    pub(crate) patch: u32,
}

/// Prediction and integration only.
pub(crate) const DRIFT: Case = Case {
    stretch: LIMP,
    bending: None,
    iterations: 1,
    substeps: 1,
    ground: None,
    gravity: 0.0,
    pinned: 0,
    speed: 2.0,
    size: 1.0,
    patch: 0,
};

pub(crate) const CASES: [(&str, Case); 12] = [
    (
        "predict_and_integrate",
        Case {
            gravity: -9.81,
            substeps: 3,
            ..DRIFT
        },
    ),
    (
        "pins",
        Case {
            pinned: 3,
            substeps: 3,
            ..DRIFT
        },
    ),
    (
        // Pins move attached vertices beyond their length.
        "attachments",
        Case {
            stretch: Stiffness::Pbd(1.0),
            pinned: 17,
            substeps: 3,
            ..DRIFT
        },
    ),
    (
        "ground",
        Case {
            ground: Some(1.0),
            ..DRIFT
        },
    ),
    (
        "stretch",
        Case {
            stretch: Stiffness::Pbd(0.9),
            ..DRIFT
        },
    ),
    (
        "compliant_stretch",
        Case {
            stretch: Stiffness::Compliance(1e-5),
            ..DRIFT
        },
    ),
    (
        "stretch_multipliers",
        Case {
            stretch: Stiffness::Compliance(1e-5),
            iterations: 4,
            substeps: 2,
            ..DRIFT
        },
    ),
    (
        "bending",
        Case {
            bending: Some(Stiffness::Pbd(0.6)),
            ..DRIFT
        },
    ),
    (
        "bending_multipliers",
        Case {
            bending: Some(Stiffness::Compliance(1e-4)),
            iterations: 4,
            substeps: 2,
            ..DRIFT
        },
    ),
    (
        // Bodies unfold into a plane that only some of them are predicted to reach.
        "ground_between_iterations",
        Case {
            stretch: Stiffness::Pbd(1.0),
            iterations: 5,
            substeps: 3,
            ground: Some(0.0),
            gravity: -9.81,
            size: 0.5,
            ..DRIFT
        },
    ),
    (
        "whole_plan",
        Case {
            stretch: Stiffness::Pbd(0.9),
            bending: Some(Stiffness::Compliance(1e-4)),
            iterations: 3,
            substeps: 2,
            ground: Some(0.3),
            gravity: -9.81,
            pinned: 17,
            ..DRIFT
        },
    ),
    (
        "layers_of_patches",
        Case {
            stretch: Stiffness::Compliance(1e-5),
            bending: Some(Stiffness::Compliance(1e-4)),
            iterations: 3,
            substeps: 2,
            patch: 40,
            ..DRIFT
        },
    ),
];

/// Random displacement that crumples bodies of 2 m \[m\].
pub(crate) const CRUMPLED: f32 = 0.8;

/// Random displacement with well-conditioned angles and lengths \[m\].
pub(crate) const WELL_CONDITIONED: f32 = 0.01;

/// Returns a vector of random components up to `scale` in size.
fn vector(random: &mut Random, scale: f32) -> [f32; 3] {
    [0; 3].map(|_| scale * round_to_f32(random.signed()))
}

fn open(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> Surface {
    Surface::from_triangles(positions, faces).expect("a surface")
}

/// Returns a sphere with free slots.
fn with_free_slots() -> Surface {
    let mut surface = sphere(2, [0.0, 1.2, 0.0]);
    let center = VertexId(7);
    let fan = surface.topology().outgoing_fan(center);
    let fan: Vec<_> = fan.map(|h| h.triangle()).collect();
    let orphans = surface.remove_triangles(&fan);
    assert!(orphans.contains(&center), "its last triangle is gone");
    surface.remove_vertices(&orphans);
    surface
}

/// Returns bodies with one constraint of a kind, of minimum size, with more constraints at a vertex
/// than colors, and with sizes around multiples of a workgroup.
fn surfaces() -> Vec<Surface> {
    let corners = [
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 1.0, 1.0],
    ];
    vec![
        open(&corners[..3], &[[0, 1, 2]]),
        open(&corners, &[[0, 1, 2], [1, 0, 3]]),
        open(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
        double_cone(100),
        with_free_slots(),
        sphere(3, [0.0, 1.1, 0.0]),
        sphere(4, [0.0, 9.0, 0.0]),
    ]
}

fn new_solver(case: &Case, surface: &mut Surface, material: &Material) -> Solver {
    let patches = PatchParams {
        vertices: case.patch,
        room: case.patch / 8,
    };
    let patches = (case.patch > 0).then_some(&patches);
    Solver::with_patches(surface, material, patches).expect("a valid surface")
}

/// The bodies of a case. Every second one has other friction and damping.
pub(crate) fn bodies(case: &Case, shaken: f32) -> Vec<Body> {
    let mut random = Random::new(5);
    let mut out = Vec::new();
    for (i, mut surface) in surfaces().into_iter().enumerate() {
        let material = Material {
            stretch: case.stretch,
            bending: case.bending,
            damping: if i % 2 == 0 { 0.0 } else { 0.3 },
            friction: if i % 2 == 0 { 0.5 } else { 0.1 },
            ..Material::default()
        };
        let mut solver = new_solver(case, &mut surface, &material);
        if let Some(height) = case.ground {
            set_ground(&mut solver, height);
        }
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for (k, &v) in vertices.iter().enumerate() {
            let by = vector(&mut random, shaken);
            for (c, by) in surface.positions_mut()[v.index()].iter_mut().zip(by) {
                *c = case.size * *c + by;
            }
            let speed = vector(&mut random, case.speed);
            solver.set_velocity(v, speed).expect("a vertex");
            if case.pinned > 0 && k % case.pinned == 1 {
                solver.pin(&mut surface, v).expect("a vertex");
            }
        }
        out.push((surface, solver));
    }
    let stretch = |body: &Body| body.1.stretch().overflow().len();
    let bending = |body: &Body| body.1.bending().map_or(1, |set| set.overflow().len());
    let overflows = |body: &Body| stretch(body) > 0 && bending(body) > 0;
    let layers = |body: &Body| body.1.stretch().batches().len() > MAX_COLORS;
    let met = out.iter().any(|body| match case.patch {
        0 => overflows(body),
        _ => layers(body),
    });
    assert!(met, "constraints without a color, or in several layers");
    out
}

pub(crate) fn params(case: &Case) -> SolverParams {
    SolverParams {
        iterations: case.iterations,
        gravity: [0.0, case.gravity, 0.0],
        diagonal_scale: if case.substeps > 1 { 0.5 } else { 1.0 },
        attachments: true,
        ..SolverParams::paper()
    }
    .with_substeps(DT, case.substeps)
}

/// Pins go somewhere else in every frame.
pub(crate) fn aim(bodies: &mut [Body], frame: u32) {
    let mut random = Random::new(frame.into());
    for (surface, solver) in bodies {
        let pinned: Vec<VertexId> = solver.pins().iter().map(|pin| pin.vertex).collect();
        for v in pinned {
            let [x, y, z, _] = surface.positions()[v.index()];
            let [dx, dy, dz] = vector(&mut random, 0.05);
            let target = [x + dx, y + dy, z + dz];
            solver.set_pin_target(v, target).expect("it is pinned");
        }
    }
}

/// Returns bodies that expand on the ground at height 0.
pub(crate) const UNFOLDING: Case = Case {
    stretch: Stiffness::Pbd(1.0),
    iterations: 3,
    ground: Some(0.0),
    speed: 0.0,
    size: 0.5,
    ..DRIFT
};

/// Bodies that stand on the ground; the height of their lowest vertices is given apart for its
/// sign.
pub(crate) fn standing(case: &Case, height: f32) -> Vec<Body> {
    let mut bodies = bodies(case, WELL_CONDITIONED);
    for (surface, _) in &mut bodies {
        let lowest = surface.bounds().min[1];
        for p in surface.positions_mut() {
            p[1] = if p[1] > lowest { p[1] - lowest } else { height };
        }
    }
    bodies
}
