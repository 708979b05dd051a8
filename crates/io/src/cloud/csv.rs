//! Clouds as CSV.

use super::{At, PointCloud, ReadError, malformed};
use std::io::{self, Write};
use std::path::Path;

pub(super) fn read(file: &Path, content: &[u8]) -> Result<Vec<[f64; 3]>, ReadError> {
    let text = String::from_utf8_lossy(content);
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let lines = lines.map(|(k, line)| (k as u64 + 1, line.split('#').next().unwrap_or_default().trim()));
    let mut rows = lines.filter(|(_, line)| !line.is_empty()).peekable();
    let mut columns = vec![0, 1, 2];
    let mut given = false;
    if let Some((at, names)) = rows.next_if(|(_, line)| words(line).any(|word| number(word, line).is_none())) {
        columns = named(&words(names).collect::<Vec<_>>()).ok_or_else(|| {
            malformed(file, "the names of columns", At::Line(at), format!("{names:?} has no x and y"))
        })?;
        given = true;
    }
    let mut points = Vec::new();
    for (at, line) in rows {
        let numbers: Vec<&str> = words(line).collect();
        if !given {
            columns.truncate(numbers.len().clamp(2, 3));
            given = true;
        }
        let mut point = [0.0; 3];
        for (x, &column) in point.iter_mut().zip(&columns) {
            let word = numbers.get(column).copied().unwrap_or_default();
            *x = number(word, line).ok_or_else(|| {
                malformed(file, "the points", At::Line(at), format!("column {} is {word:?}, not a number", column + 1))
            })?;
        }
        points.push(point);
    }
    Ok(points)
}

/// What separates the cells of a line; nothing of blanks.
fn separator(line: &str) -> Option<char> {
    if line.contains('\t') && !line.contains([';', '"']) && !line.contains(",\t") {
        // names may have blanks: tabs alone separate them
        let is_number = |word: &str| word.replace(',', ".").parse::<f64>().is_ok();
        return if line.split_whitespace().all(is_number) { None } else { Some('\t') };
    }
    [';', '\t', ','].into_iter().find(|by| line.contains(*by) && !(*by == '\t' && line.contains(",\t")))
}

/// What stands between semicolons, tabs, commas or blanks.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let cells: Vec<&str> = match separator(line) {
        Some(by) => line.split(by).map(|cell| cell.trim().trim_matches('"')).collect(),
        None => line.split_whitespace().collect(),
    };
    cells.into_iter()
}

/// A number; with a decimal comma where commas separate nothing.
fn number(word: &str, line: &str) -> Option<f64> {
    let decimal = separator(line) != Some(',') && word.matches(',').count() == 1 && !word.contains('.');
    if decimal { word.replace(',', ".").parse().ok() } else { word.parse().ok() }
}

/// The columns x, y and z, units in brackets behind them or not; in capitals, or as ParaView calls points, where no others are there.
fn named(names: &[&str]) -> Option<Vec<usize>> {
    let bare: Vec<&str> = names.iter().map(|name| name.split(['[', '(']).next().unwrap_or(name).trim()).collect();
    let find = |wanted: [&str; 3]| {
        let columns: Vec<usize> = wanted.iter().map_while(|name| bare.iter().position(|own| own == name)).collect();
        (columns.len() >= 2).then_some(columns)
    };
    find(["x", "y", "z"]).or_else(|| find(["X", "Y", "Z"])).or_else(|| find(["Points:0", "Points:1", "Points:2"]))
}

pub(super) fn write(out: &mut dyn Write, cloud: &PointCloud) -> io::Result<()> {
    writeln!(out, "node,X,Y,Z,x,y,z")?;
    for ((node, [a, b, c]), [x, y, z]) in cloud.nodes.iter().zip(&cloud.reference).zip(&cloud.points) {
        writeln!(out, "{node},{a},{b},{c},{x},{y},{z}")?;
    }
    Ok(())
}
