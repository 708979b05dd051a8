/// What a law states of the conditions under which a body of it has a state of least energy, at its parameters:
///
/// * polyconvexity: `W(F, H, J)` is convex in the three together;
/// * collapse: `W -> inf` as `J -> 0`;
/// * coercivity: `W >= a (|F|^p + |H|^q + J^r) - b` with `p >= 2`, `q >= p / (p - 1)`, `r > 1`, for some `a > 0` and `b`.
///
/// (J. Ball, Arch. Rational Mech. Anal. 63, 1977, 337-403, doi 10.1007/BF00279992; inequality (2) and theorem 2 of "Mathematical
/// modeling, analysis and control in soft robotics", SeMA Journal 2023, doi 10.1007/s40324-023-00334-4.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Existence {
    /// Whether the law is polyconvex.
    pub polyconvex: bool,
    /// Whether its energy grows without bound as `J -> 0`.
    pub resists_collapse: bool,
    /// How fast its energy grows.
    pub growth: Growth,
}

/// Exponents for which `W >= a (|F|^p + |H|^q + J^r) - b`; 0 where the law itself bounds nothing from below.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Growth {
    /// Exponent of `|F|`.
    pub p: f64,
    /// Exponent of `|H|`.
    pub q: f64,
    /// Exponent of `J`.
    pub r: f64,
}

impl Growth {
    /// Of `phi(I1') + U(J)` with `phi` of degree `n` in `I1' = J^(-2/3) |F|^2`, and `U` of degree 2: `p = 6 n / (n + 3)` by Young's
    /// inequality. The limit of large n, 6, is that of a bounded `I1'`.
    pub fn isochoric(n: f64) -> Self {
        Growth { p: if n.is_finite() { 6.0 * n / (n + 3.0) } else { 6.0 }, q: 0.0, r: 2.0 }
    }

    /// With what follows from `|H| <= |F|^2`, `J <= |F|^3` and `J^2 <= |H|^3` (up to factors).
    pub fn implied(self) -> Self {
        let q = self.q.max(self.p / 2.0);
        Growth { p: self.p, q, r: self.r.max(self.p / 3.0).max(2.0 * q / 3.0) }
    }

    /// Of a sum of laws, each of which is bounded from below.
    pub fn and(self, other: Self) -> Self {
        Growth { p: self.p.max(other.p), q: self.q.max(other.q), r: self.r.max(other.r) }
    }

    /// Whether the exponents fulfil the coercivity of the existence theorem.
    pub fn is_coercive(self) -> bool {
        let Growth { p, q, r } = self.implied();
        p >= 2.0 && q >= p / (p - 1.0) && r > 1.0
    }

    /// Whether the growth outweighs a constant pressure, `-m J`.
    pub fn balances_pressure(self) -> bool {
        self.implied().r > 1.0
    }
}

impl Existence {
    /// Of a sum of laws.
    pub fn and(self, other: Self) -> Self {
        Existence {
            polyconvex: self.polyconvex && other.polyconvex,
            resists_collapse: self.resists_collapse || other.resists_collapse,
            growth: self.growth.and(other.growth),
        }
    }

    /// What is true of each of two laws.
    pub fn or(self, other: Self) -> Self {
        let Growth { p, q, r } = self.growth.implied();
        let others = other.growth.implied();
        Existence {
            polyconvex: self.polyconvex && other.polyconvex,
            resists_collapse: self.resists_collapse && other.resists_collapse,
            growth: Growth { p: p.min(others.p), q: q.min(others.q), r: r.min(others.r) },
        }
    }

    /// Whether all conditions of the theorem hold.
    pub fn holds(self) -> bool {
        self.polyconvex && self.resists_collapse && self.growth.is_coercive()
    }
}
