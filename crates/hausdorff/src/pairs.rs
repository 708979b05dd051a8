//! Two clouds and phi^alpha between all their points.

use std::f64::consts::LN_2;

use super::adjoint::Adjoint;
use super::chebyshev::nodes;
use super::cloud::Cloud;
use super::error::{HausdorffError, positive};
use super::floor::Floor;
use super::kernel::Kernel;
use super::lanes::Machine;
use super::phi::Phi;
use super::plan::{Accuracy, Plan, Via};
use super::side::{Side, in_cloud_order, in_tree_order};
use super::sums::{Half, Log2Sums, Summation};
use super::transform::Tables;

/// How the pair sums are formed.
///
/// With the bound tol of the relative error of every sum A_t, B_q the derivative of a functional J errs, with
/// a = dJ/dlog A, b = dJ/dlog B and S the steepest slope of log phi^alpha, by no more than
///
/// ```text
/// sum_q |error of (dJ/dx_q)_d| <= 2 tol S (sum_t |a_t| + sum_q |b_q|)   for every direction d,
/// sum_q w_q |error of dJ/dw_q| <= 2 tol sum_t |a_t|,
/// ```
///
/// to first order in tol. All bounds are of exact arithmetic; rounding comes on top, about 2e-16 times the largest
/// logarithm of E that counts in a sum. The proof: `plan` for sums, `chebyshev` for a pair of boxes. What is observed
/// is smaller, a hundredth of the bound and less.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Method {
    /// Relative error of every sum below 1e-10: pairs that cannot matter are left out, those of which a few digits matter
    /// are summed in single precision (for the exponential) and, where there are more than
    /// 3e10 pairs, distant groups act on each other through Chebyshev grids wherever a count of operations says that
    /// it pays. The choice depends on numbers of points and on bounds, never on time.
    #[default]
    Auto,
    /// Every pair that can change a sum's last bits.
    Direct,
    /// Chebyshev grids wherever they pay, at this bound of the relative error of every sum.
    Tree {
        /// The bound; not below 1e-14.
        tolerance: f64,
    },
}

const TOLERANCE: f64 = 1e-10;
/// Up to here grids have been measured to cost about what they save.
const FAR_FROM: f64 = 3e10;

impl Method {
    fn accuracy(self, pairs: f64) -> Result<Accuracy, HausdorffError> {
        Ok(match self {
            Self::Auto => Accuracy { tolerance: TOLERANCE, far: pairs > FAR_FROM, single: true },
            Self::Direct => Accuracy { tolerance: f64::EPSILON / 16.0, far: false, single: false },
            Self::Tree { tolerance } => {
                Accuracy { tolerance: positive("tolerance", tolerance)?.max(1e-14), far: true, single: true }
            }
        })
    }
}

/// The sums over all pairs of a body and a target, value and derivative.
///
/// With p_q = w_q / |Omega| and s_t = w_t / |T|:
///
/// ```text
/// A_t = sum_q p_q phi(|x_q - y_t|)^alpha,    B_q = sum_t s_t phi(|x_q - y_t|)^alpha.
/// ```
///
/// These are the primitives from which `Evaluation` makes the smoothed Hausdorff distance; other functionals of A and B
/// can be made from them in the same way. The bits of all results depend on the kind of processor, not on the number
/// of threads.
#[derive(Debug)]
pub struct Pairs {
    kernel: Kernel,
    machine: Machine,
    tables: Tables,
    body: Side,
    body_floor: Floor,
    target: Side,
    target_floor: Floor,
    plan: Plan,
}

/// Logarithms of the sums, see `Pairs`, in the numbering of the clouds.
#[derive(Debug)]
pub struct LogSums {
    /// log A_t for every target point.
    pub target: Vec<f64>,
    /// log B_q for every body point.
    pub body: Vec<f64>,
    log2: Log2Sums,
}

/// What a change of the body does to a functional J(log A, log B), see `Pairs::vjp`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vjp {
    /// dJ/dx_q (1/metres).
    pub points: Vec<[f64; 3]>,
    /// dJ/dw_q through A (1/unit of the weights).
    pub weights: Vec<f64>,
}

/// Numbers of pairs: `all - near - far` were too small to count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Points of the body times points of the target.
    pub all: f64,
    /// Summed one by one.
    pub near: f64,
    /// Of these, in single precision.
    pub single: f64,
    /// Summed through Chebyshev grids.
    pub far: f64,
    /// Pairs of grid nodes (or of nodes and points) that stand for the far ones.
    pub grid: f64,
}

impl Pairs {
    /// Prepares the sums; `alpha` is the exponent of phi. Cost: a few times that of sorting the points.
    ///
    /// Errors: parameters that are not positive and finite.
    pub fn new(body: &Cloud, target: &Cloud, phi: Phi, alpha: f64, method: Method) -> Result<Self, HausdorffError> {
        Self::on(Machine::detect(), body, target, phi, alpha, method)
    }

