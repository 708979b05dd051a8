//! A scalar field on the nodes of a body, coupled one way: it pushes the body.

use nastic_energy::Slot;
use nastic_fem::{CellSum, Discretization, Field, FormDual, FormPoint, WeakForm};
use nastic_linear::Symmetry;
use nastic_tensor::HyperDual;
use std::sync::Arc;

/// `-k div grad phi = f` on the reference body, f a control, and a body force `push phi e_x`.
#[derive(Debug)]
pub struct Poisson {
    conductivity: f64,
    push: f64,
    fields: [Field; 1],
}

pub const SOURCE: [Slot; 1] = [Slot::scalar("source", "1")];

impl Poisson {
    pub fn on(disc: &Arc<Discretization>, conductivity: f64, push: f64) -> CellSum<Self> {
        CellSum::new(Poisson { conductivity, push, fields: [Field::nodal("phi", 1)] }, disc)
    }
}

impl WeakForm for Poisson {
    fn name(&self) -> &str {
        "poisson"
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn slots(&self) -> &[Slot] {
        &SOURCE
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        out.sources[0] = at.values[3] * HyperDual::constant(-self.push);
        out.sources[3] = -at.controls[0];
        out.fluxes[3] = at.gradients[3].map(|slope| slope * HyperDual::constant(self.conductivity));
    }
}

/// The nodal forces `push int phi N_a dX` of a field, flat over the displacement.
pub fn forces(disc: &Discretization, push: f64, phi: &[f64]) -> Vec<f64> {
    let points = disc.points();
    let at_points = points.interpolate(phi, 1);
    let pushed: Vec<f64> =
        at_points.iter().zip(points.weights()).flat_map(|(phi, w)| [push * w * phi, 0.0, 0.0]).collect();
    let mut out = vec![0.0; disc.dofs()];
    points.spread(&pushed, 3, &mut out);
    out
}

/// The potential `(1 + phi^2)/2 |grad phi|^2 + phi u_x + phi div u - f phi`: not linear, and coupled both ways by values and gradients.
#[derive(Debug)]
pub struct Coupled {
    fields: [Field; 1],
}

impl Coupled {
    pub fn on(disc: &Arc<Discretization>) -> CellSum<Self> {
        CellSum::new(Coupled { fields: [Field::nodal("theta", 1)] }, disc)
    }
}

impl WeakForm for Coupled {
    fn name(&self) -> &str {
        "coupled"
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn slots(&self) -> &[Slot] {
        &SOURCE
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn density(&self, at: &FormPoint) -> f64 {
        let (phi, slope) = (at.values[3].real(), at.gradients[3].map(HyperDual::real));
        let square: f64 = slope.iter().map(|g| g * g).sum();
        let spread: f64 = (0..3).map(|i| at.gradients[i][i].real()).sum();
        0.5 * (1.0 + phi * phi) * square + phi * (at.values[0].real() + spread - at.controls[0].real())
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        let (phi, slope, one) = (at.values[3], at.gradients[3], HyperDual::constant(1.0));
        let square = slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2];
        let spread = at.gradients[0][0] + at.gradients[1][1] + at.gradients[2][2];
        out.sources[0] = phi;
        out.sources[3] = phi * square + at.values[0] + spread - at.controls[0];
        out.fluxes[3] = slope.map(|g| (one + phi * phi) * g);
        (0..3).for_each(|i| out.fluxes[i][i] = phi);
    }
}

/// `theta - c^2 div grad theta = f`, which nothing has to hold.
#[derive(Debug)]
pub struct Screened {
    fields: [Field; 1],
}

impl Screened {
    pub fn on(disc: &Arc<Discretization>) -> CellSum<Self> {
        CellSum::new(Screened { fields: [Field::nodal("theta", 1)] }, disc)
    }
}

impl WeakForm for Screened {
    fn name(&self) -> &str {
        "screened"
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn slots(&self) -> &[Slot] {
        &SOURCE
    }

    fn dual(&self, at: &FormPoint, out: &mut FormDual) {
        out.sources[3] = at.values[3] - at.controls[0];
        out.fluxes[3] = at.gradients[3].map(|slope| slope * HyperDual::constant(0.01));
    }
}
