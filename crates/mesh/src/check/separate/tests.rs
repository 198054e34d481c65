//! Separation of sheets and bodies that share edges.

use crate::check::{RepairParams, check};
use crate::io::{MeshData, Warning, read_mesh, write_obj, write_ply};
use crate::surface::Surface;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Builds mesh data of quads with shared vertices on the integer grid, two triangles each.
fn quads(quads: &[[[i16; 3]; 4]]) -> MeshData {
    let mut ids = BTreeMap::new();
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut triangles = Vec::new();
    for quad in quads {
        let [a, b, c, d] = quad.map(|p| {
            *ids.entry(p).or_insert_with(|| {
                positions.push(p.map(f32::from));
                u32::try_from(positions.len() - 1).unwrap()
            })
        });
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    MeshData::from_triangles(&positions, &triangles).unwrap()
}

/// Returns the outward faces of a unit cube.
fn cube([x, y, z]: [i16; 3]) -> [[[i16; 3]; 4]; 6] {
    let p = |i: i16, j: i16, k: i16| [x + i, y + j, z + k];
    [
        [p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0)],
        [p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1)],
        [p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)],
        [p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0)],
        [p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0)],
        [p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)],
    ]
}

/// Returns the volumes of the closed pieces, without rounding errors, and the number of open ones.
fn volumes(surface: &Surface) -> (Vec<f64>, usize) {
    let mut volumes = Vec::new();
    let mut open = 0;
    for (_, part) in surface.extract_pieces() {
        if part.topology().is_closed() {
            volumes.push((1e9 * part.volume()).round() / 1e9);
        } else {
            open += 1;
        }
    }
    (volumes, open)
}

/// Every repair that there is.
const ALL: RepairParams = RepairParams {
    allow_boundaries: true,
    separate_sheets: true,
};

fn repaired(data: MeshData) -> (Surface, Vec<Warning>) {
    let (surface, warnings) = data.clone().repair(ALL).unwrap();
    surface.validate().unwrap();
    let again = data.repair(ALL).unwrap();
    assert!((surface.clone(), warnings.clone()) == again, "same bits");
    (surface, warnings)
}

fn has(warnings: &[Warning], test: fn(&Warning) -> bool) -> bool {
    warnings.iter().any(test)
}

#[test]
fn cubes_that_share_an_edge_are_two_bodies() {
    let data = quads(&[cube([0, 0, 0]), cube([1, 1, 0])].concat());
    assert!(check(&data).is_cuttable().is_err());
    let (surface, warnings) = repaired(data);
    surface.validate_closed().unwrap();
    assert_eq!(volumes(&surface), (vec![1.0, 1.0], 0));
    assert!(
        matches!(warnings[..], [Warning::EdgesSplit { count: 1, .. }]),
        "{warnings:?}"
    );
}

#[test]
fn a_wall_within_a_body_is_a_sheet() {
    // The halves of a box of two cubes, and the face between them once.
    let wall = cube([0, 0, 0])[1];
    let mut faces = [&cube([0, 0, 0])[..1], &cube([0, 0, 0])[2..]].concat();
    faces.extend([&cube([1, 0, 0])[1..2], &cube([1, 0, 0])[2..]].concat());
    for wall in [wall, [wall[3], wall[2], wall[1], wall[0]]] {
        faces.push(wall);
        let (surface, warnings) = repaired(quads(&faces));
        assert_eq!(volumes(&surface), (vec![2.0], 1));
        assert!(has(&warnings, |w| matches!(
            w,
            Warning::SheetsDetached { count: 1, .. }
        )));
        faces.pop();
    }
}

#[test]
fn a_double_wall_with_common_indices_stays() {
    let (surface, _) = repaired(quads(&[cube([0, 0, 0]), cube([1, 0, 0])].concat()));
    surface.validate_closed().unwrap();
    assert_eq!(volumes(&surface), (vec![1.0, 1.0], 0));
}

#[test]
fn a_fin_is_detached_and_its_body_stays_closed() {
    let fins = [
        [[1, 1, 0], [2, 2, 0], [2, 2, 1], [1, 1, 1]],
        [[1, 1, 0], [2, 1, 0], [2, 1, 1], [1, 1, 1]],
        [[1, 1, 1], [2, 2, 1], [2, 2, 0], [1, 1, 0]],
    ];
    for fin in fins {
        let (surface, _) = repaired(quads(&[&cube([0, 0, 0])[..], &[fin]].concat()));
        assert_eq!(volumes(&surface), (vec![1.0], 1));
    }
    // Two fins that continue each other are one sheet.
    let through = [fins[0], [[1, 1, 0], [1, 1, 1], [2, 1, 1], [2, 1, 0]]];
    let (surface, _) = repaired(quads(&[&cube([0, 0, 0])[..], &through].concat()));
    assert_eq!(volumes(&surface), (vec![1.0], 1));
}

