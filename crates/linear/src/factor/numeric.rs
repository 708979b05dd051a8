//! The numbers of the factor: fronts are assembled from the matrix and their children, eliminated, and passed on.

use std::ops::Range;
use std::sync::Mutex;

use super::dense::{Slabs, Stop};
use super::panel::Panel;
use super::real::Real;
use super::schedule;
use super::symbolic::{Symbolic, Task};
use crate::locks::lock;

/// A dof (in elimination order) whose pivot cannot be used.
#[derive(Clone, Copy, Debug)]
pub(super) struct Breakdown {
    pub dof: usize,
    pub singular: bool,
}

/// Eliminates all fronts of `scale` times the matrix: overwrites the panels. The bits do not depend on `parallel`.
///
/// # Errors
/// The first pivot, in elimination order, that cannot be used.
pub(super) fn factorize<P: Panel>(
    symbolic: &Symbolic,
    matrix: &[f64],
    scale: f64,
    panels: Vec<P>,
    parallel: bool,
) -> Result<(), Breakdown> {
    let (tasks, parallel) = (symbolic.tasks(), parallel && symbolic.suits_threads());
    let run = Run {
        symbolic,
        matrix,
        scale,
        parallel,
        panels: panels.into_iter().map(Mutex::new).collect(),
        updates: symbolic.fronts().iter().map(|_| Mutex::new(Vec::new())).collect(),
        breakdown: Mutex::new(None),
    };
    schedule::upwards(tasks, parallel, |task| run.task(task));
    symbolic.return_buffers(run.updates.iter().map(|update| std::mem::take(&mut *lock(update))).collect());
    let breakdown = *lock(&run.breakdown);
    breakdown.map_or(Ok(()), Err)
}

struct Run<'a, P: Panel> {
    symbolic: &'a Symbolic,
    matrix: &'a [f64],
    scale: f64,
    parallel: bool,
    panels: Vec<Mutex<P>>,
    /// Update matrix that each eliminated front left for its parent, in [`Slabs`].
    updates: Vec<Mutex<Vec<P::Number>>>,
    breakdown: Mutex<Option<Breakdown>>,
}

