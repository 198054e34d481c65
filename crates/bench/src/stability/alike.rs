//! The same answer from any number of threads, and in any order of constraints.

use super::audit::{Rule, keeping};
use super::case::{Case, Found, Worst, larger};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, HANGING, double_cone, elastic_shell, sheet};
use super::stage::Stage;
use crate::directions::Directions;
use incise_mesh::{Surface, VertexId, cube_sphere};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T17",
        torture: "1 to 64 threads; a device twice",
        law: "coordinates of other bits",
        bound: 0.0,
        run: threads,
    },
    Case {
        id: "T20",
        torture: "a sheet at rest, its constraints in any order of colors",
        law: "way from the first order's [m]",
        bound: 1e-4,
        run: orders,
    },
    Case {
        id: "T20",
        torture: "a cone of valence 200: a giant color, tiny ones and what has none",
        law: "way from the first order's [m]",
        bound: 1e-4,
        run: fan_orders,
    },
];

/// The largest distance along an axis between vertices of two bodies \[m\].
pub(super) fn apart(one: &[[f32; 4]], other: &[[f32; 4]]) -> f64 {
    let pairs = one.iter().zip(other);
    let way = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..3)
            .map(|k| f64::from((a[k] - b[k]).abs()))
            .fold(0.0, larger)
    };
    pairs.map(way).fold(0.0, larger)
}

fn threads(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let on_device = stage.device.is_some();
    let frames = stage.pick(1, 20);
    // Its colors are large enough to be shared among threads.
    let squares = if on_device { 8 } else { 64 };
    let material = elastic_shell(1e-5, 1e-2);
    let mut moved = |threads: usize| -> Result<Vec<[f32; 4]>, Failure> {
        let mut surface = cube_sphere(squares, 0.5);
        let mut solver = Solver::new(&mut surface, &material)?;
        crate::motion::start(&mut solver, &surface)?;
        let mut mover = stage.enter_with(surface, solver)?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| Failure::Device(error.to_string()))?;
        if on_device {
            mover.advance(FRAME, &GROUND, frames)?;
        } else {
            let (surface, solver) = (&mut mover.surface, &mut mover.solver);
            pool.install(|| -> Result<(), Failure> {
                for _ in 0..frames {
                    solver.step(surface, FRAME, &GROUND)?;
                }
                Ok(())
            })?;
        }
        Ok(mover.surface.positions.clone())
    };
    let first = moved(1)?;
    let counts: &[usize] = if on_device { &[1] } else { &[2, 3, 4, 16, 64] };
    for &count in counts {
        let found = moved(count).map(|other| {
            let coordinates = first.as_flattened().iter().zip(other.as_flattened());
            let differ = coordinates.filter(|(a, b)| a.to_bits() != b.to_bits());
            differ.count() as f64
        });
        worst.judge(found, || format!("{count} threads"));
    }
    Ok(worst)
}

/// The same surface with its vertices numbered and its triangles listed in another order; tells where each
/// vertex went.
fn renumbered(surface: &Surface, seed: u64) -> Result<(Surface, Vec<usize>), Failure> {
    let topology = surface.topology();
    let mut directions = Directions(seed);
    let mut shuffled = |count: usize| {
        let mut keyed: Vec<(f64, usize)> = (0..count).map(|i| (directions.next(), i)).collect();
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        keyed.into_iter().map(|(_, i)| i).collect::<Vec<usize>>()
    };
    let order = shuffled(surface.positions.len());
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let points: Vec<[f32; 3]> = order.iter().map(|&old| surface.rest[old]).collect();
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

/// Where a surface comes to rest that hangs by some vertices, by old numbers.
fn at_rest(
    stage: &mut Stage,
    surface: &Surface,
    pins: &[VertexId],
    seed: Option<u64>,
    iterations: u32,
) -> Result<(Vec<[f32; 4]>, Found), Failure> {
    let (surface, place) = match seed {
        Some(seed) => renumbered(surface, seed)?,
        None => (surface.clone(), (0..surface.positions.len()).collect()),
    };
    let material = Material {
        stretch: Stiffness::Compliance(0.02),
        bending: None,
        damping: 5.0,
        ..Material::default()
    };
    let mut mover = stage.enter(surface, &material)?;
    for pin in pins {
        let pin = VertexId::from_index(place[pin.index()]);
        mover.solver.pin(&mut mover.surface, pin)?;
    }
    let params = SolverParams {
        iterations,
        ..HANGING
    };
    let kept = keeping(&mut mover, FRAME, &params, 600, Rule::above(-2.0))?;
    let places = place.iter().map(|&new| mover.surface.positions[new]);
    Ok((places.collect(), kept))
}

fn in_any_order(
    stage: &mut Stage,
    surface: &Surface,
    pins: &[VertexId],
    iterations: u32,
) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let (first, _) = at_rest(stage, surface, pins, None, iterations)?;
    for seed in 1..=stage.pick(1, 10) {
        let found = at_rest(stage, surface, pins, Some(seed), iterations);
        let found = found.map(|(other, kept)| kept.by(apart(&first, &other)));
        worst.judge(found, || format!("order {seed}"));
    }
    Ok(worst)
}

fn orders(stage: &mut Stage) -> Result<Worst, Failure> {
    let surface = sheet([6, 6], [1.0, 1.0])?;
    let pins: Vec<VertexId> = (0..7).map(VertexId).collect();
    in_any_order(stage, &surface, &pins, 40)
}

fn fan_orders(stage: &mut Stage) -> Result<Worst, Failure> {
    let surface = double_cone(200)?;
    let pins: Vec<VertexId> = (2..202).map(VertexId).collect();
    in_any_order(stage, &surface, &pins, 40)
}
