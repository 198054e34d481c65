//! HTML of the report: escaped text, tables, figures. Nothing is loaded from outside.

use crate::text_table::{self, Column};
use std::fmt::Write;

/// Longest group of rows that is not folded.
const SHORT: usize = 16;

/// Escapes text for elements and attributes.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
    }
    out
}

/// Rows of a table below one group heading.
#[derive(Debug)]
pub(super) struct Group<'a, T> {
    pub(super) title: String,
    pub(super) rows: Vec<&'a T>,
    /// Whether the group is a duplicate of an earlier one.
    pub(super) is_folded: bool,
}

/// Markup under construction.
#[derive(Debug, Default)]
pub(super) struct Html(pub(super) String);

impl Html {
    /// Appends a section heading with an anchor.
    pub(super) fn heading(&mut self, anchor: &str, text: &str) {
        let _ = writeln!(
            self.0,
            "<h2 id=\"{}\">{}</h2>",
            escape(anchor),
            escape(text)
        );
    }

    /// Appends a heading within a section.
    pub(super) fn subheading(&mut self, text: &str) {
        self.element("h3", text);
    }

    pub(super) fn paragraph(&mut self, text: &str) {
        self.element("p", text);
    }

    /// Appends a highlighted paragraph.
    pub(super) fn note(&mut self, text: &str) {
        let _ = writeln!(self.0, "<p class=\"note\">{}</p>", escape(text));
    }

    /// Appends a list of links to anchors, each with a title and a text beside it.
    pub(super) fn links<'a>(
        &mut self,
        items: impl IntoIterator<Item = (&'a str, &'a str, String)>,
    ) {
        self.0.push_str("<ul>\n");
        for (anchor, title, text) in items {
            let [anchor, title, text] = [anchor, title, &text].map(escape);
            let _ = writeln!(self.0, "<li><a href=\"#{anchor}\">{title}</a>{text}</li>");
        }
        self.0.push_str("</ul>\n");
    }

    /// Appends a table.
    ///
    /// A long table shows its marked rows and folds the whole. Duplicates are folded.
    pub(super) fn table<T>(
        &mut self,
        caption: &str,
        columns: &[Column<T>],
        groups: Vec<Group<'_, T>>,
        is_marked: fn(&T) -> bool,
    ) {
        let (folded, shown): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| g.is_folded);
        let count: usize = shown.iter().map(|group| group.rows.len()).sum();
        let is_short = shown.iter().all(|group| group.rows.len() <= SHORT);
        if count > 0 && is_short {
            self.plain_table(caption, columns, &shown, is_marked);
        } else if count > 0 {
            let marked: Vec<Group<'_, T>> = (shown.iter())
                .map(|group| Group {
                    title: group.title.clone(),
                    rows: group
                        .rows
                        .iter()
                        .copied()
                        .filter(|row| is_marked(row))
                        .collect(),
                    is_folded: false,
                })
                .filter(|group| !group.rows.is_empty())
                .collect();
            if !marked.is_empty() {
                self.plain_table(&format!("{caption}: marked rows"), columns, &marked, |_| {
                    false
                });
            }
            self.details(&format!("{caption}: all {count} rows"), |html| {
                html.plain_table("", columns, &shown, is_marked);
            });
        }
        for group in folded {
            let title = format!("{caption}: another run, {}", group.title);
            self.details(&title, |html| {
                html.plain_table("", columns, &[group], is_marked)
            });
        }
    }

    fn plain_table<T>(
        &mut self,
        caption: &str,
        columns: &[Column<T>],
        groups: &[Group<'_, T>],
        is_marked: fn(&T) -> bool,
    ) {
        let rows: Vec<&T> = groups
            .iter()
            .flat_map(|group| &group.rows)
            .copied()
            .collect();
        let is_text = |column: &Column<T>| text_table::is_text(column, &rows);
        let classes = columns
            .iter()
            .map(|c| if is_text(c) { " class=\"text\"" } else { "" });
        let classes: Vec<&str> = classes.collect();
        self.0.push_str("<table>\n");
        if !caption.is_empty() {
            self.element("caption", caption);
        }
        self.0.push_str("<thead><tr>");
        for (class, (name, _)) in classes.iter().zip(columns) {
            let _ = write!(self.0, "<th{class}>{}</th>", escape(name));
        }
        self.0.push_str("</tr></thead>\n<tbody>\n");
        for group in groups {
            if !group.title.is_empty() {
                let (count, title) = (columns.len(), escape(&group.title));
                let _ = write!(
                    self.0,
                    "<tr><th class=\"group\" colspan=\"{count}\">{title}"
                );
                self.0.push_str("</th></tr>\n");
            }
            for row in &group.rows {
                self.0.push_str(if is_marked(row) {
                    "<tr class=\"bad\">"
                } else {
                    "<tr>"
                });
                for (class, (_, cell)) in classes.iter().zip(columns) {
                    let _ = write!(self.0, "<td{class}>{}</td>", escape(&cell(row)));
                }
                self.0.push_str("</tr>\n");
            }
        }
        self.0.push_str("</tbody></table>\n");
    }

    /// Appends content that is folded until it is opened.
    fn details(&mut self, summary: &str, content: impl FnOnce(&mut Self)) {
        self.0.push_str("<details>");
        self.element("summary", summary);
        content(self);
        self.0.push_str("</details>\n");
    }

    /// Appends a figure; a wide one takes a line for itself.
    pub(super) fn figure(&mut self, picture: &str, caption: &str, is_wide: bool) {
        let class = if is_wide { " class=\"wide\"" } else { "" };
        let _ = write!(self.0, "<figure{class}>{picture}");
        self.element("figcaption", caption);
        self.0.push_str("</figure>\n");
    }

    /// Appends figures side by side.
    pub(super) fn figures(&mut self, content: impl FnOnce(&mut Self)) {
        self.0.push_str("<div class=\"figures\">\n");
        content(self);
        self.0.push_str("</div>\n");
    }

    fn element(&mut self, name: &str, text: &str) {
        let _ = writeln!(self.0, "<{name}>{}</{name}>", escape(text));
    }
}

