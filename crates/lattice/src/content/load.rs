//! Completes and validates loaded [`Content`]: triangles and crossings are found again.

use super::{CellBox, Content, cells_around, find_crossings};
use crate::body::Body;
use crate::crossings::{Crossings, FoundCrossing};
use crate::error::InvalidLattice;

/// Limits of the work and the memory of a load, of all triangles together and of each one.
///
/// A file may claim small cells for large triangles. Those of a body stay far below the limits.
const MAX_TESTED: [u64; 2] = [1 << 28, 1 << 10];
const MAX_HELD: [u64; 2] = [1 << 26, 1 << 6];
const MAX_CROSSINGS: [u64; 2] = [1 << 24, 1 << 6];

impl Content {
    /// Completes content that was read with serde, of a body in a valid grid.
    pub(crate) fn finish_load(&mut self, body: &Body<'_>) -> Result<(), InvalidLattice> {
        let (topology, grid) = (body.surface.topology(), body.grid);
        let cell_count = grid.cell_count();
        if self.inside.len() != cell_count {
            let array = "scanlines through cells";
            return Err(InvalidLattice::Array { array });
        }
        let slots = topology.triangle_slots();
        let limit = |[all, each]: [u64; 2]| all + each * slots as u64;
        let [max_tested, max_held, max_crossings] =
            [MAX_TESTED, MAX_HELD, MAX_CROSSINGS].map(limit);
        self.triangles.clear();
        self.triangles.resize(cell_count, Vec::new());
        self.boxes.clear();
        self.boxes.resize(slots, CellBox::EMPTY);
        let mut crossings = Vec::new();
        let (mut tested, mut held) = (0, 0);
        for t in topology.triangles() {
            let corners = topology.triangle(t).map(|v| body.surface.rest_position(v));
            let [low, high] = cells_around(grid, &corners);
            let sides = [0, 1, 2].map(|k| u64::from(high[k].saturating_sub(low[k])) + 1);
            tested += sides.iter().product::<u64>();
            if tested > max_tested {
                return Err(InvalidLattice::TooManyEntries);
            }
            self.add_to_cells(grid, t, &corners, |_| held += 1);
            find_crossings(body, &corners, |axis, [i, j], passage| {
                let line = body.lines[axis].index(i, j);
                crossings.push(FoundCrossing::new(axis, line, t, passage));
            });
            if held > max_held || crossings.len() as u64 > max_crossings {
                return Err(InvalidLattice::TooManyEntries);
            }
        }
        for own in &mut self.triangles {
            own.sort_unstable();
        }
        self.crossings = Crossings::from_found(body, crossings);
        self.check_witnesses()
    }

    /// Checks that witnesses are triangles of their cells, so that there are not many of them.
    fn check_witnesses(&self) -> Result<(), InvalidLattice> {
        let is_valid = |(&cell, own): (&u32, &Vec<_>)| {
            let own: &[(incise_mesh::TriangleId, u32)] = own;
            (cell as usize) < self.triangles.len()
                && own.windows(2).all(|pair| pair[0].0 < pair[1].0)
                && own.iter().all(|own| self.holds(cell, own.0))
        };
        if self.witnesses.iter().all(is_valid) {
            Ok(())
        } else {
            let array = "triangles that depend on pieces";
            Err(InvalidLattice::Array { array })
        }
    }
}
