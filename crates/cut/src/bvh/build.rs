//! Build from scratch: median splits along the longest side.

use super::{Bvh, LEAF_SIZE, Node};
use incise_mesh::{Aabb, Surface, TriangleId};

impl Bvh {
    /// A tree over all triangles of `surface`. O(n log n).
    #[must_use]
    pub fn build(surface: &Surface) -> Self {
        let mut bvh = Self::default();
        bvh.rebuild(surface);
        bvh
    }

    /// Builds the tree anew in the memory that it has.
    pub fn rebuild(&mut self, surface: &Surface) {
        self.nodes.clear();
        self.order.clear();
        self.corners.clear();
        self.order.extend(surface.topology().triangles());
        if self.order.is_empty() {
            return;
        }
        let mut items: Vec<(TriangleId, [f32; 3])> = self
            .order
            .iter()
            .map(|&t| (t, middle(surface, t)))
            .collect();
        self.split(&mut items, 0);
        for (slot, &(t, _)) in self.order.iter_mut().zip(&items) {
            *slot = t;
            self.corners.push(surface.topology().triangle(t));
        }
        self.refit(surface);
    }

    /// Makes the nodes over `items`, whose first stands at `first` in the final order.
    fn split(&mut self, items: &mut [(TriangleId, [f32; 3])], first: usize) {
        let node = self.nodes.len();
        let leaf = items.len() <= LEAF_SIZE;
        self.nodes.push(Node {
            bounds: Aabb::default(),
            index: id(first),
            count: if leaf { id(items.len()) } else { 0 },
        });
        if leaf {
            return;
        }
        let spread = Aabb::around(items.iter().map(|&(_, p)| p));
        let sides: [f32; 3] = std::array::from_fn(|k| spread.max[k] - spread.min[k]);
        let axis = (1..3).fold(0, |best, k| if sides[k] > sides[best] { k } else { best });
        // A multiple of the leaf size on the left fills all leaves but one.
        let half = (items.len() / 2).next_multiple_of(LEAF_SIZE);
        items.select_nth_unstable_by(half, |x, y| {
            x.1[axis].total_cmp(&y.1[axis]).then(x.0.cmp(&y.0))
        });
        let (left, right) = items.split_at_mut(half);
        self.split(left, first);
        self.nodes[node].index = id(self.nodes.len());
        self.split(right, first + half);
    }
}

fn middle(surface: &Surface, t: TriangleId) -> [f32; 3] {
    let [a, b, c] = surface
        .topology()
        .triangle(t)
        .map(|v| surface.positions[v.index()]);
    std::array::from_fn(|k| a[k] + b[k] + c[k])
}

fn id(i: usize) -> u32 {
    u32::try_from(i).expect("a surface has fewer than 2^32 triangles")
}
