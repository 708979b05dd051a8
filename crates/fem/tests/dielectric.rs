//! Dielectric films: the free film under an electric field against its closed form, pull-in, true fields, breakdown.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::{Dielectric, NeoHookeIsochoric};
use nastic_fem::{Controls, EventKind, PathOptions, Solid, State, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const MU: f64 = 1e5;
/// nearly incompressible
const KAPPA: f64 = 1e4 * MU;
const EPS: f64 = 2.5e-11;

/// `E sqrt(eps/mu)` at pull-in, `(l^-2 - l^-8)^(1/2)` with `l = 4^(1/6)`.
const PULL_IN: f64 = 0.687_364_818_5;

/// An eighth of a film with electrodes below and above, free to widen; symmetric behind its three sides.
fn film(kind: CellKind, breakdown: f64) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [1.0, 1.0, 0.1], [1, 1, 1])?)?
        .material("body", NeoHookeIsochoric::new(MU, KAPPA)?)?
        .actuate("body", "film", Dielectric::new(EPS, Vec3::z())?.with_breakdown(breakdown)?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?)
}

fn field(solid: &Solid, value: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    let points = vec![value; controls.values(0).len()];
    controls.set(0, 0, &points)?;
    Ok(controls)
}

/// The stretch in the plane of the film: the farthest node sits at (1, 1, 0.1).
fn stretch(solid: &Solid, state: &State) -> f64 {
    let corner = common::node_at(solid.mesh(), [1.0, 1.0, 0.1]).unwrap();
    1.0 + state.u[3 * corner]
}

/// `eps E^2 / mu = l^-2 - l^-8`: the free incompressible film.
#[test]
fn a_free_film_follows_its_closed_form_up_to_pull_in() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet10] {
        let solid = film(kind, 1.0)?;
        for share in [0.3, 0.6, 0.9, 0.98] {
            let e = share * PULL_IN * (MU / EPS).sqrt();
            for signed in [e, -e] {
                let state = solid.solve(&field(&solid, signed)?, &STRICT)?;
                let l = stretch(&solid, &state);
                let message = (l.powi(-2) - l.powi(-8)).sqrt() * (MU / EPS).sqrt();
                assert!((message / e - 1.0).abs() < 1e-3, "{kind:?}: at {share} the film has {message} for {e}");
                assert_eq!(solid.negative_pivots(&state)?, 0, "{kind:?} at {share} of pull-in");
            }
        }
    }
    Ok(())
}

/// The path of equilibria turns back at l = 4^(1/6) = 1.260, E = 0.6874 (mu/eps)^(1/2); behind it the film is unstable.
#[test]
fn pull_in_is_the_limit_point_of_the_closed_form() -> Outcome {
    let solid = film(CellKind::Hex8, 1.0)?;
    let top = 0.8 * (MU / EPS).sqrt();
    let options = PathOptions { step: 0.02, to_limit: true, ..PathOptions::default() };
    let to = (&field(&solid, top)?, 1.0);
    let path =
        solid.model().stability().path(&solid.rest(), to, &options, &STRICT, &mut Workspace::default(), &mut |_| ())?;
    let turn = path.events.iter().find(|event| event.kind == EventKind::LimitPoint).ok_or("no limit point")?;
    let (found, l) = (0.8 * turn.s, stretch(&solid, &turn.state));
    assert!((found / PULL_IN - 1.0).abs() < 1e-3, "pull-in at {found}, not {PULL_IN}");
    assert!((l / 4f64.powf(1.0 / 6.0) - 1.0).abs() < 1e-2, "pull-in at the stretch {l}");
    assert_eq!((turn.before, turn.after), (Some(0), Some(1)), "the inertia shows pull-in");
    Ok(())
}

/// `|E F^-T e| = E / l_z = E l^2` of the film; beyond its breakdown strength it is reported, with how far.
#[test]
fn the_true_field_grows_as_the_film_thins() -> Outcome {
    let e = 0.9 * PULL_IN * (MU / EPS).sqrt();
    let solid = film(CellKind::Hex8, 1.1 * e)?;
    let controls = field(&solid, e)?;
    let state = solid.solve(&controls, &STRICT)?;
    let peaks = solid.body().point_peaks(&state.u, &controls)?;
    let peak = &peaks[0];
    let expected = e * stretch(&solid, &state).powi(2);
    assert!((peak.value / expected - 1.0).abs() < 1e-3, "{} instead of {expected}", peak.value);
    assert_eq!((peak.actuation.as_str(), peak.quantity.name, peak.beyond), ("film", "true_field", 1));
    let (share, limit) = peak.share.ok_or("no limit")?;
    assert!((share - peak.value / limit).abs() < 1e-12 && (limit / (1.1 * e) - 1.0).abs() < 1e-12);
    let weaker = field(&solid, 0.5 * e)?;
    let state = solid.solve(&weaker, &STRICT)?;
    assert_eq!(solid.body().point_peaks(&state.u, &weaker)?[0].beyond, 0);
    Ok(())
}
