//! A law with a limit of its own: the solve up to it, and the typed failure beyond.

use nastic_energy::Gent;
use nastic_fem::{Solid, SolveOptions, StateError};
use nastic_mesh::{CellKind, box_mesh};

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
        Err(error @ StateError::Inverted { .. }) => error,
        other => return Err(format!("not a typed failure: {other:?}").into()),
    };
    assert_eq!(error.code(), "outside_domain");
    let message = error.to_string();
    assert!(
        message.contains("left the domain of its law") && message.contains("gent: J^(-2/3) |F|^2 - 3"),
        "{message}"
    );
    let StateError::Inverted { at, last, load, .. } = &error else { return Err("inverted".into()) };
    assert!(at.outside.is_some_and(|outside| outside.limit == JM && outside.value >= JM) && at.jacobian > 0.0);
    // it fails on the way, not at its start
    assert!(*load > 0.5 && last.u.iter().all(|u| u.is_finite()), "{load}");
    Ok(())
}
