//! [`CavityPressure`]: a cavity whose pressure is given.

use super::enclosed::Patch;
use super::{PRESSURE, Room};
use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_numeric::vector::axpy;
use std::cell::OnceCell;

/// The potential `-p V(u)` of a [`Cavity`](super::Cavity).
#[derive(Debug)]
pub(super) struct CavityPressure(pub Room);

impl Contribution for CavityPressure {
    fn name(&self) -> &str {
        &self.0.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.0.enclosed.rims()
    }

    fn check(&self, supports: &Supports) -> Result<(), FemError> {
        self.0.check(supports)
    }

    fn slots(&self) -> &[Slot] {
        &[PRESSURE]
    }

    fn measure(&self) -> f64 {
        self.0.measure
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.0.quantities(at.u, at.control(0))
    }

    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Pressure
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(CavityPressurePoint { cavity: self, shares: OnceCell::new() }))
    }
}

/// A [`CavityPressure`] at one displacement.
struct CavityPressurePoint<'a> {
    cavity: &'a CavityPressure,
    shares: OnceCell<Vec<Patch<'a>>>,
}

impl<'a> CavityPressurePoint<'a> {
    /// The shares of the volume, found where they are first asked for.
    fn shares(&self, at: &Instant) -> &[Patch<'a>] {
        self.shares.get_or_init(|| self.cavity.0.enclosed.shares(at.u))
    }
}

impl ContributionPoint for CavityPressurePoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let pressure = at.control(0);
        if pressure == 0.0 {
            return Ok(());
        }
        for patch in self.shares(at) {
            if demand.energy {
                sums.energy -= pressure * patch.volume.value;
                sums.energy_scale += pressure.abs() * patch.volume.scale;
            }
            if demand.force {
                patch.each_component(|dof, gradient| {
                    sums.force[dof] -= pressure * gradient;
                    sums.force_scale[dof] += (pressure * gradient).abs();
                });
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let pressure = at.control(0);
        Ok(self.cavity.0.enclosed.add_hessian(at.u, -pressure, tangent)?)
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let pressure = at.control(0);
        if pressure != 0.0 {
            self.cavity.0.enclosed.each(Some(at.u), true, |patch| patch.add_hessian_product(-pressure, v, out));
        }
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let mut work = 0.0;
        for patch in self.shares(at) {
            patch.each_component(|dof, gradient| work -= lambda[dof] * gradient);
        }
        into.add_control(at, 0, work);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let change = at.slot_of(v, 0);
        for patch in self.shares(at) {
            patch.each_component(|dof, gradient| out[dof] -= change * gradient);
        }
        Ok(())
    }

    /// `-p V_uuu[lambda, du] - v V_uu lambda` and `-lambda . V_uu du`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (pressure, change) = (at.control(0), at.slot_of(along.controls, 0));
        let mut of_lambda = vec![0.0; lambda.len()];
        self.cavity.0.enclosed.each(Some(at.u), true, |patch| patch.add_hessian_product(-1.0, lambda, &mut of_lambda));
        into.add_control(at, 0, at.space.dot(&of_lambda, along.u));
        axpy(change, &of_lambda, &mut into.u);
        if pressure != 0.0 {
            self.cavity
                .0
                .enclosed
                .each_change(lambda, |patch| patch.add_hessian_product(-pressure, along.u, &mut into.u));
        }
        Ok(())
    }
}
