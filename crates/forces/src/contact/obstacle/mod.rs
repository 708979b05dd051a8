//! [`RigidObstacle`]: an obstacle before a surface of the body.

mod exact;
mod gaps;
mod probes;
mod stencil;

use super::advance::{Advance, BOUND_TOLERANCE};
use super::bound::BoundContact;
use super::layer::{Settings, Surface};
use super::pose::{Moved, Pose};
use super::samples::Samples;
use super::stencil::{Counterpart, Extent, Move, Nearest, Stencil};
use super::{ContactLaw, defaults};
use gaps::{Gaps, Placed, floor};
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::touches::{ExactContact, Touch};
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_mesh::Facet;
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_tensor::Vec3;
use probes::Probes;
use stencil::BeforeObstacle;

/// Depth of samples of the cubic law in a load step, in thicknesses, before the body yields.
const MAX_DEPTH: f64 = 3.0;

pub(super) type ObstacleContact = BoundContact<RigidObstacle>;

/// An obstacle and the samples before it.
#[derive(Debug, Clone)]
pub(super) struct RigidObstacle {
    obstacle: Obstacle,
    centre: Vec3,
    /// How deep inside the obstacle gaps count from.
    inset: f64,
    /// How much further at every sample, by [`exact`]; none without.
    offsets: Vec<f64>,
    /// How deep a sample of the cubic law may come in an iteration: no obstacle is crossed.
    depth: f64,
    samples: Samples,
    probes: Probes,
    /// Positions of the samples in the reference body.
    reference: Vec<Vec3>,
    dim: usize,
}

/// What an obstacle is given beside its shape.
#[derive(Debug, Clone)]
pub(super) struct Placement {
    pub obstacle: Obstacle,
    pub centre: Option<[f64; 3]>,
    pub pose: Option<String>,
    pub settled: bool,
}

impl Placement {
    /// The contribution on a body.
    pub fn on(&self, given: &Settings, body: &BodyEnergy) -> Result<ObstacleContact, FemError> {
        let mesh = body.discretization().mesh();
        let (dim, surface) = (mesh.dim(), &given.surface);
        let refuse = |what| given.refusal(what);
        self.obstacle.check(dim).map_err(|error| refuse(error.to_string()))?;
        let surfaces = [Surface { name: surface, facets: mesh.facets_of(surface)? }];
        defaults::check_layer(given, mesh, &surfaces[0].facets).map_err(refuse)?;
        let usual = defaults::thickness(mesh, &surfaces[0].facets);
        let layer = given.on(&surfaces, body, usual)?;
        let thickness = layer.thickness;
        let obstacle = rounded(&self.obstacle, thickness).map_err(refuse)?;
        let centre = Vec3::from(self.centre.unwrap_or_else(|| defaults::centre(&obstacle)));
        if centre.iter().any(|x| !x.is_finite()) {
            return Err(refuse("its centre is not finite".to_owned()));
        }
        let refine = |facet: &Facet| given.refine.unwrap_or_else(|| defaults::refine(&self.obstacle, mesh, facet));
        let samples = Samples::new(mesh, surface, refine)?;
        let probes = Probes::new(mesh, surface, refine)?;
        let place =
            |s| samples.parts(s).iter().map(|&(node, shape)| shape * Vec3::from(mesh.points()[node as usize])).sum();
        let reference: Vec<Vec3> = (0..samples.len()).map(place).collect();
        let least = reference.iter().map(|x| obstacle.distance(&(*x).into())).fold(f64::INFINITY, f64::min);
        let inset = if self.settled && least > -thickness { (thickness - least).max(0.0) } else { 0.0 };
        within_grid(&obstacle, thickness).map_err(refuse)?;
        let normals = normals(&samples, &reference, &obstacle, dim);
        let depth = 0.5 * defaults::half_thickness(&obstacle, dim);
        let (offsets, layer) = (Vec::new(), layer.before(Moved { centre, name: self.pose.clone() }));
        let with = RigidObstacle { obstacle, centre, inset, offsets, depth, samples, probes, reference, dim };
        Ok(BoundContact { layer, with, normals })
    }
}

impl RigidObstacle {
    /// How deep inside the obstacle the gap of a sample counts from.
    fn offset(&self, sample: usize) -> f64 {
        self.inset + self.offsets.get(sample).copied().unwrap_or(0.0)
    }

