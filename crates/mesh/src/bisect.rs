//! Division of a mesh into parts of as many cells.

use crate::{CellBlock, Mesh, MeshError, geometry};

impl Mesh {
    /// The part of every cell, by recursive bisection: the cells in order of their mean nodes along the longest axis of the box around these are cut
    /// where the shares of `floor(p / 2)` and `ceil(p / 2)` parts meet, and so on. Of cells with equal places the lower number comes first.
    ///
    /// Source: M. J. Berger, S. H. Bokhari, IEEE Trans. Comput. C-36 (1987), 570-580.
    ///
    /// # Errors
    /// [`MeshError::Part`]: no parts, or more than there are cells.
    pub fn bisected(&self, parts: usize) -> Result<Vec<u32>, MeshError> {
        if parts == 0 || parts > self.cells() {
            let why = format!("{parts} parts of {} cells; take 1 to {0}", self.cells());
            return Err(MeshError::Part { mesh: self.name.clone(), part: 0, why });
        }
        let middle = |nodes: &[u32]| {
            let sum = |k: usize| nodes.iter().map(|&node| self.points[node as usize][k]).sum::<f64>();
            [0, 1, 2].map(|k| sum(k) / nodes.len() as f64)
        };
        let middles: Vec<[f64; 3]> = self.blocks.iter().flat_map(CellBlock::iter).map(middle).collect();
        let mut owners = vec![0; middles.len()];
        let mut cells: Vec<u32> = (0..middles.len() as u32).collect();
        bisect(&middles, &mut cells, 0, parts, &mut owners);
        Ok(owners)
    }
}

/// Assigns cells to a number of parts from `first` on.
fn bisect(middles: &[[f64; 3]], cells: &mut [u32], first: usize, parts: usize, owners: &mut [u32]) {
    if parts == 1 {
        cells.iter().for_each(|&cell| owners[cell as usize] = first as u32);
        return;
    }
    let (low, high) = geometry::bounds(cells.iter().map(|&cell| &middles[cell as usize]));
    let size = geometry::minus(&high, &low);
    let axis = (1..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
    let along = |cell: u32| middles[cell as usize][axis];
    cells.sort_unstable_by(|&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
    let half = parts / 2;
    let (left, right) = cells.split_at_mut(cells.len() * half / parts);
    bisect(middles, left, first, half, owners);
    bisect(middles, right, first + half, parts - half, owners);
}
