use super::*;
use crate::mesh::Mesh;

/// Returns a parameter by name.
fn value(name: &str, value: Value) -> Value {
    Value::Map(vec![(name.to_owned(), value)])
}

/// Returns gravity along y.
fn gravity(y: f64) -> Value {
    value(
        "gravity",
        Value::List([0.0, y, 0.0].map(Value::Number).to_vec()),
    )
}

/// Returns a scene without gravity that holds a sphere and a blade in front of it.
fn scene() -> (Scene, f64, f64) {
    let mut scene = Scene::new();
    scene.set(&gravity(0.0)).unwrap();
    let ball = Mesh::model("Sphere768").unwrap();
    let body = scene.add_body(&ball, &Value::None).unwrap();
    let blade = scene.add_blade(&[-2.0, 0.0, -2.0, -2.0, 0.0, 2.0]).unwrap();
    (scene, body.into(), blade.into())
}

const BEHIND: [f32; 6] = [2.0, 0.01, -2.0, 2.0, 0.01, 2.0];

#[test]
fn a_blade_cuts_a_body_in_two_and_undo_joins_it() {
    let (mut scene, body, blade) = scene();
    let skin = scene.buffers(body).unwrap().skin_indices().len();
    scene.move_blade(blade, &BEHIND).unwrap();
    scene.step().unwrap();
    assert_eq!((scene.cuts(), scene.piece_count(body).unwrap()), (1, 2));
    assert_eq!(scene.revision(body).unwrap(), 1);
    assert!(!scene.buffers(body).unwrap().cap_indices().is_empty());
    scene.undo().unwrap();
    assert_eq!(scene.piece_count(body).unwrap(), 1);
    let again = scene.buffers(body).unwrap().skin_indices().len();
    assert_eq!(again, skin);
    assert!(scene.buffers(body).unwrap().cap_indices().is_empty());
    assert!(matches!(scene.undo(), Err(WebError::NothingToUndo)));
}

#[test]
fn a_full_slice_that_ends_inside_is_refused_and_a_progressive_one_is_not() {
    let inside = [0.0, 0.0, -2.0, 0.0, 0.0, 2.0];
    let (mut scene, body, blade) = scene();
    scene.set_full_slices(blade, true).unwrap();
    scene.move_blade(blade, &inside).unwrap();
    scene.step().unwrap();
    assert_eq!(scene.cuts(), 0);
    assert!(scene.failed_cuts()[0].contains("ends inside the body"));
    scene.set_full_slices(blade, false).unwrap();
    scene
        .teleport_blade(blade, &[-2.0, 0.0, -2.0, -2.0, 0.0, 2.0])
        .unwrap();
    scene.move_blade(blade, &inside).unwrap();
    scene.step().unwrap();
    assert_eq!((scene.cuts(), scene.piece_count(body).unwrap()), (1, 1));
    assert_eq!(scene.undo_count(), 1);
}

#[test]
fn an_incision_tells_where_its_blade_is() {
    let (mut scene, body, blade) = scene();
    let state = |scene: &Scene| scene.incision(blade, body).unwrap().state;
    assert_eq!(state(&scene), IncisionState::Outside);
    let edge = |x, y| [x, y, -2.0, x, y, 2.0];
    let move_to = |scene: &mut Scene, x, y, expected| {
        scene.move_blade(blade, &edge(x, y)).unwrap();
        scene.step().unwrap();
        assert_eq!(state(scene), expected, "{x}, {y}");
        assert_eq!(scene.incision(blade, body).unwrap().refused_steps, 0);
    };
    move_to(&mut scene, 0.0, 0.0, IncisionState::Inside);
    move_to(&mut scene, 2.0, 0.0, IncisionState::Finished);
    scene.teleport_blade(blade, &edge(-2.0, 0.2)).unwrap();
    assert_eq!(state(&scene), IncisionState::Outside);
    move_to(&mut scene, 0.0, 0.2, IncisionState::Inside);
    move_to(&mut scene, -1.5, 1.2, IncisionState::Abandoned);
    assert!(scene.incision(9.0, body).is_err() && scene.incision(blade, f64::NAN).is_err());
}

#[test]
fn a_dragged_vertex_follows_and_is_released() {
    let (mut scene, body, _) = scene();
    let hit = scene.pick(body, &[0.0, 0.0, 5.0], &[0.0, 0.0, -1.0]);
    let vertex = hit.unwrap().expect("the ray hits the body").vertex;
    scene.grab(body, vertex.into()).unwrap();
    let mesh = scene.mesh(body).unwrap();
    let [x, y, z, _] = mesh.surface().positions()[vertex as usize];
    scene.drag(x, y + 0.02, z).unwrap();
    scene.step().unwrap();
    let moved = scene.mesh(body).unwrap();
    let moved = moved.surface().positions()[vertex as usize];
    // The nodes of a solid carry the vertex, up to rounding.
    let off = |k: usize| (moved[k] - [x, y + 0.02, z][k]).abs();
    assert!((0..3).all(|k| off(k) < 1e-6), "{moved:?}");
    scene.release().unwrap();
    scene.step().unwrap();
    let free = scene.mesh(body).unwrap();
    assert!(
        free.surface().positions()[vertex as usize][3] > 0.0,
        "it has a mass again"
    );
}

