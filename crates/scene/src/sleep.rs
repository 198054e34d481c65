//! Bodies at rest, which are left alone until something comes to them.
//!
//! For a body that sleeps time stands still: it keeps its positions and its velocities, which are next to nothing, and
//! woken it goes on with the bits that it would have had. So all that sleeping can lose is what would have moved
//! by itself, slower than [`SleepParams::motion`].

use crate::params::SceneParams;
use incise_mesh::Aabb;
use incise_pbd_gpu::SolverParams;

/// When a body falls asleep. A body that was cut is one body still: it sleeps when all of its pieces are at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SleepParams {
    /// How far a vertex may move along an axis in a frame, as a part of the mean length of the body's edges at rest. Taken
    /// from its fastest substep, without what rounding makes: two units in the last place of the body's largest
    /// coordinate. A body that moves no faster all the time is stopped by its sleep, so this is to be less than anybody
    /// sees.
    pub motion: f32,
    /// For how many frames in a row no vertex may have moved farther, at least 1. A body that is thrown up is slow for
    /// a frame or two at the top of its flight, so a few are not enough.
    ///
    /// It is looked at once in so many frames and [`SleepParams::LAG`] more, so a body sleeps after twice as many at the
    /// latest.
    pub frames: u32,
}

impl SleepParams {
    /// Frames between the last one that counts and the one after which a body sleeps. That is how far a device may be
    /// behind: what it says is there by then, nobody waits for it, and bodies sleep at the same frame wherever they live.
    pub const LAG: u32 = 3;
}

impl Default for SleepParams {
    /// At 60 frames a second less than a hundredth of an edge a second, and half a second of it: a body that turns
    /// back at the top of its flight is as slow for a frame, a pendulum for a few. Bodies that are damped come to
    /// rest far below: what is left of their motion is rounding.
    fn default() -> Self {
        Self {
            motion: 1e-4,
            frames: 30,
        }
    }
}

impl SleepParams {
    /// The most that a vertex of a body at rest moves along an axis in a substep \[m\], for edges of a mean length and
    /// a box \[m\].
    pub(crate) fn limit(&self, edge: f64, bounds: &Aabb, substeps: u32) -> f64 {
        let corners = bounds.min.into_iter().chain(bounds.max);
        let largest = corners.map(f32::abs).fold(0.0, f32::max);
        let rounding = 2.0 * f64::from(f32::EPSILON) * f64::from(largest);
        f64::from(self.motion) * edge / f64::from(substeps) + rounding
    }
}

/// Under what bodies fell asleep: anything else may set them in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Terms {
    dt: f32,
    solver: SolverParams,
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
        let terms = Some(Terms {
            dt: params.dt,
            solver: params.solver,
            sleep: params.sleep,
        });
        if self.terms != terms {
            self.terms = terms;
            self.wake_all();
        }
    }

    /// Notes that a body that is awake was stepped, and how far a vertex moved at most in a substep \[m\]. After the last
    /// frame that counts, how far it did in all of them: [`Sleep::judge`] is to be called.
    pub(crate) fn note(&mut self, i: usize, farthest: f32, params: &SleepParams) -> Option<f32> {
        self.count(i, params);
        let watch = &mut self.watches[i];
        if watch.frames <= counted(params) {
            watch.farthest = watch.farthest.max(farthest);
        }
        (watch.frames == counted(params)).then_some(watch.farthest)
    }

    /// Notes that a body that is awake was stepped.
    pub(crate) fn count(&mut self, i: usize, params: &SleepParams) {
        let frames = &mut self.watches[i].frames;
        *frames = (*frames + 1).min(counted(params) + SleepParams::LAG);
    }

    /// Which of a watch's frames the next one is, for who has to be told before.
    #[cfg(feature = "gpu")]
    pub(crate) fn begin_step(&self, i: usize, params: Option<&SleepParams>) -> Step {
        let Some(params) = params else {
            return Step::Other;
        };
        let counted = counted(params);
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
    pub(crate) fn is_due(&mut self, i: usize, params: &SleepParams) -> bool {
        let watch = &mut self.watches[i];
        let is_over = watch.frames >= counted(params) + SleepParams::LAG;
        is_over && std::mem::take(watch).is_quiet
    }

    /// Notes the box of a body, if it sleeps and nobody knew it.
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

/// The frames of a watch that count.
fn counted(params: &SleepParams) -> u32 {
    params.frames.clamp(1, u32::MAX - SleepParams::LAG)
}
