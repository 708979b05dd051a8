//! [`ContributionRecord`]: what a contribution reports of a state, by its [`ContributionKind`]; [`BlockRecords`]: blocks of the case that add one each,
//! as `check` describes them.

use crate::number::{number, short};
use crate::record::{BodyPointRecord, Nullable, Number, Numbers, RigidMotion, UnitsRecord, number_of};
use serde::{Deserialize, Serialize};
use std::ops::Deref;

records! {
    /// The blocks of the case that add a contribution each.
    BlockRecords {
        /// The springs.
        springs: Option<Vec<SpringRecord>>,
        /// The media of voids.
        media: Option<Vec<MediumRecord>>,
    }

    /// A medium.
    MediumRecord {
        /// Its name.
        name: String,
        /// The regions it fills.
        region: Vec<String>,
        /// Its stiffness.
        stiffness: Number,
    }

    /// A spring.
    SpringRecord {
        /// Its name.
        name: String,
        /// One end.
        from: Nullable<BodyPointRecord>,
        /// The other.
        to: Nullable<BodyPointRecord>,
        /// Its stiffness.
        stiffness: Number,
        /// Its length without a force.
        rest_length: Nullable<f64>,
        /// Its force where the body is at rest.
        force_at_rest: Nullable<f64>,
    }
}

/// What a contribution reports of a state. Files have the numbers alone: they tell the kind, once, where a record is made or read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Numbers", into = "Numbers")]
pub struct ContributionRecord {
    /// The kind.
    pub kind: ContributionKind,
    numbers: Numbers,
}

/// A kind of contributions, in the order of their tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContributionKind {
    /// A support that gives way, or one that holds.
    Support,
    /// A contact.
    Contact,
    /// A rigid body.
    RigidBody,
    /// A chamber.
    Cavity,
    /// What has no table of its own.
    Other,
    /// A tendon.
    Tendon,
    /// A spring.
    Spring,
    /// An electrode.
    Electrode,
}

/// What results, pages and pictures have of a kind.
pub(crate) struct KindRow {
    /// Head of the first column of its table.
    pub head: &'static str,
    /// What several are called in the heading of the tables; empty of what has no place there.
    pub several: &'static str,
    /// A number that no kind before this one reports.
    mark: &'static str,
    /// The other columns.
    columns: &'static [Column],
}

