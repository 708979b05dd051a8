//! [`Transfer`]: fields of one mesh on another one of the same body, or of a part of it.

use nastic_mesh::{Located, Mesh, MeshError, NamedArray, Snapshot};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Finds points of a new mesh in the cells of the old one.
#[derive(Debug)]
pub struct Transfer<'a> {
    old: &'a Mesh,
    new: Arc<Mesh>,
    size: f64,
    /// Cells of the old mesh by the cubes that their boxes touch.
    cubes: BTreeMap<[i64; 3], Vec<u32>>,
}

impl<'a> Transfer<'a> {
    /// From a mesh to another.
    #[must_use]
    pub fn new(old: &'a Mesh, new: Arc<Mesh>) -> Self {
        let boxes: Vec<[[f64; 3]; 2]> = (0..old.cells()).map(|cell| bounds(old, cell)).collect();
        let longest = |[low, high]: &[[f64; 3]; 2]| (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let size = boxes.iter().map(longest).fold(f64::MIN_POSITIVE, f64::max);
        let mut cubes: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
        for (cell, [low, high]) in boxes.iter().enumerate() {
            let [from, to] = [low, high].map(|x| cube(*x, size));
            for x in from[0]..=to[0] {
                for y in from[1]..=to[1] {
                    (from[2]..=to[2]).for_each(|z| cubes.entry([x, y, z]).or_default().push(cell as u32));
                }
            }
        }
        Transfer { old, new, size, cubes }
    }

    /// The cell of the old mesh at a point and its shape functions; where the new outline lies outside by rounding, the nearest node and a cell of it.
    fn locate(&self, point: [f64; 3]) -> Option<Located> {
        let own = cube(point, self.size);
        let found = self
            .cubes
            .get(&own)
            .and_then(|cells| cells.iter().find_map(|cell| self.old.locate_in(*cell as usize, point)));
        found.or_else(|| {
            let near = (0..27).flat_map(|k| {
                let at = [0, 1, 2].map(|i| own[i] + (k / [1, 3, 9][i] % 3) - 1);
                self.cubes.get(&at).into_iter().flatten()
            });
            let square = |node: u32| {
                let x = self.old.points()[node as usize];
                (0..3).map(|k| (x[k] - point[k]).powi(2)).sum::<f64>()
            };
            let nodes = near.flat_map(|cell| self.old.cell(*cell as usize).nodes.iter().map(|node| (*cell, *node)));
            let nearest = nodes.min_by(|a, b| square(a.1).total_cmp(&square(b.1)));
            nearest.map(|(cell, node)| Located { cell: cell as usize, weights: vec![(node, 1.0)] })
        })
    }

    /// Values by cell at the centres of the new cells.
    ///
    /// # Errors
    /// [`MeshError::OutsideBody`].
    pub fn cells(&self, values: &[f64], components: usize) -> Result<Vec<f64>, MeshError> {
        let mut out = Vec::with_capacity(self.new.cells() * components);
        for cell in 0..self.new.cells() {
            let found = self.found(self.new.cell_centre(cell))?;
            out.extend_from_slice(&values[found.cell * components..][..components]);
        }
        Ok(out)
    }

    /// Values by node at the new nodes.
    ///
    /// # Errors
    /// [`MeshError::OutsideBody`].
    pub fn nodes(&self, values: &[f64], components: usize) -> Result<Vec<f64>, MeshError> {
        let mut out = Vec::with_capacity(self.new.points().len() * components);
        for point in self.new.points() {
            let found = self.found(*point)?;
            let of = |c: usize| {
                found.weights.iter().map(|(node, w)| w * values[*node as usize * components + c]).sum::<f64>()
            };
            out.extend((0..components).map(of));
        }
        Ok(out)
    }

    /// An array of a file on the old mesh, under another name beside those of a snapshot of the new one.
    ///
    /// # Errors
    /// [`MeshError::OutsideBody`].
    pub fn add(&self, out: Snapshot, name: &str, array: &NamedArray, by_node: bool) -> Result<Snapshot, MeshError> {
        let n = array.components;
        match by_node {
            true => out.with_points(name, n, self.nodes(&array.values, n)?),
            false => out.with_cells(name, n, self.cells(&array.values, n)?),
        }
    }

    fn found(&self, point: [f64; 3]) -> Result<Located, MeshError> {
        match self.locate(point) {
            Some(found) => Ok(found),
            None => self.old.locate_inside(point),
        }
    }
}

fn cube(x: [f64; 3], size: f64) -> [i64; 3] {
    x.map(|x| (x / size).floor() as i64)
}

fn bounds(mesh: &Mesh, cell: usize) -> [[f64; 3]; 2] {
    let nodes = mesh.cell(cell).nodes.iter().map(|node| mesh.points()[*node as usize]);
    nodes.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], x| {
        [[0, 1, 2].map(|k| low[k].min(x[k])), [0, 1, 2].map(|k| high[k].max(x[k]))]
    })
}
