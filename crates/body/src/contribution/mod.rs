//! What the residual is made of: [`Contribution`]s, summed by `Model`.

pub mod body_point;
pub mod constrains;
pub mod energy_role;
pub mod gathers;
pub mod point;
pub mod point_peak;
pub mod prescribes;
pub mod sensitivities;
pub mod tied;
pub mod touches;

use crate::body_energy::free_shape::FreeShape;
use crate::controls::ControlPoint;
use crate::discretization::supports::Supports;
use crate::history::Remembers;
use crate::instant::Instant;
use constrains::Constrains;
use energy_role::EnergyRole;
use gathers::Gathers;
use point::{ContributionPoint, Need};
use point_peak::PointPeak;
use prescribes::Prescribes;
use tied::Tied;
use touches::Touches;

use crate::error::{Cause, FemError, Inadmissible};
use nastic_energy::Slot;
use nastic_linear::{Field, NotCoupled, SparseMatrix, Symmetry};
use nastic_mesh::{GroupNames, Polyline};
use nastic_numeric::vector::sub;
use std::fmt::Debug;

/// A term of the residual `r(u) = sum_c r_c(u; controls, load, v, a)`, whose zero is an equilibrium.
///
/// It is evaluated at a displacement, [`at`](Self::at), and what was found there gives its sums and derivatives ([`ContributionPoint`]).
///
/// Contract, checked by `check_contribution`: `r` is the derivative of the potential where there
/// is one, the tangent is the derivative of `r` (by `u`, with `v` and `a` as the time step gives them), `vjp` that of
/// `lambda . r` by everything else, `second_vjp`, where it is there, that of both; the same input gives the same bits (for any number of threads, which is not checked there).
///
/// Vectors are flat, `dim * node + component` (with [further fields](Self::fields) a longer block per node), supported unknowns included; behind them the multipliers of all constraints.
///
/// A contribution may hold the body to constraints `g_k(u; controls) = 0`. Its potential is then `-sum_k p_k g_k`, with
/// a multiplier `p_k` each, which is an unknown ([`Instant::multiplier`]): the residual by it is `-g_k`, and the tangent gets a border
/// ([`ContributionPoint::add_border`]). Equilibria are saddle points of the whole potential. Where they are inequalities
/// ([`Constrains::are_inequalities`]), `g_k >= 0` with `p_k >= 0` and `p_k g_k = 0`, it gives all that as if they were
/// equations: whether one acts is decided where equilibria are sought and derived.
pub trait Contribution: Debug + Send + Sync {
    /// What it is called in messages and results.
    fn name(&self) -> &str;

    /// Whether its tangent is symmetric.
    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    /// Whether its residual is the derivative of a potential, in a time step of an incremental one; where one contribution
    /// has none, Newton's method searches for a smaller residual instead of a smaller potential.
    fn has_potential(&self) -> bool {
        self.symmetry() == Symmetry::Symmetric
    }

    /// Nodal fields that it has a part in beyond the displacement, by which its potential has a minimum or a [maximum](Field::saddle); beside the latter Newton's method searches
    /// for a smaller residual. Its vectors have `dim` components of the displacement per node, then those
    /// of these fields, in this order, whatever other fields a model has; so do the rows of its matrices.
    fn fields(&self) -> &[Field] {
        &[]
    }

    /// The nodes at which it determines its [fields](Self::fields), or is given their value; `None` of all.
    fn field_nodes(&self) -> Option<Vec<u32>> {
        None
    }

    /// What unknowns of its [fields](Self::fields) are multiplied by to be in their physical unit: it makes entries of the tangent alike in size.
    fn field_unit(&self) -> f64 {
        1.0
    }

    /// Unknowns of its fields of which it reports what all others put there, if there are some.
    fn gathers(&self) -> Option<&dyn Gathers> {
        None
    }

    /// Sets of nodes that it couples with each other beyond those that share a cell, whatever the state. Pairs that change with the state
    /// are not named here: [`SparseMatrix::add_beyond`].
    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    /// Whether the supports hold what it needs held.
    ///
    /// # Errors
    /// What has to be held.
    fn check(&self, _supports: &Supports) -> Result<(), FemError> {
        Ok(())
    }

