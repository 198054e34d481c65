//! Bodies lie against the flats of blades.

#[path = "common/firm.rs"]
mod firm;

use firm::firm;
use incise_mesh::{Surface, VertexId, cube_sphere};
use incise_pbd_gpu::SolverParams;
use incise_scene::{BodyId, ContactParams, Scene, SceneParams, SleepParams};

/// Of bodies whose sides would swing like drums.
const DAMPING: f32 = 1.0;

fn scene(gravity: [f32; 3]) -> Scene {
    Scene::new(SceneParams {
        solver: SolverParams {
            gravity,
            ground: None,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    })
}

fn thickness(scene: &Scene, id: BodyId) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "it is compared with f32")]
    let edge = scene.body(id).solver().mean_rest_length() as f32;
    ContactParams::default().thickness * edge
}

/// The least and the most of a coordinate of a piece.
fn extent(surface: &Surface, piece: u32, k: usize) -> [f32; 2] {
    let of_piece = |v: &VertexId| {
        let h = surface.topology().outgoing(*v);
        surface.piece(h.triangle()) == piece
    };
    let all = surface.topology().vertices().filter(of_piece);
    all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
        let c = surface.positions[v.index()][k];
        [low.min(c), high.max(c)]
    })
}

/// How fast the middle of a piece's mass goes up [m/s].
fn rising(scene: &Scene, id: BodyId, piece: u32) -> f32 {
    let (surface, solver) = (scene.body(id).surface(), scene.body(id).solver());
    let (mut momentum, mut mass) = (0.0, 0.0);
    for v in surface.topology().vertices() {
        if surface.piece(surface.topology().outgoing(v).triangle()) == piece {
            momentum += solver.masses()[v.index()] * solver.velocity(v)[1];
            mass += solver.masses()[v.index()];
        }
    }
    momentum / mass
}

/// A cube of 2 m falls by 0.2 m onto a flat at height 0 from an edge at x = -3 to the back.
fn block_over_a_flat(back: Option<[f32; 3]>) -> (Scene, BodyId) {
    let mut scene = scene([0.0, -9.81, 0.0]);
    let mut block = cube_sphere(6, 1.0);
    for (rest, p) in block.rest.iter_mut().zip(&mut block.positions) {
        let largest = rest.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        *rest = rest.map(|c| c / largest);
        rest[1] += 1.2;
        p[..3].copy_from_slice(rest);
    }
    let id = scene.add_body(block, &firm(0.5, DAMPING)).unwrap();
    let blade = scene.add_blade([[-3.0, 0.0, -3.0], [-3.0, 0.0, 3.0]]);
    scene.set_blade_back(blade, back);
    (scene, id)
}

