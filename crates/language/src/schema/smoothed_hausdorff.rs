//! The smoothed Hausdorff distance among the costs: the one whose stages and function of the distance are blocks of their own.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::mesh::MeshSource;
use crate::schema::read::{Read, Reader};
use crate::schema::timing::When;
use crate::syntax::{At, Node, Value};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};

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

fn check_stages(cost: &SmoothedHausdorff, reader: &mut Reader<'_>) {
    if matches!(&cost.stages, Stages::List(stages) if stages.is_empty()) {
        reader.complain_at(
            &cost.at.key("stages"),
            "at least one stage is needed: { \"alpha\": 1, \"beta\": 4, \"gamma\": 4 }",
        );
    }
}
