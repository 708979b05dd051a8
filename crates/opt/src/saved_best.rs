//! [`Best`] as bytes.

use crate::bytes::{Reader, SavedRunError, Writer};
use crate::failed::Failed;
use crate::objective::{Objective, Request};
use crate::run::Best;
use crate::saved_run::{read_counts, read_ends, write_counts, write_ends};
use crate::stop::{Stall, Stop, Tolerance};

const MAGIC: &str = "nastic-best-2";

impl<P> Best<P> {
    /// Little-endian bytes of all but the certificate, the point as [`Objective::save`] writes it.
    pub fn save<O: Objective<Point = P>>(&self, objective: &O) -> Vec<u8> {
        self.save_with(&objective.save(&self.point))
    }

    /// The same with other bytes in the place of the point: none of one that is kept elsewhere.
    pub fn save_with(&self, point: &[u8]) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.floats(&self.m);
        out.bytes(point);
        out.count(self.stage);
        out.float(self.cost);
        out.floats(&self.derivative);
        out.float(self.gradient_norm);
        out.count(self.active);
        write_stop(&self.stop, &mut out);
        write_counts(&self.counts, &mut out);
        write_ends(&self.stages, &mut out);
        out.finish()
    }

    /// The result that [`save`](Self::save) wrote, of the same problem and without its certificate.
    ///
    /// # Errors
    /// [`SavedRunError`] within for bytes of something else, truncated or damaged ones; as [`Objective::load`].
    pub fn load<O: Objective<Point = P>>(objective: &O, bytes: &[u8]) -> Result<Self, Failed> {
        Self::load_with(objective, bytes, None)
    }

    /// The same, with its point from elsewhere if it is given.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_with<O: Objective<Point = P>>(
        objective: &O,
        bytes: &[u8],
        elsewhere: Option<Vec<u8>>,
    ) -> Result<Self, Failed> {
        let saved = Saved::from_bytes(bytes).map_err(Failed::new)?;
        let Saved { m, point, stage, cost, derivative, gradient_norm, active, stop, counts, stages } = saved;
        let point = elsewhere.unwrap_or(point);
        let point = objective.load(&m, &point, &Request { stage, ..Request::default() })?;
        Ok(Self { m, point, stage, cost, derivative, gradient_norm, active, stop, counts, stages, certificate: None })
    }
}

/// A result whose point is bytes still.
struct Saved {
    m: Vec<f64>,
    point: Vec<u8>,
    stage: usize,
    cost: f64,
    derivative: Vec<f64>,
    gradient_norm: f64,
    active: usize,
    stop: Stop,
    counts: crate::state::Counts,
    stages: Vec<crate::state::StageEnd>,
}

impl Saved {
    fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let saved = Self {
            m: input.floats()?,
            point: input.list()?,
            stage: input.number()?,
            cost: input.float()?,
            derivative: input.floats()?,
            gradient_norm: input.float()?,
            active: input.number()?,
            stop: read_stop(&mut input)?,
            counts: read_counts(&mut input)?,
            stages: read_ends(&mut input)?,
        };
        input.finish()?;
        Ok(saved)
    }
}

fn write_stop(stop: &Stop, out: &mut Writer) {
    match stop {
        Stop::Converged { gradient_norm, first, tolerance } => {
            let (code, tolerance) = match tolerance {
                Tolerance::Relative(tolerance) => (0, tolerance),
                Tolerance::Absolute(tolerance) => (8, tolerance),
            };
            out.count(code);
            [gradient_norm, first, tolerance].into_iter().for_each(|x| out.float(*x));
        }
        Stop::MaxIterations { iterations, relative_gradient } => {
            out.count(1);
            out.count(*iterations);
            out.float(*relative_gradient);
        }
        Stop::Cancelled => out.count(2),
        Stop::Stalled(Stall::Flat { cost, predicted, relative_gradient }) => {
            out.count(3);
            [cost, predicted, relative_gradient].into_iter().for_each(|x| out.float(*x));
        }
        Stop::Stalled(Stall::LineSearch { trials, failed, shortest, last, relative_gradient }) => {
            out.count(4);
            [trials, failed].into_iter().for_each(|n| out.count(*n));
            out.float(*shortest);
            out.bytes(last.as_bytes());
            out.float(*relative_gradient);
        }
        Stop::Stalled(Stall::Stagnation { window, decrease, total, relative_gradient }) => {
            out.count(5);
            out.count(*window);
            [decrease, total, relative_gradient].into_iter().for_each(|x| out.float(*x));
        }
        Stop::Infeasible { constraint, index, violation, penalty, gradient } => {
            out.count(9);
            out.bytes(constraint.as_bytes());
            out.count(*index);
            [violation, penalty, gradient].into_iter().for_each(|x| out.float(*x));
        }
        Stop::Outperformed { cost, within_reach, best } => {
            out.count(11);
            [cost, within_reach, best].into_iter().for_each(|x| out.float(*x));
        }
        Stop::Aborted(why) => {
            out.count(7);
            out.bytes(why.to_string().as_bytes());
        }
        // The failure keeps its words, not its type.
        Stop::Stalled(Stall::SecondDerivatives { why }) => {
            out.count(10);
            out.bytes(why.to_string().as_bytes());
        }
        Stop::Stalled(Stall::Stage { stage, why }) => {
            out.count(6);
            out.count(*stage);
            out.bytes(why.to_string().as_bytes());
        }
    }
}

