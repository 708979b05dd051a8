//! [`sweep`]: cells are computed in parallel and their results taken up in mesh order.
//!
//! Sums made this way have the same bits for any number of threads.

use crate::discretization::quadrature_points::CellGroup;
use crate::kernels::CellKernel;
use crate::kernels::cell_scratch::Scratch;
use rayon::prelude::*;

/// Memory that the results of a wave may take, in numbers: they should still be in the cache when they are taken up.
const WAVE: usize = 1 << 17;
/// Waves are split into this many tasks at most.
const TASKS: usize = 16;

/// What is computed of every cell of a part.
pub(crate) trait CellWork: Sync {
    /// The answer of one cell.
    type Answer: Clone + Send + Sync;
    /// Why a cell may have none.
    type Error: Clone + Send + Sync;

    /// The cells.
    fn cells(&self) -> Cells<'_>;
    /// Room for an answer, and how many numbers it has.
    fn room(&self) -> (Self::Answer, usize);
    /// The answer of the c-th cell.
    fn compute(&self, c: usize, scratch: &mut Scratch, answer: &mut Self::Answer) -> Result<(), Self::Error>;
}

/// The cells of one kind with their arithmetic.
#[derive(Clone, Copy)]
pub(crate) struct Cells<'a> {
    pub part: &'a CellGroup,
    pub kernel: &'static dyn CellKernel,
    pub dim: usize,
}

impl<'a> Cells<'a> {
    /// Adds rows of the c-th cell to a nodal vector.
    pub fn scatter(&self, c: usize, rows: &[f64], nodal: &mut [f64]) {
        crate::discretization::quadrature_points::scatter_rows(
            rows,
            self.part.nodes_of(c),
            self.dim,
            self.kernel.width(),
            nodal,
        );
    }

    /// Room for the rows of one cell.
    pub fn rows(&self) -> Vec<f64> {
        vec![0.0; self.dim * self.kernel.width()]
    }
}

/// Computes every cell and takes up the answers in mesh order, until a cell has none.
pub(crate) fn sweep<W: CellWork>(
    work: &W,
    parallel: bool,
    mut take: impl FnMut(usize, &W::Answer) + Send,
) -> Result<(), W::Error> {
    if parallel && rayon::current_num_threads() > 1 {
        return in_waves(work, take);
    }
    let cells = work.cells();
    let mut scratch = Scratch::new(cells.part, cells.dim);
    let (mut answer, _) = work.room();
    for c in 0..cells.part.cells.len() {
        // taken up while it is in the innermost cache
        work.compute(c, &mut scratch, &mut answer)?;
        take(c, &answer);
    }
    Ok(())
}

/// One thread takes up a wave while the others compute the next.
fn in_waves<W: CellWork>(work: &W, mut take: impl FnMut(usize, &W::Answer) + Send) -> Result<(), W::Error> {
    let (answer, size) = work.room();
    let wave = (WAVE / (size + 16)).clamp(8, 256);
    let cells: Vec<usize> = (0..work.cells().part.cells.len()).collect();
    let room = (answer, Ok(()));
    let (mut ready, mut next) = (vec![room.clone(); wave], vec![room; wave]);
    let mut done: &[usize] = &[];
    for cells in cells.chunks(wave).chain([&[][..]]) {
        let mut taken = || -> Result<(), W::Error> {
            for (&c, (answer, outcome)) in done.iter().zip(&ready) {
                outcome.as_ref().map_err(W::Error::clone)?;
                take(c, answer);
            }
            Ok(())
        };
        rayon::join(&mut taken, || compute(work, cells, &mut next)).0?;
        std::mem::swap(&mut ready, &mut next);
        done = cells;
    }
    Ok(())
}

type Outcome<W> = (<W as CellWork>::Answer, Result<(), <W as CellWork>::Error>);

fn compute<W: CellWork>(work: &W, cells: &[usize], answers: &mut [Outcome<W>]) {
    let chunk = answers.len().div_ceil(TASKS);
    let scratch = || Scratch::new(work.cells().part, work.cells().dim);
    let task = |scratch: &mut Scratch, (cells, answers): (&[usize], &mut [Outcome<W>])| {
        for (&c, (answer, outcome)) in cells.iter().zip(answers) {
            *outcome = work.compute(c, scratch, answer);
        }
    };
    cells.par_chunks(chunk).zip(answers.par_chunks_mut(chunk)).for_each_init(scratch, task);
}
