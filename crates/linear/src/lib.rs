//! Sparse matrices on the node graph of a mesh, and the solution of their systems.
//!
//! The chain, each link built once per mesh and shared: [`Graph`] (which nodes are coupled), [`Ordering`] (a fill-reducing
//! ordering), [`Pattern`] (where entries are stored), [`Structure`] (the pattern and, when first asked for, [`Symbolic`], the
//! structure of the factor). Then, per matrix, [`SparseMatrix`] and [`Factor`]; [`solver`] has what nonlinear solves use: one trait
//! over factors, multigrid, GMRES and LU, each with a [`SolverFactory`].
//!
//! Modules use only those before them: `memory`, `pattern`, `factor`, `krylov`, `multigrid`, `space`, `solver`, `eigenpairs`.
//!
//! ```
//! use std::sync::Arc;
//! use nastic_linear::{Graph, Ordering, Pattern, Pivots, SparseMatrix, Symbolic};
//!
//! // Two springs in a row, one dof per node, the first node held.
//! let elements: [&[u32]; 2] = [&[0, 1], &[1, 2]];
//! let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
//! let graph = Graph::from_cliques(3, elements)?;
//! let pattern = Arc::new(Pattern::new(&graph, 1, Ordering::best(&graph, &points)?)?);
//! let symbolic = Arc::new(Symbolic::new(&pattern));
//!
//! let mut stiffness = SparseMatrix::zeros(pattern.clone());
//! for nodes in elements {
//!     stiffness.add_pairs(nodes, &[1.0, -1.0, -1.0, 1.0])?;
//! }
//! stiffness.eliminate(&[true, false, false], 1.0);
//! let factor = symbolic.factorize(&stiffness, Pivots::Positive, false)?;
//! let mut u = [0.0, 0.0, 1.0];
//! factor.solve(&mut u, 1);
//! assert!((u[2] - 2.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod eigenpairs;
mod error;
mod factor;
mod krylov;
mod locks;
pub mod memory;
mod multigrid;
mod pattern;
pub mod solver;
mod space;
mod sums;

pub use eigenpairs::{
    ByProducts, DefiniteProblem, Eigenpairs, Eigenproblem, Inversion, MassMatrix, leading_eigenpairs,
    smallest_eigenpairs,
};
pub use error::{FactorError, NotCoupled, StructureError};
pub use factor::factor_size::FactorSize;
pub use factor::joined_structure::JoinedStructure;
pub use factor::rotations::{CorotatedPreconditioner, Rotations};
pub use factor::structure::Structure;
pub use factor::symbolic::Symbolic;
pub use factor::symmetric::{Factor, Pivots, Precision};
pub use krylov::conjugate_gradients::{CgEnd, CgReport, StoppingTest, conjugate_gradient};
pub use krylov::gmres::gmres;
pub use krylov::refinement::refine;
pub use krylov::volume_modes::VolumeModes;
pub use multigrid::{CellProducts, CornerMatrix, Corners, Geometry, Multigrid};
pub use pattern::element_block::ElementBlock;
pub use pattern::entries::Pattern;
pub use pattern::graph::Graph;
pub use pattern::matrix::{SparseMatrix, Symmetry};
pub use pattern::mixing::RowsOfNodes;
pub use pattern::operator::{OnThreads, Operator, Preconditioner};
pub use pattern::ordering::{Ordering, OrderingMethod};
pub use pattern::ties::Ties;
pub use solver::{LinearError, LinearSolver, LinearWork, Solver, SolverFactory};
pub use space::{Field, On, Role, Share, Space};
