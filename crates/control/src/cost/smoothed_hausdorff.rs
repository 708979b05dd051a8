//! [`SmoothedHausdorff`]: the smoothed Hausdorff distance of the deformed body from a target domain.

use super::body_cloud::BodyCloud;
use super::bound_hausdorff::{BoundHausdorff, Setup, Stage};
use super::{Cost, IntoCost, automatic_stages, check_weight};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_hausdorff::{Cloud, Phi, Smoothing};
use nastic_mesh::{GroupNames, Mesh, Shape};
use std::sync::Arc;

/// The smoothed Hausdorff distance rho between the deformed body and a target domain, times a weight.
///
/// With A, B the smoothed densities of the body at target points and of the target at body points,
///
/// ```text
/// A(y) = (1/|Omega|) int_Omega phi(|y-x|)^alpha dx,    d_Omega(y) = phi^-1( A(y)^(1/alpha) )
/// B(x) = (1/|T|)     int_T     phi(|x-y|)^alpha dy,    d_T(x)     = phi^-1( B(x)^(1/alpha) )
/// D1 = ( (1/|T|) int_T d_Omega^beta )^(1/beta),        D2 = ( (1/|Omega|) int_Omega d_T^beta )^(1/beta)
/// rho = ( (D1^gamma + D2^gamma) / sqrt 2 )^(1/gamma)
/// ```
///
/// The derivative is the exact one of the discrete value, the part through the deformed weights `J w` and `|Omega|`
/// included. A perfect match costs rho(T, T) > 0 and is in general not stationary, so the true Hausdorff distance and
/// the self-distance are reported beside rho. Unit: length times the weight's.
///
/// The relative error of every sum A, B is below 1e-10 ([`Summation`](nastic_hausdorff::Summation)'s default, where what that means for the derivative is
/// stated): far below the differences in line searches and gradient checks.
///
/// Of a body over ranks every rank has the points of all, in the order of the ranks; they form the sums together, each those of some of
/// the points, whichever rank has these in its cells.
///
/// Source: survey, eq. (7); docs/model/costs.md.
#[derive(Debug, Clone)]
pub struct SmoothedHausdorff {
    target: Arc<Mesh>,
    target_region: Option<GroupNames>,
    region: Option<GroupNames>,
    phi: Phi,
    /// Automatic where none are given.
    stages: Option<Vec<(f64, f64, f64)>>,
    /// Gauss points per direction; chosen by the length to resolve where none are given.
    quadrature: Option<usize>,
    weight: f64,
}

/// Default length of phi, as a share of the target's diagonal.
const DEFAULT_LENGTH_RATIO: f64 = 0.1;

impl SmoothedHausdorff {
    /// To the whole of a target mesh, with `phi = exp(-r/l)`, l a tenth of the target's diagonal, and the stages
    /// (alpha, beta, gamma) = (1, 4, 4), (4, 16, 8).
    pub fn to(target: impl Into<Arc<Mesh>>) -> Self {
        let target = target.into();
        let phi = Phi::Exponential { length: DEFAULT_LENGTH_RATIO * target.diagonal() };
        let stages = Some(vec![(1.0, 4.0, 4.0), (4.0, 16.0, 8.0)]);
        SmoothedHausdorff { target, target_region: None, region: None, phi, stages, quadrature: None, weight: 1.0 }
    }

    /// Only this region of the target, or the union of several.
    pub fn target_region(mut self, names: impl Into<GroupNames>) -> Self {
        self.target_region = Some(names.into());
        self
    }

    /// Only this region of the body, or the union of several.
    pub fn region(mut self, names: impl Into<GroupNames>) -> Self {
        self.region = Some(names.into());
        self
    }

    /// The decreasing function phi.
    pub fn phi(mut self, phi: Phi) -> Self {
        self.phi = phi;
        self
    }

    /// `phi = exp(-r/length)`.
    pub fn exponential(self, length: f64) -> Self {
        self.phi(Phi::Exponential { length })
    }

    /// Continuation stages (alpha, beta, gamma), coarse to fine.
    pub fn stages(mut self, stages: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        self.stages = Some(stages.into_iter().collect());
        self
    }

    /// Continuation stages from the sizes of the problem: with d the diagonal of the target's points and h the coarser mean spacing of the
    /// points of body and target, stage s of S resolves `R_s = l/alpha_s`, in geometric progression from d/10 to h, with
    /// `S = 1 + round(log_4(d/(10 h)))`; beta goes from 4 to 16 and gamma from 4 to 8 in the same way. Points left open by
    /// [`quadrature`](Self::quadrature) are chosen to resolve a fortieth of the diagonal of the target (of its region, where one is named). One stage, the last, where d/10 < 2 h.
    pub fn automatic_stages(mut self) -> Self {
        self.stages = None;
        self
    }

