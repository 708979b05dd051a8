//! One control for several bodies.

use nastic_control::{ControlNorm, Metric, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin, Turgor};
use nastic_ensemble::{Ensemble, EnsembleError, EnsemblePoint, EnsembleWorkspace, LoadCase};
use nastic_fem::{Discretization, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Objective, Optimizer, Options, Problem, ProjectedGradient, Request, Taylor, Verdict};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::{CATALOGUE, Cvar, Mean, MeanDeviation, Risk, WorstCase, by_name};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn mesh() -> Outcome<Arc<Discretization>> {
    Ok(Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [3, 1, 2], CellKind::Hex8)?))?)
}

/// A bar with a fibre; its stiffness in multiples of 100 kPa.
fn bar(disc: &Arc<Discretization>, stiffness: f64) -> Outcome<Solid> {
    Ok(Solid::on(disc.clone())
        .material("body", MooneyRivlin::new(1e5 * stiffness, 2e4 * stiffness, 5e5 * stiffness)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

fn lifted(by: f64) -> Target {
    Target::position(move |x| [0.95 * x[0], x[1], x[2] + by])
}

fn member(disc: &Arc<Discretization>, stiffness: f64) -> Outcome<Reduced> {
    Ok(Reduced::new(bar(disc, stiffness)?)
        .control("tension", Space::Cell)?
        .cost(Tracking::surface("x+", lifted(0.1)))?
        .cost(ControlNorm::of("tension", 1e-14)?)?)
}

const PROBABILITIES: [f64; 8] = [0.05, 0.2, 0.1, 0.15, 0.08, 0.22, 0.12, 0.08];

fn eight(risk: Box<dyn Risk>) -> Outcome<Ensemble> {
    let disc = mesh()?;
    let mut all = Ensemble::new(risk);
    for (i, p) in PROBABILITIES.iter().enumerate() {
        all = all.scenario(&format!("s{i}"), *p, member(&disc, 0.7 + 0.1 * i as f64)?);
    }
    Ok(all.build()?)
}

fn start(len: usize) -> Vec<f64> {
    (0..len).map(|i| -3e4 - 2e4 * ((i * 37 % 11) as f64 / 11.0)).collect()
}

fn assert_taylor(problem: &Ensemble, m: &[f64], what: &str) -> Outcome {
    let report = Taylor::default().test(problem, &Bounds::new(-4e5, 1.3e5)?, m)?;
    for direction in &report.directions {
        assert!(matches!(direction.verdict, Verdict::Right), "{what}: {report}");
        assert!(direction.order1 > 1.95, "{what}: {report}");
    }
    Ok(())
}

#[test]
fn taylor_orders_of_every_risk_measure_over_eight_scenarios() -> Outcome {
    let mut risks: Vec<Box<dyn Risk>> = CATALOGUE.iter().map(|row| (row.make)()).collect();
    risks.push(Box::new(Cvar { level: 0.6, smoothing: 0.2 }));
    for risk in risks {
        let name = risk.name();
        let problem = eight(risk)?;
        assert_taylor(&problem, &start(problem.len()), name)?;
    }
    Ok(())
}

/// The ensemble's numbers are those of its members, put together by hand.
#[test]
fn value_and_derivative_are_those_of_the_members() -> Outcome {
    let risk = MeanDeviation { lambda: 0.7 };
    let problem = eight(Box::new(risk))?;
    let m = start(problem.len());
    let mut point = problem.at(&m)?;
    let disc = mesh()?;
    let (mut costs, mut derivatives) = (vec![], vec![]);
    for i in 0..8 {
        let alone = member(&disc, 0.7 + 0.1 * i as f64)?;
        let mut at = alone.at(&m)?;
        costs.push(at.cost());
        derivatives.push(alone.derivative(&mut at, &mut Default::default())?);
    }
    assert_eq!(point.costs, costs);
    assert_eq!(problem.value(&point), risk.value(&PROBABILITIES, &costs));
    let weights = risk.weights(&PROBABILITIES, &costs);
    let derivative = problem.derivative(&mut point, &mut Default::default())?;
    for (k, d) in derivative.iter().enumerate() {
        let sum: f64 = weights.iter().zip(&derivatives).map(|(w, d)| w * d[k]).sum();
        assert!((d - sum).abs() <= 1e-12 * sum.abs().max(1e-20), "{k}: {d:e} and {sum:e}");
    }
    Ok(())
}

fn bits(problem: &Ensemble, m: &[f64], threads: usize) -> Outcome<Vec<u64>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let run = || -> Result<(EnsemblePoint, Vec<f64>), nastic_opt::Failed> {
        let mut workspace = EnsembleWorkspace::default();
        let mut first = problem.evaluate(m, &Request::default(), &mut workspace)?;
        problem.derivative(&mut first, &mut workspace)?;
        let moved: Vec<f64> = m.iter().map(|m| 1.1 * m).collect();
        let mut second = problem.evaluate(&moved, &Request::near(&first), &mut workspace)?;
        let derivative = problem.derivative(&mut second, &mut workspace)?;
        Ok((second, derivative))
    };
    let (point, derivative) = pool.install(run)?;
    let states = point.members.iter().flat_map(|part| part.state().u.iter().copied());
    Ok(states.chain(derivative).chain([point.risk]).map(f64::to_bits).collect())
}

#[test]
fn same_bits_with_one_and_two_threads() -> Outcome {
    for name in ["cvar", "mean"] {
        let problem = eight(by_name(name)?)?;
        let m = start(problem.len());
        assert_eq!(bits(&problem, &m, 1)?, bits(&problem, &m, 2)?, "{name}");
    }
    Ok(())
}

/// A member that cannot be held in equilibrium fails the trial, by name: the first in order, on any number of threads.
#[test]
fn a_failing_member_is_named() -> Outcome {
    // One element: failing takes many load steps.
    let disc = Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [1, 1, 1], CellKind::Hex8)?))?;
    // A tension far above the bound 2 mu1 of the soft ones alone; the target asks for more of it.
    let longer = Target::position(|x| [2.0 * x[0], x[1], x[2]]);
    let mut all = Ensemble::new(Mean);
    for (name, stiffness) in [("stiff", 40.0), ("soft", 0.05), ("softer", 0.02), ("firm", 30.0)] {
        let problem = Reduced::new(bar(&disc, stiffness)?)
            .control("tension", Space::Uniform)?
            .cost(Tracking::surface("x+", longer.clone()))?;
        all = all.scenario(name, 0.25, problem);
    }
    let problem = all.build()?;
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let m = vec![3e5; problem.len()];
        let failed = pool.install(|| problem.evaluate(&m, &Request::default(), &mut Default::default())).unwrap_err();
        assert!(failed.to_string().starts_with("soft: "), "{failed}");
        assert!(failed.work().get("newton").is_some_and(|newton| newton > 0.0), "{failed:?}");
        match failed.downcast_ref::<EnsembleError>() {
            Some(EnsembleError::Member { who, .. }) => assert_eq!(who, "soft"),
            other => panic!("{other:?}"),
        }
    }
    // The optimiser shortens its step and goes on.
    let options = Options { max_iterations: 3, first_move: 1.0, ..Options::default() };
    let best = ProjectedGradient { options }.within(Bounds::new(-1e5, 3e5)?).minimize(&problem, 0.0)?;
    let rest = problem.at(&vec![0.0; problem.len()])?;
    assert!(best.counts.failed > 0 && best.cost < problem.value(&rest), "{:?}", best.counts);
    Ok(())
}

