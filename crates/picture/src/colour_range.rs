//! [`ColourRange`]: the range of a colour bar, in which a few values far from all others do not decide the colours of the rest.

use super::body::{Appearance, Body, FieldValues};
use super::face::Face;
use super::vector::{V3, cross, length, sub};

/// Shares of the area at and below which the ends of the bar lie.
const SHARES: [f64; 2] = [0.01, 0.99];
/// The ends are those of all values unless these span more than this many times as much.
const WIDER: f64 = 1.5;
/// Values that stand for those of one body.
const KEPT: usize = 1024;

/// The values of fields, weighted by the area that has them.
#[derive(Clone, Debug, Default)]
pub(super) struct ColourValues {
    /// Values with their areas.
    weighted: Vec<(f64, f64)>,
    /// The least and the largest value.
    ends: Option<[f64; 2]>,
}

/// Where a colour bar begins and ends, and whether values lie beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourRange {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Whether there are values below, and above.
    pub beyond: [bool; 2],
}

impl ColourValues {
    /// Adds what is seen of a body that is coloured by a field.
    pub fn add(&mut self, body: &Body) {
        let Appearance::Field(field) = &body.appearance else { return };
        let drawn = |node: &u32| body.part.as_ref().is_none_or(|marked| marked[*node as usize]);
        let mut own: Vec<(f64, f64)> = Vec::new();
        for face in Face::all(&body.mesh).iter().filter(|face| face.nodes.iter().all(drawn)) {
            let corners: Vec<V3> =
                face.nodes[..face.kind.corners()].iter().map(|node| body.positions[*node as usize]).collect();
            let area = area(&corners);
            match &field.values {
                FieldValues::Cells(values) => own.push((values[face.cell], area)),
                FieldValues::Nodes(values) => {
                    let share = area / face.nodes.len() as f64;
                    own.extend(face.nodes.iter().map(|node| (values[*node as usize], share)));
                }
            }
        }
        own.retain(|(value, area)| value.is_finite() && area.is_finite());
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let (Some(first), Some(last)) = (own.first(), own.last()) {
            let [low, high] = self.ends.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            self.ends = Some([low.min(first.0), high.max(last.0)]);
        }
        self.weighted.extend(thinned(&own));
    }

    /// Adds those of other pictures.
    pub fn join(&mut self, others: &Self) {
        self.weighted.extend_from_slice(&others.weighted);
        self.ends = match (self.ends, others.ends) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (own, others) => own.or(others),
        };
    }

    /// The range of all values; where a hundredth of the area at either end makes it wider by half, that without it.
    pub fn range(&self) -> Option<ColourRange> {
        let [low, high] = self.ends?;
        let whole = ColourRange { low, high, beyond: [false; 2] };
        let mut sorted = self.weighted.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sorted.iter().map(|(_, area)| area).sum();
        let at = |share: f64| {
            let mut below = 0.0;
            let found = sorted.iter().find(|(_, area)| {
                below += area;
                below >= share * total
            });
            found.map(|(value, _)| *value)
        };
        let (Some(least), Some(most)) = (at(SHARES[0]), at(SHARES[1])) else { return Some(whole) };
        if least >= most || high - low <= WIDER * (most - least) {
            return Some(whole);
        }
        Some(ColourRange { low: least, high: most, beyond: [low < least, high > most] })
    }

    /// Of a range that is given: whether values lie beyond.
    pub fn beyond(&self, low: f64, high: f64) -> [bool; 2] {
        self.ends.map_or([false; 2], |[least, most]| [least < low, most > high])
    }
}

/// At most [`KEPT`] values in order that have the areas of all.
fn thinned(sorted: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if sorted.len() <= KEPT {
        return sorted.to_vec();
    }
    let total: f64 = sorted.iter().map(|(_, area)| area).sum();
    let each = total / KEPT as f64;
    let (mut out, mut sum) = (Vec::with_capacity(KEPT + 1), 0.0);
    for (value, area) in sorted {
        sum += area;
        if sum >= each {
            out.push((*value, sum));
            sum = 0.0;
        }
    }
    out.extend(sorted.last().filter(|_| sum > 0.0).map(|last| (last.0, sum)));
    out
}

/// Of a polygon, whose corners lie nearly in a plane.
fn area(corners: &[V3]) -> f64 {
    let triangle = |pair: &[V3]| 0.5 * length(cross(sub(pair[0], corners[0]), sub(pair[1], corners[0])));
    corners.get(1..).unwrap_or_default().windows(2).map(triangle).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(weighted: &[(f64, f64)]) -> ColourValues {
        let ends = weighted.iter().fold([f64::MAX, f64::MIN], |[low, high], (x, _)| [low.min(*x), high.max(*x)]);
        ColourValues { weighted: weighted.to_vec(), ends: Some(ends) }
    }

    #[test]
    fn a_corner_does_not_decide_the_colours() {
        let mut values: Vec<(f64, f64)> = (0..=1000).map(|k| (f64::from(k) * 1e-3, 1.0)).collect();
        // even values are shown whole
        assert_eq!(of(&values).range(), Some(ColourRange { low: 0.0, high: 1.0, beyond: [false; 2] }));
        values.push((50.0, 1.0));
        let range = of(&values).range().unwrap();
        assert!((range.high - 0.99).abs() < 0.01 && range.low < 0.02 && range.beyond[1], "{range:?}");
        // by area, not by count
        values.push((50.0, 500.0));
        assert_eq!(of(&values).range().map(|range| (range.high, range.beyond[1])), Some((50.0, false)));
        // one value
        assert_eq!(of(&[(2.0, 1.0)]).range(), Some(ColourRange { low: 2.0, high: 2.0, beyond: [false; 2] }));
    }

    #[test]
    fn thinning_keeps_areas() {
        let many: Vec<(f64, f64)> = (0..100_000).map(|k| (f64::from(k), 1.0)).collect();
        let few = thinned(&many);
        assert!(few.len() <= KEPT + 1);
        assert!((few.iter().map(|(_, area)| area).sum::<f64>() - 1e5).abs() < 1e-6);
    }
}
