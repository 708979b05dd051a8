//! [`Sheet`]: several pictures side by side.

use std::path::Path;

use nastic_io::{WriteError, write_atomically};

use super::picture::{Picture, PictureError};
use super::raster::Image;
use super::{png, svg};

/// Pictures in rows, from left to right and from top to bottom, as one file; the same pictures give the same bytes. One picture alone
/// is as large as by itself, several are 1000 x 625 pixels each.
///
/// ```
/// use nastic_picture::{Body, Picture, Sheet};
/// use nastic_mesh::{CellKind, box_mesh};
///
/// # let out = tempfile::tempdir()?;
/// let of = |length| Ok::<_, Box<dyn std::error::Error>>(Body::new("bar", box_mesh([length, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?));
/// let sheet = Sheet::new(vec![Picture::new("short").body(of(0.5)?), Picture::new("long").body(of(2.0)?)]);
/// sheet.write(out.path().join("bars.png"))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sheet {
    pictures: Vec<Picture>,
}

/// Pixels of one of several pictures.
const PANEL: (u32, u32) = (1000, 625);

impl Sheet {
    /// A sheet of these pictures.
    pub fn new(pictures: Vec<Picture>) -> Self {
        let several = pictures.len() > 1;
        let sized = |picture: Picture| if several { picture.size(PANEL.0, PANEL.1) } else { picture };
        Self { pictures: pictures.into_iter().map(sized).collect() }
    }

    /// Writes a PNG or an SVG, by the ending of the name.
    ///
    /// # Errors
    ///
    /// As [`Picture::write`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        write(path.as_ref(), || self.png(), || self.svg())
    }

    /// The sheet as a PNG.
    ///
    /// # Errors
    ///
    /// As [`Picture::png`].
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        if let [picture] = self.pictures.as_slice() {
            return picture.png();
        }
        let (columns, [width, height]) = self.layout()?;
        let mut image = Image { width, height, pixels: vec![[1.0; 3]; width * height] };
        for (k, picture) in self.pictures.iter().enumerate() {
            let panel = picture.image()?;
            let (left, top) = (k % columns * panel.width, k / columns * panel.height);
            for (row, pixels) in panel.pixels.chunks_exact(panel.width).enumerate() {
                image.pixels[(top + row) * width + left..][..panel.width].copy_from_slice(pixels);
            }
        }
        png::encode(&image).map_err(|error| PictureError(error.to_string()))
    }

    fn svg(&self) -> Result<String, String> {
        if let [picture] = self.pictures.as_slice() {
            return picture.svg();
        }
        let (columns, size) = self.layout().map_err(|PictureError(what)| what)?;
        let panels = self.pictures.iter().enumerate().map(|(k, picture)| {
            let at = [k % columns * PANEL.0 as usize, k / columns * PANEL.1 as usize];
            Ok((at, picture.svg()?))
        });
        Ok(svg::sheet(size, &panels.collect::<Result<Vec<_>, String>>()?))
    }

    /// Columns, and the size in pixels: two columns of up to four pictures, three of more.
    fn layout(&self) -> Result<(usize, [usize; 2]), PictureError> {
        let count = self.pictures.len();
        if count == 0 {
            return Err(PictureError("the sheet has no pictures".to_owned()));
        }
        let columns = if count <= 4 { 2 } else { 3 };
        Ok((columns, [columns * PANEL.0 as usize, count.div_ceil(columns) * PANEL.1 as usize]))
    }
}

/// Writes what the ending of the name asks for.
pub(super) fn write(
    path: &Path,
    png: impl FnOnce() -> Result<Vec<u8>, PictureError>,
    svg: impl FnOnce() -> Result<String, String>,
) -> Result<(), WriteError> {
    let bad =
        |what: String, advice: &str| WriteError::Content { file: path.to_owned(), what, advice: advice.to_owned() };
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("png") => {
            let bytes = png().map_err(|PictureError(what)| bad(what, "see the picture's inputs"))?;
            write_atomically(path, |out| out.write_all(&bytes))
        }
        Some("svg") => {
            let text = svg().map_err(|what| bad(what, "see the picture's inputs"))?;
            write_atomically(path, |out| out.write_all(text.as_bytes()))
        }
        _ => Err(bad("the ending of the name is not known".to_owned(), "use .png or .svg")),
    }
}
