//! The shape of the body as control: derivatives against differences and closed forms, optima that do not depend on what was drawn.

use crate::designs::Outcome;
use nastic_control::{
    Consumer, Interpolation, Knots, LumenVolume, MeanDisplacement, MeanPosition, PowerLaw, Reduced, ReducedWorkspace,
    Space, Target, Timeline, Tracking,
};
use nastic_energy::{FiberTension, KinematicGrowth, NeoHooke, Parametrised};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{Controls, Inertia, Instant, NodalMode, Scheme, Solid, Tendon, VaryingLoad};
use nastic_mesh::{CellKind, box_mesh, rectangle};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Taylor, Verdict};
use nastic_tensor::Vec3;

/// A cup with a chamber, a cable and fibres, heavy, of a shape and of a share of stiff material that are unknown.
fn cup() -> Outcome<Solid> {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "cavity").ok_or("no cavity in the catalogue")?;
    let body = (entry.example)()?;
    let mesh = body.mesh().clone();
    let modes = [
        NodalMode::new("wide", &mesh, |x| [0.05 * x[0] * x[1], x[0] * (x[1] - 1.5) / 3.0, 0.0]),
        NodalMode::new("tall", &mesh, |x| [0.0, 0.1 * x[0], x[0] * x[2] / 6.0]),
    ];
    let body = body
        .actuate("body", "stiff", Parametrised::new(NeoHooke::new(5e4, 1e5)?))?
        .actuate("body", "swell", KinematicGrowth::isotropic())?
        .shape("body", "wall", modes)?;
    let weight = VaryingLoad::filled("weight", body.body(), "body", Vec3::new(0.0, 0.0, -3e3))?;
    let cable = Tendon::through("cable", [[0.2, 0.4, 0.3], [1.6, 0.7, 0.5], [2.9, 0.3, 1.9]]);
    Ok(body.contribution(weight)?.inertia(Inertia::new("body", 300.0))?.tendon(cable)?)
}

fn everything() -> Outcome<Reduced> {
    let consumers = [
        Consumer::of("stiff.mu").through(PowerLaw { low: 1e3, high: 5e4, exponent: 3.0 }),
        Consumer::of("weight").through(PowerLaw::multiple_of(1.0)),
        Consumer::of("inertia by fill").through(PowerLaw::multiple_of(1.0)),
    ];
    let wider = Target::position(|x| [1.06 * x[0], 1.1 * x[1], x[2] - 0.1]);
    Ok(Reduced::new(cup()?)
        .control("wall.wide", Space::Uniform)?
        .control("wall.tall", Space::Uniform)?
        .control("cavity", Space::Uniform)?
        .control("cable", Space::Uniform)?
        .control("fibre", Space::Uniform)?
        .control("swell", Space::Cell)?
        .design("rho", Space::Cell, &consumers)?
        .cost(Tracking::surface("x+", wider))?
        .cost(LumenVolume::behind("inside", 1.5).weight(0.1))?)
}

fn somewhere(problem: &Reduced) -> Vec<f64> {
    let mut m = vec![0.3, -0.2, 6e3, 800.0, -2e3];
    let rest = problem.layout().len() - m.len();
    m.extend((0..rest).map(|i| if i < rest / 2 { 0.02 * (i as f64).sin() } else { 0.6 + 0.2 * (i as f64).cos() }));
    m
}

