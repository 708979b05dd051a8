//! Pixels to PNG bytes.

use super::colour::to_srgb;
use super::raster::Image;

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, png::EncodingError> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| to_srgb(*pixel).0).collect();
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
