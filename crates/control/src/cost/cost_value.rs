//! [`CostValue`]: the value of a key of a cost, and how it is put into words.

use super::markers::Marker;
use super::target_positions::Target;
use nastic_fem::BodyPoint;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{GroupNames, Mesh};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A type that values of keys have.
pub trait CostTaken: Sized {
    /// The value, where it has this type.
    fn of(value: &CostValue) -> Option<Self>;
}

macro_rules! values {
    ($($(#[doc = $about:literal])* $variant:ident($type:ty)),* $(,)?) => {
        /// The value of a key of a cost, in the body's units.
        #[derive(Clone, Debug)]
        pub enum CostValue {
            $($(#[doc = $about])* $variant($type),)*
        }

        $(impl CostTaken for $type {
            fn of(value: &CostValue) -> Option<Self> {
                if let CostValue::$variant(value) = value { Some(value.clone()) } else { None }
            }
        })*
    };
}

values! {
    /// Groups of the mesh, which has them.
    Names(GroupNames),
    /// Whether something is so.
    Flag(bool),
    /// Components, 0 to 2.
    Components(Vec<usize>),
    /// Points of the body.
    Points(Vec<BodyPoint>),
    /// A number.
    Number(f64),
    /// A whole number of at least 1.
    Count(u32),
    /// One of a few words.
    Word(&'static str),
    /// The library's name of a control, or the name of a contact.
    Name(String),
    /// A point inside of the body, or a direction.
    Vector([f64; 3]),
    /// Points inside of the body.
    Line(Vec<[f64; 3]>),
    /// Markers that were measured.
    Markers(Vec<Marker>),
    /// A position.
    Position([Option<f64>; 3]),
    /// Positions of all points.
    Target(Target),
    /// An obstacle.
    Obstacle(Obstacle),
    /// A mesh.
    Mesh(Arc<Mesh>),
}

/// The values of a cost's keys in words.
#[derive(Clone, Debug, Default)]
pub struct CostWords {
    /// By key, those left out without a default not among them.
    pub texts: BTreeMap<&'static str, String>,
    /// The whole numbers among them.
    pub counts: BTreeMap<&'static str, u32>,
}

impl CostWords {
    /// The value of a key in words.
    pub fn given(&self, key: &str) -> Option<&str> {
        self.texts.get(key).map(String::as_str)
    }

    /// The same, empty for a key left out.
    pub fn text(&self, key: &str) -> &str {
        self.given(key).unwrap_or_default()
    }

    /// A whole number, 0 for a key left out.
    pub fn count(&self, key: &str) -> u32 {
        self.counts.get(key).copied().unwrap_or_default()
    }

    /// What is named by one of the keys "surface", "region" and "nodes".
    pub fn place(&self) -> &str {
        ["surface", "region", "nodes"].into_iter().find_map(|key| self.given(key)).unwrap_or_default()
    }
}
