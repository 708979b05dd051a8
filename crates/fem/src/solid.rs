//! [`Solid`]: a body with its materials, actuations, supports and dead loads.

use nastic_body::body_energy::formulation::Formulation;
use nastic_body::body_energy::{AttachedLaw, BodyEnergy};
use nastic_body::contribution::Contribution;
use nastic_body::controls::Controls;
use nastic_body::discretization::Discretization;
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::FemError;
use nastic_energy::EnergyTerm;
use nastic_equilibrium::model::Model;
use nastic_forces::cavity::Cavity;
use nastic_forces::contact::Contact;
use nastic_forces::foundation::Foundation;
use nastic_forces::inertia::{BodyInertia, Inertia};
use nastic_forces::medium::Medium;
use nastic_forces::moving_support::MovingSupport;
use nastic_forces::nodal_value::NodalValue;
use nastic_forces::rayleigh_damping::RayleighDamping;
use nastic_forces::rigid_body::RigidBody;
use nastic_forces::spring::Spring;
use nastic_forces::tendon::Tendon;
use nastic_linear::SolverFactory;
use nastic_mesh::{GroupNames, Mesh};
use nastic_tensor::Vec3;
use std::sync::Arc;

pub(crate) mod cell_fields;
mod electric;
mod over_ranks;
mod reactions;
mod shapes;
mod solving;

/// A body that can be solved: find u with `u = u_D` on the supports such that
/// `int P(F(u), m) : grad v dX = int b . v dX + int t . v dA` for all admissible v.
///
/// Built by chaining; each call says what it could not find. Clones share the mesh side.
///
/// ```
/// use nastic_fem::Solid;
/// use nastic_energy::{FiberTension, MooneyRivlin};
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_tensor::Vec3;
///
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [5, 1, 1], CellKind::Hex8)?)?
///     .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
///     .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
///     .clamp("x-")?;
/// let rest = body.solve(&body.controls(), &Default::default())?;
/// assert!(rest.u.iter().all(|u| u.abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Solid {
    model: Model,
}

impl Solid {
    /// A body without materials on the mesh.
    ///
    /// # Errors
    /// [`FemError::InvertedReference`].
    pub fn new(mesh: impl Into<Arc<Mesh>>) -> Result<Self, FemError> {
        Ok(Self::on(Discretization::new(mesh.into())?))
    }

    /// A body without materials on a discretisation shared with others.
    pub fn on(disc: Arc<Discretization>) -> Self {
        Solid { model: Model::new(disc) }
    }

    /// Adds a passive energy on a region, or on the union of several: `["wall", "cap"]`. Several on one region add up. A law chosen at run time is an `Arc<dyn EnergyTerm>`.
    ///
    /// # Errors
    /// The region's name is unknown, or a field of the law has the wrong length.
    pub fn material(
        mut self,
        region: impl Into<GroupNames>,
        term: impl EnergyTerm + 'static,
    ) -> Result<Self, FemError> {
        self.before_damping("material")?;
        let cells = self.mesh().cells_of(&region.into())?;
        self.model.body.add_term(&cells, Arc::new(term))?;
        Ok(self)
    }

    /// Chooses how the cells of a region, or of the union of several, represent volume changes. It holds for all laws and actuations there;
    /// [`Formulation::Standard`] unless something is chosen.
    ///
    /// # Errors
    /// The region's name is unknown, a cell is of a kind that cannot have the formulation, or has another one already; of a body over ranks, which all
    /// refuse together, a patch of cells that is [cut](Mesh::with_whole_patches).
    pub fn formulation(mut self, region: impl Into<GroupNames>, formulation: Formulation) -> Result<Self, FemError> {
        let cells = self.mesh().cells_of(&region.into())?;
        let chosen = self.model.body.set_formulation(&cells, formulation);
        self.model.ranks().all_accept(chosen)?;
        Ok(self)
    }

    /// Attaches an actuation to a region, or to the union of several, under a name. A law chosen at run time is an `Arc<dyn EnergyTerm>`.
    ///
    /// # Errors
    /// The region's name is unknown, the actuation's name is taken, or a field of the law has the wrong length.
    pub fn actuate(
        mut self,
        region: impl Into<GroupNames>,
        name: &str,
        law: impl EnergyTerm + 'static,
    ) -> Result<Self, FemError> {
        if self.model.controllable().iter().any(|known| known.name == name) {
            let what = format!("there are two actuations named \"{name}\"; rename one");
            return Err(FemError::Meaningless { what });
        }
        let regions = region.into();
        let cells = self.mesh().cells_of(&regions)?;
        let attached = AttachedLaw { name: name.to_owned(), law: Arc::new(law), regions, cells };
        if attached.is_shape() {
            self.before_shape(name)?;
        }
        self.model.body.add_actuation(attached)?;
        Ok(self)
    }

