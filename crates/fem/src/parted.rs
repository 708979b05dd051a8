//! A body over ranks: every rank has a [`Part`] of its cells, and solves for the whole.
//!
//! ```text
//! energy(u) = sum_p energy_p(u),    r(u) = sum_p r_p(u),    K = sum_p K_p,    j_m = sum_p (j_m)_p
//! ```
//!
//! Displacements and residuals are whole on every rank at its own nodes, tangents and derivatives by controls are shares by its own cells
//! ([`Share`]). What decides on the way (energies, residuals, the least J, admissible steps, failures) is agreed on, so that all ranks take the same steps.

use crate::contributions::Sums;
use crate::discretization::Discretization;
use crate::error::{FemError, Inadmissible};
use crate::model::Model;
use crate::solid::Solid;
use nastic_linear::{Share, SolverFactory};
use nastic_mesh::{GroupNames, Mesh, Part};
use nastic_team::{Team, TeamError};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What refusals call it.
const OVER_RANKS: &str = "a body over ranks";

/// The part of one rank.
#[derive(Debug)]
pub(crate) struct Parted {
    pub part: Part,
    pub share: Arc<Share>,
}

impl Parted {
    fn new(part: Part, team: Arc<dyn Team>) -> Self {
        let share = Share::new(team, part.owned(), part.sharers().to_vec());
        Parted { part, share }
    }
}

impl Solid {
    /// The part of a body that a rank of a team has, without materials; every other rank has that of its number of the same division. All ranks build the
    /// same body, and call what solves together; groups of the mesh may have nothing on some of them.
    ///
    /// Solves and adjoints are for equilibria of laws and actuations, dead loads, supports that are held or moved, and
    /// [contributions that say so](crate::Contribution::spans_ranks); all else is refused, also formulations over patches of cells that
    /// parts [cut](Mesh::with_whole_patches). It needs a [solver](Self::solver) that spans ranks. Vectors are in the numbers of the part: `u` is whole, [`nodal_force`](Self::nodal_force) and the derivatives by controls that a rank finds are its share of a sum.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_part(part: Part, team: Arc<dyn Team>) -> Result<Self, FemError> {
        let mesh = part.mesh().clone();
        Ok(Self::on(Discretization::of_part(mesh, Some(Parted::new(part, team)))?))
    }

    /// The nodes of surfaces or, failing that, of node sets; ascending, each once.
    ///
    /// # Errors
    /// A name is neither.
    pub fn nodes_of(&self, names: impl Into<GroupNames>) -> Result<Vec<u32>, FemError> {
        let mesh = self.mesh();
        let mut nodes = BTreeSet::new();
        for name in names.into().iter() {
            if mesh.surfaces().contains_key(name) || !mesh.node_sets().contains_key(name) {
                match self.discretization().parted() {
                    Some(parted) => nodes.extend(parted.part.nodes_of_surface(name)?),
                    None => nodes.extend(mesh.nodes_of_facets(mesh.surface(name)?)),
                }
            } else {
                nodes.extend(mesh.node_set(name)?);
            }
        }
        Ok(nodes.into_iter().collect())
    }

    /// The mesh, for what has to know all of it.
    pub(crate) fn whole_mesh(&self, what: &str) -> Result<&Arc<Mesh>, FemError> {
        self.model().refuse_ranks(what)?;
        Ok(self.mesh())
    }
}

impl Model {
    /// Whether it is the part of one rank among several.
    pub fn is_over_ranks(&self) -> bool {
        self.unknowns().share().is_some()
    }

    /// Refuses what knows of bodies alone that one rank has; of these nothing happens.
    ///
    /// # Errors
    /// [`FemError::Unsupported`] of a body over ranks, with what it is.
    pub fn refuse_ranks(&self, what: &str) -> Result<(), FemError> {
        match self.is_over_ranks() {
            false => Ok(()),
            true => Err(not_over_ranks(what, "it would have to know other parts of the body: solve it on one rank")),
        }
    }

    /// Refuses solvers that know the matrix of one rank alone; without one, the solver that suits a body on one rank.
    pub(crate) fn check_spans_ranks(&self, wanted: Option<&dyn SolverFactory>) -> Result<(), FemError> {
        let wanted = wanted.unwrap_or_else(|| self.solver());
        if !self.is_over_ranks() || wanted.spans_ranks() {
            return Ok(());
        }
        let why = "it knows the tangent of one rank alone: take a solver that spans ranks (nastic-petsc), by Solid::solver or SolveOptions::solver";
        Err(not_over_ranks(&format!("solver \"{}\"", wanted.name()), why))
    }

    /// What was found, or that another rank has found its part inadmissible.
    pub(crate) fn agreed<T>(&self, found: Result<T, Inadmissible>) -> Result<T, Inadmissible> {
        unless_elsewhere(self.share(), found, |_| Inadmissible::Elsewhere)
    }

    /// What a rank has checked by itself, or that another one refuses its part: before messages that would wait for that one.
    ///
    /// # Errors
    /// As [`all_accept`].
    pub fn all_accept<T, E: From<FemError>>(&self, found: Result<T, E>) -> Result<T, E> {
        all_accept(self.share(), found)
    }

    fn share(&self) -> Option<&Share> {
        self.unknowns().share().map(AsRef::as_ref)
    }

    /// Energies and residuals by the cells of every rank become those of the whole.
    pub(crate) fn sum_over_ranks(&self, sums: &mut Sums) {
        let Some(share) = self.unknowns().share() else { return };
        let mut energies = [sums.energy, sums.energy_scale];
        share.sum(&mut energies);
        [sums.energy, sums.energy_scale] = energies;
        sums.min_j = self.unknowns().least(sums.min_j);
        if !sums.force.is_empty() {
            self.unknowns().add_up(&mut sums.force);
            self.unknowns().add_up(&mut sums.force_scale);
        }
    }

    /// The end of a solve, unless messages between the ranks have failed on the way.
    ///
    /// # Errors
    /// What was found; [`FemError::Team`] where messages have failed.
    pub fn unless_parted<T, E: From<FemError>>(&self, found: Result<T, E>) -> Result<T, E> {
        match self.unknowns().share().and_then(|share| share.failure()) {
            None => found,
            Some(failure) => Err(FemError::from(failure).into()),
        }
    }
}

/// What a rank has found by itself, or that another one has not: before messages that would wait for that one. Without a share it is what was found.
///
/// # Errors
/// What was found; [`FemError::Elsewhere`] where another rank found an error, [`FemError::Team`] where messages have failed.
pub fn all_accept<T, E: From<FemError>>(share: Option<&Share>, found: Result<T, E>) -> Result<T, E> {
    unless_elsewhere(share, found, |failure| failure.map_or(FemError::Elsewhere, FemError::from).into())
}

fn unless_elsewhere<T, E>(
    share: Option<&Share>,
    found: Result<T, E>,
    elsewhere: impl FnOnce(Option<TeamError>) -> E,
) -> Result<T, E> {
    let Some(share) = share else { return found };
    match (share.any(found.is_err()), found) {
        (true, Ok(_)) => Err(elsewhere(share.failure())),
        (_, found) => found,
    }
}

pub(crate) fn not_over_ranks(what: &str, why: &str) -> FemError {
    FemError::Unsupported { what: what.to_owned(), with: OVER_RANKS.to_owned(), why: why.to_owned() }
}
