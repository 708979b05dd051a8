//! The contract of every inner product of the catalogue.
#![allow(clippy::unwrap_used)]

#[path = "common/inner_product.rs"]
mod contract;

use nastic_opt::{Diagonal, INNER_PRODUCTS, InnerProductError};

#[test]
fn every_inner_product_keeps_its_contract() {
    for row in INNER_PRODUCTS {
        for len in [2, 3, 17, 100] {
            contract::keeps_its_contract((row.make)(len).unwrap().as_ref(), row.name);
        }
    }
}

#[test]
fn weights_that_are_not_positive_are_refused() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = Diagonal::new(vec![1.0, value]).unwrap_err();
        assert!(matches!(refused, InnerProductError::Weight { index: 1, .. }), "{refused}");
    }
}
