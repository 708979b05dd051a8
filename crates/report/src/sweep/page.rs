//! A sweep as a page: its chart, and its runs with their pages.

use super::SweepTable;
use crate::html::{escape, paragraph, section, table};
use crate::number::short;
use crate::plain_page::{drawing, plain_page};
use crate::record::{ConvergenceRecord, Number};
use crate::sweep::row::SweepRow;
use serde_json::Value;

/// Numbers that the table shows; `sweep.csv` has all.
const SHOWN: usize = 8;

impl SweepTable {
    /// The page, with the drawing of the sweep where there is one.
    pub(super) fn page(&self, svg: Option<&str>) -> String {
        let asked = &self.asked;
        let mut words: String =
            asked.swept.iter().map(|one| paragraph(&format!("{}: {}", one.path, one.values.join(", ")))).collect();
        words += &asked.fixed.iter().map(|one| paragraph(&format!("fixed: {one}"))).collect::<String>();
        if !self.missing.is_empty() {
            words += &paragraph(&format!("Missing runs: {}", self.missing.join(", ")));
        }
        let body = [
            section("swept", "What is swept", &words),
            section("chart", "Chart", &svg.map(drawing).unwrap_or_default()),
            section("convergence", "Convergence over meshes", &self.converging()),
            section("runs", "Runs", &self.runs()),
        ];
        plain_page(&self.title, &format!("{} of {}", asked.command, asked.case), &body.concat())
    }

    fn runs(&self) -> String {
        let figures = self.figures_shown();
        let swept = self.asked.swept.iter().map(|one| one.path.as_str());
        let head: String = ["run"]
            .into_iter()
            .chain(swept)
            .chain(["exit"])
            .chain(figures.iter().map(String::as_str))
            .map(|name| format!("<th>{}</th>", escape(name)))
            .collect();
        let rows: String = self.rows.iter().map(|row| line(row, &figures)).collect();
        let all = paragraph("sweep.csv has all numbers; each run's page is behind its name.");
        format!(
            "<div class=\"scroll\"><table><thead><tr>{head}<th></th></tr></thead>\n<tbody>{rows}</tbody></table></div>\n{all}"
        )
    }

    /// Differences to the finest mesh, and orders; nothing where no meshes are swept.
    fn converging(&self) -> String {
        let Some((figure, records)) = self.convergence() else { return String::new() };
        let row = |one: &ConvergenceRecord| {
            let text = |value: Number| value.map_or_else(|| "–".to_owned(), short);
            let numbers = [one.value, one.difference, one.relative_difference, one.order].map(text);
            let size = [one.run.clone(), one.cells.to_string(), one.unknowns.to_string()];
            size.into_iter().chain(numbers).collect()
        };
        let label = figure.label();
        let difference = "difference to the finest";
        let head = ["run", "cells", "unknowns", &label, difference, "relative difference", "observed order"];
        let rows: Vec<Vec<String>> = records.iter().map(row).collect();
        table(&head, &rows)
            + &paragraph("The order is that of this mesh and the two before it; sweep_table.tex has this table.")
    }

    /// The numbers of the chart, and what else distinguishes runs.
    fn figures_shown(&self) -> Vec<String> {
        let mut out: Vec<String> = self.figures().into_iter().map(|figure| figure.path).collect();
        for more in ["min_J", "iterations", "newton_iterations"] {
            if self.rows.iter().any(|row| row.figures.contains_key(more)) {
                out.push(more.to_owned());
            }
        }
        out.truncate(SHOWN);
        out
    }
}

fn line(row: &SweepRow, figures: &[String]) -> String {
    let name = escape(&row.directory);
    // what would end a path within an address
    let address =
        [("%", "%25"), ("#", "%23"), ("?", "%3F")].iter().fold(name.clone(), |to, (of, by)| to.replace(of, by));
    let mut cells = format!("<td><a href=\"{address}/report.html\">{name}</a></td>");
    let mut cell = |text: &str| cells += &format!("<td>{}</td>", escape(text));
    row.values.iter().for_each(|(_, value)| cell(value));
    cell(&row.exit.to_string());
    for figure in figures {
        cell(&row.number(figure).map_or_else(|| "-".to_owned(), short));
    }
    let remark = row.error.clone().or_else(|| row.figures.get("stop").and_then(Value::as_str).map(str::to_owned));
    let warnings =
        if row.warnings.is_empty() { String::new() } else { format!("warnings: {}", row.warnings.join(", ")) };
    cell(
        &[remark.unwrap_or_default(), warnings]
            .into_iter()
            .filter(|text| !text.is_empty())
            .collect::<Vec<_>>()
            .join("; "),
    );
    format!("<tr>{cells}</tr>\n")
}
