//! [`Stencil`]: a sample of a surface near its counterpart; [`Counterpart`]: an obstacle or surface, which makes the stencils.

use super::bound::BoundContact;
use super::law::Pressure;
use super::layer::Layer;
use super::rubbing::Rubbing;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::{ExactContact, Touch, Touches};
use nastic_body::controls::Controls;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_tensor::HyperDual;
use nastic_tensor::Vec3;
use std::fmt::Debug;

/// A sample near its counterpart, at one displacement: a gap d that depends on *slots*, the position of the sample and the variables of the other side.
///
/// Those of an obstacle are the translation and rotation of its pose, which controls give; those of a surface are the nodes of its pieces and, for friction alone, the
/// corners of the sample's own facets, which move with the body. Pressure, friction, their derivatives and sums depend on nothing else.
pub(super) trait Stencil: Feet + Sync + Sized {
    /// Its number among all samples of the contact.
    fn number(&self) -> usize;
    /// Reference area that counts.
    fn weight(&self) -> f64;
    /// d, which determines the pressure.
    fn gap(&self) -> f64;
    /// The gap that is reported.
    fn remaining_gap(&self) -> f64 {
        self.gap()
    }
    fn touches(&self, layer: &Layer) -> bool {
        self.gap() < layer.thickness
    }
    /// `m = |dd/dx|`: the force per area is `P = p m`.
    fn steepness(&self) -> f64 {
        1.0
    }
    /// `G = dd/dz`, z the slots.
    fn gradient(&self) -> &Self::Slots;
    /// `dP/dz`
    fn push_gradient(&self, pressure: &Pressure) -> Self::Slots;
    /// `H a`, `H b` and the change of `H a` along b, H the second derivative of d. a is zero in the slots of a pose.
    fn second(&self, a: &Self::Slots, b: &Self::Slots) -> [Self::Slots; 3];

    /// Values of the slots by those of the unknowns and of a pose.
    fn slots(&self, of: impl Fn(usize) -> f64, pose: &[Vec3; 2]) -> Self::Slots;
    /// Values of the slots of a pose; zero without one.
    fn of_pose(values: &Self::Slots) -> [Vec3; 2];
    /// Force and moment about a pivot, at a displacement, on the counterpart by these forces of the residual.
    fn resultant(&self, forces: &Self::Slots, u: &[f64], pivot: &Vec3) -> [Vec3; 2];

