//! [`BoundHausdorff`]: [`SmoothedHausdorff`](super::SmoothedHausdorff) on a body, and its evaluated points.

use super::body_cloud::{BodyCloud, failed};
use super::{Cost, CostContext, CostPoint, CostTarget, Figure, FigureKind, Partials};
use nastic_fem::{Discretization, Solid};
use nastic_fields::ControlError;
use nastic_hausdorff::{Cloud, Evaluation, Motion, SecondPartials, Smoothing, Summation};
use nastic_mesh::{GroupNames, Hausdorff, Mesh, Shape, hausdorff};
use nastic_tensor::{Mat3, cross};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// [`SmoothedHausdorff`](super::SmoothedHausdorff) bound to a body.
#[derive(Debug)]
pub struct BoundHausdorff(Arc<Setup>);

/// All that does not depend on the displacement, shared with the evaluated points.
#[derive(Debug)]
pub(super) struct Setup {
    /// Of the body.
    pub mesh: Arc<Mesh>,
    pub body: BodyCloud,
    /// How many points the body has.
    pub points: usize,
    /// Region of the body; `None`: all of it.
    pub region: Option<GroupNames>,
    pub target: Arc<Mesh>,
    /// Region of the target; `None`: all of it.
    pub target_region: Option<GroupNames>,
    pub cloud: Cloud,
    pub shape: Shape,
    pub stages: Vec<Stage>,
    pub weight: f64,
    /// The coarser of the mean point spacings of body and target.
    pub spacing: f64,
}

/// The parameters of a stage, and rho(T, T) once it was asked for: it depends on nothing else.
#[derive(Debug)]
pub(super) struct Stage {
    smoothing: Smoothing,
    self_distance: OnceLock<f64>,
}

impl From<Smoothing> for Stage {
    fn from(smoothing: Smoothing) -> Self {
        Stage { smoothing, self_distance: OnceLock::new() }
    }
}

impl Setup {
    fn stage(&self, stage: usize) -> &Stage {
        &self.stages[stage.min(self.stages.len() - 1)]
    }

    fn true_distance(&self, mesh: &Mesh, u: &[f64]) -> Result<Hausdorff, ControlError> {
        let mut positions = mesh.points().to_vec();
        for (x, u) in positions.iter_mut().zip(u.chunks_exact(mesh.dim())) {
            x.iter_mut().zip(u).for_each(|(x, u)| *x += u);
        }
        let body = Shape::of(mesh, &positions, self.region.as_ref());
        let body = body.map_err(|e| ControlError::Cost { what: e.to_string() })?;
        hausdorff(&body, &self.shape).map_err(|e| ControlError::Cost { what: e.to_string() })
    }

    fn self_distance(&self, stage: usize) -> Result<f64, ControlError> {
        let stage = self.stage(stage);
        if let Some(known) = stage.self_distance.get() {
            return Ok(*known);
        }
        let own = Evaluation::new(&self.cloud, &self.cloud, stage.smoothing, Summation::default()).map_err(failed)?;
        Ok(*stage.self_distance.get_or_init(|| own.distance().rho))
    }
}

impl BoundHausdorff {
    pub(super) fn new(setup: Setup) -> Self {
        BoundHausdorff(Arc::new(setup))
    }

    /// The true Hausdorff distance of the deformed body from the target.
    ///
    /// # Errors
    /// A body turned inside out; one over ranks.
    pub fn true_distance(&self, solid: &Solid, u: &[f64]) -> Result<Hausdorff, ControlError> {
        solid.model().ranks().refuse_ranks("the true Hausdorff distance")?;
        self.0.true_distance(solid.mesh(), u)
    }

    /// rho(T, T): the cost of a perfect match, weight not included. Computed once per stage.
    ///
    /// # Errors
    /// Parameters out of the range of numbers.
    pub fn self_distance(&self, stage: usize) -> Result<f64, ControlError> {
        self.0.self_distance(stage)
    }
}

impl Cost for BoundHausdorff {
    fn name(&self) -> &str {
        "smoothed_hausdorff"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let setup = self.0.clone();
        let body = &setup.body.points;
        let kinematics = setup.body.agreed(body.kinematics(at.u).map_err(ControlError::from))?;
        let weights: Vec<f64> = body.weights().iter().zip(&kinematics).map(|(w, k)| w * k.j()).collect();
        let (cloud, own) = setup.body.gathered(body.positions(at.solid.mesh(), Some(at.u)), weights)?;
        let smoothing = setup.stage(at.stage).smoothing;
        let how = (smoothing, Summation::default());
        let evaluation =
            Evaluation::together(&cloud, &setup.cloud, how.0, how.1, setup.body.together()).map_err(failed)?;
        let discretization = at.solid.discretization().clone();
        Ok(Arc::new(HausdorffPoint { setup, discretization, u: at.u.to_vec(), stage: at.stage, evaluation, own }))
    }

    fn is_of(&self, solid: &Solid) -> bool {
        Arc::ptr_eq(&self.0.mesh, solid.mesh()) && self.0.body.is_shared_as(solid.model().unknowns().share())
    }

