//! Sleeping: bodies at rest are not stepped until something wakes them. Driven by `frame.rs`.
//!
//! A sleeping body keeps its positions and velocities and continues from the same bits when it
//! wakes. So sleeping only suppresses motion slower than [`SleepParams::speed`].
//!
//! An awake body is observed for [`SleepParams::seconds`]. The decision follows
//! [`SleepParams::LAG`] frames later, when the GPU's measurement has arrived; it then either falls
//! asleep or is observed again.

mod rest_drift;

use crate::body::Body;
use crate::contacts::ContactParams;
use crate::params::SceneParams;
#[cfg(feature = "serde")]
use crate::save::LoadError;
use incise_mesh::Aabb;
#[cfg(feature = "serde")]
use incise_mesh::index_u32;
use incise_params::Range;
use incise_pbd_gpu::SolverParams;
use rest_drift::{LAST, RestDrift};

incise_params::params! {
    /// Parameters of sleeping. Touching bodies and all pieces of a body sleep together.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SleepParams {
        /// Maximum speed of a vertex along an axis at rest.
        ///
        /// Measured in the fastest substep. Bodies that touch others may also jitter by a twentieth
        /// of an edge length if they are back in frames 8 to 20 and again in frames 21 to 32 of the
        /// observation. This takes more than 32 frames, [`SleepParams::LAG`] included. Rounding
        /// adds up to four times as much: a few units in the last place of the body's largest
        /// coordinate. A body whose coordinates round more coarsely stays awake. A body that creeps
        /// more slowly than this is stopped by its sleep. Edges are those of the surface, or of the
        /// cells of a solid ([`incise_pbd_gpu::Solver::resolution`]).
        speed: f32 = 6e-3, range: Range::NOT_NEGATIVE, unit: "edges per second";
        /// Time for which every vertex must be slower.
        ///
        /// A body thrown upwards is slow for a moment at the top of its flight; choose a longer
        /// time. A body sleeps at the latest twice this time and [`SleepParams::LAG`] frames after
        /// it came to rest.
        seconds: f32 = 0.5, range: Range::NOT_NEGATIVE, unit: "s";
    }
}

impl SleepParams {
    /// Number of frames between the last observed frame and the decision to sleep.
    ///
    /// The GPU's measurement arrives within this time without a wait, and the decision is made in
    /// the same frame on CPU and GPU.
    pub const LAG: u32 = 3;

    /// Returns the number of observed frames of `dt` \[s\], at least 1.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a saturating cast of a positive number"
    )]
    pub fn frames(&self, dt: f32) -> u32 {
        // A frame of which only the rounding of the quotient remains does not count.
        let frames = (f64::from(self.seconds) / f64::from(dt) - 1e-3).ceil();
        (frames as u32).clamp(1, u32::MAX - Self::LAG)
    }

    /// Returns the maximum displacement of a vertex at rest along an axis in a substep \[m\].
    ///
    /// `edge` is the body's resolution \[m\], `bounds` its box \[m\] and `h` the duration of the
    /// substep \[s\].
    pub(crate) fn limit(&self, edge: f64, bounds: &Aabb, h: f64) -> f64 {
        let corners = bounds.min.into_iter().chain(bounds.max);
        let largest = corners.map(f32::abs).fold(0.0, f32::max);
        let rounding = 2.0 * f64::from(f32::EPSILON) * f64::from(largest);
        let slow = f64::from(self.speed) * edge * h;
        slow + rounding.min(MAX_ROUNDING * slow)
    }
}

/// Maximum displacement attributed to rounding, relative to the displacement at rest.
const MAX_ROUNDING: f64 = 4.0;

/// Maximum jitter of a vertex at rest, in mean rest edge lengths.
const MAX_JITTER: f64 = 0.05;

/// Maximum relative change of [`Conditions::substep`] that wakes no body.
///
/// Without a fixed substep the frame of a display is one, and its length jitters by less.
const SUBSTEP_TOLERANCE: f32 = 0.2;

