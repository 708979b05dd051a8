//! What a viewer is shown of a problem at one control.

use crate::error::ControlError;
use crate::evaluated::Evaluated;
use crate::layout::ControlBlock;
use crate::map::Space;
use crate::reduced::Reduced;
use nastic_fem::{CellFields, Controls};
use nastic_mesh::{Mesh, Snapshot};

impl Reduced {
    /// The state with everything worth looking at, for VTU files and pictures.
    ///
    /// Point data: `displacement`, `adjoint` (once the derivative was asked for), nodal controls under their names and
    /// `gradient_NAME` (where a derivative is given; the Riesz image in the problem's product). Cell data, averages over
    /// the reference volume: every control and gradient, `J`, `P` and `cauchy_stress` (row by row), `energy` (stored by the
    /// passive material), `fiber`, `direction_NAME` of each actuation that has one, `region` (index of the first region
    /// in alphabetical order, -1 for none), `B_r` and `B_a` where there are magnets. Components are always three for
    /// vectors and nine for tensors.
    ///
    /// # Errors
    /// A derivative of the wrong length, a body turned inside out.
    pub fn snapshot(&self, point: &Evaluated, derivative: Option<&[f64]>) -> Result<Snapshot, ControlError> {
        let mesh = self.solid().mesh();
        let spatial = |u: &[f64]| vectors(u, mesh.dim());
        let mut shot = Snapshot::new(mesh.clone()).with_points("displacement", 3, spatial(&point.state.u))?;
        if let Some(lambda) = point.adjoint() {
            shot = shot.with_points("adjoint", 3, spatial(lambda))?;
        }
        shot = self.add_field(shot, "", &point.m)?;
        if let Some(derivative) = derivative {
            self.layout().check(derivative)?;
            shot = self.add_field(shot, "gradient_", &self.build_inner_product()?.riesz(derivative))?;
        }
        shot = self.add_magnets(shot, &point.state.controls)?;
        add_cell_fields(shot, self.solid().cell_fields(&point.state)?)?
            .with_cells("region", 1, region_numbers(mesh))
            .map_err(Into::into)
    }

    /// Adds a field of the control space, block by block, cell-wise and for nodal spaces nodal too.
    fn add_field(&self, mut shot: Snapshot, prefix: &str, m: &[f64]) -> Result<Snapshot, ControlError> {
        let disc = self.solid().discretization();
        let width = |block: &ControlBlock| if block.components == 2 { 3 } else { block.components };
        for block in self.layout().blocks() {
            let name = format!("{prefix}{}", block.name);
            let (components, wide) = (block.components, width(block));
            let mut at_points = vec![0.0; wide * block.map.points()];
            for c in 0..components {
                block.map.to_points(block.of(m), components, c, wide, c, &mut at_points);
            }
            if prefix.is_empty() {
                at_points.chunks_exact_mut(wide).for_each(|v| block.scale(&mut v[..components]));
            }
            shot = shot.with_cells(&name, wide, disc.cell_average(&at_points, wide))?;
            if block.map.space() == Space::Node {
                shot = shot.with_points(&name, wide, at_nodes(disc.mesh(), block, block.of(m), wide))?;
            }
        }
        Ok(shot)
    }

    /// Remanence and applied field of all magnets together, whether controlled or fixed: the means of each cell.
    fn add_magnets(&self, mut shot: Snapshot, controls: &Controls) -> Result<Snapshot, ControlError> {
        let disc = self.solid().discretization();
        for (name, slot) in [("B_r", "remanence.x"), ("B_a", "field.x")] {
            let mut total: Option<Vec<f64>> = None;
            for (k, attached) in self.solid().body().actuations().iter().enumerate() {
                let slots = attached.law.slots();
                let Some(first) = slots.iter().position(|s| s.name == slot) else { continue };
                let means = disc.cell_average(controls.values(k), slots.len());
                let own = means.chunks_exact(slots.len()).flat_map(|at| &at[first..first + 3]);
                let sum = total.get_or_insert_with(|| vec![0.0; 3 * self.solid().mesh().cells()]);
                sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            }
            if let Some(values) = total {
                shot = shot.with_cells(name, 3, values)?;
            }
        }
        Ok(shot)
    }
}

fn add_cell_fields(shot: Snapshot, fields: CellFields) -> Result<Snapshot, ControlError> {
    let mut shot = shot
        .with_cells("J", 1, fields.j)?
        .with_cells("P", 9, fields.piola)?
        .with_cells("cauchy_stress", 9, fields.cauchy)?
        .with_cells("energy", 1, fields.energy)?;
    if let Some(fiber) = fields.fiber {
        shot = shot.with_cells("fiber", 3, fiber)?;
    }
    for (name, values) in fields.directions {
        shot = shot.with_cells(&format!("direction_{name}"), 3, values)?;
    }
    Ok(shot)
}

/// A nodal field at every node: on corners as it is, between them by the corner shape functions.
fn at_nodes(mesh: &Mesh, block: &ControlBlock, m: &[f64], wide: usize) -> Vec<f64> {
    let mut unknown_of = vec![u32::MAX; mesh.points().len()];
    for (i, &node) in block.map.entities().iter().enumerate() {
        unknown_of[node as usize] = i as u32;
    }
    let mut out = vec![0.0; wide * mesh.points().len()];
    for cell in (0..mesh.cells()).map(|id| mesh.cell(id)) {
        let corners = &cell.nodes[..cell.kind.corners()];
        if corners.iter().any(|&node| unknown_of[node as usize] == u32::MAX) {
            continue;
        }
        let mut shapes = vec![0.0; corners.len()];
        for (node, xi) in cell.nodes.iter().zip(cell.kind.reference_nodes()) {
            cell.kind.corner_kind().shapes(xi, &mut shapes);
            for c in 0..block.components {
                let value = |(&corner, shape): (&u32, &f64)| {
                    shape * m[unknown_of[corner as usize] as usize * block.components + c]
                };
                out[wide * *node as usize + c] = corners.iter().zip(&shapes).map(value).sum();
            }
        }
    }
    out
}

/// Displacements as triples.
fn vectors(u: &[f64], dim: usize) -> Vec<f64> {
    u.chunks_exact(dim).flat_map(|u| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)]).collect()
}

fn region_numbers(mesh: &Mesh) -> Vec<f64> {
    let mut numbers = vec![-1.0; mesh.cells()];
    for (r, cells) in mesh.regions().values().enumerate().rev() {
        cells.iter().for_each(|&cell| numbers[cell as usize] = r as f64);
    }
    numbers
}
