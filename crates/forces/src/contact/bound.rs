//! [`BoundContact`]: a contact on a body.

use super::point::{Gaps, Placed, TouchPoint, advance, floor};
use super::pose::Pose;
use super::probes::Probes;
use super::samples::Samples;
use super::{Contact, ContactLaw, defaults, friction};
use crate::rigid_motion;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::touches::Touches;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::Symmetry;
use nastic_mesh::Facet;
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_tensor::Vec3;

/// Slots behind those of the pose.
pub(super) const STIFFNESS: usize = 6;
pub(super) const FRICTION: usize = 7;
/// How deep, in thicknesses, samples of the cubic law may be in a load step before the body yields.
const DEPTH: f64 = 3.0;

/// The contribution of a [`Contact`].
#[derive(Debug, Clone)]
pub struct BoundContact {
    pub(super) name: String,
    pub(super) dim: usize,
    pub(super) obstacle: Obstacle,
    pub(super) centre: Vec3,
    pub(super) law: ContactLaw,
    /// delta
    pub(super) thickness: f64,
    /// How deep inside the obstacle gaps count from.
    pub(super) inset: f64,
    /// How much further at every sample, by [`exact`](super::exact); none without.
    pub(super) offsets: Vec<f64>,
    /// How deep a sample of the cubic law may come in an iteration: no obstacle is crossed.
    pub(super) depth: f64,
    /// e, with friction.
    pub(super) slip_speed: Option<f64>,
    /// Friction takes its normal forces where the step begins.
    pub(super) lagged: bool,
    pub(super) samples: Samples,
    pub(super) probes: Probes,
    /// Positions of the samples in the reference body.
    pub(super) reference: Vec<Vec3>,
    pub(super) slots: Vec<Slot>,
    /// The name of the pose, where it is not that of the contact.
    pose: Option<String>,
    /// Displacements that it resists to.
    normals: Vec<Vec<(u32, f64)>>,
}

impl BoundContact {
    /// How deep inside the obstacle the gap of a sample counts from.
    pub(super) fn offset(&self, sample: usize) -> f64 {
        self.inset + self.offsets.get(sample).copied().unwrap_or(0.0)
    }

    /// What the pressure at a sample depends on: its distance from the obstacle at a pose, and the offset.
    pub(super) fn distance(&self, pose: &Pose, (sample, x): (usize, &Vec3)) -> f64 {
        pose.distance(&self.obstacle, x) + self.offset(sample)
    }

    /// The same with its derivatives.
    pub(super) fn signed_distance(&self, pose: &Pose, (sample, x): (usize, &Vec3)) -> SignedDistance {
        pose.signed_distance(&self.obstacle, x).plus(self.offset(sample))
    }

    /// Place of a sample, and what the pressure there depends on.
    pub(super) fn placed(&self, pose: &Pose, sample: usize, u: &[f64]) -> (Vec3, f64) {
        let place = self.reference[sample] + self.samples.of(sample, self.dim, |dof| u[dof]);
        (place, self.distance(pose, (sample, &place)))
    }

    /// Whether the distances of samples differ by no more than the samples are apart.
    pub(super) fn is_lipschitz(&self) -> bool {
        self.offsets.is_empty() && !matches!(self.obstacle, Obstacle::Grid(_))
    }

    /// The distance by which it is told how far a sample may go: of a grid one that changes no faster than the obstacle is steep.
    pub(super) fn guarded(&self, pose: &Pose, (sample, x): (usize, &Vec3)) -> f64 {
        pose.guarded(&self.obstacle, x) + self.offset(sample)
    }

    /// The same of a sample whose distance is known.
    pub(super) fn guarded_from(&self, pose: &Pose, sample: usize, (x, d): &(Vec3, f64)) -> f64 {
        match self.obstacle {
            Obstacle::Grid(_) => self.guarded(pose, (sample, x)),
            _ => *d,
        }
    }

    /// The name of its pose.
    pub(super) fn pose_name(&self) -> &str {
        self.pose.as_deref().unwrap_or(&self.name)
    }

    pub(super) fn new(of: &Contact, body: &BodyEnergy) -> Result<Self, FemError> {
        let mesh = body.discretization().mesh();
        let (dim, name) = (mesh.dim(), of.name.clone());
        let refuse = |what: String| FemError::Meaningless { what: format!("contact \"{}\": {what}", of.name) };
        of.obstacle.check(dim).map_err(|error| refuse(error.to_string()))?;
        let facets = mesh.facets_of(&of.surface)?;
        let positive = |what: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => Err(refuse(format!("its {what} is {value}; it must be positive and finite"))),
        };
        defaults::check_layer(&of.layer, mesh, &facets).map_err(refuse)?;
        let thickness = of.layer.thickness.unwrap_or_else(|| defaults::thickness(mesh, &facets));
        let usual = defaults::stiffness(of.layer.law, body, &facets);
        defaults::check_stiffness(of.layer.stiffness, usual).map_err(refuse)?;
        let stiffness = of.layer.stiffness.or(usual).ok_or_else(|| {
            refuse(format!("no passive law behind {} says how stiff the body is: give a stiffness", of.surface))
        })?;
        let stiffness = positive("stiffness", stiffness)?;
        let slots = slots(of, stiffness)?;
        let obstacle = rounded(&of.obstacle, thickness).map_err(refuse)?;
        let centre = Vec3::from(of.centre.unwrap_or_else(|| defaults::centre(&obstacle)));
        if centre.iter().any(|x| !x.is_finite()) {
            return Err(refuse("its centre is not finite".to_owned()));
        }
        let refine = |facet: &Facet| of.layer.refine.unwrap_or_else(|| defaults::refine(&of.obstacle, mesh, facet));
        let samples = Samples::new(mesh, &of.surface, refine)?;
        let probes = Probes::new(mesh, &of.surface, refine)?;
        let place =
            |s| samples.parts(s).iter().map(|&(node, shape)| shape * Vec3::from(mesh.points()[node as usize])).sum();
        let reference: Vec<Vec3> = (0..samples.len()).map(place).collect();
        let least = reference.iter().map(|x| obstacle.distance(&(*x).into())).fold(f64::INFINITY, f64::min);
        let inset = if of.settled && least > -thickness { (thickness - least).max(0.0) } else { 0.0 };
        within_grid(&obstacle, thickness).map_err(refuse)?;
        let normals = normals(&samples, &reference, &obstacle, dim);
        let depth = 0.5 * defaults::half_thickness(&obstacle, dim);
        let slip_speed = of.layer.friction.map(|friction| friction.slip_speed);
        Ok(BoundContact {
            name,
            dim,
            obstacle,
            centre,
            law: of.layer.law,
            thickness,
            inset,
            offsets: Vec::new(),
            depth,
            slip_speed,
            lagged: of.layer.lagged,
            samples,
            probes,
            reference,
            slots,
            pose: of.pose.clone(),
            normals,
        })
    }
}

