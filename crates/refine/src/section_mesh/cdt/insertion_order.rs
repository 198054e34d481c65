//! Biased randomized insertion order (BRIO) of points: Amenta, Choi and Rote 2003.
//!
//! Rounds double in size; within a round points follow a Hilbert curve. Point location is short
//! because consecutive points are close, and no input makes the number of flips quadratic. The
//! round of a point is a hash of its index, so the order is deterministic.

/// Writes the insertion order of `0..points.len()` to `order`; the second members are the indices.
pub(crate) fn insertion_order(
    points: &[[f64; 2]],
    low: [f64; 2],
    high: [f64; 2],
    order: &mut Vec<(u64, u32)>,
) {
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let scale = if size > 0.0 { 65535.0 / size } else { 0.0 };
    order.clear();
    order.extend((0u32..).zip(points).map(|(i, p)| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cell of a grid of 65536 squared; only the order depends on it"
        )]
        let cell = [0, 1].map(|k| ((p[k] - low[k]) * scale) as u32 & 0xffff);
        let round = i
            .wrapping_mul(0x9e37_79b9)
            .swap_bytes()
            .leading_ones()
            .min(15);
        (u64::from(15 - round) << 32 | u64::from(hilbert(cell)), i)
    }));
    order.sort_unstable();
}

/// Returns the position of a cell along the Hilbert curve through a grid of 65536 x 65536.
fn hilbert([mut x, mut y]: [u32; 2]) -> u32 {
    let mut d = 0;
    let mut s = 1 << 15;
    while s > 0 {
        let (rx, ry) = (u32::from(x & s != 0), u32::from(y & s != 0));
        d = d << 2 | ((3 * rx) ^ ry);
        if ry == 0 {
            if rx == 1 {
                x = !x & 0xffff;
                y = !y & 0xffff;
            }
            std::mem::swap(&mut x, &mut y);
        }
        s >>= 1;
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_cells_of_the_curve_are_adjacent() {
        let mut cells: Vec<[u32; 2]> = (0..32).flat_map(|x| (0..32).map(move |y| [x, y])).collect();
        cells.sort_by_key(|&c| hilbert(c));
        for pair in cells.windows(2) {
            let step = pair[0][0].abs_diff(pair[1][0]) + pair[0][1].abs_diff(pair[1][1]);
            assert_eq!(step, 1, "{pair:?}");
        }
    }

    #[test]
    fn order_contains_every_point_once() {
        let points: Vec<[f64; 2]> = (0..1000)
            .map(|i| [f64::from(i % 37), f64::from(i % 11)])
            .collect();
        let mut order = Vec::new();
        insertion_order(&points, [0.0, 0.0], [36.0, 10.0], &mut order);
        let mut ids: Vec<u32> = order.iter().map(|o| o.1).collect();
        ids.sort_unstable();
        assert_eq!(ids, (0..1000).collect::<Vec<_>>());
    }
}
