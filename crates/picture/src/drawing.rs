//! A [`Picture`] as PNG and SVG.

use super::body::Appearance;
use super::colour_range::ColourRange;
use super::frame::Frame;
use super::picture::{Picture, PictureError};
use super::raster::{self, Image};
use super::scene::Scene;
use super::survey::Survey;
use super::{png, sheet, svg, text};
use nastic_io::WriteError;
use std::path::Path;

impl Picture {
    /// Gives it the view, the scale and the range of colours of all pictures of a survey; a range that a field has stays.
    pub fn surveyed(mut self, survey: &Survey) -> Self {
        self.framed = survey.points().to_vec();
        for body in &mut self.bodies {
            if let Appearance::Field(field) = &mut body.appearance {
                match (field.range, survey.colours()) {
                    (Some((low, high)), _) => field.beyond = survey.values().beyond(low, high),
                    (None, Some(ColourRange { low, high, beyond })) => {
                        (field.range, field.beyond) = (Some((low, high)), beyond);
                    }
                    (None, None) => {}
                }
            }
        }
        self
    }

    /// Writes a PNG or an SVG, by the ending of the name.
    ///
    /// # Errors
    ///
    /// [`WriteError::System`]; [`WriteError::Content`] for another ending, no bodies, positions or values of the wrong
    /// number, positions that are not finite, or a view of length zero.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        sheet::write(path.as_ref(), || self.png(), || self.svg())
    }

    /// The picture as a PNG.
    ///
    /// # Errors
    ///
    /// No bodies, positions or values of the wrong number, positions that are not finite, or a view of length zero.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        png::encode(&self.image()?).map_err(|error| PictureError(error.to_string()))
    }

    pub(crate) fn image(&self) -> Result<Image, PictureError> {
        let scene = Scene::new(self).map_err(PictureError)?;
        let frame = Frame::new(self, &scene);
        let mut image = raster::render(&scene, self.width as usize, self.height as usize);
        text::draw(&mut image, &frame.marks);
        Ok(image)
    }

    pub(crate) fn svg(&self) -> Result<String, String> {
        let scene = Scene::new(self)?;
        let frame = Frame::new(self, &scene);
        Ok(svg::draw(self, &scene, &frame.marks))
    }
}
