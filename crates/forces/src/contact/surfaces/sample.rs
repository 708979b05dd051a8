//! [`Sample`]: a sample of a surface with the pieces of the other one that it is near to.

use super::bound::BoundSurfaces;
use super::gap::{Foot, Gap, slope};
use super::side::Side;
use nastic_body::kernels::hyper_dual::{HyperDual, Scalar};
use nastic_tensor::Vec3;

/// Of the area of a sample what counts: both walls that touch have samples, and each of these pushes both.
pub(super) const SHARE: f64 = 0.5;

/// A sample and what it is near to.
///
/// Its *slots* are points that move with the body: its own place, the nodes of the pieces and, with friction, the corners of its own facets.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    pub of: &'a BoundSurfaces,
    pub side: &'a Side,
    pub gap: &'a Gap,
}

impl Sample<'_> {
    /// Area that counts.
    pub fn weight(&self) -> f64 {
        SHARE * self.side.samples.weights[self.gap.sample]
    }

    /// The slots of friction alone: corners of its own facets.
    pub fn ring(&self) -> &[u32] {
        match self.of.slip_speed {
            Some(_) => &self.side.rings[self.gap.sample],
            None => &[],
        }
    }

    /// How many slots are those of the potential.
    pub fn near_slots(&self) -> usize {
        self.gap.nodes.len() + 1
    }

    /// The nodes that are slots.
    fn slot_nodes(&self) -> impl Iterator<Item = u32> {
        self.gap.nodes.iter().chain(self.ring()).copied()
    }

    /// Changes of the slots by a nodal vector.
    pub fn slots(&self, v: impl Fn(usize) -> f64) -> Vec<Vec3> {
        let dim = self.of.dim;
        let own = self.side.samples.of(self.gap.sample, dim, &v);
        let at = |node: u32| Vec3::from_fn(|i, _| if i < dim { v(dim * node as usize + i) } else { 0.0 });
        std::iter::once(own).chain(self.slot_nodes().map(at)).collect()
    }

    /// Where the slots are.
    pub fn places(&self, u: &[f64]) -> Vec<Vec3> {
        let nodes = self.slot_nodes().map(|node| self.side.node(u, node));
        std::iter::once(self.side.place(u, self.gap.sample)).chain(nodes).collect()
    }

    /// The gap, and per unit of stiffness and area the derivative of psi by the slots of the potential.
    fn gradient<T: Scalar>(&self, slots: &[[T; 3]]) -> (T, Vec<[T; 3]>) {
        let (distance, mut by) = self.gap.distance(slots[0], &slots[1..self.near_slots()]);
        let d = distance - T::of(self.of.apart());
        let slope = slope(self.of.law, d, self.of.thickness);
        by.iter_mut().flatten().for_each(|by| *by = *by * slope);
        (d, by)
    }

    /// The gap, and which shares of what presses there the nodes of the pieces bear.
    pub fn foot<T: Scalar>(&self, slots: &[[T; 3]]) -> (T, Vec<T>) {
        let (distance, feet) = self.gap.near(slots[0], &slots[1..self.near_slots()]);
        let mut shares = vec![T::of(0.0); self.gap.nodes.len()];
        for Foot { nearest, between, part } in feet {
            between.iter().zip(nearest.shares).for_each(|(&node, b)| shares[node] = shares[node] + part * b);
        }
        (distance - T::of(self.of.apart()), shares)
    }

    /// The derivatives of `f(d) (c_0 + sum_a q_a c_a)` by the slots of the potential, d the gap, q the shares of the nodes of the pieces, c numbers of the slots.
    pub fn weighed(&self, u: &[f64], of_slots: &[f64], f: impl Fn(HyperDual) -> HyperDual) -> Vec<Vec3> {
        let (dim, slots, places) = (self.of.dim, self.near_slots(), self.places(u));
        let mut by = vec![Vec3::zeros(); slots];
        for pair in (0..dim * slots).step_by(2) {
            let along = [unit(dim, slots, pair), unit(dim, slots, pair + 1)];
            let moved = |slot: usize| -> [HyperDual; 3] {
                std::array::from_fn(|i| HyperDual([places[slot][i], along[0][slot][i], along[1][slot][i], 0.0]))
            };
            let (gap, shares) = self.foot(&(0..slots).map(moved).collect::<Vec<_>>());
            let first = HyperDual::of(of_slots[0]);
            let sum = shares.iter().zip(&of_slots[1..]).fold(first, |sum, (q, c)| sum + *q * HyperDual::of(*c));
            let HyperDual([_, one, two, _]) = f(gap) * sum;
            by.iter_mut().zip(along[0].iter().zip(&along[1])).for_each(|(by, (a, b))| *by += one * a + two * b);
        }
        by
    }

    /// The corner of facets that it is at.
    pub fn corner(&self) -> Option<usize> {
        match self.side.samples.parts(self.gap.sample) {
            [(node, _)] => self.of.recovery.corner(*node),
            _ => None,
        }
    }

    /// The gap and the derivative of the potential by its slots, per unit of stiffness.
    pub fn force(&self, u: &[f64]) -> (f64, Vec<Vec3>) {
        let places: Vec<[f64; 3]> = self.places(u).into_iter().map(Into::into).collect();
        let (d, by) = self.gradient(&places);
        (d, by.into_iter().map(|by| self.weight() * Vec3::from(by)).collect())
    }

    /// Parts of the derivative of the potential by its slots along two changes of them, per unit of stiffness.
    pub fn along(&self, u: &[f64], changes: [&[Vec3]; 2]) -> Vec<[Vec3; 4]> {
        let places = self.places(u);
        let slots: Vec<[HyperDual; 3]> = places[..self.near_slots()]
            .iter()
            .enumerate()
            .map(|(slot, x)| std::array::from_fn(|i| HyperDual([x[i], changes[0][slot][i], changes[1][slot][i], 0.0])))
            .collect();
        let part = |by: &[HyperDual; 3], which: usize| self.weight() * Vec3::from_fn(|i, _| by[i].0[which]);
        self.gradient(&slots).1.iter().map(|by| std::array::from_fn(|which| part(by, which))).collect()
    }

    /// Whether it is in the layer.
    pub fn touches(&self) -> bool {
        // the smooth least distance is smaller than the least one, by little
        self.gap.least < self.of.apart() + 1.5 * self.of.thickness
    }

    /// The nodes whose unknowns it couples; one that moves two slots is there twice.
    pub fn nodes(&self) -> Vec<u32> {
        let own = self.side.samples.parts(self.gap.sample).iter().map(|(node, _)| *node);
        own.chain(self.slot_nodes()).collect()
    }

    /// Slots and shares of its nodes.
    fn shares(&self) -> Vec<(usize, f64)> {
        let own = self.side.samples.parts(self.gap.sample).iter().map(|(_, shape)| (0, *shape));
        own.chain((0..self.slot_nodes().count()).map(|k| (k + 1, 1.0))).collect()
    }

    /// Adds values of the slots, of those of the potential or of all, to a nodal vector.
    pub fn spread(&self, values: &[Vec3], mut add: impl FnMut(usize, f64)) {
        for (node, (slot, share)) in self.nodes().into_iter().zip(self.shares()) {
            let Some(value) = values.get(slot) else { continue };
            (0..self.of.dim).for_each(|i| add(self.of.dim * node as usize + i, share * value[i]));
        }
    }

    /// Columns of a matrix over the slots, as one over the unknowns of its nodes; a column or row that is not there is zero.
    pub fn block(&self, columns: &[Vec<Vec3>]) -> Vec<f64> {
        let (dim, shares) = (self.of.dim, self.shares());
        let n = dim * shares.len();
        let entry = |i: usize, j: usize| {
            let ((a, s), (b, t)) = (shares[i / dim], shares[j / dim]);
            let row = columns.get(dim * b + j % dim).and_then(|column| column.get(a));
            row.map_or(0.0, |row| s * t * row[i % dim])
        };
        (0..n * n).map(|at| entry(at / n, at % n)).collect()
    }

    /// The second derivative of the potential by its slots, per unit of stiffness, in columns.
    pub fn columns(&self, u: &[f64]) -> Vec<Vec<Vec3>> {
        let (dim, slots) = (self.of.dim, self.near_slots());
        if !self.touches() {
            return Vec::new();
        }
        let mut columns: Vec<Vec<Vec3>> = Vec::with_capacity(dim * slots);
        for pair in (0..dim * slots).step_by(2) {
            let found = self.along(u, [&unit(dim, slots, pair), &unit(dim, slots, pair + 1)]);
            (1..3).for_each(|which| columns.push(found.iter().map(|parts| parts[which]).collect()));
        }
        columns.truncate(dim * slots);
        let entry = |(a, i): (usize, usize), (b, j): (usize, usize)| columns[dim * b + j][a][i];
        let symmetric = |b: usize, j: usize, a: usize| {
            Vec3::from_fn(|i, _| if i < dim { 0.5 * (entry((a, i), (b, j)) + entry((b, j), (a, i))) } else { 0.0 })
        };
        let column = |k: usize| (0..slots).map(|a| symmetric(k / dim, k % dim, a)).collect();
        (0..dim * slots).map(column).collect()
    }
}

/// A change of one component of one of some slots; none beyond the last.
pub(super) fn unit(dim: usize, slots: usize, component: usize) -> Vec<Vec3> {
    let mut v = vec![Vec3::zeros(); slots];
    if component < dim * slots {
        v[component / dim][component % dim] = 1.0;
    }
    v
}
