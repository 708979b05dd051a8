//! A program of your own: nastic's command line, whose case files may name one more law, actuation and contribution.
//!
//! The law is that of Hencky's volumetric kind: `W = (mu/2) (|F|^2 - 3) - mu log J + (kappa/2) (log J)^2`, which is convex
//! in F and, for J < e, in J. In a case file: `{ "region": "body", "law": "log_volume", "mu": "100 kPa", "kappa": "400 kPa" }`.
//! The actuation is a sheet of fibres that turn in the plane of x and y, `{ "name": "sheet", "kind": "turned_fibers", "region": "body",
//! "angle": 0.5 }`; the contribution a band between two points, `{ "name": "band", "kind": "band", "points": [[0, 0, 1], "tip"],
//! "stiffness": "2 N/mm" }`, both in `actuation`.
//!
//! `cargo run --release -p nastic-cli --example own_program -- solve CASE`

use nastic_energy::catalogue::{ActuationRow, Example, Made, MaterialRow, Parameter};
use nastic_energy::{Block, Conjugates, ConvexDensity, Curvature, FiberTension, Field, MaterialPoint};
use nastic_fem::catalogue::{Entry, Form, Key, KeyKind};
use nastic_fem::{FemError, Solid, Spring};
use nastic_language::catalogue::Catalogue;
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

#[derive(Debug)]
struct LogVolume {
    mu: Field<f64>,
    kappa: Field<f64>,
}

impl ConvexDensity for LogVolume {
    fn value(&self, at: MaterialPoint, f: &Mat3, _: &Mat3, j: f64) -> f64 {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        0.5 * mu * (f.norm_squared() - 3.0) - mu * j.ln() + 0.5 * kappa * j.ln().powi(2)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, _: &Mat3, j: f64) -> Conjugates {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        Conjugates { f: f * mu, h: Mat3::zeros(), j: (kappa * j.ln() - mu) / j }
    }

    fn second(&self, at: MaterialPoint, _: &Mat3, _: &Mat3, j: f64) -> Curvature {
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

/// Fibres that include an angle with the x axis, in radians; a positive tension lengthens them.
static TURNED_FIBERS: ActuationRow = ActuationRow::new(
    "turned_fibers",
    "fibres in the plane of x and y, turned by `angle` from the x axis; a positive tension lengthens them",
    &[&[Parameter::number("angle", "1", 0.0)]],
    Example { controls: &[1e5], towards: [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]] },
    |given| {
        let along = given.number("angle")?.try_map(|_, angle| Ok(Vec3::new(angle.cos(), angle.sin(), 0.0)))?;
        Ok(Arc::new(FiberTension::along_field(along)?))
    },
);

/// An elastic band between the first and the last of some points of the body; nothing to control.
static BAND: Entry = Entry {
    name: "band",
    form: Some(Form {
        about: "an elastic band between two points of the body",
        keys: &[
            Key::new("points", "its two ends", KeyKind::Points),
            Key::new("stiffness", "force per length", KeyKind::Positive { unit: "N/m" }),
        ],
        slots: &[],
        passive: true,
        one_of: false,
        add: |body, name, values| {
            let ends = values.points.get("points").map_or(&[][..], Vec::as_slice);
            let [from, to] = ends else {
                return Err(FemError::Meaningless {
                    what: format!("{name} has {} points; a band has two", ends.len()),
                });
            };
            body.spring(Spring::between(name, from.clone(), to.clone(), values.numbers["stiffness"]))
        },
    }),
    example: || {
        let mesh = nastic_mesh::box_mesh([1.0; 3], [1; 3], nastic_mesh::CellKind::Hex8)?;
        Solid::new(mesh)?.spring(Spring::between("band", [0.0; 3], [1.0; 3], 1.0))
    },
};

fn main() -> std::process::ExitCode {
    nastic_cli::run(
        &Catalogue::standard().with_material(&LOG_VOLUME).with_actuation(&TURNED_FIBERS).with_contribution(&BAND),
    )
}
