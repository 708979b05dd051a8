//! The inner product of an ensemble's controls: every block once, in the product of the member that owns it.

use crate::blocks::EnsembleBlock;
use crate::member::Member;
use nastic_opt::InnerProduct;
use std::ops::Range;
use std::sync::Arc;

/// The products of the members that own blocks; none couples two blocks.
#[derive(Debug)]
pub(crate) struct EnsembleProduct {
    len: usize,
    owners: Vec<Owner>,
    lumped: Option<Vec<f64>>,
}

/// A member's product, with the blocks it is made for and those that have it.
#[derive(Debug)]
struct Owner {
    product: Arc<dyn InnerProduct>,
    /// Where each field of the member stands in the ensemble's vector, one after the other.
    fields: Vec<Range<usize>>,
    /// Of the blocks it owns: place in the ensemble's vector, first entry in the member's.
    owned: Vec<(Range<usize>, usize)>,
}

impl EnsembleProduct {
    /// From the products of the owners, each with the member's index.
    pub fn new(blocks: &[EnsembleBlock], members: &[Member], products: Vec<(usize, Arc<dyn InnerProduct>)>) -> Self {
        let range = |block: &EnsembleBlock| block.first..block.first + block.len;
        let owner = |(index, product): (usize, Arc<dyn InnerProduct>)| {
            let local = members[index].problem.layout().blocks();
            let fields = members[index].blocks.iter().map(|&block| range(&blocks[block])).collect();
            let owned = blocks.iter().filter(|block| block.owner == index);
            let owned = owned.map(|block| (range(block), local[block.field].first)).collect();
            Owner { product, fields, owned }
        };
        let len = blocks.iter().map(|block| block.len).sum();
        let mut product = Self { len, owners: products.into_iter().map(owner).collect(), lumped: None };
        if product.owners.iter().all(|owner| owner.product.lumped().is_some()) {
            product.lumped = Some(
                product
                    .by_owner(&vec![0.0; len], |product, _| product.lumped().map(<[f64]>::to_vec).unwrap_or_default()),
            );
        }
        product
    }

    /// Applies an operation of the owners' products to every block.
    fn by_owner(&self, v: &[f64], each: impl Fn(&dyn InnerProduct, &[f64]) -> Vec<f64>) -> Vec<f64> {
        let mut out = vec![0.0; v.len()];
        for owner in &self.owners {
            let local: Vec<f64> = owner.fields.iter().flat_map(|field| &v[field.clone()]).copied().collect();
            let image = each(owner.product.as_ref(), &local);
            for (place, first) in &owner.owned {
                out[place.clone()].copy_from_slice(&image[*first..*first + place.len()]);
            }
        }
        out
    }
}

impl InnerProduct for EnsembleProduct {
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