    /// Gauss points per direction, on body and target. Without it, on each of the two the fewest whose mean spacing is no
    /// more than the smallest length that a stage resolves, `l/alpha`: the value costs a sum over all pairs of points.
    pub fn quadrature(mut self, points: usize) -> Self {
        self.quadrature = Some(points);
        self
    }

    /// Multiplies the cost.
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }

    /// The cost on a body; of a body over ranks all ranks bind it together.
    ///
    /// # Errors
    /// Unknown regions, an empty target, parameters that are not positive, dimensions that differ.
    pub fn bind_to(self, solid: &Solid) -> Result<BoundHausdorff, ControlError> {
        let model = solid.model();
        // before messages that would wait for a rank that refuses
        let Given { weight, stages, length, cloud, shape } = model.ranks().all_accept(self.checked(solid.mesh()))?;
        let (resolution, share) = ((self.quadrature, length), model.unknowns().share().cloned());
        let (body, body_cloud) = BodyCloud::of(solid.mesh(), self.region.as_ref(), resolution.0, resolution.1, share)?;
        let spacing = body_cloud.spacing().max(cloud.spacing());
        let stages = match stages {
            Some(stages) => stages,
            None => {
                let diagonal = diagonal(cloud.points());
                self.smoothings(&automatic_stages::exponents(self.phi.length(), diagonal, spacing))?
            }
        };
        let stages = stages.into_iter().map(Stage::from).collect();
        let (region, target, target_region) = (self.region, self.target, self.target_region);
        let (points, mesh) = (body_cloud.len(), solid.mesh().clone());
        Ok(BoundHausdorff::new(Setup {
            mesh,
            body,
            points,
            region,
            target,
            target_region,
            cloud,
            shape,
            stages,
            weight,
            spacing,
        }))
    }

    /// What does not depend on the points of the body.
    fn checked(&self, body: &Mesh) -> Result<Given, ControlError> {
        let weight = check_weight("smoothed_hausdorff", self.weight)?;
        let fail = |what: String| ControlError::Cost { what };
        if self.target.dim() != body.dim() {
            let (target, body) = (self.target.dim(), body.dim());
            return Err(fail(format!(
                "the target {} is {target}-dimensional, the body {body}-dimensional",
                self.target.name()
            )));
        }
        if self.stages.as_ref().is_some_and(Vec::is_empty) {
            return Err(fail("smoothed_hausdorff needs at least one stage (alpha, beta, gamma)".to_owned()));
        }
        if let Some(points) = self.quadrature.filter(|points| *points == 0 || *points > MAX_GAUSS_POINTS) {
            return Err(fail(format!("smoothed_hausdorff: quadrature {points} is not within 1 to {MAX_GAUSS_POINTS}")));
        }
        let stages = self.stages.as_deref().map(|stages| self.smoothings(stages)).transpose()?;
        let length = match &stages {
            Some(stages) => stages.iter().map(Smoothing::resolution).fold(f64::INFINITY, f64::min),
            None => automatic_stages::finest(self.target.diagonal_of(self.target_region.as_ref())?),
        };
        let resolution = (self.quadrature, length);
        let (_, cloud) = BodyCloud::of(&self.target, self.target_region.as_ref(), resolution.0, resolution.1, None)?;
        let shape = Shape::of(&self.target, self.target.points(), self.target_region.as_ref());
        let shape = shape.map_err(|e| fail(e.to_string()))?;
        Ok(Given { weight, stages, length, cloud, shape })
    }

    fn smoothings(&self, stages: &[(f64, f64, f64)]) -> Result<Vec<Smoothing>, ControlError> {
        let stages = stages.iter().map(|&(alpha, beta, gamma)| Smoothing::new(self.phi, alpha, beta, gamma));
        stages.collect::<Result<_, _>>().map_err(|e| ControlError::Cost { what: e.to_string() })
    }
}

/// What a distance is given beside the body.
struct Given {
    weight: f64,
    /// Automatic where there are none.
    stages: Option<Vec<Smoothing>>,
    /// The length to resolve.
    length: f64,
    cloud: Cloud,
    shape: Shape,
}

impl IntoCost for SmoothedHausdorff {
    fn not_over_ranks(&self) -> Option<String> {
        None
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        Ok(Box::new(self.bind_to(solid)?))
    }
}

/// Gauss points per direction.
pub(super) const MAX_GAUSS_POINTS: usize = 20;

/// Diagonal of the bounding box of points.
fn diagonal(points: &[[f64; 3]]) -> f64 {
    let extent = |k: usize| {
        let ends = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[k]), h.max(x[k])));
        ends.1 - ends.0
    };
    (0..3).map(|k| extent(k).powi(2)).sum::<f64>().sqrt()
}
