//! Tests of commands, undo and redo, dragging, settings and replay, without a window.

mod blade;
mod caps;

use super::*;
use crate::recording::ReplayProgress;
use incise_mesh::icosphere;
use incise_models::{Model, build_model};
use incise_pbd_gpu::Stiffness;
use incise_refine::RefinementLevel;
use incise_scene::SceneParams;

fn session() -> Session {
    let scene = Scene::new(SceneParams::default());
    Session::new(icosphere(2, 0.5), scene).expect("a sphere can be simulated")
}

/// Returns a session with a ball that is only a surface, whose cuts are undone bit for bit.
fn surface_session() -> Session {
    let settings = Settings {
        material: incise_models::scenes::sprung(),
        ..Settings::default()
    };
    let scene = Scene::new(SceneParams::default());
    Session::with_settings(icosphere(2, 0.5), scene, settings).expect("a ball can be simulated")
}

/// Returns a horizontal slice through the whole body at a height.
fn across(height: f32) -> Command {
    Command::Slice {
        from: [[-2.0, height, -2.0], [-2.0, height, 2.0]],
        to: [[2.0, height, -2.0], [2.0, height, 2.0]],
    }
}

fn pieces(session: &Session) -> usize {
    session.surface().piece_count()
}

#[test]
fn slices_cut_immediately_and_can_be_undone_and_redone() {
    let mut s = session();
    let whole = s.surface().clone();
    s.apply(across(0.05));
    assert_eq!((pieces(&s), s.undo_count(), s.redo_count()), (2, 1, 0));
    let cut = s.surface().clone();
    s.apply(Command::Undo);
    assert_eq!((pieces(&s), s.undo_count(), s.redo_count()), (1, 0, 1));
    assert_eq!(s.surface().topology(), whole.topology());
    s.apply(Command::Redo);
    assert_eq!((pieces(&s), s.undo_count(), s.redo_count()), (2, 1, 0));
    let again = s.surface();
    assert_eq!(again.topology(), cut.topology());
    for v in cut.topology().vertices() {
        assert!((again.position(v) - cut.position(v)).norm() < 1e-6);
    }
    // Two cuts are undone after motion, the last one first.
    s.apply(across(-0.2));
    assert_eq!(pieces(&s), 3);
    for _ in 0..10 {
        s.frame();
    }
    s.apply(Command::Undo);
    s.frame();
    s.apply(Command::Undo);
    assert_eq!((pieces(&s), s.undo_count(), s.redo_count()), (1, 0, 2));
    s.apply(Command::Undo);
    assert!(
        !s.status_message().unwrap().is_error,
        "there is nothing to undo"
    );
    s.apply(across(0.0));
    assert_eq!(s.redo_count(), 0, "another cut was made");
}

/// Returns the bits of positions, masses and velocities.
fn bits(session: &Session) -> Vec<[u32; 8]> {
    let solver = session.scene().body(session.body()).unwrap().solver();
    let moved = solver.masses().iter().zip(solver.velocities());
    let all = session.surface().positions().iter().zip(moved);
    all.map(|(&[x, y, z, w], (&mass, &[u, v, n, _]))| [x, y, z, w, mass, u, v, n].map(f32::to_bits))
        .collect()
}

#[test]
fn undo_and_redo_without_motion_are_bit_identical() {
    let mut s = surface_session();
    s.apply(Command::Pin { vertex: 5 });
    for _ in 0..30 {
        s.frame();
    }
    let whole = bits(&s);
    s.apply(across(0.05));
    let once = bits(&s);
    s.apply(across(-0.2));
    assert_eq!(pieces(&s), 3);
    let twice = bits(&s);
    for _ in 0..2 {
        s.apply(Command::Undo);
        assert!(bits(&s) == once, "one cut taken back");
        s.apply(Command::Undo);
        assert!(bits(&s) == whole, "both cuts taken back");
        s.apply(Command::Redo);
        assert!(bits(&s) == once, "one cut done again");
        s.apply(Command::Redo);
        assert!(bits(&s) == twice, "both cuts done again");
    }
}

