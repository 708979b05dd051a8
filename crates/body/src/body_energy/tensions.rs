//! Fibre tensions against what the laws bear: the limit of one family, of all families on its cells, and tensions beyond.

use super::excess_tension::ExcessTension;
use super::{BodyEnergy, Composition};
use crate::controls::Controls;
use nastic_energy::{EnergyTerm, MaterialPoint, Role, Slot, TensionBound};
use nastic_tensor::{Mat3, Vec3};

/// Tensions beyond the bound by rounding alone are within it.
const ROUNDING: f64 = 1e-9;

impl BodyEnergy {
    /// The smallest convexity bound on the tension of one family alone over its cells' points, Pa: with it and no other the survey's
    /// existence theorem covers the case. `None` if the laws state no bound.
    ///
    /// Source: survey, Prop. 1.
    pub fn fiber_limit(&self, actuation: usize) -> Option<f64> {
        self.least_of_family(actuation, |body, at| {
            let way = Way::of(&body.actuations[actuation].law, at)?;
            Some(way.limit(&body.tension_bound(at)?))
        })
    }

    /// The largest tension, Pa, that one family and all others on its cells may have at once: the smallest over its points of
    /// `1 / lambda_max(B^(-1/2) S B^(-1/2))` with `S = sum_k a_k (x) a_k`, of an isotropic law `limit / lambda_max(S)`. That of
    /// [`fiber_limit`](Self::fiber_limit) where it is alone, and where all are orthogonal; half of it beside a parallel one.
    pub fn joint_fiber_limit(&self, actuation: usize) -> Option<f64> {
        self.least_of_family(actuation, |body, at| {
            let families: Vec<_> = body.families(at).map(|(_, way)| (way, 1.0)).collect();
            Some(largest_multiple(&body.tension_bound(at)?, &families))
        })
    }

    /// Names of the other families of fibres, those whose control is a tension, on cells of an actuation; in the order of the body.
    pub fn families_beside(&self, actuation: usize) -> Vec<&str> {
        let meets = |k: usize| {
            let both = |composition: &Composition| [actuation, k].iter().all(|n| composition.actuations.contains(n));
            k != actuation && self.compositions.iter().any(both) && self.is_family(k)
        };
        let others = (0..self.actuations.len()).filter(|k| meets(*k));
        others.map(|k| self.actuations[k].name.as_str()).collect()
    }

    /// The tensions beyond what the laws bear; `None` where all are borne, or where the laws state no bound.
    pub fn excess_tension(&self, controls: &Controls) -> Option<ExcessTension> {
        let tension = |k: usize, at: MaterialPoint| controls.values(k)[at.point * self.actuations[k].law.slots().len()];
        let lengthens = |k: usize| self.places(k).any(|at| tension(k, at) > 0.0);
        let driven: Vec<usize> = (0..self.actuations.len()).filter(|&k| self.is_family(k) && lengthens(k)).collect();
        let mut worst: Option<(f64, MaterialPoint)> = None;
        for at in driven.iter().flat_map(|&k| self.places(k)) {
            let Some(bound) = self.tension_bound(at) else { continue };
            let families: Vec<_> = self.families(at).map(|(k, way)| (way, tension(k, at))).collect();
            let multiple = largest_multiple(&bound, &families);
            if multiple < 1.0 - ROUNDING && worst.is_none_or(|(least, _)| multiple < least) {
                worst = Some((multiple, at));
            }
        }
        let (multiple, at) = worst?;
        let mut tensions: Vec<(String, f64)> = self
            .families(at)
            .map(|(k, _)| (self.actuations[k].name.clone(), tension(k, at)))
            .filter(|(_, tension)| *tension > 0.0)
            .collect();
        let largest = (0..tensions.len()).reduce(|most, k| if tensions[k].1 > tensions[most].1 { k } else { most })?;
        let (actuation, tension) = tensions.remove(largest);
        Some(ExcessTension { actuation, tension, limit: multiple * tension, beside: tensions })
    }

    /// The least value over the points of a family; `None` where one of them has none, and of what is no family.
    fn least_of_family(&self, actuation: usize, of: impl Fn(&Self, MaterialPoint) -> Option<f64>) -> Option<f64> {
        self.actuations.get(actuation).filter(|_| self.is_family(actuation))?;
        let mut least: Option<f64> = None;
        for at in self.places(actuation) {
            let here = of(self, at)?;
            least = Some(least.map_or(here, |l| l.min(here)));
        }
        least
    }