#[test]
fn three_sheets_at_an_edge_are_separated() {
    let pages = [
        [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]],
        [[0, 0, 0], [0, 0, 1], [-1, 1, 1], [-1, 1, 0]],
        [[0, 0, 0], [0, 0, 1], [-1, -1, 1], [-1, -1, 0]],
    ];
    let (surface, warnings) = repaired(quads(&pages));
    assert_eq!(volumes(&surface), (vec![], 3));
    assert!(has(&warnings, |w| matches!(
        w,
        Warning::SheetsDetached { count: 3, .. }
    )));
}

#[test]
fn back_sides_are_removed_unless_they_are_walls() {
    // A face of a cube again, the other way around.
    let mut faces = cube([0, 0, 0]).to_vec();
    let [a, b, c, d] = faces[3];
    faces.push([c, b, a, d]);
    let (surface, warnings) = repaired(quads(&faces));
    assert_eq!(volumes(&surface), (vec![1.0], 0));
    assert!(matches!(
        warnings[..],
        [Warning::BackSidesRemoved { count: 2, .. }]
    ));
    // A card with two sides is one sheet, whatever its indices.
    let card = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
    let back = [card[2], card[1], card[0], card[3]];
    let (surface, _) = repaired(quads(&[card, back]));
    assert_eq!(volumes(&surface), (vec![], 1));
    assert_eq!(surface.topology().triangle_count(), 2);
}

#[test]
fn components_without_volume_are_removed() {
    // Two triangulations of a square, back to back.
    let (front, back) = (
        [[2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0]],
        [[3, 0, 0], [2, 0, 0], [2, 1, 0], [3, 1, 0]],
    );
    assert!(
        quads(&[front, back]).repair(ALL).is_err(),
        "nothing remains"
    );
    let (surface, warnings) = repaired(quads(&[&cube([0, 0, 0])[..], &[front, back]].concat()));
    assert_eq!(volumes(&surface), (vec![1.0], 0));
    assert!(matches!(
        warnings[..],
        [Warning::FlatComponentsRemoved { count: 1, .. }]
    ));
}

/// A flat component stayed beside a part with a boundary, and its section had two points.
#[test]
fn components_without_volume_are_removed_beside_sheets() {
    let is_flat_removed = |warnings: &[Warning]| {
        has(warnings, |w| {
            matches!(w, Warning::FlatComponentsRemoved { count: 1, .. })
        })
    };
    // Four triangles at one edge, two of them back to back: a sheet of two remains.
    let points = [
        [-2.494_062, 1.064_186, 4.900_767],
        [-2.494_062, 1.056_373, 4.853_892],
        [-2.494_062, 1.111_061, 4.846_08],
        [-2.455, 1.126_686, 4.885_142],
        [-2.533_125, 1.126_686, 4.885_142],
    ];
    let fins = [[0, 3, 2], [0, 2, 1], [0, 1, 2], [0, 2, 4]];
    let (surface, warnings) = repaired(MeshData::from_triangles(&points, &fins).unwrap());
    assert_eq!(volumes(&surface), (vec![], 1));
    assert_eq!(surface.topology().triangle_count(), 2);
    assert!(is_flat_removed(&warnings), "{warnings:?}");
    // Flat components of two and of four triangles, beside a sheet and beside a cube.
    let pair = [[4.0, 0.0, 0.0], [5.0, 0.0, 0.0], [4.0, 1.0, 0.0]];
    let square = [
        [3.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
        [3.0, 1.0, 0.0],
    ];
    let sheet = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
    for (others, expected) in [
        (quads(&[sheet]), (vec![], 1)),
        (quads(&cube([0, 0, 0])), (vec![1.0], 0)),
    ] {
        for (points, faces) in [
            (&pair[..], &[[0, 1, 2], [0, 2, 1]][..]),
            (&square, &[[0, 1, 2], [0, 2, 3], [1, 0, 3], [1, 3, 2]]),
        ] {
            let first = u32::try_from(others.positions.len()).unwrap();
            let positions = [&others.positions[..], points].concat();
            let faces: Vec<[u32; 3]> = faces.iter().map(|t| t.map(|v| v + first)).collect();
            let triangles = [&others.triangles[..], &faces].concat();
            let (surface, warnings) =
                repaired(MeshData::from_triangles(&positions, &triangles).unwrap());
            assert_eq!(volumes(&surface), expected);
            assert!(is_flat_removed(&warnings), "{warnings:?}");
        }
    }
}

/// Returns a unit cube with a slit from the top to its middle. The two walls of the slit have the
/// same positions, and share only the two vertices at its tip.
fn slit_cube(at: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let outline = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [0.5, 1.0],
        [0.5, 0.5],
        [0.5, 1.0],
        [0.0, 1.0],
    ];
    let front = outline.map(|[x, z]| [at + x, 0.0, z]);
    let back = outline.map(|[x, z]| [at + x, 1.0, z]);
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 4], [1, 2, 4], [2, 3, 4], [4, 5, 6], [4, 6, 0]] {
        triangles.extend([[a, b, c], [a + 7, c + 7, b + 7]]);
    }
    for a in 0..7 {
        let b = (a + 1) % 7;
        triangles.extend([[a, a + 7, b], [b, a + 7, b + 7]]);
    }
    ([front, back].concat(), triangles)
}

