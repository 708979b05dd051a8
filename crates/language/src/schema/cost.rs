//! The blocks of `costs`.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::added_cost::AddedCost;
use crate::schema::contact_cost::{ContactForce, ContactPressure};
use crate::schema::field::ArrayFile;
use crate::schema::json::{Definitions, any_of, vector};
use crate::schema::mesh::MeshSource;
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::{Read, Reader};
use crate::schema::shape_cost::{Compliance, Curvature, LargestStretch, Orientation, Position};
use crate::schema::timing::When;
use crate::schema::value::entries;
use crate::syntax::{At, Node, Value};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};

tagged! {
    /// A term of the cost; the cost is their sum.
    pub enum Cost by "kind" or /// A term that the program has added.
    Added(AddedCost) {
        /// Distance between the deformed body and a target shape.
        "smoothed_hausdorff" => SmoothedHausdorff(SmoothedHausdorff),
        /// Distance of every point to its own target position.
        "tracking" => Tracking(Tracking),
        /// Where a point or the mean of a surface lies.
        "position" => Position(Position),
        /// Where the normals of a surface point.
        "orientation" => Orientation(Orientation),
        /// Curvature of a line in the body.
        "curvature" => Curvature(Curvature),
        /// A smoothed maximum of the principal stretches.
        "largest_stretch" => LargestStretch(LargestStretch),
        /// How far a surface gives way to a small force.
        "compliance" => Compliance(Compliance),
        /// The force that a contact presses with.
        "contact_force" => ContactForce(ContactForce),
        /// A smoothed largest pressure of a contact.
        "contact_pressure" => ContactPressure(ContactPressure),
        /// Squared penetration into an obstacle.
        "obstacle" => Obstacle(Penetration),
        /// Size of a control.
        "control_norm" => ControlNorm(ControlNorm),
        /// Slope of a control.
        "control_smoothness" => ControlSmoothness(ControlSmoothness),
        /// Rate of a control in time.
        "control_rate" => ControlRate(ControlRate),
        /// Kinetic energy of the body.
        "kinetic_energy" => KineticEnergy(KineticEnergy),
        /// Work that the actuations do.
        "actuation_work" => ActuationWork(ActuationWork),
    }
}

object! {
    /// Smoothed Hausdorff distance between the deformed body and a target shape.
    pub struct SmoothedHausdorff checked by check_stages {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Mesh of the target shape.
        pub target: MeshSource,
        /// Region of the target mesh; all of it if left out.
        pub target_region: Option<GroupNames>,
        /// Region of the body; all of it if left out.
        pub region: Option<GroupNames>,
        /// The decreasing function of the distance.
        pub phi: Phi,
        /// Exponents, sharpened from stage to stage; from the sizes of target and points if left out.
        pub stages: Stages = Stages::Auto,
        /// Gauss points per direction on body and target; the fewest that resolve the smallest length of the stages if left out.
        pub quadrature: Option<usize> as POSITIVE,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

choice! {
    /// The decreasing function of the distance r.
    pub enum Phi {
        /// exp(-r / l)
        "exponential" => Exponential(Exponential),
        /// 1 / (r + eps)
        "inverse" => Inverse(Inverse),
        /// 1 / sqrt(r^2 + eps^2)
        "smooth_inverse" => SmoothInverse(Inverse),
    }
}

object! {
    /// exp(-r / l)
    pub struct Exponential one of [length, fraction] {
        /// l
        pub length: Option<f64> as POSITIVE_LENGTH,
        /// l as a fraction of the diagonal of the target's bounding box.
        pub fraction: Option<f64> as POSITIVE,
    }
}

object! {
    /// Parameters of the inverse functions of the distance.
    pub struct Inverse {
        /// eps
        pub eps: f64 as POSITIVE_LENGTH,
    }
}

/// The stages of a continuation.
#[derive(Clone, PartialEq, Debug)]
pub enum Stages {
    /// From the size of the target and the spacing of the points.
    Auto,
    /// As given, coarse to fine.
    List(Vec<Stage>),
}

impl Read for Stages {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(word) if word == "auto" => Some(Self::Auto),
            Value::Array(_) => Vec::read(node, at, want, reader).map(Self::List),
            _ => {
                reader.expected(node, at, "\"auto\" or a list of { \"alpha\": .., \"beta\": .., \"gamma\": .. }");
                None
            }
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![json!({ "const": "auto" }), Vec::<Stage>::schema(want, definitions)])
    }

