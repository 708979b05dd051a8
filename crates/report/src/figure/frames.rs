//! [`Frames`]: the states of a motion, a ramp or a path as pictures of one view, one scale and one range of colours.

use super::{FigureRequest, chambers, check_plane, compose, fields, state};
use crate::error::ReportError;
use crate::figure::state::State;
use crate::folder::ResultFolder;
use nastic_picture::{Picture, PictureError, Survey};
use std::path::Path;

/// Series of states by what their names begin with, the first of a result before the others.
const SERIES: [&str; 4] = ["motion", "ramp", "path", "iteration"];

/// The states of a series as pictures.
pub struct Frames {
    folder: ResultFolder,
    names: Vec<String>,
    /// With the field of all.
    request: FigureRequest,
    survey: Survey,
}

impl Frames {
    /// Looks at all states of a series: the one that `request.state` names (`motion`, `ramp`, `CASE_motion`, or one of its states), else that of the result.
    /// They have the field that a figure of the last one has.
    ///
    /// # Errors
    /// [`ReportError`]: no results, no such states, a field that they do not have.
    pub fn open(directory: &Path, request: &FigureRequest) -> Result<Self, ReportError> {
        let folder = ResultFolder::open(directory)?;
        let names = series(&folder, request.state.as_deref())?;
        let mut request = FigureRequest { state: None, ..request.clone() };
        if let Some(last) = names.last() {
            let last = State::find(&folder, Some(last))?;
            let field = fields::chosen(&folder, &last, request.field.as_deref());
            if request.range.is_none() && fields::is_of_chambers(&folder, &field) {
                let of = |name: &String| chambers::range(&folder, &State::find(&folder, Some(name))?);
                let ranges: Vec<[f64; 2]> = names.iter().map(of).collect::<Result<_, _>>()?;
                request.range = ranges.into_iter().reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
            }
            request.field = Some(field);
        }
        check_clip(&folder, &names, &request)?;
        let mut frames = Self { folder, names, request, survey: Survey::default() };
        for k in 0..frames.len() {
            let picture = frames.alone(k)?;
            frames.survey.add(&picture).map_err(|error| frames.cannot_draw(k, &error))?;
        }
        Ok(frames)
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// One of them.
    ///
    /// # Errors
    /// [`ReportError`]: a file that cannot be read any more.
    pub fn picture(&self, k: usize) -> Result<Picture, ReportError> {
        Ok(self.alone(k)?.surveyed(&self.survey))
    }

    /// A picture that cannot be drawn, as an error of the state's file.
    #[must_use]
    pub fn cannot_draw(&self, k: usize, error: &PictureError) -> ReportError {
        self.folder.content(&format!("{}.vtu", self.names[k]), error.to_string())
    }

    fn alone(&self, k: usize) -> Result<Picture, ReportError> {
        compose(&self.folder, &State::find(&self.folder, Some(&self.names[k]))?, &self.request)
    }
}

/// Refuses a plane that cuts none of the states, as that of the last one does.
fn check_clip(folder: &ResultFolder, names: &[String], request: &FigureRequest) -> Result<(), ReportError> {
    let Some(plane) = request.clip else { return Ok(()) };
    let mut cut = Ok(());
    for name in names {
        cut = check_plane(plane.0, plane.1, &State::find(folder, Some(name))?.shot, &folder.result.units.length);
        if cut.is_ok() {
            break;
        }
    }
    cut
}

/// The names of a series' states.
fn series(folder: &ResultFolder, wanted: Option<&str>) -> Result<Vec<String>, ReportError> {
    let all = state::names(folder);
    let of =
        |series: &str| -> Vec<String> { all.iter().filter(|name| beginning(name) == Some(series)).cloned().collect() };
    let mut has: Vec<String> = all.iter().filter_map(|name| beginning(name)).map(str::to_owned).collect();
    has.dedup();
    let stem = folder.result.members.iter().flatten().next().map_or("", |member| &member.stem);
    let usual = || SERIES.iter().map(|series| format!("{stem}{series}")).find(|series| has.contains(series));
    let named = wanted.map(|name| {
        let name = name.trim_end_matches(".vtu");
        beginning(name).unwrap_or(name).to_owned()
    });
    let mut names = named.clone().or_else(usual).map(|series| of(&series)).unwrap_or_default();
    names.sort();
    if names.is_empty() {
        let name = named.unwrap_or_else(|| SERIES[0].to_owned());
        return Err(ReportError::Unknown { what: "series of states", name, has });
    }
    Ok(names)
}

/// `motion` of `motion_0003`.
fn beginning(name: &str) -> Option<&str> {
    let (series, number) = name.rsplit_once('_')?;
    let is_one = SERIES.iter().any(|known| series.ends_with(known));
    (is_one && !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())).then_some(series)
}
