//! [`Spectrum`]: leading eigenpairs of the reduced Hessian at an optimum, and the accuracy of the control by them.

mod krylov;

use crate::admissible::Face;
use crate::augmented::Domain;
use crate::failed::Failed;
use crate::hessian::{Hessian, ProductsAt};
use crate::inner_product::InnerProduct;
use crate::method::HessianProducts;
use crate::objective::Objective;
use krylov::Krylov;
use nastic_numeric::vector::{axpy, dot};
use std::sync::atomic::Ordering;
use thiserror::Error;

/// Share of the largest absolute eigenvalue below which others are zero within rounding.
const ZERO: f64 = 1e-10;

/// Eigenpairs of `H v = lambda G v` on the free directions of a control: H is the second derivative of the cost, through the curvature of the
/// set too, G the Gram matrix of the inner product, and active bounds are fixed ([`Admissible::face`](crate::Admissible::face)).
///
/// At an optimum m* the cost along an eigenvector is `j(m* + t v_k) = j(m*) + lambda_k t^2 / 2 + o(t^2)`: directions of large lambda are
/// well determined by the target, those of small lambda are not.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The algebraically largest eigenvalues, descending, in the unit of the cost per squared norm of the control. Fewer than asked for if
    /// there are not so many free directions, or the products did not suffice.
    pub values: Vec<f64>,
    /// Their eigenvectors, whole control vectors, `v_i . G v_k = delta_ik`; the entry of largest size is positive.
    pub vectors: Vec<Vec<f64>>,
    /// `|H v_k - lambda_k G v_k|` in the dual norm on the free directions, by a product of its own for each, relative to the largest absolute
    /// value of `v . H v / v . G v` that was met. An eigenvalue lies within that part of this value from `lambda_k`.
    pub residuals: Vec<f64>,
    /// Number of free directions.
    pub free: usize,
    /// The smallest `v . H v / v . G v` that was met, 0 without free directions: the smallest eigenvalue is not above it.
    pub lowest: f64,
    /// Lower bound of the number of negative eigenvalues (Cauchy's interlacing): if it is positive, the control is a saddle within the free
    /// directions, and no minimum.
    pub negative: usize,
    /// Products with H, those for the residuals included.
    pub products: usize,
}

/// Options of a [`Spectrum`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumOptions {
    /// Number of eigenpairs.
    pub count: usize,
    /// Which second derivative.
    pub hessian: Hessian,
    /// Residual of a converged pair in the Krylov space, relative to the largest absolute eigenvalue met.
    pub tolerance: f64,
    /// Largest number of products, without those for the residuals.
    pub max_products: usize,
}

impl SpectrumOptions {
    /// This number of eigenpairs of the exact second derivative.
    pub fn leading(count: usize) -> Self {
        Self { count, hessian: Hessian::Exact, tolerance: 1e-8, max_products: 100 + 10 * count }
    }
}

/// Why there is no spectrum.
#[derive(Clone, Debug, Error)]
pub enum SpectrumError {
    /// No eigenpair was asked for.
    #[error("no eigenpair of the reduced Hessian was asked for: ask for one at least")]
    Count,
    /// Vectors of different lengths.
    #[error("the control has {control} components, its inner product {metric}")]
    Lengths {
        /// Components of the control.
        control: usize,
        /// Components of the inner product.
        metric: usize,
    },
    /// The derivative, which shows the active bounds, or a product failed.
    #[error("the second derivative at the optimum: {0}")]
    Product(#[from] Failed),
    /// The flag of the domain was set.
    #[error("cancelled")]
    Cancelled,
}

impl Spectrum {
    /// The spectrum at an evaluated control, as its continuation stage values it.
    ///
    /// Lanczos' method with full reorthogonalisation in the inner product G, from up to four seeded start vectors (Ruhe 1979, "Implementation
    /// aspects of band Lanczos algorithms", Math. Comp. 33): eigenvalues of multiplicity up to four are found as often as they are there.
    ///
    /// # Errors
    /// [`SpectrumError`].
    pub fn at<O: Objective>(
        objective: &O,
        m: &[f64],
        point: &mut O::Point,
        domain: &Domain,
        options: &SpectrumOptions,
        workspace: &mut O::Workspace,
    ) -> Result<Self, SpectrumError> {
        let Domain { set, metric, cancel } = domain;
        let (set, metric) = (set.as_ref(), metric.as_ref());
        if options.count == 0 {
            return Err(SpectrumError::Count);
        }
        if m.len() != metric.len() {
            return Err(SpectrumError::Lengths { control: m.len(), metric: metric.len() });
        }
        let whole_derivative = objective.derivative(point, workspace)?;
        let mut derivative = whole_derivative.clone();
        set.tangent(m, &mut derivative);
        let face = set.face(m, &vec![0.0; m.len()], &derivative);
        let (whole_derivative, point) = (whole_derivative.as_slice(), &*point);
        let mut count = 0;
        let mut products = ProductsAt { objective, set, m, whole_derivative, point, workspace, count: &mut count };
        let product = |v: &[f64]| {
            let here = cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
            match objective.any(here)? {
                true => Err(SpectrumError::Cancelled),
                false => Ok(products.product(v, options.hessian)?),
            }
        };
        let mut out = Self::on_face(&face, metric, options, product)?;
        out.products = count;
        Ok(out)
    }

