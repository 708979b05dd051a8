//! The changes of volume that nearly incompressible laws see, by quadrature points.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_tensor::{Kinematics, Mat3};

/// What is asked of the determinant that laws see: `J`, or its projection `Jbar`.
#[derive(Clone, Copy)]
pub enum Dilatation<'a> {
    /// Itself.
    Value,
    /// Its change along a displacement.
    Change(&'a [f64]),
    /// The second derivative of the passive energy by it, times the weight of the point, with designs and growth among the controls.
    Stiffness,
    /// The first derivative of the same energy over the second: the error of the volume that makes all of its pressure.
    PressureError,
}

impl BodyEnergy {
    /// That at every quadrature point of a displaced body; zero on cells whose changes of volume do not stand out.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn dilatations(
        &self,
        to: Displaced,
        controls: &Controls,
        what: Dilatation,
        parallel: bool,
    ) -> Result<Vec<f64>, Inadmissible> {
        let mut all = vec![0.0; self.disc.points().len()];
        let at = At { body: self, to, controls, what };
        self.sweep(
            parallel,
            |cells| cells.part.table.points,
            |cells, patch, scratch, found: &mut Vec<f64>| at.compute(cells, patch, scratch, found),
            |cells, patch, found| {
                if !found.is_empty() {
                    cells.put(patch, found, &mut all);
                }
            },
        )?;
        Ok(all)
    }
}

struct At<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    controls: &'a Controls,
    what: Dilatation<'a>,
}

impl At<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        found: &mut Vec<f64>,
    ) -> Result<(), Inadmissible> {
        found.clear();
        let (body, controls) = (self.body, self.controls);
        if body.stiff_share(cells, patch, controls).is_none() {
            return Ok(());
        }
        body.kinematics(cells, patch, self.to, Some(Driving::relaxed(controls)), scratch)?;
        match self.what {
            Dilatation::Value => found.extend(scratch.kinematics.iter().map(Kinematics::j)),
            Dilatation::Stiffness => {
                let derivatives = body.derivatives_by_volume(cells, patch, controls, scratch);
                found.extend(derivatives.iter().zip(&scratch.weights).map(|([_, second], w)| second * w));
            }
            Dilatation::PressureError => {
                let derivatives = body.derivatives_by_volume(cells, patch, controls, scratch);
                found
                    .extend(derivatives.iter().map(|[first, second]| if *second > 0.0 { first / second } else { 0.0 }));
            }
            Dilatation::Change(along) => {
                let formulation = body.arithmetic_of(cells.first(patch));
                scratch.change_by(cells, patch, along);
                let of_point = |(at, change): (&Kinematics, &Mat3)| at.h().dot(change);
                let own: Vec<f64> = formulation.own(scratch).iter().zip(&scratch.change).map(of_point).collect();
                *found = formulation.projected(scratch, &own).unwrap_or(own);
            }
        }
        Ok(())
    }
}
