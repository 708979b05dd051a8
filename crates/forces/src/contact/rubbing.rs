//! [`Rubbing`]: Coulomb friction at a sample.

use super::friction::{Coulomb, Slip, dissipation, share};
use super::law::Pressure;
use super::stencil::Stencil;
use nastic_tensor::Vec3;
use nastic_tensor::{HyperDual, Scalar};

/// Least share of a foot in a sample's pressure for its sliding to be reported.
const MIN_FOOT_SHARE: f64 = 1e-3;

/// Friction at a sample, by its pressure and the velocities v of its slots: at every foot the force `mu P_i f(v_t,i)` per area.
pub(super) struct Rubbing<'s, S: Stencil + 's> {
    pub stencil: &'s S,
    pub pressure: Pressure,
    pub velocities: S::Slots,
    pub coulomb: Coulomb,
}

/// How a sample slides.
pub(super) struct Slides {
    /// Share of its pressure at feet that slide slower than the slip speed.
    pub sticking: f64,
    pub fastest: f64,
}

impl<'s, S: Stencil + 's> Rubbing<'s, S> {
    /// `P_i`
    pub fn push(&self, foot: usize) -> f64 {
        self.pressure.value * self.stencil.part(foot)
    }

    pub fn slip(&self, foot: usize) -> Slip {
        Slip::at(&self.stencil.slides(foot, &self.velocities), self.coulomb.slip_speed)
    }

    /// Forces on the slots, `factor` in the place of mu.
    pub fn forces(&self, factor: f64) -> S::Slots {
        self.stencil.spread_sliding(|foot| factor * self.push(foot) * self.slip(foot).share)
    }

    /// The change of the forces along one of the velocities, which is symmetric; `factor` in the place of mu.
    pub fn by_velocity(&self, along: &S::Slots, factor: f64) -> S::Slots {
        self.stencil
            .spread_sliding(|foot| factor * self.push(foot) * self.slip(foot).slope * self.stencil.slides(foot, along))
    }

    /// The derivative of `lambda . F` by the slots at fixed velocities, F the forces with 1 in the place of mu.
    pub fn by_place(&self, lambda: &S::Slots) -> S::Slots {
        let e = self.coulomb.slip_speed;
        self.stencil.by_place(&self.pressure, [&self.velocities, lambda], |v, lambda| {
            let f = share(v, e);
            f[0] * lambda[0] + f[1] * lambda[1] + f[2] * lambda[2]
        })
    }

    /// Power that is lost per area, smoothed like f; `factor` in the place of mu.
    pub fn dissipation(&self, factor: f64) -> f64 {
        let of_foot = |foot| factor * self.push(foot) * dissipation(self.speed(foot), self.coulomb.slip_speed);
        (0..self.stencil.feet()).map(of_foot).sum()
    }

    /// `sum_i P_i (|v_t,i| / e)^2q` with its derivatives by the slots, at fixed velocities, and by these.
    pub fn slipping(&self, q: u32) -> (f64, [S::Slots; 2]) {
        let (e, q) = (self.coulomb.slip_speed, i32::try_from(q).unwrap_or(i32::MAX));
        let share = |foot| {
            let slides = self.stencil.slides(foot, &self.velocities);
            (slides, slides.norm_squared() / (e * e))
        };
        let sum = (0..self.stencil.feet()).map(|foot| self.push(foot) * share(foot).1.powi(q)).sum();
        let by_velocity = self.stencil.spread_sliding(|foot| {
            let (slides, square) = share(foot);
            2.0 * self.push(foot) * (f64::from(q) * square.powi((q - 1).max(0))) / (e * e) * slides
        });
        let by_place = self.stencil.by_place(&self.pressure, [&self.velocities; 2], |v, _| {
            let square = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / HyperDual::of(e * e);
            (0..q).fold(HyperDual::of(1.0), |power, _| power * square)
        });
        (sum, [by_place, by_velocity])
    }

    /// Speeds at feet that count.
    pub fn speeds(&self) -> impl Iterator<Item = f64> + '_ {
        self.feet().map(|foot| self.speed(foot))
    }

    pub fn slides(&self) -> Slides {
        let slow = |foot: &usize| self.speed(*foot) < self.coulomb.slip_speed;
        let sum = |parts: &mut dyn Iterator<Item = usize>| parts.map(|foot| self.stencil.part(foot)).sum::<f64>();
        let (sticking, all) = (sum(&mut self.feet().filter(slow)), sum(&mut self.feet()));
        Slides { sticking: if all > 0.0 { sticking / all } else { 0.0 }, fastest: self.speeds().fold(0.0, f64::max) }
    }

    /// Those that have more than almost no part in the pressure.
    fn feet(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.stencil.feet()).filter(|&foot| self.stencil.part(foot) > MIN_FOOT_SHARE)
    }

    fn speed(&self, foot: usize) -> f64 {
        self.stencil.slides(foot, &self.velocities).norm()
    }
}

/// `f` of such a field of numbers with derivatives, and its derivatives by both arguments, each of numbers.
pub(super) fn gradient_of(
    phi: impl Fn([HyperDual; 3], [HyperDual; 3]) -> HyperDual,
    [v, w]: [&Vec3; 2],
) -> (f64, [Vec3; 2]) {
    let (mut value, mut by) = (0.0, [Vec3::zeros(); 2]);
    for i in 0..3 {
        let along = |x: &Vec3, part: usize| -> [HyperDual; 3] {
            std::array::from_fn(|j| {
                let mut parts = [x[j], 0.0, 0.0, 0.0];
                parts[part] = if i == j { 1.0 } else { 0.0 };
                HyperDual(parts)
            })
        };
        let HyperDual([found, by_v, by_w, _]) = phi(along(v, 1), along(w, 2));
        value = found;
        (by[0][i], by[1][i]) = (by_v, by_w);
    }
    (value, by)
}
