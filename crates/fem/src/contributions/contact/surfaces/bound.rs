//! [`BoundSurfaces`]: the contribution of a [`SurfaceContact`].

use super::SurfaceContact;
use super::gap::Gap;
use super::point::SurfacePoint;
use super::side::Side;
use super::simplex::{feature, nearest};
use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::contact::{ContactLaw, defaults};
use crate::contributions::{Contribution, ContributionPoint, Instant, Need, Touches};
use crate::error::{FemError, Inadmissible};
use nastic_energy::Slot;
use nastic_tensor::Vec3;

/// Distance at which surfaces begin to be inside each other, in thicknesses.
const APART: f64 = 2.0;
/// Largest default thickness as a share of the distance at rest.
const OF_REST: f64 = 0.25;
/// Width of the smooth least distance, in thicknesses.
const SMOOTH: f64 = 0.01;
/// Blocks of the tangent are there for samples this near to the layer, in thicknesses, so that its structure serves while they move.
const NEAR: f64 = 2.0;
/// Below this distance, as a share of that at which surfaces begin to be inside each other, the side of a sample is not certain.
const LEAST: f64 = 0.02;

/// The contribution of a [`SurfaceContact`].
#[derive(Debug)]
pub(crate) struct BoundSurfaces {
    pub(super) name: String,
    pub(super) dim: usize,
    pub(super) law: ContactLaw,
    /// delta
    pub(super) thickness: f64,
    pub(super) sides: Vec<Side>,
    pub(super) slots: [Slot; 1],
    /// Displacements that it resists to.
    normals: Vec<Vec<(u32, f64)>>,
}

impl BoundSurfaces {
    pub(super) fn new(of: &SurfaceContact, body: &BodyEnergy) -> Result<Self, FemError> {
        let (disc, mesh) = (body.discretization(), body.discretization().mesh());
        let refuse = |what: String| FemError::Meaningless { what: format!("contact \"{}\": {what}", of.name) };
        let positive = |what: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => Err(refuse(format!("its {what} is {value}; it must be positive and finite"))),
        };
        if of.refine == 0 {
            return Err(refuse("refine is 0; it is 1 or more".to_owned()));
        }
        let [own, other] = [mesh.facets_of(&of.surfaces[0])?, mesh.facets_of(&of.surfaces[1])?];
        let sides = match own == other {
            true => vec![Side::new(disc, (&of.surfaces[0], of.refine), &own, 1.0)?],
            false => vec![
                Side::new(disc, (&of.surfaces[0], of.refine), &other, 0.5)?,
                Side::new(disc, (&of.surfaces[1], of.refine), &own, 0.5)?,
            ],
        };
        let stiff = |facets: &[_]| defaults::stiffness(of.law, body, facets);
        let softer = || Some(stiff(&own)?.min(stiff(&other)?));
        let stiffness = of.stiffness.or_else(softer);
        let behind = || format!("{} or {}", of.surfaces[0], of.surfaces[1]);
        let stiffness = stiffness.ok_or_else(|| {
            refuse(format!("no passive law behind {} says how stiff the body is: give a stiffness", behind()))
        })?;
        let rest = vec![0.0; disc.dofs()];
        let nearest = sides.iter().filter_map(|side| Some((side.least(&rest)?, side)));
        let nearest = nearest.min_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let gap = nearest.as_ref().map_or(f64::INFINITY, |((gap, ..), _)| *gap);
        let by_size = defaults::thickness(mesh, &own).min(defaults::thickness(mesh, &other));
        let thickness = positive("thickness", of.thickness.unwrap_or(by_size.min(OF_REST * gap)))?;
        if let Some(((gap, sample, _), side)) = nearest.filter(|_| gap < APART * thickness) {
            let x = side.place(&rest, sample);
            return Err(refuse(format!(
                "its surfaces are {gap:.3e} apart at rest at ({:.6}, {:.6}, {:.6}); that must be at least twice the thickness, {thickness:.3e}: give \
                 a thinner layer by `thickness`, or move the bodies apart",
                x[0], x[1], x[2]
            )));
        }
        let slots = [Slot::design("stiffness", "Pa", positive("stiffness", stiffness)?)];
        let normals = sides.iter().flat_map(|side| normals(side, &rest, mesh.dim())).collect();
        Ok(BoundSurfaces { name: of.name.clone(), dim: mesh.dim(), law: of.law, thickness, sides, slots, normals })
    }

    /// Distance at which a gap is zero.
    pub(super) fn apart(&self) -> f64 {
        APART * self.thickness
    }

    /// The gaps of either side that are near the layer.
    ///
    /// # Errors
    /// [`Inadmissible::Penetrates`] where a sample is on the other surface or, of the log law, inside.
    pub(super) fn gaps(&self, u: &[f64]) -> Result<Vec<Vec<Gap>>, Inadmissible> {
        let reach = self.apart() + (1.0 + NEAR) * self.thickness;
        let all: Vec<Vec<Gap>> = self.sides.iter().map(|side| side.gaps(u, reach, SMOOTH * self.thickness)).collect();
        let least = if self.law == ContactLaw::Log { 1.0 } else { LEAST } * self.apart();
        for (side, gaps) in self.sides.iter().zip(&all) {
            if let Some(gap) = gaps.iter().find(|gap| gap.least <= least) {
                return Err(self.penetrates(side.place(u, gap.sample), gap.least));
            }
        }
        Ok(all)
    }

    fn penetrates(&self, place: Vec3, distance: f64) -> Inadmissible {
        Inadmissible::Penetrates { name: self.name.clone(), place: place.into(), depth: self.apart() - distance }
    }
}

