//! The exact method on every mesh beside the workspace that is a closed surface, by random planes, and
//! against what an independent boolean library says of 231 plane cuts. Without the folder one ignored
//! test says so. `INCISE_PLANES` sets how many planes a mesh gets.

use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, Vec3, read_mesh};
use incise_tests::{assert_section_is_covered, assert_sound, cut_and_check, euler_characteristics};
use libtest_mimic::{Arguments, Failed, Trial};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Planes for a mesh of about 1,000 triangles unless told; larger ones get fewer.
const PLANES: usize = 40;
/// Meshes from here on are cut without the laws that look at every triangle more than once.
const LARGE: usize = 20_000;

fn main() -> ExitCode {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let mut trials = Vec::new();
    for folder in ["models", "torture"] {
        for path in files(&shared.join(folder)) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = format!("{folder}/{name}");
            trials.push(Trial::test(name.clone(), move || {
                random_planes(&path, &name)
            }));
        }
    }
    let table = std::fs::read_to_string(shared.join("reference/cuts.csv"));
    for (mesh, rows) in table.as_deref().map(rows).unwrap_or_default() {
        let path = shared.join(&mesh);
        let name = format!("reference {mesh}");
        trials.push(Trial::test(name, move || reference(&path, &rows)));
    }
    if trials.is_empty() {
        trials.push(Trial::test("models are absent", || Ok(())).with_ignored_flag(true));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut out: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    out.sort();
    out
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

/// A direction and a place along it by a fixed sequence (R-sequence, Roberts 2018), so that planes
/// are spread evenly.
fn plane(i: usize) -> (Vec3, f64) {
    let part = |alpha: f64| (0.5 + alpha * (i + 1) as f64).fract();
    let z = 2.0 * part(0.819_172_513_396_164_5) - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * part(0.671_043_606_703_789_2)).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    let place = 2.0 * part(0.549_700_477_901_964_3) - 1.0;
    (Vec3::new(radius * cos, radius * sin, z), place)
}

/// Random planes one by one, each through the whole mesh, with and without snapping.
fn random_planes(path: &Path, name: &str) -> Result<(), Failed> {
    let Some(whole) = load(path) else {
        return Ok(());
    };
    let triangles = whole.topology().triangle_count();
    let told = std::env::var("INCISE_PLANES").ok();
    let told = told.and_then(|n| n.parse().ok());
    let planes = told.unwrap_or_else(|| (PLANES * 1000 / triangles).clamp(2, PLANES));
    // Bodies that pass through themselves have no section to be covered once.
    let is_tame = [
        "models/sphere",
        "models/banana",
        "ok_cube",
        "ok_torus",
        "ok_hollow",
    ]
    .iter()
    .any(|tame| name.contains(tame));
    let bounds = whole.bounds();
    let extent = |n: &Vec3| {
        let size =
            incise_mesh::geometry::widen(bounds.max) - incise_mesh::geometry::widen(bounds.min);
        n.abs().dot(&size) / 2.0
    };
    let mut failed = 0;
    for i in 0..planes {
        let (normal, place) = plane(i);
        let d = normal.dot(&bounds.center()) + 0.95 * place * extent(&normal);
        let sweep = Sweep::across_box(normal.into(), d, &bounds).map_err(|e| e.to_string())?;
        for snap in [0.0, 0.1] {
            let mut surface = whole.clone();
            let mut cutter = Cutter::new(&whole);
            let result = if triangles < LARGE {
                cut_and_check(&mut surface, &mut cutter, &sweep, &params(snap))
            } else {
                let result = cutter.cut(&mut surface, &sweep, &params(snap));
                assert_sound(&surface);
                result
            };
            let outcome = result.map_err(|e| format!("plane {i}, snap {snap}: {e}"))?;
            let change = relative_change(&whole, &surface);
            let bound = if snap == 0.0 { 1e-5 } else { 2e-3 };
            if change > bound {
                return Err(format!("plane {i}, snap {snap}: volume changed by {change}").into());
            }
            if snap == 0.0 && is_tame && !outcome.delta.is_empty() {
                assert_section_is_covered(&whole, &surface, &sweep, &params(snap), &outcome);
            }
            failed += usize::from(outcome.delta.is_empty());
        }
    }
    if failed == 2 * planes {
        return Err("no plane met the mesh".into());
    }
    Ok(())
}

/// How much volume came or went, relative to what the pieces have without signs.
fn relative_change(before: &Surface, after: &Surface) -> f64 {
    let volumes = after.piece_volumes();
    let sum: f64 = volumes.iter().map(|v| v.abs()).sum();
    (volumes.iter().sum::<f64>() - before.volume()).abs() / sum
}

/// A row of the table: the plane `normal . x = d`, then the positive and the negative side.
#[derive(Debug, Clone, Copy)]
struct Reference {
    plane: usize,
    normal: [f64; 3],
    d: f64,
    volume: [f64; 2],
    section_area: f64,
    components: [usize; 2],
    genus: [i64; 2],
}

fn rows(text: &str) -> BTreeMap<String, Vec<Reference>> {
    let mut out: BTreeMap<String, Vec<Reference>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |i: usize| -> f64 { cells[i].parse().expect("a number") };
        let count = |i: usize| -> usize { cells[i].parse().expect("a count") };
        let genus = |i: usize| -> i64 { cells[i].parse().expect("a genus") };
        out.entry(cells[0].to_owned()).or_default().push(Reference {
            plane: count(1),
            normal: [number(2), number(3), number(4)],
            d: number(5),
            volume: [number(6), number(7)],
            section_area: number(8),
            components: [count(9), count(10)],
            genus: [genus(11), genus(12)],
        });
    }
    out
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

/// What is found on the two sides of the plane.
#[derive(Debug, Default)]
struct Side {
    volume: f64,
    components: usize,
    euler: i64,
}

fn agrees(whole: &Surface, row: &Reference, snap: f64) -> Result<(), String> {
    let mut surface = whole.clone();
    let sweep = Sweep::across_box(row.normal, row.d, &surface.bounds()).expect("a plane");
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
        // The corners of the sweep are rounded too: the plane is off by that, over the section.
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

/// The area of one lip's caps.
fn cap_area(surface: &Surface, outcome: &CutOutcome) -> f64 {
    let area = |t| area_vector(surface.triangle_positions(t)).norm() / 2.0;
    outcome.cap.iter().map(|&t| area(t)).sum::<f64>() / 2.0
}

/// How high the center of every piece's volume is above the plane.
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
