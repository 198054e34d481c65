//! The steps of a volume constraint: how much of an error a substep corrects.
//!
//! An incompressible piece regains the loss of the current substep at once. Older losses, such as
//! those of an impact or a change of pressure, are regained at rate [`RECOVERY`] at most. A piece
//! that an impact crushes to less than half regains that half faster, or it turns inside out.
//!
//! Gravity may move the faces of a thin piece by more than that, even by more than its thickness.
//! The piece then regains up to [`LOADS`] times that motion as velocity, which carries its weight.
//! The rest of a loss that takes several substeps moves positions instead of displacements: a piece
//! that grows or shrinks to another volume does not gain velocity from it.
//!
//! A piece may be unable to reach the volume that its pressure asks for, because its edges hold.
//! Beyond its rest volume it presses against them with a limited force. Otherwise corrections of
//! edges and volume undo each other, and the torque that is left of their sum spins the piece.

use super::{Sums, THIRD};
use crate::constraints::volumes::{PieceVolume, REACH};
use crate::step::constants::VolumeProjection;

/// Rate at which an incompressible piece regains older volume losses, in rest volumes [1/s].
pub(crate) const RECOVERY: f32 = 3.0;

/// Recovery of a piece that others crush: [`RECOVERY`] of this many times the loss beyond half of
/// its rest volume.
pub(crate) const CRUSHED: f32 = 60.0;

/// Maximum recovery per substep, relative to the area of a piece times `|g| h^2`.
pub(crate) const LOADS: f32 = 4.0;

/// Maximum loss that a piece beyond its rest volume regains in a substep, relative to its recovery.
pub(crate) const PRESS: f32 = 0.125;

/// Gain of the resistance: growth falls to the limited force at a change of `1 / EASE` of it.
pub(crate) const EASE: f32 = 8.0;

/// Rest area of a piece times its reach, relative to its rest volume.
pub(crate) const AREA: f32 = 3.0 * REACH;

#[inline(always)]
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// Returns the maximum correction of a small old error in a substep [m^3].
#[inline(always)]
pub(super) fn recovery(piece: &PieceVolume, by: VolumeProjection) -> f32 {
    let size = piece.rest.abs();
    greater(by.recovery * size, loaded(piece, by))
}

/// Returns the part of it that becomes velocity [m^3].
#[inline(always)]
fn loaded(piece: &PieceVolume, by: VolumeProjection) -> f32 {
    by.sink * (AREA * (piece.rest.abs() / piece.reach))
}

/// Returns the steps against the gradients: of the displacements, by which the multiplier
/// decreases, and of the positions.
#[inline(always)]
pub(super) fn steps(
    [now, weight, most]: Sums,
    before: f32,
    piece: &PieceVolume,
    by: VolumeProjection,
    lambda: f32,
) -> [f32; 2] {
    let size = piece.rest.abs();
    let target = by.pressure * piece.rest;
    let error = now * THIRD - target;
    let volume = before * THIRD;
    let held = if piece.rest < 0.0 { -volume } else { volume };
    let faster = if by.is_pressed {
        by.recovery * CRUSHED
    } else {
        0.0
    };
    let crushed = faster * (0.5 * size - held);
    let recovery = greater(recovery(piece, by), crushed);
    let before = volume - target;
    let mut left = 0.0;
    if error > recovery || error < -recovery {
        left = if before > recovery {
            before - recovery
        } else {
            left
        };
        left = if before < -recovery {
            before + recovery
        } else {
            left
        };
    }
    let alpha = by.alpha * size;
    let mut shift = 0.0;
    if error > recovery || error < -recovery {
        let (old, loaded) = (before - left, loaded(piece, by));
        shift = if old > loaded { old - loaded } else { shift };
        shift = if old < -loaded { old + loaded } else { shift };
    }
    let wish = ((error - left) - shift) + alpha * lambda;
    let [wish, shift] = press([error, before], (piece, by)).unwrap_or([wish, shift]);
    let sum = by.diagonal_scale * weight + alpha;
    let under = if weight > sum { weight } else { sum };
    let limits = [greater(piece.reach, by.sink), piece.reach].map(|limit| limit / most);
    [(wish, limits[0]), (shift, limits[1])].map(|(wanted, limit)| {
        let wanted = wanted / under;
        let wanted = if wanted > limit { limit } else { wanted };
        let wanted = if wanted < -limit { -limit } else { wanted };
        if weight > 0.0 && most > 0.0 {
            wanted
        } else {
            0.0
        }
    })
}

/// Returns the corrections [m^3] of displacements and of positions of an incompressible piece
/// that has not reached the volume that its pressure asks for, from its errors now and before.
#[inline(always)]
fn press(
    [error, before]: [f32; 2],
    (piece, by): (&PieceVolume, VolumeProjection),
) -> Option<[f32; 2]> {
    let target = by.pressure * piece.rest;
    // Volumes grow in the direction of the target.
    let direction = if target > piece.rest { 1.0 } else { -1.0 };
    let ahead = -(direction * before);
    if !(by.alpha == 0.0 && target != piece.rest && ahead > 0.0) {
        return None;
    }
    let change = direction * (error - before);
    let missing = -(direction * (before + (target - piece.rest)));
    let least = greater(PRESS * (by.recovery * piece.rest.abs()), loaded(piece, by));
    let force = least + greater(0.0, missing);
    // Nothing resists a piece whose volume hardly changes by itself.
    let free = recovery(piece, by) * (1.0 - EASE * (change.abs() / force));
    let growth = greater(free, force - greater(0.0, -change));
    let growth = greater(0.0, smaller(growth, recovery(piece, by)));
    let wish = direction * greater(change, -force);
    Some([wish, -(direction * smaller(growth, ahead))])
}
