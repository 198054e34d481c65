//! Tests of the factorization: closed forms, sums of entries, and matrices without a factor.

use incise_sparse::{Cholesky, Columns, Entry};

const EVERY: [Columns; 2] = [Columns::Single, Columns::Blocks];

/// Returns the lower triangle of the second difference on `count` points, in entries of 1 and -1
/// per pair of neighbors, plus `diagonal` in every row.
fn second_difference(count: u32, diagonal: f64) -> Vec<Entry> {
    let mut out = Vec::new();
    let mut add = |row, column, value| out.push(Entry { row, column, value });
    for row in 0..count {
        add(row, row, diagonal);
        if row > 0 {
            add(row - 1, row - 1, 1.0);
            add(row, row - 1, -1.0);
            add(row, row, 1.0);
        }
    }
    add(0, 0, 1.0);
    add(count - 1, count - 1, 1.0);
    out
}

/// A load of 2 in every row bends the line between fixed ends to the parabola `i (n + 1 - i)`.
#[test]
fn a_uniform_load_gives_a_parabola() {
    let count = 300;
    for columns in EVERY {
        let factor = Cholesky::new(count, &second_difference(300, 0.0), columns).unwrap();
        assert_eq!(factor.rows(), count);
        assert!(factor.entries() >= 2 * count - 1, "the factor has the band");
        let mut scratch = factor.scratch(2).unwrap();
        for row in 0..count {
            scratch.right[(row, 0)] = 2.0;
            scratch.right[(row, 1)] = -1.0;
        }
        factor.solve(&mut scratch);
        for row in 0..count {
            let expected = ((row + 1) * (count - row)) as f64;
            let found = [0, 1].map(|column| scratch.right[(row, column)]);
            for (found, expected) in found.into_iter().zip([expected, -expected / 2.0]) {
                let error = (found - expected).abs() / expected.abs();
                assert!(
                    error < 1e-11,
                    "{columns:?}: row {row} is {found}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_has_no_factor() {
    for columns in EVERY {
        for diagonal in [-0.5, f64::NAN] {
            let lower = second_difference(300, diagonal);
            assert!(Cholesky::new(300, &lower, columns).is_none(), "{diagonal}");
        }
    }
}

/// Later entries of an element are added to earlier ones: the first two cancel.
#[test]
fn entries_are_summed_in_their_order() {
    let entry = |value| Entry {
        row: 0,
        column: 0,
        value,
    };
    let lower = [entry(1e30), entry(-1e30), entry(4.0)];
    let factor = Cholesky::new(1, &lower, Columns::Single).unwrap();
    let mut scratch = factor.scratch(1).unwrap();
    scratch.right[(0, 0)] = 8.0;
    factor.solve(&mut scratch);
    assert_eq!(scratch.right[(0, 0)], 2.0);
}

#[test]
fn an_empty_matrix_has_a_factor() {
    for columns in EVERY {
        let factor = Cholesky::new(0, &[], columns).unwrap();
        let mut scratch = factor.scratch(3).unwrap();
        factor.solve(&mut scratch);
        assert_eq!((factor.rows(), factor.entries()), (0, 0));
    }
}
