//! [`Model`]: a discrete problem, the sum of contributions on supported unknowns.

mod admissible;
mod checks;
mod contacts;
pub mod features;
mod fields;
mod held_forces;
mod history;
mod inequalities;
mod mass;
mod over_ranks;
mod point;
mod prescribed;
mod products;
mod rayleigh_damping;
mod restricted;
mod shape;
mod stored_energy;
pub mod views;

use crate::linear_systems::saddle_point::BorderedTangent;
use crate::model::views::{Properties, Tangents};
use nastic_body::body_energy::AttachedLaw;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::body_energy::driving::Driving;
use nastic_body::body_energy::point_peaks::PointPeak;
use nastic_body::body_energy::point_strains::PointStrains;
use nastic_body::contribution::constrains::Constrains;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::ControlPoint;
use nastic_body::controls::Controls;
use nastic_body::discretization::Discretization;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{Cause, FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_body::structure::TangentStructure;
use nastic_energy::Slot;
use nastic_forces::dead_load::DeadLoad;
use nastic_linear::{SolverFactory, Space, SparseMatrix, Symmetry};
use nastic_mesh::{GroupNames, Polyline};
use std::sync::Arc;

pub use contacts::{ContactSum, Contacts, Pressing};
pub use features::Feature;
pub use fields::DISPLACEMENT;
pub use point::ModelPoint;
pub use stored_energy::StoredEnergy;

/// Find u with `u = load u_D` on the supports such that `sum_c r_c(u) = 0` elsewhere.
///
/// Newton's method, load steps and the adjoint use the model and know none of its contributions.
#[derive(Debug, Clone)]
pub struct Model {
    /// Energy of the cells.
    pub body: BodyEnergy,
    /// Prescribed unknowns, and those that depend on others.
    pub supports: Arc<Supports>,
    /// Dead loads at load 1.
    pub dead_load: DeadLoad,
    /// All other contributions, in the order in which they were added.
    pub others: Vec<Arc<dyn Contribution>>,
    space: Arc<Space>,
    /// The solver of its tangent systems, if one was chosen.
    pub chosen_solver: Option<&'static dyn SolverFactory>,
}

/// What can be controlled: an actuation of the body, or a contribution with slots.
#[derive(Debug, Clone, Copy)]
pub struct Controllable<'a> {
    /// Name of the actuation or contribution.
    pub name: &'a str,
    /// Its slots.
    pub slots: &'a [Slot],
    /// The regions it acts on; `None` for a contribution whose controls are not fields over cells.
    pub regions: Option<&'a GroupNames>,
    /// Their cells, likewise.
    pub cells: Option<&'a [u32]>,
    /// Measure of the set it acts on, where that is not a set of cells.
    pub measure: f64,
    /// Its points, if it is a contribution with points.
    pub points: &'a [ControlPoint],
    /// Whether it prescribes unknowns of the body.
    pub holds: bool,
    /// A further name, and the number of first slots that it stands for: slots with the same further name are controlled together.
    pub shared: Option<(&'a str, usize)>,
}

impl Model {
    /// The same model with some contributions replaced, in their order.
    pub(crate) fn replacing(&self, others: Vec<Option<Arc<dyn Contribution>>>) -> Self {
        let own = self.others.iter().zip(others).map(|(own, other)| other.unwrap_or_else(|| own.clone()));
        Model { others: own.collect(), ..self.clone() }
    }

    /// A body without materials, supports or loads.
    pub fn new(disc: Arc<Discretization>) -> Self {
        let (supports, dead_load) = (Arc::new(Supports::new(disc.mesh())), DeadLoad(Arc::new(vec![0.0; disc.dofs()])));
        let space = Arc::new(fields::displacement_alone(&disc));
        Model { body: BodyEnergy::new(disc), supports, dead_load, others: Vec::new(), space, chosen_solver: None }
    }

    /// Adds a contribution.
    ///
    /// # Errors
    /// A name that is taken, couplings that do not fit the mesh.
    pub fn add(&mut self, contribution: Arc<dyn Contribution>) -> Result<(), FemError> {
        let name = contribution.name();
        if !contribution.spans_ranks() {
            self.ranks().refuse_ranks(&format!("\"{name}\""))?;
        }
        // a free shape is the law that sees its gradients too
        let is_shape = |own: &&AttachedLaw| own.is_shape() && contribution.free_shape().is_some();
        let laws = self.body.actuations().iter().filter(|own| !is_shape(own)).map(|own| own.name.as_str());
        let mut taken = laws.chain(self.others.iter().map(|c| c.name()));
        if taken.any(|known| known == name) || [self.body.name(), self.dead_load.name()].contains(&name) {
            let what = format!("there are two actuations or contributions named \"{name}\"; rename one");
            return Err(FemError::Meaningless { what });
        }
        let space = self.space_with(contribution.as_ref())?;
        let mut supports = self.supports.clone();
        if supports.block != space.block() {
            Arc::make_mut(&mut supports).widen(space.block());
        }
        if let Some(tied) = contribution.tied() {
            let components = fields::tied_components(&space, contribution.as_ref(), tied)?;
            Arc::make_mut(&mut supports).tie(name, components, tied)?;
        }
        let structure = self.tangent_structure().with_couplings(&contribution.couplings())?;
        let structure = structure.with_ties(supports.ties(), space.block())?;
        if let Some(moved) = contribution.prescribes() {
            let unknowns = prescribed::unknowns_among(&space, contribution.as_ref(), moved);
            Arc::make_mut(&mut supports).drive(name, &unknowns)?;
        }
        self.supports = supports;
        self.body.set_structure(structure)?;
        self.space = Arc::new(space);
        self.others.push(contribution);
        Ok(())
    }

    /// The discretisation.
    pub fn discretization(&self) -> &Arc<Discretization> {
        self.body.discretization()
    }

    /// Which nodes are coupled in its tangents, without the contact pairs, which change with the state.
    pub fn tangent_structure(&self) -> &Arc<TangentStructure> {
        self.body.structure()
    }

    /// Everything that can be controlled, in the order of the blocks of [`Controls`]; internal variables, which are not controls,
    /// have no slots.
    pub fn controllable(&self) -> Vec<Controllable<'_>> {
        // a global value is not a field over the cells
        let over_cells = |a: &AttachedLaw| !a.is_global();
        let of_body = self.body.actuations().iter().map(|a| Controllable {
            name: &a.name,
            slots: a.controlled_slots(),
            regions: over_cells(a).then_some(&a.regions),
            cells: over_cells(a).then_some(a.cells.as_slice()),
            measure: if over_cells(a) { 0.0 } else { self.body.volume_of(&a.cells) },
            points: &[],
            holds: false,
            shared: a.shape_modes().map(|modes| (a.name.as_str(), modes.len())),
        });
        let own = self.others.iter().filter(|c| !c.slots().is_empty()).map(|c| Controllable {
            name: c.name(),
            slots: c.slots(),
            regions: c.over_cells().map(|over| over.regions),
            cells: c.over_cells().map(|over| over.cells),
            measure: c.measure(),
            points: c.control_points(),
            holds: c.prescribes().is_some(),
            shared: c.shared_slots(),
        });
        of_body.chain(own).collect()
    }

    /// The controls with loads zero; designs stay as they are, and so does growth, which the stored energy of the laws depends on.
    pub fn unactuated(&self, controls: &Controls) -> Controls {
        self.taken_over(controls.clone(), &self.zero_controls(), |k, slot| !slot.is_design() && !self.body.grows_by(k))
    }

    /// Controls with the designs of others.
    pub(crate) fn with_designs(&self, controls: Controls, of: &Controls) -> Controls {
        self.taken_over(controls, of, |_, slot| slot.is_design())
    }

    /// Controls with the values of others in some slots.
    fn taken_over(&self, mut controls: Controls, of: &Controls, which: impl Fn(usize, &Slot) -> bool) -> Controls {
        for (k, own) in self.controllable().iter().enumerate() {
            let width = controls.slots(k);
            for (slot, _) in own.slots.iter().enumerate().filter(|(_, slot)| which(k, slot)) {
                let values = controls.values_mut(k).iter_mut().zip(of.values(k));
                values.skip(slot).step_by(width).for_each(|(value, other)| *value = *other);
            }
        }
        controls
    }

    /// Controls of this model at rest: loads zero, designs as their actuations and contributions say.
    pub fn controls(&self) -> Controls {
        let with_slots = || self.others.iter().filter(|c| !c.slots().is_empty());
        let points = |c: &Arc<dyn Contribution>| match c.over_cells() {
            Some(over) => over.points,
            None => c.control_points().len().max(1),
        };
        let mut own = Controls::zeros(with_slots().map(|c| (c.slots().len(), points(c))));
        for (k, contribution) in with_slots().enumerate() {
            let rest = contribution.slots().iter().map(Slot::rest).cycle();
            own.values_mut(k).iter_mut().zip(rest).for_each(|(value, rest)| *value = rest);
        }
        self.body.controls().chain(own)
    }

    /// Controls of this model, all zero: changes of controls, derivatives by them.
    pub fn zero_controls(&self) -> Controls {
        self.controls().zeroed()
    }

    /// Whether all contributions have a potential, with friction left out.
    pub(crate) fn has_potential_without_friction(&self) -> bool {
        self.others.iter().all(|c| c.has_potential() || c.path_dependence().is_some())
    }

    /// A matrix of an empty pattern, where products replace its entries.
    pub(crate) fn matrix_without_values(&self) -> SparseMatrix {
        SparseMatrix::without_values(self.structure().pattern().clone())
    }

    /// Energy alone, or energy and residual force.
    ///
    /// # Errors
    /// [`Inadmissible`] if u is not admissible.
    pub fn evaluate(&self, at: &Instant, demand: Demand) -> Result<Sums, Inadmissible> {
        self.at(at, Need::Residual)?.evaluate(at, demand)
    }

    /// Residual and tangent with independent strains at the quadrature points of the body.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub(crate) fn add_with_point_strains(
        &self,
        at: &Instant,
        strains: &PointStrains,
        sums: &mut Sums,
        tangent: &mut BorderedTangent,
    ) -> Result<(), Inadmissible> {
        let (u, driving) = (self.nodal(at.u), Driving::of(at));
        self.body.add_with_point_strains(u, driving, strains, sums, &mut tangent.matrix, at.parallel)?;
        let demand = Demand { energy: false, force: true };
        self.dead_load.add_residual(&Instant { u, ..*at }, demand, sums)?;
        self.each_other(at, |contribution, at| {
            let point = contribution.at(at, Need::Derivatives)?;
            point.add_residual(at, demand, sums)?;
            tangent.add(contribution, &*point, at).map_err(|e| e.of(contribution.name()))
        })
    }

    /// `lambda . dr/dp` by controls, velocity and acceleration.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn vjp(&self, at: &Instant, lambda: &[f64]) -> Result<Sensitivities, Inadmissible> {
        self.at(at, Need::Residual)?.vjp(at, lambda)
    }

    /// `dr/dm v`: the change of the residual along a change of the controls.
    ///
    /// # Errors
    /// [`SecondDerivativeError`]: J <= 0, or a contribution that does not give it.
    pub fn control_product(&self, at: &Instant, v: &Controls) -> Result<Vec<f64>, SecondDerivativeError> {
        self.at(at, Need::Residual)?.control_product(at, v)
    }

    /// The change of `K^T lambda` and of `lambda . dr/dm` along a change of displacement and controls.
    ///
    /// # Errors
    /// [`SecondDerivativeError`]: J <= 0, or a term that does not give it.
    pub fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
    ) -> Result<SecondSensitivities, SecondDerivativeError> {
        self.at(at, Need::Residual)?.second_vjp(at, lambda, along)
    }

    /// The unknowns on nodes among all: the displacement, where there is no further field.
    pub fn nodal<'u>(&self, u: &'u [f64]) -> &'u [f64] {
        &u[..u.len().min(self.space.nodal())]
    }

    /// Whether all constraints can be fulfilled under these controls.
    pub(crate) fn check_constraints(&self, controls: &Controls) -> Result<(), FemError> {
        let rest = vec![0.0; self.unknowns().len()];
        self.each_other(&Instant::new(&rest, controls, 1.0), |contribution, at| {
            contribution.constrains().map_or(Ok(()), |constraints| constraints.check(at))
        })
    }

    /// A contribution by name, the index of its block of controls, that of its first multiplier, and that of its internal variables.
    pub fn contribution(&self, name: &str) -> Option<(&dyn Contribution, usize, usize, usize)> {
        let mut found: Option<(&dyn Contribution, usize, usize, usize)> = None;
        let (mut block, mut scalar) = (self.body.actuations().len(), self.space.nodal());
        for contribution in [&self.body as &dyn Contribution, &self.dead_load].into_iter().filter(|c| c.name() == name)
        {
            found = Some((contribution, 0, scalar, usize::MAX));
        }
        for (contribution, memory) in self.others.iter().zip(block..) {
            if contribution.name() == name {
                found = Some((contribution.as_ref(), block, scalar, memory));
            }
            scalar += count(contribution);
            block += usize::from(!contribution.slots().is_empty());
        }
        found
    }

    /// The largest values of what actuations and contributions are judged by at every point.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn point_peaks(&self, at: &Instant) -> Result<Vec<PointPeak>, Inadmissible> {
        let mut all = self.body.point_peaks(&self.displacement(at.u), at.controls)?;
        self.each_other(at, |contribution, at| {
            all.extend(contribution.point_peak(at));
            Ok::<(), Inadmissible>(())
        })?;
        Ok(all)
    }

    /// Named numbers of every actuation and contribution that has some: its name, that of the number, value. Of an actuation it is the
    /// largest value over its points (see [`BodyEnergy::point_peaks`]).
    ///
    /// # Errors
    /// [`Inadmissible`] where a contribution needs J > 0.
    pub fn quantities(&self, at: &Instant) -> Result<Vec<(String, &'static str, f64)>, Inadmissible> {
        let peaks = self.point_peaks(at)?;
        let mut all: Vec<_> = peaks.into_iter().map(|peak| (peak.actuation, peak.quantity.name, peak.value)).collect();
        if let (Some((_, shape)), Some(worst)) = (self.body.shape(), self.body.shape_quality(at.controls)) {
            let own = [("least_det_G", worst.least_volume), ("distortion", worst.distortion)];
            all.extend(own.map(|(name, value)| (shape.name.clone(), name, value)));
        }
        self.each_other(at, |contribution, at| {
            let own = contribution.quantities(at);
            all.extend(own.into_iter().map(|(name, value)| (contribution.name().to_owned(), name, value)));
            Ok::<(), Inadmissible>(())
        })?;
        all.extend(self.gathered(at)?);
        Ok(all)
    }

    /// Lines by which contributions are shown beside the body.
    ///
    /// # Errors
    /// [`Inadmissible`] where a contribution needs J > 0.
    pub fn lines(&self, at: &Instant) -> Result<Vec<Polyline>, Inadmissible> {
        let mut all = Vec::new();
        self.each_other(at, |contribution, at| {
            all.extend(contribution.lines(at));
            Ok::<(), Inadmissible>(())
        })?;
        Ok(all)
    }

    /// The cause that a contribution suspects where no equilibrium was found.
    pub(crate) fn suspect(&self, at: &Instant) -> Option<Cause> {
        let ask = |contribution: &dyn Contribution, at: &Instant| contribution.suspect(at).map_or(Ok(()), Err);
        self.each_other(at, ask).err()
    }

    /// Calls `each` with every contribution beside the body, in a fixed order, and the instant at which it is evaluated.
    pub fn each_other<E>(
        &self,
        at: &Instant,
        mut call: impl FnMut(&dyn Contribution, &Instant) -> Result<(), E>,
    ) -> Result<(), E> {
        self.others.iter().zip(self.instants(at)).try_for_each(|(contribution, at)| {
            let contribution = contribution.as_ref();
            self.among_fields(contribution, &at, |at| call(contribution, at))
        })
    }

    /// The instant at which each contribution beside the body is evaluated.
    pub(crate) fn instants<'a>(&'a self, at: &Instant<'a>) -> impl Iterator<Item = Instant<'a>> {
        let (at, mut block, mut scalar) = (*at, self.body.actuations().len(), self.space.nodal());
        self.others.iter().zip(block..).map(move |(contribution, memory)| {
            let own = Instant { space: &self.space, block, scalar, memory, ..at };
            scalar += count(contribution);
            block += usize::from(!contribution.slots().is_empty());
            own
        })
    }

    /// The same by supports alone.
    pub(crate) fn is_held_by_supports(&self) -> bool {
        self.supports.check(self.discretization(), &[]).is_ok()
    }

    /// Cells all of whose nodes one rigid body holds together.
    pub(crate) fn rigid_cells(&self) -> Vec<u32> {
        let mesh = self.discretization().mesh();
        let in_one = |cell: &u32| {
            let nodes = mesh.cell(*cell as usize).nodes;
            let first = self.supports.body_of(nodes[0]);
            first.is_some() && nodes.iter().all(|&node| self.supports.body_of(node) == first)
        };
        if self.supports.ties().is_empty() { Vec::new() } else { (0..mesh.cells() as u32).filter(in_one).collect() }
    }
}

