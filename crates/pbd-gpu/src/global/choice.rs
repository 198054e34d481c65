//! [`Extent`]: the size of a body, by which [`Scheme::Auto`](crate::Scheme::Auto) chooses.
//!
//! Sweeps carry a load by one edge per iteration. A stretch wave travels `dt / sqrt(c m)` edges
//! per frame, with a compliance `c` and the mass `m` of a vertex. A bending wave passes about
//! `dt / (l sqrt(c m))` edges of length `l`. A body that is slow to bend moves by turns of its
//! parts, which the constant matrix resists.

use crate::material::Stiffness;
use incise_mesh::Surface;

/// Minimum number of edges that stretch and bending waves travel per frame.
const MIN_TRAVEL: f64 = 24.0;

/// Factor of [`MIN_TRAVEL`] for a body that has taken the global step.
const HYSTERESIS: f64 = 0.8;

/// Minimum number of vertices of a piece: sweeps carry a load through smaller ones.
const MIN_VERTICES: usize = 128;

/// The scheme of a body in a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Choice {
    /// Sweeps, as always.
    #[default]
    Sweeps,
    /// Sweeps in short substeps of a body that otherwise takes the global step: it touches
    /// something, or a line search has failed.
    ShortSubsteps,
    /// The global step of a body that has taken sweeps before, see
    /// [`minimizer::settling`](super::minimizer::settling).
    Settling,
    /// The global step.
    Global,
}

impl Choice {
    /// Returns whether it is the global step.
    pub(crate) fn is_global(self) -> bool {
        matches!(self, Self::Settling | Self::Global)
    }
}

/// Sizes of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    /// Vertices of the largest piece, but for the genus and the border.
    vertices: usize,
    /// Mean mass of a vertex \[kg\].
    mass: f64,
    /// Mean rest length of edges \[m\].
    edge: f64,
}

impl Extent {
    /// Measures a body with a mean rest length of `edge` \[m\]. O(triangles).
    pub(crate) fn new(surface: &Surface, masses: &[f32], edge: f64) -> Self {
        let mut triangles = vec![0_usize; surface.piece_bound() as usize];
        for t in surface.topology().triangles() {
            triangles[surface.piece(t) as usize] += 1;
        }
        let total: f64 = masses.iter().map(|&mass| f64::from(mass)).sum();
        Self {
            vertices: triangles.into_iter().max().unwrap_or(0) / 2,
            mass: total / surface.topology().vertex_count().max(1) as f64,
            edge,
        }
    }

    /// Returns whether the global step has the smaller error in a frame of `dt` \[s\].
    ///
    /// A body for which it was chosen in the last frame keeps it down to [`HYSTERESIS`] of the
    /// limit.
    pub(crate) fn needs_global_step(
        &self,
        (stretch, bending): (Stiffness, Option<Stiffness>),
        dt: f32,
        was_chosen: bool,
    ) -> bool {
        let (Stiffness::Compliance(stretch), Some(Stiffness::Compliance(bending))) =
            (stretch, bending)
        else {
            return false;
        };
        let travel = |compliance: f32| f64::from(dt) / (f64::from(compliance) * self.mass).sqrt();
        let slowest = travel(stretch).min(travel(bending) / self.edge);
        let least = if was_chosen {
            HYSTERESIS * MIN_TRAVEL
        } else {
            MIN_TRAVEL
        };
        self.vertices >= MIN_VERTICES && slowest >= least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::icosphere;

    #[test]
    fn large_and_stiff_bodies_need_it() {
        let ball = |level| {
            let surface = icosphere(level, 0.5);
            let masses = vec![1e-4; surface.topology().vertex_count()];
            Extent::new(&surface, &masses, 0.1)
        };
        assert_eq!(ball(4).vertices, 2560, "10 * 4^4 + 2 by Euler's formula");
        let is_chosen = |level, stretch, bending: Option<f32>| {
            let bending = bending.map(Stiffness::Compliance);
            let material = (Stiffness::Compliance(stretch), bending);
            ball(level).needs_global_step(material, 1.0 / 60.0, false)
        };
        assert!(is_chosen(4, 1e-3, Some(1e-1)), "53 edges in both");
        assert!(!is_chosen(4, 1e-2, Some(1e-1)), "stretch travels 17 edges");
        assert!(!is_chosen(4, 1e-3, Some(1.0)), "bending passes 17 edges");
        let after = |dt| {
            let material = (
                Stiffness::Compliance(1e-3),
                Some(Stiffness::Compliance(1e-1)),
            );
            [false, true].map(|was_chosen| ball(4).needs_global_step(material, dt, was_chosen))
        };
        assert_eq!(after(0.0080), [true; 2], "25 edges");
        assert_eq!(after(0.0070), [false, true], "22 edges");
        assert_eq!(after(0.0055), [false; 2], "17 edges");
        assert!(!is_chosen(4, 1e-3, None), "parts turn freely");
        assert!(!is_chosen(1, 1e-3, Some(1e-1)), "40 vertices");
    }
}
