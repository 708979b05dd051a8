//! The state of a problem at one control as named arrays, for VTU files and pictures.

use crate::evaluated::Evaluated;
use crate::reduced::Reduced;
use crate::time::Timeline;
use nastic_energy::SlotGroup;
use nastic_fem::{AttachedLaw, Discretization, Instant, State};
use nastic_fields::{ControlBlock, ControlError, Space};
use nastic_mesh::{MeshError, Snapshot};
use nastic_tensor::Mat3;

/// A state, and what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct StateFields<'a> {
    /// The equilibrium.
    pub state: &'a State,
    /// The control vector.
    pub m: &'a [f64],
    /// Adjoint displacement, flat.
    pub adjoint: Option<&'a [f64]>,
    /// Gradient of the cost: the Riesz image of its derivative.
    pub gradient: Option<&'a [f64]>,
    /// Whether derived fields are added: strains and stretches, smoothed stresses, reactions.
    pub detailed: bool,
    /// Names of the arrays of the control fields, in their order; their own names where there are none.
    pub names: &'a [&'a str],
    /// The stage of the maps of the control fields; those of the last one from the number of stages on.
    pub stage: usize,
}

impl<'a> StateFields<'a> {
    /// A state and its control vector, with the maps of the stage that the state is of: 0 of what no optimisation found.
    pub fn new(state: &'a State, m: &'a [f64], stage: usize) -> Self {
        StateFields { state, m, adjoint: None, gradient: None, detailed: true, names: &[], stage }
    }

    /// Those of an evaluated control, with the maps of its stage.
    pub fn of(point: &'a Evaluated) -> Self {
        StateFields::new(point.state(), &point.m, point.stage)
    }
}

impl Reduced {
    /// The state with everything worth looking at: [`snapshot_of`](Self::snapshot_of) of an evaluated control, with the gradient where a
    /// derivative is given (the Riesz image in the problem's product).
    ///
    /// # Errors
    /// Vectors of the wrong length.
    pub fn snapshot(&self, point: &Evaluated, derivative: Option<&[f64]>) -> Result<Snapshot, ControlError> {
        let gradient = match derivative {
            Some(derivative) => {
                self.layout().check(derivative)?;
                Some(self.build_inner_product()?.riesz(derivative))
            }
            None => None,
        };
        let fields = StateFields { adjoint: point.adjoint(), gradient: gradient.as_deref(), ..StateFields::of(point) };
        self.snapshot_of(&fields)
    }

    /// A state as arrays, for VTU files and pictures.
    ///
    /// Point data: `displacement` (from the drawn body), the change of its shape under the name of that, `velocity` (in motion), `adjoint`, `reaction` (of supports, of equilibria), `contact_pressure` (where there are contacts), further fields under their names (`potential`), `nodal_cauchy_stress` (smoothed) and its `nodal_mises`, nodal controls and
    /// `gradient_NAME`. Cell data: the other controls and
    /// gradients, one value per cell (of a control on a grid its mean there); averages over the reference volume of every scalar slot that nobody controls (under
    /// the actuation's name), of `B_r` and `B_a` (the sums over all magnets), `J`, `P` and `cauchy_stress` (row by row),
    /// `mises` (of that mean Cauchy stress), `green_strain`, `principal_stretches` (of its mean, largest first), `energy` (stored by the passive material), `true_field_NAME` of each dielectric, `fiber` and `direction_NAME` of each actuation that has one. Vectors
    /// always have three components, tensors nine. What follows from `J` and `F` is left out where a cell is inverted.
    /// Writers of VTU files add `region`.
    ///
    /// # Errors
    /// Vectors of the wrong length.
    pub fn snapshot_of(&self, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
        self.layout().check(fields.m)?;
        fields.gradient.map_or(Ok(()), |gradient| self.layout().check(gradient))?;
        let t = fields.state.time;
        let (m, gradient) =
            (self.at_instant(fields.m, t)?, fields.gradient.map(|gradient| self.at_instant(gradient, t)).transpose()?);
        let mut shot = self.moved(fields.state)?;
        // a motion that begins at rest, so that all its states have the same arrays
        let at_rest = || self.timeline().map(|_| vec![0.0; fields.state.u.len()]);
        if let Some(velocity) = fields.state.velocity.as_deref().cloned().or_else(at_rest) {
            shot = shot.with_points("velocity", 3, self.vectors(&velocity))?;
        }
        if let Some(adjoint) = fields.adjoint {
            shot = shot.with_points("adjoint", 3, self.vectors(adjoint))?;
        }
        for (k, block) in self.layout_at(fields.stage).blocks().iter().enumerate() {
            let name = fields.names.get(k).copied().unwrap_or(&block.name);
            shot = self.with_field(shot, block, name, &m, true)?;
            if let Some(gradient) = &gradient {
                shot = self.with_field(shot, block, &format!("gradient_{name}"), gradient, false)?;
            }
        }
        shot = self.with_actuations(shot, fields.state)?;
        let model = self.solid().model();
        for (_, field) in model.unknowns().nodal_fields().skip(1) {
            shot = shot.with_points(&field.name, field.components, model.field(&field.name, &fields.state.u)?)?;
        }
        let at = Instant::of(fields.state);
        shot = shot.with_lines(self.solid().model().lines(&at).unwrap_or_default());
        if let Some(pressures) = self.solid().model().contacts().nodal_pressures(&at) {
            shot = shot.with_points("contact_pressure", 1, pressures)?;
        }
        Ok(self.with_state(shot, fields)?)
    }

