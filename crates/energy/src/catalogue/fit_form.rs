//! [`FitForm`]: how the parameters of a law are fitted to tests.

use crate::network::{Network, NetworkInput, NetworkLayer};

/// How the parameters of a law are fitted to tests of a material that keeps its volume, the bulk modulus apart: the numbers that a fit
/// moves, where it begins, and what the law is at rest. With G the neo-Hookean shear modulus of the data and R the largest `I1 - 3` in them.
#[derive(Clone, Copy, Debug)]
pub struct FitForm {
    /// What its name has beside that of the law: `_2` of two terms.
    pub suffix: &'static str,
    /// The parameters of shape.
    pub numbers: &'static [FitNumber],
    /// What couples them, after each was made of its free number.
    pub couple: Option<fn(&mut [f64])>,
    /// Families of fibres in the plane of axes 1 and 2: none, one (`fiber`) along axis 1, or two (`fiber`, `fiber2`) at plus and minus the last
    /// number, an angle in degrees.
    pub families: usize,
    /// Where the bulk modulus goes.
    pub volume: FitVolume,
    /// Shear modulus at rest, across the fibres, Pa; that of the law itself if `None`, of which the first parameter is a measure.
    pub shear: Option<fn(&[f64]) -> f64>,
    /// What fibres add to it along them, of a law that is not isotropic at rest.
    pub along: Option<fn(&[f64]) -> f64>,
    /// Where to begin.
    pub starts: FitStarts,
    /// Whether it is compared with others only where it is named.
    pub named_only: bool,
    /// Of a network: its shape, whose numbers these are.
    pub network: Option<NetworkShape>,
}

/// The inputs of a network and the units of its hidden layers, which have no weights from the inputs but in the first. Its numbers are, layer by layer, those of `through` or `before`
/// row by row and `bias`; those of the last layer, in Pa, have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkShape {
    /// x.
    pub inputs: &'static [NetworkInput],
    /// Units by layer.
    pub units: &'static [usize],
}

/// A parameter that a fit finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitNumber {
    /// Its key in case files, or `fiber_angle`.
    pub name: &'static str,
    /// How it is made of a free number.
    pub free: Free,
}

/// An admissible parameter of a free number x, smoothly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Free {
    /// `factor G e^x`, a modulus that must be positive.
    Modulus {
        /// The factor.
        factor: f64,
    },
    /// `factor G / R^power x^2`, one that may vanish.
    Square {
        /// The factor.
        factor: f64,
        /// Of R.
        power: i32,
    },
    /// `least (1 + e^x)`, above 1 or, with `reach`, above R.
    Above {
        /// Whether `least` is R, and not 1.
        reach: bool,
    },
    /// `e^x / R^2`.
    PerReach,
    /// `x^2 / R^power`, a pure number that may vanish.
    Weight {
        /// Of R.
        power: i32,
    },
    /// x.
    Any,
    /// `e^x` or `-e^x`: the sign is one of the start.
    Power,
    /// `(1 - cos x)/6`, 0 to 1/3.
    Dispersion,
    /// Degrees from 0 to 90: of the families at x and -x.
    Angle,
}

/// Where the bulk modulus K of a law goes.
#[derive(Clone, Copy, Debug)]
pub struct FitVolume {
    /// The key in case files.
    pub key: &'static str,
    /// Its value, of the parameters of shape and K.
    pub value: fn(&[f64], f64) -> f64,
    /// The K that the parameters of shape give already; the value then depends on them.
    pub least: Option<fn(&[f64]) -> f64>,
}

/// Where a fit begins.
#[derive(Clone, Copy, Debug)]
pub enum FitStarts {
    /// At these free numbers.
    At(&'static [&'static [f64]]),
    /// At moduli and powers, in turn: first at 2, -2, 5, 1, then at random.
    Powers,
    /// Of a network, at random.
    Random,
}

impl FitVolume {
    /// K itself, as `bulk`.
    pub const BULK: Self = FitVolume { key: "bulk", value: |_, bulk| bulk, least: None };
    /// `d1 = 2/K`.
    pub const D1: Self = FitVolume { key: "d1", value: |_, bulk| 2.0 / bulk, least: None };
}

impl FitForm {
    /// Of numbers that are not coupled, without fibres, with the key `bulk`; the shear modulus at rest is that of the law itself.
    pub const fn new(numbers: &'static [FitNumber], starts: FitStarts) -> Self {
        let (couple, shear, along) = (None, None, None);
        let volume = FitVolume::BULK;
        let (named_only, network) = (false, None);
        FitForm { suffix: "", numbers, couple, families: 0, volume, shear, along, starts, named_only, network }
    }
}

impl FitNumber {
    /// A modulus that must be positive, `factor G e^x`.
    pub const fn modulus(name: &'static str, factor: f64) -> Self {
        FitNumber { name, free: Free::Modulus { factor } }
    }

    /// A modulus that may vanish, `factor G / R^power x^2`.
    pub const fn square(name: &'static str, factor: f64, power: i32) -> Self {
        FitNumber { name, free: Free::Square { factor, power } }
    }

    /// Any other.
    pub const fn new(name: &'static str, free: Free) -> Self {
        FitNumber { name, free }
    }
}

impl NetworkShape {
    /// The network of its numbers, and the factor of the last layer (Pa), by which that is divided: the shear modulus at rest where there is one.
    pub fn network(&self, numbers: &[f64]) -> (Network, f64) {
        let mut rest = numbers;
        let mut take = |count: usize| {
            let (own, others) = rest.split_at(count.min(rest.len()));
            rest = others;
            own
        };
        let mut layers = Vec::new();
        let mut columns = self.inputs.len();
        for &units in self.units {
            let rows: Vec<Vec<f64>> = take(units * columns).chunks(columns).map(<[f64]>::to_vec).collect();
            let (through, before) = if layers.is_empty() { (rows, vec![]) } else { (vec![], rows) };
            layers.push(NetworkLayer { through, before, bias: take(units).to_vec() });
            columns = units;
        }
        layers.push(NetworkLayer { before: vec![take(columns).to_vec()], ..NetworkLayer::default() });
        let mut network = Network { inputs: self.inputs.to_vec(), layers };
        let shear = network.shear();
        let scale = if shear > 0.0 && shear.is_finite() { shear } else { 1.0 };
        if let Some(last) = network.layers.last_mut() {
            last.before.iter_mut().flatten().for_each(|weight| *weight /= scale);
        }
        (network, scale)
    }
}
