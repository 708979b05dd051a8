//! [`Curvature`]: the squared deviation of the curvature of a line in the body from a wanted one.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output, Partials, check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::Located;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// `j = (weight/2) sum_i L_i (kappa_i - kappa)^2` over the inner points of a line through points of the body, with
///
/// ```text
/// kappa_i = b . (e_(i-1) x e_i) / L_i,    e_i = (x_(i+1) - x_i) / |x_(i+1) - x_i|,    L_i = (l_(i-1) + l_i) / 2
/// ```
///
/// the sine of the turn at a point over the reference length L_i of the line that belongs to it (l_i = |X_(i+1) - X_i|), counted positive
/// about the axis b. With points h apart that is the curvature of the deformed line by reference length to order h^2; a turn of more than
/// a right angle at one point is not distinguished from a smaller one. In plane strain b is the axis z.
///
/// Units: kappa 1/length; j the weight's over length. Derivatives are those of the formula. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct Curvature {
    points: Vec<[f64; 3]>,
    axis: [f64; 3],
    wanted: f64,
    weight: f64,
}

impl Curvature {
    /// Of a line through at least three points of the reference body, about an axis of any length but zero.
    pub fn of_line(points: impl Into<Vec<[f64; 3]>>, axis: [f64; 3], wanted: f64) -> Self {
        Curvature { points: points.into(), axis, wanted, weight: 1.0 }
    }

    /// Multiplies the cost.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "curvature",
    "weight/2 int (kappa - curvature)^2 along a line through points of the body, kappa its curvature about an axis.",
    &[
        Key::new("line", "The line at rest, at least three points of the body.", KeyKind::Line),
        Key::new("axis", "What is counted as positive turns about it; in plane strain z.", KeyKind::Direction)
            .optional(),
        Key::new(
            "curvature",
            "The curvature that is wanted, 1 over a radius.",
            KeyKind::Number { unit: "1/m", default: None },
        ),
    ],
    |on| {
        let plane = (on.solid.mesh().dim() == 2).then_some([0.0, 0.0, 1.0]);
        let Some(axis) = on.given("axis").or(plane) else {
            let what = "a body in space needs an \"axis\": turns about it count as positive".to_owned();
            return Err(ControlError::Cost { what });
        };
        Curvature { points: on.get("line")?, axis, wanted: on.get("curvature")?, weight: on.weight }.bind(on.solid)
    },
)
.square()
.words(|words| format!("weight/2 int (kappa - {})^2 along {}", words.text("curvature"), words.text("line")));

impl IntoCost for Curvature {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("curvature", self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what });
        let axis = Vec3::from(self.axis);
        let length = axis.norm();
        if !(length > 0.0 && length.is_finite() && self.wanted.is_finite()) {
            return refuse(format!(
                "a curvature of {} about {:?} is none; give a number and an axis",
                self.wanted, self.axis
            ));
        }
        if solid.discretization().dim() == 2 && (axis.x != 0.0 || axis.y != 0.0) {
            return refuse("a plane body bends about z: leave the axis of a curvature out, or give [0, 0, 1]".into());
        }
        if self.points.len() < 3 {
            return refuse(format!("a curvature needs a line of at least 3 points, found {}", self.points.len()));
        }
        let mut located = Vec::with_capacity(self.points.len());
        for point in &self.points {
            located.push(solid.mesh().locate_inside(*point)?);
        }
        let lengths = self.points.windows(2).map(|pair| (Vec3::from(pair[1]) - Vec3::from(pair[0])).norm());
        let lengths: Vec<f64> = lengths.collect();
        if lengths.iter().any(|&length| length <= 1e-9 * solid.mesh().diagonal()) {
            return refuse("two neighbours on the line of a curvature coincide".into());
        }
        let shares = lengths.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let line = Line { located, reference: self.points, axis: axis / length, shares };
        Ok(Box::new(OnBody { line: Arc::new(line), wanted: self.wanted, weight }))
    }
}

/// The line in the body.
#[derive(Debug)]
struct Line {
    located: Vec<Located>,
    reference: Vec<[f64; 3]>,
    axis: Vec3,
    /// `L_i` of the inner points.
    shares: Vec<f64>,
}

impl Line {
    /// The points of a nodal vector.
    fn interpolate(&self, nodal: &[f64], dim: usize) -> Vec<Vec3> {
        self.located.iter().map(|at| Vec3::from(at.interpolate(nodal, dim))).collect()
    }

    /// Adds the nodal forces of forces at the points.
    fn spread(&self, forces: &[Vec3], dim: usize, out: &mut [f64]) {
        for (at, force) in self.located.iter().zip(forces) {
            for &(node, shape) in &at.weights {
                (0..dim).for_each(|i| out[node as usize * dim + i] += shape * force[i]);
            }
        }
    }
}

