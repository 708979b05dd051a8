//! The structure of the factor: dense fronts along the elimination tree.
//!
//! Duff, Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", ACM TOMS 9 (1983);
//! Liu, "The multifrontal method for sparse matrix solution", SIAM Review 34 (1992).

use std::ops::Range;
use std::sync::Arc;

use super::dense::Slabs;
use super::factor_size::{FactorSize, front_flops};
use super::real::{Real, Workspace};
use crate::error::StructureError;
use crate::locks::lock;
use crate::pattern::elimination::ROOT;
use crate::pattern::entries::Pattern;

/// The symbolic factorisation of a pattern: built once per mesh, shared by every factor.
#[derive(Debug)]
pub struct Symbolic {
    pattern: Arc<Pattern>,
    fronts: Vec<Front>,
    rows: Vec<u32>,
    /// For every entry of `rows`, its position in the parent front's list of columns and rows.
    in_parent: Vec<u32>,
    children: Vec<Vec<u32>>,
    tasks: Vec<Task>,
    size: FactorSize,
    /// Memory of update matrices, kept between factorisations.
    workspace: Workspace,
}

/// Columns that are eliminated together. All numbers count nodes in elimination order.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub columns: Range<usize>,
    /// Rows below the columns: a range of [`Symbolic::rows`].
    rows: Range<usize>,
    pub parent: Option<usize>,
    /// Where its panel of `height x width` dofs stands among the factor's values.
    pub panel: Range<usize>,
}

/// A piece of work for one thread: the fronts of a whole subtree, or one front near the root.
#[derive(Clone, Debug)]
pub(super) struct Task {
    pub fronts: Range<usize>,
    pub parent: Option<usize>,
    /// Tasks that must be done before.
    pub children: Vec<usize>,
}

/// Subtrees with more than this share of all flops are cut into single fronts.
const SUBTREE_SHARE: f64 = 1.0 / 32.0;

impl Symbolic {
    /// Analyses a pattern: what a factor would take is counted and nothing of it allocated.
    pub fn new(pattern: &Arc<Pattern>) -> Self {
        let mut symbolic = Self {
            pattern: Arc::clone(pattern),
            fronts: Vec::new(),
            rows: Vec::new(),
            in_parent: Vec::new(),
            children: Vec::new(),
            tasks: Vec::new(),
            size: FactorSize::default(),
            workspace: Workspace::default(),
        };
        symbolic.find_rows();
        symbolic.lay_out_panels();
        symbolic.locate_rows_in_parents();
        symbolic.cut_tasks();
        symbolic
    }

    fn find_rows(&mut self) {
        let pattern = Arc::clone(&self.pattern);
        let starts = pattern.ordering().fronts();
        let mut front_of = vec![0u32; pattern.nodes()];
        for (f, range) in starts.windows(2).enumerate() {
            front_of[range[0] as usize..range[1] as usize].fill(f as u32);
        }
        self.children = vec![Vec::new(); starts.len() - 1];
        let mut seen_by = vec![ROOT; pattern.nodes()];
        for (f, range) in starts.windows(2).enumerate() {
            let columns = range[0] as usize..range[1] as usize;
            let mut rows = Vec::new();
            let mut add = |i: &u32| {
                if *i as usize >= columns.end && seen_by[*i as usize] != f as u32 {
                    seen_by[*i as usize] = f as u32;
                    rows.push(*i);
                }
            };
            columns.clone().for_each(|j| pattern.column(j).1.iter().for_each(&mut add));
            for &child in &self.children[f] {
                self.rows[self.fronts[child as usize].rows.clone()].iter().for_each(&mut add);
            }
            rows.sort_unstable();
            let parent = rows.first().map(|&i| front_of[i as usize] as usize);
            if let Some(parent) = parent {
                self.children[parent].push(f as u32);
            }
            let first = self.rows.len();
            self.rows.append(&mut rows);
            self.fronts.push(Front { columns, rows: first..self.rows.len(), parent, panel: 0..0 });
        }
    }

    fn lay_out_panels(&mut self) {
        for f in 0..self.fronts.len() {
            let (first, width, height) = (self.size.values, self.width(f), self.height(f));
            self.size.add(width, height);
            self.fronts[f].panel = first..self.size.values;
        }
    }

    fn locate_rows_in_parents(&mut self) {
        self.in_parent = vec![0; self.rows.len()];
        for front in &self.fronts {
            let Some(parent) = front.parent.map(|p| &self.fronts[p]) else { continue };
            let parent_rows = &self.rows[parent.rows.clone()];
            let mut at = 0;
            for k in front.rows.clone() {
                let row = self.rows[k];
                self.in_parent[k] = if (row as usize) < parent.columns.end {
                    row - parent.columns.start as u32
                } else {
                    while parent_rows[at] < row {
                        at += 1;
                    }
                    (parent.columns.len() + at) as u32
                };
            }
        }
    }

