//! The solver follows an edit and its undo.

use incise_mesh::{HalfEdge, Surface, TopologyDelta, TriangleId, Undo, VertexId, VertexOrigin};
use incise_pbd_gpu::{Density, Material, PatchParams, Solver, SolverParams};
use incise_test_support::edits::{
    Replacement, flip_replacement, removal_replacement, replace_with_undo, split_replacement,
    vertex_replacement,
};
use incise_test_support::surfaces::sphere;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Sums of masses that are stored in f32 [relative].
const ROUNDING: f64 = 1e-5;

fn replacement(surface: &Surface, kind: u8, at: u16, t: f32) -> Option<Replacement> {
    let half_edges: Vec<HalfEdge> = surface
        .topology()
        .triangles()
        .flat_map(TriangleId::half_edges)
        .collect();
    let h = half_edges[usize::from(at) % half_edges.len()];
    let v = surface.topology().origin(h);
    match kind {
        0 => flip_replacement(surface, h),
        1 => split_replacement(surface, h, t),
        2 => vertex_replacement(surface, v),
        _ => removal_replacement(surface, v),
    }
}

fn spin(surface: &Surface, solver: &mut Solver) {
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        solver.set_velocity(v, [y - z, 0.5 - x, x + z]).unwrap();
    }
}

fn solver(surface: &mut Surface, density: Density, patched: bool) -> Solver {
    let material = Material {
        density,
        ..Material::default()
    };
    if patched {
        let params = PatchParams {
            vertices: 24,
            room: 8,
        };
        Solver::with_patches(surface, &material, Some(&params)).unwrap()
    } else {
        Solver::new(surface, &material).unwrap()
    }
}

