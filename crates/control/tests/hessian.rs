//! Products with the second derivative: Taylor remainders of third order and symmetry, for every cost and every actuation.

use nastic_control::{
    COSTS, ControlError, ControlNorm, Cost, CostContext, CostExample, CostPoint, Evaluated, Partials, Reduced,
    ReducedWorkspace, Space, Target, Tracking,
};
use nastic_energy::catalogue::{actuations, materials};
use nastic_energy::{FiberTension, MooneyRivlin, Turgor};
use nastic_ensemble::{Ensemble, EnsembleError, LoadCase};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Hessian, Objective, Request, Taylor, Verdict};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::{CATALOGUE as RISKS, Mean};
use std::sync::Arc;

const EXACT: Hessian = Hessian::Exact;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Repeatable numbers within -1 and 1.
fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| ((i as f64 + seed) * 12.9898).sin()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn bar(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 1], kind)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .clamp("x-")?)
}

/// A bar with every actuation of the catalogue in turn, all its slots controlled, and controls to stand at.
fn bodies() -> Outcome<Vec<(String, Reduced, Vec<f64>)>> {
    let mut all = Vec::new();
    // modes of a shape are those of one mesh: shape.rs
    for row in actuations().iter().filter(|row| row.name != "shape") {
        for inputs in row.examples() {
            let solid = bar(CellKind::Hex8)?.actuate("body", "drive", row.build(&inputs)?)?;
            let names = nastic_control::Layout::names(&solid);
            let mut problem = Reduced::new(solid);
            for name in &names {
                problem = problem.control(name, Space::Cell)?;
            }
            let cells = problem.layout().blocks()[0].basis.len();
            let of_slot = |(k, size): (usize, &f64)| {
                let size = if *size == 0.0 { 0.01 } else { 0.2 * size };
                noise(cells, 3.0 * k as f64).into_iter().map(move |r| size * (1.0 + 0.5 * r)).collect::<Vec<_>>()
            };
            let slots: Vec<Vec<f64>> = row.example.controls.iter().enumerate().map(of_slot).collect();
            // three components of a vector stand together
            let of_block =
                |slots: &[Vec<f64>]| -> Vec<f64> { (0..cells).flat_map(|c| slots.iter().map(move |s| s[c])).collect() };
            let groups = problem.layout().blocks().iter().scan(0, |first, block| {
                *first += block.components;
                Some(of_block(&slots[*first - block.components..*first]))
            });
            let m = groups.flatten().collect();
            all.push((format!("{} {inputs:?}", row.name), problem, m));
        }
    }
    Ok(all)
}

/// The set of controls near those.
fn around(m: &[f64]) -> Outcome<Bounds> {
    let size = m.iter().map(|m| m.abs()).collect::<Vec<_>>();
    let shifted = |sign: f64| m.iter().zip(&size).map(|(m, s)| m + 2.0 * sign * s).collect::<Vec<_>>();
    Ok(Bounds::new(shifted(-1.0), shifted(1.0))?)
}

/// Remainders of order above 2.95 are seen along one of two directions at least, and none of a lower one.
fn assert_third_order(problem: &impl Objective, m: &[f64], stage: usize, what: &str) -> Outcome {
    let taylor = Taylor { stage, directions: 2, second: true, ..Taylor::default() };
    let report = taylor.test(problem, &around(m)?, m)?;
    let seconds: Vec<_> = report.directions.iter().filter_map(|direction| direction.second.as_ref()).collect();
    let orders = || seconds.iter().filter(|second| second.verdict == Verdict::Right).map(|second| second.order);
    let verdict = report.second_verdict();
    let right =
        verdict == Some(Verdict::Quadratic) || verdict == Some(Verdict::Right) && orders().any(|order| order > 2.95);
    assert!(report.passed() && right, "{what}, stage {stage}: {report}, {seconds:?}");
    Ok(())
}

/// `|a . H b - b . H a|` against `|a . H b|`, with the adjoint at hand and without.
fn assert_symmetric<O: Objective>(problem: &O, m: &[f64], stage: usize, what: &str) -> Outcome {
    let mut workspace = O::Workspace::default();
    let mut point = problem.evaluate(m, &Request { accuracy: 1e-12, stage, ..Request::default() }, &mut workspace)?;
    problem.derivative(&mut point, &mut workspace)?;
    let scaled = |seed: f64| noise(m.len(), seed).iter().zip(m).map(|(r, m)| r * m).collect::<Vec<f64>>();
    let (a, b) = (scaled(0.4), scaled(7.7));
    let (of_a, of_b) = (
        problem.hessian_vector(&point, &a, EXACT, &mut workspace)?,
        problem.hessian_vector(&point, &b, EXACT, &mut workspace)?,
    );
    let (left, right) = (dot(&b, &of_a), dot(&a, &of_b));
    let size = (dot(&a, &of_a).abs() * dot(&b, &of_b).abs()).sqrt().max(left.abs());
    assert!((left - right).abs() <= 1e-10 * size, "{what}, stage {stage}: {left:e} and {right:e} of {size:e}");
    Ok(())
}

