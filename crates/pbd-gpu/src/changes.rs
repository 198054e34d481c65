//! What was edited since a device backend last looked, so that it uploads that and no more.
//!
//! On a body that lives on a device the host's positions and velocities are as old as the last
//! read-back. So every list names only what the host itself has set since: what is not listed must not
//! be uploaded.

use crate::constraints::{ConstraintSet, Slot};
use crate::solver::Solver;
use incise_mesh::VertexId;

/// Edits since they were last taken. Lists are ascending and name everything once.
#[derive(Debug, Default)]
#[cfg_attr(
    not(test),
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
    pub(crate) fn note(&mut self, entry: T) {
        if !self.is_on {
            return;
        }
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
        not(test),
        allow(
            dead_code,
            reason = "asked for by backends that keep a copy of the body"
        )
    )]
    pub(crate) fn start_tracking(&mut self) {
        let VertexLogs {
            is_on,
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
    }

    /// Whether edits are noted. Not so in a new solver and in a copy of another.
    #[cfg_attr(
        not(test),
        allow(
            dead_code,
            reason = "asked for by backends that keep a copy of the body"
        )
    )]
    pub(crate) fn is_tracking(&self) -> bool {
        self.changes.is_on
    }

    /// Hands over what was edited since it was last asked for and whose memory `into` had. The first
    /// time everything has, and tracking starts.
    #[cfg_attr(
        not(test),
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
        into.lengths = take_slots(&mut self.stretch, &mut into.stretch);
        into.bending.clear();
        if let Some(bending) = &mut self.bending {
            into.lengths |= take_slots(bending, &mut into.bending);
        }
    }
}

