//! What was edited since a device backend last looked, so that it uploads that and no more.
//!
//! On a body that lives on a device the host's positions and velocities are as old as the last
//! read-back. So every list names only what the host itself has set since: what is not listed must not
//! be uploaded.

#[cfg(test)]
mod tests;

use crate::coloring::LAYERS;
use crate::constraints::{ConstraintSet, Slot};
use crate::patches::Patches;
use crate::solver::Solver;
use incise_mesh::VertexId;

/// Edits since they were last taken. Lists are ascending and name everything once.
#[derive(Debug, Default)]
#[cfg_attr(
    not(any(test, feature = "gpu")),
    allow(dead_code, reason = "read by backends that keep a copy of the body")
)]
pub(crate) struct Changes {
    /// The lists do not tell: all arrays have to be taken over, positions and velocities too.
    pub(crate) everything: bool,
    /// Vertices whose position and inverse mass were set, those that came or went among them.
    pub(crate) moved: Vec<u32>,
    /// Vertices whose inverse mass was set; their positions were not.
    pub(crate) masses: Vec<u32>,
    /// Vertices whose velocity was set.
    pub(crate) velocities: Vec<u32>,
    /// Places at which another stretch constraint stands.
    pub(crate) stretch: Vec<Slot>,
    /// Places at which another bending constraint stands.
    pub(crate) bending: Vec<Slot>,
    /// Places at which another strut stands.
    pub(crate) struts: Vec<Slot>,
    /// Patches of every patching that got or lost a vertex or a constraint.
    pub(crate) patches: [Vec<u32>; LAYERS - 1],
    /// Whether batches may have become longer or shorter.
    pub(crate) lengths: bool,
    /// Whether pins came, went or have other targets.
    pub(crate) pins: bool,
}

/// What was noted, in the order in which it was, doubly if it was so. Notes nothing until somebody
/// follows the body.
#[derive(Debug)]
pub(crate) struct Log<T> {
    is_on: bool,
    entries: Vec<T>,
}

impl<T> Default for Log<T> {
    fn default() -> Self {
        Self {
            is_on: false,
            entries: Vec::new(),
        }
    }
}

impl<T> Clone for Log<T> {
    /// Nobody follows a copy.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T: Ord + Copy> Log<T> {
    /// Notes an entry. What is noted twice is sorted out before the log grows, so it never has more
    /// than four times the room that its different entries need.
    #[inline]
    pub(crate) fn note(&mut self, entry: T) {
        if self.is_on {
            self.push(entry);
        }
    }

    fn push(&mut self, entry: T) {
        if self.entries.len() == self.entries.capacity() {
            self.sort_out();
            self.entries.reserve(self.entries.len().max(8));
        }
        self.entries.push(entry);
    }

    fn sort_out(&mut self) {
        self.entries.sort_unstable();
        self.entries.dedup();
    }

    /// Forgets all and notes from now on.
    fn start(&mut self) {
        self.is_on = true;
        self.entries.clear();
    }

    /// Hands the entries over, ascending, and takes the memory of `into` for the next ones. Says
    /// whether there were any.
    fn take(&mut self, into: &mut Vec<T>) -> bool {
        self.sort_out();
        into.clear();
        std::mem::swap(&mut self.entries, into);
        !into.is_empty()
    }
}

/// What a solver notes of its vertices and pins; constraint sets note their own.
#[derive(Debug, Default)]
pub(crate) struct VertexLogs {
    is_on: bool,
    /// Who takes the notes; 0 is nobody.
    #[cfg(feature = "gpu")]
    follower: u64,
    everything: bool,
    pins: bool,
    moved: Log<u32>,
    masses: Log<u32>,
    velocities: Log<u32>,
}

impl Clone for VertexLogs {
    /// Nobody follows a copy.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl VertexLogs {
    /// A vertex came, went or was set in all that it has.
    pub(crate) fn vertex(&mut self, v: VertexId) {
        self.moved.note(v.0);
        self.velocities.note(v.0);
    }

    /// An inverse mass was set.
    pub(crate) fn mass(&mut self, v: VertexId) {
        self.masses.note(v.0);
    }

    /// A velocity was set.
    pub(crate) fn velocity(&mut self, v: VertexId) {
        self.velocities.note(v.0);
    }

    /// Pins came, went or got targets.
    pub(crate) fn pins(&mut self) {
        self.pins = true;
    }

    /// Positions and velocities changed in a way that nobody noted.
    pub(crate) fn everything(&mut self) {
        self.everything = true;
    }
}

impl Solver {
    /// Says that positions were changed by hand. A backend that keeps the body on a device takes all of
    /// it over anew before the next frame; nobody else cares. Edits by the solver's own functions need
    /// no such word.
    pub fn mark_all_changed(&mut self) {
        self.changes.everything();
    }

