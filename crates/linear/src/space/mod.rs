//! [`Space`]: which unknowns a vector has, and sums over them.

mod field;

pub use field::{Field, On, Role};
use nastic_numeric::vector;
use std::borrow::Cow;

/// Fields of unknowns on the nodes and cells of a mesh, and on the whole.
///
/// A vector has the nodal fields first, unknown `block * node + component` with the block of [`block`](Self::block) components, one
/// field after the other in it; behind them the fields on cells, `components * cell + component`, and the numbers of the whole.
///
/// All sums over unknowns (`dot`, `norm`, `max_abs`) of nonlinear solves are asked of it: where several processes share a vector, these are
/// what has to know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Space {
    nodes: usize,
    cells: usize,
    fields: Vec<Field>,
}

impl Space {
    /// Without fields of its own: sums over any vector that one process holds.
    pub const LOCAL: &'static Space = &Space { nodes: 0, cells: 0, fields: Vec::new() };

    /// No fields yet, on so many nodes and cells.
    pub fn new(nodes: usize, cells: usize) -> Self {
        Space { nodes, cells, fields: Vec::new() }
    }

    /// With a field more, behind those on places of the same kind.
    #[must_use]
    pub fn with(mut self, field: Field) -> Self {
        let places = match field.on {
            On::Nodes => self.nodes,
            On::Cells => self.cells,
            On::Whole => 1,
        };
        let at = self.fields.partition_point(|known| known.on <= field.on);
        self.fields.insert(at, Field { owned: 0..places, ..field });
        self
    }

    /// The fields, in the order of vectors.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// The nodal fields, each with the place of its first component in the block of a node.
    pub fn nodal_fields(&self) -> impl Iterator<Item = (usize, &Field)> {
        let nodal = self.fields.iter().take_while(|field| field.on == On::Nodes);
        nodal.scan(0, |next, field| {
            let first = *next;
            *next += field.components;
            Some((first, field))
        })
    }

    /// A nodal field by name, with the place of its first component in the block of a node.
    pub fn nodal_field(&self, name: &str) -> Option<(usize, &Field)> {
        self.nodal_fields().find(|(_, field)| field.name == name)
    }

    /// Nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Unknowns per node, `sum_f components_f` over the nodal fields.
    pub fn block(&self) -> usize {
        self.nodal_fields().map(|(_, field)| field.components).sum()
    }

    /// Unknowns on nodes, `block * nodes`: those of the tangent's sparse part.
    pub fn nodal(&self) -> usize {
        self.block() * self.nodes
    }

    /// Numbers of the whole, which border the tangent: multipliers of constraints.
    pub fn multipliers(&self) -> usize {
        self.fields.iter().filter(|field| field.on == On::Whole).map(Field::len).sum()
    }

    /// All unknowns, supported ones included.
    pub fn len(&self) -> usize {
        self.fields.iter().map(Field::len).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether there is one nodal field at most: the displacement alone.
    pub fn has_one_nodal_field(&self) -> bool {
        self.nodal_fields().nth(1).is_none()
    }

    /// The values of `count` components from the first one on at every node, shape `[nodes][count]`.
    pub fn components(&self, v: &[f64], first: usize, count: usize) -> Vec<f64> {
        let nodal = &v[..self.nodal()];
        nodal.chunks_exact(self.block()).flat_map(|node| &node[first..first + count]).copied().collect()
    }

    /// The nodal unknowns of a vector field by field, each flat, shape `[nodes][components]`; copied where there are several.
    pub fn by_nodal_field<'v>(&self, v: &'v [f64]) -> Vec<Cow<'v, [f64]>> {
        if self.has_one_nodal_field() {
            return vec![Cow::Borrowed(&v[..self.nodal()])];
        }
        let copied = |(first, field): (usize, &Field)| Cow::Owned(self.components(v, first, field.components));
        self.nodal_fields().map(copied).collect()
    }

    /// `a . b` over the unknowns of vectors; of the shorter length.
    pub fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        vector::dot(a, b)
    }

    /// `|a|`, Euclidean.
    pub fn norm(&self, a: &[f64]) -> f64 {
        vector::norm(a)
    }

    /// `max_i |a_i|`; zero for an empty vector.
    pub fn max_abs(&self, a: &[f64]) -> f64 {
        vector::max_abs(a)
    }
}

#[cfg(test)]
mod tests {
    use super::{Field, Space};

    #[test]
    fn nodal_fields_are_interleaved_and_numbers_come_last() {
        let space = Space::new(2, 1).with(Field::nodal("displacement", 2));
        assert!(space.has_one_nodal_field());
        let space = space.with(Field::multipliers("volume", 1)).with(Field::nodal("phi", 1));
        assert_eq!((space.block(), space.nodal(), space.multipliers(), space.len()), (3, 6, 1, 7));
        assert_eq!(space.nodal_field("phi").map(|(first, _)| first), Some(2));
        let v = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(space.components(&v, 2, 1), [2.0, 5.0]);
        assert_eq!(space.by_nodal_field(&v)[1][..], [2.0, 5.0]);
        assert_eq!(space.components(&v, 0, 2), [0.0, 1.0, 3.0, 4.0]);
    }
}
