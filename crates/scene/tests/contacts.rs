//! Pieces of a body stop at each other.

#[path = "common/firm.rs"]
mod firm;

use firm::firm;
use incise_cut::Bvh;
use incise_mesh::{Surface, TriangleId, VertexId, cube_sphere};
use incise_pbd_gpu::{Collider, Material, SolverParams, Struts};
use incise_scene::{Body, BodyId, ContactParams, Scene, SceneError, SceneParams, SleepParams};

fn params(gravity: [f32; 3], ground: Option<f32>) -> SceneParams {
    SceneParams {
        solver: SolverParams {
            gravity,
            ground,
            ..SolverParams::default()
        },
        contacts: Some(ContactParams::default()),
        sleep: None,
        ..SceneParams::default()
    }
}

/// Surfaces as the components of one.
fn together(parts: &[Surface]) -> Surface {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        let offset = u32::try_from(corners.len()).unwrap();
        corners.extend_from_slice(&part.rest);
        let topology = part.topology();
        let of = |t: TriangleId| topology.triangle(t).map(|v| v.0 + offset);
        faces.extend(topology.triangles().map(of));
    }
    Surface::from_triangles(&corners, &faces).unwrap()
}

fn moved(surface: &Surface, by: [f32; 3], scale: [f32; 3]) -> Surface {
    let mut out = surface.clone();
    for p in &mut out.rest {
        *p = [0, 1, 2].map(|k| p[k] * scale[k] + by[k]);
    }
    out
}

/// A cube of 2 m, its corners rounded off by nothing, of n x n squares a side.
fn cube(n: u32) -> Surface {
    let mut surface = cube_sphere(n, 1.0);
    for p in &mut surface.rest {
        let largest = p.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        *p = p.map(|c| c / largest);
    }
    surface
}

fn piece_of(surface: &Surface, v: VertexId) -> u32 {
    surface.piece(surface.topology().outgoing(v).triangle())
}

/// How deep any vertex is in another piece \[m\].
fn deepest(surface: &Surface) -> f64 {
    let bvh = Bvh::build(surface);
    let mut deepest = 0.0_f64;
    for v in surface.topology().vertices() {
        let own = piece_of(surface, v);
        let at = surface.position(v);
        let found = bvh.nearest(surface, at, 10.0, |t| surface.piece(t) != own);
        deepest = deepest.max(found.map_or(0.0, |found| -found.distance));
    }
    deepest
}

/// The highest and lowest points of a piece.
fn heights(body: &Body, piece: u32) -> [f32; 2] {
    let surface = body.surface();
    let all = surface.topology().vertices();
    let of_piece = all.filter(|&v| piece_of(surface, v) == piece);
    of_piece.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
        let y = surface.positions[v.index()][1];
        [low.min(y), high.max(y)]
    })
}

/// How fast the middle of a piece's mass goes up [m/s].
fn rising(body: &Body, piece: u32) -> f32 {
    let solver = body.solver();
    let (mut momentum, mut mass) = (0.0, 0.0);
    for v in of_piece(body.surface(), piece) {
        momentum += solver.masses()[v.index()] * solver.velocity(v)[1];
        mass += solver.masses()[v.index()];
    }
    momentum / mass
}

/// Pins all of a piece.
fn hold(scene: &mut Scene, id: BodyId, piece: u32) {
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in of_piece(surface, piece) {
        solver.pin(surface, v).unwrap();
    }
}

fn of_piece(surface: &Surface, piece: u32) -> Vec<VertexId> {
    let all = surface.topology().vertices();
    all.filter(|&v| piece_of(surface, v) == piece).collect()
}

fn throw(scene: &mut Scene, id: BodyId, piece: u32, velocity: [f32; 3]) {
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for v in of_piece(surface, piece) {
        solver.set_velocity(v, velocity).unwrap();
    }
}

#[test]
fn a_ball_rests_on_another_one_instead_of_in_it() {
    let ball = cube_sphere(6, 1.0);
    let body = together(&[
        moved(&ball, [0.0, 1.0, 0.0], [1.0; 3]),
        moved(&ball, [0.02, 3.05, 0.01], [1.0; 3]),
    ]);
    for contacts in [Some(ContactParams::default()), None] {
        let params = SceneParams {
            contacts,
            ..params([0.0, -9.81, 0.0], Some(0.0))
        };
        let mut scene = Scene::new(params);
        let id = scene.add_body(body.clone(), &firm(1.0, 0.0)).unwrap();
        // On its top it stays for a while; it has not fallen to the ground within 0.8 s.
        for _ in 0..48 {
            scene.step().unwrap();
        }
        let [low, _] = heights(scene.body(id), 1);
        let is_stopped = low > 1.0;
        assert_eq!(is_stopped, contacts.is_some(), "it is {low} m high");
        let deep = deepest(scene.body(id).surface());
        assert_eq!(deep < 0.02, contacts.is_some(), "{deep} m in each other");
    }
}