/// `n . u` at every sample.
fn normals(samples: &Samples, reference: &[Vec3], obstacle: &Obstacle, dim: usize) -> Vec<Vec<(u32, f64)>> {
    let of_sample = |sample: usize| samples.component(sample, &obstacle.at(&reference[sample].into()).normal(), dim);
    (0..samples.len()).map(of_sample).collect()
}

/// The pose, loads; stiffness and friction, designs with the values at rest that were given.
fn slots(of: &Contact, stiffness: f64) -> Result<Vec<Slot>, FemError> {
    let friction = of.layer.friction.map(|friction| friction.slot(&of.name)).transpose()?;
    let designs = [Slot::design("stiffness", "Pa", stiffness)].into_iter().chain(friction);
    Ok(rigid_motion::SLOTS.into_iter().chain(designs).collect())
}

/// A box with edges that are round enough for a layer: its faces stay. A meshed solid grows when rounded, so that has to be asked for.
fn rounded(obstacle: &Obstacle, thickness: f64) -> Result<Obstacle, String> {
    let least = defaults::ROUNDING * thickness;
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

impl Contribution for BoundContact {
    fn name(&self) -> &str {
        &self.name
    }

    fn symmetry(&self) -> Symmetry {
        if self.slip_speed.is_some() && !self.lagged { Symmetry::General } else { Symmetry::Symmetric }
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn shared_slots(&self) -> Option<(&str, usize)> {
        self.pose.as_deref().map(|name| (name, rigid_motion::SLOTS.len()))
    }

    fn path_dependence(&self) -> Option<&'static str> {
        self.slip_speed.map(|_| friction::PATH)
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        rigid_motion::check(&format!("contact \"{}\": its obstacle", self.name), self.dim, values)?;
        friction::check_controls(&self.name, values[STIFFNESS], values.get(FRICTION).copied())
    }

    /// Normals of the obstacle where it is at rest, at every sample: a side that is not touched does not push, which the search for an
    /// equilibrium finds.
    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.normals
    }

    /// Within the layer, or no deeper than it is thick.
    fn check_start(&self, at: &Instant) -> Result<(), Inadmissible> {
        let gaps = Gaps::of_all(self, at)?;
        let gap = |(sample, (x, d)): &Placed| (*x, d - self.offset(*sample) + self.inset);
        match gaps.all.iter().map(gap).min_by(|a, b| a.1.total_cmp(&b.1)) {
            // multipliers begin at an equilibrium, however deep its layer let it in
            Some((place, d)) if d < -self.thickness && self.offsets.is_empty() => {
                Err(Inadmissible::Penetrates { name: self.name.clone(), place: place.into(), depth: -d })
            }
            _ => Ok(()),
        }
    }

    /// No sample goes below a few thicknesses inside, or near the limit of the log law.
    fn max_change(&self, at: &Instant, to: &Instant) -> Result<f64, Inadmissible> {
        let gaps = Gaps::at(self, at)?;
        let ([from, end_of], mut share) = ([at.controls, to.controls], 1.0_f64);
        let (pose, end) = (gaps.pose, Pose::at(&at.under(end_of), self.centre));
        if pose.is_at(&end) && at.u == to.u {
            return Ok(1.0);
        }
        let (steepest, depth) = (self.obstacle.steepest(), DEPTH * self.thickness);
        let move_of = |sample| self.samples.of(sample, self.dim, |dof| to.u[dof] - at.u[dof]);
        let safe = |least: f64, [x, dx]: [&Vec3; 2], differ: [f64; 2]| {
            least - steepest * pose.reach(&end, (x, dx), differ) >= floor(self.law, least, depth)
        };
        for ((sample, here), dx) in gaps.moving(self, at.u, move_of, safe) {
            let (x, d) = (here.0, self.guarded_from(&pose, sample, &here));
            let reach = steepest * pose.reach(&end, (&x, &dx), [0.0; 2]);
            let floor = floor(self.law, d, depth);
            if d - reach < floor {
                let distance = |s: f64| {
                    let pose = Pose::at(&at.under(&from.blend(end_of, s)), self.centre);
                    self.guarded(&pose, (sample, &(x + s * dx)))
                };
                share = share.min(advance((d, floor), reach, distance));
            }
        }
        Ok(share)
    }

    fn touches(&self) -> Option<&dyn Touches> {
        Some(self)
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.told(at).map(|touch| touch.quantities(self.dim)).unwrap_or_default()
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(TouchPoint::new(self, Gaps::at(self, at)?)))
    }
}
