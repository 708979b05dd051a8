//! Commas in numbers of tables that may separate thousands or decimals.

use super::test_sheet::Cell;
use super::test_table::Wrong;

/// A column with decimal commas elsewhere in its table that has such a number without one has thousands.
const LARGE: f64 = 100.0;

/// What is wrong with numbers whose commas may be either: every comma of a column stands before three digits, and some number has none, or a point, or
/// commas separate the cells, where a decimal one is rare. Decimal commas of the other column settle it, but beside [large](LARGE) numbers.
pub(super) fn doubt(rows: &[(usize, Vec<Cell>)], columns: [usize; 2], separator: char) -> Option<Wrong> {
    let cells = |column: usize| rows.iter().filter_map(move |(line, cells)| Some((*line, cells.get(column)?)));
    let all = || columns.into_iter().flat_map(cells);
    let plain = |cell: &Cell| cell.text.parse::<f64>().ok().filter(|_| !cell.text.contains(','));
    let decimal = all().any(|(_, cell)| of_thousands(cell) == Some(false));
    let without = separator == ',' || all().any(|(_, cell)| plain(cell).is_some());
    columns.into_iter().find_map(|column| {
        let (line, cell) = cells(column).find(|(_, cell)| of_thousands(cell) == Some(true))?;
        let own_decimal = cells(column).any(|(_, cell)| of_thousands(cell) == Some(false));
        let large = cells(column).any(|(_, cell)| plain(cell).is_some_and(|number| number.abs() >= LARGE));
        (!own_decimal && if decimal { large } else { without }).then(|| {
            let (thousands, point) = (cell.text.replace(',', ""), cell.text.replace(',', "."));
            let text = &cell.text;
            let what = format!(
                "\"{text}\" may be {thousands} or {point}: write numbers with a point, and thousands without a separator"
            );
            (line, cell.column, what)
        })
    })
}

/// Whether the comma of a number may separate thousands; none of a number without.
fn of_thousands(cell: &Cell) -> Option<bool> {
    let (whole, rest) = cell.text.trim_start_matches(['-', '+']).split_once(',')?;
    let group = (1..=3).contains(&whole.len()) && whole != "0";
    Some(group && rest.len() == 3 && rest.bytes().all(|b| b.is_ascii_digit()))
}
