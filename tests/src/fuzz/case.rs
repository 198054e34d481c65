//! Decodes a fuzz case from bytes: a body and the cuts, undos and deformations applied to it.

use crate::{Blade, Body, Deformation, Shape};
use arbitrary::{Arbitrary, Result, Unstructured};
use incise_models::Model;
use incise_refine::RefinementLevel;

/// Maximum number of steps of a case, since bodies grow with every cut.
const MAX_STEPS: usize = 8;

/// A body with a list of operations.
#[derive(Debug, Clone)]
pub struct Case {
    /// The body, of about size 1.
    pub body: Body,
    /// Scale of the body as a power of ten.
    pub exponent: i32,
    /// Position of the body, relative to its diagonal.
    pub offset: [f64; 3],
    /// The operations in order.
    pub steps: Vec<Step>,
}

/// An operation on the body.
#[derive(Debug, Clone, Copy)]
pub enum Step {
    /// A cut.
    Cut {
        /// Sweep of the cut.
        sweep: SweepCase,
        /// Refinement level of the caps.
        level: RefinementLevel,
        /// Snapping distance, relative to the local edge length.
        snap: f64,
        /// Maximum displacement by remeshing, relative to the local edge length.
        remesh: f64,
        /// Index of the only piece to cut, modulo the number of pieces.
        only: Option<u32>,
    },
    /// Undoes the last cut that is not undone.
    Undo,
    /// Bends the body by a wave of this amplitude, relative to its diagonal; rest positions stay.
    Bend([f64; 3]),
}

/// Description of a sweep.
#[derive(Debug, Clone, Copy)]
pub enum SweepCase {
    /// A plane or a part of one, chosen to hit vertices, edges and faces.
    Blade(Blade),
    /// A sweep with these corners around the body's center, relative to the body's diagonal. It may
    /// be folded or cross itself.
    Corners([[f64; 3]; 4]),
}

impl<'a> Arbitrary<'a> for Case {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let body = body(u)?;
        let exponent = match u.int_in_range(0..=3)? {
            0 => u.int_in_range(-6..=6)?,
            _ => 0,
        };
        let reach = [0.0, 0.0, 0.0, 1.0, 100.0, 1e4][u.choose_index(6)?];
        let offset = vector(u)?.map(|x| reach * x);
        let mut steps = Vec::new();
        while steps.len() < MAX_STEPS && !u.is_empty() {
            steps.push(step(u)?);
        }
        Ok(Self {
            body,
            exponent,
            offset,
            steps,
        })
    }
}

/// Returns a number from -1 to 1.
fn signed(u: &mut Unstructured<'_>) -> Result<f64> {
    // Half of all numbers have few bits, so that points coincide and planes meet vertices.
    if u.ratio(1, 2)? {
        Ok(f64::from(u.arbitrary::<i8>()?) / 128.0)
    } else {
        Ok(f64::from(u.arbitrary::<i32>()?) / 2.0_f64.powi(31))
    }
}

/// Returns a number from `from` to `to`.
fn between(u: &mut Unstructured<'_>, from: f64, to: f64) -> Result<f64> {
    Ok(from + (to - from) * (signed(u)? + 1.0) / 2.0)
}

pub(crate) fn vector(u: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    Ok([signed(u)?, signed(u)?, signed(u)?])
}

/// Returns a vector of at least 0.1 in length; the y axis if the decoded one is shorter.
fn direction(u: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    let v = vector(u)?;
    let is_long = v.iter().any(|x| x.abs() > 0.1);
    Ok(if is_long { v } else { [0.0, 1.0, 0.0] })
}

pub(crate) fn body(u: &mut Unstructured<'_>) -> Result<Body> {
    let shape = match u.int_in_range(0..=9)? {
        0..=2 => Shape::Icosphere(u.int_in_range(0..=2)?),
        3..=5 => Shape::CubeSphere(u.int_in_range(1..=6)?),
        6..=8 => Shape::Torus(u.int_in_range(3..=16)?, u.int_in_range(3..=10)?),
        _ => Shape::Model(Model::Bunny),
    };
    let deformation = match u.int_in_range(0..=3)? {
        0 => Deformation::None,
        1 => Deformation::Waves {
            stretch: vector(u)?.map(|x| 1.1 + 0.5 * x),
            phase: vector(u)?.map(|x| std::f64::consts::PI * x),
        },
        2 => Deformation::Noise(between(u, 0.0, 0.3)?),
        _ => Deformation::SelfIntersecting(between(u, 0.02, 1.5)?),
    };
    let lattice = match u.int_in_range(0..=3)? {
        0 => Some(u.int_in_range(4..=12)?),
        _ => None,
    };
    Ok(Body {
        shape,
        deformation,
        lattice,
        seed: u.int_in_range(0..=0xffff)?,
    })
}

fn step(u: &mut Unstructured<'_>) -> Result<Step> {
    Ok(match u.int_in_range(0..=9)? {
        0..=6 => Step::Cut {
            sweep: sweep(u)?,
            level: match u.int_in_range(0..=7)? {
                i @ 0..=4 => RefinementLevel::FIVE[i],
                _ => RefinementLevel::Z(between(u, 0.5, 3.0)?),
            },
            snap: match u.int_in_range(0..=4)? {
                0 | 1 => 0.0,
                2 | 3 => 0.1,
                _ => between(u, 0.0, 0.499)?,
            },
            remesh: match u.int_in_range(0..=3)? {
                0 => between(u, 0.05, 0.4)?,
                _ => 0.0,
            },
            only: match u.int_in_range(0..=2)? {
                0 => Some(u.arbitrary()?),
                _ => None,
            },
        },
        7 | 8 => Step::Undo,
        _ => Step::Bend(vector(u)?.map(|x| 0.05 * x)),
    })
}

fn sweep(u: &mut Unstructured<'_>) -> Result<SweepCase> {
    let axis = u.int_in_range(0..=2)?;
    Ok(SweepCase::Blade(match u.int_in_range(0..=9)? {
        0 | 1 => Blade::Plane(direction(u)?, 0.95 * signed(u)?),
        2 => Blade::AxisThroughVertex(axis, u.arbitrary()?),
        3 => Blade::ThroughVertices(u.arbitrary()?),
        4 => Blade::ThroughEdge(u.arbitrary()?, axis, direction(u)?),
        5 => Blade::InFace(u.arbitrary()?),
        6 => Blade::Grazing(direction(u)?),
        7 => Blade::Bent(direction(u)?, 0.9 * signed(u)?, 0.6 * signed(u)?),
        8 => Blade::Short(direction(u)?, 0.9 * signed(u)?, between(u, 0.1, 0.9)?),
        _ => {
            let reach = [1.0, 3.0, 20.0][axis];
            let mut corners = [[0.0; 3]; 4];
            for corner in &mut corners {
                *corner = vector(u)?.map(|x| reach * x);
            }
            return Ok(SweepCase::Corners(corners));
        }
    }))
}
