//! [`FilledForce`]: a dead force per volume in proportion to how full the body is.

use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, OverCells, Sums};
use nastic_body::controls::{Controls, check_finite};
use nastic_body::discretization::Discretization;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_mesh::GroupNames;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// The weight of a body whose density is a design: the potential `- l int s f . u dX` with the force f per reference volume of the full body (N/m^3), the share l of
/// the load, and the fill s at every quadrature point: a slot of the role [`Design`](nastic_energy::Role), 1 at rest.
///
/// Derivative by s at a point: `- l w f . lambda`; linear in s and u.
#[derive(Debug)]
pub struct FilledForce {
    name: String,
    regions: GroupNames,
    cells: Vec<u32>,
    disc: Arc<Discretization>,
    /// `w f` by quadrature point of the body; zero elsewhere.
    weighted: Vec<f64>,
}

const FILL: [Slot; 1] = [Slot::design("fill", "1", 1.0)];

impl FilledForce {
    /// On regions.
    ///
    /// # Errors
    /// An unknown region; a force that is not finite, or across a body in plane strain.
    pub fn new(
        name: &str,
        disc: &Arc<Discretization>,
        regions: impl Into<GroupNames>,
        force: Vec3,
    ) -> Result<Self, FemError> {
        check_finite(name, force.as_slice())?;
        let (regions, dim) = (regions.into(), disc.dim());
        if dim == 2 && force.z != 0.0 {
            return Err(FemError::Meaningless { what: format!("{name} has a z component on a plane-strain body") });
        }
        let cells = disc.mesh().cells_of(&regions)?;
        let (points, ranges) = (disc.points(), disc.points_of_cells());
        let mut weighted = vec![0.0; dim * points.len()];
        for &cell in &cells {
            let (first, count) = ranges[cell as usize];
            for q in first..first + count {
                (0..dim).for_each(|i| weighted[dim * q + i] = points.weights()[q] * force[i]);
            }
        }
        Ok(FilledForce { name: name.to_owned(), regions, cells, disc: disc.clone(), weighted })
    }

    /// `int s f . N_a dX`, flat, times the load.
    fn forces(&self, load: f64, fill: impl Fn(usize) -> f64) -> Vec<f64> {
        let dim = self.disc.dim();
        let values: Vec<f64> = self.weighted.iter().enumerate().map(|(n, w)| load * fill(n / dim) * w).collect();
        let mut out = vec![0.0; self.disc.dofs()];
        self.disc.points().spread(&values, dim, &mut out);
        out
    }
}

impl Contribution for FilledForce {
    fn name(&self) -> &str {
        &self.name
    }

    fn slots(&self) -> &[Slot] {
        &FILL
    }

    fn over_cells(&self) -> Option<OverCells<'_>> {
        Some(OverCells { regions: &self.regions, cells: &self.cells, points: self.disc.points().len() })
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Load
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for FilledForce {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for (dof, force) in self.forces(at.load, |q| at.control_at(q, 0)).into_iter().enumerate() {
            if demand.energy {
                sums.energy -= force * at.u[dof];
                sums.energy_scale += (force * at.u[dof]).abs();
            }
            if demand.force {
                sums.force[dof] -= force;
                sums.force_scale[dof] += force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let dim = self.disc.dim();
        let lambda = self.disc.points().interpolate(&lambda[..self.disc.dofs()], dim);
        for (q, (lambda, force)) in lambda.chunks_exact(dim).zip(self.weighted.chunks_exact(dim)).enumerate() {
            let product: f64 = lambda.iter().zip(force).map(|(lambda, force)| lambda * force).sum();
            into.add_control_at(at, q, 0, -at.load * product);
        }
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let forces = self.forces(at.load, |q| at.slot_at(v, q, 0));
        out.iter_mut().zip(forces).for_each(|(out, force)| *out -= force);
        Ok(())
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(()) // linear in both
    }
}
