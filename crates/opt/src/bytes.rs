//! Saved runs as bytes.

use crate::method::Memory;
use crate::state::{Counts, Progress, RunState, SavedPoint, StageEnd};
use thiserror::Error;

/// Bytes that are not a saved run.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StateError {
    /// Another kind of file, or another version of it.
    #[error("not a saved run of this version (it does not begin with {MAGIC:?})")]
    Magic,
    /// It ends early, or its counts lie.
    #[error("the saved run is damaged at byte {at}: {needed} more bytes are needed, {left} are left")]
    Truncated {
        /// Where.
        at: usize,
        /// How many bytes were to be read.
        needed: usize,
        /// How many there were.
        left: usize,
    },
    /// A field with an impossible value.
    #[error("the saved run is damaged at byte {at}: {what}")]
    Damaged {
        /// Where.
        at: usize,
        /// What is wrong.
        what: &'static str,
    },
}

const MAGIC: &str = "nastic-run-1";

impl RunState {
    /// Little-endian bytes: numbers as they are, lists with their length first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer(MAGIC.as_bytes().to_vec());
        out.bytes(self.method.as_bytes());
        out.floats(&self.memory.numbers);
        out.count(self.memory.vectors.len());
        self.memory.vectors.iter().for_each(|v| out.floats(v));
        out.progress(&self.progress);
        out.point(&self.current);
        out.count(usize::from(self.best.is_some()));
        if let Some(best) = &self.best {
            out.point(best);
        }
        out.0
    }

    /// Reads what [`RunState::to_bytes`] wrote; never trusts a count beyond the bytes that are there.
    ///
    /// # Errors
    /// Bytes of something else, truncated or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        if !bytes.starts_with(MAGIC.as_bytes()) {
            return Err(StateError::Magic);
        }
        let mut input = Reader { bytes, at: MAGIC.len() };
        let method = input.text()?;
        let numbers = input.floats()?;
        let vectors = (0..input.count(8)?).map(|_| input.floats()).collect::<Result<_, _>>()?;
        let progress = input.progress()?;
        let current = input.point()?;
        let best = if input.flag()? { Some(input.point()?) } else { None };
        if input.at != bytes.len() {
            return Err(StateError::Damaged { at: input.at, what: "more bytes than expected" });
        }
        Ok(Self { method, memory: Memory { numbers, vectors }, progress, current, best })
    }
}

struct Writer(Vec<u8>);

impl Writer {
    fn count(&mut self, n: usize) {
        self.0.extend((n as u64).to_le_bytes());
    }

    fn float(&mut self, x: f64) {
        self.0.extend(x.to_le_bytes());
    }

    fn floats(&mut self, v: &[f64]) {
        self.count(v.len());
        v.iter().for_each(|x| self.float(*x));
    }

    fn bytes(&mut self, v: &[u8]) {
        self.count(v.len());
        self.0.extend(v);
    }

    fn point(&mut self, p: &SavedPoint) {
        self.floats(&p.m);
        self.bytes(&p.point);
        self.float(p.cost);
        self.floats(&p.derivative);
        self.float(p.gradient_norm);
        self.count(p.active);
    }

    fn progress(&mut self, p: &Progress) {
        let c = p.counts;
        for n in
            [c.iterations, c.trials, c.failed, c.derivatives, usize::from(p.announced), p.stage, p.stage_began, p.flat]
        {
            self.count(n);
        }
        self.floats(&p.stage_start);
        self.floats(&p.costs);
        self.floats(&p.gradients);
        self.count(p.ends.len());
        for end in &p.ends {
            self.count(end.stage);
            self.count(end.iterations);
            self.count(usize::from(end.converged));
            self.bytes(end.why.as_bytes());
        }
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], StateError> {
        let left = self.bytes.len() - self.at;
        if n > left {
            return Err(StateError::Truncated { at: self.at, needed: n, left });
        }
        self.at += n;
        Ok(&self.bytes[self.at - n..self.at])
    }

    fn word(&mut self) -> Result<[u8; 8], StateError> {
        let mut word = [0; 8];
        word.copy_from_slice(self.take(8)?);
        Ok(word)
    }

    fn number(&mut self) -> Result<usize, StateError> {
        let at = self.at;
        usize::try_from(u64::from_le_bytes(self.word()?)).map_err(|_| StateError::Damaged { at, what: "a huge count" })
    }

    /// A count of items of at least `size` bytes each, which must be there.
    fn count(&mut self, size: usize) -> Result<usize, StateError> {
        let n = self.number()?;
        let left = self.bytes.len() - self.at;
        match n.checked_mul(size) {
            Some(needed) if needed <= left => Ok(n),
            needed => Err(StateError::Truncated { at: self.at, needed: needed.unwrap_or(usize::MAX), left }),
        }
    }

    fn flag(&mut self) -> Result<bool, StateError> {
        match self.number()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(StateError::Damaged { at: self.at - 8, what: "a flag that is neither 0 nor 1" }),
        }
    }

    fn float(&mut self) -> Result<f64, StateError> {
        Ok(f64::from_le_bytes(self.word()?))
    }

    fn floats(&mut self) -> Result<Vec<f64>, StateError> {
        (0..self.count(8)?).map(|_| self.float()).collect()
    }

    fn list(&mut self) -> Result<Vec<u8>, StateError> {
        let n = self.count(1)?;
        Ok(self.take(n)?.to_vec())
    }

    fn text(&mut self) -> Result<String, StateError> {
        let at = self.at;
        String::from_utf8(self.list()?).map_err(|_| StateError::Damaged { at, what: "text that is not UTF-8" })
    }

    fn point(&mut self) -> Result<SavedPoint, StateError> {
        Ok(SavedPoint {
            m: self.floats()?,
            point: self.list()?,
            cost: self.float()?,
            derivative: self.floats()?,
            gradient_norm: self.float()?,
            active: self.number()?,
        })
    }

    fn progress(&mut self) -> Result<Progress, StateError> {
        let counts = Counts {
            iterations: self.number()?,
            trials: self.number()?,
            failed: self.number()?,
            derivatives: self.number()?,
        };
        let announced = self.flag()?;
        let (stage, stage_began, flat) = (self.number()?, self.number()?, self.number()?);
        let (stage_start, costs, gradients) = (self.floats()?, self.floats()?, self.floats()?);
        let end = |input: &mut Self| {
            let (stage, iterations) = (input.number()?, input.number()?);
            Ok(StageEnd { stage, iterations, converged: input.flag()?, why: input.text()? })
        };
        let ends = (0..self.count(32)?).map(|_| end(self)).collect::<Result<_, _>>()?;
        Ok(Progress { counts, announced, stage, stage_began, stage_start, costs, gradients, flat, ends })
    }
}
