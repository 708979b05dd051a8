//! [`Print`]: an observer that writes the table of trials.

use crate::objective::Objective;
use crate::observer::{Observer, Trial};
use crate::summary::Summary;
use crate::trial_table::TrialTable;
use std::io::Write;
use std::time::Instant;

/// An [`Observer`] that writes a line per trial to a place of the user's, in the columns that `nastic optimize` shows
/// ([`TrialTable`]); a line above them names the columns.
///
/// Lines that cannot be written are left out: a run does not end because nobody reads it.
///
/// ```
/// # use nastic_opt::{Diagonal, Failed, InnerProduct, Objective, Problem, Request};
/// # use std::sync::Arc;
/// # struct Square;
/// # impl Objective for Square {
/// #     type Point = Vec<f64>;
/// #     type Workspace = ();
/// #     fn evaluate(&self, m: &[f64], _: &Request<Vec<f64>>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(m.to_vec()) }
/// #     fn value(&self, m: &Vec<f64>) -> f64 { m[0] * m[0] + 1.0 }
/// #     fn derivative(&self, m: &mut Vec<f64>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(vec![2.0 * m[0]]) }
/// #     fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> { Ok(m.clone()) }
/// # }
/// # impl Problem for Square {
/// #     fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
/// #         Ok(Arc::new(Diagonal::new(vec![1.0]).map_err(Failed::new)?))
/// #     }
/// # }
/// use nastic_opt::{Bounds, Lbfgs, Optimizer, Print};
///
/// let mut text = Vec::new(); // std::io::stdout() in a program
/// Lbfgs::default().within(Bounds::new(-2.0, 2.0)?).observe(Print::of(&Square, &mut text)).minimize(&Square, 1.5)?;
/// let text = String::from_utf8(text)?;
/// assert!(text.starts_with("trial  iter           cost   gradient      step"));
/// assert!(text.lines().nth(1).is_some_and(|row| row.ends_with("start")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Print<'p, T: ?Sized, W> {
    problem: &'p T,
    out: W,
    /// The columns, from the first trial on.
    table: Option<TrialTable>,
    last: Instant,
}

impl<'p, T: Objective + ?Sized, W: Write> Print<'p, T, W> {
    /// Writes to `out`; the problem says how many stages there are, and what is known of a point beside its cost.
    pub fn of(problem: &'p T, out: W) -> Self {
        Self { problem, out, table: None, last: Instant::now() }
    }
}

impl<T: Objective + ?Sized, W: Write> Observer<T::Point> for Print<'_, T, W> {
    fn trial(&mut self, trial: &Trial<'_, T::Point>) {
        let figures = match trial.point.filter(|_| trial.accepted) {
            Some(point) => self.problem.figures(point),
            None => Summary::default(),
        };
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        let table = match self.table {
            Some(table) => table,
            None => {
                let table = TrialTable::new(self.problem.stages(), &figures);
                let _ = writeln!(self.out, "{}", table.header());
                *self.table.insert(table)
            }
        };
        let row = table.row(trial, &figures, seconds);
        let _ = writeln!(self.out, "{row}").and_then(|()| self.out.flush());
    }
}
