//! Values that controls start from: of formulas, of files, of earlier results.

use super::array::{self, Entity};
use super::context::Context;
use super::control::Lowering;
use super::{optimizer, start};
use crate::warning::INPUT;
use nastic_control::{Basis, Space};
use nastic_language::expression::{EvaluationError, Formula};
use nastic_language::schema::{ArrayFile, Cells, ControlsFile, Start, vector_at};
use nastic_language::syntax::At;
use nastic_numeric::Random;
use nastic_numeric::vector::norm;
use nastic_opt::{Admissible, Outside};

/// A start is this near to a bound by rounding alone, as a share of the values' size.
const ROUNDING: f64 = 1e-9;

impl Lowering<'_> {
    /// One value of the vector for each knot and unknown; of what a file or a seed says the same at all knots.
    pub(super) fn start(&self, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let at = self.control.at.key("start");
        let (positions, knots) = (self.block.basis.positions(), self.block.values_in_time());
        match &self.control.start {
            None => Some(self.at_rest().repeat(knots)),
            Some(Start::Scalar(formula)) => context.take(&at, self.in_time(formula)),
            Some(Start::Vector(entries)) => context.take(&at, self.vectors_in_time(entries)),
            // one that could not be read was complained about
            Some(Start::Table(_)) => None,
            Some(Start::Array(file)) => self.values_of_file(file, &at, context).map(|values| values.repeat(knots)),
            Some(Start::Controls(file)) => {
                let name = self.case_name.map_or_else(String::new, |case| format!("{case}.")) + self.control.name();
                match &file.grid {
                    None => start::of_file(file, &name, self.block.len(), &at, context),
                    Some(cells) => self.start_of_grid(file, &name, *cells, context),
                }
            }
            Some(Start::Random(seed)) => {
                let Some(norm) = self.control.length().or(self.control.longest()) else {
                    context.complain(&at, "random directions need a length: give \"norm\" or \"max_norm\"");
                    return None;
                };
                let dim = self.reduced.solid().mesh().dim();
                let count = positions.len() * knots;
                Some(start::on_sphere(&mut Random::new(*seed), norm, count, dim).concat())
            }
        }
    }

    /// What its slots hold at rest: zero of a load, of a number of the body the mean over each unknown's part of it.
    fn at_rest(&self) -> Vec<f64> {
        let target = &self.block.targets[0];
        let (own, is_design) = self.slot().map_or((0.0, false), |slot| (slot.rest(), slot.is_design()));
        if !is_design || self.block.basis.is_of_contribution() {
            return vec![own; self.block.size()];
        }
        let controls = self.reduced.solid().model().controls();
        let (stride, n) = (controls.slots(target.actuation), self.block.components);
        let of_point = |slots: &[f64]| slots[target.slot..target.slot + n].to_vec();
        let values: Vec<f64> = controls.values(target.actuation).chunks_exact(stride).flat_map(of_point).collect();
        self.means(&values, n)
    }

    /// The values of a formula at all knots and unknowns.
    pub(super) fn in_time(&self, formula: &Formula) -> Result<Vec<f64>, EvaluationError> {
        let positions = self.block.basis.positions();
        let at_instant = |t: &f64| {
            let formula = formula.at_time(*t);
            positions.iter().map(|x| formula.at(*x)).collect::<Result<Vec<_>, _>>()
        };
        let values: Result<Vec<_>, _> = self.instants().iter().map(at_instant).collect();
        values.map(|values| values.concat())
    }

    /// The same of vectors.
    pub(super) fn vectors_in_time(&self, entries: &[Formula]) -> Result<Vec<f64>, EvaluationError> {
        let positions = self.block.basis.positions();
        let at_instant = |t: &f64| {
            let entries: Vec<Formula> = entries.iter().map(|entry| entry.at_time(*t)).collect();
            positions.iter().map(|x| vector_at(&entries, *x)).collect::<Result<Vec<_>, _>>()
        };
        let values: Result<Vec<_>, _> = self.instants().iter().map(at_instant).collect();
        values.map(|values| values.concat().concat())
    }

    /// The instants of the values in time.
    fn instants(&self) -> Vec<f64> {
        self.block.knots.as_ref().map_or_else(|| vec![0.0], |knots| knots.instants())
    }

    /// The values of an earlier `controls.json` on another grid, at the nodes of this one.
    fn start_of_grid(
        &self,
        file: &ControlsFile,
        name: &str,
        Cells(cells): Cells,
        context: &mut Context<'_>,
    ) -> Option<Vec<f64>> {
        let (at, n) = (self.control.at.key("start"), self.block.components);
        if self.block.basis.grid().is_none() {
            context.complain(&at.key("grid"), "the control's own \"space\" is no grid: leave this out");
            return None;
        }
        let solid = self.reduced.solid();
        let regions =
            solid.body().actuations().get(self.block.targets[0].actuation).map(|attached| &attached.regions)?;
        let coarse = Basis::new(solid.discretization(), regions, Space::Grid(cells));
        let coarse = context.take(&at.key("grid"), coarse)?;
        let size = coarse.len() * n;
        let values = start::of_file(file, name, size * self.block.values_in_time(), &at, context)?;
        let places = || self.block.basis.positions().iter();
        let at_knot = |own: &[f64]| places().map(|x| coarse.on_grid(own, n, *x)).collect::<Vec<_>>();
        let prolonged: Option<Vec<Vec<f64>>> = values.chunks_exact(size).flat_map(at_knot).collect();
        if prolonged.is_none() {
            context.complain(&at, format!("{} has no value near some node of the present grid", file.file));
        }
        prolonged.map(|values| values.concat())
    }

    /// Entries of an array that belong to the unknowns, or its mean over each unknown's part of the body.
    pub(super) fn values_of_file(&self, file: &ArrayFile, at: &At, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let basis = &self.block.basis;
        let mesh = self.reduced.solid().mesh();
        let prefer = if basis.space() == Space::Node { Entity::Node } else { Entity::Cell };
        let array = array::read(file, at, &[self.block.components], prefer, self.case, mesh, context)?;
        let n = array.components;
        let direct = matches!((basis.space(), array.entity), (Space::Node, Entity::Node) | (Space::Cell, Entity::Cell));
        if direct {
            let of = |&entity: &u32| array.values[entity as usize * n..][..n].to_vec();
            return Some(basis.entities().iter().flat_map(of).collect());
        }
        let (disc, n) = (self.reduced.solid().discretization(), array.components);
        let at_points = match array.entity {
            Entity::Node => disc.points().interpolate(&array.values, n),
            Entity::Cell => {
                let of = |cell: u32| array.values[cell as usize * n..][..n].to_vec();
                disc.points().cells().into_iter().flat_map(of).collect()
            }
        };
        Some(self.means(&at_points, n))
    }

    /// The means of values at the points over each unknown's part of the body.
    fn means(&self, at_points: &[f64], n: usize) -> Vec<f64> {
        let (disc, basis) = (self.reduced.solid().discretization(), &self.block.basis);
        let mut sums = vec![0.0; basis.len() * n];
        let mut weights = vec![0.0; basis.len()];
        let mut range = vec![(f64::INFINITY, f64::NEG_INFINITY); basis.len() * n];
        for (q, w) in disc.points().weights().iter().enumerate() {
            for (i, shape) in basis.at_point(q) {
                weights[i] += w * shape;
                for c in 0..n {
                    let (value, range) = (at_points[q * n + c], &mut range[i * n + c]);
                    sums[i * n + c] += w * shape * value;
                    *range = (range.0.min(value), range.1.max(value));
                }
            }
        }
        // The mean of equal values is that value, without rounding.
        let mean = |(k, sum): (usize, &f64)| (sum / weights[k / n]).clamp(range[k].0, range[k].1);
        sums.iter().enumerate().map(mean).collect()
    }

    /// The start, moved onto the set if only rounding keeps it outside.
    pub(super) fn settle(
        &self,
        mut start: Vec<f64>,
        set: &dyn Admissible,
        context: &mut Context<'_>,
    ) -> Option<Vec<f64>> {
        let at = self.control.at.key("start");
        if let Some(norm) = self.control.length() {
            if let Some(k) = start.chunks(self.block.components).position(|v| v.iter().all(|x| *x == 0.0)) {
                let place = self.place(k);
                context.complain(&at, format!("the start is zero at {place}: it cannot be given the \"norm\" {norm}"));
                return None;
            }
            let differ = differ_in_length(&start, self.block.components);
            set.project(&mut start);
            let is_of_run = matches!(self.control.start, Some(Start::Controls(_)));
            if differ && is_of_run && self.block.length().is_some() && optimizer::takes_spheres(self.case) {
                let message = "the vectors of the start differ in length, as those of \"mma\" do: each is given the \"norm\" by itself, which turns the \
                               field between them, and the state is another one; go on with \"mma\"";
                context.warn(&INPUT, &at, message);
            }
            return Some(start);
        }
        let Err(outside) = set.check(&start) else { return Some(start) };
        let mut moved = start.clone();
        set.project(&mut moved);
        let size = start.iter().chain(&moved).fold(0.0f64, |most, x| most.max(x.abs()));
        let far = start.iter().zip(&moved).any(|(a, b)| (a - b).abs() > ROUNDING * size);
        if far {
            context.complain(&at, self.outside(&outside));
            return None;
        }
        Some(moved)
    }

    /// Where the k-th value or vector lies, and when.
    pub(super) fn place(&self, k: usize) -> String {
        let count = self.block.basis.len();
        let place = self.block.basis.describe(k % count);
        match self.instants().get(k / count).filter(|_| self.block.knots.is_some()) {
            Some(t) => format!("{place} at t = {t}"),
            None => place,
        }
    }

    fn outside(&self, outside: &Outside) -> String {
        let place = self.place(outside.index / self.block.components);
        let allowed = &outside.allowed;
        let start = if self.control.start.is_some() { "start" } else { "own value, where no \"start\" is given," };
        format!("the {start} {} at {place} lies outside what is allowed: {allowed}", outside.value)
    }
}

/// Whether vectors differ in length by more than rounding.
fn differ_in_length(start: &[f64], components: usize) -> bool {
    let sizes = start.chunks(components).map(norm);
    let [least, most] = sizes.fold([f64::INFINITY, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
    most > least * (1.0 + ROUNDING)
}
