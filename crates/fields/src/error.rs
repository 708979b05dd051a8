//! Errors of controls, costs and reduced problems.

use crate::control_limit::ControlLimit;
use nastic_fem::{FemError, Inadmissible, StateError};
use nastic_mesh::MeshError;
use nastic_opt::{Failed, Summary};
use serde::{Deserialize, Serialize};

/// A control problem that cannot be built or evaluated: what, where, how much, what to try.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ControlError {
    /// Building the body failed.
    #[error(transparent)]
    Fem(#[from] FemError),
    /// A name or a mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The state could not be found.
    #[error(transparent)]
    State(#[from] StateError),
    /// The way from a control whose state is known to another leads to a limit point.
    #[error(
        "{limit}; the path of equilibria turns back there, beyond it the body jumps to another equilibrium or has none; keep the controls below, or \
         control what goes on growing there, as the volume of a cavity in the place of its pressure"
    )]
    LimitPoint {
        /// Where.
        limit: ControlLimit,
        /// Newton iterations spent.
        newton: usize,
    },
    /// The path of equilibria from a control whose state is known leads to another state under a control than the one that was found.
    #[error(
        "another state than the path leads to, whose displacement differs by {:.1} % of the change; shorter steps stay on the branch",
        100.0 * apart
    )]
    OtherBranch {
        /// The difference of the displacements as a share of the change on the way.
        apart: f64,
    },
    /// A saddle of the potential energy, where none is accepted.
    #[error("the equilibrium is unstable: {negative} negative pivots of the tangent, and unstable states are refused")]
    Unstable {
        /// Negative pivots of the tangent.
        negative: usize,
        /// Newton iterations spent.
        newton: usize,
    },
    /// A configuration with J <= 0.
    #[error(transparent)]
    Inverted(#[from] Inadmissible),
    /// A control that no actuation offers.
    #[error("control \"{name}\" not found; there are: {known}")]
    UnknownControl {
        /// The name asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// Nothing is controlled.
    #[error(
        "the problem has no control: call .control(NAME, Space::Cell), or with another space, before it is optimised; \
         NAME is one of: {known}"
    )]
    NoControls {
        /// What can be controlled.
        known: String,
    },
    /// Two control fields for the same slots.
    #[error("control \"{name}\" is given twice (as \"{other}\"); keep one")]
    ControlledTwice {
        /// The later one.
        name: String,
        /// The earlier one.
        other: String,
    },
    /// An amplitude along a direction that cannot be.
    #[error("control \"{name}\" along a direction: {why}; directions are unit vectors, for vector controls")]
    Direction {
        /// The control.
        name: String,
        /// What is wrong.
        why: &'static str,
    },
    /// A field where there is one number.
    #[error("control \"{name}\" is one number for the whole, so its space is \"uniform\", not \"{space}\"")]
    OneNumber {
        /// The control.
        name: String,
        /// The space asked for.
        space: &'static str,
    },
    /// A field over the points of a contribution in a space that needs cells.
    #[error(
        "control \"{name}\" is a field over points of its own, so its space is \"uniform\", \"point\" or \"grid\", not \"{space}\""
    )]
    OwnPoints {
        /// The control.
        name: String,
        /// The space asked for.
        space: &'static str,
    },
    /// A map in front of the expansion of a field that leads to another number of unknowns.
    #[error(
        "the map \"{map}\" of the field \"{name}\" leads from its {expected} unknowns to {found}; it must keep their number"
    )]
    FieldMap {
        /// The field.
        name: String,
        /// The map.
        map: String,
        /// Numbers that it leads to.
        found: usize,
        /// Unknowns of the field.
        expected: usize,
    },
    /// A consumer that cannot follow from a design field.
    #[error("the design field \"{name}\" has the consumer \"{of}\": {why}")]
    Consumer {
        /// The design field.
        name: String,
        /// The slots.
        of: String,
        /// What is wrong, and what to try.
        why: &'static str,
    },
    /// Region space over regions that overlap.
    #[error(
        "regions \"{first}\" and \"{second}\" share {cells} cells, so a control by region has no single value there: give the actuation a \
         list of regions that do not overlap, or take the space \"uniform\" or \"cell\""
    )]
    OverlappingRegions {
        /// A region.
        first: String,
        /// Another.
        second: String,
        /// How many cells they share.
        cells: usize,
    },
    /// Region space over a region that others divide in part.
    #[error(
        "{cells} cells of region \"{region}\" are in none of its parts ({parts}), so a control by region has no value there: give the \
         actuation a list of regions that do not overlap, or take the space \"uniform\" or \"cell\""
    )]
    UndividedRegion {
        /// The region.
        region: String,
        /// The regions that share some of its cells.
        parts: String,
        /// How many cells are in none of them.
        cells: usize,
    },
    /// A grid of controls that cannot be.
    #[error("a grid of {cells:?} cells cannot be: at least 1 along each axis, and at most 4294967295 nodes in all")]
    Grid {
        /// Cells along each axis.
        cells: [u32; 3],
    },
    /// A vector of the wrong length.
    #[error("the control vector has {found} entries where the problem has {expected}")]
    Length {
        /// Its length.
        found: usize,
        /// Length of the layout.
        expected: usize,
    },
    /// A cost that does not give second derivatives.
    #[error(
        "the cost {cost} gives no second derivatives; take a method that needs first ones alone (lbfgs, spectral, projected_gradient); in the library: `CostPoint::add_second_partials`"
    )]
    NoSecondPartials {
        /// Its name, or where none is known the type of the evaluated cost.
        cost: String,
    },
    /// A cost that was bound to another body than that of the problem.
    #[error(
        "the cost \"{cost}\" is bound to the mesh of another body: bind it to the body of the problem (`bind_to`), or add it unbound"
    )]
    OtherBody {
        /// Its name.
        cost: String,
    },
    /// What a problem in time does not have.
    #[error(
        "{what} of a problem in time are not there: take an optimiser of first derivatives (L-BFGS, projected gradient)"
    )]
    InTime {
        /// What was asked for.
        what: &'static str,
    },
    /// What failed on another rank of the team.
    #[error("{}", .0.message)]
    Remote(Box<RemoteFailure>),
    /// A cost that makes no sense as given.
    #[error("{what}")]
    Cost {
        /// What is wrong and what to try.
        what: String,
    },
}

