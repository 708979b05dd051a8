//! Fields of a model beyond the displacement: where their unknowns are, and what does not go with them.

use super::Model;
use super::restricted::{RestrictedPoint, Selection};
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::tied::Tied;
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::discretization::Discretization;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_linear::{Field, On, Solver, SolverFactory, Space, SparseMatrix, Structure, Symmetry};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// The name of the first field, which every model has.
pub const DISPLACEMENT: &str = "displacement";

/// That of the displacement alone.
pub(super) fn displacement_alone(disc: &Discretization) -> Space {
    let (mesh, share) = (disc.mesh(), disc.parted().map(|parted| parted.share.clone()));
    Space::new(mesh.points().len(), mesh.cells()).with(Field::nodal(DISPLACEMENT, mesh.dim())).shared(share)
}

impl Model {
    /// The space of the unknowns: the displacement, the further nodal fields of contributions in the order in which they came, then the
    /// multipliers of their constraints.
    pub fn unknowns(&self) -> &Arc<Space> {
        &self.space
    }

    /// The displacement, flat, `dim * node + component`, of a vector of all unknowns; it is copied where a model has further fields.
    pub fn displacement<'u>(&self, u: &'u [f64]) -> Cow<'u, [f64]> {
        match self.space.has_one_nodal_field() {
            true => Cow::Borrowed(self.nodal(u)),
            false => Cow::Owned(self.space.components(u, 0, self.discretization().dim())),
        }
    }

    /// The values of a nodal field in a vector of all unknowns, shape `[nodes][components]`.
    ///
    /// # Errors
    /// [`FemError::Meaningless`]: no such field.
    pub fn field(&self, name: &str, u: &[f64]) -> Result<Vec<f64>, FemError> {
        let (first, field) = nodal_field(&self.space, name)?;
        let (mut values, unit) = (self.space.components(u, first, field.components), self.unit_of(name));
        values.iter_mut().for_each(|value| *value *= unit);
        Ok(values)
    }

    /// Holds a component of a nodal field at a value on nodes.
    ///
    /// # Errors
    /// No such field or component; a value that is not finite, or not that of an earlier support.
    pub fn prescribe(
        &mut self,
        field: &str,
        component: usize,
        support: &str,
        nodes: &[u32],
        value: f64,
    ) -> Result<(), FemError> {
        let (first, known) = nodal_field(&self.space, field)?;
        if component >= known.components {
            let what = format!("field \"{field}\" has no component {component}; it has {}", known.components);
            return Err(FemError::Meaningless { what });
        }
        let unit = self.unit_of(field);
        Arc::make_mut(&mut self.supports).hold(
            support,
            nodes,
            first + component,
            &format!("{component} of \"{field}\""),
            value / unit,
        )
    }

    /// What unknowns of a field are multiplied by to be in its unit: see [`Contribution::field_unit`].
    pub fn unit_of(&self, field: &str) -> f64 {
        let owns = |c: &&Arc<dyn Contribution>| c.fields().iter().any(|own| own.name == field);
        self.others.iter().find(owns).map_or(1.0, |own| own.field_unit())
    }

    /// Holds the fields beyond the displacement at zero at nodes where no contribution determines them.
    ///
    /// # Errors
    /// A node that something holds already.
    pub fn hold_idle_fields(&mut self) -> Result<(), FemError> {
        let fields: Vec<Field> = self.space.nodal_fields().skip(1).map(|(_, field)| field.clone()).collect();
        for field in fields {
            let own = self.others.iter().filter(|c| c.fields().iter().any(|own| own.name == field.name));
            let Some(nodes) = own.map(|c| c.field_nodes()).collect::<Option<Vec<_>>>() else { continue };
            let mut idle = vec![true; self.space.nodes()];
            nodes.iter().flatten().for_each(|node| idle[*node as usize] = false);
            let idle: Vec<u32> = (0..self.space.nodes() as u32).filter(|node| idle[*node as usize]).collect();
            let name = format!("where there is no {}", field.name);
            let components = if idle.is_empty() { 0 } else { field.components };
            (0..components).try_for_each(|c| self.prescribe(&field.name, c, &name, &idle, 0.0))?;
        }
        Ok(())
    }

    /// What contributions report of what all others put on unknowns of theirs: see [`Gathers`](nastic_body::contribution::gathers::Gathers).
    pub(super) fn gathered(&self, at: &Instant) -> Result<Vec<(String, &'static str, f64)>, Inadmissible> {
        let mut all = Vec::new();
        if self.others.iter().all(|c| c.gathers().is_none()) {
            return Ok(all);
        }
        let mut sums = Sums::zero(self.space.len());
        let demand = Demand { energy: false, force: true };
        for (contribution, at) in self.others.iter().zip(self.instants(at)).filter(|(c, _)| c.gathers().is_none()) {
            self.point_of(contribution.as_ref(), &at, Need::Residual)?.add_residual(&at, demand, &mut sums)?;
        }
        for (contribution, at) in self.others.iter().zip(self.instants(at)) {
            let Some(gathers) = contribution.gathers() else { continue };
            let own = self.selection(contribution.as_ref()).map(|selection| selection.gather(&sums.force));
            let force = own.as_deref().unwrap_or(&sums.force);
            let sum = gathers.unknowns().into_iter().map(|dof| force[dof]).sum();
            let quantities = self.among_fields(contribution.as_ref(), &at, |at| gathers.quantities(at, sum));
            all.extend(quantities.into_iter().map(|(name, value)| (contribution.name().to_owned(), name, value)));
        }
        Ok(all)
    }

    /// The space with the fields of a contribution.
    pub(super) fn space_with(&self, contribution: &dyn Contribution) -> Result<Space, FemError> {
        let mut space = Space::clone(&self.space);
        for field in contribution.fields() {
            self.check_field(contribution, field)?;
            if space.nodal_field(&field.name).is_none() {
                space = space.with(field.clone());
            }
        }
        if let Some(constraints) = contribution.constrains() {
            space = space.with(Field::multipliers(contribution.name(), constraints.count()));
        }
        Ok(space)
    }

    /// The volumes of nodes by unknown of the displacement, zero of further fields.
    pub(crate) fn volumes_by_unknown(&self) -> Vec<f64> {
        let (dim, block) = (self.discretization().dim(), self.space.block());
        let of_node = |volume: f64| (0..block).map(move |i| if i < dim { volume } else { 0.0 });
        self.discretization().nodal_volumes().into_iter().flat_map(of_node).collect()
    }

    /// By unknown on nodes, whether the potential has a maximum by it and it is free: neither held nor led by others. Empty where it has one by none.
    pub(crate) fn maxima(&self) -> Vec<bool> {
        if !self.space.has_saddle_field() {
            return Vec::new();
        }
        let (components, nodes) = (self.space.maxima(), self.space.nodes());
        let all = (0..nodes).flat_map(|_| &components).enumerate();
        all.map(|(dof, is)| *is && self.supports.is_free(dof)).collect()
    }

    fn check_field(&self, contribution: &dyn Contribution, field: &Field) -> Result<(), FemError> {
        let what = format!("field \"{}\"", field.name);
        if field.on != On::Nodes || field.components == 0 {
            return Err(refused(
                &what,
                contribution.name(),
                "fields of contributions are on nodes, with a component or more",
            ));
        }
        match self.space.nodal_field(&field.name) {
            Some((_, known)) if !known.agrees(field) => {
                let why =
                    format!("another contribution has it with {} components as {:?}", known.components, known.role);
                Err(refused(&what, contribution.name(), &why))
            }
            _ => Ok(()),
        }
    }

    /// The first field beyond the displacement and a contribution that has it, where there is one.
    pub(super) fn further(&self) -> Option<(&str, &str)> {
        let field = further(&self.space)?;
        let owner = self.others.iter().find(|c| c.fields().iter().any(|own| own.name == field.name));
        Some((&field.name, owner.map_or("", |owner| owner.name())))
    }

    pub(super) fn selection(&self, contribution: &dyn Contribution) -> Option<Selection> {
        Selection::of(&self.space, contribution.fields())
    }

    /// Calls with the instant as a contribution sees it: with the fields that it knows of.
    pub(crate) fn among_fields<T>(
        &self,
        contribution: &dyn Contribution,
        at: &Instant,
        call: impl FnOnce(&Instant) -> T,
    ) -> T {
        match self.selection(contribution) {
            None => call(at),
            Some(selection) => selection.at(at, call),
        }
    }

    /// A contribution at a displacement, among the unknowns of the model.
    pub(crate) fn point_of<'m>(
        &'m self,
        contribution: &'m dyn Contribution,
        at: &Instant,
        need: Need,
    ) -> Result<Box<dyn ContributionPoint + 'm>, Inadmissible> {
        let Some(selection) = self.selection(contribution) else { return contribution.at(at, need) };
        let point = selection.at(at, |at| contribution.at(at, need))?;
        Ok(Box::new(RestrictedPoint { point, selection }))
    }

    /// Calls a function with a contribution's point, restricted to its own fields, with their positions among the unknowns of the model.
    pub(super) fn wrapped<T>(
        &self,
        contribution: &dyn Contribution,
        point: &dyn ContributionPoint,
        call: impl FnOnce(&dyn ContributionPoint) -> T,
    ) -> T {
        let Some(selection) = self.selection(contribution) else { return call(point) };
        call(&RestrictedPoint { point, selection })
    }

    /// What a contribution adds to a symmetric matrix, added to one of the model.
    pub(super) fn add_matrix<E>(
        &self,
        contribution: &dyn Contribution,
        into: &mut SparseMatrix,
        add: impl FnOnce(&mut SparseMatrix) -> Result<(), E>,
    ) -> Result<(), E> {
        match self.selection(contribution) {
            None => add(into),
            Some(selection) => selection.among(into, add),
        }
    }

    /// The supports of the fields that a contribution knows of.
    pub(super) fn supports_of(&self, contribution: &dyn Contribution) -> Cow<'_, Supports> {
        match self.selection(contribution) {
            None => Cow::Borrowed(self.supports.as_ref()),
            Some(selection) => Cow::Owned(selection.supports(&self.supports)),
        }
    }

    /// The structure of the tangent.
    pub(crate) fn structure(&self) -> Arc<Structure> {
        match self.space.has_one_nodal_field() {
            true => self.tangent_structure().equations().clone(),
            false => self.tangent_structure().with_components(self.space.block()),
        }
    }

    /// Refuses a solver, that of a request or else the chosen one, which does not go with the fields (multigrid, whose modes are those of rigid
    /// motions), or with a tangent that is not symmetric.
    pub(crate) fn check_solver(&self, wanted: Option<&dyn SolverFactory>) -> Result<(), FemError> {
        let Some(wanted) = wanted.or(self.chosen_solver.map(|chosen| chosen as &dyn SolverFactory)) else {
            return Ok(());
        };
        let instead = self.suitable_solver().name();
        match self.further() {
            None if wanted.name() == Solver::MULTIGRID.name() && !self.supports.ties().is_empty() => {
                let why = format!("its levels would couple all cells around a rigid body: take {instead}");
                Err(refused("multigrid", "rigid bodies", &why))
            }
            Some((field, owner)) if wanted.name() == Solver::GENERAL.name() && self.space.has_saddle_field() => {
                let why = format!(
                    "a factor of its symmetric part is to be positive definite, which field \"{field}\" is not: take {instead}"
                );
                Err(refused("general", owner, &why))
            }
            Some((field, owner)) if wanted.name() == Solver::MULTIGRID.name() => {
                let why = format!("it has no modes for its field \"{field}\": take {instead}");
                Err(refused("multigrid", owner, &why))
            }
            _ if self.properties().symmetry() == Symmetry::General && wanted.takes() == Symmetry::Symmetric => {
                let why = format!(
                    "friction, follower loads and contributions of a general symmetry make it so: take {instead}"
                );
                Err(refused(wanted.name(), "a tangent that is not symmetric", &why))
            }
            _ => Ok(()),
        }
    }

    /// What solves its tangent systems unless a request says otherwise: what was chosen, or else what suits.
    pub fn solver(&self) -> &'static dyn SolverFactory {
        self.chosen_solver.unwrap_or_else(|| self.suitable_solver())
    }

    fn suitable_solver(&self) -> &'static dyn SolverFactory {
        match (self.properties().symmetry(), self.space.has_one_nodal_field()) {
            // in whose hierarchy all cells around a rigid body would be coupled with each other
            (Symmetry::Symmetric, true) if !self.supports.ties().is_empty() => Solver::DIRECT,
            (Symmetry::Symmetric, true) => self.tangent_structure().solver(),
            (Symmetry::Symmetric, false) => Solver::DIRECT,
            (Symmetry::General, true) => Solver::GENERAL,
            (Symmetry::General, false) => Solver::LU,
        }
    }
}

