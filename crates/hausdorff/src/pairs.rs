//! Two clouds and phi^alpha between all their points.

use std::f64::consts::LN_2;
use std::sync::Arc;

use super::cloud::Cloud;
use super::error::{HausdorffError, positive};
use super::kernel::Kernel;
use super::lanes::InstructionSet;
use super::leaf_pairs::{LeafPairs, Log2Sums};
use super::lower_bounds::{BoundedSet, LowerBounds};
use super::phi::Phi;
use super::point_set::{PointSet, in_cloud_order, in_tree_order};
use super::summation::Summation;
use super::together::Together;
use super::vjp::VjpSums;

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
    instructions: InstructionSet,
    log2_tolerance: f64,
    body: BoundedSet,
    target: BoundedSet,
    together: Option<Arc<dyn Together>>,
}

/// Logarithms of the sums, see `Pairs`, in the numbering of the clouds.
#[derive(Debug)]
pub struct LogSums {
    /// log A_t for every target point.
    pub target: Vec<f64>,
    /// log B_q for every body point.
    pub body: Vec<f64>,
    pub(super) log2: Log2Sums,
}

/// What a change of the body does to a functional J(log A, log B), see `Pairs::vjp`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vjp {
    /// dJ/dx_q (1/metres).
    pub points: Vec<[f64; 3]>,
    /// dJ/dw_q through A (1/unit of the weights).
    pub weights: Vec<f64>,
}

/// Numbers of pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Points of the body times points of the target.
    pub all: f64,
    /// Those that are summed; the others are too small to count.
    pub summed: f64,
}

impl Pairs {
    /// Prepares the sums; `alpha` is the exponent of phi. Cost: a few times that of sorting the points.
    ///
    /// Errors: parameters that are not positive and finite.
    pub fn new(
        body: &Cloud,
        target: &Cloud,
        phi: Phi,
        alpha: f64,
        summation: Summation,
    ) -> Result<Self, HausdorffError> {
        Self::on(InstructionSet::detect(), body, target, phi, alpha, summation)
    }

    /// The same pairs, whose sums several processes form together; all but those of second derivatives.
    #[must_use]
    pub fn together(self, together: Option<Arc<dyn Together>>) -> Self {
        Pairs { together, ..self }
    }

    pub(super) fn on(
        instructions: InstructionSet,
        body: &Cloud,
        target: &Cloud,
        phi: Phi,
        alpha: f64,
        summation: Summation,
    ) -> Result<Self, HausdorffError> {
        phi.check()?;
        let kernel = Kernel::new(phi, positive("alpha", alpha)?);
        let log2_tolerance = summation.tolerance()?.log2();
        let origin = target.centre();
        let (body, target) =
            rayon::join(|| PointSet::new(body, origin, kernel.unit), || PointSet::new(target, origin, kernel.unit));
        let of_body = LowerBounds::new(&body, &target, &kernel, instructions);
        let of_target = LowerBounds::new(&target, &body, &kernel, instructions);
        let body = BoundedSet { points: body, bounds: of_body };
        let target = BoundedSet { points: target, bounds: of_target };
        Ok(Self { kernel, instructions, log2_tolerance, body, target, together: None })
    }

    /// log A and log B.
    pub fn log_sums(&self) -> LogSums {
        let log2 = self.summed().log2_sums();
        let natural = |log2: &[f64]| -> Vec<f64> { log2.iter().map(|z| LN_2 * z + self.kernel.log_at_zero).collect() };
        LogSums {
            target: in_cloud_order(self.target(), &natural(&log2.columns)),
            body: in_cloud_order(self.body(), &natural(&log2.rows)),
            log2,
        }
    }

    /// The derivative of J(log A, log B) with respect to the body's points and weights, given dJ/dlog A_t and
    /// dJ/dlog B_q. Where a body point meets a target point, the kink of phi contributes zero.
    ///
    /// Errors: seeds of the wrong length.
    pub fn vjp(&self, sums: &LogSums, by_target: &[f64], by_body: &[f64]) -> Result<Vjp, HausdorffError> {
        check("derivatives by log A", by_target, self.target())?;
        check("derivatives by log B", by_body, self.body())?;
        let (row_seed, column_seed) = (in_tree_order(self.body(), by_body), in_tree_order(self.target(), by_target));
        let vjp = VjpSums::new(self.summed(), &row_seed, &column_seed, &sums.log2).run();
        let vjp = in_cloud_order(self.body(), &vjp);
        let factor = self.kernel.gradient_factor();
        // A_t = sum_q w_q E_qt / sum_q w_q
        let total: f64 = by_target.iter().sum();
        Ok(Vjp {
            points: vjp.iter().map(|p| [factor * p[0], factor * p[1], factor * p[2]]).collect(),
            weights: vjp.iter().map(|p| (p[3] - total) / self.body().measure()).collect(),
        })
    }

    /// The body.
    pub fn body(&self) -> &Cloud {
        &self.body.points.cloud
    }

    /// The target.
    pub fn target(&self) -> &Cloud {
        &self.target.points.cloud
    }

    /// How many pairs are summed.
    pub fn counts(&self) -> Counts {
        let (summed, rows, columns) = (self.summed(), &self.body.points, &self.target.points);
        let of_row = |row: u32| {
            let met: u32 = summed.columns_of(row).iter().map(|&column| columns.node(column).count).sum();
            f64::from(rows.node(row).count) * f64::from(met)
        };
        Counts {
            all: self.body().len() as f64 * self.target().len() as f64,
            summed: rows.leaves().into_iter().map(of_row).sum(),
        }
    }

    /// See `Kernel`.
    pub(super) fn gradient_factor(&self) -> f64 {
        self.kernel.gradient_factor()
    }

    /// The kernel's unit of length, metres.
    pub(super) fn unit(&self) -> f64 {
        self.kernel.unit
    }

    pub(super) fn summed(&self) -> LeafPairs<'_> {
        LeafPairs {
            kernel: &self.kernel,
            instructions: self.instructions,
            log2_tolerance: self.log2_tolerance,
            rows: &self.body,
            columns: &self.target,
            together: self.together.as_deref(),
        }
    }
}

pub(super) fn check(what: &'static str, seed: &[f64], cloud: &Cloud) -> Result<(), HausdorffError> {
    if seed.len() == cloud.len() {
        Ok(())
    } else {
        Err(HausdorffError::Length { what, found: seed.len(), points: cloud.len() })
    }
}
