//! Graph coloring of constraints, kept up to date in place.
//!
//! Constraints of one color share no vertex, so their order within the color does not matter and they
//! can be projected at once. One mask a vertex says which colors its constraints have; a constraint
//! takes the lowest color that none of its vertices has. Adding and removing one costs O(1).

use incise_mesh::VertexId;

/// How many colors there are. What finds none of them free is solved one by one, after the others.
pub const MAX_COLORS: usize = 64;

/// The colors of the constraints of one kind around every vertex, shape [vertex slots].
#[derive(Debug, Clone, Default)]
pub(crate) struct VertexColors {
    masks: Vec<u64>,
}

impl VertexColors {
    /// Makes room for vertices without constraints.
    pub(crate) fn resize(&mut self, vertices: usize) {
        self.masks.resize(vertices, 0);
    }

    /// Takes the lowest color that none of `vertices` has, if there is one.
    pub(crate) fn claim(&mut self, vertices: &[VertexId]) -> Option<usize> {
        let taken = vertices
            .iter()
            .fold(0, |mask, v| mask | self.masks[v.index()]);
        let color = taken.trailing_ones();
        let bit = 1_u64.checked_shl(color)?;
        for v in vertices {
            self.masks[v.index()] |= bit;
        }
        Some(color as usize)
    }

    /// Gives a color of `vertices` back.
    pub(crate) fn release(&mut self, vertices: &[VertexId], color: usize) {
        for v in vertices {
            self.masks[v.index()] &= !(1 << color);
        }
    }

    /// The mask of every vertex.
    pub(crate) fn masks(&self) -> &[u64] {
        &self.masks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_free_color_is_taken_and_comes_back() {
        let mut colors = VertexColors::default();
        colors.resize(4);
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId);
        assert_eq!(colors.claim(&[a, b]), Some(0));
        assert_eq!(colors.claim(&[b, c]), Some(1));
        assert_eq!(colors.claim(&[c, d]), Some(0));
        assert_eq!(colors.claim(&[a, d]), Some(1));
        colors.release(&[b, c], 1);
        assert_eq!(colors.masks(), &[3, 1, 1, 3]);
        assert_eq!(colors.claim(&[c, b]), Some(1));
    }

    #[test]
    fn after_the_last_color_there_is_none() {
        let mut colors = VertexColors::default();
        colors.resize(66);
        for i in 0..64 {
            assert_eq!(
                colors.claim(&[VertexId(0), VertexId(1 + i)]),
                Some(i as usize)
            );
        }
        assert_eq!(colors.claim(&[VertexId(0), VertexId(65)]), None);
        assert_eq!(colors.masks()[65], 0, "a refusal leaves no trace");
    }
}
