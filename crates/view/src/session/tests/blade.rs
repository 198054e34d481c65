//! Tests of cuts with a held blade.

use super::*;

#[test]
fn held_blade_cuts_when_it_leaves_the_body() {
    let mut s = session();
    s.apply(Command::Set(Settings {
        gravity: false,
        ..Settings::default()
    }));
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
fn strokes_that_cannot_cut_are_reported() {
    let mut s = session();
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
