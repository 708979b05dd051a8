//! Sparse matrices on the node graph of a mesh, and the solution of their systems.
//!
//! The chain, each link built once per mesh and shared: [`Graph`] (which nodes are coupled), [`Ordering`] (a fill-reducing
//! ordering), [`Pattern`] (where entries are stored), [`Structure`] (the pattern and, when first asked for, [`Symbolic`], the
//! structure of the factor). Then, per matrix, [`SparseMatrix`] and [`Factor`]; [`solver`] has what nonlinear solves use: one trait
//! over factors, multigrid, GMRES and LU, each with a [`SolverFactory`].
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

mod bunch_kaufman;
mod columns;
mod dense;
mod dissection;
mod eigenpairs;
mod element_block;
mod elimination;
mod error;
mod factor;
mod factor_size;
mod gmres;
mod graph;
mod iterative;
mod joined_structure;
mod locks;
mod lu_factor;
mod matrix;
pub mod memory;
mod mixing;
mod multigrid;
mod multigrid_work;
mod numeric;
mod operator;
mod ordering;
mod panel;
mod pattern;
mod real;
mod refinement;
mod rotations;
mod saddle_gmres;
mod schedule;
mod skew;
mod solve;
pub mod solver;
mod space;
mod structure;
mod sums;
mod symbolic;
mod ties;
mod volume_modes;

pub use eigenpairs::{
    ByProducts, Eigenpairs, Eigenproblem, MassMatrix, ProductEigenproblem, smallest_eigenpairs,
    smallest_eigenpairs_by_products,
};
pub use element_block::ElementBlock;
pub use error::{FactorError, NotCoupled, StructureError};
pub use factor::{Factor, Pivots, Precision};
pub use factor_size::FactorSize;
pub use gmres::{GmresReport, gmres};
pub use graph::Graph;
pub use iterative::{CgEnd, CgReport, Preconditioner, StoppingTest, conjugate_gradient};
pub use joined_structure::JoinedStructure;
pub use matrix::{SparseMatrix, Symmetry};
pub use mixing::RowsOfNodes;
pub use multigrid::{CellProducts, CornerMatrix, Corners, Geometry, Multigrid};
pub use operator::{OnThreads, Operator};
pub use ordering::{Ordering, OrderingMethod};
pub use pattern::Pattern;
pub use refinement::refine;
pub use rotations::{CorotatedPreconditioner, Rotations};
pub use solver::{LinearError, LinearSolver, LinearWork, Solver, SolverFactory};
pub use space::{Field, On, Role, Share, Space};
pub use structure::Structure;
pub use symbolic::Symbolic;
pub use ties::Ties;
pub use volume_modes::VolumeModes;
