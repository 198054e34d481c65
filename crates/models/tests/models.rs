//! The built-in models compared with the paper's table, and the shapes with known properties.

use incise_mesh::geometry::corner_angles;
use incise_mesh::{EdgeKey, Surface, Vec3, cube_sphere, icosphere, torus};
use incise_models::{Model, build_model};
use std::f64::consts::PI;
use std::sync::LazyLock;

static MODELS: LazyLock<Vec<(Model, Surface)>> =
    LazyLock::new(|| Model::ALL.map(|m| (m, build_model(m))).into());

fn euler_characteristic(surface: &Surface) -> i64 {
    let t = surface.topology();
    let [v, e, f] = [t.vertices().count(), t.edges().count(), t.triangle_count()]
        .map(|n| i64::try_from(n).unwrap());
    v - e + f
}

fn smallest_angles(surface: &Surface) -> Vec<f64> {
    let of = |angles: [f64; 3]| angles.into_iter().fold(f64::INFINITY, f64::min);
    surface
        .topology()
        .triangles()
        .map(|t| of(corner_angles(surface.triangle_positions(t))).to_degrees())
        .collect()
}

#[test]
fn counts_are_those_of_the_table() {
    let table = [
        ("Sphere20", 60, 20, 12),
        ("Sphere80", 240, 80, 42),
        ("Sphere768", 515, 768, 386),
        ("Bunny", 752, 1500, 752),
        ("Octopus", 1939, 2816, 1410),
        ("Banana", 2894, 5592, 2798),
        ("Armadillo", 18_992, 30_000, 15_002),
    ];
    for ((model, surface), (name, vertices, triangles, particles)) in MODELS.iter().zip(table) {
        assert_eq!(model.name(), name);
        assert_eq!(model.vertices(), vertices, "{name}");
        assert_eq!(model.triangles(), triangles, "{name}");
        assert_eq!(model.particles(), particles, "{name}");
        assert_eq!(surface.seam_split_vertices(), vertices, "{name}");
        assert_eq!(surface.topology().triangle_count(), triangles, "{name}");
        assert_eq!(surface.topology().vertex_count(), particles, "{name}");
        assert_eq!(surface.topology().vertices().count(), particles, "{name}");
    }
}

#[test]
fn models_are_closed_and_of_one_piece_without_handles() {
    for (model, surface) in MODELS.iter() {
        let name = model.name();
        surface.validate().unwrap();
        assert!(surface.topology().is_closed(), "{name}");
        assert_eq!(euler_characteristic(surface), 2, "{name}");
        assert_eq!(surface.piece_bound(), 1, "{name}");
        assert!(surface.volume() > 0.0, "{name}");
    }
}

#[test]
fn every_vertex_lies_in_one_fan() {
    for (model, surface) in MODELS.iter() {
        let t = surface.topology();
        let corners: usize = t.vertices().map(|v| t.outgoing_fan(v).count()).sum();
        assert_eq!(corners, 3 * t.triangle_count(), "{}", model.name());
    }
}

#[test]
fn no_two_triangles_and_no_two_edges_have_the_same_vertices() {
    for (model, surface) in MODELS.iter() {
        let t = surface.topology();
        let mut triangles: Vec<_> = t
            .triangles()
            .map(|f| {
                let mut corners = t.triangle(f);
                corners.sort_unstable();
                corners
            })
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        assert_eq!(triangles.len(), model.triangles(), "{}", model.name());
        let mut edges: Vec<_> = t
            .edges()
            .map(|h| EdgeKey::new(t.origin(h), t.target(h)))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        assert_eq!(2 * edges.len(), 3 * model.triangles(), "{}", model.name());
    }
}

#[test]
fn triangles_are_well_shaped() {
    for (model, surface) in MODELS.iter() {
        let angles = smallest_angles(surface);
        let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        let name = model.name();
        assert!(least > 15.0, "{name}: the smallest angle is {least}");
        assert!(mean > 40.0, "{name}: the mean of smallest angles is {mean}");
    }
}

