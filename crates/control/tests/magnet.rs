//! Hard magnets as a design and a control: derivatives along spheres, lengths kept, known answers found again.

use nastic_control::{Metric, Reduced, Space, Target, Tracking};
use nastic_energy::{EnergyTerm, Magnet, MagnetIsochoric, MagnetRotation, MooneyRivlin};
use nastic_ensemble::{Ensemble, LoadCase};
use nastic_fem::{Discretization, Solid};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_opt::{
    Admissible, Ball, Best, CATALOGUE, Lbfgs, Optimizer, Options, Problem, Product, Sphere, Taylor, Trial, Verdict,
};
use nastic_uncertainty::risk::Mean;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const REMANENCE: f64 = 0.1;
const FIELD: f64 = 20e-3;

fn bar(law: Arc<dyn EnergyTerm>) -> Outcome<Solid> {
    Ok(Solid::new(box_mesh([1.0, 0.2, 0.05], [4, 2, 1], CellKind::Hex20)?)?
        .material("body", MooneyRivlin::new(5e4, 5e4, 2e5)?)?
        .actuate("body", "magnet", law)?
        .clamp("x-")?)
}

/// The bar's end is to be lifted; nodal magnetisations keep their length between the nodes.
fn lifting(law: Arc<dyn EnergyTerm>, space: Space, metric: Metric) -> Outcome<Reduced> {
    let mut problem = Reduced::new(bar(law)?).control("magnet.remanence", space)?;
    if space == Space::Node {
        problem = problem.of_length("magnet.remanence", REMANENCE)?;
    }
    let up = Target::position(|x| [0.8 * x[0], x[1] + 0.05, x[2] + 0.4]);
    let problem = problem.control("magnet.field", Space::Uniform)?.cost(Tracking::surface("x+", up))?.metric(metric);
    problem.check()?;
    Ok(problem)
}

/// Magnetisations on spheres, one field or more in balls; and a start with random directions.
fn set_and_start(vectors: usize, fields: &[[f64; 3]], seed: u64) -> Outcome<(Product, Vec<f64>)> {
    let sphere = Sphere::new(3, REMANENCE)?;
    let mut start = sphere.random(vectors, seed);
    let mut set = Product::new().block(3 * vectors, sphere);
    for field in fields {
        set.push(3, Arc::new(Ball::new(3, FIELD)?));
        start.extend(field);
    }
    Ok((set, start))
}

#[test]
fn taylor_orders_along_the_sphere_and_for_the_field() -> Outcome {
    let laws: [Arc<dyn EnergyTerm>; 3] =
        [Arc::new(Magnet::new()), Arc::new(MagnetIsochoric::new()), Arc::new(MagnetRotation::new())];
    for law in laws {
        for space in [Space::Cell, Space::Node] {
            let problem = lifting(law.clone(), space, Metric::L2)?;
            let vectors = problem.layout().blocks()[0].basis.len();
            let (set, m) = set_and_start(vectors, &[[2e-3, -4e-3, 9e-3]], 5)?;
            for components in [0..3 * vectors, 3 * vectors..m.len(), 0..m.len()] {
                let taylor =
                    Taylor { components: Some(components.clone()), directions: 2, second: true, ..Taylor::default() };
                let report = taylor.test(&problem, &set, &m)?;
                for direction in &report.directions {
                    let what = format!("{law:?}, {space:?}, {components:?}: {report}");
                    assert!(direction.verdict == Verdict::Right && direction.order1 > 1.95, "{what}");
                    let second = direction.second.as_ref().ok_or("not tested")?;
                    assert!(second.verdict == Verdict::Right && second.order > 2.95, "{what}");
                }
            }
        }
    }
    Ok(())
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// At every trial of every optimiser, accepted or not: at the unknowns, and at every quadrature point of the body.
#[test]
fn lengths_are_kept_at_every_trial() -> Outcome {
    for (space, metric) in
        [(Space::Cell, Metric::L2), (Space::Node, Metric::L2), (Space::Node, Metric::H1 { length: 0.2 })]
    {
        let problem = lifting(Arc::new(Magnet::new()), space, metric)?;
        let vectors = problem.layout().blocks()[0].basis.len();
        let (set, start) = set_and_start(vectors, &[[0.0, 0.0, 0.9 * FIELD]], 11)?;
        // moving asymptotes take bounds alone
        for entry in CATALOGUE.iter().filter(|entry| entry.name != "mma") {
            let optimizer = (entry.build)(Options { max_iterations: 8, ..Options::default() });
            let (mut trials, mut off, mut strongest) = (0, 0.0f64, 0.0f64);
            let mut watch = |trial: &Trial<'_, nastic_control::Evaluated>| {
                trials += 1;
                let mut see = |v: &[f64]| off = off.max((length(v) / REMANENCE - 1.0).abs());
                trial.m[..3 * vectors].chunks_exact(3).for_each(&mut see);
                for slots in trial.point.iter().flat_map(|point| point.state().controls.values(0).chunks_exact(6)) {
                    see(&slots[..3]);
                    strongest = strongest.max(length(&slots[3..]));
                }
                strongest = strongest.max(length(&trial.m[3 * vectors..]));
            };
            let best = optimizer.within(set.clone()).observe(&mut watch).minimize(&problem, &start)?;
            let what = format!("{}, {space:?}, {metric:?}: {:?}", entry.name, best.counts);
            assert!(trials > 5 && off <= 1e-12 && strongest <= FIELD, "{what}: {off:e}, {strongest:e}");
            let first = problem.at(&start)?.cost();
            assert!(best.cost < 0.5 * first, "{what}: {first:e} -> {:e}", best.cost);
        }
    }
    Ok(())
}

