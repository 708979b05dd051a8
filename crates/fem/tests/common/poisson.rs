//! A scalar field on the nodes of a body of bricks, coupled one way: it pushes the body.

#![allow(clippy::unwrap_used)] // helpers of tests

use nastic_energy::Slot;
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, Field, Inadmissible, Increment, Instant, Need,
    SecondDerivativeError, SecondSensitivities, Sensitivities, Sums,
};
use nastic_linear::{SparseMatrix, Symmetry};
use nastic_mesh::Mesh;
use nastic_tensor::Mat3;

/// `-k div grad phi = f` on the reference body, f a control, and a body force `push phi e_x`.
#[derive(Debug)]
pub struct Poisson {
    pub conductivity: f64,
    pub push: f64,
    fields: [Field; 1],
    cells: Vec<Cell>,
}

pub const SOURCE: [Slot; 1] = [Slot::scalar("source", "1")];

/// Of a cell of n nodes `int grad N_a . grad N_b`, `int N_a N_b` and `int N_a`.
#[derive(Debug)]
struct Cell {
    nodes: Vec<u32>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    load: Vec<f64>,
}

impl Poisson {
    pub fn on(mesh: &Mesh, conductivity: f64, push: f64) -> Self {
        let cells = mesh.blocks().iter().flat_map(|block| block.iter().map(|nodes| Cell::new(mesh, block.kind, nodes)));
        Poisson { conductivity, push, fields: [Field::nodal("phi", 1)], cells: cells.collect() }
    }

    /// The forces of a field, flat over the displacement.
    pub fn forces(&self, phi: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; 3 * phi.len()];
        for cell in &self.cells {
            cell.each(|a, b, at| out[3 * a] += self.push * cell.mass[at] * phi[b]);
        }
        out
    }

    /// `lambda . r` by f.
    fn by_source(&self, lambda: &[f64]) -> f64 {
        let of_cell = |cell: &Cell| -> f64 {
            cell.nodes.iter().zip(&cell.load).map(|(&node, load)| -load * lambda[4 * node as usize + 3]).sum()
        };
        self.cells.iter().map(of_cell).sum()
    }
}

impl Cell {
    /// By three Gauss points along each axis of the reference cube.
    fn new(mesh: &Mesh, kind: nastic_mesh::CellKind, nodes: &[u32]) -> Self {
        let (n, gauss) = (nodes.len(), [(-0.6_f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6_f64.sqrt(), 5.0 / 9.0)]);
        let (mut stiffness, mut mass, mut load) = (vec![0.0; n * n], vec![0.0; n * n], vec![0.0; n]);
        let (mut shapes, mut slopes) = (vec![0.0; n], vec![[0.0; 3]; n]);
        for at in 0..27 {
            let [x, y, z] = [at / 9, at / 3 % 3, at % 3].map(|k| gauss[k]);
            kind.shapes(&[x.0, y.0, z.0], &mut shapes);
            kind.gradients(&[x.0, y.0, z.0], &mut slopes);
            let jacobian = Mat3::from_fn(|i, j| {
                nodes.iter().zip(&slopes).map(|(&a, g)| mesh.points()[a as usize][i] * g[j]).sum::<f64>()
            });
            let weight = x.1 * y.1 * z.1 * jacobian.determinant();
            let inverse = jacobian.try_inverse().unwrap();
            let gradient = |a: usize| inverse.transpose() * nalgebra::Vector3::from(slopes[a]);
            for a in 0..n {
                load[a] += weight * shapes[a];
                for b in 0..n {
                    stiffness[n * a + b] += weight * gradient(a).dot(&gradient(b));
                    mass[n * a + b] += weight * shapes[a] * shapes[b];
                }
            }
        }
        Cell { nodes: nodes.to_vec(), stiffness, mass, load }
    }

    /// Calls with both nodes of every pair, and its place in the matrices.
    fn each(&self, mut call: impl FnMut(usize, usize, usize)) {
        let n = self.nodes.len();
        (0..n * n).for_each(|at| call(self.nodes[at / n] as usize, self.nodes[at % n] as usize, at));
    }
}

impl Contribution for Poisson {
    fn name(&self) -> &str {
        "poisson"
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    fn slots(&self) -> &[Slot] {
        &SOURCE
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Poisson {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for cell in self.cells.iter().filter(|_| demand.force) {
            let mut add = |dof: usize, force: f64| {
                sums.force[dof] += force;
                sums.force_scale[dof] += force.abs();
            };
            cell.each(|a, b, entry| {
                add(4 * a + 3, self.conductivity * cell.stiffness[entry] * at.u[4 * b + 3]);
                add(4 * a, -self.push * cell.mass[entry] * at.u[4 * b + 3]);
            });
            cell.nodes.iter().zip(&cell.load).for_each(|(&a, load)| add(4 * a as usize + 3, -at.control(0) * load));
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        for cell in &self.cells {
            let n = cell.nodes.len();
            let mut element = vec![0.0; 16 * n * n];
            for at in 0..n * n {
                let (a, b) = (at / n, at % n);
                element[4 * n * (4 * a + 3) + 4 * b + 3] = self.conductivity * cell.stiffness[at];
                element[4 * n * (4 * a) + 4 * b + 3] = -self.push * cell.mass[at];
            }
            tangent.add_pairs(&cell.nodes, &element)?;
        }
        Ok(())
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, self.by_source(lambda));
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        for cell in &self.cells {
            let nodes = cell.nodes.iter().zip(&cell.load);
            nodes.for_each(|(&node, load)| out[4 * node as usize + 3] -= at.slot_of(v, 0) * load);
        }
        Ok(())
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(()) // linear
    }
}
