//! Fills a hole of a sphere at five refinement levels and prints size and quality of the patch.
//!
//! `cargo run -p incise-refine --example fill_hole`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_mesh::icosphere;
use incise_refine::{HoleParams, RefinementLevel, fill_holes};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut sphere = icosphere(4, 0.5);
    let triangles: Vec<_> = sphere.topology().triangles().collect();
    let mut edit = sphere.edit();
    for t in triangles {
        if (edit.surface().triangle_positions(t).iter()).all(|p| p.y > 0.3) {
            edit.remove_triangle(t);
        }
    }
    let _ = edit.finish();
    assert!(!sphere.topology().is_closed(), "the sphere has a hole");

    for level in RefinementLevel::FIVE {
        let params = HoleParams {
            level,
            ..HoleParams::default()
        };
        let mut filled = sphere.clone();
        let report = fill_holes(&mut filled, &params)?;
        assert!(filled.topology().is_closed(), "the hole is filled");
        let hole = &report.holes[0];
        println!(
            "{:>12}: {:4} triangles, minimum angle {:.0} degrees",
            level.to_string(),
            hole.triangles.len(),
            hole.angles.min
        );
    }
    Ok(())
}
