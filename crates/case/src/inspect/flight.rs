//! Parts of a body that nothing holds and that fly far.

use crate::lower::CaseMember;
use crate::warning::{FREE_FLIGHT, Warning};
use nastic_fem::{State, Touch};
use nastic_language::number::short;
use nastic_mesh::{GroupNames, Mesh};
use nastic_numeric::vector::{norm, sub};

/// A part that moves by so many times its size flies away.
const FAR: f64 = 10.0;

/// Warns of connected parts that move farther than ten times their size, while no support holds the body and no contact carries the part in the last
/// state, by what the contacts carry there.
pub fn flight(member: CaseMember<'_>, states: &[State], touches: &[(String, Touch)]) -> Option<Warning> {
    let (solid, mesh) = (member.solid(), member.mesh());
    if solid.model().checks().is_held_without_contact() {
        return None;
    }
    let part_of = parts(mesh);
    let carried = carried(member, &part_of, touches);
    let count = part_of.iter().max().map_or(0, |last| *last as usize + 1);
    let far = (0..count).filter(|part| !carried[*part]).find_map(|part| {
        let nodes: Vec<usize> = (0..part_of.len()).filter(|node| part_of[*node] as usize == part).collect();
        let moved = |state: &State| {
            let u = solid.model().displacement(&state.u);
            let mean = |i: usize| nodes.iter().map(|node| u[mesh.dim() * node + i]).sum::<f64>() / nodes.len() as f64;
            norm(&(0..mesh.dim()).map(mean).collect::<Vec<f64>>())
        };
        let size = size(nodes.iter().map(|node| &mesh.points()[*node]));
        let first = states.iter().find(|state| moved(state) > FAR * size)?;
        let last = states.last().map(moved).filter(|moved| *moved > FAR * size)?;
        Some((first.time, last, last / size, mesh.points()[nodes[0]]))
    });
    let (time, moved, sizes, place) = far?;
    let units = member.problem().units();
    let (length, unit) = (units.length().symbol, units.time().symbol);
    let what = if count == 1 {
        "the body".to_owned()
    } else {
        let place: Vec<String> = place[..mesh.dim()].iter().map(|x| short(*x)).collect();
        format!("the part with the node at ({})", place.join(", "))
    };
    let message = format!(
        "{what} flies {} {length} far, {} times its size, and is {FAR} sizes away by t = {} {unit}: no support holds it, and no contact \
         carries it at the end",
        short(moved),
        short(sizes.round()),
        short(time)
    );
    Some(Warning::new(&FREE_FLIGHT, message).of(member.name()))
}

/// The connected part of every node.
fn parts(mesh: &Mesh) -> Vec<u32> {
    let mut part_of = vec![0; mesh.points().len()];
    let cells = mesh.blocks().iter().flat_map(|block| block.iter());
    for (part, nodes) in mesh.pieces().into_iter().zip(cells) {
        nodes.iter().for_each(|node| part_of[*node as usize] = part);
    }
    part_of
}

/// Parts that a surface belongs to whose contact presses, and those that a support carries along.
fn carried(member: CaseMember<'_>, part_of: &[u32], touches: &[(String, Touch)]) -> Vec<bool> {
    let (mesh, supports) = (member.mesh(), member.solid().supports());
    let mut carried = vec![false; part_of.len().max(1)];
    let pressing = |name: &str| touches.iter().any(|(own, touch)| own == name && touch.pressing > 0.0);
    let mut carry = |names: &GroupNames| {
        let nodes = mesh.facets_of(names).map(|facets| mesh.nodes_of_facets(&facets)).unwrap_or_default();
        nodes.iter().for_each(|node| carried[part_of[*node as usize] as usize] = true);
    };
    for contact in member.case().contact.iter().filter(|contact| pressing(&contact.name())) {
        carry(&contact.surface);
        contact.with.iter().for_each(&mut carry);
    }
    for (dof, fixed) in supports.fixed().iter().enumerate() {
        if *fixed && !supports.holds_at_rest(dof) {
            carried[part_of[dof / mesh.dim()] as usize] = true;
        }
    }
    carried
}

/// The diagonal of the bounding box of points.
fn size<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> f64 {
    let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (low, high) = points.fold(start, |(low, high), x| {
        (std::array::from_fn(|i| x[i].min(low[i])), std::array::from_fn(|i| x[i].max(high[i])))
    });
    norm(&sub(&high, &low))
}
