//! [`BeforeObstacle`]: a sample before an obstacle.

use super::ObstacleContact;
use super::gaps::Touch;
use crate::contact::law::Pressure;
use crate::contact::pose::Pose;
use crate::contact::rubbing::{Rubbing, gradient_of};
use crate::contact::stencil::{Feet, Part, Stencil};
use nastic_tensor::HyperDual;
use nastic_tensor::{Mat3, Vec3};

/// A sample in the layer of an obstacle. Its slots are its place x, the translation tau and a turn omega of the obstacle: with the arm y and `g = grad d`
///
/// ```text
/// G = (g, -g, -y x g)
/// H b = (dg, -dg, -(b_x - b_tau) x g - y x dg),     dg = b_omega x g + H z,  z = b_x - b_tau - b_omega x y
/// ```
///
/// and along b the product `H a`, a of the place alone, changes by the place by `b_omega x H a + H'[z] a - H (b_omega x a)`.
pub(crate) struct BeforeObstacle<'a> {
    of: &'a ObstacleContact,
    touch: &'a Touch,
    /// y
    arm: Vec3,
    gradient: [Vec3; 3],
}

impl<'a> BeforeObstacle<'a> {
    pub fn new(of: &'a ObstacleContact, pose: &Pose, touch: &'a Touch) -> Self {
        let arm = pose.arm(&touch.place);
        BeforeObstacle { of, touch, arm, gradient: moved(Vec3::from(touch.distance.gradient), &arm) }
    }

    fn normal(&self) -> Vec3 {
        Vec3::from(self.touch.distance.normal())
    }

    /// `dP/dx = p' m grad d + p dm/dx`
    fn push_change(&self, pressure: &Pressure) -> Vec3 {
        let along = pressure.slope * self.steepness() * self.gradient[0];
        along + pressure.value * Vec3::from(self.touch.distance.steepness_change())
    }

    /// `v_s - v_o`
    fn relative(&self, [own, velocity, omega]: &[Vec3; 3]) -> Vec3 {
        own - (velocity + omega.cross(&self.arm))
    }

    /// The tangent by the place, and minus the part of it by which friction grows with the pressure: without that the symmetric part is definite where the body's is,
    /// also where samples slide, but for the curvature and the spin of the obstacle.
    fn block(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>) -> (Mat3, Option<Mat3>) {
        let (g, p, weight) = (self.gradient[0], pressure, self.weight());
        let mut by_place = -p.slope * g * g.transpose() - p.value * self.touch.distance.hessian();
        let Some(friction) = friction else { return (weight * by_place, None) };
        let (n, mu, push, slip) = (self.normal(), friction.coulomb.coefficient, friction.push(0), friction.slip(0));
        let (change, relative) = (self.push_change(p), self.relative(&friction.velocities));
        let turn = self.touch.distance.normal_change();
        let turned = n.dot(&relative) * turn + n * (turn.transpose() * relative).transpose();
        by_place += mu * (slip.share * change.transpose() - push * slip.slope * turned);
        let by_velocity = mu * push * slip.slope * (Mat3::identity() - n * n.transpose());
        let by_motion = friction.coulomb.rate * Mat3::identity() - friction.velocities[2].cross_matrix();
        let less = -mu * slip.share * change.transpose();
        (weight * (by_place + by_velocity * by_motion), Some(weight * less).filter(|less| *less != Mat3::zeros()))
    }
}

/// By the slots, of what changes by the place as `by_place` and moves with the obstacle.
fn moved(by_place: Vec3, arm: &Vec3) -> [Vec3; 3] {
    [by_place, -by_place, -arm.cross(&by_place)]
}

