//! Dilatation and simple shear of every law against the formulas for their stresses, from the reactions of the supports.

use crate::common;

use common::block::STRICT;
use common::homogeneous::{Case, mooney_rivlin, neo_hooke, neo_hooke_isochoric, transverse};
use common::{Outcome, boundary_nodes, distorted, kinds, prescribe, unit, with_node_sets};
use nastic_fem::Solid;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const MR: [f64; 3] = [1.0, 0.2, 5.0];
const NH: [f64; 2] = [1.5, 4.0];
const ISO: [f64; 2] = [1.5, 5.0];
const TMR: [f64; 4] = [1.0, 0.2, 3.0, 5.0];

/// A third of the trace of P at `F = a I`, that is `W'(a) / 3`.
fn dilatations(a: f64) -> Outcome<Vec<(Case, f64)>> {
    let (j, volume) = (a.powi(3), a * a);
    let mr = 2.0 * MR[0] * a + 4.0 * MR[1] * j + 2.0 * MR[2] * (j - 1.0) * volume - 2.0 * (MR[0] + 2.0 * MR[1]) / a;
    let [mu1, mu2, mu3, mu4] = TMR;
    let tmr = 2.0 * mu1 * a + 4.0 * mu2 * j + mu3 * (2.0 * a + 4.0 * j) / 3.0 + 2.0 * mu4 * (j - 1.0) * volume
        - 2.0 * (mu1 + 2.0 * mu2 + mu3) / a;
    Ok(vec![
        (mooney_rivlin(MR)?, mr),
        (neo_hooke(NH[0], NH[1])?, NH[0] * (a - 1.0 / a) + NH[1] * (j - 1.0) * volume),
        (neo_hooke_isochoric(ISO[0], ISO[1])?, ISO[1] / 2.0 * (j - 1.0 / j) * volume),
        (transverse(TMR, Vec3::z())?, tmr),
    ])
}

#[test]
fn dilatation_takes_the_forces_of_the_formula() -> Outcome {
    for kind in kinds().filter(|kind| kind.dim() == 3) {
        for a in [0.8, 1.3] {
            for (case, expected) in dilatations(a)? {
                let mut solid = Solid::new(distorted(unit(kind, 2)?, 0.08)?)?.material("body", case.law)?;
                let sides = ["x-", "y-", "z-", "x+", "y+", "z+"];
                for (n, side) in sides.iter().enumerate() {
                    let mut values = [None; 3];
                    values[n % 3] = Some(if n < 3 { 0.0 } else { a - 1.0 });
                    solid = solid.displace(side, values)?;
                }
                let state = solid.solve(&solid.controls(), &STRICT)?;
                let force = solid.body().evaluate(&state.u, &state.controls, true, true)?.force;
                let reactions = solid.supports().reactions(&force);
                for half in [0, 3] {
                    let sum: f64 = (0..3).map(|c| reactions[half + c].1[c]).sum::<f64>() / 3.0;
                    let found = if half == 0 { -sum } else { sum };
                    let what = format!("{kind}, {}, a = {a}, {}", case.name, sides[half]);
                    assert!((found - expected).abs() < 1e-10, "{what}: {found} instead of {expected}");
                }
            }
        }
    }
    Ok(())
}

/// `P_12` at `F = I + g e_1 (x) e_2` over g.
fn shear_moduli() -> Outcome<Vec<(Case, f64)>> {
    let [mu1, mu2, mu3, _] = TMR;
    Ok(vec![
        (mooney_rivlin(MR)?, 2.0 * (MR[0] + MR[1])),
        (neo_hooke(NH[0], NH[1])?, NH[0]),
        (neo_hooke_isochoric(ISO[0], ISO[1])?, ISO[0]),
        // |F f|^2 grows when the fibre crosses the planes that slide, |H f|^2 when it lies along the motion
        (transverse(TMR, Vec3::x())?, 2.0 * (mu1 + mu2 + mu3)),
        (transverse(TMR, Vec3::y())?, 2.0 * (mu1 + mu2 + mu3)),
        (transverse(TMR, Vec3::z())?, 2.0 * (mu1 + mu2)),
    ])
}

#[test]
fn simple_shear_has_the_stress_of_the_formula() -> Outcome {
    for kind in kinds() {
        let mesh = distorted(unit(kind, 2)?, 0.08)?;
        let held = boundary_nodes(&mesh);
        let solid = Solid::new(with_node_sets(&mesh, &held)?)?;
        for g in [-0.4, 0.9] {
            for (case, modulus) in shear_moduli()? {
                let solid = solid.clone().material("body", case.law)?;
                let solid = prescribe(solid, &held, |x| Vec3::new(g * x.y, 0.0, 0.0))?;
                let state = solid.solve(&solid.controls(), &STRICT)?;
                for cell in solid.cell_fields(&state)?.piola.chunks_exact(9) {
                    let error = (cell[1] - modulus * g).abs();
                    assert!(
                        error < 1e-10,
                        "{kind}, {}, g = {g}: P_12 = {} instead of {}",
                        case.name,
                        cell[1],
                        modulus * g
                    );
                }
            }
        }
    }
    Ok(())
}

/// Reactions hold the body in balance: with the dead loads they add up to nothing, support by support as expected.
#[test]
fn reactions_balance_the_loads() -> Outcome {
    let (traction, weight) = (Vec3::new(0.02, -0.03, 0.01), Vec3::new(0.01, 0.02, -0.05));
    let point = Vec3::new(0.003, -0.004, 0.005);
    for kind in kinds() {
        let plane = kind.dim() == 2;
        let flat = |v: Vec3| if plane { Vec3::new(v.x, v.y, 0.0) } else { v };
        let mesh = distorted(unit(kind, 2)?, 0.08)?;
        let solid = Solid::new(mesh)?
            .material("body", mooney_rivlin(MR)?.law)?
            .clamp("x-")?
            .traction("x+", flat(traction))?
            .body_force("body", flat(weight))?;
        let mut force = vec![0.0; solid.dead_load().len()];
        let corner = common::node_at(solid.mesh(), [1.0, 1.0, 0.0]).ok_or("no corner")?;
        force[kind.dim() * corner..][..kind.dim()].copy_from_slice(&point.as_slice()[..kind.dim()]);
        let solid = solid.nodal_force(&force)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let force = solid.body().evaluate(&state.u, &state.controls, true, true)?.force;
        let net: Vec<f64> = force.iter().zip(solid.dead_load()).map(|(f, d)| f - d).collect();
        let reactions = solid.supports().reactions(&net);
        let [(name, found)] = reactions.as_slice() else { return Err("one support, one reaction".into()) };
        // side and body are of unit size
        let error = (Vec3::from(*found) + flat(traction + weight + point)).norm();
        assert!(name == "x-" && error < 1e-12, "{kind}: reaction {found:?} on {name}");
    }
    Ok(())
}

/// A clamp and a roller share an edge; each support sums up its own components.
#[test]
fn reactions_are_told_apart_by_support() -> Outcome {
    let solid = Solid::new(unit(CellKind::Hex8, 2)?)?
        .material("body", mooney_rivlin(MR)?.law)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?
        .displace("x+", [Some(0.5), None, None])?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let force = solid.body().evaluate(&state.u, &state.controls, true, true)?.force;
    let reactions = solid.supports().reactions(&force);
    let pull = reactions[3].1[0];
    assert!(pull > 0.5 && (reactions[0].1[0] + pull).abs() < 1e-12, "{reactions:?}");
    assert!(reactions[1..3].iter().all(|(_, r)| r.iter().all(|r| r.abs() < 1e-12)), "{reactions:?}");
    Ok(())
}
