//! The shape of a body as a strain map of its laws: displacement fields by node, their gradients, and the drawn body moved by them.

use crate::body_energy::BodyEnergy;
use crate::body_energy::laws::AttachedLaw;
use crate::controls::{Controls, check_finite};
use crate::discretization::Discretization;
use crate::error::FemError;
use nastic_energy::{Field, ShapeMode, StrainMap};
use nastic_mesh::Mesh;
use nastic_tensor::HyperDual;
use std::collections::BTreeSet;

/// A displacement counts as zero below this share of the largest one of its field.
const ROUNDING: f64 = 1e-9;

/// A displacement field phi by node, a pure number per component, along which the shape of a body may change: nodes move by its amplitude times phi.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalMode {
    /// Its name.
    pub name: String,
    /// Flat, `dim` per node.
    pub values: Vec<f64>,
}

/// What a change of shape does to the cells of a body at worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeQuality {
    /// The least det G at a quadrature point: the share that is left of a volume.
    pub least_volume: f64,
    /// The cell where it is.
    pub cell: u32,
    /// The largest `(|G|^2 / 3)^(3/2) / det G`, in the plane `|G|^2 / (2 det G)` of its entries: 1 where lengths change alike in all directions.
    pub distortion: f64,
}

impl NodalMode {
    /// Of a field given by reference places; the third component of a plane body is left out.
    pub fn new(name: &str, mesh: &Mesh, phi: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let values = mesh.points().iter().flat_map(|x| phi(*x).into_iter().take(mesh.dim())).collect();
        NodalMode { name: name.to_owned(), values }
    }

    /// On the nodes of some cells, zero elsewhere, with its gradients at the quadrature points of the body.
    ///
    /// # Errors
    /// A field of the wrong length or that is not finite.
    pub fn on(self, disc: &Discretization, cells: &[u32]) -> Result<ShapeMode, FemError> {
        let (dim, found, expected) = (disc.dim(), self.values.len(), disc.dofs());
        let what = format!("mode \"{}\" of a shape", self.name);
        if found != expected {
            return Err(FemError::Length { what, found, expected });
        }
        check_finite(&what, &self.values)?;
        let own: BTreeSet<u32> = disc.mesh().nodes_of_cells(cells).into_iter().collect();
        let mut values = self.values;
        let outside = values.chunks_exact_mut(dim).zip(0..).filter(|(_, node)| !own.contains(node));
        outside.for_each(|(at, _)| at.fill(0.0));
        let gradient = Field::points(disc.points().gradients(&values));
        Ok(ShapeMode { name: self.name, gradient, nodal: values.into() })
    }
}

impl AttachedLaw {
    /// Whether it changes the shape of the body.
    pub fn is_shape(&self) -> bool {
        self.law.strain_map().is_some_and(StrainMap::is_shape)
    }

    /// The displacement fields of a change of shape along some; `None` of another law.
    pub fn shape_modes(&self) -> Option<&[ShapeMode]> {
        self.law.strain_map().map(StrainMap::shape).filter(|modes| !modes.is_empty())
    }
}

impl BodyEnergy {
    /// The change of the body's shape, with its index among the laws with slots.
    pub fn shape(&self) -> Option<(usize, &AttachedLaw)> {
        self.actuations.iter().enumerate().find(|(_, own)| own.is_shape())
    }

    /// By how much the nodes of the drawn body move along modes under these controls, flat; `None` of a body whose shape does not change, or not along modes.
    pub fn mode_displacement(&self, controls: &Controls) -> Option<Vec<f64>> {
        let (k, attached) = self.shape()?;
        let mut s = vec![0.0; self.disc.dofs()];
        for (mode, amplitude) in attached.shape_modes()?.iter().zip(controls.values(k)) {
            s.iter_mut().zip(mode.nodal.iter()).for_each(|(s, phi)| *s += amplitude * phi);
        }
        Some(s)
    }

