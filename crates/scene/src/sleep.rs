//! Bodies at rest, which are left alone until something comes to them.
//!
//! For a body that sleeps time stands still: it keeps its positions and its velocities, which are next to nothing, and
//! woken it goes on with the bits that it would have had. So all that sleeping can lose is what would have moved
//! by itself, slower than [`SleepParams::speed`].

use crate::contacts::ContactParams;
use crate::error::SceneError;
use crate::params::SceneParams;
use incise_mesh::Aabb;
use incise_pbd_gpu::SolverParams;

/// When a body falls asleep. A body that was cut is one body still: it sleeps when all of its pieces are at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SleepParams {
    /// How fast a vertex may move along an axis, in mean lengths of the body's edges at rest a second. Taken from
    /// its fastest substep, without what rounding makes of it there, a few units in the last place of the body's largest coordinate: up
    /// to four times as much again, so a body whose coordinates are too coarse to tell stays awake. A body
    /// that moves no faster all the time is stopped by its sleep, so this is to be less than anybody sees.
    pub speed: f32,
    /// For how long no vertex may have moved faster \[s\]. A body that is thrown up is slow for a moment at the top of its
    /// flight, so a moment is not enough.
    ///
    /// It is looked at once in so long a time and [`SleepParams::LAG`] frames more, so a body sleeps after twice as long at
    /// the latest.
    pub seconds: f32,
}

impl SleepParams {
    /// Frames between the last one that counts and the one after which a body sleeps. That is how far a device may be
    /// behind: what it says is there by then, nobody waits for it, and bodies sleep at the same frame wherever they live.
    pub const LAG: u32 = 3;

    /// How many frames of `dt` \[s\] count, at least 1.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a saturating cast of a positive number"
    )]
    pub fn frames(&self, dt: f32) -> u32 {
        // A frame that begins with the rounding of the last one is none.
        let frames = (f64::from(self.seconds) / f64::from(dt) - 1e-3).ceil();
        (frames as u32).clamp(1, u32::MAX - Self::LAG)
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`SceneError::BadSleep`] with the first one out of its range.
    pub fn check(&self) -> Result<(), SceneError> {
        for (name, value) in [("speed", self.speed), ("seconds", self.seconds)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(SceneError::BadSleep { name, value });
            }
        }
        Ok(())
    }

    /// The most that a vertex of a body at rest moves along an axis in a substep of `h` \[m\], for edges of a mean
    /// length and a box \[m\].
    pub(crate) fn limit(&self, edge: f64, bounds: &Aabb, h: f64) -> f64 {
        let corners = bounds.min.into_iter().chain(bounds.max);
        let largest = corners.map(f32::abs).fold(0.0, f32::max);
        let rounding = 2.0 * f64::from(f32::EPSILON) * f64::from(largest);
        let slow = f64::from(self.speed) * edge * h;
        slow + rounding.min(MOST_ROUNDING * slow)
    }
}

impl Default for SleepParams {
    /// Less than a hundredth of an edge a second, for half a second: a body that turns back at the top of its flight is as
    /// slow for a millisecond. Bodies that are damped come to rest far below: what is left of their motion is rounding.
    fn default() -> Self {
        Self {
            speed: 6e-3,
            seconds: 0.5,
        }
    }
}

/// The most that rounding is believed to add to a motion, over what is slow.
const MOST_ROUNDING: f64 = 4.0;

/// How far the time of a frame may be from that under which bodies fell asleep, over it: clocks are not exact.
const JITTER: f32 = 0.2;

/// Under what bodies fell asleep: anything else may set them in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Terms {
    dt: f32,
    solver: SolverParams,
    contacts: Option<ContactParams>,
    sleep: Option<SleepParams>,
}

/// How long a body that is awake has been watched.
#[derive(Debug, Clone, Copy, Default)]
struct Watch {
    frames: u32,
    /// The farthest that a vertex moved along an axis in a substep of the frames that count \[m\].
    farthest: f32,
    /// Whether that is as little as in a body at rest, once they are over.
    is_quiet: bool,
}

/// The frames of a watch that a device has to be told of.
#[cfg(feature = "gpu")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// The first one, which may be the last one that counts.
    First { is_last: bool },
    /// The last one that counts.
    LastThatCounts,
    /// The one after which the body sleeps if it is to.
    Last,
    /// Any other.
    Other,
}

/// Which bodies sleep. Lists by body, one entry a body, so that a frame that everybody sleeps through looks at
/// nothing else.
#[derive(Debug, Default)]
pub(crate) struct Sleep {
    asleep: Vec<bool>,
    /// Boxes of those that sleep; of one whose box nobody knows one that meets everything.
    boxes: Vec<Aabb>,
    watches: Vec<Watch>,
    sleepers: u32,
    woken: u32,
    terms: Option<Terms>,
    /// The frames of a watch that count.
    counted: u32,
}