#[test]
fn every_cost_with_every_actuation() -> Outcome {
    for k in 0..bodies()?.len() {
        // what holds a bar at one end balances its loads: no actuation within it changes their sum (reactions_in_motion.rs and costs.rs have others)
        // a displacement is nearly linear in small controls (crates/run/tests/designs.rs has its second derivatives)
        let others = ["reaction", "displacement"];
        for row in COSTS.iter().filter(|row| row.second && !others.contains(&row.name)) {
            for example in 0.. {
                let (actuation, body, m) = bodies()?.swap_remove(k);
                if row.name == "pump_work" && body.solid().body().grows() {
                    break; // refused: it does not count the work of growth
                }
                if ["design_volume", "greyness", "prior"].contains(&row.name)
                    && body.layout().blocks()[0].components > 1
                {
                    break; // of scalars
                }
                let control = body.layout().blocks()[0].name.clone();
                let on = CostExample { solid: body.solid(), control: &control, weight: 1.0 };
                let Some(cost) = (row.examples)(&on)?.into_iter().nth(example) else { break };
                let problem = body.cost(cost)?;
                let what = format!("{} {example} of {actuation}", row.name);
                for stage in 0..problem.stages() {
                    assert_third_order(&problem, &m, stage, &what)?;
                    assert_symmetric(&problem, &m, stage, &what)?;
                }
            }
        }
    }
    Ok(())
}

fn lifted() -> Target {
    Target::position(|x| [0.95 * x[0], x[1] + 0.02 * x[0], x[2] + 0.1 * x[0] * x[0]])
}

/// Two terms, on every passive law and two kinds of cells: hexahedra of 27 nodes are solved by products.
#[test]
fn every_law_with_a_sum_of_costs() -> Outcome {
    for row in materials() {
        for kind in [CellKind::Tet10, CellKind::Hex27] {
            let law = row.build(&row.examples()[0])?;
            let mut solid = Solid::new(box_mesh([1.0, 0.3, 0.3], [2, 1, 1], kind)?)?.material("body", law)?;
            if row.reinforcing {
                solid = solid.material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?;
            }
            let solid = solid
                .actuate("body", "turgor", Turgor::new())?
                .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
                .clamp("x-")?
                .traction("x+", Vec3::new(0.0, 5e2, 1e3))?;
            let problem = Reduced::new(solid)
                .control("tension", Space::Node)?
                .control("turgor", Space::Uniform)?
                .cost(Tracking::surface("x+", lifted()))?
                .cost(ControlNorm::of("tension", 1e-12)?)?;
            let mut m: Vec<f64> = noise(problem.layout().len(), 0.9).iter().map(|r| -2e4 - 1e4 * r).collect();
            *m.last_mut().ok_or("no controls")? = 8e3;
            assert_third_order(&problem, &m, 0, &format!("{} on {kind}", row.name))?;
            assert_symmetric(&problem, &m, 0, &format!("{} on {kind}", row.name))?;
            // the second derivative of a sum is the sum of those of its terms, and needs no factor that is kept
            let point = problem.at(&m)?;
            let v = noise(m.len(), 5.0);
            let mut workspace = ReducedWorkspace::default();
            let whole = problem.hessian_vector(&point, &v, &mut workspace)?;
            let terms = (0..2).map(|term| problem.hessian_vector_of_term(&point, term, &v, &mut workspace));
            let terms = terms.collect::<Result<Vec<_>, _>>()?;
            let again = problem.keep_factors(false);
            let again = again.hessian_vector(&again.at(&m)?, &v, &mut ReducedWorkspace::default())?;
            let largest = whole.iter().fold(0.0f64, |most, h| most.max(h.abs()));
            for i in 0..m.len() {
                assert!((whole[i] - terms[0][i] - terms[1][i]).abs() < 1e-8 * largest);
                assert!((whole[i] - again[i]).abs() < 1e-7 * largest);
            }
        }
    }
    Ok(())
}

/// A pressure or an added volume and fibres act together: mixed derivatives by both.
#[test]
fn a_cavity_with_fibres() -> Outcome {
    for (name, value) in [("cavity", 2e4), ("cavity of a volume", 0.15)] {
        cavity_with_fibres(name, value).map_err(|error| format!("{name}: {error}"))?;
    }
    Ok(())
}

fn cavity_with_fibres(name: &str, value: f64) -> Outcome {
    let solid = (nastic_fem::catalogue::CATALOGUE.iter().find(|row| row.name == name))
        .map(|row| (row.example)())
        .ok_or("no cavity in the catalogue")??;
    let wider = Target::position(|x| [1.1 * x[0] + 0.1, x[1], x[2] + 0.1]);
    let problem = Reduced::new(solid)
        .control(name, Space::Uniform)?
        .control("fibre", Space::Cell)?
        .cost(Tracking::surface("x+", wider))?;
    let mut m: Vec<f64> = noise(problem.layout().len(), 0.2).iter().map(|r| -3e4 - 1e4 * r).collect();
    m[0] = value;
    assert_third_order(&problem, &m, 0, name)?;
    assert_symmetric(&problem, &m, 0, name)
}

