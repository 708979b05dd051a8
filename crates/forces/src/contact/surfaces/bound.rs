//! [`BoundSurfaces`]: the contribution of a [`SurfaceContact`].

use super::SurfaceContact;
use super::edges::Edges;
use super::gap::Gap;
use super::point::SurfacePoint;
use super::recovery::Recovery;
use super::side::Side;
use super::simplex::{feature, nearest};
use crate::contact::{ContactLaw, defaults, friction};
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::touches::Touches;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::Symmetry;
use nastic_mesh::spatial::Shape;
use nastic_tensor::Vec3;

/// Slots.
pub(super) const STIFFNESS: usize = 0;
pub(super) const FRICTION: usize = 1;
/// Pieces of the edge of a facet in space, unless another number is asked for. Samples carry all, also where edges of both surfaces cross: with one piece
/// 22 of 105 random pairs of blocks, slots and collisions ended there, with two 1.
const PIECES_IN_SPACE: usize = 2;
/// Distance at which surfaces begin to be inside each other, in thicknesses.
const APART: f64 = 2.0;
/// Largest default thickness as a share of the distance at rest.
const OF_REST: f64 = 0.25;
/// Width of the smooth least distance, in thicknesses.
const SMOOTH: f64 = 0.01;
/// What the log law needs beyond that at rest.
const MARGIN: f64 = 0.1;
/// Blocks of the tangent are there for samples this near to the layer, in thicknesses, so that its structure serves while they move.
const NEAR: f64 = 2.0;
/// Below this distance, as a share of that at which surfaces begin to be inside each other, the side of a sample is not certain.
const LEAST: f64 = 0.02;

