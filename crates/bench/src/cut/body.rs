//! A body that is cut and restored, and the times of the stages of its cuts.

use super::Parameters;
use crate::measure::{median, percentile, sorted};
use crate::options::MethodArguments;
use incise_cut::{CutOutcome, CutReport, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{ConstraintError, Solver};
use incise_scene::follow_cut;
use serde::{Serialize, Serializer};
use std::error::Error;
use std::time::{Duration, Instant};

/// A body with its cutter and solver.
pub(super) struct CutBody {
    pub(super) surface: Surface,
    cutter: Cutter,
    solver: Solver,
    caps: MethodArguments,
    /// The piece that is cut; none for all.
    pub(super) only_piece: Option<u32>,
}

/// The outcome of a cut and the time of the update of constraints, or the reason of a refusal.
type CutResult = Result<(CutOutcome, Duration), Box<dyn Error>>;

/// Measurements of many cuts.
#[derive(Debug, Default)]
pub(super) struct Outcomes {
    pub(super) times: Vec<StageTimes>,
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
    /// Returns a body of the material and the cuts of some parameters.
    pub(super) fn new(
        mut surface: Surface,
        parameters: &Parameters,
    ) -> Result<Self, ConstraintError> {
        let solver = Solver::new(&mut surface, &parameters.material.material())?;
        let mut cutter = Cutter::new(&surface);
        cutter.set_threads(None);
        cutter.set_defers_bvh(true);
        Ok(Self {
            cutter,
            surface,
            solver,
            caps: parameters.caps,
            only_piece: None,
        })
    }

    /// Cuts and keeps the cut.
    ///
    /// # Errors
    /// An error of the solver. The inner error is the cut's, which changes nothing.
    pub(super) fn cut(&mut self, sweep: &Sweep) -> Result<CutResult, ConstraintError> {
        let (cutter, solver, surface) = (&mut self.cutter, &mut self.solver, &mut self.surface);
        // The solver has changed inverse masses, which share an array with positions.
        cutter.refit_moved(surface, &[]);
        let outcome = match self.caps.cut(cutter, surface, sweep, self.only_piece) {
            Ok(outcome) => outcome,
            Err(error) => return Ok(Err(error)),
        };
        let begin = Instant::now();
        if !outcome.is_miss() {
            follow_cut(cutter, solver, surface, &outcome.delta, None)?;
        }
        Ok(Ok((outcome, begin.elapsed())))
    }

    /// Cuts, records the outcome and undoes the cut: cheaper than a copy, and buffers keep their
    /// capacity. The plane of the sweep names a cut that fails.
    ///
    /// # Errors
    /// An error of the solver or of the undo.
    pub(super) fn probe(
        &mut self,
        sweep: &Sweep,
        normal: Vec3,
        d: f64,
        outcomes: &mut Outcomes,
    ) -> Result<(), Box<dyn Error>> {
        match self.cut(sweep)? {
            Ok((outcome, _)) if outcome.is_miss() => outcomes.missed += 1,
            Ok((outcome, constraints)) => {
                let times = StageTimes::new(&outcome.report, constraints);
                outcomes.times.push(times);
                outcomes.hits.push(outcome.report.hits as f64);
                outcomes.cap_triangles.push(outcome.cap.len() as f64);
                if let Some(undo) = outcome.undo {
                    let delta = self.cutter.undo(&mut self.surface, undo)?;
                    self.solver.apply_delta(&mut self.surface, &delta)?;
                }
            }
            Err(error) => {
                let [x, y, z]: [f64; 3] = normal.into();
                let failure = format!("{error} (plane {x},{y},{z},{d})");
                outcomes.failures.push(failure);
            }
        }
        Ok(())
    }

    /// Scales the positions of pieces from the number `first` on by ten, away from the origin.
    pub(super) fn push_away(&mut self, first: u32) {
        let (surface, topology) = (&self.surface, self.surface.topology());
        let is_moved = |v: &VertexId| surface.piece(topology.outgoing(*v).triangle()) >= first;
        let vertices: Vec<VertexId> = topology.vertices().filter(is_moved).collect();
        for v in vertices {
            for x in &mut self.surface.positions_mut()[v.index()][..3] {
                *x *= 10.0;
            }
        }
        self.cutter.refit(&self.surface);
    }
}

/// Stages of a cut; the last is their sum.
const STAGES: [&str; 10] = [
    "refit",
    "detect",
    "split",
    "cap",
    "refine",
    "separate",
    "commit",
    "bvh_update",
    "constraints",
    "total",
];

/// Times of the stages of a cut, or a statistic of many \[ms\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct StageTimes([f64; 10]);

impl StageTimes {
    /// Returns the times of a report and of the update of constraints.
    pub(super) fn new(report: &CutReport, constraints: Duration) -> Self {
        let stages = [
            Duration::ZERO,
            report.detection,
            report.split,
            report.cap,
            report.refinement,
            report.separation,
            report.commit,
            report.bvh_update,
            constraints,
            report.total() + constraints,
        ];
        Self(stages.map(|time| time.as_secs_f64() * 1e3))
    }

    /// Returns the same with the time of a refit and another sum.
    pub(super) fn with_refit(mut self, refit: Duration, total: Duration) -> Self {
        self.0[0] = refit.as_secs_f64() * 1e3;
        self.0[9] = total.as_secs_f64() * 1e3;
        self
    }

    /// Returns a percentile of every stage.
    pub(super) fn percentile(all: &[Self], percent: usize) -> Self {
        let of = |stage: usize| all.iter().map(|times| times.0[stage]).collect();
        Self(std::array::from_fn(|stage| {
            percentile(&sorted(of(stage)), percent)
        }))
    }

    /// Returns the sum of all stages.
    pub(super) fn total(&self) -> f64 {
        self.0[9]
    }
}

impl Serialize for StageTimes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(STAGES.into_iter().zip(self.0))
    }
}
