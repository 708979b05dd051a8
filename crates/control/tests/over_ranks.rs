//! Reduced problems of one body over ranks, which are threads here: controls, costs and derivatives of one process.

use crate::ranks::{Outcome, apart, bar, on, part, valued};
use nastic_control::{
    Compliance, Consumer, ControlError, ControlNorm, ControlSmoothness, Cost, CostContext, CostPoint, DesignMean,
    LumenVolume, MeanDisplacement, MeanPosition, Metric, Plane, PowerLaw, Projection, Reaction, Reduced,
    ReducedWorkspace, Space, Target, Timeline, Tracking,
};
use nastic_energy::{EnergyTerm, FiberTension, Magnet, MooneyRivlin, NeoHooke, Scale, Turgor, Weighted};
use nastic_fem::{FemError, MovingSupport, Scheme, Solid, Spring};
use nastic_mesh::{CellKind, Snapshot, box_mesh};
use nastic_opt::{InnerProduct, Problem, Request};
use nastic_team::Team;
use nastic_tensor::Vec3;
use std::sync::Arc;

const SPACES: [Space; 6] =
    [Space::Uniform, Space::Region, Space::Cell, Space::Point, Space::Node, Space::Grid([4, 2, 1])];

/// Fibres along the bar, turgor in its far half, magnets in the near one.
fn body(solid: Solid) -> Outcome<Solid> {
    Ok(solid
        .material("near", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .material("far", NeoHooke::new(1e5, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .actuate("far", "turgor", Turgor::new())?
        .actuate("near", "magnet", Magnet::new())?
        .clamp("x-")?)
}

fn tracked(solid: Solid, space: Space) -> Outcome<Reduced> {
    let bent = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.2 * x[0] * x[0]]);
    Ok(Reduced::new(body(solid)?)
        .control("tension", space)?
        .control("turgor", space)?
        .cost(Tracking::surface(["x+", "z-"], bent.clone()).weight(3.0))?
        .cost(Tracking::region("far", bent.clone()))?
        .cost(Tracking::nodes("y+", bent).weight(1e-3))?
        .cost(MeanPosition::surface("x+", [Some(0.9), None, Some(0.3)]).weight(0.1))?
        .cost(MeanPosition::point([0.91, 0.11, 0.13], [None, Some(0.1), Some(0.2)]).weight(0.1))?)
}

/// An uneven control, the same whatever the numbers of the places.
fn control(problem: &Reduced) -> Vec<f64> {
    let of = |x: &[f64; 3], sign: f64| sign * 2e4 * (1.0 + x[2] / 0.2 + (5.0 * x[0]).sin() * 0.5);
    let blocks = problem.layout().blocks().iter().zip([-1.0, 0.3]);
    blocks.flat_map(|(block, sign)| block.basis.positions().iter().map(move |x| of(x, sign))).collect()
}

#[test]
fn controls_are_those_of_one_process_whatever_they_vary_over() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    for space in SPACES {
        let serial = tracked(Solid::new(mesh.clone())?, space)?;
        for (ranks, scattered) in [(1, false), (2, false), (3, true), (5, false)] {
            let found = on(ranks, |rank| {
                let problem = tracked(part(&mesh, &rank, scattered)?, space)?;
                let of = |problem: &Reduced| -> Vec<_> {
                    let blocks = problem.layout().blocks().iter();
                    blocks.map(|block| (block.first, block.basis.entities().to_vec())).collect()
                };
                let places = |problem: &Reduced| -> Vec<f64> {
                    let blocks = problem.layout().blocks().iter();
                    blocks.flat_map(|block| block.basis.positions().as_flattened().to_vec()).collect()
                };
                assert_eq!(of(&problem), of(&serial), "{space:?}");
                Ok((apart(&places(&problem), &places(&serial)), places(&problem)))
            });
            for of_rank in &found {
                assert!(of_rank.clone()?.0 < 1e-12, "{space:?}: {of_rank:?}");
                assert_eq!(*of_rank, found[0], "{space:?}: all ranks have the same places");
            }
        }
    }
    Ok(())
}

