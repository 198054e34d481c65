//! Values at a rim carried on into its cover, as smoothly as can be.
//!
//! What an inner point of a cover is the mean of are corners of the triangulation of the rim alone, whose
//! triangles are as long as the section is wide: what is interpolated so has a crease along each of them.
//! The discrete harmonic function has none. At every inner point it is the mean of its neighbors with cotangent
//! weights (Pinkall and Polthier 1993), which are positive where triangles are Delaunay, as those of a cover
//! are. So no value is outside of those at the rim, and affine functions stay what they are.
//!
//! The equations are solved by conjugate gradients from the interpolated values, for the three coordinates at
//! once, until what is left cannot be seen. Each step makes the Dirichlet energy smaller, so that wherever it
//! ends there is less of it than in what is interpolated. Every sum has one order and no instruction is
//! chosen by the machine: the same bits on every one.

mod affine;
mod conjugate;
mod rows;

use crate::cover::{Cover, Section};
use affine::Affine;
use conjugate::{Conjugate, System};
use rows::Rows;

/// Memory that [`harmonic`] keeps between calls.
#[derive(Debug, Clone, Default)]
pub struct HarmonicScratch {
    rows: Rows,
    system: System,
    conjugate: Conjugate,
    /// The unknown of each inner point, none for those that are held.
    unknowns: Vec<u32>,
    /// What is unknown: values less the affine function.
    offsets: Vec<[f64; 3]>,
    values: Vec<[f64; 3]>,
}

/// What [`harmonic`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic<'a> {
    /// The values at the cover's inner points.
    pub values: &'a [[f64; 3]],
    /// By coordinate, whether what parents and weights give is harmonic: the values at the section's points are an
    /// affine function of the place within rounding, on each side of a crease.
    pub is_affine: [bool; 3],
    /// How many steps the solver took.
    pub steps: usize,
}

/// An inner point that is no unknown.
const HELD: u32 = u32::MAX;

/// The harmonic function on `cover` that has `values` at the section's points (shape: `section.points`, in any
/// unit). `None` where those are an affine function of the place within `rounding` \[of the same unit\], on
/// each side of a crease: what the inner points' parents and weights give is harmonic then.
///
/// On a crease the function is what parents and weights give: the two halves of the sheet may be at an angle in
/// the values, and remain so. Time is O(n^1.25) for n triangles.
///
/// # Panics
/// When there are not as many values as points, or `cover` is none of `section`: that is a mistake of
/// the caller, not of its input.
pub fn harmonic<'a>(
    cover: &Cover,
    section: &Section<'_>,
    values: &[[f64; 3]],
    rounding: f64,
    scratch: &'a mut HarmonicScratch,
) -> Option<Harmonic<'a>> {
    let n = section.points.len();
    assert_eq!(values.len(), n, "one value for each point of the section");
    if cover.inner.is_empty() {
        return None;
    }
    let fits = if section.crease {
        [-1.0, 1.0].map(|side| Affine::fit(section, values, |y| side * y >= 0.0))
    } else {
        [Affine::fit(section, values, |_| true); 2]
    };
    let is_affine = [0, 1, 2].map(|k| fits.iter().all(|fit| fit.error[k] <= rounding));
    if is_affine == [true; 3] {
        return None;
    }
    let side = |at: [f64; 2]| usize::from(section.crease && at[1] > 0.0);
    let place = |v: u32| match (v as usize).checked_sub(n) {
        None => section.points[v as usize],
        Some(inner) => cover.inner[inner].at,
    };
    let HarmonicScratch {
        rows,
        system,
        conjugate,
        unknowns,
        offsets,
        values: out,
    } = scratch;
    rows.read(cover, n, place);
    out.clear();
    unknowns.clear();
    offsets.clear();
    for inner in &cover.inner {
        let mean = [0, 1, 2].map(|k| {
            let part = |i: usize| inner.weights[i] * values[inner.parents[i] as usize][k];
            part(0) + part(1) + part(2)
        });
        out.push(mean);
        if section.crease && inner.at[1] == 0.0 {
            unknowns.push(HELD);
        } else {
            unknowns.push(u32::try_from(offsets.len()).expect("covers have 32-bit numbers"));
            offsets.push(minus(mean, fits[side(inner.at)].at(inner.at)));
        }
    }
    // Less the affine function of its own side, each value is an unknown, or known at the rim.
    system.clear();
    for (i, inner) in cover.inner.iter().enumerate() {
        if unknowns[i] == HELD {
            continue;
        }
        let own = side(inner.at);
        let mut right = [0.0; 3];
        for &(v, weight) in rows.of(i) {
            let at = place(v);
            let known = match (v as usize).checked_sub(n) {
                None => values[v as usize],
                Some(j) if unknowns[j] == HELD => out[j],
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
    // Rounding, and the few weights that are not what they are in a Delaunay triangulation, might lead out.
    let bounds = bounds(section, values);
    for (i, inner) in cover.inner.iter().enumerate() {
        if let Some(offset) = offsets.get(unknowns[i] as usize) {
            let affine = fits[side(inner.at)].at(inner.at);
            out[i] = [0, 1, 2].map(|k| (affine[k] + offset[k]).clamp(bounds[k].0, bounds[k].1));
        }
    }
    Some(Harmonic {
        values: out,
        is_affine,
        steps,
    })
}

/// The least and the largest value at the loops, by coordinate.
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
