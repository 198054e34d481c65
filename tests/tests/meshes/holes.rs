//! Fills the holes of every open mesh.

use crate::reference_table::{files, shared_folder};
use incise_mesh::{Surface, check, read_mesh, write_ply};
use incise_refine::{HoleParams, fill_holes};
use libtest_mimic::{Failed, Trial};
use std::path::Path;

pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    let folders = ["torture", "models"].map(|name| files(&shared_folder().join(name)));
    for path in folders.into_iter().flatten() {
        let Some(surface) = open_surface(&path) else {
            continue;
        };
        for (fair, name) in [(false, ""), (true, ", faired")] {
            let (path, surface) = (path.clone(), surface.clone());
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            let name = format!("holes::{file}{name}");
            trials.push(Trial::test(name, move || fill(&path, &surface, fair)));
        }
    }
    trials
}

/// Returns the surface of a file if it can be read and has holes.
fn open_surface(path: &Path) -> Option<Surface> {
    let (surface, _) = read_mesh(path).ok()?.into_open_surface().ok()?;
    (!surface.topology().is_closed()).then_some(surface)
}

fn fill(path: &Path, open: &Surface, fair: bool) -> Result<(), Failed> {
    let params = HoleParams {
        fair,
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
