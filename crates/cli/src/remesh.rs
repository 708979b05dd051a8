//! `nastic remesh`: what may be typed.

use crate::arguments::Running;
use clap::Args;
use nastic_remesh::RemeshRequest;
use nastic_run::run::Options;
use std::path::PathBuf;

/// A design to mesh along its outline.
#[derive(Debug, Args)]
pub struct Remesh {
    /// The output directory of optimize
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// The size of cells in the case's unit of length [default: the mean edge of the old mesh]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub size: Option<f64>,
    /// Where the case, its mesh and its results go [default: DIR/remeshed]
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// The program Gmsh
    #[arg(long, value_name = "PROGRAM", default_value = "gmsh")]
    pub gmsh: PathBuf,
    #[command(flatten)]
    pub running: Running,
}

impl Remesh {
    /// What is asked for, with options of the solves.
    pub fn request(&self, options: Options) -> RemeshRequest {
        let Remesh { directory, size, out, gmsh, .. } = self;
        RemeshRequest { directory: directory.clone(), size: *size, out: out.clone(), gmsh: gmsh.clone(), options }
    }
}
