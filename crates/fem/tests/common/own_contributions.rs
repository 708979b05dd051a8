//! Contributions that only tests need, and bodies with them.

#![allow(clippy::unwrap_used)] // helpers of tests

use super::{Outcome, regular};
use nastic_energy::{FiberTension, NeoHooke, Slot};
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, Inadmissible, Increment, Instant, Need, SecondDerivativeError,
    SecondSensitivities, Sensitivities, Solid, Sums,
};
use nastic_linear::{NotCoupled, SparseMatrix, Symmetry};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

/// Point masses and dampers to the ground at every node: `r = mass a + damping v + k u`, less a control, with `k = stiffness (1 +
/// spread i)` of the i-th unknown.
#[derive(Debug, Clone)]
pub struct Oscillators {
    pub mass: f64,
    pub damping: f64,
    pub stiffness: f64,
    pub spread: f64,
}

pub const PUSH: [Slot; 1] = [Slot::scalar("push", "N")];

impl Oscillators {
    /// Of one unknown.
    pub fn stiffness_of(&self, dof: usize) -> f64 {
        self.stiffness * (1.0 + self.spread * dof as f64)
    }
}

impl Contribution for Oscillators {
    fn name(&self) -> &str {
        "oscillators"
    }

    fn slots(&self) -> &[Slot] {
        &PUSH
    }

    fn add_mass(&self, _: &Instant, mass: &mut SparseMatrix) -> Result<(), NotCoupled> {
        mass.add_to_diagonal(self.mass);
        Ok(())
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Oscillators {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for dof in 0..at.u.len() {
            let u = at.u[dof];
            // the incremental potential of backward Euler, whose velocity and acceleration are linear in u
            if let Some(step) = at.step {
                let (c_v, b_v) = (step.velocity.0, step.velocity.1[dof]);
                let (c_a, b_a) = (step.acceleration.0, step.acceleration.1[dof]);
                sums.energy += self.mass * (0.5 * c_a * u + b_a) * u + self.damping * (0.5 * c_v * u + b_v) * u;
            }
            let stiffness = self.stiffness_of(dof);
            sums.energy += 0.5 * stiffness * u * u - at.control(0) * u;
            if demand.force {
                let inertia = self.mass * at.acceleration(dof) + self.damping * at.velocity(dof);
                sums.force[dof] += inertia + stiffness * u - at.control(0);
                sums.force_scale[dof] += inertia.abs() + (stiffness * u).abs() + at.control(0).abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let step = at.step.map_or(0.0, |step| self.mass * step.acceleration.0 + self.damping * step.velocity.0);
        let diagonal: Vec<f64> = (0..at.u.len()).map(|dof| self.stiffness_of(dof) + step).collect();
        tangent.add_diagonal(&diagonal);
        Ok(())
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, -lambda.iter().sum::<f64>());
        into.velocity.iter_mut().zip(lambda).for_each(|(v, l)| *v += self.damping * l);
        into.acceleration.iter_mut().zip(lambda).for_each(|(a, l)| *a += self.mass * l);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        out.iter_mut().for_each(|out| *out -= at.slot_of(v, 0));
        Ok(())
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(()) // linear
    }
}

/// A force on every node that turns with its displacement: `f = control (1 + s u_y, -s u_x, 0)`, not conservative.
#[derive(Debug, Clone)]
pub struct Swirl {
    pub nodes: Vec<u32>,
    pub rate: f64,
}

pub const SWIRL: [Slot; 1] = [Slot::scalar("force", "N")];

impl Contribution for Swirl {
    fn name(&self) -> &str {
        "swirl"
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn slots(&self) -> &[Slot] {
        &SWIRL
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Swirl {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for &node in self.nodes.iter().filter(|_| demand.force) {
            let dof = 3 * node as usize;
            let force = self.force(at.u, dof).map(|f| at.control(0) * f);
            for i in 0..2 {
                sums.force[dof + i] -= force[i];
                sums.force_scale[dof + i] += force[i].abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let s = at.control(0) * self.rate;
        let element = [0.0, -s, 0.0, s, 0.0, 0.0, 0.0, 0.0, 0.0];
        for &node in &self.nodes {
            tangent.add_pairs(&[node], &element)?;
        }
        Ok(())
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let work = |&node: &u32| {
            let dof = 3 * node as usize;
            let force = self.force(at.u, dof);
            -(force[0] * lambda[dof] + force[1] * lambda[dof + 1])
        };
        into.add_control(at, 0, self.nodes.iter().map(work).sum());
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        for dof in self.nodes.iter().map(|&node| 3 * node as usize) {
            let force = self.force(at.u, dof);
            (0..2).for_each(|i| out[dof + i] -= at.slot_of(v, 0) * force[i]);
        }
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let change = self.rate * at.slot_of(along.controls, 0);
        for dof in self.nodes.iter().map(|&node| 3 * node as usize) {
            into.u[dof] += change * lambda[dof + 1];
            into.u[dof + 1] -= change * lambda[dof];
            let work = self.rate * (lambda[dof + 1] * along.u[dof] - lambda[dof] * along.u[dof + 1]);
            into.add_control(at, 0, work);
        }
        Ok(())
    }
}

impl Swirl {
    fn force(&self, u: &[f64], dof: usize) -> [f64; 2] {
        [1.0 + self.rate * u[dof + 1], -self.rate * u[dof]]
    }
}

pub fn bar() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 0.3, 0.3], [4, 1, 1])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

pub fn swirling() -> Outcome<Solid> {
    let bar = bar()?;
    let nodes = bar.nodes_of("x+")?;
    Ok(bar.contribution(Swirl { nodes, rate: 2.0 })?)
}

pub fn oscillating() -> Outcome<Solid> {
    Ok(bar()?.contribution(Oscillators { mass: 0.3, damping: 0.2, stiffness: 1.5, spread: 0.0 })?)
}
