//! [`BodyCloud`]: the quadrature points of a body as a cloud, also where several ranks have the body.

use super::smoothed_hausdorff::MAX_GAUSS_POINTS;
use nastic_fem::{QuadraturePoints, Share, all_accept};
use nastic_fields::{ControlError, gathered};
use nastic_hausdorff::{Cloud, HausdorffError, Together};
use nastic_mesh::{GroupNames, Mesh};
use std::ops::Range;
use std::sync::Arc;

/// The quadrature points that this process has of a body, and their places among those of all ranks.
#[derive(Debug)]
pub(super) struct BodyCloud {
    pub points: QuadraturePoints,
    share: Option<Arc<Share>>,
}

impl BodyCloud {
    /// Points of a mesh, with their cloud: a number per direction, or the fewest that resolve a length. With a share the points of all ranks make
    /// the cloud, of which one may have none.
    pub fn of(
        mesh: &Mesh,
        region: Option<&GroupNames>,
        points: Option<usize>,
        length: f64,
        share: Option<Arc<Share>>,
    ) -> Result<(Self, Cloud), ControlError> {
        let cells = match region {
            Some(names) => all_accept(share.as_deref(), mesh.cells_of(names).map_err(ControlError::from))?,
            None => (0..mesh.cells() as u32).collect(),
        };
        if !share.as_ref().map_or(!cells.is_empty(), |share| share.any(!cells.is_empty())) {
            return Err(ControlError::Cost { what: format!("{} has no cells to measure a distance to", mesh.name()) });
        }
        let mut count = points.unwrap_or(1);
        loop {
            let sampled = QuadraturePoints::of_cells(mesh, cells.clone(), |kind| kind.rule_of_points(count));
            let sampled = all_accept(share.as_deref(), sampled.map_err(ControlError::from))?;
            let body = BodyCloud { points: sampled, share: share.clone() };
            let (cloud, _) = body.gathered(body.points.positions(mesh, None), body.points.weights().to_vec())?;
            let resolved = cloud.len() > 1 && cloud.spacing() <= length;
            if points.is_some() || resolved || count == MAX_GAUSS_POINTS {
                return Ok((body, cloud));
            }
            count += 1;
        }
    }

    /// The cloud of these places with these weights, and which of its points are this process's.
    pub fn gathered(
        &self,
        mut points: Vec<[f64; 3]>,
        mut weights: Vec<f64>,
    ) -> Result<(Cloud, Range<usize>), ControlError> {
        let mut own = 0..points.len();
        if let Some(share) = &self.share {
            let told: Vec<f64> = points.iter().zip(&weights).flat_map(|(x, w)| [x[0], x[1], x[2], *w]).collect();
            let all = gathered(share, &told)?;
            let first = all[..share.team().rank()].iter().map(|of_rank| of_rank.len() / 4).sum();
            own = first..first + points.len();
            let all = || all.iter().flat_map(|of_rank| of_rank.as_chunks::<4>().0);
            points = all().map(|[x, y, z, _]| [*x, *y, *z]).collect();
            weights = all().map(|[.., w]| *w).collect();
        }
        Ok((Cloud::new(points, weights).map_err(failed)?, own))
    }

    /// Whether these ranks have the body, or as there one process.
    pub fn is_shared_as(&self, share: Option<&Arc<Share>>) -> bool {
        self.share.as_ref() == share
    }

    /// The ranks that form sums over pairs of its points together.
    pub fn together(&self) -> Option<Arc<dyn Together>> {
        self.share.clone().map(|share| Arc::new(Ranks(share)) as Arc<dyn Together>)
    }

    /// What this process has found, or that another rank refuses its points.
    pub fn agreed<T>(&self, found: Result<T, ControlError>) -> Result<T, ControlError> {
        all_accept(self.share.as_deref(), found)
    }
}

/// The ranks of a body, as sums over pairs see them.
#[derive(Debug)]
struct Ranks(Arc<Share>);

impl Together for Ranks {
    fn place(&self) -> (usize, usize) {
        (self.0.team().rank(), self.0.team().size())
    }

    fn add_up(&self, values: &mut [f64]) {
        self.0.sum(values);
    }
}

pub(super) fn failed(error: HausdorffError) -> ControlError {
    ControlError::Cost { what: error.to_string() }
}
