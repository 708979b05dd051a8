//! [`CostKey`]: a key of a cost in case files.

/// A key of a cost in case files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostKey {
    /// The key.
    pub name: &'static str,
    /// What it says, in a sentence.
    pub about: &'static str,
    /// What its value is.
    pub takes: CostTakes,
    /// Whether it must be there.
    pub need: Need,
}

/// Whether a key must be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// It must.
    Required,
    /// It may be left out.
    Optional,
    /// It is one of several, exactly one of which must be there.
    OneOf,
}

/// What the value of a key is; in brackets what [`CostInputs`](super::CostInputs) gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CostTakes {
    /// A surface, or several that stand for their union (`GroupNames`).
    Surface,
    /// A region, or several (`GroupNames`).
    Region,
    /// A node set or surface, or several (`GroupNames`).
    Nodes,
    /// A point of the body at rest (`[f64; 3]`).
    Point,
    /// A line through points of the body at rest (`Vec<[f64; 3]>`).
    Line,
    /// A direction: any vector, or the name of an axis (`[f64; 3]`).
    Direction,
    /// A number that is the same everywhere (`f64`).
    Number {
        /// `Pa`, `m`, `1` for a plain number ...
        unit: &'static str,
        /// What it is if left out.
        default: Option<f64>,
    },
    /// A whole number of at least 1 (`u32`).
    Count {
        /// What it is if left out.
        default: Option<u32>,
    },
    /// One of a few words (`&'static str`).
    Word {
        /// The words.
        of: &'static [&'static str],
    },
    /// The position of one point, which may change in time; components left out are free (`[Option<f64>; 3]`).
    Position,
    /// Positions of all points: formulas, a displacement in a file, or a mesh of the same numbering (`Target`).
    Target,
    /// A mesh, the first of a cost is drawn as its target (`Arc<Mesh>`).
    Mesh,
    /// An obstacle: a shape, or the name of one that rests (`Obstacle`).
    Obstacle,
    /// The name of a contact (`String`).
    Contact,
    /// The name of a control (`String`).
    Control,
}

impl CostKey {
    /// Names of surfaces.
    pub const SURFACE: Self = Self::new("surface", "Surface of the mesh.", CostTakes::Surface);
    /// Names of regions.
    pub const REGION: Self = Self::new("region", "Region of the mesh.", CostTakes::Region);
    /// Names of node sets.
    pub const NODES: Self = Self::new("nodes", "Node set of the mesh.", CostTakes::Nodes);
    /// A point of the body.
    pub const POINT: Self = Self::new("point", "A point of the body, at rest.", CostTakes::Point);
    /// A control.
    pub const CONTROL: Self = Self::new("of", "The control.", CostTakes::Control);
    /// A contact.
    pub const CONTACT: Self = Self::new("contact", "One of the case's contacts.", CostTakes::Contact);

    /// A key that must be there.
    pub const fn new(name: &'static str, about: &'static str, takes: CostTakes) -> Self {
        CostKey { name, about, takes, need: Need::Required }
    }

    /// The same, which may be left out.
    pub const fn optional(self) -> Self {
        CostKey { need: Need::Optional, ..self }
    }

    /// The same as one of several, exactly one of which must be there.
    pub const fn one_of(self) -> Self {
        CostKey { need: Need::OneOf, ..self }
    }

    /// The same with other words about it.
    pub const fn about(self, about: &'static str) -> Self {
        CostKey { about, ..self }
    }
}
