//! Homogeneous states of free and loaded blocks, against energies minimised in a single F.

use crate::common;

use common::block::Block;
use common::homogeneous::{cases, mooney_rivlin, relaxed, transverse};
use common::{Outcome, distance, kinds, largest, nodal, node_at};
use nastic_energy::{FiberTension, MaterialPoint, Turgor};
use nastic_fem::{Solid, State};
use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Vec3};

/// Every node moves by `(F - I) X`; the supports carry nothing; the potential is that of F.
fn assert_deformed(solid: &Solid, state: &State, f: &Mat3, energy: f64, what: &str) -> Outcome {
    let expected = nodal(solid.mesh(), |x| (f - Mat3::identity()) * x);
    let error = distance(&state.u, &expected);
    assert!(error < 1e-10, "{what}: u is off by {error:e}");
    let force = solid.body().evaluate(&state.u, &state.controls, true, false)?.force;
    let reaction: Vec<f64> = force.iter().zip(solid.dead_load()).map(|(f, d)| f - d).collect();
    assert!(largest(&reaction) < 1e-10, "{what}: supports of a free block carry {:e}", largest(&reaction));
    let found = state.report.energy;
    assert!((found - energy).abs() < 1e-11 * (1.0 + energy.abs()), "{what}: potential {found} instead of {energy}");
    Ok(())
}

#[test]
fn fiber_tension_deforms_a_free_block_as_one_point() -> Outcome {
    for kind in kinds() {
        let block = Block::new(kind)?;
        for case in cases()? {
            // at most 2 mu1 = 2 for the fibred law, below mu for neo-Hooke; isochoric laws bear contraction alone
            let limit = case.law.fiber_limit(MaterialPoint { cell: 0, point: 0 }, &Vec3::x());
            let tensions: &[f64] = if limit.is_some_and(|limit| limit > 0.0) { &[-1.5, 0.8] } else { &[-1.2] };
            for &m in tensions {
                let energy = |f: &Mat3| (case.density)(f) - m / 2.0 * f.column(0).norm_squared();
                let f = relaxed(kind.dim(), energy);
                let (solid, state) = block.driven(&case, FiberTension::along(Vec3::x())?, m)?;
                assert_deformed(&solid, &state, &f, energy(&f), &format!("{kind}, {}, m = {m}", case.name))?;
            }
        }
    }
    Ok(())
}

/// The two scalar equations in the stretches l along the fibre and s across it.
#[test]
fn fiber_tension_in_mooney_rivlin_meets_its_scalar_equations() -> Outcome {
    let [mu1, mu2, mu3] = [1e5, 2e4, 1e6];
    let block = Block::new(CellKind::Hex8)?;
    for m in [-3e5, -1e5, 1.5e5] {
        let (solid, state) = block.driven(&mooney_rivlin([mu1, mu2, mu3])?, FiberTension::along(Vec3::x())?, m)?;
        let far = node_at(solid.mesh(), [1.0; 3]).ok_or("no far corner")?;
        let [l, s, t] = [0, 1, 2].map(|c| 1.0 + state.u[3 * far + c]);
        let (j, log) = (l * s * s, 2.0 * (mu1 + 2.0 * mu2));
        let along = 2.0 * mu1 * l + 4.0 * mu2 * l * s * s + 2.0 * mu3 * (j - 1.0) * s * s - log / l - m * l;
        let across = 2.0 * mu1 * s + 2.0 * mu2 * (l * l * s + s.powi(3)) + 2.0 * mu3 * (j - 1.0) * l * s - log / s;
        assert!((s - t).abs() < 1e-10, "m = {m}: stretches {s} and {t} across");
        assert!(
            along.abs() < 1e-10 * mu3 && across.abs() < 1e-10 * mu3,
            "m = {m}: {along} Pa along, {across} Pa across"
        );
    }
    Ok(())
}

