//! [`PointPeak`]s of actuations.

use super::BodyEnergy;
use super::driving::Driving;
pub use crate::contribution::point_peak::PointPeak;
use crate::controls::Controls;
use crate::error::Inadmissible;
use nastic_energy::{MaterialPoint, PointBatch};

impl BodyEnergy {
    /// The peaks of all actuations that have such a quantity, in their order.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn point_peaks(&self, u: &[f64], controls: &Controls) -> Result<Vec<PointPeak>, Inadmissible> {
        let measured = |k: &usize| self.actuations[*k].law.point_quantity().is_some();
        (0..self.actuations.len())
            .filter(measured)
            .map(|k| self.point_peak(k, u, controls))
            .flat_map(Result::transpose)
            .collect()
    }

    /// The point quantity of one actuation at all points of the body, zero where it does not act; `None` without one.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn point_values(&self, k: usize, u: &[f64], controls: &Controls) -> Result<Option<Vec<f64>>, Inadmissible> {
        let attached = &self.actuations[k];
        if attached.law.point_quantity().is_none() {
            return Ok(None);
        }
        let kinematics = self.kinematics_of_laws(u)?;
        let ranges = self.discretization().points_of_cells();
        let mut out = vec![0.0; kinematics.len()];
        for &cell in &attached.cells {
            let (first, count) = ranges[cell as usize];
            let range = first..first + count;
            let at = PointBatch { kinematics: &kinematics[range.clone()], cell: cell as usize, first };
            let Some(own) = self.law_of(cell as usize, k) else { continue };
            own.law.point_values(&at, Driving::relaxed(controls).of_law(own, &at).get(), &mut out[range]);
        }
        Ok(Some(out))
    }

    fn point_peak(&self, k: usize, u: &[f64], controls: &Controls) -> Result<Option<PointPeak>, Inadmissible> {
        let attached = &self.actuations[k];
        let (Some(quantity), Some(values)) = (attached.law.point_quantity(), self.point_values(k, u, controls)?) else {
            return Ok(None);
        };
        let ranges = self.discretization().points_of_cells();
        let (mut value, mut at) = (0.0, attached.cells.first().copied().unwrap_or_default());
        let (mut share, mut beyond): (Option<(f64, f64)>, usize) = (None, 0);
        for &cell in &attached.cells {
            let (first, count) = ranges[cell as usize];
            let mut exceeded = false;
            for point in first..first + count {
                if values[point] > value {
                    (value, at) = (values[point], cell);
                }
                let Some(limit) = attached.law.point_limit(MaterialPoint { cell: cell as usize, point }) else {
                    continue;
                };
                let reached = values[point] / limit;
                exceeded |= reached > 1.0;
                if share.is_none_or(|(most, _)| reached > most) {
                    share = Some((reached, limit));
                }
            }
            beyond += usize::from(exceeded);
        }
        Ok(Some(PointPeak { actuation: attached.name.clone(), quantity, value, cell: at, share, beyond }))
    }
}
