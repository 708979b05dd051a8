//! [`Basis`]: the basis functions of a control field at the quadrature points.

use super::Space;
use super::interpolated::corners;
use super::region_of_cells::region_of_cells;
use super::whole_body::WholeBody;
use crate::control_values::ControlEntity;
use crate::error::ControlError;
use crate::grid::Grid;
use nastic_fem::{ControlPoint, Discretization};
use nastic_mesh::GroupNames;
use std::collections::BTreeSet;

/// Basis functions phi_i at the quadrature points, of the field `m(q) = sum_i phi_i(q) m_i`.
///
/// The basis functions are non-negative and sum to one on the cells of the actuation, so the values at the points lie
/// within the bounds of the unknowns.
///
/// Of a body over ranks the unknowns are those of the whole, on all ranks, by its numbers of nodes and cells; the points are those of the rank.
///
/// A [`Layout`](crate::Layout) makes the basis of every field that is controlled:
///
/// ```
/// use nastic_energy::{NeoHooke, Turgor};
/// use nastic_fem::Solid;
/// use nastic_fields::{ControlEntity, Layout, Space};
/// use nastic_mesh::{CellKind, box_mesh};
///
/// // Two cells of 1 m, hex8: two corner layers of four nodes and one between.
/// let body = Solid::new(box_mesh([2.0, 1.0, 1.0], [2, 1, 1], CellKind::Hex8)?)?
///     .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
///     .actuate("body", "turgor", Turgor::new())?
///     .clamp("x-")?;
/// let mut layout = Layout::new(body.model().controls());
/// let basis = layout.control(&body, "turgor", Space::Node)?.basis.clone();
/// assert_eq!((basis.len(), basis.entity(3)), (12, ControlEntity::Node(3)));
///
/// // A field that is X at the nodes is X at the quadrature points.
/// let m: Vec<f64> = basis.positions().iter().map(|x| x[0]).collect();
/// let values = basis.values(&m, 1);
/// let disc = body.discretization();
/// let points = disc.points().positions(disc.mesh(), None);
/// assert!(values.iter().zip(points).all(|(value, x)| (value - x[0]).abs() < 1e-12));
///
/// // The transpose: p . A m = (A^T p) . m.
/// let back = basis.transposed(&values, 1);
/// let (left, right): (f64, f64) =
///     (values.iter().map(|v| v * v).sum(), back.iter().zip(&m).map(|(a, b)| a * b).sum());
/// assert!((left - right).abs() < 1e-12 * left);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    space: Space,
    /// Row starts by quadrature point of the body, or by point of a contribution (empty rows where the actuation does not act).
    starts: Vec<u32>,
    unknowns: Vec<u32>,
    shapes: Vec<f64>,
    grid: Option<Grid>,
    /// What each unknown stands for, ascending: region index, number of the cell, point, node or grid node (0 for uniform).
    entities: Vec<u32>,
    regions: Vec<String>,
    positions: Vec<[f64; 3]>,
    /// Of a control of a contribution: positions and weights of its points.
    pub(super) own: Option<(Vec<[f64; 3]>, Vec<f64>)>,
}

impl Basis {
    /// Of a contribution: one number for the whole, whose size is its weight in inner products, or a field over its points, one value of each
    /// or multilinear on a grid over them. `None` of other spaces.
    ///
    /// # Errors
    /// [`ControlError::Grid`] of a grid without cells.
    pub fn of_contribution(measure: f64, points: &[ControlPoint], space: Space) -> Result<Option<Self>, ControlError> {
        let whole = [ControlPoint { position: [0.0; 3], weight: measure }];
        let points = if points.is_empty() { &whole } else { points };
        let positions: Vec<[f64; 3]> = points.iter().map(|point| point.position).collect();
        let grid = match space {
            Space::Grid(cells) => Some(Grid::over(positions.iter().copied(), cells)?),
            _ => None,
        };
        let rows: Vec<Vec<(u32, f64)>> = match (space, grid) {
            (Space::Uniform, _) => vec![vec![(0, 1.0)]; points.len()],
            (Space::Point, _) => (0..points.len() as u32).map(|q| vec![(q, 1.0)]).collect(),
            (_, Some(grid)) => {
                let row = |x: &[f64; 3]| grid.corners(*x).into_iter().map(|(node, shape, _)| (node, shape)).collect();
                positions.iter().map(row).collect()
            }
            _ => return Ok(None),
        };
        let mut basis = Basis { grid, ..Basis::without_unknowns(space) };
        basis.number(rows.iter().flatten().map(|(entity, _)| *entity));
        rows.into_iter().for_each(|row| basis.push(row));
        let weights: Vec<f64> = points.iter().map(|point| point.weight).collect();
        basis.positions = basis.centres(&positions, &weights, None)?;
        basis.own = Some((positions, weights));
        Ok(Some(basis))
    }

