//! Open meshes: gaps to weld, boundaries that are allowed, merged vertices far from the origin.

use super::*;

/// A sphere of unconnected, slightly displaced triangles is reported as a gap, unlike a hole.
///
/// Welding by the reported distance closes it.
#[test]
fn nearly_coincident_vertices_are_reported() {
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
            .map(|v| crate::geometry::to_f32(ball.position(v).map(|x| x + noise())))
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
        // A warning where holes are allowed.
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
        // Each vertex becomes the first one within that distance.
        let near = |p: &[f32; 3], q: &[f32; 3]| (to_f64(*p) - to_f64(*q)).norm() <= 1.01 * gap;
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
    // Missing triangles are holes, even if every second one is missing.
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

/// Returns squares of a 3 x 3 grid, two triangles each.
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
fn boundaries_are_allowed_on_request() {
    // A hole that touches the outer boundary at a vertex, which stays whole.
    let data = squares(&[(1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)]);
    assert!(data.clone().into_surface().is_err(), "it is open");
    let (surface, warnings) = data.into_open_surface().unwrap();
    assert_eq!(surface.topology().vertices().count(), 15);
    assert_eq!(warnings, [Warning::UnusedVertices { count: 1 }]);
    // Two squares that touch at a vertex are two parts with separate vertices.
    let (surface, warnings) = squares(&[(0, 0), (1, 1)]).into_open_surface().unwrap();
    assert_eq!(surface.topology().vertices().count(), 8);
    let split = |w: &Warning| matches!(w, Warning::VerticesSplit { count: 1, .. });
    assert!(warnings.iter().any(split), "{warnings:?}");
    // A mesh without boundaries is treated as by `into_surface`.
    let flat = cube_of(&[[0, 1, 3], [0, 3, 1]]);
    assert!(matches!(
        flat.into_open_surface().unwrap_err().defects[..],
        [Defect::ZeroVolume { count: 1, .. }]
    ));
}

/// Far from the origin, vertices of a thin torus round to the same position; the error says so.
///
/// Edges of three triangles near the origin have another cause.
#[test]
fn merged_vertices_far_from_the_origin_are_reported() {
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
