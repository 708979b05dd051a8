//! [`InextensibleTendon`]: a cable that does not stretch, drawn in by a given length.

use super::force::{Drive, line};
use crate::guides::{Guides, Line};
use nastic_body::contribution::constrains::Constrains;
use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{Cause, FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_mesh::Polyline;
use nastic_numeric::vector::axpy;

/// The constraint `g(u) = L0 - s - L(u) >= 0` of a [`Tendon`](super::Tendon) with the tension as its multiplier, `T >= 0`, `T g = 0`:
///
/// ```text
/// potential -T g,   residual (T L_u, -g),   tangent [T L_uu, L_u; L_u^T, 0]
/// ```
#[derive(Debug)]
pub(super) struct InextensibleTendon {
    name: String,
    guides: Guides,
    reference_length: f64,
}

impl InextensibleTendon {
    pub fn new(name: &str, guides: Guides) -> Self {
        let reference_length = guides.reference_length();
        InextensibleTendon { name: name.to_owned(), guides, reference_length }
    }

    /// `L0 - s`.
    fn free_length(&self, at: &Instant) -> f64 {
        self.reference_length - at.control(0)
    }
}

impl Constrains for InextensibleTendon {
    fn count(&self) -> usize {
        1
    }

    fn are_inequalities(&self) -> bool {
        true
    }

    fn check(&self, at: &Instant) -> Result<(), FemError> {
        if self.free_length(at) > 0.0 {
            return Ok(());
        }
        let what = format!(
            "the pull {:.4e} of tendon \"{}\" leaves none of its length {:.4e}; pull it by less",
            at.control(0),
            self.name,
            self.reference_length
        );
        Err(FemError::Meaningless { what })
    }
}

impl Contribution for InextensibleTendon {
    fn name(&self) -> &str {
        &self.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.guides.neighbours()
    }

    /// Its length at rest is that of the drawn body.
    fn drawn_nodes(&self) -> Vec<u32> {
        self.guides.nodes()
    }

    fn check(&self, supports: &Supports) -> Result<(), FemError> {
        let rest = vec![0.0; supports.fixed().len()];
        if supports.lets_change(self.guides.at(&rest).gradient().into_iter().enumerate()) {
            return Ok(());
        }
        let what = format!(
            "the supports hold all that could change the length of tendon \"{}\", or one rigid body has it all, and it cannot stretch; lead it through points \
             that move, or control its tension",
            self.name
        );
        Err(FemError::Meaningless { what })
    }

    fn slots(&self) -> &[Slot] {
        &Drive::PULL
    }

    fn suspect(&self, at: &Instant) -> Option<Cause> {
        self.guides.meeting(&self.name, at.u).map(Cause::GuidesMeet)
    }

    fn measure(&self) -> f64 {
        self.reference_length
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let tension = at.multiplier(0);
        vec![
            ("tension", tension),
            ("length", self.guides.at(at.u).length()),
            ("reference_length", self.reference_length),
            ("slack", f64::from(tension <= 0.0)),
            ("pull", at.control(0)),
        ]
    }

    fn lines(&self, at: &Instant) -> Vec<Polyline> {
        vec![line(&self.name, &self.guides, at.u, at.multiplier(0))]
    }

    fn constrains(&self) -> Option<&dyn Constrains> {
        Some(self)
    }

    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Drive
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(InextensiblePoint { tendon: self, line: self.guides.at(at.u) }))
    }
}

/// An [`InextensibleTendon`] at one displacement.
struct InextensiblePoint<'a> {
    tendon: &'a InextensibleTendon,
    line: Line<'a>,
}

impl ContributionPoint for InextensiblePoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (tension, length, free) = (at.multiplier(0), self.line.length(), self.tendon.free_length(at));
        if demand.energy {
            sums.energy += tension * (length - free);
            sums.energy_scale += tension.abs() * (length + free.abs());
        }
        if demand.force {
            self.line.add_force(tension, sums);
            sums.force[at.place(0)] += length - free;
            sums.force_scale[at.place(0)] += length + free.abs();
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if at.multiplier(0) != 0.0 {
            self.line.add_curvature(at.multiplier(0), tangent)?;
        }
        Ok(())
    }

    fn add_border(&self, _: &Instant, columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        for column in columns.iter_mut().take(1) {
            for segment in &self.line.segments {
                segment.each_end(segment.direction, |dof, slope| column[dof] += slope);
            }
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let own = at.place(0);
        self.line.add_curvature_product(at.multiplier(0), v, out);
        axpy(v[own], &self.line.gradient(), out);
        out[own] += self.line.slope(v);
        Ok(true)
    }

    /// No guide passes the next one, where the direction of the tendon jumps.
    fn max_step(&self, _: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.line.max_step(du))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, lambda[at.place(0)]);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        out[at.place(0)] += at.slot_of(v, 0);
        Ok(())
    }

    /// With `lambda = (l, n)` and `du = (d, q)`: `T L_uuu[l, d] + q L_uu l + n L_uu d` and, by the tension, `l . L_uu d`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (own, line) = (at.place(0), &self.line);
        let mut of_lambda = vec![0.0; lambda.len()];
        line.add_curvature_product(1.0, lambda, &mut of_lambda);
        into.u[own] += at.space.dot(&of_lambda, along.u);
        axpy(along.u[own], &of_lambda, &mut into.u);
        line.add_curvature_product(lambda[own], along.u, &mut into.u);
        if at.multiplier(0) != 0.0 {
            line.add_third_product(at.multiplier(0), [lambda, along.u], &mut into.u);
        }
        Ok(())
    }
}
