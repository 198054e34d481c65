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
    /// Whether each coordinate of the input is affine within rounding.
    ///
    /// Interpolation by parents and weights is then harmonic already.
    pub is_affine: [bool; 3],
    /// Number of conjugate gradient steps.
    pub steps: usize,
}

/// Interpolates `values` at the section's points over the Steiner points of its mesh.
///
/// `values` has the shape of `section.points` and any unit. Returns `None` if all coordinates are
/// an affine function of the position within `rounding` \[same unit\]. The parents and weights of
/// Steiner points then give the harmonic function.
///
/// Time is O(n^1.25) for n triangles.
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
    let fit = AffineFit::fit(section, values);
    let is_affine = fit.error.map(|error| error <= rounding);
    if is_affine == [true; 3] {
        return None;
    }
    let place = |v: u32| match (v as usize).checked_sub(n) {
        None => section.points[v as usize],
        Some(inner) => mesh.steiner_points[inner].position,
    };
    let HarmonicScratch {
        rows,
        system,
        conjugate,
        offsets,
        values: out,
    } = scratch;
    rows.read(mesh, n, place);
    offsets.clear();
    for inner in &mesh.steiner_points {
        let mean = [0, 1, 2].map(|k| {
            let part = |i: usize| inner.weights[i] * values[inner.parents[i] as usize][k];
            part(0) + part(1) + part(2)
        });
        offsets.push(minus(mean, fit.at(inner.position)));
    }
    // Relative to the affine function, a value is an unknown, or known at the rim.
    system.clear();
    for i in 0..mesh.steiner_points.len() {
        let mut right = [0.0; 3];
        for &(v, weight) in rows.of(i) {
            if let Some(j) = (v as usize).checked_sub(n) {
                system.add(index_u32(j), weight);
            } else {
                let known = minus(values[v as usize], fit.at(section.points[v as usize]));
                right = [0, 1, 2].map(|k| right[k] + f64::from(weight) * known[k]);
            }
        }
        let diagonal = rows.of(i).iter().map(|entry| f64::from(entry.1)).sum();
        system.finish_row(diagonal, right);
    }
    let steps = conjugate.solve(system, offsets);
    // Rounding and clamped weights could exceed the range of the input.
    let bounds = bounds(section, values);
    out.clear();
    for (inner, offset) in mesh.steiner_points.iter().zip(offsets.iter()) {
        let affine = fit.at(inner.position);
        out.push([0, 1, 2].map(|k| (affine[k] + offset[k]).clamp(bounds[k].0, bounds[k].1)));
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