/// Head, number, and its unit of the length L, the force F or the pressure P; square brackets put the unit into the head.
type Column = (&'static str, &'static str, &'static str);

const OF_CONTACT: [Column; 7] = [
    ("x", "force_x", "[F]"),
    ("y", "force_y", "[F]"),
    ("z", "force_z", "[F]"),
    ("sum of normal forces", "pressing", "[F]"),
    ("area", "area", "[L^2]"),
    ("largest pressure", "largest_pressure", "[P]"),
    ("smallest gap", "smallest_gap", "[L]"),
];
const OF_RIGID_BODY: [Column; 7] = [
    ("u x", "translation_x", "[L]"),
    ("u y", "translation_y", "[L]"),
    ("u z", "translation_z", "[L]"),
    ("turns by", "", "[degrees]"),
    ("turn x", "rotation_x", "[rad]"),
    ("turn y", "rotation_y", "[rad]"),
    ("turn z", "rotation_z", "[rad]"),
];
const OF_CAVITY: [Column; 3] =
    [("pressure", "pressure", "P"), ("volume", "volume", "L^3"), ("volume at rest", "reference_volume", "L^3")];
const OF_TENDON: [Column; 4] = [
    ("", SLACK, ""),
    ("tension", "tension", "F"),
    ("length", "length", "L"),
    ("length at rest", "reference_length", "L"),
];
const OF_SPRING: [Column; 3] =
    [("force", "force", "F"), ("length", "length", "L"), ("rest length", "rest_length", "L")];
/// In SI units.
const OF_ELECTRODE: [Column; 3] =
    [("voltage", "voltage", "V"), ("charge", "charge", "C"), ("capacitance", "capacitance", "C/V")];
/// What draws lines that have a tension.
pub const TENSED_LINES: &str = "tendons";
/// What draws lines that have none.
pub const PLAIN_LINES: &str = "springs";
/// What a tendon reports of itself as 1 or 0.
const SLACK: &str = "slack";

impl ContributionKind {
    /// All of them.
    pub(crate) const ALL: [Self; 8] = [
        Self::Support,
        Self::Contact,
        Self::RigidBody,
        Self::Cavity,
        Self::Other,
        Self::Tendon,
        Self::Spring,
        Self::Electrode,
    ];

    /// Its row.
    pub(crate) fn row(self) -> KindRow {
        let (head, several, mark, columns): (_, _, _, &[Column]) = match self {
            Self::Support => ("reaction at", "reactions", "force_x", &OF_CONTACT[..3]),
            Self::Contact => ("contact", "contacts", "pressing", &OF_CONTACT),
            Self::RigidBody => ("rigid body", "rigid bodies", "rotation_z", &OF_RIGID_BODY),
            Self::Cavity => ("cavity", "cavities", "volume", &OF_CAVITY),
            // a chamber behind a lid reports the force on that too
            Self::Other => ("contribution", "", "swept_volume", &[("", "", ""), ("", "", "")]),
            Self::Tendon => ("tendon", "tendons", "tension", &OF_TENDON),
            Self::Spring => ("spring", "springs", "rest_length", &OF_SPRING),
            Self::Electrode => ("electrode", "electrodes", "charge", &OF_ELECTRODE),
        };
        KindRow { head, several, mark, columns }
    }

    /// The heads of its table.
    pub(crate) fn heads(self, units: &UnitsRecord) -> Vec<String> {
        let KindRow { head, columns, .. } = self.row();
        let of = |(head, _, unit): &Column| match unit.strip_prefix('[') {
            Some(_) => format!("{head} {}", in_units(unit, units)),
            None => (*head).to_owned(),
        };
        [head.to_owned()].into_iter().chain(columns.iter().map(of)).collect()
    }
}

fn in_units(unit: &str, units: &UnitsRecord) -> String {
    unit.replace('L', &units.length).replace('F', &units.force).replace('P', &units.pressure)
}

impl ContributionRecord {
    /// The force of a support.
    pub(crate) fn of_support(force: &[Number]) -> Self {
        let components = OF_CONTACT.iter().zip(force);
        components.map(|((_, key, _), component)| ((*key).to_owned(), *component)).collect::<Numbers>().into()
    }

    /// Of a chamber its volume, and that at rest.
    #[must_use]
    pub fn volumes(&self) -> Option<[f64; 2]> {
        let [volume, rest] = ["volume", "reference_volume"].map(|key| number_of(self, key));
        (self.kind == ContributionKind::Cavity).then_some([volume?, rest?])
    }

    /// Its rows in the table of its kind, under the name.
    pub(crate) fn rows(&self, name: &str, units: &UnitsRecord) -> Vec<Vec<String>> {
        if self.kind == ContributionKind::Other {
            let row =
                |(key, value): (&String, &Number)| vec![name.to_owned(), key.replace('_', " "), number(*value, "")];
            return self.iter().map(row).collect();
        }
        let motion = RigidMotion::of(self);
        let cell = |(_, key, unit): &Column| match (number_of(self, key), &motion) {
            (None, Some(motion)) if key.is_empty() => short(RigidMotion::size(&motion.rotation).to_degrees()),
            // of a plane body
            (value, Some(_)) => short(value.unwrap_or_default()),
            (slack, None) if *key == SLACK => if slack == Some(1.0) { "slack" } else { "taut" }.to_owned(),
            (value, None) if unit.starts_with('[') => number(value, ""),
            (value, None) => number(value, &in_units(unit, units)),
        };
        vec![[name.to_owned()].into_iter().chain(self.kind.row().columns.iter().map(cell)).collect()]
    }
}

impl From<Numbers> for ContributionRecord {
    fn from(numbers: Numbers) -> Self {
        let is_marked = |kind: &ContributionKind| numbers.contains_key(kind.row().mark);
        let kind = ContributionKind::ALL.into_iter().rfind(is_marked).unwrap_or(ContributionKind::Other);
        Self { kind, numbers }
    }
}

impl From<Vec<(&'static str, f64)>> for ContributionRecord {
    fn from(quantities: Vec<(&'static str, f64)>) -> Self {
        quantities.into_iter().map(|(key, value)| (key.to_owned(), value.into())).collect::<Numbers>().into()
    }
}

impl From<ContributionRecord> for Numbers {
    fn from(record: ContributionRecord) -> Self {
        record.numbers
    }
}

impl Deref for ContributionRecord {
    type Target = Numbers;

    fn deref(&self) -> &Numbers {
        &self.numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_tell_the_kind_and_stay_as_they_are() {
        use ContributionKind::{Cavity, Contact, Electrode, Other, RigidBody, Spring, Support, Tendon};
        for (kind, text) in [
            (Support, r#"{"force_x":1.0,"force_y":null}"#),
            (Contact, r#"{"force_x":1.0,"pressing":2.0,"area":3.0}"#),
            (RigidBody, r#"{"translation_x":1.0,"rotation_z":0.5}"#),
            (Cavity, r#"{"pressure":1.0,"volume":2.0,"reference_volume":1.5}"#),
            (Other, r#"{"pressure":1.0,"swept_volume":2.0,"force_x":3.0}"#),
            (Other, r#"{"mass":1.0}"#),
            (Tendon, r#"{"tension":1.0,"length":2.0,"slack":0.0}"#),
            (Spring, r#"{"force":1.0,"length":2.0,"rest_length":1.5}"#),
            (Electrode, r#"{"voltage":1.0,"charge":2.0,"capacitance":2.0}"#),
        ] {
            let record: Result<ContributionRecord, _> = serde_json::from_str(text);
            let found = record.ok().map(|own| (own.kind, own.volumes(), serde_json::to_string(&own).ok()));
            let volumes = (kind == Cavity).then_some([2.0, 1.5]);
            assert_eq!(found, Some((kind, volumes, Some(text.to_owned()))));
        }
    }
}