    /// The part of [`snapshot_of`](Self::snapshot_of) that follows a body and its controls from iteration to iteration:
    /// `displacement` and the control fields.
    ///
    /// # Errors
    /// Vectors of the wrong length.
    pub fn moved_controls(&self, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
        self.layout().check(fields.m)?;
        let m = self.at_instant(fields.m, fields.state.time)?;
        self.with_fields(self.moved(fields.state)?, &m, fields.names, Some(fields.stage))
    }

    /// The displaced body alone, with the change of its shape.
    ///
    /// # Errors
    /// A displacement of another body.
    pub fn moved(&self, state: &State) -> Result<Snapshot, ControlError> {
        let shot = Snapshot::new(self.solid().mesh().clone()).with_points("displacement", 3, self.vectors(&state.u))?;
        let model = self.solid().model();
        Ok(match (self.solid().body().shape(), model.shape_displacement(&state.controls)) {
            (Some((_, shape)), Some(s)) => {
                shot.with_points(&shape.name, 3, by_triple(&s, self.solid().mesh().dim()))?
            }
            _ => shot,
        })
    }

    /// Adds a vector of the control space (a gradient, a direction) to a snapshot of this body, one array for each control field
    /// that has one, under these names in the order of the fields; under their own names where there are none. Of fields in time it is the
    /// value at the end.
    ///
    /// # Errors
    /// A vector of the wrong length; a snapshot of another mesh.
    pub fn with_controls(&self, shot: Snapshot, m: &[f64], names: &[&str]) -> Result<Snapshot, ControlError> {
        self.layout().check(m)?;
        let end = self.timeline().map_or(0.0, Timeline::end);
        self.with_fields(shot, &self.at_instant(m, end)?, names, None)
    }

    /// Of the fields at one instant, controls with the maps of a stage, or another vector of their space.
    fn with_fields(
        &self,
        mut shot: Snapshot,
        m: &[f64],
        names: &[&str],
        of_controls: Option<usize>,
    ) -> Result<Snapshot, ControlError> {
        for (k, block) in self.layout_at(of_controls.unwrap_or(usize::MAX)).blocks().iter().enumerate() {
            let name = names.get(k).copied().unwrap_or(&block.name);
            shot = self.with_field(shot, block, name, m, of_controls.is_some())?;
        }
        Ok(shot)
    }

    /// Displacements as triples, without what stands behind them.
    fn vectors(&self, u: &[f64]) -> Vec<f64> {
        by_triple(&self.solid().model().displacement(u), self.solid().mesh().dim())
    }

    /// A field of the control space, by node or by cell; that of a contribution is none of the body. Of a control the values, of anything else, a
    /// gradient or a direction, what it is of the unknowns.
    fn with_field(
        &self,
        shot: Snapshot,
        block: &ControlBlock,
        name: &str,
        m: &[f64],
        is_control: bool,
    ) -> Result<Snapshot, MeshError> {
        let (n, unknowns) = (block.components, block.of(m));
        if block.basis.is_of_contribution() {
            return Ok(shot);
        }
        let owned = if is_control { block.values_of(unknowns) } else { unknowns.to_vec() };
        let values = &owned[..];
        match block.basis.space() {
            Space::Node => {
                let all = self.solid().model().controllable();
                let of = block.targets.iter().filter_map(|target| all.get(target.actuation)?.cells);
                let cells: Vec<u32> = of.flatten().copied().collect();
                shot.with_points(name, n, by_node(self.solid().discretization(), &cells, block, values))
            }
            Space::Grid(_) | Space::Point => {
                // between the nodes of a grid the field is linear
                let at_points =
                    if is_control { block.values_at_points(unknowns) } else { block.basis.values(unknowns, n) };
                shot.with_cells(name, n, self.solid().discretization().cell_average(&at_points, n))
            }
            _ => shot.with_cells(name, n, self.by_cell(block, values)),
        }
    }

