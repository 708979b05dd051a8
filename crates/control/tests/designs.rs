//! Numbers of the body as unknowns: parameters of laws, design fields with several consumers, controls over points of a contribution.

use nastic_control::{
    Consumer, ControlError, ControlMap, Direction, PowerLaw, PumpWork, Reduced, ReducedWorkspace, Space, Staged,
    Target, Tracking,
};
use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::formula::{Expression, Invariant, Step};
use nastic_energy::{
    EnergyTerm, FiberTension, Field, FormulaLaw, Magnet, MooneyRivlin, NeoHooke, Parametrised, Shared, Slot, Turgor,
};
use nastic_fem::{
    Cavity, Contribution, ContributionPoint, ControlPoint, Controls, Demand, Inadmissible, Increment, Instant, Need,
    SecondDerivativeError, SecondSensitivities, Sensitivities, Solid, SolveOptions, Sums,
};
use nastic_linear::SparseMatrix;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_opt::{Bounds, Objective, Taylor, Verdict};
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar whose cells are in the region `root` or `arm`, and all in `body`.
pub fn mesh() -> Outcome<Mesh> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?;
    let mut raw = RawMesh::new("bar");
    raw.points = mesh.points().to_vec();
    for cell in mesh.blocks().iter().flat_map(|block| block.iter()) {
        let left = cell.iter().all(|&node| mesh.points()[node as usize][0] < 0.5 + 1e-9);
        raw.push(CellKind::Hex8, cell, &[if left { 1 } else { 2 }, 3]);
    }
    for (tag, name) in [(1, "root"), (2, "arm"), (3, "body")] {
        raw.name_group(3, tag, name);
    }
    for (tag, (name, facets)) in (1..).zip(mesh.surfaces()) {
        raw.name_group(2, tag, name);
        for &facet in facets {
            let (kind, nodes) = mesh.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}

/// A target that no parameters reach: residuals stay, and with them second derivatives.
pub fn target() -> Tracking {
    Tracking::surface("x+", Target::position(|x| [0.93 * x[0], x[1] + 0.05, x[2] + 0.02 * x[0]]))
}

pub fn weight(body: Solid) -> Outcome<Solid> {
    Ok(body.clamp("x-")?.body_force("body", Vec3::new(0.0, 0.0, -2e4))?)
}

pub fn assert_orders(problem: &Reduced, m: &[f64], what: &str) -> Outcome {
    let at = |factor: f64| m.iter().map(|m| factor * m).collect::<Vec<_>>();
    assert_orders_within(problem, &Bounds::new(at(0.5), at(2.0))?, m, what)
}

/// First remainders of an order above 1.95, second ones of one above 2.95 (or of none: quadratic).
pub fn assert_orders_within(problem: &Reduced, bounds: &Bounds, m: &[f64], what: &str) -> Outcome {
    let taylor = Taylor { directions: 2, second: true, ..Taylor::default() };
    let report = taylor.test(problem, bounds, m)?;
    assert!(report.passed(), "{what}: {report}");
    for direction in &report.directions {
        let second = direction.second.as_ref().ok_or("no second derivative")?;
        let quadratic = second.verdict == Verdict::Quadratic;
        assert!(direction.order1 > 1.95 && (quadratic || second.order > 2.95), "{what}: {direction:?}");
    }
    Ok(())
}

fn repeated(values: &[f64], len: usize) -> Vec<f64> {
    (0..len).map(|i| values[i % values.len()] * (1.0 + 0.1 * (i as f64).sin())).collect()
}

#[test]
fn parameters_of_laws_are_unknowns_for_the_whole_by_region_and_by_cell() -> Outcome {
    let laws: [(&str, Arc<dyn EnergyTerm>, &[f64]); 2] = [
        ("neo_hooke", Arc::new(Parametrised::new(NeoHooke::new(1e5, 4e5)?)), &[1e5, 4e5]),
        ("mooney_rivlin", Arc::new(Parametrised::new(MooneyRivlin::new(5e4, 2e4, 3e5)?)), &[5e4, 2e4, 3e5]),
    ];
    for (name, law, own) in laws {
        for (space, expected) in [(Space::Uniform, 1), (Space::Region, 2), (Space::Cell, 4)] {
            let body = Solid::new(mesh()?)?.actuate(["root", "arm"], "law", law.clone())?;
            let mut problem = Reduced::new(weight(body)?).cost(target())?;
            let slots = nastic_control::Layout::names(problem.solid());
            for slot in &slots {
                problem = problem.control(slot, space)?;
            }
            let len = problem.layout().len() / slots.len();
            assert_eq!(len, expected);
            let m: Vec<f64> = own.iter().flat_map(|value| repeated(&[*value], len)).collect();
            assert_orders(&problem, &m, &format!("{name} {}", space.name()))?;
        }
    }
    Ok(())
}

/// A cube of 27 cells without the middle one, whose surface is `inner`; the first layer along x is `root`, the rest `arm`.
pub fn hollow() -> Outcome<Mesh> {
    let mesh = box_mesh([1.0; 3], [3, 3, 3], CellKind::Hex8)?;
    let mut raw = RawMesh::new("hollow");
    raw.points = mesh.points().to_vec();
    for cell in mesh.blocks().iter().flat_map(|block| block.iter()) {
        let center = |k: usize| cell.iter().map(|&node| mesh.points()[node as usize][k]).sum::<f64>() / 8.0;
        if (0..3).all(|k| (center(k) - 0.5).abs() < 0.1) {
            for face in [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] {
                raw.push(CellKind::Quad4, &face.map(|k: usize| cell[k]), &[1]);
            }
        } else {
            raw.push(CellKind::Hex8, cell, &[if center(0) < 0.4 { 1 } else { 2 }, 3]);
        }
    }
    for (dim, tag, name) in [(3, 1, "root"), (3, 2, "arm"), (3, 3, "body"), (2, 1, "inner"), (2, 2, "x-"), (2, 3, "x+")]
    {
        raw.name_group(dim, tag, name);
    }
    for (tag, name) in [(2, "x-"), (3, "x+")] {
        for &facet in &mesh.surfaces()[name] {
            let (kind, nodes) = mesh.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}

/// By region with its logarithm, and for the whole as it is, beside a fibre tension by cell and a chamber.
#[test]
fn numbers_that_a_law_is_written_with_are_unknowns_beside_a_tension_and_a_chamber() -> Outcome {
    let inputs = Inputs::new().number("young", 3e5).number("poisson", 0.3);
    let law = material("neo_hooke")?.parametrised(&inputs, &["young", "poisson"])?;
    let body = Solid::new(hollow()?)?
        .actuate(["root", "arm"], "rubber", law)?
        .actuate("body", "fiber", FiberTension::along(Vec3::x())?)?
        .cavity(Cavity::new("air", "inner"))?;
    let aim = Tracking::surface("x+", Target::position(|x| [1.06 * x[0], x[1] + 0.05, x[2] + 0.02 * x[1]]));
    let problem = Reduced::new(body.clamp("x-")?.body_force("body", Vec3::new(0.0, 0.0, -2e4))?)
        .control("rubber.young", Space::Region)?
        .by_logarithm("rubber.young")?
        .control("rubber.poisson", Space::Uniform)?
        .control("fiber", Space::Cell)?
        .control("air", Space::Uniform)?
        .cost(aim)?;
    let cells = problem.layout().block("fiber")?.len();
    let mut m = vec![(2.4e5_f64).ln(), (3.3e5_f64).ln(), 0.33];
    m.extend((0..cells).map(|k| -2e4 * (1.0 + 0.3 * (k as f64).sin())));
    m.push(8e3);
    let range = |m: f64| if m.abs() < 20.0 { 0.1 } else { 0.3 * m.abs() };
    let at = |side: f64| m.iter().map(|m| m + side * range(*m)).collect::<Vec<_>>();
    let bounds = Bounds::new(at(-1.0), at(1.0))?;
    assert_orders_within(&problem, &bounds, &m, "young by region, poisson, tension, pressure")?;
    let slots = problem.layout().to_points(&m)?;
    // regions in the order of their names: arm, root
    let young: Vec<f64> = slots.values(0).chunks_exact(2).map(|at| at[0]).collect();
    assert!((young[0] / 3.3e5 - 1.0).abs() < 1e-13 && (young[young.len() - 1] / 2.4e5 - 1.0).abs() < 1e-13);
    assert_eq!(problem.layout().block("rubber.young")?.values_of(&m[..1]), vec![young[young.len() - 1]]);
    let refused = Reduced::new(problem.solid().clone()).control("rubber.young", Space::Region)?.by_logarithm("rubber");
    assert!(matches!(refused, Err(ControlError::UnknownControl { .. })));
    Ok(())
}

/// What is held of a logarithm is the value; costs and maps that do not fit a number of the body are refused.
#[test]
fn a_modulus_by_its_logarithm_is_held_at_a_modulus() -> Outcome {
    let solid =
        Solid::new(mesh()?)?.actuate("body", "law", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?.clamp("x-")?;
    let plain = || Reduced::new(solid.clone()).control("law.mu", Space::Cell);
    let held = plain()?.by_logarithm("law.mu")?.hold("law.mu", "arm", 2e5)?;
    let values = held.layout().block("law.mu")?.values_of(&[3e5_f64.ln(); 4]);
    let expected = [3e5, 3e5, 2e5, 2e5];
    assert!(values.iter().zip(expected).all(|(value, expected)| (value / expected - 1.0).abs() < 1e-12), "{values:?}");
    let refused = plain()?.by_logarithm("law.mu")?.hold("law.mu", "arm", 0.0).unwrap_err().to_string();
    assert!(refused.contains("it is positive"), "{refused}");
    let work = plain()?.cost(PumpWork::new(1.0)?)?.at(&[1e5; 4]).err().ok_or("work of another body")?.to_string();
    assert!(work.contains("\"law.mu\" changes it"), "{work}");
    let softer = PowerLaw { low: 1e4, high: 1e5, exponent: 1.0 };
    let staged = Consumer::of("law.mu").through(Staged::new(vec![Arc::new(softer)], softer));
    let refused = Reduced::new(solid.clone()).design("rho", Space::Cell, &[staged]).unwrap_err().to_string();
    assert!(refused.contains("changes from stage to stage"), "{refused}");
    Ok(())
}

/// `c (exp(a (J^(-2/3) I1 - 3)) - 1) + k/2 (J - 1)^2`
fn fung() -> Expression {
    use Step::{Add, Exp, Multiply, Number, Power, Subtract};
    let (first, jacobian) = (Step::Invariant(Invariant::First), Step::Invariant(Invariant::Jacobian));
    let named = |name: &'static str| Step::Parameter(name.into());
    let strain = [jacobian.clone(), Number(-2.0 / 3.0), Power, first, Multiply, Number(3.0), Subtract];
    let mut steps = vec![named("c"), named("a")];
    steps.extend(strain);
    steps.extend([Multiply, Exp, Number(1.0), Subtract, Multiply]);
    steps.extend([
        named("k"),
        Number(0.5),
        Multiply,
        jacobian,
        Number(1.0),
        Subtract,
        Number(2.0),
        Power,
        Multiply,
        Add,
    ]);
    Expression::new("fung", steps)
}

/// Weights that are the same everywhere, on which the energy does not depend linearly: in global scope they take one number each, and all derivatives are those
/// of uniform fields.
#[test]
fn slots_of_global_scope_are_the_uniform_fields_of_those_at_points() -> Outcome {
    let numbers: BTreeMap<String, Field<f64>> =
        [("a", 0.7), ("c", 4e4), ("k", 3e5)].map(|(name, value)| (name.to_owned(), Field::Uniform(value))).into();
    let law = FormulaLaw::new(&fung(), &numbers, None)?.parametrised()?;
    let names = ["net.a", "net.c", "net.k"];
    let (m, mut found) = ([0.8, 5e4, 2.5e5], Vec::new());
    let laws: [Arc<dyn EnergyTerm>; 2] = [Arc::new(law.clone()), Arc::new(Shared::new(law)?)];
    for law in laws {
        let body = Solid::new(mesh()?)?.actuate("body", "net", law)?;
        let body = body.actuate("body", "fiber", FiberTension::along(Vec3::x())?)?;
        let mut problem = Reduced::new(weight(body)?).cost(target())?;
        for name in names {
            problem = problem.control(name, Space::Uniform)?;
        }
        problem = problem.control("fiber", Space::Region)?;
        let all: Vec<f64> = m.into_iter().chain([-1e4, -2e4]).collect();
        let range = |side: f64| all.iter().map(|m| m + side * 0.3 * m.abs()).collect::<Vec<_>>();
        assert_orders_within(&problem, &Bounds::new(range(-1.0), range(1.0))?, &all, "global scope")?;
        let mut point = problem.at(&all)?;
        let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
        found.push((point.terms[0], derivative, problem.solid().controls().values(0).len()));
    }
    let ((cost, derivative, points), (same, own, one)) = (&found[0], &found[1]);
    assert_eq!((*one, *points), (3, 3 * 32));
    assert!((cost / same - 1.0).abs() < 1e-12, "{cost} {same}");
    for (a, b) in derivative.iter().zip(own) {
        assert!((a - b).abs() <= 1e-9 * a.abs(), "{derivative:?} {own:?}");
    }
    let refused = Reduced::new(weight(Solid::new(mesh()?)?.actuate("body", "net", Shared::new(Turgor::new())?)?)?);
    assert!(refused.control("net", Space::Cell).is_err());
    Ok(())
}

/// With its own moduli a law with slots has the equilibrium of the law, in as many load steps: moduli do not ramp.
#[test]
fn designs_hold_from_the_first_load_step_on() -> Outcome {
    let law = NeoHooke::new(1e5, 4e5)?;
    let plain = weight(Solid::new(mesh()?)?.material("body", law.clone())?)?;
    let with_slots = weight(Solid::new(mesh()?)?.actuate("body", "law", Parametrised::new(law))?)?;
    let how = SolveOptions::default();
    let expected = plain.solve(&plain.controls(), &how)?;
    let at_rest = with_slots.solve(&with_slots.controls(), &how)?;
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference(&expected.u, &at_rest.u) < 1e-12);
    assert_eq!(at_rest.report.load_steps, expected.report.load_steps);
    // Others: those of the law with them, and what a state begins with has them at once.
    let softer = weight(Solid::new(mesh()?)?.material("body", NeoHooke::new(7e4, 2e5)?)?)?;
    let expected = softer.solve(&softer.controls(), &how)?;
    let mut controls = with_slots.controls();
    controls.values_mut(0).chunks_exact_mut(2).for_each(|at| at.copy_from_slice(&[7e4, 2e5]));
    let found = with_slots.solve(&controls, &how)?;
    assert!(difference(&expected.u, &found.u) < 1e-12);
    assert_eq!((found.report.load_steps, found.report.newton), (expected.report.load_steps, expected.report.newton));
    let rest = with_slots.model().rest_under(&controls);
    assert_eq!((rest.controls.values(0), rest.load), (controls.values(0), 0.0));
    assert_eq!(with_slots.model().unactuated(&controls), controls);
    // A ramp has the designs of its end throughout.
    let ends = (&with_slots.controls(), &controls);
    let ramp = with_slots.model().stability().ramp(
        ends.0,
        ends.1,
        3,
        &how,
        &mut nastic_fem::Workspace::default(),
        &mut |_| (),
    )?;
    assert!(ramp.points.iter().all(|point| *point.state.controls == controls));
    Ok(())
}

/// One field that multiplies a modulus by a power law and drives an actuation; and one that gives the moduli of two laws on two regions.
#[test]
fn a_design_field_serves_several_consumers() -> Outcome {
    let body = Solid::new(mesh()?)?
        .actuate("body", "law", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?
        .actuate("body", "fiber", FiberTension::along(Vec3::x())?)?
        .actuate("arm", "magnet", Magnet::new())?;
    let consumers = [
        Consumer::of("law.mu").through(PowerLaw { low: 1e3, high: 1.2e5, exponent: 3.0 }),
        Consumer::of("fiber").through(PowerLaw::multiple_of(-2e4)),
        Consumer::of("magnet.remanence")
            .through(PowerLaw { low: 0.0, high: 0.1, exponent: 2.0 })
            .through(Direction([0.6, 0.0, 0.8])),
    ];
    for space in [Space::Uniform, Space::Cell, Space::Node, Space::Grid([2, 1, 1])] {
        let across = vec![0.05; body.discretization().points().len()];
        let problem = Reduced::new(weight(body.clone())?).design("rho", space, &consumers)?.fix(2, 3, &across)?;
        let problem = problem.cost(target())?;
        let m = repeated(&[0.9], problem.layout().len());
        let controls = problem.layout().to_points(&m)?;
        let rho = problem.layout().block("rho")?.basis.values(&m, 1);
        for (q, rho) in rho.iter().enumerate() {
            assert!((controls.values(0)[2 * q] - (1e3 + 1.19e5 * rho.powi(3))).abs() < 1e-9);
            assert!((controls.values(1)[q] + 2e4 * rho).abs() < 1e-9 && controls.values(0)[2 * q + 1] == 4e5);
        }
        assert_orders(&problem, &m, &format!("rho {}", space.name()))?;
    }
    let two = Solid::new(mesh()?)?.actuate("root", "stiff", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?.actuate(
        "arm",
        "soft",
        Parametrised::new(MooneyRivlin::new(5e4, 2e4, 3e5)?),
    )?;
    let consumers = [
        Consumer::of("stiff.mu").through(PowerLaw::multiple_of(1e5)),
        Consumer::of("stiff.lambda").through(PowerLaw::multiple_of(4e5)),
        Consumer::of("soft.mu1").through(PowerLaw { low: 0.0, high: 5e4, exponent: 2.0 }),
    ];
    for space in [Space::Uniform, Space::Region, Space::Cell] {
        let problem = Reduced::new(weight(two.clone())?).design("stiffness", space, &consumers)?.cost(target())?;
        let m = repeated(&[1.1], problem.layout().len());
        assert_orders(&problem, &m, &format!("stiffness {}", space.name()))?;
    }
    Ok(())
}

#[test]
fn design_fields_that_cannot_be_are_refused() -> Outcome {
    let body = weight(
        Solid::new(mesh()?)?
            .actuate("body", "law", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?
            .actuate("arm", "magnet", Magnet::new())?
            .contribution(Edge::new(&mesh()?))?,
    )?;
    let refused =
        |space, consumers: &[Consumer]| Reduced::new(body.clone()).design("rho", space, consumers).unwrap_err();
    let why = |error: &ControlError| matches!(error, ControlError::Consumer { .. });
    assert!(why(&refused(Space::Cell, &[])));
    assert!(why(&refused(Space::Cell, &[Consumer::of("magnet.field")])));
    assert!(why(&refused(Space::Cell, &[Consumer::of("law.mu"), Consumer::of("law.mu")])));
    assert!(why(&refused(Space::Cell, &[Consumer::of("law.mu"), Consumer::of("edge")])));
    assert!(matches!(refused(Space::Cell, &[Consumer::of("lwa.mu")]), ControlError::UnknownControl { .. }));
    let taken = Reduced::new(body.clone()).control("law.mu", Space::Cell)?;
    let twice = taken.design("rho", Space::Cell, &[Consumer::of("law.mu")]).unwrap_err();
    assert!(matches!(twice, ControlError::ControlledTwice { .. }));
    assert!(matches!(
        Reduced::new(body.clone()).control("edge", Space::Cell).unwrap_err(),
        ControlError::OwnPoints { .. }
    ));
    Ok(())
}

/// A dead force of `m_k` N along z on every node k of the upper edge at the tip, less a spring: `r = -m + c u^3`.
#[derive(Debug, Clone)]
struct Edge {
    nodes: Vec<u32>,
    points: Vec<ControlPoint>,
}

const FORCE: [Slot; 1] = [Slot::scalar("force", "N")];
/// c, N/m^3
const SPRING: f64 = 1e5;

impl Edge {
    fn new(mesh: &Mesh) -> Self {
        let at_edge = |x: &[f64; 3]| x[2] > 0.199;
        let nodes = mesh.points().iter().zip(0u32..).filter(|(x, _)| at_edge(x) && x[0] > 0.1);
        let (points, nodes) = nodes.map(|(x, node)| (ControlPoint { position: *x, weight: 0.25 }, node)).unzip();
        Edge { nodes, points }
    }

    fn dof(&self, point: usize) -> usize {
        3 * self.nodes[point] as usize + 2
    }
}

impl Contribution for Edge {
    fn name(&self) -> &str {
        "edge"
    }

    fn slots(&self) -> &[Slot] {
        &FORCE
    }

    fn control_points(&self) -> &[ControlPoint] {
        &self.points
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Edge {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for point in 0..self.points.len() {
            let (dof, force) = (self.dof(point), at.control_at(point, 0));
            let u = at.u[dof];
            sums.energy += 0.25 * SPRING * u.powi(4) - force * u;
            sums.energy_scale += (0.25 * SPRING * u.powi(4)).abs() + (force * u).abs();
            if demand.force {
                sums.force[dof] += SPRING * u.powi(3) - force;
                sums.force_scale[dof] += (SPRING * u.powi(3)).abs() + force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let mut diagonal = vec![0.0; at.u.len()];
        (0..self.points.len()).for_each(|k| diagonal[self.dof(k)] = 3.0 * SPRING * at.u[self.dof(k)].powi(2));
        tangent.add_diagonal(&diagonal);
        Ok(())
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        (0..self.points.len()).for_each(|k| into.add_control_at(at, k, 0, -lambda[self.dof(k)]));
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        (0..self.points.len()).for_each(|k| out[self.dof(k)] -= at.slot_at(v, k, 0));
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        for dof in (0..self.points.len()).map(|k| self.dof(k)) {
            into.u[dof] += 6.0 * SPRING * at.u[dof] * lambda[dof] * along.u[dof];
        }
        Ok(())
    }
}

#[test]
fn controls_of_a_contribution_are_fields_over_its_points() -> Outcome {
    let solid = Solid::new(mesh()?)?
        .material("body", NeoHooke::new(1e5, 4e5)?)?
        .actuate("body", "turgor", Turgor::new())?
        .contribution(Edge::new(&mesh()?))?
        .clamp("x-")?;
    nastic_fem::check_contribution(solid.model(), "edge", 3)?;
    for (space, len) in [(Space::Uniform, 1), (Space::Point, 8), (Space::Grid([1, 1, 1]), 4)] {
        let problem = Reduced::new(solid.clone()).control("edge", space)?.control("turgor", Space::Uniform)?;
        let block = problem.layout().block("edge")?;
        assert_eq!((block.basis.len(), block.basis.points(), block.length()), (len, 8, None), "{}", space.name());
        assert!(block.targets[0].map.is_affine());
        let problem = problem.cost(target())?;
        let mut m = repeated(&[120.0], len);
        m.push(5e3);
        let all = problem.layout().to_points(&m)?;
        assert_eq!(all.values(1).len(), 8);
        // The product of the control space weighs every point by its length.
        let product = nastic_control::inner_product(problem.solid(), problem.layout(), problem.metric_kind())?;
        let mut ones = vec![1.0; len];
        ones.push(0.0);
        let size: f64 = product.apply(&ones).iter().sum();
        assert!((size - 2.0).abs() < 1e-12, "{size}");
        assert_orders(&problem, &m, &format!("edge {}", space.name()))?;
    }
    Ok(())
}
