//! Intersection of a sweep with a surface: the first step of both methods.
//!
//! [`signs`] decides every tie, [`trace`] follows the intersection curves from triangle to triangle
//! and [`node`] holds a point where a curve crosses an edge.

pub(crate) mod node;
pub(crate) mod signs;
mod touch;
pub(crate) mod trace;

use crate::sweep::Sweep;
use signs::Signs;
use trace::Trace;

/// A sweep and its closed intersection curves with a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Intersection<'a> {
    pub(crate) sweep: &'a Sweep,
    pub(crate) signs: &'a Signs,
    pub(crate) trace: &'a Trace,
}