    pub(super) fn on(
        machine: Machine,
        body: &Cloud,
        target: &Cloud,
        phi: Phi,
        alpha: f64,
        method: Method,
    ) -> Result<Self, HausdorffError> {
        phi.check()?;
        let kernel = Kernel::new(phi, positive("alpha", alpha)?);
        let accuracy = method.accuracy(body.len() as f64 * target.len() as f64)?;
        let origin = target.centre();
        let (body, target) =
            rayon::join(|| Side::new(body, origin, kernel.unit), || Side::new(target, origin, kernel.unit));
        let body_floor = Floor::new(&body, &target, &kernel, machine);
        let target_floor = Floor::new(&target, &body, &kernel, machine);
        let plan = Plan::new(&kernel, (&body, &body_floor), (&target, &target_floor), accuracy);
        Ok(Self { kernel, machine, tables: Tables::new(), body, body_floor, target, target_floor, plan })
    }

    /// log A and log B.
    pub fn log_sums(&self) -> LogSums {
        let (rows, columns) = self.halves();
        let log2 = Summation::new(&self.kernel, self.machine, &self.tables, rows, columns).run(&self.plan);
        let natural = |log2: &[f64]| -> Vec<f64> { log2.iter().map(|z| LN_2 * z + self.kernel.log_at_zero).collect() };
        LogSums {
            target: in_cloud_order(&self.target.cloud, &natural(&log2.columns)),
            body: in_cloud_order(&self.body.cloud, &natural(&log2.rows)),
            log2: log2.padded(),
        }
    }

    /// The derivative of J(log A, log B) with respect to the body's points and weights, given dJ/dlog A_t and
    /// dJ/dlog B_q. Where a body point meets a target point, the kink of phi contributes zero.
    ///
    /// Errors: seeds of the wrong length.
    pub fn vjp(&self, sums: &LogSums, by_target: &[f64], by_body: &[f64]) -> Result<Vjp, HausdorffError> {
        check("derivatives by log A", by_target, &self.target.cloud)?;
        check("derivatives by log B", by_body, &self.body.cloud)?;
        let (row_seed, column_seed) =
            (in_tree_order(&self.body.cloud, by_body), in_tree_order(&self.target.cloud, by_target));
        let (rows, columns) = self.halves();
        let adjoint =
            Adjoint::new(&self.kernel, self.machine, &self.tables, rows, columns, &row_seed, &column_seed, &sums.log2);
        let pulled = in_cloud_order(&self.body.cloud, &adjoint.run(&self.plan));
        let factor = self.kernel.gradient_factor();
        // A_t = sum_q w_q E_qt / sum_q w_q
        let total: f64 = by_target.iter().sum();
        Ok(Vjp {
            points: pulled.iter().map(|p| [factor * p[0], factor * p[1], factor * p[2]]).collect(),
            weights: pulled.iter().map(|p| (p[3] - total) / self.body.cloud.measure()).collect(),
        })
    }

    /// The body.
    pub fn body(&self) -> &Cloud {
        &self.body.cloud
    }

    /// The target.
    pub fn target(&self) -> &Cloud {
        &self.target.cloud
    }

    /// How the sums are formed, in numbers of pairs.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts {
            all: self.body().len() as f64 * self.target().len() as f64,
            near: 0.0,
            single: 0.0,
            far: 0.0,
            grid: 0.0,
        };
        for pair in self.plan.panels.iter().flatten() {
            let (m, n) = (self.body.node(pair.row).count as usize, self.target.node(pair.column).count as usize);
            let on = |via: Option<Via>, points: usize| via.map_or(points, |via| nodes(via.orders));
            if pair.row_grid.is_none() && pair.column_grid.is_none() {
                counts.near += pair.double.join(pair.single).pairs(m, n) as f64;
                counts.single += pair.single.pairs(m, n) as f64;
            } else {
                counts.far += (m * n) as f64;
                counts.grid += (on(pair.row_grid, m) * on(pair.column_grid, n)) as f64;
            }
        }
        counts
    }

    fn halves(&self) -> (Half<'_>, Half<'_>) {
        (
            Half {
                side: &self.body,
                floor: &self.body_floor,
                grids: &self.plan.row_grids,
                frames: &self.plan.row_frames,
            },
            Half {
                side: &self.target,
                floor: &self.target_floor,
                grids: &self.plan.column_grids,
                frames: &self.plan.column_frames,
            },
        )
    }
}

fn check(what: &'static str, seed: &[f64], cloud: &Cloud) -> Result<(), HausdorffError> {
    if seed.len() == cloud.len() {
        Ok(())
    } else {
        Err(HausdorffError::Length { what, found: seed.len(), points: cloud.len() })
    }
}
