//! [`Remeshed`]: the costs of a design as a field, cut on its mesh and meshed along its outline.

use nastic_language::number::short;
use nastic_numeric::format::scientific;
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Share of the cost of the field by which that of the mesh along the outline may differ without a warning.
pub(crate) const COST_TOLERANCE: f64 = 0.1;

/// A solution of a design.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Solved {
    /// The whole cost, without those of designs that are cut.
    pub cost: Option<f64>,
    /// Its terms.
    pub terms: Value,
    /// The probes of the case.
    pub probes: Value,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl Solved {
    /// From the result of a solve.
    pub(crate) fn of(result: &Value) -> Self {
        let entry = |pointer: &str| result.pointer(pointer).cloned().unwrap_or_default();
        let error = result["error"].as_str().map(str::to_owned);
        Solved { cost: entry("/cost/total").as_f64(), terms: entry("/cost/terms"), probes: entry("/probes"), error }
    }

    pub(crate) fn failed(why: String) -> Self {
        Solved { error: Some(why), ..Solved::default() }
    }
}

/// A named group of the old mesh on the new one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CarriedGroup {
    /// Its length, area, or number of nodes before.
    pub before: f64,
    /// The same now.
    pub after: f64,
    /// Whether the case names it.
    pub used: bool,
}

/// The volume of what a design fills, of a plane body the area.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DesignVolume {
    /// That the field stands for.
    pub field: f64,
    /// Above its level, without what was dropped.
    pub outline: f64,
    /// Of the cells of the new mesh.
    pub meshed: f64,
}

/// What was made of an optimum, `remesh.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Remeshed {
    /// "remesh".
    pub command: &'static str,
    /// The directory of the optimum.
    pub of: String,
    /// The new case.
    pub case: String,
    /// The size of its cells.
    pub size: f64,
    /// Removed points of the outline lie no farther from it.
    pub tolerance: f64,
    /// The kind of the new cells.
    pub element: String,
    /// Cells of the new mesh.
    pub cells: usize,
    /// Its nodes.
    pub nodes: usize,
    /// The volumes of pieces that were dropped, as nothing holds them.
    pub islands: Vec<f64>,
    /// Volumes by design.
    pub volumes: BTreeMap<String, DesignVolume>,
    /// Named surfaces.
    pub surfaces: BTreeMap<String, CarriedGroup>,
    /// Named sets of nodes.
    pub node_sets: BTreeMap<String, CarriedGroup>,
    /// The optimum, as a field.
    pub field: Solved,
    /// The optimum with each cell of its mesh 0 or 1.
    pub cut: Solved,
    /// Meshed along its outline.
    pub meshed: Solved,
    /// What the case lost.
    pub told: Vec<String>,
    /// What deserves attention.
    pub warnings: Vec<String>,
}

impl Remeshed {
    /// The table of costs and probes.
    #[must_use]
    pub fn table(&self) -> String {
        let mut rows = vec![["", "field", "cut", "outline"].map(str::to_owned)];
        let all = [&self.field, &self.cut, &self.meshed];
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| scientific(value, 6));
        let row = |name: &str, values: [Option<f64>; 3]| {
            let [a, b, c] = values.map(number);
            [name.to_owned(), a, b, c]
        };
        rows.push(row("cost", all.map(|own| own.cost)));
        let empty = Map::new();
        let terms = self.meshed.terms.as_object().unwrap_or(&empty);
        for name in terms.keys().filter(|_| terms.len() > 1) {
            rows.push(row(&format!("  {name}"), all.map(|own| own.terms[name].as_f64())));
        }
        let mut probes = Vec::new();
        numbers_within("", &self.meshed.probes, &mut probes);
        // where a probe is says its displacement, and of a plane body the third component nothing
        for path in probes.iter().filter(|path| !path.contains("/point/") && !path.contains("/position/")) {
            let values = all.map(|own| own.probes.pointer(path).and_then(Value::as_f64));
            if values.iter().any(|value| value.is_some_and(|value| value != 0.0)) {
                rows.push(row(path.trim_start_matches('/'), values));
            }
        }
        for (name, own) in &self.volumes {
            rows.push(row(&format!("volume {name}"), [Some(own.field), Some(own.outline), Some(own.meshed)]));
        }
        let widths = [0, 1, 2, 3].map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0));
        let line = |[name, a, b, c]: &[String; 4]| {
            format!(
                "{name:w0$}  {a:>w1$}  {b:>w2$}  {c:>w3$}",
                w0 = widths[0],
                w1 = widths[1],
                w2 = widths[2],
                w3 = widths[3]
            )
        };
        rows.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// The cost of the outline against that of the field.
    pub(crate) fn compare(&mut self) {
        let (Some(field), Some(meshed)) = (self.field.cost, self.meshed.cost) else { return };
        if (meshed - field).abs() > COST_TOLERANCE * field.abs() {
            let [field, meshed, most] = [field, meshed, 100.0 * COST_TOLERANCE].map(short);
            self.warnings.push(format!(
                "the cost of the body meshed along its outline, {meshed}, differs from that of the field, {field}, by more than {most} %: sharpen the \
                 projection, or make cells smaller"
            ));
        }
    }
}

/// The paths of the numbers within a value.
fn numbers_within(path: &str, value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => members.iter().for_each(|(key, own)| {
            numbers_within(&format!("{path}/{}", key.replace('~', "~0").replace('/', "~1")), own, found);
        }),
        Value::Array(all) => {
            all.iter().enumerate().for_each(|(k, own)| numbers_within(&format!("{path}/{k}"), own, found));
        }
        Value::Number(_) => found.push(path.to_owned()),
        _ => {}
    }
}
