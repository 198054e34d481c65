use super::*;
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

/// The corners of a unit cube whose first is at `x`, `y`, `z`.
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

/// One cube with other triangles.
fn cube_of(triangles: &[[u32; 3]]) -> MeshData {
    MeshData::from_triangles(&cube_at(0.0, 0.0, 0.0), triangles).unwrap()
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
    assert_eq!(report.fit_to_cut(), Ok(()));
    assert_eq!(report.warnings, []);
}

#[test]
fn an_open_mesh_is_refused() {
    let report = check(&cube_of(&CUBE[..11]));
    assert_eq!(
        (report.closed, report.genus, report.open_edges),
        (false, None, 3)
    );
    assert!(matches!(
        report.defects[..],
        [Defect::OpenEdge { count: 3, .. }]
    ));
    let refusal = cube_of(&CUBE[..11]).into_surface().unwrap_err();
    assert_eq!(refusal.defects, report.defects);
    assert!(refusal.to_string().contains("open edges: 3"), "{refusal}");
}

/// A ball as a soup whose vertices were moved a little, each copy by itself, is told from one with a hole: welded by the
/// distance that is named it is closed.
#[test]
fn vertices_that_nearly_meet_are_to_be_welded() {
    let ball = crate::shapes::icosphere(2, 0.5);
    let topology = ball.topology();
    for jitter in [1e-6_f64, 1e-4] {
        let mut seed = 1u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            #[expect(clippy::cast_precision_loss, reason = "31 bits")]
            let part = (seed >> 33) as f64 / f64::from(1u32 << 31);
            jitter * (part - 0.5)
        };
        let soup: Vec<[f32; 3]> = (topology.triangles())
            .flat_map(|t| topology.triangle(t))
            .map(|v| crate::geometry::round(ball.position(v).map(|x| x + noise())))
            .collect();
        let triangles: Vec<[u32; 3]> = (0..)
            .take(soup.len() / 3)
            .map(|i| [0, 1, 2].map(|k| 3 * i + k))
            .collect();
        let refusal = MeshData::from_triangles(&soup, &triangles)
            .unwrap()
            .into_surface()
            .unwrap_err();
        let [Defect::OpenEdge { gap: Some(gap), .. }] = refusal.defects[..] else {
            panic!("{refusal}");
        };
        assert!(
            gap > 0.5 * jitter && gap < 2.0 * jitter,
            "{gap} for {jitter}"
        );
        assert!(refusal.to_string().contains("weld vertices"), "{refusal}");
        // Where holes are allowed for it is a warning.
        let open = MeshData::from_triangles(&soup, &triangles).unwrap();
        let (_, warnings) = open.into_open_surface().unwrap();
        let [Warning::NearlyMeeting { gap: same, .. }] = warnings[..] else {
            panic!("{warnings:?}");
        };
        assert_eq!(same, gap);
        assert!(
            warnings[0].to_string().contains("weld vertices"),
            "{warnings:?}"
        );
        // Each vertex becomes the first that is no farther away than that.
        let near = |p: &[f32; 3], q: &[f32; 3]| (widen(*p) - widen(*q)).norm() <= 1.01 * gap;
        let welded: Vec<u32> = soup
            .iter()
            .map(|p| (0..).zip(&soup).find(|(_, q)| near(p, q)).unwrap().0)
            .collect();
        let triangles: Vec<[u32; 3]> = triangles
            .iter()
            .map(|t| t.map(|v| welded[v as usize]))
            .collect();
        let closed = MeshData::from_triangles(&soup, &triangles)
            .unwrap()
            .into_surface();
        assert!(closed.is_ok(), "{:?}", closed.err());
    }
    // Triangles that are missing, also every second one, are holes.
    for step in [2, 17] {
        let all = topology
            .triangles()
            .map(|t| topology.triangle(t).map(|v| v.0));
        let some: Vec<[u32; 3]> = (0..)
            .zip(all)
            .filter(|(i, _)| i % step != 0)
            .map(|(_, t)| t)
            .collect();
        let positions: Vec<[f32; 3]> = ball
            .positions
            .iter()
            .map(|&[x, y, z, _]| [x, y, z])
            .collect();
        let refusal = MeshData::from_triangles(&positions, &some)
            .unwrap()
            .into_surface()
            .unwrap_err();
        assert!(
            matches!(refusal.defects[..], [Defect::OpenEdge { gap: None, .. }]),
            "{refusal}"
        );
        assert!(refusal.to_string().contains("close the holes"), "{refusal}");
    }
}

