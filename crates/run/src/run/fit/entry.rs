//! [`Fitted`]: one law, and its entry in `fit.json`.

use nastic_energy::{Existence, MaterialPoint};
use nastic_fit::{
    Bulk, Coverage, End, Entry, Errors, Estimate, Fibers, Fit, FitError, Law, Mode, Range, Scenario, Test, bulk,
    r_squared, scenarios, stable_range,
};
use nastic_language::schema::{FitData, network_json};
use nastic_report::record::{
    BulkRecord, EstimateRecord, FitStartsRecord, FittedLawRecord, SeenRecord, StableRangeRecord, TestRecord,
};
use nastic_result::describe::conditions;
use serde_json::{Map, Value, json};

/// Modes in which stability is examined.
const MODES: [Mode; 3] = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar];

/// The range of stability in one kind of test.
pub(super) struct Stable {
    pub mode: Mode,
    /// How the specimen lies to the fibres of a law that has some.
    pub fibers: Option<Fibers>,
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
    /// By test of shape.
    pub r_squared: Vec<(String, f64)>,
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
        let lies: &[Option<Fibers>] =
            if fit.law.has_fibers() { &[Some(Fibers::Along), Some(Fibers::Across)] } else { &[None] };
        let looked = lies.iter().flat_map(|fibers| MODES.map(|mode| (mode, *fibers)));
        let stable = looked.map(|(mode, fibers)| {
            let range = stable_range(&*incompressible, mode, fibers.unwrap_or_default(), reach);
            Stable::new(mode, fibers, range, tests)
        });
        let existence = law.existence(MaterialPoint { cell: 0, point: 0 });
        let shapes = tests.iter().filter(|test| test.mode != Mode::Volumetric);
        let share = |test: &Test| r_squared(&*incompressible, test).unwrap_or(f64::NAN);
        let r_squared = shapes.map(|test| (test.name.clone(), share(test))).collect();
        // those that this bulk modulus does not fit are no materials
        let scenarios = scenarios(&fit);
        let admissible = scenarios.iter().all(|one| fit.law.build(&one.parameters, bulk.value).is_ok());
        let scenarios = if admissible { scenarios } else { vec![] };
        let (stable, region) = (stable.collect(), asked.region.clone());
        Ok(Fitted { fit, bulk, shear, stable, existence, r_squared, region, scenarios })
    }

    /// Poisson's ratio at rest, `(3 K - 2 G)/(2 (3 K + G))`, where there is one.
    pub fn poisson(&self) -> Option<f64> {
        let ratio = (3.0 * self.bulk.value - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk.value + self.shear));
        self.fit.law.is_isotropic_at_rest().then_some(ratio)
    }

    /// The block to paste.
    pub fn materials(&self) -> Value {
        let mut block = Map::new();
        block.insert("region".into(), json!(self.region));
        block.insert("law".into(), json!(self.fit.law.name()));
        for (key, entry) in self.fit.law.block(&self.fit.values(), self.bulk.value).unwrap_or_default() {
            let value = if key == "d1" { json!(format!("2 / {}", pressure(self.bulk.value))) } else { text(entry) };
            block.insert(key.into(), value);
        }
        json!([block])
    }

    /// Of a network the name of its file, and what that holds.
    pub fn network_file(&self) -> Option<(String, Value)> {
        let mut file = self.fit.law.is_network().then(|| self.materials()[0]["network"].clone())?;
        file["nastic_network"] = json!(1);
        file["scale"] = json!(rounded(self.shear));
        Some((format!("fit_{}.json", self.fit.law.label()), file))
    }

    fn scenario_block(&self) -> Value {
        // of a law whose volumetric key depends on its parameters, the bulk modulus stays
        let law = self.fit.law;
        let all = |one: &Scenario| match law.has_own_volume() {
            true => law.block(&one.parameters, self.bulk.value),
            false => law.entries(&one.parameters),
        };
        let of = |one: &Scenario| {
            let entries = all(one).unwrap_or_default().into_iter();
            let set: Map<String, Value> =
                entries.map(|(name, entry)| (format!("materials/0/{name}"), text(entry))).collect();
            json!({ "probability": one.probability, "set": set })
        };
        self.scenarios.iter().map(of).collect()
    }

    /// Its entry; `least` is the smallest AICc of all laws.
    pub fn record(&self, least: f64, errors: Errors) -> FittedLawRecord {
        let Fit { law, squares, points, scatter, criteria, starts, correlation, .. } = &self.fit;
        let row = |row: &Vec<Option<f64>>| row.iter().map(|value| (*value).into()).collect();
        FittedLawRecord {
            law: law.label(),
            parameters: Some(self.fit.parameters.iter().map(|one| (one.name.to_owned(), estimate(one))).collect()),
            correlation: correlation.iter().map(row).collect(),
            bulk: BulkRecord {
                value: self.bulk.value.into(),
                unit: "Pa".to_owned(),
                deviation: self.bulk.deviation.into(),
                half_width: self.bulk.half_width.into(),
            },
            squares: (*squares).into(),
            points: *points,
            scatter: (*scatter).into(),
            scatter_unit: scatter_unit(errors).to_owned(),
            r_squared: Some(self.r_squared.iter().map(|(name, share)| (name.clone(), (*share).into())).collect()),
            aicc: criteria.aicc.into(),
            bic: criteria.bic.into(),
            aicc_above_best: (criteria.aicc - least).into(),
            starts: FitStartsRecord {
                tried: starts.tried,
                converged: starts.converged,
                exhausted: starts.exhausted,
                alike: starts.alike,
                best_exhausted: starts.best_exhausted,
            },
            poissons_ratio: self.poisson().into(),
            stable: Some(self.stable.iter().map(|one| (one.name(), one.record())).collect()),
            existence: self.existence.map(conditions).into(),
            materials: self.materials(),
            scenarios: self.scenario_block(),
        }
    }
}

