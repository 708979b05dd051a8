//! Several bodies in one mesh.

use crate::{Mesh, MeshError, RawMesh};

/// The region of generated meshes, whose name becomes that of the body.
const WHOLE: &str = "body";

impl Mesh {
    /// Bodies beside each other in one mesh, which share no node, under names of their own: of a body with the region "body" that becomes the region NAME, its other regions
    /// and its surfaces become "NAME.REGION" and "NAME.SURFACE".
    ///
    /// # Errors
    /// [`MeshError`] for bodies of different dimensions, and what [`Mesh::build`] refuses.
    pub fn together(name: &str, bodies: &[(&str, Mesh)]) -> Result<Mesh, MeshError> {
        let mut raw = RawMesh::new(name);
        let mut tag = 0;
        for (own, mesh) in bodies {
            let first = raw.points.len() as u32;
            raw.points.extend_from_slice(mesh.points());
            let moved = |nodes: &[u32]| nodes.iter().map(|node| first + node).collect::<Vec<_>>();
            let mut tags = vec![Vec::new(); mesh.cells()];
            for (region, cells) in mesh.regions() {
                tag += 1;
                let region = if region == WHOLE { (*own).to_owned() } else { format!("{own}.{region}") };
                raw.name_group(mesh.dim(), tag, region);
                cells.iter().for_each(|&cell| tags[cell as usize].push(tag));
            }
            for (cell, tags) in tags.iter().enumerate() {
                raw.push(mesh.cell(cell).kind, &moved(mesh.cell(cell).nodes), tags);
            }
            for (surface, facets) in mesh.surfaces() {
                tag += 1;
                raw.name_group(mesh.dim() - 1, tag, format!("{own}.{surface}"));
                for &facet in facets {
                    let (kind, nodes) = mesh.facet_nodes(facet);
                    raw.push(kind, &moved(&nodes), &[tag]);
                }
            }
        }
        Mesh::build(raw)
    }
}
