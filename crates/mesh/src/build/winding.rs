//! Orientation: cells of negative volume are mirrored; cells that are flat or folded are refused.

use crate::geometry::{MAX_NODES, bounds, minus, norm};
use crate::mesh::CellBlock;
use crate::tabulated::{Gathered, Tabulated};
use crate::{CellKind, Fault};

/// Volume of a cell over (bounding diagonal)^dim, below which it counts as zero; far from the origin the rounding of the
/// coordinates gives a flat cell a larger one.
const MIN_VOLUME_RATIO: f64 = 1e-13;

/// Mirrors the cells whose Jacobian is negative throughout; returns their numbers. `label` names a cell in errors.
pub(crate) fn orient(
    blocks: &mut [CellBlock],
    points: &[[f64; 3]],
    label: impl Fn(usize) -> u64,
) -> Result<Vec<usize>, Fault> {
    let mut mended = Vec::new();
    for block in blocks {
        let kind = block.kind;
        let probe = Probe::new(kind);
        let mut gathered = Gathered::new();
        for (k, nodes) in block.nodes.chunks_exact_mut(kind.nodes()).enumerate() {
            let positions = gathered.of(nodes, points);
            let id = block.first + k;
            if probe.orientation(positions).map_err(|refusal| refusal.fault(kind, label(id)))? == Orientation::Mirrored
            {
                mirror(kind, nodes);
                mended.push(id);
            }
        }
    }
    Ok(mended)
}

/// Says which cells were mirrored.
pub(super) fn note(mended: &[usize], label: impl Fn(usize) -> u64, notes: &mut Vec<String>) {
    if let Some(&first) = mended.first() {
        let count = mended.len();
        let cells = if count == 1 { "cell" } else { "cells" };
        notes.push(format!("{count} {cells} had negative volume; winding mended (first: cell {})", label(first)));
    }
}

fn mirror(kind: CellKind, nodes: &mut [u32]) {
    let mut old = [0; MAX_NODES];
    old[..nodes.len()].copy_from_slice(nodes);
    for (node, &from) in nodes.iter_mut().zip(kind.mirror()) {
        *node = old[from];
    }
}

#[derive(PartialEq)]
enum Orientation {
    Right,
    Mirrored,
}

enum Refusal {
    Flat { volume: f64, diameter: f64 },
    Folded { lowest: f64, highest: f64 },
}

impl Refusal {
    fn fault(self, kind: CellKind, cell: u64) -> Fault {
        match self {
            Refusal::Flat { volume, diameter } => Fault::ZeroVolume { cell, kind, volume, diameter },
            Refusal::Folded { lowest, highest } => Fault::Folded { cell, kind, lowest, highest },
        }
    }
}

/// The points of a kind's default rule, then its centre (with weight 0).
struct Probe {
    dim: i32,
    points: Tabulated,
    weights: Vec<f64>,
}

impl Probe {
    fn new(kind: CellKind) -> Probe {
        let rule = kind.rule();
        Probe {
            dim: kind.dim() as i32,
            points: Tabulated::new(kind, rule.points.iter().chain([&kind.centre()])),
            weights: rule.weights.iter().copied().chain([0.0]).collect(),
        }
    }

    fn orientation(&self, positions: &[[f64; 3]]) -> Result<Orientation, Refusal> {
        let (mut volume, mut lowest, mut highest) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for (jacobian, w) in self.points.jacobians(positions).zip(&self.weights) {
            volume += w * jacobian;
            lowest = jacobian.min(lowest);
            highest = jacobian.max(highest);
        }
        let (low, high) = bounds(positions);
        let diameter = norm(&minus(&high, &low));
        let far = low.iter().chain(&high).fold(0.0f64, |far, x| far.max(x.abs()));
        let share = MIN_VOLUME_RATIO.max(16.0 * f64::EPSILON * far / diameter);
        // Written so that NaN (from overflow) is refused too.
        let solid = volume.abs() > share * diameter.powi(self.dim) && volume.is_finite();
        match solid {
            _ if lowest < 0.0 && highest > 0.0 && highest.min(-lowest) > 1e-12 * highest.max(-lowest) => {
                Err(Refusal::Folded { lowest, highest })
            }
            false => Err(Refusal::Flat { volume, diameter }),
            true if lowest > 0.0 => Ok(Orientation::Right),
            true if highest < 0.0 => Ok(Orientation::Mirrored),
            true => Err(Refusal::Folded { lowest, highest }),
        }
    }
}
