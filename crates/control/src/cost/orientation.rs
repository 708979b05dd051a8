//! [`Orientation`]: the squared deviation of the normals of a surface from a direction.

use super::facet_tangents::{FacetTangents, area_vector};
use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output, Partials, check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// `j = (weight/2) int_{Gamma_0} |n - d|^2 dA = weight int (1 - n . d) dA` over a named surface of the reference body, with the unit
/// outward normals n of the deformed one and a preferred direction d. With the tangents t1, t2 of the deformed surface, `a = t1 x t2` and
/// `n = a / |a|`,
///
/// ```text
/// dj/du [v] = -weight int g . (dt1 x t2 + t1 x dt2) dA,    g = (d - (n . d) n) / |a|
/// ```
///
/// and `d2j/du2` differentiates g and the tangents once more. Units: area times the weight's.
/// Source: T. Guennel & R. Herzog, "Optimal control problems in finite-strain elasticity by inner pressure and fiber tension",
/// Front. Appl. Math. Stat. 2 (2016), preferred normals; docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct Orientation {
    surface: GroupNames,
    direction: [f64; 3],
    weight: f64,
}

impl Orientation {
    /// The outward normals of a named surface, or of the union of several, shall point along a direction, of any length but zero.
    pub fn surface(names: impl Into<GroupNames>, direction: [f64; 3]) -> Self {
        Orientation { surface: names.into(), direction, weight: 1.0 }
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
    "orientation",
    "weight/2 int |n - direction|^2 over a surface, n its outward unit normal in the deformed body.",
    &[Key::SURFACE, Key::new("direction", "Where its normals shall point.", KeyKind::Direction)],
    |on| {
        let (surface, direction) = (on.get("surface")?, on.get("direction")?);
        Orientation { surface, direction, weight: on.weight }.bind(on.solid)
    },
)
.square()
.reported_at("direction")
.words(|words| format!("weight/2 int |n - ({})|^2 over {}", words.text("direction"), words.place()));

impl IntoCost for Orientation {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("orientation", self.weight)?;
        let direction = Vec3::from(self.direction);
        let length = direction.norm();
        if !(length > 0.0 && length.is_finite()) {
            let what = format!("the direction {:?} of an orientation has no finite length but zero", self.direction);
            return Err(ControlError::Cost { what });
        }
        if solid.discretization().dim() == 2 && direction.z != 0.0 {
            let what = "the normals of a plane body lie in its plane: the direction of an orientation has no z";
            return Err(ControlError::Cost { what: what.to_owned() });
        }
        let tangents = Arc::new(FacetTangents::new(solid, &self.surface)?);
        Ok(Box::new(OnBody { tangents, direction: direction / length, weight }))
    }
}

/// [`Orientation`] bound to a body.
#[derive(Debug)]
struct OnBody {
    tangents: Arc<FacetTangents>,
    direction: Vec3,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "orientation"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let (mesh, dim) = (at.solid.mesh(), at.solid.discretization().dim());
        let position = |node: usize, i: usize| mesh.points()[node][i] + at.u[node * dim + i];
        let normals = (0..self.tangents.len()).map(|q| Normal::of(self.tangents.tangents(q, position, false)));
        let normals: Vec<Normal> = normals.collect();
        if normals.iter().any(|normal| !normal.n.iter().all(|n| n.is_finite())) {
            let what = "a facet of the surface of an orientation has no area left".to_owned();
            return Err(ControlError::Cost { what });
        }
        let (tangents, direction, weight) = (self.tangents.clone(), self.direction, self.weight);
        Ok(Arc::new(EvaluatedCost { tangents, direction, weight, dim, normals }))
    }
}

/// Tangents and normal of the deformed surface at a point.
#[derive(Debug)]
struct Normal {
    tangents: [Vec3; 2],
    n: Vec3,
    /// `|a|`
    area: f64,
}

impl Normal {
    fn of(tangents: [Vec3; 2]) -> Self {
        let a = area_vector(tangents);
        let area = a.norm();
        Normal { tangents, n: a / area, area }
    }

