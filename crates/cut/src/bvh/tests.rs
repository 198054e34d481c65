//! The tree through edits: as good as a fresh one, and no larger.

use super::{Bvh, MAX_HEIGHT, id, triangle_bounds};
use crate::{CutMethod, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TopologyDelta, TriangleId, VertexId, cube_sphere, torus};
use incise_refine::{RefineParams, RefinementLevel};
use proptest::prelude::*;
use std::cell::Cell;

/// Numbers at random (splitmix64), so that a test depends on its seed alone.
struct Random(u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) % below as u64).unwrap()
    }

    /// From -1 to 1.
    fn unit(&mut self) -> f32 {
        self.next(2001) as f32 / 1000.0 - 1.0
    }

    fn sweep(&mut self, surface: &Surface) -> Sweep {
        let n = [self.unit(), self.unit(), self.unit() + 0.0005].map(f64::from);
        let bounds = surface.bounds();
        let d = f64::from(self.unit()) * bounds.diagonal() / 4.0;
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        let center = bounds.center();
        let at = n[0] * center.x + n[1] * center.y + n[2] * center.z;
        Sweep::across_box(n, at + d * length, &bounds).unwrap()
    }

    fn small_sweep(&mut self) -> Sweep {
        let corner = [self.unit(), self.unit(), self.unit()];
        let to = |s: &mut Self| [0, 1, 2].map(|k| corner[k] + 0.2 * s.unit() + 0.001 * k as f32);
        let (a, b, c) = (to(self), to(self), to(self));
        Sweep::new([corner, a], [b, c]).unwrap()
    }
}

/// Triangles that share nothing.
fn soup(random: &mut Random, triangles: usize) -> Surface {
    let mut surface = Surface::default();
    let mut delta = TopologyDelta::default();
    for _ in 0..triangles {
        add_triangle(random, &mut surface, &mut delta);
    }
    surface
}

fn add_triangle(random: &mut Random, surface: &mut Surface, delta: &mut TopologyDelta) {
    let middle = [random.unit(), random.unit(), random.unit()];
    let extent = [0.05, 0.05, 0.05, 1.0][random.next(4)];
    let corners = [0; 3].map(|_| {
        let p = middle.map(|x| x + extent * random.unit());
        surface.add_vertex([p[0], p[1], p[2], 1.0], p)
    });
    // Pieces lie beside each other, as those of a cut do.
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
    all.filter(|_| random.next(100) < part).collect()
}

/// What a query offers is what a look at every triangle offers.
fn assert_equals_brute_force(bvh: &Bvh, surface: &Surface, sweep: &Sweep) {
    let mut found = Vec::new();
    bvh.query(surface, sweep, &mut found);
    found.sort_unstable();
    let mut expected = Vec::new();
    let mut alone = Bvh::default();
    alone.places.resize(surface.topology().triangle_slots(), 0);
    alone.nodes.resize(2, super::Node::default());
    alone.samples.resize(2, 0);
    alone.parents.push(0);
    for t in surface.topology().triangles() {
        alone.free_blocks.extend(0..id(alone.blocks.len()));
        let leaf = alone.leaf(surface, std::iter::once(t));
        alone.put(0, leaf);
        alone.query(surface, sweep, &mut expected);
    }
    assert_eq!(found, expected, "a tree and a look at every triangle");
}

/// Boxes that a query looks at.
fn visits(bvh: &Bvh, surface: &Surface, sweep: &Sweep) -> usize {
    let count = Cell::new(0);
    let reach = sweep.bounds();
    let touches = |b: &incise_mesh::Aabb| {
        count.set(count.get() + 1);
        b.overlaps(&reach)
    };
    bvh.collect(surface, touches, &mut Vec::new());
    count.get()
}

#[test]
fn any_number_of_leaves_can_be_built_and_updated() {
    let mut random = Random(1);
    for triangles in (1..=100).chain((101..=400).step_by(23)) {
        for part in [0, 5, 40, 100] {
            let mut surface = soup(&mut random, triangles);
            let mut bvh = Bvh::build(&surface);
            bvh.validate(&surface).unwrap();
            let chosen = some_triangles(&mut random, &surface, part);
            let mut delta = remove(&mut surface, &chosen);
            for _ in 0..random.next(1 + triangles / 2) {
                add_triangle(&mut random, &mut surface, &mut delta);
            }
            bvh.update(&surface, &delta);
            bvh.validate(&surface)
                .unwrap_or_else(|error| panic!("{triangles} triangles, {part}%: {error}"));
            assert_equals_brute_force(&bvh, &surface, &random.small_sweep());
            if surface.topology().triangle_count() > 0 {
                assert_equals_brute_force(&bvh, &surface, &random.sweep(&surface));
            }
        }
    }
}

#[test]
fn what_was_removed_can_come_back_and_go_again() {
    let mut random = Random(2);
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
fn a_thousand_edits_leave_a_tree_like_a_fresh_one() {
    let mut random = Random(3);
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
        let sweep = random.small_sweep();
        old += visits(&bvh, &surface, &sweep);
        new += visits(&fresh, &surface, &sweep);
    }
    // Everything has been replaced twenty times, a triangle here and there.
    assert!(old <= 2 * new, "{old} boxes, {new} in a fresh tree");
}

