//! [`TouchPoint`]: a contact at one displacement.

use super::bound::{BoundContact, FRICTION, STIFFNESS};
use super::friction::{Slip, without_lagged};
use super::lagged::LaggedFriction;
use super::law::{ContactLaw, Pressure, Push};
use super::pose::{ByPose, Pose};
use super::second_order;
use crate::guides::{add_element, element};
use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_mesh::spatial::SignedDistance;
use nastic_tensor::{Mat3, Vec3};
use std::borrow::Cow;
use std::ops::Range;

/// Below this share of its gap (of the cubic law its gap and a depth) no move brings a sample.
const REST_OF_GAP: f64 = 0.1;
/// Tries of conservative advancement, and the share of the way that it leaves.
const ADVANCES: usize = 64;
const NEAR: f64 = 1e-3;

/// Where the samples of a contact are.
#[derive(Debug, Clone)]
pub(super) struct Gaps {
    pub pose: Pose,
    /// Of samples their place and distance: of all but those of facets that are `far`.
    pub all: Vec<Placed>,
    /// Facets (by their place among `between`) whose samples between nodes are all beyond the layer, and how far away they are at least.
    pub far: Vec<(usize, f64)>,
    /// Those within the layer.
    pub touches: Vec<Touch>,
}

/// A sample, its place and its distance.
pub(super) type Placed = (usize, (Vec3, f64));

/// A sample within the layer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub sample: usize,
    pub place: Vec3,
    pub distance: SignedDistance,
}

/// What acts at a sample, per area: the residual `t = -P n + mu P f(v_t)` and what its derivatives take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Traction {
    pub n: Vec3,
    pub pressure: Pressure,
    pub push: Push,
    /// `v_s - v_o`
    pub relative: Vec3,
    pub slip: Option<(f64, Slip)>,
    pub t: Vec3,
}

impl Gaps {
    /// Samples of facets that are far away are left out.
    pub fn at(of: &BoundContact, at: &Instant) -> Result<Self, Inadmissible> {
        let mut found = Self::none(of, at);
        found.add(of, at, 0..of.samples.at_nodes())?;
        for (k, between) in of.samples.between.iter().enumerate() {
            let (first, _, reach) = between.about(|node| found.all[node].1.0);
            let least = found.all[first].1.1 - reach;
            match of.is_lipschitz() && least >= of.thickness {
                true => found.far.push((k, least)),
                false => found.add(of, at, between.samples.clone())?,
            }
        }
        Ok(found)
    }

    /// Those of every sample, by their numbers.
    pub fn of_all(of: &BoundContact, at: &Instant) -> Result<Self, Inadmissible> {
        let mut found = Self::none(of, at);
        found.add(of, at, 0..of.samples.len())?;
        Ok(found)
    }

    fn none(of: &BoundContact, at: &Instant) -> Self {
        let all = Vec::with_capacity(of.samples.len());
        Gaps { pose: Pose::at(at, of.centre), all, far: Vec::new(), touches: Vec::new() }
    }

    fn add(&mut self, of: &BoundContact, at: &Instant, samples: Range<usize>) -> Result<(), Inadmissible> {
        for sample in samples {
            let (place, d) = of.placed(&self.pose, sample, at.u);
            self.all.push((sample, (place, d)));
            if of.law == ContactLaw::Log && d <= 0.0 {
                return Err(Inadmissible::Penetrates { name: of.name.clone(), place: place.into(), depth: -d });
            }
            if d < of.thickness {
                let distance = of.signed_distance(&self.pose, (sample, &place));
                self.touches.push(Touch { sample, place, distance });
            }
        }
        Ok(())
    }

    /// The samples with what they move by, in a move of the nodes by `dx`; without those far facets of which it is `safe`: their least distance, place
    /// and move of one of their nodes, and how much those of their samples differ from these at most.
    pub fn moving(
        &self,
        of: &BoundContact,
        u: &[f64],
        dx: impl Fn(usize) -> Vec3,
        safe: impl Fn(f64, [&Vec3; 2], [f64; 2]) -> bool,
    ) -> Vec<(Placed, Vec3)> {
        let mut all: Vec<(Placed, Vec3)> = self.all.iter().map(|here| (*here, dx(here.0))).collect();
        for &(k, least) in &self.far {
            let between = &of.samples.between[k];
            let (_, x, apart) = between.about(|node| self.all[node].1.0);
            let (_, way, differs) = between.about(&dx);
            if !safe(least, [&x, &way], [apart, differs]) {
                let placed = |sample| ((sample, of.placed(&self.pose, sample, u)), dx(sample));
                all.extend(between.samples.clone().map(placed));
            }
        }
        all
    }
}

