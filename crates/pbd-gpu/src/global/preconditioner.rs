//! [`Preconditioner`]: the factor of a body, kept in use while the body is cut.
//!
//! New vertices have no row in the factor; they get the diagonal of the matrix instead. A new
//! factor is made beside the frames and taken into use after a number of frames that depends on
//! the body alone, so that results do not depend on speed.

use super::job::FactorJob;
use super::matrix::{Factor, MatrixInput, NO_ROW, SolveScratch};
use super::objective::Compliances;
use super::{EnergySets, GlobalStats};
use crate::particles::Particles;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;

/// Vertices whose factorization fits into a frame beside the solver's own work.
const VERTICES_PER_FRAME: usize = 4096;

/// Largest ratio of compliances for which a factor is kept; they change with the substep.
const MAX_CHANGE: f64 = 1.5;

/// The approximate inverse of the objective's Hessian.
#[derive(Debug, Default)]
pub(super) struct Preconditioner {
    pub(super) factor: Option<Arc<Factor>>,
    /// Rows of the factor, without those of vertices that have changed since.
    pub(super) rows: Vec<u32>,
    /// Inverse diagonal of the matrix [1/kg], for vertices without a row.
    pub(super) inverse_diagonal: Vec<f64>,
    pub(super) scratch: Option<SolveScratch>,
    /// Compliances and pinned vertices of the last matrix.
    pub(super) compliances: Compliances,
    pub(super) pins: Vec<VertexId>,
    /// Whether vertices have changed since the input of the last factorization.
    pub(super) is_stale: bool,
    /// Whether vertices have changed since the diagonal was computed.
    pub(super) is_diagonal_stale: bool,
    pub(super) pending: Option<Pending>,
    pub(super) factorizations: u32,
    pub(super) factor_time: Duration,
    /// Frames since the input of the factor in use was copied.
    pub(super) factor_age: u32,
}

impl Clone for Preconditioner {
    /// Returns a preconditioner that shares the factor and has scratch memory of its own.
    fn clone(&self) -> Self {
        Self {
            factor: self.factor.clone(),
            rows: self.rows.clone(),
            inverse_diagonal: self.inverse_diagonal.clone(),
            scratch: self.factor.as_ref().and_then(|factor| factor.scratch()),
            pins: self.pins.clone(),
            pending: self.pending.clone(),
            ..*self
        }
    }
}

/// A factorization beside the frames.
#[derive(Debug, Clone)]
pub(super) struct Pending {
    pub(super) job: FactorJob,
    pub(super) frames_left: u32,
    /// Frames since the input was copied.
    pub(super) age: u32,
    pub(super) input: Arc<MatrixInput>,
    /// Vertices that have changed since it was started.
    pub(super) changed: Vec<usize>,
}

