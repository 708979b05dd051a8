//! [`Survey`]: what several pictures have in common, so that they have one view, one scale and one range of colours.

use super::check;
use super::colour_range::{ColourRange, ColourValues};
use super::picture::{Picture, PictureError};
use super::scene::seen_points;
use super::vector::{V3, dot};

/// Points that are kept of one picture beside those that lie farthest out.
const KEPT: usize = 4000;

/// The points and the values of several pictures.
///
/// ```
/// use nastic_picture::{Body, Picture, Survey};
/// use nastic_mesh::{CellKind, box_mesh};
///
/// # let out = tempfile::tempdir()?;
/// let of = |length| Ok::<_, Box<dyn std::error::Error>>(Picture::new("").body(Body::new("bar", box_mesh([length, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?)));
/// let frames = [of(0.5)?, of(2.0)?];
/// let mut survey = Survey::default();
/// for frame in &frames {
///     survey.add(frame)?;
/// }
/// for (k, frame) in frames.into_iter().enumerate() {
///     frame.surveyed(&survey).write(out.path().join(format!("frame_{k}.png")))?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Survey {
    points: Vec<V3>,
    values: ColourValues,
}

impl Survey {
    /// Adds a picture.
    ///
    /// # Errors
    ///
    /// A picture that cannot be drawn.
    pub fn add(&mut self, picture: &Picture) -> Result<(), PictureError> {
        check::check(picture).map_err(PictureError)?;
        let points = seen_points(picture);
        let stride = points.len().div_ceil(KEPT).max(1);
        self.points.extend(points.iter().step_by(stride));
        if stride > 1 {
            self.points.extend(outermost(&points));
        }
        let mut values = ColourValues::default();
        picture.bodies.iter().for_each(|body| values.add(body));
        self.values.join(&values);
        Ok(())
    }

    /// The range of colours of all pictures.
    pub fn colours(&self) -> Option<ColourRange> {
        self.values.range()
    }

    pub(super) fn points(&self) -> &[V3] {
        &self.points
    }

    pub(super) fn values(&self) -> &ColourValues {
        &self.values
    }
}

/// The points that lie farthest in the directions to the faces, edges and corners of a cube.
fn outermost(points: &[V3]) -> impl Iterator<Item = V3> {
    let directions = (0..27).filter(|k| *k != 13).map(|k| [k / 9, k / 3 % 3, k % 3].map(|d| f64::from(d) - 1.0));
    directions.filter_map(|direction| {
        let along = |point: &&V3| dot(**point, direction);
        points.iter().max_by(|a, b| along(a).total_cmp(&along(b))).copied()
    })
}
