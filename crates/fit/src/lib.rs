//! Parameters of laws from test data.
//!
//! Tests are homogeneous deformations ([`Mode`]) of a material that keeps its volume; a law's parameters are those of least weighted
//! squares over all tests together, found by the Levenberg-Marquardt method from several starts ([`fit`]). The change of volume is a separate,
//! linear problem ([`bulk`]). What is reported besides: intervals and correlation from the Gauss-Newton covariance, information criteria,
//! the range in which the fitted law is stable, and scenarios that carry its uncertainty.
//!
//! ```
//! use nastic_fit::{FitOptions, Law, Mode, Response, Test, fit};
//! # fn main() -> Result<(), nastic_fit::FitError> {
//! // sigma = mu (l^2 - 1/l) with mu = 0.4 MPa, as nominal stress
//! let points = [1.1, 1.5, 2.0, 3.0].map(|l: f64| [l, 0.4e6 * (l - 1.0 / (l * l))]);
//! let test = Test::new("bar", Mode::Uniaxial, Response::Nominal, points.to_vec())?;
//! let found = fit(Law::named("neo_hooke_isochoric")?, &[test], &FitOptions::default())?;
//! assert!((found.parameters[0].value / 0.4e6 - 1.0).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```

mod coverage;
mod data;
mod error;
mod free_numbers;
mod law;
mod least_squares;
mod network;
mod scenario;
mod specimen;
mod stability;
mod statistics;
mod test;
mod volume;

pub use coverage::Coverage;
pub use error::FitError;
pub use law::{Entry, Law};
pub use least_squares::{Errors, Fit, FitOptions, Starts, fit, squares};
pub use scenario::{Scenario, scenarios};
pub use stability::{End, Range, stable_range};
pub use statistics::{Criteria, Estimate, student};
pub use test::{Fibers, Mode, Response, Test, curve, r_squared};
pub use volume::{Bulk, bulk};
