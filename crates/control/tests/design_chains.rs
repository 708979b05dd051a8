//! Fields with a chain of their own, once for several consumers; growth as an unknown.

use crate::designs::{Outcome, assert_orders, assert_orders_within, hollow, mesh, target, weight};
use nastic_control::{
    Consumer, ControlError, ControlMap, Direction, Filter, PowerLaw, Projection, Reduced, Space, Target, Tracking,
};
use nastic_energy::{
    EnergyError, FiberTension, KinematicGrowth, MaxwellBranch, MooneyRivlin, NeoHooke, Parametrised, Scale, Turgor,
    Weighted,
};
use nastic_fem::{Cavity, Formulation, Solid, SolveOptions, VaryingLoad};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::Bounds;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// Growth by cell beside a fibre tension by cell, a modulus by region, a chamber and a viscous branch at rest, with two formulations.
#[test]
fn growth_is_an_unknown_beside_a_tension_a_modulus_and_a_chamber() -> Outcome {
    let law = || Ok::<_, EnergyError>(Parametrised::new(MooneyRivlin::new(5e4, 2e4, 3e5)?));
    for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
        let body = Solid::new(hollow()?)?
            .actuate(["root", "arm"], "rubber", law()?)?
            .actuate("body", "fiber", FiberTension::along(Vec3::x())?)?
            .actuate("arm", "swell", KinematicGrowth::across(Vec3::new(0.6, 0.0, 0.8))?)?
            .viscosity("arm", MaxwellBranch::new(2e4, 0.03)?)?
            .formulation("body", formulation)?
            .cavity(Cavity::new("air", "inner"))?;
        let aim = Tracking::surface("x+", Target::position(|x| [1.06 * x[0], x[1] + 0.05, x[2] + 0.02 * x[1]]));
        let problem = Reduced::new(body.clamp("x-")?.body_force("body", Vec3::new(0.0, 0.0, -2e4))?)
            .control("swell", Space::Cell)?
            .control("rubber.mu1", Space::Region)?
            .control("fiber", Space::Cell)?
            .control("air", Space::Uniform)?
            .cost(aim)?;
        let (grown, cells) = (problem.layout().block("swell")?.len(), problem.layout().block("fiber")?.len());
        let mut m: Vec<f64> = (0..grown).map(|k| 0.15 + 0.1 * (k as f64).sin()).collect();
        m.extend([4e4, 6e4]);
        m.extend((0..cells).map(|k| -2e4 * (1.0 + 0.3 * (k as f64).sin())));
        m.push(8e3);
        let range = |m: f64| if m.abs() < 1.0 { 0.1 } else { 0.3 * m.abs() };
        let at = |side: f64| m.iter().map(|m| m + side * range(*m)).collect::<Vec<_>>();
        assert_orders_within(&problem, &Bounds::new(at(-1.0), at(1.0))?, &m, &format!("growth, {formulation}"))?;
    }
    Ok(())
}

/// A density, filtered and projected once for all, is what a modulus, a tension and a growth follow from.
#[test]
fn a_field_is_filtered_and_projected_once_for_all_its_consumers() -> Outcome {
    let body = Solid::new(mesh()?)?
        .actuate("body", "law", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?
        .actuate("body", "fiber", FiberTension::along(Vec3::x())?)?
        .actuate("body", "swell", KinematicGrowth::along(Vec3::x())?)?
        .formulation("body", Formulation::MeanDilatation)?;
    let consumers = [
        Consumer::of("law.mu").through(PowerLaw { low: 1e4, high: 1.2e5, exponent: 3.0 }),
        Consumer::of("fiber").through(PowerLaw::multiple_of(-2e4)),
        Consumer::of("swell").through(PowerLaw::multiple_of(0.2)),
    ];
    for space in [Space::Cell, Space::Node, Space::Grid([2, 1, 1])] {
        let projection = Projection { threshold: 0.5, sharpness: 2.0 };
        let problem = Reduced::new(weight(body.clone())?)
            .design("rho", space, &consumers)?
            .filter("rho", 0.15)?
            .through("rho", projection)?
            .cost(target())?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| 0.6 + 0.25 * (1.7 * i as f64).sin()).collect();
        let block = problem.layout().block("rho")?;
        let seen = block.values_of(&m);
        let filter = Filter::new(problem.solid().discretization(), &block.basis, 1, 0.15)?;
        assert_eq!(seen, projection.values(&filter.values(&m)));
        let controls = problem.layout().to_points(&m)?;
        let rho = block.basis.values(&seen, 1);
        assert_eq!(block.values_at_points(&m), rho);
        for (q, rho) in rho.iter().enumerate() {
            assert!((controls.values(0)[2 * q] - (1e4 + 1.1e5 * rho.powi(3))).abs() < 1e-9);
            assert!(
                (controls.values(1)[q] + 2e4 * rho).abs() < 1e-9 && (controls.values(2)[q] - 0.2 * rho).abs() < 1e-15
            );
        }
        assert_orders(&problem, &m, &format!("filtered rho {}", space.name()))?;
    }
    let body = weight(body)?;
    let problem = || Reduced::new(body.clone()).design("rho", Space::Cell, &consumers);
    let refused = problem()?.through("rho", Direction([1.0, 0.0, 0.0])).unwrap_err();
    assert!(matches!(refused, ControlError::FieldMap { found: 12, expected: 4, .. }), "{refused}");
    assert!(problem()?.filter("rho", 0.0).is_err());
    Ok(())
}

