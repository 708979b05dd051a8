//! [`Fitted`]: one law, and its entry in `fit.json`.

use crate::schema::FitData;
use nastic_energy::{Existence, Place};
use nastic_fit::{Bulk, Estimate, Fit, FitError, Law, Mode, Range, Scenario, Test, bulk, scenarios, stable_range};
use serde_json::{Map, Value, json};

/// Modes in which stability is examined.
const MODES: [Mode; 3] = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar];

/// A law with its parameters, and all that follows from them.
pub(super) struct Fitted {
    pub fit: Fit,
    pub bulk: Bulk,
    pub stable: Vec<(Mode, Range)>,
    /// Largest stretch that was measured.
    pub measured: f64,
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
        let measured = largest_stretch(tests);
        let reach = asked.stable_to.unwrap_or(1.25 * measured);
        let stable = MODES.map(|mode| (mode, stable_range(&*incompressible, mode, reach))).to_vec();
        let existence = law.existence(Place { cell: 0, point: 0 });
        // those that this bulk modulus does not fit are no materials
        let scenarios = scenarios(&fit);
        let admissible = scenarios.iter().all(|one| fit.law.build(&one.parameters, bulk.value).is_ok());
        let scenarios = if admissible { scenarios } else { vec![] };
        Ok(Fitted { fit, bulk, stable, measured, existence, region: asked.region.clone(), scenarios })
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
    pub fn json(&self, least: f64) -> Value {
        let Fit { law, squares, points, scatter, criteria, starts, correlation, .. } = &self.fit;
        let parameters: Map<String, Value> =
            self.fit.parameters.iter().map(|one| (one.name.to_owned(), estimate(one))).collect();
        let stable: Map<String, Value> =
            self.stable.iter().map(|(mode, range)| (mode.name().to_owned(), of_range(range))).collect();
        let existence = self.existence.map(|e| {
            json!({
                "polyconvex": e.polyconvex, "resists_collapse": e.resists_collapse, "coercive": e.growth.is_coercive(),
                "growth": { "p": e.growth.p, "q": e.growth.q, "r": e.growth.r },
            })
        });
        let [tried, converged, alike] = starts;
        json!({
            "law": law.label(),
            "parameters": parameters,
            "correlation": correlation,
            "bulk": { "value": self.bulk.value, "unit": "Pa", "deviation": self.bulk.deviation, "half_width": self.bulk.half_width },
            "squares": squares,
            "points": points,
            "scatter": scatter,
            "aicc": finite(criteria.aicc),
            "bic": finite(criteria.bic),
            "aicc_above_best": finite(criteria.aicc - least),
            "starts": { "tried": tried, "converged": converged, "alike": alike },
            "stable": stable,
            "existence": existence,
            "materials": self.materials(),
            "scenarios": self.scenario_block(),
        })
    }
}

/// A test as it was understood.
pub(super) fn of_test(test: &Test) -> Value {
    json!({
        "name": test.name, "kind": test.mode.name(), "response": test.response.name().trim_start_matches("a "),
        "points": test.points.len(), "weight": test.weight,
    })
}

/// Largest stretch of all tests of shape, or the inverse of the smallest.
fn largest_stretch(tests: &[Test]) -> f64 {
    let of = |test: &Test, x: f64| match test.mode {
        Mode::Volumetric => 1.0,
        // the larger principal stretch of simple shear
        Mode::SimpleShear => x.abs() / 2.0 + (1.0 + x * x / 4.0).sqrt(),
        _ => x.max(1.0 / x),
    };
    let all = tests.iter().flat_map(|test| test.points.iter().map(move |[x, _]| of(test, *x)));
    all.fold(1.0, f64::max)
}

fn estimate(one: &Estimate) -> Value {
    let interval = one.half_width.map(|h| [one.value - h, one.value + h]);
    let unit = if Law::is_pressure(one.name) { "Pa" } else { "1" };
    json!({ "value": one.value, "unit": unit, "deviation": one.deviation, "interval": interval })
}

fn of_range(range: &Range) -> Value {
    json!({ "from": range.from, "to": range.to, "ends_below": range.ends[0], "ends_above": range.ends[1] })
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
