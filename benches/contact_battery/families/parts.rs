//! Meshes of several bodies, and of cells of one that are kept.

use crate::problem::Failure;
use nastic::mesh::RawMesh;
use nastic::prelude::*;
use std::collections::BTreeMap;

/// Bodies in one mesh, each a region of its name, their surfaces with that name before their own: "low y+".
pub fn join(parts: &[(&str, Mesh)]) -> Result<Mesh, Failure> {
    let mut raw = RawMesh::new("bodies");
    let (mut tag, mut offset) = (0, 0);
    for (name, mesh) in parts {
        let dim = mesh.dim();
        tag += 1;
        raw.name_group(dim, tag, *name);
        raw.points.extend_from_slice(mesh.points());
        let shifted = |nodes: &[u32]| -> Vec<u32> { nodes.iter().map(|node| node + offset).collect() };
        for block in mesh.blocks() {
            block.iter().for_each(|nodes| raw.push(block.kind, &shifted(nodes), &[tag]));
        }
        for (surface, facets) in mesh.surfaces() {
            tag += 1;
            raw.name_group(dim - 1, tag, format!("{name} {surface}"));
            for facet in facets {
                let (kind, nodes) = mesh.facet_nodes(*facet);
                raw.push(kind, &shifted(&nodes), &[tag]);
            }
        }
        offset += mesh.points().len() as u32;
    }
    Ok(Mesh::build(raw)?)
}

/// Which places of a facet's middle belong to a surface.
pub type Chosen<'a> = (&'a str, &'a dyn Fn(Vec3) -> bool);

/// The cells with these middles, with surfaces of their outer facets.
pub fn carve(full: &Mesh, keep: impl Fn(Vec3) -> bool, surfaces: &[Chosen]) -> Result<Mesh, Failure> {
    let mut raw = RawMesh::new("carved");
    raw.points = full.points().to_vec();
    raw.name_group(full.dim(), 1, "body");
    let middle = |nodes: &[u32]| -> Vec3 {
        nodes.iter().map(|node| Vec3::from(full.points()[*node as usize])).sum::<Vec3>() / nodes.len() as f64
    };
    let mut facets: BTreeMap<Vec<u32>, (CellKind, Vec<u32>, usize)> = BTreeMap::new();
    for cell in (0..full.cells()).map(|id| full.cell(id)).filter(|cell| keep(middle(cell.nodes))) {
        raw.push(cell.kind, cell.nodes, &[1]);
        for (kind, local) in cell.kind.faces() {
            let nodes: Vec<u32> = local.iter().map(|k| cell.nodes[*k]).collect();
            let mut key = nodes.clone();
            key.sort_unstable();
            facets.entry(key).or_insert((*kind, nodes, 0)).2 += 1;
        }
    }
    for (tag, (name, on)) in (2..).zip(surfaces) {
        raw.name_group(full.dim() - 1, tag, *name);
        for (kind, nodes, _) in facets.values().filter(|(_, nodes, count)| *count == 1 && on(middle(nodes))) {
            raw.push(*kind, nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}

/// Moved.
pub fn shifted(mesh: Mesh, by: Vec3) -> Result<Mesh, Failure> {
    Ok(mesh.mapped(|x| (Vec3::from(x) + by).into())?)
}
