//! [`Pressures`]: how hard two surfaces press each other, place by place.

use super::recovery::Recovery;
use super::stencil::BeforeSurface;
use super::{Near, Surfaces, SurfacesContact};
use crate::contact::slots::scaled;
use crate::contact::stencil::{Counterpart, Stencil};
use nastic_tensor::{HyperDual, Scalar};

/// Gap, in thicknesses, beyond which a corner ignores the other surface; gaps are known up to a larger distance.
const MAX_GAP: f64 = 2.5;

/// Ratio of the facets' length on the other surface to the own one, above which its pressures have less weight.
const MIN_COARSE_RATIO: f64 = 2.5;
/// The ratio above which they have none.
const MAX_COARSE_RATIO: f64 = 5.0;

/// Pressures at the corners of the facets of both surfaces, per unit of stiffness:
///
/// ```text
/// L_c = sum_s w_s p_s (Phi_c(x_s) + Phi_c(y_s))                        what samples of either surface press with, at x_s and, on the other one, y_s
/// P_c                                                                  by these loads, of every surface alone (`Recovery`)
/// (P_c + sum_d f_cd P_d) / (1 + sum_d f_cd)                            f_cd = chi(d_s) w_cd Phi_d(y_s), s the sample at the corner
/// ```
///
/// With a stiff layer the pressures of single samples say little, and differ in how they are distributed from surface to surface: where both have samples, the gaps of
/// all of them cannot be alike, and those in front by a part of the layer carry what others do not. The sums of what either surface bears are right, and the mean of both
/// takes out most of what differs: `chi` is 1 where the sample is within the layer, and falls to zero where it is 2.5 thicknesses away. What is much coarser spreads a
/// small patch over all of a facet: `w_cd` is 1 up to 2.5 times the length of facets, and zero from 5 times on.
pub(super) struct Pressures<'a> {
    recovery: &'a Recovery,
    samples: Vec<BeforeSurface<'a>>,
    /// By the loads of their surface alone.
    own: Vec<f64>,
    /// Samples at corners that are near the other surface.
    beside: Vec<Beside>,
    /// `1 + sum_d f_cd`
    weights: Vec<f64>,
    /// What is reported.
    pub of_corners: Vec<f64>,
}

struct Beside {
    sample: usize,
    corner: usize,
    chi: f64,
    /// Corners of the other surface around its nearest point, with `w_cd Phi_d(y_s)`.
    at: Vec<(usize, f64)>,
}

impl<'a> Pressures<'a> {
    pub fn at(of: &'a SurfacesContact, near: &'a Near, u: &'a [f64]) -> Self {
        let (recovery, samples) = (&of.with.recovery, Surfaces::stencils(of, near, u));
        let (mut loads, mut beside) = (vec![0.0; recovery.areas.len()], Vec::new());
        for (number, sample) in samples.iter().enumerate() {
            let places: Vec<[f64; 3]> = sample.places.iter().map(|x| (*x).into()).collect();
            let (gap, shares) = sample.foot(&places);
            let load = sample.weight() * of.layer.pressure(1.0, gap).value;
            let other = sample.near.nodes.iter().zip(&shares);
            let at: Vec<(usize, f64)> = other
                .flat_map(|(&node, share)| recovery.of(node).iter().map(move |(c, part)| (*c, part * share)))
                .collect();
            if load > 0.0 {
                let own = sample.side.samples.parts(sample.near.sample).iter();
                let own =
                    own.flat_map(|(node, shape)| recovery.of(*node).iter().map(move |(c, part)| (*c, part * shape)));
                own.chain(at.iter().copied()).for_each(|(corner, share)| loads[corner] += share * load);
            }
            let chi = chi(gap, of.layer.thickness);
            if let Some(corner) = sample.corner().filter(|_| chi > 0.0) {
                let weighed = |(other, share)| (other, share * recovery.finer(corner, other, of.layer.dim));
                beside.push(Beside { sample: number, corner, chi, at: at.into_iter().map(weighed).collect() });
            }
        }
        let own = recovery.pressures(&loads);
        let (mut sums, mut weights) = (own.clone(), vec![1.0; own.len()]);
        for beside in &beside {
            for &(corner, share) in &beside.at {
                weights[beside.corner] += beside.chi * share;
                sums[beside.corner] += beside.chi * share * own[corner];
            }
        }
        let of_corners = sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect();
        Pressures { recovery, samples, own, beside, weights, of_corners }
    }

