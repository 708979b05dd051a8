//! [`Tangent`]: the tangent at a displacement, by its entries or by the products of its cells.

use crate::linear_systems::tangent_systems::eliminate;
use crate::model::Model;
use nastic_linear::{CellProducts, SparseMatrix};
use std::sync::Arc;

/// K at a displacement.
#[derive(Debug, Clone)]
pub struct Tangent {
    /// Without values where there are products.
    matrix: SparseMatrix,
    products: Option<Arc<dyn CellProducts>>,
}

/// A tangent, wherever it is kept.
#[derive(Clone, Copy)]
pub struct TangentRef<'a> {
    pub matrix: &'a SparseMatrix,
    pub products: Option<&'a Arc<dyn CellProducts>>,
}

impl TangentRef<'_> {
    /// `out = K v`, supports as they are: before they are [eliminated](Tangent::eliminate).
    pub fn multiply(&self, v: &[f64], out: &mut [f64], parallel: bool) {
        match self.products {
            Some(products) => products.multiply_whole(v, out, parallel),
            None => self.matrix.multiply_on(v, out, parallel),
        }
    }
}

impl<'a> From<&'a SparseMatrix> for TangentRef<'a> {
    fn from(matrix: &'a SparseMatrix) -> Self {
        TangentRef { matrix, products: None }
    }
}

impl<'a> From<&'a Tangent> for TangentRef<'a> {
    fn from(tangent: &'a Tangent) -> Self {
        TangentRef { matrix: &tangent.matrix, products: tangent.products.as_ref() }
    }
}

impl Tangent {
    /// By its entries.
    pub fn of_entries(matrix: SparseMatrix) -> Self {
        Tangent { matrix, products: None }
    }

    /// By the products of its cells.
    pub fn of_products(model: &Model, products: Arc<dyn CellProducts>) -> Self {
        Tangent { matrix: model.matrix_without_values(), products: Some(products) }
    }

    /// The entries, if it has some.
    pub fn into_entries(self) -> Option<SparseMatrix> {
        if self.products.is_none() { Some(self.matrix) } else { None }
    }

    /// The entries, if it has some, to be added to.
    pub fn entries_mut(&mut self) -> Option<&mut SparseMatrix> {
        if self.products.is_none() { Some(&mut self.matrix) } else { None }
    }

    /// Whether products of cells replace its entries.
    pub fn is_unassembled(&self) -> bool {
        self.products.is_some()
    }

    /// Eliminates the supports.
    pub fn eliminate(&mut self, model: &Model) {
        if self.products.is_none() {
            eliminate(model, &mut self.matrix);
        }
    }
}
