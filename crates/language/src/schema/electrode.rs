//! The blocks of `electrodes`.

use crate::quantity::{Dimension, Want};
use crate::schema::actuation::{Actuation, Means, contribution_keys};
use crate::schema::json::Definitions;
use crate::schema::read::{Key, Read, Reader};
use crate::syntax::{At, Node, Property, Value, quoted};
use nastic_fem::Electrode as Contribution;
use nastic_fem::catalogue::{ELECTRODE, KeyKind};
use serde_json::Value as Json;

/// Nodes with one electric potential. From the reading of a case on they stand behind its actuations, whose controls and fixed values work alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Electrode(pub Actuation);

/// What electrodes are called among actuations.
pub(crate) const KIND: &str = "electrode";
const FLOATING: &str = "floating";

impl Electrode {
    /// Of an actuation that was one: `None` of another.
    pub(crate) fn of(actuation: &Actuation) -> Option<&Actuation> {
        Some(actuation).filter(|own| own.kind() == KIND)
    }
}

impl Read for Electrode {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let electrode = Actuation::read_contribution(KIND, &ELECTRODE, node, at, reader)?;
        check(&electrode, node, reader);
        Some(Self(electrode))
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.part("Electrode", |definitions| {
            let keys: Vec<Key> = contribution_keys(&ELECTRODE, definitions);
            crate::schema::catalogue::row_schema(ELECTRODE.about, keys)
        })
    }
}

/// One place, and at most one of what drives it; numbers with their unit where a case's own one is none of V or C.
fn check(electrode: &Actuation, node: &Node, reader: &mut Reader<'_>) {
    let Value::Object(members) = &node.value else { return };
    let has = |key: &str| members.iter().any(|member| member.key == key);
    let of_place = |kind: KeyKind| matches!(kind, KeyKind::Surface | KeyKind::Region | KeyKind::Nodes);
    let places: Vec<&str> = ELECTRODE.keys.iter().filter(|key| of_place(key.kind)).map(|key| key.name).collect();
    let given = places.iter().filter(|key| has(key)).count();
    if given != 1 {
        let names: Vec<String> = places.iter().map(|key| quoted(key)).collect();
        let message = format!("exactly one of {} says where an electrode is; found {given}", names.join(", "));
        reader.complain_at(&electrode.at, message);
    }
    let Means::Contribution { values, .. } = &electrode.means else { return };
    let slots = [Contribution::VOLTAGE.group, Contribution::CHARGE.group];
    let drives: Vec<&str> = slots.into_iter().filter(|key| electrode.fixed.contains_key(key)).collect();
    match drives[..] {
        [one, ..] if values.flags.contains(FLOATING) => {
            let message = format!(
                "a floating electrode has no charge and finds its voltage: leave \"{one}\" or \"{FLOATING}\" out"
            );
            reader.complain_at(&electrode.at.key(one), message);
        }
        [_, charge] => {
            reader.complain_at(
                &electrode.at.key(charge),
                "an electrode has a \"voltage\" or a \"charge\": the other follows",
            );
        }
        _ => {}
    }
    members.iter().for_each(|member| check_unit(member, electrode, reader));
}

/// A plain number is in the unit that follows from the case's base units, which nobody means unless it is V or C.
fn check_unit(member: &Property, electrode: &Actuation, reader: &mut Reader<'_>) {
    let dimension = match member.key.as_str() {
        key if key == Contribution::VOLTAGE.group => Dimension::VOLTAGE,
        key if key == Contribution::CHARGE.group => Dimension::CHARGE,
        _ => return,
    };
    let Value::Number(number) = member.node.value else { return };
    if number != 0.0 && reader.units.in_si(1.0, dimension) != 1.0 {
        let (own, unit) = (reader.units.label(dimension), if dimension == Dimension::CHARGE { "nC" } else { "kV" });
        let message =
            format!("a plain number is in the case's units here, in {own}: write the unit, \"{number} {unit}\"");
        reader.complain_at(&electrode.at.key(&member.key), message);
    }
}
