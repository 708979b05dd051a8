//! [`BodyEnergy`]: the energy of a body, `int W(F) dX` summed over laws and actuations.

use crate::contribution::point::{ContributionPoint, Need};
use crate::contribution::{Contribution, Sums};
use crate::controls::Controls;
use crate::discretization::Discretization;
use crate::error::{FemError, Inadmissible, InvertedAt};
use crate::history::History;
use crate::instant::Instant;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::CellWork;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::{Patch, Patches};
use crate::structure::TangentStructure;
use assembly::Terms;
use cell_law::{CellLaw, LawSlots};
use driving::Driving;
use evaluated::EvaluatedBody;
pub use laws::AttachedLaw;
use laws::Composition;
use nastic_energy::{EnergyTerm, Outside, PointBatch, Slots};
use nastic_linear::SparseMatrix;
use nastic_tensor::Kinematics;
use std::sync::Arc;

pub(crate) mod assembly;
mod bulk_over_shear;
pub mod cell_law;
mod control_vjp;
pub mod dilatations;
pub mod driving;
pub mod evaluated;
pub mod excess_tension;
pub mod formulation;
pub mod free_shape;
pub mod hexahedra_products;
pub(crate) mod history;
mod laws;
pub mod max_step;
mod moduli;
pub mod point_peaks;
pub mod point_strains;
pub(crate) mod pressure_change;
mod product;
mod second_vjp;
pub mod shape;
mod shape_volume;
pub(crate) mod tensions;
pub mod volume_modes;

/// The energy of a body: laws without and with slots, each over some of the cells.
///
/// The total is the plain sum of what the laws give at every quadrature point; nothing here knows any law.
#[derive(Debug, Clone)]
pub struct BodyEnergy {
    disc: Arc<Discretization>,
    structure: Arc<TangentStructure>,
    /// Laws without slots.
    terms: Vec<Arc<dyn EnergyTerm>>,
    /// Laws with slots, in the order of the first blocks of [`Controls`].
    actuations: Vec<AttachedLaw>,
    /// The distinct sets of terms, and which one each cell has.
    compositions: Vec<Composition>,
    /// By composition the laws as its cells evaluate them, those without slots of their own first.
    laws: Vec<Vec<CellLaw>>,
    /// Index of the set of terms of each cell.
    of_cell: Vec<u32>,
    /// By group of cells, those that their formulation takes together.
    patches: Arc<Vec<Patches>>,
}

impl BodyEnergy {
    /// Without terms.
    pub fn new(disc: Arc<Discretization>) -> Self {
        let of_cell = vec![0; disc.mesh().cells()];
        let patches = Arc::new(disc.points().parts.iter().map(Patches::of_single_cells).collect());
        let (compositions, laws) = (vec![Composition::default()], vec![vec![]]);
        let structure = disc.of_cells().clone();
        BodyEnergy { disc, structure, terms: vec![], actuations: vec![], compositions, laws, of_cell, patches }
    }

    /// Changes to a structure of tangents in which more nodes are coupled.
    ///
    /// # Errors
    /// [`FemError::Structure`] where it does not couple what the formulations of the cells couple.
    pub fn set_structure(&mut self, structure: Arc<TangentStructure>) -> Result<(), FemError> {
        let patch = |cell: u32| self.is_in_patch(cell).then(|| self.disc.patches()[cell as usize]);
        let of_group = |group| Patches::new(group, patch, &structure);
        let patches = self.disc.points().parts.iter().map(of_group).collect::<Result<_, _>>()?;
        self.patches = Arc::new(patches);
        self.structure = structure;
        Ok(())
    }

    /// The structure of tangents that it is added to.
    pub fn structure(&self) -> &Arc<TangentStructure> {
        &self.structure
    }

