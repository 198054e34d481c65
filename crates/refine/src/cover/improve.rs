//! Points inserted where a triangle is too sharp or an edge too long: in the band around a lattice, or
//! in the whole section where targets differ too much for one.
//!
//! Rims have edges much shorter and longer than the target, side by side, and no edge of them may
//! be split. So there is no guarantee to be had from Delaunay refinement as such; instead a point
//! is inserted only where the smallest angle of what it replaces is smaller than that of what it
//! makes, or where that is no sharp one; from a short edge of the rim to a long one points make a [`spiral`].
//! Triangles wait in a queue, so points come in layers from the rim
//! inward, each as far from the last as the target asks (a frontal Delaunay refinement, Engwirda and
//! Ivers 2016). Then points move, and triangles that are still sharp ask once more.

use super::band::Band;
use super::cdt::{Cdt, id, prev, wall};
use super::lattice::Lattice;
use super::mean::mean_in;
use super::offer::{Offer, REACH, Scales, base, middle, off_center, sharpness, square};
use super::sheet::{INSIDE, Sheet};
use super::size::{Bounds, Targets};
use super::smooth::Star;
use super::spiral;

/// Triangles with an inner edge longer than this many targets ask for a point.
const LONG: f64 = 1.5;
/// A point for an edge's sake may not make an angle below 30 degrees where there was none: as squares of
/// cosines, like all sharpness.
const FINE: f64 = 0.75;
/// Nor, where there is no other place but the middle of the edge, one below 20 degrees.
const FAIR: f64 = 0.88;
/// By what factor the square of the sine of the smallest angle must grow for a point to be worth it.
const GAIN: f64 = 1.1;
/// The same where triangles have one below 20 degrees: anything better will do.
const POOR: f64 = 1.0;
/// What that factor may be where triangles have an angle below 10 degrees and edges too long.
const LOSS: f64 = 0.5;
const NEEDLE: f64 = 0.97;
/// How often points are inserted and moved.
const ROUNDS: usize = 2;
/// Of this many triangles one may be sharper than was asked.
const SHARE: usize = 20;
/// Covers of more triangles than this are not looked at again: among so many those at a few bad places are no
/// more than that.
const FEW: usize = 1024;
/// No point is put on the crease nearer to another than this many targets.
const NEAR: f64 = 0.35;

/// Room for the way.
#[derive(Debug, Clone, Default)]
pub(crate) struct Improver {
    /// The triangulation before the lattice came into it, where parents are found.
    pub(super) base: Cdt,
    /// The target at each vertex.
    pub(super) targets: Vec<f64>,
    /// What sharp triangles ask for, in this round.
    pub(super) bounds: Bounds,
    queue: Vec<(u32, [u32; 3])>,
    pub(super) sides: Vec<u32>,
    /// A triangle of the base near each vertex.
    pub(super) hints: Vec<u32>,
    /// By vertex: whether something around it has changed since it was looked at.
    pub(super) stale: Vec<bool>,
    pub(super) star: Star,
    scales: Scales,
}

impl Improver {
    /// Keeps a sheet as it is before lattice points come in.
    pub(crate) fn keep(&mut self, sheet: &Sheet) {
        self.base.copy_shape(&sheet.cdt);
    }

    /// Inserts at most `budget` points into the band and moves them, in rounds. `core` triangles are none of
    /// the sheet's.
    pub(crate) fn run(
        &mut self,
        sheet: &mut Sheet,
        lattice: &mut Lattice,
        band: &mut Band,
        targets: &Targets,
        budget: usize,
        core: usize,
    ) {
        self.start(sheet, lattice, band, targets);
        let mut left = budget;
        for _ in 0..ROUNDS {
            left -= self.insert(sheet, lattice, band, targets, left);
            self.smooth(sheet, lattice, band);
            // What was moved has room for more where it was stuck.
            self.bounds.sharp = self.bounds.stuck;
        }
        let stuck = self.bounds.stuck;
        let asks = |t: u32| sharpness(sheet.cdt.places(t)) <= stuck;
        if is_much(sheet, core, targets.bounds.sharp, asks) {
            self.bounds.sharp = self.bounds.searched;
            self.insert(sheet, lattice, band, targets, left);
            self.smooth(sheet, lattice, band);
        }
    }

    /// Whether many triangles of a small cover are sharper than asked because the core's points beside them do not
    /// move.
    pub(crate) fn is_held(
        sheet: &Sheet,
        lattice: &Lattice,
        band: &Band,
        targets: &Targets,
        core: usize,
    ) -> bool {
        let is_core = |v: u32| {
            let point = v.checked_sub(band.first).map(|i| band.lattice[i as usize]);
            point.is_some_and(|point| lattice.has_cell.get(point as usize) == Some(&true))
        };
        let is_held = |t: u32| sheet.cdt.corners(t).into_iter().any(is_core);
        is_much(sheet, core, targets.bounds.sharp, is_held)
    }

