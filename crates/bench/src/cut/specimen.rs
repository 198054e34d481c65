//! A body that is cut and made whole again.

use super::times::Times;
use crate::motion;
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, Undo, Vec3};
use incise_pbd_gpu::Solver;
use std::error::Error;
use std::time::Instant;

/// A body with its solver.
pub(super) struct Specimen {
    pub(super) surface: Surface,
    cutter: Cutter,
    solver: Solver,
}

/// A cut that was done.
pub(super) struct Cut {
    pub(super) times: Times,
    pub(super) hits: usize,
    pub(super) cap_triangles: usize,
    undo: Option<Undo>,
}

impl Specimen {
    /// A body of the material that all measurements are of.
    pub(super) fn new(mut surface: Surface) -> Result<Self, Box<dyn Error>> {
        let solver = Solver::new(&mut surface, &motion::material())?;
        Ok(Self {
            cutter: Cutter::new(&surface),
            surface,
            solver,
        })
    }

    /// Cuts and times it; nothing where the sweep misses. The inner error is the cut's and changes
    /// nothing.
    pub(super) fn cut(
        &mut self,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<Result<Option<Cut>, CutError>, Box<dyn Error>> {
        let outcome = match self.cutter.cut(&mut self.surface, sweep, params) {
            Ok(outcome) => outcome,
            Err(error) => return Ok(Err(error)),
        };
        if outcome.delta.is_empty() {
            return Ok(Ok(None));
        }
        let begin = Instant::now();
        self.solver.apply_delta(&mut self.surface, &outcome.delta)?;
        Ok(Ok(Some(Cut {
            times: Times::of(&outcome.report, begin.elapsed()),
            hits: outcome.report.hits,
            cap_triangles: outcome.cap.len(),
            undo: outcome.undo,
        })))
    }

    /// Takes a cut back: cheaper than a copy of a million triangles, and arrays keep their room.
    pub(super) fn undo(&mut self, cut: Cut) -> Result<(), Box<dyn Error>> {
        if let Some(undo) = cut.undo {
            let back = self.cutter.undo(&mut self.surface, undo)?;
            self.solver.apply_delta(&mut self.surface, &back)?;
        }
        Ok(())
    }

    /// Moves pieces from the number `first` on away from the middle of the world, ten times as far and as
    /// large as they were.
    pub(super) fn push_away(&mut self, first: u32) {
        let mut is_moved = vec![false; self.surface.positions.len()];
        let triangles: Vec<TriangleId> = self.surface.topology().triangles().collect();
        for t in triangles {
            if self.surface.piece(t) >= first {
                for v in self.surface.topology().triangle(t) {
                    if !std::mem::replace(&mut is_moved[v.index()], true) {
                        for x in &mut self.surface.positions[v.index()][..3] {
                            *x *= 10.0;
                        }
                    }
                }
            }
        }
        self.cutter.refit(&self.surface);
    }

    /// How far the body reaches along a direction, from and to \[m\].
    pub(super) fn reach(&self, normal: Vec3) -> [f64; 2] {
        let vertices = self.surface.topology().vertices();
        let heights = vertices.map(|v| normal.dot(&self.surface.position(v)));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        })
    }
}
