//! Back substitution along the tree of fronts, for several right-hand sides at once.

use std::sync::{Mutex, RwLock};

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::{Accum, MatMut, Par};

use super::columns;
use super::real::Real;
use super::schedule;
use super::symmetric::{Factor, Pivots};
use crate::locks::{lock, read, write};

/// Right-hand sides on their way to solutions. Every front has its own `width x columns` block, one after the other.
struct Sweep<'a, T> {
    factor: &'a Factor,
    values: &'a [T],
    columns: usize,
    blocks: Vec<RwLock<&'a mut [T]>>,
    /// The values that each front passes to its parent, `below x columns`.
    updates: Vec<Mutex<Vec<T>>>,
}

/// Overwrites the columns of `rhs` (dofs by mesh node) with solutions.
pub(super) fn solve<T: Real>(factor: &Factor, values: &[T], rhs: &mut [f64], columns: usize, parallel: bool) {
    let symbolic = factor.symbolic();
    let parallel = parallel && symbolic.suits_threads_to_solve(columns);
    let mut x: Vec<T> = gather(factor, rhs, columns);
    let mut rest = &mut x[..];
    let mut blocks = Vec::with_capacity(symbolic.fronts().len());
    for f in 0..symbolic.fronts().len() {
        blocks.push(RwLock::new(rest.split_off_mut(..symbolic.width(f) * columns).unwrap_or_default()));
    }
    let updates = blocks.iter().map(|_| Mutex::new(Vec::new())).collect();
    let sweep = Sweep { factor, values, columns, blocks, updates };
    schedule::upwards(symbolic.tasks(), parallel, |task| {
        task.fronts.clone().for_each(|f| sweep.forward(f));
        true
    });
    schedule::downwards(symbolic.tasks(), parallel, |task| task.fronts.clone().rev().for_each(|f| sweep.backward(f)));
    scatter(factor, &x, rhs, columns);
}

