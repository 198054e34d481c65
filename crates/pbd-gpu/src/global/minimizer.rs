//! [`Minimizer`]: quasi-Newton iterations of a substep with L-BFGS and line search.

mod energy_bound;
pub(super) mod settling;

use super::lanes::Row;
use super::objective::Objective;
use super::pieces::PieceMotions;
use super::preconditioner::Preconditioner;
use super::volumes::VolumeGradients;
use crate::constraints::volumes::VolumeSet;
use crate::kernels::particle_state::ParticleStates;
use energy_bound::{MAX_STRAIN, MAX_STRAIN_ALONE, inertia};
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Surface, Vec3};

/// Number of pairs of steps and changes of the gradient.
const PAIRS: usize = 5;

/// Minimum decrease relative to the predicted one (Armijo).
const DECREASE: f64 = 1e-4;

/// Maximum number of reductions of a step; after that the substep stays where it is.
const MAX_REDUCTIONS: u32 = 10;

/// Range of a reduced step relative to the one before.
const REDUCTION: [f64; 2] = [0.01, 0.5];

/// Minimum slope of a search whose failure counts, relative to the objective.
const MIN_STEEPNESS: f64 = 0.1;

/// Minimum cosine between a step and its change of the gradient for the pair to be kept.
const MIN_COSINE: f64 = 1e-6;

/// A point of the search with its value and gradient.
#[derive(Debug, Clone, Default)]
struct Point {
    /// Displacements \[m\], shape [vertex slots].
    displacements: Vec<Vec3>,
    value: f64,
    gradient: Vec<Vec3>,
}

/// A step and the change of the gradient over it.
#[derive(Debug, Clone, Default)]
struct Pair {
    step: Vec<Vec3>,
    change: Vec<Vec3>,
    /// Inverse of their product.
    inverse: f64,
}

/// Memory of an evaluation.
#[derive(Debug, Clone, Default)]
struct Evaluation {
    /// Displaced positions \[m\].
    points: Vec<Row>,
    gradient: Vec<Row>,
}

/// The iterations of a substep.
#[derive(Debug, Clone, Default)]
pub(super) struct Minimizer {
    /// Positions at the start of the substep \[m\].
    start: Vec<Vec3>,
    /// Masses \[kg\], 0 for fixed vertices.
    masses: Vec<f64>,
    predicted: Vec<Vec3>,
    /// The rigid motion of each piece; pinned vertices move to their targets \[m\].
    rigid: Vec<Vec3>,
    current: Point,
    /// The next point, and after a step the previous one.
    other: Point,
    evaluation: Evaluation,
    direction: Vec<Vec3>,
    volume_gradients: VolumeGradients,
    pairs: [Pair; PAIRS],
    /// Number of pairs of this substep so far; the last ones are kept.
    pair_count: usize,
    /// Whether the last iteration has moved from `other` to `current`.
    has_step: bool,
    /// Whether the matrix alone gives no step from `current`, so that another iteration would not.
    is_stuck: bool,
    /// Whether a line search of this frame found no lower objective on a steep slope.
    pub(super) line_search_failed: bool,
}

impl Minimizer {
    /// Starts a substep whose prediction falls freely by `fall` \[m\].
    ///
    /// Iterations start from the prediction with or without the fall of held pieces, whichever has
    /// the lower value: a free piece falls, one that hangs from pins does not. They start from the
    /// rigid motion of pieces that turn about pins or are dragged, if its value is lower. A start
    /// with more energy than the body has moves toward the rigid motion of its pieces.
    pub(super) fn begin(
        &mut self,
        particles: ParticleStates<'_>,
        objective: &Objective<'_>,
        (fall, pieces, iterations): ([f64; 3], &mut PieceMotions, u32),
    ) {
        self.start.clear();
        self.masses.clear();
        self.predicted.clear();
        for cell in particles.iter() {
            let state = cell.get();
            let ([x, y, z, _], [dx, dy, dz, _]) = (state.x, state.d);
            self.start.push(to_f64([x, y, z]));
            self.masses.push(inertia(state));
            self.predicted.push(to_f64([dx, dy, dz]));
        }
        (self.pair_count, self.has_step, self.is_stuck) = (0, false, false);
        self.current.displacements.clear();
        self.current
            .displacements
            .extend_from_slice(&self.predicted);
        self.evaluate_current(objective);
        let fall = Vec3::from(fall);
        if fall != Vec3::zeros() && pieces.has_pins() {
            let falls = |v: usize| self.masses[v] > 0.0 && pieces.is_held(v);
            let resting = (self.predicted.iter().enumerate())
                .map(|(v, d)| if falls(v) { d - fall } else { *d });
            self.other.displacements.clear();
            self.other.displacements.extend(resting);
            self.start_lower(particles, objective);
        }
        let rotation = self.find_rigid(pieces, true);
        let pins = self.masses.iter().zip(&self.predicted);
        let mut pins = pins.filter(|(mass, _)| **mass == 0.0);
        if pieces.has_pivots() || pins.any(|(_, by)| *by != Vec3::zeros()) {
            // A piece that swings about its pins, or that they drag.
            self.other.displacements.clone_from(&self.rigid);
            self.start_lower(particles, objective);
        }
        let max_strain = rotation
            * if iterations > 1 {
                MAX_STRAIN
            } else {
                MAX_STRAIN_ALONE
            };
        self.bound_start(particles, objective, (pieces, max_strain));
    }

