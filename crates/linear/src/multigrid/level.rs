//! [`Level`]: what is smoothed on, and the way to the next level.

use std::sync::Arc;

use super::aggregation::{Aggregates, Strength};
use super::block_matrix::BlockMatrix;
use super::corners::Corners;
use super::couplings::{Couplings, Symmetric};
use super::smoother::{NotPositive, Smoother};
use super::tentative::tentative;
use super::transfer::Transfer;
use super::{galerkin, prolongator};

/// Degrees of the smoothing polynomials on second-order elements and below.
const SECOND_ORDER_DEGREE: usize = 4;
const DEGREE: usize = 3;
/// Share of the couplings of a level that may become strong or weak before its aggregates are made anew.
const CHANGED: f64 = 0.05;

/// A level. Its couplings, aggregates, and those of the next level are kept from one matrix to the next.
#[derive(Debug)]
pub(super) struct Level {
    pub matrix: BlockMatrix,
    pub smoother: Smoother,
    pub transfer: Transfer,
    /// Couplings of the next level.
    pub below: Arc<Couplings>,
    nodes: Nodes,
}

/// What the nodes of the next level are.
#[derive(Debug)]
enum Nodes {
    /// Nodes of this one, and which of their unknowns are fixed.
    Corners(Vec<u32>, Vec<bool>),
    Aggregates(Aggregates, Strength),
}

/// What the next level inherits.
pub(super) struct Inherited {
    pub values: Vec<f64>,
    /// Modes as [`tentative`] takes them; nothing below second-order elements.
    pub modes: Option<Vec<f64>>,
}

impl Level {
    /// Of second-order elements.
    pub fn of_corners(matrix: BlockMatrix, corners: &Corners, fixed: &[bool], parallel: bool) -> Self {
        let transfer = corners.transfer(matrix.couplings.size, fixed);
        let nodes = Nodes::Corners(corners.nodes().to_vec(), corners.fixed(matrix.couplings.size, fixed));
        Self::new(matrix, SECOND_ORDER_DEGREE, transfer, nodes, parallel)
    }

    /// Of aggregates of its nodes with so many unknowns each; nothing where these have more than a share of the nodes.
    pub fn of_aggregates(matrix: BlockMatrix, (unknowns, most): (usize, f64), parallel: bool) -> Option<Self> {
        let strength = Strength::of(&matrix, parallel);
        let aggregates = Aggregates::new(&matrix, &strength);
        let (couplings, count) = (&*matrix.couplings, aggregates.count());
        if count == 0 || count as f64 > most * couplings.rows.rows() as f64 {
            return None;
        }
        let transfer = Transfer::new((couplings.size, unknowns), prolongator::rows(couplings, &aggregates, parallel));
        Some(Self::new(matrix, DEGREE, transfer, Nodes::Aggregates(aggregates, strength), parallel))
    }

    fn new(matrix: BlockMatrix, degree: usize, transfer: Transfer, nodes: Nodes, parallel: bool) -> Self {
        let below = galerkin::couplings(&matrix.couplings, &transfer, parallel);
        Level { matrix, smoother: Smoother::new(degree), transfer, below, nodes }
    }

    /// Whether its aggregates serve for the values of its matrix too.
    pub fn serves(&self, parallel: bool) -> bool {
        match &self.nodes {
            Nodes::Corners(..) => true,
            Nodes::Aggregates(_, strength) => strength.changed(&self.matrix, parallel) <= CHANGED,
        }
    }

    /// Makes the smoother, the prolongator and the values of the next level for those of its own matrix.
    pub fn fill(&mut self, values: &[f64], modes: &[f64], parallel: bool) -> Result<Inherited, NotPositive> {
        let couplings = self.matrix.couplings.clone();
        let matrix = Symmetric { couplings: &couplings, values };
        self.smoother.fill(&matrix, &self.matrix, parallel)?;
        match &self.nodes {
            Nodes::Corners(_, fixed) => {
                let values = galerkin::product(&matrix, &self.transfer, &self.below, fixed, parallel);
                Ok(Inherited { values, modes: None })
            }
            Nodes::Aggregates(aggregates, _) => {
                let tentative = tentative(aggregates, modes, self.transfer.shape, parallel);
                prolongator::smooth(
                    &self.matrix,
                    &self.smoother,
                    (aggregates, &tentative),
                    &mut self.transfer,
                    parallel,
                );
                let values = galerkin::product(&matrix, &self.transfer, &self.below, &tentative.idle, parallel);
                Ok(Inherited { values, modes: Some(tentative.modes) })
            }
        }
    }

    /// Memory, in bytes.
    pub fn bytes(&self) -> usize {
        let nodes = match &self.nodes {
            Nodes::Corners(nodes, fixed) => size_of_val(&nodes[..]) + fixed.len(),
            Nodes::Aggregates(aggregates, strength) => aggregates.bytes() + strength.bytes(),
        };
        self.matrix.bytes() + self.smoother.bytes() + self.transfer.bytes() + nodes
    }

    /// The node of this level that a node of the next one stands for.
    pub fn node_above(&self, node: usize) -> usize {
        match &self.nodes {
            Nodes::Corners(nodes, _) => nodes[node] as usize,
            Nodes::Aggregates(aggregates, _) => aggregates.members.columns[aggregates.members.starts[node]] as usize,
        }
    }
}
