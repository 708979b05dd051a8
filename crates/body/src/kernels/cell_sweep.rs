//! [`CellWork`]: patches of cells are computed in parallel and their results taken up in mesh order.
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

/// An answer, and why a patch may have none.
type Outcome<A, E> = (A, Result<(), E>);

/// What is computed of every patch of a group of cells.
pub(crate) struct CellWork<'a, C> {
    pub cells: Cells<'a>,
    pub patches: &'a Patches,
    /// How many numbers an answer has of one cell.
    pub numbers: usize,
    /// The answer of a patch, in place of an earlier one.
    pub compute: C,
}

impl<C> CellWork<'_, C> {
    /// Computes every patch and takes up the answers in mesh order, until a patch has none.
    pub fn run<A, E>(&self, parallel: bool, mut take: impl FnMut(Patch, &A) + Send) -> Result<(), E>
    where
        A: Clone + Default + Send + Sync,
        E: Clone + Send + Sync,
        C: Fn(Patch, &mut Scratch, &mut A) -> Result<(), E> + Sync,
    {
        if self.cells.on_threads(parallel) && rayon::current_num_threads() > 1 {
            return self.in_waves(take);
        }
        let mut scratch = Scratch::new(self.cells);
        let mut answer = A::default();
        for patch in self.patches.iter() {
            // taken up while it is in the innermost cache
            (self.compute)(patch, &mut scratch, &mut answer)?;
            take(patch, &answer);
        }
        Ok(())
    }

    /// One thread takes up a wave while the others compute the next.
    fn in_waves<A, E>(&self, mut take: impl FnMut(Patch, &A) + Send) -> Result<(), E>
    where
        A: Clone + Default + Send + Sync,
        E: Clone + Send + Sync,
        C: Fn(Patch, &mut Scratch, &mut A) -> Result<(), E> + Sync,
    {
        let wave = (WAVE / (self.numbers + 16)).clamp(8, 256);
        let numbers: Vec<usize> = (0..self.patches.len()).collect();
        let room = (A::default(), Ok(()));
        let (mut ready, mut next) = (vec![room.clone(); wave], vec![room; wave]);
        let mut done: &[usize] = &[];
        for numbers in numbers.chunks(wave).chain([&[][..]]) {
            let mut taken = || -> Result<(), E> {
                for (&k, (answer, outcome)) in done.iter().zip(&ready) {
                    outcome.as_ref().map_err(E::clone)?;
                    take(self.patches.get(k), answer);
                }
                Ok(())
            };
            rayon::join(&mut taken, || self.compute_wave(numbers, &mut next)).0?;
            std::mem::swap(&mut ready, &mut next);
            done = numbers;
        }
        Ok(())
    }

    fn compute_wave<A, E>(&self, numbers: &[usize], answers: &mut [Outcome<A, E>])
    where
        A: Send + Sync,
        E: Send + Sync,
        C: Fn(Patch, &mut Scratch, &mut A) -> Result<(), E> + Sync,
    {
        let chunk = answers.len().div_ceil(TASKS);
        let scratch = || Scratch::new(self.cells);
        let task = |scratch: &mut Scratch, (numbers, answers): (&[usize], &mut [Outcome<A, E>])| {
            for (&k, (answer, outcome)) in numbers.iter().zip(answers) {
                *outcome = (self.compute)(self.patches.get(k), scratch, answer);
            }
        };
        numbers.par_chunks(chunk).zip(answers.par_chunks_mut(chunk)).for_each_init(scratch, task);
    }
}
