//! Mass and momentum are distributed to both halves of a cut.

use incise_mesh::{Surface, TriangleId, VertexId};
use incise_pbd_gpu::{Collider, Density, Material, Solver, SolverParams};
use incise_test_support::edits::{Addition, NEW, on_cap, replace};
use incise_test_support::surfaces::sphere;

/// The removed triangles and the caps of a cut along the equator. Both halves get a vertex in the
/// middle of their cap.
fn equator(surface: &Surface) -> (Vec<TriangleId>, Addition) {
    let topology = surface.topology();
    let height = |v: VertexId| surface.rest_positions()[v.index()][1] - 2.0;
    let removed: Vec<TriangleId> = topology
        .triangles()
        .filter(|&t| topology.triangle(t).iter().any(|&v| height(v).abs() < 1e-3))
        .collect();
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for h in removed.iter().flat_map(|t| t.half_edges()) {
        if !removed.contains(&topology.twin(h).triangle()) {
            let (a, b) = (topology.origin(h), topology.target(h));
            let side = if height(a) > 0.0 {
                &mut above
            } else {
                &mut below
            };
            side.push([a, b]);
        }
    }
    let mut addition = Addition::default();
    for (i, rim) in (0..).zip([above, below]) {
        let third = rim.len() / 3;
        let parents = [rim[0][0], rim[third][0], rim[2 * third][0]];
        addition.vertices.push(on_cap(parents));
        let fan = rim.iter().map(|&[a, b]| [VertexId(NEW + i), a, b]);
        addition.triangles.extend(fan);
    }
    (removed, addition)
}

fn sums_of(solver: &Solver, surface: &Surface, piece: u32) -> (f64, f64) {
    let topology = surface.topology();
    let (mut mass, mut momentum) = (0.0, 0.0);
    for v in topology.vertices() {
        if surface.piece(topology.outgoing(v).triangle()) == piece {
            let m = f64::from(solver.masses()[v.index()]);
            mass += m;
            momentum += m * f64::from(solver.velocity(v)[0]);
        }
    }
    (mass, momentum)
}

#[test]
fn both_halves_get_mass_and_momentum() {
    let mut surface = sphere(3, [0.0, 2.0, 0.0]);
    let material = Material {
        density: Density::Volume(500.0),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in surface.topology().vertices() {
        let y = surface.positions()[v.index()][1];
        solver.set_velocity(v, [y, 1.0 - y * y, 0.5]).unwrap();
    }
    let (mass, momentum) = (solver.total_mass(), solver.momentum());
    let (removed, addition) = equator(&surface);
    let delta = replace(&mut surface, &removed, &addition);
    assert!(!delta.vertices_removed.is_empty());
    let labels = surface.topology().component_labels();
    for (t, &label) in labels.iter().enumerate().filter(|(_, l)| **l != u32::MAX) {
        surface.set_piece(TriangleId::from_index(t), label);
    }
    solver.apply_delta(&mut surface, &delta).unwrap();
    solver.validate(&surface).unwrap();
    assert!((solver.total_mass() / mass - 1.0).abs() < 1e-6);
    for (now, then) in solver.momentum().iter().zip(momentum) {
        assert!(
            (now - then).abs() < 1e-5 * mass,
            "{momentum:?} became {:?}",
            solver.momentum()
        );
    }
    let halves = [0, 1].map(|piece| sums_of(&solver, &surface, piece));
    for (half, _) in halves {
        // The order of vertices decides to which half those on the equator belong.
        assert!((half / mass - 0.5).abs() < 0.1, "{half} kg of {mass} kg");
    }
    for v in delta.vertices_removed {
        assert_eq!(
            (
                solver.masses()[v.index()],
                surface.positions()[v.index()][3]
            ),
            (0.0, 0.0)
        );
    }
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    for _ in 0..120 {
        let params = SolverParams::paper();
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
}

#[test]
fn a_piece_of_new_vertices_gets_mass() {
    let mut surface = sphere(2, [0.0, 2.0, 0.0]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let mass = solver.total_mass();
    let (removed, mut addition) = equator(&surface);
    // A chip that both halves lose: a tetrahedron over new vertices only.
    let ids: Vec<VertexId> = surface.topology().vertices().collect();
    let chip = [0, 1, 2, 3].map(|i| VertexId(NEW + 2 + i));
    for corners in [[0, 1, 2], [1, 3, 2], [3, 4, 2], [0, 4, 5]] {
        let parents = corners.map(|i: usize| ids[i]);
        addition.vertices.push(on_cap(parents));
    }
    for corners in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        addition.triangles.push(corners.map(|i: usize| chip[i]));
    }
    let delta = replace(&mut surface, &removed, &addition);
    let labels = surface.topology().component_labels();
    for (t, &label) in labels.iter().enumerate().filter(|(_, l)| **l != u32::MAX) {
        surface.set_piece(TriangleId::from_index(t), label);
    }
    solver.apply_delta(&mut surface, &delta).unwrap();
    solver.validate(&surface).unwrap();
    assert!((solver.total_mass() / mass - 1.0).abs() < 1e-6);
    for v in surface.topology().vertices() {
        assert!(solver.masses()[v.index()] > 0.0, "{v} has no mass");
    }
}
