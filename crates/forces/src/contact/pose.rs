//! [`Pose`]: where an obstacle is, how it moves, and derivatives by the controls that move it.

use crate::rigid_motion::{each_slot, vectors};
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::instant::Instant;
use nastic_body::rotation::{rotation, spin, spin_inverse, spin_transposed_change, vector};
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_tensor::{Mat3, Vec3};

/// An obstacle moved by a translation tau and a rotation vector theta about its centre c:
/// `d(x) = d_0(c + R^T y)`, `y = x - c - tau`; in a time step with the velocities `(tau - tau_n)/h` and `Omega = log(R R_n^T)/h`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    centre: Vec3,
    pub translation: Vec3,
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

/// Derivatives of `lambda . T` by a rigid motion of the obstacle: at the end of the step, and of its velocities.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ByPose {
    pub translation: Vec3,
    /// By a turn omega of R, `R -> exp(omega) R`.
    pub turn: Vec3,
    /// By the velocity of the translation.
    pub velocity: Vec3,
    /// By Omega.
    pub spin: Vec3,
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
    pub fn is_at(&self, other: &Pose) -> bool {
        self.translation == other.translation && self.theta == other.theta
    }

    /// How far at most an obstacle that goes to another pose moves near x, against a point there that goes by dx meanwhile, or one whose place and
    /// move differ from these by so much.
    pub fn reach(&self, to: &Pose, (x, dx): (&Vec3, &Vec3), [apart, differs]: [f64; 2]) -> f64 {
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

    /// Of the obstacle's point at x.
    pub fn velocity(&self, x: &Vec3) -> Vec3 {
        self.velocity_of(&self.arm(x))
    }

    /// Of the obstacle's point with an arm.
    pub fn velocity_of(&self, arm: &Vec3) -> Vec3 {
        self.motion.map_or(Vec3::zeros(), |m| m.velocity + m.turned.cross(arm) / m.elapsed)
    }

    /// `[Omega x]`
    pub fn spin_matrix(&self) -> Mat3 {
        self.motion.map_or(Mat3::zeros(), |m| (m.turned / m.elapsed).cross_matrix())
    }

    /// Adds the derivatives by the controls at the end of the step and at its beginning.
    pub fn add_vjp(&self, at: &Instant, by: &ByPose, dim: usize, into: &mut Sensitivities) {
        let (mut translation, mut turn) = (by.translation, by.turn);
        if let Some(m) = self.motion {
            let inverse = spin_inverse(&m.turned);
            translation += by.velocity / m.elapsed;
            turn += inverse.transpose() * by.spin / m.elapsed;
            // log(R exp(-omega) R_n^T) changes by -J(-phi)^-1 omega
            let before = -(inverse * by.spin) / m.elapsed;
            let before = spin(&m.theta_before).transpose() * before;
            each_slot(dim, -by.velocity / m.elapsed, before, |slot, value| into.before.add_control(at, slot, value));
        }
        let rotation = spin(&self.theta).transpose() * turn;
        each_slot(dim, translation, rotation, |slot, value| into.add_control(at, slot, value));
    }

    /// Adds the derivatives by a pose that the step begins with, which has no velocities.
    pub fn add_vjp_before(&self, at: &Instant, by: &ByPose, dim: usize, into: &mut Sensitivities) {
        let rotation = spin(&self.theta).transpose() * by.turn;
        each_slot(dim, by.translation, rotation, |slot, value| into.before.add_control(at, slot, value));
    }

    /// The turn omega of R along a change of theta.
    pub fn turn_along(&self, dtheta: &Vec3) -> Vec3 {
        spin(&self.theta) * dtheta
    }

    /// The change of the derivative by theta, `J(theta)^T m`, where m changes by dm along a change of theta.
    pub fn rotation_change(&self, m: &Vec3, dm: &Vec3, dtheta: &Vec3) -> Vec3 {
        spin(&self.theta).transpose() * dm + spin_transposed_change(&self.theta, dtheta, m)
    }
}
