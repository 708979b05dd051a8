//! A run under constraints that lacked memory during an update of the multipliers goes on as if nothing had happened, from the memory and
//! from bytes.

use nastic_opt::{
    AugmentedBest, AugmentedLagrangian, AugmentedRun, AugmentedState, Bounds, Constrained, ConstraintGroup, Diagonal,
    Domain, Failed, InnerProduct, Lbfgs, Objective, Problem, Request, Saved, Sense, Stop,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Outcomes<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// `j = (x - 3)^2 + (y + 1)^4` under `x + y <= 1`; asked to value a point anew, it lacks memory once `left` is used up.
struct Starved {
    left: AtomicUsize,
}

impl Objective for Starved {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(m.to_vec())
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        (m[0] - 3.0).powi(2) + (m[1] + 1.0).powi(4)
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(vec![2.0 * (m[0] - 3.0), 4.0 * (m[1] + 1.0).powi(3)])
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        match self.left.fetch_sub(1, Ordering::Relaxed) {
            0 => Err(Failed::because("too little memory").fatal()),
            _ => Ok(m.clone()),
        }
    }
}

impl Problem for Starved {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Diagonal::new(vec![1.0; 2]).map_err(Failed::new)?))
    }
}

impl Constrained for Starved {
    fn constraints(&self) -> Vec<ConstraintGroup> {
        vec![ConstraintGroup { name: "sum".into(), sense: Sense::AtMost, len: 1, scale: 1.0 }]
    }

    fn constraint_values(&self, m: &Vec<f64>) -> Vec<f64> {
        vec![m[0] + m[1] - 1.0]
    }

    fn lagrangian_derivative(&self, m: &mut Vec<f64>, y: &[f64], (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(self.derivative(m, &mut ())?.iter().map(|d| d + y[0]).collect())
    }
}

fn domain(problem: &Starved) -> Outcomes<Domain> {
    Ok(Domain { set: Arc::new(Bounds::new(-5.0, 5.0)?), metric: problem.inner_product()?, cancel: None })
}

fn finished(mut run: AugmentedRun<&Starved>) -> AugmentedBest<Vec<f64>> {
    let stop = run.run(&mut ());
    run.finish(stop)
}

fn never() -> Starved {
    Starved { left: AtomicUsize::new(usize::MAX) }
}

/// Minimises until the `restages`-th point is valued anew; the state then, and the run.
fn aborted_after(restages: usize) -> Outcomes<Option<(AugmentedState, AugmentedBest<Vec<f64>>)>> {
    let problem = Starved { left: AtomicUsize::new(restages) };
    let mut run =
        AugmentedLagrangian::default().start(&Lbfgs::default(), &problem, domain(&problem)?, &[0.0, 0.0][..])?;
    let Stop::Aborted(_) = run.run(&mut ()) else { return Ok(None) };
    let state = run.save();
    problem.left.store(usize::MAX, Ordering::Relaxed);
    let stop = run.run(&mut ());
    Ok(Some((state, run.finish(stop))))
}

#[test]
fn an_update_that_lacked_memory_is_made_again() -> Outcomes {
    let problem = never();
    let run = AugmentedLagrangian::default().start(&Lbfgs::default(), &problem, domain(&problem)?, &[0.0, 0.0][..])?;
    let whole = finished(run);
    assert!(
        whole.best.stop.is_converged() && whole.constraints.updates > 2,
        "{} {:?}",
        whole.best.stop,
        whole.constraints
    );
    let same = |found: &AugmentedBest<Vec<f64>>, what: &str| {
        assert_eq!((&found.best.m, &found.best.stop), (&whole.best.m, &whole.best.stop), "{what}");
        assert_eq!((&found.best.counts, &found.best.stages), (&whole.best.counts, &whole.best.stages), "{what}");
        assert_eq!(found.constraints, whole.constraints, "{what}");
    };
    // The first point is valued with the first penalty before the run begins.
    let mut seen = 0;
    for restages in 1.. {
        let Some((state, found)) = aborted_after(restages)? else { break };
        same(&found, &format!("from memory, valued anew {restages} times"));
        let state = AugmentedState::from_bytes(&state.to_bytes())?;
        let loaded = AugmentedLagrangian::default().load(&Lbfgs::default(), &problem, domain(&problem)?, &state)?;
        same(&finished(loaded), &format!("from bytes, valued anew {restages} times"));
        seen += 1;
    }
    assert!(seen >= whole.constraints.updates, "{seen} of {}", whole.constraints.updates);
    Ok(())
}
