//! How often a cut fails: many planes through ten bodies, or through every mesh of a folder, and every law
//! after each cut.

use clap::Parser;
use incise_cut::CutParams;
use incise_mesh::{Model, Surface, build_model, read_mesh, torus};
use incise_tests::{Body, Deformation, Planes, Shape, shells};
use rayon::prelude::*;
use std::error::Error;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Cuts bodies along planes that are spread evenly, exactly, with the default snapping and with remeshing
/// too, and counts cuts that were refused and cuts after which a law of `tests/src/laws` does not hold. Exits
/// with 1 if there were any.
#[derive(Parser)]
struct Arguments {
    /// Planes for each body.
    #[arg(long, value_name = "N", default_value_t = 2000)]
    planes: usize,
    /// Cut every mesh of this folder that is a closed surface, instead of the built-in bodies.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Only bodies whose names contain one of these, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Leave out larger bodies.
    #[arg(long, value_name = "N", default_value_t = 40_000)]
    max_triangles: usize,
    /// Cut a third time, with snapping and this much remeshing in local edge lengths; 0 does not.
    #[arg(long, value_name = "T", default_value_t = 0.1)]
    remesh: f64,
}

/// What became of many cuts.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    done: usize,
    missed: usize,
    refused: usize,
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
struct Subject {
    name: String,
    surface: Surface,
    /// Whether it is known not to pass through itself.
    is_tame: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse(), &mut io::stdout().lock()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            // Without an error output the exit code has to do.
            let _ = writeln!(io::stderr(), "incise-laws: {error}");
            ExitCode::from(2)
        }
    }
}

/// Cuts and prints; returns how many cuts failed.
fn run(arguments: &Arguments, out: &mut impl Write) -> Result<usize, Box<dyn Error>> {
    let mut subjects = match &arguments.models {
        Some(folder) => meshes(folder)?,
        None => built_in(),
    };
    subjects.retain(|s| {
        let is_named = arguments.only.iter().any(|part| s.name.contains(part));
        s.surface.topology().triangle_count() <= arguments.max_triangles
            && (arguments.only.is_empty() || is_named)
    });
    if subjects.is_empty() {
        return Err("no body is left to cut: see --models, --only and --max-triangles".into());
    }
    let mut ways = vec![(0.0, 0.0), (0.1, 0.0)];
    if arguments.remesh != 0.0 {
        ways.push((0.1, arguments.remesh));
    }
    let mut all = Tally::default();
    for subject in &subjects {
        let tally = cut(subject, arguments.planes, &ways);
        writeln!(
            out,
            "{:<28} {:>7} triangles: {:>5} cuts, {:>4} planes beside it, {} refused, laws broken: {}",
            subject.name,
            subject.surface.topology().triangle_count(),
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
        "Failed: {} of {} cuts of {} bodies; laws broken: {}.",
        all.failed(),
        all.done + all.failed(),
        subjects.len(),
        all.broken
    )?;
    Ok(all.failed())
}

/// Cuts a subject with each of these values of snap and remesh.
fn cut(subject: &Subject, planes: usize, ways: &[(f64, f64)]) -> Tally {
    let body = Planes {
        whole: &subject.surface,
        is_tame: subject.is_tame,
        every_law: true,
    };
    let one = |(i, (snap, remesh))| {
        let params = CutParams {
            snap,
            remesh,
            ..CutParams::default()
        };
        // Laws are assertions; what they say goes to the error output with the plane after it.
        let fate = catch_unwind(AssertUnwindSafe(|| body.cut_with(i, &params)));
        let mut tally = Tally::default();
        let complaint = match fate {
            Ok(Ok(true)) => return Tally { done: 1, ..tally },
            Ok(Ok(false)) => return Tally { missed: 1, ..tally },
            Ok(Err(error)) => {
                tally.refused = 1;
                error.to_string()
            }
            Err(_) => {
                tally.broken = 1;
                "a law does not hold".to_owned()
            }
        };
        let name = &subject.name;
        let _ = writeln!(
            io::stderr(),
            "{name}, plane {i}, snap {snap}, remesh {remesh}: {complaint}"
        );
        tally
    };
    let cuts = (0..planes)
        .into_par_iter()
        .flat_map_iter(|i| ways.iter().map(move |&way| (i, way)));
    cuts.map(one).reduce(Tally::default, Tally::sum)
}

/// The seven models, a body with a handle, one in shells and one that passes through itself.
fn built_in() -> Vec<Subject> {
    let mut out: Vec<Subject> = (Model::ALL.into_iter())
        .map(|model| Subject {
            name: model.name().to_owned(),
            surface: build_model(model),
            is_tame: true,
        })
        .collect();
    let wild = Body {
        shape: Shape::Icosphere(3),
        deformation: Deformation::Wild(0.2),
        lattice: None,
        seed: 1,
    };
    let more = [
        ("Torus", torus(0.4, 0.15, 48, 24), true),
        ("Shells", shells(3), true),
        ("Wild", wild.build(), false),
    ];
    out.extend(more.map(|(name, surface, is_tame)| Subject {
        name: name.to_owned(),
        surface,
        is_tame,
    }));
    out
}

/// Every closed surface of a folder, by name. Whether scans pass through themselves is not known.
fn meshes(folder: &Path) -> io::Result<Vec<Subject>> {
    let entries: io::Result<Vec<_>> = std::fs::read_dir(folder)?.collect();
    let mut paths: Vec<PathBuf> = entries?.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    let closed = paths.into_iter().filter_map(|path| {
        let (surface, _) = read_mesh(&path).ok()?.into_surface().ok()?;
        let name = path.file_name()?.to_string_lossy().into_owned();
        Some(Subject {
            name,
            surface,
            is_tame: false,
        })
    });
    Ok(closed.collect())
}
