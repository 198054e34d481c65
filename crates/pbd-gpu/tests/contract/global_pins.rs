//! Bodies that swing about their pins with the global step.

use incise_mesh::{Vec3, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Material, Scheme, Solver, SolverParams, Stiffness};
use incise_test_support::surfaces::{scaled, sphere};

const DT: f32 = 1.0 / 60.0;

/// Regression: the matrix resisted rotations about pins, so that a stiff bar kept 0.05 of the
/// energy of its fall.
#[test]
fn a_stiff_bar_swings_about_its_pins() {
    for pins in [1, 2] {
        let mut surface = scaled(sphere(3, [0.0; 3]), [0.5, 0.1, 0.1]);
        let material = Material {
            stretch: Stiffness::Compliance(1e-5),
            bending: Some(Stiffness::Compliance(1e-2)),
            damping: 0.0,
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        // The left end, or the two vertices there that are farthest apart across.
        let mut ends: Vec<VertexId> = surface.topology().vertices().collect();
        let place = |v: &VertexId| surface.position(*v);
        ends.retain(|v| place(v).x < -0.4);
        if pins == 1 {
            ends.sort_by(|a, b| place(a).x.total_cmp(&place(b).x));
            ends.truncate(1);
        } else {
            ends.sort_by(|a, b| place(a).z.total_cmp(&place(b).z));
            ends = vec![ends[0], ends[ends.len() - 1]];
        }
        for v in ends {
            solver.pin(&mut surface, v).unwrap();
        }
        let params = SolverParams {
            iterations: 4,
            gravity: [0.0, -9.81, 0.0],
            scheme: Scheme::Global,
            ..SolverParams::paper()
        }
        .with_substeps(DT, 2);
        let mass: f64 = solver.masses().iter().map(|&m| f64::from(m)).sum();
        let mut most = (0.0_f64, 0.0);
        for _ in 0..45 {
            solver.step(&mut surface, DT, &params).unwrap();
            let places = surface.topology().vertices().zip(solver.masses());
            let moment: Vec3 = places
                .map(|(v, &m)| surface.position(v) * f64::from(m))
                .sum();
            let fall = -9.81 * moment.y;
            let kinetic = solver.kinetic_energy();
            if kinetic > most.0 {
                most = (kinetic, fall);
            }
            assert!(
                kinetic < 1.05 * fall + 1e-3,
                "{pins} pins: {kinetic} J of {fall} J"
            );
        }
        let (kinetic, fall) = most;
        assert!(
            fall > 9.81 * mass * 0.3,
            "{pins} pins: it falls by {fall} J"
        );
        assert!(kinetic > 0.7 * fall, "{pins} pins: {kinetic} J of {fall} J");
    }
}

/// Regression: a body that settles gained rotation about its pin in every substep, 1.2 -> 27 J.
#[test]
fn a_settling_body_does_not_spin_up_about_its_pin() {
    let mut surface = build_model(Model::Bunny);
    let material = Material {
        stretch: Stiffness::Compliance(1e-5),
        bending: Some(Stiffness::Compliance(1e-3)),
        damping: 0.0,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let height = |v: &VertexId| surface.position(*v).y;
    let top = surface.topology().vertices();
    let top = top.max_by(|a, b| height(a).total_cmp(&height(b))).unwrap();
    solver.pin(&mut surface, top).unwrap();
    let mut before = 0.0;
    for frame in 0..100 {
        let is_pulled = frame < 5;
        let params = SolverParams {
            iterations: 4,
            gravity: [if is_pulled { 60.0 } else { 0.0 }, 0.0, 0.0],
            scheme: if frame < 8 {
                Scheme::Sweeps
            } else {
                Scheme::Global
            },
            ..SolverParams::paper()
        }
        .with_substeps(DT, 2);
        solver.step(&mut surface, DT, &params).unwrap();
        let kinetic = solver.kinetic_energy();
        if frame < 8 {
            before = kinetic;
        }
        assert!(
            kinetic <= 1.1 * before,
            "{kinetic} J of {before} J in {frame}"
        );
    }
}
