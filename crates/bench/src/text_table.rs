//! Tables of rows for a terminal, made from the fields of the rows.

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use std::fmt;

/// Largest width of a table \[characters\].
const WIDTH: usize = 150;

/// The fields of a row in their order.
#[derive(Debug, Clone)]
pub(crate) struct Cells(Vec<(String, Option<Cell>)>);

/// A value of a field.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Cell {
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Option<Self>>),
    Group(Cells),
}

impl<'de> Deserialize<'de> for Cells {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Cells;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Cells, A::Error> {
                let mut cells = Vec::new();
                while let Some(cell) = map.next_entry()? {
                    cells.push(cell);
                }
                Ok(Cells(cells))
            }
        }
        from.deserialize_map(InOrder)
    }
}

/// A row as text: headings and cells, and texts that are too long for a table.
#[derive(Debug, Default)]
struct TextRow {
    cells: Vec<(String, String)>,
    notes: Vec<String>,
}

impl TextRow {
    fn new(row: &Cells) -> Self {
        let mut text = Self::default();
        text.add("", row);
        text
    }

    fn add(&mut self, group: &str, cells: &Cells) {
        for (name, cell) in &cells.0 {
            let heading = format!("{group}{name}");
            match cell {
                Some(Cell::Group(cells)) => self.add(&format!("{heading}_"), cells),
                Some(Cell::List(list)) => {
                    let is_number = |cell: &Option<Cell>| matches!(cell, Some(Cell::Number(_)));
                    if !list.iter().any(is_number) {
                        self.cells.push((heading, list.len().to_string()));
                        let texts = list.iter().map(|cell| text(cell.as_ref()));
                        self.notes
                            .extend(texts.map(|text| format!("{name}: {text}")));
                    }
                }
                cell => self.cells.push((heading, text(cell.as_ref()))),
            }
        }
    }

    fn cell(&self, heading: &str) -> &str {
        let of = self.cells.iter().find(|cell| cell.0 == heading);
        of.map_or("-", |cell| &cell.1)
    }
}

fn text(cell: Option<&Cell>) -> String {
    match cell {
        None => "-".to_owned(),
        Some(Cell::Bool(is)) => if *is { "yes" } else { "no" }.to_owned(),
        Some(Cell::Number(x)) => number(*x),
        Some(Cell::Text(text)) => text.clone(),
        Some(Cell::List(list)) => format!("{} entries", list.len()),
        Some(Cell::Group(cells)) => {
            let parts = cells
                .0
                .iter()
                .map(|(name, cell)| (name, text(cell.as_ref())));
            let parts: Vec<String> = parts.map(|(name, text)| format!("{name} {text}")).collect();
            parts.join(", ")
        }
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

/// A column of a table.
struct Column {
    /// Broken at underscores.
    heading: Vec<String>,
    cells: Vec<String>,
    width: usize,
    is_text: bool,
}

impl Column {
    fn new(heading: &str, rows: &[TextRow]) -> Self {
        let cells: Vec<String> = rows
            .iter()
            .map(|row| row.cell(heading).to_owned())
            .collect();
        let longest = |texts: &[String]| texts.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        let width = longest(&cells);
        let mut lines: Vec<String> = Vec::new();
        for word in heading.split_inclusive('_') {
            match lines.last_mut() {
                Some(line) if line.len() + word.len() <= width => line.push_str(word),
                _ => lines.push(word.to_owned()),
            }
        }
        let has_word = |text: &String| text.chars().filter(char::is_ascii_alphabetic).count() > 1;
        Self {
            width: width.max(longest(&lines)),
            heading: lines,
            is_text: cells.iter().any(has_word),
            cells,
        }
    }

    /// Returns a line of the table, whose headings have `height` lines.
    fn line(&self, line: usize, height: usize) -> String {
        let text = match line.checked_sub(height) {
            Some(row) => self.cells.get(row),
            None => (line + self.heading.len())
                .checked_sub(height)
                .and_then(|line| self.heading.get(line)),
        };
        let (text, width) = (text.map_or("", String::as_str), self.width);
        match self.is_text {
            true => format!("{text:<width$}"),
            false => format!("{text:>width$}"),
        }
    }
}

/// Formats rows as a table; fields of the same value in all rows are listed above it instead.
///
/// A table wider than [`WIDTH`] becomes several, each with the column of names.
pub(crate) fn text_table(rows: &[Cells]) -> String {
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
    for part in same
        .iter()
        .map(|heading| format!("{heading} {}, ", value(heading)))
    {
        width += part.len();
        if width > WIDTH {
            text.push('\n');
            width = part.len();
        }
        text.push_str(&part);
    }
    let mut text = text.trim_end_matches(", ").to_owned() + "\n";
    let name = Column::new("name", &rows);
    let columns = varying.iter().filter(|heading| **heading != "name");
    let columns: Vec<Column> = columns.map(|heading| Column::new(heading, &rows)).collect();
    let mut rest = columns.as_slice();
    while !rest.is_empty() {
        let mut width = name.width;
        let fits = rest.iter().take_while(|column| {
            width += column.width + 2;
            width <= WIDTH
        });
        let (now, later) = rest.split_at(fits.count().max(1));
        rest = later;
        let all: Vec<&Column> = [&name].into_iter().chain(now).collect();
        let height = all.iter().map(|column| column.heading.len()).max();
        let height = height.unwrap_or(0);
        text.push('\n');
        for line in 0..height + rows.len() {
            let cells: Vec<String> = all.iter().map(|column| column.line(line, height)).collect();
            text.push_str(cells.join("  ").trim_end());
            text.push('\n');
        }
    }
    for row in &rows {
        let notes = row
            .notes
            .iter()
            .map(|note| format!("{}: {note}\n", row.cell("name")));
        text.extend(notes);
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
         ms_
        cut_
name     all  failures
a     0.5000         0
bc         -         1
bc: failures: no
";
        assert_eq!(text_table(&rows), expected);
    }
}
