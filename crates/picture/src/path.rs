//! [`NamedPath`]: a line through points of space over all bodies, with its name.

use super::colour::Colour;

#[derive(Clone, Debug)]
pub(super) struct NamedPath {
    pub label: String,
    pub colour: Colour,
    pub is_dashed: bool,
    pub points: Vec<[f64; 3]>,
}
