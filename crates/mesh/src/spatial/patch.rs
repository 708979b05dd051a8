//! Bézier patches: value, derivatives, rigorous bounds.

use super::V;
use super::patch_space::PatchSpace;

/// Bounds on the second derivatives of a patch over its whole domain: entry (a, b) bounds |d2x / du_a du_b|.
pub(super) type SecondBounds = [[f64; 3]; 3];

/// One patch: a space and its control points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch<'a> {
    pub space: PatchSpace,
    pub control: &'a [V],
}

/// Value and derivatives at one parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub x: V,
    pub first: [V; 3],
    /// Second derivatives: 00, 11, 01 (the first two directions only: faces have no more).
    pub second: [V; 3],
}

impl Patch<'_> {
    pub fn value(&self, u: &[f64; 3]) -> V {
        if self.space.simplex { self.simplex(u).x } else { self.tensor::<1>(u).x }
    }

    pub fn first(&self, u: &[f64; 3]) -> Jet {
        if self.space.simplex { self.simplex(u) } else { self.tensor::<4>(u) }
    }

    pub fn second(&self, u: &[f64; 3]) -> Jet {
        if self.space.simplex { self.simplex(u) } else { self.tensor::<7>(u) }
    }

    fn simplex(&self, u: &[f64; 3]) -> Jet {
        let (dim, c) = (self.space.dim, self.control);
        let lambda = [1.0 - u[0] - u[1] - u[2], u[0], u[1], u[2]];
        let mut slope = [V::zeros(); 4];
        let mut second = [V::zeros(); 3];
        let mut x = V::zeros();
        if self.space.degree == 1 {
            for a in 0..=dim {
                slope[a] = c[a];
                x += c[a] * lambda[a];
            }
        } else {
            for a in 0..=dim {
                for b in 0..=dim {
                    slope[a] += c[self.space.pair(a, b)] * (2.0 * lambda[b]);
                }
                x += slope[a] * (0.5 * lambda[a]);
            }
            second[0] = self.simplex_second(0, 0);
            if dim > 1 {
                second[1] = self.simplex_second(1, 1);
                second[2] = self.simplex_second(0, 1);
            }
        }
        let first = std::array::from_fn(|a| if a < dim { slope[a + 1] - slope[0] } else { V::zeros() });
        Jet { x, first, second }
    }

    fn simplex_second(&self, a: usize, b: usize) -> V {
        let at = |i, j| self.control[self.space.pair(i, j)];
        (at(a + 1, b + 1) - at(a + 1, 0) - at(0, b + 1) + at(0, 0)) * 2.0
    }

    /// `PARTS`: 1 value, 4 with first derivatives, 7 with second derivatives.
    fn tensor<const PARTS: usize>(&self, u: &[f64; 3]) -> Jet {
        let (dim, n) = (self.space.dim, self.space.degree + 1);
        // basis[order of derivative][direction][index]
        let mut basis = [[[0.0; 3]; 3]; 3];
        for a in 0..3 {
            if a >= dim {
                basis[0][a][0] = 1.0;
            } else if n == 2 {
                basis[0][a] = [1.0 - u[a], u[a], 0.0];
                basis[1][a] = [-1.0, 1.0, 0.0];
            } else {
                let (s, t) = (1.0 - u[a], u[a]);
                basis[0][a] = [s * s, 2.0 * s * t, t * t];
                basis[1][a] = [-2.0 * s, 2.0 * (s - t), 2.0 * t];
                basis[2][a] = [2.0, -4.0, 2.0];
            }
        }
        let size = |a: usize| if a < dim { n } else { 1 };
        let mut jet = Jet { x: V::zeros(), first: [V::zeros(); 3], second: [V::zeros(); 3] };
        let mut index = 0;
        for k in 0..size(2) {
            for j in 0..size(1) {
                // Sums along the first direction, then products with the other two.
                let mut row = [V::zeros(); 3];
                for (i, c) in self.control[index..index + n].iter().enumerate() {
                    row[0] += c * basis[0][0][i];
                    if PARTS > 1 {
                        row[1] += c * basis[1][0][i];
                    }
                    if PARTS > 4 {
                        row[2] += c * basis[2][0][i];
                    }
                }
                index += n;
                let (v, w) = (basis[0][1][j], basis[0][2][k]);
                jet.x += row[0] * (v * w);
                if PARTS > 1 {
                    jet.first[0] += row[1] * (v * w);
                    jet.first[1] += row[0] * (basis[1][1][j] * w);
                    jet.first[2] += row[0] * (v * basis[1][2][k]);
                }
                if PARTS > 4 {
                    jet.second[0] += row[2] * (v * w);
                    jet.second[1] += row[0] * (basis[2][1][j] * w);
                    jet.second[2] += row[1] * (basis[1][1][j] * w);
                }
            }
        }
        jet
    }

    /// Bounds on the second derivatives: those of a simplex are constant, those of a tensor product lie in the hull of
    /// the second differences.
    pub fn second_bounds(&self) -> SecondBounds {
        let (dim, degree) = (self.space.dim, self.space.degree);
        let bound = |a: usize, b: usize| match (self.space.simplex, degree) {
            _ if a.max(b) >= dim => 0.0,
            (true, 1) => 0.0,
            (true, _) => self.simplex_second(a, b).norm(),
            (false, _) => self.difference(a, b),
        };
        let second_bounds: SecondBounds = std::array::from_fn(|a| std::array::from_fn(|b| bound(a, b)));
        // Affine up to rounding is affine.
        let size = self.control.iter().fold(0.0f64, |m, c| m.max((c - self.control[0]).amax()).max(1e-3 * c.amax()));
        second_bounds.map(|row| row.map(|v| if v <= 1e-12 * size { 0.0 } else { v }))
    }

    /// Second derivatives D2x[e, e] of a quadratic simplex along the edges e between these parameters: constants.
    pub fn edge_seconds(&self, corners: &[[f64; 3]]) -> impl Iterator<Item = V> {
        let dim = self.space.dim;
        let second: [[V; 3]; 3] = std::array::from_fn(|a| {
            std::array::from_fn(|b| if a.max(b) < dim { self.simplex_second(a, b) } else { V::zeros() })
        });
        let pairs = (0..corners.len()).flat_map(move |i| (i + 1..corners.len()).map(move |j| (i, j)));
        pairs.map(move |(i, j)| {
            let e: [f64; 3] = std::array::from_fn(|a| corners[j][a] - corners[i][a]);
            (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| second[a][b] * (e[a] * e[b])).sum()
        })
    }

    /// Bernstein coefficients of the second derivative of a quadratic box along direction `a`.
    pub fn seconds(&self, a: usize) -> impl Iterator<Item = V> {
        let (stride, c) = (3usize.pow(a as u32), self.control);
        (0..c.len())
            .filter(move |i| i / stride % 3 == 0)
            .map(move |i| (c[i] - c[i + stride] * 2.0 + c[i + 2 * stride]) * 2.0)
    }

    /// Bound on a second derivative of a box: it lies in the hull of the second differences.
    fn difference(&self, a: usize, b: usize) -> f64 {
        let n = self.space.degree + 1;
        if a == b {
            return if n == 2 { 0.0 } else { self.seconds(a).map(|d| d.norm()).fold(0.0, f64::max) };
        }
        let (sa, sb) = (n.pow(a as u32), n.pow(b as u32));
        let c = self.control;
        let corner = |i: &usize| i / sa % n + 1 < n && i / sb % n + 1 < n;
        let mixed = (0..c.len()).filter(corner).map(|i| (c[i] - c[i + sa] - c[i + sb] + c[i + sa + sb]).norm());
        mixed.fold(0.0, f64::max) * (self.space.degree * self.space.degree) as f64
    }
}