/// Stiffness and weight follow one density: a bar of half the density weighs half.
#[test]
fn weight_follows_the_density_that_stiffness_follows() -> Outcome {
    let force = Vec3::new(0.0, 0.0, -2e4);
    let base = || -> Outcome<Solid> {
        let body = Solid::new(mesh()?)?.actuate(["root", "arm"], "law", Parametrised::new(NeoHooke::new(1e5, 4e5)?))?;
        Ok(body.clamp("x-")?)
    };
    let body = base()?;
    let weight = VaryingLoad::filled("weight", body.body(), ["root", "arm"], force)?;
    let body = body.contribution(weight)?;
    let consumers = [
        Consumer::of("law.mu").through(PowerLaw { low: 1e4, high: 1.2e5, exponent: 3.0 }),
        Consumer::of("weight").through(PowerLaw::multiple_of(1.0)),
    ];
    for space in [Space::Uniform, Space::Region, Space::Cell, Space::Grid([2, 1, 1])] {
        let problem = Reduced::new(body.clone()).design("rho", space, &consumers)?.cost(target())?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| 0.6 + 0.25 * (1.7 * i as f64).sin()).collect();
        assert_orders(&problem, &m, &format!("rho {}", space.name()))?;
    }
    let halved = Reduced::new(body).design("rho", Space::Uniform, &consumers[1..])?.cost(target())?.at(&[0.5])?;
    let plain = base()?.body_force("body", 0.5 * force)?;
    let expected = plain.solve(&plain.controls(), &SolveOptions::default())?;
    let apart = halved.state().u.iter().zip(expected.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
    Ok(())
}

/// A filtered and projected density of a law (SIMP), and a filler of another material, beside a fibre tension and a chamber; the fibres follow the density.
#[test]
fn densities_and_fillers_are_unknowns_beside_a_tension_and_a_chamber() -> Outcome {
    let rubber = Arc::new(MooneyRivlin::new(5e4, 2e4, 3e5)?);
    let simp = Scale::Simp { floor: 1e-3, exponent: 3.0 };
    let mixed = Weighted::mixture("share", rubber.clone(), Arc::new(NeoHooke::new(4e5, 1e6)?))?;
    let fibers = Weighted::scaled(
        "density",
        Arc::new(FiberTension::along(Vec3::x())?),
        Scale::Ramp { floor: 1e-3, penalty: 2.0 },
    )?;
    let body = Solid::new(hollow()?)?
        .actuate("arm", "stiff", Weighted::scaled("density", rubber, simp)?)?
        .actuate("root", "mixed", Weighted::scaled("filler", Arc::new(mixed), Scale::Guth)?)?
        .actuate("arm", "fiber", fibers)?
        .cavity(Cavity::new("air", "inner"))?;
    let consumers = ["stiff.density", "fiber.density"].map(|of| Consumer::of(of).through(PowerLaw::multiple_of(1.0)));
    let problem = Reduced::new(weight(body)?)
        .design("rho", Space::Cell, &consumers)?
        .filter("rho", 0.3)?
        .through("rho", Projection { threshold: 0.5, sharpness: 2.0 })?
        .control("mixed.share", Space::Cell)?
        .control("mixed.filler", Space::Uniform)?
        .control("fiber.tension", Space::Uniform)?
        .control("air", Space::Uniform)?
        .cost(target())?;
    let count = |name: &str| problem.layout().block(name).map(nastic_control::ControlBlock::len);
    let wave = |len: usize, mean: f64| (0..len).map(move |i| mean * (1.0 + 0.3 * (1.7 * i as f64).sin()));
    let m: Vec<f64> =
        wave(count("rho")?, 0.6).chain(wave(count("mixed.share")?, 0.3)).chain([0.1, -2e4, 4e3]).collect();
    let range = |m: f64| 0.3 * m.abs();
    let at = |side: f64| m.iter().map(|m| m + side * range(*m)).collect::<Vec<_>>();
    assert_orders_within(&problem, &Bounds::new(at(-1.0), at(1.0))?, &m, "density, filler, share")
}

/// Constants and the integral stay; a step becomes `exp(-|x|/R)/2`.
#[test]
fn a_filter_keeps_the_integral_and_smooths_a_step() -> Outcome {
    let body = Solid::new(box_mesh([2.0, 0.1, 0.1], [400, 1, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::new(1e5, 4e5)?)?
        .actuate("body", "turgor", Turgor::new())?;
    let length = 0.05;
    for space in [Space::Cell, Space::Node, Space::Grid([400, 1, 1])] {
        let problem = Reduced::new(body.clone()).control("turgor", space)?;
        let (block, disc) = (problem.layout().block("turgor")?, problem.solid().discretization());
        let filter = Filter::new(disc, &block.basis, 1, length)?;
        let ones = vec![1.0; block.len()];
        assert!(filter.values(&ones).iter().all(|s| (s - 1.0).abs() < 1e-12));
        let step: Vec<f64> =
            block.basis.positions().iter().map(|x| if x[0] < 1.0 - 1e-9 { 0.0 } else { 1.0 }).collect();
        let smooth = filter.values(&step);
        let integral = |m: &[f64]| {
            let values = block.basis.values(m, 1);
            values.iter().zip(disc.points().weights()).map(|(value, w)| value * w).sum::<f64>()
        };
        assert!((integral(&smooth) / integral(&step) - 1.0).abs() < 1e-12, "{}", space.name());
        // half a spacing of the nodes is where their step lies
        let middle = if space == Space::Cell { 1.0 } else { 1.0 - 0.0025 };
        for (x, s) in block.basis.positions().iter().zip(&smooth) {
            let d = x[0] - middle;
            let exact = if d < 0.0 { 0.5 * (d / length).exp() } else { 1.0 - 0.5 * (-d / length).exp() };
            assert!((s - exact).abs() < 2e-3, "{}: {s} for {exact} at {d}", space.name());
        }
    }
    Ok(())
}
