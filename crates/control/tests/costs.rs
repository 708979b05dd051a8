//! The contract of costs, over every row of the catalogue.

use nastic_control::{
    COSTS, Cost, CostContext, CostExample, MOTION_COSTS, Output, OutputTarget, Partials, Reduced, Space,
};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Contact, Solid, State};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Objective, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Two bodies below a ceiling that they touch, their control not yet among their costs.
fn bodies() -> Outcome<Vec<Reduced>> {
    let body = |kind: CellKind, n: usize| -> Outcome<Reduced> {
        let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [4 * n, n, n], kind)?)?
            .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?
            .contact(
                Contact::of("ceiling", "z+", Obstacle::half_space([0.0, 0.0, 0.23], [0.0, 0.0, -1.0]))
                    .thickness(0.05)
                    .stiffness(3e3),
            )?;
        Ok(Reduced::new(solid).control("tension", Space::Cell)?)
    };
    Ok(vec![body(CellKind::Hex8, 2)?, body(CellKind::Tet10, 1)?])
}

/// Every example of every row on every body, with this weight.
fn each(weight: f64, mut check: impl FnMut(&Reduced, &dyn Cost, &str) -> Outcome) -> Outcome {
    for body in bodies()? {
        for row in COSTS {
            let on = CostExample { solid: body.solid(), control: "tension", weight };
            // slip is of motions, crates/run/tests/contact_costs.rs; shrinkage of bodies whose shape changes, free_shape.rs
            let elsewhere = ["contact_slip", "shape_shrinkage"].contains(&row.name);
            assert!(elsewhere || !(row.examples)(&on)?.is_empty(), "{}", row.name);
            for (k, cost) in (row.examples)(&on)?.iter().enumerate() {
                assert_eq!(cost.name(), row.name);
                assert!(cost.stages() >= 1, "{}", row.name);
                check(&body, cost.as_ref(), &format!("{} {k} on {} cells", row.name, body.solid().mesh().cells()))?;
            }
        }
    }
    Ok(())
}

/// Repeatable numbers within -1 and 1.
fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| ((i as f64 + seed) * 12.9898).sin()).collect()
}

/// A displacement of a few hundredths and a control that varies.
fn point(body: &Reduced) -> (Vec<f64>, Vec<f64>) {
    let mesh = body.solid().mesh();
    let smooth = |x: &[f64; 3]| [0.03 * x[0] * x[1], 0.05 * x[0] * x[0], -0.04 * x[0] * x[2] + 0.02 * x[0]];
    let mut u: Vec<f64> = mesh.points().iter().flat_map(smooth).collect();
    let rough = noise(u.len(), 0.3);
    u.iter_mut().zip(rough).for_each(|(u, r)| *u += 2e-3 * r);
    let m = noise(body.layout().len(), 1.7).iter().map(|r| -1e5 * (1.0 + 0.5 * r)).collect();
    (u, m)
}

/// As if u were the equilibrium.
fn state(body: &Reduced, u: &[f64], m: &[f64]) -> Outcome<State> {
    let (u, controls) = (u.to_vec().into(), body.layout().to_points(m)?.into());
    Ok(State { u, controls, load: 1.0, ..body.solid().rest() })
}

fn value(body: &Reduced, cost: &dyn Cost, u: &[f64], m: &[f64], stage: usize) -> Outcome<f64> {
    let state = state(body, u, m)?;
    let context =
        CostContext { solid: body.solid(), layout: body.layout(), u, state: Some(&state), m, stage, step: None };
    Ok(cost.at(&context)?.value())
}

