//! Text as HTML, tables, and a page around them. Everything that comes from a file is escaped; nothing is loaded from
//! anywhere.

use std::fmt::Write;

/// Text that cannot be taken for markup, in elements and in attributes.
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

/// Tables of so many rows are kept on one sheet of paper.
const SHORT: usize = 16;

/// Markup, put together piece by piece.
#[derive(Debug, Default)]
pub(super) struct Html(String);

impl Html {
    /// A heading, by which the page is divided.
    pub(super) fn heading(&mut self, text: &str) {
        self.element("h2", text);
    }

    /// A heading below it.
    pub(super) fn subheading(&mut self, text: &str) {
        self.element("h3", text);
    }

    pub(super) fn paragraph(&mut self, text: &str) {
        self.element("p", text);
    }

    /// A paragraph for what is not there.
    pub(super) fn missing(&mut self, text: &str) {
        self.markup("<p class=\"missing\">");
        self.markup(&escape(text));
        self.markup("</p>\n");
    }

    /// A list of paragraphs.
    pub(super) fn list(&mut self, items: &[String]) {
        self.markup("<ul>\n");
        for item in items {
            self.element("li", item);
        }
        self.markup("</ul>\n");
    }

    /// A table with a caption. Cells of the columns that `texts` names are text, which is broken; those of all others stand
    /// right and are not. A row that `is_marked` stands out.
    pub(super) fn table<const N: usize>(
        &mut self,
        caption: &str,
        names: [&str; N],
        texts: &[usize],
        rows: &[([String; N], bool)],
    ) {
        let is_short = rows.len() <= SHORT;
        self.markup(if is_short {
            "<table class=\"short\">\n"
        } else {
            "<table>\n"
        });
        if !caption.is_empty() {
            self.element("caption", caption);
        }
        self.markup("<thead><tr>");
        self.cells("th", &names.map(str::to_owned), texts);
        self.markup("</tr></thead>\n<tbody>\n");
        for (cells, is_marked) in rows {
            self.markup(if *is_marked {
                "<tr class=\"bad\">"
            } else {
                "<tr>"
            });
            self.cells("td", cells, texts);
            self.markup("</tr>\n");
        }
        self.markup("</tbody></table>\n");
    }

    fn cells(&mut self, name: &str, cells: &[String], texts: &[usize]) {
        for (i, cell) in cells.iter().enumerate() {
            let class = if texts.contains(&i) {
                " class=\"text\""
            } else {
                ""
            };
            // A string takes whatever is written.
            let _ = write!(self.0, "<{name}{class}>{}</{name}>", escape(cell));
        }
    }

    /// A figure: markup of a picture, and what it shows. Wide ones take a line for themselves.
    pub(super) fn figure(&mut self, picture: &str, caption: &str, is_wide: bool) {
        self.markup(if is_wide {
            "<figure class=\"wide\">"
        } else {
            "<figure>"
        });
        self.markup(picture);
        self.element("figcaption", caption);
        self.markup("</figure>\n");
    }

    /// A picture, as part of the page.
    pub(super) fn png(bytes: &[u8], name: &str) -> String {
        let (name, data) = (escape(name), base64(bytes));
        format!("<img alt=\"{name}\" src=\"data:image/png;base64,{data}\">")
    }

    /// A chart, as part of the page: what belongs to a file of its own is taken off.
    pub(super) fn svg(file: &str) -> String {
        let begin = file.find("<svg").unwrap_or(0);
        file[begin..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1)
    }

    /// Figures that stand beside each other where there is room.
    pub(super) fn beside(&mut self, figures: impl FnOnce(&mut Self)) {
        self.markup("<div class=\"figures\">\n");
        figures(self);
        self.markup("</div>\n");
    }

    fn element(&mut self, name: &str, text: &str) {
        let _ = writeln!(self.0, "<{name}>{}</{name}>", escape(text));
    }

    fn markup(&mut self, markup: &str) {
        self.0.push_str(markup);
    }

    /// The whole page.
    pub(super) fn page(self, title: &str) -> String {
        let title = escape(title);
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{}</body>\n</html>\n",
            self.0
        )
    }
}

const STYLE: &str = include_str!("style.css");

/// Bytes as letters, four for three.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= group.len() {
                char::from(digit)
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_no_markup() {
        let text = "<script>alert('x' & \"y\")</script>";
        let escaped = escape(text);
        assert_eq!(
            escaped,
            "&lt;script&gt;alert(&#39;x&#39; &amp; &quot;y&quot;)&lt;/script&gt;"
        );
        let mut html = Html::default();
        html.heading(text);
        html.subheading(text);
        html.paragraph(text);
        html.missing(text);
        html.list(&[text.to_owned()]);
        html.table(
            text,
            [text; 2],
            &[1],
            &[([text.to_owned(), text.to_owned()], true)],
        );
        html.figure(&Html::png(b"x", text), text, false);
        let page = html.page(text);
        assert!(!page.contains("<script"), "{page}");
        assert_eq!(page.matches(&escaped).count(), 14, "{page}");
    }

    #[test]
    fn bytes_are_letters() {
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
