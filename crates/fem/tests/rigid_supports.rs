//! Supports of rigid bodies: planes of symmetry, hinges, joints; what no simplex of nodes can hold is refused.

use crate::common;

use crate::rigid_body::parts;
use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, FemError, Foundation, RigidBody, Solid, State};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;

/// A soft block of height 1 below a rigid one of height 0.5, pressed down on a floor by a stamp's weight; x and y from `low` to 1.
fn stacked(kind: CellKind, dim: usize, low: [f64; 2], planes: &[(&str, usize)]) -> Outcome<Solid> {
    let up = dim - 1;
    let mut size = [1.0 - low[0], 1.0 - low[1], 1.5];
    size[up] = 1.5;
    let mesh = regular(kind, size, size.map(|s| (2.0 * s) as usize))?;
    let mesh = mesh.mapped(|x| {
        let mut at = x;
        (0..up).for_each(|c| at[c] += low[c]);
        at
    })?;
    let mesh = parts(&mesh, |x| x[up] > 1.0)?;
    let along = |value: f64| Vec3::from_fn(|i, _| if i == up { value } else { 0.0 });
    let bottom = ["x-", "y-", "z-"][up];
    let mut solid = Solid::new(mesh)?
        .material("soft", NeoHooke::new(1.0, 2.0)?)?
        .material("hard", NeoHooke::new(1.0, 2.0)?)?
        .body_force("hard", along(-0.8))?
        .foundation(Foundation::on(bottom, 3.0))?;
    for (plane, c) in planes {
        let mut held = [None; 3];
        held[*c] = Some(0.0);
        solid = solid.displace(*plane, held)?;
    }
    let floor = Obstacle::half_space(along(-0.05).into(), along(1.0).into());
    Ok(solid.rigid(&RigidBody::new("stamp", "hard"))?.contact(Contact::of("floor", bottom, floor).thickness(4e-3))?)
}

/// The largest difference of displacements at equal places, and the largest displacement.
fn difference(part: (&Solid, &State), whole: (&Solid, &State)) -> (f64, f64) {
    let dim = part.0.mesh().dim();
    let all = whole.0.mesh().points();
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    for (a, x) in part.0.mesh().points().iter().enumerate() {
        let same = |y: &&[f64; 3]| (0..3).all(|c| (x[c] - y[c]).abs() < 1e-9);
        let b = all.iter().position(|y| same(&y)).unwrap_or(usize::MAX);
        for c in 0..dim {
            let (one, other) = (part.1.u[dim * a + c], whole.1.u[dim * b + c]);
            (worst, most) = (worst.max((one - other).abs()), most.max(one.abs()));
        }
    }
    (worst, most)
}

/// Half and quarter of a body that is symmetric move as the whole; the planes carry what the other parts would.
#[test]
fn parts_of_symmetric_bodies_move_as_the_whole() -> Outcome {
    for kind in [CellKind::Quad4, CellKind::Quad8, CellKind::Quad9] {
        let (whole, half) = (stacked(kind, 2, [-1.0, 0.0], &[])?, stacked(kind, 2, [0.0, 0.0], &[("x-", 0)])?);
        let [all, one] = [&whole, &half].map(|solid| solid.solve(&solid.controls(), &STRICT));
        let (all, one) = (all?, one?);
        let (worst, most) = difference((&half, &one), (&whole, &all));
        assert!(most > 0.1 && worst < 1e-10 * most, "{kind}: {worst:e} of {most}");
    }
    for kind in [CellKind::Hex8, CellKind::Hex20] {
        let whole = stacked(kind, 3, [-1.0, -1.0], &[])?;
        let all = whole.solve(&whole.controls(), &STRICT)?;
        let half = stacked(kind, 3, [0.0, -1.0], &[("x-", 0)])?;
        let quarter = stacked(kind, 3, [0.0, 0.0], &[("x-", 0), ("y-", 1)])?;
        for part in [&half, &quarter] {
            let one = part.solve(&part.controls(), &STRICT)?;
            let (worst, most) = difference((part, &one), (&whole, &all));
            assert!(most > 0.1 && worst < 1e-10 * most, "{kind}: {worst:e} of {most}");
            assert!(one.report.newton <= all.report.newton + 4, "{:?} {:?}", one.report, all.report);
        }
    }
    Ok(())
}

/// A rigid bar that lies on an elastic foundation and is held along an edge, at a corner, or at nothing else.
fn bar(supports: &[(&str, [bool; 3])]) -> Result<Solid, Box<dyn std::error::Error>> {
    let mesh = box_mesh([2.0, 1.0, 1.0], [2, 2, 1], CellKind::Hex8)?;
    let at = |what: &str| -> Vec<u32> {
        let inside = |x: &[f64; 3]| match what {
            "edge" => x[0] == 0.0 && x[2] == 0.0,
            "corner" => *x == [0.0; 3],
            "beside" => *x == [2.0, 0.0, 0.0],
            "along" => x[1] == 0.0 && x[2] == 0.0,
            _ => x[0] == 0.0,
        };
        (0u32..).zip(mesh.points()).filter(|(_, x)| inside(x)).map(|(node, _)| node).collect()
    };
    let nodes: Vec<Vec<u32>> = supports.iter().map(|(what, _)| at(what)).collect();
    let mut solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .body_force("body", Vec3::new(0.0, 0.1, -0.3))?
        .foundation(Foundation::on("x+", 0.4))?;
    for ((what, held), nodes) in supports.iter().zip(&nodes) {
        solid = solid.displace_nodes(what, nodes, |_, _| held.map(|held| held.then_some(0.0)))?;
    }
    Ok(solid.rigid(&RigidBody::new("bar", "body"))?)
}

