//! Commas in numbers of tables that may separate thousands or decimals.

use super::test_sheet::Cell;
use super::test_table::Wrong;

/// What is wrong with a column in which commas may be either: every one of them stands before three digits, and other numbers of it have none, or
/// some number has a point.
pub(super) fn doubt(rows: &[(usize, Vec<Cell>)], column: usize) -> Option<Wrong> {
    let cells = || rows.iter().filter_map(|(line, cells)| Some((*line, cells.get(column)?)));
    let of_thousands = |cell: &Cell| {
        let (whole, rest) = cell.text.trim_start_matches(['-', '+']).split_once(',')?;
        Some(
            (1..=3).contains(&whole.len())
                && whole != "0"
                && rest.len() == 3
                && rest.bytes().all(|b| b.is_ascii_digit()),
        )
    };
    let first = cells().find(|(_, cell)| of_thousands(cell) == Some(true))?;
    let decimal = cells().any(|(_, cell)| of_thousands(cell) == Some(false));
    let without = cells().any(|(_, cell)| !cell.text.contains(',') && cell.text.parse::<f64>().is_ok_and(|x| x != 0.0));
    (without && !decimal).then(|| {
        let (line, cell) = first;
        let (thousands, point) = (cell.text.replace(',', ""), cell.text.replace(',', "."));
        let what = format!(
            "\"{}\" may be {thousands} or {point}, as other numbers of the column have no comma: write numbers with a point, and thousands \
             without a separator",
            cell.text
        );
        (line, cell.column, what)
    })
}
