//! Sums of a piece in a fixed order, the same as on GPUs.

use super::CHUNK;

/// Returns the sums of the first `leaves` leaves; `last` combines those of the last column.
#[inline(always)]
pub(crate) fn tree<const N: usize>(
    columns: &mut [[f32; CHUNK]; N],
    leaves: usize,
    last: impl Fn(f32, f32) -> f32,
) -> [f32; N] {
    let mut width = leaves.next_power_of_two();
    for column in columns.iter_mut() {
        column[leaves..width].fill(0.0);
    }
    while width > 1 {
        width /= 2;
        let Some((last_column, summed)) = columns.split_last_mut() else {
            break;
        };
        for column in summed {
            let (low, high) = column.split_at_mut(width);
            for (low, high) in low.iter_mut().zip(high) {
                *low += *high;
            }
        }
        let (low, high) = last_column.split_at_mut(width);
        for (low, high) in low.iter_mut().zip(high) {
            *low = last(*low, *high);
        }
    }
    std::array::from_fn(|k| columns[k][0])
}

/// Returns the sums of all chunks; leaf i holds chunks i, i + [`CHUNK`] and so on.
#[inline(always)]
pub(super) fn total_of<const N: usize>(
    partial: &[[f32; N]],
    last: impl Fn(f32, f32) -> f32,
) -> [f32; N] {
    if let [only] = partial {
        return *only;
    }
    let mut columns = [[0.0; CHUNK]; N];
    for row in partial.chunks(CHUNK) {
        for (i, sums) in row.iter().enumerate() {
            for (k, (column, &sum)) in columns.iter_mut().zip(sums).enumerate() {
                column[i] = if k + 1 < N {
                    column[i] + sum
                } else {
                    last(column[i], sum)
                };
            }
        }
    }
    tree(&mut columns, partial.len().min(CHUNK), last)
}
