//! An evaluated point carries what its costs have computed: nothing is formed twice.

use nastic_control::{
    ControlError, Cost, CostContext, CostPoint, Figure, FigureKind, IntoCost, Partials, Reduced, SmoothedHausdorff,
    Space,
};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Options, Request};
use nastic_tensor::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// How often a cost was evaluated, and how often its partials were asked for.
#[derive(Debug, Default)]
struct Calls {
    evaluated: AtomicUsize,
    partials: AtomicUsize,
}

impl Calls {
    fn take(&self) -> (usize, usize) {
        (self.evaluated.swap(0, Ordering::Relaxed), self.partials.swap(0, Ordering::Relaxed))
    }
}

/// A cost that counts.
#[derive(Debug)]
struct Counted {
    cost: Box<dyn Cost>,
    calls: Arc<Calls>,
}

#[derive(Debug)]
struct CountedPoint {
    point: Arc<dyn CostPoint>,
    calls: Arc<Calls>,
}

impl Cost for Counted {
    fn name(&self) -> &str {
        self.cost.name()
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        self.calls.evaluated.fetch_add(1, Ordering::Relaxed);
        Ok(Arc::new(CountedPoint { point: self.cost.at(at)?, calls: self.calls.clone() }))
    }

    fn stages(&self) -> usize {
        self.cost.stages()
    }
}

impl CostPoint for CountedPoint {
    fn value(&self) -> f64 {
        self.point.value()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.calls.partials.fetch_add(1, Ordering::Relaxed);
        self.point.add_partials(out)
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        self.point.figures()
    }
}

/// A bar that shall reach a shorter one, its Hausdorff cost counted.
fn counted() -> Outcome<(Reduced, Arc<Calls>)> {
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let target = box_mesh([0.9, 0.21, 0.21], [5, 1, 1], CellKind::Hex8)?;
    let calls = Arc::new(Calls::default());
    let cost = SmoothedHausdorff::to(target).exponential(0.1).bind(&solid)?;
    let cost = Counted { cost, calls: calls.clone() };
    Ok((Reduced::new(solid).control("tension", Space::Cell)?.cost(cost)?, calls))
}

#[test]
fn a_trial_forms_the_sums_once_and_its_derivative_once() -> Outcome {
    let (problem, calls) = counted()?;
    let set = Bounds::new(-4e5, 1.9e5)?;
    let best = Lbfgs { options: Options { max_iterations: 6, ..Options::default() }, ..Lbfgs::default() }
        .within(set)
        .gradient_check(false)
        .minimize(&problem, -1e4)?;
    let (evaluated, partials) = calls.take();
    assert_eq!(evaluated, 1 + best.counts.trials, "the start and every trial, a new stage's first point among them");
    assert_eq!(partials, best.counts.derivatives);
    assert!(best.counts.iterations > 4, "{:?}", best.counts);
    // All that is asked of the accepted point is at hand.
    let figures = problem.figures_of(&best.point)?;
    problem.partials(&best.point, None)?;
    assert_eq!(calls.take(), (0, 1));
    let smoothed = figures[0].iter().find(|figure| figure.kind == FigureKind::SmoothedDistance);
    assert_eq!(smoothed.map(|figure| figure.value), Some(best.point.terms[0]));
    assert!(figures[0].iter().all(|figure| figure.unit == "m" && figure.value > 0.0));
    Ok(())
}

#[test]
fn restaging_evaluates_again_and_light_points_on_demand() -> Outcome {
    let (problem, calls) = counted()?;
    let m = vec![-1e4; problem.layout().len()];
    let mut workspace = Default::default();
    let point = problem.evaluate(&m, &Request::default(), &mut workspace)?;
    let mut fine = problem.restage(1, &point)?;
    assert_eq!(calls.take(), (2, 0));
    assert_ne!(point.terms, fine.terms);
    let derivative = problem.derivative(&mut fine, &mut workspace)?;
    assert_eq!(calls.take(), (0, 1));

    let (light, calls) = counted()?;
    let light = light.keep_factors(false);
    let mut point = light.evaluate(&m, &Request { stage: 1, ..Request::default() }, &mut workspace)?;
    for (a, b) in light.derivative(&mut point, &mut workspace)?.iter().zip(&derivative) {
        assert!((a - b).abs() < 1e-6 * b.abs(), "{a:e} {b:e}");
    }
    assert_eq!(calls.take(), (2, 1), "a point that keeps nothing evaluates its costs again");
    Ok(())
}
