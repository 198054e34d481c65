//! Updates of a BVH over random triangles, compared with a rebuilt one and with brute force.
//!
//! Updates after cuts are tested in `incise-cut`.

use super::{Bvh, MAX_HEIGHT};
use crate::geometry::round_to_f32;
use crate::ids::index_u32;
use crate::{Aabb, Surface, TopologyDelta, TriangleId, Vec3};
use incise_test_support::random::Random;
use std::cell::Cell;

/// Returns a number from -1 to 1.
fn signed(random: &mut Random) -> f32 {
    round_to_f32(random.signed())
}

/// Returns a triangle in a random plane through the surface, larger than the surface.
fn plane(random: &mut Random, surface: &Surface) -> [[Vec3; 3]; 1] {
    let n = Vec3::from([random.signed(), random.signed(), random.signed() + 0.0005]);
    let n = n.normalize();
    let bounds = surface.bounds();
    let size = bounds.diagonal();
    let point = bounds.center() + n * (random.signed() * size / 4.0);
    let u = n.cross(&Vec3::ith(n.iamin(), 1.0)).normalize();
    let v = n.cross(&u);
    let corner = |s: f64, t: f64| point + (u * s + v * t) * size;
    [[corner(-2.0, -1.0), corner(2.0, -1.0), corner(0.0, 2.0)]]
}

/// Returns two triangles with a common edge, each about 0.2 m in size.
fn small_quad(random: &mut Random) -> [[Vec3; 3]; 2] {
    let corner = [0; 3].map(|_| signed(random));
    let to = |random: &mut Random| {
        [0, 1, 2].map(|k| corner[k] + 0.2 * signed(random) + 0.001 * k as f32)
    };
    let [a, b, c, d] = [corner, to(random), to(random), to(random)].map(crate::geometry::to_f64);
    [[a, b, d], [a, d, c]]
}

/// Returns unconnected triangles.
fn soup(random: &mut Random, triangles: usize) -> Surface {
    let mut surface = Surface::default();
    let mut delta = TopologyDelta::default();
    for _ in 0..triangles {
        add_triangle(random, &mut surface, &mut delta);
    }
    surface
}

fn add_triangle(random: &mut Random, surface: &mut Surface, delta: &mut TopologyDelta) {
    let middle = [signed(random), signed(random), signed(random)];
    let extent = [0.05, 0.05, 0.05, 1.0][random.below(4)];
    let corners = [0; 3].map(|_| {
        let p = middle.map(|x| x + extent * signed(random));
        surface.add_vertex([p[0], p[1], p[2], 1.0], p)
    });
    // Pieces are side by side, as after a cut.
    let piece = u32::from(middle[0] > 0.0);
    delta
        .triangles_added
        .push(surface.add_triangle(corners, piece).unwrap());
}

fn remove(surface: &mut Surface, triangles: &[TriangleId]) -> TopologyDelta {
    let mut delta = TopologyDelta::default();
    for &t in triangles {
        let corners = surface.topology().triangle(t);
        delta.triangles_removed.push((t, corners));
    }
    let unused = surface.remove_triangles(triangles);
    surface.remove_vertices(&unused);
    delta.vertices_removed = unused;
    delta
}

fn some_triangles(random: &mut Random, surface: &Surface, part: usize) -> Vec<TriangleId> {
    let all = surface.topology().triangles();
    all.filter(|_| random.below(100) < part).collect()
}

/// Compares a query with a test of every triangle.
fn assert_equals_brute_force<const N: usize>(bvh: &Bvh, surface: &Surface, query: &[[Vec3; 3]; N]) {
    let mut found = Vec::new();
    bvh.query(surface, *query, &mut found);
    found.sort_unstable();
    let mut expected = Vec::new();
    let mut alone = Bvh::default();
    alone.places.resize(surface.topology().triangle_slots(), 0);
    alone.nodes.resize(2, super::Node::default());
    alone.samples.resize(2, 0);
    alone.parents.push(0);
    for t in surface.topology().triangles() {
        alone.free_blocks.extend(0..index_u32(alone.blocks.len()));
        let leaf = alone.leaf(surface, std::iter::once(t));
        alone.put(0, leaf);
        alone.query(surface, *query, &mut expected);
    }
    assert_eq!(
        found, expected,
        "a query finds the same triangles as brute force"
    );
}

/// Returns the number of boxes that a query tests.
fn visits(bvh: &Bvh, surface: &Surface, query: &[[Vec3; 3]; 2]) -> usize {
    let count = Cell::new(0);
    let reach = Aabb::around(
        query
            .as_flattened()
            .iter()
            .map(|&p| crate::geometry::to_f32(p)),
    );
    let touches = |b: &Aabb| {
        count.set(count.get() + 1);
        b.overlaps(&reach)
    };
    bvh.traverse(surface, touches, &mut Vec::new());
    count.get()
}

#[test]
fn a_query_of_many_triangles_finds_what_each_of_them_finds() {
    let mut random = Random::new(3);
    for triangles in [0, 1, 5, 100, 400] {
        let surface = soup(&mut random, triangles);
        let bvh = Bvh::build(&surface);
        for quads in 1..12 {
            let mut query: Vec<[Vec3; 3]> =
                (0..quads).flat_map(|_| small_quad(&mut random)).collect();
            // A triangle without area touches nothing.
            query.push([query[0][0]; 3]);
            let mut found = Vec::new();
            bvh.query(&surface, query.iter().copied(), &mut found);
            let mut expected = Vec::new();
            for triangle in query {
                bvh.query(&surface, [triangle], &mut expected);
            }
            expected.sort_unstable();
            expected.dedup();
            assert!(quads < 11 || triangles < 100 || !found.is_empty(), "hits");
            found.sort_unstable();
            assert_eq!(found, expected, "{quads} quads, {triangles} triangles");
        }
    }
}

