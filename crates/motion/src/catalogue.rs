//! The catalogue of time schemes: a row each, which the tests hold to its order, its damping and its derivative.

use crate::scheme::{End, Scheme, Stage, TermInstant, a, u, v};
use nastic_body::error::FemError;

/// A row of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The name.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// Order of the error at the end of a motion; 0 of a scheme that is not consistent with the equation of motion.
    pub order: usize,
    /// The scheme, with the parameters that are named in `about`.
    pub build: fn() -> Result<Scheme, FemError>,
}

/// Every scheme of this crate.
pub const SCHEMES: &[Entry] = &[
    Entry {
        name: "backward_euler",
        about: "Backward Euler: first order, damps every mode that a step does not resolve, and much that it does.",
        order: 1,
        build: || Ok(Scheme::backward_euler()),
    },
    Entry {
        name: "bdf2",
        about: "Backward differences over two steps of equal length: second order; begins by a step of TR-BDF2.",
        order: 2,
        build: || Ok(Scheme::bdf2()),
    },
    Entry {
        name: "tr_bdf2",
        about: "The trapezoidal rule over half a step, then BDF2: second order, two solves, damps what is not resolved.",
        order: 2,
        build: || Ok(Scheme::tr_bdf2()),
    },
    Entry {
        name: "trapezoidal",
        about: "The trapezoidal rule: second order, without numerical damping; rings where loads jump.",
        order: 2,
        build: || Ok(Scheme::trapezoidal()),
    },
    Entry {
        name: "implicit_midpoint",
        about: "The implicit midpoint rule: second order, without numerical damping, keeps the angular momentum.",
        order: 2,
        build: || Ok(Scheme::implicit_midpoint()),
    },
    Entry {
        name: "newmark",
        about: "Newmark's scheme, here with beta = 0.3025, gamma = 0.6: first order, damps; 1/4, 1/2: trapezoidal.",
        order: 1,
        build: || Scheme::newmark(0.3025, 0.6),
    },
    Entry {
        name: "generalized_alpha",
        about: "Generalised alpha, here with rho = 0.8: second order, damps modes that a step does not resolve by rho.",
        order: 2,
        build: || Scheme::generalized_alpha(0.8),
    },
    Entry {
        name: "quasi_dynamic",
        about: "Every step from rest: a sequence of equilibria that inertia holds back; long steps are static.",
        order: 0,
        build: || Ok(Scheme::quasi_dynamic()),
    },
    Entry {
        name: "quasi_static",
        about: "Every instant an equilibrium without inertia, viscous laws included, to first order; needs no density.",
        order: 0,
        build: || Ok(Scheme::quasi_static()),
    },
    Entry {
        name: "linearly_implicit_euler",
        about: "One iteration of Newton's method for a step of backward Euler: first order, damps like that; short steps.",
        order: 1,
        build: || Ok(Scheme::linearly_implicit_euler()),
    },
    Entry {
        name: "siere",
        about: "Semi-implicit exponential: the 10 lowest modes move exactly, the others as by linearly_implicit_euler; no gradient.",
        order: 1,
        build: || Scheme::siere(10),
    },
];

const NOW: TermInstant = TermInstant::Now;
const BEFORE: TermInstant = TermInstant::Before;
const FIRST: TermInstant = TermInstant::Stage(0);
const SECOND: TermInstant = TermInstant::Stage(1);

impl Scheme {
    /// `v = (u - u_n)/h`, `a = (v - v_n)/h`. Minimises `|u - u_n - h v_n|_M^2 / (2 h^2) + Pi(u)`.
    pub fn backward_euler() -> Self {
        let velocity = vec![u(1.0, FIRST), u(-1.0, NOW)];
        let acceleration = vec![v(1.0, FIRST), v(-1.0, NOW)];
        Self::one_stage("backward_euler", Stage { time: 1.0, velocity, acceleration }, End::stage(0))
    }

    /// `v = (3 u - 4 u_n + u_{n-1})/(2h)` and a likewise, for steps of equal length; the first step, and the first
    /// after a change of the length, is one of [`tr_bdf2`](Self::tr_bdf2).
    pub fn bdf2() -> Self {
        let velocity = vec![u(1.5, FIRST), u(-2.0, NOW), u(0.5, BEFORE)];
        let acceleration = vec![v(1.5, FIRST), v(-2.0, NOW), v(0.5, BEFORE)];
        let stage = Stage { time: 1.0, velocity, acceleration };
        Scheme { start: Some(Box::new(Self::tr_bdf2())), ..Self::one_stage("bdf2", stage, End::stage(0)) }
    }

