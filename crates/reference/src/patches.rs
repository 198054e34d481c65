//! Steps by rigid patches, coarse to fine: the multilevel alternative to a factor.
//!
//! A cycle goes from the whole body to patches of eight vertices and then to single vertices. It
//! moves one patch after another as a rigid body, with all others held, to where a Gauss-Newton
//! step lowers the objective of implicit Euler most. Constraints inside of a patch do not change,
//! so that a patch costs its inertia and the constraints that cross its border. On single vertices
//! this is vertex block descent (Chen et al. 2024).

mod levels;
#[cfg(test)]
mod tests;

use super::edge::Edge;
use super::error::ReferenceError;
use super::hinge::Hinge;
use super::measure::Kind;
use super::model::{Constraints, Model, State};
use levels::{Patch, levels};
use nalgebra::{Matrix3, Matrix6, Rotation3, Vector3, Vector6};

/// Largest number of times that a step of a patch is halved; after that the patch stays.
const MOST_HALVINGS: u32 = 4;

/// Moment of inertia added to that of a patch \[m^2\], over its mass: vertices on a line have none.
const TURN: f64 = 1e-12;

/// Steps a model by rigid patches.
#[derive(Debug, Clone)]
pub struct PatchStepper<'a> {
    model: &'a Model,
    /// The patches of all levels, the whole body first.
    patches: Vec<Patch>,
    /// All free vertices and all constraints.
    whole: Patch,
}

/// The objective of a step.
struct Goal<'a> {
    model: &'a Model,
    /// `(1 + damping h) / h^2` [1/s^2].
    inertia: f64,
    /// Predicted positions \[m\].
    to: Vec<Vector3<f64>>,
}

impl<'a> PatchStepper<'a> {
    /// Divides the free vertices of a model by their positions `x` \[m\].
    ///
    /// # Errors
    /// [`ReferenceError::NoPatches`] for rigid constraints, a plane or volumes.
    pub fn new(model: &'a Model, x: &[Vector3<f64>]) -> Result<Self, ReferenceError> {
        let (stretch, bending) = (&model.stretch, &model.bending);
        let is_rigid = stretch.compliance <= 0.0 && !stretch.rest.is_empty()
            || bending.compliance <= 0.0 && !bending.rest.is_empty();
        if is_rigid || model.plane.is_some() || !model.volumes.pieces.is_empty() {
            return Err(ReferenceError::NoPatches);
        }
        let whole = Patch {
            vertices: (0..x.len()).filter(|&v| model.mass[v] > 0.0).collect(),
            stretch: (0..stretch.rest.len()).collect(),
            bending: (0..bending.rest.len()).collect(),
        };
        Ok(Self {
            model,
            patches: levels(model, &whole.vertices, x),
            whole,
        })
    }

    /// Steps by `h` \[s\] in a number of cycles.
    ///
    /// They start from the prediction or from that without gravity, whichever has the lower value.
    pub fn step(&self, state: &mut State, h: f64, cycles: u32) {
        let goal = Goal::new(self.model, state, h);
        let still = predict(self.model, state, h, Vector3::zeros());
        let mut x = match goal.value(&self.whole, &still) < goal.value(&self.whole, &goal.to) {
            true => still,
            false => goal.to.clone(),
        };
        for _ in 0..cycles {
            self.cycle(&goal, &mut x);
        }
        for ((at, v), to) in state.x.iter_mut().zip(&mut state.v).zip(x) {
            *v = (to - *at) / h;
            *at = to;
        }
    }

    /// Moves all patches once.
    fn cycle(&self, goal: &Goal<'_>, x: &mut [Vector3<f64>]) {
        for patch in &self.patches {
            goal.lower(patch, x);
        }
    }
}

impl<'a> Goal<'a> {
    /// Returns the objective of a step of `h` \[s\].
    fn new(model: &'a Model, state: &State, h: f64) -> Self {
        Self {
            model,
            inertia: h.powi(-2) * (1.0 + model.damping * h),
            to: predict(model, state, h, model.gravity),
        }
    }

    /// Returns the part of the value that depends on the motion of a patch \[J\].
    fn value(&self, patch: &Patch, x: &[Vector3<f64>]) -> f64 {
        let model = self.model;
        let square = |&v: &usize| model.mass[v] * (x[v] - self.to[v]).norm_squared();
        let distance: f64 = patch.vertices.iter().map(square).sum();
        self.inertia / 2.0 * distance
            + energy::<Edge, 2>(&model.stretch, &patch.stretch, x)
            + energy::<Hinge, 4>(&model.bending, &patch.bending, x)
    }