#[test]
fn the_walls_of_a_slit_stay_separate() {
    let (positions, triangles) = slit_cube(0.0);
    let data = MeshData::from_triangles(&positions, &triangles).unwrap();
    assert_eq!(data.positions.len(), 12);
    let report = check(&data);
    assert_eq!(report.is_cuttable(), Ok(()));
    let counts = report.repaired.unwrap();
    assert_eq!((counts.vertices, counts.genus), (14, Some(0)));
    let kept = |w: &Warning| matches!(w, Warning::IndicesKept { count: 2, .. });
    let (surface, warnings) = data.clone().into_surface().unwrap();
    assert!(warnings.len() == 1 && kept(&warnings[0]), "{warnings:?}");
    surface.validate_closed().unwrap();
    assert_eq!(surface.topology().vertex_count(), 14);
    assert_eq!(surface.topology().triangle_count(), triangles.len());
    assert_eq!(volumes(&surface), (vec![1.0], 0));
    assert!(
        repaired(data) == (surface.clone(), warnings),
        "no other repair"
    );
    // The same after a file of either format.
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "a.ply"] {
        let path = folder.path().join(name);
        if name == "a.obj" {
            write_obj(&path, &surface).unwrap();
        } else {
            write_ply(&path, &surface).unwrap();
        }
        let (read, _) = read_mesh(&path).unwrap().into_surface().unwrap();
        assert!(read == surface, "{name}");
    }
}

/// An edge of no length beside the end of a slit.
#[test]
fn walls_with_an_edge_of_no_length_stay_separate() {
    let (mut positions, mut triangles) = slit_cube(0.0);
    // A vertex beside vertex 4, which is one end of the slit, splits the two triangles of an edge.
    let (from, to) = (4, 1);
    let new = u32::try_from(positions.len()).unwrap();
    positions.push(positions[from as usize]);
    for t in triangles.clone() {
        if let Some(k) = (0..3).find(|&k| {
            [t[k], t[(k + 1) % 3]]
                .iter()
                .all(|v| [from, to].contains(v))
        }) {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            triangles.retain(|other| *other != t);
            triangles.extend([[a, new, c], [new, b, c]]);
        }
    }
    let data = MeshData::from_triangles(&positions, &triangles).unwrap();
    let report = check(&data);
    assert_eq!(report.is_cuttable(), Ok(()));
    let counts = report.repaired.unwrap();
    assert_eq!((counts.vertices, counts.genus), (15, Some(0)));
    let (surface, _) = data.into_surface().unwrap();
    surface.validate_closed().unwrap();
    assert_eq!(surface.topology().triangle_count(), triangles.len());
}

/// Without indices the order of the triangles around each edge tells the walls apart.
#[test]
fn a_slit_without_indices_is_separated() {
    let (positions, triangles) = slit_cube(0.0);
    let soup: Vec<[f32; 3]> = triangles
        .iter()
        .flat_map(|t| t.map(|v| positions[v as usize]))
        .collect();
    let corners: Vec<[u32; 3]> = (0..)
        .take(triangles.len())
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let data = MeshData::from_triangles(&soup, &corners).unwrap();
    assert!(data.clone().into_surface().is_err());
    let (surface, warnings) = repaired(data);
    surface.validate_closed().unwrap();
    assert_eq!(surface.topology().vertex_count(), 14);
    assert_eq!(surface.topology().triangle_count(), triangles.len());
    assert_eq!(volumes(&surface), (vec![1.0], 0));
    assert!(matches!(warnings[..], [Warning::EdgesSplit { .. }]));
}

