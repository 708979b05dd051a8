//! [`LumenVolume`]: the volume that a surface encloses.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output, Partials, check_weight,
};
use nastic_fem::{Lumen, Solid};
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use std::sync::Arc;

/// `j = (weight/2) (V - volume)^2` with the volume V that the deformed named surface encloses, openings closed by lids ([`Lumen`]): of a lumen, a chamber
/// that nothing fills, a bladder.
///
/// Derivatives: `dj/du [v] = weight (V - volume) dV/du [v]`, `d2j/du2 [v, w] = weight (dV/du [v] dV/du [w] + (V - volume) d2V/du2 [v, w])`; V is cubic in u.
/// Units: volume^2 times the weight's; in plane strain per unit of thickness, an area. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct LumenVolume {
    surface: GroupNames,
    volume: f64,
    weight: f64,
}

impl LumenVolume {
    /// Behind a named surface, or the union of several.
    pub fn behind(surface: impl Into<GroupNames>, volume: f64) -> Self {
        LumenVolume { surface: surface.into(), volume, weight: 1.0 }
    }

    /// Multiplies the cost.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "volume",
    "weight/2 (V - volume)^2, V the volume that a surface encloses, openings closed by lids.",
    &[
        Key::SURFACE,
        Key::new(
            "volume",
            "The volume that is wanted; in plane strain a plain number, the area.",
            KeyKind::Number { unit: "m^3", default: None },
        ),
    ],
    |on| {
        let (surface, volume) = (on.get("surface")?, on.get("volume")?);
        LumenVolume { surface, volume, weight: on.weight }.bind(on.solid)
    },
)
.square()
.reported_at("surface")
.words(|words| format!("weight/2 (volume behind {} - {})^2", words.place(), words.text("volume")));

impl IntoCost for LumenVolume {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("volume", self.weight)?;
        if !self.volume.is_finite() {
            let what = "the volume of a cost \"volume\" is not finite".to_owned();
            return Err(ControlError::Cost { what });
        }
        let lumen =
            Lumen::new(solid.mesh(), self.surface).map_err(|error| ControlError::Cost { what: error.to_string() })?;
        Ok(Box::new(OnBody { lumen: Arc::new(lumen), wanted: self.volume, weight }))
    }
}

/// [`LumenVolume`] bound to a body.
#[derive(Debug)]
struct OnBody {
    lumen: Arc<Lumen>,
    wanted: f64,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "volume"
    }

    fn numbers(&self) -> Option<usize> {
        Some(1)
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let volume = self.lumen.volume(Some(at.u));
        let (lumen, gap) = (self.lumen.clone(), volume - self.wanted);
        let unit = if at.solid.mesh().dim() == 2 { "m^2" } else { "m^3" };
        Ok(Arc::new(EvaluatedCost { lumen, u: at.u.to_vec(), volume, unit, gap, weight: self.weight }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    lumen: Arc<Lumen>,
    u: Vec<f64>,
    volume: f64,
    unit: &'static str,
    gap: f64,
    weight: f64,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.weight * self.gap * self.gap
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.lumen.add_gradient(&self.u, self.weight * self.gap, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let mut gradient = vec![0.0; self.u.len()];
        self.lumen.add_gradient(&self.u, 1.0, &mut gradient);
        let change: f64 = gradient.iter().zip(&along.u).map(|(g, v)| g * v).sum();
        out.u.iter_mut().zip(&gradient).for_each(|(out, g)| *out += self.weight * change * g);
        self.lumen.add_hessian_product(&self.u, self.weight * self.gap, &along.u, &mut out.u);
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let mut partials = zero.clone();
        self.lumen.add_gradient(&self.u, 1.0, &mut partials.u);
        let output = Output::watched("", self.volume, self.unit, partials);
        Ok(vec![output.aiming(self.volume - self.gap, self.weight)])
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![Figure { kind: FigureKind::Other("enclosed_volume"), value: self.volume, unit: self.unit }])
    }
}
