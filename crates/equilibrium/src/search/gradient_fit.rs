//! [`GradientFit`]: the displacement whose gradient is nearest to a given one.

use crate::model::Model;
use crate::search::cell_laplacian::{CellLaplacian, Held};
use crate::search::rotation_corrected_step::{misfit, turned, turned_between};
use nastic_body::discretization::Discretization;
use nastic_body::discretization::quadrature_points::CellGroup;
use nastic_body::kernels::displaced::Displaced;
use nastic_body::kernels::{CellKernel, kernel};
use nastic_linear::{Factor, Geometry, Multigrid, SparseMatrix, Structure, conjugate_gradient};
use nastic_tensor::Tangent;
use rayon::prelude::*;
use std::sync::Arc;

/// Cells of one task.
pub(crate) const CELLS_PER_TASK: usize = 64;
/// Tasks whose element matrices are held at a time.
pub(crate) const TASKS_PER_WAVE: usize = 64;

/// Relative residual of a fit by multigrid.
const FIT_TOLERANCE: f64 = 1e-3;
/// Cycles of a fit by multigrid.
const MAX_FIT_CYCLES: usize = 60;
/// Operations per stored value up to which a factorisation takes no longer than the levels of the tangent.
const MAX_FLOPS_PER_VALUE: f64 = 2000.0;
/// The same for a body of 27-node hexahedra, whose tangent has less expensive levels, and where a factor would take a third of the memory.
const MAX_FLOPS_PER_VALUE_OF_PRODUCTS: f64 = 1000.0;

/// The Laplace operator of a body under its supports, with what solves it: fits displacements to gradients.
pub(crate) struct GradientFit {
    /// By displacement component; components with the same supports share one.
    solvers: Vec<Arc<Laplacian>>,
    /// The components that no support holds anywhere: there the first node is held, and the correction moves no centre.
    free: Vec<bool>,
    parallel: bool,
}

/// A Laplace operator and what solves it: a factor, or multigrid where a factor takes longer than the levels of the tangent; of 27-node hexahedra
/// then by products of cells.
enum Laplacian {
    Factor(Factor),
    Multigrid(Box<(SparseMatrix, Multigrid)>),
    Cells(Box<Held>),
}

/// A Laplace operator before any unknown is held.
enum Unheld {
    /// The structure of its matrix, the matrix, whether a factor is to be made of it.
    Matrix(Arc<Structure>, SparseMatrix, bool),
    Cells(Arc<CellLaplacian>),
}

impl Unheld {
    fn of(model: &Model, parallel: bool) -> Option<Self> {
        let disc = model.discretization();
        let structure = model.tangent_structure().with_components(1);
        let (values, flops) = (model.tangent_structure().pattern().values() as f64, structure.factor_size().flops);
        if let Some(hexahedra) = disc.hexahedra().filter(|_| flops > MAX_FLOPS_PER_VALUE_OF_PRODUCTS * values) {
            return Some(Unheld::Cells(Arc::new(CellLaplacian::new(disc, hexahedra, parallel)?)));
        }
        let matrix = laplacian(model, SparseMatrix::zeros(structure.pattern().clone()), parallel);
        Some(Unheld::Matrix(structure, matrix, flops <= MAX_FLOPS_PER_VALUE * values))
    }
}

impl Laplacian {
    /// Nothing if that fails.
    fn new(disc: &Discretization, of: &Unheld, fixed: &[bool], parallel: bool) -> Option<Self> {
        let (structure, matrix, by_factor) = match of {
            Unheld::Cells(cells) => return Some(Laplacian::Cells(Box::new(cells.held(disc, fixed, parallel)?))),
            Unheld::Matrix(structure, matrix, by_factor) => (structure, matrix, by_factor),
        };
        let mut matrix = matrix.clone();
        matrix.eliminate(fixed, matrix.diagonal().into_iter().fold(0.0, f64::max));
        if *by_factor {
            return structure.symbolic().approximate(&matrix, parallel).ok().map(Laplacian::Factor);
        }
        let geometry = Geometry { points: disc.mesh().points(), fixed, corners: disc.corners(), products: None };
        let levels = Multigrid::new(&matrix, &geometry, parallel).ok()?;
        Some(Laplacian::Multigrid(Box::new((matrix, levels))))
    }

