//! [`ContactLaw`]: the pressure of a contact by its gap.

use nastic_tensor::Scalar;

/// The potential of a contact per reference area, `psi(d)`, d the signed distance, delta the thickness of its layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactLaw {
    /// `psi = (k delta/3) (1 - d/delta)^3` below delta: pressure `k (1 - d/delta)^2`, which closes the gap where it reaches k, and goes on
    /// inside. Its curvature is bounded.
    #[default]
    Cubic,
    /// `psi = -k delta (d/delta - 1)^2 ln(d/delta)` below delta: infinite at `d = 0`, which nothing reaches; a start inside is refused.
    Log,
}

/// Energy per area and pressure at a distance, with derivatives by the distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pressure {
    /// psi
    pub energy: f64,
    /// `p = -psi'`
    pub value: f64,
    /// `p'`
    pub slope: f64,
    /// `p''`
    pub second: f64,
}

impl Pressure {
    pub fn times(self, k: f64) -> Self {
        Pressure { energy: k * self.energy, value: k * self.value, slope: k * self.slope, second: k * self.second }
    }

    /// p where the gap differs by a change of value zero, with its derivatives.
    pub fn along<T: Scalar>(&self, change: T) -> T {
        T::of(self.value) + (T::of(self.slope) + T::of(0.5 * self.second) * change) * change
    }
}

impl ContactLaw {
    /// What it is called in case files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ContactLaw::Cubic => "cubic",
            ContactLaw::Log => "log",
        }
    }

    /// The law of a name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        [ContactLaw::Cubic, ContactLaw::Log].into_iter().find(|law| law.name() == name)
    }

    /// Per unit of stiffness, at `d < delta`; of the log law at d > 0.
    pub(super) fn at(self, d: f64, delta: f64) -> Pressure {
        let s = d / delta;
        match self {
            ContactLaw::Cubic => {
                let t = 1.0 - s;
                Pressure {
                    energy: delta / 3.0 * t * t * t,
                    value: t * t,
                    slope: -2.0 / delta * t,
                    second: 2.0 / (delta * delta),
                }
            }
            ContactLaw::Log => {
                let (t, log) = (s - 1.0, s.ln());
                Pressure {
                    energy: -delta * t * t * log,
                    value: 2.0 * t * log + t * t / s,
                    slope: (2.0 * log + 4.0 * t / s - t * t / (s * s)) / delta,
                    second: (2.0 / s + 4.0 / (s * s) - 2.0 * t / (s * s) + 2.0 * t * t / (s * s * s)) / (delta * delta),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of ipc-toolkit 1.6.1: `b(1e-4; 1e-3)` of its barrier is `delta psi / k`, and those of the cubic law by hand.
    #[test]
    fn agrees_with_the_barrier_of_another_code() {
        let (d, delta) = (1e-4, 1e-3);
        let log = ContactLaw::Log.at(d, delta);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * b.abs();
        assert!(close(delta * log.energy, 1.8650939253e-6), "{log:?}");
        assert!(close(-delta * log.value, -1.224465317e-2), "{log:?}");
        assert!(close(-delta * log.slope, 121.605170188), "{log:?}");
        let cubic = ContactLaw::Cubic.at(d, delta);
        assert!(close(cubic.energy, 2.43e-4) && close(cubic.value, 0.81) && close(cubic.slope, -1800.0), "{cubic:?}");
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for law in [ContactLaw::Cubic, ContactLaw::Log] {
            for d in [0.03, 0.2, 0.55, 0.99] {
                let (at, h) = (|d| law.at(d, 0.7), 1e-4);
                let d = 0.7 * d;
                let slope = |f: &dyn Fn(f64) -> f64| {
                    (8.0 * (f(d + h) - f(d - h)) - (f(d + 2.0 * h) - f(d - 2.0 * h))) / (12.0 * h)
                };
                let close = |a: f64, b: f64| (a - b).abs() < 1e-7 * b.abs().max(1.0);
                assert!(close(-at(d).value, slope(&|d| at(d).energy)), "{law:?} {d}");
                assert!(close(at(d).slope, slope(&|d| at(d).value)), "{law:?} {d}");
                assert!(close(at(d).second, slope(&|d| at(d).slope)), "{law:?} {d}");
            }
        }
    }
}
