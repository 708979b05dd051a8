//! Errors of building a problem and of solving it.

mod cause;
mod inadmissible;

use crate::body_energy::formulation::Formulation;
use crate::state::State;
use nastic_energy::EnergyError;
use nastic_linear::{LinearError, NotCoupled, StructureError};
use nastic_mesh::{CellKind, MeshError};
use nastic_team::TeamError;

pub use cause::{Cause, MeetingGuides};
pub use inadmissible::{Inadmissible, InvertedAt};

/// A problem that cannot be built: what, where, how much, and what to try.
#[derive(Debug, Clone, thiserror::Error)]
pub enum FemError {
    /// A name or the mesh itself.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A law's parameter.
    #[error(transparent)]
    Energy(#[from] EnergyError),
    /// The mesh is too large for its tangent.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A contribution adds entries to a tangent for nodes that it does not couple.
    #[error(
        "contribution \"{contribution}\" adds entries to a tangent for nodes {} and {}, which share no cell; name them in its \
         `Contribution::couplings`, or add pairs that change with the state by `SparseMatrix::add_beyond`",
        .lacking.a, .lacking.b
    )]
    NotCoupled {
        /// Name of the contribution.
        contribution: String,
        /// The nodes.
        lacking: NotCoupled,
    },
    /// The reference configuration is inverted somewhere.
    #[error(
        "cell {cell} of {mesh} is inverted or flat at a quadrature point (det dX/dxi = {jacobian:.3e}); repair the mesh"
    )]
    InvertedReference {
        /// Mesh name.
        mesh: String,
        /// Cell number.
        cell: usize,
        /// Determinant of the map from the reference element.
        jacobian: f64,
    },
    /// Cells that no passive material covers.
    #[error("{count} cells of {mesh} have no material, the first is cell {first}; give one to each region ({regions})")]
    NoMaterial {
        /// Mesh name.
        mesh: String,
        /// How many.
        count: usize,
        /// The first of them.
        first: usize,
        /// The regions the mesh has.
        regions: String,
    },
    /// The supports leave rigid motions free.
    #[error(
        "the supports leave {free} rigid motion(s) of {what} free ({example}), so no equilibrium is determined; \
         fix more components or clamp a surface; a rigid body takes a weak foundation or springs"
    )]
    RigidMotion {
        /// Number of free rigid motions.
        free: usize,
        /// The connected part of the body.
        what: String,
        /// One of them in words.
        example: String,
    },
    /// A cost that changes with motions that nothing resists to.
    #[error(
        "the derivative is not determined: {:.1} % of the cost's derivative by the displacement is along {count} rigid motion(s) of {what} that nothing resists to ({example}); \
         hold that by a weak foundation or springs", 100.0 * share
    )]
    FreeDerivative {
        /// Share of the cost's derivative by the displacement.
        share: f64,
        /// Number of free rigid motions.
        count: usize,
        /// The connected part of the body, or the rigid body.
        what: String,
        /// One of them in words.
        example: String,
    },
    /// Two supports prescribe different values for one displacement component.
    #[error(
        "support on \"{support}\" prescribes {new} for component {component} of node {node}, where an earlier support \
         prescribes {old}; let one of them go"
    )]
    SupportConflict {
        /// Name of the later support.
        support: String,
        /// Node number.
        node: usize,
        /// "x", "y" or "z"; of a further field its number and name.
        component: String,
        /// Value already there.
        old: f64,
        /// Value refused.
        new: f64,
    },
    /// Ranks that have parts of a body cannot go on together.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// What another rank refuses of its part of the body; that one knows why.
    #[error("another rank refuses what is asked of its part of the body, and says why")]
    Elsewhere,
    /// A formulation that cells of a kind cannot have.
    #[error("{}", formulation_refused(*.cell, *.kind, *.formulation))]
    Formulation {
        /// The first cell of that kind.
        cell: usize,
        /// Its kind.
        kind: CellKind,
        /// The formulation.
        formulation: Formulation,
    },
    /// Two formulations for one cell.
    #[error(
        "cell {cell} is to have the formulation {later}, and has {earlier} already; choose one for all laws of a region"
    )]
    FormulationConflict {
        /// The first such cell.
        cell: usize,
        /// What it has.
        earlier: Formulation,
        /// What was refused.
        later: Formulation,
    },
    /// A support or load that names nothing to act on, or a component the dimension lacks.
    #[error("{what}")]
    Meaningless {
        /// What is wrong and what to try.
        what: String,
    },
    /// What a model does not go with, see `Properties::supports`.
    #[error("{what} does not go with \"{with}\": {why}")]
    Unsupported {
        /// What was asked for.
        what: String,
        /// Name of the contribution, or the laws, that it does not go with.
        with: String,
        /// Why, and what to take instead.
        why: String,
    },
    /// An array of the wrong length or with a value that is not finite.
    #[error("{what} has {found} values where {expected} are needed")]
    Length {
        /// Which array.
        what: String,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
    /// A value that is not finite.
    #[error("{what} is not finite (entry {index} is {value})")]
    NotFinite {
        /// Which array.
        what: String,
        /// Entry.
        index: usize,
        /// Its value.
        value: f64,
    },
}