    /// Whether it is of a contribution, and no field over the body.
    pub fn is_of_contribution(&self) -> bool {
        self.own.is_some()
    }

    /// The weights of the points: reference volumes, or those of the contribution's own.
    pub fn weights<'a>(&'a self, disc: &'a Discretization) -> &'a [f64] {
        self.own.as_ref().map_or(disc.points().weights(), |(_, weights)| weights)
    }

    fn without_unknowns(space: Space) -> Self {
        Basis {
            space,
            starts: vec![0],
            unknowns: vec![],
            shapes: vec![],
            grid: None,
            entities: vec![],
            regions: vec![],
            positions: vec![],
            own: None,
        }
    }

    /// Numbers unknowns by ascending entity, so that a field reads like the mesh does.
    fn number(&mut self, entities: impl IntoIterator<Item = u32>) {
        self.entities = entities.into_iter().collect::<BTreeSet<u32>>().into_iter().collect();
    }

    /// Adds the basis functions at the next point, by entity.
    fn push(&mut self, row: impl IntoIterator<Item = (u32, f64)>) {
        for (entity, shape) in row {
            if let Ok(unknown) = self.entities.binary_search(&entity) {
                self.unknowns.push(unknown as u32);
                self.shapes.push(shape);
            }
        }
        self.starts.push(self.unknowns.len() as u32);
    }

    /// That of a space over the cells of regions. In the region space each of them has an unknown; a single region that others
    /// of the mesh divide has one for each of those.
    ///
    /// # Errors
    /// An unknown name; [`ControlError::Grid`] of a grid without cells; in the region space [`ControlError::OverlappingRegions`] where a cell would have two unknowns, and
    /// [`ControlError::UndividedRegion`] where it would have none.
    pub fn new(disc: &Discretization, regions: &GroupNames, space: Space) -> Result<Self, ControlError> {
        let (mesh, whole) = (disc.mesh(), WholeBody::of(disc));
        let cells = mesh.cells_of(regions)?;
        let mut acts = vec![false; mesh.cells()];
        cells.iter().for_each(|&c| acts[c as usize] = true);
        let region_of = (space == Space::Region).then(|| region_of_cells(mesh, regions, &cells, &whole)).transpose()?;
        let nodes = || mesh.nodes_of_cells(&cells).into_iter().map(|node| mesh.points()[node as usize]);
        let grid = match space {
            Space::Grid(count) => Some(whole.grid(nodes(), count)?),
            _ => None,
        };
        let corners = grid.map(|grid| corners(disc, &grid, &acts));
        let numbers = whole.numbers(space)?;
        let in_whole = |own: u32| numbers.as_ref().map_or(own, |numbers| numbers[own as usize]);
        let mut basis =
            Basis { grid, regions: mesh.regions().keys().cloned().collect(), ..Basis::without_unknowns(space) };
        let own: BTreeSet<u32> = match &corners {
            Some(corners) => corners.iter().flatten().map(|(node, ..)| *node).collect(),
            None => entities(disc, &cells, space, region_of.as_deref()).into_iter().map(in_whole).collect(),
        };
        basis.entities = whole.joined(own)?;
        for (id, (first, count)) in disc.points_of_cells().into_iter().enumerate() {
            let cell = mesh.cell(id);
            for (q, xi) in cell.kind.rule().points.iter().enumerate().take(count) {
                let entity = match (space, &corners, &region_of) {
                    _ if !acts[id] => {
                        basis.push([]);
                        continue;
                    }
                    (Space::Grid(_), Some(corners), _) => {
                        basis.push(corners[first + q].iter().map(|(node, shape, _)| (*node, *shape)));
                        continue;
                    }
                    (Space::Node, ..) => {
                        let mut shapes = vec![0.0; cell.kind.corners()];
                        cell.kind.corner_kind().shapes(xi, &mut shapes);
                        basis.push(cell.nodes.iter().map(|node| in_whole(*node)).zip(shapes));
                        continue;
                    }
                    (Space::Cell, ..) => in_whole(id as u32),
                    (Space::Point, ..) => in_whole((first + q) as u32),
                    (_, _, Some(region_of)) => region_of[id],
                    _ => 0,
                };
                basis.push([(entity, 1.0)]);
            }
        }
        basis.positions = match (space, &numbers) {
            (Space::Node, None) => basis.entities.iter().map(|&node| mesh.points()[node as usize]).collect(),
            (Space::Node, Some(numbers)) => basis.at_nodes(mesh.points(), numbers, &whole)?,
            _ => basis.centres(&disc.points().positions(mesh, None), disc.points().weights(), Some(&whole))?,
        };
        Ok(basis)
    }

