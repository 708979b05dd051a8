//! [`Film`]: pictures one after the other as an animated GIF.

use std::path::Path;

use nastic_io::{WriteError, write_atomically};

use super::palette::{Palette, code};
use super::picture::{Picture, PictureError};
use super::raster::Image;
use super::{colour, png};

/// Pictures of one size one after the other. Every one is there as PNG too, when it is added.
#[derive(Clone, Debug, Default)]
pub struct Film {
    size: [u16; 2],
    /// Colours of pixels, in five bits each.
    frames: Vec<Vec<u16>>,
}

impl Film {
    /// Adds a picture; it as a PNG.
    ///
    /// # Errors
    ///
    /// As [`Picture::png`]; a picture of another size than those before.
    pub fn add(&mut self, picture: &Picture) -> Result<Vec<u8>, PictureError> {
        let image = picture.image()?;
        let bad = |what: &str| PictureError(what.to_owned());
        let side = |pixels: usize| u16::try_from(pixels).map_err(|_| bad("a film has at most 65535 pixels to a side"));
        let size = [side(image.width)?, side(image.height)?];
        if !self.frames.is_empty() && self.size != size {
            return Err(bad("the pictures of a film have one size"));
        }
        self.size = size;
        self.frames.push(codes(&image));
        png::encode(&image).map_err(|error| PictureError(error.to_string()))
    }

    /// How many pictures it has.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Writes an animated GIF that begins anew at its end; the same pictures give the same bytes. All have one palette of 256 colours.
    ///
    /// # Errors
    ///
    /// [`WriteError::System`]; [`WriteError::Content`] without pictures.
    pub fn write_gif(&self, path: impl AsRef<Path>, frames_per_second: f64) -> Result<(), WriteError> {
        let path = path.as_ref();
        let bad = |what: String| WriteError::Content {
            file: path.to_owned(),
            what,
            advice: "see the film's pictures".to_owned(),
        };
        if self.is_empty() {
            return Err(bad("the film has no pictures".to_owned()));
        }
        let bytes = self.gif(frames_per_second).map_err(|error| bad(error.to_string()))?;
        write_atomically(path, |out| out.write_all(&bytes))
    }

    fn gif(&self, frames_per_second: f64) -> Result<Vec<u8>, gif::EncodingError> {
        let palette = Palette::of(self.frames.iter().flatten().copied());
        let [width, height] = self.size;
        let mut out = Vec::new();
        let mut encoder = gif::Encoder::new(&mut out, width, height, &palette.bytes())?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        // in hundredths of a second; programs take less than two for none
        let delay = (100.0 / frames_per_second).round().clamp(2.0, 6000.0) as u16;
        for frame in &self.frames {
            let indices: Vec<u8> = frame.iter().map(|code| palette.index(*code)).collect();
            let mut frame = gif::Frame::from_indexed_pixels(width, height, indices, None);
            frame.delay = delay;
            encoder.write_frame(&frame)?;
        }
        drop(encoder);
        Ok(out)
    }
}

fn codes(image: &Image) -> Vec<u16> {
    let mut last = ([0.0; 3], code(colour::to_srgb([0.0; 3]).0));
    let of = |pixel: &colour::Linear| {
        // Neighbours are often equal, and powers are slow.
        if *pixel != last.0 {
            last = (*pixel, code(colour::to_srgb(*pixel).0));
        }
        last.1
    };
    image.pixels.iter().map(of).collect()
}
