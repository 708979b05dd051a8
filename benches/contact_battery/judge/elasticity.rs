//! Energy and nodal forces of cells, with Jbar at every point as J is, or as its mean over the cell.

use super::element::Element;
use super::law::{Law, cofactor};
use nastic::tensor::{Mat3, Vec3};

/// A cell in the reference body and its law.
pub struct Cell<'a> {
    pub element: &'a Element,
    pub places: Vec<Vec3>,
    pub law: Law,
    /// Laws see the mean of J over the cell.
    pub mean_dilatation: bool,
}

/// A point of a deformed cell.
struct Deformed {
    weight: f64,
    slopes: Vec<Vec3>,
    f: Mat3,
    h: Mat3,
    j: f64,
}

impl Cell<'_> {
    /// Gradients by the reference place, and `weight det(dX/dxi)`.
    fn mapped(&self, point: &super::element::Point) -> (f64, Vec<Vec3>) {
        let mut map: Mat3 = self.places.iter().zip(&point.slopes).map(|(x, slope)| x * slope.transpose()).sum();
        if self.element.dim == 2 {
            map[(2, 2)] = 1.0;
        }
        let (volume, across) = (map.determinant(), cofactor(&map));
        (point.weight * volume, point.slopes.iter().map(|slope| across * slope / volume).collect())
    }

    fn deformed(&self, u: &[Vec3]) -> Vec<Deformed> {
        let at = |point: &super::element::Point| {
            let (weight, slopes) = self.mapped(point);
            let f = Mat3::identity() + u.iter().zip(&slopes).map(|(u, slope)| u * slope.transpose()).sum::<Mat3>();
            Deformed { weight, slopes, h: cofactor(&f), j: f.determinant(), f }
        };
        self.element.stiff.iter().map(at).collect()
    }

    /// Its energy and the forces on its nodes that balance its stresses.
    pub fn forces(&self, u: &[Vec3]) -> (f64, Vec<Vec3>) {
        let points = self.deformed(u);
        let mut forces = vec![Vec3::zeros(); u.len()];
        let mut energy = 0.0;
        if !self.mean_dilatation {
            for at in &points {
                energy += at.weight * self.law.energy(&at.f);
                let stress = self.law.stress(&at.f) * at.weight;
                forces.iter_mut().zip(&at.slopes).for_each(|(force, slope)| *force += stress * slope);
            }
            return (energy, forces);
        }
        let d = self.element.dim as f64;
        let volume: f64 = points.iter().map(|at| at.weight).sum();
        let mean = points.iter().map(|at| at.weight * at.j).sum::<f64>() / volume;
        let mut pressed = 0.0;
        for at in &points {
            let scale = (mean / at.j).powf(1.0 / d);
            let mut bar = at.f * scale;
            if self.element.dim == 2 {
                bar[(2, 2)] = 1.0;
            }
            energy += at.weight * self.law.energy(&bar);
            let stress = self.law.stress(&bar);
            let out_of_plane = if self.element.dim == 2 { stress[(2, 2)] } else { 0.0 };
            let t = (stress.dot(&bar) - out_of_plane) / d;
            pressed += at.weight * t / mean;
            let own = (stress * scale - at.h * (t / at.j)) * at.weight;
            forces.iter_mut().zip(&at.slopes).for_each(|(force, slope)| *force += own * slope);
        }
        for at in &points {
            let own = at.h * (pressed * at.weight / volume);
            forces.iter_mut().zip(&at.slopes).for_each(|(force, slope)| *force += own * slope);
        }
        (energy, forces)
    }

    /// `int N_a N_b dX`
    pub fn products(&self) -> Vec<Vec<f64>> {
        let n = self.places.len();
        let mut sums = vec![vec![0.0; n]; n];
        for point in &self.element.mass {
            let (weight, _) = self.mapped(point);
            for (a, row) in sums.iter_mut().enumerate() {
                row.iter_mut().zip(&point.shapes).for_each(|(sum, b)| *sum += weight * point.shapes[a] * b);
            }
        }
        sums
    }

    /// `int N_a dX` by the rule of stresses, as dead loads are.
    pub fn shares(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.places.len()];
        for point in &self.element.stiff {
            let (weight, _) = self.mapped(point);
            sums.iter_mut().zip(&point.shapes).for_each(|(sum, shape)| *sum += weight * shape);
        }
        sums
    }

    /// The tangent by central differences, of components i of node a by k of b in row `dim a + i`.
    pub fn tangent(&self, u: &[Vec3], size: f64) -> Vec<Vec<f64>> {
        let (dim, step) = (self.element.dim, 1e-6 * size);
        let moved = |column: usize, sign: f64| {
            let mut u = u.to_vec();
            u[column / dim][column % dim] += sign * step;
            self.forces(&u).1
        };
        let column = |c: usize| -> Vec<f64> {
            let (ahead, behind) = (moved(c, 1.0), moved(c, -1.0));
            let of = |row: usize| (ahead[row / dim][row % dim] - behind[row / dim][row % dim]) / (2.0 * step);
            (0..dim * u.len()).map(of).collect()
        };
        (0..dim * u.len()).map(column).collect()
    }
}
