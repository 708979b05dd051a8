//! Every formulation on every kind of cell that can have it: derivatives of a potential, threads, uniform states, what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, curved, distance, largest, nodal, noise, regular};
use nastic_energy::{FiberTension, MooneyRivlin, NeoHookeIsochoric, Turgor};
use nastic_fem::{FemError, Formulation, Solid, check_contribution};
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::{Mat3, Vec3};

/// Every formulation with every kind it can have.
fn members() -> impl Iterator<Item = (Formulation, CellKind)> {
    Formulation::ALL.into_iter().flat_map(|f| f.kinds().iter().map(move |kind| (f, *kind)))
}

/// A few cells with every node moved.
fn cells(kind: CellKind) -> Outcome<Mesh> {
    let mesh = regular(kind, [1.0, 0.6, 0.5], [2, 1, 1])?;
    let mut points = mesh.points().to_vec();
    for (n, x) in points.iter_mut().enumerate() {
        x.iter_mut().enumerate().take(kind.dim()).for_each(|(k, x)| *x += 0.03 * noise(3 * n + k));
    }
    Ok(mesh.with_points(points)?)
}

/// A stiff volume, a fibre and a turgor.
fn body(mesh: Mesh, formulation: Formulation) -> Outcome<Solid> {
    Ok(Solid::new(mesh)?
        .material("body", MooneyRivlin::new(1e3, 4e2, 8e3)?)?
        .formulation("body", formulation)?
        .actuate("body", "fibre", FiberTension::along(Vec3::new(0.8, 0.6, 0.0))?)?
        .actuate("body", "turgor", Turgor)?)
}

/// A turned, stretched, sheared and uneven configuration.
fn configuration(mesh: &Mesh) -> Vec<f64> {
    let f = match mesh.dim() {
        2 => Mat3::new(1.1, -0.7, 0.0, 0.6, 0.9, 0.0, 0.0, 0.0, 1.0),
        _ => Mat3::new(1.1, -0.6, 0.2, 0.5, 0.9, -0.2, -0.1, 0.3, 1.2),
    };
    let mut u = nodal(mesh, |x| (f - Mat3::identity()) * x);
    u.iter_mut().enumerate().for_each(|(n, u)| *u += 0.02 * noise(n));
    u
}

/// Force of the potential, tangent of the force and symmetric, products, derivatives by controls, second derivatives.
#[test]
fn every_formulation_derives_from_a_potential() -> Outcome {
    for (formulation, kind) in members() {
        let solid = body(cells(kind)?, formulation)?;
        for seed in 0..2 {
            check_contribution(solid.model(), "body energy", seed)
                .map_err(|why| format!("{formulation}, {kind}: {why}"))?;
        }
    }
    Ok(())
}

/// The same bits on one thread and on several.
#[test]
fn sums_have_the_same_bits_for_any_number_of_threads() -> Outcome {
    for (formulation, kind) in members() {
        let solid = body(regular(kind, [1.0; 3], [4, 3, 3])?, formulation)?;
        let (u, mut controls) = (configuration(solid.mesh()), solid.controls());
        for k in 0..2 {
            controls.values_mut(k).iter_mut().enumerate().for_each(|(q, m)| *m = 1e2 * noise(q + k));
        }
        let answer = |threads: usize| -> Outcome<(Vec<f64>, Vec<f64>, f64)> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            let (mut tangent, model) = (solid.model().tangents().matrix(), solid.body());
            let sums = pool.install(|| model.evaluate_tangent(&u, &controls, &mut tangent, threads > 1))?;
            Ok((sums.force, tangent.values, sums.energy))
        };
        assert!(answer(1)? == answer(3)?, "{formulation}, {kind}");
    }
    Ok(())
}

/// Where J is the same at every point of a cell, laws see F: forces are those of the displacement formulation.
#[test]
fn a_uniform_deformation_is_left_as_it_is() -> Outcome {
    for (formulation, kind) in members() {
        let mesh = curved(regular(kind, [1.0, 0.6, 0.5], [2, 2, 2])?, 0.02)?;
        let f = match kind.dim() {
            2 => Mat3::new(1.1, -0.7, 0.0, 0.6, 0.9, 0.0, 0.0, 0.0, 1.0),
            _ => Mat3::new(1.1, -0.6, 0.2, 0.5, 0.9, -0.2, -0.1, 0.3, 1.2),
        };
        let u = nodal(&mesh, |x| (f - Mat3::identity()) * x);
        let force = |formulation| -> Outcome<Vec<f64>> {
            let solid = body(mesh.clone(), formulation)?;
            Ok(solid.body().evaluate(&u, &solid.controls(), true, false)?.force)
        };
        let (own, standard) = (force(formulation)?, force(Formulation::Standard)?);
        let size = largest(&standard);
        let apart = distance(&own, &standard);
        assert!(apart < 1e-12 * size, "{formulation}, {kind}: {apart:e} of {size:e}");
    }
    Ok(())
}

