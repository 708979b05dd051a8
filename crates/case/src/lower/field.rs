//! Values that vary over the body, sampled at quadrature points.

use super::array::{self, Entity, MeshArray};
use super::context::Context;
use nastic_energy::{Field, ShapeMode};
use nastic_fem::{Discretization, NodalMode, QuadraturePoints};
use nastic_language::schema::{Case, Parameter, VectorField, vector_at};
use nastic_language::syntax::At;
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;

/// Where values are wanted: points of a sampling, of which only those of the given cells matter.
pub(super) struct SamplePoints<'a> {
    pub case: &'a Case,
    pub mesh: &'a Mesh,
    sampling: &'a QuadraturePoints,
    positions: Vec<[f64; 3]>,
    wanted: Vec<bool>,
    /// Of points of the body: it, and the cells of those that matter.
    body: Option<(&'a Discretization, Vec<u32>)>,
}

impl<'a> SamplePoints<'a> {
    /// The body's own quadrature points on some cells.
    pub fn of_body(case: &'a Case, disc: &'a Discretization, cells: &[u32]) -> Self {
        let mut inside = vec![false; disc.mesh().cells()];
        cells.iter().for_each(|&cell| inside[cell as usize] = true);
        let wanted = disc.points().cells().iter().map(|&cell| inside[cell as usize]).collect();
        Self { wanted, body: Some((disc, cells.to_vec())), ..Self::of(case, disc.mesh(), disc.points()) }
    }

    /// All points of a sampling.
    pub fn of(case: &'a Case, mesh: &'a Mesh, sampling: &'a QuadraturePoints) -> Self {
        let positions = sampling.positions(mesh, None);
        let wanted = vec![true; positions.len()];
        Self { case, mesh, sampling, positions, wanted, body: None }
    }

    /// Where formulas are evaluated: at points that do not matter, at the place of one that does.
    pub fn places(&self) -> Vec<[f64; 3]> {
        self.fill(self.positions.clone())
    }

    /// A number: uniform where it is constant, else one value per point.
    pub fn number(&self, value: &Parameter, at: &At, context: &mut Context<'_>) -> Option<Field<f64>> {
        if let Some(value) = value.constant() {
            return Some(Field::Uniform(value));
        }
        if let Parameter::Cells(values) = value {
            return Some(Field::Cell(values.clone()));
        }
        self.scalars(value, at, context).map(Field::points)
    }

    /// A number at every point.
    pub fn scalars(&self, value: &Parameter, at: &At, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let values = match value {
            Parameter::Formula(formula) => {
                let values = self.each(|point| formula.at(point), 0.0);
                context.take(at, values)?
            }
            Parameter::Array(file) => {
                let array = array::read(file, at, &[1], Entity::Cell, self.case, self.mesh, context)?;
                self.sample(&array).into_iter().map(|[x, _, _]| x).collect()
            }
            Parameter::Cells(values) => self.sampling.cells().into_iter().map(|cell| values[cell as usize]).collect(),
        };
        Some(self.fill(values))
    }

    /// A unit direction. Nodal ones are normalised at the points.
    pub fn direction(&self, value: &VectorField, at: &At, context: &mut Context<'_>) -> Option<Field<Vec3>> {
        if let Some(value) = value.constant() {
            return Some(Field::Uniform(Vec3::from(value)));
        }
        let (mut values, entity) = self.vectors_of(value, at, context)?;
        if entity == Some(Entity::Node) {
            values.iter_mut().filter(|v| v.norm() > 0.0).for_each(|v| *v = v.normalize());
        }
        Some(Field::points(values))
    }

    /// A displacement field at the nodes of the cells that matter.
    pub fn mode(&self, name: &str, value: &VectorField, at: &At, context: &mut Context<'_>) -> Option<ShapeMode> {
        let (disc, cells) = self.body.as_ref()?;
        let (dim, mut values) = (self.mesh.dim(), vec![0.0; disc.dofs()]);
        let array = match value {
            VectorField::Array(file) => {
                Some(array::read(file, at, &[dim, 3], Entity::Node, self.case, self.mesh, context)?)
            }
            VectorField::Formulas(_) => None,
        };
        if array.as_ref().is_some_and(|array| array.entity != Entity::Node) {
            context.complain(at, "the nodes of the body move: an array of nodes is needed");
            return None;
        }
        for node in self.mesh.nodes_of_cells(cells) {
            let node = node as usize;
            let here = match (value, &array) {
                (VectorField::Formulas(entries), _) => {
                    context.take(at, vector_at(entries, self.mesh.points()[node]))?
                }
                (_, Some(array)) => {
                    let own = &array.values[node * array.components..][..array.components];
                    std::array::from_fn(|k| own.get(k).copied().unwrap_or(0.0))
                }
                _ => [0.0; 3],
            };
            if here[dim..].iter().any(|z| *z != 0.0) {
                context.complain(at, "the shape of a body in plane strain has no z component");
                return None;
            }
            values[dim * node..dim * (node + 1)].copy_from_slice(&here[..dim]);
        }
        context.take(at, NodalMode { name: name.to_owned(), values }.on(disc, cells))
    }

    /// A vector at every point.
    pub fn vectors(&self, value: &VectorField, at: &At, context: &mut Context<'_>) -> Option<Vec<Vec3>> {
        self.vectors_of(value, at, context).map(|(values, _)| values)
    }

    /// The same, and what the values of a file belong to.
    fn vectors_of(
        &self,
        value: &VectorField,
        at: &At,
        context: &mut Context<'_>,
    ) -> Option<(Vec<Vec3>, Option<Entity>)> {
        let (values, entity) = match value {
            VectorField::Formulas(entries) => {
                let values = self.each(|point| vector_at(entries, point), [0.0; 3]);
                (context.take(at, values)?, None)
            }
            VectorField::Array(file) => {
                let array = array::read(file, at, &[2, 3], Entity::Cell, self.case, self.mesh, context)?;
                (self.sample(&array), Some(array.entity))
            }
        };
        Some((self.fill(values).into_iter().map(Vec3::from).collect(), entity))
    }

    fn each<T: Copy, E>(&self, value: impl Fn([f64; 3]) -> Result<T, E>, none: T) -> Result<Vec<T>, E> {
        let wanted = self.positions.iter().zip(&self.wanted);
        wanted.map(|(point, wanted)| if *wanted { value(*point) } else { Ok(none) }).collect()
    }

    fn sample(&self, array: &MeshArray) -> Vec<[f64; 3]> {
        let n = array.components;
        let vector = |entry: &[f64]| std::array::from_fn(|k| entry.get(k).copied().unwrap_or(0.0));
        match array.entity {
            Entity::Node => self.sampling.interpolate(&array.values, n).chunks_exact(n).map(vector).collect(),
            Entity::Cell => {
                let of = |cell: u32| vector(&array.values[cell as usize * n..][..n]);
                self.sampling.cells().into_iter().map(of).collect()
            }
        }
    }

    /// Points that do not matter get the value of one that does: laws check all they are given.
    fn fill<T: Copy>(&self, mut values: Vec<T>) -> Vec<T> {
        if let Some(first) = self.wanted.iter().position(|wanted| *wanted) {
            let typical = values[first];
            for (value, _) in values.iter_mut().zip(&self.wanted).filter(|(_, wanted)| !**wanted) {
                *value = typical;
            }
        }
        values
    }
}
