use nastic_tensor::Scalar;

/// An invariant that a network may have as input: convex in `F` and `J`, or in `H` and `J`, a function `x(q, J)` of a square `q` and of `J`.
/// Each enters less its value at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkInput {
    /// `J^(-2/3) |F|^2 - 3`
    FirstIsochoric,
    /// `(J^(-4/3) |H|^2)^(3/2) - 3 sqrt 3`
    SecondIsochoric,
    /// `J^(-2/3) |F a|^2 - 1`
    FiberIsochoric,
    /// `(J^(-4/3) |H a|^2)^(3/2) - 1`
    AcrossIsochoric,
    /// `|F|^2 - 3`
    First,
    /// `|H|^2 - 3`
    Second,
    /// `J - 1`
    Jacobian,
    /// `|F a|^2 - 1`
    Fiber,
    /// `|H a|^2 - 1`
    Across,
}

/// Of which matrix `q` is the square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SquareOf {
    /// `F`, or `F a`.
    F,
    /// `H`, or `H a`.
    H,
    /// Neither.
    Neither,
}

impl NetworkInput {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::FirstIsochoric,
        Self::SecondIsochoric,
        Self::FiberIsochoric,
        Self::AcrossIsochoric,
        Self::First,
        Self::Second,
        Self::Jacobian,
        Self::Fiber,
        Self::Across,
    ];

    /// As files have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstIsochoric => "I1b",
            Self::SecondIsochoric => "I2b^1.5",
            Self::FiberIsochoric => "I4b",
            Self::AcrossIsochoric => "I5b^1.5",
            Self::First => "I1",
            Self::Second => "I2",
            Self::Jacobian => "J",
            Self::Fiber => "I4",
            Self::Across => "I5",
        }
    }

    /// Whether it does not change with the volume alone.
    pub fn is_isochoric(self) -> bool {
        matches!(self, Self::FirstIsochoric | Self::SecondIsochoric | Self::FiberIsochoric | Self::AcrossIsochoric)
    }

    /// Whether it needs a fibre.
    pub fn is_of_fiber(self) -> bool {
        matches!(self, Self::FiberIsochoric | Self::AcrossIsochoric | Self::Fiber | Self::Across)
    }

    /// Of what `q` is the square.
    pub fn square_of(self) -> SquareOf {
        match self {
            Self::FirstIsochoric | Self::FiberIsochoric | Self::First | Self::Fiber => SquareOf::F,
            Self::SecondIsochoric | Self::AcrossIsochoric | Self::Second | Self::Across => SquareOf::H,
            Self::Jacobian => SquareOf::Neither,
        }
    }

    /// `[p, t]` of its derivative at rest along a small strain e, `p tr e + t (a.ea)`.
    pub(crate) fn at_rest(self) -> [f64; 2] {
        match self {
            Self::FirstIsochoric | Self::SecondIsochoric => [0.0, 0.0],
            Self::FiberIsochoric => [-2.0 / 3.0, 2.0],
            Self::AcrossIsochoric => [1.0, -3.0],
            Self::First => [2.0, 0.0],
            Self::Second => [4.0, 0.0],
            Self::Jacobian => [1.0, 0.0],
            Self::Fiber => [0.0, 2.0],
            Self::Across => [2.0, -2.0],
        }
    }

    /// The input of fibres whose derivative at rest along them has the other sign.
    pub(crate) fn opposite(self) -> Option<Self> {
        match self {
            Self::FiberIsochoric => Some(Self::AcrossIsochoric),
            Self::AcrossIsochoric => Some(Self::FiberIsochoric),
            Self::Fiber => Some(Self::Across),
            Self::Across => Some(Self::Fiber),
            _ => None,
        }
    }

    /// `x`, `x_q`, `x_J`; `x` not less its value at rest.
    #[inline]
    pub fn value<T: Scalar>(self, q: T, j: T) -> [T; 3] {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        match self {
            Self::FirstIsochoric | Self::FiberIsochoric => {
                let root = j.root(3);
                let g = one / (root * root);
                let x = g * q;
                [x, g, T::of(-2.0 / 3.0) * x / j]
            }
            Self::SecondIsochoric | Self::AcrossIsochoric => {
                let g = one / (j * j);
                let x_q = T::of(1.5) * g * q.root(2);
                let x = T::of(2.0 / 3.0) * x_q * q;
                [x, x_q, T::of(-2.0) * x / j]
            }
            Self::First | Self::Second | Self::Fiber | Self::Across => [q, one, zero],
            Self::Jacobian => [j, zero, one],
        }
    }

    /// `x_qq`, `x_qJ`, `x_JJ`, of `x`, `x_q` and `x_J` there.
    #[inline]
    pub(crate) fn curvature(self, q: f64, j: f64, [x, x_q, _]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::FirstIsochoric | Self::FiberIsochoric => [0.0, -2.0 / 3.0 * x_q / j, 10.0 / 9.0 * x / (j * j)],
            Self::SecondIsochoric | Self::AcrossIsochoric => [0.5 * x_q / q, -2.0 * x_q / j, 6.0 * x / (j * j)],
            _ => [0.0; 3],
        }
    }
}
