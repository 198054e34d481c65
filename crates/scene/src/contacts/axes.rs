//! The axis along which two overlapping pieces are separated by the shortest way.
//!
//! [`super::overlaps`] moves them along it. Thirteen axes stand for all directions: those through
//! the faces, edges and corners of a cube.

use incise_mesh::Vec3;

/// Directions of the axes, of any length; horizontal ones first.
const AXES: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
];

/// Maximum slope of a way that counts as level, relative to its length.
const MAX_SLOPE: f64 = 0.25;

/// Returns the unit vector of an axis.
fn axis(k: usize) -> Vec3 {
    Vec3::from(AXES[k]).normalize()
}

/// The minimum and maximum of a set of points along each axis \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Extents([[f64; 2]; AXES.len()]);

impl Extents {
    /// Returns the extents of points.
    pub(super) fn new(points: impl Iterator<Item = Vec3>) -> Self {
        let mut extents = [[f64::INFINITY, f64::NEG_INFINITY]; AXES.len()];
        let axes: [Vec3; AXES.len()] = std::array::from_fn(axis);
        for point in points {
            for (extent, axis) in extents.iter_mut().zip(&axes) {
                let along = axis.dot(&point);
                *extent = [extent[0].min(along), extent[1].max(along)];
            }
        }
        Self(extents)
    }

    /// Returns the minimum and maximum corner of the bounding box \[m\].
    pub(super) fn corners(&self) -> [Vec3; 2] {
        let [x, z, y] = [self.0[0], self.0[1], self.0[2]];
        [0, 1].map(|side: usize| Vec3::new(x[side], y[side], z[side]))
    }

    /// Returns the diagonal of the bounding box \[m\].
    pub(super) fn diagonal(&self) -> f64 {
        let [min, max] = self.corners();
        (max - min).norm()
    }
}

/// Returns a way without its part along gravity, if that is small.
///
/// Otherwise the lower piece would get no displacement, whatever the masses are.
pub(super) fn without_vertical_part(way: Vec3, gravity: Vec3) -> Vec3 {
    let Some(down) = gravity.try_normalize(0.0) else {
        return way;
    };
    let sunk = way.dot(&down);
    if sunk.abs() > MAX_SLOPE * way.norm() {
        return way;
    }
    way - down * sunk
}

/// Returns displacements of two pieces that move the second one by `direction` from the first one.
///
/// They share it by their mobilities, the reciprocal masses. Neither moves along `gravity`, since
/// it may rest on something. `None` without a way.
pub(super) fn along(direction: Vec3, mobilities: [f64; 2], gravity: Vec3) -> Option<[Vec3; 2]> {
    let fall = direction.dot(&gravity);
    let mut shares = mobilities;
    for (share, fall) in shares.iter_mut().zip([-fall, fall]) {
        if fall > 0.0 {
            *share = 0.0;
        }
    }
    let sum = shares[0] + shares[1];
    let [first, second] = shares.map(|share| direction * (share / sum));
    (sum > 0.0).then_some([-first, second])
}

/// Returns displacements of two pieces that separate them by 1, along the shortest way.
///
/// They are those of [`along`] an axis. A way on which `is_blocked` holds for a piece and its
/// displacement is taken only if there is no other one. `None` if no way is left.
pub(super) fn separation(
    extents: &[Extents; 2],
    mobilities: [f64; 2],
    gravity: Vec3,
    is_blocked: impl Fn(&Extents, Vec3) -> bool,
) -> Option<[Vec3; 2]> {
    let [a, b] = extents;
    let mut best: Option<((bool, f64), [Vec3; 2])> = None;
    for k in 0..AXES.len() {
        let ([a_min, a_max], [b_min, b_max]) = (a.0[k], b.0[k]);
        for (way, direction) in [(a_max - b_min, axis(k)), (b_max - a_min, -axis(k))] {
            let Some(shifts) = along(direction, mobilities, gravity) else {
                continue;
            };
            let mut moves = extents.iter().zip(shifts);
            let cost = (moves.any(|(piece, by)| is_blocked(piece, by * way)), way);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, shifts));
            }
        }
    }
    best.map(|(_, shifts)| shifts)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The extents of a box with these corners.
    fn block(min: [f64; 3], max: [f64; 3]) -> Extents {
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { min[k] } else { max[k] });
        Extents::new((0..8).map(|i| Vec3::from(corner(i))))
    }

    #[test]
    fn blocks_separate_along_their_thinnest_overlap() {
        let block_a = block([0.0; 3], [4.0, 4.0, 4.0]);
        let block_b = block([1.0, 0.5, 3.0], [5.0, 4.5, 7.0]);
        assert!((block_a.diagonal() - 48.0_f64.sqrt()).abs() < 1e-12);
        let weightless = |mobilities, is_blocked: fn(&Extents, Vec3) -> bool| {
            let blocks = [block_a, block_b];
            separation(&blocks, mobilities, Vec3::zeros(), is_blocked).unwrap()
        };
        let shifts = weightless([1.0, 3.0], |_, _| false);
        assert!((shifts[0] - Vec3::new(0.0, 0.0, -0.25)).norm() < 1e-12);
        assert!((shifts[1] - Vec3::new(0.0, 0.0, 0.75)).norm() < 1e-12);
        let shifts = weightless([1.0, 0.0], |_, _| false);
        assert_eq!(shifts[1], Vec3::zeros(), "it is pinned");
        assert!((shifts[0] - Vec3::new(0.0, 0.0, -1.0)).norm() < 1e-12);
        let shifts = weightless([0.0, 1.0], |_, by| by.z != 0.0);
        assert_eq!(shifts[1], Vec3::x(), "the next shortest way");
        let shifts = weightless([0.0, 1.0], |_, _| true);
        assert_eq!(shifts[1], Vec3::z(), "all ways are blocked");
    }

    #[test]
    fn nothing_is_pressed_down() {
        let gravity = Vec3::new(0.0, -9.8, 0.0);
        let plates = [
            block([0.0; 3], [9.0, 1.0, 9.0]),
            block([0.0, 0.5, 0.0], [9.0, 1.5, 9.0]),
        ];
        let shifts = separation(&plates, [1.0; 2], gravity, |_, _| false).unwrap();
        assert_eq!(shifts, [Vec3::zeros(), Vec3::y()], "the upper one rises");
        let shifts = separation(&plates, [1.0, 0.0], gravity, |_, _| false).unwrap();
        assert_eq!(shifts, [Vec3::y(), Vec3::zeros()], "it rises through it");
        assert_eq!(separation(&plates, [0.0; 2], gravity, |_, _| false), None);
    }
}
