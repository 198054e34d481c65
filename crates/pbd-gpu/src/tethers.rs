//! Tethers: no vertex of a body that does not stretch can be farther from where it is held than the way there along
//! edges is long.
//!
//! Edges at their lengths imply it, so a tether takes nothing from a body whose constraints are met. But a correction
//! goes from edge to edge, one or two an iteration, while a tether holds at once what hangs on it: without, a fixed number
//! of iterations leaves a sheet the longer the more triangles it has, and a light one by as many lengths as its load
//! is heavier (Kim, Chentanez and Mueller 2012, "Long Range Attachments").

use crate::constraints::StretchSet;
use crate::plan::Pin;
use incise_mesh::VertexId;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A vertex and the pinned one that it is nearest to, along edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tether {
    /// The vertex, which is free to move.
    pub vertex: VertexId,
    /// The pinned one.
    pub anchor: VertexId,
    /// The way between them at rest \[m\], rounded up.
    pub length: f32,
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// The tethers of a body, and the memory that finding them takes.
#[derive(Debug, Default)]
pub(crate) struct Tethers {
    list: Vec<Tether>,
    is_current: bool,
    generation: u64,
    /// Where a vertex's edges begin in `edges`, shape [vertex slots + 1].
    first: Vec<u32>,
    /// The other end of an edge and its length at rest \[m\], both ways, by vertex.
    edges: Vec<(u32, f32)>,
    /// The anchor that a vertex is nearest to, shape [vertex slots].
    anchors: Vec<u32>,
    /// Who is reached next: the way \[m\] as bits, which are ordered as it is; the vertex; its anchor.
    next: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl Clone for Tethers {
    /// They are found again where they are needed.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Tethers {
    /// The tethers, nearest vertices first.
    pub(crate) fn list(&self) -> &[Tether] {
        &self.list
    }

    /// How often they were found.
    #[cfg(feature = "gpu")]
    pub(crate) fn generation(&self) -> u64 {
        self.generation
    }

    /// Room taken, in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.list.capacity()
            + self.first.capacity()
            + self.edges.capacity()
            + self.anchors.capacity()
            + self.next.capacity()
    }

    /// Edges or pins came or went.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Finds them again if edges or pins have changed: Dijkstra's algorithm from all pins at once, O(n log n).
    pub(crate) fn update(&mut self, stretch: &StretchSet, pins: &[Pin], vertex_slots: usize) {
        if self.is_current {
            return;
        }
        self.is_current = true;
        self.generation += 1;
        self.list.clear();
        self.collect(stretch, vertex_slots);
        self.anchors.clear();
        self.anchors.resize(vertex_slots, NONE);
        self.next.clear();
        let start = |pin: &Pin| Reverse((0, pin.vertex.0, pin.vertex.0));
        self.next.extend(pins.iter().map(start));
        while let Some(Reverse((way, vertex, anchor))) = self.next.pop() {
            let v = vertex as usize;
            if self.anchors[v] != NONE {
                continue;
            }
            self.anchors[v] = anchor;
            let way = f64::from_bits(way);
            if vertex != anchor {
                self.list.push(Tether {
                    vertex: VertexId(vertex),
                    anchor: VertexId(anchor),
                    length: rounded_up(way),
                });
            }
            let edges = &self.edges[self.first[v] as usize..self.first[v + 1] as usize];
            for &(to, length) in edges {
                if self.anchors[to as usize] == NONE {
                    let way = (way + f64::from(length)).to_bits();
                    self.next.push(Reverse((way, to, anchor)));
                }
            }
        }
    }

    /// Lists edges by vertex.
    fn collect(&mut self, stretch: &StretchSet, vertex_slots: usize) {
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
                    let place = &mut first[of.index()];
                    self.edges[*place as usize] = (to.0, rest);
                    *place += 1;
                }
            }
        }
        // Every list now begins where the one before it did.
        first.rotate_right(1);
        first[0] = 0;
    }
}

/// The least number of storage that is no less.
#[expect(clippy::cast_possible_truncation, reason = "rounding is seen to")]
fn rounded_up(way: f64) -> f32 {
    let length = way as f32;
    if f64::from(length) < way {
        length.next_up()
    } else {
        length
    }
}
