//! [`EdgeDictionary`]: interior edges of a triangle list, for edge flips and triangle splits.
//!
//! [`crate::holes`] refines patches with it. `section_mesh::cdt` has the flips and splits of
//! half-edge triangulations.

use incise_mesh::index_u32;
use rustc_hash::FxHashMap;

/// The interior edges of a triangle list, with the two triangles of each.
///
/// Edges are numbered in the order of their insertion, and found by their vertices. Each flip and
/// split takes O(1) on average. Methods panic on a number of no edge, and on triangles that are not
/// those of the dictionary.
///
/// ```
/// use incise_refine::EdgeDictionary;
///
/// let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
/// let mut dictionary = EdgeDictionary::from_triangles(&triangles);
/// let flip = dictionary.flip_of(0, &triangles);
/// assert_eq!((flip.ends, flip.apexes), ([2, 0], [1, 3]));
/// dictionary.flip(&flip, &mut triangles);
/// assert_eq!(triangles, [[1, 3, 0], [3, 1, 2]]);
/// assert!(dictionary.contains(1, 3) && !dictionary.contains(0, 2));
/// ```
#[derive(Debug, Clone, Default)]
pub struct EdgeDictionary {
    slots: FxHashMap<[u32; 2], u32>,
    edges: Vec<PatchEdge>,
    /// Whether each edge needs no test until one of its triangles changes.
    settled: Vec<bool>,
}

/// An interior edge.
#[derive(Debug, Clone, Copy)]
struct PatchEdge {
    /// Its ends, the smaller first.
    vertices: [u32; 2],
    /// Its two triangles.
    triangles: [u32; 2],
}

/// A flip of an interior edge, not yet applied.
#[derive(Debug, Clone, Copy)]
pub struct Flip {
    /// The edge's index in the dictionary.
    edge: usize,
    /// The indices of its two triangles.
    triangles: [u32; 2],
    /// The ends of the edge, in the direction of the first triangle.
    pub ends: [u32; 2],
    /// The corner opposite to the edge in each triangle: the ends of the new edge.
    pub apexes: [u32; 2],
}

impl Flip {
    /// Returns the two triangles that the flip would make.
    #[must_use]
    pub const fn new_triangles(&self) -> [[u32; 3]; 2] {
        let ([from, to], [c, d]) = (self.ends, self.apexes);
        [[c, d, to], [d, c, from]]
    }

    /// Returns the two triangles that the flip would replace.
    #[must_use]
    pub fn old_triangles(&self, triangles: &[[u32; 3]]) -> [[u32; 3]; 2] {
        self.triangles.map(|t| triangles[t as usize])
    }
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl EdgeDictionary {
    /// Collects the edges that two of `triangles` share.
    #[must_use]
    pub fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        let mut sides: Vec<([u32; 2], u32)> = (0u32..)
            .zip(triangles)
            .flat_map(|(t, &[a, b, c])| [(key(a, b), t), (key(b, c), t), (key(c, a), t)])
            .collect();
        sides.sort_unstable();
        let mut dictionary = Self::default();
        for pair in sides.chunk_by(|x, y| x.0 == y.0) {
            if let [(vertices, t1), (_, t2)] = *pair {
                dictionary.add(vertices, [t1, t2]);
            }
        }
        dictionary
    }

    /// Returns the number of edges.
    #[must_use]
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Returns whether no two triangles share an edge.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Returns the flip of edge `i`.
    #[must_use]
    pub fn flip_of(&self, i: usize, triangles: &[[u32; 3]]) -> Flip {
        let PatchEdge {
            vertices: [a, b],
            triangles: sides,
        } = self.edges[i];
        let [first, second] = sides.map(|t| triangles[t as usize]);
        let [x, y, z] = first;
        let is_forward = [(x, y), (y, z), (z, x)].contains(&(a, b));
        Flip {
            edge: i,
            triangles: sides,
            ends: if is_forward { [a, b] } else { [b, a] },
            apexes: [first, second].map(|t| t[0] ^ t[1] ^ t[2] ^ a ^ b),
        }
    }

    /// Flips an edge: its two triangles become [`Flip::new_triangles`], in the same slots.
    pub fn flip(&mut self, flip: &Flip, triangles: &mut [[u32; 3]]) {
        let ([from, to], [c, d]) = (flip.ends, flip.apexes);
        let [t1, t2] = flip.triangles;
        [triangles[t1 as usize], triangles[t2 as usize]] = flip.new_triangles();
        // t1 keeps the edge from `to` to c and gains d-to; t2 keeps from-d and gains c-from.
        self.unsettle(to, c);
        self.unsettle(from, d);
        self.substitute(d, to, t2, t1);
        self.substitute(c, from, t1, t2);
        self.rename(flip.edge, [c, d]);
    }

    /// Records the split of triangle `first`, with `corners`, into three around `center`.
    ///
    /// `first` keeps the side from corner 0 to 1; `second` has the next side, `second + 1` the
    /// last. The caller writes the triangles.
    pub fn split(&mut self, corners: [u32; 3], first: u32, second: u32, center: u32) {
        let ([a, b, c], third) = (corners, second + 1);
        self.unsettle(a, b);
        self.substitute(b, c, first, second);
        self.substitute(c, a, first, third);
        self.add([a, center], [first, third]);
        self.add([b, center], [first, second]);
        self.add([c, center], [second, third]);
    }

    /// Returns whether two vertices have an interior edge.
    #[must_use]
    pub fn contains(&self, a: u32, b: u32) -> bool {
        self.slots.contains_key(&key(a, b))
    }

    fn add(&mut self, [a, b]: [u32; 2], triangles: [u32; 2]) {
        let slot = index_u32(self.edges.len());
        self.slots.insert(key(a, b), slot);
        self.edges.push(PatchEdge {
            vertices: key(a, b),
            triangles,
        });
        self.settled.push(false);
    }

    /// Returns whether the edge's triangles are unchanged since [`Self::settle`].
    #[must_use]
    pub fn is_settled(&self, i: usize) -> bool {
        self.settled[i]
    }

    /// Marks edge `i` as tested, until one of its triangles changes.
    pub fn settle(&mut self, i: usize) {
        self.settled[i] = true;
    }

    /// Marks an interior edge as changed: one of its triangles has a new third vertex.
    fn unsettle(&mut self, a: u32, b: u32) {
        if let Some(&slot) = self.slots.get(&key(a, b)) {
            self.settled[slot as usize] = false;
        }
    }

    /// Replaces triangle `old` of an interior edge by `new`.
    fn substitute(&mut self, a: u32, b: u32, old: u32, new: u32) {
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

    /// Changes the ends of edge `i`, which keeps its triangles and its position in the order.
    fn rename(&mut self, i: usize, [a, b]: [u32; 2]) {
        let edge = &mut self.edges[i];
        let slot = self
            .slots
            .remove(&edge.vertices)
            .expect("an edge in the list is in the index");
        edge.vertices = key(a, b);
        self.slots.insert(edge.vertices, slot);
    }
}
