//! Where blocks of a case act: groups of the mesh by name.

use super::context::Context;
use nastic_language::syntax::At;
use nastic_mesh::{GroupNames, Mesh, MeshError};

/// Kinds of groups, by the key that names them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    Surface,
    Region,
    Nodes,
}

/// The groups that a block names under one of the keys "surface", "region" and "nodes".
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedGroups<'c> {
    pub kind: Kind,
    pub names: &'c GroupNames,
}

impl<'c> NamedGroups<'c> {
    /// The first of the keys that is there; one always is.
    pub fn of(
        surface: &'c Option<GroupNames>,
        region: &'c Option<GroupNames>,
        nodes: &'c Option<GroupNames>,
    ) -> Option<Self> {
        let place = |kind, names: &'c Option<GroupNames>| names.as_ref().map(|names| Self { kind, names });
        place(Kind::Surface, surface).or(place(Kind::Region, region)).or(place(Kind::Nodes, nodes))
    }

    pub fn key(&self) -> &'static str {
        match self.kind {
            Kind::Surface => "surface",
            Kind::Region => "region",
            Kind::Nodes => "nodes",
        }
    }

    /// The nodes of all the groups, ascending; `None` after a complaint about every unknown name.
    pub fn nodes(&self, mesh: &Mesh, block: &At, context: &mut Context<'_>) -> Option<Vec<u32>> {
        let at = block.key(self.key());
        Some(match self.kind {
            Kind::Surface => mesh.nodes_of_facets(&facets(mesh, self.names, &at, context)?),
            Kind::Region => mesh.nodes_of_cells(&cells(mesh, self.names, &at, context)?),
            Kind::Nodes => node_sets(mesh, self.names, &at, context)?,
        })
    }
}

/// The cells of regions, ascending; `None` after a complaint about every unknown name.
pub(super) fn cells(mesh: &Mesh, names: &GroupNames, at: &At, context: &mut Context<'_>) -> Option<Vec<u32>> {
    known(names, at, |name| mesh.region(name), context)?;
    context.take(at, mesh.cells_of(names))
}

/// The facets of surfaces, ascending; `None` after a complaint about every unknown name.
pub(super) fn facets(
    mesh: &Mesh,
    names: &GroupNames,
    at: &At,
    context: &mut Context<'_>,
) -> Option<Vec<nastic_mesh::Facet>> {
    known(names, at, |name| mesh.surface(name), context)?;
    context.take(at, mesh.facets_of(names))
}

/// The nodes of node sets, or of surfaces where no node set has the name, ascending; `None` after a complaint about every unknown
/// name.
pub(super) fn node_sets(mesh: &Mesh, names: &GroupNames, at: &At, context: &mut Context<'_>) -> Option<Vec<u32>> {
    let of = |name: &str| match mesh.surface(name) {
        Ok(facets) if !mesh.node_sets().contains_key(name) => Ok(mesh.nodes_of_facets(facets)),
        _ => mesh.node_set(name).map(<[u32]>::to_vec),
    };
    let mut nodes = known(names, at, of, context)?.concat();
    nodes.sort_unstable();
    nodes.dedup();
    Some(nodes)
}

/// What the names stand for, one by one.
fn known<T>(
    names: &GroupNames,
    at: &At,
    group: impl Fn(&str) -> Result<T, MeshError>,
    context: &mut Context<'_>,
) -> Option<Vec<T>> {
    let place = |i: usize| if names.are_several() { at.index(i) } else { at.clone() };
    let found = names.iter().enumerate().map(|(i, name)| context.take(&place(i), group(name)));
    // All of them are looked up before one that is missing ends it.
    found.collect::<Vec<Option<T>>>().into_iter().collect()
}