/// Cost and derivative over ranks beside those of one process, and whether all ranks have the same bits.
fn assert_agrees(name: &str, make: impl Fn(Solid) -> Outcome<Reduced> + Sync, kind: CellKind) -> Outcome {
    let mesh = bar(kind, 2)?;
    let serial = make(Solid::new(mesh.clone())?)?;
    let m = control(&serial);
    let (cost, derivative) = valued(&serial, &m)?;
    for (ranks, scattered) in [(1, false), (2, false), (3, true), (5, false)] {
        let found = on(ranks, |rank| valued(&make(part(&mesh, &rank, scattered)?)?, &m));
        let (own, own_derivative) = found[0].clone()?;
        assert!(found.iter().all(|other| *other == found[0]), "{name} on {ranks}: not the same bits");
        assert!((own - cost).abs() < 1e-9 * cost.abs(), "{name} on {ranks}: {own:e} {cost:e}");
        let off = apart(&own_derivative, &derivative);
        assert!(off < 1e-8, "{name} on {ranks}: the derivative is off by {off:e}");
    }
    Ok(())
}

#[test]
fn tracking_costs_and_their_derivatives_are_those_of_one_process() -> Outcome {
    for space in SPACES {
        assert_agrees(&format!("{space:?}"), |solid| tracked(solid, space), CellKind::Hex8)?;
    }
    assert_agrees("nodes of tet10", |solid| tracked(solid, Space::Node), CellKind::Tet10)
}

#[test]
fn costs_of_controls_are_those_of_one_process() -> Outcome {
    for space in [Space::Cell, Space::Node, Space::Grid([4, 2, 1]), Space::Region] {
        let regularised = |solid: Solid| -> Outcome<Reduced> {
            let problem = Reduced::new(body(solid)?).control("tension", space)?.control("turgor", space)?;
            let problem = problem.cost(ControlNorm::of("tension", 1e-10)?)?.cost(ControlNorm::of("turgor", 1e-9)?)?;
            Ok(problem.cost(ControlSmoothness::of("tension", 1e-12)?)?)
        };
        assert_agrees(&format!("{space:?}"), regularised, CellKind::Hex8)?;
    }
    Ok(())
}

#[test]
fn designs_and_amplitudes_along_directions_are_those_of_one_process() -> Outcome {
    let designed = |solid: Solid| -> Outcome<Reduced> {
        let shared = [
            Consumer::of("tension"),
            Consumer::of("turgor").through(PowerLaw { low: 1e3, high: 1.1e3, exponent: 2.0 }),
        ];
        let far = Target::position(|x| [x[0], x[1] + 0.1 * x[0], x[2]]);
        let problem = Reduced::new(body(solid)?)
            .control_along("magnet.remanence", Space::Cell, [0.0, 1.0, 1.0])?
            .design("fill", Space::Node, &shared)?;
        Ok(problem.cost(Tracking::surface("x+", far))?)
    };
    let mesh = bar(CellKind::Hex8, 2)?;
    let serial = designed(Solid::new(mesh.clone())?)?;
    let m: Vec<f64> = (0..serial.layout().len()).map(|k| 0.5 + 0.1 * (k as f64).sin()).collect();
    let (cost, derivative) = valued(&serial, &m)?;
    for of_rank in on(3, |rank| valued(&designed(part(&mesh, &rank, false)?)?, &m)) {
        let (own, own_derivative) = of_rank?;
        assert!((own - cost).abs() < 1e-9 * cost.abs() && apart(&own_derivative, &derivative) < 1e-8);
    }
    Ok(())
}

