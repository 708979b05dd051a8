//! Boxes and rectangles of any kind of cell, on a regular grid.

use crate::{CellKind, Domain, Mesh, MeshError, RawMesh};

/// Grid points of a generated mesh; a request for more is refused as a mistake.
const MAX_GRID_POINTS: usize = 1 << 26;

/// Corners of the unit cube or square in the order of `Hex8` and `Quad4`, as steps along the axes.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The six ways from (0,0,0) to (1,1,1) along the edges of a cube, by axes.
const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// The box [0, size] of `cells` grid cells, x fastest. Region "body", surfaces "x-", "x+", "y-", "y+", "z-", "z+".
/// Tetrahedra: each grid cell is split in six along its diagonal (0,0,0)-(1,1,1) (Kuhn).
///
/// # Errors
/// [`MeshError::Generate`] for a kind that is not a volume cell, sizes that are not positive, no or too many cells.
pub fn box_mesh(size: [f64; 3], cells: [usize; 3], kind: CellKind) -> Result<Mesh, MeshError> {
    let why = |why| MeshError::Generate { what: "a box", why };
    if kind.dim() != 3 {
        return Err(why(format!("{kind} is not a volume element; take {}", names(3))));
    }
    Mesh::build(Grid::new(&size, &cells, kind).map_err(why)?.raw("box"))
}

/// The plane rectangle [0, size] of `cells` grid cells, x fastest. Region "body", surfaces "x-", "x+", "y-", "y+".
/// Triangles: each grid cell is split along its diagonal (0,0)-(1,1).
///
/// # Errors
/// [`MeshError::Generate`] for a kind that is not a plane cell, sizes that are not positive, no or too many cells.
pub fn rectangle(size: [f64; 2], cells: [usize; 2], kind: CellKind) -> Result<Mesh, MeshError> {
    let why = |why| MeshError::Generate { what: "a rectangle", why };
    if kind.dim() != 2 {
        return Err(why(format!("{kind} is not a plane element; take {}", names(2))));
    }
    Mesh::build(Grid::new(&size, &cells, kind).map_err(why)?.raw("rectangle"))
}

/// The kinds of a dimension.
fn names(dim: usize) -> String {
    let names: Vec<&str> = CellKind::ALL.iter().filter(|kind| kind.dim() == dim).map(|kind| kind.name()).collect();
    names.join(" or ")
}

/// Grid points at spacing size / (cells * order); the corners of grid cells are those at multiples of the order.
struct Grid {
    kind: CellKind,
    size: [f64; 3],
    cells: [usize; 3],
    counts: [usize; 3],
    /// Grid steps from a grid cell's lowest corner to the nodes of each cell it is split into.
    template: Vec<Vec<[usize; 3]>>,
}

impl Grid {
    fn new(size: &[f64], cells: &[usize], kind: CellKind) -> Result<Grid, String> {
        let (dim, order) = (kind.dim(), kind.order());
        if let Some(bad) = size.iter().find(|s| !(s.is_finite() && **s > 0.0)) {
            return Err(format!("its size {bad} is not a positive length"));
        }
        if cells.contains(&0) {
            return Err(format!("{cells:?} cells; at least one along each axis is needed"));
        }
        let points =
            cells.iter().try_fold(1usize, |product, n| n.checked_mul(order)?.checked_add(1)?.checked_mul(product));
        if points.is_none_or(|points| points > MAX_GRID_POINTS) {
            return Err(format!(
                "{cells:?} cells of {kind} need more than {MAX_GRID_POINTS} grid points; take fewer cells"
            ));
        }
        let along = |d: usize, value: usize| if d < dim { value } else { 1 };
        Ok(Grid {
            kind,
            size: std::array::from_fn(|d| size.get(d).copied().unwrap_or(0.0)),
            cells: std::array::from_fn(|d| along(d, cells.get(d).copied().unwrap_or(1))),
            counts: std::array::from_fn(|d| along(d, cells.get(d).map_or(1, |n| n * order + 1))),
            template: template(kind),
        })
    }

    fn raw(&self, name: &str) -> RawMesh {
        let mut raw = RawMesh::new(name);
        let dim = self.kind.dim();
        raw.points = each(self.counts).map(|step| self.position(step)).collect();
        raw.name_group(dim, 1, "body");
        for cell in each(self.cells) {
            for nodes in self.split(cell) {
                raw.push(self.kind, &nodes, &[1]);
            }
        }
        for (side, name) in ["x-", "x+", "y-", "y+", "z-", "z+"].into_iter().enumerate().take(2 * dim) {
            raw.name_group(dim - 1, side as i32 + 1, name);
            self.add_side(&mut raw, side);
        }
        self.drop_unused(raw)
    }

