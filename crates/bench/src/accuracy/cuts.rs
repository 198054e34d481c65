//! What cuts are off by: volumes and sections of round bodies against their closed forms, over resolution, and what
//! that costs.

use crate::columns::columns;
use crate::statistics::median;
use incise_cut::{CutMethod, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, Vec3, cube_sphere, torus};
use serde::Serialize;
use std::error::Error;
use std::f64::consts::PI;
use std::io::Write;
use std::time::Instant;

/// Times that every cut is made; the median counts.
const REPEATS: usize = 9;
/// The sphere's radius, and the plane's distance from its center \[m\].
const SPHERE: [f64; 2] = [0.5, 0.2];
/// The torus's radii \[m\].
const TORUS: [f64; 2] = [0.4, 0.15];
/// Directions of planes that no mesh is made for.
const ACROSS_SPHERE: [f64; 3] = [0.36, 0.48, 0.8];
/// Any plane through the axis y cuts a torus into equal halves.
const ACROSS_TORUS: [f64; 3] = [0.8, 0.0, 0.6];

/// A shape, a resolution and a way to cut.
#[derive(Debug, Clone, Serialize)]
pub(super) struct CutRow {
    shape: &'static str,
    triangles: usize,
    method: &'static str,
    snap: Option<f64>,
    /// The median.
    ms: f64,
    /// Of the piece above the plane, to the closed form, over it.
    volume_error: f64,
    /// The same of the whole body before the cut: what the mesh is off by.
    mesh_error: f64,
    /// Of both pieces together to the body before, over it: what the cut itself is off by.
    lost_volume: f64,
    /// Of the section, to the closed form, over it; the mean of both caps.
    area_error: f64,
    /// The farthest vertex of a cap from the plane \[m\].
    distance: f64,
    machine: String,
    commit: String,
}

/// A round body and the plane that cuts it.
struct Shape {
    name: &'static str,
    surface: Surface,
    normal: Vec3,
    offset: f64,
    /// Of all of it, and of what is above the plane \[m^3\].
    volumes: [f64; 2],
    /// Of the section \[m^2\].
    area: f64,
}

/// Measures and prints.
pub(super) fn run(
    machine: &str,
    commit: &str,
    out: &mut impl Write,
) -> Result<Vec<CutRow>, Box<dyn Error>> {
    let ways: [(&str, CutMethod, f64); 5] = [
        ("rebuild", CutMethod::Rebuild, 0.0),
        ("exact", CutMethod::Exact, 0.0),
        ("exact", CutMethod::Exact, 0.05),
        ("exact", CutMethod::Exact, 0.1),
        ("exact", CutMethod::Exact, 0.2),
    ];
    let mut rows = Vec::new();
    for shape in shapes() {
        for (method, kind, snap) in ways {
            let params = CutParams {
                method: kind,
                snap,
                ..CutParams::default()
            };
            let mut row = shape.measure(&params)?;
            row.method = method;
            row.snap = (kind == CutMethod::Exact).then_some(snap);
            row.machine = machine.to_owned();
            row.commit = commit.to_owned();
            rows.push(row);
        }
    }
    print(&rows, out)?;
    Ok(rows)
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
    fn measure(&self, params: &CutParams) -> Result<CutRow, Box<dyn Error>> {
        let n: [f64; 3] = self.normal.into();
        let sweep = Sweep::across_box(n, self.offset, &self.surface.bounds())?;
        let mut times = Vec::new();
        let mut done: Option<(Surface, CutOutcome)> = None;
        for _ in 0..REPEATS {
            let mut surface = self.surface.clone();
            let mut cutter = Cutter::new(&surface);
            let begin = Instant::now();
            let outcome = cutter.cut(&mut surface, &sweep, params)?;
            times.push(begin.elapsed().as_secs_f64() * 1e3);
            done = Some((surface, outcome));
        }
        times.sort_unstable_by(f64::total_cmp);
        let (after, outcome) = done.ok_or("there are no repeats")?;
        let triangles = |surface: &Surface| surface.topology().triangles().collect::<Vec<_>>();
        let height = |p: Vec3| self.normal.dot(&p) - self.offset;
        // A piece is above if most of it is.
        let mut heights = vec![0.0; after.piece_bound() as usize];
        for t in triangles(&after) {
            let [a, b, c] = after.triangle_positions(t).map(height);
            heights[after.piece(t) as usize] += a + b + c;
        }
        let upper = triangles(&after)
            .into_iter()
            .filter(|&t| heights[after.piece(t) as usize] > 0.0);
        let above = volume(&after, upper);
        let [before, both] = [&self.surface, &after].map(|s| volume(s, triangles(s).into_iter()));
        let cap = outcome.cap.iter();
        let area: f64 = (cap.clone())
            .map(|&t| area_vector(after.triangle_positions(t)).norm() / 2.0)
            .sum();
        let distance = cap
            .flat_map(|&t| after.triangle_positions(t))
            .fold(0.0, |far: f64, p| far.max(height(p).abs()));
        Ok(CutRow {
            shape: self.name,
            triangles: self.surface.topology().triangle_count(),
            method: "",
            snap: None,
            ms: median(&times),
            volume_error: (above - self.volumes[1]).abs() / self.volumes[1],
            mesh_error: (before - self.volumes[0]).abs() / self.volumes[0],
            lost_volume: (both - before).abs() / before,
            area_error: (area / 2.0 - self.area).abs() / self.area,
            distance,
            machine: String::new(),
            commit: String::new(),
        })
    }
}

fn volume(surface: &Surface, triangles: impl Iterator<Item = TriangleId>) -> f64 {
    let cone = |t| {
        let p = surface.triangle_positions(t);
        p[0].dot(&area_vector(p)) / 6.0
    };
    triangles.map(cone).sum()
}

fn print(rows: &[CutRow], out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let header = [
        "shape",
        "method",
        "snap",
        "triangles",
        "ms",
        "volume",
        "mesh",
        "lost",
        "area",
        "off plane",
    ];
    let mut cells = vec![header.map(str::to_owned)];
    for row in rows {
        cells.push([
            row.shape.to_owned(),
            row.method.to_owned(),
            row.snap.map_or_else(String::new, |snap| snap.to_string()),
            row.triangles.to_string(),
            format!("{:.3}", row.ms),
            format!("{:.1e}", row.volume_error),
            format!("{:.1e}", row.mesh_error),
            format!("{:.1e}", row.lost_volume),
            format!("{:.1e}", row.area_error),
            format!("{:.1e}", row.distance),
        ]);
    }
    write!(out, "{}", columns(&cells, 3))?;
    writeln!(
        out,
        "volume, area: of the piece above and of the section, to the closed form; mesh: of the body before; lost: \
         of both pieces together to the body before. off plane: the farthest vertex of a cap [m]."
    )?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_cut_is_off_by_what_the_mesh_is_and_by_rounding() {
        for shape in shapes()
            .into_iter()
            .filter(|s| s.surface.topology().triangle_count() < 5000)
        {
            let params = CutParams {
                snap: 0.0,
                ..CutParams::default()
            };
            let row = shape.measure(&params).unwrap();
            assert!(row.lost_volume < 1e-6, "{row:?}");
            assert!(row.distance < 1e-6, "{row:?}");
            // Flat triangles lie inside of the round body: of second order in their size, as the body itself.
            assert!(row.volume_error < 3.0 * row.mesh_error, "{row:?}");
            assert!(row.area_error < 3.0 * row.mesh_error, "{row:?}");
        }
    }
}
