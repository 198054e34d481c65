//! Cuts a sphere three times along different planes, prints what each cut did and the pieces, and
//! writes them to a file if one is named.
//!
//! `cargo run -p incise-cut --example slice_sphere -- pieces.obj`

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{cube_sphere, write_obj};
use std::path::Path;

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut body = cube_sphere(16, 0.5);
    let mut cutter = Cutter::new(&body);
    println!("volume {:.4} m^3 in one piece", body.volume());
    for (normal, d) in [
        ([0.0, 1.0, 0.2], 0.1),
        ([1.0, 0.3, 0.0], -0.1),
        ([0.2, 0.1, 1.0], 0.0),
    ] {
        // A blade that is larger than the body: it cuts all the way through, piece by piece.
        let sweep = Sweep::across_box(normal, d, &body.bounds())?;
        let outcome = cutter.cut(&mut body, &sweep, &CutParams::default())?;
        let (delta, report) = (&outcome.delta, outcome.report);
        println!(
            "{} of {} candidates hit, {} loops; {} triangles out, {} in, {} of them caps; {:.2} ms",
            report.hits,
            report.candidates,
            report.loops,
            delta.triangles_removed.len(),
            delta.triangles_added.len(),
            outcome.cap.len(),
            1e3 * report.total().as_secs_f64()
        );
        for (new, old) in &delta.pieces_added {
            println!("  piece {new} came off piece {old}");
        }
    }
    assert!(body.topology().is_closed(), "both sides are closed");
    for (piece, volume) in body.piece_volumes().into_iter().enumerate() {
        println!("piece {piece}: {volume:.4} m^3");
    }
    if let Some(path) = std::env::args().nth(1) {
        write_obj(Path::new(&path), &body)?;
        println!("written to {path}");
    }
    Ok(())
}
