//! A law of two potentials, as a user writes it: electric and magnetic, which feel the strain and each other.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::dielectric::{Dielectric, between_plates, block, on_rollers};
use nastic_fem::check_contribution;
use nastic_mesh::CellKind;

const PERMITTIVITY: f64 = 0.7;
const PERMEABILITY: f64 = 0.4;
const COUPLING: f64 = 0.3;

/// Between plates at which both potentials are given, psi = r phi: the block is squeezed as by one potential of permittivity `eps + 2 k r + mu r^2`.
#[test]
fn two_potentials_squeeze_a_block_together() -> Outcome {
    let (voltage, ratio, thickness) = (0.1, -0.8, 0.25);
    let solid = on_rollers(block(CellKind::Hex8, [1.0, 0.8, thickness], [2, 2, 3])?)?;
    let pairs = vec![(0, 0, PERMITTIVITY), (0, 1, COUPLING), (1, 0, COUPLING), (1, 1, PERMEABILITY)];
    let law = Dielectric::of(solid.discretization(), &["phi", "psi"], pairs);
    let solid = solid.contribution(law)?;
    check_contribution(solid.model(), "dielectric", 3)?;
    let solid = solid.hold("phi", 0, "z-", 0.0)?.hold("phi", 0, "z+", voltage)?;
    let solid = solid.hold("psi", 0, "z-", 0.0)?.hold("psi", 0, "z+", ratio * voltage)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let u = solid.model().displacement(&state.u);
    let top = common::node_at(solid.mesh(), [1.0, 0.8, thickness]).ok_or("no node")?;
    let (along, across) = (1.0 + u[3 * top + 2] / thickness, 1.0 + u[3 * top]);
    let effective = PERMITTIVITY + 2.0 * COUPLING * ratio + PERMEABILITY * ratio * ratio;
    let [expected, found] = between_plates(effective, along, thickness);
    assert!(along < 0.995 && (across - expected).abs() < 1e-10, "{along} {across} {expected}");
    assert!((found - voltage).abs() < 1e-9, "{found}");
    assert_eq!(solid.model().stability().negative_pivots(&state)?, 0);
    Ok(())
}
