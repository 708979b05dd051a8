//! [`Surfaces`]: surfaces of bodies that touch each other, or themselves.

mod edges;
mod gap;
mod moves;
mod pieces;
mod pressures;
mod recovery;
mod side;
mod simplex;
mod sliding;
mod spin;
mod stencil;

use super::bound::BoundContact;
use super::layer::{Settings, Surface};
use super::stencil::{Counterpart, Extent, Move, Nearest, Stencil};
use super::{ContactLaw, defaults};
use edges::Edges;
use gap::Gap;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::Touch;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_mesh::GroupNames;
use nastic_mesh::spatial::Shape;
use nastic_tensor::Vec3;
use pressures::Pressures;
use recovery::Recovery;
use side::Side;
use simplex::{feature, nearest};
use stencil::BeforeSurface;

/// Pieces of the edge of a facet in space, unless another number is asked for. Samples carry all, also where edges of both surfaces cross: with one piece
/// 22 of 105 random pairs of blocks, slots and collisions ended there, with two 1.
const PIECES_IN_SPACE: usize = 2;
/// Distance below which surfaces count as inside each other, in thicknesses.
const MIN_SIDE_DISTANCE: f64 = 2.0;
/// Largest default thickness as a share of the distance at rest.
const MAX_THICKNESS_SHARE: f64 = 0.25;
/// Width of the smooth least distance, in thicknesses.
const SMOOTHING_WIDTH: f64 = 0.01;
/// Distance at rest that the log law needs beyond that, in thicknesses.
const LOG_LAW_MARGIN: f64 = 0.1;
/// Distance from the layer, in thicknesses, up to which samples have blocks in the tangent, so that its structure serves while they move.
const STRUCTURE_DISTANCE: f64 = 2.0;
/// Distance, as a share of that below which surfaces are inside each other, below which the side of a sample is uncertain.
const MIN_CERTAIN_SHARE: f64 = 0.02;

/// Share of the area of a sample that counts: both walls that touch have samples, each of which acts on both.
const AREA_SHARE: f64 = 0.5;

pub(super) type SurfacesContact = BoundContact<Surfaces>;

/// Two surfaces that push each other back, or one that pushes itself back: the samples of either before the pieces of the other.
///
/// **Potential**, without friction: `sum_s w_s psi(d_s)` over the samples s of either surface, with half of their reference areas as w_s (both walls that touch have
/// samples), psi a [`ContactLaw`] of thickness delta and stiffness k (Pa). The gap of a sample is its distance from the other
/// surface less `2 delta`: where surfaces touch, they stay about `2 delta` apart, and no edge is so sharp that a distance has no derivative.
///
/// ```text
/// d = -e ln(sum_i exp(-|x_s - y_i| / e)) - 2 delta,     e = delta / 100
/// ```
///
/// over the flat pieces i of the other surface (between the nodes of its facets), y_i the nearest point of each, moving with the body. The
/// smooth least distance keeps the force continuous where a sample passes from one piece of a hollow to the next.
///
/// Forces on the two surfaces are equal and opposite, with equal moments, to rounding. The residual is continuously differentiable but
/// where the nearest point goes from a face to an edge or corner: there the tangent jumps.
///
/// Facets that share a node with a sample's own ones, or with a neighbour of these, are left out: a surface does not touch itself there.
/// Where edges cross between samples nothing is seen.
///
/// **Friction** (Coulomb) acts in time steps alone, as before an obstacle: a sample that a piece i presses with `pi_i p` (parts
/// `pi_i` of the pressure, of the least distance) bears `mu pi_i p f(v_t)` per area, the piece the opposite, with
///
/// ```text
/// v_t = (1 - n n^T) (v_s - v_y - omega x r),     r = x_s - y_i,     v_y = sum_a b_a v_a  of  y_i = sum_a b_a x_a
/// ```
///
/// omega the spin of the sample's own surface, fitted to the velocities of its corners: where both surfaces move as one rigid body nothing slides, though
/// they stand `2 delta` apart, and forces and moments of friction cancel too.
///
/// Nearest points as in Ericson, "Real-time collision detection" (2005), section 5.1.5.
#[derive(Debug)]
pub(super) struct Surfaces {
    dim: usize,
    sides: Vec<Side>,
    edges: Edges,
    recovery: Recovery,
}

/// Of either side the samples near the layer.
pub(super) type Near = Vec<Vec<Gap>>;

