//! Iterations with a preconditioner: conjugate gradients, GMRES, refinement of a factor's solution.

pub(crate) mod conjugate_gradients;
pub(crate) mod gmres;
pub(crate) mod refinement;
pub(crate) mod saddle_gmres;
pub(crate) mod volume_modes;
