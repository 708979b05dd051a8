//! [`RunState`] as bytes.

use crate::bytes::{Reader, SavedRunError, Writer};
use crate::method::Memory;
use crate::state::{Counts, Progress, RunState, SavedPoint, StageEnd};

const MAGIC: &str = "nastic-run-2";

impl RunState {
    /// Little-endian bytes: numbers as they are, lists with their length first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.bytes(self.method.as_bytes());
        out.floats(&self.memory.numbers);
        out.count(self.memory.vectors.len());
        self.memory.vectors.iter().for_each(|v| out.floats(v));
        write_progress(&self.progress, &mut out);
        write_point(&self.current, &mut out);
        out.count(usize::from(self.best.is_some()));
        if let Some(best) = &self.best {
            write_point(best, &mut out);
        }
        out.finish()
    }

    /// Reads what [`RunState::to_bytes`] wrote; never trusts a count beyond the bytes that are there.
    ///
    /// # Errors
    /// Bytes of something else, truncated or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let method = input.text()?;
        let numbers = input.floats()?;
        let vectors = (0..input.count(8)?).map(|_| input.floats()).collect::<Result<_, _>>()?;
        let progress = read_progress(&mut input)?;
        let current = read_point(&mut input)?;
        let best = if input.flag()? { Some(read_point(&mut input)?) } else { None };
        input.finish()?;
        Ok(Self { method, memory: Memory { numbers, vectors }, progress, current, best })
    }
}

fn write_point(p: &SavedPoint, out: &mut Writer) {
    out.floats(&p.m);
    out.bytes(&p.point);
    out.float(p.cost);
    out.floats(&p.derivative);
    out.float(p.gradient_norm);
    out.count(p.active);
}

fn write_progress(p: &Progress, out: &mut Writer) {
    write_counts(&p.counts, out);
    for n in [usize::from(p.announced), p.stage, p.stage_began, p.flat] {
        out.count(n);
    }
    out.floats(&p.stage_start);
    out.floats(&p.costs);
    out.floats(&p.gradients);
    write_ends(&p.ends, out);
}

pub(crate) fn write_counts(counts: &Counts, out: &mut Writer) {
    let Counts { iterations, trials, failed, derivatives, products } = *counts;
    [iterations, trials, failed, derivatives, products].into_iter().for_each(|n| out.count(n));
}

pub(crate) fn write_ends(ends: &[StageEnd], out: &mut Writer) {
    out.count(ends.len());
    for end in ends {
        out.count(end.stage);
        out.count(end.iterations);
        out.count(usize::from(end.converged));
        out.bytes(end.why.as_bytes());
    }
}

fn read_point(input: &mut Reader<'_>) -> Result<SavedPoint, SavedRunError> {
    Ok(SavedPoint {
        m: input.floats()?,
        point: input.list()?,
        cost: input.float()?,
        derivative: input.floats()?,
        gradient_norm: input.float()?,
        active: input.number()?,
    })
}

fn read_progress(input: &mut Reader<'_>) -> Result<Progress, SavedRunError> {
    let counts = read_counts(input)?;
    let announced = input.flag()?;
    let (stage, stage_began, flat) = (input.number()?, input.number()?, input.number()?);
    let (stage_start, costs, gradients) = (input.floats()?, input.floats()?, input.floats()?);
    let ends = read_ends(input)?;
    Ok(Progress { counts, announced, stage, stage_began, stage_start, costs, gradients, flat, ends })
}

pub(crate) fn read_counts(input: &mut Reader<'_>) -> Result<Counts, SavedRunError> {
    Ok(Counts {
        iterations: input.number()?,
        trials: input.number()?,
        failed: input.number()?,
        derivatives: input.number()?,
        products: input.number()?,
    })
}

pub(crate) fn read_ends(input: &mut Reader<'_>) -> Result<Vec<StageEnd>, SavedRunError> {
    let end = |input: &mut Reader<'_>| {
        let (stage, iterations) = (input.number()?, input.number()?);
        Ok(StageEnd { stage, iterations, converged: input.flag()?, why: input.text()? })
    };
    (0..input.count(32)?).map(|_| end(input)).collect()
}
