//! The inner product of an ensemble's controls: every block once, in the product of the member that owns it.

use super::{Ensemble, EnsembleBlock};
use nastic_opt::{InnerProduct, Problem};

impl Ensemble {
    /// Applies an operation of the members' products, which do not couple blocks, to every block.
    fn by_owner(&self, v: &[f64], each: impl Fn(&dyn InnerProduct, &[f64]) -> Vec<f64>) -> Vec<f64> {
        let mut out = vec![0.0; v.len()];
        for (index, part) in self.parts.iter().enumerate() {
            let owned: Vec<&EnsembleBlock> = self.blocks.iter().filter(|block| block.owner == index).collect();
            if owned.is_empty() {
                continue;
            }
            let image = each(part.problem.inner_product(), &super::blocks::gather(&self.blocks, part, v));
            for block in owned {
                let local = &part.problem.layout().blocks()[block.field];
                out[block.first..block.first + block.len].copy_from_slice(local.of(&image));
            }
        }
        out
    }

    /// The diagonal, if the products of all owners have one.
    pub(super) fn collect_lumped(&self) -> Option<Vec<f64>> {
        let part = |block: &EnsembleBlock| {
            let problem = &self.parts[block.owner].problem;
            let local = &problem.layout().blocks()[block.field];
            problem.inner_product().lumped().map(|weights| local.of(weights).to_vec())
        };
        let parts: Option<Vec<Vec<f64>>> = self.blocks.iter().map(part).collect();
        parts.map(|parts| parts.concat())
    }
}

impl InnerProduct for Ensemble {
    fn len(&self) -> usize {
        self.len
    }

    fn apply(&self, v: &[f64]) -> Vec<f64> {
        self.by_owner(v, |product, v| product.apply(v))
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        self.by_owner(d, |product, d| product.riesz(d))
    }

    fn lumped(&self) -> Option<&[f64]> {
        self.lumped.as_deref()
    }
}

impl Problem for Ensemble {
    /// Every block once, in the product of the first member that uses it.
    fn inner_product(&self) -> &dyn InnerProduct {
        self
    }
}
