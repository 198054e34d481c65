//! Single bodies over time steps, compliances, scales, pins and orders of constraints.

use super::runner::Runner;
use super::{Case, Found, Outcome, Run, larger};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, Surface, Vec3, VertexId, icosphere, nearby_origin};
use incise_models::scenes::{Directions, FRAME};
use incise_models::{place, sheet};
use incise_pbd_gpu::{Material, SolverParams, Stiffness};
use incise_test_support::energy::Limits;
use incise_test_support::materials::{elastic_shell, shells};
use incise_test_support::params::TEN_ITERATIONS;

/// The invariant of an energy.
pub(super) const ENERGY: (&str, f64) = ("largest energy, relative to the start", 1.01);

pub(super) const CASES: [Case; 6] = [
    Case {
        id: "T1",
        stress: "time step 1/15 to 1/60000 s",
        invariants: &[ENERGY],
        run: time_steps,
    },
    Case {
        id: "T2",
        stress: "compliance 0, 1e-12 to 1e2",
        invariants: &[ENERGY],
        run: compliances,
    },
    Case {
        id: "T8",
        stress: "bodies of 1 mm to 1 km",
        invariants: &[ENERGY],
        run: scales,
    },
    Case {
        id: "T8",
        stress: "fall of 1 s at 1e4 and 1e6 m from the origin, 60 and 1200 substeps a second",
        invariants: &[("relative error of the distance", 1e-3)],
        run: far,
    },
    Case {
        id: "T20",
        stress: "a sheet at rest with its constraints in random orders",
        invariants: &[("distance from the state of the first order [m]", 1e-4)],
        run: orders,
    },
    Case {
        id: "contradiction",
        stress: "two pins 10 times as far apart as the sheet is wide, then one let go",
        invariants: &[("largest strain 10 s after", 0.05)],
        run: contradiction,
    },
];

/// Returns a sphere of radius 0.5 m around a point at a height \[m\].
pub(super) fn ball(subdivisions: u32, height: f64) -> Surface {
    let mut surface = icosphere(subdivisions, 0.5);
    place(&mut surface, |p| p + Vec3::new(0.0, height, 0.0));
    surface
}

/// Rounds up to a whole number of steps.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a positive number"
)]
pub(super) fn whole(x: f32) -> u32 {
    x.ceil() as u32
}

/// Drops a ball onto the ground and returns its largest relative energy.
fn dropped(
    runner: &Runner,
    material: &Material,
    params: &SolverParams,
    dt: f32,
    frames: u32,
    recovers: bool,
) -> Found<Outcome> {
    let mut body = runner.body_on_ground(ball(1, 0.55), material)?;
    let limits = Limits::above(0.0).within(3.0).recovering_if(recovers);
    body.energy_over(dt, params, frames, limits)
}

fn time_steps(runner: &Runner) -> Vec<Run> {
    let rates = [15.0_f32, 30.0, 60.0, 240.0, 1000.0, 6000.0, 60_000.0];
    let runs = rates.into_iter().flat_map(|rate| {
        let of = move |shell| [1, 10].map(|iterations| (rate, shell, iterations));
        shells().into_iter().flat_map(of)
    });
    let runs: Vec<(f32, (&str, Material), u32)> = runs.collect();
    runner.each(&runs, |&(rate, (name, material), iterations)| {
        // Half a second, which holds the impact, or what fits.
        let frames = if rate > 6000.0 { 12_000 } else { 3000 };
        let params = SolverParams {
            iterations,
            ..TEN_ITERATIONS
        };
        Run::new(
            format!("1/{rate} s, {name}, {iterations} iterations"),
            dropped(runner, &material, &params, 1.0 / rate, frames, true),
        )
    })
}

