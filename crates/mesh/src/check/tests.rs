//! Checks and repairs of known meshes, and their agreement for random triangles.

mod open;

use super::*;
use crate::surface::Surface;
use proptest::prelude::*;

const CUBE: [[u32; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
];

/// Returns the corners of a unit cube whose first is at `x`, `y`, `z`.
fn cube_at(x: f32, y: f32, z: f32) -> Vec<[f32; 3]> {
    (0..8u8)
        .map(|i| {
            let bit = |k: u8| f32::from(i >> k & 1);
            [x + bit(2), y + bit(1), z + bit(0)]
        })
        .collect()
}

fn cubes(corners: &[[f32; 3]]) -> MeshData {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for (i, &[x, y, z]) in (0u32..).zip(corners) {
        positions.extend(cube_at(x, y, z));
        triangles.extend(CUBE.map(|t| t.map(|v| v + 8 * i)));
    }
    MeshData::from_triangles(&positions, &triangles).unwrap()
}

/// Returns a cube with other triangles.
fn cube_of(triangles: &[[u32; 3]]) -> MeshData {
    MeshData::from_triangles(&cube_at(0.0, 0.0, 0.0), triangles).unwrap()
}

#[test]
fn touching_bodies_are_counted_welded_and_repaired() {
    for (at, welded, crowded) in [([1.0, 1.0, 0.0], 14, 1), ([1.0, 0.0, 0.0], 12, 5)] {
        let report = check(&cubes(&[[0.0; 3], at]));
        assert_eq!((report.vertices, report.components), (welded, 1));
        assert_eq!((report.nonmanifold_edges, report.genus), (crowded, None));
        let expected = RepairedCounts {
            vertices: 16,
            triangles: 24,
            edges: 36,
            components: 2,
            genus: Some(0),
        };
        assert_eq!(report.repaired, Some(expected));
    }
}

#[test]
fn a_cube_is_measured() {
    let report = check(&cube_of(&CUBE));
    assert_eq!(
        (report.vertices, report.triangles, report.edges),
        (8, 12, 18)
    );
    assert_eq!((report.euler_characteristic, report.genus), (2, Some(0)));
    assert_eq!((report.area, report.volume), (6.0, 1.0));
    assert!(report.closed && report.manifold && report.oriented);
    assert_eq!(
        (report.edge_lengths.min, report.edge_lengths.max),
        (1.0, 2f64.sqrt())
    );
    assert!((report.angles.median - 45.0).abs() < 1e-12);
    assert_eq!(report.is_cuttable(), Ok(()));
    assert_eq!(report.warnings, []);
}

#[test]
fn an_open_mesh_is_rejected() {
    let report = check(&cube_of(&CUBE[..11]));
    assert_eq!(
        (report.closed, report.genus, report.open_edges),
        (false, None, 3)
    );
    assert!(matches!(
        report.defects[..],
        [Defect::OpenEdge { count: 3, .. }]
    ));
    let error = cube_of(&CUBE[..11]).into_surface().unwrap_err();
    assert_eq!(error.defects, report.defects);
    assert!(error.to_string().contains("open edges: 3"), "{error}");
}

#[test]
fn unique_repairs_are_made() {
    let mut triangles = CUBE.to_vec();
    triangles.push([3, 0, 1]);
    triangles.push([4, 4, 1]);
    triangles[5].swap(0, 1);
    for t in &mut triangles {
        t.swap(0, 2);
    }
    let (surface, warnings) = cube_of(&triangles).into_surface().unwrap();
    assert_eq!(
        warnings,
        [
            Warning::Collapsed {
                triangle: TriangleId(13),
                count: 1
            },
            Warning::DuplicatesRemoved {
                triangle: TriangleId(12),
                count: 1
            },
            Warning::Reoriented {
                triangle: TriangleId(5),
                count: 1
            },
            Warning::Inverted,
        ]
    );
    assert_eq!(surface.volume(), 1.0);
    assert!(surface.topology().is_closed());
}

#[test]
fn bodies_in_contact_stay_separate() {
    for corner in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let data = cubes(&[[0.0; 3], corner]);
        assert_eq!(check(&data).is_cuttable(), Ok(()), "at {corner:?}");
        let (surface, warnings) = data.into_surface().unwrap();
        assert_eq!(warnings.len(), 1);
        assert_eq!(surface.piece_bound(), 2);
        for volume in surface.piece_volumes() {
            assert!((volume - 1.0).abs() < 1e-15, "{volume}");
        }
        assert_eq!(surface.topology().vertex_count(), 16);
    }
}

#[test]
fn contact_without_separate_indices_is_rejected() {
    let two = cubes(&[[0.0; 3], [1.0, 1.0, 0.0]]);
    let welded = MeshData::from_triangles(&two.positions, &two.triangles).unwrap();
    assert!(matches!(
        check(&welded).defects[..],
        [Defect::NonManifoldEdge { count: 1, .. }]
    ));
}

