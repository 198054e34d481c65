//! Fills the holes of every open mesh in the folders of shared models beside the workspace.
//!
//! A missing folder shows as an ignored test.

use incise_mesh::{Surface, check, read_mesh, write_ply};
use incise_refine::{HoleParams, fill_holes};
use libtest_mimic::{Arguments, Failed, Trial};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let mut trials = Vec::new();
    for folder in ["torture", "models"].map(|name| shared.join(name)) {
        let Ok(files) = std::fs::read_dir(&folder) else {
            let name = format!("{} is absent", folder.display());
            trials.push(Trial::test(name, || Ok(())).with_ignored_flag(true));
            continue;
        };
        let mut files: Vec<PathBuf> = files.filter_map(|f| Some(f.ok()?.path())).collect();
        files.sort_unstable();
        for path in files {
            if let Some(surface) = open_surface(&path) {
                for (fair, name) in [(false, ""), (true, ", faired")] {
                    let (path, surface) = (path.clone(), surface.clone());
                    let name = format!("{}{name}", path.file_name().unwrap().display());
                    trials.push(Trial::test(name, move || fill(&path, &surface, fair)));
                }
            }
        }
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// Returns the surface of a file if it can be read and has holes.
fn open_surface(path: &Path) -> Option<Surface> {
    let (surface, _) = read_mesh(path).ok()?.into_open_surface().ok()?;
    (!surface.topology().is_closed()).then_some(surface)
}

fn fill(path: &Path, open: &Surface, fair: bool) -> Result<(), Failed> {
    let params = HoleParams {
        fair: fair && cfg!(feature = "fair"),
        ..HoleParams::default()
    };
    let mut surface = open.clone();
    let filled = fill_holes(&mut surface, &params)?;
    let topology = surface.topology();
    topology.validate()?;
    if !topology.is_closed() {
        return Err("there is a boundary left".into());
    }
    let euler = |s: &Surface| {
        let count = |n: usize| i64::try_from(n).unwrap();
        let topology = s.topology();
        count(topology.vertices().count()) - count(topology.edges().count())
            + count(topology.triangle_count())
    };
    let discs = i64::try_from(filled.holes.len())?;
    if euler(&surface) != euler(open) + discs {
        return Err(format!("Euler characteristic {}", euler(&surface)).into());
    }
    // The file checks must find it closed and manifold as well.
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("out.ply");
    write_ply(&out, &surface)?;
    let report = check(&read_mesh(&out)?);
    if report.open_edges > 0 || report.nonmanifold_edges > 0 {
        return Err(format!("{}: {:?}", path.display(), report.defects).into());
    }
    let bounds = [open, &surface].map(Surface::bounds);
    let (small, large) = (bounds[0].diagonal(), bounds[1].diagonal());
    if large > 1.1 * small {
        return Err(format!("the box grew from {small} to {large}").into());
    }
    Ok(())
}