fn compliances(runner: &Runner) -> Vec<Run> {
    let all = std::iter::once(0.0).chain((-12..=2).map(|e| 10.0_f32.powi(e)));
    let of = |stretch: f32| {
        [stretch, 1e-8 / stretch.max(1e-12), 1e-4, 1e-2].map(|bending| (stretch, bending))
    };
    let runs: Vec<(f32, f32)> = all.flat_map(of).collect();
    let ways = [
        (1, 1, 0.5),
        (10, 1, 0.5),
        (1, 10, 0.5),
        (1, 16, 0.5),
        (10, 1, 1.0),
        (1, 10, 1.0),
    ];
    let found = runner.each(&runs, |&(stretch, bending)| {
        ways.map(|(iterations, substeps, diagonal_scale)| {
            let params = SolverParams {
                iterations,
                diagonal_scale,
                lift: SolverParams::default().lift,
                ..TEN_ITERATIONS
            };
            let params = params.with_substeps(FRAME, substeps);
            let material = elastic_shell(stretch, bending);
            Run::new(
                format!(
                    "{stretch:e} m/N, {bending:e} rad/(N m), {iterations} x {substeps}, \
                     diagonal scale {diagonal_scale}"
                ),
                dropped(runner, &material, &params, FRAME, 300, false),
            )
        })
    });
    found.into_iter().flatten().collect()
}

fn scales(runner: &Runner) -> Vec<Run> {
    let mut runs = Vec::new();
    for exponent in -3..=3 {
        let scale = 10.0_f64.powi(exponent);
        for (name, material) in [
            ("stiffness 1", Material::default()),
            ("compliance 0", elastic_shell(0.0, 0.0)),
            ("compliance 1e-5", elastic_shell(1e-5, 1e-2)),
        ] {
            let mut surface = ball(1, 0.6);
            place(&mut surface, |p| p * scale);
            let found = runner
                .body_on_ground(surface, &material)
                .and_then(|mut body| {
                    // The ball of 1 km (1e-5 m/N) is strained by 5.8 % at rest, with 1 to 256
                    // substeps alike: its weight would stretch an edge by its own length.
                    let masses = body.solver.masses().iter();
                    let weight = 9.81 * masses.map(|&m| f64::from(m)).sum::<f64>();
                    let stretch = match material.stretch {
                        Stiffness::Compliance(c) => {
                            weight * f64::from(c) / body.solver.mean_rest_length()
                        }
                        Stiffness::Pbd(_) => 0.0,
                    };
                    let limits = Limits::above(0.0).within(5.0 * scale);
                    let limits = limits.recovering_if(stretch < 0.5);
                    body.energy_over(FRAME, &TEN_ITERATIONS, 600, limits)
                });
            runs.push(Run::new(format!("1e{exponent} m, {name}"), found));
        }
    }
    runs
}

/// Returns the relative error of a free fall: `n (n + 1) / 2 g h^2` after `n` steps.
fn fall(runner: &Runner, distance: f64, substeps: u32) -> Found<[f64; 1]> {
    let mut surface = icosphere(0, 0.5);
    // Positions are relative to the origin that a mesh gets which is read at this distance.
    let away = |p: Vec3| p + Vec3::repeat(distance);
    let vertices = surface.topology().vertices();
    let bounds = Aabb::around(vertices.map(|v| to_f32(away(surface.position(v)))));
    surface.set_origin(nearby_origin(&bounds));
    let origin = Vec3::from(surface.origin());
    place(&mut surface, |p| away(p) - origin);
    let start: Vec<f64> = surface.positions().iter().map(|p| p[1].into()).collect();
    let mut body = runner.body(surface, &elastic_shell(1e3, 1e3))?;
    let params = SolverParams {
        iterations: 1,
        ..TEN_ITERATIONS
    };
    let params = params.with_substeps(FRAME, substeps);
    body.advance(FRAME, &params, 60)?;
    let n = 60.0 * f64::from(substeps);
    let h = f64::from(FRAME) / f64::from(substeps);
    let way = 9.81 * h * h * n * (n + 1.0) / 2.0;
    let fallen = |v: VertexId| start[v.index()] - body.surface.position(v).y;
    let all = body.surface.topology().vertices();
    Ok([all.map(|v| (fallen(v) / way - 1.0).abs()).fold(0.0, larger)])
}

