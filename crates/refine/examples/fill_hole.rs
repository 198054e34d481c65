//! Fills the hole inside a wavy rim at the five levels and prints what that costs.

use incise_mesh::geometry::{area_vector, corner_angles};
use incise_refine::{RefineParams, RefinementLevel, fill};
use nalgebra::Vector3;
use std::f64::consts::TAU;

#[expect(clippy::print_stdout, reason = "an example shows what it computes")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Counterclockwise seen from above, not in one plane, not convex.
    let rim: Vec<_> = (0..60)
        .map(|i| f64::from(i) * TAU / 60.0)
        .map(|a| {
            let radius = 1.0 + 0.25 * (3.0 * a).cos();
            Vector3::new(radius * a.cos(), radius * a.sin(), 0.1 * (2.0 * a).sin())
        })
        .collect();
    println!("a rim of {} vertices", rim.len());
    for level in RefinementLevel::FIVE {
        let params = RefineParams {
            level,
            ..RefineParams::default()
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
            "{:>12}: {:4} triangles, {:3} vertices inside, {} rounds, area {area:.3} m^2, smallest angle {:.0} degrees",
            level.to_string(),
            patch.triangles.len(),
            patch.inner.len(),
            patch.report.rounds,
            smallest.to_degrees()
        );
    }
    Ok(())
}
