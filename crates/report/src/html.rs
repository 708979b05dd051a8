//! Pieces of HTML.

/// A text as the content of an element or an attribute.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(other),
        }
    }
    out
}

/// A section with a heading; nothing without content.
pub(crate) fn section(id: &str, heading: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!("<section id=\"{id}\" aria-labelledby=\"{id}-h\"><h2 id=\"{id}-h\">{heading}</h2>\n{content}</section>\n")
}

/// A paragraph.
pub(crate) fn paragraph(text: &str) -> String {
    // No break within 1.5e-7: a word joiner behind the sign.
    format!("<p>{}</p>\n", escape(text).replace("e-", "e-\u{2060}"))
}

/// A table; the first column is text, the others are numbers.
pub(crate) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let cells = |cells: &mut dyn Iterator<Item = &str>, tag: &str| {
        cells.map(|text| format!("<{tag}>{}</{tag}>", escape(text))).collect::<String>()
    };
    let head = cells(&mut head.iter().copied(), "th");
    let body: String =
        rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(&mut row.iter().map(String::as_str), "td"))).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n")
}

/// Figures side by side: name, value, remark.
pub(crate) fn tiles(tiles: &[(String, String, String)]) -> String {
    let of = |(name, value, remark): &(String, String, String)| {
        let (name, value, remark) = (escape(name), escape(value), escape(remark));
        format!("<div><dt>{name}</dt><dd>{value}<small>{remark}</small></dd></div>\n")
    };
    let all: String = tiles.iter().map(of).collect();
    if all.is_empty() { all } else { format!("<dl class=\"tiles\">\n{all}</dl>\n") }
}

/// Something long, folded.
pub(crate) fn folded(summary: &str, content: &str) -> String {
    format!("<details><summary>{}</summary>\n{content}</details>\n", escape(summary))
}
