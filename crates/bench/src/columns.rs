//! Text in columns.

/// Lines of equally many cells, padded to the widest of each column; the first `left` columns begin
/// at their left edge, numbers end at their right one.
pub(crate) fn columns<const N: usize>(cells: &[[String; N]], left: usize) -> String {
    let widths: [usize; N] =
        std::array::from_fn(|k| cells.iter().map(|line| line[k].len()).max().unwrap_or(0));
    let mut text = String::new();
    for line in cells {
        let padded: Vec<String> = line
            .iter()
            .zip(widths)
            .enumerate()
            .map(|(k, (cell, width))| {
                if k < left {
                    format!("{cell:width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        text.push_str(padded.join("  ").trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::columns;

    #[test]
    fn names_are_left_and_numbers_right() {
        let cells = [["a", "b", "10"], ["long", "c", "9"]].map(|line| line.map(str::to_owned));
        assert_eq!(columns(&cells, 2), "a     b  10\nlong  c   9\n");
    }
}
