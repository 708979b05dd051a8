//! `nastic figure`: what may be typed, and what is drawn.

use crate::command::{while_shown, written};
use clap::Args;
use nastic_run::run::{self, FigureRequest};
use std::path::PathBuf;

/// What is drawn of a result directory.
#[derive(Debug, Args)]
pub struct Figure {
    /// The output directory of solve, modes, optimize or resume
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// Where to put it, PNG or SVG by the ending [default: figure.png in DIR]; with --frames the directory of them all [default: DIR]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The state, by the name of its file: start, optimum, motion_0040, iteration_0010, ..
    #[arg(long, value_name = "NAME")]
    pub state: Option<String>,
    /// What the body is coloured by: an array of the state's VTU file, |NAME| or NAME.x of a vector, NAME.xy of a tensor, |u| (displacement),
    /// pressure (of chambers), none
    #[arg(long, value_name = "NAME")]
    pub field: Option<String>,
    /// Ends of the colour bar, so that figures can be compared
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, value_parser = range)]
    pub range: Option<[f64; 2]>,
    /// Direction from the body to the eye [default: across the plane in which the body bends]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    pub view: Option<[f64; 3]>,
    /// What is kept of a solid body, in its displaced position: x<0.01, y>0, or 1,0,1<0.5 for x + z < 0.5, in the case's unit of length
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true, value_parser = plane)]
    pub clip: Option<([f64; 3], f64)>,
    /// Width and height in pixels, 320x200 to 16384x16384 [default: 1600x1000]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// States that stand behind as glass, with commas between; "target", or "" for none [default: start,target; of chambers in space target]
    #[arg(long, value_name = "NAMES")]
    pub behind: Option<String>,
    /// A probe, or a cost of one position, whose path over the instants of the motion is drawn; may be given several times. Targets that move are dashed [default:
    /// costs whose targets move]
    #[arg(long, value_name = "PROBE")]
    pub path: Vec<String>,
    /// Draw the edges of elements
    #[arg(long)]
    pub edges: bool,
    /// All states of a motion, ramp, path or optimisation, one after the other: frame_0000.png, .. and the animated frames.gif
    ///
    /// They have one view, one scale and one range of colours. --state names the series: motion, ramp, path, iteration [default: the first of these that
    /// there is]
    #[arg(long)]
    pub frames: bool,
    /// Frames in a second of frames.gif, 1 to 50
    #[arg(long, value_name = "N", requires = "frames", default_value = "10", value_parser = clap::value_parser!(u8).range(1..=50))]
    pub fps: u8,
}

impl Figure {
    /// Draws it and says where it is; the exit code.
    pub fn draw(&self) -> u8 {
        let names =
            |text: &String| text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect();
        let request = FigureRequest {
            state: self.state.clone(),
            field: self.field.clone(),
            range: self.range,
            view: self.view,
            clip: self.clip,
            size: self.size,
            behind: self.behind.as_ref().map(names),
            paths: self.path.clone(),
            edges: self.edges,
        };
        let (directory, out) = (&self.directory, self.out.as_deref());
        written(while_shown("drawing", |console| match self.frames {
            false => run::figure(directory, &request, out),
            true => {
                let drawn = |done: usize, of: usize| console.step(done.min(of - 1), of, "");
                run::frames(directory, &request, out, f64::from(self.fps), &drawn)
            }
        }))
    }
}

/// Numbers with commas between.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parts = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|number| number.is_finite()));
    let found = parts.collect::<Option<Vec<f64>>>().and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
    found.ok_or_else(|| format!("{N} numbers with commas between are needed, as {}", ["0", "1", "0.5"][..N].join(",")))
}

/// The ends of a colour bar.
fn range(text: &str) -> Result<[f64; 2], String> {
    let [low, high] = numbers::<2>(text)?;
    if low < high { Ok([low, high]) } else { Err(format!("the first end is the lower one: {high},{low}")) }
}

/// The plane beyond which the body is cut away: its normal points there.
fn plane(text: &str) -> Result<([f64; 3], f64), String> {
    let wrong = || "a plane is what is kept: x<0.01, z>0, or 1,0,1<0.5 for x + z < 0.5".to_owned();
    let at = text.find(['<', '>']).ok_or_else(wrong)?;
    let (left, right) = (text[..at].trim(), &text[at + 1..]);
    let normal = match left {
        "x" => [1.0, 0.0, 0.0],
        "y" => [0.0, 1.0, 0.0],
        "z" => [0.0, 0.0, 1.0],
        _ => numbers::<3>(left).map_err(|_| wrong())?,
    };
    let [offset] = numbers::<1>(right).map_err(|_| wrong())?;
    let sign = if text[at..].starts_with('<') { 1.0 } else { -1.0 };
    Ok((normal.map(|x| sign * x), sign * offset))
}

/// Pixels across and down.
fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let fits = |[width, height]: &[u32; 2]| (320..=16384).contains(width) && (200..=16384).contains(height);
    sides.filter(fits).ok_or_else(|| "a size is 1600x1000, from 320x200 to 16384x16384".to_owned())
}
