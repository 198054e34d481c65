//! One body and many planes, each through the whole of it.

use crate::{assert_section_is_covered, assert_sound, cut_and_check};
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::geometry::widen;
use incise_mesh::{Surface, Vec3};

/// Bodies of fewer triangles are held to every law; larger ones to those that look at each triangle once.
pub const LARGE: usize = 20_000;

/// A body that is cut by plane after plane and is whole again before the next.
#[derive(Debug, Clone, Copy)]
pub struct Planes<'a> {
    /// The body.
    pub whole: &'a Surface,
    /// Whether the body does not pass through itself, so that caps cover the section once.
    pub is_tame: bool,
    /// Whether every law is looked at.
    pub every_law: bool,
}

impl Planes<'_> {
    /// Plane number `i` of a fixed sequence (R-sequence, Roberts 2018), in which directions and places
    /// are spread evenly: no two runs and no two machines cut differently.
    ///
    /// # Errors
    /// [`CutError`] for a body without size.
    pub fn sweep(&self, i: usize) -> Result<Sweep, CutError> {
        let part = |alpha: f64| (0.5 + alpha * (i + 1) as f64).fract();
        let z = 2.0 * part(0.819_172_513_396_164_5) - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * part(0.671_043_606_703_789_2)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        let place = 2.0 * part(0.549_700_477_901_964_3) - 1.0;
        let normal = Vec3::new(radius * cos, radius * sin, z);
        let bounds = self.whole.bounds();
        let extent = normal.abs().dot(&(widen(bounds.max) - widen(bounds.min))) / 2.0;
        let d = normal.dot(&bounds.center()) + 0.95 * place * extent;
        Sweep::across_box(normal.into(), d, &bounds)
    }

    /// Cuts a copy along plane number `i` without remeshing; whether the plane met it.
    ///
    /// # Errors
    /// As [`Planes::cut_with`].
    ///
    /// # Panics
    /// When a law does not hold.
    pub fn cut(&self, i: usize, snap: f64) -> Result<bool, CutError> {
        let params = CutParams {
            snap,
            ..CutParams::default()
        };
        self.cut_with(i, &params)
    }

    /// Cuts a copy along plane number `i`; whether the plane met it.
    ///
    /// # Errors
    /// [`CutError`]: planes go all the way through, so there should be none.
    ///
    /// # Panics
    /// When a law does not hold.
    pub fn cut_with(&self, i: usize, params: &CutParams) -> Result<bool, CutError> {
        let sweep = self.sweep(i)?;
        let mut surface = self.whole.clone();
        let mut cutter = Cutter::new(self.whole);
        let outcome = if self.every_law {
            cut_and_check(&mut surface, &mut cutter, &sweep, params)?
        } else {
            let outcome = cutter.cut(&mut surface, &sweep, params)?;
            assert_sound(&surface);
            outcome
        };
        let change = relative_change(self.whole, &surface);
        let is_exact = params.snap == 0.0 && params.remesh == 0.0;
        let bound = if is_exact { 1e-5 } else { 2e-3 };
        assert!(
            change <= bound,
            "the volume changed by {change} of itself, at most {bound} may"
        );
        if params.snap == 0.0 && self.is_tame && !outcome.delta.is_empty() {
            assert_section_is_covered(self.whole, &surface, &sweep, params, &outcome);
        }
        Ok(!outcome.delta.is_empty())
    }
}

/// How much volume came or went, relative to what the pieces have without signs.
fn relative_change(before: &Surface, after: &Surface) -> f64 {
    let volumes = after.piece_volumes();
    let sum: f64 = volumes.iter().map(|v| v.abs()).sum();
    (volumes.iter().sum::<f64>() - before.volume()).abs() / sum
}