    /// What the pressure at a sample depends on: its distance from the obstacle at a pose, and the offset.
    fn distance(&self, pose: &Pose, sample: usize, x: &Vec3) -> f64 {
        pose.distance(&self.obstacle, x) + self.offset(sample)
    }

    /// The same with its derivatives.
    fn signed_distance(&self, pose: &Pose, sample: usize, x: &Vec3) -> SignedDistance {
        pose.signed_distance(&self.obstacle, x).plus(self.offset(sample))
    }

    fn place(&self, sample: usize, u: &[f64]) -> Vec3 {
        self.reference[sample] + self.samples.of(sample, self.dim, |dof| u[dof])
    }

    /// Place of a sample, and what the pressure there depends on.
    fn placed(&self, pose: &Pose, sample: usize, u: &[f64]) -> (Vec3, f64) {
        let place = self.place(sample, u);
        (place, self.distance(pose, sample, &place))
    }

    /// Whether the distances of samples differ by no more than the samples are apart.
    fn is_lipschitz(&self) -> bool {
        self.offsets.is_empty() && !matches!(self.obstacle, Obstacle::Grid(_))
    }

    /// The distance by which it is known how far a sample may go: of a grid one that changes no faster than the obstacle is steep.
    fn guarded(&self, pose: &Pose, sample: usize, x: &Vec3) -> f64 {
        pose.guarded(&self.obstacle, x) + self.offset(sample)
    }

    /// The same of a sample whose distance is known.
    fn guarded_from(&self, pose: &Pose, sample: usize, (x, d): &(Vec3, f64)) -> f64 {
        match self.obstacle {
            Obstacle::Grid(_) => self.guarded(pose, sample, x),
            _ => *d,
        }
    }

    /// The change of a sample's place along one of the unknowns.
    fn moved(&self, sample: usize, du: &[f64]) -> Vec3 {
        self.samples.of(sample, self.dim, |dof| du[dof])
    }
}

impl Counterpart for RigidObstacle {
    type State = Gaps;
    type Stencil<'a> = BeforeObstacle<'a>;
    const COUPLES_BEYOND_PATTERN: bool = false;

    fn state(of: &ObstacleContact, at: &Instant, all: bool) -> Result<Gaps, Inadmissible> {
        Gaps::at(of, at, all)
    }

