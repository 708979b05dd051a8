//! STL: a closed surface, for slicers and printers.

use crate::atomic::write_atomically;
use crate::error::WriteError;
use nastic_mesh::ClosedSurface;
use std::path::Path;

/// Bytes of the text before the number of triangles.
const HEADER_BYTES: usize = 80;

/// Writes a surface in the binary form, little-endian: 80 bytes of text, the number of triangles, of each its normal, its corners (single precision) and two bytes
/// of zero. Coordinates are multiplied by `scale`: the format has no unit, and slicers take millimetres.
///
/// # Errors
///
/// [`WriteError::System`]; [`WriteError::Content`] for a coordinate that is not finite.
pub fn write_stl(path: impl AsRef<Path>, surface: &ClosedSurface, scale: f64) -> Result<(), WriteError> {
    let path = path.as_ref();
    if let Some(point) = surface.points.iter().find(|point| !point.iter().all(|x| (*x * scale).is_finite())) {
        return Err(WriteError::content(path, format!("a point is {point:?}"), "coordinates must be finite"));
    }
    let mut text = [b' '; HEADER_BYTES];
    // a text that begins with "solid" would be the form in words
    text.iter_mut().zip(b"nastic: a closed surface").for_each(|(to, from)| *to = *from);
    write_atomically(path, |out| {
        out.write_all(&text)?;
        out.write_all(&(surface.triangles.len() as u32).to_le_bytes())?;
        for triangle in &surface.triangles {
            let corners = triangle.map(|k| surface.points[k as usize].map(|x| x * scale));
            for x in std::iter::once(normal(&corners)).chain(corners).flatten() {
                out.write_all(&(x as f32).to_le_bytes())?;
            }
            out.write_all(&[0; 2])?;
        }
        Ok(())
    })
}

/// The unit normal by the right hand; zero of a triangle without an area.
fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|x| [0, 1, 2].map(|k| x[k] - a[k]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|n| n * n).sum::<f64>().sqrt();
    n.map(|n| if length > 0.0 { n / length } else { 0.0 })
}
