//! What may be typed.

use crate::compare::{Cloud, Compare};
use crate::figure::Figure;
use crate::remesh::Remesh;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand};
use nastic_language::template::TEMPLATES;
use nastic_run::run::Part;
use std::path::PathBuf;

/// Optimal control of actuated hyperelastic soft bodies.
///
/// A case file (JSON with comments) says which body, what moves it from within, and what it shall become. nastic finds
/// its equilibrium, the derivative of the cost by the adjoint, and the best control.
#[derive(Debug, Parser)]
#[command(
    name = "nastic",
    version,
    after_help = "Exit codes: 0 done, 2 bad input, 3 forward solve failed, 4 stopped before converging, or \
                  runs are missing, 5 gradient check failed, 6 an \"expect\" was missed, 7 a file could not be written or another \
                  program writes to the output directory, 8 a warning under --strict.",
    max_term_width = 100
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a commented case with its mesh into a new directory, to begin with
    New(New),
    /// Show how a case is understood: groups, sizes, mesh quality, values with units, conventions. Solves nothing
    Check(Case),
    /// Find the equilibrium at the start controls
    ///
    /// Writes start.vtu (the equilibrium), target.vtu, picture.png, picture.svg and result.json.
    Solve(Solve),
    /// Find the lowest frequencies and shapes of small vibrations about the equilibrium at the start controls
    ///
    /// The materials need a density. Writes start.vtu (the equilibrium, with mode_1, mode_2, ..), picture.png, picture.svg (the
    /// first four), result.json and report.html.
    Modes(Modes),
    /// Compute cost and derivative at the start controls, for outside optimisers
    ///
    /// Writes derivative.json: one array per control under its name, in file order; entries in the order of cells, corner
    /// nodes or regions of the mesh, the components of a vector one after the other. Also start.vtu, target.vtu and
    /// result.json.
    Gradient(Case),
    /// Test the derivative by Taylor remainders, per control and per cost term
    ///
    /// Leaves nothing behind, unless --out says where to put result.json.
    Gradcheck(Case),
    /// Find the best control: the main job
    ///
    /// Begins with a short gradient check, prints one row per trial, ends with a summary. Writes start.vtu, optimum.vtu,
    /// target.vtu, iterations.pvd with its snapshots, history.jsonl, checkpoint.bin, picture.png, picture.svg and
    /// result.json, report.html. Ctrl-C or SIGTERM stops after the trial at hand and keeps what was found; nastic resume goes on.
    /// Load cases and scenarios have files of their own, and scenarios.pvd collects the latter.
    Optimize(Optimize),
    /// Find parameters from readings of a body: values with intervals, what the readings do not see, how the model meets them
    ///
    /// Shots are load cases with costs of the kind markers: points of the body and where they were measured, with a deviation; forces, positions and volumes
    /// may stand beside them. The parameters are the controls: { "of": "rubber.mu", "log": true }. Gauss-Newton as by optimize, with its files and exit codes,
    /// then the covariance at the optimum. Writes identified.json too: values, intervals, correlations, residuals by shot and marker, directions that are
    /// weakly seen or not at all, and blocks "materials" and "scenarios" to paste.
    Identify(Identify),
    /// Sensitivities of outputs by controls at the start, and a feedback law for a controller
    ///
    /// Outputs are what the case's costs compare with targets (position, markers, volume, mean_radius, reaction, curvature, orientation); costs that are one number, probes, pressures of chambers
    /// and tendons are told beside them. The law m <- m - L (y - y*), within the bounds, has one matrix for all steps; it is tried on the case and on each of its scenarios, beside the
    /// controls left as they are. Writes gains.json, gains.csv and gains.h (C99, no dependencies) too. The start may be the optimum of another run, its file
    /// named from the case: --set 'controls/0/start={"file": "out/finger/controls.json"}'.
    Gains(Case),
    /// Go on with an interrupted optimisation, or the motion of a solve, from the last checkpoint in its output directory
    ///
    /// The result is that of a run without interruption, to the bit, however the program ended: by Ctrl-C,
    /// SIGTERM or kill -9, or for lack of space. The case file and the files it names must be as they were; overrides
    /// (--set) are those of the run.
    Resume(Resume),
    /// Run a case once for every value of --set PATH=A,B,C, and make a table of all runs
    ///
    /// Commas outside of brackets, braces, parentheses and quotes stand between values: --set materials/0/young="90 kPa,110 kPa",
    /// --set actuation/0/direction=[1,0,0],[0,1,0]. Several such options mean all combinations; an option with one value is fixed.
    /// Each run has a directory of its own, NAME=VALUE in that of the results, with all its files; beside them are written sweep.html
    /// (a page), sweep.csv (a row per run), sweep_table.csv and sweep_table.tex (what the chart shows, for papers), sweep.json, sweep.svg and sweep.pvd (the optima, for
    /// ParaView). Where meshes are swept, the table has differences to the finest and the observed order. A run that fails is a row; the exit code is
    /// that of the worst. Ctrl-C or SIGTERM ends the run at hand and the sweep. What the case expects is left aside.
    ///
    /// A run whose finished result is there, of the same case, command and version of the program, is kept; one that was interrupted goes on from
    /// its checkpoint. So the same command goes on with a sweep that was interrupted, however that came about.
    Sweep(Sweep),
    /// Find the parameters of material laws from test data
    ///
    /// DATA is a CSV file of one test, or a data file: DATA.json names tests (uniaxial, equibiaxial, planar, simple_shear, inflation, volumetric) with CSV files of deformation and stress, and the
    /// laws to compare: { "nastic_fit": 1, "tests": [{ "kind": "uniaxial", "file": "bar.csv" }], "laws": ["yeoh", "ogden_3"], "bulk":
    /// "1 GPa" }. A CSV file begins with its columns: stretch,nominal_stress [MPa]. Weighted least squares over all tests together; confidence
    /// intervals, stability, comparison by AICc and BIC, and blocks "materials" and "scenarios" to paste. Writes fit.json and fit.svg.
    Fit(Fit),
    /// Mesh the cut design of an optimisation along its outline, with Gmsh, and solve it
    ///
    /// What optimize has found of densities, mixtures and electrodes is cut at the levels that keep their volumes; its outline, with the borders of materials and
    /// regions, is meshed by simplices (Gmsh must be installed: pip install gmsh). Surfaces, regions, node sets and the fields of other controls are carried over.
    /// Writes case.json with mesh.msh, a case of its own, solved/ and remesh.json, and compares the costs of the field, of its cut on the old mesh, and along the outline.
    Remesh(Remesh),
    /// Make report.html from the files of a result directory: shapes in 3D, plots, figures, in one page that works offline
    ///
    /// solve and optimize write the same page at their end, unless --no-report is given.
    Report(Report),
    /// Draw a state of a result directory for print: white ground, colour bar, scale of lengths, no text of the run
    ///
    /// Without more: the optimum (or the equilibrium, or the end of the motion or ramp) coloured by the first controlled field, chambers by their
    /// pressure, or else the displacement, before the start and the target as glass. The same picture gives the same bytes.
    Figure(Figure),
    /// Measure how far two shapes are apart: results, states, meshes, point clouds
    ///
    /// Mean, root mean square and largest distance of the points of each from the other, chamfer and Hausdorff distance; of two states of one
    /// mesh also node by node.
    Compare(Compare),
    /// Write the points of states as CSV, NPY or PLY, whole bodies or named surfaces and regions
    Cloud(Cloud),
    /// Print the JSON Schema of case files, for editors, or of results
    Schema(Schema),
}

