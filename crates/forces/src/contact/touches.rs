//! What a contact carries at an instant.

use super::bound::BoundContact;
use super::lagged::LaggedFriction;
use super::point::{Acting, Pressed};
use super::pose::{self, ByPose};
use super::rubbing::Rubbing;
use super::slots::scaled;
use super::stencil::{Counterpart, Nearest, Stencil};
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::{ExactContact, Onsets, RigidPose, Sliding, Touch, TouchParameters, Touches};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_tensor::Vec3;

/// What the samples in the layer carry together.
#[derive(Default)]
struct Carried {
    /// Force and moment about the pivot.
    resultant: [Vec3; 2],
    area: f64,
    pressing: f64,
    /// Gaps, weighted by what presses there.
    gaps: f64,
    largest: f64,
    /// What presses where friction acts, and of that what slides slower than the slip speed.
    borne: f64,
    sticking: f64,
    speed: f64,
}

impl Carried {
    fn add<S: Stencil>(&mut self, pressed: &Pressed<S>, u: &[f64], pivot: &Vec3) {
        let (stencil, weight, push) = (pressed.stencil, pressed.stencil.weight(), pressed.push());
        pose::add(&mut self.resultant, stencil.resultant(&pressed.forces(1.0), u, pivot), weight);
        self.area += weight;
        self.largest = self.largest.max(push);
        self.pressing += weight * push;
        self.gaps += weight * push * stencil.remaining_gap();
        if let Some(friction) = &pressed.friction {
            self.slide(friction, weight * push);
        }
    }

    fn slide<S: Stencil>(&mut self, friction: &Rubbing<S>, pressing: f64) {
        let slides = friction.slides();
        self.borne += pressing;
        self.sticking += pressing * slides.sticking;
        self.speed = self.speed.max(slides.fastest);
    }
}

impl<W: Counterpart> Touches for BoundContact<W> {
    fn pose(&self, at: &Instant) -> Option<RigidPose> {
        self.layer.moved.as_ref().map(|moved| moved.rigid_pose(&self.layer.name, at))
    }

    fn touch(&self, at: &Instant) -> Option<Touch> {
        let state = W::state(self, at, true).ok()?;
        let lagged = LaggedFriction::at(self, at).ok()?;
        let (mut carried, pivot) =
            (Carried::default(), self.layer.pose(at).map(|pose| pose.pivot()).unwrap_or_default());
        Acting::of(self, at).each(self, &state, |pressed| carried.add(pressed, at.u, &pivot));
        if let Some(lagged) = &lagged {
            lagged.each(|friction| {
                let (stencil, forces) = (friction.stencil, friction.forces(lagged.strength(friction)));
                pose::add(&mut carried.resultant, stencil.resultant(&forces, at.u, &pivot), 1.0);
                carried.slide(friction, stencil.weight() * friction.pressure.value * stencil.steepness());
            });
        }
        let Nearest { gap, place, sunk, approach } = W::nearest(self, &state, at)?;
        let share = |part: f64, whole: f64, none: f64| if whole > 0.0 { part / whole } else { none };
        let sticking = share(carried.sticking, carried.borne, 1.0);
        Some(Touch {
            force: carried.resultant[0].into(),
            pressing: carried.pressing,
            moment: carried.resultant[1].into(),
            area: carried.area,
            smallest_gap: gap,
            deepest: place.into(),
            between: None,
            largest_pressure: W::largest_pressure(self, &state, at, carried.largest),
            mean_gap: share(carried.gaps, carried.pressing, 0.0),
            approach,
            sunk,
            sliding: self.layer.slip_speed.map(|slip_speed| Sliding { sticking, speed: carried.speed, slip_speed }),
        })
    }

    fn between(&self, at: &Instant, touch: &Touch) -> Option<(f64, [f64; 3])> {
        W::between(self, at, touch)
    }

