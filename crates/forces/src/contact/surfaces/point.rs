//! [`SurfacePoint`]: surfaces that touch each other, at one displacement.

use super::bound::{BoundSurfaces, FRICTION, STIFFNESS};
use super::gap::Gap;
use super::lagged::LaggedRubbing;
use super::rub::Rub;
use super::sample::Sample;
use crate::contact::friction::without_lagged;
use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;
use rayon::prelude::*;

/// A [`BoundSurfaces`] at one displacement.
pub(super) struct SurfacePoint<'a> {
    pub of: &'a BoundSurfaces,
    gaps: Vec<Vec<Gap>>,
}

impl<'a> SurfacePoint<'a> {
    pub fn new(of: &'a BoundSurfaces, gaps: Vec<Vec<Gap>>) -> Self {
        SurfacePoint { of, gaps }
    }

    pub fn samples(&self) -> Vec<Sample<'_>> {
        let sides = self.of.sides.iter().zip(&self.gaps);
        sides.flat_map(|(side, gaps)| gaps.iter().map(move |gap| Sample { of: self.of, side, gap })).collect()
    }

    pub fn touching(&self) -> impl Iterator<Item = Sample<'_>> {
        self.samples().into_iter().filter(Sample::touches)
    }

    /// `r / k`, without friction.
    fn per_stiffness(&self, u: &[f64], mut add: impl FnMut(usize, f64)) {
        self.touching().for_each(|sample| sample.spread(&sample.force(u).1, &mut add));
    }

    fn refuse_friction(&self, method: &'static str) -> Result<(), SecondDerivativeError> {
        match self.of.slip_speed {
            None => Ok(()),
            Some(_) => Err(SecondDerivativeError::Contribution { name: self.of.name().to_owned(), method }),
        }
    }

    /// The tangent of a sample over the unknowns of its nodes, and what replaces that of friction by its derivative by velocities alone, symmetric
    /// and of no negative work, in what [stands in](SparseMatrix::stand_in) for a general matrix.
    fn block(&self, sample: &Sample, at: &Instant, general: bool) -> (Vec<f64>, Option<Vec<f64>>) {
        let k = at.control(STIFFNESS);
        let scaled = |columns: Vec<Vec<Vec3>>, by: f64| -> Vec<f64> {
            let mut block = sample.block(&columns);
            block.iter_mut().for_each(|entry| *entry *= by);
            block
        };
        let mut block = scaled(sample.columns(at.u), k);
        let Some((slip_speed, step)) = self.of.slip_speed.zip(at.step).filter(|_| sample.touches()) else {
            return (block, None);
        };
        let (rub, strength) = (Rub::at(*sample, at.u), k * at.control(FRICTION) * sample.weight());
        let of_friction = scaled(rub.columns(at, slip_speed), strength);
        block.iter_mut().zip(&of_friction).for_each(|(entry, more)| *entry += more);
        let instead = general.then(|| {
            let velocities = sample.slots(|dof| at.velocity(dof));
            let mut instead = scaled(rub.columns_by_velocity(&velocities, slip_speed), step.velocity.0 * strength);
            instead.iter_mut().zip(of_friction).for_each(|(entry, whole)| *entry -= whole);
            instead
        });
        (block, instead)
    }
}

impl BoundSurfaces {
    /// The slip speed where there is friction at an instant.
    pub(super) fn slides_at(&self, at: &Instant) -> Option<f64> {
        at.step.and(self.slip_speed)
    }
}