impl Stencil for BeforeObstacle<'_> {
    fn number(&self) -> usize {
        self.touch.sample
    }

    fn weight(&self) -> f64 {
        self.of.with.samples.weights[self.touch.sample]
    }

    fn gap(&self) -> f64 {
        self.touch.distance.value
    }

    fn remaining_gap(&self) -> f64 {
        self.gap() - self.of.with.offset(self.touch.sample)
    }

    fn steepness(&self) -> f64 {
        self.touch.distance.steepness()
    }

    fn gradient(&self) -> &[Vec3; 3] {
        &self.gradient
    }

    fn push_gradient(&self, pressure: &Pressure) -> [Vec3; 3] {
        moved(self.push_change(pressure), &self.arm)
    }

    fn second(&self, a: &[Vec3; 3], b: &[Vec3; 3]) -> [[Vec3; 3]; 3] {
        let (g, y, h) = (self.gradient[0], &self.arm, self.touch.distance.hessian());
        let along = |[x, tau, omega]: &[Vec3; 3]| {
            let way = x - tau;
            let z = way - omega.cross(y);
            let dg = omega.cross(&g) + h * z;
            (way, z, [dg, -dg, -(way.cross(&g) + y.cross(&dg))])
        };
        let ((_, _, of_a), (way, z, of_b), (x, omega)) = (along(a), along(b), (a[0], b[2]));
        let third = Vec3::from(self.touch.distance.third(z.into(), x.into()));
        let change = omega.cross(&of_a[0]) + third - h * omega.cross(&x);
        let turn = -(x.cross(&of_b[0]) + way.cross(&of_a[0]) + y.cross(&change));
        [of_a, of_b, [change, -change, turn]]
    }

    fn slots(&self, of: impl Fn(usize) -> f64, pose: &[Vec3; 2]) -> [Vec3; 3] {
        [self.of.with.samples.of(self.touch.sample, self.dim(), of), pose[0], pose[1]]
    }

    fn of_pose(values: &[Vec3; 3]) -> [Vec3; 2] {
        [values[1], values[2]]
    }

    fn resultant(&self, forces: &[Vec3; 3], u: &[f64], pivot: &Vec3) -> [Vec3; 2] {
        let place = self.of.with.place(self.touch.sample, u);
        [-forces[0], -(place - pivot).cross(&forces[0])]
    }

    fn dim(&self) -> usize {
        self.of.layer.dim
    }

    fn parts(&self) -> impl Iterator<Item = Part> {
        let parts = self.of.with.samples.parts(self.touch.sample).iter();
        parts.map(|&(node, share)| Part { node, slot: 0, share })
    }

    fn tangent(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>) -> (Vec<f64>, Option<Vec<f64>>) {
        let (block, aside) = self.block(pressure, friction);
        let element = |block: Mat3| self.element(|[_, i], [_, j]| block[(i, j)]);
        (element(block), aside.map(element))
    }

    fn tangent_by_velocity(&self, friction: &Rubbing<'_, Self>, factor: f64) -> Vec<f64> {
        let n = self.normal();
        let plane = Mat3::identity() - n * n.transpose();
        let strength = friction.coulomb.rate * (factor * friction.push(0));
        let block = strength * plane * friction.slip(0).slope * plane;
        self.element(|[_, i], [_, j]| block[(i, j)])
    }

    fn change(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>, along: &[Vec3; 3]) -> [Vec3; 3] {
        [self.block(pressure, friction).0 * along[0], Vec3::zeros(), Vec3::zeros()]
    }
}

impl Feet for BeforeObstacle<'_> {
    type Slots = [Vec3; 3];

    fn feet(&self) -> usize {
        1
    }

    fn part(&self, _: usize) -> f64 {
        self.steepness()
    }

    fn slides(&self, _: usize, velocities: &[Vec3; 3]) -> Vec3 {
        let (n, relative) = (self.normal(), self.relative(velocities));
        relative - n * n.dot(&relative)
    }

    fn spread_sliding(&self, force: impl Fn(usize) -> Vec3) -> [Vec3; 3] {
        moved(force(0), &self.arm)
    }

    /// With `b` and `c` the derivatives of `P phi` by `v_t` and `w_t`, `W = dn/dx` and the relative velocities v and w
    ///
    /// ```text
    /// by x        a + Omega x b,     a = phi dP/dx - W^T ((n.v) b + (n.w) c)
    /// by omega    -y x a - n x ((n.v) b + (n.w) c)
    /// ```
    fn by_place(
        &self,
        pressure: &Pressure,
        [v, w]: [&[Vec3; 3]; 2],
        phi: impl Fn([HyperDual; 3], [HyperDual; 3]) -> HyperDual,
    ) -> [Vec3; 3] {
        let (n, push) = (self.normal(), pressure.value * self.steepness());
        let fields = [v, w].map(|field| self.relative(field));
        let [v_t, w_t] = fields.map(|field| field - n * n.dot(&field));
        let (value, by) = gradient_of(phi, [&v_t, &w_t]);
        let [b, c] = by.map(|by| push * (by - n * n.dot(&by)));
        let across = n.dot(&fields[0]) * b + n.dot(&fields[1]) * c;
        let a = value * self.push_change(pressure) - self.touch.distance.normal_change().transpose() * across;
        let by_place = a + v[2].cross(&b) + w[2].cross(&c);
        [by_place, -by_place, -(self.arm.cross(&a) + n.cross(&across))]
    }
}
