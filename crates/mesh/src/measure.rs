//! Lengths, areas and volumes of cells, regions and surfaces.

use crate::geometry::norm;
use crate::tabulated::{Gathered, Tabulated};
use crate::{CellKind, Facet, Mesh, MeshError};
use std::collections::BTreeMap;
use std::fmt;

impl Mesh {
    /// Volume of every cell (area, in the plane) at `positions`, reference or deformed.
    pub fn volumes(&self, positions: &[[f64; 3]]) -> Vec<f64> {
        let mut volumes = Vec::with_capacity(self.cells());
        for block in &self.blocks {
            let volume = Volume::new(block.kind);
            let mut gathered = Gathered::new();
            volumes.extend(block.iter().map(|nodes| volume.of(gathered.of(nodes, positions))));
        }
        volumes
    }

    /// The point of the reference body at the centre of a cell's reference domain.
    pub fn cell_centre(&self, id: usize) -> [f64; 3] {
        let cell = self.cell(id);
        cell.kind.map(&self.gather(&self.points, cell.nodes), &cell.kind.centre())
    }

    /// Volume of a region of the reference body.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn region_volume(&self, name: &str) -> Result<f64, MeshError> {
        let cells = self.region(name)?;
        let volumes = self.volumes(&self.points);
        Ok(cells.iter().map(|&id| volumes[id as usize]).sum())
    }

    /// Area of a surface (length of a curve, in the plane) of the reference body.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn surface_area(&self, name: &str) -> Result<f64, MeshError> {
        Ok(self.area(self.surface(name)?))
    }

    /// Area of any facets of the reference body.
    pub fn area(&self, facets: &[Facet]) -> f64 {
        let one = |&facet: &Facet| {
            let (kind, nodes) = self.facet_nodes(facet);
            let positions = self.gather(&self.points, &nodes);
            kind.rule().iter().map(|(xi, w)| w * norm(&kind.area_vector(&positions, xi))).sum::<f64>()
        };
        facets.iter().map(one).sum()
    }

    /// Sizes of everything that has a name.
    pub fn measures(&self) -> Measures {
        let volumes = self.volumes(&self.points);
        let volume = |cells: &Vec<u32>| cells.iter().map(|&id| volumes[id as usize]).sum();
        Measures {
            dim: self.dim,
            size: self.size(),
            volume: volumes.iter().sum(),
            boundary: self.area(&self.boundary),
            regions: self.regions.iter().map(|(name, cells)| (name.clone(), volume(cells))).collect(),
            surfaces: self.surfaces.iter().map(|(name, facets)| (name.clone(), self.area(facets))).collect(),
        }
    }
}

/// Signed volumes of cells of one kind by its default rule.
struct Volume {
    points: Tabulated,
    weights: &'static [f64],
}

impl Volume {
    fn new(kind: CellKind) -> Volume {
        let rule = kind.rule();
        Volume { points: Tabulated::new(kind, &rule.points), weights: &rule.weights }
    }

    fn of(&self, positions: &[[f64; 3]]) -> f64 {
        self.points.jacobians(positions).zip(self.weights).map(|(jacobian, w)| w * jacobian).sum()
    }
}

/// Volumes and areas of a mesh, in the units of its coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// 2 or 3.
    pub dim: usize,
    /// Extent along each axis.
    pub size: [f64; 3],
    /// Volume (area, in the plane).
    pub volume: f64,
    /// Area of the whole boundary (its length, in the plane).
    pub boundary: f64,
    /// Volume by region.
    pub regions: BTreeMap<String, f64>,
    /// Area by surface.
    pub surfaces: BTreeMap<String, f64>,
}

impl fmt::Display for Measures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (volume, area) = if self.dim == 3 { ("volume", "area") } else { ("area", "length") };
        let size: Vec<String> = self.size[..self.dim].iter().map(|s| format!("{s:.6}")).collect();
        writeln!(f, "size {}, {volume} {:.6e}, boundary {area} {:.6e}", size.join(" x "), self.volume, self.boundary)?;
        for (name, v) in &self.regions {
            writeln!(f, "region \"{name}\": {volume} {v:.6e}")?;
        }
        for (name, a) in &self.surfaces {
            writeln!(f, "surface \"{name}\": {area} {a:.6e}")?;
        }
        Ok(())
    }
}
