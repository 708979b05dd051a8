//! A part of a cell, and the inverse of the cell's map over it.

use nalgebra::Matrix3;

use super::V;
use super::form::Form;
use super::patch::{Bend, Patch, longest};
use super::tree::Aabb;
use super::warp::Warp;

/// Parameters this far outside the domain still belong to the cell: a point on a face is in the solid.
const EDGE: f64 = 1e-9;
/// A map whose slope changes less than this fraction over a part is inverted without cutting it further.
const EASY: f64 = 0.5;

/// A box (by its least corner and its widths) or simplex (by its corners) of a cell's parameters.
#[derive(Clone, Debug)]
pub(super) struct Part {
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
pub(super) enum Answer {
    Inside,
    /// Not of a point in this part.
    Outside,
    Unknown,
}

impl Part {
    pub fn whole(patch: &Patch, bend: &Bend) -> Self {
        let form = patch.form;
        Self::new(patch, bend, std::array::from_fn(|i| form.corner(i.min(form.corners() - 1))))
    }

    fn new(patch: &Patch, bend: &Bend, corners: [[f64; 3]; 8]) -> Self {
        let count = patch.form.corners();
        let domain = &corners[..count];
        let warp = Warp::of(patch, domain);
        let points = corners.map(|u| patch.value(&u));
        let bounds = Aabb::around(&points[..count]);
        // Points on a face of the box are searched too.
        let skin = 2.0 * EDGE * bounds.diagonal();
        let expansion = expand(patch, bend, domain);
        let slabs = expansion
            .as_ref()
            .map_or([(V::zeros(), -1.0, 1.0); 4], |e| slabs(patch.form, domain, &e.inverse, &points, &warp, skin));
        Self { corners, count, bounds: bounds.warped(&warp).grown(skin), slabs, expansion }
    }

    pub fn is_easy(&self) -> bool {
        self.expansion.as_ref().is_some_and(|e| e.contraction < EASY)
    }

    /// Two halves, cut across the longest edge.
    pub fn halves(&self, patch: &Patch, bend: &Bend) -> [Self; 2] {
        let points = self.corners.map(|u| patch.value(&u));
        let (mut first, mut second) = (self.corners, self.corners);
        for (i, j) in longest(patch.form, &points[..self.count]) {
            let middle = std::array::from_fn(|a| 0.5 * (self.corners[i][a] + self.corners[j][a]));
            first[j] = middle;
            second[i] = middle;
        }
        [Self::new(patch, bend, first), Self::new(patch, bend, second)]
    }

    /// Looks for a parameter of the cell that is mapped to `p`; what it cannot find in this part it says is not there.
    pub fn find(&self, patch: &Patch, p: &V) -> Answer {
        let Some(e) = &self.expansion else { return Answer::Unknown };
        if self.slabs.iter().any(|(axis, lo, hi)| !(*lo..=*hi).contains(&axis.dot(p))) {
            return Answer::Outside;
        }
        let step = e.inverse * (p - e.x);
        let mut u = e.centre + step;
        if e.contraction == 0.0 {
            return if in_domain(patch.form, &u) { Answer::Inside } else { Answer::Outside };
        }
        if newton(patch, p, &mut u, e) && in_domain(patch.form, &u) {
            return Answer::Inside;
        }
        if e.contraction < 0.9 { e.fixed_point(patch, p, step) } else { Answer::Unknown }
    }
}

/// Slabs normal to the axes that the tangent map turns into coordinates (of a box) or barycentric coordinates (of a
/// simplex).
fn slabs(
    form: Form,
    corners: &[[f64; 3]],
    inverse: &Matrix3<f64>,
    points: &[V; 8],
    warp: &Warp,
    skin: f64,
) -> [(V, f64, f64); 4] {
    let mut axes = [V::zeros(); 4];
    let edges = Matrix3::from_fn(|a, k| match (form.simplex && a < form.dim && k < form.dim, a == k) {
        (true, _) => corners[k + 1][a] - corners[0][a],
        (false, same) => f64::from(u8::from(same)),
    });
    let gradients = edges.try_inverse().unwrap_or_default() * inverse;
    for a in 0..form.dim {
        axes[a] = gradients.row(a).transpose();
        if form.simplex {
            axes[3] -= axes[a];
        }
    }
    axes.map(|axis| {
        let along = points[..corners.len()].iter().map(|x| x.dot(&axis));
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let (less, more) = warp.extent(&axis);
        (axis, lo + less - axis.norm() * skin, hi + more + axis.norm() * skin)
    })
}

impl Expansion {
    /// The clamped simplified Newton map contracts, so a root in the box is its limit.
    fn fixed_point(&self, patch: &Patch, p: &V, mut d: V) -> Answer {
        let room = self.half.add_scalar(EDGE);
        let clamp = |d: V| V::from_fn(|a, _| if a < patch.form.dim { d[a].clamp(-room[a], room[a]) } else { 0.0 });
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
        if miss.amax() < EDGE && in_domain(patch.form, &(self.centre + d)) { Answer::Inside } else { Answer::Outside }
    }
}

fn expand(patch: &Patch, bend: &Bend, corners: &[[f64; 3]]) -> Option<Expansion> {
    let dim = patch.form.dim;
    let centre: V = corners.iter().map(|u| V::from(*u)).sum::<V>() / corners.len() as f64;
    let half = V::from_fn(|a, _| corners.iter().map(|u| (u[a] - centre[a]).abs()).fold(0.0, f64::max));
    let (x, map) = tangent(patch, &centre);
    let inverse = map.try_inverse().filter(|m| m.iter().all(|v| v.is_finite()))?;
    let mut change = 0.0;
    for a in 0..dim {
        let column: f64 = (0..dim).map(|b| bend[a][b] * half[b]).sum();
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
    let third = if patch.form.dim == 3 { jet.first[2] } else { V::z() };
    (jet.x, Matrix3::from_columns(&[jet.first[0], jet.first[1], third]))
}

/// Newton's iteration, given up when it leaves the neighbourhood of the part.
fn newton(patch: &Patch, p: &V, u: &mut V, e: &Expansion) -> bool {
    for _ in 0..12 {
        if (0..patch.form.dim).any(|a| !u[a].is_finite() || (u[a] - e.centre[a]).abs() > 3.0 * e.half[a]) {
            return false;
        }
        let (x, map) = tangent(patch, u);
        let Some(step) = map.try_inverse().map(|m| m * (p - x)) else { return false };
        for a in 0..patch.form.dim {
            u[a] += step[a];
        }
        if step.amax() < 1e-11 {
            return true;
        }
    }
    false
}

fn in_domain(form: Form, u: &V) -> bool {
    let low = u.iter().take(form.dim).all(|&v| v >= -EDGE);
    low && if form.simplex {
        u.iter().take(form.dim).sum::<f64>() <= 1.0 + EDGE
    } else {
        u.iter().take(form.dim).all(|&v| v <= 1.0 + EDGE)
    }
}