impl Stable {
    fn new(mode: Mode, fibers: Option<Fibers>, range: Range, tests: &[Test]) -> Self {
        let belongs = |test: &&Test| test.mode.kind() == Some(mode) && (fibers.is_none() || test.fibers == fibers);
        let own = tests.iter().filter(belongs).flat_map(stretches);
        let [low, high] = own.fold([1.0, 1.0], |[low, high], l| [f64::min(low, l), f64::max(high, l)]);
        let [below, above] = range.ends.map(|end| end != End::Examined);
        Stable { mode, fibers, range, within: [below && low < range.from, above && high > range.to] }
    }

    /// The key of its entry: the kind of test, and `_across` where it is one across fibres.
    fn name(&self) -> String {
        let across = if self.fibers == Some(Fibers::Across) { "_across" } else { "" };
        format!("{}{across}", self.mode.name())
    }

    fn record(&self) -> StableRangeRecord {
        let Range { from, to, ends } = self.range;
        let [ends_below, ends_above] = ends.map(|end| end != End::Examined);
        let [limit_below, limit_above] = ends.map(|end| end == End::Undefined);
        StableRangeRecord {
            from: from.into(),
            to: to.into(),
            ends_below,
            ends_above,
            limit_below,
            limit_above,
            within_data: self.within.contains(&true),
        }
    }
}

/// Stretches of a test in the mode of its [`Mode::kind`]; simple shear is planar but for a rotation, with `l - 1/l = g`.
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
pub(super) fn of_test(test: &Test, held_out: bool) -> TestRecord {
    TestRecord {
        name: test.name.clone(),
        kind: test.mode.name().to_owned(),
        response: test.response.name().trim_start_matches("a ").to_owned(),
        fibers: test.fibers.map(|fibers| fibers_name(fibers).to_owned()).into(),
        points: test.points.len(),
        at_rest: test.at_rest(),
        weight: test.weight.into(),
        held_out,
    }
}

/// As data files say it.
pub(super) fn fibers_name(fibers: Fibers) -> &'static str {
    match fibers {
        Fibers::Along => "along",
        Fibers::Across => "across",
    }
}

/// Largest stretch of all tests of shape, or the inverse of the smallest.
fn largest_stretch(tests: &[Test]) -> f64 {
    tests.iter().flat_map(stretches).fold(1.0, |most, l| most.max(l).max(1.0 / l))
}

/// All names that files of networks may have.
pub(super) fn network_files() -> impl Iterator<Item = String> {
    Law::all().into_iter().filter(|law| law.is_network()).map(|law| format!("fit_{}.json", law.label()))
}

/// Which shapes tests have seen.
pub(super) fn seen(tests: &[Test]) -> SeenRecord {
    let Coverage { missing, first, second } = Coverage::of(tests);
    let missing = missing.iter().map(|kind| kind.name().to_owned()).collect();
    SeenRecord { missing, first_invariant: first.to_vec(), second_invariant: second.to_vec() }
}

fn estimate(one: &Estimate) -> EstimateRecord {
    EstimateRecord {
        value: one.value.into(),
        unit: one.unit.to_owned(),
        deviation: one.deviation.into(),
        interval: one.half_width.map(|h| [one.value - h, one.value + h]).into(),
    }
}

/// A parameter as a case file takes it.
fn text(entry: Entry) -> Value {
    match entry {
        Entry::Direction(along) => json!(along.map(rounded)),
        Entry::Network(network) => network_json(&network),
        Entry::Number { value, unit: "Pa" } => json!(pressure(value)),
        Entry::Number { value, .. } => json!(rounded(value)),
    }
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
