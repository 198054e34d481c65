//! The program `incise-invariants`: cuts bodies along many planes, checks all invariants after each
//! cut and counts failures.

use clap::Parser;
use incise_cut::CutParams;
use incise_mesh::{Surface, read_mesh, torus};
use incise_models::{Model, build_model};
use incise_tests::{Body, Deformation, Planes, Shape, shells};
use rayon::prelude::*;
use std::error::Error;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Counts failed cuts and broken invariants over evenly distributed planes.
///
/// Cuts each body by the exact method without snapping, with the default snapping, and with
/// remeshing. Exits with 1 if a cut failed or broke an invariant.
#[derive(Parser)]
struct Arguments {
    /// Number of planes per body.
    #[arg(long, value_name = "N", default_value_t = 2000)]
    planes: usize,
    /// Cuts the closed surfaces of this folder instead of the built-in bodies.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Cuts only bodies whose names contain one of these, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Skips bodies with more triangles.
    #[arg(long, value_name = "N", default_value_t = 40_000)]
    max_triangles: usize,
    /// Remeshing of the third cut, in local edge lengths; 0 skips it.
    #[arg(long, value_name = "T", default_value_t = 0.1)]
    remesh: f64,
}

/// Counts of cuts by result.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    done: usize,
    missed: usize,
    /// Cuts that returned an error.
    refused: usize,
    /// Cuts that broke an invariant.
    broken: usize,
}

impl Tally {
    fn sum(self, other: Self) -> Self {
        Self {
            done: self.done + other.done,
            missed: self.missed + other.missed,
            refused: self.refused + other.refused,
            broken: self.broken + other.broken,
        }
    }

    fn failed(self) -> usize {
        self.refused + self.broken
    }
}

/// A body to cut.
struct TestBody {
    name: String,
    surface: Surface,
    /// True if it is known not to intersect itself.
    is_embedded: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse(), &mut io::stdout().lock()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            // Without standard error the exit code remains.
            let _ = writeln!(io::stderr(), "incise-invariants: {error}");
            ExitCode::from(2)
        }
    }
}

/// Cuts and prints; returns the number of failures.
fn run(arguments: &Arguments, out: &mut impl Write) -> Result<usize, Box<dyn Error>> {
    let mut bodies = match &arguments.models {
        Some(folder) => meshes(folder)?,
        None => built_in(),
    };
    bodies.retain(|s| {
        let is_named = arguments.only.iter().any(|part| s.name.contains(part));
        s.surface.topology().triangle_count() <= arguments.max_triangles
            && (arguments.only.is_empty() || is_named)
    });
    if bodies.is_empty() {
        return Err("no body to cut; change --models, --only or --max-triangles".into());
    }
    let mut settings = vec![(0.0, 0.0), (0.1, 0.0)];
    if arguments.remesh != 0.0 {
        settings.push((0.1, arguments.remesh));
    }
    let mut all = Tally::default();
    for body_to_cut in &bodies {
        let tally = cut(body_to_cut, arguments.planes, &settings);
        writeln!(
            out,
            "{:<28} {:>7} triangles: {:>5} cuts, {:>4} misses, {} refused, {} invariants broken",
            body_to_cut.name,
            body_to_cut.surface.topology().triangle_count(),
            tally.done + tally.failed(),
            tally.missed,
            tally.refused,
            tally.broken
        )?;
        out.flush()?;
        all = all.sum(tally);
    }
    writeln!(
        out,
        "Failed: {} of {} cuts of {} bodies; {} invariants broken.",
        all.failed(),
        all.done + all.failed(),
        bodies.len(),
        all.broken
    )?;
    Ok(all.failed())
}

/// Cuts a body along all planes with each pair of snap and remesh.
fn cut(body_to_cut: &TestBody, planes: usize, settings: &[(f64, f64)]) -> Tally {
    let body = Planes {
        whole: &body_to_cut.surface,
        is_embedded: body_to_cut.is_embedded,
        all_invariants: true,
    };
    let one = |(i, (snap, remesh))| {
        let params = CutParams {
            snap,
            remesh,
            ..CutParams::default()
        };
        // Invariants are assertions, whose messages go to standard error.
        let result = catch_unwind(AssertUnwindSafe(|| body.cut_with(i, &params)));
        let mut tally = Tally::default();
        let message = match result {
            Ok(Ok(true)) => return Tally { done: 1, ..tally },
            Ok(Ok(false)) => return Tally { missed: 1, ..tally },
            Ok(Err(error)) => {
                tally.refused = 1;
                error.to_string()
            }
            Err(_) => {
                tally.broken = 1;
                "an invariant is broken".to_owned()
            }
        };
        let name = &body_to_cut.name;
        let _ = writeln!(
            io::stderr(),
            "{name}, plane {i}, snap {snap}, remesh {remesh}: {message}"
        );
        tally
    };
    let cuts = (0..planes)
        .into_par_iter()
        .flat_map_iter(|i| settings.iter().map(move |&pair| (i, pair)));
    cuts.map(one).reduce(Tally::default, Tally::sum)
}

/// Returns the seven models, a torus, nested shells and a self-intersecting body.
fn built_in() -> Vec<TestBody> {
    let mut out: Vec<TestBody> = (Model::ALL.into_iter())
        .map(|model| TestBody {
            name: model.name().to_owned(),
            surface: build_model(model),
            is_embedded: true,
        })
        .collect();
    let self_intersecting = Body {
        shape: Shape::Icosphere(3),
        deformation: Deformation::SelfIntersecting(0.2),
        lattice: None,
        seed: 1,
    };
    let more = [
        ("Torus", torus(0.4, 0.15, 48, 24), true),
        ("Shells", shells(3), true),
        ("Self-intersecting", self_intersecting.build(), false),
    ];
    out.extend(more.map(|(name, surface, is_embedded)| TestBody {
        name: name.to_owned(),
        surface,
        is_embedded,
    }));
    out
}

/// Returns the closed surfaces of a folder by name, which may intersect themselves.
fn meshes(folder: &Path) -> io::Result<Vec<TestBody>> {
    let entries: io::Result<Vec<_>> = std::fs::read_dir(folder)?.collect();
    let mut paths: Vec<PathBuf> = entries?.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    let closed = paths.into_iter().filter_map(|path| {
        let (surface, _) = read_mesh(&path).ok()?.into_surface().ok()?;
        let name = path.file_name()?.to_string_lossy().into_owned();
        Some(TestBody {
            name,
            surface,
            is_embedded: false,
        })
    });
    Ok(closed.collect())
}
