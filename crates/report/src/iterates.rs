//! [`Iterates`]: shapes and controls of the accepted iterations of an optimisation, on the surface of the body.

use crate::carried::carried;
use crate::surface::BodySurface;
use nastic_mesh::{NamedArray, Snapshot};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use thiserror::Error;

/// Iterations that are kept at most.
const MOST: usize = 60;
/// Of the format.
const FORMAT: &str = "nastic-iterates-1";

/// Accepted iterations: every `s`-th, where `s` is the smallest power of two that leaves at most 60 of them. Which ones
/// are kept follows from the number of the last alone.
///
/// As bytes: a line of JSON, `{ "format", "nodes", "fields": [ { "name", "on", "components" } ], "iterations" }`, then
/// for every iteration, as little-endian floats of 32 bits, the positions of the surface nodes and the fields in their
/// order. The surface nodes are those of boundary faces (all nodes of a plane mesh), ascending; values of fields on
/// "faces" belong to the cell of each boundary face, faces sorted by the name of their kind.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Iterates {
    nodes: usize,
    fields: Vec<IterateField>,
    records: Vec<(usize, Vec<f32>)>,
}

/// A field that every iteration has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct IterateField {
    pub name: String,
    /// By surface node, else by face.
    pub on_nodes: bool,
    pub components: usize,
    /// Nodes or faces.
    entities: usize,
}

/// Why bytes are no iterates.
#[derive(Clone, PartialEq, Debug, Error)]
#[error("not the iterates of an optimisation: {0}")]
pub struct IteratesError(String);

impl Iterates {
    /// Whether this iteration is kept, now that it is the last.
    #[must_use]
    pub fn wants(iteration: usize) -> bool {
        iteration.is_multiple_of(stride(iteration))
    }

    /// Adds an iteration if it is kept, and gives up those that are not any more. The snapshot holds `displacement` and
    /// the control fields; vectors of the fields named here are carried with the body.
    pub fn add(&mut self, iteration: usize, shot: &Snapshot, material: &[String]) {
        let stride = stride(iteration);
        self.records.retain(|(known, _)| known.is_multiple_of(stride) && *known < iteration);
        if !Self::wants(iteration) {
            return;
        }
        let surface = BodySurface::of(&shot.mesh);
        let cells = surface.cells();
        self.describe(shot, &surface, cells.len());
        let positions = shot.positions();
        let mut values: Vec<f32> =
            surface.nodes.iter().flat_map(|node| positions[*node as usize].map(|x| x as f32)).collect();
        for field in &self.fields {
            let arrays = if field.on_nodes { &shot.point_data } else { &shot.cell_data };
            let Some(array) = arrays.iter().find(|array| array.name == field.name) else { continue };
            let entities = if field.on_nodes { &surface.nodes } else { &cells };
            let is_carried = array.components == 3 && !field.on_nodes && material.contains(&field.name);
            for entity in entities {
                match array.at(*entity as usize) {
                    &[x, y, z] if is_carried => {
                        let image = carried(&shot.mesh, &positions, *entity, [x, y, z]);
                        values.extend(image.map(|x| x as f32));
                    }
                    other => values.extend(other.iter().map(|x| *x as f32)),
                }
            }
        }
        self.records.push((iteration, values));
    }

    fn describe(&mut self, shot: &Snapshot, surface: &BodySurface, faces: usize) {
        self.nodes = surface.nodes.len();
        let of = |array: &NamedArray, on_nodes: bool| IterateField {
            name: array.name.clone(),
            on_nodes,
            components: array.components,
            entities: if on_nodes { surface.nodes.len() } else { faces },
        };
        let at_nodes = shot.point_data.iter().filter(|array| array.name != "displacement");
        self.fields = at_nodes.map(|array| of(array, true)).collect();
        self.fields.extend(shot.cell_data.iter().map(|array| of(array, false)));
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The kept iterations.
    #[must_use]
    pub fn iterations(&self) -> Vec<usize> {
        self.records.iter().map(|record| record.0).collect()
    }

    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    pub(crate) fn fields(&self) -> &[IterateField] {
        &self.fields
    }

    /// Positions of the nodes of a kept iteration, then the values of every field.
    pub(crate) fn parts(&self, index: usize) -> Vec<Vec<f64>> {
        let Some((_, values)) = self.records.get(index) else { return Vec::new() };
        let mut rest = values.as_slice();
        let lengths = self.lengths();
        let mut take = |length: usize| {
            let (part, behind) = rest.split_at(length.min(rest.len()));
            rest = behind;
            part.iter().map(|x| f64::from(*x)).collect()
        };
        lengths.into_iter().map(&mut take).collect()
    }

    fn lengths(&self) -> Vec<usize> {
        let fields = self.fields.iter().map(|field| field.entities.saturating_mul(field.components));
        [self.nodes.saturating_mul(3)].into_iter().chain(fields).collect()
    }

    /// The content of `iterates.bin`.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let field = |field: &IterateField| {
            let (on, count) = (if field.on_nodes { "nodes" } else { "faces" }, field.entities);
            json!({ "name": field.name, "on": on, "count": count, "components": field.components })
        };
        let fields: Vec<Value> = self.fields.iter().map(field).collect();
        let head = json!({
            "format": FORMAT, "nodes": self.nodes, "fields": fields, "iterations": self.iterations(),
        });
        let mut out = format!("{head}\n").into_bytes();
        self.records.iter().for_each(|(_, values)| out.extend(values.iter().flat_map(|x| x.to_le_bytes())));
        out
    }

    /// What [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// # Errors
    /// Bytes that are something else, or incomplete.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, IteratesError> {
        let bad = |what: &str| IteratesError(what.to_owned());
        let end = bytes.iter().position(|byte| *byte == b'\n').ok_or_else(|| bad("no first line"))?;
        let head: Value = serde_json::from_slice(&bytes[..end]).map_err(|error| IteratesError(error.to_string()))?;
        if head["format"] != FORMAT {
            return Err(bad("another format"));
        }
        let count = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok()).ok_or_else(|| bad("no count"));
        let mut out = Self { nodes: count(&head["nodes"])?, ..Self::default() };
        for field in head["fields"].as_array().into_iter().flatten() {
            out.fields.push(IterateField {
                name: field["name"].as_str().unwrap_or_default().to_owned(),
                on_nodes: field["on"] == "nodes",
                components: count(&field["components"])?,
                entities: count(&field["count"])?,
            });
        }
        let length = out.lengths().into_iter().fold(0, usize::saturating_add);
        let iterations: Vec<usize> =
            head["iterations"].as_array().into_iter().flatten().map(count).collect::<Result<_, _>>()?;
        if length.saturating_mul(iterations.len()).saturating_mul(4) != bytes.len() - end - 1 {
            return Err(bad("the numbers of values and of bytes do not agree"));
        }
        let mut words = bytes[end + 1..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        for iteration in iterations {
            out.records.push((iteration, words.by_ref().take(length).collect()));
        }
        Ok(out)
    }
}

/// The smallest power of two that leaves at most [`MOST`] of the iterations from 0 to the last.
fn stride(last: usize) -> usize {
    let mut stride = 1;
    while last / stride >= MOST {
        stride *= 2;
    }
    stride
}
