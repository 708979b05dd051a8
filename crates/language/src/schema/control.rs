//! The blocks of `controls`.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::direction::Direction;
use crate::schema::field::{ArrayFile, Parameter};
use crate::schema::field_chain::{Projection, SymmetryPlane};
use crate::schema::json::{Definitions, any_of, vector};
use crate::schema::read::{Read, Reader};
use crate::schema::time_table::TimeTable;
use crate::schema::timing::InTime;
use crate::schema::value::entries;
use crate::syntax::{At, Node, Property, Value, quoted};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

object! {
    /// A field the optimiser may change.
    pub struct Control checked by check {
        /// What it sets: an actuation, "NAME", for a magnet "NAME.remanence" or "NAME.field"; a number of a material, as "rubber.mu"; or a design, by its name.
        pub of: String,
        /// Its own name in results; that of `of` if left out.
        pub name: Option<String>,
        /// Where its values live.
        pub space: Space,
        /// Whether its logarithm is the unknown: of a positive number, whose steps are then shares of it.
        pub log: bool = false,
        /// Value to start from; zero if left out, of a number of a material that of the material, of a density and a factor 1, of a direction that written with it. A positive tension lengthens, a negative one contracts; a positive contraction of a muscle pulls. Vectors for magnets.
        pub start: Option<Start> as ANY_IN_TIME,
        /// Least value, of a vector a list; unbounded if left out, of a muscle and of a design 0, of a growth or strain -0.9. A tension contracts below zero.
        pub lower: Option<Bound> as ANY_IN_TIME,
        /// Largest value, of a vector a list; the law's convexity bound if left out, of a density, mixture or factor 1, of a shortening 0.9. A tension lengthens above zero.
        pub upper: Option<Bound> as ANY_IN_TIME,
        /// What is known of each of its values beside the costs: a cost that is counted once, whatever the load cases.
        pub prior: Option<ControlPrior>,
        /// Length every vector must have.
        pub norm: Option<Formula> as ANY_POSITIVE,
        /// Length no vector may exceed.
        pub max_norm: Option<Formula> as ANY_POSITIVE,
        /// Fixed direction of a vector: the control is then its amplitude, a scalar.
        pub direction: Option<Direction> as NUMBER,
        /// The length R over which its field is smoothed, by the equation s - R^2 laplace s = m; a cone of radius r is R = r / (2 sqrt 3).
        pub filter: Option<f64> as POSITIVE_LENGTH,
        /// Projection of its field, behind the filter: of a design between 0 and 1, else between its bounds.
        pub projection: Option<Projection>,
        /// Of a density, a mixture or an electrode: the level above which it is 1, elsewhere it is 0, as the optimum is made. Such a field has no derivative: it is solved, not optimised.
        pub cut: Option<f64> as NUMBER,
        /// Of what is cut at the optimum, a density, a mixture or an electrode: the thinnest bar that can be made, of which the optimum is warned about; the filter's length if left out.
        pub least_bar: Option<f64> as POSITIVE_LENGTH,
        /// Of the same: the narrowest gap that can be made, likewise.
        pub least_gap: Option<f64> as POSITIVE_LENGTH,
        /// Planes about which its field is symmetric: axes, for the planes across them in the middle, or planes by point and normal.
        pub symmetry: Vec<SymmetryPlane> = Vec::new(),
        /// Values that its field has in regions, whatever the control is there.
        pub fixed: BTreeMap<String, Formula> as ANY = BTreeMap::new(),
        /// Of a control that changes in time: where its values lie. One that is left out stays as it is for the whole motion.
        pub in_time: Option<InTime>,
        /// Largest change per time, of a vector its length; of a control that changes in time.
        pub rate: Option<Formula> as ANY_POSITIVE,
    }
}

object! {
    /// What is known of a control beside the costs: a normal distribution of its values; with "log" of the logarithms, about ln(mean) with deviation/mean.
    pub struct ControlPrior checked by check_prior {
        /// The mean, in the unit of the control.
        pub mean: Formula as ANY,
        /// The standard deviation.
        pub deviation: Formula as ANY_POSITIVE,
    }
}