#[test]
fn what_meets_keeps_its_momentum() {
    let ball = cube_sphere(6, 1.0);
    let body = together(&[ball.clone(), moved(&ball, [2.5, 0.4, 0.1], [1.0; 3])]);
    let mut scene = Scene::new(params([0.0; 3], None));
    let id = scene.add_body(body, &firm(0.5, 0.0)).unwrap();
    throw(&mut scene, id, 0, [3.0, 0.0, 0.0]);
    let solver = scene.body(id).solver();
    let (before, energy) = (solver.momentum(), solver.kinetic_energy());
    let mut deep = 0.0_f64;
    let mut touched = 0;
    for _ in 0..60 {
        touched += scene.step().unwrap().contacts;
        deep = deep.max(deepest(scene.body(id).surface()));
    }
    assert!(
        touched > 0 && deep < 0.02,
        "{touched} contacts, {deep} m deep"
    );
    let body = scene.body(id);
    let mass = body.solver().total_mass();
    for (is, was) in body.solver().momentum().into_iter().zip(before) {
        assert!((is - was).abs() < 1e-3 * mass, "{was} became {is}");
    }
    assert!(body.solver().kinetic_energy() < energy, "none is made");
    let mut pushed = [0.0; 3];
    for v in body.surface().topology().vertices() {
        if piece_of(body.surface(), v) == 1 {
            let (velocity, mass) = (body.solver().velocity(v), body.solver().masses()[v.index()]);
            (0..3).for_each(|k| pushed[k] += velocity[k] * mass);
        }
    }
    assert!(pushed[0] > 0.5, "the other one goes on: {pushed:?}");
}

#[test]
fn nothing_gets_through_at_ten_diagonals_a_second() {
    let ball = cube_sphere(5, 1.0);
    // A plate of a tenth of the ball's size, held by all of its vertices.
    let plate = moved(&cube(8), [0.0; 3], [2.0, 0.1, 2.0]);
    for offset in [0.0, 0.13, 0.7] {
        let above = moved(&ball, [offset, 3.0, offset / 3.0], [1.0; 3]);
        let body = together(&[plate.clone(), above]);
        let speed = 10.0 * 2.0 * 3.0_f32.sqrt();
        let mut scene = Scene::new(params([0.0; 3], None));
        let id = scene.add_body(body, &firm(0.0, 0.0)).unwrap();
        hold(&mut scene, id, 0);
        throw(&mut scene, id, 1, [0.0, -speed, 0.0]);
        let mut lowest = f32::INFINITY;
        for _ in 0..30 {
            scene.step().unwrap();
            lowest = lowest.min(heights(scene.body(id), 1)[0]);
        }
        assert!(
            lowest > 0.0,
            "it came down to {lowest} m, the top being 0.1 m"
        );
    }
}

#[test]
fn a_pin_is_not_dragged_through_a_piece_within_a_frame() {
    let plate = moved(&cube(8), [0.0; 3], [2.0, 0.1, 2.0]);
    let above = moved(&cube_sphere(5, 1.0), [0.1, 1.4, 0.2], [1.0; 3]);
    let mut scene = Scene::new(params([0.0; 3], None));
    let id = (scene.add_body(together(&[plate, above]), &firm(0.0, 0.0))).unwrap();
    scene.step().unwrap();
    hold(&mut scene, id, 1);
    let pins = scene.body(id).solver().pins().to_vec();
    for pin in pins {
        let [x, y, z] = pin.target;
        let to = [x, y - 2.0, z];
        scene.set_pin_target(id, pin.vertex, to).unwrap();
    }
    // All of the ball is 2 m lower a frame later, and the plate with it.
    for _ in 0..3 {
        scene.step().unwrap();
    }
    let [_, top] = heights(scene.body(id), 0);
    let [bottom, _] = heights(scene.body(id), 1);
    assert!(
        bottom < -1.0,
        "the ball is where it was dragged: {bottom} m"
    );
    assert!(rising(scene.body(id), 0) < 0.0, "the plate goes before it");
    assert!(top < 0.0, "its top is at {top} m");
}

