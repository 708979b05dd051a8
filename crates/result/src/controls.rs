//! What became of the controls.

use nastic_case::film::voltages;
use nastic_case::lower::{Admitted, CaseMember, CaseProblem, ControlField};
use nastic_control::{Basis, ControlBlock, ControlError, Cost, CostContext, DesignMean, Space};
use nastic_energy::SlotGroup;
use nastic_ensemble::EnsembleBlock;
use nastic_numeric::vector::norm;
use nastic_report::record::{ByName, ControlRecord, ControlValues, DerivativeNorm, Number, RangeRecord, numbers};

/// Norms of a derivative.
pub fn derivative_norm(problem: &CaseProblem, derivative: &[f64]) -> DerivativeNorm {
    let metric = problem.inner_product().map(|product| product.dual_norm(derivative));
    DerivativeNorm { euclidean: norm(derivative).into(), metric: metric.into() }
}

/// What every control may start from once more, at a control vector: its values, in front of filters and projections.
pub fn control_values(problem: &CaseProblem, m: &[f64]) -> ByName<Vec<Number>> {
    let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
    let values = |block: &EnsembleBlock| numbers(&problem.control_block(block).free_values_of(block.of(m)));
    blocks.map(|(block, field)| (field.name.clone(), values(block))).collect()
}

/// The part of every control in a derivative or a change of the unknowns.
pub fn by_control(problem: &CaseProblem, v: &[f64]) -> ByName<Vec<Number>> {
    let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
    blocks.map(|(block, field)| (field.name.clone(), numbers(block.of(v)))).collect()
}

/// The values of a control that has few: of the space `uniform` a number (a vector: a list), of `region` one for each by
/// name; none in other spaces.
fn values(basis: &Basis, values: &[f64], components: usize) -> Option<ControlValues> {
    let one = |x: &f64| ControlValues::One((*x).into());
    let of = |v: &[f64]| if components == 1 { one(&v[0]) } else { ControlValues::List(v.iter().map(one).collect()) };
    let mut each = values.chunks_exact(components).map(of);
    match basis.space() {
        Space::Uniform => each.next(),
        Space::Region => {
            let named = each.enumerate().map(|(k, value)| (basis.region(k).to_owned(), value));
            Some(ControlValues::ByRegion(named.collect()))
        }
        Space::Cell | Space::Point | Space::Node | Space::Grid(_) => None,
    }
}

/// What became of every control, with the maps of a stage.
pub fn controls(problem: &CaseProblem, m: &[f64], stage: usize) -> ByName<ControlRecord> {
    let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
    fields.map(|(block, field)| (field.name.clone(), control(problem, block, field, m, stage))).collect()
}