/// What is known of an error on another rank of the team.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemoteFailure {
    /// The rank.
    pub rank: usize,
    /// How it reads.
    pub message: String,
    /// Newton iterations of the state solve, where that is known.
    pub newton: Option<usize>,
    /// Whether that machine has too little memory.
    pub lacks_memory: bool,
    /// Whether a law, a contribution or a cost has no second derivatives.
    pub lacks_second_derivatives: bool,
}

impl ControlError {
    /// The same of a cost or constraint whose name is known.
    pub fn of(self, name: &str) -> Self {
        match self {
            ControlError::NoSecondPartials { .. } => ControlError::NoSecondPartials { cost: format!("\"{name}\"") },
            other => other,
        }
    }

    /// Whether the machine has too little memory: nothing is said of the control.
    pub fn is_lack_of_memory(&self) -> bool {
        match self {
            ControlError::State(error) => error.is_lack_of_memory(),
            ControlError::Remote(failure) => failure.lacks_memory,
            _ => false,
        }
    }

    /// Whether messages between the ranks that have the body have failed: nothing is said of the control.
    pub fn is_lost_rank(&self) -> bool {
        match self {
            ControlError::Fem(error) => matches!(error, FemError::Team(_)),
            ControlError::State(error) => error.is_lost_rank(),
            _ => false,
        }
    }

    /// Whether a law, a contribution or a cost has no second derivatives: nothing is said of the control.
    pub fn lacks_second_derivatives(&self) -> bool {
        match self {
            ControlError::NoSecondPartials { .. }
            | ControlError::InTime { .. }
            | ControlError::State(StateError::SecondDerivatives(_)) => true,
            ControlError::Remote(failure) => failure.lacks_second_derivatives,
            _ => false,
        }
    }

    /// The limit point that the way to the control leads to, where that is why there is no state.
    pub fn limit(&self) -> Option<&ControlLimit> {
        if let ControlError::LimitPoint { limit, .. } = self { Some(limit) } else { None }
    }

    /// Newton iterations of the state solve that failed, where that is known.
    pub fn newton(&self) -> Option<usize> {
        match self {
            ControlError::State(StateError::NoConvergence { newton, .. }) => Some(*newton),
            ControlError::Unstable { newton, .. } | ControlError::LimitPoint { newton, .. } => Some(*newton),
            ControlError::State(StateError::Inadmissible { last, .. }) => Some(last.report.newton),
            ControlError::Remote(failure) => failure.newton,
            _ => None,
        }
    }
}

/// A failed trial keeps the error with its type, the Newton iterations spent, and how far its step may go. A lack of memory is fatal, and a lost rank.
impl From<ControlError> for Failed {
    fn from(error: ControlError) -> Self {
        let newton = error.newton().map(|newton| ("newton".to_owned(), newton as f64));
        let limit = error.limit().map(|limit| limit.share);
        let is_fatal = error.is_lack_of_memory() || error.is_lost_rank();
        let failed = Failed::new(error).after(Summary(newton.into_iter().collect()));
        let failed = limit.map_or(failed.clone(), |share| failed.beyond(share));
        if is_fatal { failed.fatal() } else { failed }
    }
}
