//! [`MatterCells`]: the enthalpy of a [`Matter`] over cells, by the displacement and a potential on their nodes.

use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::discretization::quadrature_points::{CellGroup, QuadraturePoints};
use nastic_body::error::{Inadmissible, InvertedAt, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::{Gradients, Matter};
use nastic_linear::SparseMatrix;
use nastic_tensor::HyperDual;
use rayon::prelude::*;

/// Most nodes of a cell.
const NODES: usize = 27;
/// Cells whose sums are kept until they are added, one after the other.
const WAVE: usize = 1024;

/// `int Omega(F, grad phi) dX` over cells; vectors have the displacement and phi at every node.
#[derive(Debug)]
pub(crate) struct MatterCells {
    pub matter: Matter,
    pub points: QuadraturePoints,
    pub dim: usize,
}

/// One of the cells.
struct Cell<'a> {
    part: &'a CellGroup,
    /// Its number in the part.
    index: usize,
    dim: usize,
    weights: &'a [f64],
}

/// One of its quadrature points: weight, and the gradients of the shape functions by node.
struct Place {
    weight: f64,
    slopes: [[f64; 3]; NODES],
}

impl Cell<'_> {
    fn nodes(&self) -> &[u32] {
        self.part.nodes_of(self.index)
    }

    /// Unknowns of a node.
    fn block(&self) -> usize {
        self.dim + 1
    }

    fn points(&self) -> usize {
        self.part.table.points
    }

    fn place(&self, q: usize) -> Place {
        let (table, inverse) = (&self.part.table, &self.part.inverse[self.index * self.points() + q]);
        let mut slopes = [[0.0; 3]; NODES];
        for (a, slope) in slopes.iter_mut().enumerate().take(table.nodes) {
            for (j, slope) in slope.iter_mut().enumerate().take(self.dim) {
                let reference = |k: usize| table.gradients[(q * self.dim + k) * table.width + a];
                *slope = (0..self.dim).map(|k| reference(k) * inverse[3 * k + j]).sum();
            }
        }
        Place { weight: self.weights[self.part.first_point(self.index) + q], slopes }
    }

    /// The row of gradients that belongs to a component at a node.
    fn row(&self, component: usize) -> usize {
        if component < self.dim { component } else { 3 }
    }

    /// Gradients of a vector.
    fn gradients(&self, place: &Place, v: &[f64]) -> Gradients<f64> {
        let mut all = [[0.0; 3]; 4];
        for (&node, slope) in self.nodes().iter().zip(&place.slopes) {
            for c in 0..self.block() {
                let value = v[self.block() * node as usize + c];
                all[self.row(c)].iter_mut().zip(slope).for_each(|(sum, slope)| *sum += value * slope);
            }
        }
        all
    }

    /// F and grad phi.
    fn strained(&self, place: &Place, u: &[f64]) -> Gradients<f64> {
        let mut all = self.gradients(place, u);
        (0..3).for_each(|i| all[i][i] += 1.0);
        all
    }

    /// The sum over its points of what is there spread over its nodes, `[node][component]`.
    fn spread(&self, of: impl Fn(&Place) -> Gradients<f64>) -> Vec<f64> {
        let n = self.block();
        let mut out = vec![0.0; n * self.nodes().len()];
        for q in 0..self.points() {
            let place = self.place(q);
            let dual = of(&place);
            for (at, sum) in out.iter_mut().enumerate() {
                *sum += place.weight * product(&place.slopes[at / n], &dual[self.row(at % n)]);
            }
        }
        out
    }

    /// Refuses `J <= 0`.
    fn check(&self, matter: &Matter, u: &[f64]) -> Result<(), Inadmissible> {
        for q in 0..self.points() {
            let (jacobian, _) = matter.true_field(&self.strained(&self.place(q), u));
            if jacobian <= 0.0 || jacobian.is_nan() {
                let cell = self.part.cells[self.index] as usize;
                return Err(Inadmissible::Inverted(InvertedAt { cell, point: q, jacobian }));
            }
        }
        Ok(())
    }

    /// Omega, and minus the electric energy that it has: over the cell.
    fn enthalpy(&self, matter: &Matter, u: &[f64]) -> f64 {
        let of = |q: usize| {
            let place = self.place(q);
            place.weight * matter.enthalpy(&self.strained(&place, u))
        };
        (0..self.points()).map(of).sum()
    }

    /// The tangent, row after row.
    fn tangent(&self, matter: &Matter, u: &[f64]) -> Vec<f64> {
        let (n, count) = (self.block(), self.nodes().len());
        let size = n * count;
        let mut out = vec![0.0; size * size];
        for q in 0..self.points() {
            let place = self.place(q);
            let point = matter.at(&self.strained(&place, u));
            // changes by every component and direction
            let mut by = [[[[0.0; 3]; 4]; 3]; 4];
            for (d, by) in by.iter_mut().enumerate().take(n) {
                for (k, by) in by.iter_mut().enumerate().take(self.dim) {
                    let mut along = [[0.0; 3]; 4];
                    along[self.row(d)][k] = 1.0;
                    *by = point.change(&along);
                }
            }
            for (column, (b, d)) in (0..count).flat_map(|b| (0..n).map(move |d| (b, d))).enumerate() {
                let mut dual = [[0.0; 3]; 4];
                for (by, slope) in by[d].iter().zip(&place.slopes[b]) {
                    dual.iter_mut().flatten().zip(by.iter().flatten()).for_each(|(sum, by)| *sum += slope * by);
                }
                for row in 0..size {
                    out[row * size + column] +=
                        place.weight * product(&place.slopes[row / n], &dual[self.row(row % n)]);
                }
            }
        }
        out
    }
}

