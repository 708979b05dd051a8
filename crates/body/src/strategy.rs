//! [`Strategy`]: what a solve may try beside Newton's method on the displacement alone.

use serde::{Deserialize, Serialize};

/// One way to an equilibrium, in the order in which they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// From a guess of the equilibrium at once.
    Guess,
    /// Steps in time with friction: rounds in which its normal forces are those of the round before.
    LaggedFriction,
    /// Steps in time with contact, far from their end or where the tangent is not positive definite: tangents without the curvature of contacts.
    FlatContacts,
    /// Where contact alone holds a part: proximal steps of less and less weight.
    ProximalSteps,
    /// Nearly incompressible bodies: pressures at the quadrature points that every step predicts.
    PredictedPressures,
    /// Strains of their own at the quadrature points: first where prescribed components move stiff bodies or constraints hold them, else where
    /// descent creeps.
    PointStrains,
    /// Stiff bodies: a few iterations downhill before these.
    BriefDescent,
    /// Where obstacles move: the equilibrium's rate of change along the way.
    Rate,
    /// Steps along the curve that turns with the body.
    CurvedStep,
    /// After a state nearby has led nowhere: the way from rest.
    FromRest,
}

impl Strategy {
    /// All of them.
    pub const ALL: [Strategy; 10] = [
        Self::Guess,
        Self::LaggedFriction,
        Self::FlatContacts,
        Self::ProximalSteps,
        Self::PredictedPressures,
        Self::PointStrains,
        Self::BriefDescent,
        Self::Rate,
        Self::CurvedStep,
        Self::FromRest,
    ];

    /// Its name in results and on command lines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Guess => "guess",
            Self::LaggedFriction => "lagged_friction",
            Self::FlatContacts => "flat_contacts",
            Self::ProximalSteps => "proximal_steps",
            Self::PredictedPressures => "predicted_pressures",
            Self::PointStrains => "point_strains",
            Self::BriefDescent => "brief_descent",
            Self::Rate => "rate",
            Self::CurvedStep => "curved_step",
            Self::FromRest => "from_rest",
        }
    }

    /// That of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|strategy| strategy.name() == name)
    }
}

/// Which strategies a solve may take; all of them unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strategies(u16);

impl Strategies {
    /// All of them.
    pub const ALL: Strategies = Strategies(u16::MAX);

    /// The same without one: for those who measure what it is worth.
    #[must_use]
    pub const fn without(self, strategy: Strategy) -> Self {
        Strategies(self.0 & !(1 << strategy as u16))
    }

    /// Whether one is among them.
    pub const fn has(self, strategy: Strategy) -> bool {
        self.0 & (1 << strategy as u16) != 0
    }
}

/// How often each strategy was tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StrategyCounts([u32; Strategy::ALL.len()]);

impl StrategyCounts {
    /// One more.
    pub fn count(&mut self, strategy: Strategy) {
        self.0[strategy as usize] += 1;
    }

    /// Those of another solve too.
    pub fn add(&mut self, other: &StrategyCounts) {
        self.0.iter_mut().zip(other.0).for_each(|(own, other)| *own += other);
    }

    /// Those that were tried, and how often.
    pub fn tried(&self) -> impl Iterator<Item = (Strategy, u32)> {
        Strategy::ALL.into_iter().zip(self.0).filter(|(_, count)| *count > 0)
    }
}