    /// Gives a region, or the union of several, a viscous law ([`MaxwellBranch`](nastic_energy::MaxwellBranch),
    /// [`KelvinVoigt`](nastic_energy::KelvinVoigt)) beside its passive one; several of one region act in parallel. They act in motion alone: a static
    /// state is one after a long time, in which they are relaxed.
    ///
    /// # Errors
    /// The region's name is unknown, the law has no internal variables, or a field of it has the wrong length.
    pub fn viscosity(self, region: impl Into<GroupNames>, law: impl EnergyTerm + 'static) -> Result<Self, FemError> {
        if law.evolution().is_none() {
            let what = format!("{law:?} is no viscous law: attach it as an actuation");
            return Err(FemError::Meaningless { what });
        }
        let name = format!("viscosity {}", self.model.body.actuations().len());
        self.actuate(region, &name, law)
    }

    /// Fixes all components on a surface or node set, or on several.
    ///
    /// # Errors
    /// The name is unknown, or an earlier support prescribes another value.
    pub fn clamp(self, surface: impl Into<GroupNames>) -> Result<Self, FemError> {
        self.displace(surface, [Some(0.0); 3])
    }

    /// Chooses what solves the tangent systems: a row of [`Solver::CATALOGUE`](crate::Solver::CATALOGUE), or a factory of your own. Unless something is
    /// chosen, what [`Solver::cheaper`](crate::Solver::cheaper) expects to be cheaper, where the tangent is not symmetric what takes it. Whether it
    /// goes with the rest of the body is checked with that.
    #[must_use]
    pub fn solver(mut self, factory: &'static dyn SolverFactory) -> Self {
        self.model.chosen_solver = Some(factory);
        self
    }

    /// Prescribes some displacement components (`None` stays free) on a surface or node set, or on several, whose reactions are
    /// then reported as one, `left, right`.
    ///
    /// # Errors
    /// As [`clamp`](Self::clamp); a component the dimension lacks is refused.
    pub fn displace(mut self, surface: impl Into<GroupNames>, values: [Option<f64>; 3]) -> Result<Self, FemError> {
        let surface = surface.into();
        let nodes = self.nodes_of(&surface)?;
        Arc::make_mut(&mut self.model.supports).prescribe(&surface.to_string(), &nodes, values)?;
        self.model.supports.check_left(&surface.to_string())?;
        Ok(self)
    }

    /// Prescribes displacement components node by node: `value` takes a node's number and reference position. The
    /// reactions are reported under `name`.
    ///
    /// # Errors
    /// As [`displace`](Self::displace).
    pub fn displace_nodes(
        mut self,
        name: &str,
        nodes: &[u32],
        value: impl Fn(u32, [f64; 3]) -> [Option<f64>; 3],
    ) -> Result<Self, FemError> {
        let mesh = self.mesh().clone();
        for &node in nodes {
            let point = mesh.points().get(node as usize).ok_or_else(|| FemError::Meaningless {
                what: format!("support \"{name}\" names node {node}; there are {}", mesh.points().len()),
            })?;
            Arc::make_mut(&mut self.model.supports).prescribe(name, &[node], value(node, *point))?;
        }
        self.model.supports.check_left(name)?;
        Ok(self)
    }

    /// Holds a component of a field at a value (at load 1) on a surface or node set, or on several: of the displacement, or of a
    /// [field](Contribution::fields) of a contribution that was added before.
    ///
    /// # Errors
    /// An unknown name, field or component; an earlier support prescribes another value.
    pub fn hold(
        mut self,
        field: &str,
        component: usize,
        surface: impl Into<GroupNames>,
        value: f64,
    ) -> Result<Self, FemError> {
        let surface = surface.into();
        let nodes = self.nodes_of(&surface)?;
        self.model.prescribe(field, component, &surface.to_string(), &nodes, value)?;
        Ok(self)
    }

    /// Adds a dead traction (force per reference area) on a surface, or on the union of several.
    ///
    /// # Errors
    /// The name is unknown, or a component is not finite.
    pub fn traction(mut self, surface: impl Into<GroupNames>, traction: Vec3) -> Result<Self, FemError> {
        let surface = surface.into();
        let facets = self.mesh().facets_of(&surface)?;
        let sampling = QuadraturePoints::of_facets(self.mesh(), &facets, |kind| kind.rule().clone());
        self.add_dead_load(&format!("traction on \"{surface}\""), &sampling, traction)?;
        Ok(self)
    }

