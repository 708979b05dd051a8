//! Pieces of a solid's cells, and upper bounds of the distance to another solid over them.

use super::V;
use super::interpolation_error::InterpolationError;
use super::patch::longest;
use super::shape::{ClosestPoint, Hint, Shape};

/// Largest number of sides that are distinguished.
const MAX_SIDES: usize = 6;

/// Part of a cell: a box or simplex of its parameters, with the closest points to its corners on the other solid.
#[derive(Clone, Debug)]
pub(super) struct CellPiece {
    cell: u32,
    count: usize,
    params: [[f64; 3]; 8],
    points: [V; 8],
    closest: [ClosestPoint; 8],
    /// The cell leaves the hull of the piece's corners by no more.
    sag: f64,
}

impl CellPiece {
    /// All of a cell; closest points to its corners as found before.
    pub fn whole(of: &Shape, cell: usize, corner: impl Fn(u32) -> Option<(V, ClosestPoint)>) -> Option<Self> {
        let space = of.cells.patch(cell).space;
        let count = space.corners();
        let mut params = [[0.0; 3]; 8];
        let mut found = [corner(of.corners[cell][0])?; 8];
        for i in 0..count {
            params[i] = space.corner(i);
            found[i] = corner(of.corners[cell][i])?;
        }
        let mut piece = Self {
            cell: cell as u32,
            count,
            params,
            points: found.map(|f| f.0),
            closest: found.map(|f| f.1),
            sag: 0.0,
        };
        piece.measure(of);
        Some(piece)
    }

    pub fn corners(&self) -> impl Iterator<Item = (&V, &ClosestPoint)> {
        self.points.iter().zip(&self.closest).take(self.count)
    }

    fn measure(&mut self, of: &Shape) {
        self.sag = self.deviation(of).bound();
    }

    fn deviation(&self, of: &Shape) -> InterpolationError {
        InterpolationError::of(&of.cells.patch(self.cell as usize), &self.params[..self.count])
    }

    /// Halves across the longest edge (with its parallels in a box); closest points to the new corners are searched on `on`.
    pub fn halves(mut self, of: &Shape, on: &Shape, hint: &mut Hint) -> [Self; 2] {
        let patch = of.cells.patch(self.cell as usize);
        let mut second = self.clone();
        for (i, j) in longest(patch.space, &self.points[..self.count]) {
            let u = std::array::from_fn(|a| 0.5 * (self.params[i][a] + self.params[j][a]));
            let x = patch.value(&u);
            let closest = on.closest_point(&x, hint);
            self.set(j, u, x, closest);
            second.set(i, u, x, closest);
        }
        self.measure(of);
        second.measure(of);
        [self, second]
    }

    fn set(&mut self, i: usize, u: [f64; 3], x: V, closest: ClosestPoint) {
        self.params[i] = u;
        self.points[i] = x;
        self.closest[i] = closest;
    }

    /// A bound that costs nothing: one of the closest points serves the whole piece.
    pub fn bound(&self) -> f64 {
        let farthest = |q: &V| self.corners().map(|(x, _)| (x - q).norm_squared()).fold(0.0, f64::max);
        self.corners().map(|(_, f)| farthest(&f.point)).fold(f64::INFINITY, f64::min).sqrt() + self.sag
    }

