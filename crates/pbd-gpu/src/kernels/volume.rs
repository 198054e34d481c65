//! Volume: a closed piece keeps what it encloses (Mueller et al. 2007, section 4.4; multipliers as in XPBD).
//!
//! `C = V - pressure rest`. The gradient at a vertex is a sixth of the sum of `a x b` over its triangles, with `a` and `b` the
//! edges that leave it: the same for any point of reference, so that of the vertex itself is taken and nothing is lost far
//! from the origin. `V` is a third of the sum of gradient times place, as it is homogeneous of degree 3; places are seen from the
//! piece's first vertex.
//!
//! All vertices of a piece are moved at once, after sums over all of them: chunks of [`CHUNK`] vertices, each summed as a
//! tree, then the chunks by the same tree. That order is part of the kernel, so any number of threads and any device
//! sum alike.
//!
//! An incompressible piece gets back at once what a substep took from it. Of what was missing before, after a crash or
//! a change of pressure, it gets back no more than [`RECOVERY`] says: as velocities follow from displacements, it would else
//! explode. Only where more than that is missing it has to be found out when it went.

use super::block::difference;
use super::displacements::{Cell, Displacements, Exclusive, Shared};
use crate::material::VolumeProjection;
use crate::sweep::is_spread;
use crate::volumes::{PieceVolume, Spoke, VolumeSet};
use incise_mesh::Topology;
use pulp::{Arch, NullaryFnOnce};

/// How fast an incompressible piece gets back what it had not before the substep, in rest volumes [1/s].
pub(crate) const RECOVERY: f32 = 3.0;

/// Leaves of a tree.
pub(crate) const CHUNK: usize = 256;

/// The least that a thread is given, a multiple of [`CHUNK`].
const GRAIN: usize = 8 * CHUNK;

/// A sixth, of the sum of `a x b` that is the gradient; a third, of the sum of gradient times place that is the volume.
pub(crate) const SIXTH: f32 = 1.0 / 6.0;
pub(crate) const THIRD: f32 = 1.0 / 3.0;

/// What vertices say together: the sum of gradient times place, three volumes [m^3], that of `|grad C|^2 / m`, and the
/// greatest `|grad C| / m` of a vertex.
type Sums = [f32; 3];

/// Room for what is found on the way. Its content matters to nobody between calls.
#[derive(Debug, Default)]
pub(crate) struct Rings {
    /// Gradient [m^2] and inverse mass [1/kg], shape \[spokes\].
    gradients: Vec<[f32; 4]>,
    /// Shape \[chunks of the piece at hand\].
    partial: Vec<Sums>,
}

impl Rings {
    /// Room that was taken, in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.gradients.capacity() + self.partial.capacity()
    }
}

/// Where everything is during the pass.
#[derive(Debug, Clone, Copy)]
struct Places<'a> {
    x: &'a [[f32; 4]],
    d: Shared<'a>,
    topology: &'a Topology,
    /// The vertex that the piece is seen from.
    center: usize,
}

/// Projects the volume of every piece. By itself, so that the passes which every body has are compiled as if there were no others.
#[inline(never)]
pub(crate) fn volumes(
    arch: Arch,
    x: &[[f32; 4]],
    d: &mut [Cell],
    (topology, set): (&Topology, &mut VolumeSet),
    by: VolumeProjection,
    rings: &mut Rings,
) {
    for (piece, lambda) in set.pieces.iter().zip(&mut set.lambda) {
        let spokes = &set.spokes[piece.first..piece.end];
        let chunks = spokes.len().div_ceil(CHUNK);
        rings.gradients.resize(spokes.len(), [0.0; 4]);
        rings.partial.resize(chunks, [0.0; 3]);
        let Some(center) = spokes.first() else {
            continue;
        };
        let places = Places {
            x,
            d: Shared(d),
            topology,
            center: center.vertex.index(),
        };
        let sums = sum::<false>(arch, places, spokes, rings);
        let missing = (sums[0] * THIRD - by.pressure * piece.rest).abs();
        let before = if missing > by.returned * piece.rest.abs() || by.old > 0.0 {
            sum::<true>(arch, places, spokes, rings)[0]
        } else {
            sums[0]
        };
        let remembered = if by.keeps { *lambda } else { 0.0 };
        let step = step(sums, before, piece, by, remembered);
        if by.keeps {
            *lambda -= step;
        }
        apply(&mut Exclusive(d), spokes, &rings.gradients, step);
    }
}

/// Sums up a piece where it is, which leaves its gradients in `rings`; or where it was at the start of the substep.
#[inline(always)]
fn sum<const BEFORE: bool>(
    arch: Arch,
    places: Places<'_>,
    spokes: &[Spoke],
    rings: &mut Rings,
) -> Sums {
    let gather = Gather::<BEFORE> {
        places,
        spokes,
        gradients: &mut rings.gradients,
        partial: &mut rings.partial,
    };
    if is_spread(spokes.len()) {
        gather.spread(arch);
    } else {
        arch.dispatch(gather);
    }
    total_of(&rings.partial)
}

/// Gradients and sums of some chunks.
struct Gather<'a, const BEFORE: bool> {
    places: Places<'a>,
    spokes: &'a [Spoke],
    gradients: &'a mut [[f32; 4]],
    partial: &'a mut [Sums],
}

