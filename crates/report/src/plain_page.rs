//! A page of tables and drawings, without programs: that of a sweep, of a fit.

use crate::html::escape;

const STYLE: &str = include_str!("../assets/page.css");

/// The page.
pub(crate) fn plain_page(title: &str, subtitle: &str, body: &str) -> String {
    let (title, subtitle) = (escape(title), escape(subtitle));
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{title} – nastic report</title>
<style>
{STYLE}</style>
</head>
<body>
<header>
<div><h1>{title}</h1><p>{subtitle}</p></div>
</header>
<main>
{body}</main>
</body>
</html>
"#
    )
}

/// A drawing within the page; nothing where the file is no SVG.
pub(crate) fn drawing(svg: &str) -> String {
    svg.find("<svg").map_or_else(String::new, |at| format!("<figure class=\"drawing\">{}</figure>\n", &svg[at..]))
}