/// Reactions and foundation carry the load, and the lengths stay: hinges turn by what the moments about them ask for.
#[test]
fn hinges_and_joints_let_go_what_they_should() -> Outcome {
    let all = [true; 3];
    let cases: [&[(&str, [bool; 3])]; 4] = [
        &[("edge", all)],
        &[("corner", all)],
        &[("corner", all), ("beside", [false, true, false])],
        &[("edge", [true, false, true]), ("corner", [false, true, false])],
    ];
    for supports in cases {
        let solid = bar(supports)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let u = |node: usize| Vec3::new(state.u[3 * node], state.u[3 * node + 1], state.u[3 * node + 2]);
        let points: Vec<Vec3> = solid.mesh().points().iter().map(|x| Vec3::from(*x)).collect();
        for (a, x) in points.iter().enumerate() {
            for (b, y) in points.iter().enumerate().take(a) {
                let apart = (x + u(a) - y - u(b)).norm();
                assert!((apart / (x - y).norm() - 1.0).abs() < 1e-12, "{supports:?}: {apart}");
            }
        }
        let origin = points.iter().position(|x| x.norm() == 0.0).ok_or("no corner")?;
        assert!(u(origin).norm() < 1e-13, "{supports:?}: {:?}", u(origin));
        let turned = points.iter().enumerate().map(|(a, _)| u(a).norm()).fold(0.0, f64::max);
        assert!(turned > 0.05, "{supports:?}: {turned}");
        // -k int u dA over the face, which is affine: by the mean of its corners
        let face: Vec<usize> = (0..points.len()).filter(|&a| points[a].x == 2.0 && (points[a].y != 0.5)).collect();
        let bed = face.iter().map(|&a| u(a)).sum::<Vec3>() * (-0.4 / face.len() as f64);
        let held = state_reactions(&solid, &state)?;
        let rest = held + bed + Vec3::new(0.0, 0.2, -0.6);
        assert!(rest.norm() < 1e-9, "{supports:?}: {held:?} {bed:?}");
        assert_eq!(solid.negative_pivots(&state)?, 0);
    }
    Ok(())
}

/// What all supports together exert.
fn state_reactions(solid: &Solid, state: &State) -> Outcome<Vec3> {
    Ok(solid.reactions(None, state)?.into_iter().map(|(_, force)| Vec3::from(force)).sum())
}

/// A body that is held as a whole stays where it is, whatever constraints that fulfils.
#[test]
fn a_body_that_is_held_stays() -> Outcome {
    let solid = bar(&[("face", [true; 3])])?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let u = &state.u[..solid.discretization().dofs()];
    assert!(u.iter().all(|u| u.abs() < 1e-14), "{u:?}");
    let held = state_reactions(&solid, &state)?;
    assert!((held - Vec3::new(0.0, -0.2, 0.6)).norm() < 1e-12, "{held:?}");
    Ok(())
}

/// A component that is held along itself is held everywhere, as no turn leaves it there: not to first order, which would let the body begin to turn.
#[test]
fn what_is_held_along_itself_does_not_turn() -> Outcome {
    let solid = bar(&[("along", [true, false, false]), ("corner", [true; 3])])?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let n = solid.mesh().points().len();
    assert!((0..n).all(|a| state.u[3 * a].abs() < 1e-14));
    // about x it may turn, by the force along y and the weight
    let turned = (0..n).map(|a| state.u[3 * a + 1].abs()).fold(0.0, f64::max);
    assert!(turned > 0.05, "{turned}");
    let (mesh, all) = (solid.mesh(), solid.mesh().points());
    let length = |a: usize, b: usize| {
        let at = |k: usize| Vec3::from(all[k]) + Vec3::new(state.u[3 * k], state.u[3 * k + 1], state.u[3 * k + 2]);
        (at(a) - at(b)).norm() / (Vec3::from(all[a]) - Vec3::from(all[b])).norm()
    };
    assert!((1..mesh.points().len()).all(|a| (length(a, 0) - 1.0).abs() < 1e-12));
    Ok(())
}

#[test]
fn what_no_simplex_holds_is_refused() -> Outcome {
    let moved = Solid::new(box_mesh([2.0, 1.0, 1.0], [2, 1, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .displace("x-", [Some(0.1), None, None])?
        .rigid(&RigidBody::new("bar", "body"));
    let moved = moved.map(|_| ()).map_err(|error: FemError| error.to_string());
    assert!(
        moved.as_ref().is_err_and(|said| said.contains("moves node") && said.contains("hold components at zero")),
        "{moved:?}"
    );
    Ok(())
}