    fn solve(&self, b: &mut Vec<f64>, parallel: bool) {
        match self {
            Laplacian::Factor(factor) => factor.solve(b, 1),
            Laplacian::Cells(of) => *b = of.solve(b, FIT_TOLERANCE, MAX_FIT_CYCLES, parallel),
            Laplacian::Multigrid(of) => {
                let mut x = vec![0.0; b.len()];
                let product = |v: &[f64], out: &mut [f64]| of.0.multiply_on(v, out, parallel);
                // what is left of the residual changes the curve a little, and no state
                conjugate_gradient(&product, &of.1, b, &mut x, FIT_TOLERANCE, MAX_FIT_CYCLES);
                *b = x;
            }
        }
    }
}

impl GradientFit {
    /// Makes it ready; nothing if that fails, and steps stay straight.
    pub fn new(model: &Model, parallel: bool) -> Option<Self> {
        let disc = model.discretization();
        let dim = disc.dim();
        let unheld = Unheld::of(model, parallel)?;
        let mut known: Vec<(Vec<bool>, Arc<Laplacian>)> = Vec::new();
        let (mut solvers, mut free) = (Vec::with_capacity(dim), Vec::with_capacity(dim));
        for c in 0..dim {
            let mut fixed: Vec<bool> = model.supports.fixed().iter().skip(c).step_by(dim).copied().collect();
            // a body in motion may be free: gradients determine the component up to a constant
            free.push(!fixed.contains(&true));
            fixed[0] |= free[c];
            let solver = match known.iter().find(|(other, _)| *other == fixed) {
                Some((_, solver)) => solver.clone(),
                None => {
                    let solver = Arc::new(Laplacian::new(disc, &unheld, &fixed, parallel)?);
                    known.push((fixed, solver.clone()));
                    solver
                }
            };
            solvers.push(solver);
        }
        Some(Self { solvers, free, parallel })
    }

    /// `u(s) - u - s du`, zero where supported.
    pub fn correction(&self, model: &Model, at: Displaced, du: &[f64], s: f64, parallel: bool) -> Vec<f64> {
        self.fit(model, misfit(model.discretization(), at, du, s, turned, parallel))
    }

    /// The same between two states u and u + du: the way from F to `R U F`, with the polar decomposition `1 + G = R U`, is
    /// `F(s) = R^s (1 + s (U - 1)) F`, with `R^s` the rotation about the axis of R by s times its angle.
    pub fn correction_between(&self, model: &Model, at: Displaced, du: &[f64], s: f64, parallel: bool) -> Vec<f64> {
        self.fit(model, misfit(model.discretization(), at, du, s, turned_between, parallel))
    }

    fn fit(&self, model: &Model, mut rhs: Vec<f64>) -> Vec<f64> {
        let dim = model.discretization().dim();
        model.supports.clear(&mut rhs);
        for (c, solver) in self.solvers.iter().enumerate() {
            let mut component: Vec<f64> = rhs.iter().skip(c).step_by(dim).copied().collect();
            if self.free[c] {
                component[0] = 0.0;
            }
            solver.solve(&mut component, self.parallel);
            if self.free[c] {
                let volumes = model.discretization().nodal_volumes();
                let mean = model.unknowns().dot(&volumes, &component) / volumes.iter().sum::<f64>();
                component.iter_mut().for_each(|x| *x -= mean);
            }
            rhs.iter_mut().skip(c).step_by(dim).zip(component).for_each(|(r, x)| *r = x);
        }
        model.supports.extend(&mut rhs);
        rhs
    }
}