/// Which schema is printed, and how.
#[derive(Debug, Args)]
pub struct Schema {
    /// That of result.json
    #[arg(long)]
    pub results: bool,
    /// As tables of keys in Markdown
    #[arg(long)]
    pub markdown: bool,
}

/// A case to begin with.
#[derive(Debug, Args)]
pub struct New {
    /// The directory to make; its last part names the case too. What exists is never replaced
    #[arg(value_name = "NAME")]
    pub directory: PathBuf,
    /// Which: a finger bent by a muscle, a finger with an air chamber, a finger that grips a block, a magnetic strip, a finger of uncertain stiffness
    #[arg(long, value_name = "TEMPLATE", default_value = "finger", value_parser = templates())]
    pub template: String,
}

/// The names of templates.
fn templates() -> PossibleValuesParser {
    PossibleValuesParser::new(TEMPLATES.iter().map(|template| PossibleValue::new(template.name).help(template.about)))
}

/// A case, and which vibrations of it.
#[derive(Debug, Args)]
pub struct Modes {
    #[command(flatten)]
    pub case: Case,
    /// How many; all unstable ones in any case, without a factor those that are found
    #[arg(long, value_name = "N", default_value = "6", value_parser = clap::value_parser!(u16).range(1..=500))]
    pub count: u16,
    /// About the undeformed body, without controls and loads
    #[arg(long)]
    pub undeformed: bool,
}

