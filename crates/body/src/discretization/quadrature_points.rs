//! [`QuadraturePoints`]: quadrature points of cells or facets, with tabulated shape functions and weights.

use crate::error::{FemError, Inadmissible, InvertedAt};
use crate::kernels::kernel;
use nastic_mesh::{CellKind, Facet, Mesh, Rule};
use nastic_tensor::{Kinematics, Mat3};

/// Quadrature points over cells or facets of a mesh, with their shape functions and reference measure.
///
/// The body's own rule is one; a cost that wants other points makes its own. Points are numbered cell by cell in the
/// order given, so for a whole body in mesh order point `first + q` is the q-th point of its cell.
/// [`interpolate`](Self::interpolate) takes nodal values to the points, [`spread`](Self::spread) is its transpose.
#[derive(Debug)]
pub struct QuadraturePoints {
    dim: usize,
    /// By kind of cell.
    pub parts: Vec<CellGroup>,
    /// By point.
    weights: Vec<f64>,
}

/// The cells (or facets) of one kind.
#[derive(Debug)]
pub struct CellGroup {
    /// Their kind.
    pub kind: CellKind,
    /// Index of their first point.
    pub first: usize,
    /// Their numbers in the mesh; of facets, consecutive ones.
    pub cells: Vec<u32>,
    /// Their nodes, `[cell][node]`.
    pub nodes: Vec<u32>,
    /// Shape functions at their points.
    pub table: Table,
    /// `dxi_K / dX_J` at entry `3 K + J` of every point; empty for facets.
    pub inverse: Vec<[f64; 9]>,
}

impl CellGroup {
    /// The nodes of the c-th cell.
    pub fn nodes_of(&self, c: usize) -> &[u32] {
        let n = self.table.nodes;
        &self.nodes[c * n..(c + 1) * n]
    }

    /// The global number of the first point of the c-th cell.
    pub fn first_point(&self, c: usize) -> usize {
        self.first + c * self.table.points
    }
}

/// Shape functions and reference gradients at the points of a rule, rows padded to `width`.
#[derive(Debug)]
pub struct Table {
    /// Points of a cell.
    pub points: usize,
    /// Nodes of a cell.
    pub nodes: usize,
    /// Length of a row.
    pub width: usize,
    /// `[q][width]`
    pub shapes: Vec<f64>,
    /// `[q][K][width]`
    pub gradients: Vec<f64>,
    /// Weights of the rule, in the reference cell.
    pub weights: Vec<f64>,
}

impl Table {
    fn new(kind: CellKind, rule: &Rule) -> Self {
        let nodes = kind.nodes();
        let width = kernel(kind).map_or(nodes, |k| k.width());
        let (points, dim) = (rule.points.len(), kind.dim());
        let mut table = Table {
            points,
            nodes,
            width,
            shapes: vec![0.0; points * width],
            gradients: vec![0.0; points * dim * width],
            weights: rule.weights.clone(),
        };
        let mut gradients = vec![[0.0; 3]; nodes];
        for (q, xi) in rule.points.iter().enumerate() {
            kind.shapes(xi, &mut table.shapes[q * width..q * width + nodes]);
            kind.gradients(xi, &mut gradients);
            for (a, gradient) in gradients.iter().enumerate() {
                for (k, &value) in gradient.iter().enumerate().take(dim) {
                    table.gradients[(q * dim + k) * width + a] = value;
                }
            }
        }
        table
    }

    /// Shape functions at a point.
    pub fn shapes_at(&self, q: usize) -> &[f64] {
        &self.shapes[q * self.width..q * self.width + self.nodes]
    }
}

impl QuadraturePoints {
    /// Points of the cells `cells` (in this order) with the rule that `rule` gives for each kind.
    ///
    /// # Errors
    /// [`FemError::InvertedReference`] where the map from the reference element is not invertible.
    pub fn of_cells(
        mesh: &Mesh,
        cells: impl IntoIterator<Item = u32>,
        rule: impl Fn(CellKind) -> Rule,
    ) -> Result<Self, FemError> {
        let entities = cells.into_iter().map(|id| {
            let cell = mesh.cell(id as usize);
            (id, cell.kind, cell.nodes.to_vec())
        });
        let mut sampling = Self::gather(mesh, entities, rule);
        sampling.measure_cells(mesh)?;
        Ok(sampling)
    }

    /// Points of the facets of a named surface, with the reference area (length in two dimensions) as weight.
    pub fn of_facets(mesh: &Mesh, facets: &[Facet], rule: impl Fn(CellKind) -> Rule) -> Self {
        let entities = facets.iter().map(|&facet| {
            let (kind, nodes) = mesh.facet_nodes(facet);
            (facet.cell, kind, nodes)
        });
        let mut sampling = Self::gather(mesh, entities, rule);
        sampling.measure_facets(mesh);
        sampling
    }

