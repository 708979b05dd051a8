//! [`SpectrumRecord`]: eigenvalues of the reduced Hessian at an optimum.

use crate::record::{ByName, Number, RangeRecord};

records! {
    /// Eigenvalues of the reduced Hessian at an optimum, or why they were not found.
    SpectrumRecord {
        /// Why they were not found.
        failed: Option<String>,
        /// Eigenvalues, descending.
        eigenvalues: Option<Vec<Number>>,
        /// Residuals of the eigenpairs.
        residuals: Option<Vec<Number>>,
        /// Hessian products.
        products: Option<usize>,
        /// Free directions.
        free: Option<usize>,
        /// Negative eigenvalues seen.
        negative: Option<usize>,
        /// The lowest of all seen.
        lowest: Number,
        /// By control its share in the squared norm of every eigenvector.
        shares: Option<ByName<Vec<Number>>>,
        /// Eigenvalues above a thousandth of the largest.
        above: Option<usize>,
        /// Directions that hold 99 % of the curvature.
        most: Option<usize>,
        /// The rise of the cost that half-widths belong to.
        cost_rise: Number,
        /// How far the control may move along each eigenvector until the cost rises by that.
        half_widths: Option<Vec<Number>>,
        /// By control least and largest half-width over its values.
        half_width: Option<ByName<RangeRecord>>,
    }

    /// The content of `spectrum.json`, as control vectors.
    EigenvectorsRecord {
        /// Eigenvectors of the reduced Hessian.
        eigenvectors: Vec<ByName<Vec<Number>>>,
        /// Half-width of every value.
        half_width: ByName<Vec<Number>>,
    }
}