/// How far a block slides down a slope of the tangent `slope` in half a second \[m\].
fn slid(friction: f32, slope: f32) -> f32 {
    let block = moved(&cube(3), [-0.5, 0.22, 0.0], [0.2; 3]);
    let plate = moved(&cube(6), [0.0, -0.1, 0.0], [2.0, 0.1, 2.0]);
    let g = 9.81 / (1.0 + slope * slope).sqrt();
    // The slope is horizontal, and what is down is aslant.
    let mut scene = Scene::new(params([g * slope, -g, 0.0], None));
    let id = (scene.add_body(together(&[plate, block]), &firm(friction, 0.0))).unwrap();
    hold(&mut scene, id, 0);
    let along = |scene: &Scene| {
        let surface = scene.body(id).surface();
        let block = of_piece(surface, 1);
        let sum: f32 = block.iter().map(|v| surface.positions[v.index()][0]).sum();
        sum / block.len() as f32
    };
    let start = along(&scene);
    for _ in 0..30 {
        scene.step().unwrap();
    }
    along(&scene) - start
}

#[test]
fn a_block_slides_where_the_slope_is_steeper_than_friction() {
    let found = slid(0.5, 0.4);
    assert!(found < 0.01, "it holds, but for {found} m");
    for friction in [0.0, 0.3] {
        let slope = 0.6_f32;
        let a = 9.81 * (slope - friction) / (1.0 + slope * slope).sqrt();
        let (found, expected) = (slid(friction, slope), a * 0.125);
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{found}, not {expected} m"
        );
    }
}

#[test]
fn halves_of_a_cut_part_slowly_and_stay_apart() {
    let mut scene = Scene::new(params([0.0; 3], None));
    let id = scene
        .add_body(cube_sphere(8, 1.0), &firm(0.5, 0.0))
        .unwrap();
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    scene.step().unwrap();
    assert_eq!(scene.stats().contact_searches, 0, "it is in one piece");
    scene.move_blade(blade, [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]]);
    scene.step().unwrap();
    assert!(scene.stats().contacts > 100, "caps lie on each other");
    let mut fastest = 0.0_f32;
    for _ in 0..60 {
        scene.step().unwrap();
        let [upper, lower] = [0, 1].map(|piece| rising(scene.body(id), piece));
        fastest = fastest.max((upper - lower).abs());
    }
    // With its weight the upper half would not hop by a thickness.
    let thickness = 0.1 * scene.body(id).solver().mean_rest_length();
    let most = (2.0 * 9.81 * thickness).sqrt();
    assert!(
        f64::from(fastest) < most,
        "thrown apart by {fastest} of {most} m/s"
    );
    let surface = scene.body(id).surface();
    assert!(deepest(surface) < 1e-3);
    let [lower, upper] = [0, 1].map(|piece| heights(scene.body(id), piece));
    let between = f64::from(lower[0].max(upper[0]) - lower[1].min(upper[1]));
    assert!(between > 0.9 * thickness, "{between} m apart");
}

#[test]
fn bodies_stay_out_of_colliders_and_sleep_on_flat_ones() {
    // What rolls would roll off the round ones.
    let block = moved(&cube(4), [0.0, 1.0, 0.0], [0.5; 3]);
    let all = [
        Collider::Plane {
            point: [0.0, 0.2, 0.0],
            normal: [0.0, 1.0, 0.0],
        },
        Collider::Box {
            center: [0.0, -0.3, 0.0],
            half: [2.0, 0.5, 2.0],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        },
        Collider::Sphere {
            center: [0.0, -19.8, 0.0],
            radius: 20.0,
        },
        Collider::Capsule {
            ends: [[-3.0, -19.8, 0.0], [3.0, -19.8, 0.0]],
            radius: 20.0,
        },
    ];
    for collider in all {
        let mut scene = Scene::new(SceneParams {
            contacts: None,
            sleep: Some(SleepParams::default()),
            ..params([0.0, -9.81, 0.0], None)
        });
        // One that is far is not looked at.
        let far = Collider::Sphere {
            center: [100.0, 0.0, 0.0],
            radius: 1.0,
        };
        scene.colliders = vec![far, collider];
        let material = Material {
            damping: 1.0,
            ..firm(1.0, 0.0)
        };
        let body = together(std::slice::from_ref(&block));
        let id = scene.add_body(body, &material).unwrap();
        let mut lowest = f32::INFINITY;
        for frame in 0..1800 {
            scene.step().unwrap();
            assert!(scene.stats().colliders <= 1, "in frame {frame}");
            lowest = lowest.min(heights(scene.body(id), 0)[0]);
            if scene.is_asleep(id) {
                break;
            }
        }
        // A corner is on a ball of 20 m where that is 12.5 mm below its top.
        assert!(lowest > 0.187, "it got to {lowest} m in {collider:?}");
        assert!(
            lowest < 0.21,
            "it has come down: {lowest} m at {collider:?}"
        );
        // On a ball it stands on a point and rocks.
        let is_flat = matches!(collider, Collider::Plane { .. } | Collider::Box { .. });
        assert!(scene.is_asleep(id) || !is_flat, "it rests on {collider:?}");
        scene.colliders.clear();
        for _ in 0..30 {
            scene.step().unwrap();
        }
        let low = heights(scene.body(id), 0)[0];
        assert!(low < -0.5, "it falls when that goes: {low} m");
    }
}