    fn gather(
        mesh: &Mesh,
        entities: impl Iterator<Item = (u32, CellKind, Vec<u32>)>,
        rule: impl Fn(CellKind) -> Rule,
    ) -> Self {
        let mut parts: Vec<CellGroup> = Vec::new();
        let mut len = 0;
        for (cell, kind, nodes) in entities {
            if parts.last().is_none_or(|part| part.kind != kind) {
                let table = Table::new(kind, &rule(kind));
                parts.push(CellGroup { kind, first: len, cells: vec![], nodes: vec![], table, inverse: vec![] });
            }
            if let Some(part) = parts.last_mut() {
                part.cells.push(cell);
                part.nodes.extend(nodes);
                len += part.table.points;
            }
        }
        QuadraturePoints { dim: mesh.dim(), parts, weights: Vec::with_capacity(len) }
    }

    fn measure_cells(&mut self, mesh: &Mesh) -> Result<(), FemError> {
        for part in &mut self.parts {
            for c in 0..part.cells.len() {
                for q in 0..part.table.points {
                    let jacobian = part.jacobian(mesh.points(), c, q, self.dim);
                    let det = jacobian.determinant();
                    let inverse = jacobian.try_inverse().filter(|_| det > 0.0);
                    let inverse = inverse.ok_or(FemError::InvertedReference {
                        mesh: mesh.name().to_owned(),
                        cell: part.cells[c] as usize,
                        jacobian: det,
                    })?;
                    let mut flat = [0.0; 9];
                    for k in 0..3 {
                        for j in 0..3 {
                            flat[3 * k + j] = inverse[(k, j)];
                        }
                    }
                    part.inverse.push(flat);
                    self.weights.push(det * part.table.weights[q]);
                }
            }
        }
        Ok(())
    }

