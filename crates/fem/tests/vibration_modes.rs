//! Small vibrations: beams and rods against closed forms, free bodies, bodies under load, what is refused.

use crate::common;

use common::beam::{loaded_cantilever, timoshenko};
use common::block::STRICT;
use common::{Outcome, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Inertia, ModeKind, Solid, SolveOptions, Solver, State, StateError, TimeStepping, VibrationMode};
use nastic_linear::LinearError;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

const YOUNG: f64 = 2e6;
const DENSITY: f64 = 1100.0;

/// Without lateral contraction: a clamp holds nothing back.
fn bar(kind: CellKind, size: [f64; 3], cells: [usize; 3], inertia: Inertia) -> Outcome<Solid> {
    let law = NeoHooke::from_young_poisson(YOUNG, 0.0)?;
    Ok(Solid::new(regular(kind, size, cells)?)?.material("body", law)?.inertia(inertia)?)
}

fn consistent() -> Inertia {
    Inertia::new("body", DENSITY)
}

/// NaN of a mode that does not vibrate: it fails every comparison.
fn frequency(mode: &VibrationMode) -> f64 {
    match mode.kind() {
        ModeKind::Vibration { angular_frequency } => angular_frequency,
        ModeKind::Neutral | ModeKind::Unstable { .. } => f64::NAN,
    }
}

/// The frequencies of a kind of motion, reported by its directions, lowest first.
fn of_kind(modes: &[VibrationMode], belongs: impl Fn([f64; 3]) -> bool) -> Vec<f64> {
    modes.iter().filter(|mode| belongs(mode.directions)).map(frequency).collect()
}