/// A density that is held, mirrored, filtered and projected, a factor of fibres in a part of the body, costs of it.
#[test]
fn chains_of_designs_and_their_costs_are_those_of_one_process() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    for space in [Space::Cell, Space::Node] {
        let designed = |solid: Solid| -> Outcome<Reduced> {
            let dense =
                |law: Arc<dyn EnergyTerm>| Weighted::scaled("rho", law, Scale::Simp { floor: 1e-2, exponent: 3.0 });
            let fibers = Weighted::scaled("phi", Arc::new(FiberTension::along(Vec3::x())?), Scale::Factor)?;
            let solid = solid
                .actuate("near", "soft", dense(Arc::new(MooneyRivlin::new(1e5, 2e4, 1e6)?))?)?
                .actuate("far", "stiff", dense(Arc::new(NeoHooke::new(1e5, 1e6)?))?)?
                .actuate("body", "tension", fibers)?
                .clamp("x-")?;
            let stages = [1.0, 3.0].map(|sharpness| Projection { threshold: 0.4, sharpness });
            let across = Plane { point: None, normal: [0.0, 1.0, 0.0] };
            let lifted = Target::position(|x| [x[0], x[1], x[2] + 0.1 * x[0]]);
            Ok(Reduced::new(solid)
                .design("rho", space, &[Consumer::of("soft.rho"), Consumer::of("stiff.rho")])?
                .hold("rho", "near", 0.9)?
                .mirror("rho", across)?
                .filter("rho", 0.2)?
                .project("rho", &stages, [0.0, 1.0])?
                .hold("rho", "near", 0.9)?
                .design("phi", space, &[Consumer::of("tension.phi").within("far")])?
                .control("tension", Space::Uniform)?
                .cost(Tracking::surface("x+", lifted))?
                .cost(MeanDisplacement::surface("x+", [0.3, 0.0, 0.8]).weight(0.1))?
                .cost(DesignMean::volume("rho", 0.01)?)?
                .cost(DesignMean::greyness("phi", 0.02)?)?)
        };
        let serial = designed(Solid::new(mesh.clone())?)?;
        let count = serial.layout().len() - 1;
        let m: Vec<f64> = (0..count).map(|k| 0.5 + 0.3 * (k as f64).sin()).chain([-2e4]).collect();
        let (cost, derivative) = valued(&serial, &m)?;
        for (ranks, scattered) in [(2, false), (3, true)] {
            let found = on(ranks, |rank| valued(&designed(part(&mesh, &rank, scattered)?)?, &m));
            let (own, own_derivative) = found[0].clone()?;
            assert!(found.iter().all(|other| *other == found[0]), "{space:?} on {ranks}: not the same bits");
            let off = apart(&own_derivative, &derivative);
            assert!((own - cost).abs() < 1e-9 * cost.abs() && off < 1e-8, "{space:?}: {own:e} {cost:e} {off:e}");
        }
    }
    Ok(())
}

#[test]
fn inner_products_are_those_of_one_process() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    for space in [Space::Cell, Space::Node, Space::Grid([4, 2, 1])] {
        for metric in [Metric::L2, Metric::H1 { length: 0.1 }] {
            let product = |solid: Solid| -> Outcome<Arc<dyn InnerProduct>> {
                Ok(tracked(solid, space)?.metric(metric).inner_product()?)
            };
            let serial = product(Solid::new(mesh.clone())?)?;
            let v: Vec<f64> = (0..serial.len()).map(|k| (k as f64).sin()).collect();
            let found = on(3, |rank| {
                let own = product(part(&mesh, &rank, true)?)?;
                Ok((own.apply(&v), own.riesz(&v)))
            });
            for of_rank in &found {
                let (applied, riesz) = of_rank.clone()?;
                let off = [apart(&applied, &serial.apply(&v)), apart(&riesz, &serial.riesz(&v))];
                assert!(off[0] < 1e-12 && off[1] < 1e-10, "{space:?}, {metric:?}: {off:?}");
                assert_eq!(*of_rank, found[0], "{space:?}, {metric:?}: not the same bits");
            }
        }
    }
    Ok(())
}

