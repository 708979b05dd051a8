//! Tendons: lengths, the bending of a beam, tension against pull, slackness, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, noise, regular, unit};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Cause, Demand, Formulation, Instant, Solid, SolveOptions, State, StateError, Tendon, check_contribution,
};
use nastic_mesh::{CellKind, Mesh, RawMesh, rectangle};
use nastic_tensor::{Mat3, Vec3};

fn quantity(solid: &Solid, state: &State, name: &str, wanted: &str) -> Outcome<f64> {
    let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
    let found = all.iter().find(|(of, what, _)| of == name && *what == wanted);
    Ok(found.ok_or(format!("no {wanted} of {name}"))?.2)
}

/// The equilibrium with these values of the controls, one for each contribution.
fn solve(solid: &Solid, values: &[f64]) -> Outcome<State> {
    let mut controls = solid.controls();
    values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k).fill(*value));
    Ok(solid.solve(&controls, &STRICT)?)
}

/// An affine map takes every segment d to F d: guides between nodes of every kind of cell move as the body does.
#[test]
fn lengths_are_those_of_the_deformed_body() -> Outcome {
    let guides = [[0.1, 0.2, 0.3], [0.37, 0.61, 0.52], [0.9, 0.45, 0.05], [0.95, 0.95, 0.8]];
    for kind in common::kinds() {
        let (dim, plane) = (kind.dim(), kind.dim() == 2);
        let guides = guides.map(|x| if plane { [x[0], x[1], 0.0] } else { x });
        let solid = Solid::new(unit(kind, 2)?)?.tendon(Tendon::through("cable", guides))?;
        let mut f = Mat3::new(1.1, 0.2, 0.1, -0.1, 0.9, 0.3, 0.2, -0.2, 1.3);
        if plane {
            f = Mat3::new(1.1, 0.2, 0.0, -0.1, 0.9, 0.0, 0.0, 0.0, 1.0);
        }
        let moved = |x: &[f64; 3]| (f * Vec3::from(*x) - Vec3::from(*x)).as_slice()[..dim].to_vec();
        let mut state = solid.rest();
        let along =
            |f: Mat3| guides.windows(2).map(|x| (f * (Vec3::from(x[1]) - Vec3::from(x[0]))).norm()).sum::<f64>();
        let rest = quantity(&solid, &state, "cable", "length")?;
        assert!((rest - along(Mat3::identity())).abs() < 1e-13, "{kind}: {rest}");
        state.u = solid.mesh().points().iter().flat_map(moved).collect::<Vec<f64>>().into();
        let found = quantity(&solid, &state, "cable", "length")?;
        assert!((found - along(f)).abs() < 1e-13, "{kind}: {found} instead of {}", along(f));
        let lines = solid.model().lines(&Instant::new(&state.u, &state.controls, 1.0))?;
        let last = Vec3::from(lines[0].points[3]);
        assert!((last - f * Vec3::from(guides[3])).norm() < 1e-13, "{kind}: {last}");
    }
    Ok(())
}

/// The forces of a tendon on a free body have no resultant and no moment, in any deformed shape.
#[test]
fn forces_of_a_tendon_are_in_equilibrium() -> Outcome {
    let guides = [[0.1, 0.2, 0.3], [0.9, 0.45, 0.05], [0.95, 0.95, 0.8]];
    let solid = Solid::new(unit(CellKind::Tet10, 2)?)?.tendon(Tendon::through("cable", guides).spacing(0.1))?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(3.0);
    let u: Vec<f64> = (0..solid.discretization().dofs()).map(|k| 0.05 * noise(k)).collect();
    let demand = Demand { energy: false, force: true };
    let force = solid.model().evaluate(&Instant::new(&u, &controls, 0.0), demand)?.force;
    let (mut sum, mut moment) = (Vec3::zeros(), Vec3::zeros());
    for (node, x) in solid.mesh().points().iter().enumerate() {
        let own = |v: &[f64]| Vec3::from_column_slice(&v[3 * node..3 * node + 3]);
        sum += own(&force);
        moment += (Vec3::from(*x) + own(&u)).cross(&own(&force));
    }
    assert!(largest(&force) > 1.0 && sum.norm() < 1e-12 && moment.norm() < 1e-12, "{sum} {moment}");
    Ok(())
}

