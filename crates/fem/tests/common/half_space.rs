//! [`HalfSpace`]: a piece of an elastic half-space, fine where it is touched and coarser outwards, for contacts in closed form.

use nastic_mesh::{CellKind, Mesh, MeshError, RawMesh};
use std::collections::BTreeMap;

/// A grid point of the inner box, and the shell on which its image lies.
type Key = ([i32; 3], i32);

/// Corners of a unit cell in the order of `Hex8`; the first four, in the plane, in that of `Quad4`.
const CORNERS: [[i32; 3]; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// What lies below the height 0 along the last axis: a box of `cells` equal cells (squares, cubes) from the origin to the distance `fine`
/// along every axis, and shells around it that grow in proportion to their distance, to `far`. Surfaces `top` and `far`, and the planes of symmetry
/// `x-` (unless `whole`) and, in space, `y-`.
#[derive(Debug, Clone, Copy)]
pub struct HalfSpace {
    /// 2 or 3.
    pub dim: usize,
    /// Both sides of the plane x = 0, else the one of positive x.
    pub whole: bool,
    pub cells: usize,
    pub fine: f64,
    pub far: f64,
}

impl HalfSpace {
    /// The side of a cell of the inner box.
    pub fn cell(&self) -> f64 {
        self.fine / self.cells as f64
    }

    /// Shells, each about twice as thick as its cells are wide.
    fn shells(&self) -> i32 {
        (0.5 * self.cells as f64 * (self.far / self.fine).ln()).ceil() as i32
    }

    /// Grid points of the inner box along an axis.
    fn range(&self, axis: usize) -> (i32, i32) {
        let n = self.cells as i32;
        match axis {
            _ if axis >= self.dim => (0, 1),
            _ if axis + 1 == self.dim => (-n, 0),
            0 if self.whole => (-n, n),
            _ => (0, n),
        }
    }

    /// Sides of the inner box on which shells lie: axis, and the grid point there.
    fn sides(&self) -> Vec<(usize, i32)> {
        let along = |axis: usize| {
            let (low, high) = self.range(axis);
            [low, high].into_iter().filter(|&side| side != 0).map(move |side| (axis, side))
        };
        (0..self.dim).flat_map(along).collect()
    }

    fn position(&self, (point, shell): Key) -> [f64; 3] {
        let radius = self.fine * (self.far / self.fine).powf(f64::from(shell) / f64::from(self.shells()));
        point.map(|i| radius * f64::from(i) / self.cells as f64)
    }

    /// Corners of all cells.
    fn cells_of(&self) -> Vec<Vec<Key>> {
        let (sides, corners) = (self.sides(), &CORNERS[..1 << self.dim]);
        let ranges: [(i32, i32); 3] = std::array::from_fn(|axis| self.range(axis));
        let along = |axis: usize| ranges[axis].0..ranges[axis].1;
        let mut cells = Vec::new();
        for low in along(2).flat_map(|k| along(1).flat_map(move |j| along(0).map(move |i| [i, j, k]))) {
            let at = |corner: &[i32; 3]| -> [i32; 3] { std::array::from_fn(|a| low[a] + corner[a]) };
            cells.push(corners.iter().map(|corner| (at(corner), 0)).collect());
            for &(axis, side) in
                sides.iter().filter(|&&(axis, side)| low[axis] == if side > 0 { side - 1 } else { side })
            {
                for shell in 0..self.shells() {
                    let outwards = |corner: &[i32; 3]| {
                        let mut point = at(corner);
                        point[axis] = side;
                        (point, shell + if side > 0 { corner[axis] } else { 1 - corner[axis] })
                    };
                    cells.push(corners.iter().map(outwards).collect());
                }
            }
        }
        cells
    }

    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        let kind = if self.dim == 3 { CellKind::Hex8 } else { CellKind::Quad4 };
        let (last, up) = (self.shells(), self.dim - 1);
        type On = dyn Fn(&Key) -> bool;
        let mut surfaces: Vec<(&str, Box<On>)> =
            vec![("top", Box::new(move |key| key.0[up] == 0)), ("far", Box::new(move |key| key.1 == last))];
        if !self.whole {
            surfaces.push(("x-", Box::new(|key| key.0[0] == 0)));
        }
        if self.dim == 3 {
            surfaces.push(("y-", Box::new(|key| key.0[1] == 0)));
        }
        let mut raw = RawMesh::new("half-space");
        raw.name_group(self.dim, 1, "body");
        (1..).zip(&surfaces).for_each(|(tag, (name, _))| raw.name_group(up, tag, *name));
        let mut known: BTreeMap<Key, u32> = BTreeMap::new();
        for cell in self.cells_of() {
            let mut node = |key: &Key| {
                *known.entry(*key).or_insert_with(|| {
                    raw.points.push(self.position(*key));
                    raw.points.len() as u32 - 1
                })
            };
            let nodes: Vec<u32> = cell.iter().map(&mut node).collect();
            raw.push(kind, &nodes, &[1]);
            for (face, corners) in kind.faces() {
                for (tag, (_, on)) in (1..).zip(&surfaces) {
                    if corners.iter().all(|&corner| on(&cell[corner])) {
                        let nodes: Vec<u32> = corners.iter().map(|&corner| nodes[corner]).collect();
                        raw.push(*face, &nodes, &[tag]);
                    }
                }
            }
        }
        Mesh::build(raw)
    }
}
