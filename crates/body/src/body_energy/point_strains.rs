//! [`PointStrains`]: strains and stresses of their own at the quadrature points, as iteration variables.
//!
//! Newton's method on displacements alone takes the strain of a trial at its word: a step that turns a thin body stretches it
//! by `|grad du|^2 / 2`, a step of a nearly incompressible one changes its volume as much, and the tangent there is that
//! of stresses many times those of the answer. With the right Cauchy-Green tensor C and the second Piola-Kirchhoff stress
//! S of every point as unknowns beside u, the equations
//!
//! ```text
//! C = F(u)^T F(u),   S = S(C),   int F(u) S : grad v dX = forces(v)
//! ```
//!
//! are linearised each by itself. With `D = F(u)^T F(u) - C` what is left of the first,
//!
//! ```text
//! S* = S(C) + CC : D,   CC = dS/dC                             residual  int F S* : grad v dX - forces(v)
//! A[G] = G S + F (CC : (G^T F + F^T G))                         tangent
//! C_new = C + D + G^T F + F^T G,   S_new = S* + CC : (G^T F + F^T G)     with G = grad du
//! ```
//!
//! so that the stress in the tangent is the extrapolated one. At the end C and S are those of u, and so is the tangent.
//!
//! With a [formulation](crate::body_energy::formulation::kind::Formulation) of its own F is the one that laws see, G its change along du, and the tangent has the
//! term `F S : F''(u)` more, with the extrapolated S.
//!
//! Passive laws are objective, so that `S` and `CC` follow from P and dP/dF at the stretch `U = sqrt(C)`. Actuations are taken at
//! F(u), as they are.
//!
//! Source: Magisano, Leonetti, Garcea, "How to improve efficiency and robustness of the Newton method in geometrically
//! non-linear structural problem discretized via displacement-based finite elements", CMAME 313 (2017), section 4 (mixed integration
//! points), there for linear S(C).

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::contribution::Sums;
use crate::error::{Inadmissible, InvertedAt};
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, PointBatch, Response, Want};
use nastic_linear::SparseMatrix;
use nastic_tensor::{Inverted, Kinematics, Mat3, Tangent};

/// C and S of every quadrature point.
#[derive(Debug, Clone)]
pub struct PointStrains {
    c: Vec<Mat3>,
    s: Vec<Mat3>,
}

/// The least share of det C that a step may leave of it.
const COLLAPSE: f64 = 0.25;

impl PointStrains {
    /// Those of a displacement.
    pub fn of(body: &BodyEnergy, u: &[f64], driving: Driving, parallel: bool) -> Result<Self, Inadmissible> {
        let points = body.discretization().points().len();
        let strains = PointStrains { c: vec![Mat3::identity(); points], s: vec![Mat3::zeros(); points] };
        Ok(strains.swept(body, u, driving, None, parallel)?.0)
    }

    /// `C_new` and `S_new` of the whole step du, and the largest `|grad du|` (Frobenius norm).
    pub fn extrapolated(
        &self,
        body: &BodyEnergy,
        u: &[f64],
        driving: Driving,
        du: &[f64],
        parallel: bool,
    ) -> Result<(Self, f64), Inadmissible> {
        self.swept(body, u, driving, Some(du), parallel)
    }

    fn swept(
        &self,
        body: &BodyEnergy,
        u: &[f64],
        driving: Driving,
        du: Option<&[f64]>,
        parallel: bool,
    ) -> Result<(Self, f64), Inadmissible> {
        let (mut next, mut largest) = (self.clone(), 0.0_f64);
        let work = Extrapolate { body, u, driving, du, from: self };
        body.sweep(
            parallel,
            |cells| 18 * cells.part.table.points,
            |cells, patch, scratch, new: &mut PatchStrains| work.compute(cells, patch, scratch, new),
            |cells, patch, strains| {
                cells.put(patch, &strains.c, &mut next.c);
                cells.put(patch, &strains.s, &mut next.s);
                largest = largest.max(strains.largest);
            },
        )?;
        Ok((next, largest))
    }

    /// A share of the way to others; `None` where a C would not be positive definite, or would collapse.
    pub fn towards(&self, next: &Self, share: f64) -> Option<Self> {
        let blend = |from: &[Mat3], to: &[Mat3]| -> Vec<Mat3> {
            from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect()
        };
        let c = blend(&self.c, &next.c);
        let sound = |(new, old): (&Mat3, &Mat3)| {
            let minor = new[(0, 0)] * new[(1, 1)] - new[(0, 1)] * new[(1, 0)];
            new[(0, 0)] > 0.0 && minor > 0.0 && new.determinant() > COLLAPSE * old.determinant()
        };
        c.iter().zip(&self.c).all(sound).then(|| PointStrains { c, s: blend(&self.s, &next.s) })
    }
}

