//! Better angles in the band: points inserted where a triangle is too sharp or an edge too long.
//!
//! Rims have edges much shorter and longer than the target, side by side, and no edge of them may
//! be split. So there is no guarantee to be had from Delaunay refinement as such; instead a point
//! is inserted only where the smallest angle of what it replaces is smaller than that of what it
//! makes. The place is Üngör's off-center (Off-centers: a new type of Steiner points, 2009): the
//! circumcenter, or nearer to the short side where the circumcenter would leave a sharp triangle
//! on it again.

use super::band::Band;
use super::cdt::{Cdt, id, incircle_of, orient, wall};
use super::lattice::Lattice;
use super::mean::mean_in;
use super::sheet::{INSIDE, Sheet};

/// Triangles with a smaller angle ask for a point: the cosine of 32 degrees.
const SHARP: f64 = 0.848;
/// So do those with an inner edge longer than this many L.
const LONG: f64 = 1.6;
/// A point for an edge's sake may not make an angle below 30 degrees where there was none.
const FINE: f64 = 0.866;
/// By what factor 1 less the cosine of the smallest angle, about half the angle squared, must grow for
/// a point to be worth it.
const GAIN: f64 = 1.1;
/// No point is put on the crease nearer to another than this many L.
const NEAR: f64 = 0.35;
/// How far from the middle of the short side an off-center lies, in lengths of that side: where
/// the side is seen under 36 and under 58 degrees.
const REACH: [f64; 2] = [1.54, 0.9];

/// Room for the way.
#[derive(Debug, Clone, Default)]
pub(crate) struct Improver {
    /// The triangulation before the lattice came into it, where parents are found.
    base: Cdt,
    queue: Vec<(u32, [u32; 3])>,
    cavity: Vec<u32>,
    link: Vec<[u32; 2]>,
    stamps: Vec<u32>,
    stamp: u32,
}

/// A point that would be inserted, and what it is worth.
struct Offer {
    at: [f64; 2],
    triangle: u32,
    /// The smallest angles that are there and that would be, as cosines.
    old: f64,
    new: f64,
}

impl Improver {
    /// Keeps a sheet as it is before lattice points come in.
    pub(crate) fn keep(&mut self, sheet: &Sheet) {
        self.base.copy_shape(&sheet.cdt);
    }

    /// Inserts at most `budget` points into the band.
    pub(crate) fn run(
        &mut self,
        sheet: &mut Sheet,
        lattice: &mut Lattice,
        band: &mut Band,
        length: f64,
        budget: usize,
    ) {
        self.stamps.clear();
        self.stamp = 0;
        self.queue.clear();
        let cdt = &mut sheet.cdt;
        for t in 0..cdt.triangles() {
            self.ask(cdt, t, length);
        }
        let (mut at, mut inserted) = (0, 0);
        while at < self.queue.len() && inserted < budget {
            let (t, corners) = self.queue[at];
            at += 1;
            if cdt.corners(t) != corners {
                continue;
            }
            let middle = long_crease(cdt, t, length);
            let Some(offer) = middle.or_else(|| self.offer(cdt, t, length)) else {
                continue;
            };
            let v = cdt.push_point(offer.at);
            cdt.last = offer.triangle;
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
            band.lattice.push(id(lattice.points.len()));
            lattice.points.push(offer.at);
            lattice.parents.push(parents);
            lattice.weights.push(weights);
            let first = cdt.outgoing[v as usize];
            let mut h = first;
            loop {
                self.ask(cdt, h / 3, length);
                h = cdt.twin[super::cdt::prev(h) as usize];
                if h == first {
                    break;
                }
            }
        }
    }

    /// Puts a triangle in the queue if it is bad.
    fn ask(&mut self, cdt: &Cdt, t: u32, length: f64) {
        if cdt.region[t as usize] == INSIDE
            && (sharpness(cdt.places(t)) > SHARP || has_long_edge(cdt, t, length))
        {
            self.queue.push((t, cdt.corners(t)));
        }
    }

    fn offer(&mut self, cdt: &Cdt, t: u32, length: f64) -> Option<Offer> {
        let p = cdt.places(t);
        if sharpness(p) > SHARP {
            // Nearer to the short side where the usual place is no good.
            return REACH.into_iter().find_map(|reach| {
                let offer = self.weigh(cdt, t, off_center(p, reach)?)?;
                (1.0 - offer.new > GAIN * (1.0 - offer.old)).then_some(offer)
            });
        }
        let offer = self.weigh(cdt, t, off_center(p, f64::INFINITY)?)?;
        (has_long_edge(cdt, t, length) && offer.new < offer.old.max(FINE)).then_some(offer)
    }