    /// Of an operator `v -> H v` on a face.
    fn on_face(
        face: &Face,
        metric: &dyn InnerProduct,
        options: &SpectrumOptions,
        mut product: impl FnMut(&[f64]) -> Result<Vec<f64>, SpectrumError>,
    ) -> Result<Self, SpectrumError> {
        let free = face.dimension();
        if free == 0 {
            return Ok(Self::default());
        }
        let wanted = options.count.min(free);
        let mut krylov = Krylov::new(face, metric, free);
        let ritz = loop {
            let Some(q) = krylov.next() else { break krylov.ritz() };
            let image = face.gradient(metric, &product(&q)?);
            let steps = krylov.add(image);
            if krylov.is_due() || steps >= options.max_products {
                let ritz = krylov.ritz();
                if ritz.converged(options.tolerance) >= wanted || steps >= options.max_products {
                    break ritz;
                }
            }
        };
        let scale_of_all = ritz.scale();
        let (lowest, negative) = (ritz.lowest(), ritz.below(-ZERO * scale_of_all));
        let mut out = Self { lowest, negative, free, ..Self::default() };
        for k in 0..ritz.converged(options.tolerance).min(wanted) {
            let v = normalised(krylov.combined(&ritz, k), metric);
            let image = product(&v)?;
            let value = dot(&v, &image);
            let mut residual = image;
            axpy(-value, &metric.apply(&v), &mut residual);
            let size = dot(&residual, &face.gradient(metric, &residual)).max(0.0).sqrt();
            out.values.push(value);
            out.residuals.push(if scale_of_all > 0.0 { size / scale_of_all } else { size });
            out.vectors.push(v);
        }
        Ok(out)
    }

    /// Number of eigenvalues above a share of the largest, the number of directions that matter.
    pub fn above(&self, share: f64) -> usize {
        let Some(largest) = self.values.first().filter(|largest| **largest > 0.0) else { return 0 };
        self.values.iter().filter(|value| **value > share * largest).count()
    }

    /// How far the control may go along eigenvector k, `sqrt(2 rise / lambda_k)`, in the norm of the control, until the quadratic model of
    /// the cost has risen by `rise`; `None` where the eigenvalue is not above zero beyond rounding.
    pub fn half_width(&self, k: usize, rise: f64) -> Option<f64> {
        let value = *self.values.get(k)?;
        let scale = self.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        (value > ZERO * scale).then(|| (2.0 * rise / value).sqrt())
    }

    /// `sqrt(sum_k (2 rise / lambda_k) v_k^2)`, component by component, over the eigenvalues that are here and above zero: the pointwise
    /// half-width of the set `{(m - m*) . H (m - m*) / 2 <= rise}` in their span, in the unit of the control; a lower bound, for directions
    /// beyond are left out. With `rise = s^2/2` it is s times the standard deviation of the Laplace approximation of a posterior density
    /// `exp(-j)`: Bui-Thanh, Ghattas, Martin and Stadler (2013), "A computational framework for infinite-dimensional Bayesian inverse
    /// problems, part I", SIAM J. Sci. Comput. 35.
    pub fn pointwise_half_width(&self, rise: f64) -> Vec<f64> {
        let mut squares = vec![0.0; self.vectors.first().map_or(0, Vec::len)];
        for (k, v) in self.vectors.iter().enumerate() {
            let Some(width) = self.half_width(k, rise) else { continue };
            squares.iter_mut().zip(v).for_each(|(sum, v)| *sum += (width * v) * (width * v));
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

impl Default for Spectrum {
    /// Of no free direction.
    fn default() -> Self {
        let (values, vectors, residuals) = (vec![], vec![], vec![]);
        Self { values, vectors, residuals, free: 0, lowest: 0.0, negative: 0, products: 0 }
    }
}

/// Of norm one, the entry of largest size positive.
fn normalised(mut v: Vec<f64>, metric: &dyn InnerProduct) -> Vec<f64> {
    let largest = v.iter().fold(0.0, |largest: f64, x| if x.abs() > largest.abs() { *x } else { largest });
    let factor = largest.signum() / metric.norm(&v);
    // No zeros with a sign.
    v.iter_mut().for_each(|v| *v = factor * *v + 0.0);
    v
}
