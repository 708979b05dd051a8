//! The sums over cells are derivatives of one another: force of energy, tangent of force, control derivative of force;
//! for every element, law, actuation and formulation, far from the identity, on distorted meshes.

use crate::common;

use common::{Outcome, kinds, laws, nodal, noise, regular};
use nastic_energy::catalogue;
use nastic_fem::{Controls, Formulation, Solid};
use nastic_linear::SparseMatrix;
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::Mat3;

/// Relative to the largest entry; sixth-order differences leave less.
const TOLERANCE: f64 = 1e-9;

/// A few cells with every node moved: distorted, and curved for second-order kinds.
fn cells(kind: CellKind) -> Outcome<Mesh> {
    let mesh = regular(kind, [1.0, 0.6, 0.5], [2, 1, 1])?;
    let mut points = mesh.points().to_vec();
    for (n, x) in points.iter_mut().enumerate() {
        x.iter_mut().enumerate().take(kind.dim()).for_each(|(k, x)| *x += 0.03 * noise(3 * n + k));
    }
    Ok(mesh.with_points(points)?)
}

/// A turned, stretched, sheared and uneven configuration.
fn configuration(mesh: &Mesh) -> Vec<f64> {
    let f = match mesh.dim() {
        2 => Mat3::new(1.1, -0.7, 0.0, 0.6, 0.9, 0.0, 0.0, 0.0, 1.0),
        _ => Mat3::new(1.1, -0.6, 0.2, 0.5, 0.9, -0.2, -0.1, 0.3, 1.2),
    };
    let mut u = nodal(mesh, |x| (f - Mat3::identity()) * x);
    u.iter_mut().enumerate().for_each(|(n, u)| *u += 0.015 * noise(n));
    u
}

/// Controls without a pattern around the size of an example.
fn controls(solid: &Solid, example: &[f64]) -> Controls {
    let mut controls = solid.controls();
    for k in 0..controls.len() {
        let values = controls.values_mut(k);
        let slots = example.len();
        values.iter_mut().enumerate().for_each(|(n, m)| *m = example[n % slots] * (1.0 + 0.5 * noise(n)));
    }
    controls
}

/// Every law and every actuation (on top of a law) of the catalogue on the mesh.
fn solids(kind: CellKind) -> Outcome<Vec<(String, Solid, Controls)>> {
    let mesh = std::sync::Arc::new(cells(kind)?);
    let bare = Solid::new(mesh)?;
    let mut all = Vec::new();
    for (name, law) in laws()? {
        let solid = bare.clone().material("body", law)?;
        let controls = solid.controls();
        all.push((format!("{kind}, {name}"), solid, controls));
    }
    let (_, law) = laws()?.remove(0);
    // modes of a shape are those of one mesh: shape.rs
    for row in catalogue::actuations().iter().filter(|row| row.name != "shape") {
        for inputs in row.examples() {
            let solid = bare.clone().material("body", law.clone())?.actuate("body", "m", row.build(&inputs)?)?;
            let controls = controls(&solid, row.example.controls);
            for formulation in Formulation::ALL.into_iter().filter(|f| f.kinds().contains(&kind)) {
                let solid = solid.clone().formulation("body", formulation)?;
                all.push((format!("{kind}, {formulation}, {} {inputs:?}", row.name), solid, controls.clone()));
            }
        }
    }
    Ok(all)
}

/// d/dt of a vector-valued function at 0, to sixth order.
fn slope(step: f64, f: impl Fn(f64) -> Outcome<Vec<f64>>) -> Outcome<Vec<f64>> {
    let mut sum = vec![0.0; f(0.0)?.len()];
    for (offset, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        let (plus, minus) = (f(offset * step)?, f(-offset * step)?);
        for (s, (p, m)) in sum.iter_mut().zip(plus.iter().zip(&minus)) {
            *s += weight * (p - m) / (60.0 * step);
        }
    }
    Ok(sum)
}

