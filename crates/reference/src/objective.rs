//! The objective of a step: distance from the prediction, and energy of the constraints.
//!
//! A constraint's energy is `(C - mu lambda)^2 / (2 (compliance + mu))`. The regularization `mu`
//! makes it softer without moving the minimum, once `lambda` is the multiplier of the solution: the
//! proximal method of multipliers (Rockafellar 1976). Between minimizations `lambda` becomes
//! `(mu lambda - C) / (compliance + mu)`.

use super::edge::Edge;
use super::hinge::Hinge;
use super::matrix::System;
use super::measure::{Kind, energy_hessian};
use super::model::{Constraints, Model, Plane};
use super::volume::{Piece, side_blocks};
use nalgebra::{Matrix3, Vector3};

/// Smallest regularized compliance, relative to that of inertia, `h^2 sum of |grad C|^2 / m`.
/// Smaller values need fewer multiplier rounds and leave fewer digits; a chain of 20 rigid links
/// takes 6.
const SOFTNESS: f64 = 1e-4;

/// Factor by which slowly converging constraints are stiffened.
const STIFFEN: f64 = 0.1;

/// Largest number of times that rigid constraints are stiffened; more leaves no digits.
const MOST_STIFFER: u32 = 4;

/// Rounding error of a position, over the largest coordinate.
const ROUNDING: f64 = f64::EPSILON;

/// Multipliers of one kind of constraints, all of shape \[constraints\].
#[derive(Debug, Clone, Default)]
pub(super) struct Multipliers {
    /// Multipliers: \[N\] for edges and the plane, [N m] for hinges, [Pa m^1.5] for pieces.
    pub(super) lambda: Vec<f64>,
    compliance: f64,
    /// Number of times that the regularization was reduced.
    stiffened: u32,
    /// Regularization added to the compliance.
    mu: Vec<f64>,
    /// Inverse of the regularized compliance; 0 disables a constraint.
    stiffness: Vec<f64>,
}

impl Multipliers {
    /// Adds a multiplier of zero for a constraint with an inertial compliance of `h^2 weight`.
    fn add(&mut self, h: f64, weight: f64) {
        let least = SOFTNESS * h * h * weight;
        let mu = (least - self.compliance).max(0.0);
        let takes_part = weight > 0.0 && weight.is_finite();
        let stiffness = (self.compliance + mu).recip();
        self.lambda.push(0.0);
        self.mu.push(if takes_part { mu } else { 0.0 });
        self.stiffness
            .push(if takes_part { stiffness } else { 0.0 });
    }
}

/// The objective of one step.
pub(super) struct Objective<'a> {
    model: &'a Model,
    /// The time step \[s\].
    pub(super) h: f64,
    /// `(1 + damping h) / h^2` [1/s^2].
    inertia: f64,
    goal: Vec<Vector3<f64>>,
    pub(super) stretch: Multipliers,
    pub(super) bending: Multipliers,
    pub(super) plane: Multipliers,
    /// Multipliers of pieces, scaled as the constraint function of
    /// [`Piece`](super::volume::Piece).
    pub(super) volume: Multipliers,
    /// Decrement that rounding of positions causes, about.
    pub(super) rounding: f64,
}

impl<'a> Objective<'a> {
    /// Returns the objective of a step of `h` from `x` with multipliers of zero. Constraints
    /// without a gradient or a free vertex are disabled.
    pub(super) fn new(
        model: &'a Model,
        h: f64,
        x: &[Vector3<f64>],
        goal: Vec<Vector3<f64>>,
    ) -> Self {
        let inertia = h.powi(-2) * (1.0 + model.damping * h);
        let mut plane = Multipliers::default();
        if model.plane.is_some() {
            for &mass in &model.mass {
                plane.add(h, if mass > 0.0 { mass.recip() } else { 0.0 });
            }
        }
        let mut volume = Multipliers {
            compliance: model.volumes.compressibility,
            ..Multipliers::default()
        };
        for piece in &model.volumes.pieces {
            volume.add(h, piece.weight(x, &model.mass));
        }
        let mut objective = Self {
            model,
            h,
            inertia,
            stretch: multipliers::<Edge, 2>(model, &model.stretch, h, x),
            bending: multipliers::<Hinge, 4>(model, &model.bending, h, x),
            plane,
            volume,
            rounding: 0.0,
            goal,
        };
        objective.rounding = objective.rounding_at(x);
        objective
    }

