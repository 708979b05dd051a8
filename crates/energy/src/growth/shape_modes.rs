use std::sync::Arc;

use nastic_tensor::{HyperDual, Mat3};

use super::StrainMap;
use super::strain_map::{entries, identity, strain_map_alone};
use crate::slot::lasting;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// A displacement field phi of the drawn body, along which its shape changes.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeMode {
    /// Its name, that of the control of its amplitude.
    pub name: String,
    /// `grad phi`, 1/m.
    pub gradient: Field<Mat3>,
    /// phi at the nodes of the mesh, a pure number per component, flat; empty where no mesh is known.
    pub nodal: Arc<[f64]>,
}

/// The shape of the body itself: the nodes of the drawn body move by `s = sum_k a_k phi_k(X)`, and `X' = X + s` is what is free of stress.
///
/// **Map.** `G = 1 + sum_k a_k grad phi_k`, a compatible growth: with the displacement U from the drawn body, `x = X + U`, the laws see `F G^-1 = dx/dX'` and answer
/// for the volume `det G dX = dX'`, exactly as those of a body that is drawn as X'. What looks at x needs nothing new.
///
/// **Domain.** `det G` above a bound (0.1 unless another one is given).
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** The modes; controls are their amplitudes a in m, each one number for the body: numbers of the body itself, which do not ramp with loads.
///
/// **Source.** J. Haslinger, R. A. E. Mäkinen, "Introduction to Shape Optimization", SIAM (2003), ch. 3 (maps from a fixed body); the exactness on isoparametric elements
/// is that of the chain rule.
#[derive(Clone, Debug)]
pub struct ShapeModes {
    modes: Vec<ShapeMode>,
    slots: Vec<Slot>,
    least_volume: f64,
}

impl ShapeModes {
    /// Name in case files.
    pub const NAME: &str = "shape";
    /// The bound of det G where none is given: a tenth of every volume is left.
    pub const LEAST_VOLUME: f64 = 0.1;
    /// What is said of a change beyond that bound.
    pub(super) const LIMIT: &str = "the change of shape turns cells over or leaves less of their volume than the least share: make it smaller, or draw the body nearer to it";

    /// Of modes by name.
    ///
    /// # Errors
    /// [`EnergyError::ShapeModes`] of none, of two of one name, of one without a finite gradient or that moves nothing.
    pub fn new(modes: Vec<ShapeMode>) -> Result<Self, EnergyError> {
        let refuse = |why: String| Err(EnergyError::ShapeModes { why });
        if modes.is_empty() {
            return refuse("there is none".to_owned());
        }
        for (k, mode) in modes.iter().enumerate() {
            if modes[..k].iter().any(|other| other.name == mode.name) {
                return refuse(format!("two are named \"{}\"", mode.name));
            }
            let numbers = || {
                mode.gradient.entries().flat_map(|(_, g)| <[f64; 9]>::try_from(g.as_slice()).unwrap_or([f64::NAN; 9]))
            };
            if numbers().chain(mode.nodal.iter().copied()).any(|value| !value.is_finite()) {
                return refuse(format!("\"{}\" has values that are not finite", mode.name));
            }
            if numbers().all(|value| value == 0.0) {
                return refuse(format!("\"{}\" changes no shape: it is the same at all nodes", mode.name));
            }
        }
        let slots = modes.iter().map(|mode| Self::slot(&mode.name)).collect();
        Ok(ShapeModes { modes, slots, least_volume: Self::LEAST_VOLUME })
    }

    /// With a bound of det G, from 0 to below 1.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] of another one.
    pub fn with_least_volume(self, least: f64) -> Result<Self, EnergyError> {
        Self::check_least_volume(least)?;
        Ok(ShapeModes { least_volume: least, ..self })
    }

    pub(super) fn check_least_volume(least: f64) -> Result<(), EnergyError> {
        let (is_share, why) = (|least| (0.0..1.0).contains(&least), "it must be at least 0 and below 1");
        Field::Uniform(least).require(Self::NAME, "least_volume", is_share, why)
    }

    /// The slot of the amplitude of a mode.
    pub fn slot(name: &str) -> Slot {
        Slot::design(lasting(name), "m", 0.0).global()
    }
}

impl StrainMap for ShapeModes {
    fn tensor(&self, at: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let zero = HyperDual::constant(0.0);
        entries(|i, j| {
            let of_mode = |(mode, a): (&ShapeMode, &HyperDual)| *a * HyperDual::constant(mode.gradient.at(at)[(i, j)]);
            let change = self.modes.iter().zip(slots).map(of_mode).fold(zero, |sum, own| sum + own);
            identity(i, j) + change
        })
    }

    fn limit(&self) -> &'static str {
        Self::LIMIT
    }

    fn owner(&self) -> &'static str {
        Self::NAME
    }

    fn least_volume(&self) -> f64 {
        self.least_volume
    }

    fn shape(&self) -> &[ShapeMode] {
        &self.modes
    }
}

/// It has no energy of its own.
impl EnergyTerm for ShapeModes {
    strain_map_alone!();

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.modes.iter().try_for_each(|mode| mode.gradient.check_len(Self::NAME, "modes", cells, points))
    }
}
