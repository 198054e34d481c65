//! What else could be done with the same projections: ways that the solver has and ways that it has not, in 64 bits, with
//! their total errors.
//!
//! Constraints are projected in the solver's own order, one by one; nothing is timed, so what a way costs beside its
//! projections (a warm start costs as much as an iteration) is not seen here.

use super::error::distance;
use super::scene::DT;
use crate::columns::columns;
use incise_bench::{Model, State, edge, hinge};
use nalgebra::Vector3;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::io::Write;

/// Substeps and iterations of the columns.
const GRID: [[u32; 2]; 7] = [[8, 1], [16, 1], [32, 1], [64, 1], [16, 2], [16, 4], [4, 16]];

/// The largest change of angle that one projection makes \[rad\], the solver's.
const MAX_TURN: f64 = 0.1;

/// In which order iterations go through the constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Forward,
    /// Every second iteration of a substep backward.
    ByIteration,
    /// Every second iteration of all backward.
    Throughout,
}

/// A way of stepping.
#[derive(Debug, Clone, Copy)]
struct Way {
    name: &'static str,
    is_second: bool,
    own_weight: f64,
    /// Whether a projection stops at the rest value.
    is_guarded: bool,
    order: Order,
    /// The part of the last substep's multipliers that a substep begins with.
    warm: f64,
    /// That part is less by `alpha / (alpha + warm_guard w)`.
    warm_guard: f64,
    /// The spectral radius that Chebyshev's weights are made for; 0 for none.
    chebyshev: f64,
}

const PLAIN: Way = Way {
    name: "xpbd",
    is_second: false,
    own_weight: 1.0,
    is_guarded: true,
    order: Order::Forward,
    warm: 0.0,
    warm_guard: 0.0,
    chebyshev: 0.0,
};

const SECOND: Way = Way {
    name: "second order",
    is_second: true,
    ..PLAIN
};

const BEST: Way = Way {
    name: "second order, half of own weight",
    own_weight: 0.5,
    ..SECOND
};

const WAYS: [Way; 14] = [
    PLAIN,
    Way {
        name: "half of own weight",
        own_weight: 0.5,
        ..PLAIN
    },
    SECOND,
    Way {
        name: "second order, 3/4 of own weight",
        own_weight: 0.75,
        ..SECOND
    },
    BEST,
    Way {
        name: "second order, none of own weight",
        own_weight: 0.0,
        ..SECOND
    },
    Way {
        name: "that half without a guard",
        is_guarded: false,
        ..BEST
    },
    Way {
        name: "the best, iterations to and fro",
        order: Order::ByIteration,
        ..BEST
    },
    Way {
        name: "the best, all to and fro",
        order: Order::Throughout,
        ..BEST
    },
    Way {
        name: "the best, warm start",
        warm: 1.0,
        warm_guard: 2.0,
        ..BEST
    },
    Way {
        name: "warm start",
        warm: 1.0,
        ..PLAIN
    },
    Way {
        name: "warm start by half",
        warm: 0.5,
        ..PLAIN
    },
    Way {
        name: "warm start with a guard",
        warm: 1.0,
        warm_guard: 2.0,
        ..PLAIN
    },
    Way {
        name: "Chebyshev, 0.9",
        chebyshev: 0.9,
        ..PLAIN
    },
];

/// Prints the total errors of all ways.
pub(super) fn run(
    model: &Model,
    start: &State,
    exact: &[State],
    out: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let head = GRID.map(|[substeps, iterations]| format!("{substeps}x{iterations}"));
    let mut lines = vec![line("  total error", head)];
    for way in WAYS {
        let errors = GRID.map(|[substeps, iterations]| {
            let mut motion = Motion::new(model, start, way);
            let found = motion.run(substeps, iterations, exact.len());
            format!("{:.1e}", distance(model, &found, exact))
        });
        lines.push(line(&format!("  {}", way.name), errors));
    }
    write!(out, "{}", columns(&lines, 1))?;
    Ok(())
}

