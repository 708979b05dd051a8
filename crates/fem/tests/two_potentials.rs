//! A law of two potentials, as a user writes it: electric and magnetic, which feel the strain and each other.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::dielectric::{between_plates, block, inverse, on_rollers};
use nastic_fem::{CellSum, Field, FormDual, FormPoint, WeakForm, check_contribution};
use nastic_linear::Symmetry;
use nastic_mesh::CellKind;
use nastic_tensor::HyperDual;

const PERMITTIVITY: f64 = 0.7;
const PERMEABILITY: f64 = 0.4;
const COUPLING: f64 = 0.3;

/// The density `-J/2 sum_ab c_ab e_a . e_b`, `e_a = F^-T grad phi_a`, with `c = [[eps, k], [k, mu]]`.
#[derive(Debug)]
struct Magnetoelectric {
    fields: [Field; 2],
}

const PAIRS: [(usize, usize, f64); 4] =
    [(0, 0, PERMITTIVITY), (0, 1, COUPLING), (1, 0, COUPLING), (1, 1, PERMEABILITY)];

impl WeakForm for Magnetoelectric {
    fn name(&self) -> &str {
        "magnetoelectric"
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn density(&self, at: &FormPoint) -> f64 {
        let (inverse, j) = inverse(&at.gradients);
        let e = |a: usize, i: usize| (0..3).map(|k| inverse[k][i].real() * at.gradients[3 + a][k].real()).sum::<f64>();
        let product = |a: usize, b: usize| (0..3).map(|i| e(a, i) * e(b, i)).sum::<f64>();
        -0.5 * j.real() * PAIRS.iter().map(|(a, b, c)| c * product(*a, *b)).sum::<f64>()
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        let (inverse, j) = inverse(&at.gradients);
        let sum = |of: &dyn Fn(usize) -> HyperDual| of(0) + of(1) + of(2);
        let e: [[HyperDual; 3]; 2] =
            [0, 1].map(|a| std::array::from_fn(|i| sum(&|k| inverse[k][i] * at.gradients[3 + a][k])));
        let w = e.map(|e| -> [HyperDual; 3] { std::array::from_fn(|k| sum(&|i| inverse[k][i] * e[i])) });
        for (a, b, c) in PAIRS {
            let factor = j * HyperDual::constant(-c);
            let half = HyperDual::constant(0.5) * sum(&|i| e[a][i] * e[b][i]);
            for k in 0..3 {
                out.fluxes[3 + a][k] = out.fluxes[3 + a][k] + factor * w[b][k];
                for i in 0..3 {
                    let pull = factor * (half * inverse[k][i] - e[a][i] * w[b][k]);
                    out.fluxes[i][k] = out.fluxes[i][k] + pull;
                }
            }
        }
    }
}

/// Between plates at which both potentials are given, psi = r phi: the block is squeezed as by one potential of permittivity `eps + 2 k r + mu r^2`.
#[test]
fn two_potentials_squeeze_a_block_together() -> Outcome {
    let (voltage, ratio, thickness) = (0.1, -0.8, 0.25);
    let solid = on_rollers(block(CellKind::Hex8, [1.0, 0.8, thickness], [2, 2, 3])?)?;
    let law = Magnetoelectric { fields: [Field::saddle("phi", 1), Field::saddle("psi", 1)] };
    let law = CellSum::new(law, solid.discretization());
    let solid = solid.contribution(law)?;
    check_contribution(solid.model(), "magnetoelectric", 3)?;
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
