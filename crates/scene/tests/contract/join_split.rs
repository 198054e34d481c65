//! Bodies are joined, split and moved to another scene with their motion.

use incise_mesh::{Blend, Channel, Domain, Surface, VertexId, cube_sphere, icosphere};
use incise_pbd_gpu::{Density, Material};
use incise_scene::{Body, BodyId, Scene, SceneError, SceneParams};

fn edge(x: f32, y: f32) -> [[f32; 3]; 2] {
    [[x, y, -2.0], [x, y, 2.0]]
}

/// Returns a scene with a ball that turns, hangs at a pin, falls and is cut in three.
fn cut_in_flight() -> (Scene, BodyId) {
    let mut scene = Scene::new(SceneParams::default());
    // The energy budget of a body is common to its pieces.
    scene.params.solver.conserve = false;
    let id = scene
        .add_body(icosphere(3, 0.5), &Material::default())
        .unwrap();
    let (solver, surface) = scene.edit(id).unwrap().solver_mut();
    for i in 0..surface.positions().len() {
        let [x, y, ..] = surface.positions()[i];
        let v = VertexId::from_index(i);
        solver.set_velocity(v, [-3.0 * y, 3.0 * x, 0.2]).unwrap();
    }
    solver.pin(surface, VertexId(7)).unwrap();
    let blades = [0.2, -0.2].map(|y| scene.add_blade(edge(-2.0, y)));
    for _ in 0..5 {
        scene.step().unwrap();
    }
    for (blade, y) in blades.into_iter().zip([0.2, -0.2]) {
        scene.move_blade(blade, edge(2.0, y)).unwrap();
    }
    scene.step().unwrap();
    let pieces = scene.body(id).unwrap().pieces();
    assert_eq!(pieces.len(), 3, "pieces");
    (scene, id)
}

/// Mass \[kg\], momentum \[N s\], angular momentum \[N m s\] and volume \[m^3\] of all bodies.
fn totals(scene: &Scene) -> Vec<f64> {
    let mut sums = vec![0.0; 8];
    for id in scene.bodies() {
        let body = scene.body(id).unwrap();
        let (solver, surface) = (body.solver(), body.surface());
        let own = [solver.total_mass()].into_iter().chain(solver.momentum());
        let own = own.chain(solver.angular_momentum(surface, [0.0; 3]));
        for (sum, own) in sums.iter_mut().zip(own.chain([surface.volume()])) {
            *sum += own;
        }
    }
    sums
}

fn assert_close(a: &[f64], b: &[f64], bound: f64) {
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() < bound, "sum {i}: {a} and {b}");
    }
}

/// Returns the bits of positions and velocities of all used vertices, in order.
fn bits(body: &Body) -> Vec<[u32; 6]> {
    let (solver, surface) = (body.solver(), body.surface());
    let row = |v: VertexId| {
        let [x, y, z, _] = surface.positions()[v.index()];
        let [u, v, w] = solver.velocity(v);
        [x, y, z, u, v, w].map(f32::to_bits)
    };
    surface.topology().vertices().map(row).collect()
}

#[test]
fn a_split_keeps_everything_that_moves() {
    let (mut scene, id) = cut_in_flight();
    let (mut whole, _) = cut_in_flight();
    let before = totals(&scene);
    let parts = scene.split_body(id).unwrap();
    assert_eq!(scene.bodies().collect::<Vec<_>>(), parts);
    assert_eq!(
        scene.body(id).unwrap_err(),
        SceneError::UnknownBody { body: id }
    );
    assert_close(&before, &totals(&scene), 1e-9);
    let pins = parts
        .iter()
        .map(|&id| scene.body(id).unwrap().solver().pins());
    let pins: Vec<_> = pins.flatten().collect();
    let old = whole.bodies().next().unwrap();
    let old = whole.body(old).unwrap().solver().pins()[0].target;
    assert_eq!((pins.len(), pins[0].target), (1, old));
    for _ in 0..5 {
        scene.step().unwrap();
        whole.step().unwrap();
    }
    // The order of projections differs, but not the motion.
    assert_close(&totals(&scene), &totals(&whole), 2e-2);
    for id in parts {
        let body = scene.body(id).unwrap();
        body.surface().validate_closed().unwrap();
        body.solver().validate(body.surface()).unwrap();
        assert_eq!(scene.split_body(id).unwrap(), [id], "one piece stays");
    }
}