#[test]
fn duplicate_bodies_are_merged() {
    let (surface, warnings) = cubes(&[[0.0; 3], [0.0; 3]]).into_surface().unwrap();
    assert_eq!(surface.topology().triangle_count(), 12);
    assert_eq!(
        warnings,
        [Warning::DuplicatesRemoved {
            triangle: TriangleId(12),
            count: 12
        }]
    );
}

#[test]
fn a_flat_body_is_rejected() {
    // Two halves with a common boundary, on a slope with exact heights.
    let points = [
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 1.0),
        (0.0, 1.0),
        (0.5, 0.5),
        (0.25, 0.5),
    ]
    .map(|(x, y)| [3.0 * x, y, 0.5 * x + 0.25 * y]);
    let triangles = [
        [0, 1, 4],
        [1, 2, 4],
        [2, 3, 4],
        [3, 0, 4],
        [1, 0, 5],
        [2, 1, 5],
        [3, 2, 5],
        [0, 3, 5],
    ];
    let report = check(&MeshData::from_triangles(&points, &triangles).unwrap());
    assert!(
        matches!(report.defects[..], [Defect::ZeroVolume { count: 1, .. }]),
        "{:?} {}",
        report.defects,
        report.volume
    );
}

#[test]
fn a_one_sided_strip_is_rejected() {
    let points: Vec<[f32; 3]> = (0..10u8)
        .map(|i| [f32::from(i), f32::from(i * i), f32::from(i % 3)])
        .collect();
    let mut triangles: Vec<[u32; 3]> = (0..8)
        .map(|i| {
            if i % 2 == 0 {
                [i, i + 1, i + 2]
            } else {
                [i + 1, i, i + 2]
            }
        })
        .collect();
    triangles.extend([[8, 9, 1], [9, 1, 0]]);
    let report = check(&MeshData::from_triangles(&points, &triangles).unwrap());
    assert!(
        report
            .defects
            .iter()
            .any(|d| matches!(d, Defect::NonOrientable { count: 1, .. })),
        "{:?}",
        report.defects
    );
}

#[test]
fn seams_survive_repairs() {
    let mut data = cube_of(&CUBE);
    data.corners.uv = (0..36u8).map(|i| [f32::from(i), 0.0]).collect();
    for t in &mut data.triangles {
        t.swap(1, 2);
    }
    let (surface, _) = data.into_surface().unwrap();
    let u: Vec<f32> = surface.corners.uv.iter().map(|uv| uv[0]).collect();
    assert_eq!(u[..6], [0.0, 2.0, 1.0, 3.0, 5.0, 4.0]);
    assert_eq!(surface.seam_split_vertices(), 36);
}

proptest! {
    /// For any triangles, report and surface agree, and a cuttable mesh gives a valid body.
    #[test]
    fn cuttable_meshes_are_closed_and_oriented(
        triangles in prop::collection::vec(prop::array::uniform3(0..8u32), 1..16),
        flips in any::<u16>(),
        keep in any::<u16>(),
    ) {
        let flipped = (0u32..).zip(CUBE).filter(|(i, _)| keep >> i & 1 == 1).map(|(i, mut t)| {
            if flips >> i & 1 == 1 {
                t.swap(0, 1);
            }
            t
        });
        for triangles in [triangles.clone(), flipped.chain(triangles).collect()] {
            let data = cube_of(&triangles);
            let report = check(&data);
            match data.into_surface() {
                Ok((surface, _)) => {
                    prop_assert_eq!(report.is_cuttable(), Ok(()));
                    surface.validate().unwrap();
                    prop_assert!(surface.topology().is_closed());
                    prop_assert!(surface.volume() > 0.0);
                    for v in surface.topology().vertices() {
                        let fan = surface.topology().outgoing_fan(v).count();
                        let corners = surface.topology().corners().iter();
                        prop_assert_eq!(fan, corners.filter(|&&c| c == v).count());
                    }
                }
                Err(error) => prop_assert_eq!(&report.defects, &error.defects),
            }
        }
    }

    #[test]
    fn any_flips_of_a_cube_are_repaired(flips in any::<u16>()) {
        let triangles: Vec<[u32; 3]> = (0u32..)
            .zip(CUBE)
            .map(|(i, [a, b, c])| if flips >> i & 1 == 1 { [a, c, b] } else { [a, b, c] })
            .collect();
        let (surface, _) = cube_of(&triangles).into_surface().unwrap();
        prop_assert_eq!(surface.volume(), 1.0);
        let topology = surface.topology();
        let triangles = topology.triangles().map(|t| topology.triangle(t).map(|v| v.0));
        let triangles: Vec<[u32; 3]> = triangles.collect();
        let expected = Surface::from_triangles(surface.rest_positions(), &triangles);
        prop_assert_eq!(Ok(&surface), expected.as_ref());
    }
}
