//! What is written out about a state, cell by cell.

mod common;

use common::block::STRICT;
use common::{Outcome, curved, distorted, unit};
use nastic_energy::check::evaluate;
use nastic_energy::{EnergyTerm, FiberTension, Field, Place, TransverseMooneyRivlin, Turgor};
use nastic_fem::{QuadraturePoints, Solid};
use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Vec3};

/// Averages over a cell are integrals over its reference volume, of the law evaluated point by point.
#[test]
fn averages_are_integrals_over_the_cell() -> Outcome {
    let law = TransverseMooneyRivlin::new(1.0, 0.2, 3.0, 5.0, Vec3::new(0.6, 0.8, 0.0))?;
    let tension = FiberTension::along(Vec3::x())?;
    for kind in [CellKind::Quad9, CellKind::Hex8, CellKind::Tet10] {
        let mesh = distorted(unit(kind, 2)?, 0.12)?;
        let mesh = if kind.order() == 2 { curved(mesh, 0.04)? } else { mesh };
        let solid = Solid::new(mesh)?
            .material("body", law.clone())?
            .actuate("body", "turgor", Turgor::new())?
            .actuate("body", "tension", tension.clone())?
            .clamp("x-")?;
        let mut controls = solid.controls();
        let at = solid.discretization().points().positions(solid.mesh(), None);
        controls.set(0, 0, &at.iter().map(|x| 0.5 * x[0]).collect::<Vec<_>>())?;
        controls.set(1, 0, &at.iter().map(|x| -x[1]).collect::<Vec<_>>())?;
        let state = solid.solve(&controls, &STRICT)?;
        let fields = solid.cell_fields(&state)?;
        assert_eq!(fields.j.len(), solid.mesh().cells());
        for cell in 0..solid.mesh().cells() {
            // the cell by itself, with the body's rule
            let alone = QuadraturePoints::of_cells(solid.mesh(), [cell as u32], |kind| kind.rule().clone())?;
            let (first, _) = solid.discretization().points_of_cells()[cell];
            let (mut j, mut energy, mut piola, mut cauchy) = (0.0, 0.0, Mat3::zeros(), Mat3::zeros());
            for (q, (k, w)) in alone.kinematics(&state.u)?.iter().zip(alone.weights()).enumerate() {
                let place = Place { cell, point: first + q };
                let passive = evaluate(&law, place, k, &[]);
                let m = [controls.values(0)[first + q], controls.values(1)[first + q]];
                let driven = |law: &dyn EnergyTerm, m: f64| evaluate(law, place, k, &[m]).stress;
                let p = passive.stress + driven(&Turgor::new(), m[0]) + driven(&tension, m[1]);
                let w = w / alone.measure();
                (j, energy, piola) = (j + w * k.j(), energy + w * passive.energy, piola + p * w);
                cauchy += p * k.f().transpose() * (w / k.j());
            }
            assert!((fields.j[cell] - j).abs() < 1e-13, "{kind}: J = {} instead of {j}", fields.j[cell]);
            assert!(
                (fields.energy[cell] - energy).abs() < 1e-12,
                "{kind}: {} instead of {energy}",
                fields.energy[cell]
            );
            for (found, expected) in [(&fields.piola, piola), (&fields.cauchy, cauchy)] {
                let found = Mat3::from_row_slice(&found[9 * cell..9 * cell + 9]);
                assert!((found - expected).norm() < 1e-12, "{kind}: {found} instead of {expected}");
            }
        }
    }
    Ok(())
}

#[test]
fn directions_are_written_back_cell_by_cell() -> Outcome {
    let angle = |cell: usize| Vec3::new((0.3 * cell as f64).cos(), (0.3 * cell as f64).sin(), 0.0);
    let fibers: Vec<Vec3> = (0..8).map(angle).collect();
    let solid = Solid::new(unit(CellKind::Hex8, 2)?)?
        .material("body", TransverseMooneyRivlin::new(1.0, 0.2, 3.0, 5.0, Field::cells(fibers))?)?
        .actuate("body", "turgor", Turgor::new())?
        .actuate("body", "tension", FiberTension::along(Vec3::z())?)?
        .clamp("x-")?;
    let fields = solid.cell_fields(&solid.rest())?;
    assert_eq!(fields.directions, [("tension".to_owned(), [0.0, 0.0, 1.0].repeat(8))]);
    let expected: Vec<f64> = (0..8).flat_map(|cell| angle(cell).as_slice().to_vec()).collect();
    let found = fields.fiber.ok_or("the material has a fibre")?;
    assert!(common::distance(&found, &expected) < 1e-15);
    // and at rest there is nothing else to see
    assert!(fields.j.iter().all(|j| *j == 1.0) && common::largest(&fields.piola) < 1e-14);
    Ok(())
}

#[test]
fn a_material_without_fiber_writes_none() -> Outcome {
    let law = nastic_energy::NeoHooke::new(1.0, 2.0)?;
    let solid = Solid::new(unit(CellKind::Quad4, 1)?)?.material("body", law)?;
    let fields = solid.cell_fields(&solid.rest())?;
    assert!(fields.fiber.is_none() && fields.directions.is_empty());
    Ok(())
}