impl BoundContact {
    pub(super) fn traction(&self, touch: &Touch, pose: &Pose, at: &Instant) -> Traction {
        let n = Vec3::from(touch.distance.normal());
        let unit = self.law.at(touch.distance.value, self.thickness);
        let k = at.control(STIFFNESS);
        let pressure =
            Pressure { energy: k * unit.energy, value: k * unit.value, slope: k * unit.slope, second: k * unit.second };
        let push = Push::of(&pressure, &touch.distance);
        let mut t = -push.value * n;
        let (mut relative, mut slip) = (Vec3::zeros(), None);
        if let (Some(e), Some(_)) = (self.slip_speed, at.step) {
            let own = self.samples.of(touch.sample, self.dim, |dof| at.velocity(dof));
            relative = own - pose.velocity(&touch.place);
            let (mu, found) = (at.control(FRICTION), Slip::at(&(relative - n * n.dot(&relative)), e));
            t += mu * push.value * found.share;
            slip = Some((mu, found));
        }
        Traction { n, pressure, push, relative, slip, t }
    }
}

impl Traction {
    /// Minus the part of A by which friction grows with the pressure: without it the symmetric part of the tangent is definite where the body's is,
    /// also where samples slide, but for the curvature and the spin of the obstacle.
    fn less_by_pressure(&self) -> Mat3 {
        self.slip.as_ref().map_or(Mat3::zeros(), |(mu, slip)| -*mu * slip.share * self.push.change.transpose())
    }

    /// `A = dt/dx` at fixed relative velocity and `B = dt/d(v_s - v_o)`.
    pub fn tangents(&self, distance: &SignedDistance) -> [Mat3; 2] {
        let (n, p, push, g) = (self.n, self.pressure, self.push, Vec3::from(distance.gradient));
        let mut by_place = -p.slope * g * g.transpose() - p.value * distance.hessian();
        let Some((mu, slip)) = &self.slip else { return [by_place, Mat3::zeros()] };
        let turn = distance.normal_change();
        let turned = n.dot(&self.relative) * turn + n * (turn.transpose() * self.relative).transpose();
        by_place += *mu * (slip.share * push.change.transpose() - push.value * slip.slope * turned);
        [by_place, *mu * push.value * slip.slope * (Mat3::identity() - n * n.transpose())]
    }
}

/// A [`BoundContact`] at one displacement and pose.
pub(super) struct TouchPoint<'a> {
    pub of: &'a BoundContact,
    gaps: Gaps,
}

impl<'a> TouchPoint<'a> {
    pub fn new(of: &'a BoundContact, gaps: Gaps) -> Self {
        TouchPoint { of, gaps }
    }

    /// Those at the pose of an instant, which other controls may have moved.
    pub fn gaps(&self, at: &Instant) -> Result<Cow<'_, Gaps>, Inadmissible> {
        match Pose::at(at, self.of.centre) == self.gaps.pose {
            true => Ok(Cow::Borrowed(&self.gaps)),
            false => Gaps::at(self.of, at).map(Cow::Owned),
        }
    }

    /// Calls with every touching sample: the tangent by its place in the scheme, and what is added for its stand-in.
    fn each_tangent(
        &self,
        at: &Instant,
        mut call: impl FnMut(&Touch, [Mat3; 2]) -> Result<(), Inadmissible>,
    ) -> Result<(), Inadmissible> {
        let gaps = self.gaps(at)?;
        let at = &without_lagged(at, self.of.lagged);
        let c = at.step.map_or(0.0, |step| step.velocity.0) * Mat3::identity() - gaps.pose.spin_matrix();
        for touch in &gaps.touches {
            let traction = self.of.traction(touch, &gaps.pose, at);
            let [a, b] = traction.tangents(&touch.distance);
            let weight = self.of.samples.weights[touch.sample];
            call(touch, [weight * (a + b * c), weight * traction.less_by_pressure()])?;
        }
        Ok(())
    }
}

/// How near a sample may come in a move of one `reach`: a tenth of its gap is left; the cubic law bears a depth more.
pub(super) fn floor(law: ContactLaw, d: f64, depth: f64) -> f64 {
    let sunk = if law == ContactLaw::Cubic { depth + (-d).max(0.0) } else { 0.0 };
    REST_OF_GAP * (d + sunk) - sunk
}

/// The longest share of a move, over which a distance changes by no more than `reach`, that keeps it above its floor, by conservative advancement.
pub(super) fn advance((d, floor): (f64, f64), reach: f64, distance: impl Fn(f64) -> f64) -> f64 {
    let mut share = 0.0;
    for _ in 0..ADVANCES {
        let gap = distance(share) - floor;
        if gap >= (1.0 - share) * reach {
            return 1.0;
        }
        if gap <= NEAR * (d - floor) {
            break;
        }
        share += gap / reach;
    }
    share
}

