//! [`sweep`]: patches of cells are computed in parallel and their results taken up in mesh order.
//!
//! Sums made this way have the same bits for any number of threads.

use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::patch::{Patch, Patches};
use rayon::prelude::*;

/// Memory that the results of a wave may take, in numbers: they should still be in the cache when they are taken up.
const WAVE: usize = 1 << 17;
/// Waves are split into this many tasks at most.
const TASKS: usize = 16;

/// What is computed of every patch of a group of cells.
pub(crate) trait CellWork: Sync {
    /// The answer of one patch.
    type Answer: Clone + Send + Sync;
    /// Why a patch may have none.
    type Error: Clone + Send + Sync;

    /// The cells.
    fn cells(&self) -> Cells<'_>;
    /// Room for an answer, and how many numbers it has of one cell.
    fn room(&self) -> (Self::Answer, usize);
    /// The answer of a patch.
    fn compute(&self, patch: Patch, scratch: &mut Scratch, answer: &mut Self::Answer) -> Result<(), Self::Error>;
}

/// Computes every patch and takes up the answers in mesh order, until a patch has none.
pub(crate) fn sweep<W: CellWork>(
    work: &W,
    patches: &Patches,
    parallel: bool,
    mut take: impl FnMut(Patch, &W::Answer) + Send,
) -> Result<(), W::Error> {
    if work.cells().on_threads(parallel) && rayon::current_num_threads() > 1 {
        return in_waves(work, patches, take);
    }
    let mut scratch = Scratch::new(work.cells());
    let (mut answer, _) = work.room();
    for patch in patches.iter() {
        // taken up while it is in the innermost cache
        work.compute(patch, &mut scratch, &mut answer)?;
        take(patch, &answer);
    }
    Ok(())
}

/// One thread takes up a wave while the others compute the next.
fn in_waves<W: CellWork>(
    work: &W,
    patches: &Patches,
    mut take: impl FnMut(Patch, &W::Answer) + Send,
) -> Result<(), W::Error> {
    let (answer, size) = work.room();
    let wave = (WAVE / (size + 16)).clamp(8, 256);
    let numbers: Vec<usize> = (0..patches.len()).collect();
    let room = (answer, Ok(()));
    let (mut ready, mut next) = (vec![room.clone(); wave], vec![room; wave]);
    let mut done: &[usize] = &[];
    for numbers in numbers.chunks(wave).chain([&[][..]]) {
        let mut taken = || -> Result<(), W::Error> {
            for (&k, (answer, outcome)) in done.iter().zip(&ready) {
                outcome.as_ref().map_err(W::Error::clone)?;
                take(patches.get(k), answer);
            }
            Ok(())
        };
        rayon::join(&mut taken, || compute(work, patches, numbers, &mut next)).0?;
        std::mem::swap(&mut ready, &mut next);
        done = numbers;
    }
    Ok(())
}

type Outcome<W> = (<W as CellWork>::Answer, Result<(), <W as CellWork>::Error>);

fn compute<W: CellWork>(work: &W, patches: &Patches, numbers: &[usize], answers: &mut [Outcome<W>]) {
    let chunk = answers.len().div_ceil(TASKS);
    let scratch = || Scratch::new(work.cells());
    let task = |scratch: &mut Scratch, (numbers, answers): (&[usize], &mut [Outcome<W>])| {
        for (&k, (answer, outcome)) in numbers.iter().zip(answers) {
            *outcome = work.compute(patches.get(k), scratch, answer);
        }
    };
    numbers.par_chunks(chunk).zip(answers.par_chunks_mut(chunk)).for_each_init(scratch, task);
}
