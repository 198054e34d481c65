//! The paper's `edgeDictionary`: interior edges of a patch and the two triangles on each.
//!
//! Algorithm A2 fills it on the way, in lines 15 and 16, but only in the `else` branch and with one
//! triangle an edge. Here it is made from the triangles once they are all there.

use rustc_hash::FxHashMap;

/// Interior edges, in the order in which they were added, found by their vertices.
#[derive(Debug, Default)]
pub(crate) struct EdgeDictionary {
    slots: FxHashMap<[u32; 2], u32>,
    edges: Vec<PatchEdge>,
    /// By edge, whether it is settled.
    settled: Vec<bool>,
}

/// An interior edge: its vertices, the smaller first, and its triangles.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PatchEdge {
    pub(crate) vertices: [u32; 2],
    pub(crate) triangles: [u32; 2],
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl EdgeDictionary {
    /// The edges that two of `triangles` share, but for those that `is_fixed` names by their ends: what is not in
    /// the dictionary is not swapped.
    pub(crate) fn of(triangles: &[[u32; 3]], is_fixed: impl Fn(u32, u32) -> bool) -> Self {
        let mut sides: Vec<([u32; 2], u32)> = (0u32..)
            .zip(triangles)
            .flat_map(|(t, &[a, b, c])| [(key(a, b), t), (key(b, c), t), (key(c, a), t)])
            .collect();
        sides.sort_unstable();
        let mut dictionary = Self::default();
        for pair in sides.chunk_by(|x, y| x.0 == y.0) {
            if let [(vertices, t1), (_, t2)] = *pair
                && !is_fixed(vertices[0], vertices[1])
            {
                dictionary.add(vertices, [t1, t2]);
            }
        }
        dictionary
    }

    pub(crate) fn len(&self) -> usize {
        self.edges.len()
    }

    pub(crate) fn edge(&self, i: usize) -> PatchEdge {
        self.edges[i]
    }

    pub(crate) fn contains(&self, a: u32, b: u32) -> bool {
        self.slots.contains_key(&key(a, b))
    }

    pub(crate) fn add(&mut self, [a, b]: [u32; 2], triangles: [u32; 2]) {
        let slot = u32::try_from(self.edges.len()).expect("a patch has fewer than 2^32 edges");
        self.slots.insert(key(a, b), slot);
        self.edges.push(PatchEdge {
            vertices: key(a, b),
            triangles,
        });
        self.settled.push(false);
    }

    /// Whether nothing about the edge's triangles has changed since [`Self::settle`].
    pub(crate) fn is_settled(&self, i: usize) -> bool {
        self.settled[i]
    }

    /// Notes that edge `i` need not be looked at again while its triangles stay what they are.
    pub(crate) fn settle(&mut self, i: usize) {
        self.settled[i] = true;
    }

    /// Notes that a triangle on the edge has another third vertex, if it is an interior one.
    pub(crate) fn unsettle(&mut self, a: u32, b: u32) {
        if let Some(&slot) = self.slots.get(&key(a, b)) {
            self.settled[slot as usize] = false;
        }
    }

    /// Puts triangle `new` in the place of `old` on the edge, if it is an interior one.
    pub(crate) fn substitute(&mut self, a: u32, b: u32, old: u32, new: u32) {
        if let Some(&slot) = self.slots.get(&key(a, b)) {
            self.settled[slot as usize] = false;
            let triangles = &mut self.edges[slot as usize].triangles;
            if triangles[0] == old {
                triangles[0] = new;
            } else if triangles[1] == old {
                triangles[1] = new;
            }
        }
    }

    /// Gives edge `i` new vertices and keeps its triangles and its place in the order.
    pub(crate) fn rename(&mut self, i: usize, [a, b]: [u32; 2]) {
        let edge = &mut self.edges[i];
        let slot = self
            .slots
            .remove(&edge.vertices)
            .expect("an edge in the list is in the index");
        edge.vertices = key(a, b);
        self.slots.insert(edge.vertices, slot);
    }
}