    fn position(&self, step: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|d| {
            let intervals = (self.counts[d] - 1).max(1);
            self.size[d] * (step[d] as f64 / intervals as f64)
        })
    }

    fn point(&self, step: [usize; 3]) -> u32 {
        (step[0] + self.counts[0] * (step[1] + self.counts[1] * step[2])) as u32
    }

    /// Nodes of the cells one grid cell is made of.
    fn split(&self, cell: [usize; 3]) -> impl Iterator<Item = Vec<u32>> {
        let base = cell.map(|c| c * self.kind.order());
        let node = move |step: &[usize; 3]| self.point(std::array::from_fn(|d| base[d] + step[d]));
        self.template.iter().map(move |steps| steps.iter().map(node).collect())
    }

    /// Surface elements of one side: faces of its cells whose nodes all lie there.
    fn add_side(&self, raw: &mut RawMesh, side: usize) {
        let (axis, tag) = (side / 2, side as i32 + 1);
        let (last, layer) = if side.is_multiple_of(2) { (0, 0) } else { (self.counts[axis] - 1, self.cells[axis] - 1) };
        let mut range = self.cells;
        range[axis] = 1;
        for mut cell in each(range) {
            cell[axis] = layer;
            for nodes in self.split(cell) {
                for (kind, local) in self.kind.faces() {
                    let face: Vec<u32> = local.iter().map(|&a| nodes[a]).collect();
                    if face.iter().all(|&point| self.step(point)[axis] == last) {
                        raw.push(*kind, &face, &[tag]);
                    }
                }
            }
        }
    }

    fn step(&self, point: u32) -> [usize; 3] {
        let point = point as usize;
        [point % self.counts[0], point / self.counts[0] % self.counts[1], point / (self.counts[0] * self.counts[1])]
    }

    /// Serendipity cells leave grid points out; nobody needs a note about that.
    fn drop_unused(&self, mut raw: RawMesh) -> RawMesh {
        let mut number = vec![u32::MAX; raw.points.len()];
        raw.blocks.iter().flat_map(|block| &block.nodes).for_each(|&node| number[node as usize] = 0);
        for (next, slot) in (0..).zip(number.iter_mut().filter(|slot| **slot == 0)) {
            *slot = next;
        }
        let mut old = 0..;
        raw.points.retain(|_| old.next().is_some_and(|k: usize| number[k] != u32::MAX));
        raw.blocks.iter_mut().flat_map(|block| &mut block.nodes).for_each(|node| *node = number[*node as usize]);
        raw
    }
}

fn template(kind: CellKind) -> Vec<Vec<[usize; 3]>> {
    let corners = match (kind.domain(), kind.dim()) {
        (Domain::Box, _) => vec![CORNERS[..kind.corners()].to_vec()],
        (Domain::Simplex, 2) => vec![vec![[0, 0, 0], [1, 0, 0], [1, 1, 0]], vec![[0, 0, 0], [1, 1, 0], [0, 1, 0]]],
        (Domain::Simplex, _) => PATHS.iter().map(kuhn).collect(),
    };
    corners.iter().map(|corners| steps(kind, corners)).collect()
}

/// All nodes of a cell: its reference nodes, mapped by the first-order shapes, fall on grid points.
fn steps(kind: CellKind, corners: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let corners: Vec<[f64; 3]> = corners.iter().map(|corner| corner.map(|c| (c * kind.order()) as f64)).collect();
    let step = |xi| kind.corner_kind().map(&corners, xi).map(|x| x.round() as usize);
    kind.reference_nodes().iter().map(step).collect()
}

/// Corners of the Kuhn simplex of one path; odd paths wind the other way, so two corners change places.
fn kuhn(path: &[usize; 3]) -> Vec<[usize; 3]> {
    let mut corner = [0; 3];
    let mut corners = vec![corner];
    for &axis in path {
        corner[axis] = 1;
        corners.push(corner);
    }
    let inversions = [(0, 1), (0, 2), (1, 2)].iter().filter(|(i, j)| path[*i] > path[*j]).count();
    if inversions % 2 == 1 {
        corners.swap(1, 2);
    }
    corners
}

/// All steps below `counts`, the first axis fastest.
fn each(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = counts;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}
