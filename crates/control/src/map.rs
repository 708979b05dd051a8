//! [`ControlMap`]: from the unknowns of a control field to its values at the quadrature points, and back.

mod interpolated;

use crate::control_values::ControlEntity;
use crate::error::ControlError;
use crate::grid::Grid;
use interpolated::corners;
use nastic_fem::Discretization;
use nastic_mesh::{GroupNames, Mesh};
use std::collections::{BTreeMap, BTreeSet};

/// How a control field varies over the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Space {
    /// One value.
    Uniform,
    /// One value per region that the actuation names, or that divides the one it names.
    Region,
    /// One value per cell.
    Cell,
    /// Linear (multilinear) between corner nodes, on every element: bounds at the nodes hold everywhere.
    Node,
    /// Multilinear between the nodes of a regular grid of so many cells along x, y and z over the bounding box of the actuation's regions
    /// (of a plane body the third number does not matter): a control mesh that is independent of the body's. Grid cells without a
    /// quadrature point have no part in it, and nodes of such cells alone no unknown.
    Grid([u32; 3]),
}

/// A row of the catalogue of control spaces.
#[derive(Debug, Clone, Copy)]
pub struct SpaceRow {
    /// The space.
    pub space: Space,
    /// The name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
}

/// Every control space.
pub const SPACES: &[SpaceRow] = &[
    SpaceRow { space: Space::Uniform, name: "uniform", about: "one value" },
    SpaceRow { space: Space::Region, name: "region", about: "one value per named region" },
    SpaceRow { space: Space::Cell, name: "cell", about: "one value per cell" },
    SpaceRow { space: Space::Node, name: "node", about: "linear between the corner nodes of every cell" },
    SpaceRow { space: Space::Grid([2, 1, 1]), name: "grid", about: "multilinear on a regular grid of its own" },
];

impl Space {
    /// The name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Space::Uniform => "uniform",
            Space::Region => "region",
            Space::Cell => "cell",
            Space::Node => "node",
            Space::Grid(_) => "grid",
        }
    }

    /// Whether a field of it is interpolated between nodes, where vectors of one length need [`Layout::fix_length`](crate::Layout::fix_length).
    pub fn interpolates(self) -> bool {
        matches!(self, Space::Node | Space::Grid(_))
    }
}

/// A linear map `m(q) = sum_i phi_i(q) m_i` for one scalar component, with its transpose.
///
/// The basis functions are non-negative and sum to one on the cells of the actuation, so the values at the points lie
/// within the bounds of the unknowns.
///
/// A problem makes the map of every field that it controls ([`Reduced::control`](crate::Reduced::control)):
///
/// ```
/// use nastic_control::{ControlEntity, Reduced, Space};
/// use nastic_energy::{NeoHooke, Turgor};
/// use nastic_fem::Solid;
/// use nastic_mesh::{CellKind, box_mesh};
///
/// // Two cells of 1 m, hex8: two corner layers of four nodes and one between.
/// let body = Solid::new(box_mesh([2.0, 1.0, 1.0], [2, 1, 1], CellKind::Hex8)?)?
///     .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
///     .actuate("body", "turgor", Turgor::new())?
///     .clamp("x-")?;
/// let problem = Reduced::new(body).control("turgor", Space::Node)?;
/// let map = &problem.layout().block("turgor")?.map;
/// assert_eq!((map.len(), map.entity(3)), (12, ControlEntity::Node(3)));
///
/// // A field that is X at the nodes is X at the quadrature points.
/// let m: Vec<f64> = map.positions().iter().map(|x| x[0]).collect();
/// let mut values = vec![0.0; map.points()];
/// map.to_points(&m, 1, 0, 1, 0, &mut values);
/// let disc = problem.solid().discretization();
/// let points = disc.points().positions(disc.mesh(), None);
/// assert!(values.iter().zip(points).all(|(value, x)| (value - x[0]).abs() < 1e-12));
///
/// // The transpose: p . A m = (A^T p) . m.
/// let mut back = vec![0.0; map.len()];
/// map.from_points(&values, 1, 0, 1, 0, &mut back);
/// let (left, right): (f64, f64) =
///     (values.iter().map(|v| v * v).sum(), back.iter().zip(&m).map(|(a, b)| a * b).sum());
/// assert!((left - right).abs() < 1e-12 * left);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ControlMap {
    space: Space,
    /// Row starts by quadrature point of the body (empty rows where the actuation does not act).
    starts: Vec<u32>,
    unknowns: Vec<u32>,
    shapes: Vec<f64>,
    grid: Option<Grid>,
    /// What each unknown stands for: region index, cell number, node number or grid node number (0 for uniform).
    entities: Vec<u32>,
    regions: Vec<String>,
    positions: Vec<[f64; 3]>,
    /// Of a control that acts on no cells but on a contribution as a whole: the size of that.
    measure: Option<[f64; 1]>,
}

