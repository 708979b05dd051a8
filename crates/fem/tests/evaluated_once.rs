//! Contributions are evaluated once per displacement: derivatives are taken from the point whose residual was found.

use crate::common;

use common::{Outcome, own_contributions::bar};
use nastic_fem::{Contribution, ContributionPoint, Demand, Inadmissible, Instant, Need, SolveOptions, Sums};
use nastic_linear::SparseMatrix;
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A contribution without forces that counts what it is asked.
#[derive(Debug, Clone, Default)]
struct Counting(Arc<Counts>);

#[derive(Debug, Default)]
struct Counts {
    /// Evaluations of which derivatives were wanted.
    points: AtomicUsize,
    residuals: AtomicUsize,
    tangents: AtomicUsize,
    /// Tangents of a point whose residual nobody asked for.
    afresh: AtomicUsize,
}

struct Point<'a> {
    of: &'a Counts,
    found: Cell<bool>,
    counts: bool,
}

impl Contribution for Counting {
    fn name(&self) -> &str {
        "counting"
    }

    fn at<'a>(&'a self, _: &Instant, need: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        let counts = need == Need::Derivatives;
        self.0.points.fetch_add(usize::from(counts), Relaxed);
        Ok(Box::new(Point { of: &self.0, found: Cell::new(false), counts }))
    }
}

impl ContributionPoint for Point<'_> {
    fn add_residual(&self, _: &Instant, _: Demand, _: &mut Sums) -> Result<(), Inadmissible> {
        self.found.set(true);
        self.of.residuals.fetch_add(usize::from(self.counts), Relaxed);
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.of.tangents.fetch_add(1, Relaxed);
        self.of.afresh.fetch_add(usize::from(!self.found.get()), Relaxed);
        Ok(())
    }
}

#[test]
fn the_tangent_of_an_accepted_iterate_is_that_of_its_evaluation() -> Outcome {
    let counting = Counting::default();
    let counts = counting.0.clone();
    let solid = bar()?.contribution(counting)?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(-4e4);
    let report = solid.solve(&controls, &SolveOptions::default())?.report;
    let [points, residuals, tangents, afresh] =
        [&counts.points, &counts.residuals, &counts.tangents, &counts.afresh].map(|count| count.load(Relaxed));
    assert!(report.newton > 2, "{}", report.newton);
    assert_eq!((tangents, afresh), (report.newton, 0));
    // one for each trial
    assert_eq!(points, residuals);
    Ok(())
}

/// A point keeps `1 + grad u` of the body: its tangent does not look at u again.
#[test]
fn a_body_keeps_its_deformation_gradients() -> Outcome {
    let solid = bar()?;
    let (model, controls) = (solid.model(), solid.controls());
    let u: Vec<f64> = (0..model.unknowns().len()).map(|i| 1e-3 * ((i * i) % 7) as f64).collect();
    let (rest, there) = (vec![0.0; u.len()], Instant::new(&u, &controls, 1.0));
    let (mut kept, mut expected) = (model.tangents().matrix(), model.tangents().matrix());
    model.tangents().add_tangent(&there, &mut expected)?;
    let point = model.at(&there, Need::Derivatives)?;
    point.evaluate(&there, Demand { energy: true, force: true })?;
    point.add_tangent(&Instant::new(&rest, &controls, 1.0), &mut kept)?;
    assert!(kept.values == expected.values);
    Ok(())
}