    /// `g = (d - (n . d) n) / |a|`
    fn turn(&self, d: &Vec3) -> Vec3 {
        (d - self.n * self.n.dot(d)) / self.area
    }
}

/// Unit vectors across a direction: of a plane body the one in the plane, else the axis that is most across made orthogonal, and one across both.
fn across(d: &Vec3, dim: usize) -> Vec<Vec3> {
    if dim == 2 {
        return vec![Vec3::z().cross(d)];
    }
    let less = |best: Vec3, axis| if d.dot(&axis).abs() < d.dot(&best).abs() { axis } else { best };
    let most = [Vec3::y(), Vec3::z()].into_iter().fold(Vec3::x(), less);
    let first = (most - d * d.dot(&most)).normalize();
    vec![first, d.cross(&first)]
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    tangents: Arc<FacetTangents>,
    direction: Vec3,
    weight: f64,
    dim: usize,
    normals: Vec<Normal>,
}

impl EvaluatedCost {
    /// `int f(n) dA` over the reference surface.
    fn integral(&self, f: impl Fn(&Normal) -> f64) -> f64 {
        self.normals.iter().enumerate().map(|(q, normal)| self.tangents.weight(q) * f(normal)).sum()
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.weight * self.integral(|normal| (normal.n - self.direction).norm_squared())
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        for (q, normal) in self.normals.iter().enumerate() {
            let (g, [t1, t2]) = (normal.turn(&self.direction), &normal.tangents);
            let factor = -self.weight * self.tangents.weight(q);
            self.tangents.spread(q, [&(t2.cross(&g) * factor), &(g.cross(t1) * factor)], &mut out.u);
        }
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let change = |node: usize, i: usize| along.u[node * self.dim + i];
        for (q, normal) in self.normals.iter().enumerate() {
            let (d, n, [t1, t2]) = (&self.direction, &normal.n, &normal.tangents);
            let [dt1, dt2] = self.tangents.tangents(q, change, true);
            let da = dt1.cross(t2) + t1.cross(&dt2);
            let stretch = n.dot(&da) / normal.area;
            let dn = da / normal.area - n * stretch;
            let g = normal.turn(d);
            let dg = -(n * dn.dot(d) + dn * n.dot(d)) / normal.area - g * stretch;
            let factor = -self.weight * self.tangents.weight(q);
            let first = (dt2.cross(&g) + t2.cross(&dg)) * factor;
            let second = (dg.cross(t1) + g.cross(&dt1)) * factor;
            self.tangents.spread(q, [&first, &second], &mut out.u);
        }
        Ok(())
    }

    /// The mean normal `int n dA / A` along unit vectors across the direction, in the order of the axes: sines of angles about d, which shall be 0. Near there the cost is
    /// `weight A/2` times their squares, and what the normals have among themselves.
    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let area = self.integral(|_| 1.0);
        let of = |(k, across): (usize, Vec3)| {
            let mut partials = zero.clone();
            for (q, normal) in self.normals.iter().enumerate() {
                let (g, [t1, t2]) = (normal.turn(&across), &normal.tangents);
                let factor = self.tangents.weight(q) / area;
                self.tangents.spread(q, [&(t2.cross(&g) * factor), &(g.cross(t1) * factor)], &mut partials.u);
            }
            let value = self.integral(|normal| normal.n.dot(&across)) / area;
            Output::watched(k.to_string(), value, "", partials).aiming(0.0, self.weight * area)
        };
        Ok(across(&self.direction, self.dim).into_iter().enumerate().map(of).collect())
    }

    /// Root of the mean of the squared angles between normals and direction, in radians.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let angle = |normal: &Normal| 2.0 * (0.5 * (normal.n - self.direction).norm()).min(1.0).asin();
        let mean = (self.integral(|normal| angle(normal).powi(2)) / self.integral(|_| 1.0)).sqrt();
        Ok(vec![Figure { kind: FigureKind::Other("angle"), value: mean, unit: "" }])
    }
}