#[test]
fn models_have_their_size_and_place() {
    for (model, surface) in MODELS.iter() {
        let name = model.name();
        if let Model::Sphere20 | Model::Sphere80 | Model::Sphere768 = model {
            for v in surface.topology().vertices() {
                assert!((surface.position(v).norm() - 0.5).abs() < 1e-7, "{name}");
            }
        } else {
            let bounds = surface.bounds();
            assert!((bounds.diagonal() - 1.0).abs() < 1e-6, "{name}");
            assert!(bounds.center().norm() < 1e-6, "{name}");
        }
    }
}

#[test]
fn models_have_their_limbs() {
    let limbs = |model: Model, beyond: fn(Vec3) -> bool| {
        let (_, surface) = MODELS.iter().find(|(m, _)| *m == model).unwrap();
        let mut surface = surface.clone();
        let near: Vec<_> = surface
            .topology()
            .triangles()
            .filter(|&t| !surface.triangle_positions(t).into_iter().all(beyond))
            .collect();
        surface.remove_triangles(&near);
        let mut labels = surface.topology().component_labels();
        labels.retain(|&l| l != u32::MAX);
        labels.into_iter().max().map_or(0, |l| l + 1)
    };
    let arms = limbs(Model::Octopus, |p| p.x.hypot(p.z) > 0.27);
    assert_eq!(arms, 8, "arms of the octopus");
    assert_eq!(limbs(Model::Bunny, |p| p.y > 0.2), 2, "ears of the bunny");
    assert_eq!(limbs(Model::Bunny, |p| p.y < -0.32), 4, "paws of the bunny");
    let above = limbs(Model::Armadillo, |p| p.y > 0.26);
    assert_eq!(
        above, 8,
        "ears and fingers of the armadillo, without thumbs"
    );
    let below = limbs(Model::Armadillo, |p| p.y < -0.25);
    assert_eq!(below, 3, "feet and tail of the armadillo");
    assert_eq!(
        limbs(Model::Banana, |p| p.y > 0.05),
        2,
        "ends of the banana"
    );
}

#[test]
fn a_second_build_has_the_same_bits() {
    for (model, surface) in MODELS.iter() {
        let again = build_model(*model);
        let bits = |s: &Surface| -> Vec<u32> {
            s.positions()
                .iter()
                .flatten()
                .map(|c| c.to_bits())
                .collect()
        };
        assert_eq!(bits(surface), bits(&again), "{}", model.name());
        assert_eq!(*surface, again, "{}", model.name());
    }
}

#[test]
fn bits_are_the_same_on_every_machine() {
    // Checksums of the positions detect any change of a shape.
    let known = [
        0xbb04_ee0a_85db_e8a5,
        0x06af_e0e9_0322_1775,
        0x6508_2b03_cd0a_d23d,
        0x890d_4220_4668_5f94,
        0xf448_6662_ecdb_1565,
        0xc3d0_939a_0e71_2692,
        0xb726_2093_5b08_5d53,
    ];
    for ((model, surface), known) in MODELS.iter().zip(known) {
        assert_eq!(checksum(surface), known, "{}", model.name());
    }
}

/// Returns the FNV-1a hash of the bits of all positions.
fn checksum(surface: &Surface) -> u64 {
    surface
        .positions()
        .iter()
        .flatten()
        .fold(0xcbf2_9ce4_8422_2325, |hash, c| {
            (hash ^ u64::from(c.to_bits())).wrapping_mul(0x0100_0000_01b3)
        })
}

#[test]
fn models_do_not_pass_through_themselves() {
    for (model, surface) in MODELS.iter() {
        assert_eq!(self_intersections(surface), 0, "{}", model.name());
    }
}