fn formulation_refused(cell: usize, kind: CellKind, formulation: Formulation) -> String {
    let names: Vec<&str> = formulation.kinds().iter().map(|kind| kind.name()).collect();
    let instead = match Formulation::nearly_incompressible(kind) {
        Some(other) => format!("{} cells take {other}", kind.name()),
        None => format!("mesh the region with {} cells", names.join(" or ")),
    };
    let (kind, names) = (kind.name(), names.join(", "));
    format!("cell {cell} is a {kind}, and the formulation {formulation} is one of {names}; {instead}")
}

/// Why a residual has no second derivatives.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SecondDerivativeError {
    /// The displacement is not admissible.
    #[error(transparent)]
    Inadmissible(#[from] Inadmissible),
    /// A law or actuation that does not give them.
    #[error(transparent)]
    Energy(#[from] EnergyError),
    /// A motion whose rotation changes.
    #[error(
        "motion \"{name}\" gives no second derivatives by its rotation; take a method that needs first ones alone, or control its translation"
    )]
    Turning {
        /// Its name.
        name: String,
    },
    /// A contribution that does not give them.
    #[error(
        "\"{name}\" gives no second derivatives; take a method that needs first ones alone (lbfgs, spectral, projected_gradient); in the library: `ContributionPoint::{method}`"
    )]
    Contribution {
        /// Its name.
        name: String,
        /// What it would have to implement.
        method: &'static str,
    },
}

impl SecondDerivativeError {
    /// Of a contribution of this name; none by the controls of one without controls.
    pub fn of(self, contribution: &str, controlled: bool) -> Result<(), Self> {
        match self {
            Self::Contribution { method: "add_control_product", .. } if !controlled => Ok(()),
            Self::Contribution { method, name } if name.is_empty() => {
                Err(Self::Contribution { name: contribution.to_owned(), method })
            }
            other => Err(other),
        }
    }
}