fn value_and_partials(body: &Reduced, cost: &dyn Cost, u: &[f64], m: &[f64], stage: usize) -> Outcome<(f64, Partials)> {
    let state = state(body, u, m)?;
    let context =
        CostContext { solid: body.solid(), layout: body.layout(), u, state: Some(&state), m, stage, step: None };
    let at = cost.at(&context)?;
    let mut partials = Partials { u: vec![0.0; u.len()], m: vec![0.0; m.len()] };
    at.add_partials(&mut partials)?;
    Ok((at.value(), partials))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn values_and_partials_are_deterministic() -> Outcome {
    each(1.0, |body, cost, what| {
        let (u, m) = point(body);
        for stage in 0..cost.stages() {
            let (value, partials) = value_and_partials(body, cost, &u, &m, stage)?;
            // means of a field may be negative
            assert!(value.is_finite() && value != 0.0, "{what}: {value}");
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
            let alone = pool.install(|| value_and_partials(body, cost, &u, &m, stage).map_err(|e| e.to_string()))?;
            assert_eq!(alone.0.to_bits(), value.to_bits(), "{what}");
            assert_eq!(alone.1, partials, "{what}");
        }
        // A cost with fewer stages than others stays at its last.
        let last = value(body, cost, &u, &m, cost.stages() - 1)?;
        for beyond in cost.stages()..cost.stages() + 3 {
            assert_eq!(value(body, cost, &u, &m, beyond)?.to_bits(), last.to_bits(), "{what}");
        }
        Ok(())
    })
}

#[test]
fn partials_are_differences_of_values() -> Outcome {
    each(1.0, |body, cost, what| {
        let (u, m) = point(body);
        for stage in 0..cost.stages() {
            let (at, partials) = value_and_partials(body, cost, &u, &m, stage)?;
            let (du, dm) = (noise(u.len(), 5.1), noise(m.len(), 8.2));
            for (name, slope, by_u, by_m) in
                [("u", dot(&partials.u, &du), 1e-4, 0.0), ("m", dot(&partials.m, &dm), 0.0, 1e3)]
            {
                let moved = |t: f64| -> Outcome<f64> {
                    let u: Vec<f64> = u.iter().zip(&du).map(|(u, d)| u + t * by_u * d).collect();
                    let m: Vec<f64> = m.iter().zip(&dm).map(|(m, d)| m + t * by_m * d).collect();
                    value(body, cost, &u, &m, stage)
                };
                let central = |t: f64| -> Outcome<f64> { Ok((moved(t)? - moved(-t)?) / (2.0 * t * (by_u + by_m))) };
                let difference = (4.0 * central(0.5)? - central(1.0)?) / 3.0;
                let rounding = 1e-14 * at.abs() / (by_u + by_m);
                assert!(
                    (slope - difference).abs() < 1e-7 * slope.abs() + 8.0 * rounding,
                    "{what}, stage {stage}, d{name}: {slope:e} where differences say {difference:e}"
                );
            }
        }
        Ok(())
    })
}

/// Along changes of u and of m, and symmetric.
#[test]
fn second_partials_are_differences_of_partials() -> Outcome {
    each(3.0, |body, cost, what| {
        let (u, m) = point(body);
        if COSTS.iter().any(|row| row.name == cost.name() && !row.second) {
            let state = state(body, &u, &m)?;
            let context = CostContext {
                solid: body.solid(),
                layout: body.layout(),
                u: &u,
                state: Some(&state),
                m: &m,
                stage: 0,
                step: None,
            };
            let zero = Partials::zero(u.len(), m.len());
            let refused = cost.at(&context)?.add_second_partials(&zero, &mut zero.clone());
            assert!(refused.is_err_and(|error| error.to_string().contains("second")), "{what}");
            return Ok(());
        }
        for stage in 0..cost.stages() {
            let state = state(body, &u, &m)?;
            let context = CostContext {
                solid: body.solid(),
                layout: body.layout(),
                u: &u,
                state: Some(&state),
                m: &m,
                stage,
                step: None,
            };
            let at = cost.at(&context)?;
            let change = |seed: f64| Partials {
                u: noise(u.len(), seed).iter().map(|r| 1e-3 * r).collect(),
                m: noise(m.len(), seed + 3.1).iter().map(|r| 1e4 * r).collect(),
            };
            let second = |along: &Partials| -> Outcome<Partials> {
                let mut out = Partials::zero(u.len(), m.len());
                at.add_second_partials(along, &mut out)?;
                // what others have added stays
                let mut more = Partials { u: vec![2.0; u.len()], m: vec![2.0; m.len()] };
                at.add_second_partials(along, &mut more)?;
                for (more, d) in more.u.iter().chain(&more.m).zip(out.u.iter().chain(&out.m)) {
                    assert!((more - 2.0 - d).abs() <= 1e-13 * (2.0 + d.abs()), "{what}: {more:e}, {d:e}");
                }
                Ok(out)
            };
            let (a, b) = (change(0.4), change(2.2));
            let (of_a, of_b) = (second(&a)?, second(&b)?);
            let pair = |x: &Partials, y: &Partials| dot(&x.u, &y.u) + dot(&x.m, &y.m);
            let (left, right) = (pair(&of_a, &b), pair(&of_b, &a));
            let size = left.abs().max((pair(&of_a, &a) * pair(&of_b, &b)).abs().sqrt());
            assert!((left - right).abs() < 1e-11 * size + 1e-15, "{what}, stage {stage}: {left:e} and {right:e}");
            let moved = |t: f64| -> Outcome<Partials> {
                let u: Vec<f64> = u.iter().zip(&a.u).map(|(u, d)| u + t * d).collect();
                let m: Vec<f64> = m.iter().zip(&a.m).map(|(m, d)| m + t * d).collect();
                Ok(value_and_partials(body, cost, &u, &m, stage)?.1)
            };
            let h = 0.05;
            let all =
                [h, -h, 2.0 * h, -2.0 * h, 3.0 * h, -3.0 * h].map(moved).into_iter().collect::<Outcome<Vec<_>>>()?;
            for (name, found, of) in [("u", &of_a.u, 0), ("m", &of_a.m, 1)] {
                let entry = |k: usize, i: usize| if of == 0 { all[k].u[i] } else { all[k].m[i] };
                let slope = |i: usize| {
                    let pair = |k: usize| entry(2 * k, i) - entry(2 * k + 1, i);
                    (45.0 * pair(0) - 9.0 * pair(1) + pair(2)) / (60.0 * h)
                };
                let largest = (0..found.len()).map(|i| slope(i).abs()).fold(0.0, f64::max);
                let rounding = 1e-13 * (0..found.len()).map(|i| entry(0, i).abs()).fold(0.0, f64::max) / h;
                for (i, found) in found.iter().enumerate() {
                    let error = (found - slope(i)).abs();
                    assert!(
                        error <= 1e-7 * largest + rounding,
                        "{what}, stage {stage}, d{name}: {found:e} and {:e}",
                        slope(i)
                    );
                }
            }
        }
        Ok(())
    })
}

#[test]
fn weights_scale_values_and_partials() -> Outcome {
    let evaluated = |weight: f64| -> Outcome<Vec<(String, f64, Partials)>> {
        let mut all = Vec::new();
        each(weight, |body, cost, what| {
            let (u, m) = point(body);
            let (value, partials) = value_and_partials(body, cost, &u, &m, 0)?;
            all.push((what.to_owned(), value, partials));
            Ok(())
        })?;
        Ok(all)
    };
    for ((what, one, of_one), (_, four, of_four)) in evaluated(1.0)?.iter().zip(evaluated(4.0)?) {
        // Powers of two leave the bits alone.
        assert_eq!(4.0 * one, four, "{what}");
        for (one, four) in of_one.u.iter().zip(&of_four.u).chain(of_one.m.iter().zip(&of_four.m)) {
            assert!((4.0 * one - four).abs() <= 1e-12 * four.abs(), "{what}: {one:e} {four:e}");
        }
    }
    Ok(())
}

#[test]
fn figures_are_finite_and_distinct() -> Outcome {
    each(1.0, |body, cost, what| {
        let (u, m) = point(body);
        for stage in 0..cost.stages() {
            let state = state(body, &u, &m)?;
            let context = CostContext {
                solid: body.solid(),
                layout: body.layout(),
                u: &u,
                state: Some(&state),
                m: &m,
                stage,
                step: None,
            };
            let figures = cost.at(&context)?.figures()?;
            for (k, figure) in figures.iter().enumerate() {
                assert!(figure.value.is_finite(), "{what}: {figure:?}");
                assert!(figures[..k].iter().all(|other| other.kind != figure.kind), "{what}: {figure:?} twice");
            }
        }
        assert!(cost.warnings(body.solid()).iter().all(|text| !text.is_empty()), "{what}");
        Ok(())
    })
}

/// Through a full solve: the order of the Taylor remainder is above 1.95.
#[test]
fn taylor_orders_through_a_solve() -> Outcome {
    for k in 0..bodies()?.len() {
        for row in COSTS {
            for example in 0.. {
                let body = bodies()?.swap_remove(k);
                let on = CostExample { solid: body.solid(), control: "tension", weight: 1.0 };
                let Some(cost) = (row.examples)(&on)?.into_iter().nth(example) else { break };
                let problem = body.cost(cost)?;
                problem.check()?;
                let m: Vec<f64> = noise(problem.layout().len(), 0.9).iter().map(|r| -4e4 - 2e4 * r).collect();
                for stage in 0..problem.stages() {
                    let test = Taylor { stage, order: 1.95, ..Taylor::default() };
                    let report = test.test(&problem, &Bounds::new(-4e5, 1.9e5)?, &m)?;
                    let right = report.directions.iter().all(|d| matches!(d.verdict, Verdict::Right | Verdict::Linear));
                    assert!(right, "{} {example}, body {k}, stage {stage}: {report}", row.name);
                }
            }
        }
    }
    Ok(())
}

/// Squares say that they are, so that no case asks for a zero of one, where no multiplier can hold it.
#[test]
fn squares_are_marked() {
    for form in COSTS.iter().filter_map(|row| row.form).chain(MOTION_COSTS.iter().copied()) {
        assert_eq!(form.is_square, form.about.contains("weight/2"), "{}: {}", form.name, form.about);
    }
}

/// Costs that have outputs.
const WITH_OUTPUTS: [&str; 9] = [
    "position",
    "markers",
    "displacement",
    "orientation",
    "curvature",
    "mean_radius",
    "volume",
    "reaction",
    "contact_force",
];

/// A cost is what it says of its outputs: half the weighted squares of their deviations, or one of them; and their derivatives are differences.
#[test]
fn outputs_make_up_their_cost_and_have_exact_partials() -> Outcome {
    let mut seen = std::collections::BTreeSet::new();
    each(3.0, |body, cost, what| {
        let (u, m) = point(body);
        let zero = Partials::zero(u.len(), m.len());
        let outputs = |u: &[f64], m: &[f64]| -> Outcome<Vec<Output>> {
            let state = state(body, u, m)?;
            let (solid, layout) = (body.solid(), body.layout());
            let context = CostContext { solid, layout, u, state: Some(&state), m, stage: 0, step: None };
            Ok(cost.at(&context)?.outputs(&zero)?)
        };
        let found = outputs(&u, &m)?;
        assert!(!found.is_empty() || !WITH_OUTPUTS.contains(&cost.name()), "{what}");
        if found.is_empty() {
            return Ok(());
        }
        seen.insert(cost.name().to_owned());
        let (value, partials) = value_and_partials(body, cost, &u, &m, 0)?;
        let (mut sum, mut slopes) = (0.0, zero.clone());
        for output in &found {
            let (term, slope) = match output.target {
                Some(OutputTarget { value, weight }) => {
                    (0.5 * weight * (output.value - value).powi(2), weight * (output.value - value))
                }
                None => (3.0 * output.value, 3.0),
            };
            sum += term;
            slopes.u.iter_mut().zip(&output.partials.u).for_each(|(all, own)| *all += slope * own);
            slopes.m.iter_mut().zip(&output.partials.m).for_each(|(all, own)| *all += slope * own);
        }
        // normals differ among themselves, and angles are no sines
        let share = if cost.name() == "orientation" { 0.1 } else { 1e-9 };
        let size = dot(&partials.u, &partials.u) + dot(&partials.m, &partials.m);
        let off: f64 = slopes
            .u
            .iter()
            .zip(&partials.u)
            .chain(slopes.m.iter().zip(&partials.m))
            .map(|(a, b)| (a - b).powi(2))
            .sum();
        assert!(
            cost.name() == "orientation" || (sum - value).abs() <= share * value.abs(),
            "{what}: {sum} and {value}"
        );
        assert!(cost.name() == "orientation" || off <= share * share * size, "{what}: {off:e} of {size:e}");
        let (du, dm) = (noise(u.len(), 5.1), noise(m.len(), 8.2));
        for (name, by_u, by_m) in [("u", 1e-4, 0.0), ("m", 0.0, 1e3)] {
            let moved = |t: f64| {
                let u: Vec<f64> = u.iter().zip(&du).map(|(u, d)| u + t * by_u * d).collect();
                let m: Vec<f64> = m.iter().zip(&dm).map(|(m, d)| m + t * by_m * d).collect();
                outputs(&u, &m)
            };
            let all = [0.5, -0.5, 1.0, -1.0].map(moved).into_iter().collect::<Outcome<Vec<_>>>()?;
            for (k, output) in found.iter().enumerate() {
                let central = |i: usize, t: f64| (all[i][k].value - all[i + 1][k].value) / (2.0 * t * (by_u + by_m));
                let difference = (4.0 * central(0, 0.5) - central(2, 1.0)) / 3.0;
                let slope = if name == "u" { dot(&output.partials.u, &du) } else { dot(&output.partials.m, &dm) };
                let rounding = 1e-14 * output.value.abs().max(1.0) / (by_u + by_m);
                assert!(
                    (slope - difference).abs() < 1e-7 * slope.abs() + 8.0 * rounding,
                    "{what}, {}, d{name}: {slope:e} where differences say {difference:e}",
                    output.name
                );
            }
        }
        Ok(())
    })?;
    assert!(WITH_OUTPUTS.iter().all(|name| seen.contains(*name)), "{seen:?}");
    Ok(())
}
