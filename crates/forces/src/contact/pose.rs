//! [`Pose`]: where an obstacle is, how it moves, and derivatives by the controls that move it.

use crate::rigid_motion::{each_slot, vectors};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::touches::RigidPose;
use nastic_body::controls::Controls;
use nastic_body::instant::Instant;
use nastic_body::rotation::{rotation, spin, spin_inverse, spin_transposed_change, vector};
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_tensor::{Mat3, Vec3};

/// An obstacle moved by a translation tau and a rotation vector theta about its centre c:
/// `d(x) = d_0(c + R^T y)`, `y = x - c - tau`; in a time step with the velocities `(tau - tau_n)/h` and `Omega = log(R R_n^T)/h`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    centre: Vec3,
    translation: Vec3,
    theta: Vec3,
    r: Mat3,
    /// `None` in a static problem.
    motion: Option<Motion>,
}

/// What it moved by since the step began.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Motion {
    /// Time since then.
    elapsed: f64,
    velocity: Vec3,
    /// Rotation vector since then, `elapsed Omega`.
    turned: Vec3,
    theta_before: Vec3,
}

/// Derivatives by the motion of an obstacle: of its translation, of a turn omega, `R -> exp(omega) R`, and of the velocities of both.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ByPose {
    pub place: [Vec3; 2],
    pub velocity: [Vec3; 2],
}

/// Adds values of the two slots of a pose.
pub(super) fn add(to: &mut [Vec3; 2], values: [Vec3; 2], factor: f64) {
    to.iter_mut().zip(values).for_each(|(to, value)| *to += factor * value);
}

/// What is moved by the first six slots of a contact.
#[derive(Debug, Clone)]
pub(super) struct Moved {
    /// About which it turns.
    pub centre: Vec3,
    /// The name of the pose, where it is not that of the contact.
    pub name: Option<String>,
}

impl Moved {
    pub fn rigid_pose(&self, contact: &str, at: &Instant) -> RigidPose {
        let [translation, theta] = vectors(at, at.controls);
        let name = self.name.as_deref().unwrap_or(contact);
        RigidPose::new(name, self.centre.into(), translation.into(), theta.into())
    }
}

impl Pose {
    /// By the first six slots of the contribution that is asked.
    pub fn at(at: &Instant, centre: Vec3) -> Self {
        let [translation, theta] = vectors(at, at.controls);
        let r = rotation(&theta);
        let motion = at.step.filter(|step| step.elapsed > 0.0).map(|step| {
            let [before, theta_before] = vectors(at, &step.before.controls);
            let turned =
                if theta == theta_before { Vec3::zeros() } else { vector(&(r * rotation(&theta_before).transpose())) };
            let velocity = (translation - before) / step.elapsed;
            Motion { elapsed: step.elapsed, velocity, turned, theta_before }
        });
        Pose { centre, translation, theta, r, motion }
    }

    /// `x - c - tau`
    pub fn arm(&self, x: &Vec3) -> Vec3 {
        x - self.centre - self.translation
    }

    /// Where the obstacle turns about.
    pub fn pivot(&self) -> Vec3 {
        self.centre + self.translation
    }

    /// Whether the obstacle stands where another pose has it.
    fn is_at(&self, other: &Pose) -> bool {
        self.translation == other.translation && self.theta == other.theta
    }

    /// Whether nothing is moved, or it stands where it was.
    pub fn are_alike(one: &Option<Pose>, other: &Option<Pose>) -> bool {
        one.as_ref().zip(other.as_ref()).is_none_or(|(one, other)| one.is_at(other))
    }

    /// How far at most an obstacle that goes to another pose moves near x, against a point there that goes by dx meanwhile, or one whose place and
    /// move differ from these by so much.
    pub fn reach(&self, to: &Pose, x: &Vec3, dx: &Vec3, [apart, differs]: [f64; 2]) -> f64 {
        if self.is_at(to) {
            return dx.norm() + differs;
        }
        let (way, turn) = (to.translation - self.translation, (to.theta - self.theta).norm());
        let arm = self.arm(x).norm() + way.norm() + dx.norm() + apart + differs;
        (way - dx).norm() + differs + turn * arm
    }

    pub fn distance(&self, obstacle: &Obstacle, x: &Vec3) -> f64 {
        obstacle.distance(&self.within(x))
    }

    /// [`Obstacle::guarded`]
    pub fn guarded(&self, obstacle: &Obstacle, x: &Vec3) -> f64 {
        obstacle.guarded(&self.within(x))
    }

    pub fn signed_distance(&self, obstacle: &Obstacle, x: &Vec3) -> SignedDistance {
        let found = obstacle.at(&self.within(x));
        if self.theta == Vec3::zeros() { found } else { found.turned(&self.r) }
    }

    fn within(&self, x: &Vec3) -> [f64; 3] {
        let arm = self.arm(x);
        let turned = if self.theta == Vec3::zeros() { arm } else { self.r.transpose() * arm };
        (self.centre + turned).into()
    }

    /// Its velocities: of the translation, and Omega; zero in a static problem.
    pub fn rates(&self) -> [Vec3; 2] {
        self.motion.map_or([Vec3::zeros(); 2], |m| [m.velocity, m.turned / m.elapsed])
    }

    /// Adds the derivatives by the controls at the end of the step and at its beginning.
    pub fn add_vjp(&self, at: &Instant, by: &ByPose, dim: usize, into: &mut Sensitivities) {
        let ([mut translation, mut turn], [velocity, omega]) = (by.place, by.velocity);
        if let Some(m) = self.motion {
            let inverse = spin_inverse(&m.turned);
            translation += velocity / m.elapsed;
            turn += inverse.transpose() * omega / m.elapsed;
            // log(R exp(-omega) R_n^T) changes by -J(-phi)^-1 omega
            let before = -(inverse * omega) / m.elapsed;
            let before = spin(&m.theta_before).transpose() * before;
            each_slot(dim, -velocity / m.elapsed, before, |slot, value| into.before.add_control(at, slot, value));
        }
        let rotation = spin(&self.theta).transpose() * turn;
        each_slot(dim, translation, rotation, |slot, value| into.add_control(at, slot, value));
    }

    /// Adds the derivatives by a pose that the step begins with, which has no velocities.
    pub fn add_vjp_before(&self, at: &Instant, [translation, turn]: &[Vec3; 2], dim: usize, into: &mut Sensitivities) {
        let rotation = spin(&self.theta).transpose() * turn;
        each_slot(dim, *translation, rotation, |slot, value| into.before.add_control(at, slot, value));
    }

    /// The change of the slots of the pose along one of the controls.
    pub fn change(&self, at: &Instant, controls: &Controls) -> [Vec3; 2] {
        let [translation, dtheta] = vectors(at, controls);
        [translation, spin(&self.theta) * dtheta]
    }

    /// Adds the change along an increment of derivatives by the pose, `by`, which itself has a change: `J(theta)^T m` by theta.
    pub fn add_second(
        &self,
        at: &Instant,
        along: &Increment,
        dim: usize,
        [by, change]: [&[Vec3; 2]; 2],
        into: &mut SecondSensitivities,
    ) {
        let [_, dtheta] = vectors(at, along.controls);
        let rotation = spin(&self.theta).transpose() * change[1] + spin_transposed_change(&self.theta, &dtheta, &by[1]);
        each_slot(dim, change[0], rotation, |slot, value| into.add_control(at, slot, value));
    }
}
