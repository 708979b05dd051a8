//! A soft finger with an air chamber, through the library: the equilibrium at a pressure, the chamber's volume, the pressure
//! that brings the finger's end to a target; and a term of your own, springs that hold some nodes to where they were.
//!
//! `cargo run --release --example air_finger`

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::fem::{ContributionPoint, Demand, Inadmissible, Instant, Need, Sensitivities, Sums, check_contribution};
use nastic::linear::SparseMatrix;
use nastic::prelude::*;

/// A spring from each of some nodes to its place at rest: potential `sum k/2 |u|^2`, residual `k u`, tangent `k I`.
#[derive(Debug, Clone)]
struct Springs {
    nodes: Vec<u32>,
    /// Of one spring, N/m.
    stiffness: f64,
}

impl Springs {
    /// The unknowns of the held nodes.
    fn dofs(&self) -> impl Iterator<Item = usize> + '_ {
        self.nodes.iter().flat_map(|&node| (0..3).map(move |i| 3 * node as usize + i))
    }
}

impl Contribution for Springs {
    fn name(&self) -> &str {
        "springs"
    }

    /// Reported under this name in results: the sum of their forces on the body along z, N.
    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        vec![("force_z", self.nodes.iter().map(|&node| -self.stiffness * at.u[3 * node as usize + 2]).sum())]
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Springs {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for dof in self.dofs() {
            let force = self.stiffness * at.u[dof];
            if demand.energy {
                sums.energy += 0.5 * force * at.u[dof];
                sums.energy_scale += 0.5 * force * at.u[dof];
            }
            if demand.force {
                sums.force[dof] += force;
                sums.force_scale[dof] += force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let k = self.stiffness;
        for &node in &self.nodes {
            // a node is always coupled with itself; two nodes of different cells are if `couplings` says so, else this is an error
            tangent.add_pairs(&[node], &[k, 0.0, 0.0, 0.0, k, 0.0, 0.0, 0.0, k])?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        self.dofs().for_each(|dof| out[dof] += self.stiffness * v[dof]);
        Ok(true)
    }

    fn vjp(&self, _: &Instant, _: &[f64], _: &mut Sensitivities) -> Result<(), Inadmissible> {
        Ok(()) // no controls
    }
}

/// Half a finger (y >= 0), metres and pascals.
fn finger() -> Result<Solid, Box<dyn std::error::Error>> {
    Ok(Solid::new(nastic::io::read_gmsh("meshes/finger.msh")?)?
        .material("soft", NeoHooke::from_young_poisson(0.6e6, 0.45)?)?
        .material("layer", NeoHooke::from_young_poisson(6e6, 0.35)?)?
        .clamp("clamp")?
        .displace("middle", [None, Some(0.0), None])?
        .cavity(Cavity::new("air", "chamber").symmetry("middle"))?)
}

/// Prints what a state of the finger is.
fn report(body: &Solid, state: &State) -> Result<(), Box<dyn std::error::Error>> {
    let nodes = body.nodes_of("tip")?;
    let mean = |i: usize| nodes.iter().map(|&n| state.u[3 * n as usize + i]).sum::<f64>() / nodes.len() as f64;
    println!("  nodes of the end move by ({:.3}, {:.3}) mm in x, z (mean)", 1e3 * mean(0), 1e3 * mean(2));
    for (of, what, value) in body.model().quantities(&Instant::new(&state.u, &state.controls, state.load))? {
        println!("  {of}: {what} {value:.5e}");
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = finger()?;
    let mut pressure = body.controls(); // one block: the cavity's, with one slot
    pressure.set(0, 0, &[20e3])?;
    println!("at 20 kPa");
    report(&body, &body.solve(&pressure, &Default::default())?)?;

    let nodes = body.nodes_of("tip")?;
    let held = body.clone().contribution(Springs { nodes, stiffness: 0.02 })?;
    check_contribution(held.model(), "springs", 1)?;
    check_contribution(held.model(), "air", 1)?;
    println!("\nat 20 kPa, the end held by springs");
    report(&held, &held.solve(&pressure, &Default::default())?)?;

    for (name, body) in [("free", body), ("held by springs", held)] {
        let target = Target::position(|x| [0.040 + 0.6 * (x[2] - 0.00725), x[1], -0.020 + 0.8 * (x[2] - 0.00725)]);
        let problem =
            Reduced::new(body).control("air", Space::Uniform)?.cost(Tracking::surface("tip", target).weight(1e10))?;
        let set = Bounds::new(0.0, 45e3)?;
        let best = Lbfgs::default().within(set).minimize(&problem, 10e3)?;
        println!("\n{name}: {:.1} Pa, cost {:.4} mm^2; {}", best.point.m[0], best.cost, best.stop);
        report(problem.solid(), best.point.state())?;
    }
    Ok(())
}
