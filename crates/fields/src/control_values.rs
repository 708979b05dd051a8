//! [`ControlValues`]: the values of a control field with what each belongs to.

use crate::control_block::ControlBlock;
use std::fmt;
use std::slice::ChunksExact;

/// What an unknown of a control field belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ControlEntity<'a> {
    /// All cells of the actuation, or a contribution as a whole.
    Whole,
    /// The region of this name.
    Region(&'a str),
    /// The cell of this number.
    Cell(u32),
    /// The quadrature point of this number, or that point of a contribution.
    Point(u32),
    /// The corner node of this number.
    Node(u32),
    /// The node of this number of the control's own grid.
    GridNode(u32),
}

/// `cell 12`, `node 7`, `grid node 5`, `region "arm"`, `the whole region`.
impl fmt::Display for ControlEntity<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => f.write_str("the whole region"),
            Self::Region(name) => write!(f, "region \"{name}\""),
            Self::Cell(cell) => write!(f, "cell {cell}"),
            Self::Point(point) => write!(f, "point {point}"),
            Self::Node(node) => write!(f, "node {node}"),
            Self::GridNode(node) => write!(f, "grid node {node}"),
        }
    }
}

/// The values of one control field: pairs of an entity and its value, by ascending number of the entity. The value has one entry per
/// component: one of a scalar field, three of a vector. Of a field in time all pairs of the first knot, then those of the next. Of a
/// [logarithmic](ControlBlock::log) field they are the unknowns, logarithms.
#[derive(Debug, Clone, Copy)]
pub struct ControlValues<'a> {
    block: &'a ControlBlock,
    values: &'a [f64],
}

impl<'a> ControlValues<'a> {
    /// The part of a control vector that belongs to a field.
    pub fn new(block: &'a ControlBlock, m: &'a [f64]) -> Self {
        Self { block, values: block.of(m) }
    }

    /// The SI unit of the values ("Pa", "T"), as far as the program computes in SI.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        self.block.unit
    }

    /// The instants that the values of a field in time belong to: its knots, or the middles of the intervals between them.
    #[must_use]
    pub fn instants(&self) -> Option<Vec<f64>> {
        self.block.knots.as_ref().map(|knots| knots.instants())
    }

    /// All pairs.
    #[must_use]
    pub fn iter(&self) -> Pairs<'a> {
        Pairs { block: self.block, unknown: 0, values: self.values.chunks_exact(self.block.components) }
    }

    /// The value of an entity, of a field in time that of its first knot; `None` where the field does not reach it.
    #[must_use]
    pub fn get(&self, entity: ControlEntity<'_>) -> Option<&'a [f64]> {
        self.iter().find(|(other, _)| *other == entity).map(|(_, value)| value)
    }
}

impl<'a> IntoIterator for ControlValues<'a> {
    type Item = (ControlEntity<'a>, &'a [f64]);
    type IntoIter = Pairs<'a>;

    fn into_iter(self) -> Pairs<'a> {
        self.iter()
    }
}

impl<'a> IntoIterator for &ControlValues<'a> {
    type Item = (ControlEntity<'a>, &'a [f64]);
    type IntoIter = Pairs<'a>;

    fn into_iter(self) -> Pairs<'a> {
        self.iter()
    }
}

/// Iterator over the pairs of [`ControlValues`].
#[derive(Debug, Clone)]
pub struct Pairs<'a> {
    block: &'a ControlBlock,
    unknown: usize,
    values: ChunksExact<'a, f64>,
}

impl<'a> Iterator for Pairs<'a> {
    type Item = (ControlEntity<'a>, &'a [f64]);

    fn next(&mut self) -> Option<Self::Item> {
        let value = self.values.next()?;
        let entity = self.block.basis.entity(self.unknown % self.block.basis.len());
        self.unknown += 1;
        Some((entity, value))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.values.size_hint()
    }
}

impl ExactSizeIterator for Pairs<'_> {}