/// The components in a node's block of the field that is tied.
pub(super) fn tied_components(space: &Space, by: &dyn Contribution, tied: &Tied) -> Result<Range<usize>, FemError> {
    let name = tied.field.as_deref().unwrap_or(DISPLACEMENT);
    let (first, field) = nodal_field(space, name)?;
    let own = tied.field.is_none() || by.fields().iter().any(|own| own.name == *name);
    if !own {
        let why = "it ties a field that is not one of its own: name it in `Contribution::fields`";
        return Err(refused(&format!("field \"{name}\""), by.name(), why));
    }
    Ok(first..first + field.components)
}

fn nodal_field<'s>(space: &'s Space, name: &str) -> Result<(usize, &'s Field), FemError> {
    space.nodal_field(name).ok_or_else(|| {
        let known: Vec<&str> = space.nodal_fields().map(|(_, field)| field.name.as_str()).collect();
        let what = format!("there is no field \"{name}\" on the nodes; there are {}", known.join(", "));
        FemError::Meaningless { what }
    })
}

fn further(space: &Space) -> Option<&Field> {
    space.nodal_fields().nth(1).map(|(_, field)| field)
}

fn refused(what: &str, with: &str, why: &str) -> FemError {
    FemError::Unsupported { what: what.to_owned(), with: with.to_owned(), why: why.to_owned() }
}