impl<T: Real> Sweep<'_, T> {
    /// `y = L^-1 b` for the front's own rows; what that takes off the rows below goes to the parent.
    fn forward(&self, f: usize) {
        if self.columns == 1 && self.factor.pivots() == Pivots::Positive {
            return self.forward_one(f);
        }
        let symbolic = self.factor.symbolic();
        let (top, bottom) = self.factor.panel(f, self.values);
        let (width, below) = (symbolic.width(f), symbolic.below(f));
        let mut block = write(&self.blocks[f]);
        let mut own = MatMut::from_column_major_slice_mut(&mut block, width, self.columns);
        let mut update = vec![T::of(0.0); below * self.columns];
        let mut down = MatMut::from_column_major_slice_mut(&mut update, below, self.columns);
        for &child in symbolic.children(f) {
            let from_child = std::mem::take(&mut *lock(&self.updates[child as usize]));
            self.add_update(child as usize, &from_child, own.as_mut(), down.as_mut());
        }
        match self.factor.pivots() {
            Pivots::Positive => triangular::solve_lower_triangular_in_place(top, own.as_mut(), Par::Seq),
            Pivots::AnySign => {
                self.factor.permute(f, own.as_mut());
                triangular::solve_unit_lower_triangular_in_place(top, own.as_mut(), Par::Seq);
            }
        }
        if below > 0 {
            matmul(down, Accum::Add, bottom, own.as_ref(), T::of(-1.0), Par::Seq);
            *lock(&self.updates[f]) = update;
        }
    }

    /// [`forward`](Self::forward) of a single right-hand side.
    fn forward_one(&self, f: usize) {
        let symbolic = self.factor.symbolic();
        let (width, below) = (symbolic.width(f), symbolic.below(f));
        let mut block = write(&self.blocks[f]);
        let mut work = vec![T::of(0.0); width + below];
        work[..width].copy_from_slice(&block);
        for &child in symbolic.children(f) {
            let from_child = std::mem::take(&mut *lock(&self.updates[child as usize]));
            let dim = symbolic.pattern().dim();
            for (&row, node) in symbolic.rows_in_parent(child as usize).iter().zip(from_child.chunks_exact(dim)) {
                let target = &mut work[dim * row as usize..][..dim];
                target.iter_mut().zip(node).for_each(|(t, v)| *t += *v);
            }
        }
        columns::forward(self.factor.panel_values(f, self.values), width, &mut work);
        block.copy_from_slice(&work[..width]);
        if below > 0 {
            work.drain(..width);
            *lock(&self.updates[f]) = work;
        }
    }

    /// [`backward`](Self::backward) of a single right-hand side.
    fn backward_one(&self, f: usize) {
        let width = self.factor.symbolic().width(f);
        let solved = self.rows_below(f);
        let mut block = write(&self.blocks[f]);
        let mut work = Vec::with_capacity(width + solved.len());
        work.extend_from_slice(&block);
        work.extend_from_slice(&solved);
        columns::backward(self.factor.panel_values(f, self.values), width, &mut work);
        block.copy_from_slice(&work[..width]);
    }

    fn add_update(&self, child: usize, update: &[T], mut own: MatMut<'_, T>, mut down: MatMut<'_, T>) {
        let dim = self.factor.symbolic().pattern().dim();
        let rows = self.factor.symbolic().rows_in_parent(child);
        let width = own.nrows();
        for (column, values) in update.chunks_exact((dim * rows.len()).max(1)).enumerate() {
            for (&row, node) in rows.iter().zip(values.chunks_exact(dim)) {
                for (c, value) in node.iter().enumerate() {
                    let row = dim * row as usize + c;
                    if row < width {
                        own[(row, column)] += *value;
                    } else {
                        down[(row - width, column)] += *value;
                    }
                }
            }
        }
    }

    /// `x = L^-T D^-1 y` for the front's own rows; the rows below are solved already.
    fn backward(&self, f: usize) {
        if self.columns == 1 && self.factor.pivots() == Pivots::Positive {
            return self.backward_one(f);
        }
        let symbolic = self.factor.symbolic();
        let (top, bottom) = self.factor.panel(f, self.values);
        let (width, below) = (symbolic.width(f), symbolic.below(f));
        let solved = self.rows_below(f);
        let mut block = write(&self.blocks[f]);
        let mut own = MatMut::from_column_major_slice_mut(&mut block, width, self.columns);
        if self.factor.pivots() == Pivots::AnySign {
            self.factor.diagonal_blocks(f).iter().for_each(|pivot| pivot.divide_rows(own.as_mut()));
        }
        if below > 0 {
            let solved = faer::MatRef::from_column_major_slice(&solved, below, self.columns);
            matmul(own.as_mut(), Accum::Add, bottom.transpose(), solved, T::of(-1.0), Par::Seq);
        }
        match self.factor.pivots() {
            Pivots::Positive => triangular::solve_upper_triangular_in_place(top.transpose(), own, Par::Seq),
            Pivots::AnySign => {
                triangular::solve_unit_upper_triangular_in_place(top.transpose(), own.as_mut(), Par::Seq);
                self.factor.unpermute(f, own);
            }
        }
    }

    /// The solution at the rows below the columns of front `f`, from the blocks of its ancestors.
    fn rows_below(&self, f: usize) -> Vec<T> {
        let symbolic = self.factor.symbolic();
        let dim = symbolic.pattern().dim();
        let below = symbolic.below(f);
        let mut solved = vec![T::of(0.0); below * self.columns];
        let (mut rest, mut first, mut ancestor) = (symbolic.rows(f), 0, symbolic.fronts()[f].parent);
        while let (Some(a), false) = (ancestor, rest.is_empty()) {
            let nodes = &symbolic.fronts()[a].columns;
            let (here, above) = rest.split_at(rest.partition_point(|&row| (row as usize) < nodes.end));
            let block = read(&self.blocks[a]);
            for (column, values) in block.chunks_exact(dim * nodes.len()).enumerate() {
                let target = &mut solved[below * column + dim * first..][..dim * here.len()];
                for (&row, target) in here.iter().zip(target.chunks_exact_mut(dim)) {
                    target.copy_from_slice(&values[dim * (row as usize - nodes.start)..][..dim]);
                }
            }
            first += here.len();
            rest = above;
            ancestor = symbolic.fronts()[a].parent;
        }
        solved
    }
}

/// Right-hand sides in the order of the fronts.
fn gather<T: Real>(factor: &Factor, rhs: &[f64], columns: usize) -> Vec<T> {
    let mut x = Vec::with_capacity(rhs.len());
    visit(factor, columns, |at, dim| x.extend(rhs[at..at + dim].iter().map(|&value| T::of(value))));
    x
}

/// The inverse of [`gather`].
fn scatter<T: Real>(factor: &Factor, x: &[T], solution: &mut [f64], columns: usize) {
    let mut rest = x;
    visit(factor, columns, |at, dim| {
        if let Some(values) = rest.split_off(..dim) {
            solution[at..at + dim].iter_mut().zip(values).for_each(|(s, x)| *s = x.double());
        }
    });
}

/// Calls with the place of every node's dofs in mesh order, in the order of the fronts, and their number.
fn visit(factor: &Factor, columns: usize, mut call: impl FnMut(usize, usize)) {
    let pattern = factor.symbolic().pattern();
    let (dim, dofs) = (pattern.dim(), pattern.dofs());
    for front in factor.symbolic().fronts() {
        for column in 0..columns {
            for &node in &pattern.ordering().new_to_old()[front.columns.clone()] {
                call(dofs * column + dim * node as usize, dim);
            }
        }
    }
}
