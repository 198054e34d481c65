//! Public behavior of lattices.

mod follow;
#[cfg(feature = "serde")]
mod save;

use incise_cut::{CutParams, Cutter, Sweep};
use incise_lattice::{Lattice, LatticeError, LatticeParams, NO_COPY};
use incise_mesh::{Partition, Surface, Vec3, cube_sphere, icosphere, index_u32, sheet, torus};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn params(cell_size: f64) -> LatticeParams {
    LatticeParams {
        cell_size: Some(cell_size),
        ..LatticeParams::default()
    }
}

fn body(number: u8) -> Surface {
    match number {
        0 => icosphere(3, 0.5),
        1 => torus(0.35, 0.15, 32, 16),
        2 => cube_sphere(6, 0.5),
        _ => cube_sphere(1, 0.5),
    }
}

/// Cuts a body along planes, each given by a normal and a distance from the origin \[m\].
fn cut(body: &mut Surface, planes: &[([f64; 3], f64)]) {
    let mut cutter = Cutter::new(body);
    for &(normal, distance) in planes {
        if let Ok(sweep) = Sweep::from_plane(normal, distance, &body.bounds()) {
            let _ = cutter.cut(body, &sweep, &CutParams::default());
        }
    }
}

/// Checks what holds for every lattice of a closed surface.
fn check(surface: &Surface, lattice: &Lattice) {
    let size = lattice.grid.cell_size();
    let volume: f64 = lattice.node_volumes.iter().sum();
    let fractions: f64 = lattice.moments.iter().map(|m| m.fraction).sum();
    assert!(
        (fractions * size.powi(3) / volume - 1.0).abs() < 1e-9,
        "volumes of copies and nodes"
    );
    for v in surface.topology().vertices() {
        let weights = lattice.vertex_weights[v.index()];
        let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{v}: {sum}");
        let off = lattice.embedded(v.index(), &lattice.node_positions) - surface.rest_position(v);
        assert!(off.norm() < 1e-5 * size, "{v}: {off:?}");
    }
    // Copies and nodes belong to one piece, and those of a piece are connected.
    let mut of_copy = BTreeMap::new();
    for t in surface.topology().triangles() {
        for v in surface.topology().triangle(t) {
            let copy = lattice.vertex_copies[v.index()];
            assert_ne!(copy, NO_COPY, "{v}");
            let piece = *of_copy.entry(copy).or_insert(surface.piece(t));
            assert_eq!(piece, surface.piece(t), "copy {copy}");
        }
    }
    let mut sets = Partition::new(lattice.node_positions.len());
    for nodes in &lattice.nodes {
        for pair in nodes.windows(2) {
            sets.join(pair[0], pair[1]);
        }
    }
    let mut of_set = BTreeMap::new();
    for (copy, nodes) in (0..).zip(&lattice.nodes) {
        if let Some(&piece) = of_copy.get(&copy) {
            let own = *of_set.entry(sets.find(nodes[0])).or_insert(piece);
            assert_eq!(own, piece, "nodes of two pieces are connected");
        }
    }
    let nodes = 0..index_u32(lattice.node_positions.len());
    let components = nodes.filter(|&node| sets.find(node) == node).count();
    assert_eq!(components, surface.piece_count(), "pieces are connected");
}

#[test]
fn a_lattice_holds_the_volume_of_its_body() {
    for number in 0..4 {
        let body = body(number);
        let lattice = Lattice::build(&body, &LatticeParams::default()).unwrap();
        check(&body, &lattice);
        let volume: f64 = lattice.node_volumes.iter().sum();
        let error = volume / body.volume() - 1.0;
        assert!(error.abs() < 0.01, "body {number}: {error}");
    }
}

#[test]
fn a_cube_of_whole_cells_has_a_copy_for_each() {
    for n in 1..6u8 {
        // Its corners are at 0.5 along each axis.
        let cube = cube_sphere(1, 0.75_f64.sqrt());
        let lattice = Lattice::build(&cube, &params(1.0 / f64::from(n))).unwrap();
        check(&cube, &lattice);
        let (cells, nodes) = (usize::from(n).pow(3), usize::from(n + 1).pow(3));
        assert_eq!(
            (lattice.cells.len(), lattice.nodes.len()),
            (cells, cells),
            "{n} cells"
        );
        assert_eq!(lattice.node_positions.len(), nodes, "{n} cells");
        // Sizes have ten bits: cells of 1/3 and 1/5 m are rounded up, by 0.2 % at most.
        let rounding = if n.is_power_of_two() { 1e-5 } else { 0.01 };
        for moments in &lattice.moments {
            assert!((moments.fraction - 1.0).abs() < rounding, "{moments:?}");
            for k in 0..3 {
                assert!(moments.center[k].abs() < 0.01, "{moments:?}");
                assert!((moments.spread[k] - 1.0).abs() < 0.02, "{moments:?}");
            }
        }
    }
}