    /// What the laws of a cell bear: each may carry its share, so their bounds add up. `None` if one of them states none, as one does whose
    /// numbers are slots: it states a bound of the values that it is written with alone; and none beside fibres whose tension a design scales.
    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        let here = &self.compositions[self.of_cell[at.cell] as usize].actuations;
        let own = |slot: &&Slot| slot.is_design() && !slot.is_direction();
        let scaled = |law: &dyn EnergyTerm| Way::of(law, at).is_some() && law.slots().iter().any(|slot| own(&slot));
        let is_scaled = here.iter().any(|&k| scaled(&self.actuations[k].law));
        if is_scaled || self.materials_of(at.cell).any(|law| !law.slots().is_empty()) {
            return None;
        }
        let mut bounds = self.materials_of(at.cell).map(|law| law.fiber_bound(at));
        let first = bounds.next()??;
        bounds.try_fold(first, |sum, next| Some(sum + next?))
    }

    /// The families of fibres on a cell whose control is a tension: number and way.
    fn families(&self, at: MaterialPoint) -> impl Iterator<Item = (usize, Way)> {
        let here = self.compositions[self.of_cell[at.cell] as usize].actuations.iter();
        let scalar = here.filter(|&&k| is_tension(&self.actuations[k].law));
        scalar.filter_map(move |&k| Some((k, Way::of(&self.actuations[k].law, at)?)))
    }

    fn is_family(&self, actuation: usize) -> bool {
        let law = &self.actuations[actuation].law;
        is_tension(law) && self.places(actuation).next().is_some_and(|at| Way::of(law, at).is_some())
    }

    pub(crate) fn places(&self, actuation: usize) -> impl Iterator<Item = MaterialPoint> {
        let points = self.disc.points_of_cells();
        self.actuations[actuation].cells.iter().flat_map(move |&cell| {
            let (first, count) = points[cell as usize];
            (first..first + count).map(move |point| MaterialPoint { cell: cell as usize, point })
        })
    }
}

/// Whether a law has one load as its slot, or that and its direction.
fn is_tension(law: &dyn EnergyTerm) -> bool {
    match law.slots() {
        [load] => load.role == Role::Load && !load.is_global(),
        [load, turned @ ..] => load.role == Role::Load && !load.not_negative && turned.len() == 3 && is_turned(law),
        [] => false,
    }
}

/// Whether fibres have their direction among their slots.
fn is_turned(law: &dyn EnergyTerm) -> bool {
    law.strain_map().is_none() && law.slots().iter().any(Slot::is_direction)
}

/// Which way fibres go.
#[derive(Clone, Copy)]
enum Way {
    /// Along a unit vector.
    Along(Vec3),
    /// Where a control says: `m a (x) a <= m I` whatever the unit vector a.
    Any,
}

impl Way {
    fn of(law: &dyn EnergyTerm, at: MaterialPoint) -> Option<Self> {
        if is_turned(law) { Some(Way::Any) } else { law.direction(at).map(Way::Along) }
    }

    /// The largest tension that is borne alone.
    fn limit(self, bound: &TensionBound) -> f64 {
        match self {
            Way::Along(a) => bound.along(&a),
            Way::Any => bound.in_any_direction(),
        }
    }

    /// A matrix that `a (x) a` is not above.
    fn dyad(self) -> Mat3 {
        match self {
            Way::Along(a) => a * a.transpose(),
            Way::Any => Mat3::identity(),
        }
    }
}

/// The largest s for which the tensions `s m_k` along `a_k` are borne; that of one family without the rounding of eigenvalues.
fn largest_multiple(bound: &TensionBound, families: &[(Way, f64)]) -> f64 {
    if let [(way, tension)] = families {
        return if *tension > 0.0 { way.limit(bound) / tension } else { f64::INFINITY };
    }
    // a contraction whose direction is not known helps nothing
    let counts = |(way, tension): &&(Way, f64)| *tension > 0.0 || matches!(way, Way::Along(_));
    let sum = |t: Mat3, (way, tension): &(Way, f64)| t + way.dyad() * *tension;
    bound.largest_multiple(&families.iter().filter(counts).fold(Mat3::zeros(), sum))
}
