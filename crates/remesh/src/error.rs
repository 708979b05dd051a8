//! Why there is no mesh of a cut design.

use nastic_io::{ReadError, WriteError};
use nastic_language::syntax::Diagnostics;
use nastic_mesh::MeshError;
use nastic_run::run::{Exit, RunError};
use std::path::PathBuf;
use std::process::ExitStatus;
use thiserror::Error;

/// Why there is no mesh of a cut design, or no solution on it.
#[derive(Debug, Error)]
pub enum RemeshError {
    /// The directory has no optimum.
    #[error("{}: {why}; name the output directory of an optimisation of a density, a mixture or an electrode", directory.display())]
    NoOptimum {
        /// The directory.
        directory: PathBuf,
        /// What it is.
        why: String,
    },
    /// Nothing was cut.
    #[error(
        "nothing is cut: no control of the optimum is a density, a mixture or an electrode over cells, nodes or a grid that all load cases share"
    )]
    NoDesign,
    /// No size of cells.
    #[error("a size of cells of {size}: a positive length is needed")]
    Size {
        /// What was asked for.
        size: f64,
    },
    /// The case has what a body of its own mesh cannot take over.
    #[error("{at}: {what} cannot be carried to the new mesh: {why}")]
    NotCarried {
        /// Where it stands in the case.
        at: String,
        /// What it is.
        what: String,
        /// Why not, and what to try.
        why: String,
    },
    /// A surface, region or node set of a support, load or anything else of the case is no more.
    #[error(
        "{at}: nothing is left of the {kind} \"{name}\" on the outline: the cut has removed it, or left it on a piece that nothing holds ({islands} dropped); hold the cells there by \"fixed\" in the design's control, or leave this out"
    )]
    Gone {
        /// Where the case names it.
        at: String,
        /// Surface, region or node set.
        kind: &'static str,
        /// Its name.
        name: String,
        /// How many pieces were dropped, as nothing holds them.
        islands: usize,
    },
    /// All of the body was cut away.
    #[error("nothing is left of the body: the design is below its level everywhere, or no piece of it is held")]
    Empty,
    /// The border of a piece does not close.
    #[error("the outline of the cut body is not closed: please report the case with its results")]
    Open,
    /// Gmsh is not installed.
    #[error(
        "{} was not found: install Gmsh (pip install gmsh, apt install gmsh, or https://gmsh.info), or name the program with --gmsh",
        program.display()
    )]
    NoGmsh {
        /// What was looked for.
        program: PathBuf,
    },
    /// Gmsh could not be started.
    #[error("{} could not be run: {source}", program.display())]
    NotRun {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Gmsh has made no mesh.
    #[error(
        "{} made no mesh of {} ({status}):\n  {said}\ntry another --size, or open the file with Gmsh",
        program.display(), geometry.display()
    )]
    Gmsh {
        /// The program.
        program: PathBuf,
        /// What it was given.
        geometry: PathBuf,
        /// How it ended.
        status: ExitStatus,
        /// Its last words.
        said: String,
    },
    /// What Gmsh wrote cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file of results that is no JSON.
    #[error("{}: {source}", file.display())]
    Json {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// A point of the new mesh is outside of the old one, or an array does not fit it.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The case could not be opened or solved.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl From<Diagnostics> for RemeshError {
    fn from(problems: Diagnostics) -> Self {
        Self::Run(problems.into())
    }
}

impl RemeshError {
    /// The exit code that belongs to it.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Self::Run(error) => error.exit(),
            Self::Write(_) => Exit::NotWritten,
            _ => Exit::BadInput,
        }
    }
}