/// The parameters under which bodies fell asleep: a change wakes them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Conditions {
    /// Length of a substep; that of a frame if it is not fixed \[s\].
    substep: f32,
    solver: SolverParams,
    contacts: Option<ContactParams>,
    sleep: Option<SleepParams>,
}

/// The observation of an awake body.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Observation {
    /// Number of frames since it started.
    frames: u32,
    /// Duration of these frames \[s\].
    time: f64,
    /// Number of observed frames, once they are over.
    observed: Option<u32>,
    /// Maximum displacement along an axis in a substep of the observed frames \[m\].
    max_displacement: f32,
    /// Whether that was small enough, once the observed frames are over.
    is_at_rest: bool,
}

impl Observation {
    /// Returns whether the observed frames are over after one more of `dt` \[s\].
    fn ends_after(&self, sleep: &SleepParams, dt: f32) -> bool {
        // A frame of which only the rounding of the sum remains does not count.
        let dt = f64::from(dt);
        self.time + dt >= f64::from(sleep.seconds) - 1e-3 * dt
    }

    /// Returns whether the decision follows, [`SleepParams::LAG`] frames after the observed ones.
    fn is_over(&self) -> bool {
        self.observed
            .is_some_and(|observed| self.frames >= observed + SleepParams::LAG)
    }

    /// Adds a frame of `dt` \[s\], up to the decision.
    fn count(&mut self, sleep: &SleepParams, dt: f32) {
        if self.is_over() {
            return;
        }
        let ends = self.observed.is_none() && self.ends_after(sleep, dt);
        self.frames = self.frames.saturating_add(1);
        self.time += f64::from(dt);
        if ends {
            self.observed = Some(self.frames);
        }
    }
}

/// The frames of an observation in which a GPU measurement starts or ends.
#[cfg(feature = "gpu")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// The first observed frame.
    First {
        /// Whether it is also the last one.
        is_last: bool,
    },
    /// The last observed frame.
    LastObserved,
    /// The frame after which the body falls asleep if it was at rest.
    Decision,
    /// Any other frame.
    Other,
}

/// The sleeping state of all bodies, in arrays by body index.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sleep {
    asleep: Vec<bool>,
    /// Boxes of sleeping bodies; [`EVERYWHERE`] for an unknown one.
    bounds: Vec<Aabb>,
    observations: Vec<Observation>,
    drifts: Vec<RestDrift>,
    /// First body of the island in which a sleeping body fell asleep.
    islands: Vec<usize>,
    #[cfg_attr(feature = "serde", serde(skip))]
    sleeping_bodies: u32,
    woken: u32,
    conditions: Option<Conditions>,
    /// Duration of the current frame \[s\].
    #[cfg_attr(feature = "serde", serde(skip))]
    dt: f32,
}

/// A box that overlaps every other one.
const EVERYWHERE: Aabb = Aabb {
    min: [f32::NEG_INFINITY; 3],
    max: [f32::INFINITY; 3],
};

impl Sleep {
    /// Completes a state that was read with serde, of a number of bodies, removed ones included.
    ///
    /// # Errors
    /// [`LoadError::Array`].
    #[cfg(feature = "serde")]
    pub(crate) fn finish_load(&mut self, bodies: usize) -> Result<(), LoadError> {
        let lengths = [
            self.asleep.len(),
            self.bounds.len(),
            self.observations.len(),
            self.drifts.len(),
            self.islands.len(),
        ];
        let is_observation = |observation: &Observation| {
            observation.frames < u32::MAX - SleepParams::LAG
                && observation.observed.is_none_or(|n| n <= observation.frames)
        };
        let is_valid = lengths == [bodies; 5]
            && self.islands.iter().all(|&i| i < bodies)
            && self.observations.iter().all(is_observation);
        let sleeping = self.asleep.iter().filter(|&&is_asleep| is_asleep);
        self.sleeping_bodies = index_u32(sleeping.count());
        let array = "sleeping states";
        is_valid.then_some(()).ok_or(LoadError::Array { array })
    }