#[test]
fn both_sides_of_an_incision_have_their_own_copies() {
    for (number, size) in [(0, 0.1), (0, 0.07), (2, 0.12)] {
        let mut body = body(number);
        let edge = |z: f32| [[-1.0, 0.013, z], [1.0, 0.013, z]];
        let sweep = Sweep::new(edge(1.0), edge(0.0)).unwrap();
        let mut cutter = Cutter::new(&body);
        let _ = cutter
            .incise(&mut body, &sweep, &CutParams::default())
            .unwrap();
        let lattice = Lattice::build(&body, &params(size)).unwrap();
        check(&body, &lattice);
        let mut places = BTreeMap::<[u32; 3], Vec<usize>>::new();
        for v in body.topology().vertices() {
            let rest = body.rest_positions()[v.index()];
            places
                .entry(rest.map(f32::to_bits))
                .or_default()
                .push(v.index());
        }
        let mut pairs = 0;
        for pair in places.values().filter(|pair| pair.len() == 2) {
            // The cell of the tip holds both sides, and cells beside it may carry it.
            let depth = f64::from(body.rest_positions()[pair[0]][2]);
            if depth > 2.0 * size {
                pairs += 1;
                let copies = [pair[0], pair[1]].map(|slot| lattice.vertex_copies[slot]);
                assert_ne!(copies[0], copies[1], "body {number} at {depth}");
            }
        }
        assert!(pairs > 20, "{pairs}");
    }
}

#[test]
fn surfaces_without_an_inside_are_errors() {
    let open = sheet([1.0; 2], [4; 2]);
    let built = Lattice::build(&open, &LatticeParams::default());
    assert!(matches!(built, Err(LatticeError::Open { .. })), "{built:?}");
    let mut inverted = icosphere(2, 0.5);
    inverted.flip().unwrap();
    let built = Lattice::build(&inverted, &LatticeParams::default());
    assert_eq!(built, Err(LatticeError::NoVolume));
    let ball = icosphere(2, 0.5);
    for size in [0.0, -1.0, f64::NAN] {
        let built = Lattice::build(&ball, &params(size));
        assert!(
            matches!(built, Err(LatticeError::CellSize { .. })),
            "{built:?}"
        );
    }
    let built = Lattice::build(&ball, &params(1e-4));
    assert!(
        matches!(built, Err(LatticeError::TooManyCells { .. })),
        "{built:?}"
    );
}

#[test]
fn vertices_follow_affine_motion() {
    let body = torus(0.35, 0.15, 32, 16);
    let lattice = Lattice::build(&body, &params(0.08)).unwrap();
    let map = |p: Vec3| Vec3::new(1.2 * p.x + 0.3 * p.y, p.y - 0.2 * p.z, 0.9 * p.z + 0.1);
    let nodes: Vec<[f64; 3]> = lattice
        .node_positions
        .iter()
        .map(|&p| map(p.into()).into())
        .collect();
    for v in body.topology().vertices() {
        let off = lattice.embedded(v.index(), &nodes) - map(body.rest_position(v));
        assert!(off.norm() < 1e-6, "{v}: {off:?}");
    }
}

/// A unit normal, nearly, and a distance from the origin \[m\].
fn plane() -> impl Strategy<Value = ([f64; 3], f64)> {
    let coordinate = -1.0..1.0f64;
    (
        [coordinate.clone(), coordinate.clone(), coordinate],
        -0.3..0.3f64,
    )
}

proptest! {
    /// Cells of any size, at bodies that planes have cut to pieces.
    #[test]
    fn pieces_share_no_node(
        number in 0u8..4,
        planes in prop::collection::vec(plane(), 0..5),
        size in 0.06..0.5f64,
    ) {
        let mut body = body(number);
        cut(&mut body, &planes);
        let lattice = Lattice::build(&body, &params(size)).unwrap();
        check(&body, &lattice);
    }
}
