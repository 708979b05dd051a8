//! A contribution that remembers: internal variables of its own, and forces at the displacement and controls of the state before.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, noise, regular};
use nastic_energy::{FiberTension, NeoHooke, Slot};
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    BeforeStep, Contribution, ContributionPoint, Controls, Demand, Inadmissible, Inertia, Instant, Need, Remembers,
    Scheme, Sensitivities, Solid, StatePartials, StepTo, Sums, TimeStepping, Trajectory, Workspace, check_contribution,
};
use nastic_linear::SparseMatrix;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const H: f64 = 0.1;
const STEPS: usize = 6;
const PUSH: [Slot; 1] = [Slot::scalar("push", "N")];

/// On the unknowns D, with the displacement `u_n` and the control `m_n` of the state before and an anchor z each:
///
/// ```text
/// r = k (u - z) + g u_n^2 u - (m + m_n/2) u_n
/// z' = z + a (u - z) + b m^2
/// ```
#[derive(Debug, Clone)]
struct Lagged {
    dofs: Vec<usize>,
}

const K: f64 = 0.4;
const G: f64 = 30.0;
const A: f64 = 0.3;
const B: f64 = 0.02;

impl Lagged {
    /// `k`, and what lags: `g u_n^2` and the force `(m + m_n/2) u_n`.
    fn lagged(at: &Instant, dof: usize) -> (f64, f64) {
        let before = at.before();
        let (u, m) = before.map_or((0.0, 0.0), |state| (state.u[dof], at.slot_of(&state.controls, 0)));
        (G * u * u, (at.control(0) + 0.5 * m) * u)
    }

    fn anchor(at: &Instant, k: usize) -> f64 {
        at.internal().get(k).copied().unwrap_or(0.0)
    }
}

impl Contribution for Lagged {
    fn name(&self) -> &str {
        "lagged"
    }

    fn slots(&self) -> &[Slot] {
        &PUSH
    }

    fn remembers(&self) -> Option<&dyn Remembers> {
        Some(self)
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Lagged {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for (k, &dof) in self.dofs.iter().enumerate() {
            let (u, z, (stiffness, force)) = (at.u[dof], Self::anchor(at, k), Self::lagged(at, dof));
            sums.energy += 0.5 * K * (u - z) * (u - z) + 0.5 * stiffness * u * u - force * u;
            sums.energy_scale += 0.5 * K * (u * u + z * z) + 0.5 * stiffness * u * u + (force * u).abs();
            if demand.force {
                sums.force[dof] += K * (u - z) + stiffness * u - force;
                sums.force_scale[dof] += K * (u.abs() + z.abs()) + stiffness * u.abs() + force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let mut diagonal = vec![0.0; at.u.len()];
        self.dofs.iter().for_each(|&dof| diagonal[dof] = K + Self::lagged(at, dof).0);
        tangent.add_diagonal(&diagonal);
        Ok(())
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        for (k, &dof) in self.dofs.iter().enumerate() {
            let Some(before) = at.before() else { continue };
            let (u, u_n, m_n) = (at.u[dof], before.u[dof], at.slot_of(&before.controls, 0));
            into.add_control(at, 0, -lambda[dof] * u_n);
            into.before.add_internal(at, k, -K * lambda[dof]);
            into.before.u[dof] += lambda[dof] * (2.0 * G * u_n * u - at.control(0) - 0.5 * m_n);
            into.before.add_control(at, 0, -0.5 * lambda[dof] * u_n);
        }
        Ok(())
    }
}

impl Remembers for Lagged {
    fn len(&self) -> usize {
        self.dofs.len()
    }

    fn advance(&self, at: &Instant, next: &mut [f64]) {
        for (k, &dof) in self.dofs.iter().enumerate() {
            let z = at.internal()[k];
            next[k] = z + A * (at.u[dof] - z) + B * at.control(0) * at.control(0);
        }
    }

    fn advance_vjp(&self, at: &Instant, by_next: &[f64], into: &mut BeforeStep) {
        for (k, &dof) in self.dofs.iter().enumerate() {
            into.u[dof] += A * by_next[k];
            into.add_internal(at, k, (1.0 - A) * by_next[k]);
            into.add_control(at, 0, 2.0 * B * at.control(0) * by_next[k]);
        }
    }
}

/// A plane strip with it on its right end, beside fibres.
fn strip() -> Outcome<Solid> {
    let mesh = regular(CellKind::Quad4, [3.0, 1.0, 0.0], [3, 1, 1])?;
    let at_end = |node: &usize| (mesh.points()[*node][0] - 3.0).abs() < 1e-9;
    let dofs = (0..mesh.points().len()).filter(at_end).flat_map(|node| [2 * node, 2 * node + 1]).collect();
    Ok(Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, -2e-3, 0.0))?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?
        .contribution(Lagged { dofs })?)
}

fn controls(solid: &Solid, n: usize, change: f64) -> Controls {
    let mut controls = solid.controls();
    for k in 0..controls.len() {
        let wave = 0.1 * (1.0 + k as f64) * (n as f64 + 1.0 + k as f64).sin();
        let values = controls.values_mut(k).iter_mut().enumerate();
        values.for_each(|(i, value)| *value = wave + change * noise(1000 * (n + 1) + 100 * k + i));
    }
    controls
}

fn run(solid: &Solid, scheme: &Scheme, change: f64) -> Outcome<Trajectory> {
    let mut trajectory = Trajectory::from(solid.solve(&controls(solid, 0, change), &STRICT)?);
    let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: H, controls: controls(solid, n, change) }).collect();
    solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

