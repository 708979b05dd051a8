//! [`WholeBody`]: the numbers of a part of a body as those of the whole.

use super::Space;
use crate::error::ControlError;
use crate::grid::Grid;
use crate::over_ranks::{self, gathered};
use nastic_fem::{Discretization, Share, all_accept};
use nastic_mesh::Part;
use std::collections::BTreeSet;

/// What a rank asks the others for where it numbers the unknowns of a control field: these are those of the whole body, in the order in which one process has
/// them, on all ranks. A body that one process has is its own whole, and asks nobody.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WholeBody<'d> {
    disc: &'d Discretization,
    over: Option<(&'d Part, &'d Share)>,
}

impl<'d> WholeBody<'d> {
    pub fn of(disc: &'d Discretization) -> Self {
        WholeBody { disc, over: disc.over_ranks().map(|(part, share)| (part, share.as_ref())) }
    }

    /// The number that each number of this rank has in the whole, of nodes, cells or quadrature points as the space has unknowns on; `None`: its own.
    pub fn numbers(&self, space: Space) -> Result<Option<Vec<u32>>, ControlError> {
        let Some((part, share)) = self.over else { return Ok(None) };
        Ok(match space {
            Space::Node => Some(part.nodes().to_vec()),
            Space::Cell => Some(part.cells().to_vec()),
            Space::Point => Some(self.points(part, share)?),
            Space::Uniform | Space::Region | Space::Grid(_) => None,
        })
    }

    /// Quadrature points are numbered cell by cell, so all ranks send how many each of their cells has.
    fn points(&self, part: &Part, share: &Share) -> Result<Vec<u32>, ControlError> {
        let own = self.disc.points_of_cells();
        let told: Vec<f64> =
            part.cells().iter().zip(&own).flat_map(|(cell, (_, count))| [f64::from(*cell), *count as f64]).collect();
        let mut counts: Vec<(u32, u32)> = gathered(share, &told)?
            .iter()
            .flat_map(|of_rank| of_rank.as_chunks::<2>().0)
            .map(|&[cell, count]| (cell as u32, count as u32))
            .collect();
        counts.sort_unstable();
        let mut firsts = Vec::with_capacity(counts.len());
        let mut next = 0;
        for (_, count) in &counts {
            firsts.push(next);
            next += count;
        }
        let first = |cell: &u32| counts.binary_search_by_key(cell, |(known, _)| *known).map_or(0, |at| firsts[at]);
        let of_cell = |(cell, (_, count)): (&u32, &(usize, usize))| (first(cell)..).take(*count);
        Ok(part.cells().iter().zip(&own).flat_map(of_cell).collect())
    }

    /// Ascending numbers of all ranks, each once.
    pub fn joined(&self, own: BTreeSet<u32>) -> Result<Vec<u32>, ControlError> {
        let Some((_, share)) = self.over else { return Ok(own.into_iter().collect()) };
        let told: Vec<f64> = own.into_iter().map(f64::from).collect();
        let all: BTreeSet<u32> = gathered(share, &told)?.iter().flatten().map(|number| *number as u32).collect();
        Ok(all.into_iter().collect())
    }

    /// Sums of counts over all ranks.
    pub fn counted(&self, mut counts: Vec<f64>) -> Result<Vec<f64>, ControlError> {
        self.add_up(&mut counts)?;
        Ok(counts)
    }

    /// Numbers become their sums over all ranks.
    pub fn add_up(&self, values: &mut [f64]) -> Result<(), ControlError> {
        over_ranks::add_up(self.over.map(|(_, share)| share), values)
    }

    /// A grid over the bounding box of the points of all ranks.
    pub fn grid(&self, points: impl Iterator<Item = [f64; 3]>, cells: [u32; 3]) -> Result<Grid, ControlError> {
        let Some((_, share)) = self.over else { return Grid::over(points, cells) };
        let mut corners = [f64::INFINITY; 6];
        for x in points {
            for k in 0..3 {
                corners[k] = corners[k].min(x[k]);
                corners[3 + k] = corners[3 + k].min(-x[k]);
            }
        }
        share.least(&mut corners);
        let [low, high] = [0, 3].map(|first| [0, 1, 2].map(|k| corners[first + k]));
        Grid::over([low, high.map(|x| -x)], cells)
    }

    /// The nodes that are counted here: each node of several ranks is counted once.
    pub fn owned(&self) -> usize {
        self.over.map_or(usize::MAX, |(part, _)| part.owned())
    }

    /// What was found here, or that another rank refuses its part.
    pub fn agreed<T>(&self, found: Result<T, ControlError>) -> Result<T, ControlError> {
        all_accept(self.over.map(|(_, share)| share), found)
    }
}