/// Of fibres, a chamber, a cable, growth, stiff material and the shape at once, first and second derivatives.
#[test]
fn shape_layout_and_control_have_exact_derivatives_together() -> Outcome {
    let problem = everything()?;
    let m = somewhere(&problem);
    let near = |share: f64| m.iter().map(|m: &f64| m + share * m.abs().max(0.01)).collect::<Vec<f64>>();
    let report = Taylor { directions: 3, second: true, ..Taylor::default() }.test(
        &problem,
        &Bounds::new(near(-0.4), near(0.4))?,
        &m,
    )?;
    assert_eq!(report.verdict(), Verdict::Right, "{report}");
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
    println!("{report}");
    assert!(report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
    assert!(
        report.directions.iter().filter_map(|along| along.second.as_ref()).all(|second| second.order > 2.95),
        "{report}"
    );
    // by the shape alone
    let alone = Reduced::new(cup()?)
        .control("wall.wide", Space::Uniform)?
        .control("wall.tall", Space::Uniform)?
        .cost(LumenVolume::behind("inside", 1.5))?;
    let report = Taylor { second: true, ..Taylor::default() }.test(&alone, &Bounds::new(-0.8, 0.8)?, &[0.2, -0.1])?;
    assert!(report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
    Ok(())
}

/// Volume of the chamber and length of the cable, by the amplitudes.
#[test]
fn volumes_and_lengths_change_with_the_shape_as_differences_do() -> Outcome {
    let problem = everything()?;
    let m = somewhere(&problem);
    let measured = |m: &[f64]| -> Outcome<[f64; 2]> {
        let point = problem.at(m)?;
        let all = problem.solid().model().quantities(&Instant::of(point.state()))?;
        let of = |owner: &str, name: &str| all.iter().find(|own| own.0 == owner && own.1 == name).map(|own| own.2);
        Ok([of("cavity", "volume").ok_or("no volume")?, of("cable", "length").ok_or("no length")?])
    };
    let point = problem.at(&m)?;
    let model = problem.solid().model();
    let gradients = ["cavity", "cable"].map(|name| -> Outcome<Vec<f64>> {
        let block = model.controllable().iter().position(|own| own.name == name).ok_or("no such contribution")?;
        let mut unit: Controls = model.zero_controls();
        unit.values_mut(block)[0] = if name == "cavity" { -1.0 } else { 1.0 };
        let w = model.control_product(&Instant::of(point.state()), &unit)?;
        Ok(problem.displacement_vjp(&point, &w, &mut ReducedWorkspace::default())?)
    });
    for k in 0..2 {
        let step = 1e-4;
        let moved =
            |by: f64| -> Vec<f64> { m.iter().enumerate().map(|(i, m)| if i == k { m + by } else { *m }).collect() };
        let (more, less) = (measured(&moved(step))?, measured(&moved(-step))?);
        for (what, gradient) in gradients.iter().enumerate() {
            let (stated, slope) =
                (gradient.as_ref().map_err(ToString::to_string)?[k], (more[what] - less[what]) / (2.0 * step));
            println!("{what} by {k}: {stated} {slope}");
            assert!((stated / slope - 1.0).abs() < 1e-6, "{what} by {k}: {stated} {slope}");
        }
    }
    Ok(())
}

/// A cantilever in plane strain under an end force, whose thickness is an unknown.
fn cantilever(t: f64, cells: [usize; 2], growth: bool) -> Outcome<Solid> {
    let mesh = rectangle([1.0, t], cells, CellKind::Quad8)?;
    let mode = NodalMode::new("thickness", &mesh, |x| [0.0, x[1] / t - 0.5, 0.0]);
    let middle = mesh.points().iter().position(|x| x[0] == 0.0 && (x[1] - 0.5 * t).abs() < 1e-9).ok_or("no middle")?;
    let body = Solid::new(mesh)?.material("body", NeoHooke::from_young_poisson(1e6, 0.3)?)?;
    let body = if growth { body.actuate("body", "swell", KinematicGrowth::isotropic())? } else { body };
    Ok(body
        .shape("body", "beam", [mode])?
        .displace("x-", [Some(0.0), None, None])?
        .displace_nodes("middle", &[middle as u32], |_, _| [None, Some(0.0), None])?
        // one force whatever the thickness
        .traction("x+", Vec3::new(0.0, -0.01 / t, 0.0))?)
}

#[test]
fn the_tip_of_a_cantilever_rises_by_three_deflections_over_its_thickness() -> Outcome {
    let t = 0.05;
    let problem = Reduced::new(cantilever(t, [40, 2], false)?)
        .control("beam.thickness", Space::Uniform)?
        .cost(MeanDisplacement::point([1.0, 0.5 * t, 0.0], [0.0, 1.0, 0.0]))?;
    let mut point = problem.evaluate(
        &[0.0],
        &nastic_opt::Request { accuracy: 1e-9, ..Default::default() },
        &mut Default::default(),
    )?;
    let slope = problem.derivative(&mut point, &mut Default::default())?[0];
    let tip = point.cost();
    println!("tip {tip}, slope {slope}, expected {}", -3.0 * tip / t);
    assert!((slope / (-3.0 * tip / t) - 1.0).abs() < 0.01, "{slope} {tip}");
    Ok(())
}

/// Bodies that are drawn of another thickness, on other meshes, end at one.
#[test]
fn two_drawn_bodies_have_one_optimum() -> Outcome {
    let best = |t: f64, cells: [usize; 2]| -> Outcome<f64> {
        let problem = Reduced::new(cantilever(t, cells, false)?)
            .control("beam.thickness", Space::Uniform)?
            .cost(MeanPosition::point([1.0, 0.5 * t, 0.0], [None, Some(0.5 * t - 0.002), None]))?;
        let found = Lbfgs::default().within(Bounds::new(-0.8 * t, 2.0 * t)?).minimize(&problem, 0.0)?;
        assert!(found.cost < 1e-14, "{}", found.cost);
        Ok(t + found.m[0])
    };
    let thicknesses = [best(0.05, [40, 2])?, best(0.07, [24, 4])?];
    println!("{thicknesses:?}");
    assert!((thicknesses[0] / thicknesses[1] - 1.0).abs() < 2e-3, "{thicknesses:?}");
    Ok(())
}

/// A motion under fibres that pull in time, whose mass follows the shape.
#[test]
fn a_motion_has_exact_derivatives_by_the_shape() -> Outcome {
    let body = |scheme: Scheme, rest: bool| -> Outcome<Reduced> {
        let mesh = box_mesh([0.5, 0.05, 0.05], [4, 1, 1], CellKind::Hex8)?;
        let mode = NodalMode::new("thick", &mesh, |x| [0.0, 0.0, x[0] * (x[2] - 0.025) * 40.0]);
        let body = Solid::new(mesh)?
            .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
            .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
            .shape("body", "arm", [mode])?
            .clamp("x-")?;
        let weight = VaryingLoad::filled("weight", body.body(), "body", Vec3::new(0.0, 0.0, -9.81 * 1000.0))?;
        let body = body.contribution(weight)?.inertia(Inertia::new("body", 1000.0))?;
        let timeline = Timeline::uniform(scheme, 0.2, 8)?;
        let raised = Target::position(|x| [x[0], x[1], x[2] + 0.05]);
        Ok(Reduced::new(body)
            .in_time(if rest { timeline.from_rest() } else { timeline })?
            .control("arm.thick", Space::Uniform)?
            .control_in_time("fibre", Space::Uniform, Knots::every(0.1, 0.2, Interpolation::Linear)?)?
            .cost(Tracking::surface("x+", raised))?)
    };
    for scheme in [Scheme::backward_euler(), Scheme::trapezoidal()] {
        let problem = body(scheme, false)?;
        let m = [0.01, 0.0, -3e3, 2e3];
        let set = Bounds::new(vec![-0.02, -1e4, -1e4, -1e4], vec![0.03, 1e4, 1e4, 1e4])?;
        let report = Taylor { directions: 2, ..Taylor::default() }.test(&problem, &set, &m)?;
        assert!(report.passed() && report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
    }
    let refused = body(Scheme::trapezoidal(), true).map(drop).unwrap_err().to_string();
    assert!(refused.contains("begin at the equilibrium"), "{refused}");
    Ok(())
}
