//! The compiled part of the Python package `nastic`: cases run, problems evaluated, meshes built; numbers as NumPy arrays, everything
//! else as JSON text. The classes that users see are the Python files beside it.

mod error;
mod interrupt;
mod mesh;
mod problem;
mod run;
mod shapes;
mod states;

/// `nastic._nastic`.
#[pyo3::pymodule]
mod _nastic {
    #[pymodule_export]
    use crate::mesh::Mesh;
    #[pymodule_export]
    use crate::problem::Problem;
    #[pymodule_export]
    use crate::run::{figure, fit, read, read_mesh, run, schema};
    #[pymodule_export]
    use crate::shapes::{cloud, compare};
    #[pymodule_export]
    use crate::states::States;

    /// Version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
