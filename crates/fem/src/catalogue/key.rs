//! [`Key`]: a key of a cost or of a contribution in case files.

/// A key in case files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// What it says, in a sentence.
    pub about: &'static str,
    /// What its value is.
    pub kind: KeyKind,
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
    /// It is one of several, exactly one of which must be there; of costs alone.
    OneOf,
}

/// What the value of a key is; in brackets the type that a cost has it in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyKind {
    /// A surface, or several that stand for their union (`GroupNames`).
    Surface,
    /// A region, or several (`GroupNames`).
    Region,
    /// A node set or surface, or several (`GroupNames`).
    Nodes,
    /// A point at rest (`[f64; 3]`), of costs inside of the body.
    Point,
    /// A line through points of the body at rest (`Vec<[f64; 3]>`).
    Line,
    /// Points of the body: positions, or names of node sets (`Vec<BodyPoint>`).
    Points,
    /// A direction: any vector, or the name of an axis (`[f64; 3]`).
    Direction,
    /// Components, of x, y and z (`Vec<usize>`, 0 to 2).
    Components,
    /// True or false; false if left out (`bool`).
    Flag,
    /// A number that is the same everywhere (`f64`).
    Number {
        /// `Pa`, `m`, `1` for a plain number ...
        unit: &'static str,
        /// What it is if left out.
        default: Option<f64>,
    },
    /// A positive number that is the same everywhere (`f64`).
    Positive {
        /// As that of a number.
        unit: &'static str,
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
    /// Points of the body and where they were measured: a CSV file, or rows (`Vec<Marker>`).
    Markers,
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

impl Key {
    /// Names of surfaces.
    pub const SURFACE: Self = Self::new("surface", "Surface of the mesh.", KeyKind::Surface);
    /// Names of regions.
    pub const REGION: Self = Self::new("region", "Region of the mesh.", KeyKind::Region);
    /// Names of node sets.
    pub const NODES: Self = Self::new("nodes", "Node set of the mesh.", KeyKind::Nodes);
    /// A point of the body.
    pub const POINT: Self = Self::new("point", "A point of the body, at rest.", KeyKind::Point);
    /// A control.
    pub const CONTROL: Self = Self::new("of", "The control.", KeyKind::Control);
    /// A contact.
    pub const CONTACT: Self = Self::new("contact", "One of the case's contacts.", KeyKind::Contact);

    /// A key that must be there.
    pub const fn new(name: &'static str, about: &'static str, kind: KeyKind) -> Self {
        Key { name, about, kind, need: Need::Required }
    }

    /// The same, which may be left out.
    pub const fn optional(self) -> Self {
        Key { need: Need::Optional, ..self }
    }

    /// The same as one of several, exactly one of which must be there.
    pub const fn one_of(self) -> Self {
        Key { need: Need::OneOf, ..self }
    }

    /// The same with other words about it.
    pub const fn about(self, about: &'static str) -> Self {
        Key { about, ..self }
    }
}