/// `sum_n w_n . u_n + |u_n|^2 / 2`
fn functional(trajectory: &Trajectory) -> f64 {
    let of = |(n, u): (usize, &[f64])| -> f64 {
        u.iter().enumerate().map(|(i, u)| noise(77 + 100 * n + i) * u + 0.5 * u * u).sum()
    };
    trajectory.states().iter().map(|state| &state.u[..]).enumerate().map(of).sum()
}

#[test]
fn it_keeps_the_contract_of_contributions() -> Outcome {
    Ok(check_contribution(strip()?.model(), "lagged", 5)?)
}

/// By Taylor's theorem, along all controls at all instants at once, in every scheme that has an adjoint.
#[test]
fn motions_derive_by_the_state_before() -> Outcome {
    let solid = strip()?;
    for row in SCHEMES {
        let scheme = (row.build)()?;
        if !scheme.has_adjoint() || scheme.is_linearised() {
            continue;
        }
        let trajectory = run(&solid, &scheme, 0.0)?;
        let states = trajectory.states().iter().enumerate();
        let partials: Vec<StatePartials> = states
            .map(|(n, state)| {
                let by = state.u.iter().enumerate().map(|(i, u)| noise(77 + 100 * n + i) + u);
                StatePartials::by_displacement(by.collect())
            })
            .collect();
        let swept = solid.model().reverse_sweep(&trajectory, &partials, &STRICT, &mut Workspace::default())?;
        let slope = |(n, by): (usize, &Controls)| -> f64 {
            let of =
                |k: usize| by.values(k).iter().enumerate().map(move |(i, d)| d * noise(1000 * (n + 1) + 100 * k + i));
            (0..by.len()).flat_map(of).sum()
        };
        let slope: f64 = swept.controls.iter().enumerate().map(slope).sum();
        let start = functional(&trajectory);
        let rest = |s: f64| -> Outcome<f64> { Ok((functional(&run(&solid, &scheme, s)?) - start - s * slope).abs()) };
        let (long, short) = (rest(4e-2)?, rest(1e-2)?);
        let order = (long / short).log2() / 2.0;
        println!("{}: slope {slope:.6e}, remainders {long:.3e} {short:.3e}, order {order:.4}", scheme.name());
        assert!(order > 1.95 && slope.abs() > 1e-3, "{}: order {order}", scheme.name());
    }
    Ok(())
}

/// The anchors move, in steps of the length that they know.
#[test]
fn a_motion_goes_on_from_what_it_remembers() -> Outcome {
    let solid = strip()?;
    let trajectory = run(&solid, &Scheme::backward_euler(), 0.0)?;
    let end = trajectory.end();
    let block = end.history.len() - 1;
    let anchors = end.history.values(block);
    assert!(anchors.iter().any(|z| z.abs() > 1e-3), "{anchors:?}");
    assert_eq!(end.history.step(), H);
    assert!(trajectory.states()[0].history.is_empty());
    Ok(())
}
