//! Contract checks for any energy term, ours or a user's own.
//!
//! Each check evaluates the term at rotated, strongly deformed states (`J` from 0.3 to 3, never near the identity only)
//! and compares what it claims with what its energy implies. [`law`], [`passive`] and [`actuation`] run everything that
//! applies.
//!
//! ```
//! use nastic_energy::{MooneyRivlin, MaterialPoint, check};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let law = MooneyRivlin::new(1e5, 2e4, 1e6)?;
//! let report = check::law(&law, MaterialPoint { cell: 0, point: 0 })?;
//! assert!(report.findings.iter().all(|finding| finding.worst <= finding.allowed));
//! # Ok(())
//! # }
//! ```

mod accumulation;
mod control;
mod convexity;
mod density;
mod derivative;
mod free_cube;
mod rest;
mod second;
mod states;
mod symmetry;

use std::fmt;

use nastic_tensor::{Inverted, Kinematics, Mat3, Tangent};

use crate::{ConvexDensity, EnergyTerm, MaterialPoint, PointBatch, Response, Slots, Want};

pub use accumulation::accumulation;
pub use control::{control_derivative, drives};
pub use convexity::{ellipticity, growth};
pub use density::{hessian, partials, polyconvexity, tension_bound};
pub use derivative::{stress, stress_change, tangent};
pub use free_cube::free_cube;
pub use rest::{moduli, rest};
pub use second::{control_stress_change, second_stress_change};
pub use states::{rotations, states};
pub use symmetry::{major_symmetry, objectivity};

/// The measured error of one check that was passed.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was checked.
    pub check: &'static str,
    /// Largest relative error found.
    pub worst: f64,
    /// Largest one allowed.
    pub allowed: f64,
}

/// The findings of all checks that ran, none of them violated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// In the order the checks ran.
    pub findings: Vec<Finding>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Finding { check, worst, allowed } in &self.findings {
            writeln!(f, "{check:<44} {worst:9.1e} (allowed {allowed:.1e})")?;
        }
        Ok(())
    }
}

/// A term that breaks its contract, or could not be checked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Violation {
    /// A relative error above what rounding explains.
    #[error("{check}: relative error {found:e}, allowed {allowed:e}, at F = {at:?}")]
    Exceeds {
        /// What was checked.
        check: &'static str,
        /// Relative error.
        found: f64,
        /// Largest one allowed.
        allowed: f64,
        /// Rows of the deformation gradient.
        at: [[f64; 3]; 3],
    },
    /// A check met an inverted state, which means that the state asked for was one.
    #[error("{check}: {source}")]
    Inverted {
        /// What was checked.
        check: &'static str,
        /// The Jacobian.
        source: Inverted,
    },
    /// The free cube found no equilibrium: no smaller energy, or no end of growth.
    #[error(
        "free cube: no equilibrium after {iterations} iterations (relative stress {stress:e}, J = {jacobian:e}); take a \
         smaller control, below the law's fiber limit"
    )]
    NoEquilibrium {
        /// Newton iterations spent.
        iterations: usize,
        /// Norm of the stress over that of the tangent.
        stress: f64,
        /// Jacobian where it stopped.
        jacobian: f64,
    },
    /// An actuation got the wrong number of control values.
    #[error("{check}: {found} control values for {expected} slots")]
    Controls {
        /// What was checked.
        check: &'static str,
        /// Number of slots.
        expected: usize,
        /// Number of values.
        found: usize,
    },
}

/// Energy, stress and tangent of a term at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Energy density, J/m^3.
    pub energy: f64,
    /// First Piola-Kirchhoff stress, Pa.
    pub stress: Mat3,
    /// `dP/dF`, Pa.
    pub tangent: Tangent,
}

/// One-point evaluation with the slots `m` (empty of a law without).
pub fn evaluate(term: &dyn EnergyTerm, at: MaterialPoint, k: &Kinematics, m: &[f64]) -> Evaluation {
    let (mut energy, mut stress, mut tangent) = ([0.0], [Mat3::zeros()], [Tangent::zero()]);
    let mut out = Response { energy: &mut energy, stress: &mut stress, tangent: &mut tangent };
    let points = PointBatch { kinematics: std::slice::from_ref(k), cell: at.cell, first: at.point };
    term.respond(&points, Slots::by_point(m, m.len()), Want::ALL, &mut out);
    Evaluation { energy: energy[0], stress: stress[0], tangent: tangent[0] }
}

