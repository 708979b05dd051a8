//! What the tests share: meshes of every kind, laws of the catalogue, displacements prescribed node by node.

#![allow(dead_code)] // every test takes what it needs

pub mod beam;
pub mod block;
pub mod dielectric;
pub mod driven_motion;
pub mod half_space;
pub mod homogeneous;
pub mod indentation;
pub mod motion;
pub mod own_contributions;
pub mod parts;
pub mod poisson;
pub mod ranks;
pub mod rubber;
pub mod sheared;
pub mod shells;

use nastic_energy::EnergyTerm;
use nastic_energy::catalogue;
use nastic_fem::{Controls, Solid};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh, rectangle};
use nastic_tensor::Vec3;
use std::sync::Arc;

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Every kind of cell a body can be made of.
pub fn kinds() -> impl Iterator<Item = CellKind> {
    CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1)
}

/// Every passive law of the catalogue that is a material by itself, with its example coefficients, by name.
pub fn laws() -> Outcome<Vec<(&'static str, Arc<dyn EnergyTerm>)>> {
    catalogue::materials()
        .iter()
        .filter(|row| !row.reinforcing)
        .map(|row| Ok((row.name, row.build(&row.examples()[0])?)))
        .collect()
}

/// The box (rectangle, for plane kinds) `[0, size]` of `cells` grid cells.
pub fn regular(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Outcome<Mesh> {
    Ok(match kind.dim() {
        2 => rectangle([size[0], size[1]], [cells[0], cells[1]], kind)?,
        _ => box_mesh(size, cells, kind)?,
    })
}

/// The unit cube or square of `cells` grid cells along each axis.
pub fn unit(kind: CellKind, cells: usize) -> Outcome<Mesh> {
    regular(kind, [1.0; 3], [cells; 3])
}

/// Nodes on the boundary.
pub fn boundary_nodes(mesh: &Mesh) -> Vec<u32> {
    mesh.nodes_of_facets(mesh.boundary())
}

/// Nodes at a position, to rounding.
pub fn node_at(mesh: &Mesh, at: [f64; 3]) -> Option<usize> {
    let near = |x: &[f64; 3]| (0..3).all(|k| (x[k] - at[k]).abs() <= 1e-9 * mesh.diagonal());
    mesh.points().iter().position(near)
}

/// The same unit-sized grid with inner corners moved by up to `amount` of a grid step, the sides of its cells straight.
pub fn distorted(mesh: Mesh, amount: f64) -> Outcome<Mesh> {
    let mut points = mesh.points().to_vec();
    let inner = inner_mask(&mesh);
    for node in mesh.corner_nodes() {
        move_node(&mut points, node as usize, &inner, amount, mesh.dim());
    }
    for block in mesh.blocks() {
        let corner_kind = block.kind.corner_kind();
        let mut shapes = vec![0.0; corner_kind.nodes()];
        for nodes in block.iter() {
            for (&node, xi) in nodes.iter().zip(block.kind.reference_nodes()).skip(corner_kind.nodes()) {
                corner_kind.shapes(xi, &mut shapes);
                points[node as usize] = [0, 1, 2]
                    .map(|k| nodes.iter().zip(&shapes).map(|(&corner, n)| n * points[corner as usize][k]).sum::<f64>());
            }
        }
    }
    Ok(mesh.with_points(points)?)
}

/// The same mesh with all its inner nodes moved by up to `amount`: the sides of second-order cells become curved.
pub fn curved(mesh: Mesh, amount: f64) -> Outcome<Mesh> {
    let mut points = mesh.points().to_vec();
    let inner = inner_mask(&mesh);
    for node in 0..points.len() {
        move_node(&mut points, node, &inner, amount, mesh.dim());
    }
    Ok(mesh.with_points(points)?)
}

fn inner_mask(mesh: &Mesh) -> Vec<bool> {
    let mut inner = vec![true; mesh.points().len()];
    boundary_nodes(mesh).iter().for_each(|&node| inner[node as usize] = false);
    inner
}

fn move_node(points: &mut [[f64; 3]], node: usize, inner: &[bool], amount: f64, dim: usize) {
    if inner[node] {
        for (k, x) in points[node].iter_mut().enumerate().take(dim) {
            *x += amount * noise(3 * node + k);
        }
    }
}

/// Numbers in [-1, 1) without a pattern, the same on every machine (splitmix64).
pub fn noise(n: usize) -> f64 {
    let mut z = (n as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// The same mesh where each of the nodes is a node set of its own, for [`prescribe`].
pub fn with_node_sets(mesh: &Mesh, nodes: &[u32]) -> Outcome<Mesh> {
    let mut raw = RawMesh::new(mesh.name());
    raw.points = mesh.points().to_vec();
    for block in mesh.blocks() {
        block.iter().for_each(|cell| raw.push(block.kind, cell, &[1]));
    }
    raw.name_group(mesh.dim(), 1, "body");
    for (tag, (name, facets)) in (1..).zip(mesh.surfaces()) {
        raw.name_group(mesh.dim() - 1, tag, name);
        for &facet in facets {
            let (kind, nodes) = mesh.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    for &node in nodes {
        let tag = node as i32 + 1;
        raw.name_group(0, tag, set_name(node));
        raw.vertices.push((node, tag));
    }
    let mut wanted = Mesh::build(raw)?;
    // where a tidier numbering were to be introduced, the names below would mean other nodes
    assert_eq!(wanted.points(), mesh.points());
    wanted = wanted.named(mesh.name());
    Ok(wanted)
}

/// Displaces nodes of [`with_node_sets`] by a function of their position.
pub fn prescribe(mut solid: Solid, nodes: &[u32], u: impl Fn(Vec3) -> Vec3) -> Outcome<Solid> {
    for &node in nodes {
        let at = u(Vec3::from(solid.mesh().points()[node as usize]));
        let z = (solid.mesh().dim() == 3).then_some(at.z);
        solid = solid.displace(set_name(node), [Some(at.x), Some(at.y), z])?;
    }
    Ok(solid)
}

pub fn set_name(node: u32) -> String {
    format!("node {node}")
}

/// Flat nodal values of a displacement field.
pub fn nodal(mesh: &Mesh, u: impl Fn(Vec3) -> Vec3) -> Vec<f64> {
    let dim = mesh.dim();
    mesh.points().iter().flat_map(|&x| u(Vec3::from(x)).as_slice()[..dim].to_vec()).collect()
}

/// Largest absolute difference.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest absolute value.
pub fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, a| m.max(a.abs()))
}

/// Some cells of a mesh, moved, with surfaces of those outer facets whose centre, before the move, fulfils a condition.
pub fn cut(
    full: &Mesh,
    keep: impl Fn(Vec3) -> bool,
    moved: impl Fn(Vec3) -> Vec3,
    surfaces: &[(&str, &dyn Fn(Vec3) -> bool)],
) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("cut");
    raw.points = full.points().iter().map(|x| moved(Vec3::from(*x)).into()).collect();
    raw.name_group(full.dim(), 1, "body");
    let centre = |nodes: &[u32]| {
        nodes.iter().map(|&node| Vec3::from(full.points()[node as usize])).sum::<Vec3>() / nodes.len() as f64
    };
    let kept: Vec<_> = (0..full.cells()).map(|c| full.cell(c)).filter(|cell| keep(centre(cell.nodes))).collect();
    let mut faces: std::collections::BTreeMap<Vec<u32>, (CellKind, Vec<u32>, usize)> = Default::default();
    for cell in kept {
        raw.push(cell.kind, cell.nodes, &[1]);
        for (kind, local) in cell.kind.faces() {
            let nodes: Vec<u32> = local.iter().map(|&a| cell.nodes[a]).collect();
            let mut key = nodes.clone();
            key.sort_unstable();
            faces.entry(key).or_insert((*kind, nodes, 0)).2 += 1;
        }
    }
    for (tag, (name, on)) in (2..).zip(surfaces) {
        raw.name_group(full.dim() - 1, tag, *name);
        for (kind, nodes, _) in faces.values().filter(|(_, nodes, count)| *count == 1 && on(centre(nodes))) {
            raw.push(*kind, nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}

/// Tension that grows to m at the upper side and bends a cantilever of a height of 0.2.
pub fn bending(m: f64, solid: &Solid) -> Controls {
    let mut controls = solid.controls();
    let last = solid.mesh().dim() - 1;
    let at = solid.discretization().points().positions(solid.mesh(), None);
    controls.values_mut(0).iter_mut().zip(&at).for_each(|(own, x)| *own = m * x[last] / 0.2);
    controls
}