impl ControlMap {
    /// One number for a contribution as a whole (the pressure of a cavity), whose size is its weight in inner products.
    pub fn whole(measure: f64) -> Self {
        ControlMap {
            space: Space::Uniform,
            starts: vec![0, 1],
            unknowns: vec![0],
            shapes: vec![1.0],
            grid: None,
            entities: vec![0],
            regions: vec![],
            positions: vec![[0.0; 3]],
            measure: Some([measure]),
        }
    }

    /// Whether it is one number for a contribution as a whole.
    pub fn is_whole(&self) -> bool {
        self.measure.is_some()
    }

    /// The weights of the points: reference volumes, or the size of the contribution.
    pub(crate) fn weights<'a>(&'a self, disc: &'a Discretization) -> &'a [f64] {
        self.measure.as_ref().map_or(disc.points().weights(), |measure| measure.as_slice())
    }

    /// The map of a space over the cells of regions. In the region space each of them has an unknown; a single region that others
    /// of the mesh divide has one for each of those.
    ///
    /// # Errors
    /// An unknown name; [`ControlError::Grid`] of a grid without cells; in the region space [`ControlError::OverlappingRegions`] where a cell would have two unknowns, and
    /// [`ControlError::UndividedRegion`] where it would have none.
    pub fn new(disc: &Discretization, regions: &GroupNames, space: Space) -> Result<Self, ControlError> {
        let mesh = disc.mesh();
        let cells = mesh.cells_of(regions)?;
        let mut acts = vec![false; mesh.cells()];
        cells.iter().for_each(|&c| acts[c as usize] = true);
        let region_of = (space == Space::Region).then(|| region_of_cells(mesh, regions, &cells)).transpose()?;
        let nodes = || mesh.nodes_of_cells(&cells).into_iter().map(|node| mesh.points()[node as usize]);
        let grid = match space {
            Space::Grid(count) => Some(Grid::over(nodes(), count)?),
            _ => None,
        };
        let corners = grid.map(|grid| corners(disc, &grid, &acts));
        let mut map = ControlMap {
            space,
            starts: vec![0],
            unknowns: vec![],
            shapes: vec![],
            grid,
            entities: vec![],
            regions: mesh.regions().keys().cloned().collect(),
            positions: vec![],
            measure: None,
        };
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let entities = match &corners {
            Some(corners) => corners.iter().flatten().map(|(node, ..)| *node).collect(),
            None => entities(mesh, &cells, space, region_of.as_deref()),
        };
        for entity in entities {
            let next = numbers.len() as u32;
            numbers.entry(entity).or_insert(next);
        }
        // Unknowns are numbered by ascending entity, so that a field reads like the mesh does.
        for (rank, (&entity, number)) in numbers.iter_mut().enumerate() {
            *number = rank as u32;
            map.entities.push(entity);
        }
        for (id, (first, count)) in disc.points_of_cells().into_iter().enumerate() {
            let cell = mesh.cell(id);
            let rule = cell.kind.rule();
            for (q, xi) in rule.points.iter().take(count).enumerate() {
                if acts[id] {
                    match (space, &corners) {
                        (Space::Grid(_), Some(corners)) => {
                            for (node, shape, _) in &corners[first + q] {
                                map.unknowns.push(numbers[node]);
                                map.shapes.push(*shape);
                            }
                        }
                        (Space::Node, _) => {
                            let corners = cell.kind.corners();
                            let mut shapes = vec![0.0; corners];
                            cell.kind.corner_kind().shapes(xi, &mut shapes);
                            for (node, shape) in cell.nodes.iter().zip(shapes) {
                                map.unknowns.push(numbers[node]);
                                map.shapes.push(shape);
                            }
                        }
                        _ => {
                            let entity = match (space, &region_of) {
                                (Space::Cell, _) => id as u32,
                                (_, Some(region_of)) => region_of[id],
                                _ => 0,
                            };
                            map.unknowns.push(numbers[&entity]);
                            map.shapes.push(1.0);
                        }
                    }
                }
                map.starts.push(map.unknowns.len() as u32);
            }
        }
        map.positions = map.centres(disc);
        Ok(map)
    }

