//! [`Inertia`]: the mass of a body.

use crate::fill::Fill;
use crate::filled_mass::FilledMass;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, OverCells, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_body::structure::TangentStructure;
use nastic_energy::Slot;
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_mesh::GroupNames;
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// Densities by region (kg/m^3, with forces in N and lengths in m), and how the mass is distributed over the nodes.
///
/// **Residual.** `r = M a`, with the consistent mass `M_ab = int rho N_a N_b dX` or a lumped, diagonal one.
///
/// **Potential.** In a time step with `a = c u + b`: `a . M a / (2 c)`, the incremental one; its tangent is `c M`.
///
/// **Lumped.** `m_a = rho V int N_a^2 dX / sum_b int N_b^2 dX` of every cell (Hinton, Rock, Zienkiewicz 1976): the
/// row sum on linear simplices and parallelepipeds, and positive on quadratic cells, where row sums are not.
///
/// ```
/// # use nastic_fem::{Inertia, Solid};
/// # use nastic_energy::NeoHooke;
/// # use nastic_mesh::{CellKind, box_mesh};
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [5, 1, 1], CellKind::Hex8)?)?
///     .material("body", NeoHooke::new(1e5, 4e5)?)?
///     .inertia(Inertia::new("body", 1070.0))?;
/// let rest = body.rest();
/// let at = nastic_fem::Instant::new(&rest.u, &rest.controls, 1.0);
/// let (_, quantity, mass) = body.model().quantities(&at)?.remove(0);
/// assert!(quantity == "mass" && (mass - 42.8).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Inertia {
    densities: Vec<(GroupNames, f64)>,
    lumped: bool,
    filled: bool,
}

impl Inertia {
    /// A density on a region, or on the union of several.
    pub fn new(region: impl Into<GroupNames>, density: f64) -> Self {
        Inertia { densities: vec![(region.into(), density)], lumped: false, filled: false }
    }

    /// A density on further cells; several on one cell add up.
    #[must_use]
    pub fn and(mut self, region: impl Into<GroupNames>, density: f64) -> Self {
        self.densities.push((region.into(), density));
        self
    }

    /// With the diagonal mass.
    #[must_use]
    pub fn lumped(self) -> Self {
        Inertia { lumped: true, ..self }
    }

    /// With the consistent mass of the densities times a fill at every quadrature point of the body, the control `fill`, 1 at rest: a mass that follows a
    /// design. In a cell the mean over its points counts. The mass of a body whose shape changes follows that, `rho det G`, by itself.
    #[must_use]
    pub fn filled(self) -> Self {
        Inertia { filled: true, ..self }
    }

    /// The contribution on a body.
    ///
    /// # Errors
    /// A region that is unknown, a density that is not positive, cells without density; a mass both lumped and filled, or of a body whose shape changes.
    pub fn on(&self, body: &BodyEnergy, structure: &Arc<TangentStructure>) -> Result<BodyInertia, FemError> {
        let (disc, fill) = (body.discretization(), Fill::of(body));
        let mesh = disc.mesh();
        let mut density = vec![0.0; mesh.cells()];
        for (region, rho) in &self.densities {
            if !(rho.is_finite() && *rho > 0.0) {
                let what = format!("the density on \"{region}\" is {rho}; it must be positive and finite");
                return Err(FemError::Meaningless { what });
            }
            mesh.cells_of(region)?.iter().for_each(|&cell| density[cell as usize] += rho);
        }
        if let Some(first) = density.iter().position(|&rho| rho == 0.0) {
            let count = density.iter().filter(|&&rho| rho == 0.0).count();
            let what = format!(
                "{count} cells of {} have no density, the first is cell {first}; give one to each region",
                mesh.name()
            );
            return Err(FemError::Meaningless { what });
        }
        let mass = match (self.lumped, self.filled || fill.follows_shape()) {
            (true, true) => {
                let what = "a mass that follows a design or a shape is consistent: leave out \"lumped\"".to_owned();
                return Err(FemError::Meaningless { what });
            }
            (true, false) => Mass::Lumped(disc.lumped_mass(&density)),
            (false, false) => Mass::Consistent(structure.consistent_mass(&density)?),
            (false, true) => {
                let names = self.densities.iter().flat_map(|(names, _)| names.iter());
                let regions: Vec<String> = names.map(str::to_owned).collect();
                Mass::Filled(FilledMass::new(fill, disc, structure, GroupNames::from(regions), density)?)
            }
        };
        let mut along = vec![0.0; disc.dofs()];
        along.iter_mut().step_by(disc.dim()).for_each(|x| *x = 1.0);
        let total = match &mass {
            Mass::Filled(_) => 0.0,
            Mass::Lumped(diagonal) => disc.dot(&along, &diagonal_product(diagonal, &along)),
            Mass::Consistent(matrix) => disc.dot(&along, &product(matrix, &along, false)),
        };
        Ok(BodyInertia { mass, total })
    }
}

/// The contribution of an [`Inertia`].
#[derive(Debug)]
pub struct BodyInertia {
    mass: Mass,
    /// Of a mass that controls do not change.
    total: f64,
}

#[derive(Debug)]
enum Mass {
    Consistent(SparseMatrix),
    /// By unknown.
    Lumped(Vec<f64>),
    Filled(FilledMass),
}

/// Zero behind the displacement.
fn diagonal_product(diagonal: &[f64], v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; v.len()];
    out.iter_mut().zip(diagonal).zip(v).for_each(|((out, m), v)| *out = m * v);
    out
}

fn product(matrix: &SparseMatrix, v: &[f64], parallel: bool) -> Vec<f64> {
    let mut out = vec![0.0; v.len()];
    matrix.multiply_on(v, &mut out, parallel);
    out
}