    fn stages(&self) -> usize {
        self.0.stages.len()
    }

    fn smoothings(&self) -> Vec<Smoothing> {
        self.0.stages.iter().map(|stage| stage.smoothing).collect()
    }

    fn size(&self) -> Option<String> {
        let (body, target) = (self.0.points, self.0.cloud.len());
        let pairs = body as f64 * target as f64;
        Some(format!("{body} points of the body and {target} of the target, {:.3} million pairs", 1e-6 * pairs))
    }

    fn warnings(&self, _: &Solid) -> Vec<String> {
        let coarse = |(k, stage): (usize, &Stage)| {
            let (length, spacing) = (stage.smoothing.resolution(), self.0.spacing);
            (length < spacing).then(|| {
                format!(
                    "stage {} of smoothed_hausdorff resolves {length:.3e}, below the mean spacing {spacing:.3e} of the \
                     quadrature points: it sees separate points, not a body; lower alpha, or raise the quadrature or \
                     the length",
                    k + 1
                )
            })
        };
        self.0.stages.iter().enumerate().filter_map(coarse).collect()
    }

    fn target(&self, _: &Solid) -> Option<CostTarget> {
        let (mesh, regions) = (self.0.target.clone(), self.0.target_region.clone());
        Some(CostTarget { mesh, regions, displacement: vec![] })
    }
}

/// The distance at one displacement: the pair sums are formed once, for the value, and kept for the partials.
///
/// Memory: 102 bytes per quadrature point of the body, 66 per point of the target and 24 per node: 17 MB for 1e5 points on
/// either side. Pairs are not stored.
#[derive(Debug)]
struct HausdorffPoint {
    setup: Arc<Setup>,
    discretization: Arc<Discretization>,
    u: Vec<f64>,
    stage: usize,
    evaluation: Evaluation,
    /// The points of this process among those of the body.
    own: Range<usize>,
}

impl CostPoint for HausdorffPoint {
    fn value(&self) -> f64 {
        self.setup.weight * self.evaluation.distance().rho
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let partials = self.evaluation.partials().map_err(failed)?;
        let (body, weight, dim) = (&self.setup.body.points, self.setup.weight, self.discretization.dim());
        let points = &partials.points[self.own.clone()];
        let forces: Vec<f64> = points.iter().flat_map(|p| p.iter().take(dim).map(move |p| weight * p)).collect();
        body.spread(&forces, dim, &mut out.u);
        // dw_q = w_q^0 H : grad v. H takes little time beside the sums, and much memory: nine numbers per point.
        let kinematics = body.kinematics(&self.u)?;
        let stresses = kinematics.iter().zip(body.weights()).zip(&partials.weights[self.own.clone()]);
        let stresses: Vec<Mat3> = stresses.map(|((k, w), d)| k.h() * (weight * w * d)).collect();
        body.spread_stress(&stresses, &mut out.u);
        Ok(())
    }

    /// `drho = sum_q G_q . v(x_q) + g_q dw_q`, `dw_q = w_q^0 H : grad v`: G and g change along du, and so does H, by `F x grad du`.
    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let (body, weight, dim) = (&self.setup.body.points, self.setup.weight, self.discretization.dim());
        let (kinematics, gradients) = (body.kinematics(&self.u)?, body.gradients(&along.u));
        let moved = body.interpolate(&along.u, dim);
        let points = moved.chunks_exact(dim).map(|v| std::array::from_fn(|d| v.get(d).copied().unwrap_or(0.0)));
        let at_points = || body.weights().iter().zip(&kinematics).zip(&gradients);
        let weights = at_points().map(|((w, k), moved)| w * k.h().dot(moved)).collect();
        let motion = Motion { points: points.collect(), weights };
        let SecondPartials { change, weights: first } = self.evaluation.partials_change(&motion).map_err(failed)?;
        let forces: Vec<f64> = change.points.iter().flat_map(|p| p.iter().take(dim).map(move |p| weight * p)).collect();
        body.spread(&forces, dim, &mut out.u);
        let by_weight = change.weights.iter().zip(&first);
        let stresses = at_points()
            .zip(by_weight)
            .map(|(((w, k), moved), (change, first))| (k.h() * *change + cross(k.f(), moved) * *first) * (weight * w));
        let stresses: Vec<Mat3> = stresses.collect();
        body.spread_stress(&stresses, &mut out.u);
        Ok(())
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let mut figures = vec![Figure::length(FigureKind::SmoothedDistance, self.evaluation.distance().rho)];
        // that of a part says nothing of the whole
        if self.discretization.over_ranks().is_none() {
            let truth = self.setup.true_distance(self.discretization.mesh(), &self.u)?;
            figures.push(Figure::length(FigureKind::TrueDistance, truth.distance));
        }
        figures.push(Figure::length(FigureKind::SelfDistance, self.setup.self_distance(self.stage)?));
        Ok(figures)
    }
}
