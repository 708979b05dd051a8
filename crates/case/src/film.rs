//! The films of dielectrics: how thick they are at rest, and so what voltage a field is.

use crate::lower::CaseMember;
use nastic_control::{ControlBlock, Space};
use nastic_energy::{Dielectric, EnergyTerm};
use nastic_fem::AttachedLaw;
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Input, Means};
use nastic_mesh::GroupNames;

/// Thicknesses that differ by a smaller part are one.
const ALIKE: f64 = 1e-6;

/// Least and largest voltage, in V, over the films of a dielectric whose field has these values, uniform or by region; none of other controls, of fields in
/// space, of films whose direction varies, and where films of one value differ.
#[must_use]
pub fn voltages(member: CaseMember<'_>, block: &ControlBlock, values: &[f64]) -> Option<[f64; 2]> {
    let actuation = member.case().actuation.iter().find(|actuation| actuation.name == block.name)?;
    let Means::Law { row, region, parameters, .. } = &actuation.means else { return None };
    let Some(Input::Direction(direction)) = parameters.get("direction").filter(|_| row.name == Dielectric::NAME) else {
        return None;
    };
    let along = direction.constant()?;
    // where it grows, the thickness that the field goes across is another one
    let laws = member.solid().body().actuations();
    let film = laws.iter().find(|law| law.name == block.name)?;
    let grows = |law: &AttachedLaw| {
        law.law.strain_map().is_some() && law.cells.iter().any(|cell| film.cells.binary_search(cell).is_ok())
    };
    if laws.iter().any(grows) {
        return None;
    }
    let all: Vec<f64> = match block.basis.space() {
        Space::Region => {
            let voltage = |(k, field): (usize, &f64)| {
                Some(field * thickness(member, block.basis.region(k % block.basis.len().max(1)), along)?)
            };
            values.iter().enumerate().map(voltage).collect::<Option<_>>()?
        }
        Space::Uniform => {
            let films: Vec<f64> = region.iter().map(|name| thickness(member, name, along)).collect::<Option<_>>()?;
            let first = films.first().copied()?;
            let alike = films.iter().all(|film| (film - first).abs() <= ALIKE * first);
            values.iter().filter(|_| alike).map(|field| field * first).collect()
        }
        _ => return None,
    };
    let range = all.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], u| [l.min(u), h.max(u)]);
    let volts = range.map(|u| member.problem().units().in_si(u, Dimension::VOLTAGE));
    volts.iter().all(|u| u.is_finite()).then_some(volts)
}

/// The extent at rest of a region along a direction.
fn thickness(member: CaseMember<'_>, region: &str, along: [f64; 3]) -> Option<f64> {
    let mesh = member.mesh();
    let nodes = mesh.nodes_of_cells(&mesh.cells_of(&GroupNames::from(region)).ok()?);
    let place = |node: &u32| mesh.points()[*node as usize].iter().zip(along).map(|(x, d)| x * d).sum::<f64>();
    let (low, high) =
        nodes.iter().map(place).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    Some(high - low)
}

/// `3 kV`, or `1 to 3 kV`.
#[must_use]
pub fn kilovolts([low, high]: [f64; 2]) -> String {
    let [low, high] = [low, high].map(|volts| 1e-3 * volts);
    if low == high { format!("{} kV", short(low)) } else { format!("{} to {} kV", short(low), short(high)) }
}