#[test]
fn builds_and_updates_with_any_number_of_leaves() {
    let mut random = Random::new(1);
    for triangles in (1..=100).chain((101..=400).step_by(23)) {
        for part in [0, 5, 40, 100] {
            let mut surface = soup(&mut random, triangles);
            let mut bvh = Bvh::build(&surface);
            bvh.validate(&surface).unwrap();
            let chosen = some_triangles(&mut random, &surface, part);
            let mut delta = remove(&mut surface, &chosen);
            for _ in 0..random.below(1 + triangles / 2) {
                add_triangle(&mut random, &mut surface, &mut delta);
            }
            bvh.update(&surface, &delta);
            bvh.validate(&surface)
                .unwrap_or_else(|error| panic!("{triangles} triangles, {part}%: {error}"));
            assert_equals_brute_force(&bvh, &surface, &small_quad(&mut random));
            if surface.topology().triangle_count() > 0 {
                assert_equals_brute_force(&bvh, &surface, &plane(&mut random, &surface));
            }
        }
    }
}

#[test]
fn alternating_removal_and_insertion_reuses_slots() {
    let mut random = Random::new(2);
    let surface = soup(&mut random, 300);
    let mut bvh = Bvh::build(&surface);
    let mut without = surface.clone();
    let chosen = some_triangles(&mut random, &surface, 20);
    let there = remove(&mut without, &chosen);
    let back = TopologyDelta {
        triangles_added: chosen,
        ..TopologyDelta::default()
    };
    let mut slots = (0, 0);
    for round in 0..100 {
        bvh.update(&without, &there);
        bvh.validate(&without).unwrap();
        bvh.update(&surface, &back);
        bvh.validate(&surface).unwrap();
        if round == 1 {
            slots = (bvh.nodes.len(), bvh.blocks.len());
        }
    }
    assert_eq!(
        (bvh.nodes.len(), bvh.blocks.len()),
        slots,
        "slots are used again"
    );
    assert!(
        usize::from(bvh.nodes[0].height) < 20,
        "{}",
        bvh.nodes[0].height
    );
}

#[test]
fn a_thousand_edits_keep_height_and_query_cost() {
    let mut random = Random::new(3);
    let mut surface = soup(&mut random, 3000);
    let mut bvh = Bvh::build(&surface);
    let mut peak = (0, 0);
    for round in 0..1000 {
        let mut delta = {
            let chosen = some_triangles(&mut random, &surface, 2);
            remove(&mut surface, &chosen)
        };
        while surface.topology().triangle_count() < 3000 {
            add_triangle(&mut random, &mut surface, &mut delta);
        }
        bvh.update(&surface, &delta);
        if round % 50 == 0 {
            bvh.validate(&surface).unwrap();
        }
        if round == 500 {
            peak = (bvh.nodes.len(), bvh.blocks.len());
        }
    }
    bvh.validate(&surface).unwrap();
    let fresh = Bvh::build(&surface);
    let (height, fresh_height) = (bvh.nodes[0].height, fresh.nodes[0].height);
    assert!(
        height <= fresh_height + 10,
        "{height} levels, {fresh_height} when fresh"
    );
    assert!(usize::from(height) < MAX_HEIGHT, "{height} levels");
    let slack = |x: usize| x + x / 5;
    assert!(
        bvh.nodes.len() <= slack(peak.0),
        "{} of {}",
        bvh.nodes.len(),
        peak.0
    );
    assert!(
        bvh.blocks.len() <= slack(peak.1),
        "{} of {}",
        bvh.blocks.len(),
        peak.1
    );
    let (mut old, mut new) = (0, 0);
    for _ in 0..200 {
        let query = small_quad(&mut random);
        old += visits(&bvh, &surface, &query);
        new += visits(&fresh, &surface, &query);
    }
    // Every triangle has been replaced twenty times.
    assert!(old <= 2 * new, "{old} boxes, {new} in a fresh tree");
}

/// Returns triangles at random places, each a piece of its own.
fn scattered(random: &mut Random, pieces: u32) -> Surface {
    let mut surface = Surface::default();
    for piece in 0..pieces {
        let corners = [0; 3].map(|_| {
            let p = [0; 3].map(|_| 0.01 * signed(random));
            surface.add_vertex([p[0], p[1], p[2], 1.0], p)
        });
        surface.add_triangle(corners, piece).unwrap();
    }
    scatter(random, &mut surface);
    surface
}

/// Moves every triangle, which shares no vertices, to a random place.
fn scatter(random: &mut Random, surface: &mut Surface) {
    let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
    for t in triangles {
        let to = [0; 3].map(|_| signed(random));
        let corners = surface.topology().triangle(t);
        let from = surface.positions()[corners[0].index()];
        for v in corners {
            for k in 0..3 {
                surface.positions_mut()[v.index()][k] += to[k] - from[k];
            }
        }
    }
}

#[test]
fn pieces_that_moved_are_joined_by_place_in_a_refit() {
    let mut random = Random::new(5);
    let mut surface = scattered(&mut random, 1000);
    let mut bvh = Bvh::build(&surface);
    for _ in 0..3 {
        scatter(&mut random, &mut surface);
        bvh.refit(&surface);
        bvh.validate(&surface).unwrap();
        let fresh = Bvh::build(&surface);
        let (mut old, mut new) = (0, 0);
        for _ in 0..100 {
            let query = small_quad(&mut random);
            old += visits(&bvh, &surface, &query);
            new += visits(&fresh, &surface, &query);
        }
        assert_eq!(old, new, "a refit orders pieces as a build does");
    }
}
