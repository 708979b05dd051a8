//! Messages and bytes of one body over ranks, which are threads here, as docs/development/messages-of-ranks.md says.

use crate::ranks::{Outcome, on, solver::Simple};
use nastic_control::{
    ControlNorm, MeanPosition, Reduced, ReducedWorkspace, SmoothedHausdorff, Space, Target, Tracking,
};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Demand, Formulation, Instant, MovingSupport, Progress, Solid, SolveOptions, SolverFactory};
use nastic_linear::solver::{Accuracy, Definite, Solution, SolverState, Step, System};
use nastic_linear::{LinearError, LinearSolver, LinearWork, Structure, Symmetry};
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_opt::Objective;
use nastic_team::Team;
use nastic_team::threads::{ThreadRank, Traffic};
use nastic_tensor::Vec3;
use std::cell::{Cell, RefCell};
use std::sync::{Arc, Barrier, Mutex};

/// What all ranks send while all of them do something.
#[derive(Clone)]
struct Meter {
    rank: Arc<ThreadRank>,
    barrier: Arc<Barrier>,
}

thread_local! {
    static METER: RefCell<Option<Meter>> = const { RefCell::new(None) };
    /// What linear systems took since it was last asked for.
    static SYSTEMS: Cell<Traffic> = const { Cell::new(Traffic { messages: 0, bytes: 0 }) };
}

fn less(a: Traffic, b: Traffic) -> Traffic {
    Traffic { messages: a.messages - b.messages, bytes: a.bytes - b.bytes }
}

impl Meter {
    /// So far.
    fn now(&self) -> Traffic {
        self.barrier.wait();
        let now = self.rank.traffic();
        self.barrier.wait();
        now
    }

    /// Without what linear systems take.
    fn of<T>(&self, work: impl FnOnce() -> T) -> (T, Traffic) {
        SYSTEMS.take();
        let before = self.now();
        let found = work();
        (found, less(less(self.now(), before), SYSTEMS.take()))
    }
}

/// [`Simple`], whose messages are counted apart.
#[derive(Clone, Debug)]
struct Counted;

fn apart<T>(work: impl FnOnce() -> T) -> T {
    let Some(meter) = METER.with_borrow(Option::clone) else { return work() };
    let (before, sofar) = (meter.now(), SYSTEMS.get());
    let found = work();
    let own = less(meter.now(), before);
    SYSTEMS.set(Traffic { messages: sofar.messages + own.messages, bytes: sofar.bytes + own.bytes });
    found
}

impl SolverFactory for Counted {
    fn name(&self) -> &'static str {
        "counted"
    }

    fn about(&self) -> &'static str {
        Simple.about()
    }

    fn takes(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn make(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Counted)
    }
}

impl LinearSolver for Counted {
    fn state(&self) -> SolverState {
        SolverState { name: "counted", takes_products: false, bytes: 0 }
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {}

    fn prepare(&mut self, _: &System, _: &mut LinearWork) -> Result<(), LinearError> {
        Ok(())
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        apart(|| Simple.step(system, b, tolerance, work))
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        to: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        apart(|| Simple.solve(system, b, to, work))
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        apart(|| Simple.solve_definite(system, b, which, work))
    }

    fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Counted)
    }
}

fn plate() -> Outcome<Mesh> {
    Ok(box_mesh([1.0, 0.8, 0.2], [6, 5, 2], CellKind::Hex8)?)
}

/// Ranks that share nodes, over all ranks, and the nodes that these share.
fn shared(mesh: &Mesh, ranks: usize) -> Outcome<(usize, usize)> {
    let (owners, mut sums) = (mesh.bisected(ranks)?, (0, 0));
    for number in 0..ranks as u32 {
        for (_, nodes) in mesh.part(&owners, number)?.sharers() {
            sums = (sums.0 + 1, sums.1 + nodes.len());
        }
    }
    Ok(sums)
}