/// Two load cases share a tension and have a pressure each; over two scenarios, which share those pressures.
fn nested(risk: impl Risk + 'static, metric: Metric) -> Outcome<Ensemble> {
    let disc = mesh()?;
    let case = |stiffness: f64, lift: f64| -> Outcome<Reduced> {
        let body = bar(&disc, stiffness)?.actuate("body", "pressure", Turgor::new())?;
        Ok(Reduced::new(body)
            .control("pressure", Space::Uniform)?
            .control("tension", Space::Node)?
            .cost(Tracking::surface("x+", lifted(lift)))?
            .metric(metric))
    };
    let mut all = Ensemble::new(risk);
    for (name, p, stiffness) in [("soft", 0.4, 0.8), ("stiff", 0.6, 1.3)] {
        let up = LoadCase::new("up", 2.0, case(stiffness, 0.1)?).own("pressure");
        let down = LoadCase::new("down", 1.0, case(stiffness, -0.1)?).own("pressure");
        all = all.scenario_of(name, p, vec![up, down]);
    }
    Ok(all.build()?)
}

#[test]
fn load_cases_inside_scenarios_share_and_own_controls() -> Outcome {
    let problem = nested(Cvar { level: 0.5, smoothing: 0.2 }, Metric::L2)?;
    let names: Vec<&str> = problem.blocks().iter().map(|block| block.name.as_str()).collect();
    assert_eq!(names, ["up/pressure", "tension", "down/pressure"]);
    assert_eq!(problem.members()[3].name(), "stiff/down");
    assert_eq!(problem.members()[3].blocks(), [2, 1]);
    let mut m = start(problem.len());
    m[0] = 2e4;
    m[problem.len() - 1] = -1e4;
    assert_taylor(&problem, &m, "nested")?;

    let point = problem.at(&m)?;
    assert_eq!(point.costs[1], 2.0 * point.members[2].cost() + point.members[3].cost());
    assert_eq!(point.members[1].m, problem.local(&problem.members()[1], &m)?);
    assert_eq!((point.members[1].m[0], point.members[1].m[1]), (-1e4, m[1]));
    // What only "down" uses moves only "down".
    let mut other = m.clone();
    other[problem.len() - 1] = 3e4;
    let moved = problem.at(&other)?;
    assert_eq!(point.members[0].state().u, moved.members[0].state().u);
    assert_ne!(point.members[1].state().u, moved.members[1].state().u);
    Ok(())
}