    /// The same unknowns, at the points of the cells of regions alone.
    ///
    /// # Errors
    /// An unknown name.
    pub(crate) fn within(&self, disc: &Discretization, regions: &GroupNames) -> Result<Self, ControlError> {
        let mut out = Basis { starts: vec![0], unknowns: vec![], shapes: vec![], ..self.clone() };
        let cells = disc.mesh().cells_of(regions)?;
        for (q, cell) in disc.points().cells().into_iter().enumerate() {
            if cells.binary_search(&cell).is_ok() {
                let own = self.starts[q] as usize..self.starts[q + 1] as usize;
                out.unknowns.extend(&self.unknowns[own.clone()]);
                out.shapes.extend(&self.shapes[own]);
            }
            out.starts.push(out.unknowns.len() as u32);
        }
        Ok(out)
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

    /// What each unknown stands for: the region's index among the names, the cell, the point, the node, or the node of the grid (0 for uniform).
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
            Space::Point => ControlEntity::Point(entity),
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

    /// Whether the field reaches a point.
    pub fn acts_at(&self, q: usize) -> bool {
        self.starts[q] < self.starts[q + 1]
    }

    /// Values at the points of a field of several components, `components * point + component`; zero where it does not act.
    pub fn values(&self, m: &[f64], components: usize) -> Vec<f64> {
        let mut out = vec![0.0; components * self.points()];
        for (q, out) in out.chunks_exact_mut(components).enumerate().filter(|(q, _)| self.acts_at(*q)) {
            for (c, out) in out.iter_mut().enumerate() {
                *out = self.at_point(q).map(|(i, shape)| shape * m[i * components + c]).sum();
            }
        }
        out
    }

    /// The transpose of [`values`](Self::values): `sum_q phi_i(q) v(q)`.
    pub fn transposed(&self, values: &[f64], components: usize) -> Vec<f64> {
        let mut out = vec![0.0; components * self.len()];
        for (q, values) in values.chunks_exact(components).enumerate() {
            for (i, shape) in self.at_point(q) {
                let own = &mut out[i * components..][..components];
                own.iter_mut().zip(values).for_each(|(out, value)| *out += shape * value);
            }
        }
        out
    }

    /// The basis functions at a point: pairs of unknown and value.
    pub fn at_point(&self, q: usize) -> impl Iterator<Item = (usize, f64)> {
        (self.starts[q] as usize..self.starts[q + 1] as usize).map(|k| (self.unknowns[k] as usize, self.shapes[k]))
    }

    /// Number of quadrature points of the body, or of points of the contribution.
    pub fn points(&self) -> usize {
        self.starts.len() - 1
    }

    /// Nodes of the grid, or centres of the points that belong to the unknowns.
    fn centres(
        &self,
        at: &[[f64; 3]],
        weights: &[f64],
        whole: Option<&WholeBody>,
    ) -> Result<Vec<[f64; 3]>, ControlError> {
        if let Some(grid) = &self.grid {
            return Ok(self.entities.iter().map(|&node| grid.node(node)).collect());
        }
        let mut sums = vec![[0.0; 4]; self.len()];
        for (q, (x, w)) in at.iter().zip(weights).enumerate() {
            for (i, shape) in self.at_point(q) {
                for k in 0..3 {
                    sums[i][k] += w * shape * x[k];
                }
                sums[i][3] += w * shape;
            }
        }
        whole.map_or(Ok(()), |whole| whole.add_up(sums.as_flattened_mut()))?;
        Ok(sums.into_iter().map(|s| [s[0] / s[3], s[1] / s[3], s[2] / s[3]]).collect())
    }

    /// The nodes that the unknowns are on, each sent by the rank that it belongs to.
    fn at_nodes(&self, points: &[[f64; 3]], numbers: &[u32], whole: &WholeBody) -> Result<Vec<[f64; 3]>, ControlError> {
        let mut out = vec![[0.0; 3]; self.len()];
        for (x, node) in points.iter().zip(numbers).take(whole.owned()) {
            if let Ok(unknown) = self.entities.binary_search(node) {
                out[unknown] = *x;
            }
        }
        whole.add_up(out.as_flattened_mut())?;
        Ok(out)
    }
}

pub(super) fn entities(disc: &Discretization, cells: &[u32], space: Space, region_of: Option<&[u32]>) -> Vec<u32> {
    let mesh = disc.mesh();
    match (space, region_of) {
        (Space::Cell, _) => cells.to_vec(),
        (Space::Point, _) => {
            let points = disc.points_of_cells();
            let of = |&c: &u32| (points[c as usize].0..).take(points[c as usize].1).map(|point| point as u32);
            cells.iter().flat_map(of).collect()
        }
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
