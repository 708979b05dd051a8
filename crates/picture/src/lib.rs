//! Pictures of deformed bodies, for those who do not have ParaView open: PNG (z-buffer, antialiased) and SVG (painter's
//! algorithm), with legend, colour bar, axes and a scale of lengths; and charts of curves.
//!
//! Colours are mixed in linear light; orthographic projection; the same picture gives the same bytes.

mod arrows;
mod body;
mod camera;
mod chart;
mod check;
mod clip;
mod colour;
mod colour_range;
mod drawing;
mod face;
mod film;
mod frame;
mod layer;
mod paint;
mod palette;
mod path;
mod picture;
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

pub use body::{Appearance, Body, Field};
pub use chart::{Chart, Curve};
pub use colour::Colour;
pub use colour_range::ColourRange;
pub use face::{Face, FacePattern};
pub use film::Film;
pub use picture::{Picture, PictureError, View};
pub use sheet::Sheet;
pub use survey::Survey;