/// Each block stands once in the product: its ones measure the volume once, whichever members use it.
#[test]
fn the_inner_product_has_every_block_once() -> Outcome {
    for metric in [Metric::L2, Metric::H1 { length: 0.2 }] {
        let problem = nested(Mean, metric)?;
        let product = problem.inner_product()?;
        assert_eq!((product.len(), product.lumped().is_some()), (problem.len(), metric == Metric::L2));
        let ones = vec![1.0; problem.len()];
        assert!((product.inner(&ones, &ones) / (3.0 * 0.04) - 1.0).abs() < 1e-12);
        let m = start(problem.len());
        let back = product.riesz(&product.apply(&m));
        assert!(m.iter().zip(&back).all(|(a, b)| (a / b - 1.0).abs() < 1e-10));
        if let Some(weights) = product.lumped() {
            assert_eq!(product.apply(&ones), weights);
        }
    }
    Ok(())
}

#[test]
fn reports_every_risk_and_every_member() -> Outcome {
    let problem = eight(Box::new(WorstCase { smoothing: 0.02 }))?;
    let point = problem.at(&start(problem.len()))?;
    let report = problem.summary(&point);
    let get = |name: &str| report.get(name).unwrap_or_else(|| panic!("no entry {name} in {report:?}"));
    let worst = point.costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(get("risk/mean"), PROBABILITIES.iter().zip(&point.costs).map(|(p, j)| p * j).sum::<f64>());
    assert_eq!(get("risk/worst_case"), problem.value(&point));
    assert_eq!(get("risk/worst_case/exact"), worst);
    assert!((get("risk/mean_deviation") - get("risk/mean") - get("risk/deviation")).abs() < 1e-15);
    assert!(get("risk/cvar/exact") <= get("risk/cvar") && get("risk/cvar/exact") <= worst);
    assert_eq!(get("scenarios/s3/cost"), point.costs[3]);
    assert_eq!(get("scenarios/s3/terms/tracking"), point.members[3].terms[0]);
    assert!((get("terms/tracking") + get("terms/control_norm") - get("risk/mean")).abs() < 1e-15);
    assert_eq!(get("newton"), point.members.iter().map(|part| part.work.newton as f64).sum::<f64>());
    assert!(get("min_J") > 0.0);
    Ok(())
}

