//! What cannot stretch does not come loose from where it is held, however few the iterations and heavy the load.

mod common;

use common::{closed, divided, flipped, renewed, replace, sphere};
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};
use proptest::prelude::*;
use std::collections::BTreeMap;

const DT: f32 = 1.0 / 60.0;

/// Squares of the ribbon.
const SQUARES: u32 = 10;

/// A ribbon of one meter by 0.1 that hangs from its first two vertices.
fn ribbon(stretch: Stiffness, load: f32) -> (Surface, Solver) {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for row in 0..=SQUARES {
        let y = -0.1 * row as f32;
        points.extend([[0.0, y, 0.0], [0.1, y, 0.0]]);
    }
    for row in 0..SQUARES {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * row + k);
        faces.extend([[a, c, b], [b, c, d]]);
    }
    let mut surface = Surface::from_triangles(&points, &faces).unwrap();
    let material = Material {
        stretch,
        bending: None,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in [0, 1].map(VertexId) {
        solver.pin(&mut surface, v).unwrap();
    }
    let inside = solver.masses()[SQUARES as usize];
    for v in [2 * SQUARES, 2 * SQUARES + 1].map(VertexId) {
        solver.set_mass(&mut surface, v, inside * load).unwrap();
    }
    (surface, solver)
}

#[test]
fn a_million_times_its_weight_does_not_stretch_it() {
    for stretch in [Stiffness::Pbd(1.0), Stiffness::Compliance(0.0)] {
        for (iterations, substeps) in [(1, 1), (10, 1), (1, 16)] {
            let (mut surface, mut solver) = ribbon(stretch, 1e6);
            let params = SolverParams {
                iterations,
                substeps,
                ..SolverParams::default()
            };
            for _ in 0..600 {
                solver.step(&mut surface, DT, &params).unwrap();
            }
            let error = solver.stretch_error(&surface);
            assert!(
                error < 1e-3,
                "{stretch:?}, {iterations} x {substeps}: {error}"
            );
        }
    }
}

/// A tether asks for nothing that edges do not: the better these are met, the less of a difference it makes.
#[test]
fn short_substeps_lead_to_the_same() {
    let swung = |substeps, tethers| {
        let (mut surface, mut solver) = ribbon(Stiffness::Compliance(0.0), 1.0);
        let params = SolverParams {
            iterations: 20,
            substeps,
            gravity: [4.0, -9.81, 3.0],
            tethers,
            ..SolverParams::default()
        };
        for _ in 0..20 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        assert_eq!(solver.tethers().is_empty(), !tethers);
        surface
    };
    let start = ribbon(Stiffness::Compliance(0.0), 1.0).0;
    let apart = |a: &Surface, b: &Surface| {
        let all = a.topology().vertices();
        let far = |v| (a.position(v) - b.position(v)).norm();
        all.map(far).fold(0.0, f64::max)
    };
    let off = |substeps| {
        let [without, with] = [false, true].map(|tethers| swung(substeps, tethers));
        assert!(apart(&with, &start) > 0.1, "it swings");
        apart(&without, &with)
    };
    let few = off(1);
    let many = off(256);
    assert!(many < 0.01 * few, "{few} m and {many} m off");
}

#[test]
fn only_where_edges_do_not_stretch_and_something_is_pinned() {
    let count = |stretch, pinned: bool, tethers| {
        let (mut surface, mut solver) = ribbon(stretch, 1.0);
        if !pinned {
            for v in [0, 1].map(VertexId) {
                solver.unpin(&mut surface, v).unwrap();
            }
        }
        let params = SolverParams {
            tethers,
            ..SolverParams::default()
        };
        solver.step(&mut surface, DT, &params).unwrap();
        solver.tethers().len()
    };
    let rigid = Stiffness::Pbd(1.0);
    assert_eq!(count(rigid, true, true), 2 * SQUARES as usize);
    assert_eq!(
        count(Stiffness::Compliance(0.0), true, true),
        2 * SQUARES as usize
    );
    assert_eq!(count(rigid, true, false), 0, "they are not asked for");
    assert_eq!(count(rigid, false, true), 0, "nothing is pinned");
    assert_eq!(count(Stiffness::Pbd(0.99), true, true), 0, "it gives way");
    assert_eq!(
        count(Stiffness::Compliance(1e-9), true, true),
        0,
        "it gives way"
    );
}