    /// Returns the decrement that rounding of positions causes at `x`, about.
    fn rounding_at(&self, x: &[Vector3<f64>]) -> f64 {
        let model = self.model;
        let mut square = sharpness::<Edge, 2>(&model.stretch, &self.stretch, x)
            + sharpness::<Hinge, 4>(&model.bending, &self.bending, x)
            + self.inertia * model.mass.iter().sum::<f64>()
            + self.plane.stiffness.iter().sum::<f64>();
        let mut rough = 0.0;
        for (piece, stiffness) in model.volumes.pieces.iter().zip(&self.volume.stiffness) {
            let slopes: f64 = piece.gradient(x).iter().map(Vector3::norm_squared).sum();
            square += slopes * stiffness;
            rough += piece.roughness(x).powi(2) * stiffness;
        }
        let extent = (x.iter().chain(&self.goal)).fold(0.0, |far: f64, p| far.max(p.amax()));
        ROUNDING * (extent * extent * square + rough).sqrt()
    }

    /// Returns the value \[J\].
    pub(super) fn value(&self, x: &[Vector3<f64>]) -> f64 {
        let model = self.model;
        let mut sum = 0.0;
        for ((x, goal), mass) in x.iter().zip(&self.goal).zip(&model.mass) {
            sum += mass * self.inertia * (x - goal).norm_squared() / 2.0;
        }
        sum += energy::<Edge, 2>(&model.stretch, &self.stretch, x);
        sum += energy::<Hinge, 4>(&model.bending, &self.bending, x);
        for (v, x) in x.iter().enumerate() {
            let (sunk, stiffness) = self.sunk(v, x);
            sum += sunk * sunk * stiffness / 2.0;
        }
        for (p, off) in self.off_volume(x) {
            sum += off * off * self.volume.stiffness[p] / 2.0;
        }
        sum
    }

    /// Returns `C - mu lambda` of every piece.
    fn off_volume(&self, x: &[Vector3<f64>]) -> impl Iterator<Item = (usize, f64)> {
        let push = &self.volume;
        let errors = self.model.volume_errors(x).into_iter().enumerate();
        errors.map(|(p, error)| (p, error - push.mu[p] * push.lambda[p]))
    }

    /// Returns the gradient \[N\].
    pub(super) fn gradient(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.sums(x, None)
    }

    /// Returns the gradient \[N\] and writes the Hessian to `system`, with elements projected to
    /// positive semidefinite ones if `positive`.
    pub(super) fn derivatives(
        &self,
        x: &[Vector3<f64>],
        system: &mut System,
        positive: bool,
    ) -> Vec<Vector3<f64>> {
        system.clear();
        self.sums(x, Some(Matrix { system, positive }))
    }

    fn sums(&self, x: &[Vector3<f64>], matrix: Option<Matrix<'_>>) -> Vec<Vector3<f64>> {
        let model = self.model;
        let mut into = Sums {
            gradient: Vec::with_capacity(x.len()),
            matrix,
        };
        for (v, x) in x.iter().enumerate() {
            let weight = model.mass[v] * self.inertia;
            let (sunk, stiffness) = self.sunk(v, x);
            let mut force = (x - self.goal[v]) * weight;
            let mut block = Matrix3::from_diagonal_element(weight);
            if let Some(Plane { normal, .. }) = model.plane.filter(|_| sunk < 0.0) {
                force += normal * (sunk * stiffness);
                block += normal * normal.transpose() * stiffness;
            }
            into.gradient.push(force);
            if let Some(matrix) = &mut into.matrix {
                matrix.system.add([v], &[[block]]);
            }
        }
        into.add::<Edge, 2>(&model.stretch, &self.stretch, x);
        into.add::<Hinge, 4>(&model.bending, &self.bending, x);
        for (p, off) in self.off_volume(x) {
            into.add_piece(&model.volumes.pieces[p], off, self.volume.stiffness[p], x);
        }
        for (gradient, &mass) in into.gradient.iter_mut().zip(&model.mass) {
            if mass <= 0.0 {
                *gradient = Vector3::zeros();
            }
        }
        into.gradient
    }

