//! Cuts of moving bodies: in every substep, repeatedly along one plane, through pins, and undone.
//!
//! Topology, constraints and BVH stay valid; mass, momentum and volume are preserved.

mod body;

use body::{Body, ROUNDING, direction, paper_shell, pieces, place, plane, shell, through};
use incise_cut::CutParams;
use incise_mesh::{Vec3, VertexId, cube_sphere, icosphere, torus};
use incise_pbd_gpu::{Density, Material, SolverParams, Stiffness};
use incise_refine::{RefineParams, RefinementLevel};
use incise_test_support::params::{TEN_ITERATIONS, set_ground};
use incise_test_support::random::Random;

const FRAME: f32 = 1.0 / 60.0;

#[test]
fn cuts_in_every_substep_down_to_pieces_of_a_few_triangles() {
    let elastic = shell(Stiffness::Compliance(1e-5), Stiffness::Compliance(1e-2));
    let mut body = Body::turning(1, 0.8, &elastic);
    set_ground(&mut body.solver, 0.0);
    let mut random = Random::new(12);
    let params = SolverParams {
        iterations: 1,
        ..TEN_ITERATIONS
    };
    for number in 0..200 {
        body.step(FRAME / 20.0, &params);
        let all = pieces(&body.surface);
        // The larger of two random pieces.
        let two = [0, 1].map(|_| all[random.below(all.len())]);
        let size = |p: &u32| body.surface.piece_triangles(*p);
        let piece = two.into_iter().max_by_key(size).expect("two");
        let sweep = through(&mut random, &body.surface, piece);
        let params = CutParams {
            only_piece: Some(piece),
            ..CutParams::default()
        };
        body.cut(&sweep, &params, &format!("cut {number}"));
    }
}

#[test]
fn one_plane_cuts_a_moving_body_repeatedly() {
    let mut body = Body::turning(1, 0.8, &paper_shell());
    let weightless = SolverParams {
        gravity: [0.0; 3],
        ..TEN_ITERATIONS
    };
    for number in 0..50 {
        let middle = body.surface.bounds().center();
        let sweep = plane(&body.surface, Vec3::new(0.3, 0.2, 1.0), &middle);
        body.cut(&sweep, &CutParams::default(), &format!("cut {number}"));
        // Without contacts all pieces cross the plane again, so their number doubles.
        if body.surface.topology().triangle_count() > 50_000 {
            return;
        }
        body.step(FRAME, &weightless);
    }
}

#[test]
fn pieces_of_a_stretched_body_regain_their_lengths() {
    let mut random = Random::new(4);
    for (stretch, bending) in [(0.0, 0.0), (1e-4, 1e-1)] {
        let material = shell(
            Stiffness::Compliance(stretch),
            Stiffness::Compliance(bending),
        );
        let mut surface = icosphere(2, 0.5);
        place(&mut surface, |p| p + Vec3::new(0.0, 0.8, 0.0));
        surface.positions_mut().iter_mut().for_each(|p| p[0] *= 4.0);
        let mut body = Body::new(surface, &material);
        set_ground(&mut body.solver, 0.0);
        for number in 0..5 {
            let all = pieces(&body.surface);
            let piece = all[random.below(all.len())];
            let sweep = through(&mut random, &body.surface, piece);
            body.cut(&sweep, &CutParams::default(), &format!("cut {number}"));
        }
        (0..600).for_each(|_| body.step(FRAME, &TEN_ITERATIONS));
        let strain = body.solver.stretch_error(&body.surface);
        assert!(strain <= 0.05, "mean strain {strain} of {stretch} m/N");
    }
}

#[test]
fn cuts_through_pins_leave_the_others_in_place() {
    let mut body = Body::turning(2, 0.8, &paper_shell());
    set_ground(&mut body.solver, 0.0);
    let vertices = body.surface.topology().vertices();
    let top = vertices.filter(|&v| body.surface.position(v).y > 1.0);
    let top: Vec<VertexId> = top.collect();
    for &v in &top {
        body.solver.pin(&mut body.surface, v).expect("a vertex");
    }
    let places = body.surface.positions().to_vec();
    let mut random = Random::new(9);
    for number in 0..20 {
        let [x, y, z, _] = places[top[random.below(top.len())].index()].map(f64::from);
        let sweep = plane(&body.surface, direction(&mut random), &Vec3::new(x, y, z));
        body.cut(&sweep, &CutParams::default(), &format!("cut {number}"));
        body.step(FRAME, &TEN_ITERATIONS);
        for pin in body.solver.pins() {
            let i = pin.vertex.index();
            let (now, then) = (body.surface.positions()[i], places[i]);
            assert_eq!(now[..3], then[..3], "{} after cut {number}", pin.vertex);
        }
    }
}

