//! The inside of a chamber of a plane body, as triangles.

use nastic_mesh::{CellKind, Facet, Mesh, MeshError, RawMesh};

type P2 = [f64; 2];

/// The area within the wall, where the body is: every chain of its facets closed by a straight line.
pub(super) fn mesh(body: &Mesh, positions: &[[f64; 3]], wall: &[Facet]) -> Result<Mesh, MeshError> {
    let mut raw = RawMesh::default();
    for chain in chains(body, wall) {
        let corners: Vec<[f64; 3]> = chain.iter().map(|node| positions[*node as usize]).collect();
        let first = raw.points.len() as u32;
        for triangle in triangles(&corners.iter().map(|p| [p[0], p[1]]).collect::<Vec<P2>>()) {
            raw.push(CellKind::Tri3, &triangle.map(|k| first + k as u32), &[]);
        }
        raw.points.extend(corners);
    }
    Mesh::build(raw)
}

/// Nodes along the wall, from end to end or once around.
fn chains(body: &Mesh, wall: &[Facet]) -> Vec<Vec<u32>> {
    // the corners of an edge come first, its middle last
    let mut left: Vec<Vec<u32>> = wall.iter().map(|facet| body.facet_nodes(*facet).1).collect();
    left.iter_mut().filter(|edge| edge.len() == 3).for_each(|edge| edge.swap(1, 2));
    let mut out = Vec::new();
    while let Some(mut chain) = left.pop() {
        loop {
            let (first, last) = (chain[0], chain[chain.len() - 1]);
            let touches = |edge: &Vec<u32>| {
                let ends = [edge[0], edge[edge.len() - 1]];
                ends.contains(&last) || ends.contains(&first)
            };
            let Some(next) = left.iter().position(touches).filter(|_| first != last || chain.len() < 3) else { break };
            let mut edge = left.swap_remove(next);
            if edge[0] == first || edge[edge.len() - 1] == last {
                edge.reverse();
            }
            if edge[0] == last {
                chain.extend(&edge[1..]);
            } else {
                edge.pop();
                edge.append(&mut chain);
                chain = edge;
            }
        }
        if chain.len() > 1 && chain[0] == chain[chain.len() - 1] {
            chain.pop();
        }
        if chain.len() > 2 {
            out.push(chain);
        }
    }
    out
}

/// A simple polygon as triangles, by cutting off ears.
fn triangles(corners: &[P2]) -> Vec<[usize; 3]> {
    let area = |a: P2, b: P2, c: P2| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let twice: f64 = (1..corners.len() - 1).map(|k| area(corners[0], corners[k], corners[k + 1])).sum();
    let mut left: Vec<usize> = (0..corners.len()).collect();
    if twice < 0.0 {
        left.reverse();
    }
    let mut out = Vec::with_capacity(corners.len());
    while left.len() > 2 {
        let count = left.len();
        let around = |k: usize| [left[(k + count - 1) % count], left[k], left[(k + 1) % count]];
        let is_ear = |k: &usize| {
            let [a, b, c] = around(*k);
            let [p, q, r] = [corners[a], corners[b], corners[c]];
            let within = |at: P2| area(p, q, at) >= 0.0 && area(q, r, at) >= 0.0 && area(r, p, at) >= 0.0;
            area(p, q, r) > 0.0 && !left.iter().any(|other| ![a, b, c].contains(other) && within(corners[*other]))
        };
        // a polygon that crosses itself has no ear in the end: the corner is cut off all the same
        let ear = (0..count).find(is_ear).unwrap_or(0);
        let [a, b, c] = around(ear);
        if area(corners[a], corners[b], corners[c]) != 0.0 {
            out.push([a, b, c]);
        }
        left.remove(ear);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 3 x 3 cells without the middle one, second order on demand.
    fn frame(kind: CellKind) -> Mesh {
        let order = kind.order();
        let side = 3 * order + 1;
        let mut raw = RawMesh::default();
        let at = |k: usize| k as f64 / order as f64;
        raw.points = (0..side * side).map(|k| [at(k % side), at(k / side), 0.0]).collect();
        for cell in (0..9).filter(|cell| *cell != 4) {
            let corner = [cell % 3 * order, cell / 3 * order];
            let node = |xi: &[f64; 3]| {
                let [i, j] = [0, 1].map(|k| corner[k] + ((xi[k] + 1.0) * 0.5 * order as f64).round() as usize);
                (j * side + i) as u32
            };
            let nodes: Vec<u32> = kind.reference_nodes().iter().map(node).collect();
            raw.push(kind, &nodes, &[]);
        }
        Mesh::build(raw).unwrap()
    }

    #[test]
    fn the_area_within_the_wall_is_filled() {
        for kind in [CellKind::Quad4, CellKind::Quad9] {
            let body = frame(kind);
            // the wall is displaced, and no longer convex
            let moved: Vec<[f64; 3]> =
                body.points().iter().map(|p| [p[0], p[1] + 0.8 * (p[0] - 1.5).abs(), 0.0]).collect();
            let inner = |facet: &&Facet| {
                body.facet_nodes(**facet).1.iter().all(|node| {
                    let p = body.points()[*node as usize];
                    (1.0..=2.0).contains(&p[0]) && (1.0..=2.0).contains(&p[1])
                })
            };
            let wall: Vec<Facet> = body.boundary().iter().filter(inner).copied().collect();
            assert_eq!(wall.len(), 4);
            for (part, area) in [(&wall[..], 1.0), (&wall[..2], f64::NAN)] {
                let mesh = mesh(&body, &moved, part).unwrap();
                let sum: f64 = (0..mesh.cells())
                    .map(|cell| {
                        let [a, b, c] = [0, 1, 2].map(|k| mesh.points()[mesh.cell(cell).nodes[k] as usize]);
                        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
                    })
                    .sum();
                assert!(area.is_nan() || (sum - area).abs() < 1e-12, "{kind}: {sum}");
            }
        }
    }
}
