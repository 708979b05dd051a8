//! [`Tied`]: nodes that a contribution lets follow others.

/// Nodes that follow others in the components of one field, `u_s = sum_m w_m u_m`: their unknowns are eliminated, what acts on them acts on those that they follow. Nothing else
/// may hold either of them in these.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tied {
    /// The name of the field; of none the displacement.
    pub field: Option<String>,
    /// Those that are followed, whose displacements may be mixed with each other where [constraints](crate::contribution::constrains::Constrains::local) on them are eliminated.
    pub masters: Vec<u32>,
    /// Components of those that are held because supports hold others.
    pub implied: Vec<(u32, usize)>,
    /// Nodes that follow, each with those that it follows, which follow none, and their weights.
    pub follows: Vec<(u32, Vec<(u32, f64)>)>,
}
