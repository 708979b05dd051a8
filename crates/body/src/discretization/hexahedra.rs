//! [`Hexahedra`]: 27-node hexahedra in batches, for products by sum factorisation.

use crate::discretization::quadrature_points::QuadraturePoints;
use crate::kernels::hexahedra::{CELLS, CORNERS, Line, NODES, ROWS};
use nastic_mesh::{CellKind, Rule};
use std::array::from_fn;

/// How close coordinates of nodes or points are that are the same.
const SAME: f64 = 1e-12;

/// The cells of a mesh of 27-node hexahedra, sixteen at a time, nodes and points on grids of 3 x 3 x 3, the first direction
/// running fastest.
#[derive(Debug)]
pub struct Hexahedra {
    line: Line,
    /// `[batch][node][cell]`; cells that are not there have node 0.
    nodes: Vec<u32>,
    /// By cell, the first direction running fastest.
    corners: Vec<[u32; CORNERS]>,
    /// By node of the mesh where its places begin.
    starts: Vec<u32>,
    /// Where the rows of a node stand among those of the cells, in their order.
    places: Vec<u32>,
    /// Place on the grid by quadrature point.
    points: [usize; NODES],
}

impl Hexahedra {
    /// `None` unless all cells are such, with the rule of three points per direction.
    pub fn new(points: &QuadraturePoints, mesh_nodes: usize) -> Option<Self> {
        let [part] = points.parts.as_slice() else { return None };
        if part.kind != CellKind::Hex27 || part.table.points != NODES {
            return None;
        }
        let (of_nodes, node_places) = grid(part.kind.reference_nodes())?;
        let rule: &Rule = part.kind.rule();
        let (of_points, point_places) = grid(&rule.points)?;
        let batches = part.cells.len().div_ceil(CELLS);
        u32::try_from(batches * ROWS).ok()?;
        let mut nodes = vec![0; batches * NODES * CELLS];
        let mut places: Vec<Vec<u32>> = vec![Vec::new(); mesh_nodes];
        for c in 0..part.cells.len() {
            let (batch, lane) = (c / CELLS, c % CELLS);
            for (&node, place) in part.nodes_of(c).iter().zip(node_places) {
                nodes[(batch * NODES + place) * CELLS + lane] = node;
                places[node as usize].push((batch * ROWS + 3 * place * CELLS + lane) as u32);
            }
        }
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(places.iter().map(|own| {
            end += own.len() as u32;
            end
        }));
        let corner = |c: usize, a: usize| {
            let place = 2 * (a & 1) + 6 * (a >> 1 & 1) + 18 * (a >> 2);
            nodes[(c / CELLS * NODES + place) * CELLS + c % CELLS]
        };
        let corners = (0..part.cells.len()).map(|c| from_fn(|a| corner(c, a))).collect();
        let line = line(&of_points, &of_nodes);
        Some(Hexahedra { line, nodes, corners, starts, places: places.concat(), points: point_places })
    }

    /// Shapes and derivatives in one direction.
    pub fn line(&self) -> &Line {
        &self.line
    }

    /// Number of batches.
    pub fn batches(&self) -> usize {
        self.nodes.len() / (NODES * CELLS)
    }

    /// The nodes of a batch, `[node][cell]`.
    pub fn nodes_of(&self, batch: usize) -> &[u32] {
        &self.nodes[batch * NODES * CELLS..][..NODES * CELLS]
    }

    /// The nodes at the corners of every cell, the first direction running fastest.
    pub fn corners(&self) -> &[[u32; CORNERS]] {
        &self.corners
    }

    /// Place on the grid of the q-th quadrature point.
    pub fn point(&self, q: usize) -> usize {
        self.points[q]
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.corners.len()
    }

    /// Where the first components of a node stand among the rows of all batches; the others follow [`CELLS`] further on.
    pub fn places(&self, node: usize) -> &[u32] {
        &self.places[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}

/// The three coordinates of a grid of points, ascending, and the place of every point; `None` of other points.
fn grid(points: &[[f64; 3]]) -> Option<([f64; 3], [usize; NODES])> {
    let mut line: Vec<f64> = points.iter().map(|x| x[0]).collect();
    line.sort_by(f64::total_cmp);
    line.dedup_by(|a, b| (*a - *b).abs() < SAME);
    let line: [f64; 3] = line.try_into().ok()?;
    let index = |x: f64| line.iter().position(|known| (known - x).abs() < SAME);
    let place = |x: &[f64; 3]| Some(index(x[0])? + 3 * index(x[1])? + 9 * index(x[2])?);
    let places: Vec<usize> = points.iter().map(place).collect::<Option<_>>()?;
    let mut sorted = places.clone();
    sorted.sort_unstable();
    let complete = sorted.iter().enumerate().all(|(k, place)| k == *place);
    Some((line, places.try_into().ok().filter(|_| complete)?))
}

/// Lagrange's polynomials through the nodes of a line, and through its two ends, at its points.
fn line(points: &[f64; 3], nodes: &[f64; 3]) -> Line {
    let others = |n: usize| [nodes[(n + 1) % 3], nodes[(n + 2) % 3]];
    let scale = |n: usize| others(n).iter().map(|other| nodes[n] - other).product::<f64>();
    let shape = |x: f64, n: usize| others(n).iter().map(|other| x - other).product::<f64>() / scale(n);
    let derivative = |x: f64, n: usize| others(n).iter().map(|other| x - other).sum::<f64>() / scale(n);
    let length = nodes[2] - nodes[0];
    Line {
        shapes: from_fn(|q| from_fn(|n| shape(points[q], n))),
        derivatives: from_fn(|q| from_fn(|n| derivative(points[q], n))),
        ends: from_fn(|q| [(nodes[2] - points[q]) / length, (points[q] - nodes[0]) / length]),
        end_derivatives: [-1.0 / length, 1.0 / length],
    }
}
