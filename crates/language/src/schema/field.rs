//! Values that may vary over the body.

use crate::expression::{EvaluationError, Formula};
use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of, vector};
use crate::schema::read::{Read, Reader};
use crate::schema::value::entries;
use crate::syntax::{At, Node, Value};
use serde_json::Value as Json;
use std::sync::Arc;

object! {
    /// An array of a VTU file on the same mesh, in the case's units: one value per cell or per node.
    pub struct ArrayFile {
        /// The file, relative to the case.
        pub file: String,
        /// Name of the array.
        pub array: String,
    }
}

/// A scalar: a constant, a formula of X, Y, Z, or an array of a file.
#[derive(Clone, PartialEq, Debug)]
pub enum Parameter {
    /// A number or formula.
    Formula(Formula),
    /// From a file.
    Array(ArrayFile),
    /// One value per cell of the mesh: what a random field makes of a parameter, not for cases to write.
    Cells(Arc<[f64]>),
}

/// As written.
impl std::fmt::Display for Parameter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Formula(formula) => f.write_str(formula.text()),
            Self::Array(file) => write!(f, "array {} of {}", file.array, file.file),
            Self::Cells(_) => f.write_str("by cell"),
        }
    }
}

impl Parameter {
    /// The value, if it is the same everywhere.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Formula(formula) => formula.constant(),
            Self::Array(_) | Self::Cells(_) => None,
        }
    }
}

impl Parameter {
    /// Whether it changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        matches!(self, Self::Formula(formula) if formula.uses_time())
    }
}

impl Read for Parameter {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Object(_) => ArrayFile::read(node, at, want, reader).map(Self::Array),
            _ => Formula::read(node, at, want, reader).map(Self::Formula),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![Formula::schema(want, definitions), ArrayFile::schema(want, definitions)])
    }
}

/// A vector: two or three numbers or formulas, or an array of a file.
#[derive(Clone, PartialEq, Debug)]
pub enum VectorField {
    /// Two or three entries.
    Formulas(Vec<Formula>),
    /// From a file.
    Array(ArrayFile),
}

/// The vector of two or three formulas at a reference point; a third entry left out is zero.
///
/// # Errors
///
/// The first entry without a finite value there.
pub fn vector_at(entries: &[Formula], point: [f64; 3]) -> Result<[f64; 3], EvaluationError> {
    let mut out = [0.0; 3];
    for (value, entry) in out.iter_mut().zip(entries) {
        *value = entry.at(point)?;
    }
    Ok(out)
}

impl VectorField {
    /// The vector, if it is the same everywhere; a third entry left out is zero.
    #[must_use]
    pub fn constant(&self) -> Option<[f64; 3]> {
        let Self::Formulas(entries) = self else { return None };
        let mut out = [0.0; 3];
        for (value, entry) in out.iter_mut().zip(entries) {
            *value = entry.constant()?;
        }
        Some(out)
    }
}

impl Read for VectorField {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Object(_) => ArrayFile::read(node, at, want, reader).map(Self::Array),
            _ => entries(node, at, want, reader).map(Self::Formulas),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![vector::<Formula>(want, definitions), ArrayFile::schema(want, definitions)])
    }
}

/// Complains about a constant direction that is no unit vector.
pub(crate) fn check_unit(direction: &VectorField, at: &At, reader: &mut Reader<'_>) {
    let Some([x, y, z]) = direction.constant() else { return };
    let norm = x.hypot(y).hypot(z);
    if (norm - 1.0).abs() <= UNIT_TOLERANCE {
        return;
    }
    let message = if norm > 0.0 {
        let [x, y, z] = [x, y, z].map(|entry| entry / norm);
        format!("a direction must have length 1, this has {norm}: write [{x:.9}, {y:.9}, {z:.9}]")
    } else {
        "a direction must have length 1, this has 0".to_string()
    };
    reader.complain_at(at, message);
}

/// Eight typed digits are a unit vector.
const UNIT_TOLERANCE: f64 = 1e-6;