    fn measure_facets(&mut self, mesh: &Mesh) {
        for part in &self.parts {
            for c in 0..part.cells.len() {
                for q in 0..part.table.points {
                    let jacobian = part.jacobian(mesh.points(), c, q, part.kind.dim());
                    let first = jacobian.column(0);
                    let measure = match part.kind.dim() {
                        1 => first.norm(),
                        _ => first.cross(&jacobian.column(1)).norm(),
                    };
                    self.weights.push(measure * part.table.weights[q]);
                }
            }
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Reference measure of every point: quadrature weight times volume, area or length element.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// `dxi_K / dX_J` at entry `3 K + J`, by point (cells only).
    pub fn inverse_jacobians(&self) -> impl Iterator<Item = &[f64; 9]> {
        self.parts.iter().flat_map(|part| &part.inverse)
    }

    /// Sum of the weights: the volume (area in two dimensions) of the cells, or the area (length) of the facets.
    pub fn measure(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// The cell of every point (for facets: the cell they belong to), by point.
    pub fn cells(&self) -> Vec<u32> {
        let of_part =
            |part: &CellGroup| part.cells.iter().flat_map(|&c| vec![c; part.table.points]).collect::<Vec<_>>();
        self.parts.iter().flat_map(of_part).collect()
    }

    /// Nodal values (`components` per node) at the points: `v(q) = sum_a N_a(q) v_a`; shape `[len][components]`.
    pub fn interpolate(&self, nodal: &[f64], components: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.len() * components];
        self.for_each_pair(|point, node, shape| {
            for i in 0..components {
                out[point * components + i] += shape * nodal[node * components + i];
            }
        });
        out
    }

    /// The transpose of [`interpolate`](Self::interpolate): adds `sum_q N_a(q) v(q)` to `nodal`. No weights are
    /// multiplied in.
    pub fn spread(&self, values: &[f64], components: usize, nodal: &mut [f64]) {
        self.for_each_pair(|point, node, shape| {
            for i in 0..components {
                nodal[node * components + i] += shape * values[point * components + i];
            }
        });
    }

    /// Calls back with (point, node, shape value) for all pairs, in a fixed order.
    pub fn for_each_pair(&self, mut each: impl FnMut(usize, usize, f64)) {
        for part in &self.parts {
            for c in 0..part.cells.len() {
                let nodes = part.nodes_of(c);
                for q in 0..part.table.points {
                    for (&node, &shape) in nodes.iter().zip(part.table.shapes_at(q)) {
                        each(part.first_point(c) + q, node as usize, shape);
                    }
                }
            }
        }
    }

    /// Positions of the points: reference ones, or `X + u(X)` when the displacement is given (flat, `dim` per node).
    pub fn positions(&self, mesh: &Mesh, displacement: Option<&[f64]>) -> Vec<[f64; 3]> {
        let reference = self.interpolate(mesh.points().as_flattened(), 3);
        let mut positions = reference.as_chunks::<3>().0.to_vec();
        if let Some(u) = displacement {
            let moved = self.interpolate(u, self.dim);
            for (position, u) in positions.iter_mut().zip(moved.chunks_exact(self.dim)) {
                for (x, u) in position.iter_mut().zip(u) {
                    *x += u;
                }
            }
        }
        positions
    }

    /// F = I + grad u with its cofactor and determinant at every point (cells only).
    ///
    /// # Errors
    /// [`Inadmissible`] names the first cell and point where J <= 0.
    pub fn kinematics(&self, displacement: &[f64]) -> Result<Vec<Kinematics>, Inadmissible> {
        let mut out = Vec::with_capacity(self.len());
        for (q, gradient) in self.gradients(displacement).into_iter().enumerate() {
            let kinematics = Kinematics::new(Mat3::identity() + gradient);
            out.push(
                kinematics.map_err(|inverted| Inadmissible::Inverted(InvertedAt::new(self, q, inverted.jacobian)))?,
            );
        }
        Ok(out)
    }

    /// `grad u` at every point (cells only).
    pub fn gradients(&self, nodal: &[f64]) -> Vec<Mat3> {
        let mut out = vec![Mat3::zeros(); self.len()];
        self.for_each_cell(|part, kernel, c, g| {
            let mut rows = vec![0.0; self.dim * part.table.width];
            gather_rows(nodal, part.nodes_of(c), self.dim, part.table.width, &mut rows);
            let first = part.first_point(c);
            kernel.displacement_gradients(g, &rows, &mut out[first..first + part.table.points]);
        });
        out
    }

    /// The transpose of [`gradients`](Self::gradients): adds `sum_q P_iJ(q) dN_a/dX_J(q)` to the flat nodal vector.
    /// No weights are multiplied in.
    pub fn spread_stress(&self, stress: &[Mat3], nodal: &mut [f64]) {
        self.for_each_cell(|part, kernel, c, g| {
            let mut rows = vec![0.0; self.dim * part.table.width];
            let first = part.first_point(c);
            kernel.force(g, &stress[first..first + part.table.points], &mut rows);
            scatter_rows(&rows, part.nodes_of(c), self.dim, part.table.width, nodal);
        });
    }

    fn for_each_cell(&self, mut each: impl FnMut(&CellGroup, &dyn crate::kernels::CellKernel, usize, &[f64])) {
        for part in &self.parts {
            let Some(kernel) = kernel(part.kind).filter(|_| !part.inverse.is_empty()) else { continue };
            let mut g = vec![0.0; part.table.gradients.len()];
            let points = part.table.points;
            for c in 0..part.cells.len() {
                kernel.gradients(&part.table.gradients, &part.inverse[c * points..(c + 1) * points], &mut g);
                each(part, kernel, c, &g);
            }
        }
    }
}

impl CellGroup {
    /// `dX_J / dxi_K` of the c-th cell at point q; the identity beyond `dim`.
    fn jacobian(&self, points: &[[f64; 3]], c: usize, q: usize, dim: usize) -> Mat3 {
        let mut jacobian = Mat3::zeros();
        for k in dim..3 {
            jacobian[(k, k)] = 1.0;
        }
        let kind_dim = self.kind.dim();
        for (a, &node) in self.nodes_of(c).iter().enumerate() {
            for k in 0..kind_dim {
                let gradient = self.table.gradients[(q * kind_dim + k) * self.table.width + a];
                for (j, x) in points[node as usize].iter().enumerate().take(3) {
                    jacobian[(j, k)] += x * gradient;
                }
            }
        }
        jacobian
    }
}

/// Nodal vectors of a cell as rows `[i][width]`; the padding is left untouched.
#[inline]
pub(crate) fn gather_rows(nodal: &[f64], nodes: &[u32], dim: usize, width: usize, rows: &mut [f64]) {
    for (a, &node) in nodes.iter().enumerate() {
        for i in 0..dim {
            rows[i * width + a] = nodal[node as usize * dim + i];
        }
    }
}

/// Adds rows `[i][width]` of a cell to the nodal vector.
#[inline]
pub(crate) fn scatter_rows(rows: &[f64], nodes: &[u32], dim: usize, width: usize, nodal: &mut [f64]) {
    for (a, &node) in nodes.iter().enumerate() {
        for i in 0..dim {
            nodal[node as usize * dim + i] += rows[i * width + a];
        }
    }
}