    /// Adds body `i`, awake; all bodies before it have been added.
    pub(crate) fn add(&mut self, i: usize) {
        self.asleep.resize(i + 1, false);
        self.bounds.resize(i + 1, EVERYWHERE);
        self.observations.resize(i + 1, Observation::default());
        self.drifts.resize(i + 1, RestDrift::default());
        self.islands.resize(i + 1, i);
    }

    /// Removes a body and wakes its island. The index is not reused.
    pub(crate) fn remove(&mut self, i: usize) {
        self.drifts[i] = RestDrift::default();
        if std::mem::replace(&mut self.asleep[i], false) {
            self.sleeping_bodies -= 1;
            self.wake_island(self.islands[i]);
        }
    }

    pub(crate) fn is_asleep(&self, i: usize) -> bool {
        self.asleep[i]
    }

    /// Returns the number of sleeping bodies.
    pub(crate) fn sleeping_bodies(&self) -> u32 {
        self.sleeping_bodies
    }

    /// Returns whether a body sleeps and its box does not overlap `other`.
    #[inline]
    pub(crate) fn is_far(&self, i: usize, other: &Aabb) -> bool {
        self.asleep[i] && !self.bounds[i].overlaps(other)
    }

    /// Wakes a body and its island, or restarts the observation of an awake body.
    pub(crate) fn wake(&mut self, i: usize) {
        if self.asleep[i] {
            self.wake_island(self.islands[i]);
        }
        self.wake_one(i);
    }

    /// Wakes the bodies that fell asleep in an island.
    fn wake_island(&mut self, island: usize) {
        for i in island..self.asleep.len() {
            if self.asleep[i] && self.islands[i] == island {
                self.wake_one(i);
            }
        }
    }

    fn wake_one(&mut self, i: usize) {
        self.observations[i] = Observation::default();
        if std::mem::replace(&mut self.asleep[i], false) {
            self.sleeping_bodies -= 1;
            self.woken = self.woken.saturating_add(1);
        }
    }

    pub(crate) fn wake_all(&mut self) {
        for i in 0..self.asleep.len() {
            self.wake_one(i);
        }
    }

    /// Returns the parameters of the current frame, if bodies may sleep.
    fn params(&self) -> Option<SleepParams> {
        self.conditions.and_then(|conditions| conditions.sleep)
    }

    /// Returns the number of bodies that woke since the last call.
    pub(crate) fn take_woken(&mut self) -> u32 {
        std::mem::take(&mut self.woken)
    }

    /// Begins a frame; wakes all bodies if its parameters differ from those of the previous one.
    pub(crate) fn begin_frame(&mut self, params: &SceneParams) {
        self.dt = params.dt;
        let mut conditions = Conditions {
            substep: params.solver.substep.unwrap_or(params.dt),
            solver: params.solver,
            contacts: params.contacts,
            sleep: params.sleep,
        };
        if let Some(previous) = self.conditions
            && (conditions.substep / previous.substep - 1.0).abs() <= SUBSTEP_TOLERANCE
        {
            conditions.substep = previous.substep;
        }
        if self.conditions != Some(conditions) {
            self.conditions = Some(conditions);
            self.wake_all();
        }
    }

    /// Records a frame of an awake body and its maximum displacement in a substep \[m\].
    ///
    /// Returns the maximum of all observed frames after the last of them; the caller then calls
    /// [`Sleep::set_at_rest`].
    pub(crate) fn observe(&mut self, i: usize, max_displacement: f32) -> Option<f32> {
        let was_observed = self.observations[i].observed.is_some();
        self.count_frame(i);
        if was_observed {
            return None;
        }
        let observation = &mut self.observations[i];
        observation.max_displacement = observation.max_displacement.max(max_displacement);
        observation.observed.map(|_| observation.max_displacement)
    }

