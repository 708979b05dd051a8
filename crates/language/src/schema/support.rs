//! The blocks of `supports`.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Value};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};

object! {
    /// What holds the body: components of the displacement that are zero or prescribed.
    pub struct Support one of [surface, region, nodes] checked by check {
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// Components held at zero.
        pub fix: Fix = Fix::default(),
        /// Components with a given displacement.
        pub displacement: Option<Displacement>,
        /// Stiffness of an elastic foundation of a surface: force per displacement and reference area.
        pub foundation: Option<f64> as STIFFNESS_PER_AREA,
        /// Displacements that the foundation resists to.
        pub along: Along = Along::All,
    }
}

object! {
    /// Prescribed displacement; components left out are free, unless fixed.
    pub struct Displacement {
        /// Along x.
        pub x: Option<Formula> as LENGTH,
        /// Along y.
        pub y: Option<Formula> as LENGTH,
        /// Along z.
        pub z: Option<Formula> as LENGTH,
    }
}

choice! {
    /// A component.
    pub enum Axis {
        /// Along x.
        "x" => X,
        /// Along y.
        "y" => Y,
        /// Along z.
        "z" => Z,
    }
}

choice! {
    /// Displacements that a foundation resists to.
    pub enum Along {
        /// All.
        "all" => All,
        /// Along the reference normal of the surface alone: it slides freely along itself.
        "normal" => Normal,
    }
}

impl Axis {
    /// 0, 1 or 2.
    #[must_use]
    pub fn index(&self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// Components held at zero: `"all"`, one, or a list of some.
#[derive(Clone, PartialEq, Debug)]
pub enum Fix {
    /// As many as the body has dimensions.
    All,
    /// These.
    Axes(Vec<Axis>),
}

impl Default for Fix {
    fn default() -> Self {
        Self::Axes(Vec::new())
    }
}

impl Fix {
    /// The components, each with its place in the case.
    fn places(&self, at: &At) -> Vec<(Axis, At)> {
        match self {
            Self::All => [Axis::X, Axis::Y, Axis::Z].map(|axis| (axis, at.clone())).to_vec(),
            Self::Axes(axes) => axes.iter().enumerate().map(|(i, axis)| (axis.clone(), at.index(i))).collect(),
        }
    }

    /// Zero for every component held, nothing for the others.
    #[must_use]
    pub fn held(&self) -> [Option<f64>; 3] {
        let mut held = [None; 3];
        self.places(&At::root()).iter().for_each(|(axis, _)| held[axis.index()] = Some(0.0));
        held
    }

    /// The components held, 0 to 2.
    #[must_use]
    pub fn components(&self) -> Vec<usize> {
        (0..3).filter(|&i| self.held()[i].is_some()).collect()
    }
}

impl Read for Fix {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(text) if text == "all" => Some(Self::All),
            Value::Text(_) => {
                reader.word(node, at, "component", &["all", "x", "y", "z"])?;
                Axis::read(node, at, want, reader).map(|axis| Self::Axes(vec![axis]))
            }
            Value::Array(_) => Vec::read(node, at, want, reader).map(Self::Axes),
            _ => {
                reader.expected(node, at, "\"all\" or a list of \"x\", \"y\" and \"z\"");
                None
            }
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let all = json!({ "const": "all", "description": "Every component." });
        any_of(vec![all, Axis::schema(want, definitions), Vec::<Axis>::schema(want, definitions)])
    }
}

impl Displacement {
    /// The components as an array.
    #[must_use]
    pub fn entries(&self) -> [Option<&Formula>; 3] {
        [self.x.as_ref(), self.y.as_ref(), self.z.as_ref()]
    }
}

fn check(support: &Support, reader: &mut Reader<'_>) {
    let moved = support.displacement.as_ref().map_or([None; 3], Displacement::entries);
    let fixed = support.fix.places(&support.at.key("fix"));
    let rests = support.foundation.is_some();
    if fixed.is_empty() && moved.iter().all(Option::is_none) && !rests {
        reader.complain_at(
            &support.at,
            "this holds nothing: give \"fix\": \"all\", \"fix\": [\"x\", ...], \"displacement\": { \"x\": ... } or a \"foundation\"",
        );
    }
    if rests && support.surface.is_none() {
        reader.complain_at(&support.at.key("foundation"), "a foundation lies under a \"surface\": name one");
    }
    if rests && !(fixed.is_empty() && moved.iter().all(Option::is_none)) {
        let message =
            "a foundation gives way where \"fix\" and \"displacement\" do not: write a support of its own for each";
        reader.complain_at(&support.at.key("foundation"), message);
    }
    if !rests && support.along != Along::All {
        reader.complain_at(&support.at.key("along"), "\"along\" belongs to a \"foundation\": give its stiffness");
    }
    for (i, (axis, at)) in fixed.iter().enumerate() {
        if fixed[..i].iter().any(|(other, _)| other == axis) {
            reader.complain_at(at, format!("\"{}\" is fixed twice", axis.name()));
        }
        if moved[axis.index()].is_some() {
            reader.complain_at(at, format!("\"{}\" cannot be fixed and displaced", axis.name()));
        }
    }
}