/// The T of the examples on a grid of so many cells: stem 0.8 x 0.2, bar 0.2 x 1, thickness 0.05.
fn t(cells: usize) -> Outcome<Mesh> {
    let grid = box_mesh([1.0, 1.0, 0.05], [cells, cells, 1], CellKind::Hex20)?.mapped(|x| [x[0], x[1] - 0.5, x[2]])?;
    let kept = |cell: usize| {
        let nodes = grid.cell(cell).nodes;
        let mean = |k: usize| nodes.iter().map(|&n| grid.points()[n as usize][k]).sum::<f64>() / nodes.len() as f64;
        mean(0) > 0.8 || mean(1).abs() < 0.1
    };
    let mut raw = RawMesh::new("T");
    raw.points = grid.points().to_vec();
    for (cell, nodes) in grid.blocks()[0].iter().enumerate().filter(|(cell, _)| kept(*cell)) {
        assert_eq!(nodes, grid.cell(cell).nodes);
        raw.push(CellKind::Hex20, nodes, &[1]);
    }
    raw.name_group(3, 1, "body");
    for (tag, side) in [(2, "x-"), (3, "z+")] {
        raw.name_group(2, tag, side);
        for &facet in grid.surface(side)?.iter().filter(|facet| kept(facet.cell as usize)) {
            let (kind, nodes) = grid.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}

fn magnetic(disc: &Arc<Discretization>) -> Outcome<Solid> {
    Ok(Solid::on(disc.clone())
        .material("body", MooneyRivlin::new(5e4, 5e4, 2e5)?)?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("x-")?)
}

/// Tracking of where a known magnetisation takes the upper side in a field, on a finer mesh than the design's.
fn known(maker: &Arc<Discretization>, field: [f64; 3]) -> Outcome<Tracking> {
    let solid = magnetic(maker)?;
    let mut controls = solid.controls();
    let at = maker.points().positions(maker.mesh(), None);
    for (slots, x) in controls.values_mut(0).chunks_exact_mut(6).zip(&at) {
        let (sin, cos) = (2.4 * x[1]).sin_cos();
        slots.copy_from_slice(&[REMANENCE * cos, REMANENCE * sin, 0.0, field[0], field[1], field[2]]);
    }
    let state = solid.solve(&controls, &Default::default())?;
    Ok(Tracking::surface("z+", Target::moved(maker.mesh().clone(), state.u.to_vec())?))
}

const FIELDS: [[f64; 3]; 2] = [[0.0, 4e-3, 16e-3], [8e-3, 6e-3, -12e-3]];

fn designed(disc: &Arc<Discretization>, target: Tracking) -> Outcome<Reduced> {
    Ok(Reduced::new(magnetic(disc)?)
        .control("magnet.remanence", Space::Cell)?
        .control("magnet.field", Space::Uniform)?
        .cost(target)?)
}

fn minimise<P: Problem>(problem: &P, set: Product, start: Vec<f64>) -> Outcome<Best<P::Point>> {
    set.check(&start)?;
    let options = Options { tolerance: 1e-3, max_iterations: 40, ..Options::default() };
    Ok(Lbfgs { options, ..Lbfgs::default() }.within(set).minimize(problem, start)?)
}

/// The tracking cost falls by two decades in the best of four starts, on a coarse mesh and with few iterations; the example
/// program `t_magnet` goes on to three.
#[test]
fn a_known_target_is_reached() -> Outcome {
    let (disc, maker) = (Discretization::new(t(5)?.into())?, Discretization::new(t(10)?.into())?);
    let problem = designed(&disc, known(&maker, FIELDS[0])?)?;
    let cells = disc.mesh().cells();
    let upward = [0.0, 0.0, 0.5 * FIELD];
    let (set, uniform) = set_and_start(cells, &[upward], 0)?;
    let uniform = [[REMANENCE, 0.0, 0.0].repeat(cells), uniform[3 * cells..].to_vec()].concat();
    let first = problem.at(&uniform)?.cost();
    let mut end = minimise(&problem, set, uniform)?.cost;
    for seed in 1..4 {
        // Those that are left cannot make the best worse.
        if end < 1e-2 * first {
            break;
        }
        let (set, start) = set_and_start(cells, &[upward], seed)?;
        end = end.min(minimise(&problem, set, start)?.cost);
    }
    println!("{first:e} -> {end:e}");
    assert!(end < 1e-2 * first, "{first:e} -> {end:e}");
    Ok(())
}

/// One magnetisation, two fields: both costs fall by two decades.
#[test]
fn two_known_targets_are_reached_with_one_magnetisation() -> Outcome {
    let (disc, maker) = (Discretization::new(t(5)?.into())?, Discretization::new(t(10)?.into())?);
    let case = |name: &str, field| Outcome::Ok(LoadCase::new(name, 1.0, designed(&disc, known(&maker, field)?)?));
    let cases = vec![case("lifted", FIELDS[0])?.own("magnet.field"), case("lowered", FIELDS[1])?.own("magnet.field")];
    let problem = Ensemble::new(Mean).load_cases(cases).build()?;
    let names: Vec<&str> = problem.blocks().iter().map(|block| block.name.as_str()).collect();
    assert_eq!(names, ["magnet.remanence", "lifted/magnet.field", "lowered/magnet.field"]);
    let cells = disc.mesh().cells();
    let fields = [[0.0, 0.0, 0.5 * FIELD], [0.0, 0.0, -0.5 * FIELD]];
    let (set, random) = set_and_start(cells, &fields, 0)?;
    let start = [[REMANENCE, 0.0, 0.0].repeat(cells), random[3 * cells..].to_vec()].concat();
    let first = problem.at(&start)?;
    let best = minimise(&problem, set, start)?;
    for (part, (from, to)) in problem.members().iter().zip(first.members.iter().zip(&best.point.members)) {
        println!("{}: {:e} -> {:e}", part.name(), from.cost(), to.cost());
        assert!(to.cost() < 1e-2 * from.cost(), "{}: {:e} -> {:e}", part.name(), from.cost(), to.cost());
    }
    Ok(())
}

#[test]
fn lengths_that_make_no_sense_and_bodies_not_covered_are_refused() -> Outcome {
    let problem = Reduced::new(bar(Arc::new(Magnet::new()))?).control("magnet.remanence", Space::Node)?;
    let error = problem.of_length("magnet.remanence", -1.0).unwrap_err().to_string();
    assert!(error.contains("positive length"), "{error}");
    let problem = Reduced::new(bar(Arc::new(Magnet::new()))?).control("magnet.remanence", Space::Node)?;
    let error = problem.of_length("magnet.remanense", 1.0).unwrap_err().to_string();
    assert!(error.contains("magnet.remanence"), "{error}");

    let short = box_mesh([0.5, 0.2, 0.05], [1, 1, 1], CellKind::Hex8)?;
    let rest = vec![0.0; 3 * short.points().len()];
    assert!(Target::moved(short.clone(), vec![0.0; 4]).is_err());
    let target = Tracking::surface("x+", Target::moved(short, rest)?);
    let error = Reduced::new(bar(Arc::new(Magnet::new()))?).cost(target).unwrap_err().to_string();
    assert!(error.contains("not finite") && error.contains("covers the body"), "{error}");
    Ok(())
}

/// What a viewer is shown: the mean of each cell, of the length it must have where the magnetisation is uniform.
#[test]
fn snapshots_hold_remanence_and_field() -> Outcome {
    let problem = lifting(Arc::new(Magnet::new()), Space::Node, Metric::L2)?;
    let vectors = problem.layout().blocks()[0].basis.len();
    let m = [[0.0, REMANENCE, 0.0].repeat(vectors), vec![0.0, 3e-3, 4e-3]].concat();
    let shot = problem.snapshot(&problem.at(&m)?, None)?;
    for (name, expected) in [("B_r", [0.0, REMANENCE, 0.0]), ("B_a", [0.0, 3e-3, 4e-3])] {
        let array = shot.cell_array(name).ok_or("no such array")?;
        assert!(array.values.chunks_exact(3).all(|v| (0..3).all(|k| (v[k] - expected[k]).abs() < 1e-15)), "{name}");
    }
    Ok(())
}