    fn to_json(&self) -> Option<Json> {
        matches!(self, Self::Auto).then(|| "auto".into())
    }
}

object! {
    /// One stage of the continuation.
    pub struct Stage {
        /// Exponent of the soft minimum.
        pub alpha: f64 as POSITIVE,
        /// Exponent of the soft maximum.
        pub beta: f64 as POSITIVE,
        /// Exponent that joins both directions.
        pub gamma: f64 as POSITIVE,
    }
}

object! {
    /// weight/2 int |x - x_target|^2 over a surface or region, the sum over a node set.
    pub struct Tracking one of [surface, region, nodes] {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// Target positions.
        pub target: Target,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight/2 int max(0, clearance - d(x))^2 over a surface or region, the sum over a node set; d is the distance from an obstacle.
    pub struct Penetration one of [surface, region, nodes] {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// The obstacle: a shape, or the name of one of `obstacles`, where it is not moved.
        pub shape: ShapeOrName,
        /// The distance to keep.
        pub clearance: f64 as LENGTH = 0.0,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

/// Where points shall go.
#[derive(Clone, PartialEq, Debug)]
pub enum Target {
    /// The position as formulas of X, Y, Z.
    Formulas(Vec<Formula>),
    /// A displacement array of a file on the same mesh.
    Array(ArrayFile),
    /// The nodes of a mesh with the same numbering.
    Nodes(NodeTarget),
}

object! {
    /// Target positions node by node.
    pub struct NodeTarget {
        /// A mesh with the same numbering of nodes.
        pub nodes: MeshSource,
    }
}

object! {
    /// weight/2 int m^2
    pub struct ControlNorm {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// The control.
        pub of: String,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; over the whole time if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight/2 int |grad m|^2; for cell fields the jumps over faces by the distance of centres.
    pub struct ControlSmoothness {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// The control.
        pub of: String,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; over the whole time if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight/2 int int |dm/dt|^2 dX dt of a control that changes in time
    pub struct ControlRate {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// The control.
        pub of: String,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
    }
}

object! {
    /// weight times the kinetic energy
    pub struct KineticEnergy {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight times the work that all actuations do from t = 0 to the end
    pub struct ActuationWork {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
    }
}

impl Cost {
    /// Path of this block in the case.
    #[must_use]
    pub fn at(&self) -> &At {
        match self {
            Self::SmoothedHausdorff(block) => &block.at,
            Self::Tracking(block) => &block.at,
            Self::Position(block) => &block.at,
            Self::Orientation(block) => &block.at,
            Self::Curvature(block) => &block.at,
            Self::LargestStretch(block) => &block.at,
            Self::Compliance(block) => &block.at,
            Self::ContactForce(block) => &block.at,
            Self::ContactPressure(block) => &block.at,
            Self::Obstacle(block) => &block.at,
            Self::ControlNorm(block) => &block.at,
            Self::ControlSmoothness(block) => &block.at,
            Self::ControlRate(block) => &block.at,
            Self::KineticEnergy(block) => &block.at,
            Self::ActuationWork(block) => &block.at,
            Self::Added(block) => &block.at,
        }
    }

    /// Name in results: its own, or its kind.
    #[must_use]
    pub fn name(&self) -> &str {
        let own = match self {
            Self::SmoothedHausdorff(block) => &block.name,
            Self::Tracking(block) => &block.name,
            Self::Position(block) => &block.name,
            Self::Orientation(block) => &block.name,
            Self::Curvature(block) => &block.name,
            Self::LargestStretch(block) => &block.name,
            Self::Compliance(block) => &block.name,
            Self::ContactForce(block) => &block.name,
            Self::ContactPressure(block) => &block.name,
            Self::Obstacle(block) => &block.name,
            Self::ControlNorm(block) => &block.name,
            Self::ControlSmoothness(block) => &block.name,
            Self::ControlRate(block) => &block.name,
            Self::KineticEnergy(block) => &block.name,
            Self::ActuationWork(block) => &block.name,
            Self::Added(block) => &block.name,
        };
        own.as_deref().unwrap_or(self.kind())
    }