    /// The trapezoidal rule over `h/2` to `u*`, then BDF2 on the two halves: `u* = u_n + h/4 (v_n + v*)`, `u = u* +
    /// (u* - u_n + h v)/3`, velocities likewise. Estimates the error of a step by `h (-v_n + 2 v* - v)/6`. The variant with gamma = 1/2 of Bank et al., IEEE Trans. Electron
    /// Devices 32 (1985).
    pub fn tr_bdf2() -> Self {
        let half = Stage {
            time: 0.5,
            velocity: vec![u(4.0, FIRST), u(-4.0, NOW), v(-1.0, NOW)],
            acceleration: vec![v(4.0, FIRST), v(-4.0, NOW), a(-1.0, NOW)],
        };
        let whole = Stage {
            time: 1.0,
            velocity: vec![u(3.0, SECOND), u(-4.0, FIRST), u(1.0, NOW)],
            acceleration: vec![v(3.0, SECOND), v(-4.0, FIRST), v(1.0, NOW)],
        };
        // 2 C h (2 v_n - 4 v* + 2 v) with C = -1/24: about -h^3/24 times the third derivative of u
        let error = vec![v(-1.0 / 6.0, NOW), v(1.0 / 3.0, FIRST), v(-1.0 / 6.0, SECOND)];
        Scheme {
            name: "tr_bdf2",
            stages: vec![half, whole],
            end: End::stage(1),
            start: None,
            error,
            linearised: false,
            exact_modes: 0,
            parts: 1,
        }
    }

    /// `u = u_n + h/2 (v_n + v)`, `v = v_n + h/2 (a_n + a)`.
    pub fn trapezoidal() -> Self {
        let velocity = vec![u(2.0, FIRST), u(-2.0, NOW), v(-1.0, NOW)];
        let acceleration = vec![v(2.0, FIRST), v(-2.0, NOW), a(-1.0, NOW)];
        Self::one_stage("trapezoidal", Stage { time: 1.0, velocity, acceleration }, End::stage(0))
    }

    /// In the middle `u_m = u_n + h/2 v_m`, `v_m = v_n + h/2 a_m`; then `u = 2 u_m - u_n`, `v = 2 v_m - v_n`.
    /// Minimises `2 |u_m - u_n - h/2 v_n|_M^2 / h^2 + Pi(u_m)`.
    pub fn implicit_midpoint() -> Self {
        let velocity = vec![u(2.0, FIRST), u(-2.0, NOW)];
        let acceleration = vec![v(2.0, FIRST), v(-2.0, NOW)];
        let end = End {
            displacement: vec![u(2.0, FIRST), u(-1.0, NOW)],
            velocity: vec![v(2.0, FIRST), v(-1.0, NOW)],
            acceleration: Vec::new(),
        };
        Self::one_stage("implicit_midpoint", Stage { time: 0.5, velocity, acceleration }, end)
    }

    /// `u = u_n + h v_n + h^2 ((1/2 - beta) a_n + beta a)`, `v = v_n + h ((1 - gamma) a_n + gamma a)`.
    /// Newmark, J. Eng. Mech. Div. ASCE 85 (1959).
    ///
    /// # Errors
    /// Parameters with which long steps are not stable: beyond `2 beta >= gamma >= 1/2`.
    pub fn newmark(beta: f64, gamma: f64) -> Result<Self, FemError> {
        if !(gamma >= 0.5 && 2.0 * beta >= gamma && beta.is_finite()) {
            let what = format!("Newmark's scheme with beta = {beta}, gamma = {gamma}: take 2 beta >= gamma >= 1/2");
            return Err(FemError::Meaningless { what });
        }
        let [velocity, acceleration] = newmark_terms(beta, gamma);
        let stage = Stage { time: 1.0, velocity: velocity.to_vec(), acceleration: acceleration.to_vec() };
        Ok(Self::one_stage("newmark", stage, End::stage(0)))
    }

    /// Newmark's formulas, with the residual at `(1 - alpha_f) (u, v) + alpha_f (u_n, v_n)` and `(1 - alpha_m) a +
    /// alpha_m a_n`: `alpha_m = (2 rho - 1)/(rho + 1)`, `alpha_f = rho/(rho + 1)`, `gamma = 1/2 - alpha_m + alpha_f`,
    /// `beta = (1 - alpha_m + alpha_f)^2 / 4`, so that amplitudes of infinite frequency fall by rho in a step. Chung,
    /// Hulbert, J. Appl. Mech. 60 (1993).
    ///
    /// # Errors
    /// A rho beyond `[0, 1]`.
    pub fn generalized_alpha(rho: f64) -> Result<Self, FemError> {
        if !(0.0..=1.0).contains(&rho) {
            let what = format!("generalised alpha with rho = {rho}: take one of [0, 1]");
            return Err(FemError::Meaningless { what });
        }
        let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        let (gamma, beta) = (0.5 - alpha_m + alpha_f, 0.25 * (1.0 - alpha_m + alpha_f).powi(2));
        let share = 1.0 - alpha_f;
        // with the unknown w = share u + alpha_f u_n: u - u_n = (w - u_n) / share
        let [velocity, acceleration] = newmark_terms(beta, gamma).map(|[w, u_n, v_n, a_n]| {
            let inner = |factor: f64| factor / share;
            [u(inner(w.factor), FIRST), u(inner(u_n.factor), NOW), v_n, a_n]
        });
        let mixed = |[w, u_n, v_n, a_n]: [super::scheme::Term; 4], share: f64, [by_v, by_a]: [f64; 2]| {
            let at = |factor: f64| share * factor;
            vec![
                u(at(w.factor), FIRST),
                u(at(u_n.factor), NOW),
                v(at(v_n.factor) + by_v, NOW),
                a(at(a_n.factor) + by_a, NOW),
            ]
        };
        let stage = Stage {
            time: share,
            velocity: mixed(velocity, share, [alpha_f, 0.0]),
            acceleration: mixed(acceleration, 1.0 - alpha_m, [0.0, alpha_m]),
        };
        let end = End {
            displacement: vec![u(1.0 / share, FIRST), u(-alpha_f / share, NOW)],
            velocity: velocity.to_vec(),
            acceleration: acceleration.to_vec(),
        };
        Ok(Self::one_stage("generalized_alpha", stage, end))
    }

