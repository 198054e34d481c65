//! Tests that a copy of a body that is updated by the change log equals the body.

use super::*;
use crate::constraints::batches::{ConstraintSet, OVERFLOW, Slot};
use crate::material::Material;
use crate::particles::Pin;
use crate::patches::PatchParams;
use crate::solver::Solver;
use incise_mesh::{HalfEdge, Surface, TriangleId, Undo};
use incise_test_support::edits::{
    flip, replace_vertex, replace_with_undo, split, split_replacement, vertex_replacement,
};
use incise_test_support::surfaces::sphere;
use proptest::prelude::*;

/// Constraints by color, rest values as bits.
type Batches<const N: usize> = Vec<Vec<([VertexId; N], u32)>>;

/// A GPU copy of a body.
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

/// Copies the changed slots only; new slots start with invalid constraints.
fn update<const N: usize>(batches: &mut Batches<N>, set: &ConstraintSet<N>, slots: &[Slot]) {
    batches.resize(OVERFLOW + 1, Vec::new());
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
        let bending = solver.bending().unwrap();
        let mut mirror = Self {
            positions: surface.positions().to_vec(),
            velocities: solver.velocities().to_vec(),
            pins: solver.pins().to_vec(),
            ..Self::default()
        };
        update(
            &mut mirror.stretch,
            solver.stretch(),
            &all_slots(solver.stretch()),
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
            .resize(surface.positions().len(), [f32::NAN; 4]);
        self.velocities
            .resize(surface.positions().len(), [f32::NAN; 4]);
        for &v in &changes.vertices {
            self.positions[v as usize] = surface.positions()[v as usize];
        }
        for &v in &changes.masses {
            self.positions[v as usize][3] = surface.positions()[v as usize][3];
        }
        for &v in &changes.velocities {
            self.velocities[v as usize] = solver.velocities()[v as usize];
        }
        if changes.pins {
            self.pins = solver.pins().to_vec();
        }
        if changes.lengths {
            let bending = solver.bending().unwrap();
            update(&mut self.stretch, solver.stretch(), &changes.stretch);
            update(&mut self.bending, bending, &changes.bending);
        }
    }
}

/// Applies one edit of any kind at a location chosen by `at`.
fn edit(
    solver: &mut Solver,
    surface: &mut Surface,
    undos: &mut Vec<Undo>,
    kind: u8,
    at: usize,
    t: f32,
) {
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
        2 => replace_vertex(surface, v),
        3 => {
            solver.set_velocity(v, [t, 1.0, -t]).unwrap();
            None
        }
        4 => {
            let plan = if t < 0.5 {
                split_replacement(surface, h, t)
            } else {
                vertex_replacement(surface, v)
            };
            plan.map(|(remove, addition)| {
                let (delta, undo) = replace_with_undo(surface, &remove, &addition);
                undos.push(undo);
                delta
            })
        }
        // Refused after another edit.
        5 | 6 => (undos.pop()).and_then(|undo| undo.revert(surface).ok()),
        7 => {
            solver.pin(surface, v).unwrap();
            None
        }
        _ => {
            if let Some(pin) = solver.pins().get(at % 3).copied() {
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
    fn the_updated_copy_equals_the_body(
        edits in prop::collection::vec((0_u8..9, any::<u16>(), 0.1_f32..0.9, 0_u8..4), 1..60),
        in_patches in any::<bool>(),
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let material = Material::default();
        let patches = in_patches.then_some(PatchParams { vertices: 16, room: 3 });
        let mut solver =
            Solver::with_patches(&mut surface, &material, patches.as_ref()).unwrap();
        let (mut changes, mut mirror) = (Changes::default(), Mirror::default());
        let mut undos = Vec::new();
        for (kind, at, t, look) in edits {
            if look == 0 {
                let first = !solver.is_tracking();
                solver.take_changes(&mut changes);
                prop_assert_eq!(changes.everything, first);
                for list in [&changes.vertices, &changes.masses, &changes.velocities] {
                    prop_assert!(list.is_sorted_by(|a, b| a < b));
                }
                mirror.follow(&changes, &solver, &surface);
                prop_assert!(mirror == Mirror::whole(&solver, &surface));
            }
            edit(&mut solver, &mut surface, &mut undos, kind, usize::from(at), t);
        }
    }
}

fn tracked() -> (Surface, Solver, Changes) {
    let mut surface = sphere(2, [0.0, 2.0, 0.0]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let mut changes = Changes::default();
    solver.take_changes(&mut changes);
    assert!(changes.everything, "the first call lists everything");
    (surface, solver, changes)
}

#[test]
fn positions_that_were_not_set_are_not_listed() {
    let (mut surface, mut solver, mut changes) = tracked();
    let [a, b, c] = [3, 5, 7].map(VertexId);
    solver.pin(&mut surface, b).unwrap();
    solver.set_velocity(a, [1.0; 3]).unwrap();
    solver.pin(&mut surface, c).unwrap();
    solver.unpin(&mut surface, c).unwrap();
    solver.take_changes(&mut changes);
    assert!(!changes.everything && !changes.lengths && changes.pins);
    assert_eq!(changes.vertices, [0; 0]);
    assert_eq!(changes.masses, [5, 7]);
    assert_eq!(changes.velocities, [3, 5, 7]);
    solver.take_changes(&mut changes);
    assert!(!changes.pins && changes.masses.is_empty() && changes.velocities.is_empty());
}

#[test]
fn the_log_does_not_grow_with_duplicates() {
    let (surface, mut solver, mut changes) = tracked();
    for _ in 0..100 {
        for v in surface.topology().vertices() {
            solver.set_velocity(v, [1.0; 3]).unwrap();
        }
    }
    let count = surface.topology().vertex_count();
    assert!(solver.logged_velocity_capacity() <= 4 * count);
    solver.take_changes(&mut changes);
    assert_eq!(changes.velocities.len(), count);
}

#[test]
fn a_clone_has_no_log() {
    let (mut surface, mut solver, mut changes) = tracked();
    let mut copy = solver.clone();
    assert!(!copy.is_tracking() && solver.is_tracking());
    copy.take_changes(&mut changes);
    assert!(changes.everything, "a clone is uploaded whole");
    solver
        .step(&mut surface, 1.0 / 60.0, &crate::SolverParams::paper())
        .unwrap();
    solver.take_changes(&mut changes);
    assert!(changes.everything, "the CPU moved all vertices");
}
