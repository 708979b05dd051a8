//! Inner products of control fields: lumped L2, in which clamping is the projection, and H1.

use crate::control_block::ControlBlock;
use crate::error::ControlError;
use crate::grid::Corner;
use crate::layout::Layout;
use crate::map::{Basis, Space, WholeBody};
use crate::over_ranks::gathered;
use nastic_fem::{Discretization, Solid};
use nastic_linear::{Factor, Graph, Ordering, Pattern, Pivots, SparseMatrix, Symbolic};
use nastic_numeric::vector::axpy;
use nastic_opt::{Diagonal, InnerProduct};
use std::sync::Arc;

/// Which inner product turns derivatives into gradients.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Metric {
    /// `int m v dX`, lumped: the weight of an unknown is the integral of its basis function.
    #[default]
    L2,
    /// `int m v + length^2 grad m . grad v dX` (mass lumped): smooths the gradient over the length given. Fields by region and by point
    /// have no neighbours: the part with gradients is zero.
    H1 {
        /// The smoothing length.
        length: f64,
    },
}

/// A row of the catalogue of inner products of control fields.
#[derive(Debug, Clone, Copy)]
pub struct MetricRow {
    /// The product's name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The product, of this length if it has one.
    pub make: fn(f64) -> Metric,
}

/// Every inner product of control fields.
pub const METRICS: &[MetricRow] = &[
    MetricRow { name: "L2", about: "int m v, lumped", make: |_| Metric::L2 },
    MetricRow { name: "H1", about: "int m v + length^2 grad m . grad v", make: |length| Metric::H1 { length } },
];

/// The inner product of a layout: that of the fields, each times its [weight](Layout::weigh).
///
/// # Errors
/// A control that acts on nothing, or a smoothing length that is not positive.
pub fn inner_product(solid: &Solid, layout: &Layout, metric: Metric) -> Result<Arc<dyn InnerProduct>, ControlError> {
    let (model, disc) = (solid.model(), solid.discretization());
    let weights = lumped_weights(disc, layout)?;
    // of ranks that have a body all have it, or none: no message is left to wait for
    model.ranks().all_accept(check(&weights, layout, metric))?;
    model.ranks().all_accept(match metric {
        Metric::L2 => Diagonal::new(weights)
            .map(|diagonal| Arc::new(diagonal) as Arc<dyn InnerProduct>)
            .map_err(|e| ControlError::Cost { what: e.to_string() }),
        Metric::H1 { length } => {
            H1::new(disc, layout, &weights, length).map(|product| Arc::new(product) as Arc<dyn InnerProduct>)
        }
    })
}

fn check(weights: &[f64], layout: &Layout, metric: Metric) -> Result<(), ControlError> {
    let fail = |what: String| Err(ControlError::Cost { what });
    if let Some(i) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
        return fail(format!("unknown {i} of the controls acts on nothing (weight {})", weights[i]));
    }
    match metric {
        Metric::H1 { .. } if layout.blocks().iter().any(|block| block.knots.is_some()) => fail(
            "the H1 product of controls in time is not implemented: take L2, and costs of the control's smoothness in space and of its rate in time".to_owned(),
        ),
        Metric::H1 { length } if !(length.is_finite() && length > 0.0) => {
            fail(format!("the smoothing length of the H1 product is {length}; it is a positive length"))
        }
        Metric::L2 | Metric::H1 { .. } => Ok(()),
    }
}

/// `weight int phi_i dX` for every entry of the control vector; of fields in time times `(1/T) int phi_k dt`.
fn lumped_weights(disc: &Discretization, layout: &Layout) -> Result<Vec<f64>, ControlError> {
    let mut out = vec![0.0; layout.len()];
    for block in layout.blocks().iter().filter(|block| is_counted(disc, &block.basis)) {
        let mut at_instant = vec![0.0; block.size()];
        for (q, w) in block.basis.weights(disc).iter().enumerate() {
            for (i, shape) in block.basis.at_point(q) {
                for c in 0..block.components {
                    at_instant[i * block.components + c] += block.weight * w * shape;
                }
            }
        }
        let shares = block.knots.as_ref().map_or(vec![1.0], |knots| knots.shares());
        let own = out[block.first..].chunks_exact_mut(at_instant.len().max(1));
        own.zip(shares).for_each(|(out, share)| axpy(share, &at_instant, out));
    }
    WholeBody::of(disc).add_up(&mut out)?;
    Ok(out)
}

/// Whether this rank counts a field in sums over ranks: fields over a body at the points of each, what is a contribution's own on the first alone, as all have it.
fn is_counted(disc: &Discretization, basis: &Basis) -> bool {
    !basis.is_of_contribution() || disc.over_ranks().is_none_or(|(_, share)| share.team().leads())
}

