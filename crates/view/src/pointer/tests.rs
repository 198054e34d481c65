//! Gestures without a window.

use super::*;
use incise_mesh::icosphere;
use incise_scene::{Scene, SceneParams};

fn set_up() -> (Session, Eye) {
    let scene = Scene::new(SceneParams::default());
    let session = Session::new(icosphere(2, 0.5), scene).unwrap();
    let mut eye = Eye {
        camera: Camera::looking(0.3, 0.2),
        size: [800, 600],
        covered: 200.0,
    };
    eye.fit(&session.surface().bounds());
    (session, eye)
}

/// Presses, goes there in steps and lets go.
fn drag(
    pointer: &mut Pointer,
    shift: bool,
    way: [[f64; 2]; 2],
    eye: &mut Eye,
    session: &mut Session,
) {
    pointer.go(way[0], eye, session).unwrap();
    pointer.press(Button::Left, shift, eye, session).unwrap();
    for i in 1..=20 {
        let t = f64::from(i) / 20.0;
        let at = [0, 1].map(|k| way[0][k] + t * (way[1][k] - way[0][k]));
        pointer.go(at, eye, session).unwrap();
        session.frame();
    }
    pointer.release(Button::Left, eye, session).unwrap();
}

#[test]
fn the_body_is_in_the_middle_of_what_is_not_covered() {
    let (session, eye) = set_up();
    let center = session.surface().bounds().center();
    let [x, y] = eye.shown().project(center, eye.size).unwrap();
    assert!(
        (x - 300.0).abs() < 1.0 && (y - 300.0).abs() < 1.0,
        "{x} {y}"
    );
    let ray = eye.ray([300.0, 300.0]);
    let off = (center - ray.origin).cross(&ray.direction).norm();
    assert!(off < 1e-3, "{off}");
}

#[test]
fn a_line_across_the_view_cuts_along_itself() {
    let (mut session, mut eye) = set_up();
    let mut pointer = Pointer::default();
    let way = [[20.0, 280.0], [580.0, 330.0]];
    drag(&mut pointer, false, way, &mut eye, &mut session);
    assert_eq!(session.surface().piece_count(), 2);
    // All that the caps have is seen on the line.
    session.apply(Command::Undo);
    session.apply(Command::Redo);
    let surface = session.surface();
    let caps = surface
        .topology()
        .triangles()
        .filter(|&t| surface.material(t) == 1);
    let mut corners = 0;
    for v in caps.flat_map(|t| surface.topology().triangle(t)) {
        let [x, y] = eye.shown().project(surface.position(v), eye.size).unwrap();
        let on_line = 280.0 + (x - 20.0) * 50.0 / 560.0;
        assert!((y - on_line).abs() < 0.5, "{y} is not {on_line}");
        corners += 1;
    }
    assert!(corners > 30, "{corners}");
}

#[test]
fn a_short_line_cuts_with_shift_alone() {
    let way = [[280.0, 300.0], [320.0, 300.0]];
    for (shift, pieces) in [(false, 1), (true, 2)] {
        let (mut session, mut eye) = set_up();
        drag(&mut Pointer::default(), shift, way, &mut eye, &mut session);
        assert_eq!(session.surface().piece_count(), pieces, "shift {shift}");
        assert_eq!(session.notice().is_some(), !shift);
    }
    let (mut session, mut eye) = set_up();
    let click = [[300.0, 300.0], [302.0, 300.0]];
    drag(&mut Pointer::default(), true, click, &mut eye, &mut session);
    assert!(session.notice().is_none(), "a click draws no line");
}

#[test]
fn a_blade_is_held_through_the_body() {
    let (mut session, mut eye) = set_up();
    let mut pointer = Pointer {
        tool: Tool::Blade,
        ..Pointer::default()
    };
    let way = [[20.0, 300.0], [580.0, 300.0]];
    drag(&mut pointer, false, way, &mut eye, &mut session);
    assert_eq!(session.surface().piece_count(), 2);
    assert_eq!(session.held_blade(), None, "it was put away");
}

#[test]
fn a_vertex_under_the_pointer_follows_it() {
    let (mut session, mut eye) = set_up();
    let mut pointer = Pointer {
        tool: Tool::Grab,
        ..Pointer::default()
    };
    pointer.go([300.0, 250.0], &mut eye, &mut session).unwrap();
    pointer
        .press(Button::Left, false, &eye, &mut session)
        .unwrap();
    let v = session.held_vertex().expect("the ball is there");
    for _ in 0..40 {
        pointer.go([200.0, 100.0], &mut eye, &mut session).unwrap();
        session.frame();
    }
    let at = eye
        .shown()
        .project(session.surface().position(v), eye.size)
        .unwrap();
    assert!(
        (at[0] - 200.0).abs() < 1.0 && (at[1] - 100.0).abs() < 1.0,
        "{at:?}"
    );
    pointer.cancel(&mut session);
    assert_eq!(session.held_vertex(), None);
    // Beside the body the view turns.
    let before = eye;
    let aside = [[30.0, 30.0], [60.0, 30.0]];
    drag(&mut pointer, false, aside, &mut eye, &mut session);
    assert_ne!(eye, before);
    pointer.tool = Tool::Pin;
    pointer.go([300.0, 300.0], &mut eye, &mut session).unwrap();
}

#[test]
fn the_view_turns_shifts_and_comes_nearer_without_end() {
    let (mut session, mut eye) = set_up();
    let start = eye;
    let mut pointer = Pointer::default();
    pointer
        .press(Button::Right, false, &eye, &mut session)
        .unwrap();
    pointer.go([100.0, 1e6], &mut eye, &mut session).unwrap();
    // Another button does nothing while one is down.
    pointer
        .press(Button::Left, false, &eye, &mut session)
        .unwrap();
    pointer.release(Button::Left, &eye, &mut session).unwrap();
    assert!(pointer.is_busy());
    pointer.release(Button::Right, &eye, &mut session).unwrap();
    assert!(eye.camera.azimuth < start.camera.azimuth);
    assert_eq!(eye.camera.elevation, STEEPEST);
    let mut eye = start;
    let center = Vec3::from(eye.camera.target);
    pointer.go([300.0, 300.0], &mut eye, &mut session).unwrap();
    pointer
        .press(Button::Middle, false, &eye, &mut session)
        .unwrap();
    pointer.go([340.0, 280.0], &mut eye, &mut session).unwrap();
    pointer.release(Button::Middle, &eye, &mut session).unwrap();
    let [x, y] = eye.shown().project(center, eye.size).unwrap();
    assert!(
        (x - 340.0).abs() < 0.5 && (y - 280.0).abs() < 0.5,
        "it goes with the pointer: {x} {y}"
    );
    eye.zoom(2.0);
    assert!(eye.camera.distance < start.camera.distance);
    for _ in 0..1000 {
        eye.zoom(20.0);
    }
    assert!(eye.camera.distance > 0.0);
}
