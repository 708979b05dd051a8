//! From what a file lists to a raw mesh with groups.

use std::collections::BTreeMap;

use super::element::Family;
use super::model::{Element, Model, Scope};
use super::read::{Found, Reader};
use crate::error::ReadError;
use nastic_mesh::{CellKind, RawMesh};

/// Keywords that a note lists.
const MOST_LISTED: usize = 12;

/// Corners of a face, ascending; `u32::MAX` where there are fewer than four.
type Corners = [u32; 4];
/// How many cells have a face.
type Faces = BTreeMap<Corners, u32>;

impl Reader<'_> {
    /// The mesh of all that was read.
    pub fn mesh(self) -> Result<RawMesh, ReadError> {
        let dim = self.root.elements.iter().map(|element| element.kind.dim()).max().unwrap_or(0);
        if let Some((line, name)) = &self.shells
            && dim == 2
        {
            let what = format!("a body of shells or membranes ({name}, line {line})");
            return Err(self.lines.unsupported(what, "mesh the body itself, with C3D or CPE elements"));
        }
        let mut raw = RawMesh { notes: notes(&self.found), ..RawMesh::default() };
        if dim == 2 && !self.plane_stress.is_empty() {
            let names: Vec<&str> = self.plane_stress.iter().map(String::as_str).collect();
            raw.notes.push(format!("plane stress elements ({}) are taken in plane strain", names.join(", ")));
        }
        let names = Names { model: &self.root, instances: &self.instance_names };
        // looked up by surfaces without numbers of faces, and by elements that are faces
        let is_asked = self.root.surfaces.iter().any(|surface| !surface.free.is_empty())
            || self.root.elements.iter().any(|element| element.kind.dim() < dim);
        let faces = if is_asked { faces(&self.root.elements, dim) } else { Faces::new() };
        let free = elements(&self.root, dim, &names, &faces, &mut raw);
        surfaces(&self.root, dim, &names, &faces, free, &mut raw);
        node_sets(&self.root, &names, &mut raw);
        (raw.points, raw.node_labels) = (self.root.points, self.root.node_labels);
        Ok(raw)
    }
}

/// What groups are called.
struct Names<'m> {
    model: &'m Model,
    instances: &'m [String],
}

impl Names<'_> {
    /// The name, behind that of its instance where there are several or the file itself has such a name.
    fn of(&self, scope: Scope, name: &str) -> String {
        let instance = (scope as usize).checked_sub(1).and_then(|k| self.instances.get(k));
        let has = |other: Scope| {
            let same = |own: &str| own.eq_ignore_ascii_case(name);
            self.model.node_sets.find(other, name).is_some()
                || self.model.element_sets.find(other, name).is_some()
                || self.model.surfaces.iter().any(|surface| surface.scope == other && same(&surface.name))
        };
        match instance {
            Some(instance) if self.instances.len() > 1 || has(0) => format!("{instance}.{name}"),
            _ => name.to_owned(),
        }
    }
}

fn corners(kind: CellKind, nodes: &[u32]) -> Corners {
    let mut corners = std::array::from_fn(|k| if k < kind.corners() { nodes[k] } else { u32::MAX });
    corners.sort_unstable();
    corners
}

fn face_of(element: &Element, face: usize) -> (CellKind, Vec<u32>) {
    let (kind, local) = element.kind.faces()[face];
    (kind, local.iter().map(|at| element.nodes[*at]).collect())
}

fn faces(elements: &[Element], dim: usize) -> Faces {
    let mut faces = Faces::new();
    for element in elements.iter().filter(|element| element.kind.dim() == dim) {
        for k in 0..element.kind.faces().len() {
            let (kind, nodes) = face_of(element, k);
            *faces.entry(corners(kind, &nodes)).or_default() += 1;
        }
    }
    faces
}

/// Adds elements with the tags of their sets; returns the first free tag.
fn elements(model: &Model, dim: usize, names: &Names, faces: &Faces, raw: &mut RawMesh) -> i32 {
    let mut tags = vec![Vec::new(); model.elements.len()];
    let mut tag = 0;
    for set in model.element_sets.all.iter().filter(|set| !set.internal) {
        tag += 1;
        let name = names.of(set.scope, &set.name);
        for &member in &set.members {
            let tags: &mut Vec<i32> = &mut tags[member as usize];
            if tags.last() != Some(&tag) {
                tags.push(tag);
            }
            raw.names.entry((model.elements[member as usize].kind.dim(), tag)).or_insert_with(|| name.clone());
        }
    }
    let mut loose = 0;
    for (element, tags) in model.elements.iter().zip(&tags) {
        if element.kind.dim() + 1 == dim && !faces.contains_key(&corners(element.kind, &element.nodes)) {
            loose += 1;
            continue;
        }
        raw.push_labelled(element.kind, &element.nodes, tags, element.label);
    }
    if loose > 0 {
        raw.notes.push(format!("{loose} elements of dimension {} are no faces of cells; left out", dim - 1));
    }
    tag + 1
}

fn surfaces(model: &Model, dim: usize, names: &Names, faces: &Faces, free: i32, raw: &mut RawMesh) {
    for (tag, surface) in (free..).zip(&model.surfaces) {
        raw.name_group(dim.saturating_sub(1), tag, names.of(surface.scope, &surface.name));
        let mut push = |(kind, nodes): (CellKind, Vec<u32>)| raw.push(kind, &nodes, &[tag]);
        surface
            .faces
            .iter()
            .map(|(element, face)| face_of(&model.elements[*element as usize], *face))
            .for_each(&mut push);
        for element in surface.free.iter().map(|element| &model.elements[*element as usize]) {
            if element.family == Family::Shell || element.kind.dim() < dim {
                if faces.contains_key(&corners(element.kind, &element.nodes)) {
                    push((element.kind, element.nodes.clone()));
                }
                continue;
            }
            let own = (0..element.kind.faces().len()).map(|face| face_of(element, face));
            own.filter(|(kind, nodes)| faces.get(&corners(*kind, nodes)) == Some(&1)).for_each(&mut push);
        }
    }
}

fn node_sets(model: &Model, names: &Names, raw: &mut RawMesh) {
    for (tag, set) in (1..).zip(model.node_sets.all.iter().filter(|set| !set.internal)) {
        raw.name_group(0, tag, names.of(set.scope, &set.name));
        raw.vertices.extend(set.members.iter().map(|node| (*node, tag)));
    }
}

/// What was not read.
fn notes(found: &Found) -> Vec<String> {
    let mut notes = Vec::new();
    if !found.includes.is_empty() {
        notes.push(format!("files of *INCLUDE are not read: {}", found.includes.join(", ")));
    }
    for (name, count) in &found.passed_over {
        notes.push(format!("{count} elements of type {} passed over", crate::source::brief(name)));
    }
    for (name, count) in &found.unknown {
        notes.push(format!("{count} members of the set \"{name}\" are not in the file"));
    }
    for name in &found.foreign {
        notes.push(format!("the set \"{name}\" lists no elements of the file, but entities of Gmsh: not read"));
    }
    if !found.surfaces.is_empty() {
        let names: Vec<&str> = found.surfaces.iter().map(String::as_str).collect();
        notes.push(format!("surfaces of other kinds than ELEMENT and NODE are not read: {}", names.join(", ")));
    }
    if !found.unread.is_empty() {
        let listed: Vec<&str> = found.unread.iter().take(MOST_LISTED).map(String::as_str).collect();
        let more = found.unread.len() - listed.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        notes.push(format!("the mesh alone is read, not {}{more}", listed.join(", ")));
    }
    notes
}
