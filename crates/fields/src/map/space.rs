//! [`Space`]: what a control field may vary over, and the catalogue of them.

/// How a control field varies over the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Space {
    /// One value.
    Uniform,
    /// One value per region that the actuation names, or that divides the one it names.
    Region,
    /// One value per cell.
    Cell,
    /// One value per quadrature point, or per [point](nastic_fem::Contribution::control_points) of a contribution.
    Point,
    /// Linear (multilinear) between corner nodes, on every element: bounds at the nodes hold everywhere.
    Node,
    /// Multilinear between the nodes of a regular grid with these numbers of cells along x, y and z over the bounding box of the actuation's regions
    /// (of a plane body the third number does not matter): a control mesh that is independent of the body's. Grid cells without a
    /// quadrature point have no part in it, and nodes of such cells alone no unknown.
    Grid([u32; 3]),
}

/// A row of the catalogue of control spaces.
#[derive(Debug, Clone, Copy)]
pub struct SpaceRow {
    /// The space.
    pub space: Space,
    /// The name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
}

/// Every control space.
pub const SPACES: &[SpaceRow] = &[
    SpaceRow { space: Space::Uniform, name: "uniform", about: "one value" },
    SpaceRow { space: Space::Region, name: "region", about: "one value per named region" },
    SpaceRow { space: Space::Cell, name: "cell", about: "one value per cell" },
    SpaceRow {
        space: Space::Point,
        name: "point",
        about: "one value per quadrature point, or point of a contribution",
    },
    SpaceRow { space: Space::Node, name: "node", about: "linear between the corner nodes of every cell" },
    SpaceRow { space: Space::Grid([2, 1, 1]), name: "grid", about: "multilinear on a regular grid of its own" },
];

impl Space {
    /// The name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Space::Uniform => "uniform",
            Space::Region => "region",
            Space::Cell => "cell",
            Space::Point => "point",
            Space::Node => "node",
            Space::Grid(_) => "grid",
        }
    }

    /// Whether a field of it is interpolated between nodes, where vectors of one length need [`Layout::fix_length`](crate::Layout::fix_length).
    pub fn interpolates(self) -> bool {
        matches!(self, Space::Node | Space::Grid(_))
    }
}