#[test]
fn derivatives_over_ranks_are_those_of_differences() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    let along =
        |m: &[f64], h: f64| -> Vec<f64> { (0..m.len()).map(|k| m[k] + 1e4 * h * (1.0 + k as f64).sin()).collect() };
    let found = on(3, |rank| {
        let problem = tracked(part(&mesh, &rank, false)?, Space::Node)?;
        let m = control(&problem);
        let (cost, derivative) = valued(&problem, &m)?;
        let slope: f64 = along(&m, 1.0).iter().zip(&m).zip(&derivative).map(|((a, b), d)| (a - b) * d).sum();
        let remainder = |h: f64| -> Outcome<f64> { Ok(problem.at(&along(&m, h))?.cost() - cost - h * slope) };
        Ok((remainder(0.2)? / remainder(0.1)?).log2())
    });
    for order in found {
        let order = order?;
        assert!(order > 1.95, "Taylor remainders: {order}");
    }
    Ok(())
}

/// A grip whose place and turning are controls beside the tension.
fn gripped(solid: Solid) -> Outcome<Reduced> {
    let solid = body(solid)?
        .motion(MovingSupport::of("grip", "x+").about([1.0, 0.1, 0.1]))?
        .spring(Spring::to_ground("wire", [0.5, 0.1, 0.0], [0.5, 0.1, -0.3], 2e3))?;
    let bent = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.2 * x[0] * x[0]]);
    Ok(Reduced::new(solid)
        .control("grip.translation", Space::Uniform)?
        .control("grip.rotation", Space::Uniform)?
        .control("tension", Space::Node)?
        .cost(Tracking::surface(["skin"], bent))?
        .cost(ControlNorm::of("grip.translation", 1e-3)?)?
        .cost(ControlSmoothness::of("tension", 1e-15)?)?)
}

#[test]
fn supports_that_controls_move_have_the_derivatives_of_one_process() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    let serial = gripped(Solid::new(mesh.clone())?)?;
    let m = |h: f64| -> Vec<f64> {
        let grip = [0.01, 0.0, 0.05, 0.02, -0.3, 0.05].into_iter().map(|x: f64| x + 0.1 * h * (30.0 * x).cos());
        let tension = |k: usize| -1e4 * (1.0 + (k as f64 + h).sin());
        grip.chain((6..serial.layout().len()).map(tension)).collect()
    };
    let (cost, derivative) = valued(&serial, &m(0.0))?;
    let weights = serial.inner_product()?.apply(&vec![1.0; derivative.len()]);
    for (ranks, scattered) in [(1, false), (2, false), (3, true), (5, false)] {
        let found = on(ranks, |rank| {
            let problem = gripped(part(&mesh, &rank, scattered)?)?;
            let (own, own_derivative) = valued(&problem, &m(0.0))?;
            let off = apart(&problem.inner_product()?.apply(&vec![1.0; own_derivative.len()]), &weights);
            // grip and tension are of different sizes
            let by_part =
                [apart(&own_derivative[..6], &derivative[..6]), apart(&own_derivative[6..], &derivative[6..])];
            Ok((own, own_derivative, by_part, off))
        });
        let (own, _, by_part, off) = found[0].clone()?;
        assert!(found.iter().all(|other| *other == found[0]), "on {ranks}: not the same bits");
        assert!((own - cost).abs() < 1e-9 * cost && off < 1e-12, "on {ranks}: {own:e} {cost:e}, {off:e}");
        assert!(by_part.iter().all(|off| *off < 1e-8), "on {ranks}: the derivative is off by {by_part:?}");
    }
    Ok(())
}

/// The force of a support between parts, and of a grip that controls move.
fn grasped(solid: Solid) -> Outcome<Reduced> {
    let solid = body(solid)?.motion(MovingSupport::of("grip", "x+"))?;
    Ok(Reduced::new(solid)
        .control("tension", Space::Node)?
        .control("grip.translation", Space::Uniform)?
        .cost(Reaction::at("x-", [1.0, 0.0, 2.0], 300.0).weight(1e-3))?
        .cost(Reaction::at(["x+", "x-"], [0.0, 1.0, 0.0], 200.0).weight(1e-3))?
        .cost(Reaction::at("x+", [0.0, 0.0, 1.0], 200.0).weight(1e-3))?)
}