    /// Moves a patch as a rigid body, if that lowers the value.
    fn lower(&self, patch: &Patch, x: &mut [Vector3<f64>]) {
        let (model, vertices) = (self.model, &patch.vertices);
        let mass: f64 = vertices.iter().map(|&v| model.mass[v]).sum();
        let moments = vertices.iter().map(|&v| x[v] * model.mass[v]);
        let center = moments.sum::<Vector3<f64>>() / mass;
        let mut before = 0.0;
        let mut slope = Vector6::zeros();
        let mut turn = Matrix3::from_diagonal_element(TURN * mass * self.inertia);
        for &v in vertices {
            let (arm, off) = (x[v] - center, x[v] - self.to[v]);
            let weight = model.mass[v] * self.inertia;
            before += weight * off.norm_squared() / 2.0;
            slope += wrench(&arm, &(off * weight));
            turn -= arm.cross_matrix() * arm.cross_matrix() * weight;
        }
        let mut matrix = Matrix6::from_diagonal_element(mass * self.inertia);
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
        let is_in = |v: usize| vertices.binary_search(&v).is_ok();
        let mut add = |by_motion: Vector6<f64>, off: f64, compliance: f64| {
            before += off * off / (2.0 * compliance);
            slope += by_motion * (off / compliance);
            matrix += by_motion * by_motion.transpose() / compliance;
        };
        each_slope::<Edge, 2>(&model.stretch, &patch.stretch, x, &center, is_in, &mut add);
        each_slope::<Hinge, 4>(&model.bending, &patch.bending, x, &center, is_in, &mut add);
        let Some(factor) = matrix.cholesky() else {
            return;
        };
        let step = factor.solve(&-slope);
        let start: Vec<Vector3<f64>> = vertices.iter().map(|&v| x[v]).collect();
        let mut share = 1.0;
        for _ in 0..=MOST_HALVINGS {
            let by = step * share;
            let rotation = Rotation3::new(by.fixed_rows::<3>(3).into_owned());
            let to = center + by.fixed_rows::<3>(0);
            for (&v, start) in vertices.iter().zip(&start) {
                x[v] = to + rotation * (start - center);
            }
            if self.value(patch, x) <= before {
                return;
            }
            share /= 2.0;
        }
        for (&v, start) in vertices.iter().zip(start) {
            x[v] = start;
        }
    }
}

/// Returns the positions after `h` \[s\] under gravity alone \[m\].
fn predict(model: &Model, state: &State, h: f64, gravity: Vector3<f64>) -> Vec<Vector3<f64>> {
    let kept = h / (1.0 + model.damping * h);
    let way = |(v, &mass): (&Vector3<f64>, &f64)| match mass > 0.0 {
        true => (v + gravity * h) * kept,
        false => Vector3::zeros(),
    };
    let ways = state.v.iter().zip(&model.mass).map(way);
    state.x.iter().zip(ways).map(|(x, way)| x + way).collect()
}

/// Returns force and torque of a force.
fn wrench(arm: &Vector3<f64>, force: &Vector3<f64>) -> Vector6<f64> {
    let torque = arm.cross(force);
    Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
}

/// Returns the energy of some constraints \[J\].
fn energy<K: Kind<N>, const N: usize>(
    constraints: &Constraints<N>,
    which: &[usize],
    x: &[Vector3<f64>],
) -> f64 {
    if which.is_empty() {
        // A body without such constraints has no compliance.
        return 0.0;
    }
    let off = |&i: &usize| {
        let slope = K::slope(&constraints.vertices[i].map(|v| x[v]))?;
        Some(K::error(slope.value, constraints.rest[i]))
    };
    let squares = which.iter().filter_map(off).map(|off| off * off);
    squares.sum::<f64>() / (2.0 * constraints.compliance)
}

/// Calls `add` with the gradient by the motion of a patch, the error and the compliance of some
/// constraints.
fn each_slope<K: Kind<N>, const N: usize>(
    constraints: &Constraints<N>,
    which: &[usize],
    x: &[Vector3<f64>],
    center: &Vector3<f64>,
    is_in: impl Fn(usize) -> bool,
    add: &mut impl FnMut(Vector6<f64>, f64, f64),
) {
    for &i in which {
        let vertices = constraints.vertices[i];
        if let Some(slope) = K::slope(&vertices.map(|v| x[v])) {
            let all = vertices.iter().zip(&slope.gradient);
            let own = all.filter(|(v, _)| is_in(**v));
            let sum = own.map(|(&v, gradient)| wrench(&(x[v] - center), gradient));
            let off = K::error(slope.value, constraints.rest[i]);
            add(sum.sum(), off, constraints.compliance);
        }
    }
}
