//! Measures a cut from arrays to arrays: build the surface, cut it by a plane, copy the pieces.
//!
//! `cargo run --release -p incise-bench --example time_cuts -- bunny.obj`; without a file it cuts a
//! sphere. `crates/python/examples/compare.py` measures the same cuts from Python.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, icosphere, read_mesh};
use std::error::Error;
use std::f64::consts::PI;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Number of planes.
const COUNT: u32 = 50;

/// A mesh as arrays.
struct Arrays {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

fn arrays(surface: &Surface) -> Arrays {
    let topology = surface.topology();
    let corners = |t| topology.triangle(t).map(|v| v.0);
    let positions = surface.positions().iter().map(|&[x, y, z, _]| [x, y, z]);
    Arrays {
        positions: positions.collect(),
        triangles: topology.triangles().map(corners).collect(),
    }
}

/// Cuts by a plane through the middle of the bounding box.
fn cut(mesh: &Arrays, normal: Vec3) -> Result<Vec<Arrays>, Box<dyn Error>> {
    let mut surface = Surface::from_triangles(&mesh.positions, &mesh.triangles)?;
    let bounds = surface.bounds();
    let plane = Sweep::from_plane(normal.into(), normal.dot(&bounds.center()), &bounds)?;
    let mut cutter = Cutter::new(&surface);
    let outcome = cutter.cut(&mut surface, &plane, &CutParams::default());
    assert!(!outcome?.is_miss(), "the plane is in the middle");
    let pieces = surface.extract_pieces();
    Ok(pieces.map(|(_, piece)| arrays(&piece)).collect())
}

/// Returns direction `k` of those all around: a Fibonacci sphere.
fn normal(k: u32) -> Vec3 {
    let z = 1.0 - f64::from(2 * k + 1) / f64::from(COUNT);
    let (sin, cos) = (f64::from(k) * PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

fn main() -> Result<(), Box<dyn Error>> {
    let surface = match std::env::args_os().nth(1) {
        Some(path) => read_mesh(&PathBuf::from(path))?.into_surface()?.0,
        None => icosphere(3, 0.5),
    };
    let input = arrays(&surface);
    let mut times: Vec<Duration> = Vec::new();
    for k in 0..COUNT {
        let begin = Instant::now();
        let pieces = cut(&input, normal(k)).map_err(|error| format!("plane {k}: {error}"))?;
        times.push(begin.elapsed());
        drop(pieces);
    }
    times.sort_unstable();
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    println!(
        "{} triangles, {COUNT} planes: median {:.3} ms, fastest {:.3} ms",
        input.triangles.len(),
        ms(times[times.len() / 2]),
        ms(times[0])
    );
    Ok(())
}
