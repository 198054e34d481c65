//! Contacts of the walls of an incision: it gapes under tension and stays shut under pressure.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, VertexId, cube_sphere};
use incise_pbd_gpu::{InteriorSprings, Material, Stiffness, Volume};
use incise_scene::{BodyId, ContactParams, Scene, SceneParams};
use std::collections::BTreeMap;

/// Mean edge length of the ball \[m\].
const EDGE: f64 = 0.05;

/// A soft ball of radius 0.5 m, slit from above to its center in the plane x = 0.01 m.
fn slit_ball(contacts: Option<ContactParams>) -> (Scene, BodyId) {
    let mut ball = cube_sphere(12, 0.5);
    let pose = |y: f32| [[0.01, y, -0.7], [0.01, y, 0.7]];
    let sweep = Sweep::new(pose(0.7), pose(0.005)).unwrap();
    let mut cutter = Cutter::new(&ball);
    let _ = (cutter.incise(&mut ball, &sweep, &CutParams::default())).unwrap();
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        volume: Some(Volume::default()),
        interior_springs: Some(InteriorSprings {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-4),
        }),
        damping: 4.0,
        ..Material::default()
    };
    let mut scene = Scene::new(SceneParams {
        contacts,
        ..SceneParams::default()
    });
    scene.params.solver.gravity = [0.0; 3];
    scene.params.solver.substep = Some(1.0 / 960.0);
    let body = scene.add_body(ball, &material).unwrap();
    (scene, body)
}

/// Moves the left and the right end of the ball apart, together for a negative distance \[m\].
fn pull(scene: &mut Scene, body: BodyId, distance: f32) {
    let (solver, surface) = scene.edit(body).unwrap().solver_mut();
    let ends: Vec<VertexId> = (surface.topology().vertices())
        .filter(|&v| surface.position(v).x.abs() > 0.4)
        .collect();
    for &v in &ends {
        solver.pin(surface, v).unwrap();
    }
    let start: Vec<[f32; 4]> = (ends.iter())
        .map(|v| surface.positions()[v.index()])
        .collect();
    for frame in 1u16..=60 {
        for (&v, &[x, y, z, _]) in ends.iter().zip(&start) {
            let x = x + 0.5 * distance * x.signum() * f32::from(frame) / 60.0;
            scene.set_pin_target(body, v, [x, y, z]).unwrap();
        }
        scene.step().unwrap();
    }
    for _ in 0..60 {
        scene.step().unwrap();
    }
}

/// Returns the smallest and the largest width of the slit at its vertices \[m\].
///
/// It is negative where the walls have passed through each other.
fn width(surface: &Surface) -> [f64; 2] {
    let is_wall = |t: &TriangleId| surface.material(*t) == CutParams::default().cap_material;
    let mut sides: BTreeMap<[u64; 3], BTreeMap<VertexId, bool>> = BTreeMap::new();
    for t in surface.topology().triangles().filter(is_wall) {
        let [a, b, c] = surface
            .topology()
            .triangle(t)
            .map(|v| surface.rest_position(v));
        let is_right = (b - a).cross(&(c - a)).x < 0.0;
        for v in surface.topology().triangle(t) {
            let rest = surface.rest_position(v);
            let key = [rest.x, rest.y, rest.z].map(f64::to_bits);
            sides.entry(key).or_default().insert(v, is_right);
        }
    }
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for pair in sides.values().filter(|pair| pair.len() == 2) {
        let x = |side: bool| pair.iter().find(|(_, is_right)| **is_right == side);
        if let (Some((left, _)), Some((right, _))) = (x(false), x(true)) {
            let width = surface.position(*right).x - surface.position(*left).x;
            range = [range[0].min(width), range[1].max(width)];
        }
    }
    assert!(range[0] <= range[1], "walls have partners");
    range
}

fn touching() -> Option<ContactParams> {
    Some(ContactParams {
        self_collision: true,
        ..ContactParams::default()
    })
}

#[test]
fn walls_at_rest_stay_where_they_are() {
    let (mut scene, body) = slit_ball(touching());
    for _ in 0..60 {
        scene.step().unwrap();
    }
    let [low, high] = width(scene.body(body).unwrap().surface());
    assert!(low > -0.01 * EDGE && high < 0.1 * EDGE, "{low} to {high} m");
}

#[test]
fn a_slit_under_tension_gapes() {
    let (mut scene, body) = slit_ball(touching());
    pull(&mut scene, body, 0.1);
    let [low, high] = width(scene.body(body).unwrap().surface());
    assert!(low > -0.1 * EDGE && high > EDGE, "{low} to {high} m");
}

#[test]
fn a_slit_under_pressure_stays_shut() {
    let depth = |contacts| {
        let (mut scene, body) = slit_ball(contacts);
        pull(&mut scene, body, -0.1);
        width(scene.body(body).unwrap().surface())
    };
    let [without, _] = depth(None);
    let [low, high] = depth(touching());
    assert!(without < -EDGE, "walls without contacts pass: {without} m");
    assert!(low > -0.1 * EDGE && high < EDGE, "{low} to {high} m");
}