#[test]
fn what_has_one_repair_is_repaired() {
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
fn bodies_in_contact_stay_two() {
    for corner in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let data = cubes(&[[0.0; 3], corner]);
        assert_eq!(check(&data).fit_to_cut(), Ok(()), "at {corner:?}");
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
fn contact_without_indices_to_tell_is_refused() {
    let two = cubes(&[[0.0; 3], [1.0, 1.0, 0.0]]);
    let welded = MeshData::from_triangles(&two.positions, &two.triangles).unwrap();
    assert!(matches!(
        check(&welded).defects[..],
        [Defect::NonManifoldEdge { count: 1, .. }]
    ));
}

#[test]
fn the_same_body_twice_is_one() {
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
fn a_flat_body_is_refused() {
    // A square with a middle and its mirror image with another, joined along the rim, on a slope
    // whose heights are exact.
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
fn a_strip_with_one_side_is_refused() {
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
    /// Whatever the triangles, the report and the surface agree, and what is fit is a valid body.
    #[test]
    fn fit_means_a_closed_oriented_body(
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
                    prop_assert_eq!(report.fit_to_cut(), Ok(()));
                    surface.topology().validate().unwrap();
                    prop_assert!(surface.topology().is_closed());
                    prop_assert!(surface.volume() > 0.0);
                    for v in surface.topology().vertices() {
                        let fan = surface.topology().outgoing_fan(v).count();
                        let corners = surface.topology().corners().iter().filter(|&&c| c == v).count();
                        prop_assert_eq!(fan, corners);
                    }
                }
                Err(refusal) => prop_assert_eq!(&report.defects, &refusal.defects),
            }
        }
    }

    #[test]
    fn one_cube_with_any_flips_is_repaired(flips in any::<u16>()) {
        let triangles: Vec<[u32; 3]> = (0u32..)
            .zip(CUBE)
            .map(|(i, [a, b, c])| if flips >> i & 1 == 1 { [a, c, b] } else { [a, b, c] })
            .collect();
        let (surface, _) = cube_of(&triangles).into_surface().unwrap();
        prop_assert_eq!(surface.volume(), 1.0);
    }
}

/// Squares of a 3 x 3 grid, two triangles each.
fn squares(kept: &[(u32, u32)]) -> MeshData {
    let corner = |x: u32, y: u32| 4 * y + x;
    let positions: Vec<[f32; 3]> = (0..16u8)
        .map(|i| [f32::from(i % 4), f32::from(i / 4), 0.0])
        .collect();
    let triangles: Vec<[u32; 3]> = kept
        .iter()
        .flat_map(|&(x, y)| {
            let (a, c) = (corner(x, y), corner(x + 1, y + 1));
            [[a, corner(x + 1, y), c], [a, c, corner(x, y + 1)]]
        })
        .collect();
    MeshData::from_triangles(&positions, &triangles).unwrap()
}

#[test]
fn an_open_mesh_is_a_surface_where_that_is_asked_for() {
    // A hole that touches the outside in a vertex: it stays whole.
    let data = squares(&[(1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)]);
    assert!(data.clone().into_surface().is_err(), "it is open");
    let (surface, warnings) = data.into_open_surface().unwrap();
    assert_eq!(surface.topology().vertices().count(), 15);
    assert_eq!(warnings, [Warning::UnusedVertices { count: 1 }]);
    // Two squares that touch in a vertex are two parts: each gets its own.
    let (surface, warnings) = squares(&[(0, 0), (1, 1)]).into_open_surface().unwrap();
    assert_eq!(surface.topology().vertices().count(), 8);
    let split = |w: &Warning| matches!(w, Warning::VerticesSplit { count: 1, .. });
    assert!(warnings.iter().any(split), "{warnings:?}");
    // What has no boundary is treated as ever.
    let flat = cube_of(&[[0, 1, 3], [0, 3, 1]]);
    assert!(matches!(
        flat.into_open_surface().unwrap_err().defects[..],
        [Defect::ZeroVolume { count: 1, .. }]
    ));
}

/// Far off the origin vertices of a thin ring round to the same places, and it is no surface any more: what to do is
/// said. Edges of three triangles near the origin have another reason.
#[test]
fn a_mesh_far_off_is_to_be_moved_to_the_origin() {
    let ring = crate::shapes::torus(0.5, 0.1, 48, 24);
    let topology = ring.topology();
    let at = |offset: f32| {
        let points = ring.positions.iter();
        let points: Vec<[f32; 3]> = points
            .map(|&[x, y, z, _]| [x, y, z].map(|x| x + offset))
            .collect();
        let triangles = topology.triangles();
        let triangles: Vec<[u32; 3]> = triangles
            .map(|t| topology.triangle(t).map(|v| v.0))
            .collect();
        MeshData::from_triangles(&points, &triangles).unwrap()
    };
    assert!(at(0.0).into_surface().is_ok());
    let mut refused = 0;
    for offset in [1e6, 2e6, 4e6] {
        let Err(refusal) = at(offset).into_surface() else {
            continue;
        };
        let Defect::NonManifoldEdge {
            rounding: Some(rounding),
            ..
        } = refusal.defects[0]
        else {
            panic!("{refusal}");
        };
        let expected = f64::from(offset) * f64::from(f32::EPSILON);
        assert!((rounding / expected - 1.0).abs() < 0.01, "{rounding}");
        let text = refusal.to_string();
        assert!(text.contains("move the mesh to the origin"), "{text}");
        refused += 1;
    }
    assert!(refused > 0, "vertices become one somewhere");
    let fin: Vec<[u32; 3]> = [&CUBE[..], &[[0, 1, 6]]].concat();
    let refusal = cube_of(&fin).into_surface().unwrap_err();
    assert!(!refusal.to_string().contains("origin"), "{refusal}");
}
