//! [`SurfacePoint`]: surfaces that touch each other, at one displacement.

use super::bound::BoundSurfaces;
use super::gap::{Gap, slope};
use super::side::Side;
use crate::contributions::{
    ContributionPoint, Controls, Demand, Increment, Instant, SecondSensitivities, Sensitivities, Sums,
};
use crate::error::{Inadmissible, SecondDerivativeError};
use crate::kernels::hyper_dual::{HyperDual, Scalar};
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;
use rayon::prelude::*;

/// Of the area of a sample what counts: both walls that touch have samples, and each of these pushes both.
pub(super) const SHARE: f64 = 0.5;

/// A [`BoundSurfaces`] at one displacement.
pub(super) struct SurfacePoint<'a> {
    pub of: &'a BoundSurfaces,
    gaps: Vec<Vec<Gap>>,
}

/// A sample with what it is near to: the nodes of its own facet, with their shape functions, then those of the pieces.
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

    /// The place of the sample and of the nodes of the pieces, or the change of these along a nodal vector.
    fn slots(&self, v: &[f64]) -> Vec<Vec3> {
        let dim = self.of.dim;
        let own = self.side.samples.of(self.gap.sample, dim, |dof| v[dof]);
        let at = |&node: &u32| Vec3::from_fn(|i, _| if i < dim { v[dim * node as usize + i] } else { 0.0 });
        std::iter::once(own).chain(self.gap.nodes.iter().map(at)).collect()
    }

    pub fn places(&self, u: &[f64]) -> Vec<Vec3> {
        let nodes = self.gap.nodes.iter().map(|&node| self.side.node(u, node));
        std::iter::once(self.side.place(u, self.gap.sample)).chain(nodes).collect()
    }

    /// The gap, and per unit of stiffness and area the derivative of psi by the slots.
    fn gradient<T: Scalar>(&self, slots: &[[T; 3]]) -> (T, Vec<[T; 3]>) {
        let (distance, mut by) = self.gap.distance(slots[0], &slots[1..]);
        let d = distance - T::of(self.of.apart());
        let slope = slope(self.of.law, d, self.of.thickness);
        by.iter_mut().flatten().for_each(|by| *by = *by * slope);
        (d, by)
    }

    /// The gap and the derivative of the potential by the slots, per unit of stiffness.
    fn force(&self, u: &[f64]) -> (f64, Vec<Vec3>) {
        let places: Vec<[f64; 3]> = self.places(u).into_iter().map(Into::into).collect();
        let (d, by) = self.gradient(&places);
        (d, by.into_iter().map(|by| self.weight() * Vec3::from(by)).collect())
    }

    /// Parts of the derivative of the potential by the slots along two changes of them, per unit of stiffness.
    fn along(&self, u: &[f64], changes: [&[Vec3]; 2]) -> Vec<[Vec3; 4]> {
        let slots: Vec<[HyperDual; 3]> = self
            .places(u)
            .iter()
            .enumerate()
            .map(|(slot, x)| std::array::from_fn(|i| HyperDual([x[i], changes[0][slot][i], changes[1][slot][i], 0.0])))
            .collect();
        let part = |by: &[HyperDual; 3], which: usize| self.weight() * Vec3::from_fn(|i, _| by[i].0[which]);
        self.gradient(&slots).1.iter().map(|by| std::array::from_fn(|which| part(by, which))).collect()
    }

    /// Whether it is in the layer.
    fn touches(&self) -> bool {
        // the smooth least distance is smaller than the least one, by little
        self.gap.least < self.of.apart() + 1.5 * self.of.thickness
    }

    /// The nodes whose unknowns it couples.
    fn nodes(&self) -> Vec<u32> {
        let own = self.side.samples.parts(self.gap.sample).iter().map(|(node, _)| *node);
        own.chain(self.gap.nodes.iter().copied()).collect()
    }

    /// Slots and shares of its nodes.
    fn shares(&self) -> Vec<(usize, f64)> {
        let own = self.side.samples.parts(self.gap.sample).iter().map(|(_, shape)| (0, *shape));
        own.chain((0..self.gap.nodes.len()).map(|k| (k + 1, 1.0))).collect()
    }

    /// Adds values of the slots to a nodal vector.
    pub fn spread(&self, values: &[Vec3], mut add: impl FnMut(usize, f64)) {
        for (node, (slot, share)) in self.nodes().into_iter().zip(self.shares()) {
            (0..self.of.dim).for_each(|i| add(self.of.dim * node as usize + i, share * values[slot][i]));
        }
    }

    /// The second derivative of the potential by its nodes' unknowns, per unit of stiffness.
    fn block(&self, u: &[f64]) -> Vec<f64> {
        let (dim, shares) = (self.of.dim, self.shares());
        let n = dim * shares.len();
        if !self.touches() {
            return vec![0.0; n * n];
        }
        let slots = self.gap.nodes.len() + 1;
        let unit = |column: usize| {
            let mut v = vec![Vec3::zeros(); slots];
            if column < dim * slots {
                v[column / dim][column % dim] = 1.0;
            }
            v
        };
        let mut columns: Vec<Vec<Vec3>> = Vec::with_capacity(dim * slots);
        for pair in (0..dim * slots).step_by(2) {
            let found = self.along(u, [&unit(pair), &unit(pair + 1)]);
            (1..3).for_each(|which| columns.push(found.iter().map(|parts| parts[which]).collect()));
        }
        let entry = |i: usize, j: usize| {
            let ((a, s), (b, t)) = (shares[i / dim], shares[j / dim]);
            let of = |row: usize, r: usize, column: usize, c: usize| columns[dim * column + c][row][r];
            s * t * 0.5 * (of(a, i % dim, b, j % dim) + of(b, j % dim, a, i % dim))
        };
        (0..n * n).map(|at| entry(at / n, at % n)).collect()
    }
}

