//! The blocks of `design`: numbers in front of laws, which follow design fields.

use crate::number::short;
use crate::quantity::Want;
use crate::schema::catalogue::{Input, form_schema, read_inputs};
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Key, Read, Reader};
use crate::syntax::{At, Node, Value, quoted};
use nastic_energy::catalogue::MaterialRow;
use nastic_energy::{Dielectric, Scale};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::fmt;

object! {
    /// A number s of the body in front of a law, by its name a control: the same name in several laws is one field.
    pub struct Design checked by check {
        /// Name of the field, by which a control refers to it: "rho".
        pub name: String,
        /// What the field is to the law.
        pub kind: DesignKind,
        /// The factor of the law: of a density "simp" if left out, of a filler "mooney".
        pub interpolation: Option<Interpolation>,
        /// p of "simp" (1, or at least 2) and of "ramp"; 3 if left out.
        pub power: Option<f64> as NOT_NEGATIVE,
        /// Share e of the stiffness that a density of zero leaves; 1e-6 if left out.
        pub least: Option<f64> as POSITIVE,
        /// Of a mixture: the other law, or the name of a material whose law it is.
        pub with: Option<MixedLaw>,
        /// Whether mass and weight of the material follow a density or a mixture; true if left out.
        pub mass: Option<bool>,
    }
}

choice! {
    /// What a design field s is to a law W.
    pub enum DesignKind {
        /// chi(s) W, chi(1) = 1: how much material there is.
        "density" => Density,
        /// chi(s) W, chi(0) = 1: share of rigid particles in an elastomer.
        "filler" => Filler,
        /// (1 - s) W + s W': share of another law.
        "mixture" => Mixture,
        /// s W, of an actuation: where it acts.
        "factor" => Factor,
        /// s^2 W, of a dielectric, whose field is s times that of its control: where a film has electrodes.
        "electrode" => Electrode,
    }
}

choice! {
    /// The factor chi of a law.
    pub enum Interpolation {
        /// e + (1 - e) s^p.
        "simp" => Simp,
        /// e + (1 - e) s / (1 + p (1 - s)).
        "ramp" => Ramp,
        /// exp(2.5 s / (1 - 1.35 s)).
        "mooney" => Mooney,
        /// 1 + 2.5 s + 14.1 s^2.
        "guth" => Guth,
        /// 1 / (1 - 2.5 s).
        "hill" => Hill,
    }
}

/// Share of the stiffness that a void keeps where none is given.
const LEAST: f64 = 1e-6;
/// The exponent where none is given.
const POWER: f64 = 3.0;

impl Design {
    /// The factor of the law; none of a mixture.
    #[must_use]
    pub fn scale(&self) -> Option<Scale> {
        let (floor, p) = (self.least.unwrap_or(LEAST), self.power.unwrap_or(POWER));
        match (&self.kind, &self.interpolation) {
            (DesignKind::Mixture, _) => None,
            (DesignKind::Factor, _) => Some(Scale::Factor),
            (DesignKind::Electrode, _) => Some(Scale::Electrode),
            (DesignKind::Density, Some(Interpolation::Ramp)) => Some(Scale::Ramp { floor, penalty: p }),
            (DesignKind::Density, _) => Some(Scale::Simp { floor, exponent: p }),
            (DesignKind::Filler, Some(Interpolation::Guth)) => Some(Scale::Guth),
            (DesignKind::Filler, Some(Interpolation::Hill)) => Some(Scale::Hill),
            (DesignKind::Filler, _) => Some(Scale::Mooney),
        }
    }

    /// Where s may be.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.scale().map_or([0.0, 1.0], |scale| scale.range())
    }
}

/// As people read it: `rho: density by simp (p = 3, least 1e-6)`.
impl fmt::Display for Design {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mass = if self.mass == Some(false) { ", the mass does not follow" } else { "" };
        let (name, kind) = (&self.name, self.kind.name());
        match (self.scale(), &self.with) {
            (Some(Scale::Factor | Scale::Electrode), _) => write!(f, "{name}: {kind}"),
            (Some(Scale::Simp { floor, exponent: p } | Scale::Ramp { floor, penalty: p }), _) => {
                let by = if matches!(self.interpolation, Some(Interpolation::Ramp)) { "ramp" } else { "simp" };
                write!(f, "{name}: {kind} by {by} (p = {}, least {}){mass}", short(p), short(floor))
            }
            (Some(scale), _) => write!(f, "{name}: {kind} by {}", scale.name()),
            (None, Some(MixedLaw::Law(law))) => write!(f, "{name}: {kind} with {}{mass}", law.law.name),
            (None, Some(MixedLaw::Name(with))) => write!(f, "{name}: {kind} with that of {with}{mass}"),
            (None, None) => write!(f, "{name}: {kind}"),
        }
    }
}

/// The other law of a mixture.
#[derive(Clone, PartialEq, Debug)]
pub enum MixedLaw {
    /// That of the material of this name.
    Name(String),
    /// One of its own.
    Law(Box<OwnLaw>),
}

/// A law without a region.
#[derive(Clone, Debug)]
pub struct OwnLaw {
    /// Path of this block in the case.
    pub at: At,
    /// The law.
    pub law: &'static MaterialRow,
    /// Mass per reference volume; where none is given, the mixture has the mass of the other material.
    pub density: Option<f64>,
    /// Exactly the parameters of one of the law's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
}

