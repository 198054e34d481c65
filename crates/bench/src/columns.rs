//! Text in columns.

/// The most characters of a line that is broken where it can be.
pub(crate) const WIDTH: usize = 120;

/// Lines of equally many cells, padded to the widest of each column; the first `left` columns begin
/// at their left edge, numbers end at their right one.
pub(crate) fn columns<const N: usize>(cells: &[[String; N]], left: usize) -> String {
    let widths: [usize; N] = std::array::from_fn(|k| {
        (cells.iter().map(|line| length(&line[k])))
            .max()
            .unwrap_or(0)
    });
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

/// As [`columns`], with texts in a last column below each other, broken so that no line is wider than [`WIDTH`] unless a
/// word is.
pub(crate) fn with_texts<const N: usize>(
    rows: &[([String; N], Vec<String>)],
    left: usize,
) -> String {
    let cells: Vec<[String; N]> = rows.iter().map(|row| row.0.clone()).collect();
    let table = columns(&cells, left);
    let indent = table.lines().map(length).max().unwrap_or(0) + 2;
    let mut out = String::new();
    for (line, (_, texts)) in table.lines().zip(rows) {
        let room = WIDTH.saturating_sub(indent);
        let broken = texts.iter().flat_map(|text| broken(text, room));
        let mut begin = line;
        for part in broken {
            out.push_str(format!("{begin:indent$}{part}").trim_end());
            out.push('\n');
            begin = "";
        }
    }
    out
}

/// A text as lines of at most [`WIDTH`] characters; a line break in it stays.
pub(crate) fn paragraphs(text: &str) -> String {
    let lines = text.lines().flat_map(|line| broken(line, WIDTH));
    lines.map(|line| line + "\n").collect()
}

/// Lines of at most `width` characters, longer only where a word is; one in any case.
fn broken(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let Some(line) = lines.last_mut() else {
            break;
        };
        if line.is_empty() {
            line.push_str(word);
        } else if length(line) + 1 + length(word) <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// A number of things by their name.
pub(crate) fn count(number: usize, name: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {name}{plural}")
}

fn length(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_left_and_numbers_right() {
        let cells = [["a", "b", "10"], ["long", "c", "9"]].map(|line| line.map(str::to_owned));
        assert_eq!(columns(&cells, 2), "a     b  10\nlong  c   9\n");
    }
    #[test]
    fn texts_stand_below_each_other_and_no_line_is_too_wide() {
        let long = "word ".repeat(60);
        let rows = [
            (["case".to_owned(), "10".to_owned()], vec!["law".to_owned()]),
            (
                ["\u{3bb}".to_owned(), "9".to_owned()],
                vec![long.clone(), "at: x".to_owned()],
            ),
        ];
        let text = with_texts(&rows, 1);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "case  10  law");
        assert!(lines[1].starts_with("\u{3bb}      9  word word"), "{text}");
        assert_eq!(lines[lines.len() - 1], "          at: x");
        assert!(lines.iter().all(|line| length(line) <= WIDTH), "{text}");
        let words = text.matches("word").count();
        assert_eq!(words, 60, "none is lost");
        let broken = paragraphs(&format!("{long}\nnext"));
        assert!(broken.lines().all(|line| line.len() <= WIDTH) && broken.ends_with("\nnext\n"));
    }

    #[test]
    fn one_thing_is_not_several() {
        let counts = [0, 1, 2].map(|n| count(n, "law"));
        assert_eq!(counts, ["0 laws", "1 law", "2 laws"]);
    }
}
