//! Mean and deviation to first order: a bar against closed forms, Taylor's theorem beside every kind of control, differences, saved points.

use nastic_control::{MeanDisplacement, Reaction, Reduced, Space, Target, Tracking};
use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::{EnergyTerm, FiberTension, Magnet, Turgor};
use nastic_ensemble::{Ensemble, EnsembleError, EnsembleWorkspace, FirstOrder, LoadCase, UncertainSource};
use nastic_fem::{Cavity, Solid, Tendon};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_numeric::vector::norm;
use nastic_opt::{Bounds, Hessian, Objective, Request, Taylor, Verdict};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::Mean;
use nastic_uncertainty::{FieldLaw, Modes, RandomField, Sample, UnitModes};
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn rubber(young: f64, poisson: f64) -> Outcome<Arc<dyn EnergyTerm>> {
    let law = material("neo_hooke")?;
    Ok(law.parametrised(&Inputs::new().number("young", young).number("poisson", poisson), &["young", "poisson"])?)
}

fn source(name: &str, slopes: Vec<Vec<f64>>) -> UncertainSource {
    UncertainSource { name: name.to_owned(), slopes, parts: vec![] }
}

/// A bar pulled by a dead load, its modulus a log-normal field of variation 0.2 and covariance `exp(-|x - y|/(L/4))` of the logarithm: with `r = P L/(A E0)` the displacement
/// at the median is `r exp(v/2)`, its first-order deviation `r exp(v/2) sqrt(int 2 (1 - s) v exp(-4 s) ds)`; all orders have the mean `r exp(v)` and the deviation 0.127235 r.
#[test]
fn a_bar_under_a_log_normal_modulus() -> Outcome {
    let (cells, r) = (64, 1e-5);
    let mesh = box_mesh([1.0, 0.1, 0.1], [cells, 1, 1], CellKind::Hex8)?;
    let young = 3e5;
    let field = RandomField::log_normal(&mesh, "body", young, 0.2, 0.25, Modes::Energy(1.0))?;
    let (medians, slopes) = field.linearised();
    let body = Solid::new(mesh)?
        .actuate("body", "rubber", rubber(young, 0.0)?)?
        .actuate("body", "fiber", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .traction("x+", Vec3::new(r * young, 0.0, 0.0))?;
    let problem = Reduced::new(body)
        .control("fiber", Space::Uniform)?
        .uncertain("rubber.young", Space::Cell, &medians)?
        .cost(MeanDisplacement::surface("x+", [1.0, 0.0, 0.0]))?;
    let parts = vec![("near".to_owned(), (0..32).collect()), ("far".to_owned(), (32..64).collect())];
    let sources = vec![UncertainSource { name: "E".to_owned(), slopes, parts }];
    let of = FirstOrder { deviations: 2.0, smoothing: 1e-3, sources };
    let problem = Ensemble::new(Mean).scenario("", 1.0, problem).first_order(of).build()?;
    let point = problem.at(&[0.0])?;
    let at = point.first_order.as_ref().ok_or("no first order")?;
    println!("{} {}", at.mean / r, at.deviation / r);
    assert!((at.mean / r / 1.019804 - 1.0).abs() < 2e-4, "{}", at.mean / r);
    assert!((at.deviation / r / 0.124054 - 1.0).abs() < 2e-3, "{}", at.deviation / r);
    let rounded = at.deviation.hypot(1e-3 * at.mean);
    assert!((problem.value(&point) - (at.mean + 2.0 * rounded)).abs() < 1e-14 * r.max(1.0));
    let shares = problem.variance_shares(&point);
    assert!(shares.iter().all(|own| (own.share - 0.5).abs() < 1e-3 && own.name == "E"), "{shares:?}");
    // all orders, by a lattice of the compliances of the cells
    let laws = field.laws();
    let sample = Sample::lattice(&laws, 4096, 1)?;
    let elongation = |xi: &[f64]| match field.realise(xi) {
        Ok(nastic_energy::Field::Cell(values)) => values.iter().map(|e| young / e).sum::<f64>() / cells as f64,
        _ => f64::NAN,
    };
    let mean = sample.expectation(elongation);
    let deviation = sample.expectation(|xi| (elongation(xi) - mean).powi(2)).sqrt();
    assert!((mean / 1.04 - 1.0).abs() < 1e-3 && (deviation / 0.127235 - 1.0).abs() < 1e-2, "{mean} {deviation}");
    Ok(())
}

/// A cube of 27 cells without the middle one, whose surface is `inner`.
fn hollow() -> Outcome<Mesh> {
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
            raw.push(CellKind::Hex8, cell, &[1]);
        }
    }
    for (dim, tag, name) in [(3, 1, "body"), (2, 1, "inner"), (2, 2, "x-"), (2, 3, "x+")] {
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

/// What is controlled, and where.
struct Drive {
    name: &'static str,
    space: Space,
    start: f64,
    range: f64,
}

const DRIVES: [Drive; 5] = [
    Drive { name: "fiber", space: Space::Cell, start: -2e4, range: 1e4 },
    Drive { name: "turgor", space: Space::Cell, start: 1e4, range: 1e4 },
    Drive { name: "magnet.field", space: Space::Uniform, start: 2e-2, range: 1e-2 },
    Drive { name: "air", space: Space::Uniform, start: 1e-3, range: 5e-4 },
    Drive { name: "string", space: Space::Uniform, start: 300.0, range: 100.0 },
];

const YOUNG: f64 = 3e5;
const POISSON: f64 = 0.3;

/// The cube with a modulus that is a field of three modes by cell and an uncertain ratio, shifted from their medians by numbers of deviations.
fn cube(drive: &Drive, shift: [f64; 4], weight: f64) -> Outcome<Reduced> {
    let solid = Solid::new(hollow()?)?.actuate("body", "rubber", rubber(YOUNG, POISSON)?)?;
    let solid = match drive.name {
        "fiber" => solid.actuate("body", "fiber", FiberTension::along(Vec3::x())?)?,
        "turgor" => solid.actuate("body", "turgor", Turgor::new())?,
        "air" => solid.cavity(Cavity::new("air", "inner").by_volume())?,
        "string" => solid.tendon(Tendon::through("string", [[0.0, 0.2, 0.85], [1.0, 0.3, 0.9]]).spacing(0.25))?,
        _ => solid.actuate("body", "magnet", Magnet::new())?,
    };
    let solid = solid.clamp("x-")?.body_force("body", Vec3::new(0.0, 0.0, -2e4))?;
    let [young, ratio] = sources();
    let mut medians = vec![YOUNG; 26];
    for (slopes, xi) in young.slopes.iter().zip(shift) {
        medians.iter_mut().zip(slopes).for_each(|(median, slope)| *median += xi * slope);
    }
    let mut problem = Reduced::new(solid);
    problem = problem.control(drive.name, drive.space)?;
    if drive.name == "magnet.field" {
        problem = problem.control("magnet.remanence", Space::Uniform)?;
    }
    Ok(problem
        .uncertain("rubber.young", Space::Cell, &medians)?
        .uncertain("rubber.poisson", Space::Uniform, &[POISSON + shift[3] * ratio.slopes[0][0]])?
        .cost(
            Tracking::surface("x+", Target::position(|x| [1.06 * x[0], x[1] + 0.05, x[2] + 0.02 * x[1]]))
                .weight(weight),
        )?)
}

fn sources() -> [UncertainSource; 2] {
    let slope = |k: usize, c: usize| 0.1 * YOUNG * (0.5 + k as f64 + 0.7 * c as f64).sin();
    [source("E", (0..3).map(|k| (0..26).map(|c| slope(k, c)).collect()).collect()), source("nu", vec![vec![0.02]])]
}

fn robust(drive: &Drive) -> Outcome<Ensemble> {
    let of = FirstOrder { deviations: 3.0, smoothing: 1e-3, sources: sources().to_vec() };
    Ok(Ensemble::new(Mean).scenario("", 1.0, cube(drive, [0.0; 4], 1.0)?).first_order(of).build()?)
}

fn start(drive: &Drive, len: usize) -> Vec<f64> {
    let mut m: Vec<f64> = (0..len).map(|i| drive.start * (1.0 + 0.3 * (i as f64).sin())).collect();
    if drive.name == "magnet.field" {
        m[3..].copy_from_slice(&[0.1, 0.05, 0.2]);
    }
    m
}

#[test]
fn the_derivative_of_the_risk_is_exact() -> Outcome {
    for drive in &DRIVES {
        let problem = robust(drive)?;
        let m = start(drive, problem.len());
        let range = |k: usize| if drive.name == "magnet.field" && k > 2 { 0.05 } else { drive.range };
        let around = |side: f64| m.iter().enumerate().map(|(k, m)| m + side * range(k)).collect::<Vec<f64>>();
        let report = Taylor::default().test(&problem, &Bounds::new(around(-1.0), around(1.0))?, &m)?;
        for direction in &report.directions {
            println!("{} {}", drive.name, direction.order1);
            assert!(matches!(direction.verdict, Verdict::Right), "{}: {report}", drive.name);
            assert!(direction.order1 > 1.95, "{}: {report}", drive.name);
        }
    }
    Ok(())
}

/// The deviation is that of central differences by the random numbers, extrapolated; shares add up and follow the differences.
#[test]
fn the_deviation_is_that_of_differences() -> Outcome {
    for drive in &DRIVES {
        let problem = robust(drive)?;
        let m = start(drive, problem.len());
        let point = problem.at(&m)?;
        let at = point.first_order.clone().ok_or("no first order")?;
        let mut slopes = Vec::new();
        for k in 0..4 {
            let change = |h: f64| -> Outcome<f64> {
                let value = |xi: f64| -> Outcome<f64> {
                    let mut shift = [0.0; 4];
                    shift[k] = xi;
                    Ok(cube(drive, shift, 1.0)?.at(&m)?.cost())
                };
                Ok((value(h)? - value(-h)?) / (2.0 * h))
            };
            slopes.push((4.0 * change(5e-2)? - change(0.1)?) / 3.0);
        }
        let expected = norm(&slopes);
        println!("{} {} {expected} of {}", drive.name, at.deviation, at.mean);
        assert!((at.deviation / expected - 1.0).abs() < 1e-6, "{}: {} and {expected}", drive.name, at.deviation);
        let shares = problem.variance_shares(&point);
        let ratio = shares.iter().find(|own| own.name == "nu").ok_or("no share")?;
        assert!((ratio.share - (slopes[3] / expected).powi(2)).abs() < 1e-5, "{shares:?}");
        assert!((shares.iter().map(|own| own.share).sum::<f64>() - 1.0).abs() < 1e-12 && shares[0].share >= 0.5);
    }
    Ok(())
}

/// Load cases share the uncertain numbers: the deviation is that of the weighted sum, not the sum of deviations.
#[test]
fn load_cases_vary_together() -> Outcome {
    let drive = &DRIVES[0];
    let of = || FirstOrder { deviations: 1.0, smoothing: 0.0, sources: sources().to_vec() };
    let cases = |a: f64, b: f64| -> Outcome<Vec<LoadCase>> {
        Ok(vec![LoadCase::new("a", a, cube(drive, [0.0; 4], 1.0)?), LoadCase::new("b", b, cube(drive, [0.0; 4], 3.0)?)])
    };
    let both = Ensemble::new(Mean).scenario_of("", 1.0, cases(1.0, 2.0)?).first_order(of()).build()?;
    let m = start(drive, both.len());
    let (point, one) = (both.at(&m)?, robust(drive)?.at(&m)?);
    let (sum, one) = (point.first_order.clone().ok_or("none")?, one.first_order.ok_or("none")?);
    assert!(
        (sum.deviation / (7.0 * one.deviation) - 1.0).abs() < 1e-9 && (sum.mean / (7.0 * one.mean) - 1.0).abs() < 1e-12
    );
    // a saved point is what it was, and a run goes on with its bits
    let mut workspace = EnsembleWorkspace::default();
    let loaded = both.load(&m, &both.save(&point), &Request::default())?;
    assert_eq!((loaded.risk, &loaded.first_order), (point.risk, &point.first_order));
    assert!(both.load(&m, &robust(drive)?.save(&robust(drive)?.at(&m)?), &Request::default()).is_err());
    let refused = both.hessian_vector(&point, &m, &mut workspace).unwrap_err();
    assert!(refused.lacks_second_derivatives() && refused.to_string().contains("lbfgs"), "{refused}");
    assert!(Objective::hessian_vector(&both, &point, &m, Hessian::GaussNewton, &mut workspace).is_err());
    let wrong = FirstOrder { sources: vec![source("E", vec![vec![1.0; 3]])], ..of() };
    let wrong = Ensemble::new(Mean).scenario("", 1.0, cube(drive, [0.0; 4], 1.0)?).first_order(wrong).build();
    assert!(matches!(wrong, Err(EnsembleError::FirstOrder { .. })));
    let two = Ensemble::new(Mean)
        .scenario("a", 0.5, cube(drive, [0.0; 4], 1.0)?)
        .scenario("b", 0.5, cube(drive, [0.0; 4], 1.0)?)
        .first_order(of())
        .build();
    assert!(matches!(two, Err(EnsembleError::FirstOrder { .. })));
    Ok(())
}

/// A number that is uncertain is not controlled as well, has as many medians as unknowns, and changes the state that it is solved for.
#[test]
fn uncertain_numbers_that_do_not_fit_are_refused() -> Outcome {
    let solid = || -> Outcome<Solid> {
        Ok(Solid::new(hollow()?)?.actuate("body", "rubber", rubber(YOUNG, POISSON)?)?.clamp("x-")?)
    };
    let twice =
        Reduced::new(solid()?).control("rubber.young", Space::Cell)?.uncertain("rubber.young", Space::Uniform, &[1e5]);
    assert!(twice.is_err());
    assert!(Reduced::new(solid()?).uncertain("rubber.young", Space::Cell, &[1e5; 3]).is_err());
    assert!(Reduced::new(solid()?).uncertain("rubber.mu", Space::Uniform, &[1e5]).is_err());
    let law = FieldLaw::LogNormal;
    let modes = UnitModes { cells: (0..26).collect(), all_cells: 26, modes: vec![vec![1.0; 26]], captured: 1.0 };
    let (medians, _) = RandomField::of_modes(law, YOUNG, 0.2 * YOUNG, modes)?.linearised();
    let problem = Reduced::new(solid()?).uncertain("rubber.young", Space::Cell, &medians)?;
    assert!(problem.layout().is_empty());
    // the force of a support depends on the modulus where nothing moves
    let reaction = Reaction::at("x-", [1.0, 0.0, 0.0], 1.0);
    let pulled = problem.cost(reaction)?;
    let sources = vec![source("E", vec![vec![1.0; 26]])];
    let of = FirstOrder { deviations: 1.0, smoothing: 0.0, sources };
    let refused = Ensemble::new(Mean).scenario("", 1.0, pulled).first_order(of).build().unwrap_err().to_string();
    assert!(refused.contains("\"reaction\" depends on numbers of materials"), "{refused}");
    let problem = Reduced::new(solid()?).uncertain("rubber.young", Space::Cell, &medians)?;
    assert_eq!(problem.uncertain_numbers(), vec![("rubber.young", 26)]);
    let found = problem.layout().to_points(&[])?.values(0)[0];
    assert!((found / (YOUNG / 1.04_f64.sqrt()) - 1.0).abs() < 1e-12, "{found}");
    Ok(())
}
