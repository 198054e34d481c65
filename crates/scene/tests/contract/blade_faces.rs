//! Contacts of bodies with blade faces: rest, push, rotation, cuts and tunneling.

use incise_mesh::{Surface, VertexId, cube_sphere};
use incise_pbd_gpu::SolverParams;
use incise_scene::{BodyId, ContactParams, Scene, SceneParams, SleepParams};
use incise_test_support::materials::firm;

/// Damping of bodies without interior springs, whose sides would oscillate.
const DAMPING: f32 = 1.0;

fn scene(gravity: [f32; 3]) -> Scene {
    Scene::new(SceneParams {
        solver: SolverParams {
            gravity,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    })
}

fn thickness(scene: &Scene, id: BodyId) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "it is compared with f32")]
    let edge = scene.body(id).unwrap().solver().mean_rest_length() as f32;
    ContactParams::default().thickness * edge
}

/// Returns minimum and maximum of coordinate `k` of a piece \[m\].
fn extent(surface: &Surface, piece: u32, k: usize) -> [f32; 2] {
    let of_piece = |v: &VertexId| {
        let h = surface.topology().outgoing(*v);
        surface.piece(h.triangle()) == piece
    };
    let all = surface.topology().vertices().filter(of_piece);
    all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
        let c = surface.positions()[v.index()][k];
        [low.min(c), high.max(c)]
    })
}

/// Returns the vertical velocity of a piece's center of mass [m/s].
fn vertical_velocity(scene: &Scene, id: BodyId, piece: u32) -> f32 {
    let (surface, solver) = (
        scene.body(id).unwrap().surface(),
        scene.body(id).unwrap().solver(),
    );
    let (mut momentum, mut mass) = (0.0, 0.0);
    for v in surface.topology().vertices() {
        if surface.piece(surface.topology().outgoing(v).triangle()) == piece {
            momentum += solver.masses()[v.index()] * solver.velocity(v)[1];
            mass += solver.masses()[v.index()];
        }
    }
    momentum / mass
}

/// Returns a scene in which a cube of 2 m is 0.2 m above a blade face.
///
/// The face is at height 0, with its edge at x = -3.
fn block_over_a_face(back: Option<[f32; 3]>) -> (Scene, BodyId) {
    let mut scene = scene([0.0, -9.81, 0.0]);
    let mut block = cube_sphere(6, 1.0);
    for v in 0..block.positions().len() {
        let mut rest = block.rest_positions()[v];
        let largest = rest.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        rest = rest.map(|c| c / largest);
        rest[1] += 1.2;
        block.rest_positions_mut()[v] = rest;
        block.positions_mut()[v][..3].copy_from_slice(&rest);
    }
    let id = scene.add_body(block, &firm(0.5, DAMPING)).unwrap();
    let blade = scene.add_blade([[-3.0, 0.0, -3.0], [-3.0, 0.0, 3.0]]);
    scene.set_blade_face(blade, back).unwrap();
    (scene, id)
}