choice! {
    /// Where a control's values live.
    pub enum Space {
        /// One value.
        "uniform" => Uniform,
        /// One value per region of the mesh.
        "region" => Region,
        /// One value per cell.
        "cell" => Cell,
        /// One value per corner node, linear between.
        "node" => Node,
        /// Multilinear between the nodes of a regular grid of so many cells along x, y and z, over the bounding box of the actuation's regions.
        "grid" => Grid(Cells),
    }
}

/// Numbers of cells along x, y and z; 1 where the third is left out.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Cells(pub [u32; 3]);

impl Read for Cells {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let counts = entries::<u64>(node, at, Want::POSITIVE, reader)?;
        let cells: Option<Vec<u32>> = counts.iter().map(|count| u32::try_from(*count).ok()).collect();
        match cells.as_deref() {
            Some(&[x, y]) => Some(Self([x, y, 1])),
            Some(&[x, y, z]) => Some(Self([x, y, z])),
            _ => {
                reader.expected(
                    node,
                    at,
                    "numbers of cells along x, y and z (of a plane body x and y), as in [4, 2, 2]",
                );
                None
            }
        }
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        json!({ "type": "array", "items": { "type": "integer", "minimum": 1 }, "minItems": 2, "maxItems": 3 })
    }
}

/// A least or largest value.
#[derive(Clone, PartialEq, Debug)]
pub enum Bound {
    /// Of a scalar.
    Scalar(Parameter),
    /// Of the components of a vector, two or three entries.
    Vector(Vec<Formula>),
}

impl Bound {
    /// Whether it changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        match self {
            Self::Scalar(bound) => bound.uses_time(),
            Self::Vector(entries) => entries.iter().any(Formula::uses_time),
        }
    }

    /// That of a scalar.
    #[must_use]
    pub fn scalar(&self) -> Option<&Parameter> {
        if let Self::Scalar(bound) = self { Some(bound) } else { None }
    }
}

impl Read for Bound {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Array(_) => entries(node, at, want, reader).map(Self::Vector),
            _ => Parameter::read(node, at, want, reader).map(Self::Scalar),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![Parameter::schema(want, definitions), vector::<Formula>(want, definitions)])
    }
}

/// What a control starts from.
#[derive(Clone, PartialEq, Debug)]
pub enum Start {
    /// A scalar, constant or of X, Y, Z, t.
    Scalar(Formula),
    /// A vector, two or three entries.
    Vector(Vec<Formula>),
    /// An array of an earlier result.
    Array(ArrayFile),
    /// The values of an earlier `controls.json`.
    Controls(ControlsFile),
    /// Values over the time.
    Table(TimeTable),
    /// Random directions of the control's norm, from this seed.
    Random(u64),
}

object! {
    /// The optimal controls of an earlier run, `controls.json`.
    pub struct ControlsFile {
        /// The file, relative to the case.
        pub file: String,
        /// Name of the control there; its own if left out.
        pub control: Option<String>,
        /// Cells of the grid that it was made with, where that is another one than the control's: its field is taken at the nodes of the present grid, exact where one grid divides the cells of the other.
        pub grid: Option<Cells>,
    }
}

object! {
    /// Random unit vectors.
    pub struct RandomStart {
        /// The seed.
        pub random: u64,
    }
}

/// Whether a start names a JSON file.
fn is_controls_file(members: &[Property]) -> bool {
    members.iter().any(|member| {
        member.key == "file" && matches!(&member.node.value, Value::Text(file) if file.ends_with(".json"))
    })
}

impl Control {
    /// Its name in results.
    #[must_use]
    pub fn name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.of)
    }

    /// The length that every vector has.
    #[must_use]
    pub fn length(&self) -> Option<f64> {
        self.norm.as_ref().and_then(Formula::constant)
    }

    /// The length that no vector exceeds.
    #[must_use]
    pub fn longest(&self) -> Option<f64> {
        self.max_norm.as_ref().and_then(Formula::constant)
    }
}

impl Start {
    /// Whether it changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        match self {
            Self::Scalar(formula) => formula.uses_time(),
            Self::Vector(entries) => entries.iter().any(Formula::uses_time),
            Self::Table(_) => true,
            Self::Array(_) | Self::Controls(_) | Self::Random(_) => false,
        }
    }
}

