//! nastic: optimal control of actuated hyperelastic soft bodies.
//!
//! Given a soft body, what it is made of and how it can be actuated, find the actuation that bends it into the shape you
//! want, and prove that the answer is right. The body obeys a polyconvex energy and is solved by finite elements at finite
//! strain; fibre tension, turgor, air or hard magnets drive it; a cost says how far it is from the target; the adjoint gives the
//! gradient; a projected method moves the controls within their bounds.
//!
//! ```
//! use nastic::prelude::*;
//!
//! let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [5, 1, 2], CellKind::Hex8)?)?
//!     .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
//!     .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
//!     .clamp("x-")?;
//! let lifted = Target::position(|x| [0.98 * x[0], x[1], x[2] + 0.1]);
//! let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(Tracking::surface("x+", lifted))?;
//! let best = Lbfgs::default().within(Bounds::new(-3e5, 1.9e5)?).minimize(&problem, 0.0)?;
//! assert!(best.cost < 1e-2 * problem.at(&[0.0; 10])?.cost());
//!
//! // The same with an evaluated start, a line per trial and a tolerance; then stepped by hand.
//! let start = problem.at(&[0.0; 10])?;
//! let print = Print::of(&problem, std::io::stdout());
//! let mut search = Lbfgs::default().within(Bounds::new(-3e5, 1.9e5)?).tolerance(1e-2).observe(print);
//! let near = search.minimize(&problem, &start)?;
//! let mut run = search.start(&problem, near.point)?;
//! while run.step(&mut ()) == Outcome::Iterated {}
//! assert!(run.cost() < near.cost);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`tensor`] | 3x3 kinematics, the tensor cross product |
//! | [`energy`] | passive laws and actuations, contract checks for your own |
//! | [`mesh`] | elements, meshes, quality, exact distances |
//! | [`io`] | Gmsh and VTU in; VTU and PVD out |
//! | [`picture`] | pictures of bodies, PNG and SVG |
//! | [`report`] | a result folder as one HTML page |
//! | [`numeric`], [`linear`] | vectors, sparse matrices, factorisation, iterative solvers, multigrid |
//! | [`fem`] | bodies, equilibria, adjoints |
//! | [`hausdorff`] | the smoothed Hausdorff distance of point clouds |
//! | [`uncertainty`] | random parameters, rules over them, measures of risk |
//! | [`team`] | ranks that share out members of an ensemble |
//! | [`opt`] | admissible sets, optimisers, the Taylor test |
//! | [`control`] | control fields, costs, reduced problems, ensembles |
//! | [`case`] | case files and what the command line does with them |

pub use nastic_energy as energy;
pub use nastic_fem as fem;
pub use nastic_fit as fit;
pub use nastic_hausdorff as hausdorff;
pub use nastic_io as io;
pub use nastic_linear as linear;
pub use nastic_mesh as mesh;
pub use nastic_numeric as numeric;
pub use nastic_opt as opt;
pub use nastic_picture as picture;
pub use nastic_report as report;
pub use nastic_team as team;
pub use nastic_tensor as tensor;
pub use nastic_uncertainty as uncertainty;

/// Control fields, costs, reduced problems, ensembles of them.
pub mod control {
    pub use nastic_control::*;
    pub use nastic_ensemble::*;
}

/// Case files and what the command line does with them.
pub mod case {
    pub use nastic_case::{lower, warning};
    pub use nastic_language::{catalogue, expression, quantity, schema, syntax, template};
    pub use nastic_run::{console, history, result, run, signals};
}

/// What most programs need.
pub mod prelude {
    pub use crate::case::run::{Optimum, Study};
    pub use crate::control::{
        ControlNorm, ControlSmoothness, Cost, CostPoint, Ensemble, EnsemblePoint, Evaluated, LoadCase, Metric, Phi,
        Reduced, SmoothedHausdorff, Space, Target, Tracking,
    };
    pub use crate::energy::{
        ConvexDensity, EnergyTerm, FiberTension, Field, Magnet, MagnetIsochoric, MagnetRotation, MooneyRivlin,
        NeoHooke, NeoHookeIsochoric, TransverseMooneyRivlin, Turgor,
    };
    pub use crate::fem::{
        Cavity, Contribution, Discretization, Formulation, Foundation, MovingSupport, Solid, SolveOptions, Spring,
        State, Tendon, TimeStepping,
    };
    pub use crate::mesh::{CellKind, Mesh, Snapshot, box_mesh, rectangle};
    pub use crate::opt::{
        Ball, Best, Bounds, Lbfgs, Objective, Optimizer, Options, Outcome, Print, Problem, Product, ProjectedGradient,
        Request, Run, Spectral, Sphere, Taylor, Trial,
    };
    pub use crate::tensor::{Mat3, Vec3};
}
