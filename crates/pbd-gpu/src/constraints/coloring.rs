//! Greedy graph coloring of constraints, updated in place.
//!
//! Constraints of one color share no vertex, so they can be projected in parallel in any order.
//! Each vertex has a mask of the colors of its constraints; a new constraint gets the lowest color
//! that none of its vertices has. Adding and removing a constraint costs O(1).
//!
//! Layers are projected one after another and colored independently, see [`LAYERS`].

use incise_mesh::VertexId;

/// Colors per layer. Constraints without a free color in layer 0 are projected serially.
pub const MAX_COLORS: usize = 64;

/// Layers of colors: layer 0 for constraints between patches, then one for each of three patchings.
///
/// Without patches all constraints are in layer 0. Layer `l` starts at color `l * MAX_COLORS`.
pub const LAYERS: usize = 4;

/// The colors in use at every vertex, for one kind of constraint.
#[derive(Debug, Clone, Default)]
pub(crate) struct VertexColors {
    /// Shape [layers, vertex slots].
    masks: Vec<Vec<u64>>,
}

impl VertexColors {
    /// Creates masks of `layers` layers without vertices.
    pub(crate) fn new(layers: usize) -> Self {
        Self {
            masks: vec![Vec::new(); layers],
        }
    }

    /// Adds vertices without constraints, or removes the last ones.
    pub(crate) fn resize(&mut self, vertices: usize) {
        for masks in &mut self.masks {
            masks.resize(vertices, 0);
        }
    }

    /// Allocates room for more vertices.
    pub(crate) fn reserve(&mut self, more: usize) {
        for masks in &mut self.masks {
            masks.reserve(more);
        }
    }

    /// Assigns the lowest color of a layer that is free at all `vertices`, if there is one.
    #[inline]
    pub(crate) fn claim(&mut self, layer: usize, vertices: &[VertexId]) -> Option<usize> {
        let masks = self.masks[layer].as_mut_slice();
        let taken = vertices.iter().fold(0, |mask, v| mask | masks[v.index()]);
        let color = taken.trailing_ones();
        let bit = 1_u64.checked_shl(color)?;
        for v in vertices {
            masks[v.index()] |= bit;
        }
        Some(layer * MAX_COLORS + color as usize)
    }

    /// Assigns a given color if it is free at all `vertices`; returns whether it was.
    #[cfg(feature = "serde")]
    pub(crate) fn claim_color(&mut self, color: usize, vertices: &[VertexId]) -> bool {
        let (masks, bit) = (
            &mut self.masks[color / MAX_COLORS],
            1 << (color % MAX_COLORS),
        );
        let is_free = vertices.iter().all(|v| masks[v.index()] & bit == 0);
        if is_free {
            for v in vertices {
                masks[v.index()] |= bit;
            }
        }
        is_free
    }

    /// Frees a color at `vertices`.
    #[inline]
    pub(crate) fn release(&mut self, vertices: &[VertexId], color: usize) {
        let (masks, bit) = (&mut self.masks[color / MAX_COLORS], color % MAX_COLORS);
        for v in vertices {
            masks[v.index()] &= !(1 << bit);
        }
    }

    /// Returns the masks, shape [layers, vertex slots].
    pub(crate) fn masks(&self) -> &[Vec<u64>] {
        &self.masks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_free_color_is_assigned_and_freed() {
        let mut colors = VertexColors::new(1);
        colors.resize(4);
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId);
        assert_eq!(colors.claim(0, &[a, b]), Some(0));
        assert_eq!(colors.claim(0, &[b, c]), Some(1));
        assert_eq!(colors.claim(0, &[c, d]), Some(0));
        assert_eq!(colors.claim(0, &[a, d]), Some(1));
        colors.release(&[b, c], 1);
        assert_eq!(colors.masks()[0], [3, 1, 1, 3]);
        assert_eq!(colors.claim(0, &[c, b]), Some(1));
    }

    #[test]
    fn without_a_free_color_there_is_none() {
        let mut colors = VertexColors::new(1);
        colors.resize(66);
        for i in 0..64 {
            assert_eq!(
                colors.claim(0, &[VertexId(0), VertexId(1 + i)]),
                Some(i as usize)
            );
        }
        assert_eq!(colors.claim(0, &[VertexId(0), VertexId(65)]), None);
        assert_eq!(colors.masks()[0][65], 0, "nothing is changed");
    }

    #[test]
    fn layers_are_independent() {
        let mut colors = VertexColors::new(LAYERS);
        colors.resize(2);
        let edge = [0, 1].map(VertexId);
        let claimed = [1, 0, 3, 1].map(|layer| colors.claim(layer, &edge));
        assert_eq!(claimed, [Some(64), Some(0), Some(192), Some(65)]);
        colors.release(&edge, 64);
        assert_eq!(colors.masks(), [[1, 1], [2, 2], [0, 0], [1, 1]]);
    }
}
