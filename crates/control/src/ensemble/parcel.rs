//! [`Parcel`]: what ranks send each other of their members, as bytes.

use crate::control_limit::{ControlAt, ControlLimit};
use crate::error::{ControlError, RemoteFailure};
use crate::evaluated::Evaluated;
use crate::state_bytes::{read_report, write_report};
use nastic_fem::{Connection, SolveReport, StateError};
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{SavedRunError, Summary};
use nastic_team::TeamError;

/// What is sent of a member to the other ranks.
pub trait Parcel: Sized {
    /// Adds it to a message.
    fn pack(&self, out: &mut Writer);

    /// Reads what [`pack`](Self::pack) wrote.
    ///
    /// # Errors
    /// It ends early, or something else stands there.
    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError>;
}

/// A message of one parcel.
pub(super) fn packed(parcel: &impl Parcel) -> Vec<u8> {
    let mut out = Writer::new("");
    parcel.pack(&mut out);
    out.finish()
}

/// The whole message of a rank.
pub(super) fn unpacked<T>(
    rank: usize,
    bytes: &[u8],
    read: impl FnOnce(&mut Reader<'_>) -> Result<T, SavedRunError>,
) -> Result<T, TeamError> {
    let read = |input: &mut Reader<'_>| read(input).and_then(|found| input.finish().map(|()| found));
    let found = Reader::new(bytes, "").and_then(|mut input| read(&mut input));
    found.map_err(|_| TeamError::Unexpected { rank, what: "a report of another form" })
}

/// What all ranks know of a member that has been evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberValues {
    /// Value of every cost term, weights included.
    pub terms: Vec<f64>,
    /// Value of every constraint.
    pub constraints: Vec<f64>,
    /// Work of the state solve.
    pub work: SolveReport,
    /// Work of the adjoint, once the derivative was taken.
    pub adjoint: Option<SolveReport>,
    /// The smallest J of its state; of a motion at the end.
    pub min_j: f64,
}

impl MemberValues {
    pub(super) fn of(at: &Evaluated) -> Self {
        Self {
            terms: at.terms.clone(),
            constraints: at.constraints.clone(),
            work: at.work,
            adjoint: at.adjoint.as_ref().map(|adjoint| adjoint.work),
            min_j: at.state().report.min_j,
        }
    }

    /// Sum of the terms.
    pub fn cost(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// Work of the state solve and, if there is one, of the adjoint.
    pub fn total_work(&self) -> SolveReport {
        let mut work = self.work;
        self.adjoint.iter().for_each(|adjoint| work.add_work(adjoint));
        work
    }
}

impl Parcel for MemberValues {
    fn pack(&self, out: &mut Writer) {
        out.floats(&self.terms);
        out.floats(&self.constraints);
        write_report(&self.work, out);
        self.adjoint.pack(out);
        out.float(self.min_j);
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let (terms, constraints) = (input.floats()?, input.floats()?);
        let (work, adjoint) = (read_report(input)?, Parcel::unpack(input)?);
        Ok(Self { terms, constraints, work, adjoint, min_j: input.float()? })
    }
}

impl Parcel for SolveReport {
    fn pack(&self, out: &mut Writer) {
        write_report(self, out);
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        read_report(input)
    }
}

impl Parcel for () {
    fn pack(&self, _: &mut Writer) {}

