//! `nastic compare` and `nastic cloud`: what may be typed, and what is said.

use crate::command::{answered, while_shown, written};
use crate::output::Output;
use clap::Args;
use nastic_io::write_cloud;
use nastic_mesh::GroupNames;
use nastic_report::{CompareRequest, ComparedPart};
use nastic_run::run::keep_results;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Two shapes.
#[derive(Debug, Args)]
pub struct Compare {
    /// A result directory (its optimum, equilibrium or last instant), a state of one (DIR/motion_0040), a .vtu, .msh or .vtk file, or a point
    /// cloud (.csv, .npy, .ply)
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// The same, or another one
    #[arg(value_name = "B")]
    pub b: PathBuf,
    #[command(flatten)]
    pub part: Part,
    /// What the lengths of B are multiplied with, as 0.001 where A is in metres and B in millimetres
    #[arg(long, value_name = "FACTOR")]
    pub scale: Option<f64>,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}

/// The points of states.
#[derive(Debug, Args)]
pub struct Cloud {
    /// The output directory of solve, modes, optimize or resume
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// Where to put them: CSV (node,X,Y,Z,x,y,z), NPY or PLY by the ending. Of several states, NAME_STATE.ENDING each
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// States by the names of their files, with commas between: optimum, motion_0040, .. [default: the optimum, the equilibrium or the last
    /// instant]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub state: Vec<String>,
    #[command(flatten)]
    pub part: Part,
}

/// A part of a body.
#[derive(Debug, Args)]
pub struct Part {
    /// Surfaces alone, with commas between
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with = "region")]
    pub surface: Vec<String>,
    /// Regions alone, with commas between
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub region: Vec<String>,
}

impl Part {
    fn part(&self) -> ComparedPart {
        match (&self.surface[..], &self.region[..]) {
            ([], []) => ComparedPart::Whole,
            ([], regions) => ComparedPart::Region(GroupNames::from(regions.to_vec())),
            (surfaces, _) => ComparedPart::Surface(GroupNames::from(surfaces.to_vec())),
        }
    }
}

impl Compare {
    /// Compares and says what was found; the exit code.
    pub fn run(&self) -> u8 {
        let request = CompareRequest { part: self.part.part(), scale: self.scale };
        let found = while_shown("comparing", |_| nastic_report::compare(&self.a, &self.b, &request));
        answered(found.map_err(Into::into), |found| {
            let text = match self.json {
                true => serde_json::to_string_pretty(&found).unwrap_or_default() + "\n",
                false => found.text(),
            };
            // of a failure, `Output` knows
            let _ = Output.write_all(text.as_bytes());
        })
    }
}

impl Cloud {
    /// Writes the clouds and says where they are; the exit code.
    pub fn run(&self) -> u8 {
        let part = self.part.part();
        let of = |state: Option<&str>, file: &Path| {
            let cloud = while_shown("taking points", |_| nastic_report::cloud(&self.directory, state, &part))?;
            keep_results(&self.directory, file)?;
            write_cloud(file, &cloud)?;
            Ok(file.to_owned())
        };
        match &self.state[..] {
            [] => written(of(None, &self.out)),
            [one] => written(of(Some(one), &self.out)),
            several => {
                let codes = several.iter().map(|state| written(of(Some(state), &beside(&self.out, state))));
                codes.max().unwrap_or(0)
            }
        }
    }
}

/// `skin_motion_0040.csv` of `skin.csv`.
fn beside(file: &Path, state: &str) -> PathBuf {
    let (stem, ending) = (file.file_stem().unwrap_or_default(), file.extension().unwrap_or_default());
    file.with_file_name(format!("{}_{state}.{}", stem.to_string_lossy(), ending.to_string_lossy()))
}
