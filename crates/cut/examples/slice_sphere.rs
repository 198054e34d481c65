//! Cuts a sphere three times along different planes, prints what the last cut did and the pieces, takes it back, and writes
//! what is left to a file if one is named.
//!
//! `cargo run -p incise-cut --example slice_sphere -- pieces.obj`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{cube_sphere, write_obj};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut body = cube_sphere(16, 0.5);
    let mut cutter = Cutter::new(&body);
    let plane = Sweep::across_box([0.0, 1.0, 0.2], 0.1, &body.bounds())?; // a blade larger than the body
    let outcome = cutter.cut(&mut body, &plane, &CutParams::default())?;
    println!("{} cap triangles", outcome.cap.len());
    assert_eq!(body.piece_volumes().len(), 2, "two pieces");
    assert!(body.topology().is_closed(), "both lips are closed");

    let plane = Sweep::across_box([1.0, 0.3, 0.0], -0.1, &body.bounds())?;
    cutter.cut(&mut body, &plane, &CutParams::default())?;
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
        println!("piece {new} came off piece {old}");
    }
    for (piece, volume) in body.piece_volumes().into_iter().enumerate() {
        println!("piece {piece}: {volume:.4} m^3");
    }
    let undo = outcome.undo.ok_or("the sweep missed the body")?;
    cutter.undo(&mut body, undo)?;
    println!("taken back: {} pieces", body.piece_volumes().len());
    if let Some(path) = std::env::args().nth(1) {
        write_obj(path.as_ref(), &body)?;
        println!("written to {path}");
    }
    Ok(())
}