/// Slenderness 10 and 7: two frequencies of bending in either direction, the first of a bar that stretches and of one
/// that twists (Saint-Venant: `w = pi/(2L) sqrt(G J / (rho I_p))`; the clamp hinders warping, which stiffens it).
#[test]
fn a_cantilever_has_the_frequencies_of_a_timoshenko_beam() -> Outcome {
    let (length, wide, thick) = (1.0, 0.14, 0.1);
    let (area, shear) = (wide * thick, 0.5 * YOUNG);
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let solid = bar(kind, [length, wide, thick], [10, 2, 2], consistent())?.clamp("x-")?;
        let modes = solid.model().vibration_modes(&solid.rest(), 8, &STRICT)?;
        for mode in &modes {
            assert!((mode.directions.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let fixed = solid.supports().fixed().iter().zip(&mode.shape);
            assert!(fixed.into_iter().all(|(fixed, x)| !fixed || *x == 0.0));
        }
        let bending = |h: f64, k: usize| {
            let i = area * h * h / 12.0;
            let kappa = 10.0 / 12.0;
            timoshenko(i / area, YOUNG * i / (kappa * shear * area), k) * (YOUNG * i / (DENSITY * area)).sqrt()
        };
        let sides = of_kind(&modes, |[_, y, z]| y > 0.6 && z < 0.1);
        let height = of_kind(&modes, |[_, y, z]| z > 0.6 && y < 0.1);
        for (name, found, h) in [("along y", &sides, wide), ("along z", &height, thick)] {
            for k in 1..=2 {
                let (found, expected) = (found[k - 1], bending(h, k));
                println!(
                    "{kind} bending {name} {k}: {found:.4}, Timoshenko {expected:.4}, {:+.2e}",
                    found / expected - 1.0
                );
                assert!((found / expected - 1.0).abs() < 0.02, "{kind}: {found} instead of {expected}");
            }
        }
        let axial = of_kind(&modes, |[x, ..]| x > 0.9)[0];
        let expected = 0.5 * PI / length * (YOUNG / DENSITY).sqrt();
        println!("{kind} axial: {axial:.6}, {expected:.6}, {:+.2e}", axial / expected - 1.0);
        assert!((axial / expected - 1.0).abs() < 1e-5, "{kind}: {axial} instead of {expected}");
        let (a, b) = (0.5 * wide, 0.5 * thick);
        let sum: f64 = (0..20).map(|n| f64::from(2 * n + 1)).map(|n| (0.5 * n * PI * a / b).tanh() / n.powi(5)).sum();
        let stiffness = a * b.powi(3) * (16.0 / 3.0 - 1024.0 / PI.powi(5) * b / a * sum);
        let polar = area * (wide * wide + thick * thick) / 12.0;
        let expected = 0.5 * PI / length * (shear * stiffness / (DENSITY * polar)).sqrt();
        let torsion = of_kind(&modes, |[x, y, z]| x < 0.1 && y > 0.1 && z > 0.1)[0];
        println!("{kind} torsion: {torsion:.4}, Saint-Venant {expected:.4}, {:+.2e}", torsion / expected - 1.0);
        assert!(torsion > expected && torsion < 1.04 * expected, "{kind}: {torsion} instead of {expected}");
    }
    Ok(())
}

/// A rod that cannot move sideways: `w_k = (k - 1/2) pi/L sqrt(E/rho)` clamped and free, `k pi/L sqrt(E/rho)` held at
/// both ends; from above with the consistent mass, by 1/8640 (pi k h)^4 .. of second order cells.
#[test]
fn a_rod_has_its_axial_frequencies() -> Outcome {
    let length = 2.0;
    let speed = (YOUNG / DENSITY).sqrt();
    for (both, lumped) in [(false, false), (true, false), (false, true)] {
        let inertia = if lumped { consistent().lumped() } else { consistent() };
        let mut solid = bar(CellKind::Hex27, [length, 0.1, 0.1], [8, 1, 1], inertia)?.clamp("x-")?;
        for side in ["y-", "y+", "z-", "z+"] {
            solid = solid.displace(side, [None, Some(0.0), Some(0.0)])?;
        }
        let solid = if both { solid.clamp("x+")? } else { solid };
        let modes = solid.model().vibration_modes(&solid.rest(), 3, &STRICT)?;
        for (k, mode) in modes.iter().enumerate() {
            let n = k as f64 + if both { 1.0 } else { 0.5 };
            let (expected, found) = (n * PI / length * speed, frequency(mode));
            let error = found / expected - 1.0;
            println!("rod, both ends {both}, lumped {lumped}, {}: {found:.6}, error {error:+.2e}", k + 1);
            assert!(error.abs() < if lumped { 2e-2 } else { 2e-3 } && (lumped || error > 0.0), "{found}, {expected}");
        }
    }
    Ok(())
}

/// Six rigid motions (three in the plane) and then the frequency `(4.73004/L)^2 sqrt(EI/(rho A))` of a free beam, for
/// either mass; as many modes as are asked for, however many zeros there are.
#[test]
fn a_free_body_has_the_rigid_motions() -> Outcome {
    let thin = 0.02;
    let expected = 4.730_041_f64.powi(2) * (YOUNG * thin * thin / 12.0 / DENSITY).sqrt();
    for (kind, cells) in [(CellKind::Hex20, [12, 1, 1]), (CellKind::Quad9, [12, 1, 1]), (CellKind::Tet10, [4, 1, 1])] {
        for inertia in [consistent(), consistent().lumped()] {
            let solid = bar(kind, [1.0, thin, 1.5 * thin], cells, inertia)?;
            let rigid = if kind.dim() == 3 { 6 } else { 3 };
            for count in [1, rigid - 1, rigid + 1] {
                let modes = solid.model().vibration_modes(&solid.rest(), count, &STRICT)?;
                assert_eq!(modes.len(), count);
                let neutral = modes.iter().filter(|mode| mode.kind() == ModeKind::Neutral).count();
                assert_eq!(neutral, rigid.min(count), "{kind}, {count}");
                if let Some(mode) = modes.get(rigid) {
                    let found = frequency(mode);
                    println!(
                        "{kind}, free beam: {found:.5} instead of {expected:.5}; {:.1e} of {:.1e}",
                        modes[0].square, mode.square
                    );
                    let tolerance = if kind == CellKind::Tet10 { 0.2 } else { 0.02 };
                    assert!((found / expected - 1.0).abs() < tolerance, "{kind}: {found} instead of {expected}");
                }
            }
        }
    }
    Ok(())
}

/// A slender strip under a dead end force of so many times its buckling load.
fn loaded(multiple: f64) -> Outcome<(Solid, State)> {
    let thin: f64 = 0.02;
    let critical = PI * PI / 4.0 * YOUNG * thin * thin / 12.0;
    let solid = bar(CellKind::Quad9, [1.0, thin, 0.0], [10, 1, 1], consistent())?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -multiple * critical)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    Ok((solid, state))
}

