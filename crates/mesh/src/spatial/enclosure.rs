//! A proof that a convex hull lies in a solid, or does after a small shift.
//!
//! A connected set that holds a point of the solid and meets no boundary face lies in the solid. The hulls asked about
//! have corners on the boundary, so they are pushed inwards first: the shift is what the proof costs.

use super::V;
use super::boundary::Facet;
use super::interpolation_error::InterpolationError;
use super::shape::Shape;
use super::tree::Aabb;

/// Facets that are cut in one proof.
const MAX_CUTS: usize = 200;
/// Facets whose normals determine the inward direction.
const MAX_NORMALS: usize = 400;
/// Axes tried per facet, besides its own normal and the coordinate axes.
const MAX_AXES: usize = 10;

/// The convex hull of points with all that a deviation may add to it, and how far it reaches along some axes.
struct Hull<'a> {
    points: &'a [V],
    deviation: &'a InterpolationError,
    /// Moved by minus this.
    shift: V,
    reach: Vec<(V, f64, f64)>,
}

impl Shape {
    /// A shift (at most `slack`) that brings the convex hull of `points`, which belong to the solid, with all that
    /// `deviation` may add to it, wholly into the solid. `None`: not proven.
    pub(super) fn shift_into(&self, points: &[V], deviation: &InterpolationError, slack: f64) -> Option<f64> {
        let mut hull = Hull { points, deviation, shift: V::zeros(), reach: Vec::with_capacity(MAX_AXES + 3) };
        [V::x(), V::y(), V::z()].iter().for_each(|axis| hull.add(axis));
        let normals = self.normals_in_the_way(&hull)?;
        if normals.is_empty() {
            return self.has_centre(&hull).then_some(0.0);
        }
        let outwards = common_direction(&normals)?;
        let shift = slack.min(0.5 * hull.bounds().diagonal());
        hull.add(&outwards);
        normals.iter().for_each(|n| hull.add(n));
        hull.push(&(outwards * shift));
        (shift > 0.0 && self.clear(&hull, 0.1 * shift) && self.has_centre(&hull)).then_some(shift)
    }

    fn has_centre(&self, hull: &Hull) -> bool {
        let centre = hull.points.iter().sum::<V>() / hull.points.len() as f64 - hull.shift;
        self.cells.find(&centre, None).is_some()
    }

    /// Unit normals of the facets that may meet the hull; `None` if there are too many.
    fn normals_in_the_way(&self, hull: &Hull) -> Option<Vec<V>> {
        let mut normals = Vec::new();
        self.boundary.tree.overlapping(&hull.bounds(), |facet| {
            let facet = &self.boundary.facets[facet];
            if !hull.misses(facet) {
                normals.push(facet.normal);
            }
            normals.len() > MAX_NORMALS
        });
        (normals.len() <= MAX_NORMALS).then_some(normals)
    }

    /// Does no boundary facet meet the hull? Facets that sag more than `fine` are cut where they are too coarse to
    /// show.
    fn clear(&self, hull: &Hull, fine: f64) -> bool {
        let mut budget = MAX_CUTS;
        let mut met = false;
        self.boundary.tree.overlapping(&hull.bounds(), |facet| {
            met = !self.clears(hull, &self.boundary.facets[facet], fine, &mut budget);
            met
        });
        !met
    }

    fn clears(&self, hull: &Hull, facet: &Facet, fine: f64, budget: &mut usize) -> bool {
        if hull.misses(facet) {
            return true;
        }
        if facet.sag <= fine || *budget == 0 {
            return false;
        }
        *budget -= 1;
        let mut missed = true;
        self.boundary.split(facet, |part| {
            missed = self.clears(hull, part, fine, budget);
            !missed
        });
        missed
    }
}

impl Hull<'_> {
    fn along(&self, axis: &V) -> (f64, f64) {
        let (lo, hi) = extent(self.points, axis);
        let (less, more) = self.deviation.extent(axis);
        let shift = self.shift.dot(axis);
        (lo + less - shift, hi + more - shift)
    }

    /// Another axis to distinguish facets by, if it is new and there is room.
    fn add(&mut self, axis: &V) {
        if self.reach.len() < MAX_AXES + 3 && self.reach.iter().all(|(a, _, _)| (a - axis).norm_squared() > 1e-8) {
            let (lo, hi) = self.along(axis);
            self.reach.push((*axis, lo, hi));
        }
    }

    fn push(&mut self, shift: &V) {
        self.shift += shift;
        for (axis, lo, hi) in &mut self.reach {
            let along = shift.dot(axis);
            *lo -= along;
            *hi -= along;
        }
    }

    /// The first three axes are those of the coordinates.
    fn bounds(&self) -> Aabb {
        Aabb { lo: V::from_fn(|a, _| self.reach[a].1), hi: V::from_fn(|a, _| self.reach[a].2) }
    }

    /// Is there a plane between the hull and the facet with its sag, normal to one of the axes or to the facet?
    fn misses(&self, facet: &Facet) -> bool {
        let apart = |axis: &V, lo: f64, hi: f64| {
            let (least, most) = extent(&facet.corners, axis);
            lo > most + facet.sag || hi < least - facet.sag
        };
        // A degenerate facet has the normal 0, which separates nothing.
        self.reach.iter().any(|(axis, lo, hi)| apart(axis, *lo, *hi)) || {
            let (lo, hi) = self.along(&facet.normal);
            apart(&facet.normal, lo, hi)
        }
    }
}

/// A unit vector with a positive product with all normals, about the centre of their smallest cap (Badoiu and
/// Clarkson).
fn common_direction(normals: &[V]) -> Option<V> {
    let mut centre = normals.iter().sum::<V>() / normals.len() as f64;
    let mut least = 0.0;
    for k in 0..24 {
        let unit = centre.try_normalize(1e-12)?;
        let mut worst = normals[0];
        for n in normals {
            if n.dot(&unit) < worst.dot(&unit) {
                worst = *n;
            }
        }
        least = worst.dot(&unit);
        if least > 0.6 {
            return Some(unit);
        }
        centre += (worst - centre) / (k + 2) as f64;
    }
    centre.try_normalize(1e-12).filter(|_| least > 0.05)
}

fn extent(points: &[V], axis: &V) -> (f64, f64) {
    points.iter().map(|p| p.dot(axis)).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
}
