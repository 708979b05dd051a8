//! [`Model`]: nodes, elements, sets and surfaces of a part, or of a whole file.

use std::collections::BTreeMap;

use super::element::Family;
use nastic_mesh::CellKind;

/// An element, its nodes as indices into [`Model::points`], in our order.
#[derive(Clone)]
pub(super) struct Element {
    pub kind: CellKind,
    pub family: Family,
    pub nodes: Vec<u32>,
    pub label: u64,
}

/// A number that is a name space: 0 the file's own, others instances.
pub(super) type Scope = u32;

/// Members by name.
#[derive(Clone, Default)]
pub(super) struct Sets {
    pub all: Vec<Set>,
    by_name: BTreeMap<(Scope, String), usize>,
}

/// A set of nodes or elements.
#[derive(Clone)]
pub(super) struct Set {
    pub scope: Scope,
    /// As first written.
    pub name: String,
    pub members: Vec<u32>,
    /// Made by a program for its own use.
    pub internal: bool,
}

impl Sets {
    /// Names mean the same in capitals and without.
    pub fn find(&self, scope: Scope, name: &str) -> Option<&[u32]> {
        let at = self.by_name.get(&(scope, name.to_uppercase()))?;
        Some(&self.all[*at].members)
    }

    pub fn extend(&mut self, scope: Scope, name: &str, internal: bool, members: &[u32]) {
        let next = self.all.len();
        let at = *self.by_name.entry((scope, name.to_uppercase())).or_insert(next);
        if at == next {
            self.all.push(Set { scope, name: name.to_owned(), members: Vec::new(), internal });
        }
        self.all[at].members.extend_from_slice(members);
    }
}

/// A surface.
#[derive(Clone, Default)]
pub(super) struct Surface {
    pub scope: Scope,
    pub name: String,
    /// Elements with one of their faces.
    pub faces: Vec<(u32, usize)>,
    /// Elements all of whose outer faces are meant, or that are faces themselves.
    pub free: Vec<u32>,
}

/// What a file or a part has.
#[derive(Clone, Default)]
pub(super) struct Model {
    pub points: Vec<[f64; 3]>,
    pub node_labels: Vec<u64>,
    pub elements: Vec<Element>,
    pub node_at: BTreeMap<(Scope, u64), u32>,
    pub element_at: BTreeMap<(Scope, u64), u32>,
    pub node_sets: Sets,
    pub element_sets: Sets,
    pub surfaces: Vec<Surface>,
}

impl Model {
    /// Adds a part as an instance, moved.
    pub fn add(&mut self, part: &Model, scope: Scope, moved: impl Fn([f64; 3]) -> [f64; 3]) {
        let (nodes, elements) = (self.points.len() as u32, self.elements.len() as u32);
        self.points.extend(part.points.iter().map(|point| moved(*point)));
        self.node_labels.extend(&part.node_labels);
        let shifted = |element: &Element| {
            let nodes = element.nodes.iter().map(|node| node + nodes).collect();
            Element { nodes, ..element.clone() }
        };
        self.elements.extend(part.elements.iter().map(shifted));
        let shift = |at: &BTreeMap<(Scope, u64), u32>, by: u32| {
            at.iter().map(|((_, label), k)| ((scope, *label), k + by)).collect::<Vec<_>>()
        };
        self.node_at.extend(shift(&part.node_at, nodes));
        self.element_at.extend(shift(&part.element_at, elements));
        let own =
            [(&mut self.node_sets, &part.node_sets, nodes), (&mut self.element_sets, &part.element_sets, elements)];
        for (sets, added, by) in own {
            for set in &added.all {
                let members: Vec<u32> = set.members.iter().map(|member| member + by).collect();
                sets.extend(scope, &set.name, set.internal, &members);
            }
        }
        self.surfaces.extend(part.surfaces.iter().map(|surface| Surface {
            scope,
            name: surface.name.clone(),
            faces: surface.faces.iter().map(|(element, face)| (element + elements, *face)).collect(),
            free: surface.free.iter().map(|element| element + elements).collect(),
        }));
    }
}