/// Returns the number of intersecting pairs of an edge and a triangle without a common vertex.
///
/// Decides by exact signs. Pairs are found in a grid of cells and counted once for each shared
/// cell.
fn self_intersections(surface: &Surface) -> usize {
    let t = surface.topology();
    let cell = 2.0 * surface.mean_edge_length();
    let mut entries: Vec<([i64; 3], usize)> = Vec::new();
    let triangles: Vec<_> = t
        .triangles()
        .map(|f| (t.triangle(f), surface.triangle_positions(f)))
        .collect();
    for (i, (_, [a, b, c])) in triangles.iter().enumerate() {
        let low = grid_cell(a.inf(b).inf(c) / cell);
        let high = grid_cell(a.sup(b).sup(c) / cell);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    entries.push(([x, y, z], i));
                }
            }
        }
    }
    entries.sort_unstable();
    let mut count = 0;
    for group in entries.chunk_by(|a, b| a.0 == b.0) {
        for (_, i) in group {
            for (_, j) in group {
                let ((v, p), (w, q)) = (&triangles[*i], &triangles[*j]);
                count += (0..3)
                    .map(|k| (k, (k + 1) % 3))
                    .filter(|&(k, l)| !w.contains(&v[k]) && !w.contains(&v[l]))
                    .filter(|&(k, l)| meets(p[k], p[l], *q))
                    .count();
            }
        }
    }
    count
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "models are a few hundred cells wide"
)]
fn grid_cell(p: Vec3) -> [i64; 3] {
    [p.x, p.y, p.z].map(|c| c.floor() as i64)
}

/// Returns whether the segment from `p` to `q` intersects the triangle.
fn meets(p: Vec3, q: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let side = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| {
        let coord = |p: Vec3| robust::Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        robust::orient3d(coord(a), coord(b), coord(c), coord(d))
    };
    if side(a, b, c, p) * side(a, b, c, q) > 0.0 {
        return false;
    }
    let around = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    around.iter().all(|&s| s >= 0.0) || around.iter().all(|&s| s <= 0.0)
}

#[test]
fn icosphere_volume_converges_to_the_sphere() {
    let exact = 4.0 / 3.0 * PI * 8.0;
    let errors: Vec<f64> = (0..6)
        .map(|n| {
            let sphere = icosphere(n, 2.0);
            assert_eq!(sphere.topology().triangle_count(), 20 << (2 * n));
            assert_eq!(euler_characteristic(&sphere), 2);
            1.0 - sphere.volume() / exact
        })
        .collect();
    for (n, pair) in errors.windows(2).enumerate().skip(1) {
        let ratio = pair[0] / pair[1];
        assert!(
            (3.5..4.2).contains(&ratio),
            "second order: step {n} gave {ratio}"
        );
    }
    assert!(errors[5] < 2e-3, "{}", errors[5]);
}

#[test]
fn an_icosahedron_has_its_known_volume() {
    let phi = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let edge: f64 = 2.0 / (phi * phi + 1.0).sqrt();
    let exact = 5.0 / 12.0 * (3.0 + 5.0_f64.sqrt()) * edge * edge * edge;
    assert!((icosphere(0, 1.0).volume() - exact).abs() < 1e-6);
}

#[test]
fn cube_spheres_approach_the_sphere() {
    for n in [1, 2, 5, 16] {
        let sphere = cube_sphere(n, 1.0);
        let squares = 6 * (n as usize) * (n as usize);
        assert_eq!(sphere.topology().triangle_count(), 2 * squares);
        assert_eq!(sphere.topology().vertex_count(), squares + 2);
        assert_eq!(sphere.seam_split_vertices(), squares + 2);
        assert_eq!(euler_characteristic(&sphere), 2);
        sphere.topology().validate().unwrap();
    }
    assert!((cube_sphere(32, 1.0).volume() / (4.0 / 3.0 * PI) - 1.0).abs() < 2e-3);
}

#[test]
fn a_torus_has_one_handle() {
    let surface = torus(1.0, 0.3, 64, 32);
    surface.validate().unwrap();
    assert!(surface.topology().is_closed());
    assert_eq!(euler_characteristic(&surface), 0);
    let exact = 2.0 * PI * PI * 0.3 * 0.3;
    assert!((surface.volume() / exact - 1.0).abs() < 0.01);
    assert_eq!(torus(1.0, 0.3, 0, 0).topology().triangle_count(), 18);
}
