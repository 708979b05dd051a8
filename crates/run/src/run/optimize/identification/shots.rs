//! The residuals of every shot at an optimum.

use crate::run::error::RunError;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{Evaluated, Reading};
use nastic_ensemble::EnsemblePoint;
use nastic_report::record::{ByName, Number, ShotRecord};

/// By load case.
pub(super) fn of(problem: &CaseProblem, point: &EnsemblePoint) -> Result<ByName<ShotRecord>, RunError> {
    let members = problem.members().zip(&point.members);
    members.map(|(member, at)| Ok((member.load_case().unwrap_or("all").to_owned(), shot(member, at)?))).collect()
}

fn shot(member: CaseMember<'_>, at: &Evaluated) -> Result<ShotRecord, RunError> {
    let weight = member.part().weight();
    let (mut readings, mut squares) = (0, 0.0);
    let (mut markers, mut others): (Vec<Reading>, ByName<Number>) = (Vec::new(), ByName::new());
    let evaluated = member.reduced().costs_of(at)?;
    for ((cost, evaluated), value) in member.reduced().costs().iter().zip(evaluated.iter()).zip(&at.terms) {
        let Some(own) = cost.numbers() else { continue };
        readings += own;
        squares += 2.0 * weight * value;
        let read = evaluated.readings();
        if read.is_empty() {
            others.insert(cost.name().to_owned(), (2.0 * weight * value / own as f64).sqrt().into());
        }
        markers.extend(read);
    }
    let coordinates: usize = markers.iter().map(Reading::count).sum();
    let sum: f64 = markers.iter().map(|one| one.distance().powi(2)).sum();
    let largest = markers.iter().max_by(|a, b| a.distance().total_cmp(&b.distance()));
    let distances = || markers.iter().map(|one| (one.name.clone(), one.distance().into())).collect();
    Ok(ShotRecord {
        readings,
        squares: squares.into(),
        rms: (coordinates > 0).then(|| (sum / coordinates as f64).sqrt()).into(),
        largest: largest.map(Reading::distance).into(),
        marker: largest.map(|one| one.name.clone()).into(),
        distances: (!markers.is_empty()).then(distances),
        others: (!others.is_empty()).then_some(others),
    })
}
