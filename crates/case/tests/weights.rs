//! Control fields are weighed against each other by their ranges.

#![allow(clippy::unwrap_used)] // a test may

use nastic_case::lower::CaseProblem;
use nastic_language::syntax::Document;
use std::sync::Arc;

/// A change through the whole range counts the same in every field, whatever its unit and its size.
#[test]
fn fields_are_weighed_by_their_ranges() {
    let case = r#"{ "nastic": 1, "mesh": { "box": { "size": [1, 0.1], "cells": [10, 1], "element": "quad9" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0 } ],
        "supports": [ { "surface": "x-", "fix": ["x", "y"] } ],
        "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body" },
                       { "name": "swelling", "kind": "turgor", "region": "body" } ],
        "controls": [ { "of": "magnet.remanence", "space": "cell", "start": [1, 0, 0], "norm": "100 mT" },
                      { "of": "magnet.field", "space": "uniform", "max_norm": "1 mT" },
                      { "of": "swelling", "space": "node", "lower": "-10 kPa", "upper": "30 kPa" } ],
        "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y + 0.1"] } ] }"#;
    for metric in [r#"metric="l2""#, r#"metric={ "h1": 0.2 }"#] {
        let mut document = Document::parse("case.json", case).unwrap();
        document.set(&format!("optimizer/{metric}")).unwrap();
        let problem = CaseProblem::lower(document, Arc::default()).unwrap();
        let product = problem.inner_product().unwrap();
        let sizes: Vec<f64> = problem
            .ensemble
            .blocks()
            .iter()
            .zip([(3, 0.2), (3, 0.002), (1, 4e4)])
            .map(|(block, (components, range))| {
                let mut v = vec![0.0; product.len()];
                v[block.first..block.first + block.len].iter_mut().step_by(components).for_each(|x| *x = range);
                product.norm(&v)
            })
            .collect();
        // The body has the volume 0.1, the first field the range 0.2.
        sizes.iter().for_each(|size| assert!((size / (0.1_f64.sqrt() * 0.2) - 1.0).abs() < 1e-10, "{sizes:?}"));
    }
}