/// Extent of a set of parameters in each direction.
pub(super) fn widths(params: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|a| {
        let (lo, hi) =
            params.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), u| (lo.min(u[a]), hi.max(u[a])));
        hi - lo
    })
}

/// The longest edge of a simplex, or the edges in the longest direction of a box, as pairs of corners.
pub(super) fn longest(space: PatchSpace, points: &[V]) -> impl Iterator<Item = (usize, usize)> + use<> {
    let length = |i: usize, j: usize| (points[i] - points[j]).norm_squared();
    let count = points.len();
    let mut best = (f64::NEG_INFINITY, (0, 0));
    for i in 0..count {
        for j in i + 1..count {
            let edge = space.simplex || (j - i).is_power_of_two() && i & (j - i) == 0;
            if edge && length(i, j) > best.0 {
                best = (length(i, j), (i, j));
            }
        }
    }
    let (first, bit) = (best.1, best.1.1 - best.1.0);
    let simplex = space.simplex;
    (0..count)
        .filter(move |i| if simplex { *i == first.0 } else { i & bit == 0 && i | bit < count })
        .map(move |i| if simplex { first } else { (i, i | bit) })
}

/// How far the patch may leave the convex hull of any of its points whose parameters span the widths `w`: x(sum l_i
/// u_i) - sum l_i x(u_i) is at most 1/2 sum_ab M_ab cov_ab, and a variance is at most a quarter of the squared width.
pub(super) fn sag(second_bounds: &SecondBounds, w: &[f64; 3]) -> f64 {
    let mut sum = 0.0;
    for a in 0..3 {
        for b in 0..3 {
            sum += second_bounds[a][b] * w[a] * w[b];
        }
    }
    0.125 * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CellKind;
    use crate::spatial::interpolation_error::InterpolationError;
    use crate::spatial::patch_space::Conversion;

    #[test]
    fn patches_reproduce_the_isoparametric_map_and_bound_it() {
        for kind in CellKind::ALL {
            let conversion = Conversion::of(kind);
            let space = conversion.space;
            // A bent cell: reference nodes pushed around by smooth waves.
            let nodes: Vec<V> = kind
                .reference_nodes()
                .iter()
                .map(|x| {
                    V::new(x[0] + 0.2 * (x[1] - x[2]).sin(), x[1] + 0.1 * (2.0 * x[0]).cos(), x[2] + 0.15 * x[0] * x[1])
                })
                .collect();
            let mut control = Vec::new();
            conversion.append(&nodes, &mut control);
            let patch = Patch { space, control: &control };
            let second_bounds = patch.second_bounds();
            let mut shapes = vec![0.0; kind.nodes()];
            let mut gradients = vec![[0.0; 3]; kind.nodes()];
            let scale = if space.simplex { 1.0 } else { 2.0 };
            for sample in 0..50 {
                let mut u = [0.0; 3];
                for (a, value) in u.iter_mut().enumerate().take(space.dim) {
                    *value = (0.37 + 0.618 * (sample * (a + 1)) as f64 + 0.2 * a as f64).fract()
                        / if space.simplex { 3.0 } else { 1.0 };
                }
                let xi = std::array::from_fn(|a| if space.simplex || a >= space.dim { u[a] } else { 2.0 * u[a] - 1.0 });
                kind.shapes(&xi, &mut shapes);
                kind.gradients(&xi, &mut gradients);
                let x: V = nodes.iter().zip(&shapes).map(|(x, n)| x * *n).sum();
                let jet = patch.second(&u);
                assert!((patch.value(&u) - x).norm() < 1e-13, "{kind:?}");
                for a in 0..space.dim {
                    let d: V = nodes.iter().zip(&gradients).map(|(x, g)| x * (g[a] * scale)).sum();
                    assert!((patch.first(&u).first[a] - d).norm() < 1e-12, "{kind:?}");
                    let mut step = u;
                    step[a] += 1e-5;
                    let second = (patch.second(&step).first[a] - jet.first[a]) / 1e-5;
                    assert!(second.norm() <= second_bounds[a][a] * (1.0 + 1e-6) + 1e-9, "{kind:?}");
                    if a < 2 && space.dim < 3 {
                        assert!((second - jet.second[a]).norm() < 1e-4, "{kind:?}");
                    }
                }
                // The chord between two corners stays within the sag.
                let ends = (space.corner(0), space.corner(space.corners() - 1));
                let mid = std::array::from_fn(|a| 0.5 * (ends.0[a] + ends.1[a]));
                let w = std::array::from_fn(|a| (ends.0[a] - ends.1[a]).abs());
                let chord = (patch.value(&ends.0) + patch.value(&ends.1)) * 0.5;
                let departure = (patch.value(&mid) - chord).norm();
                assert!(departure <= sag(&second_bounds, &w) * (1.0 + 1e-12) + 1e-14, "{kind:?}");
                let corners: Vec<_> = (0..space.corners()).map(|i| space.corner(i)).collect();
                let weight = |i: usize| -> f64 {
                    let first = 1.0 - u.iter().sum::<f64>();
                    let side = |a: usize| if i >> a & 1 == 1 { u[a] } else { 1.0 - u[a] };
                    if space.simplex { [first, u[0], u[1], u[2]][i] } else { (0..space.dim).map(side).product() }
                };
                let linear: V = (0..corners.len()).map(|i| patch.value(&corners[i]) * weight(i)).sum();
                let deviation = InterpolationError::of(&patch, &corners);
                for axis in [V::x(), V::y(), V::z(), V::new(0.6, -0.3, 0.7)] {
                    let (lo, hi) = deviation.extent(&axis);
                    assert!((lo - 1e-14..=hi + 1e-14).contains(&(jet.x - linear).dot(&axis)), "{kind:?}");
                }
                assert!((jet.x - linear).norm() <= deviation.bound() + 1e-14, "{kind:?}");
            }
        }
    }
}