    /// Adds a dead body force (force per reference volume) on a region, or on the union of several.
    ///
    /// # Errors
    /// The name is unknown, or a component is not finite.
    pub fn body_force(mut self, region: impl Into<GroupNames>, force: Vec3) -> Result<Self, FemError> {
        let region = region.into();
        let cells = self.mesh().cells_of(&region)?;
        let sampling = QuadraturePoints::of_cells(self.mesh(), cells, |kind| kind.rule().clone())?;
        self.add_dead_load(&format!("body force on \"{region}\""), &sampling, force)?;
        Ok(self)
    }

    fn add_dead_load(&mut self, what: &str, sampling: &QuadraturePoints, density: Vec3) -> Result<(), FemError> {
        nastic_body::controls::check_finite(what, density.as_slice())?;
        let dim = self.mesh().dim();
        if dim == 2 && density.z != 0.0 {
            return Err(FemError::Meaningless { what: format!("{what} has a z component on a plane-strain body") });
        }
        let weighted: Vec<f64> =
            sampling.weights().iter().flat_map(|w| (0..dim).map(move |i| w * density[i])).collect();
        sampling.spread(&weighted, dim, Arc::make_mut(&mut self.model.dead_load.0).as_mut_slice());
        Ok(())
    }

    /// Shares supports and dead loads with other bodies on the discretisation that have equal ones: [`Discretization::share`].
    pub fn share_equal_parts(&mut self) {
        let disc = self.model.discretization().clone();
        self.model.supports = disc.share(self.model.supports.clone());
        self.model.dead_load.0 = disc.share(self.model.dead_load.0.clone());
    }

    /// Adds a nodal dead load, flat (`dim` per node).
    ///
    /// # Errors
    /// Wrong length or a value that is not finite.
    pub fn nodal_force(mut self, force: &[f64]) -> Result<Self, FemError> {
        if force.len() != self.model.dead_load.0.len() {
            let (found, expected) = (force.len(), self.model.dead_load.0.len());
            return Err(FemError::Length { what: "nodal force".to_owned(), found, expected });
        }
        nastic_body::controls::check_finite("nodal force", force)?;
        for (total, f) in Arc::make_mut(&mut self.model.dead_load.0).iter_mut().zip(force) {
            *total += f;
        }
        Ok(self)
    }

    /// Checks that the problem is complete: every cell has a material, no rigid motion is left free.
    ///
    /// # Errors
    /// [`FemError::NoMaterial`], [`FemError::RigidMotion`].
    pub fn check(&self) -> Result<(), FemError> {
        self.model.check()
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        self.discretization().mesh()
    }

    /// The discretisation, to be shared with other solids.
    pub fn discretization(&self) -> &Arc<Discretization> {
        self.model.discretization()
    }

    /// The discrete problem: the sum of contributions.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Materials and actuations.
    pub fn body(&self) -> &BodyEnergy {
        &self.model.body
    }

    /// Supports.
    pub fn supports(&self) -> &Supports {
        &self.model.supports
    }

    /// Dead loads at load 1, flat.
    pub fn dead_load(&self) -> &[f64] {
        &self.model.dead_load.0
    }

    /// Controls of this body at rest: loads zero, designs as their actuations say.
    pub fn controls(&self) -> Controls {
        self.model.controls()
    }

    /// Adds a cavity under pressure, or of a volume.
    ///
    /// # Errors
    /// As [`Cavity`] says; a name that is taken.
    pub fn cavity(mut self, cavity: Cavity) -> Result<Self, FemError> {
        let contribution = cavity.on(self.whole_mesh("a cavity")?)?;
        self.model.add(contribution)?;
        Ok(self)
    }

    /// Adds a tendon.
    ///
    /// # Errors
    /// A guide outside the body, guides that coincide, numbers that are not positive; a name that is taken.
    pub fn tendon(mut self, tendon: Tendon) -> Result<Self, FemError> {
        let contribution = tendon.on(self.whole_mesh("a tendon")?)?;
        self.model.add(contribution)?;
        Ok(self)
    }

    /// Puts a surface on an elastic foundation.
    ///
    /// # Errors
    /// An unknown surface, a stiffness that is not positive; a second foundation on it.
    pub fn foundation(self, foundation: Foundation) -> Result<Self, FemError> {
        let contribution = foundation.of(self.mesh())?;
        self.contribution(contribution)
    }

    /// Fills a region with a medium that keeps its cells from folding.
    ///
    /// # Errors
    /// As [`Medium::of`] says; a name that is taken.
    pub fn medium(self, medium: Medium) -> Result<Self, FemError> {
        let contribution = medium.of(self.whole_mesh("a medium")?)?;
        self.contribution(contribution)
    }