impl ContributionPoint for SurfacePoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        if let Some(friction) = LaggedRubbing::at(self.of, at)? {
            friction.add_residual(at, demand, sums);
        }
        let (at, k) = (&without_lagged(at, self.of.lagged), at.control(STIFFNESS));
        for sample in self.touching() {
            let (d, mut forces) = sample.force(at.u);
            if d >= self.of.thickness {
                continue;
            }
            let energy = k * sample.weight() * self.of.law.at(d, self.of.thickness).energy;
            sums.energy += energy;
            sums.energy_scale += energy.abs();
            if !demand.force {
                continue;
            }
            if let Some(slip_speed) = self.of.slides_at(at) {
                let (of_friction, strength) =
                    (Rub::at(sample, at.u).forces(at, slip_speed), at.control(FRICTION) * sample.weight());
                forces.resize(of_friction.len(), Vec3::zeros());
                forces.iter_mut().zip(of_friction).for_each(|(force, more)| *force += strength * more);
            }
            sample.spread(&forces, |dof, value| {
                sums.force[dof] += k * value;
                sums.force_scale[dof] += (k * value).abs();
            });
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if let Some(friction) = LaggedRubbing::at(self.of, at)? {
            friction.add_tangent(at, tangent);
        }
        let (at, samples) = (&without_lagged(at, self.of.lagged), self.samples());
        let general = !tangent.is_symmetric();
        let block = |sample: &Sample| self.block(sample, at, general);
        let blocks: Vec<(Vec<f64>, Option<Vec<f64>>)> = match at.parallel && samples.len() > 256 {
            true => samples.par_iter().map(block).collect(),
            false => samples.iter().map(block).collect(),
        };
        for (sample, (block, instead)) in samples.iter().zip(blocks) {
            let nodes = sample.nodes();
            tangent.add_beyond(&nodes, block);
            if let Some(instead) = instead {
                tangent.add_aside(&nodes, instead);
            }
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        if let Some(friction) = LaggedRubbing::at(self.of, at)? {
            friction.add_tangent_product(at, v, out);
        }
        let (at, k) = (&without_lagged(at, self.of.lagged), at.control(STIFFNESS));
        for sample in self.touching() {
            let change = sample.slots(|dof| v[dof]);
            let mut found: Vec<Vec3> = sample.along(at.u, [&change, &change]).iter().map(|parts| parts[1]).collect();
            if let Some(slip_speed) = self.of.slides_at(at) {
                let strength = at.control(FRICTION) * sample.weight();
                let of_friction = Rub::at(sample, at.u).change(at, slip_speed, &change);
                found.resize(of_friction.len(), Vec3::zeros());
                found.iter_mut().zip(of_friction).for_each(|(force, more)| *force += strength * more);
            }
            sample.spread(&found, |dof, value| out[dof] += k * value);
        }
        Ok(true)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.of.longest_move(at.u, du))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let mut by_stiffness = 0.0;
        self.per_stiffness(at.u, |dof, value| by_stiffness += lambda[dof] * value);
        if let Some(friction) = LaggedRubbing::at(self.of, at)? {
            friction.vjp(at, lambda, into);
        }
        let at = &without_lagged(at, self.of.lagged);
        if let Some(slip_speed) = self.of.slides_at(at) {
            let (k, mu, mut unit) = (at.control(STIFFNESS), at.control(FRICTION), 0.0);
            for sample in self.touching() {
                let (rub, weight) = (Rub::at(sample, at.u), sample.weight());
                let [velocities, own] = [sample.slots(|dof| at.velocity(dof)), sample.slots(|dof| lambda[dof])];
                let work = rub.forces(at, slip_speed).iter().zip(&own).map(|(force, own)| force.dot(own)).sum::<f64>();
                unit += weight * work;
                let by_velocity = rub.by_velocity(&velocities, slip_speed, &own);
                sample.spread(&by_velocity, |dof, value| into.velocity[dof] += k * mu * weight * value);
            }
            by_stiffness += mu * unit;
            into.add_control(at, FRICTION, k * unit);
        }
        into.add_control(at, STIFFNESS, by_stiffness);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        self.refuse_friction("add_control_product")?;
        let change = at.slot_of(v, STIFFNESS);
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
        self.refuse_friction("second_vjp")?;
        let (k, dk) = (at.control(STIFFNESS), at.slot_of(along.controls, STIFFNESS));
        let mut by = 0.0;
        for sample in self.touching() {
            let (of_lambda, of_u) = (sample.slots(|dof| lambda[dof]), sample.slots(|dof| along.u[dof]));
            let found = sample.along(at.u, [&of_lambda, &of_u]);
            let change: Vec<Vec3> = found.iter().map(|parts| k * parts[3] + dk * parts[1]).collect();
            sample.spread(&change, |dof, value| into.u[dof] += value);
            by += found.iter().zip(&of_u).map(|(parts, v)| parts[1].dot(v)).sum::<f64>();
        }
        into.add_control(at, STIFFNESS, by);
        Ok(())
    }
}
