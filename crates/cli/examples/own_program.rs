//! A program of your own: nastic's command line, whose case files may name one more law.
//!
//! The law is that of Hencky's volumetric kind: `W = (mu/2) (|F|^2 - 3) - mu log J + (kappa/2) (log J)^2`, which is convex
//! in F and, for J < e, in J. In a case file: `{ "region": "body", "law": "log_volume", "mu": "100 kPa", "kappa": "400 kPa" }`.
//!
//! `cargo run --release -p nastic-cli --example own_program -- solve CASE`

use nastic_energy::catalogue::{Made, MaterialRow, Parameter};
use nastic_energy::{Block, Conjugates, ConvexDensity, Curvature, Field, Place};
use nastic_language::catalogue::Catalogue;
use nastic_tensor::Mat3;

#[derive(Debug)]
struct LogVolume {
    mu: Field<f64>,
    kappa: Field<f64>,
}

impl ConvexDensity for LogVolume {
    fn value(&self, at: Place, f: &Mat3, _: &Mat3, j: f64) -> f64 {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        0.5 * mu * (f.norm_squared() - 3.0) - mu * j.ln() + 0.5 * kappa * j.ln().powi(2)
    }

    fn first(&self, at: Place, f: &Mat3, _: &Mat3, j: f64) -> Conjugates {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        Conjugates { f: f * mu, h: Mat3::zeros(), j: (kappa * j.ln() - mu) / j }
    }

    fn second(&self, at: Place, _: &Mat3, _: &Mat3, j: f64) -> Curvature {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        Curvature::split(Block::Isotropic(mu), Block::Zero, (mu + kappa * (1.0 - j.ln())) / (j * j))
    }
}

static LOG_VOLUME: MaterialRow = MaterialRow::new(
    "log_volume",
    "neo-Hookean with a logarithmic volumetric part",
    &[&[Parameter::number("mu", "Pa", 1e5), Parameter::number("kappa", "Pa", 4e5)]],
    |given| Ok(Made::density(LogVolume { mu: given.number("mu")?, kappa: given.number("kappa")? })),
);

fn main() -> std::process::ExitCode {
    nastic_cli::run(&Catalogue::standard().with_material(&LOG_VOLUME))
}