    /// A bound no greater than `goal`, proven by convex parts of the other solid: the distance to a convex set is a
    /// convex function, so over the hull of the corners it is at most the same mean of its values there. Closest points that
    /// point to different sides (a slot, a bore) make several convex sets, and any mean of the distances to them is a
    /// bound as well. `None`: not proven.
    pub fn proven_bound(&self, of: &Shape, on: &Shape, goal: f64) -> Option<f64> {
        // With the deviation added, the shifted hull holds a partner, as far away, also for what leaves the piece's hull.
        let deviation = self.deviation(of);
        let enclosed =
            |hull: &[V], base: f64| if goal > base { on.shift_into(hull, &deviation, goal - base) } else { None };
        let farthest = self.corners().map(|(_, f)| f.distance).fold(0.0, f64::max);
        let closest: Vec<V> = self.corners().map(|(_, f)| f.point).collect();
        if let Some(shift) = enclosed(&closest, farthest) {
            return Some(farthest + shift);
        }
        let sides = self.sides(on, 1e-3 * goal)?;
        let reach = |side: &Vec<V>| self.points.iter().zip(side).map(|(x, q)| (x - q).norm()).collect();
        let (base, used) = best_mean(&sides.iter().map(reach).collect::<Vec<_>>());
        let shifts = used.iter().map(|&side| enclosed(&sides[side], base));
        shifts.collect::<Option<Vec<f64>>>().map(|s| base + s.into_iter().fold(0.0, f64::max))
    }

    /// The least bound of a few, when there is no time to cut further: what a slack of 2, 4, 8, ... steps proves, or
    /// `bound`.
    pub fn relaxed_bound(&self, of: &Shape, on: &Shape, goal: f64, step: f64, bound: f64) -> f64 {
        let mut slack = step;
        while slack > 0.0 && goal + slack < bound {
            if let Some(proven) = self.proven_bound(of, on, goal + slack) {
                return proven;
            }
            slack *= 2.0;
        }
        bound
    }

    /// Where the closest points lie on several sides: for every side, points of the other solid near all corners. Corners inside,
    /// or `near`, are their own closest points on every side. `None` if there is one side, or too many to distinguish.
    fn sides(&self, on: &Shape, near: f64) -> Option<Vec<Vec<V>>> {
        let way = |i: usize| self.closest[i].point - self.points[i];
        // By side: its first direction, and the sum and number of the ways there.
        let mut sides: Vec<(V, V, f64)> = Vec::new();
        for i in 0..self.count {
            let Some(direction) = way(i).try_normalize(near) else { continue };
            match sides.iter().position(|side| side.0.dot(&direction) > 0.5) {
                Some(side) => {
                    sides[side].1 += way(i);
                    sides[side].2 += 1.0;
                }
                None if sides.len() < MAX_SIDES => sides.push((direction, way(i), 1.0)),
                None => return None,
            }
        }
        let mut hint = Hint::default();
        let mut closest = |side: &(V, V, f64), i: usize| match way(i).try_normalize(near) {
            Some(direction) if direction.dot(&side.0) <= 0.5 => {
                on.closest_point(&(self.points[i] + side.1 / side.2), &mut hint).point
            }
            _ => self.closest[i].point,
        };
        (sides.len() > 1)
            .then(|| sides.iter().map(|side| (0..self.count).map(|i| closest(side, i)).collect()).collect())
    }
}

/// The least, over means of at most two rows, of the largest entry; and the rows of that mean.
fn best_mean(values: &[Vec<f64>]) -> (f64, Vec<usize>) {
    let largest = |row: &[f64]| row.iter().copied().fold(0.0, f64::max);
    let mut best = (f64::INFINITY, Vec::new());
    for (k, row) in values.iter().enumerate() {
        let value = largest(row);
        if value < best.0 {
            best = (value, vec![k]);
        }
    }
    for k in 0..values.len() {
        for l in k + 1..values.len() {
            let value = mean_of_two(&values[k], &values[l]);
            if value < best.0 * (1.0 - 1e-9) {
                best = (value, vec![k, l]);
            }
        }
    }
    best
}

/// min over t in [0, 1] of max_i (1 - t) a_i + t b_i: convex in t, by ternary search (any t gives a valid bound).
fn mean_of_two(a: &[f64], b: &[f64]) -> f64 {
    let value = |t: f64| a.iter().zip(b).map(|(a, b)| (1.0 - t) * a + t * b).fold(0.0, f64::max);
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..40 {
        let (s, t) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
        if value(s) <= value(t) { hi = t } else { lo = s }
    }
    value(0.5 * (lo + hi))
}