#[test]
fn forces_of_supports_have_the_derivatives_of_one_process() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10] {
        let mesh = bar(kind, 2)?;
        let serial = grasped(Solid::new(mesh.clone())?)?;
        let nodes = serial.layout().len() - 3;
        let at = |h: f64| -> Vec<f64> {
            let tension = (0..nodes).map(|k| -1e4 * (1.0 + (k as f64).sin() + h * (2.0 * k as f64).cos()));
            tension.chain([0.01 + 0.01 * h, 0.02, 0.05 - 0.02 * h]).collect()
        };
        let (cost, derivative) = valued(&serial, &at(0.0))?;
        let along: Vec<f64> = at(1.0).iter().zip(at(0.0)).map(|(a, b)| a - b).collect();
        for (ranks, scattered) in [(1, false), (2, false), (3, true), (5, false)] {
            let found = on(ranks, |rank| {
                let problem = grasped(part(&mesh, &rank, scattered)?)?;
                let (own, slope) = valued(&problem, &at(0.0))?;
                let change: f64 = slope.iter().zip(&along).map(|(d, v)| d * v).sum();
                let remainder = |h: f64| -> Outcome<f64> { Ok(problem.at(&at(h))?.cost() - own - h * change) };
                Ok((own, slope, (remainder(0.2)? / remainder(0.1)?).log2()))
            });
            let (own, slope, order) = found[0].clone()?;
            assert!(found.iter().all(|other| *other == found[0]), "{kind} on {ranks}: not the same bits");
            assert!((own - cost).abs() < 1e-9 * cost, "{kind} on {ranks}: {own:e} {cost:e}");
            let off = [apart(&slope[..nodes], &derivative[..nodes]), apart(&slope[nodes..], &derivative[nodes..])];
            assert!(off.iter().all(|off| *off < 1e-8), "{kind} on {ranks}: the derivative is off by {off:?}");
            assert!(order > 1.95, "{kind} on {ranks}: Taylor remainders of order {order}");
        }
    }
    let mesh = bar(CellKind::Hex8, 1)?;
    let free = |rank| {
        Ok(tracked(part(&mesh, &rank, false)?, Space::Uniform)?.cost(Reaction::at("x+", [1.0; 3], 1.0)).is_err())
    };
    assert!(on(3, free).iter().all(|refused| *refused == Ok(true)), "nothing holds that surface");
    Ok(())
}

#[test]
fn arrays_for_files_have_the_controls_of_the_part() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    for space in [Space::Node, Space::Cell, Space::Grid([4, 2, 1])] {
        let shot = |problem: &Reduced| -> Outcome<_> {
            let point = problem.at(&control(problem))?;
            Ok(problem.moved_controls(&nastic_control::StateFields::of(&point))?)
        };
        let serial = shot(&tracked(Solid::new(mesh.clone())?, space)?)?;
        let owners = mesh.bisected(3)?;
        let found = on(3, |rank| {
            let own = shot(&tracked(part(&mesh, &rank, false)?, space)?)?;
            let part = mesh.part(&owners, rank.rank() as u32)?;
            let numbers = if space == Space::Node { part.nodes() } else { part.cells() };
            let named = |shot: &Snapshot| {
                let arrays = if space == Space::Node { &shot.point_data } else { &shot.cell_data };
                arrays.iter().find(|array| array.name == "tension").cloned()
            };
            let (Some(own), Some(whole)) = (named(&own), named(&serial)) else { return Err("no array".into()) };
            let expected: Vec<f64> = numbers.iter().map(|number| whole.values[*number as usize]).collect();
            Ok(apart(&own.values, &expected))
        });
        assert!(found.iter().all(|off| off.as_ref().is_ok_and(|off| *off < 1e-12)), "{space:?}: {found:?}");
    }
    Ok(())
}

