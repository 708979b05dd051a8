//! Markers of a shot: a CSV file with a line of names and units, or rows of the case.

use super::context::Context;
use super::coordinates;
use super::test_columns::{bare, scale, unit_of};
use super::test_sheet::{Cell, Line, Sheet, decoded, number};
use nastic_control::Marker;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{MarkerRow, MarkerTable};
use nastic_language::syntax::{At, quoted};
use nastic_mesh::Mesh;

/// Columns of the place at rest, and of the measured one; capitals are told apart.
const REFERENCE: [&str; 3] = ["X", "Y", "Z"];
const MEASURED: [&str; 3] = ["x", "y", "z"];
const NAME: &str = "name";
const DEVIATION: &str = "deviation";
/// Problems of a table that are reported one by one.
const MOST_WRONG: usize = 10;

/// What a table is read for.
pub(super) struct Wanted<'a> {
    pub mesh: &'a Mesh,
    /// The deviation of markers that have none of their own.
    pub deviation: Option<f64>,
    pub at: &'a At,
}

/// A marker, and how messages call its row.
struct Row {
    place: String,
    marker: Marker,
}

/// The markers of a table, all of them in the body; `None` after complaints.
pub(super) fn read(table: &MarkerTable, wanted: &Wanted<'_>, context: &mut Context<'_>) -> Option<Vec<Marker>> {
    let rows = match table {
        MarkerTable::Rows(rows) => of_case(rows, wanted, context),
        MarkerTable::File(file) => of_file(file, wanted, context),
    }?;
    if rows.is_empty() {
        context.complain(wanted.at, "no marker: give one at least");
        return None;
    }
    let again =
        rows.iter().enumerate().find(|(k, row)| rows[..*k].iter().any(|one| one.marker.name == row.marker.name));
    if let Some((_, row)) = again {
        let what = format!(
            "{}: another marker is called {} too: give each a name of its own",
            row.place,
            quoted(&row.marker.name)
        );
        context.complain(wanted.at, what);
        return None;
    }
    let outside = rows.iter().filter_map(|row| {
        let found = wanted.mesh.locate_inside(row.marker.reference);
        found.err().map(|error| format!("{}: {error}", row.place))
    });
    let outside: Vec<String> = outside.collect();
    complain(outside, wanted.at, context)?;
    Some(rows.into_iter().map(|row| row.marker).collect())
}

/// Reports what is wrong, the first of many; `None` if something is.
fn complain(wrong: Vec<String>, at: &At, context: &mut Context<'_>) -> Option<()> {
    let more = wrong.len().saturating_sub(MOST_WRONG);
    wrong.iter().take(MOST_WRONG).for_each(|why| context.complain(at, why));
    if more > 0 {
        context.complain(at, format!("and {more} more markers"));
    }
    wrong.is_empty().then_some(())
}

/// The rows that stand in the case.
fn of_case(rows: &[MarkerRow], wanted: &Wanted<'_>, context: &mut Context<'_>) -> Option<Vec<Row>> {
    let mut out = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let place = format!("marker {}", k + 1);
        let position = coordinates::given(&row.position, context)?;
        let Some(deviation) = row.deviation.or(wanted.deviation) else {
            context.complain(&row.at, no_deviation(&place));
            return None;
        };
        let name = row.name.clone().unwrap_or_else(|| place.clone());
        out.push(Row { place, marker: Marker { name, reference: row.point.xyz(), position, deviation } });
    }
    Some(out)
}

fn no_deviation(place: &str) -> String {
    format!("{place} has no deviation: give it one, or the cost a \"deviation\" for all, as \"0.1 mm\"")
}

/// The rows of a file.
fn of_file(file: &str, wanted: &Wanted<'_>, context: &mut Context<'_>) -> Option<Vec<Row>> {
    let path = context.file(file);
    let bytes = std::fs::read(&path).map_err(|error| format!("{} cannot be read: {error}", path.display()));
    let text = decoded(context.take(wanted.at, bytes)?);
    let sheet = Sheet::new(&text);
    let metre = context.units.in_case(1.0, Dimension::LENGTH);
    let parsed = parse(&sheet, metre, wanted);
    parsed
        .map_err(|wrong| {
            let named = wrong.into_iter().map(|(line, why)| match line {
                0 => format!("{file}: {why}"),
                line => format!("line {line} of {file}: {why}"),
            });
            complain(named.collect(), wanted.at, context)
        })
        .ok()
        .map(|rows| rows.into_iter().map(|(line, row)| row.named(line, file)).collect())
}

/// A row of a file, before it is known how it is called.
struct Read {
    name: Option<String>,
    reference: [f64; 3],
    position: [Option<f64>; 3],
    deviation: f64,
}

impl Read {
    fn named(self, line: usize, file: &str) -> Row {
        let Read { name, reference, position, deviation } = self;
        let place = format!("line {line} of {file}");
        let name = name.unwrap_or_else(|| place.clone());
        Row { place, marker: Marker { name, reference, position, deviation } }
    }
}

/// A column of lengths: its place, and the case's units of length in one of its own.
#[derive(Clone, Copy)]
struct Column {
    index: usize,
    factor: f64,
}

/// The columns of a table.
#[derive(Default)]
struct Columns {
    name: Option<usize>,
    reference: [Option<Column>; 3],
    measured: [Option<Column>; 3],
    deviation: Option<Column>,
}

/// What is wrong with a line, 0 for the file as a whole.
type Wrong = (usize, String);

