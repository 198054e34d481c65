//! Slices a falling ball in a session without a window and replays the recording bit for bit.
//!
//! `cargo run -p incise-view --example recorded_slice -- recording.jsonl` writes a recording that
//! `incise-view --replay` shows.

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_models::{Model, build_model};
use incise_scene::{Scene, SceneParams};
use incise_view::{Command, ReplayProgress, Session};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ball = build_model(Model::Sphere768);
    let mut session = Session::new(ball.clone(), Scene::new(SceneParams::default()))?;
    let from = [[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0]]; // a blade's edge, left of the ball
    let to = from.map(|[x, _, z]| [-x, 0.2, z]); // and right of it
    session.apply(Command::Slice { from, to });
    (0..60).for_each(|_| session.frame());
    println!(
        "{} pieces",
        session.scene().body(session.body())?.pieces().len()
    );

    let recording = session.finished_recording()?;
    println!(
        "{} entries of {} frames",
        recording.entries().len(),
        session.frames()
    );
    if let Some(path) = std::env::args().nth(1) {
        recording.write(&mut std::fs::File::create(&path)?)?;
        println!("written to {path}");
    }
    let mut replay = recording.replay(&ball)?;
    let mut again = Session::new(ball, Scene::new(SceneParams::default()))?;
    let is_same = loop {
        match replay.advance(&mut again)? {
            ReplayProgress::Running => again.frame(),
            ReplayProgress::Finished(is_same) => break is_same,
        }
    };
    assert_eq!(is_same, Some(true), "the replay is bit-identical");
    println!("the replay is bit-identical");
    Ok(())
}
