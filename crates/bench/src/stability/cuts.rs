//! Random cuts of bodies, for other cases.

use super::error::StressError;
use super::runner::Body;
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3};

/// Returns the pieces of a surface.
pub(super) fn pieces(surface: &Surface) -> Vec<u32> {
    let numbers = 0..surface.piece_bound();
    numbers
        .filter(|&p| surface.piece_triangles(p) > 0)
        .collect()
}

/// Returns a random whole number below `count`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a number that is not negative"
)]
pub(super) fn below(directions: &mut Directions, count: usize) -> usize {
    let part = f64::midpoint(directions.next(), 1.0);
    ((part * count as f64) as usize).min(count.saturating_sub(1))
}

/// Returns a random plane through the middle half of a piece, or of all pieces.
pub(super) fn through(
    surface: &Surface,
    piece: Option<u32>,
    directions: &mut Directions,
) -> Result<Sweep, StressError> {
    let is_meant = |&t: &_| piece.is_none_or(|piece| surface.piece(t) == piece);
    let triangles = surface.topology().triangles().filter(is_meant);
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in triangles.flat_map(|t| surface.triangle_positions(t)) {
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let normal = directions.next_unit();
    let off = Vec3::from_fn(|_, _| directions.next()).component_mul(&(high - low)) / 4.0;
    let point = (low + high) / 2.0 + off;
    Ok(Sweep::from_plane(
        normal.into(),
        normal.dot(&point),
        &surface.bounds(),
    )?)
}

/// Planes tried for one cut; some miss the piece.
const TRIES: u32 = 20;

/// Smallest part of the body's volume that a cut may leave as a piece.
///
/// Planes through ears and feet cut off chips a fraction of a millimeter thin. Gravity moves the
/// faces of a chip by more than a hundredth of its thickness per substep.
const CHIP: f64 = 1e-3;

/// Cuts the largest piece; tries another plane where one misses, fails or cuts off a chip.
///
/// # Errors
/// [`StressError`] when no plane cuts the piece or the solver cannot follow.
pub(super) fn cut_largest(
    body: &mut Body<'_>,
    cutter: &mut Cutter,
    directions: &mut Directions,
) -> Result<(), StressError> {
    let before = pieces(&body.surface);
    let size = |p: &u32| body.surface.piece_triangles(*p);
    let largest = before.iter().copied().max_by_key(size).unwrap_or(0);
    let params = CutParams {
        only_piece: Some(largest),
        ..CutParams::default()
    };
    for _ in 0..TRIES {
        let sweep = through(&body.surface, Some(largest), directions)?;
        cutter.refit(&body.surface);
        let Ok(outcome) = cutter.cut(&mut body.surface, &sweep, &params) else {
            continue;
        };
        if pieces(&body.surface).len() > before.len() && !has_chip(&body.surface) {
            return body.follow(&outcome.delta);
        }
        if let Some(undo) = outcome.undo {
            cutter.undo(&mut body.surface, undo)?;
        }
    }
    let why = format!("none of {TRIES} planes cut piece {largest}");
    Err(StressError::Invariant(why))
}

/// Returns whether a piece is smaller than a [`CHIP`].
fn has_chip(surface: &Surface) -> bool {
    let volumes = surface.piece_volumes();
    let smallest = CHIP * volumes.iter().sum::<f64>();
    (pieces(surface).iter()).any(|&piece| volumes[piece as usize] < smallest)
}
