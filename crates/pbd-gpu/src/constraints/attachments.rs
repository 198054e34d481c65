//! Long range attachments of inextensible bodies (Kim, Chentanez and Mueller 2012).
//!
//! The distance of a vertex from a pinned vertex is at most their geodesic distance at rest. Rigid
//! edges imply this limit, so attachments do not change a converged state. One iteration propagates
//! a correction over one or two edges only; an attachment acts over any distance. Without
//! attachments, more triangles or a heavier load stretch a sheet further.

use crate::constraints::batches::StretchSet;
use crate::particles::Pin;
use incise_mesh::VertexId;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The maximum distance of a vertex from the nearest pinned vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongRangeAttachment {
    /// The free vertex.
    pub vertex: VertexId,
    /// The pinned vertex.
    pub anchor: VertexId,
    /// Their distance along edges at rest \[m\], rounded up.
    pub length: f32,
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// The attachments of a body, with scratch memory.
#[derive(Debug, Default)]
pub(crate) struct LongRangeAttachments {
    list: Vec<LongRangeAttachment>,
    is_current: bool,
    generation: u64,
    /// First edge of every vertex in `edges`, shape [vertex slots + 1].
    first: Vec<u32>,
    /// Other end and rest length \[m\] of the edges at every vertex.
    edges: Vec<(u32, f32)>,
    /// Nearest anchor of every vertex, shape [vertex slots].
    anchors: Vec<u32>,
    /// Dijkstra's queue: bits of the distance \[m\], which are ordered as it is; vertex; anchor.
    queue: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl Clone for LongRangeAttachments {
    /// Returns empty attachments; a clone computes them again when needed.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl LongRangeAttachments {
    /// Returns the attachments, nearest vertices first.
    pub(crate) fn list(&self) -> &[LongRangeAttachment] {
        &self.list
    }

    /// Returns a number that changes whenever attachments are recomputed.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.list.capacity()
            + self.first.capacity()
            + self.edges.capacity()
            + self.anchors.capacity()
            + self.queue.capacity()
    }

    /// Marks the attachments as outdated, after a change of edges or pins.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Recomputes outdated attachments: Dijkstra's algorithm from all pins, O(n log n).
    pub(crate) fn update(&mut self, stretch: &StretchSet, pins: &[Pin], vertex_slots: usize) {
        if self.is_current {
            return;
        }
        self.is_current = true;
        self.generation += 1;
        self.list.clear();
        self.collect_edges(stretch, vertex_slots);
        self.anchors.clear();
        self.anchors.resize(vertex_slots, NONE);
        self.queue.clear();
        let start = |pin: &Pin| Reverse((0, pin.vertex.0, pin.vertex.0));
        self.queue.extend(pins.iter().map(start));
        while let Some(Reverse((distance, vertex, anchor))) = self.queue.pop() {
            let v = vertex as usize;
            if self.anchors[v] != NONE {
                continue;
            }
            self.anchors[v] = anchor;
            let distance = f64::from_bits(distance);
            if vertex != anchor {
                self.list.push(LongRangeAttachment {
                    vertex: VertexId(vertex),
                    anchor: VertexId(anchor),
                    length: round_up(distance),
                });
            }
            let edges = &self.edges[self.first[v] as usize..self.first[v + 1] as usize];
            for &(to, length) in edges {
                if self.anchors[to as usize] == NONE {
                    let distance = (distance + f64::from(length)).to_bits();
                    self.queue.push(Reverse((distance, to, anchor)));
                }
            }
        }
    }

    /// Lists the edges of every vertex.
    fn collect_edges(&mut self, stretch: &StretchSet, vertex_slots: usize) {
        let first = &mut self.first;
        first.clear();
        first.resize(vertex_slots + 1, 0);
        for vertices in stretch.all().flat_map(|batch| batch.vertices()) {
            for v in vertices {
                first[v.index() + 1] += 1;
            }
        }
        for v in 0..vertex_slots {
            first[v + 1] += first[v];
        }
        self.edges.clear();
        self.edges.resize(first[vertex_slots] as usize, (NONE, 0.0));
        for batch in stretch.all() {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                for (of, to) in [(a, b), (b, a)] {
                    let next = &mut first[of.index()];
                    self.edges[*next as usize] = (to.0, rest);
                    *next += 1;
                }
            }
        }
        // Every entry is now the start of the following list.
        first.rotate_right(1);
        first[0] = 0;
    }
}

/// Returns the smallest `f32` that is not less than a distance.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the result is corrected below"
)]
fn round_up(distance: f64) -> f32 {
    let length = distance as f32;
    if f64::from(length) < distance {
        length.next_up()
    } else {
        length
    }
}