/// Regression: pieces that had separated were joined over a distance and flew apart.
#[test]
fn undo_and_redo_restore_the_state_of_the_cut() {
    let mut s = surface_session();
    let places = |s: &Session| s.surface().positions().to_vec();
    for _ in 0..20 {
        s.frame();
    }
    let whole = places(&s);
    s.apply(across(0.1));
    let cut = places(&s);
    let parts = s.surface().piece_volumes();
    for _ in 0..120 {
        s.frame();
    }
    let near = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let mut pairs = a.iter().zip(b);
        pairs.all(|(a, b)| a[..3] == b[..3]) && a.len() == b.len()
    };
    for _ in 0..2 {
        s.apply(Command::Undo);
        let used = whole.len();
        assert!(near(&places(&s)[..used], &whole), "as before the cut");
        let stretch = s
            .scene()
            .body(s.body())
            .unwrap()
            .solver()
            .stretch_error(s.surface());
        for _ in 0..60 {
            s.frame();
        }
        assert!(stretch < 0.01, "nothing is torn: {stretch}");
        s.apply(Command::Redo);
        assert!(near(&places(&s), &cut), "as after the cut");
        assert_eq!(s.surface().piece_volumes(), parts);
        assert_eq!((s.undo_count(), s.redo_count()), (1, 0));
        for _ in 0..60 {
            s.frame();
        }
    }
}

#[test]
fn cut_statistics_appear_in_the_next_frame() {
    let mut s = session();
    s.apply(across(0.0));
    s.frame();
    assert_eq!(
        (
            s.last_frame().stats.cuts,
            s.last_frame().stats.resting_blades
        ),
        (1, 1)
    );
    assert!(s.last_frame().stats.hit_triangles > 0);
    assert_eq!(s.last_cut_stats().map(|stats| stats.cuts), Some(1));
    s.frame();
    assert_eq!(s.last_frame().stats.cuts, 0);
    assert_eq!(s.frames(), 2);
}

#[test]
fn failed_cuts_are_reported_and_change_nothing() {
    let mut s = session();
    s.apply(Command::Set(Settings {
        progressive: false,
        ..Settings::default()
    }));
    let before = s.fingerprint().unwrap();
    s.apply(Command::Slice {
        from: [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0]],
        to: [[0.0, 0.0, -2.0], [0.0, 0.0, 2.0]],
    });
    let status_message = s.status_message().expect("the cut was refused");
    assert!(
        status_message.is_error && status_message.text.contains("inside"),
        "{status_message:?}"
    );
    s.apply(across(9.0));
    let status_message = s.status_message().expect("the cut missed");
    assert!(
        !status_message.is_error && status_message.text.contains("misses"),
        "{status_message:?}"
    );
    assert_eq!(s.fingerprint().unwrap(), before);
    assert_eq!(s.undo_count(), 0);
}

#[test]
fn vertices_are_dragged_released_and_pinned() {
    let mut s = session();
    let picked = s.pick(Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.0, -1.0, 0.0));
    let picked = picked.unwrap().expect("it looks down on the ball");
    assert!((picked.point.y - 0.5).abs() < 0.05, "{picked:?}");
    let v = picked.vertex;
    s.apply(Command::Grab { vertex: v.0 });
    let start = s.surface().position(v);
    let to = round_up(start, 0.4);
    for _ in 0..60 {
        s.apply(Command::Drag { to });
        s.frame();
    }
    assert!((s.surface().position(v).y - f64::from(to[1])).abs() < 1e-4);
    // A free ball falls by 4.9 m, and the vertex pulls out the soft skin around it.
    let low = s.surface().bounds().min[1];
    assert!(low > -0.7, "the ball hangs on it: {low}");
    s.apply(Command::Release);
    assert_eq!((s.held_vertex(), s.pins().count()), (None, 0));
    // A pinned vertex stays pinned after a drag.
    s.apply(Command::Pin { vertex: v.0 });
    s.apply(Command::Grab { vertex: v.0 });
    s.apply(Command::Release);
    assert_eq!(s.pins().map(|(v, _)| v).collect::<Vec<_>>(), [v]);
    s.apply(Command::Pin { vertex: v.0 });
    assert_eq!(s.pins().count(), 0);
    s.apply(Command::Grab { vertex: 99_999 });
    assert_eq!(s.held_vertex(), None);
}