/// Tension at 45 degrees to the material's fibre shears the block, and a good deal.
#[test]
fn tension_oblique_to_the_fiber_shears() -> Outcome {
    let case = transverse([1.0, 0.2, 3.0, 5.0], Vec3::new(1.0, 1.0, 0.0).normalize())?;
    let (solid, state) = Block::new(CellKind::Hex8)?.driven(&case, FiberTension::along(Vec3::x())?, -1.5)?;
    let up = node_at(solid.mesh(), [0.0, 1.0, 0.0]).ok_or("no upper corner")?;
    assert!(state.u[3 * up].abs() > 0.03, "F_12 = {}", state.u[3 * up]);
    Ok(())
}

#[test]
fn turgor_swells_a_free_block_as_one_point() -> Outcome {
    for kind in kinds() {
        let block = Block::new(kind)?;
        for case in cases()? {
            for m in [-1.0, 2.0] {
                let energy = |f: &Mat3| (case.density)(f) - m * (f.determinant() - 1.0);
                let f = relaxed(kind.dim(), energy);
                let (solid, state) = block.driven(&case, Turgor::new(), m)?;
                assert_deformed(&solid, &state, &f, energy(&f), &format!("{kind}, {}, m = {m}", case.name))?;
            }
        }
    }
    Ok(())
}

#[test]
fn traction_stretches_a_block_as_one_point() -> Outcome {
    for kind in kinds() {
        let block = Block::new(kind)?;
        for case in cases()? {
            for t in [-1.0, 1.5] {
                let energy = |f: &Mat3| (case.density)(f) - t * f[(0, 0)];
                let f = relaxed(kind.dim(), energy);
                let (solid, state) = block.pulled(&case, &[("x", Vec3::x() * t)])?;
                // the dead load's work starts at rest
                assert_deformed(&solid, &state, &f, energy(&f) + t, &format!("{kind}, {}, t = {t}", case.name))?;
                let piola = solid.cell_fields(&state)?.piola;
                // a plane body is held in z, where a fibre may well push
                let inside = |n: &usize| n % 3 < kind.dim() && n / 3 % 3 < kind.dim();
                let expected = |n: usize| if n.is_multiple_of(9) { t } else { 0.0 };
                let off = (0..piola.len()).filter(inside).map(|n| (piola[n] - expected(n)).abs()).fold(0.0, f64::max);
                assert!(off < 1e-10, "{kind}, {}, t = {t}: P is off by {off:e}", case.name);
            }
        }
    }
    Ok(())
}

/// Under a load of 1e-7 the block obeys Hooke's law with the moduli that docs/model.md states, stretched and sheared.
#[test]
fn a_small_load_meets_the_small_strain_moduli() -> Outcome {
    const T: f64 = 1e-7;
    for kind in kinds() {
        let block = Block::new(kind)?;
        for case in cases()? {
            let (mut stretch, mut shear) = (Mat3::zeros(), Mat3::zeros());
            stretch[(0, 0)] = 1.0;
            (shear[(0, 1)], shear[(1, 0)]) = (1.0, 1.0);
            // shear stresses come in pairs
            let sheared = vec![("x", Vec3::y() * T), ("y", Vec3::x() * T)];
            let loads = [("stretch", vec![("x", Vec3::x() * T)], stretch), ("shear", sheared, shear)];
            for (name, tractions, stress) in &loads {
                // a linear answer, so that it may be found under a load of 1 where differences are exact
                let f = relaxed(kind.dim(), |f| case.small.energy(f) - stress.dot(&(f - Mat3::identity())));
                let (solid, state) = block.pulled(&case, tractions)?;
                let expected = nodal(solid.mesh(), |x| (f - Mat3::identity()) * x * T);
                let error = distance(&state.u, &expected) / largest(&expected);
                assert!(error < 1e-6, "{kind}, {}, {name}: relative error {error:e}", case.name);
            }
        }
    }
    Ok(())
}