    /// Adds the derivatives by the unknowns of `sum_c f_c P_c`, P the reported pressures.
    pub fn add_derivatives(&self, f: &[f64], mut add: impl FnMut(usize, f64)) {
        let mut by_own: Vec<f64> = f.iter().zip(&self.weights).map(|(f, weight)| f / weight).collect();
        for beside in &self.beside {
            let (sample, scale) = (&self.samples[beside.sample], f[beside.corner] / self.weights[beside.corner]);
            if scale == 0.0 {
                continue;
            }
            let differs = |other: usize| {
                self.recovery.finer(beside.corner, other, sample.of.layer.dim)
                    * (self.own[other] - self.of_corners[beside.corner])
            };
            let of_node = |node: &u32| self.recovery.of(*node).iter().map(|(other, part)| part * differs(*other)).sum();
            let of_slots: Vec<f64> = std::iter::once(0.0).chain(sample.near.nodes.iter().map(of_node)).collect();
            let by = sample.weighed(&of_slots, |gap| chi(gap, sample.of.layer.thickness));
            sample.spread(&scaled(by, scale), &mut add);
            beside.at.iter().for_each(|&(corner, share)| by_own[corner] += scale * beside.chi * share);
        }
        let by_loads = self.recovery.pressures(&by_own);
        for sample in self.samples.iter().filter(|sample| sample.touches(&sample.of.layer)) {
            let of_slots = self.of_slots(sample, &by_loads);
            if of_slots.iter().all(|of| *of == 0.0) {
                continue;
            }
            let (pressure, here) = (sample.of.layer.pressure(1.0, sample.gap()), HyperDual::of(sample.gap()));
            let by = sample.weighed(&of_slots, |gap| pressure.along(gap - here));
            sample.spread(&scaled(by, sample.weight()), &mut add);
        }
    }

    /// Values of corners at the slots of the potential of a sample.
    fn of_slots(&self, sample: &BeforeSurface, of_corners: &[f64]) -> Vec<f64> {
        let parts = sample.side.samples.parts(sample.near.sample).iter();
        let own = parts.map(|&(node, shape)| shape * self.recovery.at(node, of_corners)).sum();
        let other = sample.near.nodes.iter().map(|&node| self.recovery.at(node, of_corners));
        std::iter::once(own).chain(other).collect()
    }
}

impl Recovery {
    /// `w_cd`: 1 where the facets around the corner d are no longer than some of those around c.
    fn finer(&self, c: usize, d: usize, dim: usize) -> f64 {
        let ratio = self.areas[d] / self.areas[c];
        let longer = if dim == 3 { ratio.sqrt() } else { ratio };
        ((MAX_COARSE_RATIO - longer) / (MAX_COARSE_RATIO - MIN_COARSE_RATIO)).clamp(0.0, 1.0)
    }
}

/// 1 within the layer, zero beyond [`MAX_GAP`], with a continuous derivative.
fn chi<T: Scalar>(gap: T, thickness: f64) -> T {
    let t = (gap / T::of(thickness) - T::of(1.0)) / T::of(MAX_GAP - 1.0);
    match t.value() {
        t if t <= 0.0 => T::of(1.0),
        t if t >= 1.0 => T::of(0.0),
        _ => T::of(1.0) - t * t * (T::of(3.0) - T::of(2.0) * t),
    }
}
