//! [`Preconditioner`]: the factor of a body, kept in use while the body is cut.
//!
//! Touched vertices, those of triangles that an edit changed, have no row in the factor. They get a
//! [`LocalFactor`] of their own in the frame of the edit. A new factor is computed in the
//! background and taken into use after a number of frames that depends on the body alone, so that
//! results do not depend on speed.

use super::coordinates::{self, COORDINATES};
use super::free_pieces::FreePieces;
use super::job::FactorJob;
use super::local::LocalFactor;
use super::matrix::{Factor, MatrixInput, NO_ROW};
use super::objective::Compliances;
use super::{EnergySets, GlobalStats};
use crate::particles::Particles;
use incise_mesh::{Surface, Vec3, VertexId, index_u32};
use incise_sparse::Scratch;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Duration;

/// Vertices whose factorization fits into a frame beside the solver's own work.
const VERTICES_PER_FRAME: usize = 4096;

/// Largest ratio of compliances for which a factor is kept; they change with the substep.
const MAX_CHANGE: f64 = 1.5;

/// The approximate inverse of the objective's Hessian.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Preconditioner {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) factor: Option<Arc<Factor>>,
    /// The input of the factor, from which a loaded body makes it again.
    pub(super) input: Option<Arc<MatrixInput>>,
    /// Rows of the factor, without those of vertices that have changed since.
    pub(super) rows: Vec<u32>,
    /// The matrix of the vertices without a row.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) local: Option<LocalFactor>,
    /// Pieces without a pin; none while the factor has all rows.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) free: FreePieces,
    /// Inverse diagonal of the matrix [1/kg], for vertices without a row; empty with `local`.
    pub(super) inverse_diagonal: Vec<f64>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) scratch: Option<Scratch>,
    /// Compliances and pinned vertices of the last matrix.
    pub(super) compliances: Compliances,
    pub(super) pins: Vec<VertexId>,
    /// Whether vertices have changed since the input of the last factorization.
    pub(super) is_stale: bool,
    /// Whether vertices have lost or got their rows since `local` or the diagonal was made.
    pub(super) is_local_stale: bool,
    /// Whether `local` was made in this frame because of an edit, of masses or of a new factor.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) is_local_new: bool,
    /// Compliances and pinned vertices of `local` or the diagonal.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) local_compliances: Compliances,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) local_pins: Vec<VertexId>,
    pub(super) pending: Option<Pending>,
    pub(super) factorizations: u32,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) factor_time: Duration,
    /// Frames since the input of the factor in use was copied.
    pub(super) factor_age: u32,
}

impl Clone for Preconditioner {
    /// Returns a preconditioner that shares the factor and has scratch memory of its own.
    fn clone(&self) -> Self {
        Self {
            factor: self.factor.clone(),
            input: self.input.clone(),
            rows: self.rows.clone(),
            local: self.local.as_ref().and_then(LocalFactor::share),
            free: self.free.clone(),
            inverse_diagonal: self.inverse_diagonal.clone(),
            local_pins: self.local_pins.clone(),
            scratch: self
                .factor
                .as_ref()
                .and_then(|factor| factor.cholesky.scratch(COORDINATES)),
            pins: self.pins.clone(),
            pending: self.pending.clone(),
            ..*self
        }
    }
}

