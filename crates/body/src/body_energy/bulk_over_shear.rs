//! Moduli of a body at rest: how nearly incompressible it is, and the forces that they make.

use crate::body_energy::BodyEnergy;
use crate::controls::Controls;
use nastic_energy::{EnergyTerm, PointBatch, Response, Want};
use nastic_tensor::{Kinematics, Mat3, Tangent};

impl BodyEnergy {
    /// The largest ratio of bulk to shear modulus of its cells at rest, of their passive laws with the designs among the controls, without growth; of the first point of a cell. With
    /// `A = dP/dF` at `F = 1` and the shears `e_ij = e_i (x) e_j + e_j (x) e_i`
    ///
    /// ```text
    /// kappa = 1 : A : 1 / 9,   mu = sum over i < j of e_ij : A : e_ij / 12
    /// ```
    ///
    /// 0 of cells without a shear modulus.
    pub fn bulk_over_shear(&self, controls: &Controls) -> f64 {
        let parts = self.disc.points().parts.iter();
        let cells = parts.flat_map(|part| (0..part.cells.len()).map(|c| (part.cells[c] as usize, part.first_point(c))));
        cells.map(|(cell, first)| self.ratio_of(cell, first, controls)).fold(0.0, f64::max)
    }

    /// That of a cell.
    pub(super) fn ratio_of(&self, cell: usize, first: usize, controls: &Controls) -> f64 {
        let [bulk, shear] = self.moduli_of(cell, first, controls);
        let ratio = bulk / shear;
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// kappa and mu of the passive laws of a cell.
    fn moduli_of(&self, cell: usize, first: usize, controls: &Controls) -> [f64; 2] {
        let at = PointBatch { kinematics: &[Kinematics::rest()], cell, first };
        let (mut stress, mut tangent) = ([Mat3::zeros()], [Tangent::zero()]);
        let mut response = Response { energy: &mut [], stress: &mut stress, tangent: &mut tangent };
        for (law, own) in self.ungrown_materials(&at, controls) {
            law.respond(&at, own, Want::TANGENT, &mut response);
        }
        let twice = |strain: &Mat3| strain.dot(&tangent[0].apply(strain));
        let shears = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
            let mut strain = Mat3::zeros();
            strain[(i, j)] = 1.0;
            strain[(j, i)] = 1.0;
            twice(&strain)
        });
        [twice(&Mat3::identity()) / 9.0, shears.iter().sum::<f64>() / 12.0]
    }

    /// The square of the norm of the forces that moduli make, over the cells: `(kappa + 4 mu / 3) V^((d - 1)/d)` of a cell of volume V in d dimensions, the
    /// force on a face under a strain of 1; of cells that may strain.
    pub fn squared_force_of_moduli(&self, rigid: &[u32], controls: &Controls) -> f64 {
        let (points, dim) = (self.disc.points(), self.disc.dim() as f64);
        let mut sum = 0.0;
        for part in &points.parts {
            for (c, cell) in part.cells.iter().enumerate().filter(|(_, cell)| rigid.binary_search(cell).is_err()) {
                let first = part.first_point(c);
                let volume: f64 = points.weights()[first..first + part.table.points].iter().sum();
                let [bulk, shear] = self.moduli_of(*cell as usize, first, controls);
                let force = (bulk + 4.0 / 3.0 * shear) * volume.powf((dim - 1.0) / dim);
                sum += if force.is_finite() { force * force } else { 0.0 };
            }
        }
        sum
    }
}
