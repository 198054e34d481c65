//! Tests of cuts with a held blade.

use super::*;

/// Settings whose blade cuts full slices only.
fn full_slices() -> Settings {
    Settings {
        progressive: false,
        ..Settings::default()
    }
}

#[test]
fn held_blade_cuts_when_it_leaves_the_body() {
    let mut s = session();
    let mut settings = full_slices();
    settings.scene.solver.gravity = [0.0; 3];
    s.apply(Command::Set(settings));
    let edge = |x: f32| [[x, 0.02, -2.0], [x, 0.02, 2.0]];
    let mut cuts = Vec::new();
    for i in -5..=5_i16 {
        s.apply(Command::Blade {
            edge: edge(f32::from(i) * 0.15),
        });
        s.frame();
        let (_, place) = s.held_blade().unwrap();
        let is_inside = (-3..=3).contains(&i);
        assert_eq!(place == BladeState::Inside, is_inside, "at {i}");
        cuts.push(s.last_frame().stats.cuts);
    }
    assert_eq!(cuts.iter().sum::<u32>(), 1);
    assert_eq!(cuts[9], 1, "{cuts:?}");
    s.apply(Command::LiftBlade);
    assert_eq!((pieces(&s), s.undo_count()), (2, 1));
    assert_eq!(s.held_blade(), None);
}

/// Moves the held blade to a position across the ball.
fn upright(x: f32) -> Command {
    Command::Blade {
        edge: [[x, 0.02, -2.0], [x, 0.02, 2.0]],
    }
}

#[test]
fn stroke_that_ends_outside_cuts() {
    let mut s = session();
    s.apply(upright(-1.0));
    s.frame();
    // The whole stroke happens within one frame.
    s.apply(upright(1.0));
    s.apply(Command::FinishBlade);
    assert_eq!((pieces(&s), s.undo_count()), (2, 1));
    assert_eq!(s.held_blade(), None);
    // Lifting the blade discards the stroke.
    s.apply(Command::Undo);
    s.apply(upright(-1.0));
    s.apply(upright(1.0));
    s.apply(Command::LiftBlade);
    s.frame();
    assert_eq!((pieces(&s), s.held_blade()), (1, None));
}

#[test]
fn full_slices_that_cannot_cut_are_reported() {
    let mut s = session();
    s.apply(Command::Set(full_slices()));
    let place = |s: &Session| s.held_blade().map(|(_, place)| place);
    s.apply(upright(-1.0));
    assert_eq!(place(&s), Some(BladeState::Outside));
    s.frame();
    s.apply(upright(0.0));
    s.frame();
    assert_eq!(place(&s), Some(BladeState::Inside));
    s.apply(Command::FinishBlade);
    let status_message = s.status_message().expect("nothing was cut");
    assert!(status_message.is_error && status_message.text.contains("let go inside"));
    // A stroke that starts inside must leave the body first.
    s.clear_status_message();
    s.apply(upright(0.1));
    assert_eq!(place(&s), Some(BladeState::StartedInside));
    s.frame();
    s.apply(upright(1.0));
    s.frame();
    assert_eq!((place(&s), pieces(&s)), (Some(BladeState::Outside), 1));
    s.apply(upright(-1.0));
    s.frame();
    assert_eq!((place(&s), pieces(&s)), (Some(BladeState::Outside), 2));
    s.apply(upright(0.0));
    s.apply(Command::LiftBlade);
    s.apply(upright(0.0));
    s.apply(upright(1.0));
    s.apply(Command::FinishBlade);
    let status_message = s.status_message().expect("nothing was cut");
    assert!(status_message.is_error && status_message.text.contains("put into"));
}

/// Moves the held blade from x = -0.7 m to `end` in steps of 0.1 m, with a frame each.
fn stroke(s: &mut Session, end: f32) {
    let mut x = -0.7;
    while x < end {
        s.apply(upright(x));
        s.frame();
        x += 0.1;
    }
}

/// A session without gravity, whose held blade is progressive.
fn floating() -> Session {
    float(session())
}