/// `n . u` at every sample, and at the point of the other surface that is nearest to it, n the direction between them.
fn normals(side: &Side, rest: &[f64], dim: usize) -> Vec<Vec<(u32, f64)>> {
    let placed = side.pieces.placed(&[&|node| side.node(rest, node)]);
    let of_sample = |sample: usize| {
        let x = side.place(rest, sample);
        let to =
            |piece| side.may_touch(sample, piece).then(|| super::simplex::distance(&x, &side.corners(rest, piece)));
        let (_, piece) = placed.least(&x, to)?;
        let (corners, nodes) = (side.corners(rest, piece), &side.pieces.all[piece].0);
        let between = feature(&x, &corners);
        let found = nearest(x.into(), &between.iter().map(|&i| corners[i].into()).collect::<Vec<_>>());
        let along =
            |node: u32, share: f64| (0..dim).map(move |i| (dim as u32 * node + i as u32, share * found.normal[i]));
        let own = side.samples.parts(sample).iter().flat_map(|&(node, shape)| along(node, shape)).collect();
        let other = between.iter().zip(found.shares).flat_map(|(&i, share)| along(nodes[i], -share)).collect();
        Some([own, other])
    };
    (0..side.samples.len()).filter_map(of_sample).flatten().collect()
}

impl Contribution for BoundSurfaces {
    fn name(&self) -> &str {
        &self.name
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        match values[0] > 0.0 {
            true => Ok(()),
            false => {
                let what = format!("contact \"{}\": its stiffness is {}; it must be positive", self.name, values[0]);
                Err(FemError::Meaningless { what })
            }
        }
    }

    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.normals
    }

    /// Within the layer, or no deeper than it is thick.
    fn check_start(&self, at: &Instant) -> Result<(), Inadmissible> {
        let gaps = self.gaps(at.u)?;
        for (side, gaps) in self.sides.iter().zip(&gaps) {
            if let Some(gap) = gaps.iter().find(|gap| gap.least < self.apart() - self.thickness) {
                return Err(self.penetrates(side.place(at.u, gap.sample), gap.least));
            }
        }
        Ok(())
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.touch(at).map(|touch| touch.quantities(self.dim)).unwrap_or_default()
    }

    fn touches(&self) -> Option<&dyn Touches> {
        Some(self)
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(SurfacePoint::new(self, self.gaps(at.u)?)))
    }
}