/// With the mean of J a law of the volume alone stores what one number per cell says; in plane strain too.
#[test]
fn laws_see_the_mean_change_of_volume() -> Outcome {
    for kind in Formulation::MeanDilatation.kinds() {
        let mesh = cells(*kind)?;
        let solid = Solid::new(mesh)?
            .material("body", NeoHookeIsochoric::new(1.0, 5e3)?)?
            .formulation("body", Formulation::MeanDilatation)?;
        let u = configuration(solid.mesh());
        let (disc, own) = (solid.discretization(), solid.discretization().points().kinematics(&u)?);
        let seen = solid.body().kinematics_of_laws(&u)?;
        let points = disc.points_of_cells();
        for patch in solid.body().patches() {
            let of_cell = |&cell: &u32| points[cell as usize].0..points[cell as usize].0 + points[cell as usize].1;
            let range: Vec<usize> = patch.iter().flat_map(of_cell).collect();
            let weights = disc.points().weights();
            let volume: f64 = range.iter().map(|&q| weights[q]).sum();
            let moved: f64 = range.iter().map(|&q| weights[q] * own[q].j()).sum();
            for (seen, own) in range.iter().map(|&q| (&seen[q], &own[q])) {
                assert!((seen.j() * volume / moved - 1.0).abs() < 1e-13, "{kind}: {} for {}", seen.j(), moved / volume);
                let (a, b) = (seen.f().column(0).normalize(), own.f().column(0).normalize());
                assert!((a - b).norm() < 1e-14, "{kind}: the shape of the deformation changes");
                assert!(kind.dim() == 3 || seen.f()[(2, 2)] == 1.0, "{kind}: {}", seen.f());
            }
        }
    }
    Ok(())
}

/// The projection is the best linear function: what is left of J is orthogonal to 1, X, Y, Z.
#[test]
fn laws_see_the_linear_part_of_the_change_of_volume() -> Outcome {
    for kind in Formulation::LinearDilatation.kinds() {
        let solid = body(cells(*kind)?, Formulation::LinearDilatation)?;
        let u = configuration(solid.mesh());
        let points = solid.discretization().points();
        let (own, seen) = (points.kinematics(&u)?, solid.body().kinematics_of_laws(&u)?);
        let positions = points.positions(solid.mesh(), None);
        for (first, count) in solid.discretization().points_of_cells() {
            let moment = |of: &dyn Fn([f64; 3]) -> f64, value: &dyn Fn(usize) -> f64| -> f64 {
                (first..first + count).map(|q| points.weights()[q] * of(positions[q]) * value(q)).sum()
            };
            for k in 0..=kind.dim() {
                let of = |x: [f64; 3]| if k == 0 { 1.0 } else { x[k - 1] };
                let left = moment(&of, &|q| seen[q].j() - own[q].j());
                let size = moment(&|x| of(x).abs(), &|q| own[q].j());
                assert!(left.abs() < 1e-13 * size, "{kind}, moment {k}: {left:e} of {size:e}");
            }
            let uneven = (first..first + count).map(|q| (seen[q].j() - own[q].j()).abs()).fold(0.0, f64::max);
            assert!(uneven > 1e-3, "{kind}: J is linear already");
        }
    }
    Ok(())
}

#[test]
fn kinds_without_the_formulation_and_contradictions_are_refused() -> Outcome {
    let bare = |kind: CellKind| -> Outcome<Solid> { Ok(Solid::new(regular(kind, [1.0; 3], [1; 3])?)?) };
    let described = |outcome: Result<Solid, FemError>| outcome.err().map(|e| e.to_string()).unwrap_or_default();
    let message = described(bare(CellKind::Hex20)?.formulation("body", Formulation::MeanDilatation));
    assert!(message.contains("hex8, quad4, tet10, tri6, tet4, tri3; hex20 cells take linear_dilatation"), "{message}");
    let message = described(bare(CellKind::Hex27)?.formulation("body", Formulation::MeanDilatation));
    assert!(message.contains("hex27 cells take linear_dilatation"), "{message}");
    let chosen = bare(CellKind::Hex8)?.formulation("body", Formulation::MeanDilatation)?;
    let message = described(chosen.clone().formulation("body", Formulation::Standard));
    assert!(message.contains("standard") && message.contains("mean_dilatation already"), "{message}");
    assert!(chosen.formulation("body", Formulation::MeanDilatation).is_ok());
    Ok(())
}

/// J > 0 everywhere, and yet its linear part is negative in a corner: such a state is refused, and steps end before it.
#[test]
fn a_step_ends_where_the_projected_volume_vanishes() -> Outcome {
    let solid = |formulation| -> Outcome<Solid> { body(regular(CellKind::Hex27, [1.0; 3], [1; 3])?, formulation) };
    let (standard, linear) = (solid(Formulation::Standard)?, solid(Formulation::LinearDilatation)?);
    // J = (1 + 0.9 x) (1 + 0.9 y) (1 + 0.9 z) with x, y, z in [-1, 1]
    let du = nodal(standard.mesh(), |x| x.map(|x| 0.225 * (2.0 * x - 1.0).powi(2)));
    let (rest, controls) = (vec![0.0; du.len()], standard.controls());
    let evaluated = |solid: &Solid| solid.body().evaluate(&du, &controls, false, false).is_ok();
    assert_eq!([evaluated(&standard), evaluated(&linear)], [true, false]);
    let step = |solid: &Solid| solid.body().max_step(&rest, &du, false);
    assert_eq!([step(&standard)?, step(&linear)?], [0.5, 0.25]);
    Ok(())
}