/// Takes the slots of a set that still exist. Says whether constraints came or went.
fn take_slots<const N: usize>(set: &mut ConstraintSet<N>, into: &mut Vec<Slot>) -> bool {
    let any = set.log.take(into);
    into.retain(|slot| slot.index < set.batch(slot.color).len());
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{flip, renew, sphere, split};
    use crate::material::Material;
    use crate::plan::Pin;
    use incise_mesh::{HalfEdge, Surface, TriangleId};
    use proptest::prelude::*;

    /// Constraints by color, rest values as bits.
    type Batches<const N: usize> = Vec<Vec<([VertexId; N], u32)>>;

    /// What a device has of a body.
    #[derive(Debug, Default, PartialEq)]
    struct Mirror {
        positions: Vec<[f32; 4]>,
        velocities: Vec<[f32; 4]>,
        stretch: Batches<2>,
        bending: Batches<4>,
        pins: Vec<Pin>,
    }

    fn entry<const N: usize>(set: &ConstraintSet<N>, slot: Slot) -> ([VertexId; N], u32) {
        let (vertices, rest) = set.at(slot);
        (vertices, rest.to_bits())
    }

    /// Takes over the changed slots only; new places are filled with what cannot be right.
    fn update<const N: usize>(batches: &mut Batches<N>, set: &ConstraintSet<N>, slots: &[Slot]) {
        batches.resize(crate::MAX_COLORS + 1, Vec::new());
        for (color, batch) in set.numbered() {
            batches[color].resize(batch.len(), ([VertexId::NULL; N], 0));
        }
        for &slot in slots {
            batches[slot.color][slot.index] = entry(set, slot);
        }
    }

    fn all_slots<const N: usize>(set: &ConstraintSet<N>) -> Vec<Slot> {
        let slots = |(color, batch): (usize, &crate::Batch<N>)| {
            (0..batch.len()).map(move |index| Slot { color, index })
        };
        set.numbered().flat_map(slots).collect()
    }

    impl Mirror {
        fn whole(solver: &Solver, surface: &Surface) -> Self {
            let bending = solver.bending.as_ref().unwrap();
            let mut mirror = Self {
                positions: surface.positions.clone(),
                velocities: solver.velocities.clone(),
                pins: solver.pins.clone(),
                ..Self::default()
            };
            update(
                &mut mirror.stretch,
                &solver.stretch,
                &all_slots(&solver.stretch),
            );
            update(&mut mirror.bending, bending, &all_slots(bending));
            mirror
        }

        fn follow(&mut self, changes: &Changes, solver: &Solver, surface: &Surface) {
            if changes.everything {
                *self = Self::whole(solver, surface);
                return;
            }
            self.positions
                .resize(surface.positions.len(), [f32::NAN; 4]);
            self.velocities
                .resize(surface.positions.len(), [f32::NAN; 4]);
            for &v in &changes.moved {
                self.positions[v as usize] = surface.positions[v as usize];
            }
            for &v in &changes.masses {
                self.positions[v as usize][3] = surface.positions[v as usize][3];
            }
            for &v in &changes.velocities {
                self.velocities[v as usize] = solver.velocities[v as usize];
            }
            if changes.pins {
                self.pins.clone_from(&solver.pins);
            }
            if changes.lengths {
                let bending = solver.bending.as_ref().unwrap();
                update(&mut self.stretch, &solver.stretch, &changes.stretch);
                update(&mut self.bending, bending, &changes.bending);
            }
        }
    }

    /// One edit of any kind; `at` chooses where.
    fn edit(solver: &mut Solver, surface: &mut Surface, kind: u8, at: usize, t: f32) {
        let topology = surface.topology();
        let half_edges: Vec<HalfEdge> = topology
            .triangles()
            .flat_map(TriangleId::half_edges)
            .collect();
        let h = half_edges[at % half_edges.len()];
        let v = topology.origin(h);
        let delta = match kind {
            0 => flip(surface, h),
            1 => split(surface, h, t),
            2 => renew(surface, v),
            3 => {
                solver.set_velocity(v, [t, 1.0, -t]).unwrap();
                None
            }
            4 => {
                solver.pin(surface, v).unwrap();
                None
            }
            _ => {
                if let Some(pin) = solver.pins.get(at % 3).copied() {
                    if t < 0.5 {
                        solver.unpin(surface, pin.vertex).unwrap();
                    } else {
                        solver.set_pin_target(pin.vertex, [t; 3]).unwrap();
                    }
                }
                None
            }
        };
        if let Some(delta) = delta {
            solver.apply_delta(surface, &delta).unwrap();
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn following_the_changes_is_as_good_as_looking_at_everything(
            edits in prop::collection::vec((0_u8..6, any::<u16>(), 0.1_f32..0.9, 0_u8..4), 1..60),
        ) {
            let mut surface = sphere(2, [0.0, 2.0, 0.0]);
            let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
            let (mut changes, mut mirror) = (Changes::default(), Mirror::default());
            for (kind, at, t, look) in edits {
                if look == 0 {
                    let first = !solver.is_tracking();
                    solver.take_changes(&mut changes);
                    prop_assert_eq!(changes.everything, first);
                    for list in [&changes.moved, &changes.masses, &changes.velocities] {
                        prop_assert!(list.is_sorted_by(|a, b| a < b));
                    }
                    mirror.follow(&changes, &solver, &surface);
                    prop_assert!(mirror == Mirror::whole(&solver, &surface));
                }
                edit(&mut solver, &mut surface, kind, usize::from(at), t);
            }
        }
    }

    fn tracked() -> (Surface, Solver, Changes) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        let mut changes = Changes::default();
        solver.take_changes(&mut changes);
        assert!(changes.everything, "the first look is at everything");
        (surface, solver, changes)
    }

    #[test]
    fn positions_that_were_not_set_are_not_named() {
        let (mut surface, mut solver, mut changes) = tracked();
        let [a, b, c] = [3, 5, 7].map(VertexId);
        solver.pin(&mut surface, b).unwrap();
        solver.set_velocity(a, [1.0; 3]).unwrap();
        solver.pin(&mut surface, c).unwrap();
        solver.unpin(&mut surface, c).unwrap();
        solver.take_changes(&mut changes);
        assert!(!changes.everything && !changes.lengths && changes.pins);
        assert_eq!(changes.moved, [0; 0]);
        assert_eq!(changes.masses, [5, 7]);
        assert_eq!(changes.velocities, [3, 5, 7]);
        solver.take_changes(&mut changes);
        assert!(!changes.pins && changes.masses.is_empty() && changes.velocities.is_empty());
    }

    #[test]
    fn what_the_log_holds_does_not_grow_with_repetition() {
        let (surface, mut solver, mut changes) = tracked();
        for _ in 0..100 {
            for v in surface.topology().vertices() {
                solver.set_velocity(v, [1.0; 3]).unwrap();
            }
        }
        let count = surface.topology().vertex_count();
        assert!(solver.changes.velocities.entries.capacity() <= 4 * count);
        solver.take_changes(&mut changes);
        assert_eq!(changes.velocities.len(), count);
    }

    #[test]
    fn a_copy_is_followed_by_nobody() {
        let (mut surface, mut solver, mut changes) = tracked();
        let mut copy = solver.clone();
        assert!(!copy.is_tracking() && solver.is_tracking());
        copy.take_changes(&mut changes);
        assert!(changes.everything, "a copy is new to a device");
        solver
            .step(&mut surface, 1.0 / 60.0, &crate::SolverParams::default())
            .unwrap();
        solver.take_changes(&mut changes);
        assert!(changes.everything, "the CPU moved all vertices");
    }
}