/// One factor per member is kept, whatever was evaluated and differentiated; none where none is to be kept, with the same
/// costs.
#[test]
fn at_most_one_factor_per_member_is_kept_and_reported() -> Outcome {
    let disc = mesh()?;
    let structure = bar(&disc, 1.0)?.model().tangent_structure().clone();
    let mut identity = structure.matrix();
    identity.eliminate(&vec![true; disc.dofs()], 1.0);
    let one = structure.symbolic().approximate(&identity, false)?.bytes();
    assert!(one >= 4 * disc.dofs());
    let costs = |keep: bool| -> Outcome<Vec<f64>> {
        let mut all = Ensemble::new(Mean).keep_factors(keep);
        for (i, p) in PROBABILITIES.iter().enumerate() {
            all = all.scenario(&format!("s{i}"), *p, member(&disc, 0.7 + 0.1 * i as f64)?);
        }
        let all = all.build()?;
        let m = start(all.len());
        let mut workspace = EnsembleWorkspace::default();
        let mut point = all.evaluate(&m, &Request::default(), &mut workspace)?;
        let mut refactored = 0;
        for round in 0..3 {
            all.derivative(&mut point, &mut workspace)?;
            let expected = if keep { 8 * one } else { 0 };
            assert_eq!(workspace.factor_bytes(), expected, "round {round}");
            let moved: Vec<f64> = point.m.iter().map(|m| 1.3 * m).collect();
            let trial = all.evaluate(&moved, &Request::near(&point), &mut workspace)?;
            assert_eq!(workspace.factor_bytes(), expected, "a trial adds a factor");
            refactored += trial.members.iter().map(|part| part.work.factorisations).sum::<usize>();
            point = trial;
        }
        assert!(refactored > 0, "no trial made a factor: nothing is seen");
        Ok(point.costs)
    };
    for (kept, alone) in costs(true)?.iter().zip(&costs(false)?) {
        assert!((kept / alone - 1.0).abs() < 1e-6, "{kept:e} and {alone:e}");
    }
    Ok(())
}

/// The bound of the tension is that of the softest law.
#[test]
fn bounds_take_the_smallest_over_scenarios() -> Outcome {
    let problem = eight(Box::new(Mean))?;
    assert!((problem.fiber_limit("tension")?.unwrap_or(f64::NAN) / 1.4e5 - 1.0).abs() < 1e-12);
    let error = problem.fiber_limit("tensoin").unwrap_err().to_string();
    assert!(error.contains("tensoin") && error.contains("tension"), "{error}");
    Ok(())
}

#[test]
fn warm_starts_from_the_members_own_state_and_tells_who_finished() -> Outcome {
    let disc = mesh()?;
    let message = Arc::new(AtomicUsize::new(0));
    let count = message.clone();
    let problem = Ensemble::new(Mean)
        .scenario("a", 0.5, member(&disc, 0.8)?)
        .scenario("b", 0.5, member(&disc, 1.4)?)
        .watched_by(move |finished| {
            assert!(finished.of == 2 && finished.cost.is_ok());
            count.fetch_add(1, Ordering::Relaxed);
        })
        .build()?;
    let m = start(problem.len());
    let mut workspace = EnsembleWorkspace::default();
    let cold = problem.evaluate(&m, &Request::default(), &mut workspace)?;
    let warm = problem.evaluate(&m, &Request::near(&cold), &mut workspace)?;
    assert_eq!(message.load(Ordering::Relaxed), 4);
    for (warm, cold) in warm.members.iter().zip(&cold.members) {
        assert!(warm.work.newton <= 1 && cold.work.newton > 2, "{:?}", warm.work);
    }
    Ok(())
}

