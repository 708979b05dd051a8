//! Tangents of a [`Model`] by products, without a matrix.

use super::Model;
use crate::model::views::Tangents;
use nastic_body::body_energy::hexahedra_products::HexahedraProducts;
use nastic_body::contribution::point::Need;
use nastic_body::controls::Controls;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_body::kernels::displaced::Displaced;
use nastic_linear::solver::MultigridSolver;
use nastic_linear::{CellProducts, Multigrid, VolumeModes};
use std::sync::Arc;

impl Model {
    /// The changes of volume that its body resists much at a displacement, as a part of the tangent; nothing where no cell's stand out, or where unknowns are not
    /// displacements of nodes by themselves, all on one rank.
    pub(crate) fn volume_modes(
        &self,
        u: &[f64],
        controls: &Controls,
        expected: Option<&[f64]>,
        parallel: bool,
    ) -> Option<VolumeModes> {
        let plain = self.unknowns().has_one_nodal_field() && self.unknowns().multipliers() == 0;
        if !plain || !self.supports.ties().is_empty() || self.ranks().is_over_ranks() {
            return None;
        }
        self.body.volume_modes(Displaced::by(u), controls, self.supports.fixed(), expected, parallel).ok().flatten()
    }
}

impl Tangents<'_> {
    /// Whether tangents of its equilibria are had by the products of their cells, see [`cell_products`](Self::cell_products).
    pub fn has_cell_products(&self) -> bool {
        let plain = self.model.unknowns().has_one_nodal_field() && self.model.unknowns().multipliers() == 0;
        let alone =
            plain && !self.model.others.iter().any(|own| own.is_stiff()) && self.model.supports.ties().is_empty();
        alone && !self.model.ranks().is_over_ranks() && self.model.body.has_cell_products()
    }

    /// Bytes of the tangent of an equilibrium and of its levels of multigrid, predicted from counts.
    pub fn multigrid_bytes(&self) -> usize {
        if self.has_cell_products() {
            let (nodes, cells) =
                (self.model.discretization().mesh().points().len(), self.model.discretization().mesh().cells());
            return HexahedraProducts::bytes_of(cells) + Multigrid::predicted_bytes_below_products(nodes, cells);
        }
        self.assembled_multigrid_bytes()
    }

    /// The same of a tangent that is assembled, as those of steps in time are. The pressures of nearly incompressible cells that become unknowns are counted at rest.
    pub fn assembled_multigrid_bytes(&self) -> usize {
        let structure = self.model.tangent_structure();
        let (rest, controls) = (vec![0.0; self.model.unknowns().nodal()], self.model.body.controls());
        let modes = self.model.volume_modes(&rest, &controls, None, true);
        let beside =
            modes.map_or(0, |modes| modes.bytes() + MultigridSolver::bytes_of_modes(structure.pattern(), modes.len()));
        structure.multigrid_bytes() + beside
    }

    /// The tangent of an equilibrium by the products of its cells, from moduli in single precision: of a body of 27-node hexahedra
    /// of the standard formulation beside whose energy no contribution [is stiff](nastic_body::contribution::Contribution::is_stiff); `None` of others, and in time steps.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn cell_products(&self, at: &Instant) -> Result<Option<Arc<dyn CellProducts>>, Inadmissible> {
        self.model.at(at, Need::Residual)?.cell_products(at)
    }

    /// `out = K v` without a matrix; false where a contribution needs one.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        self.model.at(at, Need::Residual)?.tangent_product(at, v, out)
    }
}