    /// Notes edits from now on.
    #[cfg_attr(
        not(any(test, feature = "gpu")),
        allow(
            dead_code,
            reason = "asked for by backends that keep a copy of the body"
        )
    )]
    pub(crate) fn start_tracking(&mut self) {
        let VertexLogs {
            is_on,
            #[cfg(feature = "gpu")]
                follower: _,
            everything,
            pins,
            moved,
            masses,
            velocities,
        } = &mut self.changes;
        (*is_on, *everything, *pins) = (true, true, true);
        for log in [moved, masses, velocities] {
            log.start();
        }
        self.stretch.log.start();
        if let Some(bending) = &mut self.bending {
            bending.log.start();
        }
        if let Some(struts) = &mut self.struts {
            struts.log.start();
        }
        for log in self.patches.iter_mut().flat_map(Patches::logs) {
            log.start();
        }
    }

    /// Whether edits are noted. Not so in a new solver and in a copy of another.
    #[cfg_attr(
        not(any(test, feature = "gpu")),
        allow(
            dead_code,
            reason = "asked for by backends that keep a copy of the body"
        )
    )]
    pub(crate) fn is_tracking(&self) -> bool {
        self.changes.is_on
    }

    /// Whether the notes are for `follower`. A copy of a solver has none.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_followed_by(&self, follower: u64) -> bool {
        self.changes.follower == follower
    }

    /// Has `follower`, who is not 0, get the notes from now on, everything to begin with.
    #[cfg(feature = "gpu")]
    pub(crate) fn follow(&mut self, follower: u64) {
        self.changes.follower = follower;
        self.mark_all_changed();
    }

    /// Whether nothing was edited since it was last asked for.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_unchanged(&self) -> bool {
        let logs = &self.changes;
        let small = logs.masses.entries.is_empty() && logs.velocities.entries.is_empty();
        small && !logs.pins && !self.changes_concern_surface()
    }

    /// Whether positions or constraints were edited since it was last asked for.
    #[cfg(feature = "gpu")]
    pub(crate) fn changes_concern_surface(&self) -> bool {
        let logs = &self.changes;
        let edges = [Some(&self.stretch), self.struts.as_ref()];
        let constraints = edges
            .into_iter()
            .flatten()
            .any(|set| !set.log.entries.is_empty())
            || self
                .bending
                .as_ref()
                .is_some_and(|set| !set.log.entries.is_empty());
        !logs.is_on || logs.everything || !logs.moved.entries.is_empty() || constraints
    }

    /// The velocities that were set since it was last asked for, by vertex [m/s].
    #[cfg(feature = "gpu")]
    pub(crate) fn velocities_set(&self) -> Vec<(usize, [f32; 4])> {
        let set = self.changes.velocities.entries.iter();
        set.filter_map(|&v| Some((v as usize, *self.velocities.get(v as usize)?)))
            .collect()
    }

    /// Hands over what was edited since it was last asked for and whose memory `into` had. The first
    /// time everything has, and tracking starts.
    #[cfg_attr(
        not(any(test, feature = "gpu")),
        allow(
            dead_code,
            reason = "asked for by backends that keep a copy of the body"
        )
    )]
    pub(crate) fn take_changes(&mut self, into: &mut Changes) {
        if !self.is_tracking() {
            self.start_tracking();
        }
        let logs = &mut self.changes;
        into.everything = std::mem::take(&mut logs.everything);
        into.pins = std::mem::take(&mut logs.pins);
        logs.moved.take(&mut into.moved);
        logs.masses.take(&mut into.masses);
        logs.velocities.take(&mut into.velocities);
        // What was noted of vertices whose slots an undo gave up is of no use to anybody.
        for list in [&mut into.moved, &mut into.masses, &mut into.velocities] {
            list.truncate(list.partition_point(|&v| (v as usize) < self.mass.len()));
        }
        into.lengths = take_slots(&mut self.stretch, &mut into.stretch);
        into.bending.clear();
        if let Some(bending) = &mut self.bending {
            into.lengths |= take_slots(bending, &mut into.bending);
        }
        into.struts.clear();
        if let Some(struts) = &mut self.struts {
            into.lengths |= take_slots(struts, &mut into.struts);
        }
        into.patches.iter_mut().for_each(Vec::clear);
        let logs = self.patches.iter_mut().flat_map(Patches::logs);
        for (log, into) in logs.zip(&mut into.patches) {
            log.take(into);
        }
    }
}

/// Takes the slots of a set that still exist. Says whether constraints came or went.
fn take_slots<const N: usize>(set: &mut ConstraintSet<N>, into: &mut Vec<Slot>) -> bool {
    let any = set.log.take(into);
    into.retain(|slot| slot.index < set.batch(slot.color).len());
    any
}
