//! [`Parted`]: bytes of a run, and apart from them its points.

use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};

/// Bytes of a run, and the points that belong to it, each as the ensemble saves it. Checkpoints of ranks have the points in files of their own.
#[derive(Clone, Default)]
pub(super) struct Parted {
    pub body: Vec<u8>,
    pub points: Vec<Vec<u8>>,
}

impl Parted {
    /// Without points.
    pub fn whole(body: Vec<u8>) -> Self {
        Self { body, points: vec![] }
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new("");
        out.bytes(&self.body);
        out.count(self.points.len());
        self.points.iter().for_each(|point| out.bytes(point));
        out.finish()
    }

    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, "")?;
        let body = input.list()?;
        let points = (0..input.count(8)?).map(|_| input.list()).collect::<Result<_, _>>()?;
        input.finish()?;
        Ok(Self { body, points })
    }
}

/// The next point of a run.
pub(super) fn next(points: &mut impl Iterator<Item = Vec<u8>>) -> Result<Vec<u8>, SavedRunError> {
    points.next().ok_or(SavedRunError::Damaged { at: 0, what: "a run without its points" })
}
