//! Pictures of deformed bodies, for those who do not have ParaView open: PNG (z-buffer, antialiased) and SVG (painter's
//! algorithm), with legend, colour bar, axes and a scale of lengths; and charts of curves.
//!
//! Colours are mixed in linear light; orthographic projection; the same picture gives the same bytes.

mod arrows;
mod camera;
mod chart;
mod check;
mod clip;
mod colour;
mod colour_range;
mod face;
mod film;
mod frame;
mod layer;
mod paint;
mod palette;
mod path;
mod png;
mod polylines;
mod raster;
mod scene;
mod shade;
mod sheet;
mod survey;
mod svg;
mod tessellation;
mod text;
mod triangle;
mod vector;

use std::path::Path;
use std::sync::Arc;

use nastic_mesh::{Mesh, Snapshot};

pub use chart::{Chart, Curve};
pub use colour::Colour;
pub use colour_range::ColourRange;
pub use face::{Face, FacePattern};
pub use film::Film;
use nastic_io::WriteError;
use path::NamedPath;
pub use sheet::Sheet;
pub use survey::Survey;

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
    title: String,
    subtitle: String,
    width: u32,
    height: u32,
    view: View,
    length_unit: String,
    bodies: Vec<Body>,
    paths: Vec<NamedPath>,
    vectors: Vec<(String, Colour, [f64; 3])>,
    is_plain: bool,
    /// What decides view and scale, in the place of what is drawn.
    framed: Vec<[f64; 3]>,
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

/// How a body looks.
#[derive(Clone, Debug)]
pub enum Appearance {
    /// Opaque, in one colour.
    Solid(Colour),
    /// Opaque, coloured by a scalar.
    Field(Field),
    /// Translucent, with its outline.
    Glass(Colour),
    /// Element edges only.
    Wire(Colour),
}

/// A scalar to colour a body by. Its map runs from blue over white to red if it changes sign, else from dark to bright.
#[derive(Clone, Debug)]
pub struct Field {
    name: String,
    unit: String,
    values: FieldValues,
    range: Option<(f64, f64)>,
    /// Whether values of other pictures lie beyond.
    beyond: [bool; 2],
}

#[derive(Clone, Debug)]
enum FieldValues {
    Nodes(Vec<f64>),
    Cells(Vec<f64>),
}

impl Field {
    /// One value per node of the mesh.
    pub fn at_nodes(name: &str, unit: &str, values: Vec<f64>) -> Self {
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: FieldValues::Nodes(values),
            range: None,
            beyond: [false; 2],
        }
    }

    /// One value per cell of the mesh.
    pub fn at_cells(name: &str, unit: &str, values: Vec<f64>) -> Self {
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: FieldValues::Cells(values),
            range: None,
            beyond: [false; 2],
        }
    }

    /// Fixes the range of the colour bar, for pictures that are to be compared; otherwise it is that of the values, or where a hundredth of the area at
    /// either end makes that wider by half, the range without it. The bar is pointed at an end beyond which there are values.
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    fn values(&self) -> &[f64] {
        match &self.values {
            FieldValues::Nodes(values) | FieldValues::Cells(values) => values,
        }
    }
}

/// A mesh at some position, with its name in the legend.
#[derive(Clone, Debug)]
pub struct Body {
    label: String,
    mesh: Arc<Mesh>,
    positions: Vec<[f64; 3]>,
    appearance: Appearance,
    lines: bool,
    arrows: Vec<Arrows>,
    polylines: Vec<(Colour, Vec<[f64; 3]>)>,
    part: Option<Vec<bool>>,
    plane: Option<([f64; 3], f64)>,
}

/// Vectors drawn as arrows.
#[derive(Clone, Debug)]
struct Arrows {
    colour: Colour,
    /// One per cell, drawn from its centre.
    vectors: Vec<[f64; 3]>,
}

impl Body {
    /// A body in its reference position, grey.
    pub fn new(label: &str, mesh: impl Into<Arc<Mesh>>) -> Self {
        let mesh = mesh.into();
        let positions = mesh.points().to_vec();
        Self {
            label: label.to_owned(),
            mesh,
            positions,
            appearance: Appearance::Solid(Colour::GREY),
            lines: true,
            arrows: Vec::new(),
            polylines: Vec::new(),
            part: None,
            plane: None,
        }
    }

    /// The body of a snapshot, moved by its field `displacement`.
    pub fn of(label: &str, snapshot: &Snapshot) -> Self {
        Self::new(label, snapshot.mesh.clone()).at(snapshot.positions())
    }

    /// Puts the nodes elsewhere: one position per node.
    pub fn at(mut self, positions: Vec<[f64; 3]>) -> Self {
        self.positions = positions;
        self
    }

    /// The number of its nodes.
    pub fn nodes(&self) -> usize {
        self.positions.len()
    }

    /// Chooses the appearance.
    pub fn appearance(mut self, appearance: Appearance) -> Self {
        self.appearance = appearance;
        self
    }

    /// Whether element edges are drawn on opaque bodies; they are, unless this says no.
    pub fn lines(mut self, lines: bool) -> Self {
        self.lines = lines;
        self
    }

    /// Draws only the faces all of whose nodes are marked, from both sides: a part of the surface. One mark per node.
    pub fn part(mut self, marked: Vec<bool>) -> Self {
        self.part = Some(marked);
        self
    }

    /// Cuts away what lies beyond the plane `x . normal = offset` in the displaced body, and draws the section through its cells.
    pub fn clip(mut self, normal: [f64; 3], offset: f64) -> Self {
        self.plane = Some((normal, offset));
        self
    }

    /// Draws one vector per cell from the cell's centre, in front of the surface; the longest is about as long as a
    /// cell. Several such fields are drawn over each other.
    pub fn arrows(mut self, colour: Colour, vectors: Vec<[f64; 3]>) -> Self {
        self.arrows.push(Arrows { colour, vectors });
        self
    }

    /// Draws a line through points of space in front of the surface, which it may lie within.
    pub fn polyline(mut self, colour: Colour, points: Vec<[f64; 3]>) -> Self {
        self.polylines.push((colour, points));
        self
    }
}

/// A picture that cannot be drawn: what is wrong with its inputs.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("cannot draw the picture: {0}")]
pub struct PictureError(String);

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

    fn image(&self) -> Result<raster::Image, PictureError> {
        let scene = scene::Scene::new(self).map_err(PictureError)?;
        let frame = frame::Frame::new(self, &scene);
        let mut image = raster::render(&scene, self.width as usize, self.height as usize);
        text::draw(&mut image, &frame.marks);
        Ok(image)
    }

    fn svg(&self) -> Result<String, String> {
        let scene = scene::Scene::new(self)?;
        let frame = frame::Frame::new(self, &scene);
        Ok(svg::draw(self, &scene, &frame.marks))
    }
}
