//! [`Fitted`]: one law, and its entry in `fit.json`.

use crate::run::describe::conditions;
use crate::schema::FitData;
use nastic_energy::{Existence, Place};
use nastic_fit::{
    Bulk, End, Errors, Estimate, Fit, FitError, Law, Mode, Range, Scenario, Test, bulk, scenarios, stable_range,
};
use serde_json::{Map, Value, json};

/// Modes in which stability is examined.
const MODES: [Mode; 3] = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar];

/// The range of stability in one kind of test.
pub(super) struct Stable {
    pub mode: Mode,
    pub range: Range,
    /// Whether it ends, below and above, within the stretches measured in tests of this kind.
    pub within: [bool; 2],
}

/// A law with its parameters, and all that follows from them.
pub(super) struct Fitted {
    pub fit: Fit,
    pub bulk: Bulk,
    /// Shear modulus at rest, Pa.
    pub shear: f64,
    pub stable: Vec<Stable>,
    pub existence: Option<Existence>,
    region: String,
    scenarios: Vec<Scenario>,
}

impl Fitted {
    pub fn new(fit: Fit, asked: &FitData, tests: &[Test]) -> Result<Self, FitError> {
        let values = fit.values();
        let bulk = match asked.bulk {
            Some(value) => Bulk { value, deviation: None, half_width: None },
            None => bulk(fit.law, &values, tests)?,
        };
        let law = fit.law.build(&values, bulk.value)?;
        let incompressible = fit.law.incompressible(&values)?;
        let shear = fit.law.shear(&values)?;
        let reach = asked.stable_to.unwrap_or_else(|| 1.25 * largest_stretch(tests));
        let stable = MODES.map(|mode| Stable::new(mode, stable_range(&*incompressible, mode, reach), tests));
        let existence = law.existence(Place { cell: 0, point: 0 });
        // those that this bulk modulus does not fit are no materials
        let scenarios = scenarios(&fit);
        let admissible = scenarios.iter().all(|one| fit.law.build(&one.parameters, bulk.value).is_ok());
        let scenarios = if admissible { scenarios } else { vec![] };
        Ok(Fitted { fit, bulk, shear, stable: stable.into(), existence, region: asked.region.clone(), scenarios })
    }

    /// Poisson's ratio at rest, `(3 K - 2 G)/(2 (3 K + G))`.
    pub fn poisson(&self) -> f64 {
        (3.0 * self.bulk.value - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk.value + self.shear))
    }

    /// The block to paste.
    pub fn materials(&self) -> Value {
        let mut block = Map::new();
        block.insert("region".into(), json!(self.region));
        block.insert("law".into(), json!(self.fit.law.name()));
        for parameter in &self.fit.parameters {
            block.insert(parameter.name.into(), text(parameter.name, parameter.value));
        }
        let (key, value) = self.fit.law.volumetric(self.bulk.value);
        block.insert(
            key.into(),
            if key == "d1" { json!(format!("2 / {}", pressure(self.bulk.value))) } else { text(key, value) },
        );
        json!([block])
    }

    fn scenario_block(&self) -> Value {
        let names = self.fit.law.parameters();
        let of = |one: &Scenario| {
            let values = names.iter().zip(&one.parameters);
            let set: Map<String, Value> =
                values.map(|(name, value)| (format!("materials/0/{name}"), text(name, *value))).collect();
            json!({ "probability": one.probability, "set": set })
        };
        self.scenarios.iter().map(of).collect()
    }

    /// Its entry; `least` is the smallest AICc of all laws.
    pub fn json(&self, least: f64, errors: Errors) -> Value {
        let Fit { law, squares, points, scatter, criteria, starts, correlation, .. } = &self.fit;
        let parameters: Map<String, Value> =
            self.fit.parameters.iter().map(|one| (one.name.to_owned(), estimate(one))).collect();
        let stable: Map<String, Value> =
            self.stable.iter().map(|one| (one.mode.name().to_owned(), one.json())).collect();
        json!({
            "law": law.label(),
            "parameters": parameters,
            "correlation": correlation,
            "bulk": { "value": self.bulk.value, "unit": "Pa", "deviation": self.bulk.deviation, "half_width": self.bulk.half_width },
            "squares": squares,
            "points": points,
            "scatter": scatter,
            "scatter_unit": scatter_unit(errors),
            "aicc": finite(criteria.aicc),
            "bic": finite(criteria.bic),
            "aicc_above_best": finite(criteria.aicc - least),
            "starts": {
                "tried": starts.tried, "converged": starts.converged, "exhausted": starts.exhausted, "alike": starts.alike,
                "best_exhausted": starts.best_exhausted,
            },
            "poissons_ratio": self.poisson(),
            "stable": stable,
            "existence": self.existence.map(conditions),
            "materials": self.materials(),
            "scenarios": self.scenario_block(),
        })
    }
}