    /// Starts from the other displacements if their objective is lower.
    fn start_lower(&mut self, particles: ParticleStates<'_>, objective: &Objective<'_>) {
        self.evaluate_other(objective);
        if self.other.value < self.current.value {
            std::mem::swap(&mut self.current, &mut self.other);
            self.store(particles);
        }
    }

    /// Returns the value of an objective at the positions of a surface, without inertia.
    pub(super) fn value_at(&mut self, objective: &Objective<'_>, surface: &Surface) -> f64 {
        let Evaluation { points, gradient } = &mut self.evaluation;
        points.clear();
        let positions = surface.positions().iter();
        points.extend(positions.map(|&[x, y, z, _]| Row::from(to_f64([x, y, z]))));
        let inertia = points.iter().map(|_| (Vec3::zeros(), 0.0));
        objective.evaluate(points, inertia, gradient)
    }

    /// Moves the displacements by one iteration.
    pub(super) fn iterate(
        &mut self,
        particles: ParticleStates<'_>,
        (objective, volumes): (&Objective<'_>, Option<&VolumeSet>),
        preconditioner: &mut Preconditioner,
    ) {
        if self.load(particles) {
            self.evaluate_current(objective);
            self.is_stuck = false;
        }
        if self.is_stuck {
            return;
        }
        if self.has_step {
            self.add_pair();
        }
        self.has_step = false;
        let mut slope = self.find_direction(volumes, preconditioner);
        if slope >= 0.0 && self.pair_count > 0 {
            self.pair_count = 0;
            slope = self.find_direction(volumes, preconditioner);
        }
        if slope >= 0.0 {
            self.is_stuck = true;
            return;
        }
        let mut share = 1.0;
        for _ in 0..=MAX_REDUCTIONS {
            let Self {
                current,
                other,
                direction,
                ..
            } = self;
            other.displacements.clear();
            let moved = current.displacements.iter().zip(&*direction);
            other
                .displacements
                .extend(moved.map(|(d, by)| d + by * share));
            self.evaluate_other(objective);
            // False for a value that is not finite.
            if self.other.value <= self.current.value + DECREASE * share * slope {
                std::mem::swap(&mut self.current, &mut self.other);
                self.has_step = true;
                self.store(particles);
                return;
            }
            // Where a parabola through both values, with this slope, has its minimum.
            let excess = self.other.value - self.current.value - share * slope;
            let [least, most] = REDUCTION.map(|by| by * share);
            let lowest = -0.5 * slope * share * share / excess;
            share = if lowest.is_finite() {
                lowest.clamp(least, most)
            } else {
                most
            };
        }
        self.is_stuck = self.pair_count == 0;
        self.line_search_failed |= self.is_stuck && -slope > MIN_STEEPNESS * self.current.value;
        self.pair_count = 0;
    }

    /// Reads changes by other passes, and returns whether there are any.
    ///
    /// The pass of volumes also moves positions.
    fn load(&mut self, particles: ParticleStates<'_>) -> bool {
        let mut is_changed = false;
        let vertices = self.start.iter_mut().zip(&mut self.current.displacements);
        for (cell, (start, displacement)) in particles.iter().zip(vertices) {
            let ([x, y, z, _], [dx, dy, dz, _]) = (cell.get().x, cell.get().d);
            for (known, now) in [(start, [x, y, z]), (displacement, [dx, dy, dz])] {
                if to_f32(*known) != now {
                    *known = to_f64(now);
                    is_changed = true;
                }
            }
        }
        is_changed
    }

    /// Writes the current displacements.
    fn store(&mut self, particles: ParticleStates<'_>) {
        for (i, d) in self.current.displacements.iter().enumerate() {
            let [x, y, z] = to_f32(*d);
            particles.set_d(i, [x, y, z, 0.0]);
        }
    }

    fn evaluate_current(&mut self, objective: &Objective<'_>) {
        let Self {
            start,
            masses,
            predicted,
            current,
            evaluation,
            ..
        } = self;
        evaluate(objective, (start, masses, predicted), current, evaluation);
    }

    fn evaluate_other(&mut self, objective: &Objective<'_>) {
        let Self {
            start,
            masses,
            predicted,
            other,
            evaluation,
            ..
        } = self;
        evaluate(objective, (start, masses, predicted), other, evaluation);
    }

    /// Adds the last step as a pair, if the objective is convex along it.
    fn add_pair(&mut self) {
        let Self {
            current,
            other,
            pairs,
            pair_count,
            ..
        } = self;
        let pair = &mut pairs[*pair_count % PAIRS];
        difference(&mut pair.step, &current.displacements, &other.displacements);
        difference(&mut pair.change, &current.gradient, &other.gradient);
        let product = dot(&pair.step, &pair.change);
        let squares = dot(&pair.step, &pair.step) * dot(&pair.change, &pair.change);
        if product > MIN_COSINE * squares.sqrt() {
            pair.inverse = 1.0 / product;
            *pair_count += 1;
        }
    }

    /// Computes a direction and returns its slope.
    fn find_direction(
        &mut self,
        volumes: Option<&VolumeSet>,
        preconditioner: &mut Preconditioner,
    ) -> f64 {
        let Self {
            start,
            current,
            direction,
            volume_gradients,
            pairs,
            pair_count,
            masses,
            ..
        } = self;
        direction.clear();
        direction.extend(current.gradient.iter().map(|g| -g));
        let mut inverse = |vector: &mut Vec<Vec3>| {
            multiply_by_inverse(vector, (&*pairs, *pair_count), preconditioner);
            for (d, &mass) in vector.iter_mut().zip(&*masses) {
                if mass == 0.0 {
                    *d = Vec3::zeros();
                }
            }
        };
        inverse(direction);
        if let Some(volumes) = volumes {
            let point = |v: usize| start[v] + current.displacements[v];
            volume_gradients.project(volumes, point, masses, direction, inverse);
        }
        dot(&current.gradient, direction)
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let of = |vectors: &Vec<Vec3>| 24 * vectors.capacity();
        let point = |point: &Point| of(&point.displacements) + of(&point.gradient);
        let pairs = self
            .pairs
            .iter()
            .map(|pair| of(&pair.step) + of(&pair.change));
        of(&self.start)
            + 8 * self.masses.capacity()
            + of(&self.predicted)
            + of(&self.rigid)
            + point(&self.current)
            + point(&self.other)
            + size_of::<Row>()
                * (self.evaluation.points.capacity() + self.evaluation.gradient.capacity())
            + of(&self.direction)
            + self.volume_gradients.bytes()
            + pairs.sum::<usize>()
    }
}

/// Evaluates the objective at the displacements of a point.
fn evaluate(
    objective: &Objective<'_>,
    (start, masses, predicted): (&[Vec3], &[f64], &[Vec3]),
    point: &mut Point,
    Evaluation { points, gradient }: &mut Evaluation,
) {
    points.clear();
    let displaced = start.iter().zip(&point.displacements);
    points.extend(displaced.map(|(x, d)| Row::from(x + d)));
    let offsets = point.displacements.iter().zip(predicted);
    let inertia = offsets.zip(masses).map(|((d, to), &mass)| (d - to, mass));
    point.value = objective.evaluate(points, inertia, gradient);
    point.gradient.clear();
    let gradient = gradient.iter().zip(masses);
    (point.gradient).extend(gradient.map(|(&row, &mass)| match mass {
        0.0 => Vec3::zeros(),
        _ => Vec3::from(row),
    }));
}

/// Multiplies a vector by the approximate inverse of the Hessian: the two loops of L-BFGS
/// (Nocedal 1980).
fn multiply_by_inverse(
    vector: &mut [Vec3],
    (pairs, count): (&[Pair; PAIRS], usize),
    preconditioner: &mut Preconditioner,
) {
    let first = count.saturating_sub(PAIRS);
    let mut shares = [0.0; PAIRS];
    for k in (first..count).rev().map(|i| i % PAIRS) {
        shares[k] = pairs[k].inverse * dot(&pairs[k].step, vector);
        add_scaled(vector, -shares[k], &pairs[k].change);
    }
    preconditioner.apply(vector);
    for k in (first..count).map(|i| i % PAIRS) {
        let back = pairs[k].inverse * dot(&pairs[k].change, vector);
        add_scaled(vector, shares[k] - back, &pairs[k].step);
    }
}

fn difference(to: &mut Vec<Vec3>, a: &[Vec3], b: &[Vec3]) {
    to.clear();
    to.extend(a.iter().zip(b).map(|(a, b)| a - b));
}

fn add_scaled(to: &mut [Vec3], by: f64, other: &[Vec3]) {
    for (to, other) in to.iter_mut().zip(other) {
        *to += other * by;
    }
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