/// Every check of a passive law: derivatives (those of third order where it gives them), symmetry, objectivity, rest state,
/// moduli; ellipticity and growth unless it states that it lacks them ([`EnergyTerm::existence`]).
///
/// # Errors
/// The first [`Violation`].
pub fn passive(law: &dyn EnergyTerm, at: MaterialPoint) -> Result<Report, Violation> {
    let mut findings = vec![
        accumulation(law, at, &[])?,
        stress(law, at, &[])?,
        tangent(law, at, &[])?,
        stress_change(law, at, &[])?,
        major_symmetry(law, at, &[])?,
        objectivity(law, at, &[], &|_, _| {})?,
        rest(law, at)?,
    ];
    findings.extend(second_stress_change(law, at, &[])?);
    findings.extend(moduli(law, at)?);
    let stated = law.existence(at);
    if stated.is_none_or(|stated| stated.polyconvex) {
        findings.push(ellipticity(law, at)?);
    }
    if stated.is_none_or(|stated| stated.resists_collapse) {
        findings.push(growth(law, at)?);
    }
    Ok(Report { findings })
}

/// Every check of a law of your own, written as a [`ConvexDensity`]: those of [`passive`], those of [`convex_density`], and
/// the convexity bound it states.
///
/// # Errors
/// The first [`Violation`].
pub fn law<L: ConvexDensity>(law: &L, at: MaterialPoint) -> Result<Report, Violation> {
    let mut report = passive(law, at)?;
    report.findings.extend(convex_density(law, at)?.findings);
    report.findings.extend(tension_bound(law, at)?);
    Ok(report)
}

/// The further checks of a law written as a [`ConvexDensity`]: its partial derivatives one by one, and their convexity
/// unless it states that it lacks it.
///
/// # Errors
/// The first [`Violation`].
pub fn convex_density(law: &dyn ConvexDensity, at: MaterialPoint) -> Result<Report, Violation> {
    let mut findings = vec![partials(law, at)?];
    if law.conditions(at).is_none_or(|stated| stated.polyconvex) {
        findings.push(polyconvexity(law, at)?);
    }
    Ok(Report { findings })
}

/// Every check of an actuation at the control values `m`: derivatives (those of third order where it gives them), symmetry,
/// objectivity, `dP/dm`.
///
/// # Errors
/// The first [`Violation`].
pub fn actuation(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Report, Violation> {
    let expected = term.slots().len();
    if m.len() != expected {
        return Err(Violation::Controls { check: "actuation", expected, found: m.len() });
    }
    let mut findings = vec![
        accumulation(term, at, m)?,
        stress(term, at, m)?,
        tangent(term, at, m)?,
        stress_change(term, at, m)?,
        major_symmetry(term, at, m)?,
        objectivity(term, at, m, &|q, m| term.turn(q, m))?,
        control_derivative(term, at, m)?,
    ];
    findings.extend(second_stress_change(term, at, m)?);
    findings.extend(control_stress_change(term, at, m)?);
    Ok(Report { findings })
}

/// Worst relative error so far of one check.
struct Worst {
    check: &'static str,
    worst: f64,
    allowed: f64,
}

impl Worst {
    fn new(check: &'static str, allowed: f64) -> Self {
        Worst { check, worst: 0.0, allowed }
    }

    /// Takes one error in units of a scale; exact agreement needs no scale, NaN never passes.
    fn see(&mut self, error: f64, scale: f64, at: &Mat3) -> Result<(), Violation> {
        let found = if error == 0.0 { 0.0 } else { error / scale };
        if found <= self.allowed {
            self.worst = self.worst.max(found);
            return Ok(());
        }
        let at = [0, 1, 2].map(|i| [at[(i, 0)], at[(i, 1)], at[(i, 2)]]);
        Err(Violation::Exceeds { check: self.check, found, allowed: self.allowed, at })
    }

    fn finding(self) -> Finding {
        Finding { check: self.check, worst: self.worst, allowed: self.allowed }
    }
}

fn kinematics(check: &'static str, f: Mat3) -> Result<Kinematics, Violation> {
    Kinematics::new(f).map_err(|source| Violation::Inverted { check, source })
}

fn norm(t: &Tangent) -> f64 {
    t.0.iter().map(|x| x * x).sum::<f64>().sqrt()
}