/// Why a state solve stopped short. It is an ordinary answer: an optimiser shortens its step on it.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StateError {
    /// Every attempt beyond `load` was inadmissible: it inverted an element, say.
    #[error(
        "{at} at load {load:.4} after {cuts} cuts of the load step; try a smaller control or load, or a finer mesh"
    )]
    Inadmissible {
        /// Why.
        at: Inadmissible,
        /// Fraction of the way from the starting state.
        load: f64,
        /// How often the load step was cut.
        cuts: usize,
        /// The last equilibrium found on the way.
        last: Box<State>,
    },
    /// The state to begin at is not admissible.
    #[error("{at} in the state to begin at; begin at an equilibrium, or at rest")]
    Start {
        /// Why.
        at: Inadmissible,
    },
    /// A time step has no solution.
    #[error("in the time step of {dt:.3e} from t = {time:.6e}: {source}; shorter steps may help")]
    InStep {
        /// When the step begins.
        time: f64,
        /// Its length.
        dt: f64,
        /// Why: [`Inadmissible`](Self::Inadmissible), [`NoConvergence`](Self::NoConvergence), or [`Linear`](Self::Linear) where the matrix of a
        /// step is not positive definite.
        source: Box<StateError>,
    },
    /// The end of a time step is inadmissible, although the instant between at which its forces balance is not.
    #[error(
        "the end of the time step of {dt:.3e} from t = {time:.6e} is not admissible ({at}), though its middle is; take shorter \
         steps, or a scheme whose forces balance at the end of a step"
    )]
    EndOfStep {
        /// Why.
        at: Inadmissible,
        /// When the step begins.
        time: f64,
        /// Its length.
        dt: f64,
        /// The state that it begins at.
        last: Box<State>,
    },
    /// Gaps of contacts do not vanish.
    #[error(
        "after {rounds} equilibria the gaps of contacts are {violation:.1e} of the layer's thickness still; a thicker or softer layer takes them in \
         longer steps"
    )]
    InexactContact {
        /// Largest gap or depth that is left, in thicknesses of the layer.
        violation: f64,
        /// Equilibria that were found.
        rounds: usize,
    },
    /// Newton's method did not converge at this load, however small the step.
    #[error(
        "{}no {}equilibrium found at load {load:.4} of the way, the last one at {reached:.4}, after {cuts} cuts of the load step and \
         {newton} Newton iterations (relative residual {residual:.2e}); {cause}",
        budget.map_or_else(String::new, |budget| format!("cut after its budget of {budget} Newton iterations: ")),
        if matches!(cause, Cause::Saddle { .. }) { "stable " } else { "" }
    )]
    NoConvergence {
        /// Fraction of the way.
        load: f64,
        /// How often the load step was cut.
        cuts: usize,
        /// Newton iterations spent.
        newton: usize,
        /// Residual reached, relative to the sum of element forces.
        residual: f64,
        /// Fraction of the way to the last equilibrium found.
        reached: f64,
        /// The likely reason.
        cause: Cause,
        /// Where the solve was cut since it had used up all it was allowed: how many that are.
        budget: Option<usize>,
        /// The last equilibrium found on the way.
        last: Box<State>,
    },
    /// A linear system could not be solved.
    #[error("linear solve failed: {0}")]
    Linear(#[from] LinearError),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A term of the residual without second derivatives.
    #[error(transparent)]
    SecondDerivatives(#[from] SecondDerivativeError),
    /// The problem is not complete or an input does not fit.
    #[error(transparent)]
    Problem(#[from] FemError),
}

impl StateError {
    /// That of a displacement on the way beyond `last`, or of a contribution that is at fault at any displacement.
    pub fn inadmissible(at: Inadmissible, load: f64, cuts: usize, last: Box<State>) -> Self {
        match at.problem() {
            Some(problem) => problem.into(),
            None => StateError::Inadmissible { at, load, cuts, last },
        }
    }

    /// Whether no other way to the state is to be tried: the caller asked to stop, the iterations allowed are used up, or memory is lacking.
    pub fn is_final(&self) -> bool {
        match self {
            StateError::Cancelled | StateError::NoConvergence { budget: Some(_), .. } => true,
            StateError::InStep { source, .. } => source.is_final(),
            _ => self.is_lack_of_memory(),
        }
    }

    /// Of a second way that failed: the error of the first, which began nearer, unless the second one says nothing of the state. A budget that ended
    /// the second one ended both.
    pub fn or_cut(self, mut first: StateError, allowed: Option<usize>) -> StateError {
        match (self, &mut first) {
            (
                StateError::NoConvergence { budget: Some(_), newton: again, .. },
                StateError::NoConvergence { newton, budget, .. },
            ) => {
                *newton += again;
                *budget = allowed;
                first
            }
            (StateError::NoConvergence { budget: Some(_), .. }, _) => first,
            (again, _) if again.is_final() => again,
            _ => first,
        }
    }

    /// Newton iterations that were spent, as far as that is known.
    pub fn newton(&self) -> usize {
        match self {
            StateError::NoConvergence { newton, .. } => *newton,
            StateError::InStep { source, .. } => source.newton(),
            _ => 0,
        }
    }

    /// Whether the machine has too little memory: nothing is said of the state.
    pub fn is_lack_of_memory(&self) -> bool {
        matches!(self, StateError::Linear(error) if error.is_lack_of_memory())
    }

    /// Whether messages between the ranks that have the body have failed: nothing is said of the state.
    pub fn is_lost_rank(&self) -> bool {
        match self {
            StateError::Problem(error) => matches!(error, FemError::Team(_)),
            StateError::InStep { source, .. } => source.is_lost_rank(),
            _ => false,
        }
    }

    /// Whether the tangent is singular to working precision.
    pub fn is_singular(&self) -> bool {
        matches!(self, StateError::Linear(error) if error.is_singular())
    }

    /// A stable name: `inverted`, `outside_domain` (of a law), `penetrates`, `no_convergence`, `linear`, `cancelled`, `second_derivatives`, `problem`.
    pub fn code(&self) -> &'static str {
        match self {
            StateError::Inadmissible { at, .. } | StateError::EndOfStep { at, .. } | StateError::Start { at } => {
                at.code()
            }
            StateError::NoConvergence { .. } => "no_convergence",
            StateError::InStep { source, .. } => source.code(),
            StateError::InexactContact { .. } => "inexact_contact",
            StateError::Linear(_) => "linear",
            StateError::Cancelled => "cancelled",
            StateError::SecondDerivatives(_) => "second_derivatives",
            StateError::Problem(_) => "problem",
        }
    }
}