fn product(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl MatterCells {
    /// Unknowns of a node.
    fn block(&self) -> usize {
        self.dim + 1
    }

    /// Calls with the answer of every cell in their order, whatever computes them.
    fn each<R: Send>(
        &self,
        parallel: bool,
        of: impl Fn(&Cell) -> R + Sync,
        mut add: impl FnMut(&[u32], R) -> Result<(), Inadmissible>,
    ) -> Result<(), Inadmissible> {
        for part in &self.points.parts {
            let cell = |index: usize| Cell { part, index, dim: self.dim, weights: self.points.weights() };
            for first in (0..part.cells.len()).step_by(WAVE) {
                let wave = first..part.cells.len().min(first + WAVE);
                let found: Vec<R> = match parallel {
                    true => wave.clone().into_par_iter().map(|index| of(&cell(index))).collect(),
                    false => wave.clone().map(|index| of(&cell(index))).collect(),
                };
                wave.zip(found).try_for_each(|(index, found)| add(part.nodes_of(index), found))?;
            }
        }
        Ok(())
    }

    /// Adds what is spread over the nodes of every cell to a vector.
    fn add_spread(
        &self,
        parallel: bool,
        of: impl Fn(&Cell, &Place) -> Gradients<f64> + Sync,
        out: &mut [f64],
    ) -> Result<(), Inadmissible> {
        let n = self.block();
        self.each(
            parallel,
            |cell| cell.spread(|place| of(cell, place)),
            |nodes, own| {
                own.iter().enumerate().for_each(|(at, own)| out[n * nodes[at / n] as usize + at % n] += own);
                Ok(())
            },
        )
    }

    /// Refuses `J <= 0`.
    pub fn check(&self, at: &Instant) -> Result<(), Inadmissible> {
        self.each(at.parallel, |cell| cell.check(&self.matter, at.u), |_, found| found)
    }

    /// The electric energy `-int Omega dX`; nothing where `J <= 0`.
    pub fn energy(&self, at: &Instant) -> Option<f64> {
        self.check(at).ok()?;
        let mut energy = 0.0;
        let add = |_: &[u32], own: f64| {
            energy -= own;
            Ok(())
        };
        self.each(at.parallel, |cell| cell.enthalpy(&self.matter, at.u), add).ok()?;
        Some(energy)
    }

    /// The largest true field of every cell; nothing where `J <= 0`.
    pub fn largest_fields(&self, at: &Instant) -> Option<Vec<(u32, f64)>> {
        self.check(at).ok()?;
        let mut all = Vec::new();
        let of = |cell: &Cell| {
            let field = |q: usize| self.matter.true_field(&cell.strained(&cell.place(q), at.u)).1;
            (cell.part.cells[cell.index], (0..cell.points()).map(field).fold(0.0, f64::max))
        };
        let add = |_: &[u32], own| {
            all.push(own);
            Ok(())
        };
        self.each(at.parallel, of, add).ok()?;
        Some(all)
    }

    /// Their nodes, each once, ascending.
    pub fn nodes(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.points.parts.iter().flat_map(|part| part.nodes.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

impl ContributionPoint for MatterCells {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (n, matter) = (self.block(), &self.matter);
        if demand.energy {
            let add = |_: &[u32], own: f64| {
                sums.energy += own;
                sums.energy_scale += own.abs();
                Ok(())
            };
            self.each(at.parallel, |cell| cell.enthalpy(matter, at.u), add)?;
        }
        if demand.force {
            let add = |nodes: &[u32], own: Vec<f64>| {
                for (k, own) in own.into_iter().enumerate() {
                    let dof = n * nodes[k / n] as usize + k % n;
                    sums.force[dof] += own;
                    sums.force_scale[dof] += own.abs();
                }
                Ok(())
            };
            let of = |cell: &Cell| cell.spread(|place| matter.duals(&cell.strained(place, at.u)));
            self.each(at.parallel, of, add)?;
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let add = |nodes: &[u32], own: Vec<f64>| Ok(tangent.add_pairs(nodes, &own)?);
        self.each(at.parallel, |cell| cell.tangent(&self.matter, at.u), add)
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let of =
            |cell: &Cell, place: &Place| self.matter.at(&cell.strained(place, at.u)).change(&cell.gradients(place, v));
        self.add_spread(at.parallel, of, out)?;
        Ok(true)
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let of = |cell: &Cell, place: &Place| {
            let value = cell.strained(place, at.u);
            let [first, second] = [lambda, along.u].map(|v| cell.gradients(place, v));
            let numbers: Gradients<HyperDual> = std::array::from_fn(|i| {
                std::array::from_fn(|c| HyperDual([value[i][c], first[i][c], second[i][c], 0.0]))
            });
            self.matter.duals(&numbers).map(|row| row.map(HyperDual::both))
        };
        Ok(self.add_spread(at.parallel, of, &mut into.u)?)
    }
}
