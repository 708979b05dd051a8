//! The table of a sweep that papers show: swept values and figures with their units, of meshes how they converge; as CSV and as LaTeX.

use crate::csv::quoted;
use crate::record::{ConvergenceRecord, Number};
use crate::sweep::chart::short_name;
use crate::sweep::figure::{Figure, labelled};
use crate::sweep::row::SweepRow;

/// Digits of numbers in LaTeX.
const DIGITS: usize = 6;

/// A table of texts and numbers.
pub(super) struct ShownTable {
    /// Names of columns, and their units.
    head: Vec<(String, String)>,
    rows: Vec<Vec<Cell>>,
}

enum Cell {
    Text(String),
    Whole(usize),
    Number(Option<f64>),
}

impl ShownTable {
    /// Of the figures in all rows.
    pub fn of_figures(figures: &[Figure], rows: &[SweepRow]) -> Self {
        let values = rows.first().map_or(&[][..], |row| row.values.as_slice());
        let swept = values.iter().map(|(path, _)| (path.clone(), String::new()));
        let head = swept.chain(figures.iter().map(|figure| (figure.path.clone(), figure.unit.clone()))).collect();
        let row = |row: &SweepRow| {
            let values = row.values.iter().map(|(_, text)| Cell::Text(short_name(text)));
            values.chain(figures.iter().map(|figure| Cell::Number(row.number(&figure.path)))).collect()
        };
        Self { head, rows: rows.iter().map(row).collect() }
    }

    /// Of how a figure converges.
    pub fn of_convergence(figure: &Figure, records: &[ConvergenceRecord], rows: &[SweepRow]) -> Self {
        let of_run = |run: &str| rows.iter().find(|row| row.directory == run);
        let values = rows.first().map_or(&[][..], |row| row.values.as_slice());
        let mut head: Vec<(String, String)> = values.iter().map(|(path, _)| (path.clone(), String::new())).collect();
        let Figure { path, unit } = figure;
        let own = [
            ("cells", ""),
            ("unknowns", ""),
            (path.as_str(), unit.as_str()),
            ("difference to the finest", unit),
            ("relative difference", ""),
            ("observed order", ""),
        ];
        head.extend(own.map(|(name, unit)| (name.to_owned(), unit.to_owned())));
        let row = |record: &ConvergenceRecord| {
            let values = of_run(&record.run).map_or(&[][..], |row| row.values.as_slice());
            let number = |number: Number| Cell::Number(*number);
            let mut cells: Vec<Cell> = values.iter().map(|(_, text)| Cell::Text(short_name(text))).collect();
            cells.extend([Cell::Whole(record.cells), Cell::Whole(record.unknowns)]);
            cells.extend([record.value, record.difference, record.relative_difference, record.order].map(number));
            cells
        };
        Self { head, rows: records.iter().map(row).collect() }
    }

    /// As CSV, units in the heads of columns; nothing stands where a number is not known.
    pub fn csv(&self) -> String {
        let head = self.head.iter().map(|(name, unit)| quoted(&labelled(name, unit)));
        let mut text = head.collect::<Vec<_>>().join(",") + "\n";
        for row in &self.rows {
            let cell = |cell: &Cell| match cell {
                Cell::Text(text) => quoted(text),
                Cell::Whole(count) => count.to_string(),
                Cell::Number(number) => number.map_or_else(String::new, |x| format!("{x:?}")),
            };
            text += &(row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    /// As a `tabular` of LaTeX with the rules of the package booktabs.
    pub fn latex(&self) -> String {
        let is_text = |k: usize| self.rows.iter().any(|row| matches!(row.get(k), Some(Cell::Text(_))));
        let columns: String = (0..self.head.len()).map(|k| if is_text(k) { 'l' } else { 'r' }).collect();
        let names = self.head.iter().map(|(name, unit)| match unit.as_str() {
            "" => escaped(name),
            unit => format!("{} ({})", escaped(name), latex_unit(unit)),
        });
        let mut text = format!(
            "% needs \\usepackage{{booktabs}}\n\\begin{{tabular}}{{{columns}}}\n\\toprule\n{} \\\\\n\\midrule\n",
            names.collect::<Vec<_>>().join(" & ")
        );
        for row in &self.rows {
            let cell = |cell: &Cell| match cell {
                Cell::Text(text) => escaped(text),
                Cell::Whole(count) => count.to_string(),
                Cell::Number(number) => number.map_or_else(|| "--".to_owned(), latex_number),
            };
            text += &(row.iter().map(cell).collect::<Vec<_>>().join(" & ") + " \\\\\n");
        }
        text + "\\bottomrule\n\\end{tabular}\n"
    }
}

/// A text whose signs LaTeX would take for its own.
fn escaped(text: &str) -> String {
    let sign = |c: char| match c {
        '\\' => "\\textbackslash{}".to_owned(),
        '~' => "\\textasciitilde{}".to_owned(),
        '^' => "\\textasciicircum{}".to_owned(),
        '_' | '&' | '%' | '$' | '#' | '{' | '}' => format!("\\{c}"),
        other => other.to_string(),
    };
    text.chars().map(sign).collect()
}

/// `$\mathrm{N\,mm^{2}}$`
fn latex_unit(unit: &str) -> String {
    let part = |part: &str| match part.split_once('^') {
        Some((base, exponent)) => format!("{base}^{{{exponent}}}"),
        None => part.to_owned(),
    };
    let parts: Vec<String> = unit.split([' ', '*']).map(part).collect();
    format!("$\\mathrm{{{}}}$", parts.join("\\,"))
}

/// `$1.234 \times 10^{-5}$`, and plainly where that is short.
fn latex_number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1e-3..1e6).contains(&size) {
        let places = if x == 0.0 { 0 } else { (DIGITS as i32 - 1 - size.log10().floor() as i32).max(0) as usize };
        return format!("${x:.places$}$");
    }
    let text = format!("{x:.*e}", DIGITS - 1);
    let (factor, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("${factor} \\times 10^{{{exponent}}}$")
}
