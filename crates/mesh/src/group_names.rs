//! [`GroupNames`]: the union of one or several groups of a mesh.

use crate::{Facet, Mesh, MeshError, geometry};
use std::fmt;

/// The names of one or several regions, surfaces or node sets; several mean their union.
///
/// ```
/// use nastic_mesh::{CellKind, GroupNames, box_mesh};
///
/// let mesh = box_mesh([1.0, 1.0, 1.0], [2, 2, 2], CellKind::Hex8)?;
/// assert_eq!(mesh.facets_of(&"x-".into())?.len(), 4);
/// assert_eq!(mesh.facets_of(&["x-", "x+"].into())?.len(), 8);
/// # Ok::<(), nastic_mesh::MeshError>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GroupNames(Vec<String>);

impl GroupNames {
    /// The names, in the order given.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// Whether there are several.
    pub fn are_several(&self) -> bool {
        self.0.len() > 1
    }
}

impl Mesh {
    /// Diagonal of the bounding box of the nodes of regions; of the whole mesh if `None`.
    ///
    /// # Errors
    /// A name that the mesh lacks.
    pub fn diagonal_of(&self, regions: Option<&GroupNames>) -> Result<f64, MeshError> {
        let Some(names) = regions else { return Ok(self.diagonal()) };
        let nodes = self.nodes_of_cells(&self.cells_of(names)?);
        let (low, high) = geometry::bounds(nodes.iter().map(|&node| &self.points()[node as usize]));
        Ok(geometry::norm(&geometry::minus(&high, &low)))
    }

    /// Cells of the regions, ascending, each once.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`] of the first unknown one.
    pub fn cells_of(&self, regions: &GroupNames) -> Result<Vec<u32>, MeshError> {
        union(regions, |name| self.region(name))
    }

    /// Facets of the surfaces, ascending, each once.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`] of the first unknown one.
    pub fn facets_of(&self, surfaces: &GroupNames) -> Result<Vec<Facet>, MeshError> {
        union(surfaces, |name| self.surface(name))
    }
}

fn union<'m, T: Copy + Ord + 'm>(
    names: &GroupNames,
    group: impl Fn(&str) -> Result<&'m [T], MeshError>,
) -> Result<Vec<T>, MeshError> {
    let mut all = Vec::new();
    for name in names.iter() {
        all.extend_from_slice(group(name)?);
    }
    all.sort_unstable();
    all.dedup();
    Ok(all)
}

/// `wall`, or `wall, cap` of several.
impl fmt::Display for GroupNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(", "))
    }
}

impl<T: AsRef<str> + ?Sized> From<&T> for GroupNames {
    fn from(name: &T) -> Self {
        Self(vec![name.as_ref().to_owned()])
    }
}

impl From<String> for GroupNames {
    fn from(name: String) -> Self {
        Self(vec![name])
    }
}

impl From<&Self> for GroupNames {
    fn from(names: &Self) -> Self {
        names.clone()
    }
}

impl From<Vec<String>> for GroupNames {
    fn from(names: Vec<String>) -> Self {
        Self(names)
    }
}

impl<const N: usize> From<[&str; N]> for GroupNames {
    fn from(names: [&str; N]) -> Self {
        Self(names.map(str::to_owned).to_vec())
    }
}