/// Slices are cut off again and again and move away from what is left.
#[test]
fn a_hundred_cuts_and_their_pieces_moving_apart_leave_a_tree_like_a_fresh_one() {
    let mut surface = cube_sphere(32, 1.0);
    let mut cutter = Cutter::new(&surface);
    let mut random = Random(4);
    let mut cuts = 0;
    for _ in 0..600 {
        let sweep = random.sweep(&surface);
        let params = CutParams {
            only_piece: Some(id(random.next(surface.piece_bound() as usize))),
            refine: RefineParams {
                level: RefinementLevel::Z(3.0),
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let Ok(outcome) = cutter.cut(&mut surface, &sweep, &params) else {
            continue;
        };
        if outcome.delta.is_empty() {
            continue;
        }
        cuts += 1;
        cutter.bvh().validate(&surface).unwrap();
        if cuts % 20 == 0 {
            push_apart(&mut surface);
            cutter.refit(&surface);
            cutter.bvh().validate(&surface).unwrap();
        }
    }
    assert!(cuts >= 100, "{cuts} cuts");
    let fresh = Bvh::build(&surface);
    let (height, fresh_height) = (cutter.bvh().nodes[0].height, fresh.nodes[0].height);
    assert!(
        height <= fresh_height + 10,
        "{height} levels, {fresh_height} when fresh"
    );
    let (mut old, mut new) = (0, 0);
    for _ in 0..200 {
        let sweep = random.small_sweep();
        old += visits(cutter.bvh(), &surface, &sweep);
        new += visits(&fresh, &surface, &sweep);
        assert_equals_brute_force(cutter.bvh(), &surface, &sweep);
    }
    assert!(2 * old <= 3 * new, "{old} boxes, {new} in a fresh tree");
}

/// Moves every piece away from the middle.
fn push_apart(surface: &mut Surface) {
    let count = surface.piece_bound() as usize;
    let mut sums = vec![([0.0_f32; 3], 0.0_f32); count];
    let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
    for &t in &triangles {
        let bounds = triangle_bounds(surface, surface.topology().triangle(t));
        let (sum, of) = &mut sums[surface.piece(t) as usize];
        for (k, x) in sum.iter_mut().enumerate() {
            *x += bounds.min[k];
        }
        *of += 1.0;
    }
    let mut moved = vec![false; surface.positions.len()];
    for t in triangles {
        let (sum, of) = sums[surface.piece(t) as usize];
        for v in surface.topology().triangle(t) {
            if !std::mem::replace(&mut moved[v.index()], true) {
                for (k, x) in sum.iter().enumerate() {
                    surface.positions[v.index()][k] += 0.05 * x / of;
                }
            }
        }
    }
}

fn around(surface: &Surface, v: VertexId) -> Vec<TriangleId> {
    let fan = surface.topology().outgoing_fan(v);
    fan.map(|h| h.triangle()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Cuts, moves of some vertices and of all, in any order.
    #[test]
    fn answers_equal_brute_force_whatever_happened(seed in any::<u64>(), steps in 1..12_usize) {
        let mut random = Random(seed);
        let mut surface = if seed % 2 == 0 { torus(1.0, 0.4, 24, 12) } else { cube_sphere(8, 0.9) };
        let mut cutter = Cutter::new(&surface);
        for _ in 0..steps {
            match random.next(3) {
                0 => {
                    let sweep = random.sweep(&surface);
                    let method = [CutMethod::Exact, CutMethod::Rebuild][random.next(2)];
                    let params = CutParams { method, ..CutParams::default() };
                    // A refusal changes nothing and is as good as a cut.
                    let done = cutter.cut(&mut surface, &sweep, &params);
                    cutter.bvh().validate(&surface).unwrap();
                    if let Some(undo) = done.ok().and_then(|outcome| outcome.undo)
                        && random.next(2) == 0
                    {
                        cutter.undo(&mut surface, undo).unwrap();
                    }
                }
                1 => {
                    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
                    let mut moved = Vec::new();
                    for _ in 0..random.next(9) {
                        let v = vertices[random.next(vertices.len())];
                        surface.positions[v.index()][random.next(3)] += 0.1 * random.unit();
                        moved.extend(around(&surface, v));
                    }
                    cutter.refit_moved(&surface, &moved);
                }
                _ => {
                    for p in &mut surface.positions {
                        p[random.next(3)] += 0.02 * random.unit();
                    }
                    prop_assert!(cutter.bvh().validate(&surface).is_err(), "it no longer fits");
                    cutter.refit(&surface);
                }
            }
            cutter.bvh().validate(&surface).unwrap();
            assert_equals_brute_force(cutter.bvh(), &surface, &random.sweep(&surface));
            assert_equals_brute_force(cutter.bvh(), &surface, &random.small_sweep());
        }
    }
}