/// Applies `delta` and asserts valid constraints and the same mass and momentum.
fn follow(solver: &mut Solver, surface: &mut Surface, delta: &TopologyDelta) {
    let (mass, momentum) = (solver.total_mass(), solver.momentum());
    solver.apply_delta(surface, delta).unwrap();
    solver.validate(surface).unwrap();
    let lost = (solver.total_mass() - mass).abs();
    assert!(lost <= ROUNDING * mass, "mass {mass} changed by {lost}");
    for (was, is) in momentum.into_iter().zip(solver.momentum()) {
        let scale = mass.max(was.abs());
        assert!(
            (is - was).abs() <= ROUNDING * scale,
            "momentum {was} became {is}"
        );
    }
    for v in surface.topology().vertices() {
        let inverse = surface.positions()[v.index()][3];
        assert!(inverse > 0.0 && inverse.is_finite(), "{v} has no mass");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn constraints_match_after_edits_and_undos(
        edits in prop::collection::vec((0_u8..4, any::<u16>(), 0.1_f32..0.9), 1..12),
        density in prop_oneof![Just(Density::Area(2.0)), Just(Density::Volume(3.0))],
        patched: bool,
        steps in 0..3_usize,
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = solver(&mut surface, density, patched);
        spin(&surface, &mut solver);
        let start = surface.clone();
        let params = SolverParams::paper();
        let mut undos: Vec<Undo> = Vec::new();
        for (kind, at, t) in edits {
            let Some((remove, addition)) = replacement(&surface, kind, at, t) else {
                continue;
            };
            let (delta, undo) = replace_with_undo(&mut surface, &remove, &addition);
            follow(&mut solver, &mut surface, &delta);
            undos.push(undo);
            for _ in 0..steps {
                solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            }
        }
        while let Some(undo) = undos.pop() {
            let back = undo.revert(&mut surface).unwrap();
            follow(&mut solver, &mut surface, &back);
            for _ in 0..steps {
                solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            }
        }
        prop_assert_eq!(surface.topology(), start.topology());
        if steps == 0 {
            for v in start.topology().vertices() {
                let [was, is] = [&start, &surface].map(|s| s.positions()[v.index()]);
                prop_assert_eq!(was[..3].to_vec(), is[..3].to_vec(), "{} did not move", v);
            }
        }
    }
}

/// Everything that a vertex slot has, to the bit.
fn bits(surface: &Surface, solver: &Solver) -> Vec<[u32; 9]> {
    let slots = (surface.positions().iter()).zip(solver.masses().iter().zip(solver.velocities()));
    slots
        .map(|(&[x, y, z, w], (&mass, &[u, v, n, o]))| {
            [x, y, z, w, mass, u, v, n, o].map(f32::to_bits)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn an_undo_before_motion_restores_every_bit_and_redo_repeats_it(
        edits in prop::collection::vec((1_u8..3, any::<u16>(), 0.1_f32..0.9), 1..8),
        patched: bool,
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = solver(&mut surface, Density::Area(2.0), patched);
        spin(&surface, &mut solver);
        let params = SolverParams::paper();
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        solver.pin(&mut surface, VertexId(7)).unwrap();
        let mut states = vec![bits(&surface, &solver)];
        for turn in 0..2 {
            let mut undos: Vec<Undo> = Vec::new();
            for (i, &(kind, at, t)) in edits.iter().enumerate() {
                let (remove, addition) = replacement(&surface, kind, at, t).unwrap();
                let (delta, undo) = replace_with_undo(&mut surface, &remove, &addition);
                solver.apply_delta(&mut surface, &delta).unwrap();
                undos.push(undo);
                if turn == 0 {
                    states.push(bits(&surface, &solver));
                }
                prop_assert!(bits(&surface, &solver) == states[i + 1], "edit {}", i);
            }
            while let Some(undo) = undos.pop() {
                let back = undo.revert(&mut surface).unwrap();
                solver.apply_delta(&mut surface, &back).unwrap();
                solver.validate(&surface).unwrap();
                let is_same = bits(&surface, &solver) == states[undos.len()];
                prop_assert!(is_same, "undo {}", undos.len());
            }
        }
    }
}

/// Takes a vertex away and puts another in its place, or none.
fn without(surface: &mut Surface, v: VertexId, new: bool) -> (TopologyDelta, Undo) {
    let plan = if new {
        vertex_replacement(surface, v)
    } else {
        removal_replacement(surface, v)
    };
    let (remove, addition) = plan.unwrap();
    replace_with_undo(surface, &remove, &addition)
}

#[test]
fn a_restored_vertex_moves_like_its_replacement() {
    for new in [true, false] {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = solver(&mut surface, Density::Area(2.0), false);
        let v = VertexId(20);
        let velocity = [0.25, -1.5, 3.0];
        for v in surface.topology().vertices() {
            solver.set_velocity(v, velocity).unwrap();
        }
        let was = surface.positions()[v.index()];
        let (delta, undo) = without(&mut surface, v, new);
        assert_eq!(delta.vertices_removed, [v]);
        follow(&mut solver, &mut surface, &delta);
        let shift = [0.5_f32, -1.0, 0.125];
        for w in surface.topology().vertices().collect::<Vec<_>>() {
            for (k, by) in shift.iter().enumerate() {
                surface.positions_mut()[w.index()][k] += by;
            }
        }
        let back = undo.revert(&mut surface).unwrap();
        let [restored] = back.vertices_added[..] else {
            panic!("one vertex came back");
        };
        assert!(matches!(restored.origin, VertexOrigin::Restored { .. }));
        for k in 0..3 {
            let moved = surface.positions()[v.index()][k] - was[k];
            assert!((moved - shift[k]).abs() < 1e-6, "{v} moved by {moved}");
        }
        follow(&mut solver, &mut surface, &back);
        for w in surface.topology().vertices() {
            for (now, was) in solver.velocity(w).into_iter().zip(velocity) {
                assert!((now - was).abs() < 1e-5, "{w} has a velocity of {now}");
            }
        }
    }
}

/// State of the vertex in a slot, with a number that identifies the vertex.
#[derive(Debug, Clone, Copy)]
struct Known {
    slot: VertexId,
    held_at: Option<[f32; 3]>,
}

/// All vertices that there ever were, and which of them is in each slot.
#[derive(Debug, Default)]
struct Census {
    all: Vec<Known>,
    there: BTreeMap<VertexId, usize>,
}

impl Census {
    fn enter(&mut self, slot: VertexId) {
        self.there.insert(slot, self.all.len());
        let held_at = None;
        self.all.push(Known { slot, held_at });
    }

    /// Pins as they should be.
    fn pins(&self) -> Vec<(VertexId, [f32; 3])> {
        let there = self.there.values().map(|&i| self.all[i]);
        there
            .filter_map(|known| Some((known.slot, known.held_at?)))
            .collect()
    }
}

fn pins_of(solver: &Solver) -> Vec<(VertexId, [f32; 3])> {
    let pins = solver.pins().iter();
    pins.map(|pin| (pin.vertex, pin.target)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Vertices go and come back, slots are used again by others, some of them pinned: every vertex
    /// has the pin that it had.
    #[test]
    fn pins_return_with_their_vertices(
        steps in prop::collection::vec((0_u8..7, any::<u16>(), any::<u16>()), 1..40),
        patched: bool,
        moves: bool,
    ) {
        let mut surface = sphere(1, [0.0, 2.0, 0.0]);
        let mut solver = solver(&mut surface, Density::Area(2.0), patched);
        let params = SolverParams::paper();
        let mut census = Census::default();
        surface.topology().vertices().for_each(|v| census.enter(v));
        let mut undos: Vec<(Undo, TopologyDelta, BTreeMap<VertexId, usize>)> = Vec::new();
        for (kind, at, pin) in steps {
            if kind < 4 {
                let plan = replacement(&surface, kind, at, 0.5);
                let Some((remove, addition)) = plan else { continue };
                let before = census.there.clone();
                let (delta, undo) = replace_with_undo(&mut surface, &remove, &addition);
                for v in &delta.vertices_removed {
                    census.there.remove(v);
                }
                delta.vertices_added.iter().for_each(|added| census.enter(added.vertex));
                solver.apply_delta(&mut surface, &delta).unwrap();
                undos.push((undo, delta, before));
            } else if kind < 6 && let Some((undo, delta, before)) = undos.pop() {
                let back = undo.revert(&mut surface).unwrap();
                solver.apply_delta(&mut surface, &back).unwrap();
                for added in &delta.vertices_added {
                    census.there.remove(&added.vertex);
                }
                for v in &delta.vertices_removed {
                    census.there.insert(*v, before[v]);
                }
            }
            solver.validate(&surface).unwrap();
            let slots: Vec<VertexId> = census.there.keys().copied().collect();
            let v = slots[usize::from(pin) % slots.len()];
            let known = &mut census.all[census.there[&v]];
            if known.held_at.take().is_some() {
                solver.unpin(&mut surface, v).unwrap();
            } else {
                solver.pin(&mut surface, v).unwrap();
                let [x, y, z, _] = surface.positions()[v.index()];
                known.held_at = Some([x, y, z]);
            }
            prop_assert_eq!(pins_of(&solver), census.pins());
            if moves {
                solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            }
            for (v, target) in census.pins() {
                let [x, y, z, inverse] = surface.positions()[v.index()];
                prop_assert_eq!(inverse, 0.0, "{} is held", v);
                if moves {
                    let off = [x - target[0], y - target[1], z - target[2]];
                    prop_assert!(off.iter().all(|c| c.abs() < 1e-5), "{} is {:?} off", v, off);
                }
            }
        }
    }
}