fn far(runner: &Runner) -> Vec<Run> {
    let runs = [(1e4, 1), (1e4, 20), (1e6, 1), (1e6, 20)];
    let of = |(distance, substeps)| {
        let at = format!("{distance:e} m, {} substeps a second", 60 * substeps);
        Run::new(at, fall(runner, distance, substeps))
    };
    runs.map(of).into()
}

fn contradiction(runner: &Runner) -> Vec<Run> {
    // The upper corners of the sheet.
    let corners = [0, 8].map(VertexId);
    let run = |(name, material): (&str, Material)| {
        let pull = || -> Found<[f64; 1]> {
            let mut body = runner.body(sheet([8, 8], [1.0, 1.0]), &material)?;
            for v in corners {
                body.solver.pin(&mut body.surface, v)?;
            }
            body.solver.set_pin_target(corners[1], [10.0, 0.0, 0.0])?;
            body.advance(FRAME, &TEN_ITERATIONS, 600)?;
            body.solver.unpin(&mut body.surface, corners[1])?;
            body.advance(FRAME, &TEN_ITERATIONS, 600)?;
            Ok([body.largest_strain()])
        };
        Run::new(name.to_owned(), pull())
    };
    let shells = [
        ("stiffness 1", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-6", elastic_shell(1e-6, 1e-3)),
    ];
    shells.map(run).into()
}

/// Returns a surface with vertices and triangles in a random order, and the new index of each
/// vertex.
fn renumbered(surface: &Surface, seed: u64) -> Found<(Surface, Vec<usize>)> {
    let topology = surface.topology();
    let mut directions = Directions(seed);
    let mut shuffled = |count: usize| {
        let mut keyed: Vec<(f64, usize)> = (0..count).map(|i| (directions.signed(), i)).collect();
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        keyed.into_iter().map(|(_, i)| i).collect::<Vec<usize>>()
    };
    let order = shuffled(surface.positions().len());
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let rest = |&old: &usize| surface.rest_positions()[old];
    let points: Vec<[f32; 3]> = order.iter().map(rest).collect();
    let triangles: Vec<_> = topology.triangles().collect();
    let new = |v: VertexId| VertexId::from_index(place[v.index()]).0;
    let faces: Vec<[u32; 3]> = (shuffled(triangles.len()).into_iter())
        .map(|t| topology.triangle(triangles[t]).map(new))
        .collect();
    Ok((Surface::from_triangles(&points, &faces)?, place))
}

/// Returns the rest state of a hanging sheet with its parts in an order, in the old vertex order.
fn at_rest(runner: &Runner, seed: Option<u64>) -> Found<(Vec<[f32; 4]>, Outcome)> {
    let surface = sheet([6, 6], [1.0, 1.0]);
    let (surface, place) = match seed {
        Some(seed) => renumbered(&surface, seed)?,
        None => (surface, (0..49).collect()),
    };
    let material = Material {
        stretch: Stiffness::Compliance(0.02),
        bending: None,
        damping: 5.0,
        ..Material::default()
    };
    let mut body = runner.body(surface, &material)?;
    for &pin in &place[..7] {
        body.solver
            .pin(&mut body.surface, VertexId::from_index(pin))?;
    }
    let params = SolverParams {
        iterations: 40,
        ..TEN_ITERATIONS
    };
    let kept = body.energy_over(FRAME, &params, 600, Limits::above(-2.0))?;
    let places = place.iter().map(|&new| body.surface.positions()[new]);
    Ok((places.collect(), kept))
}

fn orders(runner: &Runner) -> Vec<Run> {
    let first = match at_rest(runner, None) {
        Ok((first, _)) => first,
        Err(error) => return vec![Run::new("first order".to_owned(), Err::<Outcome, _>(error))],
    };
    let way = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..3)
            .map(|k| f64::from((a[k] - b[k]).abs()))
            .fold(0.0, larger)
    };
    let run = |seed| {
        let found = at_rest(runner, Some(seed)).map(|(other, found)| {
            found.within_energy(first.iter().zip(&other).map(way).fold(0.0, larger))
        });
        Run::new(format!("order {seed}"), found)
    };
    (1..=10).map(run).collect()
}
