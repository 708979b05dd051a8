//! [`Level`]: a matrix with its smoother, and the transfer to the next level.

use std::sync::Arc;

use super::aggregation::{Aggregates, Strength};
use super::block_matrix::BlockMatrix;
use super::cell_products::CellProducts;
use super::corner_matrix::CornerCells;
use super::corners::Corners;
use super::couplings::{Couplings, Symmetric};
use super::smoother::{NotPositive, Smoother};
use super::tentative::tentative;
use super::transfer::Transfer;
use super::{galerkin, prolongator};

/// Degree of the smoothing polynomial on second-order elements.
const SECOND_ORDER_DEGREE: usize = 4;
/// Degree of the smoothing polynomial on other levels.
const DEGREE: usize = 3;
/// Share of the couplings of a level that may become strong or weak before its aggregates are formed again.
const MAX_CHANGED_SHARE: f64 = 0.05;

/// A level. Its couplings, its aggregates, and those of the next level are reused from one matrix to the next.
#[derive(Debug)]
pub(super) struct Level {
    pub matrix: BlockMatrix,
    pub smoother: Smoother,
    pub transfer: Transfer,
    /// Couplings of the next level.
    pub below: Arc<Couplings>,
    nodes: Nodes,
}

/// The nodes of the next level.
#[derive(Debug)]
enum Nodes {
    /// Nodes of this level, and which of their unknowns are fixed; where products replace the entries of this level, the cells for the entries of
    /// the next.
    Corners {
        nodes: Vec<u32>,
        fixed: Vec<bool>,
        cells: Option<CornerCells>,
    },
    Aggregates(Aggregates, Strength),
}

/// The data of the next level.
pub(super) struct Inherited {
    pub values: Vec<f64>,
    /// Modes as [`tentative`] takes them; nothing below second-order elements.
    pub modes: Option<Vec<f64>>,
}

impl Level {
    /// A level of second-order elements.
    pub fn of_corners(matrix: BlockMatrix, corners: &Corners, fixed: &[bool], parallel: bool) -> Self {
        let fixed = corners.fixed(matrix.couplings.size, fixed);
        let transfer = corners.transfer(matrix.couplings.size, &fixed);
        let nodes = Nodes::Corners { nodes: corners.nodes().to_vec(), fixed, cells: None };
        Self::new(matrix, SECOND_ORDER_DEGREE, transfer, nodes, parallel)
    }

    /// The same by products instead of entries.
    pub fn of_products(products: &dyn CellProducts, corners: &Corners, fixed: &[bool], parallel: bool) -> Self {
        let matrix = BlockMatrix::new(Couplings::unknown(3, fixed.len() / 3));
        let fixed = corners.fixed(3, fixed);
        let transfer = corners.transfer(3, &fixed);
        let cells = CornerCells::new(products.corners(), corners, parallel);
        let (smoother, below) = (Smoother::new(SECOND_ORDER_DEGREE), cells.couplings.clone());
        let nodes = Nodes::Corners { nodes: corners.nodes().to_vec(), fixed, cells: Some(cells) };
        Level { matrix, smoother, transfer, below, nodes }
    }

    /// A level with aggregates of its nodes, with this number of unknowns each; `None` if there are more of them than a share of the nodes.
    pub fn of_aggregates(matrix: BlockMatrix, unknowns: usize, most: f64, parallel: bool) -> Option<Self> {
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
            Nodes::Corners { .. } => true,
            Nodes::Aggregates(_, strength) => strength.changed(&self.matrix, parallel) <= MAX_CHANGED_SHARE,
        }
    }

    /// Makes the smoother, the prolongator and the values of the next level from those of its matrix.
    pub fn fill(&mut self, values: &[f64], modes: &[f64], parallel: bool) -> Result<Inherited, NotPositive> {
        let couplings = self.matrix.couplings.clone();
        let matrix = Symmetric { couplings: &couplings, values };
        self.smoother.fill(&self.matrix, |i| matrix.diagonal(i), parallel)?;
        match &self.nodes {
            Nodes::Corners { fixed, .. } => {
                let values = galerkin::product(&matrix, &self.transfer, &self.below, fixed, parallel);
                Ok(Inherited { values, modes: None })
            }
            Nodes::Aggregates(aggregates, _) => {
                let tentative = tentative(aggregates, modes, self.transfer.shape.0, self.transfer.shape.1, parallel);
                prolongator::smooth(&self.matrix, &self.smoother, aggregates, &tentative, &mut self.transfer, parallel);
                let values = galerkin::product(&matrix, &self.transfer, &self.below, &tentative.idle, parallel);
                Ok(Inherited { values, modes: Some(tentative.modes) })
            }
        }
    }

    /// The same for the matrix of products, on a level [of such](Self::of_products); with a bound of its largest eigenvalue.
    pub fn fill_by_products(
        &mut self,
        products: &Arc<dyn CellProducts>,
        fixed_unknowns: &[bool],
        parallel: bool,
    ) -> Result<(Inherited, f64), NotPositive> {
        self.matrix.fill(&[], Some(products), parallel);
        let blocks = products.diagonal_blocks(parallel);
        self.smoother.fill(&self.matrix, |i| blocks.get(i).map(|block| block.as_flattened()), parallel)?;
        // supported unknowns have a row of the identity, whatever the units
        let rows = blocks.as_flattened().iter().zip(fixed_unknowns).filter(|(_, fixed)| !**fixed);
        let norm = rows.map(|(row, _)| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        let norm = self.smoother.bound * norm;
        let values = match &self.nodes {
            Nodes::Corners { fixed, cells: Some(cells), .. } => cells.values(products.as_ref(), fixed, parallel),
            _ => Vec::new(),
        };
        Ok((Inherited { values, modes: None }, norm))
    }

    /// Memory, in bytes.
    pub fn bytes(&self) -> usize {
        let nodes = match &self.nodes {
            Nodes::Corners { nodes, fixed, cells } => {
                size_of_val(&nodes[..]) + fixed.len() + cells.as_ref().map_or(0, CornerCells::bytes)
            }
            Nodes::Aggregates(aggregates, strength) => aggregates.bytes() + strength.bytes(),
        };
        self.matrix.bytes() + self.smoother.bytes() + self.transfer.bytes() + nodes
    }

    /// The node of this level that a node of the next one represents.
    pub fn node_above(&self, node: usize) -> usize {
        match &self.nodes {
            Nodes::Corners { nodes, .. } => nodes[node] as usize,
            Nodes::Aggregates(aggregates, _) => aggregates.members.columns[aggregates.members.starts[node]] as usize,
        }
    }
}
