//! A part of a cell, and the inverse of the cell's map over it.

use nalgebra::Matrix3;

use super::V;
use super::interpolation_error::InterpolationError;
use super::patch::{Patch, SecondBounds, longest};
use super::patch_space::PatchSpace;
use super::tree::Aabb;

/// Distance of parameters from the domain up to which they belong to the cell: a point on a face is in the solid.
const FACE_TOLERANCE: f64 = 1e-9;
/// Relative change of the slope of a map over a part, up to which it is inverted without cutting the part further.
const MAX_SLOPE_CHANGE: f64 = 0.5;

/// A box (by its least corner and its widths) or simplex (by its corners) of a cell's parameters.
#[derive(Clone, Debug)]
pub(super) struct SubCell {
    corners: [[f64; 3]; 8],
    count: usize,
    /// Holds the image of the part.
    pub bounds: Aabb,
    /// Slabs lo <= axis . x <= hi that hold the image, parallel to its faces.
    slabs: [(V, f64, f64); 4],
    /// Where the map is not degenerate at the centre.
    expansion: Option<Expansion>,
}

/// x(u) = x + F (u - centre) + remainder.
#[derive(Clone, Debug)]
struct Expansion {
    centre: V,
    half: V,
    x: V,
    inverse: Matrix3<f64>,
    /// The simplified Newton map u + F^-1 (p - x(u)) contracts by this factor over the box.
    contraction: f64,
}

/// Is a point the image of some point of the cell?
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Containment {
    Inside,
    /// Not of a point in this part.
    Outside,
    Unknown,
}

impl SubCell {
    pub fn whole(patch: &Patch, second_bounds: &SecondBounds) -> Self {
        let space = patch.space;
        Self::new(patch, second_bounds, std::array::from_fn(|i| space.corner(i.min(space.corners() - 1))))
    }

    fn new(patch: &Patch, second_bounds: &SecondBounds, corners: [[f64; 3]; 8]) -> Self {
        let count = patch.space.corners();
        let domain = &corners[..count];
        let deviation = InterpolationError::of(patch, domain);
        let points = corners.map(|u| patch.value(&u));
        let bounds = Aabb::around(&points[..count]);
        // Points on a face of the box are searched too.
        let margin = 2.0 * FACE_TOLERANCE * bounds.diagonal();
        let expansion = expand(patch, second_bounds, domain);
        let slabs = expansion.as_ref().map_or([(V::zeros(), -1.0, 1.0); 4], |e| {
            slabs(patch.space, domain, &e.inverse, &points, &deviation, margin)
        });
        Self { corners, count, bounds: bounds.enlarged(&deviation).grown(margin), slabs, expansion }
    }

    pub fn is_nearly_linear(&self) -> bool {
        self.expansion.as_ref().is_some_and(|e| e.contraction < MAX_SLOPE_CHANGE)
    }

    /// Two halves, cut across the longest edge.
    pub fn halves(&self, patch: &Patch, second_bounds: &SecondBounds) -> [Self; 2] {
        let points = self.corners.map(|u| patch.value(&u));
        let (mut first, mut second) = (self.corners, self.corners);
        for (i, j) in longest(patch.space, &points[..self.count]) {
            let middle = std::array::from_fn(|a| 0.5 * (self.corners[i][a] + self.corners[j][a]));
            first[j] = middle;
            second[i] = middle;
        }
        [Self::new(patch, second_bounds, first), Self::new(patch, second_bounds, second)]
    }

    /// Looks for a parameter of the cell that is mapped to `p`; what it cannot find in this part it says is not there.
    pub fn find(&self, patch: &Patch, p: &V) -> Containment {
        let Some(e) = &self.expansion else { return Containment::Unknown };
        if self.slabs.iter().any(|(axis, lo, hi)| !(*lo..=*hi).contains(&axis.dot(p))) {
            return Containment::Outside;
        }
        let step = e.inverse * (p - e.x);
        let mut u = e.centre + step;
        if e.contraction == 0.0 {
            return if in_domain(patch.space, &u) { Containment::Inside } else { Containment::Outside };
        }
        if newton(patch, p, &mut u, e) && in_domain(patch.space, &u) {
            return Containment::Inside;
        }
        if e.contraction < 0.9 { e.fixed_point(patch, p, step) } else { Containment::Unknown }
    }
}