    fn stencils<'a>(of: &'a ObstacleContact, state: &'a Gaps, _: &'a [f64]) -> Vec<BeforeObstacle<'a>> {
        state.touches.iter().map(|touch| BeforeObstacle::new(of, &state.pose, touch)).collect()
    }

    fn gaps(_: &ObstacleContact, state: &Gaps) -> Vec<f64> {
        state.all.iter().map(|(_, (_, d))| *d).collect()
    }

    fn nearest(of: &ObstacleContact, state: &Gaps, _: &Instant) -> Option<Nearest> {
        let own = &of.with;
        let remaining = |&(sample, (x, d)): &Placed| (x, d - own.offset(sample));
        let (place, gap) = state.all.iter().map(remaining).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let sunk = state.all.iter().map(|(_, (_, d))| -d).fold(f64::NEG_INFINITY, f64::max);
        let depth = |sample| own.offset(sample) - own.distance(&state.pose, sample, &own.reference[sample]);
        let approach = state.touches.iter().map(|touch| depth(touch.sample)).fold(0.0, f64::max);
        Some(Nearest { gap, place, sunk, approach })
    }

    fn extent(&self) -> Extent {
        let (area, samples) = (self.samples.weights.iter().sum::<f64>(), self.samples.len());
        let share = area / samples as f64;
        let apart = if self.dim == 3 { share.sqrt() } else { share };
        let radius = match self.obstacle {
            Obstacle::Sphere { radius, .. } | Obstacle::Capsule { radius, .. } => radius,
            _ => f64::INFINITY,
        };
        let between_samples = apart * apart / (8.0 * radius);
        Extent { area, samples, inset: self.inset, between_samples, is_exact: !self.offsets.is_empty() }
    }

    /// By conservative advancement: no sample goes deeper than half of what is known of the obstacle's inside, in a load step than a few thicknesses, or near the
    /// limit of the log law.
    fn longest_move(of: &ObstacleContact, gaps: &Gaps, at: &Instant, by: &Move) -> f64 {
        let (own, law, pose) = (&of.with, of.layer.law, &gaps.pose);
        let depth = if by.to.is_some() { MAX_DEPTH * of.layer.thickness } else { own.depth };
        if law == ContactLaw::Cubic && depth.is_infinite() {
            return 1.0;
        }
        let end = by.to.map_or(*pose, |to| Pose::at(&at.under(to), own.centre));
        let steepest = own.obstacle.steepest();
        let safe = |least: f64, [x, dx]: [&Vec3; 2], differ: [f64; 2]| {
            least - steepest * pose.reach(&end, x, dx, differ) >= floor(law, least, depth)
        };
        let shares =
            gaps.moving(of, at.u, |sample| own.moved(sample, by.way), safe).into_iter().map(|((sample, here), dx)| {
                let (x, d) = (here.0, own.guarded_from(pose, sample, &here));
                let (reach, floor) = (steepest * pose.reach(&end, &x, &dx, [0.0; 2]), floor(law, d, depth));
                if d - reach >= floor {
                    return 1.0;
                }
                let pose_at = |share: f64| {
                    by.to.map_or(*pose, |to| Pose::at(&at.under(&at.controls.blend(to, share)), own.centre))
                };
                let distance = |share: f64| own.guarded(&pose_at(share), sample, &(x + share * dx));
                Advance { floor, nearest: floor + BOUND_TOLERANCE * (d - floor), reach, most: 1.0 }.share(distance)
            });
        shares.fold(1.0, f64::min)
    }

    /// The mean of the samples, by their shares of the node.
    fn nodal_pressures(of: &ObstacleContact, at: &Instant) -> Vec<(u32, f64)> {
        let k = at.control(of.layer.stiffness);
        let of_touches = |gaps: Gaps| -> Vec<(usize, f64)> {
            let stencils = Self::stencils(of, &gaps, at.u);
            let push = |s: &BeforeObstacle| of.layer.pressure(k, s.gap()).value * s.steepness();
            stencils.iter().map(|stencil| (stencil.number(), push(stencil))).collect()
        };
        Samples::nodal_means(&[(&of.with.samples, Gaps::at(of, at, false).map(of_touches).unwrap_or_default())])
    }

    fn between(of: &ObstacleContact, at: &Instant, touch: &Touch) -> Option<(f64, [f64; 3])> {
        let nearest = (touch.smallest_gap, Vec3::from(touch.deepest));
        let pose = Pose::at(at, of.with.centre);
        let (gap, place) = of.with.probes.least(&of.with.obstacle, &pose, at.u, nearest);
        Some((gap, place.into()))
    }

    fn exact(of: &ObstacleContact, at: &Instant) -> Option<ExactContact> {
        exact::step(of, at)
    }
}

/// `n . u` at every sample.
fn normals(samples: &Samples, reference: &[Vec3], obstacle: &Obstacle, dim: usize) -> Vec<Vec<(u32, f64)>> {
    let of_sample = |sample: usize| samples.component(sample, &obstacle.at(&reference[sample].into()).normal(), dim);
    (0..samples.len()).map(of_sample).collect()
}

/// A box with edges that are round enough for a layer: its faces stay. A meshed solid grows when rounded, so that has to be asked for.
fn rounded(obstacle: &Obstacle, thickness: f64) -> Result<Obstacle, String> {
    let least = defaults::MIN_ROUNDING_RATIO * thickness;
    match obstacle {
        Obstacle::Box { low, high, rounding } if *rounding < least => {
            let half = (0..3).map(|i| 0.5 * (high[i] - low[i])).fold(f64::INFINITY, f64::min);
            Ok(obstacle.clone().rounded(least.min(0.9 * half)))
        }
        Obstacle::Solid { rounding, .. } if *rounding < least => Err(format!(
            "a meshed obstacle needs a rounding radius of at least {least:.3e}, twice the thickness of the layer, by which it grows (it \
             has {rounding:.3e}): give `rounding`, or a thinner layer by `thickness`, or put its distance on a `grid`"
        )),
        _ => Ok(obstacle.clone()),
    }
}

/// A layer where the distance is interpolated.
fn within_grid(obstacle: &Obstacle, thickness: f64) -> Result<(), String> {
    match obstacle {
        Obstacle::Grid(grid) if grid.margin() < thickness => Err(format!(
            "its layer, {thickness:.3e} thick, is thicker than the margin of the obstacle's grid, {:.3e}: give a thinner layer by `thickness`, or \
             the grid a wider margin",
            grid.margin()
        )),
        _ => Ok(()),
    }
}