#[test]
fn a_collider_that_is_none_is_refused_before_anything_moves() {
    let mut scene = Scene::new(params([0.0, -9.81, 0.0], None));
    let id = scene
        .add_body(cube_sphere(3, 0.5), &firm(0.5, 0.0))
        .unwrap();
    let far = |radius| Collider::Sphere {
        center: [1e3; 3],
        radius,
    };
    scene.colliders = vec![far(1.0), far(f32::NAN)];
    let error = scene.step().unwrap_err();
    assert!(error.to_string().contains("collider 1"), "{error}");
    assert_eq!(scene.body(id).solver().kinetic_energy(), 0.0);
    scene.colliders.pop();
    scene.step().unwrap();
}

/// Two plates a fifth of their edges thick, so that every vertex is near triangles of the other's far side too. Struts keep each plate's
/// own two sides apart; without them these pass through each other, and what is inside out trembles.
#[test]
fn thin_plates_lie_on_each_other() {
    for half in [0.02, 0.05] {
        let plate = moved(&cube(4), [0.0; 3], [0.5, half, 0.5]);
        let below = moved(&plate, [0.0, half + 0.03, 0.0], [1.0; 3]);
        let above = moved(&plate, [0.0, 3.0 * half + 0.06, 0.0], [1.0; 3]);
        let mut scene = Scene::new(params([0.0, -9.81, 0.0], Some(0.0)));
        let material = Material {
            damping: 1.0,
            struts: Some(Struts::default()),
            ..Material::default()
        };
        let body = together(&[below, above]);
        let id = scene.add_body(body, &material).unwrap();
        let mut fastest = 0.0_f32;
        for _ in 0..180 {
            scene.step().unwrap();
            let velocities = scene.body(id).solver().velocities().iter();
            fastest = velocities.flatten().fold(fastest, |a, c| a.max(c.abs()));
        }
        // The fall alone gives 1.1 m/s.
        assert!(fastest < 5.0, "{fastest} m/s of plates of {half} m");
    }
}

/// A ball cut in two whose halves roll on each other and on the ground: none of it gets faster than the fall makes it, but for what
/// whips.
#[test]
fn halves_that_roll_are_not_thrown() {
    for i in 0..6 {
        let mut scene = Scene::new(params([0.0, -9.81, 0.0], Some(-1.0)));
        let material = Material {
            damping: 1.0,
            ..firm(0.5, 0.0)
        };
        let id = scene.add_body(cube_sphere(8, 0.5), &material).unwrap();
        let y = 0.013 + 0.011 * i as f32;
        let blade = scene.add_blade([[-2.0, y, -2.0], [-2.0, y + 0.1, 2.0]]);
        scene.move_blade(blade, [[2.0, y, -2.0], [2.0, y + 0.1, 2.0]]);
        let mut fastest = 0.0_f32;
        for _ in 0..240 {
            scene.step().unwrap();
            let velocities = scene.body(id).solver().velocities().iter();
            fastest = velocities.flatten().fold(fastest, |a, c| a.max(c.abs()));
        }
        assert!(fastest < 10.0, "{fastest} m/s after a cut at {y} m");
    }
}

#[test]
fn a_thickness_is_a_positive_number() {
    for thickness in [0.0, -1.0, f32::NAN] {
        let contacts = ContactParams {
            thickness,
            ..ContactParams::default()
        };
        let mut scene = Scene::new(SceneParams {
            contacts: Some(contacts),
            ..SceneParams::default()
        });
        assert!(matches!(scene.step(), Err(SceneError::BadContacts { .. })));
    }
}