    /// The cells by kind, with the patches that their formulations take together.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (Cells<'_>, &Patches)> {
        self.patches.iter().enumerate().filter_map(|(p, patches)| Some((Cells::of(&self.disc, p)?, patches)))
    }

    /// Computes something of every patch, in parallel, and takes the answers up in mesh order; `numbers` are those that an answer has of one cell.
    pub(crate) fn sweep<'b, A, E>(
        &'b self,
        parallel: bool,
        numbers: impl Fn(&Cells<'b>) -> usize,
        compute: impl Fn(Cells<'b>, Patch, &mut Scratch, &mut A) -> Result<(), E> + Sync,
        mut take: impl FnMut(Cells<'b>, Patch, &A) + Send,
    ) -> Result<(), E>
    where
        A: Clone + Default + Send + Sync,
        E: Clone + Send + Sync,
    {
        for (cells, patches) in self.groups() {
            let compute = |patch: Patch, scratch: &mut Scratch, answer: &mut A| compute(cells, patch, scratch, answer);
            let work = CellWork { cells, patches, numbers: numbers(&cells), compute };
            work.run(parallel, |patch, answer| take(cells, patch, answer))?;
        }
        Ok(())
    }

    /// The discretisation.
    pub fn discretization(&self) -> &Arc<Discretization> {
        &self.disc
    }

    /// The laws with slots in the order of [`Controls`].
    pub fn actuations(&self) -> &[AttachedLaw] {
        &self.actuations
    }

    /// Controls of this body at rest: loads zero, designs as their laws say.
    pub fn controls(&self) -> Controls {
        let points = |attached: &AttachedLaw| if attached.is_global() { 1 } else { self.disc.points().len() };
        let mut controls = Controls::zeros(self.actuations.iter().map(|a| (a.controlled_slots().len(), points(a))));
        for (k, attached) in self.actuations.iter().enumerate() {
            let slots = attached.law.slots();
            for (slot, _) in slots.iter().enumerate().filter(|(_, slot)| slot.is_design()) {
                let values = controls.values_mut(k);
                match attached.is_global() {
                    true => values[slot] = self.places(k).next().map_or(0.0, |at| attached.law.rest(at, slot)),
                    false => self
                        .places(k)
                        .for_each(|at| values[at.point * slots.len() + slot] = attached.law.rest(at, slot)),
                }
            }
        }
        controls
    }

    /// The reference volume of some cells (area in the plane).
    pub fn volume_of(&self, cells: &[u32]) -> f64 {
        let (points, weights) = (self.disc.points_of_cells(), self.disc.points().weights());
        let of_cell = |&cell: &u32| {
            let (first, count) = points[cell as usize];
            weights[first..first + count].iter().sum::<f64>()
        };
        cells.iter().map(of_cell).sum()
    }

    /// Every cell needs a passive material.
    pub fn check_complete(&self) -> Result<(), FemError> {
        let bare = |&cell: &usize| self.materials_of(cell).next().is_none();
        let Some(first) = (0..self.of_cell.len()).find(bare) else { return Ok(()) };
        let mesh = self.disc.mesh();
        let regions = mesh.regions().keys().cloned().collect::<Vec<_>>().join(", ");
        let count = (0..self.of_cell.len()).filter(bare).count();
        Err(FemError::NoMaterial { mesh: mesh.name().to_owned(), count, first, regions })
    }

    /// Shape gradients and kinematics of a displaced patch, into the scratch: none that is inverted or beyond the
    /// domain of a law, where nothing drives it as it is at rest.
    fn kinematics(
        &self,
        cells: Cells,
        patch: Patch,
        to: Displaced,
        driving: Option<Driving>,
        scratch: &mut Scratch,
    ) -> Result<(), Inadmissible> {
        self.arithmetic_of(cells.first(patch)).kinematics(&self.disc, cells, patch, to, scratch)?;
        cells.batches(patch, &scratch.kinematics).try_for_each(|(_, at)| self.check_domain(&at, driving))
    }

    /// Refuses what is beyond the domain of a law of the cell, passive or an actuation; where nothing drives it as it is at rest.
    ///
    /// # Errors
    /// [`Inadmissible::OutsideDomain`].
    pub fn check_domain(&self, at: &PointBatch, driving: Option<Driving>) -> Result<(), Inadmissible> {
        self.laws_of(at.cell).iter().try_for_each(|own| self.check_domain_of(own, at, driving))
    }

    fn check_domain_of(&self, own: &CellLaw, at: &PointBatch, driving: Option<Driving>) -> Result<(), Inadmissible> {
        // what a body that grows sees is not known without its growth
        if driving.is_none() && own.blocks.last().is_some_and(|&k| self.is_growth(k)) {
            return Ok(());
        }
        let m = driving.map_or(LawSlots::OfBlock(Slots::none()), |driving| driving.of_law(own, at));
        own.law.check_domain(at, m.get()).map_err(|outside| beyond(at, outside))
    }

    /// Refuses what is beyond the domain of a passive law of the cell.
    fn check_domain_of_materials(&self, at: &PointBatch, driving: Driving) -> Result<(), Inadmissible> {
        let mut materials = self.laws_of(at.cell).iter().filter(|own| own.law.is_material());
        materials.try_for_each(|own| self.check_domain_of(own, at, Some(driving)))
    }

    /// Energy alone, or energy and internal force, with relaxed viscous laws (`Model::evaluate` knows those of a state).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn evaluate(&self, u: &[f64], controls: &Controls, force: bool, parallel: bool) -> Result<Sums, Inadmissible> {
        let mut sums = Sums::zero(if force { self.disc.dofs() } else { 0 });
        let terms = Terms { energy: true, force, tangent: false };
        assembly::add(self, Displaced::by(u), Driving::relaxed(controls), terms, (&mut sums, None, None), parallel)?;
        Ok(sums)
    }

    /// Energy, internal force, and the tangent added to `tangent` (supports not yet eliminated).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn evaluate_tangent(
        &self,
        u: &[f64],
        controls: &Controls,
        tangent: &mut SparseMatrix,
        parallel: bool,
    ) -> Result<Sums, Inadmissible> {
        let mut sums = Sums::zero(self.disc.dofs());
        let terms = Terms { energy: true, force: true, tangent: true };
        assembly::add(
            self,
            Displaced::by(u),
            Driving::relaxed(controls),
            terms,
            (&mut sums, Some(tangent), None),
            parallel,
        )?;
        Ok(sums)
    }

    /// The tangent alone, added to `tangent`: the bits of [`evaluate_tangent`](Self::evaluate_tangent) for less.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn add_tangent(
        &self,
        u: &[f64],
        controls: &Controls,
        tangent: &mut SparseMatrix,
        parallel: bool,
    ) -> Result<(), Inadmissible> {
        let terms = Terms { energy: false, force: false, tangent: true };
        assembly::add(
            self,
            Displaced::by(u),
            Driving::relaxed(controls),
            terms,
            (&mut Sums::zero(0), Some(tangent), None),
            parallel,
        )
    }

    /// The longest step `s <= 1` from u along du on which no point loses more than nine tenths of its volume.
    ///
    /// # Errors
    /// [`Inadmissible`] where J <= 0 at u itself.
    pub fn max_step(&self, u: &[f64], du: &[f64], parallel: bool) -> Result<f64, Inadmissible> {
        max_step::max_step(self, Displaced::by(u), du, parallel)
    }

    /// `out = K(u, m) v`, the product with the tangent of [`evaluate_tangent`](Self::evaluate_tangent) (supports not
    /// eliminated) for which no matrix is assembled: at every point the change of stress `dP/dF : grad v`, spread like a
    /// stress. `v` and `out` are flat, `dim` per node. The same bits for any number of threads.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn tangent_product(
        &self,
        u: &[f64],
        controls: &Controls,
        v: &[f64],
        out: &mut [f64],
        parallel: bool,
    ) -> Result<(), Inadmissible> {
        out.fill(0.0);
        let at = (Displaced::by(u), Driving::relaxed(controls));
        product::add(self, at, product::Along::Displacement(v), out, parallel)
    }

    /// Derivative of the body's virtual work with respect to the controls at the points: for every actuation,
    /// `int (dP/dm_k) : grad lambda dX` split by point, shape `[points][slots]`; weights included.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn control_vjp(
        &self,
        u: &[f64],
        controls: &Controls,
        lambda: &[f64],
        parallel: bool,
    ) -> Result<Controls, Inadmissible> {
        let mut out = self.controls().zeroed();
        let (at, mut none) = ((Displaced::by(u), Driving::relaxed(controls)), History::default());
        control_vjp::add(self, at, lambda, &mut out, &mut none, parallel)?;
        Ok(out)
    }
}

/// What a law says of a point of its cell. The number of the point is the law's own: it may be none of the cell's.
fn beyond(at: &PointBatch, outside: Outside) -> Inadmissible {
    let jacobian = at.kinematics.get(outside.point).map_or(f64::NAN, Kinematics::j);
    let at = InvertedAt { cell: at.cell, point: outside.point, jacobian };
    Inadmissible::OutsideDomain { at, outside }
}

impl Contribution for BodyEnergy {
    fn name(&self) -> &str {
        "body energy"
    }

    fn at<'a>(&'a self, _: &Instant, need: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(EvaluatedBody::new(self, need)))
    }
}
