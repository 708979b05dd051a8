//! How nearly incompressible a body is.

use crate::contributions::body_energy::BodyEnergy;
use nastic_energy::{EnergyTerm, PointBatch, Response, Slots, Want};
use nastic_tensor::{Kinematics, Mat3, Tangent};

impl BodyEnergy {
    /// The largest ratio of bulk to shear modulus of its cells at rest, of their passive laws; of the first point of a cell. With
    /// `A = dP/dF` at `F = 1` and the shears `e_ij = e_i (x) e_j + e_j (x) e_i`
    ///
    /// ```text
    /// kappa = 1 : A : 1 / 9,   mu = sum over i < j of e_ij : A : e_ij / 12
    /// ```
    ///
    /// 0 of cells without a shear modulus.
    pub(crate) fn bulk_over_shear(&self) -> f64 {
        let parts = self.disc.points().parts.iter();
        let cells = parts.flat_map(|part| (0..part.cells.len()).map(|c| (part.cells[c] as usize, part.first_point(c))));
        cells.map(|(cell, first)| self.ratio_of(cell, first)).fold(0.0, f64::max)
    }

    /// That of a cell.
    pub(super) fn ratio_of(&self, cell: usize, first: usize) -> f64 {
        let at = PointBatch { kinematics: &[Kinematics::rest()], cell, first };
        let (mut stress, mut tangent) = ([Mat3::zeros()], [Tangent::zero()]);
        let mut response = Response { energy: &mut [], stress: &mut stress, tangent: &mut tangent };
        for &t in &self.composition_of(cell).terms {
            self.terms[t].respond(&at, Slots::none(), Want::TANGENT, &mut response);
        }
        let twice = |strain: &Mat3| strain.dot(&tangent[0].apply(strain));
        let bulk = twice(&Mat3::identity()) / 9.0;
        let shear = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
            let mut strain = Mat3::zeros();
            strain[(i, j)] = 1.0;
            strain[(j, i)] = 1.0;
            twice(&strain)
        });
        let ratio = 12.0 * bulk / shear.iter().sum::<f64>();
        if ratio.is_finite() { ratio } else { 0.0 }
    }
}
