//! Errors and times of cuts: volumes and sections of round bodies against closed forms.

use super::AccuracyOutput;
use crate::measure::{Budget, measure};
use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, cube_sphere, torus};
use incise_paper::PaperParams;
use serde::Serialize;
use std::error::Error;
use std::f64::consts::PI;

/// Repetitions of every cut; the median counts.
const REPEATS: u32 = 9;
/// The sphere's radius, and the plane's distance from its center \[m\].
const SPHERE: [f64; 2] = [0.5, 0.2];
/// The torus's radii \[m\].
const TORUS: [f64; 2] = [0.4, 0.15];
/// Plane normals along no edge of a mesh.
const ACROSS_SPHERE: [f64; 3] = [0.36, 0.48, 0.8];
/// Any plane through the axis y cuts a torus into equal halves.
const ACROSS_TORUS: [f64; 3] = [0.8, 0.0, 0.6];

/// A row: a shape, a resolution and a cut method.
#[derive(Debug, Clone, Serialize)]
struct CutRow {
    kind: &'static str,
    triangles: usize,
    method: &'static str,
    snap: Option<f64>,
    /// Median time.
    ms: f64,
    /// Relative error of the volume above the plane to the closed form.
    volume_error: f64,
    /// Relative volume error of the mesh before the cut.
    mesh_error: f64,
    /// Relative volume change by the cut itself.
    lost_volume: f64,
    /// Relative error of the section's area to the closed form, mean of both caps.
    area_error: f64,
    /// Largest distance of a cap vertex from the plane \[m\].
    distance: f64,
}

/// A round body and the plane that cuts it.
struct Shape {
    name: &'static str,
    surface: Surface,
    normal: Vec3,
    offset: f64,
    /// Volume of the body and of the part above the plane \[m^3\].
    volumes: [f64; 2],
    /// Area of the section \[m^2\].
    area: f64,
}

/// Cuts every body at every resolution, prints and writes the rows.
pub(super) fn run(output: &mut AccuracyOutput<'_>) -> Result<(), Box<dyn Error>> {
    for shape in shapes() {
        for snap in [None, Some(0.0), Some(0.05), Some(0.1), Some(0.2)] {
            output.row(shape.name, &shape.measure(snap)?)?;
        }
    }
    Ok(output.table()?)
}

fn shapes() -> Vec<Shape> {
    let [radius, distance] = SPHERE;
    let [large, small] = TORUS;
    let spheres = [4, 8, 16, 32, 64, 128].map(|quads| Shape {
        name: "sphere",
        surface: cube_sphere(quads, radius),
        normal: ACROSS_SPHERE.into(),
        offset: distance,
        volumes: [
            4.0 / 3.0 * PI * radius.powi(3),
            PI / 3.0 * (radius - distance).powi(2) * (2.0 * radius + distance),
        ],
        area: PI * (radius * radius - distance * distance),
    });
    let volume = 2.0 * PI * PI * large * small * small;
    let tori = [16, 32, 64, 128, 256].map(|around| Shape {
        name: "torus",
        surface: torus(large, small, around, around / 2),
        normal: ACROSS_TORUS.into(),
        offset: 0.0,
        volumes: [volume, volume / 2.0],
        area: 2.0 * PI * small * small,
    });
    spheres.into_iter().chain(tori).collect()
}

impl Shape {
    /// Cuts by the exact method with a snap distance, or by the paper's.
    fn measure(&self, snap: Option<f64>) -> Result<CutRow, Box<dyn Error>> {
        let n: [f64; 3] = self.normal.into();
        let sweep = Sweep::from_plane(n, self.offset, &self.surface.bounds())?;
        let mut done: Option<(Surface, CutOutcome)> = None;
        let times = measure(
            &Budget::runs(REPEATS),
            |times| -> Result<(), Box<dyn Error>> {
                let mut surface = self.surface.clone();
                let mut cutter = Cutter::new(&surface);
                let outcome = times.time(|| -> Result<CutOutcome, Box<dyn Error>> {
                    let Some(snap) = snap else {
                        let params = PaperParams::default();
                        return Ok(
                            incise_paper::cut(&mut cutter, &mut surface, &sweep, &params)?.cut,
                        );
                    };
                    let params = CutParams {
                        snap,
                        ..CutParams::default()
                    };
                    Ok(cutter.cut(&mut surface, &sweep, &params)?)
                })?;
                done = Some((surface, outcome));
                Ok(())
            },
        )?;
        let (after, outcome) = done.ok_or("there are no repeats")?;
        let height = |p: Vec3| self.normal.dot(&p) - self.offset;
        // A piece is above if most of its volume is.
        let mut heights = vec![0.0; after.piece_bound() as usize];
        for t in after.topology().triangles() {
            let [a, b, c] = after.triangle_positions(t).map(height);
            heights[after.piece(t) as usize] += a + b + c;
        }
        let volumes = heights.iter().zip(after.piece_volumes());
        let above: f64 = (volumes.filter(|(height, _)| **height > 0.0))
            .map(|(_, volume)| volume)
            .sum();
        let [before, both] = [&self.surface, &after].map(Surface::volume);
        let cap = outcome.cap.iter();
        let area: f64 = (cap.clone())
            .map(|&t| area_vector(after.triangle_positions(t)).norm() / 2.0)
            .sum();
        let distance = cap
            .flat_map(|&t| after.triangle_positions(t))
            .fold(0.0, |far: f64, p| far.max(height(p).abs()));
        Ok(CutRow {
            kind: "cut",
            triangles: self.surface.topology().triangle_count(),
            method: if snap.is_some() { "exact" } else { "paper" },
            snap,
            ms: times.median() * 1e3,
            volume_error: (above - self.volumes[1]).abs() / self.volumes[1],
            mesh_error: (before - self.volumes[0]).abs() / self.volumes[0],
            lost_volume: (both - before).abs() / before,
            area_error: (area / 2.0 - self.area).abs() / self.area,
            distance,
        })
    }
}