/// The consistent mass times m for one component: `int phi_i m dX`; over ranks the share of this one.
pub(crate) fn mass_product(disc: &Discretization, basis: &Basis, m: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; basis.len()];
    if !is_counted(disc, basis) {
        return out;
    }
    for (q, w) in basis.weights(disc).iter().enumerate() {
        let value: f64 = basis.at_point(q).map(|(i, shape)| shape * m[i]).sum();
        basis.at_point(q).for_each(|(i, shape)| out[i] += w * shape * value);
    }
    out
}

/// The stiffness times m for one component: `int grad phi_i . grad m dX`, or its analogue over faces; over ranks the share of this one.
pub(crate) fn stiffness_product(disc: &Discretization, basis: &Basis, m: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; basis.len()];
    if !is_counted(disc, basis) {
        return out;
    }
    for_each_stiffness(disc, basis, |unknowns, local| {
        let n = unknowns.len();
        for (a, &i) in unknowns.iter().enumerate() {
            let row = &local[a * n..(a + 1) * n];
            out[i as usize] += row.iter().zip(unknowns).map(|(k, &j)| k * m[j as usize]).sum::<f64>();
        }
    });
    out
}

/// Calls back with the unknowns and the dense stiffness of every cell (nodal fields), part of a cell in one grid cell (fields
/// on a grid) or inner face (cell fields).
fn for_each_stiffness(disc: &Discretization, basis: &Basis, mut each: impl FnMut(&[u32], &[f64])) {
    match basis.space() {
        Space::Uniform | Space::Region | Space::Point => {}
        Space::Cell => for_each_face(disc, basis, |pair, area, distance| {
            let k = area / distance;
            each(&pair, &[k, -k, -k, k]);
        }),
        Space::Node | Space::Grid(_) => {
            let gradients = basis.gradients(disc);
            let mut first = 0;
            let same = |a: &Vec<Corner>, b: &Vec<Corner>| a.iter().map(|(i, ..)| i).eq(b.iter().map(|(i, ..)| i));
            for points in gradients.chunk_by(same) {
                let unknowns: Vec<u32> = points[0].iter().map(|(i, ..)| *i).collect();
                let n = unknowns.len();
                let mut local = vec![0.0; n * n];
                for (basis, w) in points.iter().zip(&basis.weights(disc)[first..]) {
                    for (a, (_, _, left)) in basis.iter().enumerate() {
                        for (b, (_, _, right)) in basis.iter().enumerate() {
                            local[a * n + b] += w * (0..3).map(|j| left[j] * right[j]).sum::<f64>();
                        }
                    }
                }
                first += points.len();
                if n > 0 {
                    each(&unknowns, &local);
                }
            }
        }
    }
}

/// The unknowns on both sides of every inner face of the cells that a control acts on, its area, and the distance of the unknowns' places.
pub(crate) fn for_each_face(disc: &Discretization, basis: &Basis, mut each: impl FnMut([u32; 2], f64, f64)) {
    let mesh = disc.mesh();
    let unknown = |first: usize| basis.at_point(first).next().map_or(u32::MAX, |(i, _)| i as u32);
    let unknown_of: Vec<u32> = disc.points_of_cells().into_iter().map(|(first, _)| unknown(first)).collect();
    for &(here, there) in mesh.neighbours() {
        let (a, b) = (unknown_of[here.cell as usize], unknown_of[there.cell as usize]);
        if a == u32::MAX || b == u32::MAX {
            continue;
        }
        each([a, b], mesh.area(&[here]), distance(basis, [a, b]));
    }
    // faces to cells that other ranks have; a field that is constant in regions does not know whose they are
    let outer =
        disc.over_ranks().filter(|_| basis.space() == Space::Cell).map_or(&[][..], |(part, _)| part.outer_faces());
    for (here, there) in outer {
        let (a, b) = (unknown_of[here.cell as usize], basis.entities().binary_search(there));
        if let (false, Ok(b)) = (a == u32::MAX, b) {
            each([a, b as u32], mesh.area(&[*here]), distance(basis, [a, b as u32]));
        }
    }
}

