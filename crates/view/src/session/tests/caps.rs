//! Tests of the curves along which caps close cuts.

use super::*;
use incise_cut::Caps;

/// Returns a session with these caps after a slice through the body.
fn sliced(caps: Caps) -> Session {
    let mut settings = Settings::default();
    settings.scene.cut.caps = caps;
    let scene = Scene::new(SceneParams::default());
    let mut session = Session::with_settings(icosphere(2, 0.5), scene, settings).unwrap();
    session.apply(across(0.05));
    assert_eq!(session.status_message(), None);
    session
}

#[test]
fn a_body_stays_open_without_caps() {
    for (caps, is_closed) in [
        (Caps::Bodies, true),
        (Caps::AllLoops, true),
        (Caps::None, false),
    ] {
        let mut session = sliced(caps);
        session.frame();
        assert_eq!(pieces(&session), 2);
        let topology = session.surface().topology();
        assert_eq!(topology.is_closed(), is_closed, "{caps:?}");
    }
}

#[test]
fn recordings_keep_the_caps() {
    for caps in [Caps::Bodies, Caps::AllLoops, Caps::None] {
        let mut file = Vec::new();
        sliced(caps).recording().write(&mut file).unwrap();
        let read = Recording::read(file.as_slice()).unwrap();
        assert_eq!(read.settings().scene.cut.caps, caps);
    }
}