/// A case to optimise.
#[derive(Debug, Args)]
pub struct Optimize {
    #[command(flatten)]
    pub case: Case,
    /// Begin anew although the output directory holds the checkpoint of an interrupted optimisation or motion, or one that
    /// cannot be read, which is replaced
    #[arg(long)]
    pub restart: bool,
    /// Run only the K-th of N parts of the case's optimizer/starts (every N-th), each start in a directory start_I of its own, and make no
    /// result: N processes may do so at the same time; --join then makes the result. Starts that have ended are kept, one that was
    /// interrupted goes on
    #[arg(long, value_name = "K/N", conflicts_with_all = ["join", "spectrum"])]
    pub part: Option<Part>,
    /// Run nothing: make the result of all starts from those that parts have run, and name those that are missing (then at least exit code
    /// 4). Everything else is as for the parts
    #[arg(long)]
    pub join: bool,
    #[command(flatten)]
    pub diagnosis: Diagnosis,
}

/// A case whose parameters are to be found.
#[derive(Debug, Args)]
pub struct Identify {
    #[command(flatten)]
    pub case: Case,
    /// Begin anew although the output directory holds the checkpoint of an interrupted run, which is replaced
    #[arg(long)]
    pub restart: bool,
}

/// What is to be found of an optimum.
#[derive(Debug, Args)]
pub struct Diagnosis {
    /// Also the N largest eigenvalues of the cost's second derivative at the optimum, on the directions free of bounds
    ///
    /// They show how well the target determines the control: result.json has them with residuals (spectrum), spectrum.vtu and
    /// spectrum.json the eigenvectors. A cost, law or risk without second derivatives is refused before the run. nastic resume DIR
    /// --spectrum N finds them for an optimisation that has ended.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=500))]
    pub spectrum: Option<u16>,
    /// How far the cost may rise above the optimum, for the half-widths of the control along the eigenvectors [default: a hundredth of
    /// the cost there]
    #[arg(long, value_name = "RISE", requires = "spectrum")]
    pub cost_rise: Option<f64>,
}

/// A case to run for several values.
#[derive(Debug, Args)]
pub struct Sweep {
    #[command(flatten)]
    pub case: Case,
    /// What to run for every value
    #[arg(long, value_name = "COMMAND", default_value = "optimize")]
    pub command: SweptCommand,
    /// Start every optimisation after the first from the controls of the last one before that has some
    #[arg(long)]
    pub warm: bool,
    /// What the chart and the table show, by its path in result.json: energy/elastic, probes/tip/displacement/2, .. [default: cost, distances and
    /// controls of optimisations, distances of solves, else displacements of probes, or the elastic energy]
    #[arg(long, value_name = "PATH")]
    pub quantity: Option<String>,
    /// Begin anew: keep no finished run, and replace checkpoints of interrupted ones and those that cannot be read
    #[arg(long, conflicts_with = "join")]
    pub restart: bool,
    /// Make only the K-th of N parts (of all runs every N-th), and no table: N processes, on several machines with a common directory,
    /// may do so at the same time; --join then makes the table
    #[arg(long, value_name = "K/N", conflicts_with = "join")]
    pub part: Option<Part>,
    /// Make no run: write the table from the runs that are there, and name those that are missing (then at least exit code 4). Everything
    /// else is as for the parts
    #[arg(long)]
    pub join: bool,
}

/// What a sweep runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SweptCommand {
    /// The main job.
    Optimize,
    /// The equilibrium at the start controls.
    Solve,
}

/// A run that was interrupted.
#[derive(Debug, Args)]
pub struct Resume {
    /// The output directory of the optimisation or solve
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    #[command(flatten)]
    pub diagnosis: Diagnosis,
    /// How to run it.
    #[command(flatten)]
    pub running: Running,
}

/// Test data.
#[derive(Debug, Args)]
pub struct Fit {
    /// The data file, or the CSV file of one test
    #[arg(value_name = "DATA")]
    pub data: PathBuf,
    /// What is known of a CSV file.
    #[command(flatten)]
    pub table: Table,
    /// Directory of all results [default: out/DATA beside the file]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print errors only
    #[arg(long)]
    pub quiet: bool,
    /// Print the result as JSON instead of text for people
    #[arg(long)]
    pub json: bool,
}