#[test]
fn balls_cut_into_islands_keep_their_sums_and_slots() {
    let params = SolverParams {
        iterations: 1,
        ..TEN_ITERATIONS
    };
    for seed in 1..=100 {
        let mut body = Body::turning(0, 0.8, &paper_shell());
        set_ground(&mut body.solver, 0.0);
        let mut random = Random::new(seed);
        let most = 1.01 * body.energy();
        for number in 0..5 {
            let context = format!("ball {seed}, cut {number}");
            body.step(FRAME, &params);
            let energy = body.energy();
            assert!(energy <= most, "{context}: {energy} J, at most {most} J");
            let size = |p: &u32| body.surface.piece_triangles(*p);
            let largest = pieces(&body.surface).into_iter().max_by_key(size);
            let piece = largest.expect("a piece is left");
            let sweep = through(&mut random, &body.surface, piece);
            let params = CutParams {
                only_piece: Some(piece),
                // Minimal caps, since the pieces are small.
                refine: RefineParams {
                    level: RefinementLevel::Z(1e3),
                    grading: 1e3,
                    ..RefineParams::default()
                },
                ..CutParams::default()
            };
            body.cut(&sweep, &params, &context);
            let topology = body.surface.topology();
            assert!(
                topology.vertex_slots() <= 2 * topology.vertex_count()
                    && topology.triangle_slots() <= 2 * topology.triangle_count(),
                "{context}: {} and {} slots",
                topology.vertex_slots(),
                topology.triangle_slots()
            );
        }
    }
}

#[test]
fn a_body_that_is_cut_and_restored_needs_no_more_memory() {
    let mut body = Body::turning(2, 0.8, &paper_shell());
    set_ground(&mut body.solver, 0.0);
    let mut random = Random::new(21);
    let mut first = None;
    for number in 0..200 {
        body.step(FRAME, &TEN_ITERATIONS);
        let sweep = through(&mut random, &body.surface, 0);
        let before = (body.surface.topology().triangle_count(), body.sums().mass);
        let context = format!("cut {number}");
        let Some(undo) = body.cut(&sweep, &CutParams::default(), &context) else {
            continue;
        };
        let delta = body
            .cutter
            .undo(&mut body.surface, undo)
            .expect("the last edit");
        let applied = body.solver.apply_delta(&mut body.surface, &delta);
        applied.expect("the delta of an undo fits");
        body.validate();
        assert_eq!(
            body.surface.topology().triangle_count(),
            before.0,
            "{context}"
        );
        let mass = body.sums().mass;
        assert!(
            (mass / before.1 - 1.0).abs() <= ROUNDING,
            "{context}: {mass} kg"
        );
        let topology = body.surface.topology();
        let room = [
            topology.vertex_slots(),
            topology.triangle_slots(),
            body.solver.capacity(),
        ];
        let first = *first.get_or_insert(room);
        assert!(
            (0..3).all(|k| room[k] <= 2 * first[k]),
            "{context}: {room:?}, {first:?} at first"
        );
    }
}

/// Steps a random body with random material and pins, and cuts it three times.
fn random_body(seed: u64) {
    let mut random = Random::new(seed);
    let mut surface = match random.below(4) {
        0 => icosphere(0, 0.5),
        1 => icosphere(2, 0.5),
        2 => torus(0.35, 0.15, 12, 6),
        _ => cube_sphere(4, 0.5),
    };
    let scale = f64::from(random.log(0.1, 10.0));
    let axes = Vec3::from_fn(|_, _| random.between(0.5, 1.5)) * scale;
    let up = Vec3::new(0.0, 1.5 * scale, 0.0);
    place(&mut surface, |p| p.component_mul(&axes) + up);
    let stiffness = |random: &mut Random| match random.below(2) {
        0 => Stiffness::Pbd(random.log(0.1, 1.0)),
        _ => Stiffness::Compliance(random.log(1e-9, 1e-1)),
    };
    let material = Material {
        density: Density::Area(random.log(1e-2, 1e2)),
        stretch: stiffness(&mut random),
        bending: (random.below(4) > 0).then(|| stiffness(&mut random)),
        damping: random.log(1e-3, 1.0),
        friction: random.log(1e-3, 1.0),
        ..Material::default()
    };
    let params = SolverParams {
        iterations: [1, 10][random.below(2)],
        ..TEN_ITERATIONS
    };
    let substeps = [1, 5][random.below(2)];
    let is_on_ground = random.below(2) == 1;
    let dt = random.log(1e-3, 1.0 / 30.0);
    let params = params.with_substeps(dt, substeps);
    let mut body = Body::new(surface, &material);
    if is_on_ground {
        set_ground(&mut body.solver, 0.0);
    }
    body.turn();
    for number in 0..3 {
        let v = VertexId::from_index(random.below(body.surface.topology().vertex_slots()));
        if random.below(3) == 0 && !body.surface.topology().outgoing(v).is_null() {
            body.solver.pin(&mut body.surface, v).expect("a vertex");
        }
        (0..10).for_each(|_| body.step(dt, &params));
        let all = pieces(&body.surface);
        let piece = all[random.below(all.len())];
        let sweep = through(&mut random, &body.surface, piece);
        body.cut(
            &sweep,
            &CutParams::default(),
            &format!("seed {seed}, cut {number}"),
        );
    }
    (0..10).for_each(|_| body.step(dt, &params));
    body.cutter.refit(&body.surface);
    body.validate();
}

#[test]
fn random_bodies_are_cut_in_motion() {
    (0..50).for_each(random_body);
}

#[test]
#[ignore = "long"]
fn many_random_bodies_are_cut_in_motion() {
    (50..500).for_each(random_body);
}
