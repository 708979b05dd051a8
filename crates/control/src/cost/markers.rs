//! [`Markers`]: squared distances of points of the body from where they were measured.

use super::position::{Shares, add_component, mean};
use super::{
    AXES, Cost, CostContext, CostForm, CostPoint, IntoCost, Key, KeyKind, Output, Partials, Reading, check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use std::sync::Arc;

/// A point of the body and where it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Its name, or its place in the table.
    pub name: String,
    /// X, its place in the reference body.
    pub reference: [f64; 3],
    /// y, where it was measured; coordinates that were not read are `None`.
    pub position: [Option<f64>; 3],
    /// s, the standard deviation of a coordinate of y.
    pub deviation: f64,
}

/// `j = weight sum_k |P_k (X_k + u(X_k) - y_k)|^2 / (2 s_k^2)` over markers k, with u interpolated in the cell of X_k and P_k the
/// coordinates that were read: half the weighted sum of squares of independent readings with the deviations s_k.
///
/// Derivatives: `dj/du [v] = weight sum_k P_k (x_k - y_k) . v(X_k) / s_k^2`, `d2j/du2 [v, w] = weight sum_k P_k v(X_k) . w(X_k) / s_k^2`, so that the matrix of Gauss and
/// Newton has no part of the cost's own. Units: none times the weight's. Source: docs/identify.md.
#[derive(Clone, Debug)]
pub struct Markers {
    markers: Vec<Marker>,
    weight: f64,
}

impl Markers {
    /// Of these markers.
    pub fn of(markers: impl Into<Vec<Marker>>) -> Self {
        Markers { markers: markers.into(), weight: 1.0 }
    }

    /// Multiplies the cost.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How they stand in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "markers",
    "weight/2 sum |x - y|^2 / s^2 over markers of the body that were measured at y with the deviation s.",
    &[
        Key::new(
            "markers",
            "A CSV file with columns X, Y, Z (at rest), x, y, z (measured), name and deviation, or rows.",
            KeyKind::Markers,
        ),
        Key::new(
            "deviation",
            "The standard deviation of a coordinate, of markers that have none of their own.",
            KeyKind::Positive { unit: "m" },
        )
        .optional(),
    ],
    |on| Markers { markers: on.get("markers")?, weight: on.weight }.bind(on.solid),
)
.square()
.reported_at("markers")
.words(|words| format!("weight/2 sum |x - y|^2 / s^2 over {}", words.text("markers")));

impl IntoCost for Markers {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("markers", self.weight)?;
        if self.markers.is_empty() {
            return refuse("there are no markers: give one at least".to_owned());
        }
        let bound: Vec<Bound> = self.markers.iter().map(|marker| bound(marker, solid)).collect::<Result<_, _>>()?;
        Ok(Box::new(OnBody { markers: bound.into(), weight }))
    }
}

fn refuse<T>(what: String) -> Result<T, ControlError> {
    Err(ControlError::Cost { what })
}

/// A marker in its cell.
fn bound(marker: &Marker, solid: &Solid) -> Result<Bound, ControlError> {
    let Marker { name, reference, position, deviation } = marker;
    let dim = solid.discretization().dim();
    if !(*deviation > 0.0 && deviation.is_finite()) {
        return refuse(format!("{name} has the deviation {deviation}; deviations are positive numbers"));
    }
    if position.iter().all(Option::is_none) {
        return refuse(format!("{name} has no measured coordinate: leave it out, or give one"));
    }
    if position.iter().flatten().chain(reference).any(|x| !x.is_finite()) {
        return refuse(format!("a coordinate of {name} is not finite"));
    }
    if dim == 2 && position[2].is_some() {
        return refuse(format!("{name} has a coordinate z, and the body is plane: leave it out"));
    }
    let located = solid.mesh().locate_inside(*reference);
    let located = located.map_err(|error| ControlError::Cost { what: format!("{name}: {error}") })?;
    let shares: Shares = located.weights.iter().filter(|(_, shape)| *shape != 0.0).copied().collect();
    Ok(Bound { name: name.clone(), shares, reference: *reference, position: *position, deviation: *deviation })
}

/// A marker with the shape functions of its cell.
#[derive(Debug)]
struct Bound {
    name: String,
    shares: Shares,
    reference: [f64; 3],
    position: [Option<f64>; 3],
    deviation: f64,
}

impl Bound {
    /// `P (X + u - y)`; zero in coordinates that were not read.
    fn gap(&self, u: &[f64], dim: usize) -> [f64; 3] {
        let moved = mean(&self.shares, u, dim);
        std::array::from_fn(|i| self.position[i].map_or(0.0, |y| self.reference[i] + moved[i] - y))
    }

    /// `P v(X)`.
    fn change(&self, v: &[f64], dim: usize) -> [f64; 3] {
        let moved = mean(&self.shares, v, dim);
        std::array::from_fn(|i| if self.position[i].is_some() { moved[i] } else { 0.0 })
    }
}

/// [`Markers`] bound to a body.
#[derive(Debug)]
struct OnBody {
    markers: Arc<[Bound]>,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "markers"
    }

    fn numbers(&self) -> Option<usize> {
        Some(self.markers.iter().map(|marker| marker.position.iter().flatten().count()).sum())
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let gaps = self.markers.iter().map(|marker| marker.gap(at.u, dim)).collect();
        Ok(Arc::new(EvaluatedCost { markers: self.markers.clone(), weight: self.weight, dim, gaps }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    markers: Arc<[Bound]>,
    weight: f64,
    dim: usize,
    /// `P_k (x_k - y_k)` by marker.
    gaps: Vec<[f64; 3]>,
}

impl EvaluatedCost {
    /// Adds `weight sum_k f_k N_k / s_k^2`.
    fn add(&self, forces: impl Iterator<Item = [f64; 3]>, out: &mut [f64]) {
        for (marker, force) in self.markers.iter().zip(forces) {
            let factor = self.weight / (marker.deviation * marker.deviation);
            for &(node, share) in &marker.shares {
                for i in 0..self.dim {
                    out[node as usize * self.dim + i] += factor * share * force[i];
                }
            }
        }
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        let square = |(marker, gap): (&Bound, &[f64; 3])| {
            gap.iter().map(|gap| (gap / marker.deviation) * (gap / marker.deviation)).sum::<f64>()
        };
        0.5 * self.weight * self.markers.iter().zip(&self.gaps).map(square).sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.add(self.gaps.iter().copied(), &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        self.add(self.markers.iter().map(|marker| marker.change(&along.u, self.dim)), &mut out.u);
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let of = |(marker, gap): (&Bound, &[f64; 3]), i: usize| {
            let target = marker.position[i]?;
            let mut partials = zero.clone();
            add_component(&marker.shares, i, self.dim, &mut partials.u);
            let output = Output::watched(format!("{}.{}", marker.name, AXES[i]), target + gap[i], "m", partials);
            Some(output.aiming(target, self.weight / (marker.deviation * marker.deviation)))
        };
        Ok(self.markers.iter().zip(&self.gaps).flat_map(|own| (0..3).filter_map(move |i| of(own, i))).collect())
    }

    fn readings(&self) -> Vec<Reading> {
        let read = |(marker, gap): (&Bound, &[f64; 3])| Reading {
            name: marker.name.clone(),
            gap: std::array::from_fn(|i| marker.position[i].map(|_| gap[i])),
            deviation: marker.deviation / self.weight.sqrt(),
        };
        self.markers.iter().zip(&self.gaps).map(read).collect()
    }
}