const LENGTH: f64 = 20.0;
const OFFSET: f64 = 0.4;
const YOUNG: f64 = 1e4;

/// A strip of thickness 1 in plane strain without lateral contraction, clamped at the left, with a tendon at a distance from its axis.
fn strip(guides: usize) -> Outcome<Solid> {
    let mesh = rectangle([LENGTH, 1.0], [40, 2], CellKind::Quad9)?;
    let tendon = [[0.0, 0.5 - OFFSET, 0.0], [LENGTH, 0.5 - OFFSET, 0.0]];
    Ok(Solid::new(mesh)?
        .material("body", NeoHooke::new(0.5 * YOUNG, 0.0)?)?
        .clamp("x-")?
        .tendon(Tendon::through("cable", tendon).spacing(LENGTH / guides as f64))?)
}

/// By how much the cross-section at x has turned: between its ends.
fn turned(solid: &Solid, state: &State, x: f64) -> Outcome<f64> {
    let at = |y: f64| -> Outcome<[f64; 3]> {
        let node = common::node_at(solid.mesh(), [x, y, 0.0]).ok_or("no node there")?;
        Ok([x + state.u[2 * node], y + state.u[2 * node + 1], 0.0])
    };
    let (low, high) = (at(0.0)?, at(1.0)?);
    Ok((low[0] - high[0]).atan2(high[1] - low[1]))
}

/// Curvature away from both ends, per reference length.
fn curvature(solid: &Solid, state: &State) -> Outcome<f64> {
    Ok((turned(solid, state, 0.75 * LENGTH)? - turned(solid, state, 0.25 * LENGTH)?) / (0.5 * LENGTH))
}

/// The strip bends towards the tendon (downward) to an arc of curvature T d / (E I), I = 1/12.
#[test]
fn a_tendon_bends_a_slender_strip_to_an_arc() -> Outcome {
    let second_moment = 1.0 / 12.0;
    let tension = |angle: f64| angle / LENGTH * YOUNG * second_moment / OFFSET;
    let solid = strip(40)?;
    let small = solve(&solid, &[tension(0.008)])?;
    let expected = -0.008 / LENGTH;
    let found = curvature(&solid, &small)?;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found:e} instead of {expected:e}");
    // a circle: between quarters of the length it turns by the same angle
    let angles = [0.25, 0.5, 0.75].map(|s| turned(&solid, &small, s * LENGTH));
    let [a, b, c] = angles.map(Result::unwrap_or_default);
    assert!(((b - a) / (c - b) - 1.0).abs() < 1e-4, "{a} {b} {c}");
    // the difference is the axial strain T / (E A), of first order: the lever and the section change with it
    let strain = tension(0.8) / YOUNG;
    let large = curvature(&solid, &solve(&solid, &[tension(0.8)])?)?;
    let excess = large / (100.0 * expected) - 1.0;
    assert!(excess.abs() > 1e-3 && excess.abs() < 8.0 * strain, "{excess:e}, strain {strain:e}");
    Ok(())
}

/// Between guides the tendon is a chord, nearer to the axis than the arc by up to kappa h^2 / 8: the error falls as h^2.
#[test]
fn the_curvature_converges_with_the_distance_of_guides() -> Outcome {
    let tension = 0.8 / LENGTH * YOUNG / 12.0 / OFFSET;
    let of = |guides: usize| -> Outcome<f64> {
        let solid = strip(guides)?;
        curvature(&solid, &solve(&solid, &[tension])?)
    };
    let finest = of(160)?;
    let errors = [5, 10, 20].map(|guides| of(guides).map(|found| (found / finest - 1.0).abs()));
    let [coarse, middle, fine] = errors.map(|error| error.unwrap_or(f64::NAN));
    assert!(coarse / middle > 3.0 && middle / fine > 3.0, "{coarse:e} {middle:e} {fine:e}");
    // its mean distance from the arc is kappa h^2 / 12
    let h = LENGTH / 10.0;
    let predicted = 0.8 / LENGTH * h * h / 12.0 / OFFSET;
    assert!((middle / predicted - 1.0).abs() < 0.3, "{middle:e}, predicted {predicted:e}");
    assert!((of(40)? / finest - 1.0).abs() < 1e-2);
    Ok(())
}