impl BodyEnergy {
    /// Adds residual and tangent of the linearised equations.
    pub fn add_with_point_strains(
        &self,
        u: &[f64],
        driving: Driving,
        strains: &PointStrains,
        total: &mut Sums,
        tangent: &mut SparseMatrix,
        parallel: bool,
    ) -> Result<(), Inadmissible> {
        let work = Linearised { body: self, u, driving, strains };
        self.sweep(
            parallel,
            |cells| cells.row_length() + cells.kernel.matrix_len(),
            |cells, patch, scratch, answer: &mut RowsAndMatrix| work.compute(cells, patch, scratch, answer),
            |cells, patch, (rows, matrix)| {
                cells.scatter(patch, rows, &mut total.force);
                cells.scatter_matrix(patch, matrix, self.structure(), tangent);
            },
        )
    }

    /// S and CC of the materials at the points of a cell.
    fn second_stresses(
        &self,
        cell: usize,
        first: usize,
        driving: Driving,
        c: &[Mat3],
    ) -> Result<Vec<(Mat3, MaterialTangent)>, Inadmissible> {
        let stretch = |(point, c): (usize, &Mat3)| {
            let inverted =
                |found: Inverted| Inadmissible::Inverted(InvertedAt { cell, point, jacobian: found.jacobian });
            Kinematics::new(square_root(c)).map_err(inverted)
        };
        let stretches = c.iter().enumerate().map(stretch).collect::<Result<Vec<_>, _>>()?;
        let (mut stress, mut tangent) = (vec![Mat3::zeros(); c.len()], vec![Tangent::zero(); c.len()]);
        let at = PointBatch { kinematics: &stretches, cell, first };
        self.check_domain_of_materials(&at, driving)?;
        let mut response = Response { energy: &mut [], stress: &mut stress, tangent: &mut tangent };
        for (law, m) in self.materials(&at, driving) {
            law.respond(&at, m.get(), Want::TANGENT, &mut response);
        }
        Ok(stretches.iter().zip(&stress).zip(&tangent).map(|((u, p), a)| material(u, p, a)).collect())
    }
}

/// `dS/dC` as images of the six symmetric unit tensors.
type MaterialTangent = [Mat3; 6];

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

fn apply(cc: &MaterialTangent, d: &Mat3) -> Mat3 {
    PAIRS.iter().zip(cc).map(|(&(i, j), image)| image * d[(i, j)]).sum()
}

fn twice_symmetric(m: &Mat3) -> Mat3 {
    m + m.transpose()
}

/// The symmetric square root of a positive definite C.
fn square_root(c: &Mat3) -> Mat3 {
    let eigen = c.symmetric_eigen();
    let root = Mat3::from_diagonal(&eigen.eigenvalues.map(|e| e.max(0.0).sqrt()));
    eigen.eigenvectors * root * eigen.eigenvectors.transpose()
}

/// `S = U^-1 P`, and `CC : D = U^-1 (dP/dF : E - E S)` with `E = U^-1 D / 2`, for then `E^T U + U E = D`.
fn material(u: &Kinematics, p: &Mat3, a: &Tangent) -> (Mat3, MaterialTangent) {
    let inverse = u.h().transpose() / u.j();
    let s = inverse * p;
    let s = twice_symmetric(&s) / 2.0;
    let cc = PAIRS.map(|(i, j)| {
        let mut d = Mat3::zeros();
        d[(i, j)] = 1.0;
        d[(j, i)] = 1.0;
        let e = inverse * d / 2.0;
        let image = inverse * (a.apply(&e) - e * s);
        twice_symmetric(&image) / 2.0
    });
    (s, cc)
}

type RowsAndMatrix = (Vec<f64>, PatchMatrix);

struct Linearised<'a> {
    body: &'a BodyEnergy,
    u: &'a [f64],
    driving: Driving<'a>,
    strains: &'a PointStrains,
}

impl Linearised<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        (rows, matrix): &mut RowsAndMatrix,
    ) -> Result<(), Inadmissible> {
        self.body.kinematics(cells, patch, Displaced::by(self.u), Some(self.driving), scratch)?;
        scratch.clear(Want::TANGENT);
        // what bends with F where that is not affine in u: the extrapolated stress, as in the rest of the tangent
        let mut geometric = Vec::with_capacity(scratch.kinematics.len());
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let (stress, tangent) = (&mut scratch.stress[range.clone()], &mut scratch.tangent[range.clone()]);
            let mut out = Response { energy: &mut [], stress, tangent };
            for (law, m) in self.body.laws(&at, self.driving).filter(|(law, _)| !law.is_material()) {
                law.respond(&at, m.get(), Want::TANGENT, &mut out);
            }
            let own = at.first..at.first + at.len();
            let passive = self.body.second_stresses(at.cell, at.first, self.driving, &self.strains.c[own])?;
            for (q, (point, (s, cc))) in range.zip(passive.iter().enumerate()).map(|(q, (k, p))| (q, (at.first + k, p)))
            {
                let (f, weight) = (scratch.kinematics[q].f(), scratch.weights[q]);
                let (stress, tangent) = (&mut scratch.stress[q], &mut scratch.tangent[q]);
                geometric.push((*stress + f * self.strains.s[point]) * weight);
                let left = f.transpose() * f - self.strains.c[point];
                *stress += f * (s + apply(cc, &left));
                tangent.add_metric(&self.strains.s[point]);
                tangent.add(&Tangent::from_map(|g| f * apply(cc, &twice_symmetric(&(g.transpose() * f)))));
                *stress *= weight;
                tangent.0.iter_mut().for_each(|c| *c *= weight);
            }
        }
        cells.clear_rows(patch, rows);
        let formulation = self.body.arithmetic_of(cells.first(patch));
        formulation.add_force(cells, scratch, &scratch.stress, rows);
        scratch.stress.clone_from(&geometric);
        formulation.tangent(cells, patch, scratch, matrix);
        Ok(())
    }
}