impl Preconditioner {
    /// Prepares a frame.
    pub(super) fn prepare(
        &mut self,
        (particles, sets, surface): (&Particles, &EnergySets<'_>, &Surface),
        compliances: Compliances,
        threads: Option<NonZeroUsize>,
    ) {
        self.factor_age = self.factor_age.saturating_add(1);
        if let Some(mut pending) = self.pending.take() {
            pending.frames_left -= 1;
            pending.age += 1;
            if pending.frames_left == 0 {
                self.adopt(pending.job.finish(), &pending.changed, pending.age);
            } else {
                self.pending = Some(pending);
            }
        }
        let pins = particles.pins.iter().map(|pin| pin.vertex);
        self.is_stale |= self.factorizations == 0
            || !self.compliances.is_near(&compliances)
            || !pins.clone().eq(self.pins.iter().copied());
        let is_started = self.is_stale && self.pending.is_none();
        if !(is_started || self.is_diagonal_stale) {
            return;
        }
        let input = Arc::new(MatrixInput::new(sets, surface, compliances));
        self.rows.resize(surface.positions().len(), NO_ROW);
        self.update_diagonal(&input);
        if !is_started {
            return;
        }
        self.is_stale = false;
        self.compliances = compliances;
        self.pins.clear();
        self.pins.extend(pins);
        if self.factor.is_none() {
            let job = FactorJob::start(move || input.factor(), NonZeroUsize::new(1));
            self.adopt(job.finish(), &[], 0);
        } else {
            let own = input.clone();
            self.pending = Some(Pending {
                job: FactorJob::start(move || own.factor(), threads),
                input,
                frames_left: index_u32(2 + surface.positions().len() / VERTICES_PER_FRAME),
                age: 0,
                changed: Vec::new(),
            });
        }
    }

    /// Takes a new factor into use, except for vertices that have changed since.
    fn adopt(&mut self, factor: Option<Arc<Factor>>, changed: &[usize], age: u32) {
        self.factorizations += 1;
        // Without a positive definite matrix, or after a panic, the old factor stays.
        let Some(factor) = factor else { return };
        let slots = self.rows.len();
        self.rows.clear();
        self.rows.extend_from_slice(&factor.rows);
        self.rows.resize(slots, NO_ROW);
        for &v in changed.iter().filter(|&&v| v < slots) {
            self.rows[v] = NO_ROW;
        }
        self.scratch = factor.scratch();
        self.factor_time = factor.time;
        self.factor_age = age;
        self.factor = Some(factor);
    }

    /// Removes vertices from the factor in use and from the one that is being made.
    pub(super) fn forget(&mut self, vertices: impl Iterator<Item = usize>) {
        for v in vertices {
            if let Some(row) = self.rows.get_mut(v) {
                *row = NO_ROW;
            }
            if let Some(pending) = &mut self.pending {
                pending.changed.push(v);
            }
        }
        (self.is_stale, self.is_diagonal_stale) = (true, true);
    }

    /// Computes the inverse diagonal.
    fn update_diagonal(&mut self, input: &MatrixInput) {
        self.is_diagonal_stale = false;
        self.inverse_diagonal.clear();
        (self.inverse_diagonal).extend(
            input
                .diagonal()
                .iter()
                .map(|&sum| if sum > 0.0 { 1.0 / sum } else { 0.0 }),
        );
    }

    /// Replaces a gradient by the preconditioned one.
    pub(super) fn apply(&mut self, vector: &mut [Vec3]) {
        for ((v, &inverse), &row) in vector
            .iter_mut()
            .zip(&self.inverse_diagonal)
            .zip(&self.rows)
        {
            if row == NO_ROW {
                *v *= inverse;
            }
        }
        if let (Some(factor), Some(scratch)) = (&self.factor, &mut self.scratch) {
            factor.solve(&self.rows, vector, scratch);
        }
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let factor = self.factor.as_ref().map_or(0, |factor| factor.bytes());
        let pending = (self.pending.as_ref()).map_or(0, |pending| {
            pending.input.bytes() + 8 * pending.changed.capacity()
        });
        factor + pending + 4 * self.rows.capacity() + 8 * self.inverse_diagonal.capacity()
    }

    /// Returns the statistics of the factor.
    pub(super) fn stats(&self) -> GlobalStats {
        GlobalStats {
            factor_entries: self.factor.as_ref().map_or(0, |factor| factor.entries()),
            bytes: 0,
            factorizations: self.factorizations,
            factor_time: self.factor_time,
            factor_age: self.factor_age,
        }
    }
}

impl Compliances {
    /// Returns whether a factor for these compliances is a good one for others.
    fn is_near(&self, other: &Self) -> bool {
        let pairs = [
            (self.stretch, other.stretch),
            (self.bending, other.bending),
            (self.interior_springs, other.interior_springs),
        ];
        pairs
            .iter()
            .all(|(a, b)| *a <= MAX_CHANGE * b && *b <= MAX_CHANGE * a)
    }
}
