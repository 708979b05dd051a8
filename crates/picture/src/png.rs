//! Pixels to PNG bytes.

use super::colour::to_srgb;
use super::raster::Image;

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::with_capacity(3 * image.pixels.len());
    let mut last = ([0.0; 3], to_srgb([0.0; 3]));
    for pixel in &image.pixels {
        // Neighbours are often equal, and powers are slow.
        if *pixel != last.0 {
            last = (*pixel, to_srgb(*pixel));
        }
        bytes.extend(last.1.0);
    }
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(out)
}