impl Stable {
    fn new(mode: Mode, range: Range, tests: &[Test]) -> Self {
        let own = tests.iter().filter(|test| kind(test.mode) == Some(mode)).flat_map(stretches);
        let [low, high] = own.fold([1.0, 1.0], |[low, high], l| [f64::min(low, l), f64::max(high, l)]);
        let [below, above] = range.ends.map(|end| end != End::Examined);
        Stable { mode, range, within: [below && low < range.from, above && high > range.to] }
    }

    fn json(&self) -> Value {
        let Range { from, to, ends } = self.range;
        let [below, above] = ends.map(|end| end != End::Examined);
        let [limit_below, limit_above] = ends.map(|end| end == End::Undefined);
        json!({
            "from": from, "to": to, "ends_below": below, "ends_above": above,
            "limit_below": limit_below, "limit_above": limit_above, "within_data": self.within.contains(&true),
        })
    }
}

/// The mode in which stability is examined that has the deformations of a test.
fn kind(mode: Mode) -> Option<Mode> {
    match mode {
        Mode::Uniaxial => Some(Mode::Uniaxial),
        Mode::Equibiaxial | Mode::Inflation { .. } => Some(Mode::Equibiaxial),
        Mode::Planar | Mode::SimpleShear => Some(Mode::Planar),
        Mode::Volumetric => None,
    }
}

/// Stretches of a test in the mode of its [`kind`]; simple shear is planar but for a rotation, with `l - 1/l = g`.
fn stretches(test: &Test) -> Vec<f64> {
    let of = |x: f64| match test.mode {
        Mode::Volumetric => vec![],
        Mode::SimpleShear => {
            let l = x.abs() / 2.0 + (1.0 + x * x / 4.0).sqrt();
            vec![l, 1.0 / l]
        }
        _ => vec![x],
    };
    test.points.iter().flat_map(|[x, _]| of(*x)).collect()
}

/// Of residuals, and so of their scatter.
pub(super) fn scatter_unit(errors: Errors) -> &'static str {
    match errors {
        Errors::Absolute => "Pa",
        Errors::Relative => "1",
    }
}

/// A test as it was understood.
pub(super) fn of_test(test: &Test) -> Value {
    json!({
        "name": test.name, "kind": test.mode.name(), "response": test.response.name().trim_start_matches("a "),
        "points": test.points.len(), "at_rest": test.at_rest(), "weight": test.weight,
    })
}

/// Largest stretch of all tests of shape, or the inverse of the smallest.
fn largest_stretch(tests: &[Test]) -> f64 {
    tests.iter().flat_map(stretches).fold(1.0, |most, l| most.max(l).max(1.0 / l))
}

fn estimate(one: &Estimate) -> Value {
    let interval = one.half_width.map(|h| [one.value - h, one.value + h]);
    let unit = if Law::is_pressure(one.name) { "Pa" } else { "1" };
    json!({ "value": one.value, "unit": unit, "deviation": one.deviation, "interval": interval })
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// A parameter as a case file takes it.
fn text(name: &str, value: f64) -> Value {
    if Law::is_pressure(name) { json!(pressure(value)) } else { json!(rounded(value)) }
}

/// Ten digits, which the borders of the laws bear.
fn rounded(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

fn pressure(value: f64) -> String {
    let (factor, unit) = match value.abs() {
        v if v >= 1e9 => (1e9, "GPa"),
        v if v >= 1e6 => (1e6, "MPa"),
        v if v >= 1e3 => (1e3, "kPa"),
        _ => (1.0, "Pa"),
    };
    format!("{} {unit}", rounded(value / factor))
}
