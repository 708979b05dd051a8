//! [`Analysis`]: what `solve` computes.

/// What `nastic solve` computes.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Analysis {
    /// The equilibrium at the start controls.
    #[default]
    Equilibrium,
    /// The equilibrium, and where it is unstable a stable one below it: `--minimum`.
    Minimum,
    /// The equilibrium, and the one of exact contact: `--exact-contact`.
    ExactContact,
    /// The state, equilibrium or motion, and the one whose contacts have layers half as thick: `--half-thickness`.
    HalfThickness,
    /// The equilibrium and so many smallest eigenvalues of its tangent, with their modes: `--modes N`.
    Modes(usize),
    /// Equilibria with one control going from a value to another: `--ramp CONTROL=FROM:TO:N`.
    Ramp(String),
    /// The path of equilibria from rest to the start controls, through limit points: `--path`.
    Path,
    /// The same, to the first limit point: `--path --stop-at limit`.
    PathToLimit,
    /// The equilibrium and up to so many in all under the same controls, by deflation: `--equilibria N`.
    Equilibria(usize),
}

impl Analysis {
    /// The option of `solve` that asks for it; none for the plain state.
    #[must_use]
    pub fn option(&self) -> Option<&'static str> {
        match self {
            Self::Equilibrium => None,
            Self::Minimum => Some("--minimum"),
            Self::ExactContact => Some("--exact-contact"),
            Self::HalfThickness => Some("--half-thickness"),
            Self::Modes(_) => Some("--modes"),
            Self::Ramp(_) => Some("--ramp"),
            Self::Path | Self::PathToLimit => Some("--path"),
            Self::Equilibria(_) => Some("--equilibria"),
        }
    }

    /// Whether it is for motions too.
    #[must_use]
    pub fn goes_with_time(&self) -> bool {
        matches!(self, Self::Equilibrium | Self::HalfThickness)
    }

    /// Whether the result has the entries of a single state.
    #[must_use]
    pub fn has_one_state(&self) -> bool {
        !matches!(self, Self::Ramp(_) | Self::Path | Self::PathToLimit)
    }
}