/// The ways from every vertex to the pin nearest to it: relaxed along all edges until nothing changes.
fn ways(solver: &Solver) -> BTreeMap<VertexId, f64> {
    let mut ways: BTreeMap<VertexId, f64> = solver.pins().iter().map(|p| (p.vertex, 0.0)).collect();
    let stretch = solver.stretch();
    loop {
        let mut changed = false;
        for batch in stretch.batches().iter().chain([stretch.overflow()]) {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                for (from, to) in [(a, b), (b, a)] {
                    let Some(way) = ways.get(&from).map(|way| way + f64::from(rest)) else {
                        continue;
                    };
                    if ways.get(&to).is_none_or(|&known| way < known) {
                        ways.insert(to, way);
                        changed = true;
                    }
                }
            }
        }
        if !changed {
            return ways;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// One tether for every vertex that hangs on a pin, as long as the shortest way there, whatever edits and pins
    /// came before.
    #[test]
    fn tethers_are_the_shortest_ways(
        edits in prop::collection::vec((0_u8..6, any::<u16>(), 0.1_f32..0.9), 1..16),
    ) {
        let mut surface = common::two_spheres(1);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        for (kind, at, t) in edits {
            let half_edges: Vec<HalfEdge> = surface
                .topology()
                .triangles()
                .flat_map(TriangleId::half_edges)
                .collect();
            let h = half_edges[usize::from(at) % half_edges.len()];
            let v = surface.topology().origin(h);
            let edit = match kind {
                0 => flipped(&surface, h),
                1 => divided(&surface, h, t),
                2 => renewed(&surface, v),
                3 => closed(&surface, v),
                4 => {
                    solver.pin(&mut surface, v).unwrap();
                    None
                }
                _ => {
                    if let Some(pin) = solver.pins().first().copied() {
                        solver.unpin(&mut surface, pin.vertex).unwrap();
                    }
                    None
                }
            };
            if let Some((remove, addition)) = edit {
                let delta = replace(&mut surface, &remove, &addition);
                solver.apply_delta(&mut surface, &delta).unwrap();
            }
            solver.step(&mut surface, DT, &SolverParams::default()).unwrap();
            let mut ways = ways(&solver);
            for pin in solver.pins() {
                ways.remove(&pin.vertex);
            }
            let found: BTreeMap<VertexId, f32> = (solver.tethers().iter())
                .map(|tether| (tether.vertex, tether.length))
                .collect();
            prop_assert_eq!(found.len(), solver.tethers().len(), "one a vertex");
            prop_assert!(found.keys().eq(ways.keys()), "those that hang on pins");
            for (v, way) in ways {
                let length = f64::from(found[&v]);
                // Sums of the same numbers in another order.
                prop_assert!(length >= way * (1.0 - 1e-14), "{}: {} of {}", v, length, way);
                prop_assert!(length <= way * (1.0 + 2e-7), "{}: {} of {}", v, length, way);
            }
            for tether in solver.tethers() {
                let is_pin = |pin: &incise_pbd_gpu::Pin| pin.vertex == tether.anchor;
                prop_assert!(solver.pins().iter().any(is_pin), "{} is held", tether.anchor);
            }
        }
    }
}

/// A sheet that has sagged is far out of reach when it becomes rigid.
#[test]
fn what_stretched_before_is_not_thrown_back() {
    let fastest = |tethers, (iterations, substeps)| {
        let (mut surface, mut solver) = ribbon(Stiffness::Compliance(0.02), 30.0);
        for p in &mut surface.positions {
            p[1] *= 1.5;
        }
        let params = SolverParams {
            iterations,
            substeps,
            tethers,
            ..SolverParams::default()
        };
        solver.step(&mut surface, DT, &params).unwrap();
        solver.set_stretch(Stiffness::Compliance(0.0)).unwrap();
        let mut most: f64 = 0.0;
        for _ in 0..120 {
            solver.step(&mut surface, DT, &params).unwrap();
            most = most.max(solver.kinetic_energy());
        }
        assert_eq!(solver.tethers().is_empty(), !tethers);
        (most, solver.stretch_error(&surface))
    };
    for way in [(1, 16), (10, 1)] {
        let (without, _) = fastest(false, way);
        let (with, strain) = fastest(true, way);
        assert!(
            with < 1.1 * without,
            "{with} J, {without} J without tethers"
        );
        assert!(strain < 0.05, "{strain} is left, {way:?}");
    }
}

#[test]
fn what_is_let_go_falls() {
    let mut surface = sphere(2, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    solver.pin(&mut surface, VertexId(1)).unwrap();
    let params = SolverParams::default();
    for _ in 0..30 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    let held = surface.bounds().max[1];
    solver.unpin(&mut surface, VertexId(1)).unwrap();
    for _ in 0..30 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    assert!(solver.tethers().is_empty());
    let fallen = held - surface.bounds().max[1];
    assert!((fallen - 1.226).abs() < 0.15, "{fallen} m in half a second");
}