fn laplacian(model: &Model, mut matrix: SparseMatrix, parallel: bool) -> SparseMatrix {
    let disc = model.discretization();
    for (p, part) in disc.points().parts.iter().enumerate() {
        let Some(kernel) = kernel(part.kind) else { continue };
        let maps = model.tangent_structure().scatter(p);
        let per_cell = maps.len() / part.cells.len();
        let cells: Vec<usize> = (0..part.cells.len()).collect();
        let of = |cells: &[usize]| elements(disc, part, kernel, cells);
        for cells in cells.chunks(TASKS_PER_WAVE * CELLS_PER_TASK) {
            let elements: Vec<Vec<f64>> = match parallel {
                true => cells.par_chunks(CELLS_PER_TASK).map(of).collect(),
                false => cells.chunks(CELLS_PER_TASK).map(of).collect(),
            };
            let maps = &maps[cells[0] * per_cell..];
            for (value, &code) in elements.iter().flatten().zip(maps) {
                matrix.values[(code >> 1) as usize] += value;
            }
        }
    }
    matrix
}

/// `int grad N_a . grad N_b dX`, `b <= a`, of some cells one after the other.
pub(crate) fn elements(disc: &Discretization, part: &CellGroup, kernel: &dyn CellKernel, cells: &[usize]) -> Vec<f64> {
    let (points, metric) = (part.table.points, Tangent::from_map(|b| *b));
    let mut g = vec![0.0; part.table.gradients.len()];
    let mut element = vec![0.0; kernel.matrix_len()];
    let (mut weighted, mut work, mut out) = (vec![Tangent::zero(); points], Vec::new(), Vec::new());
    for &c in cells {
        kernel.gradients(&part.table.gradients, &part.inverse[c * points..(c + 1) * points], &mut g);
        for (q, tangent) in weighted.iter_mut().enumerate() {
            let weight = disc.points().weights()[part.first_point(c) + q];
            *tangent = Tangent(metric.0.map(|m| m * weight));
        }
        kernel.tangent(&g, &weighted, &mut element, &mut work);
        // the first component's block: the others are the same
        for a in 0..part.table.nodes {
            out.extend_from_slice(&element[a * part.table.width..][..=a]);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_energy::NeoHooke;
    use nastic_linear::Space;
    use nastic_mesh::{CellKind, box_mesh};
    use nastic_numeric::vector::sub;

    /// On the same right-hand side, with a face held and with a node alone.
    #[test]
    fn products_of_cells_fit_as_the_matrix_does() -> Result<(), Box<dyn std::error::Error>> {
        let mesh = box_mesh([1.0, 0.3, 0.2], [7, 3, 2], CellKind::Hex27)?;
        let (held, cells) = (mesh.nodes_of_facets(mesh.surface("x-")?), mesh.cells_of(&"body".into())?);
        let mut model = Model::new(Discretization::new(Arc::new(mesh))?);
        model.body.add_term(&cells, Arc::new(NeoHooke::new(1.0, 0.3)?))?;
        Arc::make_mut(&mut model.supports).prescribe("x-", &held, [Some(0.0); 3])?;
        let (disc, model) = (model.discretization(), &model);
        let structure = model.tangent_structure().with_components(1);
        let matrix = laplacian(model, SparseMatrix::zeros(structure.pattern().clone()), true);
        let hexahedra = disc.hexahedra().ok_or("27-node hexahedra")?;
        let cells = Unheld::Cells(Arc::new(CellLaplacian::new(disc, hexahedra, true).ok_or("no products")?));
        let matrix = Unheld::Matrix(structure, matrix, true);
        let nodes = disc.mesh().points().len();
        let face: Vec<bool> = model.supports.fixed().iter().step_by(3).copied().collect();
        let single: Vec<bool> = (0..nodes).map(|node| node == 0).collect();
        for fixed in [face, single] {
            let noise = |node: usize| ((node * 7919 % 997) as f64 / 498.0 - 1.0) * f64::from(u8::from(!fixed[node]));
            let b: Vec<f64> = (0..nodes).map(noise).collect();
            let solve = |of: &Unheld, parallel: bool| {
                let mut x = b.clone();
                Laplacian::new(disc, of, &fixed, parallel).ok_or("no solution")?.solve(&mut x, parallel);
                Ok::<_, &str>(x)
            };
            let (wanted, found) = (solve(&matrix, true)?, solve(&cells, true)?);
            let error = Space::LOCAL.norm(&sub(&wanted, &found)) / Space::LOCAL.norm(&wanted);
            assert!(error < 3e-2, "{error:e}");
            assert_eq!(found, solve(&cells, false)?);
        }
        Ok(())
    }
}