#[test]
fn a_slit_stays_open_beside_other_repairs() {
    // The slit body touches a cube whose every triangle has its own vertices, and a fin.
    let (mut positions, mut triangles) = slit_cube(0.0);
    let soup = quads(&cube([1, 0, 0]));
    for t in &soup.triangles {
        let first = u32::try_from(positions.len()).unwrap();
        triangles.push([first, first + 1, first + 2]);
        positions.extend(t.map(|v| soup.positions[v as usize]));
    }
    let (surface, _) = MeshData::from_triangles(&positions, &triangles)
        .unwrap()
        .into_surface()
        .unwrap();
    surface.validate_closed().unwrap();
    assert_eq!(volumes(&surface), (vec![1.0, 1.0], 0));
    let first = u32::try_from(positions.len()).unwrap();
    triangles.push([first, first + 1, first + 2]);
    positions.extend([[2.0, 1.0, 0.0], [2.0, 1.0, 1.0], [3.0, 2.0, 0.0]]);
    let data = MeshData::from_triangles(&positions, &triangles).unwrap();
    assert!(data.clone().into_surface().is_err(), "the fin is open");
    let (surface, warnings) = repaired(data);
    assert_eq!(volumes(&surface), (vec![1.0, 1.0], 1));
    assert!(has(&warnings, |w| matches!(w, Warning::IndicesKept { .. })));
}

/// Returns the boundary of a set of unit cubes, as quads that share all vertices.
fn boundary(is_filled: impl Fn([i16; 3]) -> bool, size: i16) -> Vec<[[i16; 3]; 4]> {
    let mut out = Vec::new();
    let all =
        (0..size).flat_map(|x| (0..size).flat_map(move |y| (0..size).map(move |z| (x, y, z))));
    for (x, y, z) in all.filter(|&(x, y, z)| is_filled([x, y, z])) {
        let neighbors = [
            [x - 1, y, z],
            [x + 1, y, z],
            [x, y - 1, z],
            [x, y + 1, z],
            [x, y, z - 1],
            [x, y, z + 1],
        ];
        let faces = cube([x, y, z]).into_iter().zip(neighbors);
        out.extend(faces.filter(|&(_, n)| !is_filled(n)).map(|(face, _)| face));
    }
    out
}

#[test]
fn an_edge_within_a_body_is_separated_across_the_void() {
    // A block with two cubes missing that share an edge. Around the edge the material is connected
    // at both ends, so pairs around the material would give two edges with the same ends.
    let inside = |p: [i16; 3]| p.iter().all(|x| (0..4).contains(x));
    let holes = [[1, 1, 1], [2, 2, 1]];
    let faces = boundary(|p| inside(p) && !holes.contains(&p), 4);
    let (surface, _) = repaired(quads(&faces));
    surface.validate_closed().unwrap();
    assert_eq!(volumes(&surface), (vec![64.0, -1.0, -1.0], 0));
}

proptest! {
    /// The boundary of any set of cubes has a closed, oriented surface with the same volume.
    #[test]
    fn bodies_of_cubes_are_separated(filled in prop::collection::vec(any::<bool>(), 64)) {
        let is_filled = |[x, y, z]: [i16; 3]| {
            let inside = [x, y, z].iter().all(|x| (0..4).contains(x));
            inside && filled[usize::try_from(16 * x + 4 * y + z).unwrap()]
        };
        let faces = boundary(is_filled, 4);
        prop_assume!(!faces.is_empty());
        let (surface, _) = repaired(quads(&faces));
        surface.validate_closed().unwrap();
        let expected = filled.iter().filter(|&&filled| filled).count();
        let expected = f64::from(u32::try_from(expected).unwrap());
        prop_assert!((surface.volume() - expected).abs() < 1e-9, "{}", surface.volume());
    }

    /// Any triangles give an oriented manifold or an error, and a mesh without edges of more than
    /// two triangles the same surface as before.
    #[test]
    fn any_triangles_are_separated_or_refused(
        points in prop::collection::vec(prop::array::uniform3(-2..3i8), 4..12),
        triangles in prop::collection::vec(prop::array::uniform3(0..12u32), 1..40),
    ) {
        let count = u32::try_from(points.len()).unwrap();
        let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| v % count)).collect();
        let data = MeshData::from_triangles(&positions, &triangles).unwrap();
        let open = data.clone().into_open_surface();
        let nonmanifold = check(&data).nonmanifold_edges;
        match data.clone().repair(ALL) {
            Ok((surface, warnings)) => {
                surface.validate().unwrap();
                let again = data.repair(ALL).unwrap();
                prop_assert!((surface.clone(), warnings.clone()) == again);
                let topology = surface.topology();
                let mut edges: Vec<_> = topology
                    .triangles()
                    .flat_map(|t| t.half_edges())
                    .map(|h| (topology.origin(h), topology.target(h)))
                    .collect();
                edges.sort_unstable();
                let count = edges.len();
                edges.dedup();
                prop_assert_eq!(edges.len(), count, "an edge has two triangles at most");
                if let (Ok((open, _)), 0) = (open, nonmanifold) {
                    let same = open.topology() == surface.topology();
                    prop_assert!(same || warnings.contains(&Warning::Inverted));
                }
            }
            Err(error) => {
                prop_assert!(!error.defects.is_empty());
                prop_assert!(open.is_err());
            }
        }
    }
}
