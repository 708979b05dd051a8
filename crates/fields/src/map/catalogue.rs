//! Every kind of control map with an example, which the contract tests take.

use super::{
    Basis, Chain, ControlMap, Direction, Expansion, Exponential, Filter, Held, Length, Mirror, Plane, PowerLaw,
    Projection, Space, Staged,
};
use crate::error::ControlError;
use nastic_fem::Discretization;
use std::sync::Arc;

/// A map, and values that it can be evaluated at.
pub type MapExample = (Arc<dyn ControlMap>, Vec<f64>);

/// A row of the catalogue of control maps.
#[derive(Debug, Clone, Copy)]
pub struct MapRow {
    /// The map's name.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// An example on the region `body` of a mesh.
    pub example: fn(&Discretization) -> Result<MapExample, ControlError>,
}

/// Every kind of control map.
pub const MAPS: &[MapRow] = &[
    MapRow {
        name: "expansion",
        about: "m(q) = sum_i phi_i(q) m_i",
        example: |disc| {
            let map = expansion(disc, 2)?;
            let x = sample(map.basis.len() * 2);
            Ok((Arc::new(map), x))
        },
    },
    MapRow { name: "direction", about: "x d", example: |_| Ok((Arc::new(Direction([0.6, 0.0, -0.8])), sample(5))) },
    MapRow {
        name: "length",
        about: "L x/|x|",
        example: |_| Ok((Arc::new(Length { length: 0.3, components: 3 }), sample(12))),
    },
    MapRow {
        name: "power_law",
        about: "low + (high - low) x^p",
        example: |_| {
            let x = sample(5).into_iter().map(|x| 1.0 + 0.5 * x).collect();
            Ok((Arc::new(PowerLaw { low: 0.2, high: 1.4, exponent: 3.0 }), x))
        },
    },
    MapRow {
        name: "filter",
        about: "(1 - R^2 laplace)^-1 x",
        example: |disc| {
            let basis = expansion(disc, 2)?.basis;
            Ok((Arc::new(Filter::new(disc, &basis, 2, 0.3)?), sample(2 * basis.len())))
        },
    },
    MapRow {
        name: "projection",
        about: "tanh between 0 and 1 about a threshold",
        example: |_| {
            let x = sample(5).into_iter().map(|x| 0.3 + 0.2 * x).collect();
            Ok((Arc::new(Projection { threshold: 0.4, sharpness: 3.0 }), x))
        },
    },
    MapRow {
        name: "held",
        about: "x, but c in regions",
        example: |disc| {
            let basis = expansion(disc, 1)?.basis;
            Ok((Arc::new(Held::new(disc, &basis, 1, &"body".into(), 0.4)?), sample(basis.len())))
        },
    },
    MapRow {
        name: "mirror",
        about: "the symmetric part about a plane",
        example: |disc| {
            let basis = expansion(disc, 1)?.basis;
            let plane = Plane { point: None, normal: [1.0, 0.0, 0.0] };
            Ok((Arc::new(Mirror::new(&basis, 1, plane)?), sample(basis.len())))
        },
    },
    MapRow {
        name: "staged",
        about: "another map in each stage",
        example: |_| {
            let of = |sharpness| Projection { threshold: 0.5, sharpness };
            Ok((Arc::new(Staged::new(vec![Arc::new(of(1.0))], of(2.0))), sample(5)))
        },
    },
    MapRow { name: "exponential", about: "exp x", example: |_| Ok((Arc::new(Exponential), sample(5))) },
    MapRow {
        name: "chain",
        about: "f_n o .. o f_1",
        example: |disc| {
            let map = expansion(disc, 3)?;
            let x = sample(map.basis.len() * 3);
            let first = Length { length: 2.0, components: 3 };
            Ok((Arc::new(Chain::default().then(first).then(map).then(Length { length: 0.3, components: 3 })), x))
        },
    },
];

fn expansion(disc: &Discretization, components: usize) -> Result<Expansion, ControlError> {
    let basis = Arc::new(Basis::new(disc, &"body".into(), Space::Node)?);
    Ok(Expansion { basis, components })
}

fn sample(len: usize) -> Vec<f64> {
    (0..len).map(|i| 0.7 + (1.3 * i as f64).sin()).collect()
}