/// The contribution of a [`SurfaceContact`].
#[derive(Debug)]
pub struct BoundSurfaces {
    pub(super) name: String,
    pub(super) dim: usize,
    pub(super) law: ContactLaw,
    /// delta
    pub(super) thickness: f64,
    pub(super) sides: Vec<Side>,
    pub(super) edges: Edges,
    pub(super) recovery: Recovery,
    /// e, with friction.
    pub(super) slip_speed: Option<f64>,
    /// Friction takes its normal forces where the step begins.
    pub(super) lagged: bool,
    pub(super) slots: Vec<Slot>,
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
        let [own, other] = [mesh.facets_of(&of.surfaces[0])?, mesh.facets_of(&of.surfaces[1])?];
        for facets in [&own, &other] {
            defaults::check_layer(&of.layer, mesh, facets).map_err(refuse)?;
        }
        let refine = of.layer.refine.unwrap_or(if mesh.dim() == 3 { PIECES_IN_SPACE } else { 1 });
        let mut sides = vec![Side::new(disc, (&of.surfaces[0], refine), &other)?];
        if own != other {
            sides.push(Side::new(disc, (&of.surfaces[1], refine), &own)?);
        }
        let edges = Edges::new(mesh, &sides[sides.len() - 1].pieces, &sides[0].pieces, sides.len() == 1);
        let recovery = Recovery::new(mesh, &of.surfaces)?;
        let stiff = |facets: &[_]| defaults::stiffness(of.layer.law, body, facets);
        let softer = || Some(stiff(&own)?.min(stiff(&other)?));
        let behind = || format!("{} or {}", of.surfaces[0], of.surfaces[1]);
        defaults::check_stiffness(of.layer.stiffness, softer()).map_err(refuse)?;
        let stiffness = of.layer.stiffness.or_else(softer).ok_or_else(|| {
            refuse(format!("no passive law behind {} says how stiff the body is: give a stiffness", behind()))
        })?;
        let rest = vec![0.0; disc.dofs()];
        let (gap, place) = least(&sides, &rest).ok_or_else(|| {
            refuse(
                "all of its facets are neighbours of each other: name a larger surface, or take a finer mesh"
                    .to_owned(),
            )
        })?;
        let place = format!("({:.6}, {:.6}, {:.6})", place[0], place[1], place[2]);
        let shape = Shape::new(mesh, mesh.points(), None).map_err(|error| refuse(error.to_string()))?;
        if gap <= 0.0 || !shape.self_intersection().is_empty() {
            let what = "its surfaces meet, or bodies are inside of each other, at rest";
            return Err(refuse(format!("{what}; they are nearest at {place}: move them apart")));
        }
        let by_size = defaults::thickness(mesh, &own).min(defaults::thickness(mesh, &other));
        let thickness = positive("thickness", of.layer.thickness.unwrap_or(by_size.min(OF_REST * gap)))?;
        // the log law has no value where the smooth least distance, which is smaller, is below that
        let near = if of.layer.law == ContactLaw::Log { APART + MARGIN } else { APART };
        if gap < near * thickness {
            return Err(refuse(format!(
                "its surfaces are {gap:.3e} apart at rest at {place}; that must be at least {near} times the thickness, {thickness:.3e}: give \
                 a thinner layer by `thickness`, or move the bodies apart"
            )));
        }
        let friction = of.layer.friction.map(|friction| friction.slot(&of.name)).transpose()?;
        let stiffness = Slot::design("stiffness", "Pa", positive("stiffness", stiffness)?);
        let slots = [stiffness].into_iter().chain(friction).collect();
        let slip_speed = of.layer.friction.map(|friction| friction.slip_speed);
        let normals = sides.iter().flat_map(|side| normals(side, &rest, mesh.dim())).collect();
        let (name, dim, law, lagged) = (of.name.clone(), mesh.dim(), of.layer.law, of.layer.lagged);
        Ok(BoundSurfaces { name, dim, law, thickness, sides, edges, recovery, slip_speed, lagged, slots, normals })
    }

    /// Distance at which a gap is zero.
    pub(super) fn apart(&self) -> f64 {
        APART * self.thickness
    }

    /// The gaps of either side that are near the layer.
    ///
    /// # Errors
    /// [`Inadmissible::Penetrates`] where a sample is on the other surface or, of the log law, inside; [`Inadmissible::EdgesMeet`] where edges are as near
    /// as no sample may come.
    pub(super) fn gaps(&self, u: &[f64]) -> Result<Vec<Vec<Gap>>, Inadmissible> {
        let reach = self.apart() + (1.0 + NEAR) * self.thickness;
        let all: Vec<Vec<Gap>> = self.sides.iter().map(|side| side.gaps(u, reach, SMOOTH * self.thickness)).collect();
        let least = if self.law == ContactLaw::Log { 1.0 } else { LEAST } * self.apart();
        for (side, gaps) in self.sides.iter().zip(&all) {
            if let Some(gap) = gaps.iter().find(|gap| gap.smoothed <= least) {
                return Err(self.penetrates(side.place(u, gap.sample), gap.least));
            }
        }
        match self.edges.nearer(u, LEAST * self.apart()) {
            Some((place, distance)) => {
                Err(Inadmissible::EdgesMeet { name: self.name.clone(), place: place.into(), distance })
            }
            None => Ok(all),
        }
    }

    fn penetrates(&self, place: Vec3, distance: f64) -> Inadmissible {
        Inadmissible::Penetrates { name: self.name.clone(), place: place.into(), depth: self.apart() - distance }
    }
}

/// The least distance of a sample from the other surface, and where the sample is.
pub(super) fn least(sides: &[Side], u: &[f64]) -> Option<(f64, Vec3)> {
    let of_side = |side: &Side| side.least(u).map(|(distance, sample, _)| (distance, side.place(u, sample)));
    sides.iter().filter_map(of_side).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// `n . (u - u_y)` at every sample, y the point of the other surface that is nearest to it, n the direction between them.
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
        let own = side.samples.parts(sample).iter().flat_map(|&(node, shape)| along(node, shape));
        let other = between.iter().zip(found.shares).flat_map(|(&i, share)| along(nodes[i], -share));
        Some(own.chain(other).collect())
    };
    (0..side.samples.len()).filter_map(of_sample).collect()
}

impl Contribution for BoundSurfaces {
    fn name(&self) -> &str {
        &self.name
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn symmetry(&self) -> Symmetry {
        if self.slip_speed.is_some() && !self.lagged { Symmetry::General } else { Symmetry::Symmetric }
    }

    fn path_dependence(&self) -> Option<&'static str> {
        self.slip_speed.map(|_| friction::PATH)
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        friction::check_controls(&self.name, values[STIFFNESS], values.get(FRICTION).copied())
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
        self.told(at).map(|touch| touch.quantities(self.dim)).unwrap_or_default()
    }

    fn touches(&self) -> Option<&dyn Touches> {
        Some(self)
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(SurfacePoint::new(self, self.gaps(at.u)?)))
    }
}