impl<const BEFORE: bool> Gather<'_, BEFORE> {
    fn spread(self, arch: Arch) {
        if self.spokes.len() < 2 * GRAIN {
            arch.dispatch(self);
            return;
        }
        let middle = (self.spokes.len() / 2).next_multiple_of(GRAIN);
        let places = self.places;
        let spokes = self.spokes.split_at(middle);
        let gradients = self.gradients.split_at_mut(middle);
        let partial = self.partial.split_at_mut(middle / CHUNK);
        let [left, right] = [
            (spokes.0, gradients.0, partial.0),
            (spokes.1, gradients.1, partial.1),
        ]
        .map(|(spokes, gradients, partial)| Self {
            places,
            spokes,
            gradients,
            partial,
        });
        rayon::join(|| left.spread(arch), || right.spread(arch));
    }
}

impl<const BEFORE: bool> NullaryFnOnce for Gather<'_, BEFORE> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let mut columns = [[0.0; CHUNK]; 3];
        let spokes = self.spokes.chunks(CHUNK);
        let gradients = self.gradients.chunks_mut(CHUNK);
        for ((spokes, gradients), partial) in spokes.zip(gradients).zip(self.partial) {
            for (i, (spoke, gradient)) in spokes.iter().zip(gradients).enumerate() {
                let (g, sums) = around::<BEFORE>(&mut self.places, spoke);
                if !BEFORE {
                    *gradient = g;
                }
                for (column, sum) in columns.iter_mut().zip(sums) {
                    column[i] = sum;
                }
            }
            *partial = tree(&mut columns, spokes.len());
        }
    }
}

/// The gradient at a spoke with its inverse mass, and what it adds to the sums.
#[inline(always)]
fn around<const BEFORE: bool>(places: &mut Places<'_>, spoke: &Spoke) -> ([f32; 4], Sums) {
    let Places {
        x,
        d,
        topology,
        center,
    } = places;
    let v = spoke.vertex.index();
    let mut moved = |i: usize| if BEFORE { [0.0; 4] } else { d.get(i) };
    let (xv, dv) = (x[v], moved(v));
    let mut edge = |i: usize| difference(xv, dv, x[i], moved(i));
    let mut a = edge(topology.target(spoke.outgoing).index());
    let mut sum = [0.0; 3];
    let mut h = spoke.outgoing;
    loop {
        let across = h.prev();
        let b = edge(topology.origin(across).index());
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
        a = b;
        h = topology.twin(across);
        if h == spoke.outgoing {
            break;
        }
    }
    let [gx, gy, gz] = sum.map(|c| c * SIXTH);
    // From the vertex to the center, so that the sum gets the other sign.
    let back = edge(*center);
    let w = xv[3];
    let square = gx * gx + gy * gy + gz * gz;
    let place = gx * back[0] + gy * back[1] + gz * back[2];
    ([gx, gy, gz, w], [-place, w * square, w * square.sqrt()])
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The sums of the first so many leaves; the others count as 0.
#[inline(always)]
fn tree(columns: &mut [[f32; CHUNK]; 3], leaves: usize) -> Sums {
    let mut width = leaves.next_power_of_two();
    for column in columns.iter_mut() {
        column[leaves..width].fill(0.0);
    }
    while width > 1 {
        width /= 2;
        let [place, weight, most] = columns;
        for column in [place, weight] {
            let (low, high) = column.split_at_mut(width);
            for (low, high) in low.iter_mut().zip(high) {
                *low += *high;
            }
        }
        let (low, high) = most.split_at_mut(width);
        for (low, high) in low.iter_mut().zip(high) {
            *low = greater(*low, *high);
        }
    }
    [0, 1, 2].map(|k| columns[k][0])
}

/// The sums of all chunks: leaf i is that of chunk i, i + [`CHUNK`] and so on.
#[inline(always)]
fn total_of(partial: &[Sums]) -> Sums {
    if let [only] = partial {
        return *only;
    }
    let mut columns = [[0.0; CHUNK]; 3];
    for row in partial.chunks(CHUNK) {
        for (i, [place, weight, most]) in row.iter().enumerate() {
            columns[0][i] += place;
            columns[1][i] += weight;
            columns[2][i] = greater(columns[2][i], *most);
        }
    }
    tree(&mut columns, partial.len().min(CHUNK))
}

/// How far to go against the gradients: by how much the multiplier shrinks.
#[inline(always)]
fn step(
    [now, weight, most]: Sums,
    before: f32,
    piece: &PieceVolume,
    by: VolumeProjection,
    lambda: f32,
) -> f32 {
    let size = piece.rest.abs();
    let goal = by.pressure * piece.rest;
    let error = now * THIRD - goal;
    let before = before * THIRD - goal;
    let returned = by.returned * size;
    let mut left = 0.0;
    if error > returned || error < -returned {
        left = if before > returned {
            before - returned
        } else {
            left
        };
        left = if before < -returned {
            before + returned
        } else {
            left
        };
    }
    let kept = by.old * before;
    left = if kept.abs() > left.abs() { kept } else { left };
    let alpha = by.alpha * size;
    let wish = (error - left) + alpha * lambda;
    let sum = by.own_weight * weight + alpha;
    let under = if weight > sum { weight } else { sum };
    let limit = piece.reach / most;
    let mut wanted = wish / under;
    wanted = if wanted > limit { limit } else { wanted };
    wanted = if wanted < -limit { -limit } else { wanted };
    if weight > 0.0 && most > 0.0 {
        wanted
    } else {
        0.0
    }
}

#[inline(always)]
fn apply(d: &mut impl Displacements, spokes: &[Spoke], gradients: &[[f32; 4]], step: f32) {
    for (spoke, &[gx, gy, gz, w]) in spokes.iter().zip(gradients) {
        let v = spoke.vertex.index();
        let by = -(w * step);
        let mut dv = d.get(v);
        dv[0] += by * gx;
        dv[1] += by * gy;
        dv[2] += by * gz;
        d.set(v, dv);
    }
}
