//! A body that is cut and restored.

use super::times::Times;
use crate::method::{Method, Refusal};
use crate::motion;
use crate::statistics::median;
use incise_cut::{Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, Undo};
use incise_pbd_gpu::Solver;
use incise_scene::follow_cut;
use std::error::Error;
use std::time::Instant;

/// A body with its cutter and solver.
pub(super) struct CutBody {
    pub(super) surface: Surface,
    cutter: Cutter,
    solver: Solver,
}

/// A successful cut.
struct Cut {
    times: Times,
    hits: usize,
    cap_triangles: usize,
    undo: Option<Undo>,
}

/// Measurements of many cuts.
#[derive(Debug, Default)]
pub(super) struct Outcomes {
    pub(super) times: Vec<Times>,
    pub(super) hits: Vec<f64>,
    cap_triangles: Vec<f64>,
    /// Number of sweeps without a hit.
    pub(super) missed: usize,
    /// Errors with their planes.
    pub(super) failures: Vec<String>,
}

impl Outcomes {
    /// Returns the medians of hit triangles and of cap triangles.
    pub(super) fn medians(&self) -> [f64; 2] {
        [&self.hits, &self.cap_triangles].map(|values| median(values.clone()))
    }
}

impl CutBody {
    /// Returns a body of the table's material.
    pub(super) fn new(mut surface: Surface) -> Result<Self, Box<dyn Error>> {
        let solver = Solver::new(&mut surface, &motion::material())?;
        let mut cutter = Cutter::new(&surface);
        cutter.set_threads(None);
        cutter.set_defers_bvh(true);
        Ok(Self {
            cutter,
            surface,
            solver,
        })
    }

    /// Cuts and times it; none where the sweep misses. The inner error is the cut's and changes
    /// nothing.
    fn timed_cut(
        &mut self,
        sweep: &Sweep,
        method: &Method,
    ) -> Result<Result<Option<Cut>, Refusal>, Box<dyn Error>> {
        // The solver has changed inverse masses, which share an array with positions.
        self.cutter.refit_moved(&self.surface, &[]);
        let outcome = match method.cut(&mut self.cutter, &mut self.surface, sweep) {
            Ok(outcome) => outcome,
            Err(error) => return Ok(Err(error)),
        };
        if outcome.is_miss() {
            return Ok(Ok(None));
        }
        let begin = Instant::now();
        let (cutter, solver, surface) = (&mut self.cutter, &mut self.solver, &mut self.surface);
        follow_cut(cutter, solver, surface, &outcome.delta, None)?;
        Ok(Ok(Some(Cut {
            times: Times::new(&outcome.report, begin.elapsed()),
            hits: outcome.report.hits,
            cap_triangles: outcome.cap.len(),
            undo: outcome.undo,
        })))
    }

    /// Cuts and keeps the cut; a failed cut changes nothing.
    pub(super) fn cut(&mut self, sweep: &Sweep, method: &Method) -> Result<(), Box<dyn Error>> {
        self.timed_cut(sweep, method).map(|_| ())
    }

    /// Cuts, records the outcome and undoes the cut: cheaper than a copy, and buffers keep their
    /// capacity.
    ///
    /// # Errors
    /// An error of the solver or of the undo; `plane` names a cut that fails.
    pub(super) fn probe(
        &mut self,
        (sweep, plane): (&Sweep, [f64; 4]),
        method: &Method,
        outcomes: &mut Outcomes,
    ) -> Result<(), Box<dyn Error>> {
        match self.timed_cut(sweep, method)? {
            Ok(Some(cut)) => {
                outcomes.times.push(cut.times);
                outcomes.hits.push(cut.hits as f64);
                outcomes.cap_triangles.push(cut.cap_triangles as f64);
                if let Some(undo) = cut.undo {
                    let delta = self.cutter.undo(&mut self.surface, undo)?;
                    self.solver.apply_delta(&mut self.surface, &delta)?;
                }
            }
            Ok(None) => outcomes.missed += 1,
            Err(error) => {
                let [x, y, z, d] = plane;
                let failure = format!("{error} (plane {x},{y},{z},{d})");
                outcomes.failures.push(failure);
            }
        }
        Ok(())
    }

    /// Scales the positions of pieces from the number `first` on by ten, away from the origin.
    pub(super) fn push_away(&mut self, first: u32) {
        let mut is_moved = vec![false; self.surface.positions().len()];
        let triangles: Vec<TriangleId> = self.surface.topology().triangles().collect();
        for t in triangles {
            if self.surface.piece(t) >= first {
                for v in self.surface.topology().triangle(t) {
                    if !std::mem::replace(&mut is_moved[v.index()], true) {
                        for x in &mut self.surface.positions_mut()[v.index()][..3] {
                            *x *= 10.0;
                        }
                    }
                }
            }
        }
        self.cutter.refit(&self.surface);
    }
}
