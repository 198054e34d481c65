//! Misuse of a scene: ids of other scenes, removed bodies and invalid edits are typed errors.

use incise_mesh::{Vec3, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BodyId, ContactParams, Scene, SceneError, SceneParams};
use std::collections::{BTreeSet, HashSet};

const LEFT: [[f32; 3]; 2] = [[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]];
const RIGHT: [[f32; 3]; 2] = [[2.0, 0.1, -2.0], [2.0, 0.1, 2.0]];

fn scene() -> (Scene, BodyId, BladeId) {
    let mut scene = Scene::new(SceneParams::default());
    let body = build_model(Model::Sphere80);
    let body = scene.add_body(body, &Material::default()).unwrap();
    let blade = scene.add_blade(LEFT);
    (scene, body, blade)
}

#[test]
fn ids_of_another_scene_are_errors() {
    let (mut scene, ..) = scene();
    let (_other, body, blade) = self::scene();
    let unknown = Some(SceneError::UnknownBody { body });
    assert_eq!(scene.body(body).err(), unknown);
    assert_eq!(scene.residency(body).err(), unknown);
    assert_eq!(scene.is_asleep(body).err(), unknown);
    assert_eq!(scene.wake(body).err(), unknown);
    assert_eq!(scene.read_back(body).err(), unknown);
    assert_eq!(scene.edit(body).err(), unknown);
    assert_eq!(scene.remove_body(body).err(), unknown);
    assert_eq!(scene.discard_body(body).err(), unknown);
    let pin = scene.set_pin_target(body, VertexId(0), [0.0; 3]);
    assert_eq!(pin.err(), unknown);
    let unknown = Some(SceneError::UnknownBlade { blade });
    assert_eq!(scene.blade(blade).err(), unknown);
    assert_eq!(scene.move_blade(blade, RIGHT).err(), unknown);
    assert_eq!(scene.teleport_blade(blade, RIGHT).err(), unknown);
    assert_eq!(scene.set_blade_piece(blade, None).err(), unknown);
    assert_eq!(scene.set_blade_face(blade, None).err(), unknown);
}

#[test]
fn the_id_of_a_removed_body_is_an_error() {
    let (mut scene, body, _) = scene();
    scene.remove_body(body).unwrap();
    let unknown = SceneError::UnknownBody { body };
    assert_eq!(scene.body(body).err(), Some(unknown.clone()));
    assert_eq!(scene.remove_body(body).err(), Some(unknown.clone()));
    assert_eq!(scene.discard_body(body).err(), Some(unknown.clone()));
    let text = unknown.to_string();
    assert!(text.contains("body 0 is not in this scene"), "{text}");
    scene.step().unwrap();
}

#[test]
fn ids_are_ordered_hashed_and_shown() {
    let (mut scene, first, blade) = scene();
    let second = build_model(Model::Sphere20);
    let second = scene.add_body(second, &Material::default()).unwrap();
    assert!(first < second);
    assert_eq!([first, second].map(|id| id.to_string()), ["0", "1"]);
    assert_eq!(HashSet::from([first, second, first]).len(), 2);
    assert_eq!(BTreeSet::from([blade, blade]).len(), 1);
    assert_ne!(first, self::scene().1, "ids of two scenes differ");
}

#[test]
fn a_position_that_is_not_finite_is_an_error_until_it_is_corrected() {
    let (mut scene, body, blade) = scene();
    let (_, surface) = scene.edit(body).unwrap().solver_mut();
    let before = surface.positions()[7];
    surface.positions_mut()[7][1] = f32::NAN;
    scene.move_blade(blade, RIGHT).unwrap();
    let vertex = VertexId(7);
    let error = Some(SceneError::PositionNotFinite { body, vertex });
    assert_eq!(scene.cut().err(), error);
    assert_eq!(scene.advance().err(), error);
    assert_eq!(scene.step().err(), error);
    let (_, surface) = scene.edit(body).unwrap().solver_mut();
    surface.positions_mut()[7] = before;
    assert_eq!(scene.step().unwrap().cuts, 1);
}

#[test]
fn edited_triangles_are_an_error() {
    let (mut scene, body, _) = scene();
    let (_, surface) = scene.edit(body).unwrap().solver_mut();
    let first = surface.topology().triangles().next().unwrap();
    surface.remove_triangles(&[first]);
    let error = Some(SceneError::TopologyEdited { body });
    assert_eq!(scene.cut().err(), error);
    assert_eq!(scene.advance().err(), error);
    scene.remove_body(body).unwrap();
    scene.step().unwrap();
}

