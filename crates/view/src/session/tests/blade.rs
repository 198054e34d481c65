//! A held blade.

use super::*;

#[test]
fn a_held_blade_cuts_in_the_frame_in_which_it_comes_out() {
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
        assert_eq!(place == BladePlace::Inside, is_inside, "at {i}");
        cuts.push(s.last().stats.cuts);
    }
    assert_eq!(cuts.iter().sum::<u32>(), 1);
    assert_eq!(cuts[9], 1, "{cuts:?}");
    s.apply(Command::LiftBlade);
    assert_eq!((pieces(&s), s.undoable()), (2, 1));
    assert_eq!(s.held_blade(), None);
}

/// A held blade's edge across the ball, so far from its middle.
fn upright(x: f32) -> Command {
    Command::Blade {
        edge: [[x, 0.02, -2.0], [x, 0.02, 2.0]],
    }
}

#[test]
fn a_blade_that_is_let_go_beside_the_body_has_cut_what_it_passed() {
    let mut s = session();
    s.apply(upright(-1.0));
    s.frame();
    // All of it within a frame, or while time stands still.
    s.apply(upright(1.0));
    s.apply(Command::FinishBlade);
    assert_eq!((pieces(&s), s.undoable()), (2, 1));
    assert_eq!(s.held_blade(), None);
    // It may also be taken away.
    s.apply(Command::Undo);
    s.apply(upright(-1.0));
    s.apply(upright(1.0));
    s.apply(Command::LiftBlade);
    s.frame();
    assert_eq!((pieces(&s), s.held_blade()), (1, None));
}

#[test]
fn a_blade_that_cannot_cut_says_so() {
    let mut s = session();
    let place = |s: &Session| s.held_blade().map(|(_, place)| place);
    s.apply(upright(-1.0));
    assert_eq!(place(&s), Some(BladePlace::Outside));
    s.frame();
    s.apply(upright(0.0));
    s.frame();
    assert_eq!(place(&s), Some(BladePlace::Inside));
    s.apply(Command::FinishBlade);
    let notice = s.notice().expect("nothing was cut");
    assert!(notice.is_refusal && notice.text.contains("let go inside"));
    // One that was put into the body has to come out of it first.
    s.dismiss();
    s.apply(upright(0.1));
    assert_eq!(place(&s), Some(BladePlace::Begun));
    s.frame();
    s.apply(upright(1.0));
    s.frame();
    assert_eq!((place(&s), pieces(&s)), (Some(BladePlace::Outside), 1));
    s.apply(upright(-1.0));
    s.frame();
    assert_eq!((place(&s), pieces(&s)), (Some(BladePlace::Outside), 2));
    s.apply(upright(0.0));
    s.apply(Command::LiftBlade);
    s.apply(upright(0.0));
    s.apply(upright(1.0));
    s.apply(Command::FinishBlade);
    let notice = s.notice().expect("nothing was cut");
    assert!(notice.is_refusal && notice.text.contains("put into"));
}
