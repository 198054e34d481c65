//! Triangles of the lattice, strip by strip, and the boundary of the core that they form.

use super::{Lattice, Span};
use incise_mesh::index_u32;

impl Lattice {
    /// Assigns all points to the band, without a core.
    pub(crate) fn assign_to_band(&mut self) {
        self.in_band.clear();
        self.in_band.resize(self.points.len(), true);
        self.in_core.clear();
        self.in_core.resize(self.points.len(), false);
    }

    /// Appends the core's triangles, with points numbered from `offset`, and finds its boundary.
    pub(crate) fn triangles(&mut self, offset: u32, triangles: &mut Vec<[u32; 3]>) {
        self.sides.clear();
        self.sides.resize(self.points.len(), 0);
        self.in_band.clear();
        self.in_band.resize(self.points.len(), false);
        self.in_core.clear();
        self.in_core.resize(self.points.len(), false);
        for row_at in 0..self.kept_rows.len().saturating_sub(2) {
            let odd = (self.first_row + i64::try_from(row_at).unwrap_or(0)).rem_euclid(2);
            let [from, middle, to] = [0, 1, 2].map(|k| self.kept_rows[row_at + k]);
            let mut start = middle;
            for a in from..middle {
                let lower = self.kept[a];
                while start < to && self.kept[start].columns[1] + 1 < lower.columns[0] {
                    start += 1;
                }
                for b in start..to {
                    let upper = self.kept[b];
                    if upper.columns[0] > lower.columns[1] + 1 {
                        break;
                    }
                    self.strip(lower, upper, odd, offset, triangles);
                }
            }
        }
        // A horizontal edge with a triangle on one side only is on the boundary.
        for span in &self.kept {
            let n = index_u32(usize::try_from(span.columns[1] - span.columns[0]).unwrap_or(0));
            for p in span.first..span.first + n - 1 {
                match self.sides[p as usize] {
                    1 => self.boundary.push([p, p + 1]),
                    2 => self.boundary.push([p + 1, p]),
                    _ => {}
                }
            }
        }
        for &[p, q] in &self.boundary {
            self.in_band[p as usize] = true;
            self.in_band[q as usize] = true;
        }
        for (band, cell) in self.in_band.iter_mut().zip(&self.in_core) {
            *band |= !cell;
        }
    }

    /// Appends the triangles between a span and one in the row above.
    fn strip(
        &mut self,
        lower: Span,
        upper: Span,
        odd: i64,
        offset: u32,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        // The upper right neighbor of column i is column i in an even row, i + 1 in an odd row.
        let below =
            |i: i64| lower.first + index_u32(usize::try_from(i - lower.columns[0]).unwrap_or(0));
        let above =
            |j: i64| upper.first + index_u32(usize::try_from(j - upper.columns[0]).unwrap_or(0));
        let up = [
            lower.columns[0].max(upper.columns[0] - odd),
            (lower.columns[1] - 1).min(upper.columns[1] - odd),
        ];
        let down = [
            upper.columns[0].max(lower.columns[0] - 1 + odd),
            (upper.columns[1] - 1).min(lower.columns[1] - 1 + odd),
        ];
        let (has_up, has_down) = (up[0] < up[1], down[0] < down[1]);
        if has_up {
            let (p, q) = (below(up[0]), above(up[0] + odd));
            let n = index_u32(usize::try_from(up[1] - up[0]).unwrap_or(0));
            let (p0, q0) = (p + offset, q + offset);
            triangles.extend((0..n).map(|k| [p0 + k, p0 + k + 1, q0 + k]));
            self.sides[p as usize..(p + n) as usize]
                .iter_mut()
                .for_each(|s| *s |= 1);
            self.in_core[p as usize..=(p + n) as usize].fill(true);
            self.in_core[q as usize..(q + n) as usize].fill(true);
        }
        if has_down {
            let (p, q) = (above(down[0]), below(down[0] + 1 - odd));
            let n = index_u32(usize::try_from(down[1] - down[0]).unwrap_or(0));
            let (p0, q0) = (p + offset, q + offset);
            triangles.extend((0..n).map(|k| [p0 + k + 1, p0 + k, q0 + k]));
            self.sides[p as usize..(p + n) as usize]
                .iter_mut()
                .for_each(|s| *s |= 2);
            self.in_core[p as usize..=(p + n) as usize].fill(true);
            self.in_core[q as usize..(q + n) as usize].fill(true);
        }
        if !(has_up || has_down) {
            return;
        }
        // Compare left and right ends in units of half columns.
        let left = |i: i64, odd: i64| 2 * i + odd;
        let first_up = has_up && (!has_down || left(up[0], odd) < left(down[0], 1 - odd));
        let last_up = has_up && (!has_down || left(up[1], odd) > left(down[1], 1 - odd));
        self.boundary.push(if first_up {
            [above(up[0] + odd), below(up[0])]
        } else {
            [above(down[0]), below(down[0] + 1 - odd)]
        });
        self.boundary.push(if last_up {
            [below(up[1]), above(up[1] - 1 + odd)]
        } else {
            [below(down[1] - odd), above(down[1])]
        });
    }
}