fn round_up(p: Vec3, by: f64) -> [f32; 3] {
    incise_mesh::geometry::to_f32(p + Vec3::new(0.0, by, 0.0))
}

#[test]
fn settings_apply_to_the_next_frame_and_cut() {
    let mut s = surface_session();
    s.apply(across(0.1));
    let coarse = s.surface().topology().triangle_count();
    s.apply(Command::Undo);
    let mut settings = *s.settings();
    settings.scene.cut.refine.level = RefinementLevel::Finer2;
    settings.scene.solver.iterations = 4;
    settings.material.stretch = Stiffness::Pbd(0.5);
    settings.material.volume = None;
    s.apply(Command::Set(settings));
    s.apply(across(0.1));
    assert!(s.surface().topology().triangle_count() > coarse);
    assert_eq!(s.scene().params.solver.iterations, 4);
    let v = VertexId(0);
    s.apply(Command::Pin { vertex: v.0 });
    // Other bending and interior springs rebuild the body; pins and the undo stack are kept.
    let interior_springs = |s: &Session| {
        s.scene()
            .body(s.body())
            .unwrap()
            .solver()
            .interior_springs()
            .map(|set| set.len())
    };
    assert!(interior_springs(&s).is_some_and(|count| count > 0));
    settings.material.interior_springs = None;
    s.apply(Command::Set(settings));
    assert!(
        s.status_message()
            .is_some_and(|n| n.text.contains("rebuilt"))
    );
    assert_eq!(interior_springs(&s), None);
    settings.material.bending = None;
    s.apply(Command::Set(settings));
    let body = s.scene().body(s.body()).unwrap();
    assert!(body.solver().bending().is_none());
    assert!(body.solver().volumes().pieces().is_empty());
    assert_eq!(s.pins().map(|(v, _)| v).collect::<Vec<_>>(), [v]);
    s.frame();
    assert_eq!(pieces(&s), 2);
    s.apply(Command::Undo);
    assert_eq!(pieces(&s), 1, "{:?}", s.status_message());
    s.apply(Command::Reset);
    assert_eq!((s.undo_count(), s.pins().count()), (0, 0));
    let whole = icosphere(2, 0.5);
    assert!(
        s.surface()
            .positions()
            .iter()
            .zip(whole.positions())
            .all(|(p, q)| p[..3] == q[..3])
    );
}

/// Plays 90 frames with most of the commands.
fn play(s: &mut Session) {
    let grab = 3;
    for i in 0..90_u16 {
        match i {
            4 => s.apply(across(0.1)),
            10 => s.apply(Command::Grab { vertex: grab }),
            11..30 => s.apply(Command::Drag {
                to: [0.1 * f32::from(i), 0.3, 0.7],
            }),
            30 => s.apply(Command::Release),
            40 => s.apply(Command::Undo),
            42 => {
                let mut settings = Settings::default();
                settings.material.bending = Some(Stiffness::Pbd(0.7));
                settings.scene.cut.refine.level = RefinementLevel::Z(0.8);
                s.apply(Command::Set(settings));
            }
            45 => s.apply(Command::Slice {
                from: [[-0.3, 3.0, -2.0], [0.3, -3.0, -2.0]],
                to: [[-0.3, 3.0, 2.0], [0.3, -3.0, 2.0]],
            }),
            50..60 => s.apply(Command::Blade {
                edge: [
                    [f32::from(i) * 0.3 - 16.5, -0.1, -2.0],
                    [f32::from(i) * 0.3 - 16.5, -0.2, 2.0],
                ],
            }),
            60 => s.apply(Command::LiftBlade),
            70 => s.apply(Command::Pin { vertex: 1 }),
            _ => {}
        }
        if i % 7 == 0 {
            // Picking changes nothing.
            let _ = s.pick(Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.0, -1.0, 0.0));
        }
        s.frame();
    }
}