    /// What a point would replace and make: the sharpest angles. `None` where a wall is in between
    /// or the point would lie on something.
    fn weigh(&mut self, cdt: &Cdt, from: u32, at: [f64; 2]) -> Option<Offer> {
        let triangle = reach(cdt, from, at)?;
        self.stamps.resize(cdt.region.len(), 0);
        self.stamp += 1;
        self.stamps[triangle as usize] = self.stamp;
        self.cavity.clear();
        self.cavity.push(triangle);
        self.link.clear();
        let (mut old, mut new) = (-1.0f64, -1.0f64);
        let mut i = 0;
        while i < self.cavity.len() {
            let t = self.cavity[i];
            i += 1;
            old = old.max(sharpness(cdt.places(t)));
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                if cdt.walls[h as usize] == wall::FREE {
                    let u = cdt.twin[h as usize] / 3;
                    if self.stamps[u as usize] == self.stamp {
                        continue;
                    }
                    if incircle_of(cdt.places(u), at) > 0.0 {
                        self.stamps[u as usize] = self.stamp;
                        self.cavity.push(u);
                        continue;
                    }
                }
                self.link.push([cdt.start(h), cdt.end(h)]);
            }
        }
        for ends in &self.link {
            let [p, q] = ends.map(|v| cdt.point(v));
            if orient(p, q, at) <= 0.0 {
                return None;
            }
            new = new.max(sharpness([p, q, at]));
        }
        Some(Offer {
            at,
            triangle,
            old,
            new,
        })
    }
}

/// The triangle that holds `at`, if no wall is on the way from triangle `t`.
fn reach(cdt: &Cdt, mut t: u32, at: [f64; 2]) -> Option<u32> {
    for _ in 0..32 {
        let out = [3 * t, 3 * t + 1, 3 * t + 2]
            .into_iter()
            .find(|&h| orient(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)), at) < 0.0);
        match out {
            None => return Some(t),
            Some(h) if cdt.walls[h as usize] != wall::FREE => return None,
            Some(h) => t = cdt.twin[h as usize] / 3,
        }
    }
    None
}

fn square(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
}

/// The cosine of a triangle's smallest angle.
fn sharpness([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let sides = [square(b, c), square(c, a), square(a, b)];
    let shortest = sides[0].min(sides[1]).min(sides[2]);
    let [x, y] = if sides[0] == shortest {
        [sides[1], sides[2]]
    } else if sides[1] == shortest {
        [sides[0], sides[2]]
    } else {
        [sides[0], sides[1]]
    };
    (x + y - shortest) / (2.0 * (x * y).sqrt())
}

fn has_long_edge(cdt: &Cdt, t: u32, length: f64) -> bool {
    let limit = (LONG * length).powi(2);
    [3 * t, 3 * t + 1, 3 * t + 2].into_iter().any(|h| {
        matches!(cdt.walls[h as usize], wall::FREE | wall::CREASE)
            && square(cdt.point(cdt.start(h)), cdt.point(cdt.end(h))) > limit
    })
}

/// The middle of a triangle's side on the crease, where that side is long and the lattice left
/// it free because a rim is near, but not too near.
fn long_crease(cdt: &Cdt, t: u32, length: f64) -> Option<Offer> {
    [3 * t, 3 * t + 1, 3 * t + 2].into_iter().find_map(|h| {
        let g = cdt.twin[h as usize];
        let (p, q) = (cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
        let at = [0.5 * p[0] + 0.5 * q[0], 0.5 * p[1] + 0.5 * q[1]];
        let splits = cdt.walls[h as usize] == wall::CREASE
            && square(p, q) > (LONG * length).powi(2)
            && [h, g].into_iter().all(|h| {
                cdt.region[(h / 3) as usize] == INSIDE
                    && square(cdt.point(cdt.apex(h)), at) > (NEAR * length).powi(2)
                    && cdt.side(cdt.start(h), cdt.end(h), cdt.apex(h)) > 0.0
            });
        splits.then_some(Offer {
            at,
            triangle: t,
            old: 1.0,
            new: 1.0,
        })
    })
}

/// The circumcenter of a triangle, or the point `reach` shortest sides off the middle of the
/// shortest where that is nearer.
fn off_center(p: [[f64; 2]; 3], reach: f64) -> Option<[f64; 2]> {
    // The shortest side first.
    let k = (0..3)
        .min_by(|&i, &j| square(p[i], p[(i + 1) % 3]).total_cmp(&square(p[j], p[(j + 1) % 3])))?;
    let [a, b, c] = [p[k], p[(k + 1) % 3], p[(k + 2) % 3]];
    let (u, w) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let double = u[0] * w[1] - u[1] * w[0];
    let base = u[0] * u[0] + u[1] * u[1];
    if !(double > 0.0 && base > 0.0) {
        return None;
    }
    // The circumcenter lies this many sides off the middle of the shortest one.
    let off = (w[0] * (w[0] - u[0]) + w[1] * (w[1] - u[1])) / (2.0 * double);
    let off = off.min(reach);
    let at = [
        a[0] + 0.5 * u[0] - off * u[1],
        a[1] + 0.5 * u[1] + off * u[0],
    ];
    (at[0].is_finite() && at[1].is_finite()).then_some(at)
}