fn body(solid: Solid) -> Outcome<Solid> {
    Ok(solid
        .solver(&Counted)
        .material("body", NeoHooke::new(1e5, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

fn part(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Solid> {
    Ok(Solid::of_part(mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?, rank.clone())?)
}

/// What is counted, and what is expected of it.
struct Row {
    name: String,
    traffic: Traffic,
    expected: Expected,
}

/// On p ranks: `messages = A p ceil(log2 p) + X q + 2 T (p - 1)`, `bytes = 8 p (p - 1) (A + N) + 8 d s X + 16 L (p - 1) + P (p - 1)`.
#[derive(Default)]
struct Expected {
    /// A, and N: the numbers that a rank sends in all of them.
    agreements: [usize; 2],
    /// X, of d = 3 numbers per node.
    exchanges: usize,
    /// T sums along a tree, L their lengths together.
    sums: Vec<usize>,
    /// P: bytes of all ranks that are sent to all beside these.
    told: usize,
}

fn expected(agreements: [usize; 2], exchanges: usize) -> Expected {
    Expected { agreements, exchanges, ..Expected::default() }
}

/// Of evaluations and of one solve.
fn of_the_body(solid: &Solid, meter: &Meter) -> Outcome<Vec<Row>> {
    let mut rows = Vec::new();
    let mut row = |name: &str, traffic, agreements, exchanges| {
        rows.push(Row { name: name.to_owned(), traffic, expected: expected(agreements, exchanges) });
    };
    let (u, mut controls) = (vec![0.0; solid.model().unknowns().len()], solid.controls());
    controls.values_mut(0).fill(-1e3);
    let at = Instant::new(&u, &controls, 1.0);
    for (name, force, exchanges) in [("energy", false, 0), ("energy and residual", true, 2)] {
        let (found, traffic) = meter.of(|| solid.model().evaluate(&at, Demand { energy: true, force }));
        found?;
        row(name, traffic, [3, 4], exchanges);
    }
    let mut tangent = solid.model().tangent_structure().matrix();
    row("tangent", meter.of(|| solid.model().tangents().add_tangent(&at, &mut tangent)).1, [1, 1], 0);
    row("sum over unknowns", meter.of(|| solid.model().unknowns().dot(&u, &u)).1, [1, 1], 0);
    let chosen = solid.clone();
    row("formulation", meter.of(|| chosen.formulation("body", Formulation::MeanDilatation)).1, [1, 1], 0);

    SYSTEMS.take();
    let seen = Mutex::new(vec![meter.now()]);
    let watch = |_: &Progress| {
        let sofar = less(meter.now(), SYSTEMS.get());
        if let Ok(mut seen) = seen.lock() {
            seen.push(sofar);
        }
    };
    solid.solve(&controls, &SolveOptions { parallel: false, watch: Some(&watch), ..SolveOptions::default() })?;
    let end = less(meter.now(), SYSTEMS.take());
    let mut seen = seen.into_inner()?;
    seen.push(end);
    let (iteration, last) = ([14, 15], seen.len() - 2);
    assert!(last > 2, "{last} iterations");
    for (k, pair) in seen.windows(2).enumerate() {
        let (name, agreements, exchanges) = match k {
            0 => ("beginning and an iteration", [19 + iteration[0], 55 + iteration[1]], 2 + 2),
            k if k == last => ("end", [3, 3], 0),
            _ => ("Newton iteration", iteration, 2),
        };
        row(name, less(pair[1], pair[0]), agreements, exchanges);
    }
    Ok(rows)
}

/// Points of the rules by which distances are summed, of the body and of its target.
const POINTS: [usize; 2] = [60 * 27, 4 * 512];

/// Cost and derivative of one tracking cost, and of one more of what is named.
fn of_problems(mesh: &Mesh, meter: &Meter) -> Outcome<Vec<Row>> {
    let [n, m] = POINTS;
    let (far, nodes) = (Target::position(|x| [0.95 * x[0], x[1], x[2]]), mesh.points().len());
    // what it takes beside that of the first cost: agreements of the cost with their numbers, sums along trees, bytes; of its derivative exchanges, sums
    let more = [
        ("tracking", [0, 0], None, 0, 0, None),
        ("a second tracking", [3, 4], None, 0, 0, None),
        ("mean position", [2, 4], None, 0, 0, None),
        ("norm", [2, 2], None, 0, 0, None),
        ("smoothed distance", [3, 2], Some(n + m), 32 * n, 0, Some(4 * n)),
        ("support that moves", [0, 0], None, 0, 1, None),
    ];
    let mut rows = Vec::new();
    for (name, agreements, sum, told, exchanges, sum_of_derivative) in more {
        let solid = body(part(mesh, &meter.rank)?)?;
        let moves = name == "support that moves";
        let solid = if moves { solid.motion(MovingSupport::of("grip", "x+"))? } else { solid };
        let problem = Reduced::new(solid).sequential().control("tension", Space::Node)?;
        let problem = problem.cost(Tracking::surface("x+", far.clone()))?;
        let problem = match name {
            "a second tracking" => problem.cost(Tracking::surface("z+", far.clone()))?,
            "mean position" => problem.cost(MeanPosition::surface("x+", [Some(0.9), None, None]))?,
            "norm" => problem.cost(ControlNorm::of("tension", 1e-12)?)?,
            "smoothed distance" => {
                problem.cost(SmoothedHausdorff::to(box_mesh([1.0, 0.8, 0.3], [2, 2, 1], CellKind::Hex8)?))?
            }
            _ if moves => problem.control("grip.translation", Space::Uniform)?,
            _ => problem,
        };
        let (point, traffic) = meter.of(|| problem.at(&vec![0.0; problem.layout().len()]));
        // the solve at rest, the control and the cost
        let agreements = [21 + 1 + 3 + agreements[0], 57 + 3 + 4 + agreements[1]];
        let of_value = Expected { agreements, exchanges: 2, sums: sum.into_iter().collect(), told };
        rows.push(Row { name: format!("cost: {name}"), traffic, expected: of_value });
        let (mut point, mut workspace) = (point?, ReducedWorkspace::default());
        let (found, traffic) = meter.of(|| problem.derivative(&mut point, &mut workspace));
        found?;
        // the adjoint, one for each cost, and the derivative by the control
        let costs = problem.costs().len();
        let sums = std::iter::once(nodes + if moves { 3 } else { 0 }).chain(sum_of_derivative).collect();
        let agreements = [3 + costs + 2, 3 + costs + 2];
        let of_derivative = Expected { agreements, exchanges: 1 + exchanges, sums, told: 0 };
        rows.push(Row { name: format!("derivative: {name}"), traffic, expected: of_derivative });
        let (any, traffic) = meter.of(|| problem.any(false));
        any?;
        rows.push(Row { name: "cancellation".to_owned(), traffic, expected: expected([1, 1], 0) });
    }
    Ok(rows)
}

#[test]
fn messages_and_bytes_are_those_of_the_formulas() -> Outcome {
    let mesh = plate()?;
    for ranks in 2..=8 {
        let barrier = Arc::new(Barrier::new(ranks));
        let found = on(ranks, |rank| {
            let meter = Meter { rank, barrier: barrier.clone() };
            METER.set(Some(meter.clone()));
            let mut rows = of_the_body(&body(part(&mesh, &meter.rank)?)?, &meter)?;
            rows.extend(of_problems(&mesh, &meter)?);
            Ok(rows)
        });
        let (log, (q, s)) = (ranks.next_power_of_two().trailing_zeros() as usize, shared(&mesh, ranks)?);
        for rows in found {
            for Row { name, traffic, expected } in rows? {
                let Expected { agreements: [agreements, numbers], exchanges, sums, told } = expected;
                let messages = agreements * ranks * log + exchanges * q + 2 * sums.len() * (ranks - 1);
                let of_agreements = 8 * ranks * (ranks - 1) * (agreements + numbers);
                let others = 16 * sums.iter().sum::<usize>() + told;
                let bytes = of_agreements + 8 * 3 * s * exchanges + others * (ranks - 1);
                assert_eq!(traffic, Traffic { messages, bytes }, "{name} on {ranks}");
            }
        }
    }
    Ok(())
}