    /// Returns the depth of a vertex in the plane \[m\], negative, 0 above it, and the inverse
    /// compliance.
    fn sunk(&self, v: usize, x: &Vector3<f64>) -> (f64, f64) {
        match self.model.plane {
            Some(Plane { normal, offset }) => {
                let push = &self.plane;
                let off = normal.dot(x) - offset - push.mu[v] * push.lambda[v];
                (off.min(0.0), push.stiffness[v])
            }
            None => (0.0, 0.0),
        }
    }

    /// Stiffens constraints: less work for multipliers, more for Newton's method.
    pub(super) fn stiffen(&mut self, x: &[Vector3<f64>]) {
        self.stretch.stiffen();
        self.bending.stiffen();
        self.plane.stiffen();
        self.volume.stiffen();
        self.rounding = self.rounding_at(x);
    }

    /// Updates the multipliers at `x`; returns the remaining constraint error in units of the
    /// decrement.
    pub(super) fn update(&mut self, x: &[Vector3<f64>]) -> f64 {
        let model = self.model;
        let mut square = update::<Edge, 2>(&model.stretch, &mut self.stretch, x);
        square += update::<Hinge, 4>(&model.bending, &mut self.bending, x);
        if model.plane.is_some() {
            for (v, x) in x.iter().enumerate() {
                let (sunk, stiffness) = self.sunk(v, x);
                square += self.plane.set(v, -sunk * stiffness);
            }
        }
        let off: Vec<_> = self.off_volume(x).collect();
        for (p, off) in off {
            square += self.volume.set(p, -off * self.volume.stiffness[p]);
        }
        square.sqrt()
    }
}

impl Multipliers {
    /// Reduces the regularization, of rigid constraints a limited number of times.
    fn stiffen(&mut self) {
        if self.compliance == 0.0 && self.stiffened == MOST_STIFFER {
            return;
        }
        self.stiffened += 1;
        for (mu, stiffness) in self.mu.iter_mut().zip(&mut self.stiffness) {
            *mu *= STIFFEN;
            if *stiffness > 0.0 {
                *stiffness = (self.compliance + *mu).recip();
            }
        }
    }

    /// Sets a multiplier; returns the squared constraint error.
    fn set(&mut self, i: usize, to: f64) -> f64 {
        let change = to - self.lambda[i];
        self.lambda[i] = to;
        (self.mu[i] * change).powi(2) * self.stiffness[i]
    }
}

/// Returns the points of a constraint.
fn points<const N: usize>(x: &[Vector3<f64>], vertices: [usize; N]) -> [Vector3<f64>; N] {
    vertices.map(|v| x[v])
}

/// Returns multipliers of constraints for a step of `h` from `x`.
fn multipliers<K: Kind<N>, const N: usize>(
    model: &Model,
    constraints: &Constraints<N>,
    h: f64,
    x: &[Vector3<f64>],
) -> Multipliers {
    let mut out = Multipliers {
        compliance: constraints.compliance,
        ..Multipliers::default()
    };
    for &vertices in &constraints.vertices {
        let mut weight = 0.0;
        if let Some(slope) = K::slope(&points(x, vertices)) {
            let each = vertices.iter().zip(slope.gradient);
            let moving = each.filter(|(v, _)| model.mass[**v] > 0.0);
            weight = moving.map(|(v, g)| g.norm_squared() / model.mass[*v]).sum();
        }
        out.add(h, weight);
    }
    out
}

/// Returns the sum of squared gradients over regularized compliances.
fn sharpness<K: Kind<N>, const N: usize>(
    constraints: &Constraints<N>,
    multipliers: &Multipliers,
    x: &[Vector3<f64>],
) -> f64 {
    let square = |(&vertices, stiffness): (&[usize; N], &f64)| {
        let slope = K::slope(&points(x, vertices))?;
        let square: f64 = slope.gradient.iter().map(Vector3::norm_squared).sum();
        Some(square * stiffness)
    };
    let each = constraints.vertices.iter().zip(&multipliers.stiffness);
    each.filter_map(square).sum()
}