/// The lowest frequency falls to zero at the buckling load, grows in tension, as that of a beam with an axial force
/// does; beyond it, where `w^2` is nearly linear, the mode is unstable.
#[test]
fn an_axial_force_changes_the_frequency() -> Outcome {
    let thin: f64 = 0.02;
    let scale = YOUNG * thin * thin / 12.0 / DENSITY;
    assert!((loaded_cantilever(0.0) - 12.362_36).abs() < 1e-4);
    for multiple in [-4.0, -1.0, 0.0, 0.5, 0.9, 0.99] {
        let (solid, state) = loaded(multiple)?;
        let mode = solid.model().vibration_modes(&state, 1, &STRICT)?.swap_remove(0);
        let (found, expected) = (mode.square / scale, loaded_cantilever(multiple));
        println!("P = {multiple:5} Pcr: w^2 L^4 rho A/(E I) = {found:.5}, beam {expected:.5}");
        assert!(
            (found - expected).abs() < 0.01 * expected + 0.005 * 12.36,
            "{multiple}: {found} instead of {expected}"
        );
    }
    let (solid, state) = loaded(1.1)?;
    let modes = solid.model().vibration_modes(&state, 2, &STRICT)?;
    let ModeKind::Unstable { rate } = modes[0].kind() else { return Err(format!("{:?}", modes[0].kind()).into()) };
    let (found, expected) = (rate * rate / scale, (loaded_cantilever(0.9) - loaded_cantilever(0.99)) / 0.9);
    assert!((found / expected - 1.0).abs() < 0.03, "{found} instead of {expected}");
    assert!(frequency(&modes[1]) > 0.0);
    Ok(())
}

/// `1/2 w^2 m` is the energy of a mode of amplitude 1: of the rod's first, `sin(pi x/2L)`, m is half the mass.
#[test]
fn modal_masses_belong_to_shapes_with_a_largest_component_of_one() -> Outcome {
    let solid = bar(CellKind::Hex20, [1.0, 0.05, 0.05], [10, 1, 1], consistent())?.clamp("x-")?;
    let solid = ["y-", "y+", "z-", "z+"]
        .into_iter()
        .try_fold(solid, |s, side| s.displace(side, [None, Some(0.0), Some(0.0)]))?;
    let mode = solid.model().vibration_modes(&solid.rest(), 1, &STRICT)?.swap_remove(0);
    assert_eq!(largest(&mode.shape), 1.0);
    let half = 0.5 * DENSITY * 0.05 * 0.05;
    assert!((mode.modal_mass / half - 1.0).abs() < 1e-4, "{} instead of {half}", mode.modal_mass);
    Ok(())
}

#[test]
fn what_does_not_vibrate_is_a_typed_error() -> Outcome {
    let law = NeoHooke::from_young_poisson(YOUNG, 0.0)?;
    let bare = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?.material("body", law)?.clamp("x-")?;
    let refused = bare.model().vibration_modes(&bare.rest(), 1, &SolveOptions::default());
    assert!(refused.is_err_and(|error| error.to_string().contains("density")));
    let solid = bare.inertia(consistent())?;
    let refused = solid.model().vibration_modes(&solid.rest(), 13, &SolveOptions::default());
    let too_many = StateError::Linear(LinearError::EigenpairCount { count: 13, unknowns: 12 });
    assert!(refused.is_err_and(|error| error.to_string() == too_many.to_string()));
    Ok(())
}

/// With the consistent mass, held and free.
#[test]
fn vibrations_need_no_factor() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let free = || bar(kind, [1.0, 0.2, 0.1], [6, 2, 2], consistent());
        for solid in [free()?, free()?.clamp("x-")?] {
            let of = |solver| {
                let how = SolveOptions { solver: Some(solver), ..STRICT };
                solid.model().vibration_modes(&solid.rest(), 8, &how)
            };
            let (direct, products) = (of(Solver::DIRECT)?, of(Solver::MULTIGRID)?);
            assert!(direct.iter().all(|mode| mode.counted) && products.iter().all(|mode| !mode.counted), "{kind}");
            assert!(direct.iter().all(|mode| mode.by_products.is_none()), "{kind}");
            let shown = products.iter().map(|mode| mode.by_products);
            assert!(shown.into_iter().all(|how| how.is_some_and(|(n, error)| n > 0 && error <= 1e-7)), "{kind}");
            let largest = direct[7].square;
            for (a, b) in direct.iter().zip(&products) {
                assert!((a.square - b.square).abs() < 1e-9 * largest, "{kind}: {:e}, {:e}", a.square, b.square);
                assert!(a.kind() == b.kind() || a.kind() != ModeKind::Neutral && b.kind() != ModeKind::Neutral);
                assert!((a.modal_mass / b.modal_mass - 1.0).abs() < 1e-5 || a.kind() == ModeKind::Neutral, "{kind}");
            }
        }
    }
    Ok(())
}
