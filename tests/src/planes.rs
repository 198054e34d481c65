//! Cuts of one body along many evenly distributed planes.

use crate::{assert_caps_cover_section, assert_closed_manifold, cut_and_check};
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f64;
use incise_mesh::{Surface, Vec3};

/// Number of triangles from which tests check only the invariants of linear cost.
pub const LARGE: usize = 20_000;

/// A body of which copies are cut along planes.
#[derive(Debug, Clone, Copy)]
pub struct Planes<'a> {
    /// The body.
    pub whole: &'a Surface,
    /// True if the body does not intersect itself, so that caps cover the section once.
    pub is_embedded: bool,
    /// Checks all invariants, not only those of linear cost.
    pub all_invariants: bool,
}

impl Planes<'_> {
    /// Returns plane `i` of a fixed low-discrepancy sequence (R-sequence, Roberts 2018).
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
        let extent = normal.abs().dot(&(to_f64(bounds.max) - to_f64(bounds.min))) / 2.0;
        let d = normal.dot(&bounds.center()) + 0.95 * place * extent;
        Sweep::from_plane(normal.into(), d, &bounds)
    }

    /// Cuts a copy along plane `i` without remeshing; returns true if the plane intersects it.
    ///
    /// # Errors
    /// As [`Planes::cut_with`].
    ///
    /// # Panics
    /// If an invariant does not hold.
    pub fn cut(&self, i: usize, snap: f64) -> Result<bool, CutError> {
        let params = CutParams {
            snap,
            ..CutParams::default()
        };
        self.cut_with(i, &params)
    }

    /// Cuts a copy along plane `i`; returns true if the plane intersects it.
    ///
    /// # Errors
    /// [`CutError`]: planes go all the way through, so there should be none.
    ///
    /// # Panics
    /// If an invariant does not hold.
    pub fn cut_with(&self, i: usize, params: &CutParams) -> Result<bool, CutError> {
        let sweep = self.sweep(i)?;
        let mut surface = self.whole.clone();
        let mut cutter = Cutter::new(self.whole);
        let outcome = if self.all_invariants {
            cut_and_check(&mut surface, &mut cutter, &sweep, params)?
        } else {
            let outcome = cutter.cut(&mut surface, &sweep, params)?;
            assert_closed_manifold(&surface);
            outcome
        };
        let change = relative_change(self.whole, &surface);
        let is_exact = params.snap == 0.0 && params.remesh == 0.0;
        let bound = if is_exact { 1e-5 } else { 2e-3 };
        assert!(
            change <= bound,
            "the volume changed by {change} of itself, at most {bound} may"
        );
        if params.snap == 0.0 && self.is_embedded && !outcome.is_miss() {
            assert_caps_cover_section(self.whole, &surface, &sweep, params, &outcome);
        }
        Ok(!outcome.is_miss())
    }
}

/// Returns the change of volume relative to the sum of unsigned volumes of the pieces.
fn relative_change(before: &Surface, after: &Surface) -> f64 {
    let volumes = after.piece_volumes();
    let sum: f64 = volumes.iter().map(|v| v.abs()).sum();
    (volumes.iter().sum::<f64>() - before.volume()).abs() / sum
}