fn scenario(mu: f64, lift: f64) -> Outcome<Reduced> {
    let target = Target::position(move |x| [x[0], x[1], x[2] + lift * x[0] * x[0]]);
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(mu, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::new(0.8, 0.0, 0.6))?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?;
    Ok(Reduced::new(solid)
        .control("tension", Space::Cell)?
        .control("turgor", Space::Uniform)?
        .cost(Tracking::surface("x+", target))?
        .cost(ControlNorm::of("tension", 1e-12)?)?)
}

/// Members with load cases of their own controls, judged by every measure of risk.
#[test]
fn every_risk_over_scenarios_and_load_cases() -> Outcome {
    for row in RISKS {
        let mut ensemble = Ensemble::new((row.make)());
        for (name, p, mu) in [("soft", 0.3, 0.7e5), ("stiff", 0.5, 1.4e5), ("middle", 0.2, 1e5)] {
            let case = |case: &str, weight: f64, lift: f64| -> Outcome<LoadCase> {
                Ok(LoadCase::new(case, weight, scenario(mu, lift)?).own("turgor"))
            };
            ensemble = ensemble.scenario_of(name, p, vec![case("up", 1.0, 0.15)?, case("down", 0.6, -0.1)?]);
        }
        let ensemble = ensemble.build()?;
        let m: Vec<f64> = noise(ensemble.len(), 0.6).iter().map(|r| -2e4 - 1e4 * r).collect();
        assert_third_order(&ensemble, &m, 0, row.name)?;
        assert_symmetric(&ensemble, &m, 0, row.name)?;

        let product = |threads: usize| -> Result<Vec<f64>, EnsembleError> {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                unreachable!("no threads")
            };
            pool.install(|| ensemble.hessian_vector(&ensemble.at(&m)?, &noise(m.len(), 1.0), &mut Default::default()))
        };
        assert_eq!(product(1)?, product(3)?, "{}: the bits depend on the number of threads", row.name);

        let point = ensemble.at(&m)?;
        let (v, workspace) = (noise(m.len(), 2.0), &mut Default::default());
        if row.name == "mean" {
            let whole = ensemble.hessian_vector(&point, &v, workspace)?;
            let terms =
                ["tracking", "control_norm"].map(|term| ensemble.hessian_vector_of_term(&point, term, &v, workspace));
            let [tracking, norm] = terms.map(|term| term.map_err(|error| error.to_string()));
            let (tracking, norm) = (tracking?, norm?);
            let largest = whole.iter().fold(0.0f64, |most, h| most.max(h.abs()));
            assert!((0..m.len()).all(|i| (whole[i] - tracking[i] - norm[i]).abs() < 1e-8 * largest));
        }
    }
    Ok(())
}

/// A cost of a user without second derivatives says so by its type, through the ensemble too.
#[test]
fn costs_without_second_derivatives_refuse() -> Outcome {
    #[derive(Debug)]
    struct Lift;
    #[derive(Debug)]
    struct LiftPoint(f64);
    impl Cost for Lift {
        fn name(&self) -> &str {
            "lift"
        }
        fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
            Ok(Arc::new(LiftPoint(at.u[2])))
        }
    }
    impl CostPoint for LiftPoint {
        fn value(&self) -> f64 {
            self.0
        }
        fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
            out.u[2] += 1.0;
            Ok(())
        }
    }
    let problem = || -> Outcome<Reduced> { Ok(scenario(1e5, 0.1)?.cost(Lift)?) };
    let reduced = problem()?;
    let m = vec![1e4; reduced.layout().len()];
    let point: Evaluated = reduced.at(&m)?;
    let refused = reduced.hessian_vector(&point, &m, &mut ReducedWorkspace::default());
    let Err(ControlError::NoSecondPartials { cost }) = refused else { return Err("not refused".into()) };
    assert_eq!(cost, "\"lift\"");
    let short = reduced.hessian_vector(&point, &m[1..], &mut ReducedWorkspace::default());
    assert!(matches!(short, Err(ControlError::Length { .. })), "{short:?}");

    let ensemble = Ensemble::new(Mean).scenario("one", 1.0, problem()?).build()?;
    let mut workspace = Default::default();
    let failed = Objective::hessian_vector(&ensemble, &ensemble.at(&m)?, &m, EXACT, &mut workspace)
        .err()
        .ok_or("not refused")?;
    let typed = failed.downcast_ref::<EnsembleError>();
    assert!(matches!(typed, Some(EnsembleError::Member { who, .. }) if who == "one"), "{failed}");
    assert!(failed.to_string().contains("in the library: `CostPoint::add_second_partials`"), "{failed}");
    Ok(())
}
