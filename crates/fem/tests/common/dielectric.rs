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

/// The density `-eps/2 J |e|^2`, `e = F^-T grad phi`.
#[derive(Debug)]
pub struct Dielectric {
    permittivity: f64,
    fields: [Field; 1],
}

impl Dielectric {
    pub fn on(disc: &Arc<Discretization>, permittivity: f64) -> CellSum<Self> {
        CellSum::new(Dielectric { permittivity, fields: [Field::saddle("phi", 1)] }, disc)
    }
}

/// `F^-1` and J of `F = 1 + grad u`.
pub fn inverse(gradients: &[[HyperDual; 3]]) -> ([[HyperDual; 3]; 3], HyperDual) {
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
        let e = |i: usize| (0..3).map(|k| inverse[k][i].real() * at.gradients[3][k].real()).sum::<f64>();
        -0.5 * self.permittivity * j.real() * (0..3).map(|i| e(i).powi(2)).sum::<f64>()
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        let ((inverse, j), slope) = (inverse(&at.gradients), at.gradients[3]);
        let sum = |of: &dyn Fn(usize) -> HyperDual| of(0) + of(1) + of(2);
        let e: [HyperDual; 3] = std::array::from_fn(|i| sum(&|k| inverse[k][i] * slope[k]));
        let w: [HyperDual; 3] = std::array::from_fn(|k| sum(&|i| inverse[k][i] * e[i]));
        let (factor, half) = (j * HyperDual::constant(-self.permittivity), HyperDual::constant(0.5));
        let square = half * sum(&|i| e[i] * e[i]);
        out.fluxes[3] = w.map(|w| factor * w);
        for (i, k) in (0..3).flat_map(|i| (0..3).map(move |k| (i, k))) {
            out.fluxes[i][k] = factor * (square * inverse[k][i] - e[i] * w[k]);
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
