//! Points, and cells in their two forms.

use super::cursor::Cursor;
use super::kind::Kind;
use crate::error::ReadError;
use crate::grid::{CORRUPT, LagrangeOrder, ListedCell, OTHER_CELLS, Refused, cell};

/// `POINTS count type`.
pub(super) fn points(cursor: &mut Cursor) -> Result<Vec<[f64; 3]>, ReadError> {
    let words = cursor.words();
    let (count, kind) = (cursor.count(&words, 0)?, cursor.kind(&words, 1)?);
    let count = count.checked_mul(3).ok_or_else(|| cursor.malformed(format!("{count} points cannot be"), CORRUPT))?;
    let values = cursor.numbers(kind, count)?.into_reals();
    Ok(values.as_chunks::<3>().0.to_vec())
}

/// Nodes of all cells and where each begins.
pub(super) struct CellNodes {
    offsets: Vec<i64>,
    nodes: Vec<i64>,
}

/// `CELLS`: of version 5 offsets and nodes as two arrays, before that each cell's number of nodes before them.
pub(super) fn nodes(cursor: &mut Cursor) -> Result<CellNodes, ReadError> {
    let words = cursor.words();
    let (first, second) = (cursor.count(&words, 0)?, cursor.count(&words, 1)?);
    if cursor.take_word("OFFSETS") {
        let words = cursor.words();
        let kind = cursor.kind(&words, 0)?;
        let offsets = cursor.integers(kind, first)?;
        if !cursor.take_word("CONNECTIVITY") {
            return Err(cursor.malformed("CONNECTIVITY does not follow OFFSETS", CORRUPT));
        }
        let words = cursor.words();
        let kind = cursor.kind(&words, 0)?;
        let nodes = cursor.integers(kind, second)?;
        return Ok(CellNodes { offsets, nodes });
    }
    let all = cursor.integers(Kind::Signed(4), second)?;
    let (mut offsets, mut nodes) = (vec![0], Vec::with_capacity(all.len()));
    let mut rest = all.as_slice();
    while let Some((count, behind)) = rest.split_first() {
        let own = usize::try_from(*count).ok().and_then(|count| behind.split_at_checked(count));
        let Some((own, behind)) = own else {
            let what =
                format!("cell {} claims {count} nodes where {} numbers are left", offsets.len() - 1, behind.len());
            return Err(cursor.malformed(what, CORRUPT));
        };
        nodes.extend_from_slice(own);
        offsets.push(nodes.len() as i64);
        rest = behind;
    }
    if offsets.len() as u64 != first + 1 {
        let what = format!("its {second} numbers are {} cells where {first} are claimed", offsets.len() - 1);
        return Err(cursor.malformed(what, CORRUPT));
    }
    Ok(CellNodes { offsets, nodes })
}

/// `CELL_TYPES`, which makes nodes to cells.
pub(super) fn cells(
    cursor: &mut Cursor,
    CellNodes { offsets, nodes }: CellNodes,
    points: usize,
    order: LagrangeOrder,
) -> Result<Vec<ListedCell>, ReadError> {
    let words = cursor.words();
    let count = cursor.count(&words, 0)?;
    let listed = offsets.len().saturating_sub(1);
    if count != listed as u64 {
        return Err(cursor.malformed(format!("{count} types for {listed} cells"), CORRUPT));
    }
    let types = cursor.integers(Kind::Signed(4), count)?;
    let mut cells = Vec::with_capacity(listed);
    for (k, (range, number)) in offsets.windows(2).zip(types).enumerate() {
        let ends = usize::try_from(range[0]).ok().zip(usize::try_from(range[1]).ok());
        let Some(own) = ends.and_then(|(start, end)| nodes.get(start..end)) else {
            return Err(cursor.malformed(format!("the offset of cell {k} is out of order"), CORRUPT));
        };
        let node = |node: &i64| usize::try_from(*node).ok().filter(|node| *node < points).map(|node| node as u32);
        let Some(own) = own.iter().map(node).collect::<Option<Vec<u32>>>() else {
            return Err(cursor.malformed(format!("cell {k} has the nodes {own:?}, of {points}"), CORRUPT));
        };
        let has = own.len();
        cells.push(cell(number, own, order).map_err(|refused| match refused {
            Refused::Nodes { wanted } => {
                cursor.malformed(format!("cell {k} has {has} nodes, its type {number} needs {wanted}"), CORRUPT)
            }
            Refused::Type(name) => cursor.unsupported(format!("{name} of VTK type {number} (cell {k})"), OTHER_CELLS),
        })?);
    }
    Ok(cells)
}