#[test]
fn the_mean_shape_and_its_scatter_are_those_of_the_states() -> Outcome {
    let problem = nested(Mean, Metric::L2)?;
    let point = problem.at(&start(problem.len()))?;
    let shot = problem.mean_shape(&point, "down")?;
    let of = |name: &str| shot.point_data.iter().find(|a| a.name == name).map(|a| a.values.clone());
    let (mean, scatter, norm) = (of("displacement"), of("deviation"), of("deviation_norm"));
    let (mean, scatter, norm) = (mean.unwrap(), scatter.unwrap(), norm.unwrap());
    let (soft, stiff) = (&point.members[1].state().u, &point.members[3].state().u);
    for i in 0..mean.len() {
        assert!((mean[i] - (0.4 * soft[i] + 0.6 * stiff[i])).abs() < 1e-15);
        // Two values with probabilities p and q scatter by sqrt(pq) times their distance.
        assert!((scatter[i] - 0.24f64.sqrt() * (soft[i] - stiff[i]).abs()).abs() < 1e-13);
    }
    assert!((norm[5].powi(2) - scatter[15..18].iter().map(|s| s * s).sum::<f64>()).abs() < 1e-15);
    assert!(norm.iter().any(|n| *n > 1e-4));
    let error = problem.mean_shape(&point, "dwon").unwrap_err().to_string();
    assert!(error.contains("dwon"), "{error}");
    Ok(())
}

#[test]
fn ensembles_that_make_no_sense_are_refused() -> Outcome {
    let disc = mesh()?;
    let one = || member(&disc, 1.0);
    let refuse = |builder: nastic_ensemble::EnsembleBuilder, what: &str| match builder.build() {
        Err(error) => assert!(error.to_string().contains(what), "{error}"),
        Ok(_) => panic!("{what}"),
    };
    refuse(Ensemble::new(Mean), "empty");
    refuse(Ensemble::new(Mean).scenario_of("a", 1.0, vec![]), "empty");
    refuse(Ensemble::new(Mean).scenario("a", 0.5, one()?).scenario("a", 0.5, one()?), "\"a\" is given twice");
    refuse(Ensemble::new(Mean).scenario("a", 0.5, one()?), "sum to 0.5");
    refuse(Ensemble::new(Mean).scenario("a", f64::NAN, one()?), "a has weight NaN");
    let negative = || -> Outcome<_> { Ok([("a", 1.5, one()?), ("b", -0.5, one()?)]) };
    let add = |risk: Box<dyn Risk>, members: [(&str, f64, Reduced); 2]| {
        members.into_iter().fold(Ensemble::new(risk), |all, (name, p, problem)| all.scenario(name, p, problem))
    };
    refuse(add(Box::<Cvar>::default(), negative()?), "sparse");
    assert!(add(Box::new(Mean), negative()?).build().is_ok());
    let case = |name: &str| -> Outcome<LoadCase> { Ok(LoadCase::new(name, 1.0, one()?)) };
    refuse(Ensemble::new(Mean).load_cases(vec![case("up")?, case("up")?]), "given twice");
    refuse(Ensemble::new(Mean).load_cases(vec![case("up")?.own("tensoin")]), "tensoin");
    let nodal = Reduced::new(bar(&disc, 1.0)?).control("tension", Space::Node)?;
    refuse(Ensemble::new(Mean).scenario("a", 0.5, one()?).scenario("b", 0.5, nodal), "differ in its space");
    let nodal = || -> Outcome<_> { Ok(Reduced::new(bar(&disc, 1.0)?).control("tension", Space::Node)?) };
    let filtered = nodal()?.filter("tension", 0.2)?;
    refuse(Ensemble::new(Mean).scenario("a", 0.5, nodal()?).scenario("b", 0.5, filtered), "other maps");
    let empty = Reduced::new(Solid::on(disc.clone()));
    refuse(Ensemble::new(Mean).scenario("bare", 1.0, empty), "bare: ");

    let problem = Ensemble::new(Mean).load_cases(vec![case("up")?, case("down")?]).build()?;
    assert!(matches!(problem.at(&[0.0]), Err(EnsembleError::Length { found: 1, .. })));
    Ok(())
}