/// Meets everything.
const EVERYWHERE: Aabb = Aabb {
    min: [f32::NEG_INFINITY; 3],
    max: [f32::INFINITY; 3],
};

impl Sleep {
    /// Takes in body `i`, awake; those before it have been taken in.
    pub(crate) fn add(&mut self, i: usize) {
        self.asleep.resize(i + 1, false);
        self.boxes.resize(i + 1, EVERYWHERE);
        self.watches.resize(i + 1, Watch::default());
    }

    /// Forgets a body that was removed.
    pub(crate) fn remove(&mut self, i: usize) {
        if std::mem::replace(&mut self.asleep[i], false) {
            self.sleepers -= 1;
        }
    }

    pub(crate) fn is_asleep(&self, i: usize) -> bool {
        self.asleep[i]
    }

    /// How many sleep.
    pub(crate) fn sleepers(&self) -> u32 {
        self.sleepers
    }

    /// Whether a body sleeps where `reach` does not come.
    #[inline]
    pub(crate) fn is_far(&self, i: usize, reach: &Aabb) -> bool {
        self.asleep[i] && !self.boxes[i].overlaps(reach)
    }

    /// Wakes a body, or has one that is awake watched anew: something happens to it.
    pub(crate) fn wake(&mut self, i: usize) {
        self.watches[i] = Watch::default();
        if std::mem::replace(&mut self.asleep[i], false) {
            self.sleepers -= 1;
            self.woken += 1;
        }
    }

    pub(crate) fn wake_all(&mut self) {
        for i in 0..self.asleep.len() {
            self.wake(i);
        }
    }

    /// How many woke since it was asked last.
    pub(crate) fn take_woken(&mut self) -> u32 {
        std::mem::take(&mut self.woken)
    }

    /// Begins a frame: wakes all if it is another kind of frame than the one before.
    pub(crate) fn begin_frame(&mut self, params: &SceneParams) {
        let mut terms = Terms {
            dt: params.dt,
            solver: params.solver,
            contacts: params.contacts,
            sleep: params.sleep,
        };
        if let Some(known) = self.terms
            && (terms.dt / known.dt - 1.0).abs() <= JITTER
        {
            terms.dt = known.dt;
        }
        if self.terms != Some(terms) {
            self.terms = Some(terms);
            self.counted = params.sleep.map_or(1, |sleep| sleep.frames(terms.dt));
            self.wake_all();
        }
    }

    /// Notes that a body that is awake was stepped, and how far a vertex moved at most in a substep \[m\]. After the last
    /// frame that counts, how far it did in all of them: [`Sleep::judge`] is to be called.
    pub(crate) fn note(&mut self, i: usize, farthest: f32) -> Option<f32> {
        self.count(i);
        let counted = self.counted;
        let watch = &mut self.watches[i];
        if watch.frames <= counted {
            watch.farthest = watch.farthest.max(farthest);
        }
        (watch.frames == counted).then_some(watch.farthest)
    }

    /// Notes that a body that is awake was stepped.
    pub(crate) fn count(&mut self, i: usize) {
        let frames = &mut self.watches[i].frames;
        *frames = (*frames + 1).min(self.counted + SleepParams::LAG);
    }

    /// Which of a watch's frames the next one is, for who has to be told before.
    #[cfg(feature = "gpu")]
    pub(crate) fn begin_step(&self, i: usize, sleeps: bool) -> Step {
        if !sleeps {
            return Step::Other;
        }
        let counted = self.counted;
        match self.watches[i].frames {
            // A single frame that counts is both the first and the last one.
            0 => Step::First {
                is_last: counted == 1,
            },
            n if n + 1 == counted => Step::LastThatCounts,
            n if n + 1 == counted + SleepParams::LAG => Step::Last,
            _ => Step::Other,
        }
    }

    /// Notes whether a body was at rest in the frames that count.
    pub(crate) fn judge(&mut self, i: usize, is_quiet: bool) {
        self.watches[i].is_quiet = is_quiet;
    }

    /// Whether a body is to sleep from now on. If not, and it is time to decide, it is watched anew.
    pub(crate) fn is_due(&mut self, i: usize) -> bool {
        let watch = &mut self.watches[i];
        let is_over = watch.frames >= self.counted + SleepParams::LAG;
        is_over && std::mem::take(watch).is_quiet
    }

    /// Notes the box of a body that sleeps.
    pub(crate) fn know(&mut self, i: usize, bounds: Aabb) {
        self.boxes[i] = bounds;
    }

    /// Lets a body sleep in its box, none if nobody knows it.
    pub(crate) fn fall_asleep(&mut self, i: usize, bounds: Option<Aabb>) {
        self.asleep[i] = true;
        self.boxes[i] = bounds.unwrap_or(EVERYWHERE);
        self.sleepers += 1;
    }
}