fn control(
    problem: &CaseProblem,
    block: &EnsembleBlock,
    field: &ControlField,
    m: &[f64],
    stage: usize,
) -> ControlRecord {
    let own = &problem.member(block.owner).reduced().layout_in_stage(stage).blocks()[block.field];
    let (n, unknowns) = (own.components, block.of(m));
    let values_of = &own.values_of(unknowns)[..];
    let size = |v: &[f64]| if n == 1 { v[0] } else { norm(v) };
    let sizes: Vec<f64> = values_of.chunks_exact(n).map(size).collect();
    let (min, max) = sizes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let active = active(unknowns, n, field);
    let (lower, upper) = match field.admitted {
        Admitted::Between { lower, upper } => (lower.into(), upper.into()),
        Admitted::Norm(length) => (length.into(), length.into()),
        Admitted::MaxNorm(most) => (None.into(), most.into()),
        Admitted::Any => (None.into(), None.into()),
    };
    let variation = (!own.basis.is_of_contribution() && own.knots.is_none()).then(|| {
        let disc = problem.member(block.owner).solid().discretization();
        own.total_variation(disc, values_of)
    });
    let each = |v: &[f64]| values(&own.basis, v, n);
    let few = match &own.knots {
        None => each(values_of),
        Some(_) => {
            let all: Vec<ControlValues> = values_of.chunks_exact(own.size()).filter_map(each).collect();
            (!all.is_empty()).then_some(ControlValues::List(all))
        }
    };
    let is_design = problem.case.has_design(&own.name);
    let of_design = |of: fn(CaseMember<'_>, &str, &[f64], usize) -> Number| {
        if is_design { of(problem.member(block.owner), &own.name, m, stage) } else { Number::default() }
    };
    let volts = voltages(problem.member(block.owner), own, values_of);
    let volts = volts.map(|[low, high]| RangeRecord { min: low.into(), max: high.into(), unit: Some("V".to_owned()) });
    ControlRecord {
        voltage: volts,
        array: Some(field.array.clone()),
        slot: slot(problem.member(block.owner), own).map(str::to_owned).into(),
        space: Some(own.basis.space().name().to_owned()),
        unit: Some(field.unit.clone()),
        unknowns: Some(block.len),
        min: min.into(),
        max: max.into(),
        lower,
        upper,
        active: Some(active),
        active_share: (active as f64 / sizes.len().max(1) as f64).into(),
        total_variation: variation.map(Number::from).unwrap_or_default(),
        volume: of_design(|member, of, m, stage| measure(member, DesignMean::volume(of, 1.0), m, stage)),
        greyness: of_design(|member, of, m, stage| measure(member, DesignMean::greyness(of, 1.0), m, stage)),
        level: Number::default(),
        cut_volume: Number::default(),
        smallest_bar: None,
        smallest_gap: None,
        grid: own.basis.grid().map(|grid| grid.cells().to_vec()),
        instants: own.knots.as_ref().map(|knots| numbers(&knots.instants())),
        values: few,
        fiber_limit: Default::default(),
    }
}

/// A cost of a control alone.
fn measure(member: CaseMember<'_>, cost: Result<DesignMean, ControlError>, m: &[f64], stage: usize) -> Number {
    let (solid, layout) = (member.solid(), member.reduced().layout_at(stage));
    let (rest, m) = (solid.rest(), member.layout().at(&member.local(m), 0.0).unwrap_or_default());
    let at = CostContext { solid, layout, u: &rest.u, state: None, m: &m, stage: 0, step: None };
    cost.and_then(|cost| cost.at(&at)).map_or_else(|_| Number::default(), |point| point.value().into())
}

/// The name of the slots that a control drives; `None` for a contribution that is no field.
pub fn slot(member: CaseMember<'_>, block: &ControlBlock) -> Option<&'static str> {
    let controllable = member.solid().model().controllable();
    SlotGroup::of(controllable.get(block.targets[0].actuation)?.slots)
        .into_iter()
        .find(|group| group.first == block.targets[0].slot)
        .map(|group| group.name)
}

/// Whether negative values of a control have no meaning: of muscles and tendons.
pub fn only_pulls(member: CaseMember<'_>, block: &ControlBlock) -> bool {
    let controllable = member.solid().model().controllable();
    controllable
        .get(block.targets[0].actuation)
        .and_then(|own| own.slots.get(block.targets[0].slot))
        .is_some_and(|slot| slot.not_negative)
}

/// How many values of a control field lie on a bound; vectors count once.
pub fn active(values: &[f64], components: usize, field: &ControlField) -> usize {
    if field.bounds.is_some() {
        let is_active =
            |(i, v): (usize, &[f64])| v.iter().enumerate().any(|(c, x)| is_active(components * i + c, *x, field));
        return values.chunks_exact(components).enumerate().filter(|at| is_active(*at)).count();
    }
    let size = |v: &[f64]| if components == 1 { v[0] } else { norm(v) };
    let sizes = values.chunks_exact(components).map(size).enumerate();
    sizes.filter(|(i, x)| is_active(*i, *x, field)).count()
}

/// Whether a value lies on a bound; on a sphere every vector does, which says nothing.
fn is_active(unknown: usize, value: f64, field: &ControlField) -> bool {
    match (&field.bounds, field.admitted) {
        (Some(bounds), _) => {
            let (lower, upper) = bounds.at(unknown);
            value <= lower || value >= upper
        }
        (None, Admitted::MaxNorm(most)) => value >= most * (1.0 - 1e-12),
        (None, _) => false,
    }
}
