//! [`CavityVolume`]: a cavity whose volume is given, and whose pressure follows.

use super::enclosed::Patch;
use super::{AREA, Room, VOLUME};
use nastic_body::contribution::constrains::Constrains;
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

/// Largest volume over that at rest, a stretch of about 20 everywhere; larger ones are refused.
const MAX_VOLUME_RATIO: f64 = 1e4;

/// The constraint `g(u) = V(u) - V_0 - dV = 0` of a [`Cavity`](super::Cavity) with the pressure p as its multiplier:
///
/// ```text
/// potential -p g,   residual (-p V_u, -g),   tangent [-p V_uu, -V_u; -V_u^T, 0]
/// ```
#[derive(Debug)]
pub(super) struct CavityVolume(pub Room);

impl CavityVolume {
    /// `V_0 + dV`.
    fn wanted(&self, at: &Instant) -> f64 {
        self.0.reference_volume + at.control(0)
    }
}

impl Constrains for CavityVolume {
    fn count(&self) -> usize {
        1
    }

    fn check(&self, at: &Instant) -> Result<(), FemError> {
        let rest = self.0.reference_volume;
        if self.wanted(at) > MAX_VOLUME_RATIO * rest {
            let what = format!(
                "the added volume {:.4e} of cavity \"{}\" is {:.1e} times its reference volume {rest:.4e}, beyond any material; is it \
                 in another unit?",
                at.control(0),
                self.0.name,
                at.control(0) / rest
            );
            return Err(FemError::Meaningless { what });
        }
        if self.wanted(at) > 0.0 {
            return Ok(());
        }
        let what = format!(
            "the added volume {:.4e} of cavity \"{}\" leaves none of its reference volume {:.4e}; add more than {:.4e}",
            at.control(0),
            self.0.name,
            self.0.reference_volume,
            -self.0.reference_volume
        );
        Err(FemError::Meaningless { what })
    }
}

impl Contribution for CavityVolume {
    fn name(&self) -> &str {
        &self.0.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.0.enclosed.rims()
    }

    /// Its volume at rest is that of the drawn body.
    fn drawn_nodes(&self) -> Vec<u32> {
        self.0.enclosed.nodes()
    }

    fn check(&self, supports: &Supports) -> Result<(), FemError> {
        self.0.check(supports)?;
        let mut slopes = Vec::new();
        self.0.enclosed.each(None, false, |patch| patch.each_component(|dof, g| slopes.push((dof, g))));
        if supports.lets_change(slopes.into_iter()) {
            return Ok(());
        }
        let what = format!(
            "the supports hold the whole surface of cavity \"{}\", or one rigid body has it, so that its volume cannot change; control its pressure, or \
             hold less of it",
            self.0.name
        );
        Err(FemError::Meaningless { what })
    }

    fn slots(&self) -> &[Slot] {
        if self.0.plane_strain() { &[AREA] } else { &[VOLUME] }
    }

    fn measure(&self) -> f64 {
        self.0.measure
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.0.quantities(at.u, at.multiplier(0))
    }

    fn constrains(&self) -> Option<&dyn Constrains> {
        Some(self)
    }

    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Pressure
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(CavityVolumePoint { cavity: self, shares: OnceCell::new() }))
    }
}

/// A [`CavityVolume`] at one displacement.
struct CavityVolumePoint<'a> {
    cavity: &'a CavityVolume,
    shares: OnceCell<Vec<Patch<'a>>>,
}

impl<'a> CavityVolumePoint<'a> {
    /// The shares of the volume, found where they are first asked for.
    fn shares(&self, at: &Instant) -> &[Patch<'a>] {
        self.shares.get_or_init(|| self.cavity.0.enclosed.shares(at.u))
    }
}

impl ContributionPoint for CavityVolumePoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (pressure, wanted) = (at.multiplier(0), self.cavity.wanted(at));
        let (mut volume, mut scale) = (0.0, wanted.abs());
        for patch in self.shares(at) {
            volume += patch.volume.value;
            scale += patch.volume.scale;
            if demand.force {
                patch.each_component(|dof, gradient| {
                    sums.force[dof] -= pressure * gradient;
                    sums.force_scale[dof] += (pressure * gradient).abs();
                });
            }
        }
        if demand.energy {
            sums.energy -= pressure * (volume - wanted);
            sums.energy_scale += pressure.abs() * scale;
        }
        if demand.force {
            sums.force[at.place(0)] -= volume - wanted;
            // Shares of the volume cancel where o lies far from the cavity; what is wanted of it is a share of itself.
            sums.force_scale[at.place(0)] += volume.abs() + wanted.abs();
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let pressure = at.multiplier(0);
        Ok(self.cavity.0.enclosed.add_hessian(at.u, -pressure, tangent)?)
    }

    fn add_border(&self, at: &Instant, columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        for column in columns.iter_mut().take(1) {
            self.shares(at).iter().for_each(|patch| patch.each_component(|dof, g| column[dof] -= g));
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let (pressure, own) = (at.multiplier(0), at.place(0));
        let (mut by_pressure, of_pressure) = (0.0, v[own]);
        self.cavity.0.enclosed.each(Some(at.u), true, |patch| {
            patch.add_hessian_product(-pressure, v, out);
            patch.each_component(|dof, gradient| {
                out[dof] -= of_pressure * gradient;
                by_pressure -= gradient * v[dof];
            });
        });
        out[own] += by_pressure;
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, lambda[at.place(0)]);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        out[at.place(0)] += at.slot_of(v, 0);
        Ok(())
    }

    /// With `lambda = (l, n)` and `du = (d, q)`: `-p V_uuu[l, d] - q V_uu l - n V_uu d` and, by the pressure, `-l . V_uu d`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (pressure, own) = (at.multiplier(0), at.place(0));
        let mut of_lambda = vec![0.0; lambda.len()];
        self.cavity.0.enclosed.each(Some(at.u), true, |patch| {
            patch.add_hessian_product(-1.0, lambda, &mut of_lambda);
            patch.add_hessian_product(-lambda[own], along.u, &mut into.u);
        });
        into.u[own] += at.space.dot(&of_lambda, along.u);
        axpy(along.u[own], &of_lambda, &mut into.u);
        if pressure != 0.0 {
            self.cavity
                .0
                .enclosed
                .each_change(lambda, |patch| patch.add_hessian_product(-pressure, along.u, &mut into.u));
        }
        Ok(())
    }
}
