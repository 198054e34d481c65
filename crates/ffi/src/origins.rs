//! [`Origins`]: the vertices from which the vertices of a cut surface are interpolated.

use incise::mesh::{TopologyDelta, VertexId};

/// Ids of vertices through one or more cuts: those of the input, then created ones in order.
#[derive(Debug, Default)]
pub(crate) struct Origins {
    /// Number of vertices of the input.
    pub(crate) input: u32,
    /// The id of the vertex in each slot.
    ids: Vec<u32>,
    /// Ids of the parents of each created vertex, earlier than its own.
    pub(crate) parents: Vec<[u32; 3]>,
    /// Weights of the parents; their sum is 1 within rounding.
    pub(crate) weights: Vec<[f32; 3]>,
}

impl Origins {
    /// Starts with a surface of `input` vertices without free slots.
    pub(crate) fn new(input: u32) -> Self {
        Self {
            input,
            ids: (0..input).collect(),
            ..Self::default()
        }
    }

    /// Gives ids to the vertices that an edit added.
    pub(crate) fn follow(&mut self, delta: &TopologyDelta) {
        for added in &delta.vertices_added {
            // An edit does not reuse the slots that it freed, so removed parents keep their ids.
            let parents = added.origin.weights();
            let row = parents.map(|(v, _)| self.ids.get(v.index()).copied().unwrap_or(u32::MAX));
            let slot = added.vertex.index();
            if self.ids.len() <= slot {
                self.ids.resize(slot + 1, u32::MAX);
            }
            self.ids[slot] = self
                .input
                .saturating_add(crate::memory::count(self.parents.len()));
            self.parents.push(row);
            self.weights.push(parents.map(|(_, weight)| to_f32(weight)));
        }
    }

    /// Returns the id of each vertex after the slots were renumbered by `vertex_map`.
    pub(crate) fn renumbered(&self, vertex_map: &[VertexId]) -> Vec<u32> {
        // Slots keep their order.
        let kept = vertex_map
            .iter()
            .zip(&self.ids)
            .filter(|(v, _)| !v.is_null());
        kept.map(|(_, &id)| id).collect()
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounds a weight of 0 to 1 once"
)]
fn to_f32(weight: f64) -> f32 {
    weight as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise::cut::{CutMethod, CutParams, Cutter, ExactParams, Sweep};
    use incise::mesh::icosphere;

    #[test]
    fn ids_of_two_cuts_name_earlier_vertices_and_positions_lie_between_them() {
        let mut surface = icosphere(3, 0.5);
        let before = surface.positions().to_vec();
        let mut origins = Origins::new(crate::memory::count(before.len()));
        let mut cutter = Cutter::new(&surface);
        // Without snapping no old vertex moves.
        let exact = ExactParams {
            snap: 0.0,
            remesh: 0.0,
        };
        let params = CutParams {
            method: CutMethod::Exact(exact),
            ..CutParams::default()
        };
        for normal in [[0.1, 1.0, 0.2], [1.0, 0.3, 0.1]] {
            let plane = Sweep::from_plane(normal, 0.05, &surface.bounds()).expect("a plane");
            let outcome = cutter.cut(&mut surface, &plane, &params).expect("a cut");
            origins.follow(&outcome.delta);
        }
        let (vertex_map, _) = surface.compact();
        let ids = origins.renumbered(&vertex_map);
        assert_eq!(ids.len(), surface.topology().vertex_count());
        let mut at: Vec<[f32; 3]> = before.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        for (row, weights) in origins.parents.iter().zip(&origins.weights) {
            assert!(
                row.iter().all(|&parent| (parent as usize) < at.len()),
                "{row:?}"
            );
            let point = [0, 1, 2].map(|axis| {
                let terms = row.iter().zip(weights);
                terms
                    .map(|(&parent, weight)| weight * at[parent as usize][axis])
                    .sum()
            });
            at.push(point);
        }
        for (&id, &[x, y, z, _]) in ids.iter().zip(surface.positions()) {
            let [a, b, c] = at[id as usize];
            let error = (a - x).abs().max((b - y).abs()).max((c - z).abs());
            assert!(
                error < 1e-4,
                "vertex of id {id} is {error} off its parents' mean"
            );
        }
    }
}
