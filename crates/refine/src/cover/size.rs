//! How long edges are to get, corner by corner.

use super::offer::square;
use super::section::Rims;
use super::sheet::Sheet;
use super::{CoverParams, FINEST};
use crate::patch::RefineError;

/// By how much the target grows with the distance from a rim whose edges are shorter, up to what is asked for.
const GROWTH: f64 = 0.5;
/// How many edges to both sides of a corner of the rim its own length is the mean of.
pub(super) const AROUND: usize = 2;
/// One lattice serves targets whose mean is no more than this times the least,
const ABOVE: f64 = 1.6;
/// and whose largest no more than this times the mean.
const BELOW: f64 = 2.0;

/// How long a cover's edges are to get.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CoverSize<'a> {
    /// As long as they come out: no inner points but where nothing else is possible.
    #[default]
    Any,
    /// This long everywhere \[m\].
    Uniform(f64),
    /// By point of the section, this long there \[m\], and in between inside. Shape
    /// [`Section::points`](super::Section::points).
    Local(&'a [f64]),
}

/// What is done about triangles as sharp as this: as squares of cosines of their smallest angle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bounds {
    /// Their corners move, where that helps.
    pub(crate) moved: f64,
    /// A point is inserted, where that helps.
    pub(crate) sharp: f64,
    /// Their corners look all around for a better place.
    pub(crate) searched: f64,
    /// A point is inserted once corners have moved.
    pub(crate) stuck: f64,
}

impl Bounds {
    /// Around the angle below which triangles ask for a point \[degrees\].
    fn new(sharp: f64) -> Self {
        let square = |degrees: f64| degrees.max(0.0).to_radians().cos().powi(2);
        Self {
            moved: square(sharp + 6.0),
            sharp: square(sharp),
            searched: square(sharp - 2.0),
            stuck: square(sharp - 7.0),
        }
    }
}

/// The targets of a section's corners, in its scale.
#[derive(Debug, Clone, Default)]
pub(crate) struct Targets {
    /// By corner; empty where any length will do.
    by_corner: Vec<f64>,
    /// By how much the target grows a length off the rim.
    pub(crate) grading: f64,
    pub(crate) bounds: Bounds,
}

impl Targets {
    /// Takes the targets in and checks them.
    pub(crate) fn read(
        &mut self,
        rims: &Rims,
        params: &CoverParams<'_>,
    ) -> Result<(), RefineError> {
        self.by_corner.clear();
        self.grading = params.grading;
        if !(params.grading >= 0.0 && params.grading.is_finite()) {
            return Err(RefineError::NegativeGrading {
                grading: params.grading,
            });
        }
        if !(0.0..=60.0).contains(&params.sharp) {
            return Err(RefineError::SharpAngle {
                degrees: params.sharp,
            });
        }
        self.bounds = Bounds::new(params.sharp);
        let scaled = |length: f64| {
            if length > 0.0 && length.is_finite() {
                // The largest float stands for all that are larger than any patch.
                Ok((length * rims.scale).clamp(4.0 * FINEST, f64::MAX))
            } else {
                Err(RefineError::NonPositiveLength { length })
            }
        };
        match params.size {
            CoverSize::Any => {}
            CoverSize::Uniform(length) => {
                self.by_corner.resize(rims.ids.len(), scaled(length)?);
            }
            CoverSize::Local(lengths) => {
                for &point in &rims.ids {
                    let length = lengths.get(point as usize);
                    let length = length.ok_or(RefineError::NoLength { point })?;
                    self.by_corner.push(scaled(*length)?);
                }
            }
        }
        Ok(())
    }

    /// Whether any length will do.
    pub(crate) fn is_any(&self) -> bool {
        self.by_corner.is_empty()
    }

    /// The target at a corner.
    pub(crate) fn at(&self, corner: u32) -> f64 {
        self.by_corner[corner as usize]
    }

    /// What a target of `near` is some way off, where it would be `far` a good way off the rim.
    pub(crate) fn grown(&self, near: f64, far: f64, way: f64) -> f64 {
        grow(near, far, way, self.grading)
    }

    /// The targets at the vertices of a sheet: what is asked for, but no more than the rim's own edges
    /// there, which stay as they are.
    pub(crate) fn along_rim(&self, sheet: &Sheet, out: &mut Vec<f64>) {
        for (v, &corner) in (0..).zip(&sheet.corner) {
            let mut at = (0..AROUND).fold(v, |v, _| sheet.before(v));
            let own = own_length(|_| {
                let from = at;
                at = sheet.next[from as usize];
                square(sheet.cdt.point(from), sheet.cdt.point(at)).sqrt()
            });
            out.push(self.at(corner).min(own));
        }
    }

    /// The one length that serves all of these corners, if there is one.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 corners")]
    pub(crate) fn common(&self, corners: &[u32]) -> Option<f64> {
        if self.is_any() || self.grading > 0.0 {
            return None;
        }
        let (mut low, mut high, mut sum) = (f64::INFINITY, 0.0f64, 0.0);
        for target in corners.iter().map(|&corner| self.at(corner)) {
            low = low.min(target);
            high = high.max(target);
            sum += target;
        }
        if low == high {
            return Some(low);
        }
        let mean = sum / corners.len() as f64;
        (mean <= ABOVE * low && high <= BELOW * mean).then_some(mean)
    }
}

/// The rim's own length at a corner: the mean of the edges around it, the first of which is number 0.
#[expect(clippy::cast_precision_loss, reason = "a handful of edges")]
pub(super) fn own_length(edge: impl FnMut(usize) -> f64) -> f64 {
    (0..2 * AROUND).map(edge).sum::<f64>() / (2 * AROUND) as f64
}

/// What a target of `near` is some way off, where it would be `far` a good way off the rim: it grows
/// quickly up to that and by `grading` after.
pub(super) fn grow(near: f64, far: f64, way: f64, grading: f64) -> f64 {
    let slow = way - ((far - near) / GROWTH).max(0.0);
    if slow < 0.0 {
        near + GROWTH * way
    } else {
        near.max(far) + grading * slow
    }
}
