//! The spectrum of the reduced Hessian at the optimum: asked for by `--spectrum`, in results, in files and in words.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::optimize::minimization::domain;
use crate::run::session::{CommandFindings, CommandInput};
use crate::run::spectrum_request::{SpectrumRefusal, SpectrumRequest};
use nastic_case::lower::CaseProblem;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::number::{count, short};
use nastic_numeric::vector::dot;
use nastic_opt::{Best, Constrained, Hessian, Objective, Spectrum, SpectrumOptions};
use nastic_report::record::{ByName, EigenvectorsRecord, Number, RangeRecord, SpectrumRecord, numbers};
use nastic_result::files::Directory;
use nastic_result::{controls, snapshot};

/// Rise of the cost, as a share of it, where nothing else is asked for.
const RISE: f64 = 0.01;
/// An eigenvalue above this share of the largest counts as a direction that matters.
const MATTERS: f64 = 1e-3;
/// Share of the curvature that the first directions are counted up to.
const MOST: f64 = 0.99;

/// What was found at an optimum.
pub(super) struct Diagnosis {
    spectrum: Spectrum,
    rise: f64,
    point: EnsemblePoint,
}

/// Refuses what is known to be impossible before anything is solved.
pub(super) fn check(input: &CommandInput) -> Result<(), RunError> {
    let Some(SpectrumRequest { count, cost_rise }) = input.options.spectrum else { return Ok(()) };
    if count == 0 {
        return Err(SpectrumRefusal::Count.into());
    }
    if let Some(rise) = cost_rise.filter(|rise| !(*rise > 0.0 && rise.is_finite())) {
        return Err(SpectrumRefusal::Rise(rise).into());
    }
    if !input.problem.ensemble.constraints().is_empty() {
        return Err(SpectrumRefusal::Constraints.into());
    }
    Ok(())
}

/// Refuses a problem without second derivatives, by one product at the start.
pub(super) fn check_products(
    input: &CommandInput,
    start: &EnsemblePoint,
    workspace: &mut EnsembleWorkspace,
) -> Result<(), RunError> {
    if input.options.spectrum.is_none() {
        return Ok(());
    }
    let along = vec![1.0; start.m.len()];
    let product = Objective::hessian_vector(&input.problem.ensemble, start, &along, Hessian::Exact, workspace);
    product.map_err(SpectrumRefusal::SecondDerivatives)?;
    Ok(())
}

/// The spectrum at an optimum, if it was asked for. What fails then is said and noted: the optimum is not lost for it.
pub(super) fn find(
    input: &CommandInput,
    console: &Console,
    findings: &mut CommandFindings,
    best: &Best<EnsemblePoint>,
) -> Result<Option<Diagnosis>, RunError> {
    let Some(request) = input.options.spectrum else { return Ok(None) };
    let domain = domain(input)?;
    console.phase("eigenpairs of the reduced Hessian");
    let (mut point, mut workspace) = (best.point.clone(), EnsembleWorkspace::default());
    let options = SpectrumOptions::leading(request.count);
    let found = findings.timed(console, "spectrum", |_| {
        Spectrum::at(&input.problem.ensemble, &best.m, &mut point, &domain, &options, &mut workspace)
    });
    console.clear();
    match found {
        Ok(spectrum) => {
            let rise = request.cost_rise.unwrap_or(RISE * best.cost.abs());
            let found = Diagnosis { spectrum, rise, point };
            findings.record.optimum.spectrum = Some(found.record(&input.problem));
            Ok(Some(found))
        }
        Err(error) => {
            console.say(format!("spectrum    failed: {error}"));
            let failed = Some(error.to_string());
            findings.record.optimum.spectrum = Some(SpectrumRecord { failed, ..SpectrumRecord::default() });
            Ok(None)
        }
    }
}

impl Diagnosis {
    fn record(&self, problem: &CaseProblem) -> SpectrumRecord {
        let Spectrum { values, residuals, free, lowest, negative, products, .. } = &self.spectrum;
        let widths = (0..values.len()).map(|k| self.spectrum.half_width(k, self.rise).into()).collect();
        SpectrumRecord {
            failed: None,
            eigenvalues: Some(numbers(values)),
            residuals: Some(numbers(residuals)),
            products: Some(*products),
            free: Some(*free),
            negative: Some(*negative),
            lowest: (*lowest).into(),
            shares: self.shares(problem),
            above: Some(self.spectrum.above(MATTERS)),
            most: Some(self.holds_most()),
            cost_rise: self.rise.into(),
            half_widths: Some(widths),
            half_width: self.ranges(problem),
        }
    }

    /// By control its share in the squared norm of every eigenvector.
    fn shares(&self, problem: &CaseProblem) -> Option<ByName<Vec<Number>>> {
        let product = problem.inner_product()?;
        let images: Vec<Vec<f64>> = self.spectrum.vectors.iter().map(|v| product.apply(v)).collect();
        let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
        let of = |v: (&Vec<f64>, &Vec<f64>), block: &nastic_ensemble::EnsembleBlock| dot(block.of(v.0), block.of(v.1));
        let own = |block| self.spectrum.vectors.iter().zip(&images).map(|v| of(v, block).into()).collect();
        Some(fields.map(|(block, field)| (field.name.clone(), own(block))).collect())
    }

