//! Masses on every kind of cell against closed forms, and what inertia and Rayleigh damping refuse.

use crate::common;

use common::{Outcome, distorted, kinds, largest, nodal, noise, unit};
use nastic_energy::NeoHooke;
use nastic_fem::{Cavity, Inertia, Instant, Solid, TimeStep};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const DENSITY: f64 = 7.0;

fn body(kind: CellKind, inertia: Inertia) -> Outcome<Solid> {
    Ok(Solid::new(unit(kind, 2)?)?.material("body", NeoHooke::new(1.0, 2.0)?)?.inertia(inertia)?)
}

/// `v . M v` of a velocity field.
fn twice_kinetic(solid: &Solid, v: &[f64]) -> Outcome<f64> {
    let mut product = vec![0.0; v.len()];
    solid.model().energies().mass()?.multiply(v, &mut product);
    Ok(v.iter().zip(&product).map(|(v, p)| v * p).sum())
}

/// Of the unit cube (square) about its corner: `int rho |w x X|^2`, which the consistent mass integrates exactly.
#[test]
fn a_rotation_has_its_kinetic_energy() -> Outcome {
    for kind in kinds() {
        let consistent = body(kind, Inertia::new("body", DENSITY))?;
        let v = nodal(consistent.mesh(), |x| Vec3::new(-x.y, x.x, 0.0));
        let expected = DENSITY * 2.0 / 3.0;
        let found = twice_kinetic(&consistent, &v)?;
        assert!((found / expected - 1.0).abs() < 1e-12, "{kind}: {found} instead of {expected}");
        let lumped = twice_kinetic(&body(kind, Inertia::new("body", DENSITY).lumped())?, &v)?;
        assert!((lumped / expected - 1.0).abs() < 0.15, "{kind}, lumped: {lumped} instead of {expected}");
    }
    Ok(())
}

/// The mass is that of the body, quadratic cells have no negative nodal masses, and where row sums are positive they
/// are taken.
#[test]
fn lumped_masses_are_positive_and_sum_to_the_mass() -> Outcome {
    for kind in kinds() {
        let mesh = distorted(unit(kind, 2)?, 0.05)?;
        let solid = Solid::new(mesh)?.inertia(Inertia::new("body", 3.0).and("body", 4.0).lumped())?;
        let diagonal = solid.model().energies().mass()?.diagonal();
        assert!(diagonal.iter().all(|&m| m > 0.0), "{kind}");
        let sum: f64 = diagonal.iter().step_by(solid.discretization().dim()).sum();
        assert!((sum - DENSITY).abs() < 1e-12 * DENSITY, "{kind}: {sum}");
        let rest = solid.rest();
        let quantities = solid.model().quantities(&Instant::new(&rest.u, &rest.controls, 1.0))?;
        assert!(quantities.iter().any(|(_, name, mass)| *name == "mass" && (mass - DENSITY).abs() < 1e-12 * DENSITY));
        if kind.order() == 1 {
            let consistent = body(kind, Inertia::new("body", DENSITY))?;
            let ones = vec![1.0; consistent.discretization().dofs()];
            let mut sums = vec![0.0; ones.len()];
            consistent.model().energies().mass()?.multiply(&ones, &mut sums);
            let lumped = body(kind, Inertia::new("body", DENSITY).lumped())?.model().energies().mass()?.diagonal();
            let error = sums.iter().zip(&lumped).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13, "{kind}: {error:e}");
        }
    }
    Ok(())
}

/// A cavity's lid changes the sparsity pattern that the mass was made on: same residual and tangent in either order.
#[test]
fn inertia_is_the_same_before_and_after_a_coupling() -> Outcome {
    let rows = nastic_fem::catalogue::CATALOGUE;
    let cup = (rows.iter().find(|row| row.name == "dead load").ok_or("no cup")?.example)()?;
    let inertia = || Inertia::new("body", DENSITY);
    let cavity = || Cavity::new("air", "inside").lid();
    let one = cup.clone().inertia(inertia())?.rayleigh_damping(0.5, 0.1)?.cavity(cavity())?;
    let other = cup.cavity(cavity())?.inertia(inertia())?.rayleigh_damping(0.5, 0.1)?;
    let u: Vec<f64> = (0..one.rest().u.len()).map(|i| 1e-3 * noise(i)).collect();
    let direction: Vec<f64> = (0..u.len()).map(|i| noise(i + 9999)).collect();
    let product = |solid: &Solid| -> Outcome<Vec<f64>> {
        let step = TimeStep::backward_euler(&solid.rest(), 0.01);
        let controls = solid.controls();
        let at = Instant::new(&u, &controls, 1.0).in_step(&step);
        let mut tangent = solid.model().tangents().matrix();
        solid.model().tangents().add_tangent(&at, &mut tangent)?;
        let mut out = vec![0.0; u.len()];
        tangent.multiply(&direction, &mut out);
        Ok(out)
    };
    let (a, b) = (product(&one)?, product(&other)?);
    let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
    assert!(largest(&difference) < 1e-12 * largest(&a), "{:e} of {:e}", largest(&difference), largest(&a));
    Ok(())
}

#[test]
fn what_makes_no_mass_is_refused() -> Outcome {
    let refused = |inertia: Inertia| body(CellKind::Hex8, inertia).err().map_or(String::new(), |e| e.to_string());
    assert!(refused(Inertia::new("body", -1.0)).contains("positive"));
    assert!(refused(Inertia::new("nowhere", 1.0)).contains("nowhere"));
    let twice = body(CellKind::Hex8, Inertia::new("body", 1.0))?.inertia(Inertia::new("body", 1.0));
    assert!(twice.is_err_and(|error| error.to_string().contains("inertia")));
    let bare = Solid::new(unit(CellKind::Hex8, 2)?)?.material("body", NeoHooke::new(1.0, 2.0)?)?;
    assert!(bare.clone().rayleigh_damping(1.0, 0.0).is_err_and(|error| error.to_string().contains("mass")));
    assert!(bare.clone().rayleigh_damping(0.0, f64::NAN).is_err());
    let damped = bare.rayleigh_damping(0.0, 0.1)?;
    let late = damped.material("body", NeoHooke::new(1.0, 2.0)?);
    assert!(late.is_err_and(|error| error.to_string().contains("damping last")));
    Ok(())
}
