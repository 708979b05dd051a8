//! A law of your own: implement [`ConvexDensity`] in your crate, and everything works with it - the contract checks, the
//! equilibrium, the adjoint, the optimiser. Nothing of nastic changes.
//!
//! The law here is Gent's, which stiffens as the chains of a rubber reach their full length:
//! `W = -(mu limit/2) log(1 - (|F|^2 - 3)/limit) - mu log J + (lambda/2)(J-1)^2`
//! (A. N. Gent, Rubber Chem. Technol. 69 (1996) 59-61, with a neo-Hookean volumetric part). Convex in F for
//! `|F|^2 < 3 + limit`, where it is defined; beyond that the energy is infinite and no step is ever taken.
//!
//! `cargo run --release --example own_energy` writes what `nastic optimize` would write to `out/own_energy`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::energy::{Block, Conjugates, Curvature, MaterialPoint, check};
use nastic::prelude::*;
use nastic::tensor::Tangent;

/// Gent's law with shear modulus mu (Pa), Lame constant lambda (Pa) and the limit of `|F|^2 - 3`.
#[derive(Debug, Clone)]
struct Gent {
    mu: f64,
    lambda: f64,
    limit: f64,
}

impl Gent {
    /// `1 - (|F|^2 - 3)/limit`: positive as long as the chains are not at their full length.
    fn slack(&self, f: &Mat3) -> f64 {
        1.0 - (f.norm_squared() - 3.0) / self.limit
    }
}

impl ConvexDensity for Gent {
    fn value(&self, _: MaterialPoint, f: &Mat3, _: &Mat3, j: f64) -> f64 {
        let slack = self.slack(f);
        if slack <= 0.0 {
            return f64::INFINITY;
        }
        -0.5 * self.mu * self.limit * slack.ln() - self.mu * j.ln() + 0.5 * self.lambda * (j - 1.0).powi(2)
    }

    fn first(&self, _: MaterialPoint, f: &Mat3, _: &Mat3, j: f64) -> Conjugates {
        Conjugates { f: f * (self.mu / self.slack(f)), h: Mat3::zeros(), j: self.lambda * (j - 1.0) - self.mu / j }
    }

    fn second(&self, _: MaterialPoint, f: &Mat3, _: &Mat3, j: f64) -> Curvature {
        let slack = self.slack(f);
        let mut by_f = Tangent::zero();
        by_f.add_identity(self.mu / slack);
        by_f.add_outer(f, f, 2.0 * self.mu / (self.limit * slack * slack));
        Curvature::split(Block::Full(Box::new(by_f)), Block::Zero, self.lambda + self.mu / (j * j))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let law = Gent { mu: 1e5, lambda: 4e5, limit: 60.0 };

    // The checks every built-in law passes: derivatives by differences, objectivity, rest state, ellipticity, growth.
    println!("{}", check::law(&law, MaterialPoint { cell: 0, point: 0 })?);

    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [10, 2, 2], CellKind::Hex20)?)?
        .material("body", law)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let lifted = Target::position(|x| [0.9 * x[0], x[1], x[2] + 0.3]);
    let problem = Reduced::new(body).control("tension", Space::Node)?.cost(Tracking::surface("x+", lifted))?;
    let set = Bounds::new(-3e5, 0.0)?;
    let start = vec![-1e4; problem.layout().len()];
    println!("{}", Taylor::default().test(&problem, &set, &start)?);

    let found = Study::new(problem)?
        .within("tension", set)
        .start_at(start)
        .title("A bar of Gent's law, lifted")
        .directory("out/own_energy")
        .print(std::io::stdout())
        .interruptible()
        .optimize(&Lbfgs::default())?;
    println!("tracking cost {:.3e}", found.states.point().risk);
    Ok(())
}