impl Surfaces {
    /// The contribution on a body.
    pub fn on(given: &Settings, other: &GroupNames, body: &BodyEnergy) -> Result<SurfacesContact, FemError> {
        let (disc, mesh) = (body.discretization(), body.discretization().mesh());
        let (dim, names) = (mesh.dim(), [&given.surface, other]);
        let refuse = |what: String| given.refusal(what);
        let facets = |name| Ok(Surface { name, facets: mesh.facets_of(name)? });
        let surfaces = names.map(facets).into_iter().collect::<Result<Vec<Surface>, FemError>>()?;
        for surface in &surfaces {
            defaults::check_layer(given, mesh, &surface.facets).map_err(refuse)?;
        }
        let refine = given.refine.unwrap_or(if dim == 3 { PIECES_IN_SPACE } else { 1 });
        let [own, others] = [0, 1].map(|k: usize| &surfaces[k].facets);
        let mut sides = vec![Side::new(disc, names[0], refine, others)?];
        if own != others {
            let mut second = Side::new(disc, names[1], refine, own)?;
            second.first = sides[0].samples.len();
            sides.push(second);
        }
        let edges = Edges::new(mesh, &sides[sides.len() - 1].pieces, &sides[0].pieces, sides.len() == 1);
        let rest = vec![0.0; disc.dofs()];
        let (gap, place) = least(&sides, &rest).ok_or_else(|| {
            let what = "all of its facets are neighbours of each other: name a larger surface, or take a finer mesh";
            refuse(what.to_owned())
        })?;
        let place = format!("({:.6}, {:.6}, {:.6})", place[0], place[1], place[2]);
        let shape = Shape::new(mesh, mesh.points(), None).map_err(|error| refuse(error.to_string()))?;
        if gap <= 0.0 || !shape.self_intersection().is_empty() {
            let what = "its surfaces meet, or bodies are inside of each other, at rest";
            return Err(refuse(format!("{what}; they are nearest at {place}: move them apart")));
        }
        let usual =
            defaults::thickness(mesh, own).min(defaults::thickness(mesh, others)).min(MAX_THICKNESS_SHARE * gap);
        let layer = given.on(&surfaces, body, usual)?;
        // the log law has no value where the smooth least distance, which is smaller, is below that
        let near = if layer.law == ContactLaw::Log { MIN_SIDE_DISTANCE + LOG_LAW_MARGIN } else { MIN_SIDE_DISTANCE };
        if gap < near * layer.thickness {
            return Err(refuse(format!(
                "its surfaces are {gap:.3e} apart at rest at {place}; that must be at least {near} times the thickness, {:.3e}: give \
                 a thinner layer by `thickness`, or move the bodies apart",
                layer.thickness
            )));
        }
        let normals = sides.iter().flat_map(|side| normals(side, &rest, dim)).collect();
        let with = Surfaces { dim, sides, edges, recovery: Recovery::new(mesh, names)? };
        Ok(BoundContact { layer, with, normals })
    }
}

impl SurfacesContact {
    /// Distance at which a gap is zero.
    fn apart(&self) -> f64 {
        MIN_SIDE_DISTANCE * self.layer.thickness
    }

    fn sides<'a>(&'a self, near: &'a Near) -> impl Iterator<Item = (&'a Side, &'a Vec<Gap>)> {
        self.with.sides.iter().zip(near)
    }
}

impl Counterpart for Surfaces {
    type State = Near;
    type Stencil<'a> = BeforeSurface<'a>;
    const COUPLES_BEYOND_PATTERN: bool = true;

    /// # Errors
    /// [`Inadmissible::Penetrates`] where a sample is on the other surface or, of the log law, inside; [`Inadmissible::EdgesMeet`] where edges are as near
    /// as no sample may come.
    fn state(of: &SurfacesContact, at: &Instant, _: bool) -> Result<Near, Inadmissible> {
        let (thickness, u) = (of.layer.thickness, at.u);
        let reach = of.apart() + (1.0 + STRUCTURE_DISTANCE) * thickness;
        let all: Near = of.with.sides.iter().map(|side| side.gaps(u, reach, SMOOTHING_WIDTH * thickness)).collect();
        let least = if of.layer.law == ContactLaw::Log { 1.0 } else { MIN_CERTAIN_SHARE } * of.apart();
        for (side, gaps) in of.sides(&all) {
            if let Some(gap) = gaps.iter().find(|gap| gap.smoothed <= least) {
                return Err(of.layer.penetrates(&side.place(u, gap.sample), of.apart() - gap.least));
            }
        }
        match of.with.edges.nearer(u, MIN_CERTAIN_SHARE * of.apart()) {
            Some((place, distance)) => {
                Err(Inadmissible::EdgesMeet { name: of.layer.name.clone(), place: place.into(), distance })
            }
            None => Ok(all),
        }
    }

