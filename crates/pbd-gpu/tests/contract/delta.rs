//! Constraints, mass and momentum after topology edits.

use incise_mesh::{HalfEdge, Surface, TopologyDelta, TriangleId, VertexId};
use incise_models::double_cone;
use incise_pbd_gpu::{Collider, ConstraintError, Density, Material, Solver, SolverParams};
use incise_test_support::edits::{Addition, flip, replace, replace_vertex, split};
use incise_test_support::surfaces::{sphere, two_spheres};
use proptest::prelude::*;

fn assert_same_sums(solver: &Solver, before: (f64, [f64; 3])) {
    let (mass, momentum) = before;
    let scale = mass.max(1.0);
    assert!(
        (solver.total_mass() - mass).abs() < 1e-6 * scale,
        "mass {mass} became {}",
        solver.total_mass()
    );
    for (now, then) in solver.momentum().iter().zip(momentum) {
        assert!(
            (now - then).abs() < 1e-5 * scale,
            "momentum {momentum:?} became {:?}",
            solver.momentum()
        );
    }
}

fn edit(surface: &mut Surface, kind: u8, at: usize, t: f32) -> Option<TopologyDelta> {
    let half_edges: Vec<HalfEdge> = surface
        .topology()
        .triangles()
        .flat_map(TriangleId::half_edges)
        .collect();
    let h = half_edges[at % half_edges.len()];
    match kind {
        0 => flip(surface, h),
        1 => split(surface, h, t),
        _ => replace_vertex(surface, surface.topology().origin(h)),
    }
}

fn spin(surface: &Surface, solver: &mut Solver) {
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        solver.set_velocity(v, [y - z, 0.5 - x, x + z]).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn edited_constraints_equal_rebuilt_ones(
        edits in prop::collection::vec((0_u8..3, any::<u16>(), 0.1_f32..0.9), 1..40),
        density in prop_oneof![Just(Density::Area(2.0)), Just(Density::Volume(3.0))],
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let material = Material { density, ..Material::default() };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        spin(&surface, &mut solver);
        for (kind, at, t) in edits {
            let before = (solver.total_mass(), solver.momentum());
            if let Some(delta) = edit(&mut surface, kind, usize::from(at), t) {
                solver.apply_delta(&mut surface, &delta).unwrap();
                solver.validate(&surface).unwrap();
                assert_same_sums(&solver, before);
            }
        }
        for v in surface.topology().vertices() {
            prop_assert!(surface.positions()[v.index()][3] > 0.0, "{v} has no mass");
        }
        solver.step(&mut surface, 1.0 / 60.0, &SolverParams::paper()).unwrap();
    }

    #[test]
    fn removed_triangles_can_be_restored(
        picks in prop::collection::vec(any::<u16>(), 1..60),
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        spin(&surface, &mut solver);
        let before = (solver.total_mass(), solver.momentum());
        let count = surface.topology().triangle_slots();
        let mut picked: Vec<TriangleId> = picks
            .iter()
            .map(|&p| TriangleId::from_index(usize::from(p) % count))
            .collect();
        picked.sort_unstable();
        picked.dedup();
        // Vertices stay in use, so that the same corners can come back.
        picked.retain(|t| t.0 % 4 != 3);
        let corners: Vec<[VertexId; 3]> =
            picked.iter().map(|&t| surface.topology().triangle(t)).collect();
        let delta = replace(&mut surface, &picked, &Addition::default());
        solver.apply_delta(&mut surface, &delta).unwrap();
        solver.validate(&surface).unwrap();
        if delta.vertices_removed.is_empty() {
            assert_same_sums(&solver, before);
            let back = Addition { triangles: corners, ..Addition::default() };
            let delta = replace(&mut surface, &[], &back);
            solver.apply_delta(&mut surface, &delta).unwrap();
            solver.validate(&surface).unwrap();
            assert_same_sums(&solver, before);
        }
    }
}

#[test]
fn an_edit_keeps_other_constraints() {
    let mut surface = two_spheres(2);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    spin(&surface, &mut solver);
    let old = solver.clone();
    let positions = surface.positions().to_vec();
    let h = HalfEdge(30);
    let delta = split(&mut surface, h, 0.25).unwrap();
    let affected: Vec<VertexId> = delta
        .triangles_removed
        .iter()
        .flat_map(|&(_, corners)| corners)
        .collect();
    solver.apply_delta(&mut surface, &delta).unwrap();
    for (i, position) in positions.iter().enumerate() {
        let v = VertexId::from_index(i);
        if !affected.contains(&v) {
            assert_eq!(surface.positions()[i], *position, "{v}");
            assert_eq!(solver.velocity(v), old.velocity(v), "{v}");
            assert_eq!(solver.masses()[i], old.masses()[i], "{v}");
        }
    }
    let moved = (old.stretch().batches().iter())
        .zip(solver.stretch().batches())
        .flat_map(|(a, b)| a.vertices().iter().zip(b.vertices()))
        .filter(|(a, b)| a != b)
        .count();
    assert!(moved <= 2, "{moved} constraints changed their slots");
}

#[test]
fn mass_stays_in_its_piece() {
    let mut surface = two_spheres(2);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let mass_of = |surface: &Surface, solver: &Solver, piece: u32| -> f64 {
        let mut vertices: Vec<VertexId> = surface
            .topology()
            .triangles()
            .filter(|&t| surface.piece(t) == piece)
            .flat_map(|t| surface.topology().triangle(t))
            .collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mass = |v: &VertexId| f64::from(solver.masses()[v.index()]);
        vertices.iter().map(mass).sum()
    };
    let before = [0, 1].map(|piece| mass_of(&surface, &solver, piece));
    let (first, second) = (VertexId(2), VertexId(80));
    for v in [first, second] {
        let delta = replace_vertex(&mut surface, v).unwrap();
        solver.apply_delta(&mut surface, &delta).unwrap();
    }
    for (piece, before) in (0..).zip(before) {
        let after = mass_of(&surface, &solver, piece);
        assert!(
            (after - before).abs() < 1e-6,
            "piece {piece}: {before} became {after}"
        );
    }
}

#[test]
fn pins_are_removed_with_their_vertices() {
    let mut surface = sphere(2, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let (kept, lost) = (VertexId(10), VertexId(2));
    solver.pin(&mut surface, kept).unwrap();
    solver.pin(&mut surface, lost).unwrap();
    let h = surface.topology().outgoing(kept);
    let delta = split(&mut surface, h, 0.5).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    assert_eq!(surface.positions()[kept.index()][3], 0.0);
    let delta = replace_vertex(&mut surface, lost).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    let pinned: Vec<VertexId> = solver.pins().iter().map(|pin| pin.vertex).collect();
    assert_eq!(pinned, [kept]);
}

#[test]
fn constraints_at_a_high_valence_overflow() {
    let mut surface = double_cone(100);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    solver.validate(&surface).unwrap();
    assert!(solver.stretch().overflow().len() >= 36);
    assert!(!solver.bending().unwrap().overflow().is_empty());
    let params = SolverParams::paper();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    for _ in 0..120 {
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
    assert!(solver.stretch_error(&surface) < 0.05);
    let delta = replace_vertex(&mut surface, VertexId(0)).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    solver.validate(&surface).unwrap();
}

#[test]
fn a_delta_fits_once() {
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let delta = flip(&mut surface, HalfEdge(0)).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    let again = solver.apply_delta(&mut surface, &delta);
    assert!(matches!(again, Err(ConstraintError::DeltaMismatch { .. })));
    solver.validate(&surface).unwrap();
}