#[test]
fn replay_is_bit_identical() {
    for model in [Model::Sphere768, Model::Sphere80] {
        let scene = || Scene::new(SceneParams::default());
        let mut s = Session::new(build_model(model), scene()).unwrap();
        play(&mut s);
        let recording = s.finished_recording().unwrap();
        let mut text = Vec::new();
        recording.write(&mut text).unwrap();
        let again = Recording::read(&*text).unwrap();
        assert_eq!(again, recording, "floats keep their bits");
        let mut replay = again.replay(&build_model(model)).unwrap();
        let mut other =
            Session::with_settings(build_model(model), scene(), recording.settings()).unwrap();
        let over = loop {
            match replay.advance(&mut other).unwrap() {
                ReplayProgress::Running => other.frame(),
                ReplayProgress::Finished(is_same) => break is_same,
            }
        };
        assert_eq!(over, Some(true), "{}", model.name());
        assert_eq!(other.frames(), s.frames());
        assert_eq!(other.surface().positions(), s.surface().positions());
    }
}

#[test]
fn recordings_of_other_bodies_and_out_of_order_are_errors() {
    let mut s = session();
    s.apply(across(0.0));
    s.frame();
    s.apply(Command::Undo);
    let mut text = Vec::new();
    s.finished_recording().unwrap().write(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let read = |text: &str| Recording::read(text.as_bytes());
    assert!(
        read(&text)
            .unwrap()
            .replay(&build_model(Model::Sphere20))
            .is_err()
    );
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4);
    for bad in [
        vec![],
        vec![lines[1]],
        vec![lines[0], lines[2], lines[1]],
        vec![lines[0], lines[0]],
        vec![lines[0], "{}"],
    ] {
        let error = read(&bad.join("\n")).unwrap_err().to_string();
        assert!(error.contains("line"), "{error}");
    }
}

#[test]
fn large_body_keeps_its_height_on_the_ground() {
    let surface = incise_mesh::cuboid([20.0, 10.0, 10.0], [20, 10, 10]);
    let measure = |surface: &Surface| {
        let bounds = surface.bounds();
        let volume = surface.piece_volumes().iter().sum::<f64>();
        [f64::from(bounds.max[1] - bounds.min[1]), volume]
    };
    let whole = measure(&surface);
    let mut s = Session::new(surface, Scene::new(SceneParams::default())).unwrap();
    for _ in 0..120 {
        s.frame();
    }
    let now = measure(s.surface());
    let [height, volume] = [0, 1].map(|k| now[k] / whole[k]);
    assert!(height > 0.8, "{height} of its height is left");
    assert!(
        (volume - 1.0).abs() < 0.02,
        "{volume} of its volume is left"
    );
}

#[test]
fn recordings_with_unknown_or_wrong_settings_name_them() {
    let mut text = Vec::new();
    session().recording().write(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let now = serde_json::to_string(&Settings::default()).unwrap();
    for (settings, expected) in [
        (r#"{"method":"exact"}"#, "method"),
        (r#"{"scene":{"solver":{"substep":0}}}"#, "substep"),
    ] {
        let text = text.replace(&now, settings);
        let error = Recording::read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("line 1 "), "{error}");
        assert!(error.contains(expected), "{error}");
    }
}

/// Regression: the order of colored sweeps turned a ball on the ground, so that it rolled forever.
///
/// It rocks on for minutes, as the open verdict `primitive` of the stress tests says.
#[test]
fn undisturbed_ball_stays_in_place() {
    let mut s = session();
    let began = s.bounds().unwrap();
    for _ in 0..1800 {
        s.frame();
    }
    let way = s.bounds().unwrap().center() - began.center();
    let radius = f64::from(began.max[1] - began.min[1]) / 2.0;
    let aside = way.x.hypot(way.z);
    assert!(aside < radius, "{aside} m");
}