    /// Backward Euler from rest: `a = (u - u_n)/h^2`, `v = (u - u_n)/h`. Minimises `|u - u_n|_M^2 / (2 h^2) + Pi(u)`;
    /// the static problem for h to infinity.
    pub fn quasi_dynamic() -> Self {
        let velocity = vec![u(1.0, FIRST), u(-1.0, NOW)];
        let stage = Stage { time: 1.0, acceleration: velocity.clone(), velocity };
        Self::one_stage("quasi_dynamic", stage, End::stage(0))
    }

    /// `r(u, v; m) = 0` with `v = (u - u_n)/h`, which viscosity and damping see, and no acceleration. Minimises the potential of the
    /// forces: without viscosity and damping every instant is the static equilibrium under its controls, whatever h. The body has to be
    /// held; it needs no density, and may not begin with a velocity.
    pub fn quasi_static() -> Self {
        let velocity = vec![u(1.0, FIRST), u(-1.0, NOW)];
        let end = End { acceleration: Vec::new(), ..End::stage(0) };
        Self::one_stage("quasi_static", Stage { time: 1.0, velocity, acceleration: Vec::new() }, end)
    }

    /// One iteration of Newton's method for [`backward_euler`](Self::backward_euler), from `u_n` and without a line search: with
    /// `K = dr/du` at `u_n` and the controls at the end of the step
    ///
    /// ```text
    /// (M/h^2 + C/h + K) (u - u_n) = M v_n/h - r(u_n; m_{n+1}),    v = (u - u_n)/h
    /// ```
    ///
    /// A matrix that is not positive definite and an end with J <= 0 are errors. Rotations by more than a few degrees in a step
    /// swell the body. Baraff, Witkin, "Large steps in cloth simulation", SIGGRAPH 1998.
    pub fn linearly_implicit_euler() -> Self {
        Scheme { name: "linearly_implicit_euler", linearised: true, ..Self::backward_euler() }
    }

    /// The semi-implicit exponential Rosenbrock-Euler scheme: a step of [`linearly_implicit_euler`](Self::linearly_implicit_euler) in
    /// which the part in the `modes` lowest modes of the tangent at `u_n`, `K w = lambda M w` (and in all with a negative lambda), is
    /// that of the exact solution of the equations linearised there under the controls at the end of the step. So the lowest modes,
    /// unlike all others, are not damped, however long the step is. Every step finds its modes, which takes several factors and some
    /// hundreds of solves; 5 to 20 are usual.
    ///
    /// For elastic bodies, with Rayleigh damping or none; of damping the modes feel what acts among themselves. No adjoint: that takes
    /// the derivatives of modes. A matrix that is not positive definite and an end with J <= 0 are errors.
    ///
    /// Chen, Sheen, Ascher, Pai, "SIERE: a hybrid semi-implicit exponential integrator for efficiently simulating stiff deformable
    /// objects", ACM Trans. Graph. 40 (2020): `y + (1 - h J_H)^-1 (h H(y) + h phi_1(h J_G) G(y))`, G the modes' part.
    ///
    /// # Errors
    /// No modes.
    pub fn siere(modes: usize) -> Result<Self, FemError> {
        if modes == 0 {
            let what = "siere with 0 exact modes: take 1 or more, or linearly_implicit_euler".to_owned();
            return Err(FemError::Meaningless { what });
        }
        let euler = Self::linearly_implicit_euler();
        let end = End { acceleration: Vec::new(), ..euler.end };
        Ok(Scheme { name: "siere", end, exact_modes: modes, ..euler })
    }

    fn one_stage(name: &'static str, stage: Stage, end: End) -> Self {
        Scheme {
            name,
            stages: vec![stage],
            end,
            start: None,
            error: Vec::new(),
            linearised: false,
            exact_modes: 0,
            parts: 1,
        }
    }
}

/// Newmark's velocity and acceleration by u, `u_n`, `v_n` and `a_n`.
fn newmark_terms(beta: f64, gamma: f64) -> [[super::scheme::Term; 4]; 2] {
    let velocity =
        [u(gamma / beta, FIRST), u(-gamma / beta, NOW), v(1.0 - gamma / beta, NOW), a(1.0 - gamma / (2.0 * beta), NOW)];
    let acceleration =
        [u(1.0 / beta, FIRST), u(-1.0 / beta, NOW), v(-1.0 / beta, NOW), a(1.0 - 1.0 / (2.0 * beta), NOW)];
    [velocity, acceleration]
}