    /// What a change of shape does to the cells at worst; `None` of a body whose shape does not change.
    pub fn shape_quality(&self, controls: &Controls) -> Option<ShapeQuality> {
        let (k, attached) = self.shape()?;
        let map = attached.law.strain_map()?;
        let mut worst = ShapeQuality { least_volume: f64::INFINITY, cell: 0, distortion: 1.0 };
        for at in self.places(k) {
            let a: Vec<HyperDual> =
                attached.slots_at(controls.values(k), at).iter().copied().map(HyperDual::constant).collect();
            let g = map.tensor(at, &a);
            let size: f64 = g.iter().flatten().map(|entry| entry.real().powi(2)).sum();
            // in the plane without the entry across it
            let (square, power) = if self.disc.dim() == 2 { ((size - 1.0) / 2.0, 1.0) } else { (size / 3.0, 1.5) };
            let volume = map.volume(at, &a).real();
            if volume < worst.least_volume || volume.is_nan() {
                (worst.least_volume, worst.cell) = (volume, at.cell as u32);
            }
            let distortion = square.powf(power) / volume;
            worst.distortion = if volume > 0.0 { worst.distortion.max(distortion) } else { f64::INFINITY };
        }
        Some(worst)
    }

    /// Refuses nodes that a change of shape moves and that `kept` names the keeper of, by node and component.
    ///
    /// # Errors
    /// [`FemError::Meaningless`] with the first one.
    pub fn check_shape<'k>(&self, kept: impl Fn(u32, usize) -> Option<&'k str>, why: &str) -> Result<(), FemError> {
        let Some((_, attached)) = self.shape() else { return Ok(()) };
        let dim = self.disc.dim();
        for mode in attached.shape_modes().unwrap_or_default() {
            let most = mode.nodal.iter().fold(0.0_f64, |most, phi| most.max(phi.abs()));
            let moved = mode.nodal.iter().enumerate().filter(|(_, phi)| phi.abs() > ROUNDING * most);
            let found = moved.map(|(dof, phi)| ((dof / dim) as u32, dof % dim, phi));
            let kept = found.into_iter().find_map(|(node, c, phi)| Some((kept(node, c)?, node, c, phi)));
            if let Some((keeper, node, c, phi)) = kept {
                let [x, y, z] = self.disc.mesh().points()[node as usize];
                let what = format!(
                    "mode \"{}\" of shape \"{}\" moves node {node} at ({x}, {y}, {z}) along {} by {phi:.3e} of its amplitude, but {keeper} {why}: \
                     let the mode be 0 there",
                    mode.name,
                    attached.name,
                    ["x", "y", "z"][c]
                );
                return Err(FemError::Meaningless { what });
            }
        }
        Ok(())
    }

    /// Refuses a second change of shape, fields of another mesh, and one that moves cells outside of its regions.
    pub(super) fn check_new_shape(&self, new: &AttachedLaw) -> Result<(), FemError> {
        let refuse = |what: String| Err(FemError::Meaningless { what });
        if let Some((_, earlier)) = self.shape() {
            return refuse(format!(
                "\"{}\" changes the shape of the body already, and a body has one such change: give \"{}\" as modes of it, or as one more surface of its skin",
                earlier.name, new.name
            ));
        }
        let modes = new.shape_modes().unwrap_or_default();
        if let Some(mode) = modes.iter().find(|mode| mode.nodal.len() != self.disc.dofs()) {
            let (what, found) = (format!("mode \"{}\" of shape \"{}\"", mode.name, new.name), mode.nodal.len());
            return Err(FemError::Length { what, found, expected: self.disc.dofs() });
        }
        let (mesh, dim) = (self.disc.mesh(), self.disc.dim());
        let other = |cell: &u32| new.cells.binary_search(cell).is_err();
        let others: Vec<u32> = (0..mesh.cells() as u32).filter(other).collect();
        let nodes: BTreeSet<u32> = mesh.nodes_of_cells(&others).into_iter().collect();
        for mode in modes {
            let most = mode.nodal.iter().fold(0.0_f64, |most, phi| most.max(phi.abs()));
            let moves = |node: &&u32| (0..dim).any(|c| mode.nodal[dim * **node as usize + c].abs() > ROUNDING * most);
            if let Some(&node) = nodes.iter().find(moves) {
                let [x, y, z] = mesh.points()[node as usize];
                return refuse(format!(
                    "mode \"{}\" of shape \"{}\" moves node {node} at ({x}, {y}, {z}), where cells outside of \"{}\" begin: let the mode be 0 there, or take \
                     their region too",
                    mode.name, new.name, new.regions
                ));
            }
        }
        Ok(())
    }
}
