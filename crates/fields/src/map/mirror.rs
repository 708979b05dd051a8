//! [`Mirror`]: a field that is its own mirror image.

use super::{Basis, ControlMap};
use crate::error::ControlError;
use nastic_mesh::spatial::{Aabb, Tree};
use nastic_numeric::vector::{dot, norm, sub};
use nastic_tensor::Vec3;

/// How far a mirror image may lie from an unknown along each axis, as a share of the diagonal of the box around all of them.
const IMAGE_TOLERANCE: f64 = 1e-6;

/// A plane of symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of it; `None`: the middle of the box around the places of the unknowns.
    pub point: Option<[f64; 3]>,
    /// Its normal, of any length but zero.
    pub normal: [f64; 3],
}

/// `y_i = (x_i + x_i') / 2` with the unknown i' at the mirror image of the place of i: fields that are symmetric about a plane stay as they are, of others the symmetric part is left. Linear and symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct Mirror {
    images: Vec<u32>,
    plane: Plane,
}

impl Mirror {
    /// About a plane.
    ///
    /// # Errors
    /// A normal without length; a field of vectors; a place whose mirror image has no unknown; a plane in which all places lie.
    pub fn new(basis: &Basis, components: usize, plane: Plane) -> Result<Self, ControlError> {
        let fail = |what: String| Err(ControlError::Cost { what });
        let length = norm(&plane.normal);
        if !(length.is_finite() && length > 0.0) {
            return fail(format!("the normal {:?} of a plane of symmetry has no finite length but zero", plane.normal));
        }
        if components > 1 {
            return fail("symmetric are scalar fields".to_owned());
        }
        let normal = plane.normal.map(|n| n / length);
        let places = basis.positions();
        let (low, high) = places.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), x| {
            ([0, 1, 2].map(|k| low[k].min(x[k])), [0, 1, 2].map(|k| high[k].max(x[k])))
        });
        let point = plane.point.unwrap_or([0, 1, 2].map(|k| 0.5 * (low[k] + high[k])));
        let boxes: Vec<Aabb> = places.iter().map(|x| Aabb::around([&Vec3::from(*x)])).collect();
        let (tree, tolerance) = (Tree::build(&boxes), IMAGE_TOLERANCE * norm(&sub(&high, &low)));
        let mut images = Vec::with_capacity(places.len());
        for (i, x) in places.iter().enumerate() {
            let depth = dot(&sub(x, &point), &normal);
            let image = [0, 1, 2].map(|k| x[k] - 2.0 * depth * normal[k]);
            let range = Aabb::around([&Vec3::from(image)]).grown(tolerance);
            let mut found = None;
            tree.overlapping(&range, |other| {
                let is_there = boxes[other].overlaps(&range);
                found = is_there.then_some(other as u32);
                is_there
            });
            let Some(found) = found else {
                return fail(format!(
                    "the mesh is not symmetric about the plane through {point:?} with the normal {normal:?}: {} at {x:?} has no mirror image at {image:?}",
                    basis.describe(i)
                ));
            };
            images.push(found);
        }
        if images.iter().enumerate().all(|(i, image)| i == *image as usize) {
            return fail(format!(
                "all places lie in the plane through {point:?} with the normal {normal:?}: the symmetry ties none of them"
            ));
        }
        Ok(Mirror { images, plane: Plane { point: Some(point), normal } })
    }
}

impl ControlMap for Mirror {
    fn describe(&self) -> String {
        format!("symmetric about {:?} with normal {:?}", self.plane.point.unwrap_or_default(), self.plane.normal)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.images.iter().zip(x).map(|(image, x_i)| 0.5 * (x_i + x[*image as usize])).collect()
    }

    fn change(&self, _: &[f64], v: &[f64]) -> Vec<f64> {
        self.values(v)
    }

    fn vjp(&self, _: &[f64], g: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = g.iter().map(|g| 0.5 * g).collect();
        self.images.iter().zip(g).for_each(|(image, g)| out[*image as usize] += 0.5 * g);
        out
    }
}