/// Returns the energy of constraints \[J\].
fn energy<K: Kind<N>, const N: usize>(
    constraints: &Constraints<N>,
    multipliers: &Multipliers,
    x: &[Vector3<f64>],
) -> f64 {
    let mut sum = 0.0;
    for (i, (&vertices, rest)) in constraints.each() {
        if let Some(slope) = K::slope(&points(x, vertices)) {
            let off = K::error(slope.value, *rest) - multipliers.mu[i] * multipliers.lambda[i];
            sum += off * off * multipliers.stiffness[i] / 2.0;
        }
    }
    sum
}

fn update<K: Kind<N>, const N: usize>(
    constraints: &Constraints<N>,
    multipliers: &mut Multipliers,
    x: &[Vector3<f64>],
) -> f64 {
    let mut square = 0.0;
    for (i, (&vertices, rest)) in constraints.each() {
        if let Some(slope) = K::slope(&points(x, vertices)) {
            let off = K::error(slope.value, *rest) - multipliers.mu[i] * multipliers.lambda[i];
            square += multipliers.set(i, -off * multipliers.stiffness[i]);
        }
    }
    square
}

/// The target of Hessian entries.
struct Matrix<'a> {
    system: &'a mut System,
    positive: bool,
}

/// The target of derivatives.
struct Sums<'a> {
    gradient: Vec<Vector3<f64>>,
    /// None for gradients only.
    matrix: Option<Matrix<'a>>,
}

impl Sums<'_> {
    fn add<K: Kind<N>, const N: usize>(
        &mut self,
        constraints: &Constraints<N>,
        multipliers: &Multipliers,
        x: &[Vector3<f64>],
    ) {
        for (i, (&vertices, rest)) in constraints.each() {
            let stiffness = multipliers.stiffness[i];
            let shift = multipliers.mu[i] * multipliers.lambda[i];
            let at = points(x, vertices);
            let Some(matrix) = &mut self.matrix else {
                if let Some(slope) = K::slope(&at) {
                    let off = K::error(slope.value, *rest) - shift;
                    for (v, gradient) in vertices.iter().zip(slope.gradient) {
                        self.gradient[*v] += gradient * (off * stiffness);
                    }
                }
                continue;
            };
            let Some(measure) = K::measure(&at).filter(|_| stiffness > 0.0) else {
                matrix.system.add(vertices, &[[Matrix3::zeros(); N]; N]);
                continue;
            };
            let off = K::error(measure.value, *rest) - shift;
            for (v, gradient) in vertices.iter().zip(measure.gradient) {
                self.gradient[*v] += gradient * (off * stiffness);
            }
            let mut hessian = energy_hessian(&measure, off);
            if matrix.positive {
                K::clamp(&mut hessian);
            }
            for block in hessian.as_flattened_mut() {
                *block *= stiffness;
            }
            matrix.system.add(vertices, &hessian);
        }
    }
}

impl Sums<'_> {
    /// Adds a piece with an error of `off`: its Hessian has a sparse part from the sides and a
    /// column from the gradient.
    fn add_piece(&mut self, piece: &Piece, off: f64, stiffness: f64, x: &[Vector3<f64>]) {
        let mut gradient = piece.gradient(x);
        for (sum, slope) in self.gradient.iter_mut().zip(&gradient) {
            *sum += slope * (off * stiffness);
        }
        let Some(Matrix { system, positive }) = &mut self.matrix else {
            return;
        };
        let twisted = off * stiffness * piece.scale();
        for &side in piece.sides() {
            let blocks = side_blocks(&Piece::twist(side, x), twisted, *positive);
            system.add([side[0], side[1]], &blocks);
        }
        gradient.iter_mut().for_each(|g| *g *= stiffness.sqrt());
        system.add_column(gradient);
    }
}

impl<const N: usize> Constraints<N> {
    /// Returns all constraints with their indices.
    fn each(&self) -> impl Iterator<Item = (usize, (&[usize; N], &f64))> {
        self.vertices.iter().zip(&self.rest).enumerate()
    }
}