const CABLE: [[f64; 3]; 3] = [[0.0, 0.31, 0.2], [1.0, 0.33, 0.17], [2.0, 0.3, 0.21]];

fn bar(kind: CellKind, tendons: impl IntoIterator<Item = Tendon>) -> Outcome<Solid> {
    let body = Solid::new(regular(kind, [2.0, 0.5, 0.5], [5, 2, 2])?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .clamp("x-")?;
    Ok(tendons.into_iter().try_fold(body, Solid::tendon)?)
}

/// The tension of the elastic cable, given to one under tension, makes the same state, which keeps the elastic law.
#[test]
fn pull_and_tension_find_the_same_state() -> Outcome {
    let stiffness = 3e3;
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Hex20] {
        let way = || Tendon::through("cable", CABLE).spacing(0.3);
        let (elastic, forced) = (bar(kind, [way().stiffness(stiffness)])?, bar(kind, [way()])?);
        let pulled = solve(&elastic, &[0.15])?;
        let [tension, length, reference] =
            ["tension", "length", "reference_length"].map(|what| quantity(&elastic, &pulled, "cable", what).unwrap());
        assert!((tension - stiffness * (length - reference + 0.15)).abs() < 1e-12 * tension, "{kind}: {tension}");
        assert!(tension > 50.0 && length < reference && quantity(&elastic, &pulled, "cable", "slack")? == 0.0);
        let held = solve(&forced, &[tension])?;
        let difference = pulled.u.iter().zip(held.u.iter()).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(difference < 1e-9 * largest(&held.u), "{kind}: {difference:e} of {:e}", largest(&held.u));
    }
    Ok(())
}

/// A cable that is let out carries nothing: the state is the rest, to the bit; of two antagonists the one that is let out has no part.
#[test]
fn a_slack_tendon_carries_no_force() -> Outcome {
    let upper = || Tendon::through("upper", CABLE.map(|x| [x[0], x[1], 0.45])).stiffness(2e3);
    let lower = || Tendon::through("lower", CABLE.map(|x| [x[0], x[1], 0.05])).stiffness(2e3);
    let both = bar(CellKind::Hex8, [upper(), lower()])?;
    let rest = solve(&both, &[-0.01, -1e-3])?;
    assert!(rest.u.iter().all(|u| *u == 0.0));
    assert_eq!(quantity(&both, &rest, "upper", "tension")?, 0.0);
    assert_eq!(quantity(&both, &rest, "upper", "slack")?, 1.0);
    // pulled up, the lower one becomes longer: it stays slack only if it is let out far enough
    let up = solve(&both, &[0.1, -0.5])?;
    let alone = solve(&bar(CellKind::Hex8, [upper()])?, &[0.1])?;
    let difference = up.u.iter().zip(alone.u.iter()).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(largest(&alone.u) > 0.05 && difference < 1e-10, "{difference:e}");
    let held = solve(&both, &[0.1, 0.0])?;
    assert!(quantity(&both, &held, "lower", "tension")? > 1.0, "the antagonist is not stretched");
    let tip = common::node_at(both.mesh(), [2.0, 0.25, 0.25]).ok_or("no tip")?;
    let (with, without) = (held.u[3 * tip + 2], alone.u[3 * tip + 2]);
    assert!(with > 0.0 && with < 0.98 * without, "the antagonist does not hold the bar: {with} of {without}");
    Ok(())
}

/// The contract where the elastic cable is taut, at controls of its own size.
#[test]
fn both_kinds_keep_the_contract_on_every_cell() -> Outcome {
    for kind in common::kinds() {
        let guides = CABLE.map(|x| if kind.dim() == 2 { [x[0], x[1], 0.0] } else { x });
        for stiffness in [None, Some(10.0)] {
            let way = Tendon::through("cable", guides).spacing(0.7);
            let solid = bar(kind, [stiffness.map_or(way.clone(), |k| way.stiffness(k))])?;
            (0..6).try_for_each(|seed| check_contribution(solid.model(), "cable", seed))?;
        }
    }
    Ok(())
}

