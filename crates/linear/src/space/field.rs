//! [`Field`]: unknowns of one kind.

/// What a field has values on. In vectors, fields on nodes come first, interleaved node by node, then those on cells, then numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum On {
    /// Every node.
    Nodes,
    /// Every cell.
    Cells,
    /// Global numbers.
    Whole,
}

/// Which part a field has in an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The potential, where there is one, has a minimum by it.
    Primary,
    /// The potential has a maximum by it, as by multipliers of constraints or an electric potential: each of its unknowns gives the tangent one
    /// negative eigenvalue.
    Saddle,
}

/// Unknowns of one kind: `components` on every place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// What messages and supports call it.
    pub name: String,
    /// Numbers per place.
    pub components: usize,
    /// The places.
    pub on: On,
    /// Its part in an equilibrium.
    pub role: Role,
    /// How many places there are. Set by the [`Space`](super::Space).
    pub places: usize,
}

impl Field {
    /// A primary field on nodes.
    pub fn nodal(name: &str, components: usize) -> Self {
        Field { name: name.to_owned(), components, on: On::Nodes, role: Role::Primary, places: 0 }
    }

    /// A field on nodes by which the potential has a maximum: an electric potential phi, with the density `-eps/2 J |F^-T grad phi|^2`.
    ///
    /// Of the tangent `[A B; B^T -C]`, C by this field, `n_-([A B; B^T -C]) = n_-(A + B C^-1 B^T) + dim C` where C is positive definite (Haynsworth).
    /// Equilibria are stable where the first term, by the unknowns that are left once the field is eliminated, is 0.
    pub fn saddle(name: &str, components: usize) -> Self {
        Field { role: Role::Saddle, ..Field::nodal(name, components) }
    }

    /// So many multipliers of the whole.
    pub fn multipliers(name: &str, count: usize) -> Self {
        Field { name: name.to_owned(), components: count, on: On::Whole, role: Role::Saddle, places: 0 }
    }

    /// Number of its unknowns.
    pub fn len(&self) -> usize {
        self.components * self.places
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether another one describes the same unknowns, wherever their places are.
    pub fn agrees(&self, other: &Field) -> bool {
        (&self.name, self.components, self.on, self.role) == (&other.name, other.components, other.on, other.role)
    }
}
