//! [`ElementMatrices`]: a potential that is quadratic in u, by constant matrices of facets or cells.

use crate::guides::add_element;
use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;

/// `1/2 sum_e u_e . K_e u_e`, K_e symmetric.
#[derive(Debug)]
pub(crate) struct ElementMatrices {
    dim: usize,
    /// Whether K_e goes by node and component, or by node alone, the same for every component.
    couples_components: bool,
    /// Nodes of every facet or cell, and K_e, row after row.
    elements: Vec<(Vec<u32>, Vec<f64>)>,
}

impl ElementMatrices {
    /// By node and component.
    pub fn by_component(dim: usize) -> Self {
        ElementMatrices { dim, couples_components: true, elements: Vec::new() }
    }

    /// By node, the same for every component.
    pub fn by_node(dim: usize) -> Self {
        ElementMatrices { dim, couples_components: false, elements: Vec::new() }
    }

    pub fn push(&mut self, nodes: Vec<u32>, matrix: Vec<f64>) {
        self.elements.push((nodes, matrix));
    }

    /// Those of its elements, each once, ascending.
    pub fn nodes(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.elements.iter().flat_map(|(nodes, _)| nodes.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Calls with every unknown of every element and its entry of K v.
    pub fn each_product(&self, v: &[f64], mut call: impl FnMut(usize, f64)) {
        let (together, copies) = if self.couples_components { (self.dim, 1) } else { (1, self.dim) };
        for (nodes, k) in &self.elements {
            let n = together * nodes.len();
            for first in 0..copies {
                let dof = |local: usize| self.dim * nodes[local / together] as usize + local % together + first;
                for row in 0..n {
                    call(dof(row), (0..n).map(|column| k[n * row + column] * v[dof(column)]).sum());
                }
            }
        }
    }
}

impl ContributionPoint for ElementMatrices {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        self.each_product(at.u, |dof, force| {
            if demand.energy {
                sums.energy += 0.5 * force * at.u[dof];
                sums.energy_scale += 0.5 * (force * at.u[dof]).abs();
            }
            if demand.force {
                sums.force[dof] += force;
                sums.force_scale[dof] += force.abs();
            }
        });
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        for (nodes, k) in &self.elements {
            let (dim, n) = (self.dim, nodes.len());
            add_element(nodes, dim, tangent, |a, i, b, j| match self.couples_components {
                true => k[n * dim * (dim * a + i) + dim * b + j],
                false if i == j => k[n * a + b],
                false => 0.0,
            })?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        self.each_product(v, |dof, value| out[dof] += value);
        Ok(true)
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(())
    }
}