#[test]
fn moved_vertices_are_cut_where_they_are() {
    let (mut scene, body, blade) = scene();
    scene.step().unwrap();
    let (_, surface) = scene.edit(body).unwrap().solver_mut();
    for p in surface.positions_mut() {
        p[1] += 50.0;
    }
    scene.move_blade(blade, RIGHT).unwrap();
    let stats = *scene.cut().unwrap();
    assert_eq!((stats.cuts, stats.missed_sweeps), (0, 1));
    let above = |[x, y, z]: [f32; 3]| [x, y + 50.0, z];
    scene.teleport_blade(blade, LEFT.map(above)).unwrap();
    scene.move_blade(blade, RIGHT.map(above)).unwrap();
    assert_eq!(scene.cut().unwrap().cuts, 1);
}

#[test]
fn a_sweep_that_misses_is_reported() {
    let (mut scene, body, blade) = scene();
    scene
        .move_blade(blade, LEFT.map(|[x, y, z]| [x, y + 1.0, z]))
        .unwrap();
    let stats = *scene.cut().unwrap();
    assert_eq!((stats.sweeps, stats.missed_sweeps, stats.cuts), (1, 1, 0));
    let [missed] = scene.cuts() else {
        panic!("one sweep, not {:?}", scene.cuts());
    };
    assert!(missed.blade == blade && missed.cut.is_none());
    scene.teleport_blade(blade, LEFT).unwrap();
    scene.move_blade(blade, RIGHT).unwrap();
    let stats = *scene.cut().unwrap();
    assert_eq!((stats.sweeps, stats.missed_sweeps, stats.cuts), (1, 0, 1));
    let (cut, _) = scene.cuts()[0].cut.as_ref().unwrap();
    assert_eq!(*cut, body);
    // A blade at rest makes no sweep, so it misses nothing.
    assert_eq!(scene.cut().unwrap().missed_sweeps, 0);
    assert!(scene.cuts().is_empty());
}

#[test]
fn a_blade_face_that_is_not_finite_is_an_error() {
    let mut scene = Scene::new(SceneParams::default());
    let blade = scene.add_blade([[-2.0, 0.1, -2.0], [-2.0, 0.1, 2.0]]);
    for face in [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 1.0]] {
        let error = scene.set_blade_face(blade, Some(face));
        assert!(
            matches!(error, Err(SceneError::BladeFaceNotFinite { .. })),
            "{error:?}"
        );
    }
    assert_eq!(
        scene.blade(blade).unwrap().face,
        None,
        "the face is unchanged"
    );
}

#[test]
fn poses_and_rays_that_are_not_finite_are_refused_at_once() {
    let (mut scene, body, blade) = scene();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let bad = [[0.0; 3], [0.0, value, 0.0]];
        for refused in [
            scene.move_blade(blade, bad),
            scene.teleport_blade(blade, bad),
        ] {
            let text = refused.unwrap_err().to_string();
            assert!(
                text.contains("edge") && text.contains(&value.to_string()),
                "{text}"
            );
        }
        let far = Vec3::new(0.0, f64::from(value), 0.0);
        for (origin, direction, name) in [
            (far, Vec3::x(), "origin"),
            (Vec3::zeros(), far, "direction"),
        ] {
            let text = scene
                .cast_ray(body, origin, direction)
                .unwrap_err()
                .to_string();
            assert!(text.contains(name), "{text}");
        }
    }
    assert_eq!(scene.blade(blade).unwrap().edge(), LEFT, "it has not moved");
}

#[test]
fn all_parameters_are_checked_on_request() {
    let valid = SceneParams::default();
    assert_eq!(valid.check(), Ok(()));
    let text = |change: fn(&mut SceneParams)| {
        let mut params = valid;
        change(&mut params);
        params.check().unwrap_err().to_string()
    };
    assert!(text(|p| p.dt = f32::NAN).contains("dt is NaN"));
    assert!(text(|p| p.solver.gravity[1] = f32::NAN).contains("gravity"));
    assert!(text(|p| p.solver.substep = Some(0.0)).contains("substep"));
    assert!(text(|p| p.cut.refine.grading = f64::NAN).contains("grading"));
    assert!(text(|p| p.cut.cap_uv_scale = f64::NAN).contains("cap_uv_scale"));
    let thick = ContactParams {
        thickness: f32::NAN,
        ..ContactParams::default()
    };
    let contacts = SceneParams {
        contacts: Some(thick),
        ..valid
    };
    let text = contacts.check().unwrap_err().to_string();
    assert!(text.contains("thickness"), "{text}");
}