    /// The space.
    pub fn space(&self) -> Space {
        self.space
    }

    /// Number of unknowns per component.
    pub fn len(&self) -> usize {
        self.entities.len()
    }

    /// Whether the actuation acts nowhere.
    pub fn is_empty(&self) -> bool {
        self.entities.is_empty()
    }

    /// The grid of the space `grid`.
    pub fn grid(&self) -> Option<&Grid> {
        self.grid.as_ref()
    }

    /// What each unknown stands for: the region's index among the names, the cell, the node, or the node of the grid (0 for uniform).
    pub fn entities(&self) -> &[u32] {
        &self.entities
    }

    /// The name of the region of an unknown, in the region space; empty in others.
    pub fn region(&self, unknown: usize) -> &str {
        let entity = self.entities.get(unknown).filter(|_| self.space == Space::Region);
        entity.and_then(|entity| self.regions.get(*entity as usize)).map_or("", String::as_str)
    }

    /// What an unknown stands for.
    pub fn entity(&self, unknown: usize) -> ControlEntity<'_> {
        let entity = self.entities[unknown];
        match self.space {
            Space::Uniform => ControlEntity::Whole,
            Space::Region => ControlEntity::Region(&self.regions[entity as usize]),
            Space::Cell => ControlEntity::Cell(entity),
            Space::Node => ControlEntity::Node(entity),
            Space::Grid(_) => ControlEntity::GridNode(entity),
        }
    }

    /// The same in words: `cell 12`, `node 7`, `region "arm"`, `the whole region`.
    pub fn describe(&self, unknown: usize) -> String {
        self.entity(unknown).to_string()
    }

    /// Where each unknown sits: the node, or the centre of its cells. Start formulas are evaluated here.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Values at the quadrature points of the body, written to entry `stride * q + offset`.
    pub fn to_points(
        &self,
        m: &[f64],
        components: usize,
        component: usize,
        stride: usize,
        offset: usize,
        out: &mut [f64],
    ) {
        for q in 0..self.starts.len() - 1 {
            let row = self.starts[q] as usize..self.starts[q + 1] as usize;
            if !row.is_empty() {
                let terms = row.map(|k| self.shapes[k] * m[self.unknowns[k] as usize * components + component]);
                out[stride * q + offset] = terms.sum();
            }
        }
    }

    /// The transpose of [`to_points`](Self::to_points): adds `sum_q phi_i(q) v(q)`.
    pub fn from_points(
        &self,
        values: &[f64],
        stride: usize,
        offset: usize,
        components: usize,
        component: usize,
        out: &mut [f64],
    ) {
        for q in 0..self.starts.len() - 1 {
            for k in self.starts[q] as usize..self.starts[q + 1] as usize {
                out[self.unknowns[k] as usize * components + component] += self.shapes[k] * values[stride * q + offset];
            }
        }
    }

    /// The basis functions at a point: pairs of unknown and value.
    pub fn at_point(&self, q: usize) -> impl Iterator<Item = (usize, f64)> {
        (self.starts[q] as usize..self.starts[q + 1] as usize).map(|k| (self.unknowns[k] as usize, self.shapes[k]))
    }

    /// Number of quadrature points of the body, or 1 for a contribution as a whole.
    pub fn points(&self) -> usize {
        self.starts.len() - 1
    }

    fn centres(&self, disc: &Discretization) -> Vec<[f64; 3]> {
        if let Some(grid) = &self.grid {
            return self.entities.iter().map(|&node| grid.node(node)).collect();
        }
        if self.space == Space::Node {
            return self.entities.iter().map(|&node| disc.mesh().points()[node as usize]).collect();
        }
        let at = disc.points().positions(disc.mesh(), None);
        let mut sums = vec![[0.0; 4]; self.len()];
        for (q, (x, w)) in at.iter().zip(disc.points().weights()).enumerate() {
            for (i, shape) in self.at_point(q) {
                for k in 0..3 {
                    sums[i][k] += w * shape * x[k];
                }
                sums[i][3] += w * shape;
            }
        }
        sums.into_iter().map(|s| [s[0] / s[3], s[1] / s[3], s[2] / s[3]]).collect()
    }
}