fn read_stop(input: &mut Reader<'_>) -> Result<Stop, SavedRunError> {
    Ok(match input.number()? {
        code @ (0 | 8) => {
            let of = if code == 0 { Tolerance::Relative } else { Tolerance::Absolute };
            Stop::Converged { gradient_norm: input.float()?, first: input.float()?, tolerance: of(input.float()?) }
        }
        1 => Stop::MaxIterations { iterations: input.number()?, relative_gradient: input.float()? },
        2 => Stop::Cancelled,
        3 => Stop::Stalled(Stall::Flat {
            cost: input.float()?,
            predicted: input.float()?,
            relative_gradient: input.float()?,
        }),
        4 => Stop::Stalled(Stall::LineSearch {
            trials: input.number()?,
            failed: input.number()?,
            shortest: input.float()?,
            last: input.text()?,
            relative_gradient: input.float()?,
        }),
        5 => Stop::Stalled(Stall::Stagnation {
            window: input.number()?,
            decrease: input.float()?,
            total: input.float()?,
            relative_gradient: input.float()?,
        }),
        6 => Stop::Stalled(Stall::Stage { stage: input.number()?, why: Failed::because(input.text()?) }),
        10 => Stop::Stalled(Stall::SecondDerivatives { why: Failed::because(input.text()?) }),
        11 => Stop::Outperformed { cost: input.float()?, within_reach: input.float()?, best: input.float()? },
        9 => Stop::Infeasible {
            constraint: input.text()?,
            index: input.number()?,
            violation: input.float()?,
            penalty: input.float()?,
            gradient: input.float()?,
        },
        7 => Stop::Aborted(Failed::because(input.text()?).fatal()),
        _ => return Err(input.damaged("an unknown reason to stop")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_to_stop_is_read_as_it_was_written() {
        let relative_gradient = 0.1 + 0.2;
        let all = [
            Stop::Converged { gradient_norm: 1e-3, first: 3.0, tolerance: Tolerance::Relative(1e-4) },
            Stop::Converged { gradient_norm: 1e-3, first: 3.0, tolerance: Tolerance::Absolute(2e-3) },
            Stop::MaxIterations { iterations: 7, relative_gradient },
            Stop::Cancelled,
            Stop::Infeasible { constraint: "ball".into(), index: 4, violation: 1e-3, penalty: 1e5, gradient: 1e-12 },
            Stop::Outperformed { cost: 0.1, within_reach: 1e-3, best: 1e-4 },
            Stop::Aborted(Failed::because("no memory").fatal()),
            Stop::Stalled(Stall::Flat { cost: 1.0, predicted: -1e-17, relative_gradient }),
            Stop::Stalled(Stall::LineSearch {
                trials: 9,
                failed: 2,
                shortest: 1e-9,
                last: "no decrease".into(),
                relative_gradient,
            }),
            Stop::Stalled(Stall::Stagnation { window: 5, decrease: 1e-9, total: 2.0, relative_gradient }),
            Stop::Stalled(Stall::SecondDerivatives { why: Failed::because("a kink") }),
            Stop::Stalled(Stall::Stage { stage: 2, why: Failed::because("no value there") }),
        ];
        for stop in all {
            let mut out = Writer::new(MAGIC);
            write_stop(&stop, &mut out);
            let bytes = out.finish();
            let mut input = Reader::new(&bytes, MAGIC).unwrap();
            let read = read_stop(&mut input).unwrap();
            assert_eq!((&read, read.to_string()), (&stop, stop.to_string()));
            input.finish().unwrap();
        }
    }
}
