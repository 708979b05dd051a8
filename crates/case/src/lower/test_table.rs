//! Tables of test data: CSV with a line of column names and units, stresses and stretches or the forces and extensions of a specimen.

use super::test_columns::{Column, Columns, EXTENSION, FORCE, STRAIN, Specimen, columns, names, wanted};
use super::test_sheet::{Cell, Line, Sheet, decoded, number};
use super::{test_course, test_stiffness, thousands};
use nastic_fit::{FitError, Mode, Response, Test};
use nastic_language::number::short;
use nastic_language::schema::{FitData, FitKind, FitTest};
use nastic_language::syntax::{Diagnostic, Diagnostics, Document, quoted};
use std::path::Path;

/// Where something is wrong: line and column from 1, 0 for the file as a whole.
pub(super) type Wrong = (usize, usize, String);

/// Lines that may stand above that of the columns: what a machine says of the specimen.
const MOST_ABOVE: usize = 200;
/// Rows that are reported one by one.
const MOST_WRONG: usize = 10;

/// Strains beyond this, 1000 %, no rubber bears: percent were meant.
const LARGEST_STRAIN: f64 = 10.0;

/// The tables of a data file, with what deserves attention in them.
///
/// # Errors
/// A file that cannot be read, an invalid row: all that is wrong with any.
pub fn read_tests(document: &Document, asked: &FitData) -> Result<(Vec<Test>, Vec<String>), Diagnostics> {
    let (mut tests, mut doubtful, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for test in &asked.tests {
        match read(document, test, mode(test)) {
            Ok((read, doubt)) => {
                tests.push(read);
                doubtful.extend(doubt);
            }
            Err(found) => problems.extend(found.list().iter().cloned()),
        }
    }
    Diagnostics::new(problems).into_result().map(|()| (tests, doubtful))
}

fn mode(test: &FitTest) -> Mode {
    match test.kind {
        FitKind::Uniaxial => Mode::Uniaxial,
        FitKind::Equibiaxial => Mode::Equibiaxial,
        FitKind::Planar => Mode::Planar,
        FitKind::SimpleShear => Mode::SimpleShear,
        // the schema has seen to it that there is one
        FitKind::Inflation => Mode::Inflation { thickness_to_radius: test.thickness_to_radius.unwrap_or(f64::NAN) },
        FitKind::Volumetric => Mode::Volumetric,
    }
}

/// Reads the table of a test, and what deserves attention in it.
fn read(document: &Document, test: &FitTest, mode: Mode) -> Result<(Test, Vec<String>), Diagnostics> {
    let path = document.resolve(&test.file);
    let bytes = std::fs::read(&path).map_err(|error| {
        document.complain(&test.at.key("file"), format!("{} cannot be read: {error}", path.display()))
    })?;
    let text = decoded(bytes);
    let specimen = Specimen { area: test.area, length: test.length };
    let Table { response, rows, is_strain, uses, taken } = parse(&text, mode, specimen).map_err(|wrong| {
        let report = |(line, column, message)| Diagnostic {
            file: path.display().to_string(),
            path: String::new(),
            line,
            column,
            message,
        };
        Diagnostics::new(wrong.into_iter().map(report).collect())
    })?;
    for (key, given, column, used) in [("area", test.area, FORCE, uses[0]), ("length", test.length, EXTENSION, uses[1])]
    {
        if given.is_some() && !used {
            let message = format!("{} has no column \"{column}\" that it would be for", path.display());
            return Err(document.complain(&test.at.key(key), message).into());
        }
    }
    let stem =
        || Path::new(&test.file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name = test.name.clone().unwrap_or_else(stem);
    let points = rows.iter().map(|row| row.point).collect();
    let largest = rows.iter().map(|row| row.point[0] - 1.0).fold(0.0, f64::max);
    let doubtful = (is_strain && largest > LARGEST_STRAIN).then(|| {
        format!(
            "{}: \"strain\" reaches {}, which is {} %: if it is in percent, write \"strain [%]\"",
            path.display(),
            short(largest),
            short(100.0 * largest)
        )
    });
    let taken = taken.map(|name| {
        format!("{}: the column {} is taken as nominal stress, force over area at rest", path.display(), quoted(&name))
    });
    let doubtful: Vec<String> = doubtful.into_iter().chain(taken).collect();
    let made = Test::new(&name, mode, response, points).map_err(|error| match &error {
        FitError::Point { point, .. } => Diagnostics::from(Diagnostic {
            file: path.display().to_string(),
            path: String::new(),
            line: rows[*point].line,
            column: 1,
            message: error.to_string(),
        }),
        _ => document.complain(&test.at, error.to_string()).into(),
    })?;
    let made = match test.fibers.as_ref().map(|fibers| fibers.fibers()) {
        None => made,
        Some(fibers) => {
            made.loaded(fibers).map_err(|error| document.complain(&test.at.key("fibers"), error.to_string()))?
        }
    };
    let made = made.weighted(test.weight);
    let made = made.map_err(|error| document.complain(&test.at.key("weight"), error.to_string()))?;
    let file = path.display().to_string();
    let found = test_stiffness::doubtful(&made, &file).into_iter().chain(test_course::doubtful(&made, &file));
    let doubtful = doubtful.into_iter().chain(found).collect();
    Ok((made, doubtful))
}

/// What a table holds.
struct Table {
    response: Response,
    rows: Vec<Row>,
    /// Whether the deformations are strains as plain numbers.
    is_strain: bool,
    /// Whether they are forces over an area, and extensions over a length.
    uses: [bool; 2],
    /// The name of a column of stresses that does not say which.
    taken: Option<String>,
}

/// A row that was measured.
struct Row {
    line: usize,
    point: [f64; 2],
}

fn parse(text: &str, mode: Mode, specimen: Specimen) -> Result<Table, Vec<Wrong>> {
    let sheet = Sheet::new(text);
    let above = sheet.lines.iter().take(MOST_ABOVE).position(|line| names(&line.cells(line.separator()), mode));
    let Some(head) = sheet.lines.get(above.unwrap_or(0)) else {
        return Err(vec![(
            0,
            0,
            format!("the table is empty: a line of columns is wanted, as in \"{}\"", wanted(mode)[0]),
        )]);
    };
    let separator = head.separator();
    let mut below = sheet.lines[above.unwrap_or(0) + 1..].iter().peekable();
    let units = below.next_if(|line| is_line_of_units(line, separator)).map(|line| line.cells(separator));
    let Columns { x, y, response, taken } = columns(head, units.as_deref(), mode, specimen)?;
    let named = head.cells(separator).len();
    let (mut rows, mut wrong, mut surpluses) = (Vec::new(), Vec::new(), Vec::new());
    let rows_of: Vec<&Line> = below.collect();
    for line in &rows_of {
        let cells = line.cells(separator);
        if let Some(cell) = cells.get(named) {
            surpluses.push((line.number, cell.column, surplus(cells.len(), named, separator)));
            continue;
        }
        let value = |column: &Column| {
            let end = line.text.chars().count() + 1;
            let cell = cells.get(column.index);
            let cell = cell.ok_or_else(|| (line.number, end, format!("the row has no column {}", column.index + 1)))?;
            let what = || format!("{} is no number; leave out rows without one", quoted(&cell.text));
            let value = number(&cell.text).ok_or_else(|| (line.number, cell.column, what()))?;
            Ok(value * column.factor + column.shift)
        };
        match (value(&x), value(&y)) {
            (Ok(x), Ok(y)) => rows.push(Row { line: line.number, point: [x, y] }),
            (x, y) => wrong.extend([x, y].into_iter().filter_map(Result::err)),
        }
    }
    let body: Vec<(usize, Vec<Cell>)> = rows_of.iter().map(|line| (line.number, line.cells(separator))).collect();
    wrong.extend(thousands::doubt(&body, [x.index, y.index], separator));
    let more = surpluses.len().saturating_sub(1);
    if let Some((line, column, what)) = surpluses.into_iter().next() {
        let more = if more > 0 { format!("; so do {more} more lines") } else { String::new() };
        wrong.insert(0, (line, column, what + &more));
    }
    if rows.is_empty() && wrong.is_empty() {
        wrong.push((0, 0, "the table has no rows below its line of columns".to_owned()));
    }
    let more = wrong.len().saturating_sub(MOST_WRONG);
    if more > 0 {
        wrong.truncate(MOST_WRONG);
        wrong.push((0, 0, format!("and {more} more cells that are no numbers")));
    }
    let is_strain = x.name == STRAIN && x.factor == 1.0;
    let uses = [y.name == FORCE, x.name == EXTENSION];
    if wrong.is_empty() { Ok(Table { response, rows, is_strain, uses, taken }) } else { Err(wrong) }
}

/// Below the names: `(s),(mm),(N)`, without a number.
fn is_line_of_units(line: &Line, separator: char) -> bool {
    let cells = line.cells(separator);
    let mut said = cells.iter().filter(|cell| !cell.text.is_empty()).peekable();
    said.peek().is_some() && said.all(|cell| number(&cell.text).is_none())
}

/// A decimal comma splits a number into two cells, and the rest of the row moves on by one column.
fn surplus(cells: usize, named: usize, separator: char) -> String {
    let comma = if separator == ',' {
        ": are there decimal commas? Numbers have a point, or semicolons or tabs separate the columns"
    } else {
        ""
    };
    format!("the row has {cells} cells, but the line of columns has {named}{comma}")
}