    /// Makes ready for a sheet.
    fn start(&mut self, sheet: &Sheet, lattice: &Lattice, band: &Band, targets: &Targets) {
        self.scales.clear();
        self.targets.clear();
        self.bounds = targets.bounds;
        targets.along_rim(sheet, &mut self.targets);
        // Of the box's corners nothing is asked; lattice points have one target,
        self.targets.resize(sheet.cdt.points.len(), lattice.length);
        if lattice.boundary.is_empty() {
            // or what the rim's grow to on the way to them where no core keeps them in place.
            for v in band.first..id(sheet.cdt.points.len()) {
                self.targets[v as usize] = self.grown(&sheet.cdt, v, lattice.length, targets);
            }
        }
        self.stale.clear();
        self.stale.resize(sheet.cdt.points.len(), true);
        self.hints.clear();
        let base = self.base.outgoing.iter().map(|h| h / 3);
        self.hints.extend(base);
        for &point in &band.lattice {
            // A corner of the triangle that holds it.
            let corner = lattice.parents[point as usize][0];
            self.hints.push(self.hints[corner as usize]);
        }
    }

    /// Inserts points while triangles ask for them. Returns how many.
    fn insert(
        &mut self,
        sheet: &mut Sheet,
        lattice: &mut Lattice,
        band: &mut Band,
        targets: &Targets,
        budget: usize,
    ) -> usize {
        let cdt = &mut sheet.cdt;
        self.queue.clear();
        for t in 0..cdt.triangles() {
            self.ask(cdt, t);
        }
        let (mut at, mut inserted) = (0, 0);
        while at < self.queue.len() && inserted < budget {
            let (t, corners) = self.queue[at];
            at += 1;
            if cdt.corners(t) != corners {
                continue;
            }
            let middle = self.long_crease(cdt, t);
            let Some(offer) = middle.or_else(|| self.offer(cdt, t)) else {
                continue;
            };
            let v = cdt.push_point(offer.at);
            cdt.last = offer.triangle;
            let near = cdt.corners(offer.triangle)[0];
            self.base.last = self.hints[near as usize];
            // Parents come from the triangulation of the rings alone; where that fails so does
            // the point.
            let Some((parents, weights)) = mean_in(&mut self.base, offer.at) else {
                cdt.pop_point();
                continue;
            };
            if cdt.insert(v).is_err() {
                cdt.pop_point();
                continue;
            }
            inserted += 1;
            self.hints.push(self.base.last);
            band.lattice.push(id(lattice.points.len()));
            lattice.points.push(offer.at);
            lattice.parents.push(parents);
            lattice.weights.push(weights);
            let far = |i: usize| weights[i] * targets.at(sheet.corner[parents[i] as usize]);
            let far = far(0) + far(1) + far(2);
            self.targets.push(self.grown(cdt, v, far, targets));
            self.stale.push(true);
            self.touch(cdt, v);
            for h in fan(cdt, v) {
                self.ask(cdt, h / 3);
            }
        }
        inserted
    }

    /// What the target has grown to on the way from the nearest neighbor of `v`, where it is `far` a good
    /// way off the rim.
    fn grown(&self, cdt: &Cdt, v: u32, far: f64, targets: &Targets) -> f64 {
        let from = |w: u32| {
            let way = square(cdt.point(v), cdt.point(w)).sqrt();
            targets.grown(self.targets[w as usize], far, way)
        };
        fan(cdt, v)
            .map(|h| from(cdt.end(h)))
            .fold(f64::MAX, f64::min)
    }

    /// Puts a triangle in the queue if it is bad.
    fn ask(&mut self, cdt: &Cdt, t: u32) {
        if cdt.region[t as usize] == INSIDE
            && (sharpness(cdt.places(t)) > self.bounds.sharp || self.has_long_edge(cdt, t))
        {
            self.queue.push((t, cdt.corners(t)));
        }
    }

