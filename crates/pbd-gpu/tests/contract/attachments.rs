//! Long range attachments: inextensible bodies stay attached to their pins under any load.

use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};
use incise_test_support::edits::{
    flip_replacement, removal_replacement, replace, split_replacement, vertex_replacement,
};
use incise_test_support::surfaces::sphere;
use proptest::prelude::*;
use std::collections::BTreeMap;

const DT: f32 = 1.0 / 60.0;

/// Squares of the ribbon.
const SQUARES: u32 = 10;

/// Returns a ribbon of 1 m by 0.1 m that hangs from its first two vertices.
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
fn a_load_of_a_million_weights_does_not_stretch_a_sheet() {
    for stretch in [Stiffness::Pbd(1.0), Stiffness::Compliance(0.0)] {
        for (iterations, substeps) in [(1, 1), (10, 1), (1, 16)] {
            let (mut surface, mut solver) = ribbon(stretch, 1e6);
            let params = SolverParams {
                iterations,
                ..SolverParams::default()
            }
            .with_substeps(DT, substeps);
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

/// Attachments do not change a converged state: rigid edges imply them.
#[test]
fn the_effect_vanishes_with_shorter_substeps() {
    let swung = |substeps, attachments| {
        let (mut surface, mut solver) = ribbon(Stiffness::Compliance(0.0), 1.0);
        let params = SolverParams {
            iterations: 20,
            gravity: [4.0, -9.81, 3.0],
            attachments,
            ..SolverParams::default()
        }
        .with_substeps(DT, substeps);
        for _ in 0..20 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        assert_eq!(solver.attachments().is_empty(), !attachments);
        surface
    };
    let start = ribbon(Stiffness::Compliance(0.0), 1.0).0;
    let apart = |a: &Surface, b: &Surface| {
        let all = a.topology().vertices();
        let far = |v| (a.position(v) - b.position(v)).norm();
        all.map(far).fold(0.0, f64::max)
    };
    let off = |substeps| {
        let [without, with] = [false, true].map(|attachments| swung(substeps, attachments));
        assert!(apart(&with, &start) > 0.1, "it swings");
        apart(&without, &with)
    };
    let few = off(1);
    let many = off(256);
    assert!(many < 0.01 * few, "{few} m and {many} m off");
}

#[test]
fn only_inextensible_pinned_bodies_have_attachments() {
    let count = |stretch, pinned: bool, attachments| {
        let (mut surface, mut solver) = ribbon(stretch, 1.0);
        if !pinned {
            for v in [0, 1].map(VertexId) {
                solver.unpin(&mut surface, v).unwrap();
            }
        }
        let params = SolverParams {
            attachments,
            ..SolverParams::default()
        };
        solver.step(&mut surface, DT, &params).unwrap();
        solver.attachments().len()
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

/// Returns the geodesic distance of every vertex from the nearest pin, by relaxation of all edges.
fn geodesic_distances(solver: &Solver) -> BTreeMap<VertexId, f64> {
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

    /// Every vertex connected to a pin has an attachment of geodesic length, after any edits and
    /// changes of pins.
    #[test]
    fn attachments_have_geodesic_lengths(
        edits in prop::collection::vec((0_u8..6, any::<u16>(), 0.1_f32..0.9), 1..16),
    ) {
        let mut surface = incise_test_support::surfaces::two_spheres(1);
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
                0 => flip_replacement(&surface, h),
                1 => split_replacement(&surface, h, t),
                2 => vertex_replacement(&surface, v),
                3 => removal_replacement(&surface, v),
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
            let mut ways = geodesic_distances(&solver);
            for pin in solver.pins() {
                ways.remove(&pin.vertex);
            }
            let found: BTreeMap<VertexId, f32> = (solver.attachments().iter())
                .map(|attachment| (attachment.vertex, attachment.length))
                .collect();
            prop_assert_eq!(found.len(), solver.attachments().len(), "one a vertex");
            prop_assert!(found.keys().eq(ways.keys()), "those that hang on pins");
            for (v, way) in ways {
                let length = f64::from(found[&v]);
                // Sums of the same numbers in another order.
                prop_assert!(length >= way * (1.0 - 1e-14), "{}: {} of {}", v, length, way);
                prop_assert!(length <= way * (1.0 + 2e-7), "{}: {} of {}", v, length, way);
            }
            for attachment in solver.attachments() {
                let is_pin = |pin: &incise_pbd_gpu::Pin| pin.vertex == attachment.anchor;
                prop_assert!(solver.pins().iter().any(is_pin), "{} is held", attachment.anchor);
            }
        }
    }
}

/// A sheet that has sagged exceeds the lengths of attachments when it becomes rigid.
#[test]
fn old_stretch_is_corrected_slowly() {
    let fastest = |attachments, (iterations, substeps)| {
        let (mut surface, mut solver) = ribbon(Stiffness::Compliance(0.02), 30.0);
        for p in surface.positions_mut() {
            p[1] *= 1.5;
        }
        let params = SolverParams {
            iterations,
            attachments,
            // The energy budget would hide what the attachments add.
            conserve: false,
            ..SolverParams::default()
        }
        .with_substeps(DT, substeps);
        solver.step(&mut surface, DT, &params).unwrap();
        solver.set_stretch(Stiffness::Compliance(0.0)).unwrap();
        let mut most: f64 = 0.0;
        for _ in 0..120 {
            solver.step(&mut surface, DT, &params).unwrap();
            most = most.max(solver.kinetic_energy());
        }
        assert_eq!(solver.attachments().is_empty(), !attachments);
        (most, solver.stretch_error(&surface))
    };
    for way in [(1, 16), (10, 1)] {
        let (without, _) = fastest(false, way);
        let (with, strain) = fastest(true, way);
        assert!(
            with < 1.1 * without,
            "{with} J, {without} J without attachments, {way:?}"
        );
        assert!(strain < 0.05, "{strain} is left, {way:?}");
    }
}

#[test]
fn released_vertices_fall() {
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
    assert!(solver.attachments().is_empty());
    let fallen = held - surface.bounds().max[1];
    assert!((fallen - 1.226).abs() < 0.15, "{fallen} m in half a second");
}
