//! Harmonic interpolation of rim values over a section mesh.
//!
//! Interpolation by the parents of Steiner points has creases, because the triangles of the loops
//! alone are as long as the section is wide. The discrete harmonic function has none. At every
//! Steiner point it is the mean of its neighbors with cotangent weights (Pinkall and Polthier
//! 1993), which are positive in Delaunay triangulations. It therefore stays within the values at
//! the rim and reproduces affine functions.
//!
//! Conjugate gradients start at the interpolated values and solve for three coordinates at once.
//! Each step decreases the Dirichlet energy. All sums have a fixed order, so results are
//! deterministic.

mod affine_fit;
mod conjugate_gradient;
mod cotangent_weights;

use crate::section_mesh::{Section, SectionMesh};
use affine_fit::AffineFit;
use conjugate_gradient::{ConjugateGradient, System};
use cotangent_weights::CotangentWeights;
use incise_mesh::index_u32;

/// Scratch memory that [`interpolate_harmonic`] reuses between calls.
#[derive(Debug, Clone, Default)]
pub struct HarmonicScratch {
    rows: CotangentWeights,
    system: System,
    conjugate: ConjugateGradient,
    /// Index of each Steiner point's unknown, [`FIXED`] on a crease.
    unknowns: Vec<u32>,
    /// The unknowns: values minus the affine function.
    offsets: Vec<[f64; 3]>,
    values: Vec<[f64; 3]>,
}

/// The result of [`interpolate_harmonic`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct HarmonicInterpolation<'a> {
    /// Values at the Steiner points.
    pub values: &'a [[f64; 3]],
    /// Whether each coordinate of the input is affine within rounding, on each side of a crease.
    ///
    /// Interpolation by parents and weights is then harmonic already.
    pub is_affine: [bool; 3],
    /// Number of conjugate gradient steps.
    pub steps: usize,
}

/// Marks a Steiner point with a fixed value.
const FIXED: u32 = u32::MAX;

/// Interpolates `values` at the section's points over the Steiner points of its mesh.
///
/// `values` has the shape of `section.points` and any unit. Returns `None` if all coordinates are
/// an affine function of the position within `rounding` \[same unit\], on each side of a crease.
/// The parents and weights of Steiner points then give the harmonic function.
///
/// Values on a crease are those of parents and weights, because the two halves of the section may
/// be at an angle in `values`. Time is O(n^1.25) for n triangles.
///
/// # Panics
/// If the number of values differs from the number of points, or `mesh` is not a mesh of `section`.
pub fn interpolate_harmonic<'a>(
    mesh: &SectionMesh,
    section: &Section<'_>,
    values: &[[f64; 3]],
    rounding: f64,
    scratch: &'a mut HarmonicScratch,
) -> Option<HarmonicInterpolation<'a>> {
    let n = section.points.len();
    assert_eq!(values.len(), n, "one value for each point of the section");
    if mesh.steiner_points.is_empty() {
        return None;
    }
    let fits = if section.crease {
        [-1.0, 1.0].map(|side| AffineFit::fit(section, values, |y| side * y >= 0.0))
    } else {
        [AffineFit::fit(section, values, |_| true); 2]
    };
    let is_affine = [0, 1, 2].map(|k| fits.iter().all(|fit| fit.error[k] <= rounding));
    if is_affine == [true; 3] {
        return None;
    }
    let side = |at: [f64; 2]| usize::from(section.crease && at[1] > 0.0);
    let place = |v: u32| match (v as usize).checked_sub(n) {
        None => section.points[v as usize],
        Some(inner) => mesh.steiner_points[inner].position,
    };
    let HarmonicScratch {
        rows,
        system,
        conjugate,
        unknowns,
        offsets,
        values: out,
    } = scratch;
    rows.read(mesh, n, place);
    out.clear();
    unknowns.clear();
    offsets.clear();
    for inner in &mesh.steiner_points {
        let mean = [0, 1, 2].map(|k| {
            let part = |i: usize| inner.weights[i] * values[inner.parents[i] as usize][k];
            part(0) + part(1) + part(2)
        });
        out.push(mean);
        if section.crease && inner.position[1] == 0.0 {
            unknowns.push(FIXED);
        } else {
            unknowns.push(index_u32(offsets.len()));
            offsets.push(minus(mean, fits[side(inner.position)].at(inner.position)));
        }
    }
    // Relative to the affine function of its side, a value is an unknown, or known at the rim.
    system.clear();
    for (i, inner) in mesh.steiner_points.iter().enumerate() {
        if unknowns[i] == FIXED {
            continue;
        }
        let own = side(inner.position);
        let mut right = [0.0; 3];
        for &(v, weight) in rows.of(i) {
            let at = place(v);
            let known = match (v as usize).checked_sub(n) {
                None => values[v as usize],
                Some(j) if unknowns[j] == FIXED => out[j],
                Some(j) => {
                    system.add(unknowns[j], weight);
                    if side(at) == own {
                        continue;
                    }
                    fits[side(at)].at(at)
                }
            };
            let known = minus(known, fits[own].at(at));
            right = [0, 1, 2].map(|k| right[k] + f64::from(weight) * known[k]);
        }
        let diagonal = rows.of(i).iter().map(|entry| f64::from(entry.1)).sum();
        system.finish_row(diagonal, right);
    }
    let steps = conjugate.solve(system, offsets);
    // Rounding and clamped weights could exceed the range of the input.
    let bounds = bounds(section, values);
    for (i, inner) in mesh.steiner_points.iter().enumerate() {
        if let Some(offset) = offsets.get(unknowns[i] as usize) {
            let affine = fits[side(inner.position)].at(inner.position);
            out[i] = [0, 1, 2].map(|k| (affine[k] + offset[k]).clamp(bounds[k].0, bounds[k].1));
        }
    }
    Some(HarmonicInterpolation {
        values: out,
        is_affine,
        steps,
    })
}

/// Returns the range of each coordinate's values on the loops.
fn bounds(section: &Section<'_>, values: &[[f64; 3]]) -> [(f64, f64); 3] {
    [0, 1, 2].map(|k| {
        let at_loops = section.loops.iter().flatten();
        at_loops
            .map(|&p| values[p as usize][k])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            })
    })
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}
