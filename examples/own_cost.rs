//! A cost of your own: implement [`Cost`] and [`CostPoint`] in your crate; the derivative through the equilibrium, the Taylor
//! test and the optimiser come with nastic.
//!
//! The cost here keeps a body above a table: `j(u) = weight/2 sum_a max(0, height - (Z_a + w_a))^2` over the nodes a, w_a their
//! displacements along z; its derivative by w_a is `-weight max(0, height - (Z_a + w_a))`. It is a penalty, no contact: the
//! body feels no force from the table, the optimiser looks for a control whose shape stays above it.
//!
//! `cargo run --release --example own_cost`

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::control::{ControlError, CostContext, Partials};
use nastic::prelude::*;
use std::sync::Arc;

/// What a body in space costs that is lower than a height (m): weight/2 times the sum of its nodes' squared depths.
#[derive(Debug, Clone)]
struct AboveTable {
    height: f64,
    weight: f64,
}

/// The cost at one displacement.
#[derive(Debug)]
struct Depths {
    weight: f64,
    /// How far a node is below the table, 0 above it.
    below: Vec<f64>,
}

impl Cost for AboveTable {
    fn name(&self) -> &str {
        "above_table"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let points = at.solid.mesh().points();
        let height = |node: usize| points[node][2] + at.u[3 * node + 2];
        let below = (0..points.len()).map(|node| (self.height - height(node)).max(0.0)).collect();
        Ok(Arc::new(Depths { weight: self.weight, below }))
    }
}

impl CostPoint for Depths {
    fn value(&self) -> f64 {
        0.5 * self.weight * self.below.iter().map(|depth| depth * depth).sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        for (node, depth) in self.below.iter().enumerate() {
            out.u[3 * node + 2] -= self.weight * depth;
        }
        Ok(())
    }
}

/// A bar of a metre on the table, whose end shall come to a place at the same height, 0.1 m nearer to the clamp.
fn problem(table: Option<AboveTable>) -> Result<Reduced, Box<dyn std::error::Error>> {
    let body = Solid::new(box_mesh([1.0, 0.1, 0.1], [10, 1, 2], CellKind::Hex20)?)?
        .material("body", NeoHooke::from_young_poisson(3e5, 0.4)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, 0.0, -1e3))?
        .clamp("x-")?;
    let target = Target::position(|x| [x[0] - 0.1, x[1], x[2]]);
    let problem =
        Reduced::new(body).control("tension", Space::Cell)?.cost(Tracking::surface("x+", target).weight(1e4))?;
    Ok(match table {
        Some(table) => problem.cost(table)?,
        None => problem,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = AboveTable { height: -0.002, weight: 1e4 };
    let set = Bounds::new(-1.5e5, 0.0)?;

    let kept = problem(Some(table))?;
    let start = vec![-1e4; kept.layout().len()];
    println!("{}", Taylor::default().test(&kept, &set, &start)?);

    for (name, problem) in [("without", problem(None)?), ("with", kept)] {
        let print = Print::of(&problem, std::io::stdout());
        let mut search = Lbfgs::default().within(set.clone()).tolerance(1e-6).observe(print);
        let best = search.minimize(&problem, start.clone())?;
        let points = problem.solid().mesh().points();
        let u = &best.point.state().u;
        let lowest = (0..points.len()).map(|node| points[node][2] + u[3 * node + 2]).fold(f64::INFINITY, f64::min);
        println!("{name} the table: cost {:.4}, lowest node at {:.2} mm; {}", best.cost, 1e3 * lowest, best.stop);

        let values = problem.values("tension", &best.m)?;
        let strongest = values.iter().min_by(|a, b| a.1[0].total_cmp(&b.1[0]));
        if let Some((cell, tension)) = strongest {
            println!("{name} the table: the strongest muscle is {cell}, {:.0} {}", tension[0], values.unit());
        }
    }
    Ok(())
}
