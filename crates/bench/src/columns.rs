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
            .map(|(k, (cell, width))| pad(cell, width, k < left))
            .collect();
        text.push_str(padded.join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// As [`columns`], in several tables below each other where one would be wider than [`WIDTH`]; each begins with the first
/// column.
pub(crate) fn folded<const N: usize>(cells: &[[String; N]], left: usize) -> String {
    let width = |k: usize| cells.iter().map(|line| length(&line[k])).max().unwrap_or(0);
    let (mut tables, mut table, mut used) = (Vec::new(), vec![0], width(0));
    for k in 1..N {
        let more = 2 + width(k);
        if used + more > WIDTH {
            tables.push(std::mem::replace(&mut table, vec![0]));
            used = width(0);
        }
        used += more;
        table.push(k);
    }
    tables.push(table);
    let mut text = String::new();
    for (i, table) in tables.iter().enumerate() {
        if i > 0 {
            text.push('\n');
        }
        for line in cells {
            let padded: Vec<String> = (table.iter())
                .map(|&k| pad(&line[k], width(k), k < left))
                .collect();
            text.push_str(padded.join("  ").trim_end());
            text.push('\n');
        }
    }
    text
}

fn pad(cell: &str, width: usize, is_left: bool) -> String {
    if is_left {
        format!("{cell:width$}")
    } else {
        format!("{cell:>width$}")
    }
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

/// A number, or a dash for what a run without a cut cannot tell.
pub(crate) fn measured(x: f64, digits: usize) -> String {
    if x.is_finite() {
        format!("{x:.digits$}")
    } else {
        "-".to_owned()
    }
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
    fn a_table_that_is_too_wide_is_several() {
        let line = |name: &str, cell: &str| {
            let cells = [cell; 4].map(|cell| cell.repeat(30));
            let [a, b, c, d] = cells;
            [name.to_owned(), a, b, c, d]
        };
        let cells = [line("name", "n"), line("x", "1")];
        let text = folded(&cells, 1);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines.len(),
            5,
            "two of two lines and one between them: {text}"
        );
        assert!(lines.iter().all(|line| line.len() <= WIDTH), "{text}");
        assert_eq!([lines[0], lines[3]].map(|line| &line[..6]), ["name  "; 2]);
        let counts = [1, 4].map(|k| lines[k].matches(&"1".repeat(30)).count());
        assert_eq!(counts, [3, 1], "each column once");
        assert_eq!(folded(&cells[..1], 1).lines().count(), 3);
        let narrow = [["a", "b"], ["1", "2"]].map(|line| line.map(str::to_owned));
        assert_eq!(folded(&narrow, 1), columns(&narrow, 1));
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