/// Returns an embedded PNG.
pub(super) fn png(bytes: &[u8], name: &str) -> String {
    let (name, data) = (escape(name), base64(bytes));
    format!("<img alt=\"{name}\" src=\"data:image/png;base64,{data}\">")
}

/// Returns an SVG file as an element, without its XML header.
pub(super) fn svg(file: &str) -> String {
    let begin = file.find("<svg").unwrap_or(0);
    file[begin..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1)
}

/// Encodes bytes as base64.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for i in 0..4 {
            let digit = char::from(DIGITS[(bits >> (18 - 6 * i)) as usize & 63]);
            text.push(if i <= group.len() { digit } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        let text = "<script>alert('x' & \"y\")</script>";
        let escaped = "&lt;script&gt;alert(&#39;x&#39; &amp; &quot;y&quot;)&lt;/script&gt;";
        let mut html = Html::default();
        html.heading("a", text);
        html.subheading(text);
        html.paragraph(text);
        html.note(text);
        html.links([("a", text, text.to_owned())]);
        let rows = [text];
        let group = Group {
            title: text.to_owned(),
            rows: rows.iter().collect(),
            is_folded: false,
        };
        let columns: [Column<&str>; 1] = [("t", |row| (*row).to_owned())];
        html.table(text, &columns, vec![group], |_| true);
        html.figure(&png(b"x", text), text, false);
        assert!(!html.0.contains("<script"), "{}", html.0);
        assert_eq!(html.0.matches(escaped).count(), 11, "{}", html.0);
    }

    #[test]
    fn long_tables_and_duplicates_are_folded() {
        let rows: Vec<usize> = (0..100).collect();
        let group = |count: usize, is_folded| Group {
            title: String::new(),
            rows: rows[..count].iter().collect(),
            is_folded,
        };
        let page = |groups| {
            let mut html = Html::default();
            let columns: [Column<usize>; 1] = [("name", |row| format!("row {row}"))];
            html.table("T", &columns, groups, |row| *row == 3);
            html.0
        };
        assert!(!page(vec![group(SHORT, false)]).contains("<details>"));
        let long = page(vec![group(SHORT + 1, false)]);
        assert_eq!(
            long.matches("row 3<").count(),
            2,
            "marked, and among all: {long}"
        );
        assert_eq!(long.matches("row 2<").count(), 1, "{long}");
        let twice = page(vec![group(2, false), group(2, true)]);
        assert_eq!(twice.matches("<details>").count(), 1, "{twice}");
    }

    #[test]
    fn bytes_are_base64() {
        let pairs = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
        ];
        for (bytes, text) in pairs {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[255, 254, 253]), "//79");
    }
}