impl PartialEq for OwnLaw {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, self.law.name, self.density, &self.parameters)
            == (&other.at, other.law.name, other.density, &other.parameters)
    }
}

const DENSITY: &str = "Mass per reference volume.";

impl Read for MixedLaw {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        if let Value::Text(_) = node.value {
            return String::read(node, at, want, reader).map(Self::Name);
        }
        let laws = reader.document.catalogue().materials();
        let names: Vec<&str> = laws.iter().map(|law| law.name).collect();
        let name = reader.tag(node, at, "law", &names)?;
        let law = laws.iter().find(|law| law.name == name)?;
        let known: Vec<&str> = ["law", "density"].into_iter().chain(law.parameters().iter().map(|p| p.name)).collect();
        let members = reader.members(node, at)?;
        reader.refuse_unknown(members, at, &known);
        let parameters = read_inputs(law.name, law.forms, node, at, reader);
        let density: Option<Option<f64>> = reader.key(node, at, "density", DENSITY, Want::DENSITY, Some(None));
        Some(Self::Law(Box::new(OwnLaw { at: at.clone(), law, density: density?, parameters: parameters? })))
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        let law = definitions.part("MixedLaw", |definitions| {
            let mut options = Vec::new();
            for law in definitions.catalogue.clone().materials() {
                for form in law.forms {
                    let keys = vec![
                        Key::as_is("law", true, json!({ "const": law.name })),
                        Key::new::<Option<f64>>("density", DENSITY, Want::DENSITY, Some(None), definitions),
                    ];
                    options.push(form_schema(law.about, keys, form, definitions));
                }
            }
            json!({ "description": "A law without a region.", "oneOf": options })
        });
        any_of(vec![String::schema(Want::ANY, definitions), law])
    }
}

fn check(design: &Design, reader: &mut Reader<'_>) {
    use Interpolation::{Guth, Hill, Mooney, Ramp, Simp};
    let kind = design.kind.name();
    let fits = match (&design.kind, &design.interpolation) {
        (_, None) => true,
        (DesignKind::Density, Some(own)) => matches!(own, Simp | Ramp),
        (DesignKind::Filler, Some(own)) => matches!(own, Mooney | Guth | Hill),
        _ => false,
    };
    if let Some(own) = design.interpolation.as_ref().filter(|_| !fits) {
        let message = format!(
            "a {kind} is not interpolated by {}: \"simp\" and \"ramp\" are of a density, \"mooney\", \"guth\" and \"hill\" of a filler",
            quoted(own.name())
        );
        reader.complain_at(&design.at.key("interpolation"), message);
    }
    let of_density = [("power", design.power.is_some()), ("least", design.least.is_some())];
    for (key, _) in of_density.into_iter().filter(|(_, given)| *given && design.kind != DesignKind::Density) {
        reader.complain_at(&design.at.key(key), format!("belongs to a density, not to a {kind}: leave it out"));
    }
    match (design.kind == DesignKind::Mixture, &design.with) {
        (true, None) => {
            let message =
                "missing key \"with\": the other law of the mixture, { \"law\": .. }, or the name of a material";
            reader.complain_at(&design.at, message);
        }
        (false, Some(_)) => {
            reader.complain_at(&design.at.key("with"), format!("belongs to a mixture, not to a {kind}: leave it out"));
        }
        _ => {}
    }
    if design.mass.is_some() && !matches!(design.kind, DesignKind::Density | DesignKind::Mixture) {
        reader.complain_at(&design.at.key("mass"), format!("no mass follows a {kind}: leave it out"));
    }
}

const DESIGN: &str = "Numbers in front of the law, each of which follows a design field.";

/// The list `design` of a block; with the name of its law where that is an actuation.
pub(crate) fn read_list(node: &Node, at: &At, actuation: Option<&str>, reader: &mut Reader<'_>) -> Option<Vec<Design>> {
    let all: Vec<Design> = reader.key(node, at, "design", DESIGN, Want::ANY, Some(vec![]))?;
    for (k, design) in all.iter().enumerate() {
        if let Some(first) = all[..k].iter().find(|other| other.name == design.name) {
            let message = format!("{} stands in front of this law already, at {}", quoted(&design.name), first.at);
            reader.complain_at(&design.at.key("name"), message);
        }
        let message = match (actuation, &design.kind) {
            (Some(_), DesignKind::Mixture) => {
                "a mixture is one of two materials: an actuation takes \"factor\"".to_owned()
            }
            (None, DesignKind::Factor) => {
                "a law that holds the body has no stiffness where its factor is 0: take \"density\"".to_owned()
            }
            (Some(Dielectric::NAME), DesignKind::Electrode) => continue,
            (Some(other), DesignKind::Electrode) => {
                format!("electrodes cover a \"dielectric\", not a {}: take \"factor\"", quoted(other))
            }
            (None, DesignKind::Electrode) => {
                "electrodes cover a \"dielectric\" of \"actuation\", whose \"design\" takes them".to_owned()
            }
            _ => continue,
        };
        reader.complain_at(&design.at.key("kind"), message);
    }
    Some(all)
}

/// Its key in the schema.
pub(crate) fn list_key(definitions: &mut Definitions) -> Key {
    Key::new::<Vec<Design>>("design", DESIGN, Want::ANY, Some(vec![]), definitions)
}