fn moved(u: &[f64], direction: &[f64], t: f64) -> Vec<f64> {
    u.iter().zip(direction).map(|(u, d)| u + t * d).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn force(solid: &Solid, u: &[f64], controls: &Controls) -> Outcome<Vec<f64>> {
    Ok(solid.body().evaluate(u, controls, true, false)?.force)
}

fn tangent(solid: &Solid, u: &[f64], controls: &Controls) -> Outcome<SparseMatrix> {
    let mut matrix = solid.model().tangent_structure().matrix();
    solid.body().evaluate_tangent(u, controls, &mut matrix, false)?;
    Ok(matrix)
}

#[test]
fn the_force_is_the_derivative_of_the_energy() -> Outcome {
    for (name, solid, controls) in kinds().map(solids).collect::<Outcome<Vec<_>>>()?.concat() {
        let u = configuration(solid.mesh());
        let direction: Vec<f64> = (0..u.len()).map(|n| noise(n + 1000)).collect();
        let energy = |t| Ok(vec![solid.body().evaluate(&moved(&u, &direction, t), &controls, false, false)?.energy]);
        let force = force(&solid, &u, &controls)?;
        let (found, expected) = (dot(&force, &direction), slope(1e-3, energy)?[0]);
        let scale: f64 = force.iter().zip(&direction).map(|(f, d)| (f * d).abs()).sum();
        assert!((found - expected).abs() < TOLERANCE * scale, "{name}: {found} where differences give {expected}");
    }
    Ok(())
}

/// Column by column, so that no entry can hide.
#[test]
fn the_tangent_is_the_derivative_of_the_force() -> Outcome {
    for (name, solid, controls) in kinds().map(solids).collect::<Outcome<Vec<_>>>()?.concat() {
        let u = configuration(solid.mesh());
        let matrix = tangent(&solid, &u, &controls)?;
        let scale = matrix.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        for dof in probed(&solid) {
            let mut unit = vec![0.0; u.len()];
            unit[dof] = 1.0;
            let expected = slope(2e-4, |t| force(&solid, &moved(&u, &unit, t), &controls))?;
            for (row, expected) in expected.iter().enumerate() {
                let found = matrix.get(row, dof);
                let error = (found - expected).abs() / scale;
                assert!(error < TOLERANCE, "{name}: K[{row}, {dof}] = {found} where differences give {expected}");
            }
        }
    }
    Ok(())
}

/// Without a matrix, and with one.
#[test]
fn a_product_with_the_tangent_needs_no_matrix() -> Outcome {
    for (name, solid, controls) in kinds().map(solids).collect::<Outcome<Vec<_>>>()?.concat() {
        let u = configuration(solid.mesh());
        let v: Vec<f64> = (0..u.len()).map(|n| noise(n + 3000)).collect();
        let (mut expected, mut found) = (vec![0.0; u.len()], vec![1.0; u.len()]);
        tangent(&solid, &u, &controls)?.multiply(&v, &mut expected);
        solid.body().tangent_product(&u, &controls, &v, &mut found, false)?;
        let error = common::distance(&found, &expected) / common::largest(&expected);
        assert!(error < 1e-13, "{name}: {error:e}");
    }
    Ok(())
}

/// The unknowns of the nodes of one cell: each meets every other one of the cell, and those of its neighbours.
fn probed(solid: &Solid) -> Vec<usize> {
    let (mesh, dim) = (solid.mesh(), solid.mesh().dim());
    let cell = mesh.cell(mesh.cells() / 2);
    cell.nodes.iter().flat_map(|&node| (0..dim).map(move |c| dim * node as usize + c)).collect()
}

/// What an adjoint displacement makes of the controls: `lambda . df/dm`, for every control of one cell in turn.
#[test]
fn pulling_back_is_the_derivative_of_the_force_by_the_controls() -> Outcome {
    for (name, solid, controls) in kinds().map(solids).collect::<Outcome<Vec<_>>>()?.concat() {
        if controls.is_empty() {
            continue;
        }
        let u = configuration(solid.mesh());
        let lambda: Vec<f64> = (0..u.len()).map(|n| noise(n + 2000)).collect();
        let pulled = solid.body().control_vjp(&u, &controls, &lambda, false)?;
        let (first, count) = solid.discretization().points_of_cells()[1];
        let width = controls.slots(0);
        for entry in first * width..(first + count) * width {
            let value = controls.values(0)[entry];
            // forces are linear in all other controls
            let share = if solid.body().actuations()[0].law.strain_map().is_some() { 0.02 } else { 0.1 };
            let step = share * common::largest(controls.values(0));
            let work = |t| {
                let mut changed = controls.clone();
                changed.values_mut(0)[entry] = value + t;
                Ok(vec![dot(&force(&solid, &u, &changed)?, &lambda)])
            };
            let (found, expected) = (pulled.values(0)[entry], slope(step, work)?[0]);
            let scale = common::largest(pulled.values(0));
            assert!((found - expected).abs() < TOLERANCE * scale, "{name}, {entry}: {found} instead of {expected}");
        }
    }
    Ok(())
}
