//! [`SpringForce`]: the contribution of a spring.

use crate::contributions::guides::{Guides, Segment};
use crate::contributions::{
    Contribution, ContributionPoint, Demand, Increment, Instant, Need, SecondSensitivities, Sums,
};
use crate::error::{Inadmissible, SecondDerivativeError};
use nastic_linear::SparseMatrix;
use nastic_mesh::Polyline;
use nastic_tensor::{Mat3, Vec3};

/// The contribution of a [`Spring`](super::Spring): with d = x_2 - x_1 the potential `(k/2) |d|^2 - k L l + (k/2) L^2`, whose first term is
/// quadratic, and whose second one has the derivatives of the length l. A rest length of 0 leaves the first alone, smooth at l = 0.
#[derive(Debug)]
pub(crate) struct SpringForce {
    pub(super) name: String,
    /// Two points.
    pub(super) ends: Guides,
    pub(super) stiffness: f64,
    pub(super) rest_length: f64,
    /// Derivative of its potential by d where the body is at rest.
    pub(super) at_rest: Vec3,
    /// Displacements that it resists to.
    pub(super) holds: Vec<Vec<(u32, f64)>>,
}

impl SpringForce {
    fn elongation(&self, u: &[f64]) -> f64 {
        self.ends.length(u) - self.rest_length
    }

    /// `V'(d)` less what balances it: `k (1 - L/l) d - (1 - q) V'(d_0)`.
    fn pull(&self, segment: &Segment, load: f64) -> Vec3 {
        self.stiffness * (segment.length - self.rest_length) * segment.direction - (1.0 - load) * self.at_rest
    }
}

impl Contribution for SpringForce {
    fn name(&self) -> &str {
        &self.name
    }

    fn stores_energy(&self) -> bool {
        true
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        vec![self.ends.nodes()]
    }

    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.holds
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let elongation = self.elongation(at.u);
        vec![
            ("force", self.stiffness * elongation),
            ("length", self.ends.length(at.u)),
            ("rest_length", self.rest_length),
        ]
    }

    fn lines(&self, at: &Instant) -> Vec<Polyline> {
        let quantities = vec![("force", self.stiffness * self.elongation(at.u))];
        vec![Polyline { name: self.name.clone(), points: self.ends.positions(at.u), quantities }]
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for SpringForce {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for segment in self.ends.segments(at.u) {
            if demand.energy {
                let (elongation, balanced) = (segment.length - self.rest_length, (1.0 - at.load) * self.at_rest);
                let (value, change) = (0.5 * self.stiffness * elongation * elongation, segment.change(at.u));
                sums.energy += value - balanced.dot(&change);
                let rounding = self.stiffness * elongation.abs() * (segment.length + self.rest_length);
                sums.energy_scale += value + rounding + balanced.dot(&change).abs();
            }
            if demand.force {
                segment.each_end(self.pull(&segment, at.load), |dof, force| {
                    sums.force[dof] += force;
                    sums.force_scale[dof] += force.abs();
                });
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let quadratic = self.stiffness * Mat3::identity();
        self.ends.segments(at.u).try_for_each(|segment| segment.add_block(&quadratic, tangent))?;
        if self.rest_length > 0.0 {
            self.ends.add_curvature(at.u, -self.stiffness * self.rest_length, tangent)?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        for segment in self.ends.segments(at.u) {
            segment.each_end(self.stiffness * segment.change(v), |dof, value| out[dof] += value);
        }
        if self.rest_length > 0.0 {
            self.ends.add_curvature_product(at.u, -self.stiffness * self.rest_length, v, out);
        }
        Ok(true)
    }

    /// Its ends do not pass each other, where its direction jumps; of rest length 0 it needs none.
    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        let free = self.rest_length == 0.0;
        Ok(if free { 1.0 } else { self.ends.max_step(at.u, du) })
    }

    /// `-k L l'''[lambda, du]`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        if self.rest_length > 0.0 {
            let factor = -self.stiffness * self.rest_length;
            self.ends.add_third_product(at.u, factor, [lambda, along.u], &mut into.u);
        }
        Ok(())
    }
}
