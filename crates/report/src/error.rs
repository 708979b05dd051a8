//! [`ReportError`]: why a folder gives no page, figure or comparison.

use crate::number::short;
use nastic_io::ReadError;
use nastic_mesh::MeshError;
use nastic_mesh::spatial::SpatialError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a result folder gives no page, figure or comparison.
#[derive(Debug, Error)]
pub enum ReportError {
    /// Nothing was run there.
    #[error(
        "{} has no result.json: nastic report takes the output directory of nastic solve or nastic optimize",
        directory.display()
    )]
    Missing {
        /// The directory.
        directory: PathBuf,
    },
    /// A file cannot be read.
    #[error("cannot read {}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// A file does not hold what it should.
    #[error("{}: {what}; run the case again", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The results have no state, field or probe of that name.
    #[error("there is no {what} \"{name}\"; there is: {}", has.join(", "))]
    Unknown {
        /// What was looked for.
        what: &'static str,
        /// Its name.
        name: String,
        /// The names that there are.
        has: Vec<String>,
    },
    /// A path needs the instants of a motion.
    #[error(
        "paths of probes need a motion, and this run wrote no {file}: it is static, or it failed before its first step"
    )]
    NoMotion {
        /// The table of the motion.
        file: String,
    },
    /// Pressures are known of the states that the result speaks of.
    #[error(
        "the pressure of chamber \"{chamber}\" in the state \"{state}\" is not known: results have that of the optimum, of an equilibrium, of \
         ramps and of the instants of a motion; choose such a state, or another field by --field"
    )]
    NoPressure {
        /// The chamber.
        chamber: String,
        /// The state.
        state: String,
    },
    /// Ends of a colour bar that leave nothing between them.
    #[error("a range of colours goes from a lower to a higher end, not from {low} to {high}")]
    Range {
        /// The first end.
        low: f64,
        /// The second.
        high: f64,
    },
    /// A plane that cuts nothing.
    #[error(
        "this plane leaves {keeps} of the body: {} is between {} and {} {unit} in it, the plane at {}",
        named(*normal), short(*least), short(*most), short(*offset)
    )]
    Plane {
        /// What of the body it leaves.
        keeps: &'static str,
        /// Its normal.
        normal: [f64; 3],
        /// Where it is along that.
        offset: f64,
        /// The first that the body has of it.
        least: f64,
        /// The last.
        most: f64,
        /// The unit of length.
        unit: String,
    },
    /// Nothing that can be compared.
    #[error(
        "{} is no shape: nastic compare takes result directories, states of them (DIR/NAME), .vtu, .msh and .vtk files, point clouds (.csv, .npy, .ply)",
        path.display()
    )]
    NoShape {
        /// What was named.
        path: PathBuf,
    },
    /// Results in different units.
    #[error("the lengths of A are in {a}, those of B in {b}: say by --scale what B's are multiplied with")]
    Units {
        /// Of the first.
        a: String,
        /// Of the second.
        b: String,
    },
    /// An invalid factor of lengths.
    #[error("a scale of lengths is positive and finite, not {scale}")]
    Scale {
        /// What was given.
        scale: f64,
    },
    /// A part that a mesh lacks.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A shape that cannot be searched.
    #[error(transparent)]
    Spatial(#[from] SpatialError),
    /// A file cannot be understood.
    #[error(transparent)]
    File(#[from] ReadError),
}

impl ReportError {
    /// A value of `result.json` is of another kind than its key has.
    pub(crate) fn of_result(error: serde_json::Error) -> Self {
        Self::Content { file: "result.json".into(), what: error.to_string() }
    }
}

/// `x`, `(1, 0, 1) . x`
fn named(normal: [f64; 3]) -> String {
    let of = |axis: usize, sign: f64| (0..3).all(|i| normal[i] == if i == axis { sign } else { 0.0 });
    let axes = ["x", "y", "z"].into_iter().enumerate();
    let [x, y, z] = normal.map(short);
    let known = axes.filter(|(i, _)| of(*i, 1.0)).map(|(_, name)| name.to_owned()).next();
    known.unwrap_or_else(|| format!("({x}, {y}, {z}) . x"))
}