/// Number of constraints of a contribution.
pub(crate) fn count(contribution: &Arc<dyn Contribution>) -> usize {
    contribution.constrains().map_or(0, Constrains::count)
}

impl Tangents<'_> {
    /// A zero matrix for the tangent.
    pub fn matrix(&self) -> SparseMatrix {
        SparseMatrix::with_symmetry(self.model.structure().pattern().clone(), self.model.properties().symmetry())
    }

    /// Adds the tangent, supports not eliminated.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.model.at(at, Need::Residual)?.add_tangent(at, tangent)
    }

    /// The tangent with the border of the constraints, supports not eliminated.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn bordered_tangent(&self, at: &Instant) -> Result<BorderedTangent, Inadmissible> {
        self.model.at(at, Need::Residual)?.bordered_tangent(at)
    }
}

impl<'a> Properties<'a> {
    /// Whether all contributions have symmetric tangents.
    pub fn symmetry(&self) -> Symmetry {
        self.model.others.iter().map(|c| c.symmetry()).max().unwrap_or(Symmetry::Symmetric)
    }

    /// The name of a contribution beside the body that stores energy where its controls are zero, if there is one.
    pub fn storing(&self) -> Option<&'a str> {
        self.model
            .others
            .iter()
            .find(|contribution| contribution.stores_energy())
            .map(|contribution| contribution.name())
    }

    /// Whether an equilibrium depends on the way there: with friction.
    pub fn depends_on_path(&self) -> bool {
        self.model.others.iter().any(|c| c.path_dependence().is_some())
    }

    /// The largest ratio of bulk to shear modulus of the cells at rest, of their passive laws with the designs among the controls: how nearly incompressible the body is.
    pub fn bulk_over_shear(&self, controls: &Controls) -> f64 {
        -self.model.space.least(-self.model.body.bulk_over_shear(controls))
    }

    /// Whether all contributions have a potential.
    pub fn has_potential(&self) -> bool {
        self.model.others.iter().all(|c| c.has_potential())
    }
}