impl Read for Start {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Array(_) => entries(node, at, want, reader).map(Self::Vector),
            Value::Object(members) if members.iter().any(|member| member.key == "random") => {
                RandomStart::read(node, at, want, reader).map(|start| Self::Random(start.random))
            }
            Value::Object(_) if TimeTable::is_named_by(node) => {
                TimeTable::read_for(None, node, at, reader).map(Self::Table)
            }
            Value::Object(members) if is_controls_file(members) => {
                ControlsFile::read(node, at, want, reader).map(Self::Controls)
            }
            Value::Object(_) => ArrayFile::read(node, at, want, reader).map(Self::Array),
            _ => Formula::read(node, at, want, reader).map(Self::Scalar),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![
            Formula::schema(want, definitions),
            vector::<Formula>(want, definitions),
            ArrayFile::schema(want, definitions),
            ControlsFile::schema(want, definitions),
            TimeTable::schema(want, definitions),
            RandomStart::schema(want, definitions),
        ])
    }
}

fn check(control: &Control, reader: &mut Reader<'_>) {
    let start = if let Some(Start::Scalar(start)) = &control.start { start.constant() } else { None };
    let values = [("lower", constant(&control.lower)), ("upper", constant(&control.upper)), ("start", start)];
    for (key, value) in values.into_iter().filter(|_| control.log) {
        if let Some(value) = value.filter(|value| *value <= 0.0) {
            let message = format!("{value} has no logarithm: with \"log\" all values are positive");
            reader.complain_at(&control.at.key(key), message);
        }
    }
    if let (Some(lower), Some(upper)) = (constant(&control.lower), constant(&control.upper)) {
        if lower > upper {
            let message = format!("crossed bounds: \"lower\" is {lower}, above \"upper\" {upper}");
            reader.complain_at(&control.at.key("lower"), message);
        } else if let Some(Start::Scalar(start)) = &control.start {
            let outside = start.constant().filter(|value| !(lower..=upper).contains(value));
            if let Some(value) = outside {
                let message = format!("the start {value} lies outside the bounds {lower} to {upper}");
                reader.complain_at(&control.at.key("start"), message);
            }
        }
    }
    let sizes = [("norm", &control.norm), ("max_norm", &control.max_norm), ("rate", &control.rate)];
    for (key, size) in sizes {
        if let Some(text) = size.as_ref().filter(|size| size.constant().is_none()).map(Formula::text) {
            let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(text));
            reader.complain_at(&control.at.key(key), message);
        }
    }
    if control.log && control.projection.is_some() {
        let message = "a projection takes the value, the unknown is its logarithm: leave one of them out";
        reader.complain_at(&control.at.key("projection"), message);
    }
    if let Some(projection) = control.projection.as_ref().filter(|own| !(0.0..=1.0).contains(&own.eta)) {
        let message = format!("the threshold {} is a share of the way between the ends: from 0 to 1", projection.eta);
        reader.complain_at(&projection.at.key("eta"), message);
    }
    for (region, value) in control.fixed.iter().filter(|(_, value)| value.constant().is_none()) {
        let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(value.text()));
        reader.complain_at(&control.at.key("fixed").key(region), message);
    }
    if control.log && control.rate.is_some() {
        let message = "a rate is that of the value, the unknown is its logarithm: leave one of them out";
        reader.complain_at(&control.at.key("rate"), message);
    }
    if let (Some(_), None) = (&control.rate, &control.in_time) {
        let message = "the rate of a control that does not change in time: give \"in_time\": { \"every\": \"50 ms\" }";
        reader.complain_at(&control.at.key("rate"), message);
    }
    if control.norm.is_some() && control.max_norm.is_some() {
        reader.complain_at(&control.at.key("max_norm"), "\"norm\" fixes the length already: give one of them");
    }
}

fn check_prior(block: &ControlPrior, reader: &mut Reader<'_>) {
    for (key, value) in [("mean", &block.mean), ("deviation", &block.deviation)] {
        if value.constant().is_none() {
            let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(value.text()));
            reader.complain_at(&block.at.key(key), message);
        }
    }
}

fn constant(bound: &Option<Bound>) -> Option<f64> {
    bound.as_ref().and_then(Bound::scalar).and_then(Parameter::constant)
}
