//! Sums entries of a lower triangle to a matrix by columns.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};

/// A part of an element of the lower triangle of a matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Row of the element, at least `column`.
    pub row: u32,
    /// Column of the element.
    pub column: u32,
    /// Term of the element, which is the sum of its entries in their order.
    pub value: f64,
}

/// Returns the matrix of `count` rows that is the sum of some entries.
pub(crate) fn sum(count: usize, entries: &[Entry]) -> SparseColMat<usize, f64> {
    let mut starts = vec![0; count + 1];
    for entry in entries {
        starts[entry.column as usize + 1] += 1;
    }
    for column in 0..count {
        starts[column + 1] += starts[column];
    }
    let mut next = starts.clone();
    let mut by_column = vec![(0, 0.0); entries.len()];
    for entry in entries {
        let place = &mut next[entry.column as usize];
        by_column[*place] = (entry.row, entry.value);
        *place += 1;
    }
    // The place of a row's sum among those of the column; those of other columns are outdated.
    let mut places = vec![usize::MAX; count];
    let mut sums: Vec<(u32, f64)> = Vec::with_capacity(entries.len() / 2);
    for column in 0..count {
        let first = sums.len();
        for &(row, value) in &by_column[starts[column]..starts[column + 1]] {
            let place = &mut places[row as usize];
            match sums.get_mut(*place).filter(|_| *place >= first) {
                Some((_, sum)) => *sum += value,
                None => {
                    *place = sums.len();
                    sums.push((row, value));
                }
            }
        }
        sums[first..].sort_unstable_by_key(|&(row, _)| row);
        starts[column] = first;
    }
    starts[count] = sums.len();
    let rows = sums.iter().map(|&(row, _)| row as usize).collect();
    let structure = SymbolicSparseColMat::new_checked(count, count, starts, None, rows);
    let values = sums.into_iter().map(|(_, value)| value).collect();
    SparseColMat::new(structure, values)
}
