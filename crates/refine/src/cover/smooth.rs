//! Points moved to where the sharpest angle around them is less sharp.
//!
//! A point goes to the middle of its neighbors where that helps (smart Laplacian smoothing, Freitag and
//! Ollivier-Gooch 1997), and the triangulation is made Delaunay around it again, which never makes
//! the smallest angle smaller.

use super::band::Band;
use super::cdt::{Cdt, next, orient, prev, wall};
use super::improve::{Improver, fan};
use super::lattice::Lattice;
use super::mean::mean_in;
use super::offer::{middle, sharpness};
use super::sheet::Sheet;

/// How often every point is looked at, at most.
const SWEEPS: usize = 3;
/// Points with no angle below 38 degrees around them stay.
const BLUNT: f64 = 0.62;

impl Improver {
    /// Moves the band's points that no triangle of the core is at.
    pub(crate) fn smooth(&mut self, sheet: &mut Sheet, lattice: &mut Lattice, band: &Band) {
        let cdt = &mut sheet.cdt;
        for _ in 0..SWEEPS {
            let mut moved = false;
            for (v, &point) in (band.first..).zip(&band.lattice) {
                let point = point as usize;
                let in_core = lattice.has_cell.get(point) == Some(&true);
                let is_free = |h: u32| cdt.walls[h as usize] == wall::FREE;
                if in_core || !fan(cdt, v).all(is_free) {
                    continue;
                }
                let Some(at) = self.better_place(cdt, v) else {
                    continue;
                };
                self.base.last = self.hints[v as usize];
                let Some((parents, weights)) = mean_in(&mut self.base, at) else {
                    continue;
                };
                self.hints[v as usize] = self.base.last;
                lattice.points[point] = at;
                lattice.parents[point] = parents;
                lattice.weights[point] = weights;
                cdt.points[v as usize] = at;
                let sides = fan(cdt, v).flat_map(|h| [h, next(h)]);
                self.sides.extend(sides);
                cdt.stack.append(&mut self.sides);
                cdt.legalize_all();
                moved = true;
            }
            if !moved {
                break;
            }
        }
    }

    /// Where a point has a larger smallest angle around it than where it is.
    fn better_place(&self, cdt: &Cdt, v: u32) -> Option<[f64; 2]> {
        let old = worst(cdt, v, cdt.point(v), 1.0)?;
        if old < BLUNT {
            return None;
        }
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for h in fan(cdt, v) {
            let p = cdt.point(cdt.end(h));
            sum = [sum[0] + p[0], sum[1] + p[1]];
            count += 1.0;
        }
        let center = sum.map(|x| x / count);
        [center, middle(center, cdt.point(v))]
            .into_iter()
            .find(|&at| worst(cdt, v, at, old).is_some_and(|new| new < old))
    }
}

/// The sharpest angle of the triangles around `v`, were it at `at`; none where one would turn over or be
/// sharper than `most`.
fn worst(cdt: &Cdt, v: u32, at: [f64; 2], most: f64) -> Option<f64> {
    let mut worst = -1.0f64;
    for h in fan(cdt, v) {
        let (p, q) = (cdt.point(cdt.end(h)), cdt.point(cdt.start(prev(h))));
        if orient(p, q, at) <= 0.0 {
            return None;
        }
        worst = worst.max(sharpness([p, q, at]));
        if worst > most {
            return None;
        }
    }
    Some(worst)
}