    /// Measures before a frame whether an awake body that touches others has left its place.
    ///
    /// Contacts are found on the CPU, which has the positions of such bodies.
    pub(crate) fn measure(&mut self, i: usize, body: &Body, params: &SceneParams) {
        let Some(sleep) = &params.sleep else { return };
        // The observation is too short to compare positions.
        if sleep.frames(params.dt).saturating_add(SleepParams::LAG) <= LAST {
            return;
        }
        let Observation { frames, time, .. } = self.observations[i];
        let (surface, solver) = (body.surface(), body.solver());
        let slow = sleep.limit(solver.resolution(), &surface.bounds(), time);
        let jitter = MAX_JITTER * solver.mean_rest_length();
        let limits = [slow, f64::max(slow, jitter)];
        self.drifts[i].measure(surface.positions(), frames, limits);
    }

    /// Records a frame of an awake body.
    pub(crate) fn count_frame(&mut self, i: usize) {
        self.drifts[i].end_frame();
        if let Some(sleep) = self.params() {
            self.observations[i].count(&sleep, self.dt);
        }
    }

    /// Returns the role of a body's next frame in its observation.
    #[cfg(feature = "gpu")]
    pub(crate) fn begin_step(&self, i: usize, is_enabled: bool) -> Step {
        if !is_enabled {
            return Step::Other;
        }
        let Some(sleep) = self.params() else {
            return Step::Other;
        };
        let observation = &self.observations[i];
        let is_last = observation.observed.is_none() && observation.ends_after(&sleep, self.dt);
        let decides = |observed| observation.frames + 1 == observed + SleepParams::LAG;
        if observation.frames == 0 {
            // A single observed frame is both the first and the last one.
            Step::First { is_last }
        } else if is_last {
            Step::LastObserved
        } else if observation.observed.is_some_and(decides) {
            Step::Decision
        } else {
            Step::Other
        }
    }

    /// Records whether a body was at rest in the observed frames.
    pub(crate) fn set_at_rest(&mut self, i: usize, is_at_rest: bool) {
        self.observations[i].is_at_rest = is_at_rest;
    }

    /// Makes the bodies of an island be observed for the same time, that of the latest one.
    pub(crate) fn join(&mut self, members: &[usize]) {
        let observations = members.iter().map(|&i| self.observations[i]);
        let Some(latest) = observations.min_by_key(|observation| observation.frames) else {
            return;
        };
        for &i in members {
            let observation = &mut self.observations[i];
            observation.frames = latest.frames;
            observation.time = latest.time;
            observation.observed = latest.observed;
        }
    }

    /// Returns whether the bodies of an island are to fall asleep now.
    ///
    /// Otherwise restarts a completed observation.
    pub(crate) fn take_decision(&mut self, members: &[usize]) -> bool {
        let is_over = |&i: &usize| self.observations[i].is_over();
        if !members.iter().all(is_over) {
            return false;
        }
        let is_at_rest =
            |&i: &usize| self.observations[i].is_at_rest || self.drifts[i].is_in_place();
        let are_at_rest = members.iter().all(is_at_rest);
        for &i in members {
            self.observations[i] = Observation::default();
        }
        are_at_rest
    }

    /// Returns the bounding box of a sleeping body.
    pub(crate) fn bounds(&self, i: usize) -> Aabb {
        self.bounds[i]
    }

    /// Sets the bounding box of a sleeping body.
    pub(crate) fn set_bounds(&mut self, i: usize, bounds: Aabb) {
        self.bounds[i] = bounds;
    }

    /// Puts a body to sleep in its bounding box, `None` if it is unknown.
    ///
    /// `island` is the first body of its island.
    pub(crate) fn fall_asleep(&mut self, i: usize, island: usize, bounds: Option<Aabb>) {
        self.islands[i] = island;
        self.asleep[i] = true;
        self.drifts[i] = RestDrift::default();
        self.bounds[i] = bounds.unwrap_or(EVERYWHERE);
        self.sleeping_bodies += 1;
    }
}
