//! Tables of rows for a terminal, made from the fields of the rows.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, Table};
use incise_params::Value;

/// Largest width of a table \[characters\].
const WIDTH: usize = 150;

/// A row as text: headings and cells, and texts that are too long for a table.
#[derive(Debug, Default)]
struct TextRow {
    cells: Vec<(String, String)>,
    notes: Vec<String>,
}

impl TextRow {
    fn new(row: &Value) -> Self {
        let mut text = Self::default();
        text.add("", row);
        text
    }

    fn add(&mut self, heading: &str, value: &Value) {
        match value {
            Value::Map(fields) => {
                for (name, value) in fields {
                    let group = if heading.is_empty() { "" } else { "_" };
                    self.add(&format!("{heading}{group}{name}"), value);
                }
            }
            Value::List(list) if list.iter().any(is_number) => {}
            Value::List(list) => {
                self.cells
                    .push((heading.to_owned(), list.len().to_string()));
                let notes = list
                    .iter()
                    .map(|value| format!("{heading}: {}", text(value)));
                self.notes.extend(notes);
            }
            value => self.cells.push((heading.to_owned(), text(value))),
        }
    }

    fn cell(&self, heading: &str) -> &str {
        let of = self.cells.iter().find(|cell| cell.0 == heading);
        of.map_or("-", |cell| &cell.1)
    }
}

fn is_number(value: &Value) -> bool {
    matches!(value, Value::Count(_) | Value::Number(_))
}

fn text(value: &Value) -> String {
    match value {
        Value::None => "-".to_owned(),
        Value::Flag(is) => if *is { "yes" } else { "no" }.to_owned(),
        Value::Number(x) => number(*x),
        Value::Text(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Formats a number in few digits; whole numbers stay whole.
pub(crate) fn number(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e15 {
        return format!("{x}");
    }
    match x.abs() {
        size if !(1e-3..1e6).contains(&size) => format!("{x:.3e}"),
        size if size >= 100.0 => format!("{x:.1}"),
        size if size >= 1.0 => format!("{x:.3}"),
        _ => format!("{x:.4}"),
    }
}

/// Returns the side of cells: words on the left, numbers on the right.
fn alignment<'a>(mut cells: impl Iterator<Item = &'a str>) -> CellAlignment {
    let has_word = |text: &str| text.chars().filter(char::is_ascii_alphabetic).count() > 1;
    match cells.any(has_word) {
        true => CellAlignment::Left,
        false => CellAlignment::Right,
    }
}

/// Formats rows as a table; fields of the same value in all rows are listed above it instead.
///
/// A table wider than [`WIDTH`] becomes several, each with the column of names.
pub(crate) fn text_table(rows: &[Value]) -> String {
    let rows: Vec<TextRow> = rows.iter().map(TextRow::new).collect();
    let mut headings: Vec<&str> = Vec::new();
    for (heading, _) in rows.iter().flat_map(|row| &row.cells) {
        if !headings.contains(&heading.as_str()) {
            headings.push(heading);
        }
    }
    let value = |heading: &str| rows.first().map_or("-", |row| row.cell(heading)).to_owned();
    let is_same = |heading: &&str| rows.iter().all(|row| row.cell(heading) == value(heading));
    let (same, varying): (Vec<&str>, Vec<&str>) = headings.into_iter().partition(is_same);
    let mut text = String::new();
    let mut width = 0;
    for heading in same {
        let part = format!("{heading} {}, ", value(heading));
        width += part.len();
        if width > WIDTH {
            text.push('\n');
            width = part.len();
        }
        text.push_str(&part);
    }
    let mut text = text.trim_end_matches(", ").to_owned() + "\n";
    let others = varying.into_iter().filter(|heading| *heading != "name");
    let columns: Vec<&str> = ["name"].into_iter().chain(others).collect();
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(columns.iter().map(|heading| heading.replace('_', "_\n")));
    for row in &rows {
        table.add_row(columns.iter().map(|heading| row.cell(heading)));
    }
    for (column, heading) in table.column_iter_mut().zip(&columns) {
        column.set_padding((0, 2));
        column.set_cell_alignment(alignment(rows.iter().map(|row| row.cell(heading))));
    }
    let widths = table.column_max_content_widths().into_iter();
    let widths: Vec<usize> = widths.map(|width| usize::from(width) + 2).collect();
    let mut first = 1;
    while first < columns.len() {
        let mut width = widths[0] - 2;
        let fits = widths[first..].iter().take_while(|own| {
            width += **own;
            width <= WIDTH
        });
        let shown = first..first + fits.count().max(1);
        first = shown.end;
        for (index, column) in table.column_iter_mut().enumerate() {
            column.remove_constraint();
            if index > 0 && !shown.contains(&index) {
                column.set_constraint(ColumnConstraint::Hidden);
            }
        }
        text.push('\n');
        text.push_str(&table.trim_fmt());
        text.push('\n');
    }
    for row in &rows {
        let name = row.cell("name");
        text.extend(row.notes.iter().map(|note| format!("{name}: {note}\n")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_fields_are_listed_once_and_the_rest_are_columns() {
        let rows = [
            r#"{"name":"a","seed":1,"ms":{"cut_all":0.5},"by_second":[1,2],"failures":[]}"#,
            r#"{"name":"bc","seed":1,"ms":{"cut_all":null},"by_second":[3],"failures":["no"]}"#,
        ];
        let rows = rows.map(|row| serde_json::from_str(row).unwrap());
        let expected = "seed 1\n
name     ms_  failures
        cut_
         all
a     0.5000         0
bc         -         1
bc: failures: no
";
        assert_eq!(text_table(&rows), expected);
    }
}