impl<'a> SurfacePoint<'a> {
    pub fn new(of: &'a BoundSurfaces, gaps: Vec<Vec<Gap>>) -> Self {
        SurfacePoint { of, gaps }
    }

    pub fn samples(&self) -> Vec<Sample<'_>> {
        let sides = self.of.sides.iter().zip(&self.gaps);
        sides.flat_map(|(side, gaps)| gaps.iter().map(move |gap| Sample { of: self.of, side, gap })).collect()
    }

    fn touching(&self) -> impl Iterator<Item = Sample<'_>> {
        self.samples().into_iter().filter(Sample::touches)
    }

    /// `r / k`
    fn per_stiffness(&self, u: &[f64], mut add: impl FnMut(usize, f64)) {
        self.touching().for_each(|sample| sample.spread(&sample.force(u).1, &mut add));
    }
}

impl ContributionPoint for SurfacePoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let k = at.control(0);
        for sample in self.touching() {
            let (d, by) = sample.force(at.u);
            if d >= self.of.thickness {
                continue;
            }
            let energy = k * sample.weight() * self.of.law.at(d, self.of.thickness).energy;
            sums.energy += energy;
            sums.energy_scale += energy.abs();
            if demand.force {
                sample.spread(&by, |dof, value| {
                    sums.force[dof] += k * value;
                    sums.force_scale[dof] += (k * value).abs();
                });
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let (k, samples) = (at.control(0), self.samples());
        let block = |sample: &Sample| sample.block(at.u);
        let blocks: Vec<Vec<f64>> = match at.parallel {
            true => samples.par_iter().map(block).collect(),
            false => samples.iter().map(block).collect(),
        };
        for (sample, mut block) in samples.iter().zip(blocks) {
            block.iter_mut().for_each(|entry| *entry *= k);
            tangent.add_beyond(&sample.nodes(), block);
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let k = at.control(0);
        for sample in self.touching() {
            let change = sample.slots(v);
            let found: Vec<Vec3> = sample.along(at.u, [&change, &change]).iter().map(|parts| k * parts[1]).collect();
            sample.spread(&found, |dof, value| out[dof] += value);
        }
        Ok(true)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.of.longest_move(at.u, du))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let mut by = 0.0;
        self.per_stiffness(at.u, |dof, value| by += lambda[dof] * value);
        into.add_control(at, 0, by);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let change = at.slot_of(v, 0);
        self.per_stiffness(at.u, |dof, value| out[dof] += change * value);
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (k, dk) = (at.control(0), at.slot_of(along.controls, 0));
        let mut by = 0.0;
        for sample in self.touching() {
            let (of_lambda, of_u) = (sample.slots(lambda), sample.slots(along.u));
            let found = sample.along(at.u, [&of_lambda, &of_u]);
            let change: Vec<Vec3> = found.iter().map(|parts| k * parts[3] + dk * parts[1]).collect();
            sample.spread(&change, |dof, value| into.u[dof] += value);
            by += found.iter().zip(&of_u).map(|(parts, v)| parts[1].dot(v)).sum::<f64>();
        }
        into.add_control(at, 0, by);
        Ok(())
    }
}
