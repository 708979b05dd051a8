//! [`Space`]: which unknowns a vector has, and sums over them.

mod field;
mod share;

pub use field::{Field, On, Role};
use nastic_numeric::vector;
pub use share::Share;
use std::borrow::Cow;
use std::sync::Arc;

/// Fields of unknowns on the nodes and cells of a mesh, and on the whole.
///
/// A vector has the nodal fields first, unknown `block * node + component` with the block of [`block`](Self::block) components, one
/// field after the other in it; behind them the fields on cells, `components * cell + component`, and the numbers of the whole.
///
/// All sums over unknowns (`dot`, `norm`, `max_abs`) of nonlinear solves are asked of it: where several ranks share a body, it has a [`Share`], and they are
/// sums over all ranks. Vectors that are not on nodes are numbers of the whole, which every rank has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Space {
    nodes: usize,
    cells: usize,
    fields: Vec<Field>,
    share: Option<Arc<Share>>,
}

impl Space {
    /// Without fields of its own: sums over any vector that one process holds.
    pub const LOCAL: &'static Space = &Space { nodes: 0, cells: 0, fields: Vec::new(), share: None };

    /// No fields yet, on so many nodes and cells.
    pub fn new(nodes: usize, cells: usize) -> Self {
        Space { nodes, cells, fields: Vec::new(), share: None }
    }

    /// The same of one rank among several.
    #[must_use]
    pub fn shared(self, share: Option<Arc<Share>>) -> Self {
        Space { share, ..self }
    }

    /// What this rank has of a body, where several share it.
    pub fn share(&self) -> Option<&Arc<Share>> {
        self.share.as_ref()
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
        self.fields.insert(at, Field { places, ..field });
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

    /// Whether the potential has a maximum by a nodal field.
    pub fn has_saddle_field(&self) -> bool {
        self.nodal_fields().any(|(_, field)| field.role == Role::Saddle)
    }

    /// By component of a node's block, whether the potential has a maximum by it.
    pub fn maxima(&self) -> Vec<bool> {
        let of_field = |(_, field): (usize, &Field)| std::iter::repeat_n(field.role == Role::Saddle, field.components);
        self.nodal_fields().flat_map(of_field).collect()
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
        match self.owned(a.len().min(b.len())) {
            None => vector::dot(a, b),
            Some((share, own)) => total(share, vector::dot(&a[..own], &b[..own])),
        }
    }

    /// The same, added one after the other.
    pub fn dot_in_order(&self, a: &[f64], b: &[f64]) -> f64 {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
        match self.owned(a.len().min(b.len())) {
            None => sum(a, b),
            Some((share, own)) => total(share, sum(&a[..own], &b[..own])),
        }
    }

    /// `|a|`, Euclidean.
    pub fn norm(&self, a: &[f64]) -> f64 {
        match self.share {
            None => vector::norm(a),
            Some(_) => self.dot(a, a).sqrt(),
        }
    }

    /// `max_i |a_i|`; zero for an empty vector.
    pub fn max_abs(&self, a: &[f64]) -> f64 {
        -self.least(-vector::max_abs(a))
    }

    /// The sum over all ranks of what each has by its own cells; itself of one that has the whole.
    pub fn total(&self, here: f64) -> f64 {
        self.share.as_ref().map_or(here, |share| total(share, here))
    }

    /// The least one over all ranks.
    pub fn least(&self, here: f64) -> f64 {
        let Some(share) = &self.share else { return here };
        let mut least = [here];
        share.least(&mut least);
        least[0]
    }

    /// Whether it is so on any rank.
    pub fn any(&self, here: bool) -> bool {
        self.share.as_ref().map_or(here, |share| share.any(here))
    }

    /// Makes forces whole of which every rank has those by its own cells: [`Share::add_up`].
    pub fn add_up(&self, forces: &mut [f64]) {
        if let Some(share) = &self.share {
            share.add_up(self.block(), &mut forces[..self.block() * self.nodes]);
        }
    }

    /// The numbers of a vector on nodes that belong to this rank; all of one that has the whole.
    pub(crate) fn own<'v>(&self, vector: &'v [f64]) -> &'v [f64] {
        &vector[..self.owned(vector.len()).map_or(vector.len(), |(_, own)| own)]
    }

    /// How many of the first numbers of a vector of this length belong to this rank, where it is one of several and the vector is on nodes.
    fn owned(&self, length: usize) -> Option<(&Share, usize)> {
        let share = self.share.as_deref()?;
        (length > 0 && length.is_multiple_of(self.nodes)).then(|| (share, length / self.nodes * share.owned()))
    }
}

fn total(share: &Share, here: f64) -> f64 {
    let mut sum = [here];
    share.sum(&mut sum);
    sum[0]
}

#[cfg(test)]
mod tests {
    use super::{Field, Share, Space};
    use nastic_team::Team;
    use nastic_team::threads::{self, Faults};
    use std::sync::Arc;

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

    #[test]
    fn unknowns_of_several_ranks_count_once() {
        // two ranks with two nodes each, of which they share one
        let found = threads::run(2, &Faults::default(), |rank| {
            let own = rank.rank();
            let (owned, at) = [(2, 1), (1, 1)][own];
            let share = Share::new(Arc::new(rank), owned, vec![(1 - own, vec![at])]);
            let space = Space::new(2, 1).with(Field::nodal("displacement", 2)).shared(Some(share));
            let v = [[1.0, 2.0, 3.0, 4.0], [5.0, -6.0, 3.0, 4.0]][own];
            let mut forces = v;
            space.add_up(&mut forces);
            (
                space.dot(&v, &v),
                space.norm(&v),
                space.max_abs(&v),
                space.dot_in_order(&v, &v),
                space.total(1.0),
                forces[2],
            )
        });
        let squares = 1.0 + 4.0 + 9.0 + 16.0 + 25.0 + 36.0_f64;
        assert_eq!(found, [(squares, squares.sqrt(), 6.0, squares, 2.0, 6.0); 2]);
    }
}
