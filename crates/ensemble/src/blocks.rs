//! [`EnsembleBlock`]: the control fields of an ensemble, each once, in one vector.

use crate::error::EnsembleError;
use crate::member::Member;
use nastic_control::{ControlBlock, ControlMap};

/// One control field of an ensemble, used by some of its members.
#[derive(Clone, Debug)]
pub struct EnsembleBlock {
    /// The control's name, `LOAD_CASE/CONTROL` for a load case's own.
    pub name: String,
    /// First entry in the vector.
    pub first: usize,
    /// Number of entries.
    pub len: usize,
    /// Index of the first member that uses it: the one whose inner product it has.
    pub owner: usize,
    /// Index of the field in that member's layout.
    pub field: usize,
}

impl EnsembleBlock {
    /// Its member of a vector.
    pub fn of<'m>(&self, m: &'m [f64]) -> &'m [f64] {
        &m[self.first..self.first + self.len]
    }
}

/// Enters the control fields of `member` (names as the ensemble has them) after those of the members before it.
pub(crate) fn enter(
    blocks: &mut Vec<EnsembleBlock>,
    before: &[Member],
    member: &mut Member,
    names: Vec<String>,
) -> Result<(), EnsembleError> {
    for (field, name) in names.into_iter().enumerate() {
        let new = &member.problem.layout().blocks()[field];
        let index = match blocks.iter().position(|block| block.name == name) {
            Some(index) => {
                let owner = &before[blocks[index].owner];
                let old = &owner.problem.layout().blocks()[blocks[index].field];
                if let Some(what) = difference(old, new) {
                    let (who, other) = (member.name.clone(), owner.name.clone());
                    return Err(EnsembleError::Block { block: name, who, other, what });
                }
                index
            }
            None => {
                let first = blocks.last().map_or(0, |last| last.first + last.len);
                blocks.push(EnsembleBlock { name, first, len: new.len(), owner: before.len(), field });
                blocks.len() - 1
            }
        };
        member.blocks.push(index);
    }
    Ok(())
}

/// In what two fields of one name differ. Positions may: the geometry can be uncertain too.
fn difference(a: &ControlBlock, b: &ControlBlock) -> Option<&'static str> {
    match () {
        () if a.basis.space() != b.basis.space() => Some("space"),
        () if a.components != b.components => Some("number of components"),
        () if a.unit != b.unit => Some("unit"),
        () if maps(a) != maps(b) => Some("direction, length or other maps to the slots"),
        () if a.weight != b.weight => Some("weight in the inner product"),
        () if a.knots != b.knots => Some("knots in time"),
        () if a.basis.entities() != b.basis.entities() => Some("cells or nodes"),
        () => None,
    }
}

/// What its field and its slots are made by, as far as members must agree in it.
fn maps(block: &ControlBlock) -> Vec<String> {
    let targets = block.targets.iter().map(|target| target.map.shared());
    std::iter::once(block.field.shared()).chain(targets).collect()
}

/// The control vector of one member.
pub(crate) fn gather(blocks: &[EnsembleBlock], member: &Member, m: &[f64]) -> Vec<f64> {
    member.blocks.iter().flat_map(|&block| blocks[block].of(m)).copied().collect()
}

/// Adds `weight` times a member's dual vector to the ensemble's.
pub(crate) fn scatter(blocks: &[EnsembleBlock], member: &Member, weight: f64, from: &[f64], out: &mut [f64]) {
    for (local, &block) in member.problem.layout().blocks().iter().zip(&member.blocks) {
        let block = &blocks[block];
        let place = &mut out[block.first..block.first + block.len];
        place.iter_mut().zip(local.of(from)).for_each(|(out, d)| *out += weight * d);
    }
}