    /// Adds a spring between two points of the body, or from one to a fixed point of space.
    ///
    /// # Errors
    /// As [`Spring`] says; a name that is taken.
    pub fn spring(mut self, spring: Spring) -> Result<Self, FemError> {
        let Some(parted) = self.discretization().parted() else {
            let contribution = spring.on(self.mesh())?;
            return self.contribution(contribution);
        };
        let added = spring.on_rank(self.mesh(), parted).map(|contribution| self.model.add(contribution))?;
        self.model.ranks().all_accept(added)?;
        Ok(self)
    }

    /// Holds a surface that moves as a rigid body.
    ///
    /// # Errors
    /// An unknown surface, nodes that something else holds; a name that is taken.
    pub fn motion(self, motion: MovingSupport) -> Result<Self, FemError> {
        let nodes = self.nodes_of(motion.surface())?;
        let contribution = motion.on(self.discretization(), nodes)?;
        self.contribution_of_all(contribution)
    }

    /// Gives a field beside the displacement one value on a surface or node set: that of a control, or one that is found.
    ///
    /// # Errors
    /// An unknown surface, nodes whose value something else holds; a name that is taken.
    pub fn nodal_value(self, value: NodalValue) -> Result<Self, FemError> {
        let contribution = value.on(self.mesh(), self.nodes_of(value.surface())?)?;
        self.contribution(contribution)
    }

    /// Makes a region a rigid body.
    ///
    /// # Errors
    /// A region that is unknown, flat or in parts; nodes that are moved, held as no simplex can be, or of another rigid body; a name that is taken.
    pub fn rigid(self, body: &RigidBody) -> Result<Self, FemError> {
        let contribution = self
            .before_damping("rigid body")
            .and_then(|()| body.on(self.whole_mesh("a rigid body")?, self.supports()))?;
        self.contribution(contribution)
    }

    /// Lets a surface touch an obstacle, another surface or itself; the materials come before it.
    ///
    /// # Errors
    /// As [`Contact`] says; a name that is taken.
    pub fn contact(mut self, contact: Contact) -> Result<Self, FemError> {
        let contribution = self.whole_mesh("a contact").and_then(|_| contact.on(self.body()))?;
        self.model.add(contribution)?;
        Ok(self)
    }

    /// Gives the body a mass, which acts in motion alone.
    ///
    /// # Errors
    /// A region's name is unknown, a density is not positive, cells without density, a body that has an inertia already.
    pub fn inertia(mut self, inertia: Inertia) -> Result<Self, FemError> {
        self.whole_mesh("inertia").and_then(|_| self.before_damping("mass"))?;
        if [BodyInertia::NAME, BodyInertia::FILLED].iter().any(|name| self.model.contribution(name).is_some()) {
            return Err(FemError::Meaningless { what: "the body has an inertia already: give one".to_owned() });
        }
        let contribution: BodyInertia = inertia.on(self.body(), self.model.tangent_structure())?;
        self.model.add(Arc::new(contribution))?;
        Ok(self)
    }

    /// Rayleigh damping `(a0 M + a1 K(0)) v`, M the mass and K(0) the tangent at rest without controls, of laws with the numbers
    /// that they are written with, whatever controls make of these; a0 in 1/s, a1 in s.
    ///
    /// It is not objective: K(0) v does not vanish for a finite rotation, and a0 damps every rigid motion. A mode of small
    /// vibrations with angular frequency w has the damping ratio `(a0/w + a1 w)/2`.
    ///
    /// # Errors
    /// A coefficient that is negative or not finite; cells without material, or no mass for a0, yet.
    pub fn rayleigh_damping(mut self, a0: f64, a1: f64) -> Result<Self, FemError> {
        let contribution =
            self.whole_mesh("Rayleigh damping").and_then(|_| self.model.energies().rayleigh_damping(a0, a1))?;
        self.model.add(Arc::new(contribution))?;
        Ok(self)
    }

    /// Refuses what Rayleigh damping that is there already would not know of.
    fn before_damping(&self, what: &str) -> Result<(), FemError> {
        if self.model.contribution(RayleighDamping::NAME).is_none() {
            return Ok(());
        }
        let what = format!("{what} after the Rayleigh damping, which would not know of it; add the damping last");
        Err(FemError::Meaningless { what })
    }

    /// Adds a contribution of your own to the residual.
    ///
    /// # Errors
    /// A name that is taken, couplings that do not fit the mesh.
    pub fn contribution(mut self, contribution: impl Contribution + 'static) -> Result<Self, FemError> {
        self.model.add(Arc::new(contribution))?;
        Ok(self)
    }

    /// The same of one that a part of the body may refuse.
    fn contribution_of_all(self, contribution: impl Contribution + 'static) -> Result<Self, FemError> {
        let space = self.model.unknowns().clone();
        let added = self.contribution(contribution);
        nastic_body::discretization::parted::all_accept(space.share().map(AsRef::as_ref), added)
    }
}
