//! Cuts a sphere three times, prints the last cut and the pieces, undoes the cut, and writes the
//! surface to a file if one is named.
//!
//! `cargo run -p incise-cut --example slice_sphere -- pieces.obj`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{cube_sphere, write_obj};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut body = cube_sphere(16, 0.5);
    let mut cutter = Cutter::new(&body);
    // A blade larger than the body.
    let plane = Sweep::from_plane([0.0, 1.0, 0.2], 0.1, &body.bounds())?;
    let outcome = cutter.cut(&mut body, &plane, &CutParams::default())?;
    assert!(!outcome.is_miss(), "the plane meets the body");
    println!("{} cap triangles", outcome.cap.len());
    assert_eq!(body.piece_volumes().len(), 2, "two pieces");
    assert!(body.topology().is_closed(), "both sides are closed");

    let plane = Sweep::from_plane([1.0, 0.3, 0.0], -0.1, &body.bounds())?;
    let outcome = cutter.cut(&mut body, &plane, &CutParams::default())?;
    assert!(!outcome.is_miss(), "the plane meets both pieces");
    // A blade's edge in two frames. It cuts every piece that it passes through.
    let (before, after) = (
        [[-1.0, -1.0, 0.1], [-1.0, 1.0, 0.1]],
        [[1.0, -1.0, -0.1], [1.0, 1.0, -0.1]],
    );
    let sweep = Sweep::new(before, after)?;
    let outcome = cutter.cut(&mut body, &sweep, &CutParams::default())?;
    let report = outcome.report;
    println!(
        "{} of {} candidates hit, {} loops; {:.2} ms",
        report.hits,
        report.candidates,
        report.loops,
        1e3 * report.total().as_secs_f64()
    );
    for (new, old) in &outcome.delta.pieces_added {
        println!("piece {new} was separated from piece {old}");
    }
    for (piece, volume) in body.piece_volumes().into_iter().enumerate() {
        println!("piece {piece}: {volume:.4} m^3");
    }
    let undo = outcome.undo.ok_or("the sweep missed the body")?;
    cutter.undo(&mut body, undo)?;
    println!("after the undo: {} pieces", body.piece_volumes().len());
    if let Some(path) = std::env::args().nth(1) {
        write_obj(path.as_ref(), &body)?;
        println!("written to {path}");
    }
    Ok(())
}
