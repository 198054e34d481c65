//! The band between the rings and the lattice's core: lattice points on the core's boundary go into
//! the triangulation of the rings, and what lies inside the core is left out of it.

use super::cdt::{Cdt, NONE, id, wall};
use super::lattice::Lattice;
use super::order::insertion_order;
use super::sheet::{INSIDE, Sheet};
use super::wall::Laid;

/// Region of triangles that the lattice's own replace.
const CORE: u8 = 2;

/// Room for the way, and the lattice point of each vertex.
#[derive(Debug, Clone, Default)]
pub(crate) struct Band {
    /// Lattice point of vertex `first + i` of the triangulation.
    pub(crate) lattice: Vec<u32>,
    /// The first vertex that is no corner of a ring or the box.
    pub(crate) first: u32,
    vertex: Vec<u32>,
    points: Vec<[f64; 2]>,
    order: Vec<(u64, u32)>,
    queue: Vec<u32>,
}

impl Band {
    pub(crate) fn clear(&mut self, sheet: &Sheet) {
        self.lattice.clear();
        self.first = id(sheet.corner.len() + 4);
    }

    /// Inserts the band's lattice points and marks the core. Returns false where that is not
    /// possible; the sheet is of no use then.
    pub(crate) fn connect(&mut self, sheet: &mut Sheet, lattice: &Lattice) -> bool {
        self.clear(sheet);
        self.vertex.clear();
        self.vertex.resize(lattice.points.len(), NONE);
        self.points.clear();
        for (point, &p) in (0u32..).zip(&lattice.points) {
            if lattice.in_band[point as usize] {
                self.vertex[point as usize] = self.first + id(self.lattice.len());
                self.lattice.push(point);
                self.points.push(p);
                sheet.cdt.push_point(p);
            }
        }
        insertion_order(&self.points, sheet.low, sheet.high, &mut self.order);
        for &(_, i) in &self.order {
            if sheet.cdt.insert(self.first + i).is_err() {
                return false;
            }
        }
        if sheet.torn {
            sheet.follow_crease();
        }
        self.queue.clear();
        for ends in &lattice.boundary {
            let [v, w] = ends.map(|p| self.vertex[p as usize]);
            // An edge on the crease stays one; it is a wall as well.
            if let Some(h) = sheet.cdt.find(v, w) {
                if sheet.cdt.walls[h as usize] == wall::FREE {
                    sheet.cdt.mark(h, wall::CORE);
                }
                continue;
            }
            if !matches!(
                sheet.cdt.lay(v, w, wall::CORE, &mut sheet.walls),
                Laid::Done(_)
            ) {
                return false;
            }
        }
        for ends in &lattice.boundary {
            let [v, w] = ends.map(|p| self.vertex[p as usize]);
            let Some(h) = sheet.cdt.find(v, w) else {
                return false;
            };
            self.enter(&mut sheet.cdt, h);
        }
        self.flood(&mut sheet.cdt)
    }

    fn enter(&mut self, cdt: &mut Cdt, h: u32) {
        let t = h / 3;
        if cdt.region[t as usize] == INSIDE {
            cdt.region[t as usize] = CORE;
            self.queue.push(t);
        }
    }

    /// Marks everything up to the core's boundary. A rim must not be reached.
    fn flood(&mut self, cdt: &mut Cdt) -> bool {
        while let Some(t) = self.queue.pop() {
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                let wall = cdt.walls[h as usize];
                if wall == wall::RIM {
                    return false;
                }
                let crosses = wall == wall::FREE;
                if crosses {
                    let g = cdt.twin[h as usize];
                    if g == NONE {
                        return false;
                    }
                    self.enter(cdt, g);
                }
            }
        }
        true
    }
}