    /// Factor.
    #[must_use]
    pub fn weight(&self) -> f64 {
        match self {
            Self::SmoothedHausdorff(block) => block.weight,
            Self::Tracking(block) => block.weight,
            Self::Position(block) => block.weight,
            Self::Orientation(block) => block.weight,
            Self::Curvature(block) => block.weight,
            Self::LargestStretch(block) => block.weight,
            Self::Compliance(block) => block.weight,
            Self::ContactForce(block) => block.weight,
            Self::ContactPressure(block) => block.weight,
            Self::Obstacle(block) => block.weight,
            Self::ControlNorm(block) => block.weight,
            Self::ControlSmoothness(block) => block.weight,
            Self::ControlRate(block) => block.weight,
            Self::KineticEnergy(block) => block.weight,
            Self::ActuationWork(block) => block.weight,
            Self::Added(block) => block.weight,
        }
    }

    /// When it counts in a motion, where the case says so.
    #[must_use]
    pub fn when(&self) -> Option<&When> {
        match self {
            Self::SmoothedHausdorff(block) => block.when.as_ref(),
            Self::Tracking(block) => block.when.as_ref(),
            Self::Position(block) => block.when.as_ref(),
            Self::Orientation(block) => block.when.as_ref(),
            Self::Curvature(block) => block.when.as_ref(),
            Self::LargestStretch(block) => block.when.as_ref(),
            Self::Compliance(block) => block.when.as_ref(),
            Self::ContactForce(block) => block.when.as_ref(),
            Self::ContactPressure(block) => block.when.as_ref(),
            Self::Obstacle(block) => block.when.as_ref(),
            Self::ControlNorm(block) => block.when.as_ref(),
            Self::ControlSmoothness(block) => block.when.as_ref(),
            Self::Added(block) => block.when.as_ref(),
            Self::KineticEnergy(block) => block.when.as_ref(),
            Self::ControlRate(_) | Self::ActuationWork(_) => None,
        }
    }

    /// Whether it is a term of a motion, not of states.
    #[must_use]
    pub fn is_of_motion(&self) -> bool {
        matches!(self, Self::ControlRate(_) | Self::KineticEnergy(_) | Self::ActuationWork(_))
    }

    /// Whether its target changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        match self {
            Self::Tracking(block) => {
                matches!(&block.target, Target::Formulas(all) if all.iter().any(Formula::uses_time))
            }
            Self::Position(block) => block.target.use_time(),
            _ => false,
        }
    }

    /// The term at an instant, where its target changes in time.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        let mut own = self.clone();
        match &mut own {
            Self::Tracking(block) => {
                if let Target::Formulas(entries) = &mut block.target {
                    entries.iter_mut().for_each(|entry| *entry = entry.at_time(t));
                }
            }
            Self::Position(block) => *block.target = block.target.at_time(t),
            _ => {}
        }
        own
    }

    /// The control a regularising term refers to.
    pub(crate) fn control(&self) -> Option<&str> {
        match self {
            Self::ControlNorm(block) => Some(&block.of),
            Self::ControlSmoothness(block) => Some(&block.of),
            Self::ControlRate(block) => Some(&block.of),
            _ => None,
        }
    }
}

impl Read for Target {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Array(_) => entries(node, at, Want::LENGTH_IN_TIME, reader).map(Self::Formulas),
            Value::Object(members) if members.iter().any(|member| member.key == "nodes") => {
                NodeTarget::read(node, at, Want::ANY, reader).map(Self::Nodes)
            }
            Value::Object(_) => ArrayFile::read(node, at, Want::ANY, reader).map(Self::Array),
            _ => {
                let forms = "[\"formula\", ...], { \"file\": ..., \"array\": ... } or { \"nodes\": ... }";
                reader.expected(node, at, forms);
                None
            }
        }
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![
            vector::<Formula>(Want::LENGTH, definitions),
            ArrayFile::schema(Want::ANY, definitions),
            NodeTarget::schema(Want::ANY, definitions),
        ])
    }
}

fn check_stages(cost: &SmoothedHausdorff, reader: &mut Reader<'_>) {
    if matches!(&cost.stages, Stages::List(stages) if stages.is_empty()) {
        reader.complain_at(
            &cost.at.key("stages"),
            "at least one stage is needed: { \"alpha\": 1, \"beta\": 4, \"gamma\": 4 }",
        );
    }
}