    /// Displacements that it resists to at rest, each a sum of weighted unknowns: they hold a body still as supports do.
    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &[]
    }

    /// Whether it stores energy where its controls are zero: a spring, a foundation, an elastic tendon.
    fn stores_energy(&self) -> bool {
        false
    }

    /// Where the energy balance of a motion counts its work.
    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Stored
    }

    /// Whether its force depends on the displacement outside of time steps: not of inertia, damping, loads that do not follow.
    fn is_stiff(&self) -> bool {
        true
    }

    /// Whether it is the sum of what its parts on several ranks give, each by its own cells, facets and nodes, and its derivatives by controls of its own,
    /// which all ranks have, are such shares: `Solid::of_part`.
    fn spans_ranks(&self) -> bool {
        false
    }

    /// Nodes from whose drawn places it measures lengths, displacements or volumes: there the shape of the body cannot change. Empty of what sees places x alone.
    fn drawn_nodes(&self) -> Vec<u32> {
        Vec::new()
    }

    /// Of what the places of the nodes of the drawn body are, `dim` numbers at each: the change of shape that they follow.
    fn free_shape(&self) -> Option<&FreeShape> {
        None
    }

    /// Why an equilibrium with it depends on the way there, if it does: such a contribution acts in steps in time alone.
    fn path_dependence(&self) -> Option<&'static str> {
        None
    }

    /// Whether a motion, or the way to an equilibrium, may begin there.
    ///
    /// # Errors
    /// [`Inadmissible`]: why not.
    fn check_start(&self, _at: &Instant) -> Result<(), Inadmissible> {
        Ok(())
    }

    /// Its controls, each one number for the whole contribution (see [`Instant::control`]) or one for each of its
    /// [points](Self::control_points) (see [`Instant::control_at`]).
    fn slots(&self) -> &[Slot] {
        &[]
    }

    /// A name of the first so many slots that is not its own: contributions with the same one are controlled together (the pose of an
    /// obstacle that several surfaces touch).
    fn shared_slots(&self) -> Option<(&str, usize)> {
        None
    }

    /// Named numbers worth reporting of a state: the volume of a cavity, say.
    fn quantities(&self, _at: &Instant) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// The largest value of what it is judged by at every point, where there is such a thing.
    fn point_peak(&self, _at: &Instant) -> Option<PointPeak> {
        None
    }

    /// What of it is to be drawn beside the body: tendons and springs, say.
    fn lines(&self, _at: &Instant) -> Vec<Polyline> {
        Vec::new()
    }

    /// What it reports, if by it a surface touches something.
    fn touches(&self) -> Option<&dyn Touches> {
        None
    }

    /// What of it, where no equilibrium was found, may be the reason.
    fn suspect(&self, _at: &Instant) -> Option<Cause> {
        None
    }

    /// Size of what its controls act on (a volume, say): their weight in the inner product of the control space.
    fn measure(&self) -> f64 {
        1.0
    }

    /// The points at which its controls have values: along a tendon, over a surface. Empty where they are numbers for the whole.
    fn control_points(&self) -> &[ControlPoint] {
        &[]
    }

    /// The cells over which its controls are fields, one value at every quadrature point of the body, as those of laws; none of what has
    /// [points](Self::control_points) of its own, or one number.
    fn over_cells(&self) -> Option<OverCells<'_>> {
        None
    }

    /// Whether its controls may have these values, `slots * point + slot`.
    ///
    /// # Errors
    /// What may not.
    fn check_controls(&self, _values: &[f64]) -> Result<(), FemError> {
        Ok(())
    }

    /// The longest share of a straight change of the controls, to those of another instant of the same model, that a body which goes straight to
    /// the displacement there meanwhile bears at once.
    ///
    /// # Errors
    /// [`Inadmissible`] where the instant is.
    fn max_change(&self, at: &Instant, to: &Instant) -> Result<f64, Inadmissible> {
        let du = sub(to.u, at.u);
        match du.iter().all(|du| *du == 0.0) {
            true => Ok(1.0),
            false => self.at(at, Need::Residual)?.max_step(at, &du),
        }
    }

    /// Unknowns that it moves by its controls, if there are some.
    fn prescribes(&self) -> Option<&dyn Prescribes> {
        None
    }

    /// Nodes that it lets follow others, if there are some.
    fn tied(&self) -> Option<&Tied> {
        None
    }

    /// Its internal variables, if it remembers where it has been. They enter the residual by [`Instant::internal`], and `vjp` adds
    /// the derivatives by them (and to the rest of the state that the step begins at, [`Instant::before`]) to [`Sensitivities::before`](sensitivities::Sensitivities::before).
    fn remembers(&self) -> Option<&dyn Remembers> {
        None
    }

    /// The constraints that it holds the body to, if there are some.
    fn constrains(&self) -> Option<&dyn Constrains> {
        None
    }

    /// What it is at the displacement of an instant, from which all that follows is had. Kinematics that serve several methods are found
    /// here or with the first of them, and kept as far as `need` makes it worth it.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn at<'a>(&'a self, at: &Instant, need: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible>;

    /// Adds its mass matrix `dr/da`, which is symmetric and depends on the controls alone: what accelerations follow from where a motion begins.
    ///
    /// # Errors
    /// [`NotCoupled`] where the pattern lacks a pair of nodes that it couples.
    fn add_mass(&self, _at: &Instant, _mass: &mut SparseMatrix) -> Result<(), NotCoupled> {
        Ok(())
    }

    /// Whether that depends on its controls, which are constant in time then.
    fn mass_follows_controls(&self) -> bool {
        false
    }
}

/// Where controls of a contribution are fields over the body.
#[derive(Debug, Clone, Copy)]
pub struct OverCells<'a> {
    /// The regions.
    pub regions: &'a GroupNames,
    /// Their cells.
    pub cells: &'a [u32],
    /// Quadrature points of the whole body.
    pub points: usize,
}

/// What is wanted of a contribution; forces and the potential come together cheaper than one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Demand {
    /// The potential energy.
    pub energy: bool,
    /// The residual force.
    pub force: bool,
}

/// Sums over contributions.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// Potential energy.
    pub energy: f64,
    /// Sum of absolute terms of the energy: what its rounding error is measured against.
    pub energy_scale: f64,
    /// Residual force `r`, flat; empty unless asked for.
    pub force: Vec<f64>,
    /// Sum of absolute forces, flat: of every cell those of the passive laws and of the actuations each by itself (in a free
    /// body they cancel), and of every other contribution. What a residual's smallness is measured against.
    pub force_scale: Vec<f64>,
    /// Smallest J.
    pub min_j: f64,
}

impl Sums {
    /// Zero, with residuals of a length (0 where none is wanted).
    pub fn zero(dofs: usize) -> Self {
        Sums {
            energy: 0.0,
            energy_scale: 0.0,
            force: vec![0.0; dofs],
            force_scale: vec![0.0; dofs],
            min_j: f64::INFINITY,
        }
    }
}
