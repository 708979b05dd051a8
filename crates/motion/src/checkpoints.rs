//! [`Checkpoints`]: from which instants of a motion the others are computed again, for least work in given memory.

use crate::scheme::Scheme;
use nastic_body::error::FemError;
use nastic_equilibrium::model::Model;
use std::mem::size_of;

/// How the states of N steps are kept for the reverse sweep. The steps are cut into l segments of equal length R (the last may
/// be shorter), and with at most s checkpoints only the beginnings of segments are kept, and the states of the one that is swept.
///
/// The checkpoints are placed binomially (Griewank, Walther, "Algorithm 799: revolve", ACM Trans. Math. Software 26, 2000): with
/// `beta(s, r) = (s + r)! / (s! r!)` and `beta(s, r - 1) < l <= beta(s, r)`
///
/// ```text
/// t(l, s) = r l - beta(s + 1, r - 1)
/// ```
///
/// segments are computed again, which no other placement undercuts. (The last one is in memory when the sweep begins.)
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checkpoints {
    steps: usize,
    segment: usize,
    /// Nothing where all states are kept.
    most: Option<usize>,
}

impl Checkpoints {
    /// All states of this number of steps are stored; nothing is recomputed. Segments have the length `segment` nevertheless.
    ///
    /// # Errors
    /// Segments without steps.
    pub fn all(steps: usize, segment: usize) -> Result<Self, FemError> {
        match segment {
            0 => Err(meaningless("segments of no time steps: take one or more")),
            _ => Ok(Checkpoints { steps, segment, most: None }),
        }
    }

    /// Of a static problem: no steps, one state.
    pub(crate) fn none() -> Self {
        Checkpoints { steps: 0, segment: 1, most: None }
    }

    /// At most this number of checkpoints, the beginning of the motion among them.
    ///
    /// # Errors
    /// No checkpoint, segments without steps.
    pub fn at_most(checkpoints: usize, steps: usize, segment: usize) -> Result<Self, FemError> {
        match checkpoints {
            0 => Err(meaningless("no checkpoint of a motion: its beginning is one, take one or more")),
            most => Ok(Checkpoints { most: Some(most), ..Checkpoints::all(steps, segment)? }),
        }
    }

    /// As many as fit into a number of bytes; all states if these fit.
    ///
    /// # Errors
    /// Less memory than one checkpoint and one segment take; segments without steps.
    pub fn within(
        bytes: usize,
        steps: usize,
        segment: usize,
        model: &Model,
        scheme: &Scheme,
    ) -> Result<Self, FemError> {
        let all = Checkpoints::all(steps, segment)?;
        if all.bytes(model, scheme) <= bytes {
            return Ok(all);
        }
        let with = |most: usize| Checkpoints { most: Some(most), ..all };
        let least = with(1).bytes(model, scheme);
        if least > bytes {
            let what = format!(
                "{bytes} bytes for the states of a motion: one checkpoint and the {segment} steps of a segment take {least}; allow \
                 that much, or take shorter segments"
            );
            return Err(FemError::Meaningless { what });
        }
        let most = 1 + (bytes - least) / (with(2).bytes(model, scheme) - least).max(1);
        Ok(with(most.min(all.segments())))
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Steps of a segment.
    pub fn segment(&self) -> usize {
        self.segment
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.steps.div_ceil(self.segment)
    }

    /// How many checkpoints there may be; nothing where all states are kept.
    pub fn most(&self) -> Option<usize> {
        self.most
    }

    /// Steps that a reverse sweep computes again, the motion itself not counted.
    pub fn recomputed_steps(&self) -> usize {
        // the last segment, which may be shorter, is never computed again
        self.most.map_or(0, |most| self.segment * recomputed(self.segments(), most))
    }

    /// States in memory at once, at most: of each checkpoint the states that a step begins with, and those of a segment.
    pub fn states(&self, scheme: &Scheme) -> usize {
        let begin = 1 + usize::from(scheme.start().is_some());
        match self.most {
            None => self.steps + 1,
            Some(most) => most.min(self.segments()) * begin + begin + self.segment.min(self.steps),
        }
    }

    /// Memory of these states, in bytes: displacements of stages and ends, velocities, accelerations, controls with internal variables.
    pub fn bytes(&self, model: &Model, scheme: &Scheme) -> usize {
        let controls = model.controls();
        let of_controls: usize = (0..controls.len()).map(|k| controls.values(k).len()).sum();
        let of_state = scheme.vectors() * model.unknowns().len() + of_controls + model.memory().internal_variables();
        self.states(scheme) * size_of::<f64>() * of_state
    }

    /// The segments at whose beginnings the motion leaves checkpoints, increasing, from 0 on.
    pub(crate) fn first_places(&self) -> Vec<usize> {
        let Some(mut free) = self.most else { return Vec::new() };
        let mut places = vec![0];
        let mut begin = 0;
        while free > 1 && self.segments() - begin > 1 {
            begin += split(self.segments() - begin, free);
            free -= 1;
            places.push(begin);
        }
        places
    }
}

fn meaningless(what: &str) -> FemError {
    FemError::Meaningless { what: what.to_owned() }
}

/// `t(l, s)`: segments computed again in a sweep over l segments with s checkpoints, one of them at their beginning.
pub(crate) fn recomputed(l: usize, s: usize) -> usize {
    // beta(s, r), by which r of them l is covered; beta(s + 1, r - 1) = beta(s, r) r / (s + 1)
    let (mut r, mut beta) = (0, 1);
    while beta < l {
        r += 1;
        beta = beta * (s + r) / r;
    }
    r * l - beta * r / (s + 1)
}

/// How many of l > 1 segments to go before the next of s > 1 checkpoints, with the least work in all: those before it are swept with all
/// checkpoints, those behind it with one less.
pub(crate) fn split(l: usize, s: usize) -> usize {
    let work = |j: usize| j + recomputed(j, s) + recomputed(l - j, s - 1);
    (1..l).min_by_key(|j| work(*j)).unwrap_or(1)
}
