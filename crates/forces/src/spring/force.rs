//! [`SpringForce`]: the contribution of a spring.

use crate::guides::{Guides, Line, Segment};
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_mesh::Polyline;
use nastic_tensor::{Mat3, Vec3};

/// The contribution of a [`Spring`](super::Spring): with d = x_2 - x_1 the potential `(k/2) |d|^2 - k L l + (k/2) L^2`, whose first term is
/// quadratic, and whose second one has the derivatives of the length l. A rest length of 0 leaves the first alone, smooth at l = 0.
#[derive(Debug)]
pub struct SpringForce {
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
        self.ends.at(u).length() - self.rest_length
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

    fn spans_ranks(&self) -> bool {
        true
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        vec![self.ends.nodes()]
    }

    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.holds
    }

    fn drawn_nodes(&self) -> Vec<u32> {
        self.ends.nodes()
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let elongation = self.elongation(at.u);
        vec![
            ("force", self.stiffness * elongation),
            ("length", self.ends.at(at.u).length()),
            ("rest_length", self.rest_length),
        ]
    }

    fn lines(&self, at: &Instant) -> Vec<Polyline> {
        let quantities = vec![("force".to_owned(), self.stiffness * self.elongation(at.u))];
        vec![Polyline { name: self.name.clone(), points: self.ends.positions(at.u), quantities }]
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(SpringPoint { spring: self, line: self.ends.at(at.u) }))
    }
}

/// A [`SpringForce`] at one displacement.
struct SpringPoint<'a> {
    spring: &'a SpringForce,
    line: Line<'a>,
}

impl ContributionPoint for SpringPoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for segment in &self.line.segments {
            if demand.energy {
                let (elongation, balanced) =
                    (segment.length - self.spring.rest_length, (1.0 - at.load) * self.spring.at_rest);
                let (value, change) = (0.5 * self.spring.stiffness * elongation * elongation, segment.change(at.u));
                sums.energy += value - balanced.dot(&change);
                let rounding = self.spring.stiffness * elongation.abs() * (segment.length + self.spring.rest_length);
                sums.energy_scale += value + rounding + balanced.dot(&change).abs();
            }
            if demand.force {
                segment.each_end(self.spring.pull(segment, at.load), |dof, force| {
                    sums.force[dof] += force;
                    sums.force_scale[dof] += force.abs();
                });
            }
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let quadratic = self.spring.stiffness * Mat3::identity();
        self.line.segments.iter().try_for_each(|segment| segment.add_block(&quadratic, tangent))?;
        if self.spring.rest_length > 0.0 {
            self.line.add_curvature(-self.spring.stiffness * self.spring.rest_length, tangent)?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        for segment in &self.line.segments {
            segment.each_end(self.spring.stiffness * segment.change(v), |dof, value| out[dof] += value);
        }
        if self.spring.rest_length > 0.0 {
            self.line.add_curvature_product(-self.spring.stiffness * self.spring.rest_length, v, out);
        }
        Ok(true)
    }

    /// Its ends do not pass each other, where its direction jumps; of rest length 0 it needs none.
    fn max_step(&self, _: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        let free = self.spring.rest_length == 0.0;
        Ok(if free { 1.0 } else { self.line.max_step(du) })
    }

    /// `-k L l'''[lambda, du]`.
    fn second_vjp(
        &self,
        _: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        if self.spring.rest_length > 0.0 {
            let factor = -self.spring.stiffness * self.spring.rest_length;
            self.line.add_third_product(factor, [lambda, along.u], &mut into.u);
        }
        Ok(())
    }
}
