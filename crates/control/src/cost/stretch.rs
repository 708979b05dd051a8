//! [`LargestStretch`]: a smoothed maximum of the principal stretches over the body.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Partials, check_weight,
};
use nastic_fem::{QuadraturePoints, Solid};
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_tensor::{Kinematics, Mat3};
use std::sync::Arc;

/// `j = weight M`, a power mean of the principal stretches l_1, l_2, l_3 over a region (the body if none is named):
///
/// ```text
/// M = ( 1/(3 |Omega_0|) int (l_1^2p + l_2^2p + l_3^2p) dX )^(1/2p),    sum_k l_k^2p = tr(C^p),    C = F^T F
/// ```
///
/// 1 at rest, never above the largest stretch, and close to it for large p: a share s of the volume that is stretched by l in one
/// direction alone gives M > l (s/3)^(1/2p). `dM/dF = M^(1-2p) / (3 |Omega_0|) F C^(p-1)` at a point. A plain number. Compressions count
/// as stretches below 1, hardly at all. Source: power means, e.g. P. Duysinx & O. Sigmund, AIAA 98-4906 (1998), for stresses;
/// docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct LargestStretch {
    region: Option<GroupNames>,
    exponent: u32,
    weight: f64,
}

/// p where none is given: a uniform stretch of 1.2 along one axis gives 1.17, one of a twentieth of the volume 1.10.
const DEFAULT_EXPONENT: u32 = 24;
/// Largest p: above it C^p of a stretch of 100 overflows.
const MAX_EXPONENT: u32 = 32;

impl Default for LargestStretch {
    fn default() -> Self {
        LargestStretch { region: None, exponent: DEFAULT_EXPONENT, weight: 1.0 }
    }
}

impl LargestStretch {
    /// Over a named region, or the union of several, in place of the body.
    #[must_use]
    pub fn region(mut self, names: impl Into<GroupNames>) -> Self {
        self.region = Some(names.into());
        self
    }

    /// p, 24 if not given.
    #[must_use]
    pub fn exponent(mut self, p: u32) -> Self {
        self.exponent = p;
        self
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
    "largest_stretch",
    "weight times a smoothed maximum of the principal stretches, the power mean of exponent 2p over a region.",
    &[
        Key::REGION.about("Region of the mesh; the body if left out.").optional(),
        Key::new("exponent", "p, from 1 to 32.", KeyKind::Count { default: Some(DEFAULT_EXPONENT) }).optional(),
    ],
    |on| {
        let (region, exponent) = (on.given("region"), on.get("exponent")?);
        LargestStretch { region, exponent, weight: on.weight }.bind(on.solid)
    },
)
.reported_at("exponent")
.words(|words| {
    let (place, exponent) = (words.given("region").unwrap_or("the body"), 2 * u64::from(words.count("exponent")));
    format!("smoothed maximum of the principal stretches of {place}, power mean of exponent {exponent}")
});

impl IntoCost for LargestStretch {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("largest_stretch", self.weight)?;
        if !(1..=MAX_EXPONENT).contains(&self.exponent) {
            let what = format!("the exponent of a largest stretch is {}; take 1 to {MAX_EXPONENT}", self.exponent);
            return Err(ControlError::Cost { what });
        }
        let mesh = solid.mesh();
        let cells = match &self.region {
            Some(names) => mesh.cells_of(names)?,
            None => (0..mesh.cells() as u32).collect(),
        };
        let points = QuadraturePoints::of_cells(mesh, cells, |k| k.rule_of_points(k.order() + 1))?;
        Ok(Box::new(OnBody { points: Arc::new(points), exponent: self.exponent, weight }))
    }
}

/// [`LargestStretch`] bound to a body.
#[derive(Debug)]
struct OnBody {
    points: Arc<QuadraturePoints>,
    exponent: u32,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "largest_stretch"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let kinematics = self.points.kinematics(at.u)?;
        let power =
            |k: &Kinematics| powers(&(k.f().transpose() * k.f()), self.exponent)[self.exponent as usize].trace();
        let sum: f64 = kinematics.iter().zip(self.points.weights()).map(|(k, w)| w * power(k)).sum();
        let mean = sum / (3.0 * self.points.measure());
        let norm = mean.powf(0.5 / f64::from(self.exponent));
        let (points, exponent, weight) = (self.points.clone(), self.exponent, self.weight);
        Ok(Arc::new(EvaluatedCost { points, exponent, weight, kinematics, norm }))
    }
}

/// `C^0 .. C^p`
fn powers(c: &Mat3, p: u32) -> Vec<Mat3> {
    let mut out = vec![Mat3::identity()];
    (0..p as usize).for_each(|k| out.push(out[k] * c));
    out
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    points: Arc<QuadraturePoints>,
    exponent: u32,
    weight: f64,
    kinematics: Vec<Kinematics>,
    /// M
    norm: f64,
}

impl EvaluatedCost {
    /// `M^(1-2p) / (3 |Omega_0|)`
    fn factor(&self) -> f64 {
        self.norm.powi(1 - 2 * self.exponent as i32) / (3.0 * self.points.measure())
    }

    /// `w F C^(p-1)` at every point.
    fn slopes(&self) -> Vec<Mat3> {
        let slope = |(k, w): (&Kinematics, &f64)| {
            let c = k.f().transpose() * k.f();
            k.f() * powers(&c, self.exponent - 1)[self.exponent as usize - 1] * *w
        };
        self.kinematics.iter().zip(self.points.weights()).map(slope).collect()
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.weight * self.norm
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let factor = self.weight * self.factor();
        let stresses: Vec<Mat3> = self.slopes().into_iter().map(|slope| slope * factor).collect();
        self.points.spread_stress(&stresses, &mut out.u);
        Ok(())
    }

    /// With `S = int w F C^(p-1) : .`, `dM = f S`, `f = M^(1-2p) / (3 |Omega_0|)`: `d2M [v] = f dS[v] + (1 - 2p)/M (f S[v]) f S`,
    /// `d(F C^(p-1)) = dF C^(p-1) + F sum_k C^k dC C^(p-2-k)`.
    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let changes = self.points.gradients(&along.u);
        let (slopes, p) = (self.slopes(), self.exponent as usize);
        let factor = self.factor();
        let change = factor * slopes.iter().zip(&changes).map(|(slope, df)| slope.dot(df)).sum::<f64>();
        let shrink = (1.0 - 2.0 * p as f64) / self.norm * change * factor;
        let rows = self.kinematics.iter().zip(self.points.weights()).zip(slopes.iter().zip(&changes));
        let stresses = rows.map(|((k, w), (slope, df))| {
            let f = k.f();
            let dc = df.transpose() * f + f.transpose() * df;
            let c = powers(&(f.transpose() * f), self.exponent - 1);
            let inner = (0..p - 1).fold(Mat3::zeros(), |sum, k| sum + c[k] * dc * c[p - 2 - k]);
            ((df * c[p - 1] + f * inner) * (*w * factor) + slope * shrink) * self.weight
        });
        let stresses: Vec<Mat3> = stresses.collect();
        self.points.spread_stress(&stresses, &mut out.u);
        Ok(())
    }

    /// M, and the largest principal stretch at a quadrature point.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let stretch = |k: &Kinematics| (k.f().transpose() * k.f()).symmetric_eigenvalues().max().sqrt();
        let largest = self.kinematics.iter().map(stretch).fold(0.0, f64::max);
        let figure = |name, value| Figure { kind: FigureKind::Other(name), value, unit: "" };
        Ok(vec![figure("smoothed_stretch", self.norm), figure("largest_stretch", largest)])
    }
}