fn line(name: &str, cells: [String; GRID.len()]) -> [String; GRID.len() + 1] {
    let mut cells = cells.into_iter();
    std::array::from_fn(|k| match k {
        0 => name.to_owned(),
        _ => cells.next().unwrap_or_default(),
    })
}

type Points = Vec<Vector3<f64>>;

/// A body on its way.
struct Motion<'a> {
    model: &'a Model,
    way: Way,
    weight: Vec<f64>,
    /// Positions and velocities now and a substep ago.
    now: [Points; 2],
    before: Option<[Points; 2]>,
    stretch: Vec<f64>,
    bending: Vec<f64>,
    sweeps: u64,
}

impl<'a> Motion<'a> {
    fn new(model: &'a Model, start: &State, way: Way) -> Self {
        let weight = |&m: &f64| if m > 0.0 { m.recip() } else { 0.0 };
        Self {
            model,
            way,
            weight: model.mass.iter().map(weight).collect(),
            now: [start.x.clone(), start.v.clone()],
            before: None,
            stretch: vec![0.0; model.stretch.rest.len()],
            bending: vec![0.0; model.bending.rest.len()],
            sweeps: 0,
        }
    }

    fn run(&mut self, substeps: u32, iterations: u32, frames: usize) -> Vec<State> {
        let h = f64::from(DT) / f64::from(substeps);
        let mut out = Vec::new();
        for _ in 0..frames {
            for _ in 0..substeps {
                self.substep(h, iterations);
            }
            let [x, v] = self.now.clone();
            out.push(State { x, v });
        }
        out
    }

    fn substep(&mut self, length: f64, iterations: u32) {
        let now = self.now.clone();
        let mut h = length;
        let mut from = now.clone();
        if let Some(before) = self.before.take().filter(|_| self.way.is_second) {
            h *= 2.0 / 3.0;
            for (from, before) in from.iter_mut().zip(&before) {
                for (x, before) in from.iter_mut().zip(before) {
                    *x = (*x * 4.0 - before) / 3.0;
                }
            }
        }
        let [from, velocities] = from;
        let mut x: Points = (from.iter().zip(&velocities).zip(&self.weight))
            .map(|((x, v), w)| {
                if *w > 0.0 {
                    x + (v + self.model.gravity * h) * h
                } else {
                    *x
                }
            })
            .collect();
        self.begin(&now[0], &mut x, h);
        let touched = self.iterate(&mut x, h, iterations);
        let v = x
            .iter()
            .zip(&from)
            .map(|(x, from)| (x - from) / h)
            .collect();
        self.now = [x, v];
        self.before = (!touched).then_some(now);
    }

    /// Multipliers at the start of a substep, and what they move.
    fn begin(&mut self, at: &Points, x: &mut Points, h: f64) {
        let Self { model, way, .. } = *self;
        if way.warm == 0.0 {
            self.stretch.fill(0.0);
            self.bending.fill(0.0);
            return;
        }
        let mut each = |vertices: &[usize], gradient: &[Vector3<f64>], alpha: f64, l: &mut f64| {
            let own = own_weight(&self.weight, vertices, gradient);
            *l *= way.warm;
            if way.warm_guard > 0.0 {
                *l *= alpha / (alpha + way.warm_guard * own);
            }
            for (&v, g) in vertices.iter().zip(gradient) {
                x[v] += g * (self.weight[v] * *l);
            }
        };
        for (vertices, l) in model.stretch.vertices.iter().zip(&mut self.stretch) {
            if let Some(measure) = edge(&vertices.map(|v| at[v])) {
                each(
                    vertices,
                    &measure.gradient,
                    model.stretch.compliance / (h * h),
                    l,
                );
            }
        }
        for (vertices, l) in model.bending.vertices.iter().zip(&mut self.bending) {
            if let Some(measure) = hinge(&vertices.map(|v| at[v])) {
                each(
                    vertices,
                    &measure.gradient,
                    model.bending.compliance / (h * h),
                    l,
                );
            }
        }
    }

