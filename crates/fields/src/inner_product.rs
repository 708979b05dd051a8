//! Inner products of control fields: lumped L2, in which clamping is the projection, and H1.

use crate::control_block::ControlBlock;
use crate::error::ControlError;
use crate::field_operator::{FieldOperator, Piece, is_counted, pieces_of_all};
use crate::layout::Layout;
use crate::map::WholeBody;
use nastic_fem::{Discretization, Solid};
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
    operator: FieldOperator,
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
        let masses: Vec<f64> = (0..block.basis.len()).map(|i| weights[block.first + i * block.components]).collect();
        let operator = FieldOperator::new(disc, &block.basis, gathered, &masses, block.weight * length * length)?;
        Ok(H1Block { first: block.first, components: block.components, operator })
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
            let n = block.operator.matrix.pattern().dofs();
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
            block.operator.matrix.multiply(&from, x);
        })
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        self.by_component(d, |block, x| block.operator.factor.solve(x, 1))
    }
}