    /// A field that is constant in each cell; zero where it does not act.
    fn by_cell(&self, block: &ControlBlock, values: &[f64]) -> Vec<f64> {
        let n = block.components;
        let mut out = vec![0.0; self.solid().mesh().cells() * n];
        for (cell, (first, _)) in self.solid().discretization().points_of_cells().into_iter().enumerate() {
            if let Some((unknown, _)) = block.basis.at_point(first).next() {
                out[cell * n..][..n].copy_from_slice(&values[unknown * n..][..n]);
            }
        }
        out
    }

    /// Scalar slots nobody controls (of several those of growths alone, as `NAME.SLOT`), and remanence and applied field of all magnets together: the means of each cell.
    fn with_actuations(&self, mut shot: Snapshot, state: &State) -> Result<Snapshot, MeshError> {
        let (disc, cells) = (self.solid().discretization(), self.solid().mesh().cells());
        let mut sums = [("B_r", "remanence", None::<Vec<f64>>), ("B_a", "field", None)];
        let all = self.solid().body().actuations().iter().enumerate();
        let over_cells = |attached: &AttachedLaw| attached.law.evolution().is_none() && !attached.is_global();
        for (k, attached) in all.filter(|(_, attached)| over_cells(attached)) {
            let slots = attached.law.slots();
            let mut means = disc.cell_average(state.controls.values(k), slots.len());
            let mut inside = vec![false; cells];
            attached.cells.iter().for_each(|&cell| inside[cell as usize] = true);
            let outside = means.chunks_exact_mut(slots.len()).zip(inside).filter(|(_, inside)| !inside);
            outside.for_each(|(means, _)| means.fill(0.0));
            let targets = || self.layout().blocks().iter().flat_map(|block| &block.targets);
            let is_free = |slot: usize| targets().all(|target| target.actuation != k || target.slot != slot);
            let loads: Vec<usize> = (0..slots.len()).filter(|slot| !slots[*slot].is_design()).collect();
            if loads.len() == 1 && is_free(loads[0]) && (slots.len() == 1 || attached.law.strain_map().is_some()) {
                let own = means.iter().skip(loads[0]).step_by(slots.len()).copied().collect();
                shot = shot.with_cells(&attached.name, 1, own)?;
            } else if attached.law.strain_map().is_some() {
                for slot in loads.into_iter().filter(|slot| is_free(*slot)) {
                    let own = means.iter().skip(slot).step_by(slots.len()).copied().collect();
                    shot = shot.with_cells(&format!("{}.{}", attached.name, slots[slot].group), 1, own)?;
                }
            }
            for group in SlotGroup::of(slots).into_iter().filter(SlotGroup::is_vector) {
                for (_, _, sum) in sums.iter_mut().filter(|(_, name, _)| *name == group.name) {
                    let own = means.chunks_exact(slots.len()).flat_map(|at| &at[group.first..group.first + 3]);
                    let sum = sum.get_or_insert_with(|| vec![0.0; 3 * cells]);
                    sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                }
            }
        }
        for (array, _, sum) in sums {
            if let Some(values) = sum {
                shot = shot.with_cells(array, 3, values)?;
            }
        }
        Ok(shot)
    }

    /// What follows from the state alone; a state with an inverted cell has no such thing.
    fn with_state(&self, shot: Snapshot, of: &StateFields<'_>) -> Result<Snapshot, MeshError> {
        let Ok(fields) = self.solid().cell_fields(of.state) else { return Ok(shot) };
        let mises = fields.cauchy.chunks_exact(9).map(von_mises).collect();
        let mut shot = shot
            .with_cells("J", 1, fields.j)?
            .with_cells("P", 9, fields.piola)?
            .with_cells("cauchy_stress", 9, fields.cauchy)?
            .with_cells("mises", 1, mises)?
            .with_cells("energy", 1, fields.energy)?;
        let displacement = self.solid().model().displacement(&of.state.u);
        for (k, attached) in self.solid().body().actuations().iter().enumerate() {
            let values = self.solid().body().point_values(k, &displacement, &of.state.controls);
            if let (Some(quantity), Ok(Some(values))) = (attached.law.point_quantity(), values) {
                let means = self.solid().discretization().cell_average(&values, 1);
                shot = shot.with_cells(&format!("{}_{}", quantity.name, attached.name), 1, means)?;
            }
        }
        for (name, direction) in fields.directions {
            shot = shot.with_cells(&format!("direction_{name}"), 3, direction)?;
        }
        if let Some(fiber) = fields.fiber {
            shot = shot.with_cells("fiber", 3, fiber)?;
        }
        if of.detailed { self.with_details(shot, of.state) } else { Ok(shot) }
    }