/// What of a body over ranks is refused with [`FemError::Unsupported`].
fn refused<T>(found: Result<T, ControlError>) -> String {
    match found.err() {
        Some(ControlError::Fem(FemError::Unsupported { what, with, .. })) if with == "a body over ranks" => what,
        Some(error) => format!("another error: {error}"),
        None => "nothing".to_owned(),
    }
}

/// A cost that says nothing of ranks.
#[derive(Debug)]
struct Own;

impl Cost for Own {
    fn name(&self) -> &str {
        "own"
    }

    fn at(&self, _: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Err(ControlError::Cost { what: "never asked".to_owned() })
    }
}

#[test]
fn what_does_not_span_ranks_is_refused_by_name() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(2, |rank| {
        let problem = || tracked(part(&mesh, &rank, false)?, Space::Uniform);
        let point = problem()?.at(&[0.0; 2])?;
        let timeline = Timeline::uniform(Scheme::backward_euler(), 1.0, 2)?;
        let limit = nastic_control::CostLimit::at_most(Own, 1.0);
        Ok([
            refused(problem()?.cost(Compliance::surface("x+", [0.0, 0.0, 1.0]))),
            refused(problem()?.cost(LumenVolume::behind("x+", 1.0))),
            refused(problem()?.cost(Own)),
            refused(problem()?.cost(Box::new(Own) as Box<dyn Cost>)),
            refused(problem()?.constrain(limit)),
            refused(Reduced::new(problem()?.solid().clone()).in_time(timeline)),
            refused(problem()?.hessian_vector(&point, &[1.0; 2], &mut ReducedWorkspace::default())),
        ])
    });
    let named =
        ["cost Compliance", "cost LumenVolume", "\"own\"", "\"own\"", "constraint", "in time", "second derivatives"];
    for found in found {
        let found = found?;
        assert!(found.iter().zip(named).all(|(found, named)| found.contains(named)), "{found:?}");
    }
    Ok(())
}

#[test]
fn another_control_on_one_rank_is_refused_by_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(3, |rank| {
        let problem = tracked(part(&mesh, &rank, false)?, Space::Uniform)?;
        let (own, same) = ([0.0, if rank.rank() == 2 { 1e-300 } else { 0.0 }], [1.0; 2]);
        let refused = match problem.at(&own) {
            Err(error) => error.to_string(),
            Ok(_) => "nothing".to_owned(),
        };
        Ok((refused, problem.at(&same).is_ok()))
    });
    for found in found {
        let (refused, goes_on) = found?;
        assert!(refused.contains("rank 2 was given another control") && goes_on, "{refused}");
    }
    Ok(())
}

#[test]
fn what_one_rank_cannot_bind_or_find_is_an_error_of_all() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, |rank| {
        let solid = part(&mesh, &rank, false)?
            .material("body", NeoHooke::new(1e5, 1e6)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?;
        let problem = || -> Outcome<Reduced> { Ok(Reduced::new(solid.clone()).control("tension", Space::Uniform)?) };
        // not finite at the end alone
        let hole = Target::position(|x| if x[0] > 0.99 { [f64::NAN; 3] } else { x });
        let bound = problem()?.cost(Tracking::surface("skin", hole)).err().map(|error| error.to_string());
        let unknown = problem()?.cost(Tracking::surface("nowhere", Target::position(|x| x))).is_err();
        let problem = problem()?.cost(Tracking::surface("x+", Target::position(|x| x)))?;
        let request = Request { accuracy: 1e-8, ..Request::default() };
        let none = nastic_opt::Objective::evaluate(&problem, &[f64::NAN], &request, &mut ReducedWorkspace::default());
        Ok((bound, unknown, none.is_err(), problem.at(&[0.0]).is_ok()))
    });
    let mut own = 0;
    for found in found {
        let (bound, unknown, none, good) = found?;
        assert!(unknown && none && good);
        let bound = bound.ok_or("it was bound")?;
        own += usize::from(bound.contains("not finite"));
        assert!(bound.contains("not finite") || bound.contains("rank"), "{bound}");
    }
    assert_eq!(own, 1);
    Ok(())
}
