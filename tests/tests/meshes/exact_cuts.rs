//! The exact method on closed meshes: invariants on many planes, and 231 cuts compared with an
//! independent boolean library.
//!
//! `INCISE_PLANES` sets the number of planes per mesh.

use crate::reference_table::{Reference, files, reference_cuts, shared_folder};
use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, read_mesh};
use incise_tests::{LARGE, Planes, cut_and_check, euler_characteristics};
use libtest_mimic::{Failed, Trial};
use std::collections::BTreeMap;
use std::path::Path;

/// Default number of planes for a mesh of about 1,000 triangles; larger meshes get fewer.
const PLANES: usize = 40;

pub(crate) fn trials() -> Vec<Trial> {
    let shared = shared_folder();
    let mut trials = Vec::new();
    for folder in ["models", "torture"] {
        for path in files(&shared.join(folder)) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = format!("{folder}/{name}");
            trials.push(Trial::test(format!("exact_cuts::{name}"), move || {
                random_planes(&path, &name)
            }));
        }
    }
    for (mesh, rows) in reference_cuts() {
        let path = shared.join(&mesh);
        let name = format!("exact_cuts::reference {mesh}");
        trials.push(Trial::test(name, move || reference(&path, &rows)));
    }
    trials
}

fn load(path: &Path) -> Option<Surface> {
    let (surface, _) = read_mesh(path).ok()?.into_surface().ok()?;
    Some(surface)
}

fn params(snap: f64) -> CutParams {
    CutParams {
        snap,
        ..CutParams::default()
    }
}

/// Cuts copies of the mesh along many planes, with and without snapping.
fn random_planes(path: &Path, name: &str) -> Result<(), Failed> {
    let Some(whole) = load(path) else {
        return Ok(());
    };
    let triangles = whole.topology().triangle_count();
    let told = std::env::var("INCISE_PLANES").ok();
    let told = told.and_then(|n| n.parse().ok());
    let count = told.unwrap_or_else(|| (PLANES * 1000 / triangles).clamp(2, PLANES));
    // Scans may intersect themselves, so the area of the section is unknown.
    let tame = [
        "models/sphere",
        "models/banana",
        "ok_cube",
        "ok_torus",
        "ok_hollow",
    ];
    let planes = Planes {
        whole: &whole,
        is_embedded: tame.iter().any(|tame| name.contains(tame)),
        all_invariants: triangles < LARGE,
    };
    let mut hits = 0;
    for i in 0..count {
        for snap in [0.0, 0.1] {
            let hit = planes.cut(i, snap);
            hits += usize::from(hit.map_err(|e| format!("plane {i}, snap {snap}: {e}"))?);
        }
    }
    if hits == 0 {
        return Err("no plane met the mesh".into());
    }
    Ok(())
}

fn reference(path: &Path, rows: &[Reference]) -> Result<(), Failed> {
    let whole = load(path).ok_or("the mesh cannot be read")?;
    for row in rows {
        for snap in [0.0, 0.1] {
            agrees(&whole, row, snap)
                .map_err(|error| format!("plane {}, snap {snap}: {error}", row.plane))?;
        }
    }
    Ok(())
}

/// Results on the two sides of the plane.
#[derive(Debug, Default)]
struct Side {
    volume: f64,
    components: usize,
    euler: i64,
}

fn agrees(whole: &Surface, row: &Reference, snap: f64) -> Result<(), String> {
    let mut surface = whole.clone();
    let sweep = Sweep::from_plane(row.normal, row.d, &surface.bounds()).expect("a plane");
    let mut cutter = Cutter::new(whole);
    let outcome = if whole.topology().triangle_count() < LARGE {
        cut_and_check(&mut surface, &mut cutter, &sweep, &params(snap))
    } else {
        cutter.cut(&mut surface, &sweep, &params(snap))
    };
    let outcome = outcome.map_err(|error| error.to_string())?;
    let mut sides = [Side::default(), Side::default()];
    let volumes = surface.piece_volumes();
    let heights = heights_of_volume(&surface, row);
    for (piece, euler) in euler_characteristics(&surface) {
        let side = &mut sides[usize::from(heights[&piece] < 0.0)];
        side.volume += volumes[piece as usize];
        side.components += 1;
        side.euler += euler;
    }
    let total = row.volume[0].abs() + row.volume[1].abs();
    for (side, i) in sides.iter().zip(0..) {
        let error = (side.volume - row.volume[i]).abs();
        // The corners of the sweep are rounded, which shifts the plane over the whole section.
        let rounding = 1e-5 * total + 1e-6 * whole.bounds().diagonal() * row.section_area;
        let bound = if snap == 0.0 { rounding } else { 2e-3 * total };
        if error > bound {
            return Err(format!("{side:?} for a volume of {}", row.volume[i]));
        }
        if side.components != row.components[i] {
            return Err(format!(
                "{side:?}, {} components expected",
                row.components[i]
            ));
        }
        if side.euler != 2 - 2 * row.genus[i] && side.components > 0 {
            return Err(format!("{side:?}, genus {} expected", row.genus[i]));
        }
    }
    let area = cap_area(&surface, &outcome);
    let bound = if snap == 0.0 { 1e-5 } else { 2e-2 } * row.section_area;
    if (area - row.section_area).abs() > bound {
        return Err(format!("a cap of {area} for {}", row.section_area));
    }
    Ok(())
}

/// Returns the area of the caps of one side.
fn cap_area(surface: &Surface, outcome: &CutOutcome) -> f64 {
    let area = |t| area_vector(surface.triangle_positions(t)).norm() / 2.0;
    outcome.cap.iter().map(|&t| area(t)).sum::<f64>() / 2.0
}

/// Returns the height of the center of volume of every piece above the plane.
fn heights_of_volume(surface: &Surface, row: &Reference) -> BTreeMap<u32, f64> {
    let mut moments: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let normal = Vec3::from(row.normal);
    let apex = normal * (row.d / normal.norm_squared());
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t).map(|p| p - apex);
        let volume = a.dot(&b.cross(&c)) / 6.0;
        let moment = moments.entry(surface.piece(t)).or_default();
        moment.0 += volume;
        moment.1 += normal.dot(&(a + b + c)) * (volume / 4.0);
    }
    let center = |(volume, moment): (f64, f64)| moment / volume;
    moments.into_iter().map(|(p, m)| (p, center(m))).collect()
}