    fn add_pressing(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        let at = &Instant { step: None, ..*at };
        let (mut sum, mut by_pose, mut by_stiffness, acting) = (0.0, ByPose::default(), 0.0, Acting::of(self, at));
        acting.each(self, &W::state(self, at, false)?, |pressed| {
            let (stencil, weight, push) = (pressed.stencil, pressed.stencil.weight(), pressed.push());
            let [value, slope] = by(push);
            sum += weight * value;
            by_stiffness += weight * slope * push / acting.stiffness;
            let by_slots = scaled(stencil.push_gradient(&pressed.pressure), weight * slope);
            stencil.spread(&by_slots, |dof, value| by_u[dof] += value);
            pose::add(&mut by_pose.place, W::Stencil::of_pose(&by_slots), 1.0);
        });
        self.layer.add_pose_vjp(at, &by_pose, into);
        into.add_control(at, self.layer.stiffness, by_stiffness);
        Ok(sum)
    }

    fn add_pressures(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        W::add_pressures(self, at, by, by_u, into)
    }

    fn add_slip(
        &self,
        at: &Instant,
        q: u32,
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<Option<f64>, Inadmissible> {
        if self.layer.slip_speed.is_none() {
            return Ok(None);
        }
        let (mut sum, mut by_pose, acting) = (0.0, ByPose::default(), Acting::sliding(self, at));
        acting.each(self, &W::state(self, at, false)?, |Pressed { stencil, friction, .. }| {
            let Some(friction) = friction else { return };
            let (value, by) = friction.slipping(q);
            let [by_place, by_velocity] = by.map(|by| scaled(by, stencil.weight()));
            sum += stencil.weight() * value;
            stencil.spread(&by_place, |dof, value| by_u[dof] += value);
            stencil.spread(&by_velocity, |dof, value| into.velocity[dof] += value);
            pose::add(&mut by_pose.place, W::Stencil::of_pose(&by_place), 1.0);
            pose::add(&mut by_pose.velocity, W::Stencil::of_pose(&by_velocity), 1.0);
        });
        self.layer.add_pose_vjp(at, &by_pose, into);
        into.add_control(at, self.layer.stiffness, sum / acting.stiffness);
        Ok(Some(sum))
    }

    fn resists_at(&self, at: &Instant) -> Option<Vec<Vec<(u32, f64)>>> {
        let (state, mut found) = (W::state(self, at, true).ok()?, Vec::new());
        Acting::of(self, &Instant { step: None, ..*at }).each(self, &state, |pressed| {
            let mut terms = Vec::new();
            let normals = scaled(pressed.stencil.gradient().clone(), 1.0 / pressed.stencil.steepness());
            pressed.stencil.spread(&normals, |dof, slope| terms.push((dof as u32, slope)));
            found.push(terms);
        });
        Some(found)
    }

    fn onsets(&self, at: &Instant) -> Option<Onsets> {
        let state = W::state(self, at, true).ok()?;
        let gaps = W::gaps(self, &state);
        let (mut found, mut slides) = (Onsets::default(), vec![Vec::new(); gaps.len()]);
        Acting::sliding(self, at).each(self, &state, |pressed| {
            if let (Some(friction), Some(e)) = (&pressed.friction, self.layer.slip_speed) {
                slides[pressed.stencil.number()] = friction.speeds().map(|speed| speed / e).collect();
            }
        });
        gaps.iter().zip(&slides).for_each(|(gap, slides)| found.add(gap / self.layer.thickness, slides));
        Some(found)
    }

    fn parameters(&self) -> TouchParameters {
        let (layer, extent) = (&self.layer, self.with.extent());
        TouchParameters {
            thickness: layer.thickness,
            area: extent.area,
            inset: extent.inset,
            stiffness: layer.slots[layer.stiffness].rest(),
            friction: layer.slip_speed.map(|slip_speed| (layer.slots[layer.friction()].rest(), slip_speed)),
            lagged: layer.lagged,
            samples: extent.samples,
            between_samples: extent.between_samples,
        }
    }

    fn exact(&self, at: &Instant) -> Option<ExactContact> {
        W::exact(self, at)
    }

    fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)> {
        W::nodal_pressures(self, at)
    }
}
