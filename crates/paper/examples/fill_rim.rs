//! Fills a wavy rim with the paper's method at five levels and prints size and quality.
//!
//! `cargo run -p incise-paper --example fill_rim`

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise_mesh::geometry::{area_vector, corner_angles};
use incise_paper::{PaperParams, fill};
use incise_refine::RefinementLevel;
use nalgebra::Vector3;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let angles = (0..60).map(|i| f64::from(i) * TAU / 60.0);
    let wave = |a: f64| Vector3::new(a.cos(), a.sin(), 0.1 * (2.0 * a).sin());
    let rim: Vec<_> = angles.map(wave).collect(); // counterclockwise seen from above
    let patch = fill(&rim, Vector3::z(), &PaperParams::default(), |_, _| false)?;
    assert_eq!(patch.points[..60], rim[..], "the rim is unchanged");

    for level in RefinementLevel::FIVE {
        let params = PaperParams {
            level,
            ..PaperParams::default()
        };
        let patch = fill(&rim, Vector3::z(), &params, |_, _| false)?;
        let corners = |t: &[u32; 3]| t.map(|v| patch.points[v as usize]);
        let triangles = patch.triangles.iter().map(corners);
        let (mut area, mut smallest) = (0.0, f64::INFINITY);
        for t in triangles {
            area += area_vector(t).norm() / 2.0;
            smallest = corner_angles(t).into_iter().fold(smallest, f64::min);
        }
        println!(
            "{:>12}: {:4} triangles, {:3} new vertices, {} rounds, area {area:.3} m^2, \
             minimum angle {:.0} degrees",
            level.to_string(),
            patch.triangles.len(),
            patch.parents.len(),
            patch.report.rounds,
            smallest.to_degrees()
        );
    }
    Ok(())
}
