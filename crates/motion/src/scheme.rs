//! [`Scheme`]: a time scheme as a table of linear combinations.

/// A table from the state at `t_n` (and the one before) to that at `t_n + h`: in every stage an unknown displacement
/// w with
///
/// ```text
/// v = (c_v w + sum f_i y_i) / h,    a = (c_a w + sum g_i y_i) / h^2,    r(w, v, a; m(t_n + time h)) = 0
/// ```
///
/// where the y are displacements u, velocities `h v` and accelerations `h^2 a` of the states before and of earlier
/// stages; then u, v and a at the end as such combinations too. A stage is found by minimising its incremental
/// potential. What steps and what differentiates them read the same table. The catalogue:
/// [`catalogue::SCHEMES`](crate::catalogue::SCHEMES).
#[derive(Debug, Clone, PartialEq)]
pub struct Scheme {
    pub(crate) name: &'static str,
    pub(crate) stages: Vec<Stage>,
    pub(crate) end: End,
    /// What makes the first step of a scheme that needs two states.
    pub(crate) start: Option<Box<Scheme>>,
    /// An estimate of the error of u that a step makes, a combination too; empty where there is none.
    pub(crate) error: Vec<Term>,
    /// Whether a stage is one iteration of Newton's method from the state that the step begins at, instead of a solution.
    pub(crate) linearised: bool,
    /// How many of the lowest modes of a linearised step are those of the exact solution instead.
    pub(crate) exact_modes: usize,
    /// How many steps of the scheme of this name a step is.
    pub(crate) parts: usize,
}

/// A solve for an unknown displacement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stage {
    /// Where the residual is evaluated, as a share of the step: controls are interpolated linearly to there.
    pub time: f64,
    /// `h v`; of its own stage by the displacement alone.
    pub velocity: Vec<Term>,
    /// `h^2 a`; of its own stage by displacement and velocity.
    pub acceleration: Vec<Term>,
}

/// The state at the end of a step: u, `h v`, `h^2 a`. An empty acceleration is not known there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct End {
    pub displacement: Vec<Term>,
    pub velocity: Vec<Term>,
    pub acceleration: Vec<Term>,
}

/// A factor times u, `h v` or `h^2 a` at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Term {
    pub factor: f64,
    pub of: Quantity,
    pub at: TermInstant,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Displacement,
    Velocity,
    Acceleration,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TermInstant {
    /// `t_n`
    Now,
    /// `t_n - h`
    Before,
    /// A stage of this step.
    Stage(usize),
}

pub(crate) fn u(factor: f64, at: TermInstant) -> Term {
    Term { factor, of: Quantity::Displacement, at }
}

pub(crate) fn v(factor: f64, at: TermInstant) -> Term {
    Term { factor, of: Quantity::Velocity, at }
}

pub(crate) fn a(factor: f64, at: TermInstant) -> Term {
    Term { factor, of: Quantity::Acceleration, at }
}

impl Quantity {
    pub(crate) fn power(self) -> i32 {
        match self {
            Quantity::Displacement => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
        }
    }
}

impl Term {
    /// The factor of u, v or a itself in a combination for u, v or a itself.
    pub fn scaled(&self, of: Quantity, h: f64) -> f64 {
        self.factor * h.powi(self.of.power() - of.power())
    }

    /// Whether it is one of the quantities of a stage.
    pub fn is(&self, of: Quantity, stage: usize) -> bool {
        self.of == of && self.at == TermInstant::Stage(stage)
    }
}

impl Stage {
    /// `c_v / h` and `c_a / h^2` of the k-th stage, which this is.
    pub fn own(&self, k: usize, h: f64) -> (f64, f64) {
        let sum = |terms: &[Term], target: Quantity, of: Quantity| -> f64 {
            terms.iter().filter(|term| term.is(of, k)).map(|term| term.scaled(target, h)).sum()
        };
        let c_v = sum(&self.velocity, Quantity::Velocity, Quantity::Displacement);
        let by_u = sum(&self.acceleration, Quantity::Acceleration, Quantity::Displacement);
        let by_v = sum(&self.acceleration, Quantity::Acceleration, Quantity::Velocity);
        (c_v, by_u + by_v * c_v)
    }
}

