//! Many cuts and undos of a body with volume constraints, interior springs and self-collision.

use incise_mesh::geometry::{area_vector, round_to_f32};
use incise_mesh::{Aabb, Surface, cube_sphere};
use incise_pbd_gpu::{Collider, InteriorSprings, Material, SolverParams, Stiffness, Volume};
use incise_scene::{BladeId, Body, BodyId, ContactParams, Scene, SceneParams};
use incise_test_support::random::Random;

fn scene() -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams {
        solver: SolverParams::default().with_substeps(1.0 / 60.0, 2),
        contacts: Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        }),
        ..SceneParams::default()
    });
    scene.colliders.push(Collider::ground(-1.5));
    let material = Material {
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 0.5,
            stiffness: Stiffness::Compliance(1e-5),
        }),
        ..Material::default()
    };
    let id = scene.add_body(cube_sphere(3, 1.0), &material).unwrap();
    let blade = scene.add_blade([[0.0; 3], [0.0, 0.0, 1.0]]);
    (scene, id, blade)
}

/// Returns the edge of a blade before and after it sweeps down through a whole box.
fn sweep(bounds: &Aabb, random: &mut Random) -> [[[f32; 3]; 2]; 2] {
    let middle = [0, 1, 2].map(|k| (bounds.min[k] + bounds.max[k]) / 2.0);
    let half = [0, 1, 2].map(|k| (bounds.max[k] - bounds.min[k]) / 2.0);
    let [turn, aside] = [3.2, 0.7].map(|size| round_to_f32(size * random.signed()));
    let (sin, cos) = turn.sin_cos();
    // The edge is horizontal, at any angle and with an offset from the middle.
    let width = half[0].max(half[2]);
    let at = |along: f32, y: f32| {
        [
            middle[0] + cos * along - sin * aside * width,
            y,
            middle[2] + sin * along + cos * aside * width,
        ]
    };
    let far = 4.0 * (half[0] + half[2]);
    let (above, below) = (bounds.max[1] + half[1], bounds.min[1] - half[1]);
    [above, below].map(|y| [at(-far, y), at(far, y)])
}

/// Returns the piece with the most triangles.
fn largest(body: &Body) -> u32 {
    let surface = body.surface();
    let mut counts = vec![0; surface.piece_bound() as usize];
    for t in surface.topology().triangles() {
        counts[surface.piece(t) as usize] += 1;
    }
    (0..).zip(counts).max_by_key(|&(_, count)| count).unwrap().0
}

/// Returns the bounding box of a piece.
fn bounds(surface: &Surface, piece: u32) -> Aabb {
    let mut bounds = Aabb::default();
    for t in surface.topology().triangles() {
        for v in surface.topology().triangle(t) {
            for k in (0..3).filter(|_| surface.piece(t) == piece) {
                let c = surface.positions()[v.index()][k];
                bounds.min[k] = bounds.min[k].min(c);
                bounds.max[k] = bounds.max[k].max(c);
            }
        }
    }
    bounds
}

fn check(scene: &Scene, id: BodyId) {
    let body = scene.body(id).unwrap();
    let (surface, solver) = (body.surface(), body.solver());
    assert!(surface.topology().is_closed(), "the surface is closed");
    solver.validate(surface).unwrap();
    let solids: Vec<u32> = (solver.volumes().pieces().iter())
        .map(|volume| volume.piece())
        .collect();
    for piece in body.pieces() {
        let triangles = surface.topology().triangles();
        let own: Vec<_> = triangles.filter(|&t| surface.piece(t) == piece).collect();
        let corners = |t| {
            surface
                .topology()
                .triangle(t)
                .map(|v| surface.rest_position(v))
        };
        let areas = own.iter().map(|&t| area_vector(corners(t)).norm() / 2.0);
        let area: f64 = areas.sum();
        let ball = area.powf(1.5) / (6.0 * std::f64::consts::PI.sqrt());
        let points = own.iter().flat_map(|&t| corners(t));
        let largest = points.fold(0.0, |largest, p| f64::max(largest, p.amax()));
        let volume = surface.rest_volume_of(own.into_iter()).abs();
        // Flat pieces have none, and those whose volume is lost in rounding (`Volume`).
        let (round, resolved) = (volume / ball, volume / (area * largest));
        assert!(
            solids.contains(&piece) || round < 2e-6 || resolved < 2e-6,
            "piece {piece} has no volume constraint, but {round} of the volume of a ball, \
             {resolved} of its area times the largest coordinate"
        );
    }
    let interior_springs = solver.interior_springs().unwrap();
    let batches = interior_springs
        .batches()
        .iter()
        .chain([interior_springs.overflow()]);
    let ends = batches.flat_map(|batch| batch.vertices());
    let pieces =
        ends.map(|ends| ends.map(|v| surface.piece(surface.topology().outgoing(v).triangle())));
    for [a, b] in pieces {
        assert_eq!(a, b, "an interior spring connects pieces {a} and {b}");
    }
    let bounds = surface.bounds();
    let numbers = bounds.min.into_iter().chain(bounds.max);
    assert!(numbers.clone().all(f32::is_finite), "{bounds:?}");
    assert!(
        numbers.map(f32::abs).fold(0.0, f32::max) < 50.0,
        "no vertex flies off: {bounds:?}"
    );
}

#[test]
#[ignore = "long"]
fn constraints_stay_valid_through_many_cuts_and_undos() {
    let (mut scene, id, blade) = scene();
    let mut random = Random::new(7);
    let (mut cuts, mut undone) = (0, 0);
    for round in 0..24 {
        // Through all pieces at first, then only through the largest, to limit their number.
        let largest = largest(scene.body(id).unwrap());
        let [from, to] = sweep(
            &bounds(scene.body(id).unwrap().surface(), largest),
            &mut random,
        );
        scene
            .set_blade_piece(blade, (round >= 3).then_some(largest))
            .unwrap();
        scene.teleport_blade(blade, from).unwrap();
        scene
            .set_blade_face(blade, (round % 5 == 0).then_some([0.0, 1.0, 0.0]))
            .unwrap();
        scene.move_blade(blade, to).unwrap();
        let done = scene.step().unwrap().cuts;
        cuts += done;
        if round % 4 == 3 && done > 0 {
            // Undone before the halves have moved.
            let (_, outcome) = scene.cuts().last().unwrap().cut.as_ref().unwrap();
            let undo = outcome.undo.clone().unwrap();
            scene.undo(id, undo).unwrap();
            undone += 1;
        }
        check(&scene, id);
        scene.step().unwrap();
    }
    assert!(cuts > 15 && undone > 2, "{cuts} cuts, {undone} undone");
    for _ in 0..30 {
        scene.step().unwrap();
    }
    check(&scene, id);
}
