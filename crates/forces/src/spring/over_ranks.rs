//! A spring on a body over ranks.

use super::elsewhere::SpringElsewhere;
use super::{End, Spring};
use nastic_body::contribution::Contribution;
use nastic_body::contribution::body_point::{AttachedPoint, BodyPoint, without_rounding};
use nastic_body::discretization::parted::{Parted, all_accept, not_over_ranks};
use nastic_body::error::FemError;
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Nodes by their numbers in the whole body, each with its weight.
type Weights = Vec<(u32, f64)>;

impl Spring {
    /// The contribution of a rank, of which the lowest that has the nodes of both ends has the spring, and the others nothing but its name. Who has an end
    /// in its cells sends all ranks where it is.
    ///
    /// # Errors
    /// As [`on`](Self::on); [`FemError::Unsupported`] where no rank has the nodes of both ends.
    pub fn on_rank(&self, mesh: &Mesh, parted: &Parted) -> Result<Arc<dyn Contribution>, FemError> {
        self.check()?;
        let ground = match &self.to {
            End::Ground(place) => Some(self.ground(mesh, *place)?),
            End::Body(_) => None,
        };
        let ends = match &self.to {
            End::Ground(_) => vec![(&self.from, "from")],
            End::Body(to) => vec![(&self.from, "from"), (to, "to")],
        };
        let weights: Vec<Weights> =
            ends.iter().map(|(end, name)| self.told(mesh, parted, end, name)).collect::<Result<_, _>>()?;
        let numbers: BTreeMap<u32, u32> = parted.part.nodes().iter().copied().zip(0..).collect();
        let here = |weights: &Weights| -> Option<AttachedPoint> {
            let own = weights.iter().map(|(node, weight)| Some((*numbers.get(node)?, *weight)));
            let weights: Weights = own.collect::<Option<_>>()?;
            let position = |&(node, weight): &(u32, f64)| weight * Vec3::from(mesh.points()[node as usize]);
            Some(AttachedPoint { reference: weights.iter().map(position).sum(), weights })
        };
        let held: Option<Vec<AttachedPoint>> = weights.iter().map(here).collect();
        let own = parted.share.team().rank() as f64;
        let mut lowest = [if held.is_some() { own } else { f64::INFINITY }];
        parted.share.least(&mut lowest);
        if lowest[0] == f64::INFINITY {
            let why = "no rank has the nodes of its ends: give them to one, Mesh::part_reaching with Spring::nodes";
            return Err(not_over_ranks(&format!("the spring \"{}\"", self.name), why));
        }
        let elsewhere = || Arc::new(SpringElsewhere(self.name.clone())) as Arc<dyn Contribution>;
        let mut ends = held.filter(|_| lowest[0] == own).into_iter().flatten().chain(ground);
        let spring = match (ends.next(), ends.next()) {
            (Some(from), Some(to)) => {
                let spring = self.held_by(from, to, mesh.dim(), parted.part.diagonal());
                spring.map(|spring| Arc::new(spring) as Arc<dyn Contribution>)
            }
            _ => Ok(elsewhere()),
        };
        all_accept(Some(&parted.share), spring)
    }

    /// An end: of a place by who has the lowest cell of the whole that it is in, as [`nodes`](Self::nodes) finds it (beside a face both cells have it, to
    /// rounding), of a node set by all.
    fn told(&self, mesh: &Mesh, parted: &Parted, end: &BodyPoint, name: &str) -> Result<Weights, FemError> {
        let (share, whole) = (&parted.share, parted.part.nodes());
        match end {
            BodyPoint::At(place) => {
                let mut own = Vec::new();
                if let Some(found) = mesh.locate(*place) {
                    own.push(f64::from(parted.part.cells()[found.cell]));
                    let weights = without_rounding(found.weights).into_iter();
                    own.extend(weights.flat_map(|(node, weight)| [f64::from(whole[node as usize]), weight]));
                }
                let all = share.gather(&own)?;
                let cells = all.iter().filter_map(|told| told.split_first());
                match cells.min_by(|one, other| one.0.total_cmp(other.0)) {
                    Some((_, told)) => Ok(told.as_chunks::<2>().0.iter().map(|&[node, w]| (node as u32, w)).collect()),
                    None => {
                        let what =
                            format!("cannot hold its end \"{name}\": no rank has the place {place:?} in its cells");
                        Err(self.refuse(what))
                    }
                }
            }
            BodyPoint::Nodes(set) => {
                let nodes = mesh.node_set(set)?;
                let own: Vec<f64> = nodes.iter().map(|node| f64::from(whole[*node as usize])).collect();
                let all: BTreeSet<u32> = share.gather(&own)?.iter().flatten().map(|node| *node as u32).collect();
                if all.is_empty() {
                    return Err(
                        self.refuse(format!("cannot hold its end \"{name}\": the node set \"{set}\" has no nodes"))
                    );
                }
                let weight = 1.0 / all.len() as f64;
                Ok(all.into_iter().map(|node| (node, weight)).collect())
            }
        }
    }
}