impl Mass {
    /// Zero behind the displacement.
    fn times(&self, at: &Instant, v: &[f64]) -> Vec<f64> {
        match self {
            Mass::Lumped(diagonal) => diagonal_product(diagonal, v),
            Mass::Consistent(matrix) => product(matrix, v, at.parallel),
            Mass::Filled(filled) => filled.times(at, v),
        }
    }

    fn add_to(&self, factor: f64, at: &Instant, matrix: &mut SparseMatrix) -> Result<(), NotCoupled> {
        match self {
            Mass::Lumped(diagonal) => {
                matrix.add_diagonal(&diagonal.iter().map(|m| factor * m).collect::<Vec<_>>());
                Ok(())
            }
            Mass::Consistent(mass) => matrix.add_scaled(factor, mass),
            Mass::Filled(filled) => filled.add_to(factor, at, matrix),
        }
    }
}

impl BodyInertia {
    /// What it is called in messages and results.
    pub const NAME: &str = "inertia";
    /// That of one that follows a design.
    pub const FILLED: &str = "inertia by fill";
}

impl Contribution for BodyInertia {
    fn name(&self) -> &str {
        if let Mass::Filled(_) = self.mass { Self::FILLED } else { Self::NAME }
    }

    fn slots(&self) -> &[Slot] {
        if let Mass::Filled(filled) = &self.mass { filled.fill.slots() } else { &[] }
    }

    fn shared_slots(&self) -> Option<(&str, usize)> {
        if let Mass::Filled(filled) = &self.mass { filled.fill.shared_slots() } else { None }
    }

    fn over_cells(&self) -> Option<OverCells<'_>> {
        match &self.mass {
            Mass::Filled(filled) => {
                Some(OverCells { regions: &filled.regions, cells: &filled.cells, points: filled.points() })
            }
            _ => None,
        }
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        let width = self.slots().len().max(1);
        match values.iter().skip(width - 1).step_by(width).find(|fill| !(fill.is_finite() && **fill >= 0.0)) {
            None => Ok(()),
            Some(fill) => {
                let what = format!("\"{}\" with a fill of {fill}: it must be finite and at least zero", self.name());
                Err(FemError::Meaningless { what })
            }
        }
    }

    fn mass_follows_controls(&self) -> bool {
        matches!(self.mass, Mass::Filled(_))
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let total = if let Mass::Filled(filled) = &self.mass { filled.total(at) } else { self.total };
        let mut found = vec![("mass", total)];
        if at.step.is_some() {
            let velocity: Vec<f64> = (0..at.u.len()).map(|dof| at.velocity(dof)).collect();
            found.push(("kinetic_energy", 0.5 * at.space.dot(&velocity, &self.mass.times(at, &velocity))));
        }
        found
    }

    fn add_mass(&self, at: &Instant, mass: &mut SparseMatrix) -> Result<(), NotCoupled> {
        self.mass.add_to(1.0, at, mass)
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for BodyInertia {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let Some(step) = at.step else { return Ok(()) };
        let acceleration: Vec<f64> = (0..at.u.len()).map(|dof| at.acceleration(dof)).collect();
        let force = self.mass.times(at, &acceleration);
        add_linear(at, step.acceleration.0, &acceleration, &force, demand, sums);
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if let Some(step) = at.step {
            self.mass.add_to(step.acceleration.0, at, tangent)?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        if let Some(step) = at.step {
            axpy(step.acceleration.0, &self.mass.times(at, v), out);
        }
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        if at.step.is_some() {
            axpy(1.0, &self.mass.times(at, lambda), &mut into.acceleration);
        }
        if let (Mass::Filled(filled), Some(_)) = (&self.mass, at.step) {
            let acceleration: Vec<f64> = (0..at.u.len()).map(|dof| at.acceleration(dof)).collect();
            filled.vjp(at, lambda, &acceleration, |point, slot, by| into.add_control_at(at, point, slot, by));
        }
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        if let (Mass::Filled(filled), Some(_)) = (&self.mass, at.step) {
            let acceleration: Vec<f64> = (0..at.u.len()).map(|dof| at.acceleration(dof)).collect();
            axpy(1.0, &filled.times_change(at, v, &acceleration), out);
        }
        Ok(())
    }

    /// The residual is linear in the displacement and, apart from it, in the fill; not in a change of shape.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        if let (Mass::Filled(filled), Some(step)) = (&self.mass, at.step) {
            let factor = step.acceleration.0;
            axpy(factor, &filled.times_change(at, along.controls, lambda), &mut into.u);
            filled.vjp(at, lambda, along.u, |point, slot, by| into.add_control_at(at, point, slot, factor * by));
            let acceleration: Vec<f64> = (0..at.u.len()).map(|dof| at.acceleration(dof)).collect();
            let mut add = |point, slot, by| into.add_control_at(at, point, slot, by);
            filled.second_vjp(at, along.controls, [lambda, &acceleration], &mut add);
        }
        Ok(())
    }
}

/// Adds the force `A y` with `y = c u + b` and a constant symmetric A, and its incremental potential `y . A y / (2
/// c)`, which is `u . A y` where y does not depend on u.
pub(crate) fn add_linear(at: &Instant, c: f64, y: &[f64], force: &[f64], demand: Demand, sums: &mut Sums) {
    if demand.energy {
        let (along, factor) = if c == 0.0 { (at.u, 1.0) } else { (y, 0.5 / c) };
        sums.energy += factor * at.space.dot(along, force);
        sums.energy_scale += along.iter().zip(force).map(|(y, f)| (factor * y * f).abs()).sum::<f64>();
    }
    if demand.force {
        axpy(1.0, force, &mut sums.force);
        sums.force_scale.iter_mut().zip(force).for_each(|(scale, f)| *scale += f.abs());
    }
}
