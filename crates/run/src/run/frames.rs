//! `nastic figure --frames`: the states of a result folder one after the other.

use crate::run::error::RunError;
use crate::run::report::place;
use nastic_io::{WriteError, WrittenFiles, write_atomically};
use nastic_picture::Film;
use nastic_report::{FigureRequest, Frames};
use std::path::{Path, PathBuf};

/// The animated picture of all.
const GIF: &str = "frames.gif";

/// Draws the states of a motion, ramp or path, to `frame_0000.png` .. and `frames.gif` in the result folder, or in the directory that is named;
/// where the animated picture went. `drawn` gets how many of them are drawn.
///
/// # Errors
/// [`RunError::Report`]: the folder holds no results, or has not what is asked for; as [`figure`](crate::run::figure).
pub fn frames(
    directory: &Path,
    request: &FigureRequest,
    out: Option<&Path>,
    frames_per_second: f64,
    drawn: &dyn Fn(usize, usize),
) -> Result<PathBuf, RunError> {
    let frames = Frames::open(directory, request)?;
    let out = out.unwrap_or(directory);
    std::fs::create_dir_all(out).map_err(|source| WriteError::System { file: out.to_owned(), source })?;
    let mut film = Film::default();
    for k in 0..frames.len() {
        let bytes = film.add(&frames.picture(k)?).map_err(|error| frames.cannot_draw(k, &error))?;
        write_atomically(place(out, None, &frame(k))?, |out| out.write_all(&bytes))?;
        drawn(k + 1, frames.len());
    }
    remove_from(out, frames.len())?;
    let file = place(out, None, GIF)?;
    film.write_gif(&file, frames_per_second)?;
    Ok(file)
}

fn frame(k: usize) -> String {
    format!("frame_{k:04}.png")
}

/// Those of a longer series that were drawn there before.
fn remove_from(directory: &Path, first: usize) -> Result<(), RunError> {
    let written = WrittenFiles::of(directory)?;
    for name in (first..).map(frame).take_while(|name| written.has(name)) {
        let file = directory.join(&name);
        match std::fs::remove_file(&file) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                return Err(WriteError::System { file, source }.into());
            }
            _ => written.remove(&name)?,
        }
    }
    Ok(())
}
