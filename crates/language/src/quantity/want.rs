//! [`Want`]: dimension and range that a key demands of its number.

use crate::quantity::Dimension;

/// The sign a key demands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sign {
    /// Any finite number.
    Any,
    /// >= 0
    NotNegative,
    /// > 0
    Positive,
}

/// Dimension and sign a key demands of its number; part of the one description the reader and the schema share.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Want {
    /// `None`: decided later (a control's bounds take the dimension of what they control).
    pub dimension: Option<Dimension>,
    /// Checked where the value is a constant.
    pub sign: Sign,
    /// Whether a formula may change in time.
    pub in_time: bool,
}

impl Want {
    /// Anything.
    pub const ANY: Self = Self { dimension: None, sign: Sign::Any, in_time: false };
    /// Anything, which may change in time.
    pub const ANY_IN_TIME: Self = Self::ANY.in_time();
    /// Anything, > 0.
    pub const ANY_POSITIVE: Self = Self { dimension: None, sign: Sign::Positive, in_time: false };
    /// Anything, >= 0.
    pub const ANY_NOT_NEGATIVE: Self = Self { dimension: None, sign: Sign::NotNegative, in_time: false };
    /// A plain number.
    pub const NUMBER: Self = Self::a(Dimension::NONE);
    /// A plain number, which may change in time.
    pub const NUMBER_IN_TIME: Self = Self::NUMBER.in_time();
    /// A plain number > 0.
    pub const POSITIVE: Self = Self::NUMBER.positive();
    /// A plain number >= 0.
    pub const NOT_NEGATIVE: Self = Self { dimension: Some(Dimension::NONE), sign: Sign::NotNegative, in_time: false };
    /// A length.
    pub const LENGTH: Self = Self::a(Dimension::LENGTH);
    /// A length, which may change in time.
    pub const LENGTH_IN_TIME: Self = Self::LENGTH.in_time();
    /// A length > 0.
    pub const POSITIVE_LENGTH: Self = Self::LENGTH.positive();
    /// An area > 0.
    pub const POSITIVE_AREA: Self = Self::a(Dimension::of(2, 0, 0, 0)).positive();
    /// A length >= 0.
    pub const NOT_NEGATIVE_LENGTH: Self =
        Self { dimension: Some(Dimension::LENGTH), sign: Sign::NotNegative, in_time: false };
    /// A curvature, 1 over a length.
    pub const CURVATURE: Self = Self::a(Dimension::of(-1, 0, 0, 0));
    /// A force.
    pub const FORCE: Self = Self::a(Dimension::FORCE);
    /// A time.
    pub const TIME: Self = Self::a(Dimension::TIME);
    /// A time > 0.
    pub const POSITIVE_TIME: Self = Self::a(Dimension::TIME).positive();
    /// A time >= 0.
    pub const NOT_NEGATIVE_TIME: Self =
        Self { dimension: Some(Dimension::TIME), sign: Sign::NotNegative, in_time: false };
    /// 1 over a time, >= 0.
    pub const NOT_NEGATIVE_RATE: Self =
        Self { dimension: Some(Dimension::RATE), sign: Sign::NotNegative, in_time: false };
    /// A density > 0.
    pub const DENSITY: Self = Self::a(Dimension::DENSITY).positive();
    /// A pressure, which may change in time.
    pub const PRESSURE_IN_TIME: Self = Self::PRESSURE.in_time();
    /// A force per volume, which may change in time.
    pub const BODY_FORCE_IN_TIME: Self = Self::BODY_FORCE.in_time();
    /// A velocity.
    pub const VELOCITY: Self = Self::a(Dimension::VELOCITY);
    /// A velocity > 0.
    pub const POSITIVE_VELOCITY: Self = Self::VELOCITY.positive();
    /// An acceleration.
    pub const ACCELERATION: Self = Self::a(Dimension::ACCELERATION);
    /// An acceleration, which may change in time.
    pub const ACCELERATION_IN_TIME: Self = Self::ACCELERATION.in_time();
    /// A viscosity >= 0.
    pub const VISCOSITY: Self = Self { dimension: Some(Dimension::VISCOSITY), sign: Sign::NotNegative, in_time: false };
    /// A pressure.
    pub const PRESSURE: Self = Self::a(Dimension::PRESSURE);
    /// A pressure > 0.
    pub const POSITIVE_PRESSURE: Self = Self::PRESSURE.positive();
    /// A magnetic field.
    pub const FIELD: Self = Self::a(Dimension::FIELD);
    /// A force per volume.
    pub const BODY_FORCE: Self = Self::a(Dimension::BODY_FORCE);
    /// A force per length and area > 0.
    pub const STIFFNESS_PER_AREA: Self = Self::a(Dimension::BODY_FORCE).positive();
    /// A force per length > 0.
    pub const STIFFNESS: Self = Self::a(Dimension::STIFFNESS).positive();
    /// A magnetic permeability > 0.
    pub const PERMEABILITY: Self = Self::a(Dimension::PERMEABILITY).positive();

    /// A quantity of this dimension.
    #[must_use]
    pub const fn a(dimension: Dimension) -> Self {
        Self { dimension: Some(dimension), sign: Sign::Any, in_time: false }
    }

    /// The same, > 0.
    #[must_use]
    pub(crate) const fn positive(self) -> Self {
        Self { sign: Sign::Positive, ..self }
    }

    /// The same, where a formula may change in time.
    #[must_use]
    pub(crate) const fn in_time(self) -> Self {
        Self { in_time: true, ..self }
    }

    /// Whether a constant has the demanded sign; the text says what was wanted.
    pub(crate) fn refuses(self, value: f64) -> Option<&'static str> {
        match self.sign {
            Sign::Positive if value <= 0.0 => Some("must be positive"),
            Sign::NotNegative if value < 0.0 => Some("must not be negative"),
            _ => None,
        }
    }
}