    /// Projects all constraints; whether the ground pushed.
    fn iterate(&mut self, x: &mut Points, h: f64, iterations: u32) -> bool {
        let mut touched = false;
        let (mut last, mut older) = (x.clone(), x.clone());
        let mut omega = 1.0;
        for iteration in 0..iterations {
            let backward = match self.way.order {
                Order::Forward => false,
                Order::ByIteration => iteration % 2 == 1,
                Order::Throughout => self.sweeps % 2 == 1,
            };
            self.sweeps += 1;
            let (edges, hinges) = (self.stretch.len(), self.bending.len());
            if backward {
                (0..hinges).rev().for_each(|i| self.bend(x, h, i));
                (0..edges).rev().for_each(|i| self.stretch(x, h, i));
            } else {
                (0..edges).for_each(|i| self.stretch(x, h, i));
                (0..hinges).for_each(|i| self.bend(x, h, i));
            }
            if let Some(ground) = self.model.ground {
                for (x, w) in x.iter_mut().zip(&self.weight) {
                    touched |= *w > 0.0 && x.y < ground;
                    if *w > 0.0 {
                        x.y = x.y.max(ground);
                    }
                }
            }
            let radius = self.way.chebyshev;
            if radius > 0.0 {
                omega = match iteration {
                    0 => 1.0,
                    1 => 2.0 / (2.0 - radius * radius),
                    _ => 4.0 / (4.0 - radius * radius * omega),
                };
                for ((x, last), older) in x.iter_mut().zip(&mut last).zip(&mut older) {
                    if iteration > 0 {
                        *x = (*x - *older) * omega + *older;
                    }
                    *older = std::mem::replace(last, *x);
                }
            }
        }
        touched
    }

    fn stretch(&mut self, x: &mut Points, h: f64, i: usize) {
        let constraints = &self.model.stretch;
        let vertices = constraints.vertices[i];
        if let Some(measure) = edge(&vertices.map(|v| x[v])) {
            let off = measure.value - constraints.rest[i];
            let alpha = constraints.compliance / (h * h);
            let lambda = &mut self.stretch[i];
            let by = (off, alpha, f64::INFINITY);
            project(
                self.way,
                &self.weight,
                &vertices,
                &measure.gradient,
                by,
                lambda,
                x,
            );
        }
    }

    fn bend(&mut self, x: &mut Points, h: f64, i: usize) {
        let constraints = &self.model.bending;
        let vertices = constraints.vertices[i];
        if let Some(measure) = hinge(&vertices.map(|v| x[v])) {
            let turn = measure.value - constraints.rest[i];
            let off = turn - TAU * ((turn + PI) / TAU).floor();
            let alpha = constraints.compliance / (h * h);
            let lambda = &mut self.bending[i];
            let by = (off, alpha, MAX_TURN);
            project(
                self.way,
                &self.weight,
                &vertices,
                &measure.gradient,
                by,
                lambda,
                x,
            );
        }
    }
}

/// The sum of squared gradients over masses.
fn own_weight(weight: &[f64], vertices: &[usize], gradient: &[Vector3<f64>]) -> f64 {
    let each = vertices.iter().zip(gradient);
    each.map(|(&v, g)| weight[v] * g.norm_squared()).sum()
}

/// Projects one constraint that is off by the first number, with `alpha` as the second and no more change than the third.
fn project(
    way: Way,
    weight: &[f64],
    vertices: &[usize],
    gradient: &[Vector3<f64>],
    (off, alpha, most): (f64, f64, f64),
    lambda: &mut f64,
    x: &mut Points,
) {
    let own = own_weight(weight, vertices, gradient);
    if own == 0.0 {
        return;
    }
    let least = if way.is_guarded { own } else { 0.0 };
    let step = (off + alpha * *lambda) / (alpha + way.own_weight * own).max(least);
    let step = step.max(-most / own).min(most / own);
    *lambda -= step;
    for (&v, g) in vertices.iter().zip(gradient) {
        x[v] -= g * (weight[v] * step);
    }
}
