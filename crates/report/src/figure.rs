//! A state of a result folder as a picture for print: [`figure`].

mod behind;
mod chambers;
mod fields;
mod frames;
mod lumen;
mod marks;
mod paths;
mod state;

pub use frames::Frames;
pub use marks::{FIELD, tension, uniform_field, with_marks};

use crate::error::ReportError;
use crate::folder::ResultFolder;
use fields::Shown;
use nastic_mesh::Snapshot;
use nastic_picture::{Appearance, Body, Colour, Picture, View};
use paths::TargetPath;
pub(crate) use state::State;
use std::path::Path;

/// What a figure shows; without more the optimum (or the equilibrium, or the end of the motion, ramp or path), coloured by the first controlled
/// field or else by the displacement, before the start and the target; chambers in space before the target alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureRequest {
    /// A state by the name of its file, with or without `.vtu`.
    pub state: Option<String>,
    /// An array of that file, `|NAME|` or `NAME.x` of a vector, `NAME.xy` of a tensor, `|u|`, `pressure` of chambers, or `none`.
    pub field: Option<String>,
    /// Ends of the colour bar.
    pub range: Option<[f64; 2]>,
    /// From the body to the eye.
    pub view: Option<[f64; 3]>,
    /// Normal and offset of a plane beyond which the body is cut away.
    pub clip: Option<([f64; 3], f64)>,
    /// Width and height in pixels.
    pub size: Option<[u32; 2]>,
    /// States that stand behind as glass; unless this is given start and target, of chambers in space the target.
    pub behind: Option<Vec<String>>,
    /// Probes, or costs that look at a place, whose path over the instants of the motion is drawn. Without any, costs whose targets move.
    pub paths: Vec<String>,
    /// Whether element edges are drawn.
    pub edges: bool,
}

/// The picture of a state.
///
/// # Errors
/// [`ReportError`]: no results, a state, field or probe that they do not have, or a plane that does not cut the body.
pub fn figure(directory: &Path, request: &FigureRequest) -> Result<Picture, ReportError> {
    let folder = ResultFolder::open(directory)?;
    let state = State::find(&folder, request.state.as_deref())?;
    if let Some(plane) = request.clip {
        check_plane(plane.0, plane.1, &state.shot, &folder.result.units.length)?;
    }
    compose(&folder, &state, request)
}

/// A plane cuts the displaced body: one beside it would leave all or nothing without a word.
pub(crate) fn check_plane(normal: [f64; 3], offset: f64, shot: &Snapshot, unit: &str) -> Result<(), ReportError> {
    let u = shot.point_array("displacement");
    let along = |(node, x): (usize, &[f64; 3])| -> f64 {
        let moved = |i: usize| x[i] + u.and_then(|u| u.values.get(node * u.components + i)).copied().unwrap_or(0.0);
        (0..3).map(|i| normal[i] * moved(i)).sum()
    };
    let all = || shot.mesh.points().iter().enumerate().map(along);
    let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    if least < offset && offset < most {
        return Ok(());
    }
    let keeps = if offset >= most { "all" } else { "nothing" };
    // told in the direction of the axis
    let negative = normal.iter().all(|n| *n <= 0.0);
    let told = |value: f64| if negative { 0.0 - value } else { value };
    let (least, most) = if negative { (told(most), told(least)) } else { (least, most) };
    Err(ReportError::Plane {
        keeps,
        normal: normal.map(told),
        offset: told(offset),
        least,
        most,
        unit: unit.to_owned(),
    })
}

fn compose(folder: &ResultFolder, state: &State<'_>, request: &FigureRequest) -> Result<Picture, ReportError> {
    if let Some([low, high]) = request.range.filter(|[low, high]| low >= high) {
        return Err(ReportError::Range { low, high });
    }
    let mut picture = Picture::new(&state.label).plain().length_unit(&folder.result.units.length);
    if let Some([width, height]) = request.size {
        picture = picture.size(width, height);
    }
    if let Some(direction) = request.view {
        picture = picture.view(View::From(direction));
    }
    let field = fields::shown(folder, state, request.field.as_deref())?;
    // the body itself is glass around its chambers: a start of glass behind it could not be told from it
    let target = ["target".to_owned()];
    let is_glass = matches!(field, Shown::Chambers) && state.shot.mesh.dim() == 3;
    let behind = request.behind.as_deref().or(is_glass.then_some(&target));
    for body in behind::bodies(folder, state, behind)? {
        picture = picture.body(body);
    }
    if let Some(field) = uniform_field(&state.shot) {
        picture = picture.vector("field", FIELD, field);
    }
    for body in bodies(folder, state, field, request)? {
        picture = picture.body(body);
    }
    let targets = paths::moving_targets(folder, state)?;
    let shown = if request.paths.is_empty() { paths::usual(state, folder, &targets) } else { request.paths.clone() };
    for (k, name) in shown.iter().enumerate() {
        let points = paths::of(folder, state, name)?;
        picture = picture.path(&format!("path of {name}"), path_colour(k), points);
    }
    let with_targets = behind::with_targets(behind);
    let is_one = targets.len() == 1;
    for TargetPath { cost, points } in targets.into_iter().filter(|_| with_targets) {
        let label = if is_one { "target path".to_owned() } else { format!("target path of {cost}") };
        picture = picture.dashed_path(&label, Colour::INK, points);
    }
    Ok(picture)
}

/// The colour of the k-th path: red first, which stands out before a body in shades of blue.
fn path_colour(k: usize) -> Colour {
    let mut colours = Colour::DISTINCT;
    colours[..4].reverse();
    colours[k % colours.len()]
}

/// The body itself with what it carries; chambers in the colour of their pressure within a body of glass.
fn bodies(
    folder: &ResultFolder,
    state: &State<'_>,
    field: Shown,
    request: &FigureRequest,
) -> Result<Vec<Body>, ReportError> {
    let shot = &state.shot;
    let cut = |body: Body| match request.clip {
        Some((normal, offset)) => body.clip(normal, offset),
        None => body,
    };
    let body = cut(Body::of(&state.label, shot)).lines(request.edges);
    Ok(match field {
        Shown::Chambers => {
            let look = if shot.mesh.dim() == 2 { Appearance::Solid } else { Appearance::Glass };
            let mut bodies = vec![with_marks(body.appearance(look(Colour::GREY)), shot)];
            bodies.extend(chambers::bodies(folder, state, request.range)?.into_iter().map(cut));
            bodies
        }
        Shown::Nothing => vec![with_marks(body.appearance(Appearance::Solid(Colour::BLUE)), shot)],
        Shown::Field(field) => {
            let field = request.range.map_or_else(|| field.clone(), |[low, high]| field.clone().range(low, high));
            vec![with_marks(body.appearance(Appearance::Field(field)), shot)]
        }
    })
}
