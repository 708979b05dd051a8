//! Manufactured solutions at finite strain: every element converges with order p + 1 in L2 and p in H1.
//!
//! The body force is `-Div P`, that is `-C_iJkL u_k,JL`, from the exact second derivatives of a smooth displacement; one
//! side carries the exact traction, the others the exact displacement. The meshes are smoothly distorted.

#![allow(clippy::print_stdout)] // the orders found are worth reading

use crate::common;

use common::{Outcome, nodal, prescribe, unit, with_node_sets};
use nastic_energy::check::{Evaluation, evaluate};
use nastic_energy::{MaterialPoint, MooneyRivlin};
use nastic_fem::{QuadraturePoints, Solid, SolveOptions, SolveReport, State};
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::{Kinematics, Mat3, Vec3};
use std::f64::consts::{LN_2, PI};

/// `u_i = A_i sin(k_i . X + c_i)`: displacement gradients up to 0.3.
struct Wave {
    amplitude: Vec3,
    /// Row i is `k_i`.
    k: Mat3,
    phase: Vec3,
}

impl Wave {
    fn new(dim: usize) -> Self {
        let k = Mat3::new(2.0, 1.2, -0.8, -1.0, 1.9, 1.1, 0.9, -1.3, 1.7);
        let plane = Mat3::new(2.0, 1.2, 0.0, -1.0, 1.9, 0.0, 0.0, 0.0, 0.0);
        match dim {
            2 => Wave { amplitude: Vec3::new(0.12, 0.1, 0.0), k: plane, phase: Vec3::new(0.3, 0.7, 0.0) },
            _ => Wave { amplitude: Vec3::new(0.1, 0.09, 0.08), k, phase: Vec3::new(0.3, 0.7, -0.4) },
        }
    }

    fn phases(&self, x: Vec3) -> Vec3 {
        self.k * x + self.phase
    }

    fn u(&self, x: Vec3) -> Vec3 {
        self.amplitude.component_mul(&self.phases(x).map(f64::sin))
    }

    fn gradient(&self, x: Vec3) -> Mat3 {
        Mat3::from_diagonal(&self.amplitude.component_mul(&self.phases(x).map(f64::cos))) * self.k
    }

    /// `u_k,JL`
    fn second(&self, x: Vec3, k: usize, j: usize, l: usize) -> f64 {
        -self.u(x)[k] * self.k[(k, j)] * self.k[(k, l)]
    }

    fn respond(&self, law: &MooneyRivlin, x: Vec3) -> Outcome<Evaluation> {
        let kinematics = Kinematics::new(Mat3::identity() + self.gradient(x))?;
        Ok(evaluate(law, MaterialPoint { cell: 0, point: 0 }, &kinematics, &[]))
    }

    /// `-Div P`
    fn body_force(&self, law: &MooneyRivlin, x: Vec3) -> Outcome<Vec3> {
        let c = self.respond(law, x)?.tangent;
        let mut b = Vec3::zeros();
        for (i, b) in b.iter_mut().enumerate() {
            for n in 0..27 {
                let (j, k, l) = (n / 9, n / 3 % 3, n % 3);
                *b -= c.get(i, j, k, l) * self.second(x, k, j, l);
            }
        }
        Ok(b)
    }
}

/// Inner lines bent by a fifth of the coarsest step; sides stay where they are.
fn bent(mesh: Mesh) -> Outcome<Mesh> {
    let dim = mesh.dim();
    Ok(mesh.mapped(|[x, y, z]| {
        let wave =
            (PI * (x + 0.2)).cos() * (PI * (y - 0.1)).cos() * if dim == 3 { (PI * (z + 0.3)).cos() } else { 1.0 };
        [x + 0.05 * (PI * x).sin() * wave, y - 0.05 * (PI * y).sin() * wave, z + 0.05 * (PI * z).sin() * wave]
    })?)
}

/// Quadrature that adds nothing to the errors measured.
fn fine(mesh: &Mesh) -> Outcome<QuadraturePoints> {
    Ok(QuadraturePoints::of_cells(mesh, 0..mesh.cells() as u32, |kind| kind.rule_of_degree(2 * kind.order() + 4))?)
}

/// Nodal forces of a density given at the points of a sampling.
fn spread(
    sampling: &QuadraturePoints,
    mesh: &Mesh,
    density: impl Fn(Vec3) -> Outcome<Vec3>,
    nodal: &mut [f64],
) -> Outcome {
    let dim = mesh.dim();
    let mut values = Vec::with_capacity(dim * sampling.len());
    for (x, w) in sampling.positions(mesh, None).into_iter().zip(sampling.weights()) {
        values.extend_from_slice(&(density(Vec3::from(x))? * *w).as_slice()[..dim]);
    }
    sampling.spread(&values, dim, nodal);
    Ok(())
}