impl<P: Panel> Run<'_, P> {
    /// Eliminates the fronts of a task; false if it, or one that comes before it, broke down.
    fn task(&self, task: &Task) -> bool {
        let fronts = task.fronts.clone();
        if lock(&self.breakdown).is_some_and(|found| found.dof < self.first_dof(fronts.start)) {
            return false;
        }
        for f in fronts {
            if let Err(breakdown) = self.front(f) {
                let mut first = lock(&self.breakdown);
                if first.is_none_or(|first| breakdown.dof < first.dof) {
                    *first = Some(breakdown);
                }
                return false;
            }
        }
        true
    }

    /// Eliminates front `f` and leaves its update matrix for the parent.
    fn front(&self, f: usize) -> Result<(), Breakdown> {
        let children = self.symbolic.children(f);
        let child_updates: Vec<Vec<P::Number>> =
            children.iter().map(|&child| std::mem::take(&mut *lock(&self.updates[child as usize]))).collect();
        let mut update = self.symbolic.take_buffer(Slabs::new(self.symbolic.below(f)).values());
        let eliminated = self.eliminate(f, &child_updates, &mut update);
        *lock(&self.updates[f]) = update;
        self.symbolic.return_buffers(child_updates);
        eliminated.map_err(|stop| self.breakdown_at(f, stop))
    }

    fn eliminate(&self, f: usize, child_updates: &[Vec<P::Number>], update: &mut [P::Number]) -> Result<(), Stop> {
        let children = || self.symbolic.children(f).iter().map(|&child| child as usize).zip(child_updates);
        let (width, below) = (self.symbolic.width(f), self.symbolic.below(f));
        let mut panel = lock(&self.panels[f]);
        self.assemble(f, panel.values());
        for (child, child_update) in children() {
            self.extend_add_panel(f, child, child_update, panel.values());
        }
        panel.eliminate(width, Slabs::new(below), update, self.parallel)?;
        for (child, child_update) in children() {
            self.extend_add_update(f, child, child_update, update);
        }
        Ok(())
    }

    fn breakdown_at(&self, f: usize, stop: Stop) -> Breakdown {
        match stop {
            Stop::NotPositive(column) => Breakdown { dof: self.first_dof(f) + column, singular: false },
            Stop::Singular(column) => Breakdown { dof: self.first_dof(f) + column, singular: true },
        }
    }

    fn first_dof(&self, f: usize) -> usize {
        self.symbolic.pattern().dim() * self.symbolic.fronts()[f].columns.start
    }

    /// Copies the matrix's columns of the front into its panel.
    fn assemble(&self, f: usize, panel: &mut [P::Number]) {
        let pattern = self.symbolic.pattern();
        let (dim, height) = (pattern.dim(), self.symbolic.height(f));
        let columns = &self.symbolic.fronts()[f].columns;
        let rows = self.symbolic.rows(f);
        panel.fill(P::Number::of(0.0));
        for (local, j) in columns.clone().enumerate() {
            let (first, matrix_rows) = pattern.column(j);
            let mut at = 0;
            for (k, &i) in matrix_rows.iter().enumerate() {
                let row = if (i as usize) < columns.end {
                    i as usize - columns.start
                } else {
                    while rows[at] < i {
                        at += 1;
                    }
                    columns.len() + at
                };
                let block = &self.matrix[dim * dim * (first + k)..][..dim * dim];
                for (c, column) in block.chunks_exact(dim).enumerate() {
                    let target = &mut panel[height * (dim * local + c) + dim * row..][..dim];
                    target.iter_mut().zip(column).for_each(|(t, &v)| *t = P::Number::of(self.scale * v));
                }
            }
        }
    }

    /// Adds the columns of a child's update matrix that front `f` eliminates to its panel.
    fn extend_add_panel(&self, f: usize, child: usize, child_update: &[P::Number], panel: &mut [P::Number]) {
        let rows = self.symbolic.rows_in_parent(child);
        let own = rows.partition_point(|&row| (row as usize) < self.symbolic.fronts()[f].columns.len());
        let height = self.symbolic.height(f);
        self.extend_add(rows, 0..own, child_update, panel, |column| (height * column..height * (column + 1), 0));
    }

    /// Adds the other columns to the update matrix of front `f`.
    fn extend_add_update(&self, f: usize, child: usize, child_update: &[P::Number], update: &mut [P::Number]) {
        let rows = self.symbolic.rows_in_parent(child);
        let own = rows.partition_point(|&row| (row as usize) < self.symbolic.fronts()[f].columns.len());
        let (width, slabs) = (self.symbolic.width(f), Slabs::new(self.symbolic.below(f)));
        self.extend_add(rows, own..rows.len(), child_update, update, |column| {
            let (stored, first) = slabs.column(column - width);
            (stored, first + width)
        });
    }

    /// Adds the lower triangle of some (node) columns of a child's update matrix to those of a matrix of the parent.
    ///
    /// `rows` are the node positions of the child's rows in the parent; `place` says where the parent's matrix stores a
    /// dof column, and the first dof row it stores there.
    fn extend_add(
        &self,
        rows: &[u32],
        columns: Range<usize>,
        child_update: &[P::Number],
        target: &mut [P::Number],
        place: impl Fn(usize) -> (Range<usize>, usize),
    ) {
        let dim = self.symbolic.pattern().dim();
        let runs = runs(&rows[columns.start..], columns.start, dim);
        let slabs = Slabs::new(dim * rows.len());
        let mut first_run = 0;
        for k in columns {
            while runs[first_run].0.end <= dim * k {
                first_run += 1;
            }
            for c in 0..dim {
                let (stored, skipped) = slabs.column(dim * k + c);
                let source = &child_update[stored];
                let (stored, first_row) = place(dim * rows[k] as usize + c);
                let target = &mut target[stored];
                for (from, to) in &runs[first_run..] {
                    let start = from.start.max(dim * k);
                    let to = to + (start - from.start) - first_row;
                    let source = &source[start - skipped..from.end - skipped];
                    target[to..to + source.len()].iter_mut().zip(source).for_each(|(t, s)| *t += *s);
                }
            }
        }
    }
}

/// Maximal ranges of a child's dof rows that are consecutive in the parent, with where they start there.
fn runs(rows_in_parent: &[u32], first: usize, dim: usize) -> Vec<(Range<usize>, usize)> {
    let mut runs: Vec<(Range<usize>, usize)> = Vec::new();
    for (k, &row) in (first..).zip(rows_in_parent) {
        let to = dim * row as usize;
        match runs.last_mut() {
            Some((from, start)) if *start + from.len() == to => from.end += dim,
            _ => runs.push((dim * k..dim * (k + 1), to)),
        }
    }
    runs
}