/// A node set stands for the mean of its nodes.
#[test]
fn a_node_set_holds_a_tendon() -> Outcome {
    let mesh = regular(CellKind::Hex8, [2.0, 0.5, 0.5], [5, 2, 2])?;
    let ends: Vec<u32> = (0..mesh.points().len() as u32).filter(|n| mesh.points()[*n as usize][0] == 2.0).collect();
    let mut raw = RawMesh::new("bar");
    raw.points = mesh.points().to_vec();
    raw.name_group(3, 1, "body");
    (0..mesh.cells()).for_each(|cell| raw.push(CellKind::Hex8, mesh.cell(cell).nodes, &[1]));
    raw.name_group(0, 2, "anchor");
    raw.vertices = ends.into_iter().map(|node| (node, 2)).collect();
    let mesh = Mesh::build(raw)?;
    let guides = [nastic_fem::BodyPoint::At([0.0, 0.25, 0.25]), "anchor".into()];
    let solid = Solid::new(mesh)?.tendon(Tendon::through("cable", guides))?;
    assert!((quantity(&solid, &solid.rest(), "cable", "length")? - 2.0).abs() < 1e-14);
    let unknown = Tendon::through("cable", ["anchr", "anchor"]);
    let message = solid.clone().tendon(unknown).err().ok_or("an unknown set")?.to_string();
    assert!(message.contains("guide 0") && message.contains("anchr") && message.contains("anchor"), "{message}");
    Ok(())
}

#[test]
fn what_is_no_tendon_is_refused() -> Outcome {
    let refused = |tendon: Tendon, words: &[&str]| -> Outcome {
        let message = bar(CellKind::Hex8, [tendon]).err().ok_or(format!("{words:?} passes"))?.to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
        Ok(())
    };
    let [a, b, _] = CABLE;
    refused(
        Tendon::through("cable", [a, [2.5, 0.3, 0.2]]),
        &["guide 1", "outside the body", "(2, 0.3, 0.2)", "5.000e-1"],
    )?;
    refused(Tendon::through("cable", [a]), &["1 guides"])?;
    refused(Tendon::through("cable", [a, b, b]), &["guides 1 and 2"])?;
    refused(Tendon::through("cable", [a, b]).stiffness(-1.0), &["stiffness", "-1"])?;
    refused(Tendon::through("cable", [a, b]).stiffness(f64::NAN), &["stiffness"])?;
    refused(Tendon::through("cable", [a, b]).spacing(0.0), &["spacing"])?;
    refused(Tendon::through("cable", [a, b]).spacing(1e-9), &["spacing", "10000"])?;
    let twice = bar(CellKind::Hex8, [Tendon::through("cable", [a, b]), Tendon::through("cable", [a, b])]);
    assert!(twice.err().ok_or("one name twice")?.to_string().contains("cable"));
    // it only pulls
    let solid = bar(CellKind::Hex8, [Tendon::through("cable", [a, b])])?;
    let message = solve(&solid, &[-1.0]).err().ok_or("a tendon that pushes")?.to_string();
    assert!(message.contains("cable") && message.contains("only pulls"), "{message}");
    Ok(())
}

/// A cable so strong that the body collapses between two of its guides: the tangent grows without bound as they meet, so that a full
/// step is shorter than double precision resolves although nothing balances. That is no equilibrium.
#[test]
fn a_cable_whose_guides_run_together_is_no_equilibrium() -> Outcome {
    let (length, width, height) = (0.06778116756897896, 0.04411153083810304, 0.04499227615383725);
    let mesh = nastic_mesh::box_mesh([length, width, height], [3, 2, 2], CellKind::Hex8)?;
    let law = nastic_energy::NeoHookeIsochoric::new(43557.32523368733, 71012285.82508357)?;
    let guides = [[0.0, width, 0.0], [length / 3.0, width, 0.0], [length, width, 0.0]];
    let solid = Solid::new(mesh)?
        .material("body", law)?
        .formulation("body", Formulation::MeanDilatation)?
        .clamp("x-")?
        .tendon(Tendon::through("cable", guides).spacing(0.00847264594612237))?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(23.19124465355479);
    let error = solid.solve(&controls, &SolveOptions::default()).unwrap_err();
    let StateError::NoConvergence { cause: Cause::GuidesMeet(meeting), residual, .. } = &error else {
        panic!("{error}")
    };
    assert!(meeting.name == "cable" && meeting.share < 1e-2 && *residual > 1e-6, "{error}");
    assert!(error.to_string().contains("two guides of \"cable\", at ("), "{error}");
    Ok(())
}
