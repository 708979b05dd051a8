//! How well shaped the cells are.

use crate::geometry::{minus, norm};
use crate::tabulated::{Gathered, Tabulated};
use crate::{CellKind, Domain, Mesh};
use std::fmt;

/// Shape of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellQuality {
    /// The cell.
    pub cell: u32,
    /// Its kind.
    pub kind: CellKind,
    /// Lowest scaled Jacobian over the corners (Knupp 2003): determinant of the straight edges that meet there over
    /// the product of their lengths, 1 for square corners and for equilateral simplices, <= 0 for a bad corner.
    pub scaled_jacobian: f64,
    /// Lowest over highest det dx/dxi at the nodes and quadrature points: 1 for affine cells, <= 0 if the map turns
    /// over somewhere.
    pub jacobian_ratio: f64,
    /// Longest over shortest edge.
    pub aspect: f64,
}

/// Shapes of all cells, and the range of edge lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// By cell.
    pub cells: Vec<CellQuality>,
    /// Shortest edge, corner to corner.
    pub shortest_edge: f64,
    /// Longest edge.
    pub longest_edge: f64,
}

impl Mesh {
    /// Shapes of the cells of the reference body.
    pub fn quality(&self) -> Quality {
        self.quality_at(&self.points)
    }

    /// Shapes of the cells at other positions of the nodes, for instance deformed ones.
    pub fn quality_at(&self, positions: &[[f64; 3]]) -> Quality {
        let mut quality =
            Quality { cells: Vec::with_capacity(self.cells()), shortest_edge: f64::INFINITY, longest_edge: 0.0 };
        for block in &self.blocks {
            let judge = Judge::new(block.kind);
            let mut gathered = Gathered::new();
            for (k, nodes) in block.iter().enumerate() {
                quality.add((block.first + k) as u32, &judge, gathered.of(nodes, positions));
            }
        }
        quality
    }
}

impl Quality {
    fn add(&mut self, cell: u32, judge: &Judge, positions: &[[f64; 3]]) {
        let lengths = judge.kind.edges().iter().map(|&[i, j]| norm(&minus(&positions[j], &positions[i])));
        let (shortest, longest) = lengths.fold((f64::INFINITY, 0.0f64), |(lo, hi), l| (lo.min(l), hi.max(l)));
        self.shortest_edge = self.shortest_edge.min(shortest);
        self.longest_edge = self.longest_edge.max(longest);
        self.cells.push(CellQuality {
            cell,
            kind: judge.kind,
            scaled_jacobian: judge.scaled_jacobian(positions),
            jacobian_ratio: judge.jacobian_ratio(positions),
            aspect: longest / shortest,
        });
    }

    /// The `n` cells of lowest scaled Jacobian, worst first.
    pub fn worst(&self, n: usize) -> Vec<CellQuality> {
        let mut cells = self.cells.clone();
        cells.sort_by(|a, b| a.scaled_jacobian.total_cmp(&b.scaled_jacobian));
        cells.truncate(n);
        cells
    }

    /// The lowest scaled Jacobian.
    pub fn scaled_jacobian(&self) -> f64 {
        self.cells.iter().map(|c| c.scaled_jacobian).fold(f64::INFINITY, f64::min)
    }

    /// The lowest ratio of Jacobians within a cell.
    pub fn jacobian_ratio(&self) -> f64 {
        self.cells.iter().map(|c| c.jacobian_ratio).fold(f64::INFINITY, f64::min)
    }

    /// The highest aspect.
    pub fn aspect(&self) -> f64 {
        self.cells.iter().map(|c| c.aspect).fold(0.0, f64::max)
    }

    /// Number of cells below a scaled Jacobian.
    pub fn below(&self, scaled_jacobian: f64) -> usize {
        self.cells.iter().filter(|c| c.scaled_jacobian < scaled_jacobian).count()
    }

    /// What deserves attention before solving; empty for a good mesh. Cells are named by their number in the mesh.
    pub fn warnings(&self) -> Vec<String> {
        let turned: Vec<u32> = self.cells.iter().filter(|c| c.jacobian_ratio <= 0.0).map(|c| c.cell).collect();
        let mut warnings = Vec::new();
        if let Some(first) = turned.first() {
            let count = turned.len();
            warnings
                .push(format!("the map of {count} cells turns over at a node (first: cell {first}); expect trouble"));
        }
        let poor = self.below(MIN_SCALED_JACOBIAN);
        if let (1.., Some(worst)) = (poor, self.worst(1).first()) {
            let lowest = worst.scaled_jacobian;
            warnings.push(format!(
                "{poor} cells have a scaled Jacobian below {MIN_SCALED_JACOBIAN} (cell {}: {lowest:.3})",
                worst.cell
            ));
        }
        warnings
    }
}

/// Scaled Jacobian below which a cell is poor.
const MIN_SCALED_JACOBIAN: f64 = 0.1;

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} cells, edges {:.4e} to {:.4e}, scaled Jacobian >= {:.3}, Jacobian ratio >= {:.3}, aspect <= {:.2}",
            self.cells.len(),
            self.shortest_edge,
            self.longest_edge,
            self.scaled_jacobian(),
            self.jacobian_ratio(),
            self.aspect()
        )?;
        self.warnings().iter().try_for_each(|warning| writeln!(f, "{warning}"))
    }
}

/// What is the same for all cells of a kind.
struct Judge {
    kind: CellKind,
    /// Corners that share an edge with each corner.
    around: Vec<Vec<usize>>,
    /// Makes the scaled Jacobian of the best shape 1: edges are twice the tangents on [-1,1]^d; sin 60 degrees; ...
    factor: f64,
    /// Corners of the straight-edged cell.
    corners: Tabulated,
    /// Nodes and quadrature points.
    places: Tabulated,
}

impl Judge {
    fn new(kind: CellKind) -> Judge {
        let ends = |corner: usize| {
            let other = move |&[i, j]: &[usize; 2]| match corner {
                c if c == i => Some(j),
                c if c == j => Some(i),
                _ => None,
            };
            kind.edges().iter().filter_map(other).collect()
        };
        let straight = kind.corner_kind();
        Judge {
            kind,
            around: (0..kind.corners()).map(ends).collect(),
            factor: match (kind.domain(), kind.dim()) {
                (Domain::Box, dim) => f64::from(1u32 << dim),
                (Domain::Simplex, 2) => 2.0 / 3f64.sqrt(),
                (Domain::Simplex, _) => 2f64.sqrt(),
            },
            corners: Tabulated::new(straight, straight.reference_nodes()),
            places: Tabulated::new(kind, kind.reference_nodes().iter().chain(&kind.rule().points)),
        }
    }

    fn scaled_jacobian(&self, positions: &[[f64; 3]]) -> f64 {
        let corners = &positions[..self.around.len()];
        let at = |(c, jacobian): (usize, f64)| {
            let lengths: f64 = self.around[c].iter().map(|&o| norm(&minus(&corners[o], &corners[c]))).product();
            if lengths > 0.0 { self.factor * jacobian / lengths } else { 0.0 }
        };
        self.corners.jacobians(corners).enumerate().map(at).fold(f64::INFINITY, f64::min)
    }

    fn jacobian_ratio(&self, positions: &[[f64; 3]]) -> f64 {
        let jacobians = self.places.jacobians(positions);
        let (lowest, highest) = jacobians.fold((f64::INFINITY, 0.0f64), |(lo, hi), j| (lo.min(j), hi.max(j)));
        if highest > 0.0 { lowest / highest } else { -1.0 }
    }
}