fn float(mut s: Session) -> Session {
    let mut settings = *s.settings();
    settings.scene.solver.gravity = [0.0; 3];
    s.apply(Command::Set(settings));
    s
}

fn volume(session: &Session) -> f64 {
    session.surface().piece_volumes().iter().sum()
}

#[test]
fn progressive_blade_cuts_as_it_moves_and_stops_inside() {
    let mut s = floating();
    let whole = (s.fingerprint().unwrap(), volume(&s));
    let mut cuts = 0;
    for i in -7..=1_i16 {
        s.apply(upright(f32::from(i) * 0.1));
        s.frame();
        let (_, place) = s.held_blade().unwrap();
        assert_eq!(place == BladeState::Inside, i >= -4, "at {i}");
        cuts += s.last_frame().stats.cuts;
    }
    assert!(cuts > 2, "{cuts} cuts");
    assert_eq!((pieces(&s), s.undo_count()), (1, 1), "one stroke");
    s.surface().validate().unwrap();
    assert!(s.surface().topology().is_closed());
    assert!((volume(&s) / whole.1 - 1.0).abs() < 0.01);
    // The stroke ends there: the walls stay, and the body keeps its volume at rest.
    s.apply(Command::FinishBlade);
    assert_eq!((s.held_blade(), s.status_message()), (None, None));
    for _ in 0..120 {
        s.frame();
    }
    assert!((volume(&s) / whole.1 - 1.0).abs() < 0.02, "{}", volume(&s));
    assert!(s.surface().bounds().diagonal() < 1.2 * s.initial.bounds().diagonal());
    assert_eq!(s.last_frame().stats.failed_cuts, 0);
    // One undo takes the whole stroke back.
    s.apply(Command::Undo);
    assert_eq!((s.undo_count(), s.redo_count()), (0, 1));
    assert_eq!(s.surface().topology().triangle_count(), 320);
}

#[test]
fn progressive_blade_goes_on_through_the_body_and_parts_it() {
    for progressive in [true, false] {
        let mut s = floating();
        s.apply(Command::Set(Settings {
            progressive,
            ..*s.settings()
        }));
        stroke(&mut s, 0.8);
        assert_eq!((pieces(&s), s.undo_count()), (2, 1), "{progressive}");
        let (_, place) = s.held_blade().unwrap();
        assert_eq!(place, BladeState::Outside);
        s.apply(Command::LiftBlade);
        assert_eq!(s.status_message(), None);
    }
}

#[test]
fn strokes_are_undone_and_redone_to_the_same_bits() {
    let mut s = float(surface_session());
    let state = |s: &Session| {
        let surface = s.surface();
        let places = surface.positions().iter().map(|p| [p[0], p[1], p[2]]);
        let places: Vec<[f32; 3]> = places.collect();
        (surface.topology().clone(), places)
    };
    let whole = s.surface().topology().clone();
    stroke(&mut s, 0.1);
    s.apply(Command::LiftBlade);
    s.apply(across(-0.2));
    let cut = state(&s);
    assert_eq!(s.undo_count(), 2);
    for _ in 0..2 {
        s.apply(Command::Undo);
        s.apply(Command::Undo);
        assert_eq!((s.undo_count(), s.redo_count()), (0, 2));
        assert_eq!(s.surface().topology(), &whole);
        s.apply(Command::Redo);
        s.apply(Command::Redo);
        assert_eq!((s.undo_count(), s.redo_count()), (2, 0));
        assert_eq!(s.status_message(), None);
        assert!(state(&s) == cut, "another cut");
    }
}

#[test]
fn undo_during_a_stroke_lifts_the_blade() {
    let mut s = floating();
    stroke(&mut s, 0.0);
    s.apply(Command::Undo);
    assert_eq!((s.held_blade(), pieces(&s)), (None, 1));
    s.apply(upright(0.1));
    s.frame();
    let place = s.held_blade().map(|(_, place)| place);
    assert_eq!(place, Some(BladeState::StartedInside));
    s.apply(Command::FinishBlade);
    let message = s.status_message().expect("nothing was cut");
    assert!(message.text.contains("put into the body"), "{message:?}");
    assert_eq!(s.undo_count(), 0);
}