/// Slabs normal to the axes that the tangent map turns into coordinates (of a box) or barycentric coordinates (of a
/// simplex).
fn slabs(
    space: PatchSpace,
    corners: &[[f64; 3]],
    inverse: &Matrix3<f64>,
    points: &[V; 8],
    deviation: &InterpolationError,
    margin: f64,
) -> [(V, f64, f64); 4] {
    let mut axes = [V::zeros(); 4];
    let edges = Matrix3::from_fn(|a, k| match (space.simplex && a < space.dim && k < space.dim, a == k) {
        (true, _) => corners[k + 1][a] - corners[0][a],
        (false, same) => f64::from(u8::from(same)),
    });
    let gradients = edges.try_inverse().unwrap_or_default() * inverse;
    for a in 0..space.dim {
        axes[a] = gradients.row(a).transpose();
        if space.simplex {
            axes[3] -= axes[a];
        }
    }
    axes.map(|axis| {
        let along = points[..corners.len()].iter().map(|x| x.dot(&axis));
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let (less, more) = deviation.extent(&axis);
        (axis, lo + less - axis.norm() * margin, hi + more + axis.norm() * margin)
    })
}

impl Expansion {
    /// The clamped simplified Newton map contracts, so a root in the box is its limit.
    fn fixed_point(&self, patch: &Patch, p: &V, mut d: V) -> Containment {
        let room = self.half.add_scalar(FACE_TOLERANCE);
        let clamp = |d: V| V::from_fn(|a, _| if a < patch.space.dim { d[a].clamp(-room[a], room[a]) } else { 0.0 });
        d = clamp(d);
        let mut miss = V::zeros();
        for _ in 0..200 {
            miss = self.inverse * (p - patch.value(&(self.centre + d).into()));
            let next = clamp(d + miss);
            let moved = (next - d).amax();
            d = next;
            if moved < 1e-13 {
                break;
            }
        }
        if miss.amax() < FACE_TOLERANCE && in_domain(patch.space, &(self.centre + d)) {
            Containment::Inside
        } else {
            Containment::Outside
        }
    }
}

fn expand(patch: &Patch, second_bounds: &SecondBounds, corners: &[[f64; 3]]) -> Option<Expansion> {
    let dim = patch.space.dim;
    let centre: V = corners.iter().map(|u| V::from(*u)).sum::<V>() / corners.len() as f64;
    let half = V::from_fn(|a, _| corners.iter().map(|u| (u[a] - centre[a]).abs()).fold(0.0, f64::max));
    let (x, map) = tangent(patch, &centre);
    let inverse = map.try_inverse().filter(|m| m.iter().all(|v| v.is_finite()))?;
    let mut change = 0.0;
    for a in 0..dim {
        let column: f64 = (0..dim).map(|b| second_bounds[a][b] * half[b]).sum();
        change += column * half[a];
    }
    let rows = V::from_fn(|a, _| if a < dim { inverse.row(a).norm() } else { 0.0 });
    // In the norm max_a |u_a| / half_a.
    let contraction = (0..dim).map(|a| rows[a] * change / half[a]).fold(0.0, f64::max);
    Some(Expansion { centre, half, x, inverse, contraction })
}

/// Value and derivative; in the plane the third direction is mapped to itself.
fn tangent(patch: &Patch, u: &V) -> (V, Matrix3<f64>) {
    let jet = patch.first(&(*u).into());
    let third = if patch.space.dim == 3 { jet.first[2] } else { V::z() };
    (jet.x, Matrix3::from_columns(&[jet.first[0], jet.first[1], third]))
}

/// Newton's iteration, given up when it leaves the neighbourhood of the part.
fn newton(patch: &Patch, p: &V, u: &mut V, e: &Expansion) -> bool {
    for _ in 0..12 {
        if (0..patch.space.dim).any(|a| !u[a].is_finite() || (u[a] - e.centre[a]).abs() > 3.0 * e.half[a]) {
            return false;
        }
        let (x, map) = tangent(patch, u);
        let Some(step) = map.try_inverse().map(|m| m * (p - x)) else { return false };
        for a in 0..patch.space.dim {
            u[a] += step[a];
        }
        if step.amax() < 1e-11 {
            return true;
        }
    }
    false
}

fn in_domain(space: PatchSpace, u: &V) -> bool {
    let low = u.iter().take(space.dim).all(|&v| v >= -FACE_TOLERANCE);
    low && if space.simplex {
        u.iter().take(space.dim).sum::<f64>() <= 1.0 + FACE_TOLERANCE
    } else {
        u.iter().take(space.dim).all(|&v| v <= 1.0 + FACE_TOLERANCE)
    }
}