/// Errors in L2 and in the H1 seminorm.
fn errors(kind: CellKind, cells: usize) -> Outcome<[f64; 2]> {
    let mesh = bent(unit(kind, cells)?)?;
    let (wave, law) = (Wave::new(mesh.dim()), MooneyRivlin::new(1.0, 0.4, 2.0)?);
    let loaded = mesh.surface("x+")?.to_vec();
    let held: Vec<_> = mesh.boundary().iter().copied().filter(|facet| !loaded.contains(facet)).collect();
    let held = mesh.nodes_of_facets(&held);
    let mesh = with_node_sets(&mesh, &held)?;

    let mut force = vec![0.0; mesh.dim() * mesh.points().len()];
    spread(&fine(&mesh)?, &mesh, |x| wave.body_force(&law, x), &mut force)?;
    let side = QuadraturePoints::of_facets(&mesh, &loaded, |kind| kind.rule_of_degree(2 * kind.order() + 4));
    spread(&side, &mesh, |x| Ok(wave.respond(&law, x)?.stress.column(0).into()), &mut force)?;

    let solid = Solid::new(mesh)?.material("body", law)?.nodal_force(&force)?;
    let solid = prescribe(solid, &held, |x| wave.u(x))?;
    // the interpolant is near the answer, which saves the way from rest
    let u = nodal(solid.mesh(), |x| wave.u(x));
    let near = State::equilibrium(u, solid.controls(), 1.0, SolveReport::default());
    let state = solid.solve(&solid.controls(), &SolveOptions::near(&near))?;
    deviation(solid.mesh(), &state.u, &wave)
}

fn deviation(mesh: &Mesh, u: &[f64], wave: &Wave) -> Outcome<[f64; 2]> {
    let (sampling, dim) = (fine(mesh)?, mesh.dim());
    let (values, gradients) = (sampling.interpolate(u, dim), sampling.gradients(u));
    let mut squares = [0.0; 2];
    for (q, (x, w)) in sampling.positions(mesh, None).into_iter().zip(sampling.weights()).enumerate() {
        let x = Vec3::from(x);
        let exact = wave.u(x);
        squares[0] += w * (0..dim).map(|i| (values[dim * q + i] - exact[i]).powi(2)).sum::<f64>();
        squares[1] += w * (gradients[q] - wave.gradient(x)).norm_squared();
    }
    Ok(squares.map(f64::sqrt))
}

fn assert_orders(kind: CellKind, cells: usize) -> Outcome {
    let (coarse, fine) = (errors(kind, cells)?, errors(kind, 2 * cells)?);
    let [l2, h1] = [0, 1].map(|k| (coarse[k] / fine[k]).ln() / LN_2);
    println!(
        "{kind:6} {cells:3} -> {:3}: L2 {:.3e} order {l2:.3}, H1 {:.3e} order {h1:.3}",
        2 * cells,
        fine[0],
        fine[1]
    );
    let p = kind.order() as f64;
    assert!((l2 - p - 1.0).abs() < 0.1, "{kind}: order {l2} in L2, errors {coarse:?} and {fine:?}");
    assert!((h1 - p).abs() < 0.1, "{kind}: order {h1} in H1, errors {coarse:?} and {fine:?}");
    Ok(())
}

#[test]
fn tri3_converges() -> Outcome {
    assert_orders(CellKind::Tri3, 16)
}

#[test]
fn tri6_converges() -> Outcome {
    assert_orders(CellKind::Tri6, 12)
}

#[test]
fn quad4_converges() -> Outcome {
    assert_orders(CellKind::Quad4, 16)
}

#[test]
fn quad8_converges() -> Outcome {
    assert_orders(CellKind::Quad8, 8)
}

#[test]
fn quad9_converges() -> Outcome {
    assert_orders(CellKind::Quad9, 8)
}

#[test]
fn tet4_converges() -> Outcome {
    assert_orders(CellKind::Tet4, 8)
}

#[test]
fn tet10_converges() -> Outcome {
    assert_orders(CellKind::Tet10, 4)
}

#[test]
fn hex8_converges() -> Outcome {
    assert_orders(CellKind::Hex8, 8)
}

#[test]
fn hex20_converges() -> Outcome {
    assert_orders(CellKind::Hex20, 5)
}

#[test]
fn hex27_converges() -> Outcome {
    assert_orders(CellKind::Hex27, 4)
}
