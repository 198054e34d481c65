//! The paper's method on 231 plane cuts, compared with an independent boolean library.

use crate::reference_table::{Reference, reference_cuts, shared_folder};
use incise_cut::{CutOutcome, Cutter, Sweep};
use incise_mesh::geometry::{Vec3, area_vector};
use incise_mesh::{Surface, read_mesh};
use incise_paper::{PaperError, PaperParams};
use incise_refine::RefinementLevel;
use incise_tests::paper_cut_and_check;
use libtest_mimic::{Failed, Trial};
use std::collections::BTreeMap;
use std::path::Path;

/// Returns true if the cross-section has a hole, which the paper's method refuses.
fn has_hole(mesh: &str, plane: usize) -> bool {
    mesh == "torture/ok_hollow_sphere.obj" || (mesh, plane) == ("torture/ok_plate_genus16.obj", 9)
}

pub(crate) fn trials() -> Vec<Trial> {
    let cuts = reference_cuts().into_iter();
    let trial = |(mesh, rows): (String, Vec<Reference>)| {
        let path = shared_folder().join(&mesh);
        Trial::test(format!("paper_cuts::{mesh}"), move || {
            test(&path, &mesh, &rows)
        })
    };
    cuts.map(trial).collect()
}

fn test(path: &Path, mesh: &str, rows: &[Reference]) -> Result<(), Failed> {
    let data = read_mesh(path).map_err(|e| e.to_string())?;
    let (surface, _) = data.into_surface().map_err(|e| e.to_string())?;
    for row in rows {
        for level in RefinementLevel::FIVE {
            cut(&surface, mesh, row, level)
                .map_err(|error| format!("plane {}, level {level}: {error}", row.plane))?;
        }
    }
    Ok(())
}

fn cut(whole: &Surface, mesh: &str, row: &Reference, level: RefinementLevel) -> Result<(), String> {
    let mut surface = whole.clone();
    let sweep = Sweep::from_plane(row.normal, row.d, &surface.bounds()).expect("a plane");
    let params = PaperParams {
        level,
        ..PaperParams::default()
    };
    let result = paper_cut_and_check(&mut surface, &mut Cutter::new(whole), &sweep, &params);
    let outcome = match (result, has_hole(mesh, row.plane)) {
        (Err(PaperError::NestedSection { .. }), true) => return Ok(()),
        (Err(error), _) => return Err(error.to_string()),
        (Ok(_), true) => return Err("a section with a hole was cut".to_owned()),
        (Ok(outcome), false) => outcome,
    };
    let volumes = surface.piece_volumes();
    let mut found = [0.0; 2];
    let mut components = 0;
    for (piece, center) in centers_of_volume(&surface) {
        let is_negative = Vec3::from(row.normal).dot(&center) < row.d;
        found[usize::from(is_negative)] += volumes[piece as usize];
        components += 1;
    }
    let expected: usize = row.components.iter().sum();
    if components != expected {
        return Err(format!("{components} components, expected {expected}"));
    }
    let bound = error_bound(whole, row, &outcome);
    for (found, expected) in found.into_iter().zip(row.volume) {
        let error = (found - expected).abs();
        if error > bound {
            return Err(format!("volume {found}, expected {expected} to {bound}"));
        }
    }
    Ok(())
}

/// Returns the bound of the volume error.
///
/// The method removes whole intersected triangles, so a side may end one edge from the plane.
fn error_bound(whole: &Surface, row: &Reference, outcome: &CutOutcome) -> f64 {
    let removed = &outcome.delta.triangles_removed;
    let (mut perimeters, mut strip) = (0.0, 0.0);
    for (_, corners) in removed {
        let [a, b, c] = corners.map(|v| whole.position(v));
        perimeters += (b - a).norm() + (c - b).norm() + (a - c).norm();
        strip += area_vector([a, b, c]).norm() / 2.0;
    }
    let mean_edge = perimeters / (3 * removed.len()) as f64;
    mean_edge * (row.section_area + strip)
}

/// Returns the center of volume of every piece.
fn centers_of_volume(surface: &Surface) -> BTreeMap<u32, Vec3> {
    let mut moments: BTreeMap<u32, (f64, Vec3)> = BTreeMap::new();
    let apex = surface.bounds().center();
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t).map(|p| p - apex);
        let volume = a.dot(&b.cross(&c)) / 6.0;
        let moment = moments.entry(surface.piece(t)).or_default();
        moment.0 += volume;
        moment.1 += (a + b + c) * (volume / 4.0);
    }
    moments
        .into_iter()
        .map(|(piece, (volume, moment))| (piece, apex + moment / volume))
        .collect()
}