/// Number of the region, among those of the mesh, that gives each cell of an actuation its value.
fn region_of_cells(mesh: &Mesh, named: &GroupNames, cells: &[u32]) -> Result<Vec<u32>, ControlError> {
    let acts: BTreeSet<u32> = cells.iter().copied().collect();
    let shared = |of: &[u32]| of.iter().filter(|cell| acts.contains(cell)).count();
    let is_named = |name: &str| named.iter().any(|one| one == name);
    // A region that has all the cells does not divide them, one that has none has nothing to do with them.
    let divides = |name: &str, of: &[u32]| !is_named(name) && shared(of) > 0 && shared(of) < acts.len();
    let divided = !named.are_several() && mesh.regions().iter().any(|(name, of)| divides(name, of));
    let parts = mesh.regions().iter().enumerate();
    let parts = parts.filter(|(_, (name, of))| if divided { divides(name, of) } else { is_named(name) });
    let parts: Vec<(u32, &String, &Vec<u32>)> = parts.map(|(r, (name, of))| (r as u32, name, of)).collect();
    let mut of_cell = vec![u32::MAX; mesh.cells()];
    for (k, (r, name, of)) in parts.iter().enumerate() {
        let own: BTreeSet<u32> = of.iter().filter(|cell| acts.contains(cell)).copied().collect();
        let clash = parts[..k].iter().find(|(_, _, other)| other.iter().any(|cell| own.contains(cell)));
        if let Some((_, first, other)) = clash {
            let cells = other.iter().filter(|cell| own.contains(cell)).count();
            let (first, second) = ((*first).clone(), (*name).clone());
            return Err(ControlError::OverlappingRegions { first, second, cells });
        }
        own.iter().for_each(|&cell| of_cell[cell as usize] = *r);
    }
    let bare = cells.iter().filter(|&&cell| of_cell[cell as usize] == u32::MAX).count();
    if bare > 0 {
        let parts: Vec<&str> = parts.iter().map(|(_, name, _)| name.as_str()).collect();
        let (region, parts) = (named.to_string(), parts.join(", "));
        return Err(ControlError::UndividedRegion { region, parts, cells: bare });
    }
    Ok(of_cell)
}

fn entities(mesh: &Mesh, cells: &[u32], space: Space, region_of: Option<&[u32]>) -> Vec<u32> {
    match (space, region_of) {
        (Space::Cell, _) => cells.to_vec(),
        (Space::Node, _) => {
            let corners = |&c: &u32| {
                let cell = mesh.cell(c as usize);
                cell.nodes[..cell.kind.corners()].to_vec()
            };
            cells.iter().flat_map(corners).collect()
        }
        (Space::Region, Some(region_of)) => cells.iter().map(|&cell| region_of[cell as usize]).collect(),
        _ => vec![0],
    }
}
