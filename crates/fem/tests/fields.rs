//! What is written out about a state, cell by cell.

use crate::common;

use common::block::STRICT;
use common::{Outcome, curved, distorted, unit};
use nastic_energy::check::evaluate;
use nastic_energy::{EnergyTerm, FiberTension, Field, MaterialPoint, TransverseMooneyRivlin, Turgor};
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
                let place = MaterialPoint { cell, point: first + q };
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

/// Strain of a known motion, smoothed values of known fields, forces of supports: each against what defines it.
#[test]
fn strains_smoothed_values_and_reactions_are_what_they_say() -> Outcome {
    for kind in [CellKind::Quad8, CellKind::Tet4, CellKind::Hex20, CellKind::Tet10] {
        let solid = Solid::new(unit(kind, 2)?)?
            .material("body", nastic_energy::NeoHooke::new(1.0, 2.0)?)?
            .clamp("x-")?
            .displace("x+", [Some(0.2), None, None])?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let (disc, dim) = (solid.discretization(), solid.mesh().dim());

        let f = state.u.len();
        let shear: Vec<f64> =
            (0..f).map(|i| if i % dim == 0 { 0.3 * solid.mesh().points()[i / dim][1] } else { 0.0 }).collect();
        let sheared = nastic_fem::State { u: shear.into(), ..state.clone() };
        let expected = [0.0, 0.15, 0.0, 0.15, 0.045, 0.0, 0.0, 0.0, 0.0];
        for strain in solid.cell_strains(&sheared)?.chunks_exact(9) {
            assert!(common::distance(strain, &expected) < 1e-12, "{kind}: {strain:?}");
        }

        // A constant comes back at every node; so does the integral of any field, against the corners' functions.
        let constant = disc.nodal_average(&[2.0, -1.0].repeat(disc.points().len()), 2);
        assert!(constant.chunks_exact(2).all(|v| common::distance(v, &[2.0, -1.0]) < 1e-12), "{kind}");
        let at: Vec<f64> = disc.points().positions(solid.mesh(), None).iter().map(|x| x[0]).collect();
        let smooth = disc.nodal_average(&at, 1);
        for (node, x) in solid.mesh().points().iter().enumerate() {
            let (value, most) = (smooth[node], 0.26);
            assert!((value - x[0]).abs() < most && value > 0.0 && value < 1.0, "{kind}: {value} at {x:?}");
        }
        let uniform =
            nastic_fem::State { u: sheared.u.iter().map(|u| 0.1 * u).collect::<Vec<_>>().into(), ..state.clone() };
        let cells = solid.cell_fields(&uniform)?.cauchy;
        for stress in solid.nodal_stresses(&uniform)?.chunks_exact(9) {
            assert!(common::distance(stress, &cells[..9]) < 1e-12, "{kind}: one stress everywhere");
        }

        let nodal = solid.nodal_reactions(&state)?;
        let at = nastic_fem::Instant::new(&state.u, &state.controls, state.load);
        let force = solid.model().evaluate(&at, nastic_fem::Demand { energy: false, force: true })?.force;
        for (surface, total) in solid.supports().reactions(&force) {
            let nodes = solid.nodes_of(surface.as_str())?;
            let sum: Vec<f64> = (0..3).map(|c| nodes.iter().map(|a| nodal[3 * *a as usize + c]).sum()).collect();
            assert!(common::distance(&sum, &total) < 1e-12 && total[0].abs() > 0.1, "{kind}: {sum:?}, {total:?}");
        }
        let held: Vec<u32> = ["x-", "x+"].iter().flat_map(|s| solid.nodes_of(*s).unwrap_or_default()).collect();
        let free = |(node, _): &(usize, &[f64])| !held.contains(&(*node as u32));
        assert!(nodal.chunks_exact(3).enumerate().filter(free).all(|(_, force)| force == [0.0; 3]));
    }
    Ok(())
}
