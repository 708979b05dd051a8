//! [`CaseDescription`]: a case as it was understood.

use crate::record::{Absent, BlockRecords, ByName, ContactRecord, Nullable, Number};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

records! {
    /// The case as `check` describes it.
    CaseDescription {
        /// The mesh.
        mesh: Option<MeshRecord>,
        /// The materials.
        materials: Option<Vec<LawRecord>>,
        /// Conditions for a state of least energy, by groups of cells whose laws state the same.
        existence: Option<Vec<CellGroupRecord>>,
        /// The actuations.
        actuation: Option<Vec<LawRecord>>,
        /// The contacts.
        contact: Option<Vec<ContactRecord>>,
        /// The blocks that add a contribution each.
        #[serde(flatten)]
        blocks: BlockRecords,
        /// Displacement components that supports hold.
        held_components: Option<usize>,
        /// Memory that a solve takes.
        memory: Option<MemoryRecord>,
        /// Whether the case is complete and consistent.
        valid: Option<bool>,
    }

    /// A mesh.
    MeshRecord {
        /// Its name.
        name: String,
        /// 2 or 3.
        dimensions: usize,
        /// Number of nodes.
        nodes: usize,
        /// Number of cells.
        cells: usize,
        /// Cells by their kind.
        kinds: Option<ByName<usize>>,
        /// Displacement components.
        unknowns: usize,
        /// Extent along the axes.
        size: Vec<Number>,
        /// Volume, or area.
        measure: Number,
        /// Area of its boundary, or length.
        boundary: Number,
        /// Quality of its cells.
        quality: QualityRecord,
        /// By name.
        regions: Option<ByName<SetRecord>>,
        /// By name.
        surfaces: Option<ByName<SetRecord>>,
        /// By name.
        node_sets: Option<ByName<SetRecord>>,
    }

    /// Quality of cells.
    QualityRecord {
        /// The smallest scaled Jacobian; 1 is best.
        scaled_jacobian: Number,
        /// The smallest ratio of Jacobians within a cell.
        jacobian_ratio: Number,
        /// The largest ratio of edges.
        aspect: Number,
        /// The shortest edge.
        shortest_edge: Number,
        /// The longest edge.
        longest_edge: Number,
    }

    /// A region, surface or node set.
    SetRecord {
        /// Cells of a region.
        cells: Option<usize>,
        /// Facets of a surface.
        facets: Option<usize>,
        /// Nodes of a node set.
        nodes: Option<usize>,
        /// Volume of a region or area of a surface.
        measure: Nullable<f64>,
    }

    /// A law of a material, or an actuation.
    LawRecord {
        /// Where it holds.
        region: Option<NamesRecord>,
        /// The law.
        law: Option<String>,
        /// Of an actuation that is no law: its kind.
        kind: Option<String>,
        /// Its constants.
        parameters: Option<ByName<ConstantRecord>>,
        /// Keys of an actuation that is no law: names, points, numbers, flags.
        #[serde(flatten)]
        keys: ByName<ConstantRecord>,
        /// Formulation of a material.
        formulation: Option<String>,
        /// Numbers in front of the law that follow designs, in words.
        design: Option<Vec<String>>,
        /// Of a material: true where its region moves as a rigid body.
        rigid: Option<bool>,
        /// Of a chamber: its volume at rest.
        reference_volume: Number,
        /// Of a tendon: its length at rest.
        reference_length: Number,
        /// Of an actuation: its name.
        name: Option<String>,
        /// Of an actuation: the tension up to which the law stays polyconvex.
        fiber_limit: Nullable<f64>,
        /// The same with the families beside it, all alike.
        joint_fiber_limit: Number,
        /// These families.
        beside: Option<Vec<String>>,
    }

    /// Cells whose laws state the same.
    CellGroupRecord {
        /// How many.
        cells: usize,
        /// What they state; null where a law makes no statement.
        conditions: Nullable<ExistenceRecord>,
    }

    /// Conditions of the existence theorem (J. Ball 1977).
    ExistenceRecord {
        /// Whether the law is polyconvex.
        polyconvex: bool,
        /// Whether W grows without bound as J -> 0.
        resists_collapse: bool,
        /// Whether the exponents fulfil coercivity.
        coercive: bool,
        /// Exponents of |F|, |cof F| and J.
        growth: GrowthRecord,
        /// Whether a turgor has an energy that is bounded from below.
        balances_pressure: bool,
        /// Whether all hold.
        holds: bool,
    }

    /// Exponents for which W >= a (|F|^p + |cof F|^q + J^r) - b.
    GrowthRecord {
        /// p.
        p: Number,
        /// q.
        q: Number,
        /// r.
        r: Number,
    }

    /// Memory that a solve takes, predicted.
    MemoryRecord {
        /// The solver of linear systems.
        linear_solver: String,
        /// Bytes of a factor of the tangent in double precision.
        factor: usize,
        /// Bytes of its factorisation at the largest.
        factorisation: usize,
    }
}

/// A name, or several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NamesRecord {
    /// One.
    One(String),
    /// Several.
    Several(Vec<String>),
}

/// A point of a body: a place, a node set, or a place of the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum BodyPointRecord {
    /// A place.
    Place([f64; 3]),
    /// The mean of a node set.
    Nodes(String),
    /// A place of the ground.
    Ground {
        /// The place.
        ground: [f64; 3],
    },
}

/// A constant of a law or an actuation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ConstantRecord {
    /// With its unit.
    Quantity {
        /// In the case's units.
        value: f64,
        /// Its unit.
        unit: String,
        /// In SI.
        si: f64,
    },
    /// One that varies over the body.
    Varies {
        /// As the case says it.
        varies: String,
    },
    /// A plain number.
    Number(f64),
    /// Whether a key is set.
    Flag(bool),
    /// A word or a name.
    Word(String),
    /// A direction or a place.
    Vector([f64; 3]),
    /// Names.
    Names(Vec<String>),
    /// Points.
    Points(Vec<BodyPointRecord>),
}

/// What is no group of keys is there where it is written.
macro_rules! present {
    ($($type:ty),*) => { $( impl Absent for $type {
        fn is_absent(&self) -> bool {
            false
        }
    } )* };
}

present!(NamesRecord, BodyPointRecord, ConstantRecord);