impl End {
    /// The end is a stage.
    pub fn stage(k: usize) -> Self {
        let at = TermInstant::Stage(k);
        End { displacement: vec![u(1.0, at)], velocity: vec![v(1.0, at)], acceleration: vec![a(1.0, at)] }
    }

    /// Each quantity with its terms.
    pub fn combinations(&self) -> [(Quantity, &[Term]); 3] {
        [
            (Quantity::Displacement, &self.displacement),
            (Quantity::Velocity, &self.velocity),
            (Quantity::Acceleration, &self.acceleration),
        ]
    }
}

impl Scheme {
    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// How many displacements a step solves for.
    pub fn stages(&self) -> usize {
        self.stages.len()
    }

    /// The scheme of its first step, and of the first one after a change of the step's length, where it needs two
    /// states.
    pub fn start(&self) -> Option<&Scheme> {
        self.start.as_deref()
    }

    /// Whether it leaves out inertia: its states are equilibria of the forces, those of viscosity and damping included.
    pub fn is_quasi_static(&self) -> bool {
        self.stages.iter().all(|stage| stage.acceleration.is_empty())
    }

    /// Whether a step solves one linear system, that of the forces linearised where it begins: forces are balanced at its end up to
    /// second order in the change of the displacement.
    pub fn is_linearised(&self) -> bool {
        self.linearised
    }

    /// How many of the lowest modes, those of the tangent where a step begins, move as the equations linearised there do; the others
    /// move as the stages say. 0 of all but [`siere`](Self::siere).
    pub fn exact_modes(&self) -> usize {
        self.exact_modes
    }

    /// Whether there is an adjoint of its steps: not where they take modes.
    pub fn has_adjoint(&self) -> bool {
        self.exact_modes == 0
    }

    /// Vectors of the body's unknowns that a step and its end keep.
    pub(crate) fn vectors(&self) -> usize {
        let shared = (0..self.stages.len()).any(|k| self.end.displacement == [u(1.0, TermInstant::Stage(k))]);
        let rates = [&self.end.velocity, &self.end.acceleration];
        self.stages.len() + usize::from(!shared) + rates.iter().filter(|terms| !terms.is_empty()).count()
    }

    /// Whether it estimates the error of its steps, which [`TimeStepping::advance_adaptively`](crate::TimeStepping::advance_adaptively) needs.
    pub fn estimates_error(&self) -> bool {
        !self.error.is_empty()
    }

    /// Whether it asks for the acceleration of the state that a step begins at.
    pub fn needs_acceleration(&self) -> bool {
        self.terms().any(|term| term.of == Quantity::Acceleration && term.at == TermInstant::Now)
    }

    /// Whether the state at the end of a step is not one of its stages: it has an equilibrium nowhere.
    pub fn extrapolates(&self) -> bool {
        self.stages.iter().enumerate().all(|(k, _)| self.end.displacement != [u(1.0, TermInstant::Stage(k))])
    }

    /// Whether the state at the end of a step is that of its last stage, at the end: forces are in equilibrium there.
    pub fn ends_at_its_last_stage(&self) -> bool {
        let Some((k, last)) = self.stages.iter().enumerate().next_back() else { return false };
        let End { displacement, velocity, .. } = End::stage(k);
        !self.linearised && last.time == 1.0 && self.end.displacement == displacement && self.end.velocity == velocity
    }

    /// Where the end is extrapolated from the k-th stage, its last: the factor alpha of `u = alpha w + b`, and the terms of b.
    pub(crate) fn extrapolation(&self, k: usize) -> Option<(f64, Vec<Term>)> {
        if !(self.extrapolates() && k + 1 == self.stages.len()) {
            return None;
        }
        let of_stage = |term: &Term| term.is(Quantity::Displacement, k);
        let (own, rest): (Vec<Term>, Vec<Term>) = self.end.displacement.iter().partition(|term| of_stage(term));
        Some((own.iter().map(|term| term.factor).sum(), rest))
    }

    pub(crate) fn terms(&self) -> impl Iterator<Item = &Term> {
        let of_stages = self.stages.iter().flat_map(|stage| stage.velocity.iter().chain(&stage.acceleration));
        let End { displacement, velocity, acceleration } = &self.end;
        of_stages.chain(displacement).chain(velocity).chain(acceleration)
    }
}
