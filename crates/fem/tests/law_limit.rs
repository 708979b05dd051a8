//! A law with a limit of its own: the solve up to it, and the typed failure beyond.

use nastic_energy::{EnergyTerm, Gent, NeoHooke, Outside, PointBatch, Response, Slot, Slots, Turgor, Want};
use nastic_fem::{Solid, SolveOptions, StateError};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Mat3;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const MU: f64 = 1e5;
const JM: f64 = 3.0;

/// A cube between plates that part in x and let it contract.
fn pulled(stretch: f64) -> Outcome<Solid> {
    let mut solid = Solid::new(box_mesh([1.0; 3], [2, 2, 2], CellKind::Hex8)?)?;
    solid = solid.material("body", Gent::new(MU, JM, 1e4 * MU)?)?;
    for (surface, axis) in [("x-", 0), ("y-", 1), ("z-", 2)] {
        solid = solid.displace(surface, [0, 1, 2].map(|c| (c == axis).then_some(0.0)))?;
    }
    Ok(solid.displace("x+", [Some(stretch - 1.0), None, None])?)
}

/// `I1' - 3 = l^2 + 2/l - 3` reaches 3 at l = 2.2618 (the volume hardly changes).
#[test]
fn up_to_the_limit_and_beyond() -> Outcome {
    let l = 2.0f64;
    let solid = pulled(l)?;
    let state = solid.solve(&solid.controls(), &SolveOptions::default())?;
    let forces = solid.body().evaluate(&state.u, &state.controls, true, true)?.force;
    let reactions = solid.supports().reactions(&forces);
    let force: f64 = reactions.iter().filter(|(name, _)| name == "x+").map(|(_, force)| force[0]).sum();
    let expected = MU * JM / (JM - (l * l + 2.0 / l - 3.0)) * (l - 1.0 / (l * l));
    assert!((force / expected - 1.0).abs() < 2e-3, "{force} {expected}");
    // free to contract, it swells rather than reach its limit; held at its volume, it cannot
    let swollen = pulled(2.4)?;
    swollen.solve(&swollen.controls(), &SolveOptions::default())?;
    let side = 2.4f64.powf(-0.5) - 1.0;
    let solid = swollen.displace("y+", [None, Some(side), None])?.displace("z+", [None, None, Some(side)])?;
    let error = match solid.solve(&solid.controls(), &SolveOptions::default()) {
        Err(error @ StateError::Inadmissible { .. }) => error,
        other => return Err(format!("not a typed failure: {other:?}").into()),
    };
    assert_eq!(error.code(), "outside_domain");
    let message = error.to_string();
    assert!(
        message.contains("left the domain of its law") && message.contains("gent: J^(-2/3) |F|^2 - 3"),
        "{message}"
    );
    let StateError::Inadmissible { at, last, load, .. } = &error else { return Err("inverted".into()) };
    assert!(
        at.outside().is_some_and(|outside| outside.limit == JM && outside.value >= JM)
            && at.cell().is_some_and(|at| at.jacobian > 0.0)
    );
    // it fails on the way, not at its start
    assert!(*load > 0.5 && last.u.iter().all(|u| u.is_finite()), "{load}");
    Ok(())
}

/// A turgor for volumes up to `most` alone, which says that the point of the given number is beyond.
#[derive(Debug)]
struct Bladder {
    most: f64,
    named: usize,
}

impl EnergyTerm for Bladder {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        Turgor::new().respond(at, m, want, out);
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        Turgor::new().stress_change(at, m, change, out);
    }

    fn check_domain(&self, at: &PointBatch, _: Slots) -> Result<(), Outside> {
        let Some(value) = at.kinematics.iter().map(|k| k.j()).find(|j| *j > self.most) else { return Ok(()) };
        Err(Outside { law: "bladder", measure: "J", value, limit: self.most, meaning: "its skin", point: self.named })
    }

    fn slots(&self) -> &[Slot] {
        const { &[Slot::scalar("pressure", "Pa")] }
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        Turgor::new().stress_by_control(at, m, out);
    }
}

/// A cube with a bladder, and the displacement of a state of volume 1.2^3.
fn swollen(bladder: Bladder) -> Outcome<(Solid, Vec<f64>)> {
    let mut solid = Solid::new(box_mesh([1.0; 3], [1, 1, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "bladder", bladder)?;
    for (surface, axis) in [("x-", 0), ("y-", 1), ("z-", 2)] {
        solid = solid.displace(surface, [0, 1, 2].map(|c| (c == axis).then_some(0.0)))?;
    }
    let u = solid.mesh().points().iter().flat_map(|x| x.map(|x| 0.2 * x)).collect();
    Ok((solid, u))
}

/// Actuations have domains as passive laws do, whatever asks them.
#[test]
fn an_actuation_is_not_asked_beyond_its_domain() -> Outcome {
    let (solid, u) = swollen(Bladder { most: 2.0, named: 0 })?;
    solid.body().evaluate(&u, &solid.controls(), true, false)?;
    let (solid, u) = swollen(Bladder { most: 1.5, named: 3 })?;
    let error = solid.body().evaluate(&u, &solid.controls(), true, false).unwrap_err();
    assert!(error.outside().is_some_and(|outside| outside.law == "bladder" && outside.limit == 1.5), "{error}");
    assert!(error.cell().is_some_and(|at| at.point == 3 && (at.jacobian - 1.2f64.powi(3)).abs() < 1e-12), "{error:?}");
    Ok(())
}

/// The fields of a state are refused as its energy is.
#[test]
fn no_stresses_beyond_the_domain() -> Outcome {
    for material in [true, false] {
        let (mut solid, u) = swollen(Bladder { most: if material { 2.0 } else { 1.5 }, named: 0 })?;
        let mut state = solid.solve(&solid.controls(), &SolveOptions::default())?;
        solid.cell_fields(&state)?;
        state.u = u.into();
        if material {
            solid.cell_fields(&state)?;
            solid = solid.material("body", Gent::new(MU, 1e-3, MU)?)?;
            // of one stretch in all directions alone Gent bears any: shear it
            let sheared = |(node, x): (usize, &[f64; 3])| Arc::make_mut(&mut state.u)[3 * node] += 0.3 * x[1];
            solid.mesh().points().iter().enumerate().for_each(sheared);
        }
        let law = if material { "gent" } else { "bladder" };
        for found in [solid.cell_fields(&state).err(), solid.nodal_stresses(&state).err()] {
            let outside =
                found.and_then(|error| error.outside().cloned()).ok_or(format!("{law} was asked beyond its domain"))?;
            assert_eq!(outside.law, law);
        }
    }
    Ok(())
}

/// A law of a user's own that numbers its points wrongly is refused, not followed.
#[test]
fn a_point_that_the_cell_does_not_have() -> Outcome {
    let (solid, u) = swollen(Bladder { most: 1.5, named: 99 })?;
    let error = solid.body().evaluate(&u, &solid.controls(), true, false).unwrap_err();
    assert!(error.cell().is_some_and(|at| at.point == 99 && at.jacobian.is_nan()), "{error:?}");
    assert!(error.to_string().contains("bladder: J = 1.728"), "{error}");
    Ok(())
}
