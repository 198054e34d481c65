//! A sheet that falls on a held ball.

use super::case::{Case, larger};
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::place;
use incise_mesh::{Vec3, icosphere, sheet};
use incise_pbd_gpu::Material;
use incise_scene::BackendRequest;

pub(super) const CASES: [Case; 1] = [Case {
    id: "drape",
    stress: "a sheet falls on a held ball, with either side up",
    invariant: "depth of a vertex of the sheet in the ball, or of all of the sheet below its top, \
                in radii",
    bound: 0.05,
    run: |runner| worst_of(runner, 0, fall),
}];

/// Radius of the ball \[m\].
const RADIUS: f64 = 0.5;

fn fall(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let cells = runner.pick(16, 40);
    Ok(runner.each(&[1.0, -1.0], |backend, &side| Measured {
        at: format!("outer side {}", if side > 0.0 { "up" } else { "down" }),
        quantities: drape(backend, side, cells),
    }))
}

fn drape(backend: &BackendRequest, side: f64, cells: u32) -> Result<Quantities, StressError> {
    let ball = icosphere(3, RADIUS);
    let mut cloth = sheet([1.6; 2], [cells; 2]);
    place(&mut cloth, |p| Vec3::new(p.x, RADIUS + 0.1, -side * p.y));
    let parts = (&[ball, cloth][..], Grouping::Bodies);
    let mut group = Group::new(backend, touching(9.81, None), parts, &Material::default())?;
    group.pin(0, |_| true)?;
    let mut worst = 0.0;
    for _ in 0..180 {
        group.step()?;
        let points = group.positions(1)?;
        let top = points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let inside = points.iter().map(|p| RADIUS - p.norm()).fold(0.0, larger);
        worst = larger(worst, larger(inside, RADIUS - top) / RADIUS);
    }
    Ok(vec![Some(worst)])
}