/// [`Curvature`] bound to a body.
#[derive(Debug)]
struct OnBody {
    line: Arc<Line>,
    wanted: f64,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "curvature"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let moved = self.line.interpolate(at.u, dim);
        let x: Vec<Vec3> = self.line.reference.iter().zip(moved).map(|(x, u)| Vec3::from(*x) + u).collect();
        let segments: Vec<Segment> = x.windows(2).map(|pair| Segment::of(pair[1] - pair[0])).collect();
        if segments.iter().any(|segment| segment.length == 0.0) {
            let what = "two neighbours on the line of a curvature meet".to_owned();
            return Err(ControlError::Cost { what });
        }
        let (line, wanted, weight) = (self.line.clone(), self.wanted, self.weight);
        Ok(Arc::new(EvaluatedCost { line, wanted, weight, dim, segments }))
    }
}

/// A segment of the deformed line.
#[derive(Debug, Clone, Copy)]
struct Segment {
    e: Vec3,
    length: f64,
}

impl Segment {
    fn of(d: Vec3) -> Self {
        Segment { e: d / d.norm(), length: d.norm() }
    }

    /// The change of e along one of the segment.
    fn turn(&self, d: &Vec3) -> Vec3 {
        (d - self.e * self.e.dot(d)) / self.length
    }

    /// The change of [`turn`](Self::turn) of `h` when the segment changes by `d` and `h` by `dh`.
    fn turn_change(&self, h: &Vec3, d: &Vec3, dh: &Vec3) -> Vec3 {
        let de = self.turn(d);
        let inner = de * self.e.dot(h) + self.e * (de.dot(h) + self.e.dot(dh));
        (dh - inner) / self.length - self.turn(h) * (self.e.dot(d) / self.length)
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    line: Arc<Line>,
    wanted: f64,
    weight: f64,
    dim: usize,
    segments: Vec<Segment>,
}

impl EvaluatedCost {
    /// kappa at the inner points, in order.
    fn curvatures(&self) -> impl Iterator<Item = f64> {
        let turns = self.segments.windows(2).map(|pair| self.line.axis.dot(&pair[0].e.cross(&pair[1].e)));
        turns.zip(&self.line.shares).map(|(turn, share)| turn / share)
    }

    /// Derivatives of the turn `b . (e0 x e1)` by both segments.
    fn turn_partials(&self, i: usize) -> [Vec3; 2] {
        let (first, second) = (&self.segments[i], &self.segments[i + 1]);
        [first.turn(&second.e.cross(&self.line.axis)), second.turn(&self.line.axis.cross(&first.e))]
    }
}

/// Adds forces by both segments at an inner point to its points.
fn add([by_first, by_second]: [Vec3; 2], i: usize, forces: &mut [Vec3]) {
    forces[i] -= by_first;
    forces[i + 1] += by_first - by_second;
    forces[i + 2] += by_second;
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        let squares =
            self.curvatures().zip(&self.line.shares).map(|(kappa, share)| share * (kappa - self.wanted).powi(2));
        0.5 * self.weight * squares.sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let mut forces = vec![Vec3::zeros(); self.line.located.len()];
        for (i, kappa) in self.curvatures().enumerate() {
            let factor = self.weight * (kappa - self.wanted);
            add(self.turn_partials(i).map(|g| g * factor), i, &mut forces);
        }
        self.line.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let moved = self.line.interpolate(&along.u, self.dim);
        let changes: Vec<Vec3> = moved.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut forces = vec![Vec3::zeros(); moved.len()];
        for (i, kappa) in self.curvatures().enumerate() {
            let (b, share) = (&self.line.axis, self.line.shares[i]);
            let (first, second) = (&self.segments[i], &self.segments[i + 1]);
            let (d0, d1) = (&changes[i], &changes[i + 1]);
            let [g0, g1] = self.turn_partials(i);
            let slope = self.weight * (g0.dot(d0) + g1.dot(d1)) / share;
            let bent = self.weight * (kappa - self.wanted);
            let by_first = first.turn_change(&second.e.cross(b), d0, &second.turn(d1).cross(b));
            let by_second = second.turn_change(&b.cross(&first.e), d1, &b.cross(&first.turn(d0)));
            add([g0 * slope + by_first * bent, g1 * slope + by_second * bent], i, &mut forces);
        }
        self.line.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    /// The curvatures at the inner points, in order.
    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let of = |(i, (kappa, share)): (usize, (f64, &f64))| {
            let (mut partials, mut forces) = (zero.clone(), vec![Vec3::zeros(); self.line.located.len()]);
            add(self.turn_partials(i).map(|g| g / *share), i, &mut forces);
            self.line.spread(&forces, self.dim, &mut partials.u);
            Output::watched(i.to_string(), kappa, "1/m", partials).aiming(self.wanted, self.weight * share)
        };
        Ok(self.curvatures().zip(&self.line.shares).enumerate().map(of).collect())
    }

    /// Mean curvature over the line, and the one farthest from what is wanted; per metre.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let whole: f64 = self.line.shares.iter().sum();
        let mean = self.curvatures().zip(&self.line.shares).map(|(kappa, share)| kappa * share).sum::<f64>() / whole;
        let off = |kappa: &f64| (kappa - self.wanted).abs();
        let worst = self.curvatures().max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(mean);
        let figure = |name, value| Figure { kind: FigureKind::Other(name), value, unit: "1/m" };
        Ok(vec![figure("mean_curvature", mean), figure("worst_curvature", worst)])
    }
}