/// New C and S by patch: of u itself, or extrapolated along du.
struct Extrapolate<'a> {
    body: &'a BodyEnergy,
    u: &'a [f64],
    driving: Driving<'a>,
    du: Option<&'a [f64]>,
    from: &'a PointStrains,
}

#[derive(Clone, Default)]
struct PatchStrains {
    c: Vec<Mat3>,
    s: Vec<Mat3>,
    largest: f64,
}

impl Extrapolate<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        new: &mut PatchStrains,
    ) -> Result<(), Inadmissible> {
        self.body.kinematics(cells, patch, Displaced::by(self.u), Some(self.driving), scratch)?;
        new.c.clear();
        new.c.extend(scratch.kinematics.iter().map(|k| k.f().transpose() * k.f()));
        new.s.clear();
        new.largest = 0.0;
        if let Some(du) = self.du {
            self.body.arithmetic_of(cells.first(patch)).change(cells, patch, du, scratch);
        }
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            if self.du.is_none() {
                let passive = self.body.second_stresses(at.cell, at.first, self.driving, &new.c[range])?;
                new.s.extend(passive.iter().map(|(s, _)| s));
                continue;
            }
            let before = &self.from.c[at.first..][..at.len()];
            let passive = self.body.second_stresses(at.cell, at.first, self.driving, before)?;
            for (q, ((s, cc), before)) in range.zip(passive.iter().zip(before)) {
                let (f, g) = (scratch.kinematics[q].f(), &scratch.change[q]);
                new.c[q] += twice_symmetric(&(g.transpose() * f));
                new.s.push(s + apply(cc, &(new.c[q] - before)));
                new.largest = new.largest.max(g.norm());
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::PointStrains;
    use crate::body_energy::BodyEnergy;
    use crate::body_energy::driving::Driving;
    use crate::body_energy::formulation::Formulation;
    use crate::contribution::Sums;
    use crate::discretization::Discretization;
    use nastic_energy::{EnergyTerm, MooneyRivlin, NeoHooke, NeoHookeIsochoric};
    use nastic_mesh::{CellKind, box_mesh};
    use nastic_numeric::Random;
    use std::sync::Arc;

    /// Where C and S are those of u, residual and tangent are those of the formulation without them.
    #[test]
    fn agree_with_the_formulation_at_their_own_displacement() -> Result<(), Box<dyn std::error::Error>> {
        let laws: [Arc<dyn EnergyTerm>; 3] = [
            Arc::new(MooneyRivlin::new(1.0, 0.5, 2.0)?),
            Arc::new(NeoHooke::new(1.0, 3.0)?),
            Arc::new(NeoHookeIsochoric::new(1.0, 5.0)?),
        ];
        let members = [
            (CellKind::Hex8, Formulation::Standard),
            (CellKind::Hex8, Formulation::MeanDilatation),
            (CellKind::Tet4, Formulation::MeanDilatation),
            (CellKind::Hex27, Formulation::LinearDilatation),
        ];
        for (law, (kind, formulation)) in laws.iter().flat_map(|law| members.map(|member| (law, member))) {
            let mut body = BodyEnergy::new(Discretization::new(Arc::new(box_mesh([1.0; 3], [2, 1, 1], kind)?))?);
            let cells: Vec<u32> = (0..body.discretization().mesh().cells() as u32).collect();
            body.add_term(&cells, law.clone())?;
            body.set_formulation(&cells, formulation)?;
            let mut random = Random::new(3);
            let u: Vec<f64> = (0..body.discretization().dofs()).map(|_| 0.06 * random.symmetric()).collect();
            let (controls, mut expected, mut tangent) =
                (body.controls(), body.structure().matrix(), body.structure().matrix());
            let sums = body.evaluate_tangent(&u, &controls, &mut expected, false)?;
            let strains = PointStrains::of(&body, &u, Driving::relaxed(&controls), false)?;
            let mut own = Sums::zero(u.len());
            body.add_with_point_strains(&u, Driving::relaxed(&controls), &strains, &mut own, &mut tangent, false)?;
            let apart = |a: &[f64], b: &[f64]| {
                let largest = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
                a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / largest
            };
            assert!(apart(&own.force, &sums.force) < 1e-12, "{kind}, {formulation}");
            assert!(apart(&tangent.values, &expected.values) < 1e-12, "{kind}, {formulation}");
        }
        Ok(())
    }
}
