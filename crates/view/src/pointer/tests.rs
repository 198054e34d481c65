//! Tests of pointer gestures and the orbit camera, without a window.

use super::*;
use crate::command::Settings;
use incise_mesh::{Surface, icosphere};
use incise_scene::{Scene, SceneParams};

fn set_up() -> (Session, OrbitCamera) {
    set_up_with(Settings::default())
}

fn set_up_with(settings: Settings) -> (Session, OrbitCamera) {
    let scene = Scene::new(SceneParams::default());
    let session = Session::with_settings(icosphere(2, 0.5), scene, settings).unwrap();
    let mut orbit = OrbitCamera {
        camera: Camera::from_angles(0.3, 0.2),
        size: [800, 600],
        panel_width: 200.0,
    };
    orbit.fit(&session.surface().bounds());
    (session, orbit)
}

/// Presses the left button, moves in 20 steps with a frame each, and releases.
fn drag(
    pointer: &mut Pointer,
    shift: bool,
    way: [[f64; 2]; 2],
    orbit: &mut OrbitCamera,
    session: &mut Session,
) {
    pointer.move_to(way[0], orbit, session).unwrap();
    pointer.press(Button::Left, shift, orbit, session).unwrap();
    for i in 1..=20 {
        let t = f64::from(i) / 20.0;
        let at = [0, 1].map(|k| way[0][k] + t * (way[1][k] - way[0][k]));
        pointer.move_to(at, orbit, session).unwrap();
        session.frame();
    }
    pointer.release(Button::Left, orbit, session).unwrap();
}

/// Asserts that a body, once of fewer triangles and this volume, is slit and still one piece.
fn assert_is_slit(surface: &Surface, triangles: usize, volume: f64) {
    assert_eq!(surface.piece_count(), 1);
    assert!(surface.topology().triangle_count() > triangles);
    assert!(surface.topology().is_closed());
    assert!((surface.volume() / volume - 1.0).abs() < 0.02);
}

#[test]
fn fit_centers_the_body_beside_the_panel() {
    let (session, orbit) = set_up();
    let center = session.surface().bounds().center();
    let [x, y] = orbit.window_camera().project(center, orbit.size).unwrap();
    assert!(
        (x - 300.0).abs() < 1.0 && (y - 300.0).abs() < 1.0,
        "{x} {y}"
    );
    let ray = orbit.ray([300.0, 300.0]);
    let off = (center - ray.origin).cross(&ray.direction).norm();
    assert!(off < 1e-3, "{off}");
}

#[test]
fn slice_line_cuts_along_itself() {
    let (mut session, mut orbit) = set_up_with(Settings {
        material: incise_models::scenes::sprung(),
        ..Settings::default()
    });
    let mut pointer = Pointer::default();
    let way = [[20.0, 280.0], [580.0, 330.0]];
    drag(&mut pointer, false, way, &mut orbit, &mut session);
    assert_eq!(session.surface().piece_count(), 2);
    // All corners of the section project to the line.
    session.apply(Command::Undo);
    session.apply(Command::Redo);
    let surface = session.surface();
    let caps = surface
        .topology()
        .triangles()
        .filter(|&t| surface.material(t) == 1);
    let mut corners = 0;
    for v in caps.flat_map(|t| surface.topology().triangle(t)) {
        let [x, y] = orbit
            .window_camera()
            .project(surface.position(v), orbit.size)
            .unwrap();
        let on_line = 280.0 + (x - 20.0) * 50.0 / 560.0;
        assert!((y - on_line).abs() < 0.5, "{y} is not {on_line}");
        corners += 1;
    }
    assert!(corners > 30, "{corners}");
}

#[test]
fn short_line_of_full_slices_cuts_only_with_shift() {
    let way = [[280.0, 300.0], [320.0, 300.0]];
    for (shift, pieces) in [(false, 1), (true, 2)] {
        let (mut session, mut orbit) = set_up();
        session.apply(Command::Set(Settings {
            progressive: false,
            ..Settings::default()
        }));
        drag(
            &mut Pointer::default(),
            shift,
            way,
            &mut orbit,
            &mut session,
        );
        assert_eq!(session.surface().piece_count(), pieces, "shift {shift}");
        assert_eq!(session.status_message().is_some(), !shift);
    }
    let (mut session, mut orbit) = set_up();
    let click = [[300.0, 300.0], [302.0, 300.0]];
    drag(
        &mut Pointer::default(),
        true,
        click,
        &mut orbit,
        &mut session,
    );
    assert!(session.status_message().is_none(), "a click draws no line");
}

#[test]
fn line_that_ends_inside_slits_the_body() {
    let (mut session, mut orbit) = set_up();
    let mut settings = Settings::default();
    settings.scene.solver.gravity = [0.0; 3];
    session.apply(Command::Set(settings));
    let volume = session.surface().volume();
    for way in [
        [[20.0, 300.0], [300.0, 300.0]],
        [[280.0, 200.0], [320.0, 220.0]],
    ] {
        let triangles = session.surface().topology().triangle_count();
        let mut pointer = Pointer::default();
        drag(&mut pointer, false, way, &mut orbit, &mut session);
        assert_eq!(session.status_message(), None);
        assert_is_slit(session.surface(), triangles, volume);
    }
    assert_eq!(session.undo_count(), 2);
    session.frame();
    session.apply(Command::Undo);
    session.apply(Command::Undo);
    assert_eq!((session.undo_count(), session.redo_count()), (0, 2));
}