#[test]
fn unknown_numbers_and_hostile_values_are_errors() {
    let (mut scene, body, blade) = scene();
    assert!(scene.mesh(7.0).is_err() && scene.positions(4294967296.0).is_err());
    assert!(scene.move_blade(9.0, &BEHIND).is_err());
    assert!(scene.move_blade(blade, &[0.0; 5]).is_err());
    assert!(scene.grab(body, f64::NAN).is_err() && scene.grab(body, 1048576.0).is_err());
    assert!(scene.drag(f32::NAN, 0.0, 0.0).is_err());
    assert!(scene.drag(0.0, 0.0, 0.0).is_ok(), "no vertex is grabbed");
    for number in [f64::NAN, 0.5, -1.0, 4294967296.0] {
        let text = scene.mesh(number).unwrap_err().to_string();
        assert!(text.contains(&format!("no body {number};")), "{text}");
        assert!(scene.buffers(number).is_err() && scene.revision(number).is_err());
        assert!(scene.remove_body(number).is_err() && scene.move_blade(number, &BEHIND).is_err());
    }
    let nan = [f64::NAN; 3];
    assert!(scene.pick(body, &nan, &[1.0; 3]).is_err());
    assert!(scene.pick(body, &[1.0; 3], &nan).is_err());
    assert!(scene.pick(body, &[0.0; 3], &[0.0; 3]).is_ok());
    scene.grab(body, 0.0).unwrap();
    assert!(scene.drag(f32::NAN, 0.0, 0.0).is_err());
    let nan = [f32::NAN; 6];
    assert!(scene.move_blade(blade, &nan).is_err() && scene.teleport_blade(blade, &nan).is_err());
    assert!(scene.add_blade(&nan).is_err());
    for bad in [f64::NAN, f64::INFINITY] {
        for name in ["dt", "residual", "substep"] {
            assert!(
                scene.set(&value(name, Value::Number(bad))).is_err(),
                "{name}"
            );
        }
        assert!(scene.set(&gravity(bad)).is_err());
    }
    for (name, all) in [
        ("substep", &[-1.0, 0.0][..]),
        ("iterations", &[-1.0, 0.0, 0.5]),
    ] {
        for &bad in all {
            assert!(
                scene.set(&value(name, Value::Number(bad))).is_err(),
                "{name}"
            );
        }
    }
    assert_eq!(
        scene.get("substep").unwrap(),
        Value::Number(0.001_388_888_9)
    );
    assert_eq!(scene.get("residual").unwrap(), Value::None);
    scene
        .set(&value("substep", Value::Number(1.0 / 60.0)))
        .unwrap();
    scene.step().unwrap();
    assert!(scene.failed_cuts().is_empty());
    scene.remove_body(body).unwrap();
    assert!(scene.remove_body(body).is_err() && scene.drag(0.0, 0.0, 0.0).is_ok());
    scene.step().unwrap();
}

#[test]
fn parameters_are_read_back() {
    let mut scene = Scene::new();
    let values = [
        ("residual".to_owned(), Value::Number(0.5)),
        ("level".to_owned(), Value::from("2x-finer")),
        ("threads".to_owned(), Value::Count(4)),
    ];
    scene.set(&Value::Map(values.to_vec())).unwrap();
    assert_eq!(scene.get("residual").unwrap(), Value::Number(0.5));
    assert_eq!(scene.get("level").unwrap(), Value::from("2x-finer"));
    assert_eq!(scene.get("threads").unwrap(), Value::Count(1));
    let before = scene.get("caps").unwrap();
    for bad in [
        value("level", Value::from("finest")),
        value("caps", Value::from("")),
        value("floor", Value::Number(0.0)),
    ] {
        assert!(scene.set(&bad).is_err(), "{bad}");
    }
    assert_eq!(
        scene.get("caps").unwrap(),
        before,
        "an error changes nothing"
    );
}

#[test]
fn a_loaded_scene_has_the_numbers_of_the_saved_one_and_its_bits() {
    let (mut scene, body, blade) = scene();
    scene.remove_body(body).unwrap();
    let ball = Mesh::model("Sphere80").unwrap();
    let body = f64::from(scene.add_body(&ball, &Value::None).unwrap());
    scene.move_blade(blade, &BEHIND).unwrap();
    scene.step().unwrap();
    let mut loaded = Scene::from_bytes(&scene.save().unwrap()).unwrap();
    assert_eq!(
        (loaded.undo_count(), loaded.piece_count(body).unwrap()),
        (0, 2)
    );
    assert!(loaded.mesh(body - 1.0).is_err());
    for each in [&mut scene, &mut loaded] {
        each.move_blade(blade, &[-2.0, 0.1, -2.0, -2.0, 0.1, 2.0])
            .unwrap();
        each.step().unwrap();
    }
    let positions = |scene: &Scene| scene.mesh(body).unwrap().surface().positions().to_vec();
    assert_eq!(positions(&scene), positions(&loaded));
    assert_eq!(
        f64::from(loaded.add_body(&ball, &Value::None).unwrap()),
        body + 1.0
    );
    loaded.remove_body(body + 1.0).unwrap();
    let mut again = Scene::from_bytes(&loaded.save().unwrap()).unwrap();
    let next = f64::from(again.add_body(&ball, &Value::None).unwrap());
    assert_eq!(
        next,
        body + 2.0,
        "the number of a removed body is not used again"
    );
    assert!(Scene::from_bytes(&[0; 9]).is_err());
}