    fn unpack(_: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        Ok(())
    }
}

impl Parcel for f64 {
    fn pack(&self, out: &mut Writer) {
        out.float(*self);
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        input.float()
    }
}

impl Parcel for usize {
    fn pack(&self, out: &mut Writer) {
        out.count(*self);
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        input.number()
    }
}

impl Parcel for Connection {
    fn pack(&self, out: &mut Writer) {
        let (kind, share) = match self {
            Connection::Connected => (0, 0.0),
            Connection::Unknown(share) => (1, *share),
            Connection::LimitPoint(share) => (2, *share),
            Connection::Elsewhere(share) => (3, *share),
        };
        out.count(kind);
        out.float(share);
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        Ok(match (input.number()?, input.float()?) {
            (0, _) => Connection::Connected,
            (2, share) => Connection::LimitPoint(share),
            (3, share) => Connection::Elsewhere(share),
            (_, share) => Connection::Unknown(share),
        })
    }
}

impl Parcel for Vec<usize> {
    fn pack(&self, out: &mut Writer) {
        out.count(self.len());
        self.iter().for_each(|number| out.count(*number));
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        (0..input.count(8)?).map(|_| input.number()).collect()
    }
}

impl Parcel for Vec<Vec<u8>> {
    fn pack(&self, out: &mut Writer) {
        out.count(self.len());
        self.iter().for_each(|bytes| out.bytes(bytes));
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        (0..input.count(8)?).map(|_| input.list()).collect()
    }
}

impl<P: Parcel> Parcel for Option<P> {
    fn pack(&self, out: &mut Writer) {
        out.count(usize::from(self.is_some()));
        self.iter().for_each(|one| one.pack(out));
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        if input.flag()? { P::unpack(input).map(Some) } else { Ok(None) }
    }
}

impl Parcel for Summary {
    fn pack(&self, out: &mut Writer) {
        out.count(self.0.len());
        for (name, value) in &self.0 {
            out.bytes(name.as_bytes());
            out.float(*value);
        }
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let entries = (0..input.count(8)?).map(|_| Ok((input.text()?, input.float()?)));
        entries.collect::<Result<_, _>>().map(Summary)
    }
}

/// A failure with the rank it happened on. Limit points and cancelled solves stay what they are; of others what a run asks of them is kept, and
/// how they read.
impl Parcel for (usize, ControlError) {
    fn pack(&self, out: &mut Writer) {
        let (rank, error) = self;
        out.count(*rank);
        match error {
            ControlError::LimitPoint { limit, newton } => {
                out.count(1);
                out.count(*newton);
                pack_limit(limit, out);
            }
            ControlError::State(StateError::Cancelled) => out.count(2),
            ControlError::Remote(failure) => pack_failure(failure, out),
            error => pack_failure(&RemoteFailure::new(*rank, error), out),
        }
    }

    fn unpack(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let rank = input.number()?;
        let error = match input.number()? {
            1 => {
                let newton = input.number()?;
                ControlError::LimitPoint { newton, limit: unpack_limit(input)? }
            }
            2 => ControlError::State(StateError::Cancelled),
            _ => ControlError::Remote(Box::new(RemoteFailure {
                rank,
                message: input.text()?,
                newton: Parcel::unpack(input)?,
                lacks_memory: input.flag()?,
                lacks_second_derivatives: input.flag()?,
            })),
        };
        Ok((rank, error))
    }
}

fn pack_failure(failure: &RemoteFailure, out: &mut Writer) {
    out.count(0);
    out.bytes(failure.message.as_bytes());
    failure.newton.pack(out);
    out.count(usize::from(failure.lacks_memory));
    out.count(usize::from(failure.lacks_second_derivatives));
}

fn pack_limit(limit: &ControlLimit, out: &mut Writer) {
    out.float(limit.share);
    out.count(limit.at.len());
    for ControlAt { name, range: [low, high], unit } in &limit.at {
        out.bytes(name.as_bytes());
        out.float(*low);
        out.float(*high);
        out.bytes(unit.as_bytes());
    }
}

fn unpack_limit(input: &mut Reader<'_>) -> Result<ControlLimit, SavedRunError> {
    let share = input.float()?;
    let at = (0..input.count(8)?).map(|_| {
        let (name, range) = (input.text()?, [input.float()?, input.float()?]);
        Ok(ControlAt { name, range, unit: input.text()? })
    });
    Ok(ControlLimit { share, at: at.collect::<Result<_, _>>()? })
}
