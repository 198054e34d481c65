//! Graph coloring of constraints, kept up to date in place.
//!
//! Constraints of one color share no vertex, so their order within the color does not matter and they
//! can be projected at once. One mask a vertex says which colors its constraints have; a constraint
//! takes the lowest color that none of its vertices has. Adding and removing one costs O(1).
//!
//! Colors come in layers, see [`LAYERS`]. Layers are colored apart, for they are projected one after
//! another.

use incise_mesh::VertexId;

/// How many colors a layer has. What finds none of them free in layer 0 is solved one by one, after the
/// others of that layer.
pub const MAX_COLORS: usize = 64;

/// How many layers of colors there are: layer 0 for constraints between patches, which is all of them
/// in a body without patches, then one for each of three patchings. Layer `l` has the colors from
/// `l * MAX_COLORS` on.
pub const LAYERS: usize = 4;

/// The colors of the constraints of one kind around every vertex.
#[derive(Debug, Clone)]
pub(crate) struct VertexColors {
    /// Shape [layers, vertex slots].
    masks: Vec<Vec<u64>>,
}

impl VertexColors {
    /// Colors in so many layers, no vertices yet.
    pub(crate) fn new(layers: usize) -> Self {
        Self {
            masks: vec![Vec::new(); layers],
        }
    }

    /// Makes room for vertices without constraints.
    pub(crate) fn resize(&mut self, vertices: usize) {
        for masks in &mut self.masks {
            masks.resize(vertices, 0);
        }
    }

    /// Makes room for more vertices to come.
    pub(crate) fn reserve(&mut self, more: usize) {
        for masks in &mut self.masks {
            masks.reserve(more);
        }
    }

    /// Takes the lowest color of a layer that none of `vertices` has, if there is one.
    #[inline]
    pub(crate) fn claim(&mut self, layer: usize, vertices: &[VertexId]) -> Option<usize> {
        let masks = &mut self.masks[layer];
        let taken = vertices.iter().fold(0, |mask, v| mask | masks[v.index()]);
        let color = taken.trailing_ones();
        let bit = 1_u64.checked_shl(color)?;
        for v in vertices {
            masks[v.index()] |= bit;
        }
        Some(layer * MAX_COLORS + color as usize)
    }

    /// Gives a color of `vertices` back.
    #[inline]
    pub(crate) fn release(&mut self, vertices: &[VertexId], color: usize) {
        let (masks, bit) = (&mut self.masks[color / MAX_COLORS], color % MAX_COLORS);
        for v in vertices {
            masks[v.index()] &= !(1 << bit);
        }
    }

    /// The mask of every vertex in every layer, shape [layers, vertex slots].
    pub(crate) fn masks(&self) -> &[Vec<u64>] {
        &self.masks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_free_color_is_taken_and_comes_back() {
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
    fn after_the_last_color_there_is_none() {
        let mut colors = VertexColors::new(1);
        colors.resize(66);
        for i in 0..64 {
            assert_eq!(
                colors.claim(0, &[VertexId(0), VertexId(1 + i)]),
                Some(i as usize)
            );
        }
        assert_eq!(colors.claim(0, &[VertexId(0), VertexId(65)]), None);
        assert_eq!(colors.masks()[0][65], 0, "a refusal leaves no trace");
    }

    #[test]
    fn layers_know_nothing_of_each_other() {
        let mut colors = VertexColors::new(LAYERS);
        colors.resize(2);
        let edge = [0, 1].map(VertexId);
        let claimed = [1, 0, 3, 1].map(|layer| colors.claim(layer, &edge));
        assert_eq!(claimed, [Some(64), Some(0), Some(192), Some(65)]);
        colors.release(&edge, 64);
        assert_eq!(colors.masks(), [[1, 1], [2, 2], [0, 0], [1, 1]]);
    }
}
