//! What is coupled with what, where its entries are stored, and matrices of such patterns.

mod assembly;
mod dissection;
pub(crate) mod element_block;
pub(crate) mod elimination;
pub(crate) mod entries;
pub(crate) mod graph;
pub(crate) mod matrix;
pub(crate) mod mixing;
pub(crate) mod multigrid_work;
pub(crate) mod operator;
pub(crate) mod ordering;
mod skew;
pub(crate) mod ties;