    fn offer(&mut self, cdt: &Cdt, t: u32) -> Option<Offer> {
        let p = cdt.places(t);
        let (k, side) = base(p);
        if sharpness(p) > self.bounds.sharp {
            // Among needles from rim to rim no single point makes anything better, but row after row do.
            let is_needle = sharpness(p) > NEEDLE && self.has_long_edge(cdt, t);
            let gain = if is_needle {
                LOSS
            } else if sharpness(p) > FAIR {
                POOR
            } else {
                GAIN
            };
            let is_gain = |offer: &Offer| 1.0 - offer.new > gain * (1.0 - offer.old);
            // Nearer to the short side where the usual place is no good.
            let mut usual = REACH.into_iter().filter_map(|reach| {
                let offer = self.scales.weigh(cdt, t, off_center(p, k, reach)?)?;
                is_gain(&offer).then_some(offer)
            });
            let mut best = usual.next();
            for at in spiral::points(cdt, t) {
                let offer = self.scales.weigh(cdt, t, at).filter(is_gain);
                let is_better = |offer: &Offer| best.is_none_or(|best| offer.new < best.new);
                best = offer.filter(is_better).or(best);
            }
            return best;
        }
        if !self.has_long_edge(cdt, t) {
            return None;
        }
        // Where the other two sides are as long as the target.
        let target = self.target(cdt, 3 * t + id(k));
        let far = ((target / side).powi(2) - 0.25)
            .max(REACH[1].powi(2))
            .sqrt();
        let places = [far.min(REACH[0]), f64::INFINITY].into_iter();
        let best = places
            .filter_map(|reach| off_center(p, k, reach))
            .find_map(|at| {
                let offer = self.scales.weigh(cdt, t, at)?;
                (offer.plain < offer.old.max(FINE)).then_some(offer)
            });
        best.or_else(|| {
            let sides = [3 * t, 3 * t + 1, 3 * t + 2].into_iter();
            let free = sides.filter(|&h| cdt.walls[h as usize] == wall::FREE);
            let length = |h: u32| square(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
            let h = free.max_by(|&g, &h| length(g).total_cmp(&length(h)))?;
            let at = middle(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
            let offer = self.scales.weigh(cdt, t, at)?;
            (offer.plain < offer.old.max(FAIR)).then_some(offer)
        })
    }

    /// The target of an edge: the mean of its ends'.
    fn target(&self, cdt: &Cdt, h: u32) -> f64 {
        let of = |v: u32| self.targets[v as usize];
        0.5 * of(cdt.start(h)) + 0.5 * of(cdt.end(h))
    }

    fn is_long(&self, cdt: &Cdt, h: u32) -> bool {
        square(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)))
            > (LONG * self.target(cdt, h)).powi(2)
    }

    fn has_long_edge(&self, cdt: &Cdt, t: u32) -> bool {
        [3 * t, 3 * t + 1, 3 * t + 2].into_iter().any(|h| {
            matches!(cdt.walls[h as usize], wall::FREE | wall::CREASE) && self.is_long(cdt, h)
        })
    }

    /// The middle of a triangle's side on the crease, where that side is long and the lattice left
    /// it free because a rim is near, but not too near.
    fn long_crease(&self, cdt: &Cdt, t: u32) -> Option<Offer> {
        [3 * t, 3 * t + 1, 3 * t + 2].into_iter().find_map(|h| {
            let g = cdt.twin[h as usize];
            let at = middle(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
            let near = (NEAR * self.target(cdt, h)).powi(2);
            let splits = cdt.walls[h as usize] == wall::CREASE
                && self.is_long(cdt, h)
                && [h, g].into_iter().all(|h| {
                    cdt.region[(h / 3) as usize] == INSIDE
                        && square(cdt.point(cdt.apex(h)), at) > near
                        && cdt.side(cdt.start(h), cdt.end(h), cdt.apex(h)) > 0.0
                });
            splits.then_some(Offer {
                at,
                triangle: t,
                old: 1.0,
                new: 1.0,
                plain: 1.0,
            })
        })
    }
}

/// Whether more than one in [`SHARE`] triangles of a small cover is sharper than `asked`, and no more than that
/// would be without those for which something `helps`. `core` triangles more than the sheet's are none.
fn is_much(sheet: &Sheet, core: usize, asked: f64, helps: impl Fn(u32) -> bool) -> bool {
    let cdt = &sheet.cdt;
    if cdt.triangles() as usize + core > FEW {
        return false;
    }
    let (mut all, mut sharp, mut others) = (core, 0, 0);
    for t in (0..cdt.triangles()).filter(|&t| cdt.region[t as usize] == INSIDE) {
        all += 1;
        if sharpness(cdt.places(t)) > asked {
            sharp += 1;
            others += usize::from(!helps(t));
        }
    }
    SHARE * sharp > all && SHARE * others <= all
}

/// The half-edges that leave an inner vertex.
pub(super) fn fan(cdt: &Cdt, v: u32) -> impl Iterator<Item = u32> + '_ {
    let first = cdt.outgoing[v as usize];
    std::iter::successors(Some(first), move |&h| {
        Some(cdt.twin[prev(h) as usize]).filter(|&h| h != first)
    })
}