/// A table of test data without a data file, which has keys of these names.
#[derive(Clone, Debug, Args)]
pub struct Table {
    /// Of a CSV file: how the material was deformed [default: uniaxial]
    #[arg(long, value_name = "KIND")]
    pub kind: Option<String>,
    /// Of a CSV file: the bulk modulus, "1 GPa" of solid rubber, or about 50 times the shear modulus where a body is to be solved without locking
    #[arg(long, value_name = "PRESSURE")]
    pub bulk: Option<String>,
    /// Of a CSV file with a column "force": the area at rest of the cross-section, as "40 mm^2"
    #[arg(long, value_name = "AREA")]
    pub area: Option<String>,
    /// Of a CSV file with a column "extension": the length at rest that was extended, as "33 mm"
    #[arg(long, value_name = "LENGTH")]
    pub length: Option<String>,
    /// Of a CSV file: laws to compare, with commas between [default: all that can be fitted]
    #[arg(long, value_name = "LAWS", value_delimiter = ',')]
    pub laws: Vec<String>,
}

/// A result directory.
#[derive(Debug, Args)]
pub struct Report {
    /// The output directory of solve, optimize or resume
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// Where to put the page [default: report.html in DIR]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// How to run and what to print.
#[derive(Debug, Args)]
pub struct Running {
    /// Number of threads; results do not depend on it [default: all processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Let warnings fail the command: exit code 8 where there would be 0
    #[arg(long)]
    pub strict: bool,
    /// Leave out report.html, the page that solve and optimize write at their end
    #[arg(long)]
    pub no_report: bool,
    /// Write figure.png and figure.svg too: the result for print, as nastic figure draws it
    #[arg(long)]
    pub figure: bool,
    /// Say what the columns of the table of trials mean
    #[arg(long)]
    pub explain: bool,
    /// Print errors only
    #[arg(long)]
    pub quiet: bool,
    /// Print the result as JSON instead of text for people
    #[arg(long)]
    pub json: bool,
}

/// A case, and what to compute of it.
#[derive(Debug, Args)]
pub struct Solve {
    #[command(flatten)]
    pub case: Case,
    #[command(flatten)]
    pub analysis: Analysis,
    /// Where --path ends before full loads: behind the first limit point
    #[arg(long, value_name = "EVENT", requires = "path")]
    pub stop_at: Option<StopAt>,
    /// Begin anew although the output directory holds the checkpoint of an interrupted motion, which is replaced
    #[arg(long)]
    pub restart: bool,
}

/// Where a path may end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum StopAt {
    /// Behind the first limit point.
    Limit,
}

/// What solve computes: the equilibrium at the start controls, unless one of these is given.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub struct Analysis {
    /// Also the N smallest eigenvalues of the tangent, all negative ones in any case (without a factor those that are found), and their modes (in start.vtu)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=500))]
    pub modes: Option<u16>,
    /// Go on from an unstable equilibrium to a stable one, downhill along its most negative mode
    #[arg(long)]
    pub minimum: bool,
    /// Also the equilibrium whose contacts have no layer, for verification (exact_contact.vtu): how far are forces and places from it?
    #[arg(long)]
    pub exact_contact: bool,
    /// Also the state, equilibrium or motion, whose contacts have layers half as thick: the share of the layer in forces and places
    #[arg(long)]
    pub half_thickness: bool,
    /// Instead N equilibria with one control going from a value to another: --ramp "air=0 Pa:60 kPa:12"
    ///
    /// Writes ramp.csv, ramp.svg, ramp_reactions.svg, ramp_energies.svg, ramp_volumes.svg, ramp.pvd with its snapshots, and result.json with the critical values.
    #[arg(long, value_name = "CONTROL=FROM:TO:N")]
    pub ramp: Option<String>,
    /// Instead the path of equilibria from rest to the start controls and full loads, through limit points
    ///
    /// Arc-length continuation. Writes path.csv, path.svg (the load-displacement curve), charts as of ramps, path.pvd with its snapshots,
    /// and result.json with limit points and bifurcations.
    #[arg(long)]
    pub path: bool,
    /// Also other equilibria under the same controls, up to N in all, by deflation (equilibrium_001.vtu ..)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub equilibria: Option<u16>,
}

/// A case and how to run it.
#[derive(Debug, Args)]
pub struct Case {
    /// The case file
    #[arg(value_name = "CASE")]
    pub case: PathBuf,
    /// Directory of all results [default: output/directory of the case, else out/NAME beside it]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Put a value in the place of another: --set materials/0/mu1="90 kPa"; may be repeated
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub settings: Vec<String>,
    /// How to run it.
    #[command(flatten)]
    pub running: Running,
}