#[test]
fn a_block_rests_on_a_blade_face_and_falls_past_an_edge() {
    for back in [None, Some([6.0, 0.0, 0.0]), Some([1.5, 0.0, 0.0])] {
        let (mut scene, id) = block_over_a_face(back);
        for _ in 0..180 {
            scene.step().unwrap();
        }
        let [low, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
        if back == Some([6.0, 0.0, 0.0]) {
            let apart = thickness(&scene, id);
            assert!(low > 0.9 * apart && low < 2.0 * apart, "{low} m");
            assert!(scene.stats().contacts > 0);
        } else {
            assert!(low < -5.0, "it falls: {low} m");
        }
    }
}

#[test]
fn a_moving_face_pushes_a_block_and_a_removed_one_drops_it() {
    let (mut scene, id) = block_over_a_face(Some([6.0, 0.0, 0.0]));
    scene.params.sleep = Some(SleepParams::default());
    let mut frames = 0;
    while !scene.is_asleep(id).unwrap() {
        scene.step().unwrap();
        frames += 1;
        assert!(frames < 1200, "a body on a blade face falls asleep");
    }
    let blade = scene.blades().next().unwrap();
    // The face rises at 3 m/s; its edge is beside the block and cuts nothing.
    for frame in 1..=20_u8 {
        let y = 0.05 * f32::from(frame);
        scene
            .move_blade(blade, [[-3.0, y, -3.0], [-3.0, y, 3.0]])
            .unwrap();
        scene.step().unwrap();
        assert!(!scene.is_asleep(id).unwrap(), "it is awake");
        let [low, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
        assert!(low > y, "at {low} m of {y}, in frame {frame}");
    }
    let [low, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
    scene
        .teleport_blade(blade, [[30.0, 0.0, -3.0], [30.0, 0.0, 3.0]])
        .unwrap();
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let [fallen, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
    assert!(fallen < low - 1.0, "from {low} to {fallen} m");
}

#[test]
fn a_turning_face_carries_a_block_and_its_ends_may_swap() {
    for step in [0.1_f32, 0.5, 1.0] {
        let (mut scene, id) = block_over_a_face(Some([6.0, 0.0, 0.0]));
        scene.params.solver.gravity = [0.0; 3];
        let blade = scene.blades().next().unwrap();
        let mut angle = 0.0_f32;
        while angle < 40.0 {
            angle += step;
            let (sin, cos) = angle.to_radians().sin_cos();
            scene
                .set_blade_face(blade, Some([6.0 * cos, 6.0 * sin, 0.0]))
                .unwrap();
            scene.step().unwrap();
        }
        // Above the plane through the edge at (-3, 0).
        let (sin, cos) = angle.to_radians().sin_cos();
        let positions = scene.body(id).unwrap().surface().positions();
        let heights = positions.iter().map(|[x, y, ..]| y * cos - (x + 3.0) * sin);
        let lowest = heights.fold(f32::INFINITY, f32::min);
        assert!(lowest > 0.0, "{lowest} m, {step} degrees a frame");
    }
    let (mut scene, id) = block_over_a_face(Some([6.0, 0.0, 0.0]));
    let blade = scene.blades().next().unwrap();
    for frame in 0..180 {
        if frame == 120 {
            scene
                .move_blade(blade, [[-3.0, 0.0, 3.0], [-3.0, 0.0, -3.0]])
                .unwrap();
        }
        scene.step().unwrap();
    }
    let [low, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
    let apart = thickness(&scene, id);
    assert!(low > 0.9 * apart && low < 2.0 * apart, "{low} m");
}

#[test]
fn a_face_between_the_sides_of_a_cut_ejects_no_vertex() {
    for (y, edges) in [(0.1, 0.1), (0.7, 0.1), (0.7, 0.3), (0.7, 1.0)] {
        let mut scene = scene([0.0; 3]);
        scene.params.contacts = Some(ContactParams {
            thickness: edges,
            ..ContactParams::default()
        });
        let id = scene
            .add_body(cube_sphere(6, 1.0), &firm(0.5, DAMPING))
            .unwrap();
        let blade = scene.add_blade([[-2.0, y, -2.0], [-2.0, y, 2.0]]);
        scene.set_blade_face(blade, Some([-6.0, 0.0, 0.0])).unwrap();
        scene.step().unwrap();
        scene
            .move_blade(blade, [[2.0, y, -2.0], [2.0, y, 2.0]])
            .unwrap();
        assert_eq!(scene.step().unwrap().cuts, 1);
        let mut fastest = 0.0_f32;
        for _ in 0..60 {
            scene.step().unwrap();
            for piece in [0, 1] {
                fastest = fastest.max(vertical_velocity(&scene, id, piece).abs());
            }
        }
        // The speed is too low to rise by two contact thicknesses under gravity.
        let apart = f64::from(2.0 * edges) * scene.body(id).unwrap().solver().mean_rest_length();
        let most = (2.0 * 9.81 * apart).sqrt();
        assert!(
            f64::from(fastest) < most,
            "{fastest} of {most} m/s at {y}, {edges}"
        );
    }
}

#[test]
fn the_sides_of_a_cut_lie_on_both_sides_of_the_blade() {
    let mut scene = scene([0.0; 3]);
    let id = scene
        .add_body(cube_sphere(8, 1.0), &firm(0.5, DAMPING))
        .unwrap();
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    scene.set_blade_face(blade, Some([-6.0, 0.0, 0.0])).unwrap();
    scene.step().unwrap();
    scene
        .move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]])
        .unwrap();
    assert_eq!(scene.step().unwrap().cuts, 1);
    for _ in 0..90 {
        scene.step().unwrap();
    }
    let surface = scene.body(id).unwrap().surface();
    let mut sides = [0, 1].map(|piece| extent(surface, piece, 1));
    sides.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // Half of the distance that two sides would keep from each other.
    let apart = 0.9 * thickness(&scene, id);
    let [[_, below], [above, _]] = sides;
    assert!(below < 0.1 - apart && above > 0.1 + apart, "{sides:?}");
    // The speed is too low to rise by a contact thickness under gravity.
    let most = (2.0 * 9.81 * thickness(&scene, id)).sqrt();
    let velocities = scene.body(id).unwrap().solver().velocities();
    let fastest = velocities.iter().map(|v| v[1].abs()).fold(0.0, f32::max);
    assert!(
        fastest < most,
        "no vertex is thrown: {fastest} of {most} m/s"
    );
}

#[test]
fn a_fast_block_does_not_tunnel_through_a_face() {
    for back in [[6.0_f32, 0.0, 0.0], [-6.0, 0.0, 0.0]] {
        let mut scene = scene([0.0; 3]);
        let id = scene
            .add_body(cube_sphere(5, 1.0), &firm(0.5, DAMPING))
            .unwrap();
        let (solver, surface) = scene.edit(id).unwrap().solver_mut();
        for v in surface.topology().vertices().collect::<Vec<_>>() {
            let down = [0.0, -20.0 * 3.0_f32.sqrt(), 0.0];
            solver.set_velocity(v, down).unwrap();
        }
        let x = -3.0 * back[0].signum();
        let blade = scene.add_blade([[x, -1.5, -3.0], [x, -1.5, 3.0]]);
        scene.set_blade_face(blade, Some(back)).unwrap();
        for _ in 0..30 {
            scene.step().unwrap();
            let [low, _] = extent(scene.body(id).unwrap().surface(), 0, 1);
            assert!(low > -1.51, "it came to {low} m");
        }
    }
}

#[test]
fn a_face_without_area_or_without_contacts_has_no_effect() {
    let fallen = |back, contacts| {
        let (mut scene, id) = block_over_a_face(back);
        scene.params.contacts = contacts;
        for _ in 0..60 {
            scene.step().unwrap();
        }
        scene.body(id).unwrap().surface().positions().to_vec()
    };
    let contacts = Some(ContactParams::default());
    let expected = fallen(None, contacts);
    for (back, contacts) in [
        (Some([0.0, 0.0, 2.0]), contacts),
        (Some([0.0; 3]), contacts),
        (Some([6.0, 0.0, 0.0]), None),
    ] {
        assert_eq!(fallen(back, contacts), expected, "{back:?}");
    }
}