#[test]
fn a_block_lies_on_a_flat_and_falls_past_a_mere_edge() {
    for back in [None, Some([6.0, 0.0, 0.0]), Some([1.5, 0.0, 0.0])] {
        let (mut scene, id) = block_over_a_flat(back);
        for _ in 0..180 {
            scene.step().unwrap();
        }
        let [low, _] = extent(scene.body(id).surface(), 0, 1);
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
fn a_flat_that_comes_pushes_what_is_before_it_and_one_that_goes_drops_it() {
    let (mut scene, id) = block_over_a_flat(Some([6.0, 0.0, 0.0]));
    scene.params.sleep = Some(SleepParams::default());
    let mut frames = 0;
    while !scene.is_asleep(id) {
        scene.step().unwrap();
        frames += 1;
        assert!(frames < 1200, "what lies on a flat falls asleep");
    }
    let blade = scene.blades().next().unwrap();
    // The edge goes up along itself and the back, so that it cuts nothing: 3 m/s.
    for frame in 1..=20_u8 {
        let y = 0.05 * f32::from(frame);
        scene.move_blade(blade, [[-3.0, y, -3.0], [-3.0, y, 3.0]]);
        scene.step().unwrap();
        assert!(!scene.is_asleep(id), "it is woken");
        let [low, _] = extent(scene.body(id).surface(), 0, 1);
        assert!(low > y, "at {low} m of {y}, in frame {frame}");
    }
    let [low, _] = extent(scene.body(id).surface(), 0, 1);
    scene.jump_blade(blade, [[30.0, 0.0, -3.0], [30.0, 0.0, 3.0]]);
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let [fallen, _] = extent(scene.body(id).surface(), 0, 1);
    assert!(fallen < low - 1.0, "from {low} to {fallen} m");
}

#[test]
fn a_flat_that_turns_takes_along_what_lies_on_it_and_its_ends_may_change_places() {
    for step in [0.1_f32, 0.5, 1.0] {
        let (mut scene, id) = block_over_a_flat(Some([6.0, 0.0, 0.0]));
        scene.params.solver.gravity = [0.0; 3];
        let blade = scene.blades().next().unwrap();
        let mut angle = 0.0_f32;
        while angle < 40.0 {
            angle += step;
            let (sin, cos) = angle.to_radians().sin_cos();
            scene.set_blade_back(blade, Some([6.0 * cos, 6.0 * sin, 0.0]));
            scene.step().unwrap();
        }
        // Above the plane through the edge at (-3, 0).
        let (sin, cos) = angle.to_radians().sin_cos();
        let positions = &scene.body(id).surface().positions;
        let heights = positions.iter().map(|[x, y, ..]| y * cos - (x + 3.0) * sin);
        let lowest = heights.fold(f32::INFINITY, f32::min);
        assert!(lowest > 0.0, "{lowest} m, {step} degrees a frame");
    }
    let (mut scene, id) = block_over_a_flat(Some([6.0, 0.0, 0.0]));
    let blade = scene.blades().next().unwrap();
    for frame in 0..180 {
        if frame == 120 {
            scene.move_blade(blade, [[-3.0, 0.0, 3.0], [-3.0, 0.0, -3.0]]);
        }
        scene.step().unwrap();
    }
    let [low, _] = extent(scene.body(id).surface(), 0, 1);
    let apart = thickness(&scene, id);
    assert!(low > 0.9 * apart && low < 2.0 * apart, "{low} m");
}

#[test]
fn a_thick_flat_between_lips_throws_nobody() {
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
        scene.set_blade_back(blade, Some([-6.0, 0.0, 0.0]));
        scene.step().unwrap();
        scene.move_blade(blade, [[2.0, y, -2.0], [2.0, y, 2.0]]);
        assert_eq!(scene.step().unwrap().cuts, 1);
        let mut fastest = 0.0_f32;
        for _ in 0..60 {
            scene.step().unwrap();
            for piece in [0, 1] {
                fastest = fastest.max(rising(&scene, id, piece).abs());
            }
        }
        // With its weight no piece would hop by the two thicknesses that are between them.
        let apart = f64::from(2.0 * edges) * scene.body(id).solver().mean_rest_length();
        let most = (2.0 * 9.81 * apart).sqrt();
        assert!(
            f64::from(fastest) < most,
            "{fastest} of {most} m/s at {y}, {edges}"
        );
    }
}

#[test]
fn lips_of_a_cut_lie_on_both_sides_of_the_blade() {
    let mut scene = scene([0.0; 3]);
    let id = scene
        .add_body(cube_sphere(8, 1.0), &firm(0.5, DAMPING))
        .unwrap();
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    scene.set_blade_back(blade, Some([-6.0, 0.0, 0.0]));
    scene.step().unwrap();
    scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]);
    assert_eq!(scene.step().unwrap().cuts, 1);
    for _ in 0..90 {
        scene.step().unwrap();
    }
    let surface = scene.body(id).surface();
    let mut sides = [0, 1].map(|piece| extent(surface, piece, 1));
    sides.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // Half of what two lips would keep from each other, on either side.
    let apart = 0.9 * thickness(&scene, id);
    let [[_, below], [above, _]] = sides;
    assert!(below < 0.1 - apart && above > 0.1 + apart, "{sides:?}");
    // With its weight the upper one would not hop by a thickness.
    let most = (2.0 * 9.81 * thickness(&scene, id)).sqrt();
    let velocities = scene.body(id).solver().velocities();
    let fastest = velocities.iter().map(|v| v[1].abs()).fold(0.0, f32::max);
    assert!(
        fastest < most,
        "and nobody is thrown: {fastest} of {most} m/s"
    );
}

#[test]
fn nothing_gets_through_a_flat_at_ten_diagonals_a_second() {
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
        scene.set_blade_back(blade, Some(back));
        for _ in 0..30 {
            scene.step().unwrap();
            let [low, _] = extent(scene.body(id).surface(), 0, 1);
            assert!(low > -1.51, "it came to {low} m");
        }
    }
}

#[test]
fn a_back_of_no_area_and_a_scene_without_contacts_are_as_if_it_were_not_there() {
    let fallen = |back, contacts| {
        let (mut scene, id) = block_over_a_flat(back);
        scene.params.contacts = contacts;
        for _ in 0..60 {
            scene.step().unwrap();
        }
        scene.body(id).surface().positions.clone()
    };
    let contacts = Some(ContactParams::default());
    let expected = fallen(None, contacts);
    for (back, contacts) in [
        (Some([0.0, 0.0, 2.0]), contacts),
        (Some([0.0; 3]), contacts),
        (Some([f32::NAN, 0.0, 0.0]), contacts),
        (Some([f32::INFINITY, 1.0, 0.0]), contacts),
        (Some([6.0, 0.0, 0.0]), None),
    ] {
        assert_eq!(fallen(back, contacts), expected, "{back:?}");
    }
}