    fn dim(&self) -> usize;
    /// The nodes that move its slots; a node that moves two appears twice.
    fn parts(&self) -> impl Iterator<Item = Part>;
    fn nodes(&self) -> Vec<u32> {
        self.parts().map(|part| part.node).collect()
    }
    /// Adds values of the slots to a vector of unknowns.
    fn spread(&self, values: &Self::Slots, mut add: impl FnMut(usize, f64)) {
        for Part { node, slot, share } in self.parts() {
            let Some(value) = values.as_ref().get(slot) else { continue };
            (0..self.dim()).for_each(|i| add(self.dim() * node as usize + i, share * value[i]));
        }
    }
    /// A matrix over slots and components as one over the unknowns of its nodes.
    fn element(&self, entry: impl Fn([usize; 2], [usize; 2]) -> f64) -> Vec<f64> {
        let (dim, parts) = (self.dim(), self.parts().collect::<Vec<_>>());
        let n = dim * parts.len();
        let of = |i: usize, j: usize| {
            let (a, b) = (&parts[i / dim], &parts[j / dim]);
            a.share * b.share * entry([a.slot, i % dim], [b.slot, j % dim])
        };
        (0..n * n).map(|at| of(at / n, at % n)).collect()
    }
    /// Its tangent over the unknowns of its nodes, in a time step as the scheme has it, and what is added to that in the
    /// [stand-in](nastic_linear::SparseMatrix::stand_in) of a general matrix.
    fn tangent(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>) -> (Vec<f64>, Option<Vec<f64>>);
    /// The same of friction by velocities alone, `factor` in the place of mu: symmetric, of no negative work.
    fn tangent_by_velocity(&self, friction: &Rubbing<'_, Self>, factor: f64) -> Vec<f64>;
    /// The change of the forces along one of the unknowns, in a time step as the scheme has it.
    fn change(&self, pressure: &Pressure, friction: Option<&Rubbing<'_, Self>>, along: &Self::Slots) -> Self::Slots;
}

/// A node that moves a slot by a share of its own displacement.
pub(super) struct Part {
    pub node: u32,
    pub slot: usize,
    pub share: f64,
}

/// The *feet* that a sample slides on: on an obstacle one, on a surface one for each piece.
pub(super) trait Feet {
    /// A vector of each slot.
    type Slots: AsRef<[Vec3]> + AsMut<[Vec3]> + Clone;

    fn feet(&self) -> usize;
    /// `P_i / p`, the share of a foot in the pressure.
    fn part(&self, foot: usize) -> f64;
    /// `v_t` on a foot, linear in the velocities of the slots.
    fn slides(&self, foot: usize, velocities: &Self::Slots) -> Vec3;
    /// Forces on the slots by a tangential force at every foot: the transpose of [`Self::slides`].
    fn spread_sliding(&self, force: impl Fn(usize) -> Vec3) -> Self::Slots;
    /// The derivative by the slots of `sum_i P_i phi(v_t,i, w_t,i)` for two fields v and w of the slots, which do not depend on them; w is zero in the slots of a pose.
    fn by_place(
        &self,
        pressure: &Pressure,
        fields: [&Self::Slots; 2],
        phi: impl Fn([HyperDual; 3], [HyperDual; 3]) -> HyperDual,
    ) -> Self::Slots;
}

/// The sample with the smallest gap, in the layer or not.
pub(super) struct Nearest {
    pub gap: f64,
    pub place: Vec3,
    /// [`Touch::sunk`]
    pub sunk: f64,
    /// [`Touch::approach`]
    pub approach: f64,
}

/// Area and spacing of the samples of a contact.
pub(super) struct Extent {
    pub area: f64,
    pub samples: usize,
    pub inset: f64,
    pub between_samples: f64,
    /// Whether it has multipliers.
    pub is_exact: bool,
}

/// A straight move of the body, and of an obstacle.
pub(super) struct Move<'a> {
    pub way: &'a [f64],
    /// The controls at the end of a load step; `None` in an iteration.
    pub to: Option<&'a Controls>,
}

/// The counterpart of the samples: an obstacle or other surfaces.
pub(super) trait Counterpart: Debug + Send + Sync + Sized + 'static {
    /// The data of its stencils at a displacement.
    type State: Clone;
    type Stencil<'a>: Stencil;
    /// Whether its stencils couple nodes outside of the pattern.
    const COUPLES_BEYOND_PATTERN: bool;

    /// The state with `all` samples, or with those near the layer.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is not admissible.
    fn state(of: &BoundContact<Self>, at: &Instant, all: bool) -> Result<Self::State, Inadmissible>;
    /// The samples of a state in the layer or, where they couple nodes outside of the pattern, near it; in the order of their numbers.
    fn stencils<'a>(of: &'a BoundContact<Self>, state: &'a Self::State, u: &'a [f64]) -> Vec<Self::Stencil<'a>>;
    /// The gaps of all samples of a state of all samples; infinite where there is no counterpart.
    fn gaps(of: &BoundContact<Self>, state: &Self::State) -> Vec<f64>;
    fn nearest(of: &BoundContact<Self>, state: &Self::State, at: &Instant) -> Option<Nearest>;
    fn extent(&self) -> Extent;
    /// The longest admissible share of a move.
    fn longest_move(of: &BoundContact<Self>, state: &Self::State, at: &Instant, by: &Move) -> f64;

    /// The reported pressures, by node.
    fn nodal_pressures(of: &BoundContact<Self>, at: &Instant) -> Vec<(u32, f64)>;
    /// The largest of them, by the largest of the samples.
    fn largest_pressure(_of: &BoundContact<Self>, _state: &Self::State, _at: &Instant, of_samples: f64) -> f64 {
        of_samples
    }
    /// [`Touches::add_pressures`]
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_pressures(
        of: &BoundContact<Self>,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        of.add_pressing(at, by, by_u, into)
    }
    /// [`Touches::between`]
    fn between(of: &BoundContact<Self>, at: &Instant, touch: &Touch) -> Option<(f64, [f64; 3])>;
    /// [`Touches::exact`]
    fn exact(_of: &BoundContact<Self>, _at: &Instant) -> Option<ExactContact> {
        None
    }
}
