//! Whether the members, sets and starts of a program can be run and reported as those of a case file.

use super::{Admission, AssemblyError, ControlProblem};
use crate::lower::control_field::{Admitted, ControlField};
use crate::lower::start::{self, Unbounded};
use nastic_control::ControlBlock;
use nastic_ensemble::{Ensemble, Member};
use nastic_language::schema::Case;

/// All members have one mesh, all scenarios the same load cases.
pub(super) fn members(ensemble: &Ensemble) -> Result<(), AssemblyError> {
    let members = ensemble.members();
    let first = &members[0];
    let mesh = first.problem().solid().mesh();
    for member in &members[1..] {
        let own = member.problem().solid().mesh();
        if own.points() != mesh.points() || own.blocks() != mesh.blocks() {
            return Err(AssemblyError::Mesh { member: member.name().to_owned(), other: first.name().to_owned() });
        }
    }
    for (one, other) in members.iter().flat_map(|member| [(member, first), (first, member)]) {
        if let Some(alone) = without_counterpart(members, one.scenario(), other.scenario()) {
            return Err(AssemblyError::LoadCases {
                member: alone.name().to_owned(),
                other: other.name().to_owned(),
                load_case: alone.load_case().to_owned(),
            });
        }
    }
    Ok(())
}

/// A member of one scenario whose load case another scenario lacks.
fn without_counterpart(members: &[Member], of: usize, other: usize) -> Option<&Member> {
    let has = |name: &str| members.iter().any(|member| member.scenario() == other && member.load_case() == name);
    members.iter().find(|member| member.scenario() == of && !has(member.load_case()))
}

/// The set holds vectors of as many components as the control has, and those of one length have it between the nodes too.
pub(super) fn set(own: &ControlBlock, control: &ControlProblem) -> Result<(), AssemblyError> {
    let Admission::Vectors { admitted, dim } = control.admitted else { return Ok(()) };
    if dim != own.components {
        return Err(AssemblyError::Components { control: own.name.clone(), dim, components: own.components });
    }
    match admitted {
        Admitted::Norm(radius) if dim > 1 && own.basis.space().interpolates() && own.length().is_none() => {
            Err(AssemblyError::NodalSphere { control: own.name.clone(), radius })
        }
        _ => Ok(()),
    }
}

/// The start has a value for each of the control's, within the set.
pub(super) fn start(own: &ControlBlock, control: &ControlProblem) -> Result<(), AssemblyError> {
    if control.start.len() != own.len() {
        let (found, expected) = (control.start.len(), own.len());
        return Err(AssemblyError::Length { control: own.name.clone(), found, expected });
    }
    control.set.check(&control.start).map_err(|source| {
        let unknown = source.index / own.components.max(1);
        let place = if unknown < own.basis.len() { own.basis.describe(unknown) } else { format!("value {unknown}") };
        AssemblyError::Start { control: own.name.clone(), place, source }
    })
}

/// A control is bounded where random starts are asked for.
pub(super) fn random_starts(field: &ControlField, case: &Case) -> Result<(), AssemblyError> {
    let missing = match start::unbounded(field) {
        _ if case.optimizer.starts < 2 => return Ok(()),
        None => return Ok(()),
        Some(Unbounded::Below) => "lower bound",
        Some(Unbounded::Above) => "upper bound",
        Some(Unbounded::Length) => "largest length",
    };
    Err(AssemblyError::RandomStart { control: field.name.clone(), missing })
}
