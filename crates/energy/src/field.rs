use std::fmt;
use std::sync::Arc;

use nastic_tensor::Vec3;

use crate::EnergyError;

/// A parameter that may vary over the body: uniform, one value per mesh cell, or one per quadrature point.
///
/// Cells and points are numbered globally, over the whole mesh, so a law attached to one region still indexes its
/// fields with the mesh's own cell ids. Cloning shares the values.
#[derive(Clone, Debug, PartialEq)]
pub enum Field<T> {
    /// The same value everywhere.
    Uniform(T),
    /// One value per mesh cell.
    Cell(Arc<[T]>),
    /// One value per quadrature point of the body's rule.
    Point(Arc<[T]>),
}

/// Where a law is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialPoint {
    /// Mesh cell.
    pub cell: usize,
    /// Quadrature point, numbered over the whole mesh.
    pub point: usize,
}

/// Which value of a field is meant, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// The only one.
    Uniform,
    /// That of a cell.
    Cell(usize),
    /// That of a quadrature point.
    Point(usize),
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Entry::Uniform => Ok(()),
            Entry::Cell(c) => write!(f, " in cell {c}"),
            Entry::Point(p) => write!(f, " at quadrature point {p}"),
        }
    }
}

impl<T> From<T> for Field<T> {
    fn from(value: T) -> Self {
        Field::Uniform(value)
    }
}

impl<T: Copy> Field<T> {
    /// One value per mesh cell.
    pub fn cells(values: impl Into<Arc<[T]>>) -> Self {
        Field::Cell(values.into())
    }

    /// One value per quadrature point.
    pub fn points(values: impl Into<Arc<[T]>>) -> Self {
        Field::Point(values.into())
    }

    /// The value at a place. Lengths are proved beforehand by [`Field::check_len`].
    #[inline(always)]
    pub fn at(&self, place: MaterialPoint) -> T {
        match self {
            Field::Uniform(value) => *value,
            Field::Cell(values) => values[place.cell],
            Field::Point(values) => values[place.point],
        }
    }

    /// All values with their entries, in order.
    pub fn entries(&self) -> impl Iterator<Item = (Entry, T)> + '_ {
        let (values, kind): (&[T], fn(usize) -> Entry) = match self {
            Field::Uniform(value) => (std::slice::from_ref(value), |_| Entry::Uniform),
            Field::Cell(values) => (values, Entry::Cell),
            Field::Point(values) => (values, Entry::Point),
        };
        values.iter().enumerate().map(move |(n, v)| (kind(n), *v))
    }

    /// Checks that the field fits a body of so many cells and quadrature points.
    ///
    /// # Errors
    /// [`EnergyError::Length`] names `owner` and `name`.
    pub fn check_len(
        &self,
        owner: &'static str,
        name: &'static str,
        cells: usize,
        points: usize,
    ) -> Result<(), EnergyError> {
        let (found, expected) = match self {
            Field::Uniform(_) => return Ok(()),
            Field::Cell(values) => (values.len(), cells),
            Field::Point(values) => (values.len(), points),
        };
        let per = self.per();
        if found == expected { Ok(()) } else { Err(EnergyError::Length { owner, name, per, expected, found }) }
    }

    /// The same field with every value passed through `change`, which may refuse one.
    ///
    /// # Errors
    /// The first refusal, in the order of the values.
    pub fn try_map<U: Copy>(
        &self,
        mut change: impl FnMut(Entry, T) -> Result<U, EnergyError>,
    ) -> Result<Field<U>, EnergyError> {
        let values = self.entries().map(|(entry, v)| change(entry, v)).collect::<Result<Vec<U>, _>>()?;
        Ok(match self {
            Field::Uniform(_) => Field::Uniform(values[0]),
            Field::Cell(_) => Field::cells(values),
            Field::Point(_) => Field::points(values),
        })
    }

    fn len(&self) -> usize {
        match self {
            Field::Uniform(_) => 1,
            Field::Cell(values) | Field::Point(values) => values.len(),
        }
    }

    fn per(&self) -> &'static str {
        match self {
            Field::Uniform(_) => "body",
            Field::Cell(_) => "cell",
            Field::Point(_) => "quadrature point",
        }
    }
}