    /// Strains and stretches, smoothed stresses, reactions. Those that are means or smoothed are in single precision, which is more
    /// than their accuracy.
    fn with_details(&self, shot: Snapshot, state: &State) -> Result<Snapshot, MeshError> {
        let solid = self.solid();
        let (Ok(strains), Ok(stresses)) = (solid.cell_strains(state), solid.nodal_stresses(state)) else {
            return Ok(shot);
        };
        // in motion supports hold masses and viscous forces too
        let reactions = if self.timeline().is_none() { solid.nodal_reactions(state).ok() } else { None };
        let stretches = strains.chunks_exact(9).flat_map(principal_stretches).collect();
        let mises = stresses.chunks_exact(9).map(von_mises).collect();
        let shot = match reactions {
            Some(reactions) => shot.with_points("reaction", 3, reactions)?,
            None => shot,
        };
        let shot = shot
            .with_points("nodal_cauchy_stress", 9, stresses)?
            .with_points("nodal_mises", 1, mises)?
            .with_cells("green_strain", 9, strains)?
            .with_cells("principal_stretches", 3, stretches)?;
        Ok(shot.in_single(&["nodal_cauchy_stress", "nodal_mises", "green_strain", "principal_stretches"]))
    }
}

/// Vectors by node with a third component of zero in the plane.
fn by_triple(u: &[f64], dim: usize) -> Vec<f64> {
    let triple = |u: &[f64]| -> [f64; 3] { std::array::from_fn(|k| u.get(k).copied().unwrap_or(0.0)) };
    u.chunks_exact(dim).flat_map(triple).collect()
}

/// `(3/2 s : s)^(1/2)` with the deviator s of a Cauchy stress, row by row.
fn von_mises(stress: &[f64]) -> f64 {
    let mean = (stress[0] + stress[4] + stress[8]) / 3.0;
    let deviator = |k: usize| stress[k] - if k.is_multiple_of(4) { mean } else { 0.0 };
    (1.5 * (0..9).map(|k| deviator(k).powi(2)).sum::<f64>()).sqrt()
}

/// `(1 + 2 e_i)^(1/2)` of the eigenvalues e_1 >= e_2 >= e_3 of a Green-Lagrange strain, row by row.
fn principal_stretches(strain: &[f64]) -> [f64; 3] {
    let mut values: [f64; 3] = Mat3::from_row_slice(strain).symmetric_eigenvalues().into();
    values.sort_unstable_by(|a, b| b.total_cmp(a));
    values.map(|e| (1.0 + 2.0 * e).max(0.0).sqrt())
}

/// A nodal field on all nodes of the mesh: on corners as it is, between them by the corner shape functions, zero where it
/// does not act.
fn by_node(disc: &Discretization, cells: &[u32], block: &ControlBlock, values: &[f64]) -> Vec<f64> {
    let (mesh, n) = (disc.mesh(), block.components);
    let mut out = vec![0.0; mesh.points().len() * n];
    // unknowns are numbered by the nodes of the whole body
    let in_whole = |node: u32| disc.over_ranks().map_or(node, |(part, _)| part.nodes()[node as usize]);
    let unknown = |node: u32| block.basis.entities().binary_search(&in_whole(node)).ok();
    for &id in cells {
        let cell = mesh.cell(id as usize);
        let corners = cell.kind.corners();
        let mut shapes = vec![0.0; corners];
        for (a, &node) in cell.nodes.iter().enumerate().skip(corners) {
            cell.kind.corner_kind().shapes(&cell.kind.reference_nodes()[a], &mut shapes);
            for c in 0..n {
                let terms = cell.nodes.iter().zip(&shapes);
                out[node as usize * n + c] =
                    terms.filter_map(|(&corner, shape)| Some(shape * values[unknown(corner)? * n + c])).sum();
            }
        }
    }
    for node in 0..mesh.points().len() {
        if let Some(k) = unknown(node as u32) {
            out[node * n..][..n].copy_from_slice(&values[k * n..][..n]);
        }
    }
    out
}