#[test]
fn a_join_of_parts_is_undone_by_a_split() {
    let (mut scene, id) = cut_in_flight();
    let parts = scene.split_body(id).unwrap();
    let before = totals(&scene);
    let of = |scene: &Scene, ids: &[BodyId]| -> Vec<_> {
        ids.iter()
            .map(|&id| bits(scene.body(id).unwrap()))
            .collect()
    };
    let moving = of(&scene, &parts);
    let joined = scene.join_bodies(&parts).unwrap();
    assert_eq!(scene.bodies().collect::<Vec<_>>(), [joined]);
    assert_close(&before, &totals(&scene), 1e-9);
    let body = scene.body(joined).unwrap();
    body.surface().validate_closed().unwrap();
    body.solver().validate(body.surface()).unwrap();
    assert_eq!(body.solver().pins().len(), 1);
    let again = scene.split_body(joined).unwrap();
    assert_eq!(of(&scene, &again), moving);
    // Joined bodies are cut as one.
    let joined = scene.join_bodies(&again).unwrap();
    let blade = scene.add_blade([[-2.0, -2.0, 0.05], [2.0, -2.0, 0.05]]);
    scene.step().unwrap();
    let to = [[-2.0, 2.0, 0.05], [2.0, 2.0, 0.05]];
    scene.move_blade(blade, to).unwrap();
    scene.step().unwrap();
    assert_eq!(scene.body(joined).unwrap().pieces().len(), 6);
    assert_eq!(scene.failed_cuts().len(), 0);
}

#[test]
fn a_body_goes_on_in_another_scene_with_the_same_bits() {
    let (mut own, id) = cut_in_flight();
    let (mut old, old_id) = cut_in_flight();
    let body = old.remove_body(old_id).unwrap();
    let mut other = Scene::new(own.params);
    let moved = other.insert_body(body).unwrap();
    for _ in 0..30 {
        own.step().unwrap();
        other.step().unwrap();
    }
    assert_eq!(
        bits(own.body(id).unwrap()),
        bits(other.body(moved).unwrap())
    );
}

#[test]
fn refused_joins_change_nothing() {
    let mut scene = Scene::new(SceneParams::default());
    let channel = |surface: &mut Surface, width: usize| {
        let values = vec![0.5; width * surface.topology().vertex_slots()];
        let heat = Channel::new("heat", Domain::Vertex, Blend::Linear, width, values);
        surface.set_channel(heat.unwrap()).unwrap();
    };
    let add = |scene: &mut Scene, width: usize, density: f32| {
        let mut surface = cube_sphere(3, 0.3);
        channel(&mut surface, width);
        let material = Material {
            density: Density::Area(density),
            ..Material::default()
        };
        scene.add_body(surface, &material).unwrap()
    };
    let [a, b, c] = [(1, 1000.0), (1, 500.0), (2, 1000.0)].map(|(w, d)| add(&mut scene, w, d));
    let removed = add(&mut scene, 1, 1000.0);
    scene.remove_body(removed).unwrap();
    let before: Vec<_> = scene
        .bodies()
        .map(|id| bits(scene.body(id).unwrap()))
        .collect();
    let cannot =
        |result: Result<BodyId, SceneError>| matches!(result, Err(SceneError::CannotJoin { .. }));
    assert_eq!(scene.join_bodies(&[]), Err(SceneError::NothingToJoin));
    assert!(cannot(scene.join_bodies(&[a, a])), "listed twice");
    assert!(cannot(scene.join_bodies(&[a, b])), "two densities");
    let channels = scene.join_bodies(&[a, c]);
    assert!(
        matches!(channels, Err(SceneError::Channel(_))),
        "{channels:?}"
    );
    let unknown = scene.join_bodies(&[a, removed]);
    assert_eq!(unknown, Err(SceneError::UnknownBody { body: removed }));
    assert_eq!(scene.join_bodies(&[a]), Ok(a));
    let after: Vec<_> = scene
        .bodies()
        .map(|id| bits(scene.body(id).unwrap()))
        .collect();
    assert_eq!(before, after);
}
