//! An electric potential in a body that is a dielectric: a field in which the potential has a maximum.

use super::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{CellSum, Discretization, Field, FormDual, FormPoint, Solid, WeakForm};
use nastic_linear::Symmetry;
use nastic_mesh::CellKind;
use nastic_tensor::HyperDual;
use std::sync::Arc;

pub const MU: f64 = 1.0;
pub const LAMBDA: f64 = 4.0;

/// The density `-J/2 sum_ab c_ab e_a . e_b`, `e_a = F^-T grad phi_a`, of potentials phi_a.
#[derive(Debug)]
pub struct Dielectric {
    fields: Vec<Field>,
    /// `a, b, c_ab`
    pairs: Vec<(usize, usize, f64)>,
}

impl Dielectric {
    /// Of one potential.
    pub fn on(disc: &Arc<Discretization>, permittivity: f64) -> CellSum<Self> {
        Self::of(disc, &["phi"], vec![(0, 0, permittivity)])
    }

    pub fn of(disc: &Arc<Discretization>, names: &[&'static str], pairs: Vec<(usize, usize, f64)>) -> CellSum<Self> {
        let fields = names.iter().map(|name| Field::saddle(name, 1)).collect();
        CellSum::new(Dielectric { fields, pairs }, disc)
    }
}

/// `F^-1` and J of `F = 1 + grad u`.
fn inverse(gradients: &[[HyperDual; 3]]) -> ([[HyperDual; 3]; 3], HyperDual) {
    let unit = |i: usize, j: usize| HyperDual::constant(f64::from(u8::from(i == j)));
    let f: [[HyperDual; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| gradients[i][j] + unit(i, j)));
    let minor = |i: usize, j: usize| {
        let at = |a: usize, b: usize| f[(i + a) % 3][(j + b) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let j = f[0][0] * minor(0, 0) + f[0][1] * minor(0, 1) + f[0][2] * minor(0, 2);
    (std::array::from_fn(|a| std::array::from_fn(|b| minor(b, a) / j)), j)
}

impl WeakForm for Dielectric {
    fn name(&self) -> &str {
        "dielectric"
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
        -0.5 * j.real() * self.pairs.iter().map(|(a, b, c)| c * product(*a, *b)).sum::<f64>()
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        let (inverse, j) = inverse(&at.gradients);
        let sum = |of: &dyn Fn(usize) -> HyperDual| of(0) + of(1) + of(2);
        let e =
            |slope: &[HyperDual; 3]| -> [HyperDual; 3] { std::array::from_fn(|i| sum(&|k| inverse[k][i] * slope[k])) };
        let e: Vec<[HyperDual; 3]> = at.gradients[3..].iter().map(e).collect();
        let w = |e: &[HyperDual; 3]| -> [HyperDual; 3] { std::array::from_fn(|k| sum(&|i| inverse[k][i] * e[i])) };
        let w: Vec<[HyperDual; 3]> = e.iter().map(w).collect();
        for &(a, b, c) in &self.pairs {
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

/// A neo-Hookean block.
pub fn block(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, size, cells)?)?.material("body", NeoHooke::new(MU, LAMBDA)?)?)
}

/// On rollers, so that it strains alike everywhere.
pub fn on_rollers(solid: Solid) -> Outcome<Solid> {
    let hold = |c: usize| -> [Option<f64>; 3] { std::array::from_fn(|i| (i == c).then_some(0.0)) };
    Ok(solid.displace("x-", hold(0))?.displace("y-", hold(1))?.displace("z-", hold(2))?)
}

/// The stretch a across the field and the voltage V of a block between two plates at a distance h that has the stretch c along the field: the elastic stress against the pair
/// `eps E^2 / 2`, a pull across and a push along it, with `E = V / (c h)`.
pub fn between_plates(permittivity: f64, along: f64, thickness: f64) -> [f64; 2] {
    let stresses = |across: f64| {
        let j = across * across * along;
        let pressure = LAMBDA * (j - 1.0) - MU / j;
        [across, along].map(|stretch| MU * stretch * stretch / j + pressure)
    };
    // their sum is zero, and rises with the stretch
    let (mut low, mut high) = (0.5, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if stresses(middle).iter().sum::<f64>() < 0.0 { low = middle } else { high = middle }
    }
    let pair = stresses(low)[0].max(0.0);
    [low, along * thickness * (2.0 * pair / permittivity).sqrt()]
}
