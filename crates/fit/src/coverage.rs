use std::fmt;

use nastic_tensor::cofactor;

use crate::{Mode, Test};

/// Which shapes tests have seen: what a law of many numbers is not known beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Kinds without a test, of tension, equibiaxial tension (a balloon is one) and a planar one (simple shear is one).
    pub missing: Vec<Mode>,
    /// Range of `I1 = |F|^2`, from 3 at rest.
    pub first: [f64; 2],
    /// Range of `I2 = |H|^2`.
    pub second: [f64; 2],
}

impl Coverage {
    /// Of all tests of shape, taken as of a material without fibres.
    pub fn of(tests: &[Test]) -> Self {
        let kinds = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar];
        let has = |kind: &Mode| tests.iter().any(|test| test.mode.kind() == Some(*kind));
        let mut out = Coverage {
            missing: kinds.into_iter().filter(|kind| !has(kind)).collect(),
            first: [3.0; 2],
            second: [3.0; 2],
        };
        for test in tests.iter().filter(|test| test.mode.kind().is_some()) {
            for f in test.points.iter().filter_map(|[x, _]| test.mode.gradient(*x)) {
                for (range, value) in
                    [(&mut out.first, f.norm_squared()), (&mut out.second, cofactor(&f).norm_squared())]
                {
                    *range = [range[0].min(value), range[1].max(value)];
                }
            }
        }
        out
    }
}

/// What is missing, and the ranges of the invariants.
impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seen = |[from, to]: [f64; 2]| format!("{from:.4} to {to:.4}");
        let ranges = format!("I1 {}, I2 {}", seen(self.first), seen(self.second));
        let missing: Vec<&str> = self.missing.iter().map(|kind| kind.name()).collect();
        match missing.is_empty() {
            true => write!(f, "the tests have seen {ranges}: beyond, nothing is known of it"),
            false => write!(
                f,
                "no test of kind {}, and the others have seen {ranges}: in other shapes its stresses may be wrong by any factor; measure them, or take a law of few parameters",
                missing.join(", ")
            ),
        }
    }
}
