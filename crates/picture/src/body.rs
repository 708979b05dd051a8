//! [`Body`]: what is drawn, and how it looks.

use super::colour::Colour;
use nastic_mesh::{Mesh, Snapshot};
use std::sync::Arc;

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
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) values: FieldValues,
    pub(crate) range: Option<(f64, f64)>,
    /// Whether values of other pictures lie beyond.
    pub(crate) beyond: [bool; 2],
}

#[derive(Clone, Debug)]
pub(crate) enum FieldValues {
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

    pub(crate) fn values(&self) -> &[f64] {
        match &self.values {
            FieldValues::Nodes(values) | FieldValues::Cells(values) => values,
        }
    }
}

/// A mesh at some position, with its name in the legend.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) label: String,
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) appearance: Appearance,
    pub(crate) lines: bool,
    pub(crate) arrows: Vec<Arrows>,
    pub(crate) polylines: Vec<(Colour, Vec<[f64; 3]>)>,
    pub(crate) part: Option<Vec<bool>>,
    pub(crate) plane: Option<([f64; 3], f64)>,
}

/// Vectors drawn as arrows.
#[derive(Clone, Debug)]
pub(crate) struct Arrows {
    pub(crate) colour: Colour,
    /// One per cell, drawn from its centre.
    pub(crate) vectors: Vec<[f64; 3]>,
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
