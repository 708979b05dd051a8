//! Problems of a body over ranks, which are threads here, with springs between its parts and with formulations over patches of cells: controls, costs,
//! inner products and derivatives of one process.

use crate::ranks::{Outcome, apart, bar, on, solver, valued};
use nastic_control::{ControlSmoothness, MeanPosition, Metric, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Formulation, Solid, Spring};
use nastic_mesh::{CellKind, Mesh};
use nastic_opt::Problem;
use nastic_team::Team;
use nastic_team::threads::ThreadRank;
use std::sync::Arc;

fn springs() -> [Spring; 2] {
    [
        Spring::between("far", [0.07, 0.1, 0.13], [0.91, 0.13, 0.2], 3e3).rest_length(0.6),
        Spring::between("back", [0.97, 0.05, 0.1], [0.3, 0.03, 0.0], 2e3),
    ]
}

/// The part of a rank that cuts no patches, with the nodes of springs.
fn part(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Solid> {
    let owners = mesh.with_whole_patches(&mesh.bisected(rank.size())?)?;
    let sets: Vec<Vec<u32>> = springs().iter().map(|spring| spring.nodes(mesh)).collect::<Result<_, _>>()?;
    let part = mesh.part_reaching(&owners, rank.rank() as u32, &sets)?;
    Ok(Solid::of_part(part, rank.clone())?.solver(&solver::Simple))
}

fn sprung(solid: Solid, space: Space) -> Outcome<Reduced> {
    let solid = solid
        .material("body", NeoHooke::new(1e5, 1e6)?)?
        .formulation("far", Formulation::MeanDilatation)?
        .actuate("body", "tension", FiberTension::along(nastic_tensor::Vec3::x())?)?
        .clamp("x-")?;
    let solid = springs().into_iter().try_fold(solid, |solid, spring| solid.spring(spring))?;
    let bent = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.2 * x[0] * x[0]]);
    Ok(Reduced::new(solid)
        .control("tension", space)?
        .metric(Metric::H1 { length: 0.1 })
        .cost(Tracking::surface(["x+", "z-"], bent.clone()))?
        .cost(Tracking::nodes("y+", bent).weight(1e-3))?
        .cost(MeanPosition::point([0.91, 0.13, 0.2], [None, Some(0.1), Some(0.3)]).weight(0.1))?
        .cost(ControlSmoothness::of("tension", 1e-12)?)?)
}

#[test]
fn derivatives_with_springs_between_parts_and_patches_are_those_of_one_process() -> Outcome {
    for (kind, space) in [(CellKind::Hex8, Space::Node), (CellKind::Tet4, Space::Node), (CellKind::Tet4, Space::Cell)] {
        let mesh = bar(kind, if kind == CellKind::Tet4 { 3 } else { 2 })?;
        let serial = sprung(Solid::new(mesh.clone())?, space)?;
        let m: Vec<f64> = (0..serial.layout().len()).map(|k| -1e4 * (1.5 + (k as f64).sin())).collect();
        let along: Vec<f64> = (0..m.len()).map(|k| 2e3 * (1.0 + (3.0 * k as f64).cos())).collect();
        let ((cost, derivative), applied) = (valued(&serial, &m)?, serial.inner_product()?.apply(&m));
        for ranks in [1, 2, 3, 5] {
            let found = on(ranks, |rank| {
                let problem = sprung(part(&mesh, &rank)?, space)?;
                let here = valued(&problem, &m)?;
                let slope: f64 = here.1.iter().zip(&along).map(|(d, v)| d * v).sum();
                let remainder = |h: f64| -> Outcome<f64> {
                    let moved: Vec<f64> = m.iter().zip(&along).map(|(m, v)| m + h * v).collect();
                    Ok(problem.at(&moved)?.cost() - here.0 - h * slope)
                };
                let order = (remainder(1.0)? / remainder(0.5)?).log2();
                Ok((here, order, problem.inner_product()?.apply(&m)))
            });
            let ((own, own_derivative), order, own_applied) = found[0].clone()?;
            let same = found.iter().all(|other| *other == found[0]);
            assert!(same, "{kind}, {space:?} on {ranks}: not the same bits");
            assert!((own - cost).abs() < 1e-9 * cost, "{kind}, {space:?} on {ranks}: {own:e} {cost:e}");
            let off = [apart(&own_derivative, &derivative), apart(&own_applied, &applied)];
            assert!(off[0] < 1e-8 && off[1] < 1e-12, "{kind}, {space:?} on {ranks}: off by {off:?}");
            assert!(order > 1.95, "{kind}, {space:?} on {ranks}: Taylor remainders of order {order}");
        }
    }
    Ok(())
}
