//! [`FilledMass`]: a consistent mass whose density follows a field over the body.

use crate::fill::Fill;
use nastic_body::controls::Controls;
use nastic_body::discretization::Discretization;
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_body::structure::TangentStructure;
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_mesh::GroupNames;
use std::sync::Arc;

/// `M_ab = sum_c rho_c f_c int_c N_a N_b dX`, `f_c = (1/V_c) sum_q w_q f(X_q)`: the mean fill of a cell over the quadrature points of the body, so that any rule
/// of the body has a positive mass. f is a [`Fill`]: a design, times det G of the body's shape.
#[derive(Debug)]
pub(crate) struct FilledMass {
    pub fill: Fill,
    pub regions: GroupNames,
    /// Cells, all of the body.
    pub cells: Vec<u32>,
    /// By cell, of the full body.
    density: Vec<f64>,
    /// By quadrature point of the body: its cell, its share of the cell's volume.
    points: Vec<(u32, f64)>,
    /// By the rule that is exact for `N_a N_b`.
    sampling: QuadraturePoints,
    dim: usize,
    /// Entries of a displacement.
    dofs: usize,
    structure: Arc<TangentStructure>,
}

impl FilledMass {
    pub fn new(
        fill: Fill,
        disc: &Discretization,
        structure: &Arc<TangentStructure>,
        regions: GroupNames,
        density: Vec<f64>,
    ) -> Result<Self, FemError> {
        let (mesh, points) = (disc.mesh(), disc.points());
        let mut volumes = vec![0.0; mesh.cells()];
        points.cells().iter().zip(points.weights()).for_each(|(&cell, weight)| volumes[cell as usize] += weight);
        let share = |(&cell, weight): (&u32, &f64)| (cell, weight / volumes[cell as usize]);
        let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
        Ok(FilledMass {
            fill,
            regions,
            cells,
            density,
            points: points.cells().iter().zip(points.weights()).map(share).collect(),
            sampling: structure.mass_rule()?,
            dim: mesh.dim(),
            dofs: disc.dofs(),
            structure: Arc::clone(structure),
        })
    }

    /// Quadrature points of the body.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// `rho_c f_c`, of a fill by quadrature point.
    fn densities(&self, fill: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut filled = vec![0.0; self.density.len()];
        for (point, &(cell, share)) in self.points.iter().enumerate() {
            filled[cell as usize] += share * fill(point);
        }
        filled.iter().zip(&self.density).map(|(fill, density)| fill * density).collect()
    }

    fn at(&self, at: &Instant) -> Vec<f64> {
        self.densities(|point| self.fill.value(point, &|k| at.control_at(point, k)))
    }

    fn times_density(&self, density: &[f64], v: &[f64]) -> Vec<f64> {
        let mut at_points = self.sampling.interpolate(&v[..self.dofs], self.dim);
        let cells = self.sampling.cells();
        let weighted = self.sampling.weights().iter().zip(&cells).map(|(w, &cell)| w * density[cell as usize]);
        for (values, factor) in at_points.chunks_exact_mut(self.dim).zip(weighted) {
            values.iter_mut().for_each(|value| *value *= factor);
        }
        let mut out = vec![0.0; v.len()];
        self.sampling.spread(&at_points, self.dim, &mut out[..self.dofs]);
        out
    }

    /// The mass of the body.
    pub fn total(&self, at: &Instant) -> f64 {
        let (density, cells) = (self.at(at), self.sampling.cells());
        self.sampling.weights().iter().zip(&cells).map(|(w, &cell)| w * density[cell as usize]).sum()
    }

    pub fn times(&self, at: &Instant, v: &[f64]) -> Vec<f64> {
        self.times_density(&self.at(at), v)
    }

    /// `dM v` along a change of the controls.
    pub fn times_change(&self, at: &Instant, change: &Controls, v: &[f64]) -> Vec<f64> {
        let of_point = |point| {
            let (m, change) = (|k| at.control_at(point, k), |k| at.slot_at(change, point, k));
            self.fill.change(point, &m, &change)
        };
        self.times_density(&self.densities(of_point), v)
    }

    pub fn add_to(&self, factor: f64, at: &Instant, matrix: &mut SparseMatrix) -> Result<(), NotCoupled> {
        let density: Vec<f64> = self.at(at).iter().map(|density| factor * density).collect();
        matrix.add_scaled(1.0, &self.structure.mass_by(&self.sampling, &density))
    }

    /// `lambda . dM/dm v` of every point and slot.
    pub fn vjp(&self, at: &Instant, lambda: &[f64], v: &[f64], mut add: impl FnMut(usize, usize, f64)) {
        self.each_product(lambda, v, |point, by| {
            self.fill.each_derivative(point, &|k| at.control_at(point, k), |slot, own| add(point, slot, own * by));
        });
    }

    /// Its change along a change of the controls, which is zero of a fill alone.
    pub fn second_vjp(
        &self,
        at: &Instant,
        change: &Controls,
        [lambda, v]: [&[f64]; 2],
        mut add: impl FnMut(usize, usize, f64),
    ) {
        self.each_product(lambda, v, |point, by| {
            let (m, change) = (|k| at.control_at(point, k), |k| at.slot_at(change, point, k));
            self.fill.each_second(point, &m, &change, |slot, own| add(point, slot, own * by));
        });
    }

    /// `lambda . dM/df_q v` of every point.
    fn each_product(&self, lambda: &[f64], v: &[f64], mut call: impl FnMut(usize, f64)) {
        let by_rule = [lambda, v].map(|v| self.sampling.interpolate(&v[..self.dofs], self.dim));
        let mut by_cell = vec![0.0; self.density.len()];
        let products = by_rule[0].chunks_exact(self.dim).zip(by_rule[1].chunks_exact(self.dim));
        for ((a, b), (weight, &cell)) in products.zip(self.sampling.weights().iter().zip(&self.sampling.cells())) {
            by_cell[cell as usize] += weight * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        }
        for (point, &(cell, share)) in self.points.iter().enumerate() {
            call(point, share * self.density[cell as usize] * by_cell[cell as usize]);
        }
    }
}