fn parse(sheet: &Sheet<'_>, metre: f64, wanted: &Wanted<'_>) -> Result<Vec<(usize, Read)>, Vec<Wrong>> {
    const HEAD: &str = "a line of columns is wanted first, as in `X [mm],Y [mm],Z [mm],x [mm],y [mm],z [mm]`";
    let Some(head) = sheet.lines.first() else { return Err(vec![(0, format!("the table is empty: {HEAD}"))]) };
    let columns = columns(head, metre).map_err(|why| vec![(head.number, why)])?;
    let lacks = REFERENCE.iter().zip(&columns.reference).take(wanted.mesh.dim()).find(|(_, column)| column.is_none());
    if let Some((name, _)) = lacks {
        return Err(vec![(head.number, format!("no column {}, the place at rest: {HEAD}", quoted(name)))]);
    }
    if columns.measured.iter().all(Option::is_none) {
        return Err(vec![(head.number, format!("no column \"x\", \"y\" or \"z\", the measured place: {HEAD}"))]);
    }
    let separator = head.separator();
    let of_head = head.cells(separator).len();
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    for line in &sheet.lines[1..] {
        let cells = line.cells(separator);
        let more = cells.iter().skip(of_head).any(|cell| !cell.text.is_empty());
        let read = match more {
            true => Err(format!(
                "{} cells below {of_head} columns: numbers with decimal commas need another separator, as \";\"",
                cells.len()
            )),
            false => row(&cells, &columns, wanted.deviation),
        };
        match read {
            Ok(Some(row)) => rows.push((line.number, row)),
            // the marker was not seen
            Ok(None) => {}
            Err(why) => wrong.push((line.number, why)),
        }
    }
    if wrong.is_empty() { Ok(rows) } else { Err(wrong) }
}

/// A row; `None` of a marker without a measured coordinate.
fn row(cells: &[Cell], columns: &Columns, usual: Option<f64>) -> Result<Option<Read>, String> {
    let value = |column: Column| {
        let cell = cells.get(column.index).filter(|cell| !cell.text.is_empty());
        let read = |cell: &Cell| number(&cell.text).ok_or_else(|| format!("{} is no number", quoted(&cell.text)));
        cell.map(|cell| Ok::<f64, String>(read(cell)? * column.factor)).transpose()
    };
    let (mut reference, mut position) = ([0.0; 3], [None; 3]);
    for (place, column) in position.iter_mut().zip(columns.measured) {
        *place = column.map(value).transpose()?.flatten();
    }
    if position.iter().all(Option::is_none) {
        return Ok(None);
    }
    for ((place, column), name) in reference.iter_mut().zip(columns.reference).zip(REFERENCE) {
        let Some(column) = column else { continue };
        *place = value(column)?.ok_or_else(|| format!("no number in column {}", quoted(name)))?;
    }
    let own = columns.deviation.map(value).transpose()?.flatten();
    let deviation = own.or(usual).ok_or_else(|| no_deviation("the marker"))?;
    if deviation <= 0.0 {
        return Err(format!("the deviation is {deviation}; deviations are positive"));
    }
    let name = columns.name.and_then(|index| cells.get(index)).map(|cell| cell.text.clone());
    Ok(Some(Read { name: name.filter(|name| !name.is_empty()), reference, position, deviation }))
}

/// The columns by their names; columns of other names are not looked at.
fn columns(head: &Line<'_>, metre: f64) -> Result<Columns, String> {
    let mut out = Columns::default();
    let mut symbols: Vec<(String, Option<String>)> = Vec::new();
    for (index, cell) in head.cells(head.separator()).iter().enumerate() {
        let name = bare(&cell.text);
        let axis = |names: [&str; 3]| names.iter().position(|own| *own == name);
        let place = match (axis(REFERENCE), axis(MEASURED)) {
            (Some(i), _) => &mut out.reference[i],
            (_, Some(i)) => &mut out.measured[i],
            _ if name.eq_ignore_ascii_case(DEVIATION) => &mut out.deviation,
            _ => {
                if name.eq_ignore_ascii_case(NAME) && out.name.replace(index).is_some() {
                    return Err("two columns are called \"name\"".to_owned());
                }
                continue;
            }
        };
        let symbol = unit_of(&cell.text).map_err(|why| format!("{} {why}", quoted(name)))?;
        let factor = match symbol {
            // a plain number, as in the case
            None => 1.0,
            Some(_) => {
                let scale = scale(symbol, Dimension::LENGTH, "a length", "as in \"X [mm]\" (m, cm, mm, um, in)");
                metre * scale.map_err(|why| format!("{} {why}", quoted(name)))?
            }
        };
        symbols.push((name.to_owned(), symbol.map(str::to_owned)));
        if place.replace(Column { index, factor }).is_some() {
            return Err(format!("two columns are called {}", quoted(name)));
        }
    }
    disagree(&symbols).map_or(Ok(out), Err)
}

/// Units beside plain numbers: one of both was forgotten.
fn disagree(symbols: &[(String, Option<String>)]) -> Option<String> {
    let plain = symbols.iter().find(|(_, symbol)| symbol.is_none())?;
    let (name, symbol) = symbols.iter().find_map(|(name, symbol)| Some((name, symbol.as_ref()?)))?;
    let (name, plain) = (quoted(name), quoted(&plain.0));
    Some(format!("{name} is in {symbol}, {plain} has no unit: give all columns of lengths units, or none"))
}