    /// By control least and largest half-width over its values.
    fn ranges(&self, problem: &CaseProblem) -> Option<ByName<RangeRecord>> {
        let width = self.spectrum.pointwise_half_width(self.rise);
        let range = |own: &[f64]| own.iter().fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(*x), h.max(*x)));
        let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
        let of = |own: &[f64]| {
            let (min, max) = range(own);
            RangeRecord { min: min.into(), max: max.into(), unit: None }
        };
        let ranges = || fields.map(|(block, field)| (field.name.clone(), of(block.of(&width)))).collect();
        (!width.is_empty()).then(ranges)
    }

    /// How many of the first directions hold [`MOST`] of the sum of the positive eigenvalues found.
    fn holds_most(&self) -> usize {
        let values = self.spectrum.values.iter().map(|value| value.max(0.0));
        let most = MOST * values.clone().sum::<f64>();
        let sums = values.scan(0.0, |sum, value| Some(std::mem::replace(sum, *sum + value)));
        sums.take_while(|before| *before < most).count()
    }

    /// A few lines for people.
    pub fn say(&self, input: &CommandInput, console: &Console) {
        let Spectrum { values, residuals, free, lowest, negative, products, .. } = &self.spectrum;
        console.say(format!(
            "spectrum    {} of {free} free: the first {} hold {:.0} % of their curvature, {} are above {MATTERS} of the largest eigenvalue",
            count(values.len(), "direction"),
            self.holds_most(),
            100.0 * MOST,
            self.spectrum.above(MATTERS)
        ));
        if let Some((largest, last)) = values.first().zip(values.last()) {
            let residual = residuals.iter().fold(0.0, |most: f64, residual| most.max(*residual));
            console.say(format!(
                "            eigenvalues from {} to {}, residuals up to {}, {}",
                short(*largest),
                short(*last),
                short(residual),
                count(*products, "Hessian product")
            ));
        }
        if let Some(asked) =
            input.options.spectrum.map(|asked| asked.count).filter(|asked| values.len() < *asked.min(free))
        {
            console.say(format!("            {} of {asked} eigenpairs met the tolerance", values.len()));
        }
        if *negative > 0 {
            let (negative, lowest) = (count(*negative, "negative eigenvalue"), *lowest);
            let share = -lowest / values.first().map_or(f64::NAN, |largest| largest.abs());
            console.say(match share < MATTERS {
                true => format!(
                    "            at least {negative}, to -{} of the largest: directions that the target hardly determines; a control_norm or a smaller tolerance settles them",
                    short(share)
                ),
                false => format!(
                    "            SADDLE: at least {negative} of the second derivative, the lowest {} or less: the cost falls further along it",
                    short(lowest)
                ),
            });
        }
        let left_out = if *negative > 0 { " (not counting directions of negative curvature)" } else { "" };
        for (field, range) in &self.ranges(&input.problem).unwrap_or_default() {
            let of = |number: Number| short(number.unwrap_or(f64::NAN));
            let unit = input.problem.controls.iter().find(|own| own.name == *field);
            let unit = unit.map(|own| if own.log { "(of its logarithm)" } else { own.unit.as_str() });
            let unit = unit.filter(|unit| !unit.is_empty()).map_or_else(String::new, |unit| format!(" {unit}"));
            console.say(format!(
                "            {field} may differ by {} to {}{unit} at least until the cost rises by {}{left_out}",
                of(range.min),
                of(range.max),
                short(self.rise)
            ));
        }
    }

    /// `spectrum.json`: eigenvectors and half-width as control vectors; `spectrum.vtu`: the same as fields on the optimum. Names of the files.
    pub fn write(&self, problem: &CaseProblem, out: &Directory) -> Result<Vec<String>, RunError> {
        let width = self.spectrum.pointwise_half_width(self.rise);
        let vectors: Vec<ByName<Vec<Number>>> =
            self.spectrum.vectors.iter().map(|v| controls::by_control(problem, v)).collect();
        if vectors.is_empty() {
            return Ok(vec![]);
        }
        let half_width = controls::by_control(problem, &width);
        out.write_json("spectrum.json", &EigenvectorsRecord { eigenvectors: vectors, half_width })?;
        let mut files = vec!["spectrum.json".to_owned()];
        let numbered = self.spectrum.vectors.iter().enumerate().map(|(k, v)| (format!("eigenvector_{}", k + 1), v));
        let fields: Vec<(String, &Vec<f64>)> = numbered.chain([("half_width".to_owned(), &width)]).collect();
        for (member, at) in problem.leads().zip(&self.point.members) {
            let own: Vec<(&str, Vec<f64>)> = fields.iter().map(|(name, m)| (name.as_str(), member.local(m))).collect();
            let name = member.case_file("spectrum.vtu");
            out.write_vtu(&name, &snapshot::control_fields(member, at.state(), &own)?)?;
            files.push(name);
        }
        Ok(files)
    }
}