    fn cut_tasks(&mut self) {
        let n = self.fronts.len();
        let mut subtree: Vec<f64> = (0..n).map(|f| front_flops(self.width(f) as f64, self.height(f) as f64)).collect();
        let mut first: Vec<usize> = (0..n).collect();
        for f in 0..n {
            if let Some(parent) = self.fronts[f].parent {
                subtree[parent] += subtree[f];
                first[parent] = first[parent].min(first[f]);
            }
        }
        let small = |f: usize| subtree[f] <= SUBTREE_SHARE * self.size.flops;
        let mut task_of = vec![0; n];
        let mut tasks: Vec<Task> = Vec::new();
        for f in 0..n {
            let parent = self.fronts[f].parent;
            if small(f) && parent.is_some_and(small) {
                continue;
            }
            let fronts = if small(f) { first[f]..f + 1 } else { f..f + 1 };
            task_of[f] = tasks.len();
            tasks.push(Task { fronts, parent, children: Vec::new() });
        }
        for t in 0..tasks.len() {
            tasks[t].parent = tasks[t].parent.map(|front| task_of[front]);
            if let Some(parent) = tasks[t].parent {
                tasks[parent].children.push(t);
            }
        }
        self.tasks = tasks;
    }

    /// Whether indices of 32 bits reach over the factor.
    pub(super) fn check_size(&self) -> Result<(), StructureError> {
        match self.size.values as u64 {
            count if count > i32::MAX as u64 => Err(StructureError::TooLarge { what: "entries of the factor", count }),
            _ => Ok(()),
        }
    }

    /// The pattern that was analysed.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Entries of the factor's lower triangle, with the explicit zeros that merged fronts store.
    pub fn nonzeros(&self) -> u64 {
        self.size.nonzeros
    }

    /// Floating-point operations of one factorisation, multiplications and additions counted separately.
    pub fn flops(&self) -> f64 {
        self.size.flops
    }

    /// Whether a factorisation takes longer than it takes to wake other threads.
    pub(super) fn suits_threads(&self) -> bool {
        self.size.flops > 1e7
    }

    /// The same of a solve for some columns.
    pub(super) fn suits_threads_to_solve(&self, columns: usize) -> bool {
        self.size.nonzeros * columns as u64 > 300_000
    }

    /// Bytes held by one factor in double precision.
    pub fn factor_bytes(&self) -> usize {
        self.size.bytes()
    }

    /// Largest number of values of update matrices at one time: those of the children die when a front has taken them.
    pub(super) fn update_values(&self) -> usize {
        let update = |f: usize| Slabs::new(self.below(f)).values();
        let (mut alive, mut most) = (0, 0);
        for f in 0..self.fronts.len() {
            alive += update(f);
            most = most.max(alive);
            alive -= self.children(f).iter().map(|&child| update(child as usize)).sum::<usize>();
        }
        most
    }

    /// Bytes that factorisations keep for their successors. They grow to what one factorisation needs (times the number of
    /// factorisations that run at the same time).
    pub fn workspace_bytes(&self) -> usize {
        self.workspace.bytes()
    }

    /// Frees them.
    pub fn release_workspace(&self) {
        self.workspace.clear();
    }

    /// The smallest kept buffer that is large enough, or else a new one in place of the largest. Fresh memory costs a page
    /// fault every few kB: a tenth of the factorisation's time.
    pub(super) fn take_buffer<T: Real>(&self, len: usize) -> Vec<T> {
        if len == 0 {
            return Vec::new();
        }
        let mut kept = lock(T::buffers(&self.workspace));
        let best = kept.iter().enumerate().min_by_key(|(_, buffer)| match buffer.len() {
            enough if enough >= len => (false, enough),
            small => (true, usize::MAX - small),
        });
        let buffer = best.map(|(at, _)| at).map(|at| kept.swap_remove(at)).unwrap_or_default();
        drop(kept);
        if buffer.len() >= len { buffer } else { vec![T::of(0.0); len] }
    }

    /// Takes back what [`Symbolic::take_buffer`] gave.
    pub(super) fn return_buffers<T: Real>(&self, buffers: Vec<Vec<T>>) {
        lock(T::buffers(&self.workspace)).extend(buffers.into_iter().filter(|buffer| !buffer.is_empty()));
    }

    pub(super) fn fronts(&self) -> &[Front] {
        &self.fronts
    }

    pub(super) fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    pub(super) fn panel_values(&self) -> usize {
        self.size.values
    }

    pub(super) fn children(&self, f: usize) -> &[u32] {
        &self.children[f]
    }

    /// Node rows below the columns of front `f`, ascending.
    pub(super) fn rows(&self, f: usize) -> &[u32] {
        &self.rows[self.fronts[f].rows.clone()]
    }

    /// Positions of the rows of front `f` in its parent's columns and rows.
    pub(super) fn rows_in_parent(&self, f: usize) -> &[u32] {
        &self.in_parent[self.fronts[f].rows.clone()]
    }

    /// Dof columns of front `f`.
    pub(super) fn width(&self, f: usize) -> usize {
        self.pattern.dim() * self.fronts[f].columns.len()
    }

    /// Dof rows of front `f` below its columns.
    pub(super) fn below(&self, f: usize) -> usize {
        self.pattern.dim() * self.fronts[f].rows.len()
    }

    /// Dof rows of front `f`.
    pub(super) fn height(&self, f: usize) -> usize {
        self.width(f) + self.below(f)
    }
}
