//! Inner points of a clean sheet: the lattice's core, and what the band around it asks for.
//!
//! The core's points stay where the lattice has them. Where a section is a few triangles wide they can be what
//! keeps the triangles around them sharp; then all points are the band's, which may move them.

use super::Cover;
use super::band::Band;
use super::cdt::id;
use super::improve::Improver;
use super::lattice::Lattice;
use super::section::Rims;
use super::sheet::{INSIDE, Sheet};
use super::size::Targets;
use crate::patch::RefineError;

/// No cover has so few triangles as equilateral ones with sides of this many targets would be.
const SPARSE: f64 = 2.0;

/// What is to be filled.
pub(crate) struct Filling<'a> {
    pub(crate) rims: &'a Rims,
    pub(crate) targets: &'a Targets,
    /// The sheet's rings.
    pub(crate) group: &'a [u32],
    pub(crate) mirrored: bool,
    pub(crate) crease: bool,
    /// The most triangles.
    pub(crate) limit: usize,
}

impl Filling<'_> {
    /// Adds the core's triangles to the cover and the band's points to the sheet.
    pub(crate) fn fill(
        &self,
        sheet: &mut Sheet,
        lattice: &mut Lattice,
        band: &mut Band,
        improver: &mut Improver,
        cover: &mut Cover,
    ) -> Result<(), RefineError> {
        let (targets, limit) = (self.targets, self.limit);
        if self.is_too_fine(sheet) {
            return Err(RefineError::TooManyTriangles { limit });
        }
        improver.keep(sheet);
        let common = targets.common(&sheet.corner);
        let mark = cover.triangles.len();
        for has_core in [true, false] {
            // Every point makes two triangles more.
            let mut budget = limit / 2 + 1;
            if let Some(length) = common {
                if !lattice.fill(sheet, length, limit + sheet.corner.len()) {
                    return Err(RefineError::TooManyTriangles { limit });
                }
                if !lattice.points.is_empty() {
                    if has_core {
                        let offset = id(self.rims.ids.len() + cover.inner.len());
                        lattice.triangles(offset, &mut cover.triangles);
                    } else {
                        lattice.leave_open();
                    }
                    if band.connect(sheet, lattice) {
                        budget = 2 * sheet.corner.len() + 64;
                    } else {
                        cover.triangles.truncate(mark);
                        self.restart(sheet, lattice, band);
                    }
                }
            }
            let core = cover.triangles.len() - mark;
            improver.run(sheet, lattice, band, targets, budget, core);
            if core == 0 || !Improver::is_held(sheet, lattice, band, targets, core) {
                break;
            }
            cover.triangles.truncate(mark);
            self.restart(sheet, lattice, band);
        }
        Ok(())
    }

    /// The sheet as it was, without a lattice.
    fn restart(&self, sheet: &mut Sheet, lattice: &mut Lattice, band: &mut Band) {
        sheet.build(self.rims, self.group, self.mirrored, self.crease);
        lattice.clear();
        band.clear(sheet);
    }

    /// Whether equilateral triangles with sides of [`SPARSE`] targets would be too many already: then there is
    /// no use in making the first ones.
    #[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
    fn is_too_fine(&self, sheet: &Sheet) -> bool {
        let (cdt, targets) = (&sheet.cdt, self.targets);
        let inside = (0..cdt.triangles()).filter(|&t| cdt.region[t as usize] == INSIDE);
        let least: f64 = inside
            .map(|t| {
                // The mean of targets in a triangle. None lies deeper inside than 2 in the rims' scale.
                let [a, b, c] = cdt.corners(t).map(|v| sheet.corner[v as usize]);
                let mean = (targets.at(a) + targets.at(b) + targets.at(c)) / 3.0;
                let side = SPARSE * (mean + 2.0 * targets.grading);
                let [p, q, r] = cdt.places(t);
                let twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                twice / (0.75f64.sqrt() * side * side)
            })
            .sum();
        least > self.limit as f64
    }
}