/// A factorization in the background.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pending {
    #[cfg_attr(feature = "serde", serde(skip))]
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
        self.is_local_new = false;
        if let Some(mut pending) = self.pending.take() {
            pending.frames_left -= 1;
            pending.age = pending.age.saturating_add(1);
            if pending.frames_left == 0 {
                let made = pending.job.finish().map(|factor| (factor, pending.input));
                self.adopt(made, &pending.changed, pending.age);
            } else {
                self.pending = Some(pending);
            }
        }
        let pins = || particles.pins.iter().map(|pin| pin.vertex);
        self.is_stale |= self.factorizations == 0
            || !self.compliances.is_near(&compliances)
            || !pins().eq(self.pins.iter().copied());
        self.rows.resize(surface.positions().len(), NO_ROW);
        let mut input = None;
        if self.is_stale && self.pending.is_none() {
            self.is_stale = false;
            self.compliances = compliances;
            self.pins.clear();
            self.pins.extend(pins());
            let of_body = Arc::new(MatrixInput::new(sets, surface, compliances));
            let own = of_body.clone();
            if self.factor.is_none() {
                let job = FactorJob::start(move || own.factor(), NonZeroUsize::new(1));
                let made = job.finish().map(|factor| (factor, of_body.clone()));
                self.adopt(made, &[], 0);
            } else {
                self.pending = Some(Pending {
                    job: FactorJob::start(move || own.factor(), threads),
                    input: of_body.clone(),
                    frames_left: index_u32(2 + surface.positions().len() / VERTICES_PER_FRAME),
                    age: 0,
                    changed: Vec::new(),
                });
            }
            input = Some(of_body);
        }
        let mut vertices = self.rows.iter().zip(surface.positions());
        if vertices.all(|(&row, p)| row != NO_ROW || p[3] == 0.0) {
            self.is_local_stale = false;
            self.local = None;
            self.free = FreePieces::default();
            self.inverse_diagonal.clear();
            // The next vertex without a row needs new ones, with the same pins or others.
            self.local_compliances = Compliances::default();
            self.local_pins.clear();
        } else if self.is_local_stale
            // Exactly, so that a loaded body makes the same factor.
            || self.local_compliances != compliances
            || !pins().eq(self.local_pins.iter().copied())
        {
            self.local_compliances = compliances;
            self.local_pins.clear();
            self.local_pins.extend(pins());
            let input =
                input.unwrap_or_else(|| Arc::new(MatrixInput::new(sets, surface, compliances)));
            self.free = FreePieces::new(&input, surface);
            self.update_local(&input);
            self.is_local_new = self.is_local_stale && self.local.is_some();
            self.is_local_stale = false;
        }
    }

    /// Returns whether this frame has made a factor for the region of an edit of a large body.
    pub(super) fn is_edit_slow(&self) -> bool {
        self.is_local_new && self.rows.len() > VERTICES_PER_FRAME
    }

    /// Takes a new factor of an input into use, except for vertices that have changed since.
    fn adopt(
        &mut self,
        made: Option<(Arc<Factor>, Arc<MatrixInput>)>,
        changed: &[usize],
        age: u32,
    ) {
        self.factorizations = self.factorizations.saturating_add(1);
        self.is_local_stale = true;
        // Without a positive definite matrix, or after a panic, the old factor stays.
        let Some((factor, input)) = made else { return };
        let slots = self.rows.len();
        self.rows.clear();
        self.rows.extend_from_slice(&factor.rows);
        self.rows.resize(slots, NO_ROW);
        for &v in changed.iter().filter(|&&v| v < slots) {
            self.rows[v] = NO_ROW;
        }
        self.scratch = factor.cholesky.scratch(COORDINATES);
        self.factor_time = factor.time;
        self.factor_age = age;
        self.factor = Some(factor);
        self.input = Some(input);
    }

    /// Makes the next frame start a new factor, after a change of masses.
    pub(super) fn mark_stale(&mut self) {
        (self.is_stale, self.is_local_stale) = (true, true);
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
        self.mark_stale();
    }

    /// Factors the matrix of the vertices without a row, or computes its inverse diagonal.
    fn update_local(&mut self, input: &MatrixInput) {
        self.inverse_diagonal.clear();
        self.local = LocalFactor::new(input, &self.rows);
        if self.local.is_none() {
            let masses = (0..self.rows.len()).map(|v| input.mass(v));
            self.inverse_diagonal.extend(masses);
            input.for_each_entry(
                |v| self.rows[v] == NO_ROW,
                |a, b, value| {
                    if a == b {
                        self.inverse_diagonal[a] += value;
                    }
                },
            );
            for sum in &mut self.inverse_diagonal {
                *sum = if *sum > 0.0 { 1.0 / *sum } else { 0.0 };
            }
        }
    }

    /// Replaces a gradient by the preconditioned one.
    pub(super) fn apply(&mut self, vector: &mut [Vec3]) {
        let Self {
            factor,
            scratch,
            rows,
            local,
            free,
            inverse_diagonal,
            ..
        } = self;
        let solve = |vector: &mut [Vec3]| {
            if let (Some(factor), Some(scratch)) = (factor, scratch) {
                let known = rows.iter().enumerate().filter(|&(_, &row)| row != NO_ROW);
                let known = known.map(|(v, &row)| (row as usize, v));
                coordinates::solve(&factor.cholesky, known, vector, scratch);
            }
        };
        free.apply(vector, |vector| match local {
            Some(local) => local.apply(vector, solve),
            None => {
                let vertices = vector.iter_mut().zip(&*inverse_diagonal).zip(&*rows);
                for ((v, &inverse), &row) in vertices {
                    if row == NO_ROW {
                        *v *= inverse;
                    }
                }
                solve(vector);
            }
        });
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        let factor = self.factor.as_ref().map_or(0, |factor| factor.bytes());
        let input = self.input.as_ref().map_or(0, |input| input.bytes());
        let pending = (self.pending.as_ref()).map_or(0, |pending| {
            pending.input.bytes() + 8 * pending.changed.capacity()
        });
        let local = self.local.as_ref().map_or(0, LocalFactor::bytes);
        factor
            + input
            + pending
            + local
            + self.free.bytes()
            + 4 * (self.rows.capacity() + self.local_pins.capacity())
            + 8 * self.inverse_diagonal.capacity()
    }

    /// Returns the statistics of the factor.
    pub(super) fn stats(&self) -> GlobalStats {
        GlobalStats {
            factor_entries: self
                .factor
                .as_ref()
                .map_or(0, |factor| factor.cholesky.entries()),
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