impl ContributionPoint for TouchPoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (gaps, of, friction) = (self.gaps(at)?, self.of, LaggedFriction::at(self.of, at)?);
        if let Some(friction) = &friction {
            friction.add_residual(at, demand, sums);
        }
        let at = &without_lagged(at, of.lagged);
        for touch in &gaps.touches {
            let (weight, traction) = (of.samples.weights[touch.sample], of.traction(touch, &gaps.pose, at));
            if demand.energy {
                sums.energy += weight * traction.pressure.energy;
                sums.energy_scale += weight * traction.pressure.energy.abs();
            }
            if demand.force {
                of.add_force(touch.sample, weight * traction.t, sums);
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if let Some(friction) = LaggedFriction::at(self.of, at)? {
            friction.add_tangent(at, tangent)?;
        }
        let rubs = self.of.slip_speed.is_some() && !tangent.is_symmetric();
        self.each_tangent(at, |touch, [block, aside]| {
            let parts = self.of.samples.parts(touch.sample);
            let nodes: Vec<u32> = parts.iter().map(|(node, _)| *node).collect();
            let of = |block: &Mat3, [a, i, b, j]: [usize; 4]| parts[a].1 * parts[b].1 * block[(i, j)];
            add_element(&nodes, self.of.dim, tangent, |a, i, b, j| of(&block, [a, i, b, j]))?;
            if rubs && aside != Mat3::zeros() {
                let element = element(&nodes, self.of.dim, |a, i, b, j| of(&aside, [a, i, b, j]));
                tangent.add_aside(&nodes, element);
            }
            Ok(())
        })
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        if let Some(friction) = LaggedFriction::at(self.of, at)? {
            friction.add_tangent_product(at, v, out);
        }
        self.each_tangent(at, |touch, [block, _]| {
            let product = block * self.of.samples.of(touch.sample, self.of.dim, |dof| v[dof]);
            self.of.spread(touch.sample, &product, out);
            Ok(())
        })?;
        Ok(true)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        if self.of.law == ContactLaw::Cubic && self.of.depth.is_infinite() {
            return Ok(1.0);
        }
        let gaps = self.gaps(at)?;
        let steepest = self.of.obstacle.steepest();
        let move_of = |sample| self.of.samples.of(sample, self.of.dim, |dof| du[dof]);
        let safe = |least: f64, [_, dx]: [&Vec3; 2], [_, differs]: [f64; 2]| {
            steepest * (dx.norm() + differs) <= (1.0 - REST_OF_GAP) * least
        };
        let moving = gaps.moving(self.of, at.u, move_of, safe);
        let shares = moving.iter().map(|((sample, here), dx)| {
            let (sample, x, d) = (*sample, here.0, self.of.guarded_from(&gaps.pose, *sample, here));
            let reach = steepest * dx.norm();
            if reach <= (1.0 - REST_OF_GAP) * d {
                return 1.0;
            }
            let floor = floor(self.of.law, d, self.of.depth);
            advance((d, floor), reach, |share| self.of.guarded(&gaps.pose, (sample, &(x + share * dx))))
        });
        Ok(shares.fold(1.0, f64::min))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let (gaps, of) = (self.gaps(at)?, self.of);
        let spin = gaps.pose.spin_matrix();
        let (mut by, mut by_stiffness, mut by_friction) = (ByPose::default(), 0.0, 0.0);
        let lagged = LaggedFriction::at(of, at)?;
        let pushing = &without_lagged(at, of.lagged);
        for touch in &gaps.touches {
            let traction = of.traction(touch, &gaps.pose, pushing);
            let [a, b] = traction.tangents(&touch.distance);
            let weighted = of.samples.weights[touch.sample] * of.samples.of(touch.sample, of.dim, |dof| lambda[dof]);
            let (by_place, by_velocity) = (a.transpose() * weighted, b.transpose() * weighted);
            let arm = gaps.pose.arm(&touch.place);
            by_stiffness += weighted.dot(&traction.t) / at.control(STIFFNESS);
            if let Some((_, slip)) = &traction.slip {
                by_friction += traction.push.value * weighted.dot(&slip.share);
                of.spread(touch.sample, &by_velocity, &mut into.velocity);
            }
            // omega x t - A (omega x y) - B (omega x w), omega taken out
            by.turn += traction.t.cross(&weighted) - arm.cross(&by_place) - traction.relative.cross(&by_velocity);
            by.translation -= by_place + spin * by_velocity;
            by.velocity -= by_velocity;
            by.spin -= arm.cross(&by_velocity);
        }
        if let Some(friction) = &lagged {
            friction.vjp(at, lambda, &mut by, into);
        }
        gaps.pose.add_vjp(at, &by, of.dim, into);
        into.add_control(at, STIFFNESS, by_stiffness);
        if of.slip_speed.is_some() {
            into.add_control(at, FRICTION, by_friction);
        }
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        second_order::add_control_product(self, at, v, out)
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        second_order::second_vjp(self, at, lambda, along, into)
    }
}

impl BoundContact {
    /// Adds a force of the residual at a sample.
    pub(super) fn add_force(&self, sample: usize, force: Vec3, sums: &mut Sums) {
        for &(node, shape) in self.samples.parts(sample) {
            for i in 0..self.dim {
                let (dof, force) = (self.dim * node as usize + i, shape * force[i]);
                sums.force[dof] += force;
                sums.force_scale[dof] += force.abs();
            }
        }
    }

    /// Adds a force at a sample to the nodes of its facet.
    pub(super) fn spread(&self, sample: usize, force: &Vec3, out: &mut [f64]) {
        for &(node, shape) in self.samples.parts(sample) {
            (0..self.dim).for_each(|i| out[self.dim * node as usize + i] += shape * force[i]);
        }
    }
}
