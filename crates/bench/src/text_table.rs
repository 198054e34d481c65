//! Tables of columns, and wrapped paragraphs, for a terminal.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table};
use std::borrow::Borrow;

/// Largest width of a table of numbers \[characters\].
const TABLE_WIDTH: u16 = 150;
/// Largest width of wrapped text \[characters\].
const WIDTH: u16 = 120;

/// A heading and the cell of a row.
pub(crate) type Column<T> = (&'static str, fn(&T) -> String);

/// Returns a table without borders; columns are two spaces apart, numbers align right.
fn new_table<T>(
    columns: &[Column<T>],
    rows: &[impl Borrow<T>],
    texts: Option<(&str, Vec<String>)>,
) -> Table {
    let mut table = Table::new();
    let (heading, texts) = texts.map_or((None, Vec::new()), |(h, texts)| (Some(h), texts));
    let headings = columns.iter().map(|column| column.0);
    table
        .load_style(comfy_table::presets::NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH);
    if !columns.is_empty() {
        table.set_header(headings.chain(heading));
    }
    let mut texts = texts.into_iter();
    for row in rows {
        let cells = columns.iter().map(|column| column.1(row.borrow()));
        table.add_row(cells.chain(texts.next()));
    }
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        if columns.get(i).is_some_and(|column| !is_text(column, rows)) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// Returns whether a cell of a column has a word.
pub(crate) fn is_text<T>((_, cell): &Column<T>, rows: &[impl Borrow<T>]) -> bool {
    let is_word = |text: &str| text.chars().filter(char::is_ascii_alphabetic).count() > 1;
    rows.iter().any(|row| is_word(&cell(row.borrow())))
}

/// Formats a table of rows.
///
/// A table wider than [`TABLE_WIDTH`] becomes several, each with the first column.
pub(crate) fn text_table<T>(columns: &[Column<T>], rows: &[impl Borrow<T>]) -> String {
    let mut table = new_table(columns, rows, None);
    table.set_content_arrangement(ContentArrangement::Disabled);
    let widths: Vec<u16> = (table.column_max_content_widths().iter())
        .map(|width| width + 2)
        .collect();
    let mut text = String::new();
    let mut next = 1;
    while next < columns.len() || text.is_empty() {
        let (first, mut used) = (next, widths[0]);
        while next < columns.len() && (next == first || used + widths[next] <= TABLE_WIDTH + 2) {
            used += widths[next];
            next += 1;
        }
        for (i, column) in table.column_iter_mut().enumerate() {
            column.remove_constraint();
            if i > 0 && !(first..next).contains(&i) {
                column.set_constraint(ColumnConstraint::Hidden);
            }
        }
        if !text.is_empty() {
            text.push('\n');
        }
        text.extend([table.trim_fmt(), "\n".to_owned()]);
    }
    text
}

/// Formats a table with a last column of wrapped text.
pub(crate) fn table_with_text<T>(
    columns: &[Column<T>],
    rows: &[T],
    heading: &str,
    text: impl Fn(&T) -> String,
) -> String {
    let texts = rows.iter().map(text).collect();
    let mut table = new_table(columns, rows, Some((heading, texts)));
    for column in table.column_iter_mut().take(columns.len()) {
        column.set_constraint(ColumnConstraint::ContentWidth);
    }
    table.trim_fmt() + "\n"
}

/// Wraps a text at [`WIDTH`]; its line breaks stay.
pub(crate) fn paragraphs(text: &str) -> String {
    let mut table = new_table::<()>(&[], &[(); 0], None);
    table.add_row([text]);
    if let Some(column) = table.column_mut(0) {
        column.set_padding((0, 0));
    }
    table.trim_fmt() + "\n"
}

/// Formats a number of things.
pub(crate) fn count(number: usize, name: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {name}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_left_and_numbers_right() {
        let columns: [Column<[&str; 2]>; 2] = [("a", |r| r[0].into()), ("10", |r| r[1].into())];
        let text = text_table(&columns, &[["long", "9"], ["x", "4x1"]]);
        assert_eq!(text, "a      10\nlong    9\nx     4x1\n");
    }

    #[test]
    fn a_wide_table_is_folded() {
        let wide: Column<&str> = ("n", |r| r.repeat(40));
        let name: Column<&str> = ("name", |r| (*r).to_owned());
        let columns = [name, wide, wide, wide, wide];
        let text = text_table(&columns, &["1"]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "two tables of two lines: {text}");
        let widths = lines.iter().map(|line| line.len());
        assert!(widths.max() <= Some(TABLE_WIDTH.into()), "{text}");
        let counts = [1, 4].map(|k| lines[k].matches(&"1".repeat(40)).count());
        assert_eq!(counts, [3, 1], "each column once");
    }

    #[test]
    fn texts_are_wrapped_and_lose_no_word() {
        let long = "word ".repeat(60) + "\nat: x";
        let columns: [Column<(&str, &str)>; 1] = [("id", |row| row.0.to_owned())];
        let rows = [("case", "law"), ("\u{3bb}", long.as_str())];
        let text = table_with_text(&columns, &rows, "text", |row| row.1.to_owned());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[1], "case  law", "{text}");
        assert_eq!(lines.last(), Some(&"      at: x"));
        assert!(
            lines
                .iter()
                .all(|line| line.chars().count() <= WIDTH.into()),
            "{text}"
        );
        assert_eq!(text.matches("word").count(), 60);
        let wrapped = paragraphs(&long);
        assert!(wrapped.ends_with("\nat: x\n") && wrapped.lines().all(|l| l.len() <= 120));
    }
}
