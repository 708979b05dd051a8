//! [`Picture`]: bodies seen from one place, as they are put together.

use super::body::Body;
use super::colour::Colour;
use super::path::NamedPath;

/// Several bodies seen from one place.
///
/// ```
/// use nastic_picture::{Body, Colour, Appearance, Picture};
/// use nastic_mesh::{CellKind, box_mesh};
///
/// # let out = tempfile::tempdir()?;
/// # let path = out.path().join("bodies.svg");
/// let bar = box_mesh([1.0, 0.2, 0.2], [10, 2, 2], CellKind::Hex27)?;
/// let bent = bar.points().iter().map(|p| [p[0], p[1], p[2] + 0.3 * p[0] * p[0]]).collect();
/// Picture::new("A bar and a bent bar")
///     .body(Body::new("start", bar.clone()).appearance(Appearance::Glass(Colour::GREY)))
///     .body(Body::new("bent", bar).at(bent).appearance(Appearance::Solid(Colour::BLUE)))
///     .write(path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) view: View,
    pub(crate) length_unit: String,
    pub(crate) bodies: Vec<Body>,
    pub(crate) paths: Vec<NamedPath>,
    pub(crate) vectors: Vec<(String, Colour, [f64; 3])>,
    pub(crate) is_plain: bool,
    /// What decides view and scale, in the place of what is drawn.
    pub(crate) framed: Vec<[f64; 3]>,
}

/// Where the eye is.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum View {
    /// Across the plane in which the bodies bend, a little from above; plane meshes from straight above.
    #[default]
    Auto,
    /// The direction from the bodies to the eye; z points up in the picture unless the eye looks along z.
    From([f64; 3]),
}

/// A picture that cannot be drawn: what is wrong with its inputs.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("cannot draw the picture: {0}")]
pub struct PictureError(pub(crate) String);

impl Picture {
    /// An empty picture of 1600 x 1000 pixels.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            subtitle: String::new(),
            width: 1600,
            height: 1000,
            view: View::Auto,
            length_unit: "m".to_owned(),
            bodies: Vec::new(),
            paths: Vec::new(),
            vectors: Vec::new(),
            is_plain: false,
            framed: Vec::new(),
        }
    }

    /// For print: a white ground, and neither title nor subtitle.
    pub fn plain(mut self) -> Self {
        self.is_plain = true;
        self
    }

    /// Draws a vector that is the same everywhere, a field say, as one arrow beside the bodies, with its name.
    pub fn vector(mut self, label: &str, colour: Colour, vector: [f64; 3]) -> Self {
        self.vectors.push((label.to_owned(), colour, vector));
        self
    }

    /// Draws a line through points of space over all bodies, with its name in the legend: the path of a tip, say.
    pub fn path(mut self, label: &str, colour: Colour, points: Vec<[f64; 3]>) -> Self {
        self.paths.push(NamedPath { label: label.to_owned(), colour, is_dashed: false, points });
        self
    }

    /// Draws a dashed line so, over the others: a path that should be followed.
    pub fn dashed_path(mut self, label: &str, colour: Colour, points: Vec<[f64; 3]>) -> Self {
        self.paths.push(NamedPath { label: label.to_owned(), colour, is_dashed: true, points });
        self
    }

    /// Below the title, for numbers that belong to the picture: one line, or several where it is too wide for one and
    /// has parts between semicolons.
    pub fn subtitle(mut self, subtitle: &str) -> Self {
        self.subtitle = subtitle.to_owned();
        self
    }

    /// Width and height in pixels, at least 320 x 200 and at most 16384 each.
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.width = width.clamp(320, 16384);
        self.height = height.clamp(200, 16384);
        self
    }

    /// Chooses the view.
    pub fn view(mut self, view: View) -> Self {
        self.view = view;
        self
    }

    /// The unit of lengths written at the scale; metres unless set.
    pub fn length_unit(mut self, unit: &str) -> Self {
        self.length_unit = unit.to_owned();
        self
    }

    /// Adds a body. Order does not matter to what hides what, only to the legend.
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }
}
