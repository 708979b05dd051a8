use super::WeightKind;

/// Why numbers are no network whose energy is polyconvex. Layers, rows and columns count from 0, as in the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// A weight below zero.
    #[error(
        "layers[{layer}].{kind}[{row}][{column}] = {value:e}, but it must not be negative: the energy would not be polyconvex (train squares, or \
         softplus, of free numbers); weights of J alone, `through`, may be"
    )]
    Negative {
        /// The layer.
        layer: usize,
        /// Which of its matrices.
        kind: WeightKind,
        /// The unit.
        row: usize,
        /// The input, or the unit of the layer before.
        column: usize,
        /// The weight found.
        value: f64,
    },
    /// A weight or a bias that is no number.
    #[error("layers[{layer}].{kind}{entry} is {value}: a finite number is wanted")]
    NotFinite {
        /// The layer.
        layer: usize,
        /// Which of its numbers.
        kind: WeightKind,
        /// `[row][column]`, `[row]` of a bias.
        entry: String,
        /// What was found.
        value: f64,
    },
    /// A matrix or a bias of another size.
    #[error("layers[{layer}].{kind}{entry} has {found} entries, but {expected} are wanted: {why}")]
    Size {
        /// The layer.
        layer: usize,
        /// Which of its numbers.
        kind: WeightKind,
        /// `[row]`, nothing of the whole.
        entry: String,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
        /// One for each of what.
        why: &'static str,
    },
    /// No input, or no layer.
    #[error("a network has one input and one layer at least, this has {inputs} and {layers}")]
    Empty {
        /// How many inputs.
        inputs: usize,
        /// How many layers.
        layers: usize,
    },
    /// More than anybody evaluates at every point of a body.
    #[error("layers[{layer}] has {units} units; at most {most}")]
    TooWide {
        /// The layer.
        layer: usize,
        /// Its units.
        units: usize,
        /// How many it may have.
        most: usize,
    },
    /// An input twice.
    #[error("inputs: \"{name}\" stands there twice")]
    Twice {
        /// Its name.
        name: &'static str,
    },
    /// Inputs of a network with and of one without a split of the volume.
    #[error(
        "inputs: \"{isochoric}\" is free of the change of volume, \"{other}\" is not: take either I1b, I2b^1.5, I4b, I5b^1.5 or I1, I2, J, I4, I5"
    )]
    Mixed {
        /// One of the first kind.
        isochoric: &'static str,
        /// One of the second.
        other: &'static str,
    },
    /// An input of fibres, and none are given.
    #[error("inputs: \"{name}\" is one of a fibre, and no \"fiber\" is given")]
    NoFiber {
        /// The input.
        name: &'static str,
    },
    /// A fibre that no input knows.
    #[error("a \"fiber\" is given, but no input of the network is one of fibres: I4b, I5b^1.5, or I4, I5")]
    UnusedFiber,
    /// An energy that does not change with the shape.
    #[error(
        "the network gives no shear stiffness at rest ({shear:e} times its scale): weights that lead from I1b, I2b^1.5, I1 or I2 to the last layer vanish"
    )]
    NoShear {
        /// The shear modulus at rest over the scale.
        shear: f64,
    },
}

impl NetworkError {
    /// Keys and indices that lead from a network to what is wrong, as in its file.
    pub fn path(&self) -> Vec<String> {
        let layers = |layer: &usize| vec!["layers".to_owned(), layer.to_string()];
        match self {
            NetworkError::Negative { layer, kind, row, column, .. } => {
                [layers(layer), vec![kind.to_string(), row.to_string(), column.to_string()]].concat()
            }
            NetworkError::NotFinite { layer, kind, entry, .. } | NetworkError::Size { layer, kind, entry, .. } => {
                let indices = entry.split(['[', ']']).filter(|index| !index.is_empty()).map(str::to_owned);
                layers(layer).into_iter().chain([kind.to_string()]).chain(indices).collect()
            }
            NetworkError::TooWide { layer, .. } => layers(layer),
            NetworkError::Twice { .. } | NetworkError::Mixed { .. } => vec!["inputs".to_owned()],
            _ => vec![],
        }
    }
}