/// The distance of the places of two unknowns.
fn distance(basis: &Basis, [a, b]: [u32; 2]) -> f64 {
    let (x, y) = (basis.positions()[a as usize], basis.positions()[b as usize]);
    (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt()
}

/// Unknowns and the dense stiffness of them.
type Piece = (Vec<u32>, Vec<f64>);

/// The pieces of [`for_each_stiffness`] of all ranks, in their order; `None` of a body that one process has.
fn pieces_of_all(disc: &Discretization, basis: &Basis) -> Result<Option<Vec<Piece>>, ControlError> {
    let Some((_, share)) = disc.over_ranks() else { return Ok(None) };
    // each behind its number of unknowns
    let mut told = Vec::new();
    if is_counted(disc, basis) {
        for_each_stiffness(disc, basis, |unknowns, local| {
            told.push(unknowns.len() as f64);
            told.extend(unknowns.iter().map(|unknown| f64::from(*unknown)));
            told.extend(local);
        });
    }
    let mut pieces = Vec::new();
    for of_rank in gathered(share, &told)? {
        let mut rest = &of_rank[..];
        while let Some((count, behind)) = rest.split_first() {
            let n = *count as usize;
            let (unknowns, behind) = behind.split_at(n.min(behind.len()));
            let (local, behind) = behind.split_at((n * n).min(behind.len()));
            pieces.push((unknowns.iter().map(|unknown| *unknown as u32).collect(), local.to_vec()));
            rest = behind;
        }
    }
    Ok(Some(pieces))
}

/// `G = M + length^2 S`, M lumped, factorised once; one scalar matrix per control field, shared by its components.
#[derive(Debug)]
struct H1 {
    len: usize,
    blocks: Vec<H1Block>,
}

#[derive(Debug)]
struct H1Block {
    first: usize,
    components: usize,
    matrix: SparseMatrix,
    factor: Factor,
}

impl H1Block {
    /// Of a field with the pieces of all ranks, where there are several.
    fn new(
        disc: &Discretization,
        block: &ControlBlock,
        gathered: Option<Vec<Piece>>,
        weights: &[f64],
        length: f64,
    ) -> Result<Self, ControlError> {
        let fail = |what: String| ControlError::Cost { what };
        let basis = &block.basis;
        let for_each_piece = |each: &mut dyn FnMut(&[u32], &[f64])| match &gathered {
            None => for_each_stiffness(disc, basis, each),
            Some(pieces) => pieces.iter().for_each(|(unknowns, local)| each(unknowns, local)),
        };
        let mut cliques: Vec<Vec<u32>> = (0..basis.len() as u32).map(|i| vec![i]).collect();
        for_each_piece(&mut |unknowns, _| cliques.push(unknowns.to_vec()));
        let graph =
            Graph::from_cliques(basis.len(), cliques.iter().map(Vec::as_slice)).map_err(|e| fail(e.to_string()))?;
        let ordering = Ordering::best(&graph, basis.positions()).map_err(|e| fail(e.to_string()))?;
        let pattern = Arc::new(Pattern::new(&graph, 1, ordering).map_err(|e| fail(e.to_string()))?);
        let mut matrix = SparseMatrix::zeros(pattern.clone());
        let mut add = |i: usize, j: usize, value: f64| {
            if let Some(at) = pattern.value_index(i, j) {
                matrix.values[at] += value;
            }
        };
        for i in 0..basis.len() {
            add(i, i, weights[block.first + i * block.components]);
        }
        for_each_piece(&mut |unknowns, local| {
            let n = unknowns.len();
            for a in 0..n {
                for b in 0..=a {
                    add(unknowns[a] as usize, unknowns[b] as usize, block.weight * length * length * local[a * n + b]);
                }
            }
        });
        let symbolic = Arc::new(Symbolic::new(&pattern));
        let factor = symbolic.factorize(&matrix, Pivots::Positive, true).map_err(|e| fail(e.to_string()))?;
        Ok(H1Block { first: block.first, components: block.components, matrix, factor })
    }
}

impl H1 {
    fn new(disc: &Discretization, layout: &Layout, weights: &[f64], length: f64) -> Result<Self, ControlError> {
        let whole = WholeBody::of(disc);
        let mut blocks = Vec::new();
        for block in layout.blocks() {
            let gathered = pieces_of_all(disc, &block.basis)?;
            // the pieces of the next one would wait for a rank that has failed
            blocks.push(whole.agreed(H1Block::new(disc, block, gathered, weights, length))?);
        }
        Ok(H1 { len: layout.len(), blocks })
    }

    /// Applies a scalar operation to every component of every block.
    fn by_component(&self, v: &[f64], each: impl Fn(&H1Block, &mut Vec<f64>)) -> Vec<f64> {
        let mut out = v.to_vec();
        for block in &self.blocks {
            let n = block.matrix.pattern().dofs();
            for c in 0..block.components {
                let entry = |i: usize| block.first + i * block.components + c;
                let mut scalar: Vec<f64> = (0..n).map(|i| v[entry(i)]).collect();
                each(block, &mut scalar);
                scalar.into_iter().enumerate().for_each(|(i, value)| out[entry(i)] = value);
            }
        }
        out
    }
}

impl InnerProduct for H1 {
    fn len(&self) -> usize {
        self.len
    }

    fn apply(&self, v: &[f64]) -> Vec<f64> {
        self.by_component(v, |block, x| {
            let from = x.clone();
            block.matrix.multiply(&from, x);
        })
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        self.by_component(d, |block, x| block.factor.solve(x, 1))
    }
}