#[test]
fn blade_dragged_through_the_body_cuts() {
    let (mut session, mut orbit) = set_up();
    let mut pointer = Pointer {
        tool: Tool::Blade,
        ..Pointer::default()
    };
    let way = [[20.0, 300.0], [580.0, 300.0]];
    drag(&mut pointer, false, way, &mut orbit, &mut session);
    assert_eq!(session.surface().piece_count(), 2);
    assert_eq!(session.held_blade(), None, "the stroke ended");
}

#[test]
fn blade_dragged_into_the_body_opens_it() {
    let (mut session, mut orbit) = set_up();
    let mut settings = Settings::default();
    settings.scene.solver.gravity = [0.0; 3];
    session.apply(Command::Set(settings));
    let mut pointer = Pointer {
        tool: Tool::Blade,
        ..Pointer::default()
    };
    let volume = session.surface().volume();
    let triangles = session.surface().topology().triangle_count();
    pointer
        .move_to([20.0, 300.0], &mut orbit, &mut session)
        .unwrap();
    pointer
        .press(Button::Left, false, &orbit, &mut session)
        .unwrap();
    let mut cuts = 0;
    for i in 1..=20 {
        let at = [20.0 + 14.0 * f64::from(i), 300.0];
        pointer.move_to(at, &mut orbit, &mut session).unwrap();
        session.frame();
        cuts += session.last_frame().stats.cuts;
    }
    assert!(cuts > 1, "it opens while the button is down: {cuts} cuts");
    pointer.release(Button::Left, &orbit, &mut session).unwrap();
    assert_eq!(session.status_message(), None);
    assert_is_slit(session.surface(), triangles, volume);
    assert_eq!(session.undo_count(), 1);
}

#[test]
fn grabbed_vertex_follows_the_pointer() {
    let (mut session, mut orbit) = set_up();
    let mut pointer = Pointer {
        tool: Tool::Grab,
        ..Pointer::default()
    };
    pointer
        .move_to([300.0, 250.0], &mut orbit, &mut session)
        .unwrap();
    pointer
        .press(Button::Left, false, &orbit, &mut session)
        .unwrap();
    let v = session.held_vertex().expect("the ball is there");
    for _ in 0..40 {
        pointer
            .move_to([200.0, 100.0], &mut orbit, &mut session)
            .unwrap();
        session.frame();
    }
    let at = orbit
        .window_camera()
        .project(session.surface().position(v), orbit.size)
        .unwrap();
    assert!(
        (at[0] - 200.0).abs() < 1.0 && (at[1] - 100.0).abs() < 1.0,
        "{at:?}"
    );
    pointer.cancel(&mut session);
    assert_eq!(session.held_vertex(), None);
    // Outside of the body the view rotates.
    let before = orbit;
    let aside = [[30.0, 30.0], [60.0, 30.0]];
    drag(&mut pointer, false, aside, &mut orbit, &mut session);
    assert_ne!(orbit, before);
    pointer.tool = Tool::Pin;
    pointer
        .move_to([300.0, 300.0], &mut orbit, &mut session)
        .unwrap();
}

#[test]
fn view_rotates_pans_and_zooms() {
    let (mut session, mut orbit) = set_up();
    let start = orbit;
    let mut pointer = Pointer::default();
    pointer
        .press(Button::Right, false, &orbit, &mut session)
        .unwrap();
    pointer
        .move_to([100.0, 1e6], &mut orbit, &mut session)
        .unwrap();
    // Another button does nothing while one is down.
    pointer
        .press(Button::Left, false, &orbit, &mut session)
        .unwrap();
    pointer.release(Button::Left, &orbit, &mut session).unwrap();
    assert!(pointer.is_dragging());
    pointer
        .release(Button::Right, &orbit, &mut session)
        .unwrap();
    assert!(orbit.camera.azimuth < start.camera.azimuth);
    assert_eq!(orbit.camera.elevation, MAX_ELEVATION);
    let mut orbit = start;
    let center = Vec3::from(orbit.camera.target);
    pointer
        .move_to([300.0, 300.0], &mut orbit, &mut session)
        .unwrap();
    pointer
        .press(Button::Middle, false, &orbit, &mut session)
        .unwrap();
    pointer
        .move_to([340.0, 280.0], &mut orbit, &mut session)
        .unwrap();
    pointer
        .release(Button::Middle, &orbit, &mut session)
        .unwrap();
    let [x, y] = orbit.window_camera().project(center, orbit.size).unwrap();
    assert!(
        (x - 340.0).abs() < 0.5 && (y - 280.0).abs() < 0.5,
        "it goes with the pointer: {x} {y}"
    );
    orbit.zoom(2.0);
    assert!(orbit.camera.distance < start.camera.distance);
    for _ in 0..1000 {
        orbit.zoom(20.0);
    }
    assert!(orbit.camera.distance > 0.0);
}