    fn stencils<'a>(of: &'a SurfacesContact, near: &'a Near, u: &'a [f64]) -> Vec<BeforeSurface<'a>> {
        let of_side =
            |(side, gaps): (&'a Side, &'a Vec<Gap>)| gaps.iter().map(move |gap| BeforeSurface::new(of, side, gap, u));
        of.sides(near).flat_map(of_side).collect()
    }

    fn gaps(of: &SurfacesContact, near: &Near) -> Vec<f64> {
        let mut all = vec![f64::INFINITY; of.with.extent().samples];
        for (side, gaps) in of.sides(near) {
            gaps.iter().for_each(|gap| all[side.first + gap.sample] = gap.smoothed - of.apart());
        }
        all
    }

    fn nearest(of: &SurfacesContact, near: &Near, at: &Instant) -> Option<Nearest> {
        let (distance, place) = least(&of.with.sides, at.u)?;
        let mut nearest = Nearest { gap: distance - of.apart(), place, sunk: 0.0, approach: 0.0 };
        for stencil in Self::stencils(of, near, at.u) {
            if stencil.gap() < nearest.gap {
                (nearest.gap, nearest.place) = (stencil.gap(), stencil.places[0]);
            }
        }
        Some(Nearest { sunk: -nearest.gap, ..nearest })
    }

    fn extent(&self) -> Extent {
        let area = AREA_SHARE * self.sides.iter().flat_map(|side| &side.samples.weights).sum::<f64>();
        let samples = self.sides.iter().map(|side| side.samples.len()).sum();
        Extent { area, samples, inset: 0.0, between_samples: 0.0, is_exact: false }
    }

    fn longest_move(of: &SurfacesContact, _: &Near, at: &Instant, by: &Move) -> f64 {
        of.with.longest_move(at.u, by.way)
    }

    /// Means over facets.
    fn nodal_pressures(of: &SurfacesContact, at: &Instant) -> Vec<(u32, f64)> {
        let (k, recovery) = (at.control(of.layer.stiffness), &of.with.recovery);
        let pressures = match Self::state(of, at, false) {
            Ok(near) => Pressures::at(of, &near, at.u).of_corners,
            Err(_) => vec![0.0; recovery.areas.len()],
        };
        recovery.at_nodes(&pressures).into_iter().map(|(node, unit)| (node, k * unit)).collect()
    }

    fn largest_pressure(of: &SurfacesContact, near: &Near, at: &Instant, _: f64) -> f64 {
        let pressures = Pressures::at(of, near, at.u).of_corners;
        at.control(of.layer.stiffness) * pressures.into_iter().fold(0.0, f64::max)
    }

    fn add_pressures(
        of: &SurfacesContact,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        let (near, k) = (Self::state(of, at, false)?, at.control(of.layer.stiffness));
        let pressures = Pressures::at(of, &near, at.u);
        let (mut sum, mut by_stiffness, mut by_pressures) = (0.0, 0.0, Vec::new());
        for (unit, area) in pressures.of_corners.iter().zip(&of.with.recovery.areas) {
            let [value, slope] = if *unit > 0.0 { by(k * unit) } else { [0.0; 2] };
            sum += AREA_SHARE * area * value;
            by_stiffness += AREA_SHARE * area * slope * unit;
            by_pressures.push(AREA_SHARE * area * slope * k);
        }
        pressures.add_derivatives(&by_pressures, |dof, value| by_u[dof] += value);
        into.add_control(at, of.layer.stiffness, by_stiffness);
        Ok(sum)
    }

    /// The nearest points of two surfaces of flat pieces are at a node of one of them, which samples see, or on an edge of either.
    fn between(of: &SurfacesContact, at: &Instant, touch: &Touch) -> Option<(f64, [f64; 3])> {
        let (gap, apart) = (touch.smallest_gap, of.apart());
        let is_near = gap < of.layer.thickness;
        let edges = is_near.then(|| of.with.edges.nearer(at.u, gap + apart)).flatten();
        Some(edges.map_or((gap, touch.deepest), |(place, distance)| (distance - apart, place.into())))
    }
}

/// The least distance of a sample from the other surface, and where the sample is.
fn least(sides: &[Side], u: &[f64]) -> Option<(f64, Vec3)> {
    let of_side = |side: &Side| {
        let all = side.nearest_pieces(u).into_iter().enumerate();
        let distances = all.filter_map(|(sample, nearest)| nearest.map(|(distance, _)| (distance, sample)));
        let least = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        least.map(|(distance, sample)| (distance, side.place(u, sample)))
    };
    sides.iter().filter_map(of_side).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// `n . (u - u_y)` at every sample, y the point of the other surface that is nearest to it, n the direction between them.
fn normals(side: &Side, rest: &[f64], dim: usize) -> Vec<Vec<(u32, f64)>> {
    let of_sample = |(sample, found): (usize, Option<(f64, usize)>)| {
        let (_, piece) = found?;
        let (x, corners, nodes) = (side.place(rest, sample), side.corners(rest, piece), &side.pieces.all[piece].0);
        let between = feature(&x, &corners);
        let found = nearest(x.into(), &between.iter().map(|&i| corners[i].into()).collect::<Vec<_>>());
        let along =
            |node: u32, share: f64| (0..dim).map(move |i| (dim as u32 * node + i as u32, share * found.normal[i]));
        let own = side.samples.parts(sample).iter().flat_map(|&(node, shape)| along(node, shape));
        let other = between.iter().zip(found.shares).flat_map(|(&i, share)| along(nodes[i], -share));
        Some(own.chain(other).collect())
    };
    side.nearest_pieces(rest).into_iter().enumerate().filter_map(of_sample).collect()
}
