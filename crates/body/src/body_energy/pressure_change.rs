//! What a change of the pressures makes of residual and tangent.

use crate::body_energy::BodyEnergy;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_linear::SparseMatrix;
use nastic_tensor::{Kinematics, Mat3, Tangent};

impl BodyEnergy {
    /// Adds first and second derivatives of `sum_q w_q p_q J_q` by the displacement. The pressures p are the projections of `weighted_q / w_q`, as those of
    /// energies of `Jbar` are; where nothing is projected these themselves.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn add_pressures(
        &self,
        to: Displaced,
        weighted: &[f64],
        force: &mut [f64],
        tangent: &mut SparseMatrix,
        parallel: bool,
    ) -> Result<(), Inadmissible> {
        let change = Change { body: self, to, weighted };
        self.sweep(
            parallel,
            |cells| cells.row_length() + cells.matrix_length(),
            |cells, patch, scratch, answer: &mut RowsAndMatrix| change.compute(cells, patch, scratch, answer),
            |cells, patch, (rows, matrix)| {
                if !rows.is_empty() {
                    cells.scatter(patch, rows, force);
                    cells.scatter_matrix(patch, matrix, self.structure(), tangent);
                }
            },
        )
    }
}

/// No rows where no pressure changes.
type RowsAndMatrix = (Vec<f64>, PatchMatrix);

struct Change<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    weighted: &'a [f64],
}

impl Change<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        (rows, matrix): &mut RowsAndMatrix,
    ) -> Result<(), Inadmissible> {
        rows.clear();
        let body = self.body;
        let mut pressures = cells.taken(patch, self.weighted);
        if pressures.iter().all(|p| *p == 0.0) {
            return Ok(());
        }
        body.kinematics(cells, patch, self.to, None, scratch)?;
        pressures.iter_mut().zip(&scratch.weights).for_each(|(p, w)| *p /= w);
        let formulation = body.arithmetic_of(cells.first(patch));
        let mut pressures = formulation.projected(scratch, &pressures).unwrap_or(pressures);
        pressures.iter_mut().zip(&scratch.weights).for_each(|(p, w)| *p *= w);
        let own = || formulation.own(scratch).iter().zip(&pressures);
        let stress: Vec<Mat3> = own().map(|(at, p)| at.h() * *p).collect();
        let second = |(at, p): (&Kinematics, &f64)| {
            let mut tangent = Tangent::zero();
            tangent.add_cross(at.f(), *p);
            tangent
        };
        let tangents: Vec<Tangent> = own().map(second).collect();
        cells.clear_rows(patch, rows);
        cells.force(&scratch.g, &stress, rows);
        cells.tangent(patch, &scratch.g, &tangents, matrix, &mut scratch.work);
        Ok(())
    }
}
