use nalgebra::{SMatrix, SVector};
use nastic_tensor::{Mat3, Tangent};

use super::derivative::sixth_order;
use super::{Finding, Violation, Worst, states};
use crate::{Block, ConvexDensity, MaterialPoint};

/// Components of `F`, then of `H`, row by row, then `J`.
type Vec19 = SVector<f64, 19>;
/// Second derivatives by those.
pub type Hessian = SMatrix<f64, 19, 19>;

/// The 19 x 19 matrix of second partial derivatives of `W(F, H, J)` as the law states them; order `F`, `H` (row by
/// row), `J`. The law is polyconvex where it is positive semidefinite for independent `F`, `H`, `J`.
pub fn hessian(law: &dyn ConvexDensity, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Hessian {
    let w = law.second(at, f, h, j);
    let (ff, hh, fh) = (spread(&w.ff), spread(&w.hh), spread(&w.fh));
    let fj = flat(&w.fj.unwrap_or_else(Mat3::zeros));
    let hj = flat(&w.hj.unwrap_or_else(Mat3::zeros));
    Hessian::from_fn(|r, c| match (r / 9, c / 9) {
        (0, 0) => ff.0[9 * r + c],
        (0, 1) => fh.0[9 * r + c - 9],
        (1, 0) => fh.0[9 * c + r - 9],
        (1, 1) => hh.0[9 * (r - 9) + c - 9],
        (0, _) => fj[r],
        (_, 0) => fj[c],
        (1, _) => hj[r - 9],
        (_, 1) => hj[c - 9],
        _ => w.jj,
    })
}

/// First and second partial derivatives are those of the value, with `F`, `H` and `J` varied independently.
///
/// # Errors
/// A [`Violation`] at the first state where they are not.
pub fn partials(law: &dyn ConvexDensity, at: MaterialPoint) -> Result<Finding, Violation> {
    let mut worst = Worst::new("partial derivatives by F, H and J", 1e-9);
    for x in independent_states() {
        let (f, h, j) = unpack(&x);
        let (slope, curvature) = (gradient(law, at, &x), hessian(law, at, &f, &h, j));
        let scale = curvature.norm() + slope.norm();
        for n in 0..19 {
            let step = 5e-3 * j;
            let moved = |t: f64| {
                let mut y = x;
                y[n] += t * step;
                y
            };
            let first = sixth_order(step, |t| {
                let (f, h, j) = unpack(&moved(t));
                Ok::<f64, Violation>(law.value(at, &f, &h, j))
            })?;
            worst.see((first - slope[n]).abs(), scale, &f)?;
            let second = sixth_order(step, |t| Ok::<Vec19, Violation>(gradient(law, at, &moved(t))))?;
            worst.see((second - curvature.column(n)).norm(), scale, &f)?;
        }
    }
    Ok(worst.finding())
}

/// The density is convex in `(F, H, J)`, sampled independently of each other.
///
/// # Errors
/// A [`Violation`] with the most negative eigenvalue of the [`hessian`] over its norm.
pub fn polyconvexity(law: &dyn ConvexDensity, at: MaterialPoint) -> Result<Finding, Violation> {
    let mut worst = Worst::new("convex in F, H and J", 1e-13);
    for x in independent_states() {
        let (f, h, j) = unpack(&x);
        let w = hessian(law, at, &f, &h, j);
        worst.see((-w.symmetric_eigenvalues().min()).max(0.0), w.norm(), &f)?;
    }
    Ok(worst.finding())
}

/// With fibre tensions at the bound the law states, the sum is still convex in `(F, H, J)`, and with it that of all tensions
/// below; `None` where the law states no bound.
///
/// # Errors
/// A [`Violation`] with the most negative eigenvalue over the norm of the second derivatives.
pub fn tension_bound(law: &dyn ConvexDensity, at: MaterialPoint) -> Result<Option<Finding>, Violation> {
    let mut worst = Worst::new("convex with tensions at their bound", 1e-12);
    let Some(bound) = law.tension_bound(at) else { return Ok(None) };
    let tensions = fiber_terms(bound.matrix());
    for x in independent_states() {
        let (f, h, j) = unpack(&x);
        let w = hessian(law, at, &f, &h, j) - tensions;
        worst.see((-w.symmetric_eigenvalues().min()).max(0.0), w.norm(), &f)?;
    }
    Ok(Some(worst.finding()))
}

/// Second derivatives of `1/2 T : F^T F`: `delta_ik T_JL`.
fn fiber_terms(t: &Mat3) -> Hessian {
    Hessian::from_fn(|r, c| if r < 9 && c < 9 && r / 3 == c / 3 { t[(r % 3, c % 3)] } else { 0.0 })
}

/// `F`, `H` and `J` that do not belong together.
fn independent_states() -> Vec<Vec19> {
    let states = states();
    let count = states.len();
    let pick = |n: usize| &states[n % count];
    (0..count).map(|n| pack(pick(n).f(), pick(5 * n + 1).h(), pick(7 * n + 2).j())).collect()
}

fn gradient(law: &dyn ConvexDensity, at: MaterialPoint, x: &Vec19) -> Vec19 {
    let (f, h, j) = unpack(x);
    let s = law.first(at, &f, &h, j);
    pack(&s.f, &s.h, s.j)
}

fn pack(f: &Mat3, h: &Mat3, j: f64) -> Vec19 {
    let (f, h) = (flat(f), flat(h));
    Vec19::from_fn(|n, _| match n / 9 {
        0 => f[n],
        1 => h[n - 9],
        _ => j,
    })
}

fn unpack(x: &Vec19) -> (Mat3, Mat3, f64) {
    let x = x.as_slice();
    (Mat3::from_row_slice(&x[..9]), Mat3::from_row_slice(&x[9..18]), x[18])
}

fn flat(m: &Mat3) -> [f64; 9] {
    std::array::from_fn(|n| m[(n / 3, n % 3)])
}

fn spread(block: &Block) -> Tangent {
    let mut out = Tangent::zero();
    match block {
        Block::Zero => {}
        Block::Isotropic(c) => out.add_identity(*c),
        Block::Metric(m) => out.add_metric(m),
        Block::Full(d) => out.add(d),
    }
    out
}