impl Field<f64> {
    /// Checks every value, which must also be finite.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] with the first value that fails, where it is, and the `requirement`.
    pub fn require(
        &self,
        owner: &'static str,
        name: &'static str,
        holds: impl Fn(f64) -> bool,
        requirement: &'static str,
    ) -> Result<(), EnergyError> {
        for (entry, value) in self.entries() {
            if !value.is_finite() {
                let requirement = "it must be a finite number";
                return Err(EnergyError::Parameter { owner, name, value, entry, requirement });
            }
            if !holds(value) {
                return Err(EnergyError::Parameter { owner, name, value, entry, requirement });
            }
        }
        Ok(())
    }

    /// Positive and finite everywhere.
    ///
    /// # Errors
    /// As [`Field::require`].
    pub fn require_positive(&self, owner: &'static str, name: &'static str) -> Result<(), EnergyError> {
        self.require(owner, name, |v| v > 0.0, "it must be positive")
    }

    /// Zero or positive, and finite, everywhere.
    ///
    /// # Errors
    /// As [`Field::require`].
    pub fn require_non_negative(&self, owner: &'static str, name: &'static str) -> Result<(), EnergyError> {
        self.require(owner, name, |v| v >= 0.0, "it must not be negative: the law would lose its polyconvexity")
    }
}

impl Field<Vec3> {
    /// The field with every direction at length one; lengths may be off by 1e-6, which covers printed digits.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, where it is, its length, and the
    /// unit vector along it.
    pub fn unit_directions(&self, owner: &'static str, name: &'static str) -> Result<Self, EnergyError> {
        self.try_map(|entry, v| {
            let length = v.norm();
            if (length - 1.0).abs() <= 1e-6 {
                return Ok(v / length);
            }
            let unit = (length > 0.0 && length.is_finite()).then(|| (v / length).into());
            Err(EnergyError::Direction { owner, name, found: v.into(), entry, length, unit })
        })
    }
}

/// Combines named fields value by value: `N` parameters in, `M` out, such as engineering constants to coefficients.
///
/// Uniform fields go with anything; the others must all be given per cell, or all per quadrature point.
///
/// # Errors
/// [`EnergyError::Mixed`] when they are not, else the first refusal of `change`.
pub fn combine<const N: usize, const M: usize>(
    owner: &'static str,
    fields: [(&'static str, &Field<f64>); N],
    change: impl Fn(Entry, [f64; N]) -> Result<[f64; M], EnergyError>,
) -> Result<[Field<f64>; M], EnergyError> {
    let varying = fields.iter().find(|(_, f)| !matches!(f, Field::Uniform(_)));
    let Some((first, lead)) = varying else {
        let values = change(Entry::Uniform, fields.map(|(_, f)| f.at(MaterialPoint { cell: 0, point: 0 })))?;
        return Ok(values.map(Field::Uniform));
    };
    for (second, f) in &fields {
        if !matches!(f, Field::Uniform(_)) && (f.per(), f.len()) != (lead.per(), lead.len()) {
            let (first_len, first_per, second_len, second_per) = (lead.len(), lead.per(), f.len(), f.per());
            return Err(EnergyError::Mixed { owner, first, first_len, first_per, second, second_len, second_per });
        }
    }
    let mut out: [Vec<f64>; M] = std::array::from_fn(|_| Vec::with_capacity(lead.len()));
    for (n, (entry, _)) in lead.entries().enumerate() {
        let values = change(entry, fields.map(|(_, f)| f.at(MaterialPoint { cell: n, point: n })))?;
        for (list, v) in out.iter_mut().zip(values) {
            list.push(v);
        }
    }
    let per_cell = matches!(lead, Field::Cell(_));
    Ok(out.map(|list| if per_cell { Field::cells(list) } else { Field::points(list) }))
}
