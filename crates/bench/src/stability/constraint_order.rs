//! Bodies at rest with their constraints in other orders.

use super::case::{Case, Outcome, Worst, larger};
use super::energy::{Limits, within_limits};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::{FRAME, HANGING};
use crate::directions::Directions;
use incise_mesh::{Surface, VertexId};
use incise_models::sheet;
use incise_pbd_gpu::{Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 1] = [Case {
    id: "T20",
    stress: "a sheet at rest with its constraints in random orders",
    invariant: "distance from the state of the first order [m]",
    bound: 1e-4,
    run: orders,
}];

/// Returns the largest distance along an axis between vertices of two states \[m\].
fn apart(one: &[[f32; 4]], other: &[[f32; 4]]) -> f64 {
    let pairs = one.iter().zip(other);
    let way = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..3)
            .map(|k| f64::from((a[k] - b[k]).abs()))
            .fold(0.0, larger)
    };
    pairs.map(way).fold(0.0, larger)
}

/// Returns a surface with vertices and triangles in a random order, and the new index of each
/// vertex.
fn renumbered(surface: &Surface, seed: u64) -> Result<(Surface, Vec<usize>), StressError> {
    let topology = surface.topology();
    let mut directions = Directions(seed);
    let mut shuffled = |count: usize| {
        let mut keyed: Vec<(f64, usize)> = (0..count).map(|i| (directions.next(), i)).collect();
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        keyed.into_iter().map(|(_, i)| i).collect::<Vec<usize>>()
    };
    let order = shuffled(surface.positions().len());
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let points: Vec<[f32; 3]> = order
        .iter()
        .map(|&old| surface.rest_positions()[old])
        .collect();
    let triangles: Vec<_> = topology.triangles().collect();
    let faces: Vec<[u32; 3]> = shuffled(triangles.len())
        .into_iter()
        .map(|t| {
            let new = |v: VertexId| VertexId::from_index(place[v.index()]).0;
            topology.triangle(triangles[t]).map(new)
        })
        .collect();
    Ok((Surface::from_triangles(&points, &faces)?, place))
}

/// Returns the rest state of a surface that hangs by `pins`, in the old vertex order.
fn at_rest(
    runner: &mut Runner,
    surface: &Surface,
    pins: &[VertexId],
    seed: Option<u64>,
) -> Result<(Vec<[f32; 4]>, Outcome), StressError> {
    let (surface, place) = match seed {
        Some(seed) => renumbered(surface, seed)?,
        None => (surface.clone(), (0..surface.positions().len()).collect()),
    };
    let material = Material {
        stretch: Stiffness::Compliance(0.02),
        bending: None,
        damping: 5.0,
        ..Material::default()
    };
    let mut body = runner.enter(surface, &material)?;
    for pin in pins {
        let pin = VertexId::from_index(place[pin.index()]);
        body.solver.pin(&mut body.surface, pin)?;
    }
    let params = SolverParams {
        iterations: 40,
        ..HANGING
    };
    let kept = within_limits(&mut body, FRAME, &params, 600, Limits::above(-2.0))?;
    let places = place.iter().map(|&new| body.surface.positions()[new]);
    Ok((places.collect(), kept))
}

fn orders(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let surface = sheet([6, 6], [1.0, 1.0]);
    let pins: Vec<VertexId> = (0..7).map(VertexId).collect();
    let (first, _) = at_rest(runner, &surface, &pins, None)?;
    for seed in 1..=runner.pick(1, 10) {
        let outcome = at_rest(runner, &surface, &pins, Some(seed));
        let outcome = outcome.map(|(other, outcome)| outcome.by(apart(&first, &other)));
        worst.judge(outcome, || format!("order {seed}"));
    }
    Ok(worst)
}
