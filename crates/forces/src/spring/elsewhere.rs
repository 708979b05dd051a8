//! [`SpringElsewhere`]: what the other ranks have of a spring that one of them has.

use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;

/// A spring on the cells of another rank: it has its name, and acts on nothing here.
#[derive(Debug)]
pub(crate) struct SpringElsewhere(pub(super) String);

impl Contribution for SpringElsewhere {
    fn name(&self) -> &str {
        &self.0
    }

    fn stores_energy(&self) -> bool {
        true
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for SpringElsewhere {
    fn add_residual(&self, _: &Instant, _: Demand, _: &mut Sums) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }
}
