//! Every admissible set of this crate, with an example.

use super::{Admissible, Ball, Bounds, Product, SetError, Sphere};
use std::sync::Arc;

/// A row of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct SetRow {
    /// The set's name.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// Components per point.
    pub components: usize,
    /// Whether it is convex; steps of its local model are then differences of admissible controls.
    pub convex: bool,
    /// An example over a number of points, of a size of about one.
    pub make: fn(usize) -> Result<Arc<dyn Admissible>, SetError>,
}

/// Every admissible set.
pub const CATALOGUE: &[SetRow] = &[
    SetRow {
        name: "bounds",
        about: "lower <= m <= upper, component by component",
        components: 1,
        convex: true,
        make: |points| {
            let lower = (0..points).map(|i| -1.0 - 0.1 * (i % 3) as f64).collect::<Vec<_>>();
            Ok(Arc::new(Bounds::new(lower, 0.7)?))
        },
    },
    SetRow {
        name: "sphere",
        about: "vectors of one length",
        components: 3,
        convex: false,
        make: |_| Ok(Arc::new(Sphere::new(3, 1.3)?)),
    },
    SetRow {
        name: "circle",
        about: "vectors of the plane of one length",
        components: 2,
        convex: false,
        make: |_| Ok(Arc::new(Sphere::new(2, 0.8)?)),
    },
    SetRow {
        name: "ball",
        about: "vectors no longer than a radius",
        components: 3,
        convex: true,
        make: |_| Ok(Arc::new(Ball::new(3, 0.9)?)),
    },
    SetRow {
        name: "product",
        about: "blocks of components, each in its own set",
        components: 4,
        convex: true,
        make: |points| {
            Ok(Arc::new(Product::new().block(points, Bounds::new(-0.5, 0.5)?).block(3 * points, Ball::new(3, 1.1)?)))
        },
    },
];
