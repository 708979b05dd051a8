//! Bodies that grow: compatible growth is taken without energy, layers that grow apart bend as they must, what is refused.

use crate::common;

use common::block::{Block, STRICT};
use common::homogeneous::cases;
use common::motion::steps;
use common::{Outcome, kinds, largest, nodal, regular};
use nastic_energy::{
    EnergyTerm, FiberTension, Field, GrowthTensor, KelvinVoigt, KinematicGrowth, MaxwellBranch, NeoHooke, PointBatch,
    SpontaneousStrain, ThermalExpansion,
};
use nastic_fem::{
    EnergyBalance, EnergyLedger, FemError, Formulation, Scheme, Solid, SolveOptions, State, TimeStepping, Trajectory,
    Workspace,
};
use nastic_mesh::{CellKind, rectangle};
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

/// u is that of `F = G`, and nothing is stored.
fn assert_taken(solid: &Solid, state: &State, expected: &[f64], what: &str) -> Outcome {
    let apart = state.u.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let energy = solid.body().evaluate(&state.u, &state.controls, false, false)?.energy;
    assert!(apart < 1e-9, "{what}: u is off by {apart:e}");
    assert!(energy.abs() < 1e-12, "{what}: energy {energy:e}");
    Ok(())
}

type Grows = fn(f64) -> Mat3;

/// Every kind with its G.
fn kinds_of_growth() -> Outcome<Vec<(Arc<dyn EnergyTerm>, Grows)>> {
    Ok(vec![
        (Arc::new(KinematicGrowth::isotropic()), |g| Mat3::identity() * (1.0 + g)),
        (Arc::new(KinematicGrowth::along(Vec3::y())?), |g| Mat3::from_diagonal(&Vec3::new(1.0, 1.0 + g, 1.0))),
        (Arc::new(KinematicGrowth::across(Vec3::y())?), |g| Mat3::from_diagonal(&Vec3::new(1.0 + g, 1.0, 1.0 + g))),
        (Arc::new(ThermalExpansion::along(Vec3::y(), 2.0, -1.0)?), |t| {
            Mat3::from_diagonal(&Vec3::new(1.0 - t, 1.0 + 2.0 * t, 1.0 - t))
        }),
        (Arc::new(SpontaneousStrain::elastomer(Vec3::y())?), |e| {
            let across = 1.0 / (1.0 + e).sqrt();
            Mat3::from_diagonal(&Vec3::new(across, 1.0 + e, across))
        }),
        (Arc::new(GrowthTensor::new()), |g| Mat3::identity() + Mat3::repeat(g)),
    ])
}

/// The turn of G that supports allow: upper triangular, `F^T F = G^T G`.
fn upright(g: &Mat3) -> Outcome<Mat3> {
    Ok((g.transpose() * g).cholesky().ok_or("no stretch")?.l().transpose())
}

#[test]
fn a_free_block_takes_its_growth_for_every_law_and_cell() -> Outcome {
    for kind in kinds().filter(|kind| kind.dim() == 3) {
        let block = Block::new(kind)?;
        for case in cases()? {
            for (law, grown) in kinds_of_growth()? {
                // far from rest there are turned equilibria too
                for g in [0.3, if law.slots().len() == 6 { -0.1 } else { -0.2 }] {
                    let (solid, state) = block.driven(&case, law.clone(), g)?;
                    let more = upright(&grown(g))? - Mat3::identity();
                    let expected = nodal(solid.mesh(), |x| more * x);
                    assert_taken(&solid, &state, &expected, &format!("{kind}, {}, {law:?}, {g}", case.name))?;
                }
            }
        }
    }
    Ok(())
}

/// `g = 0.6 x` along x is the gradient of `x + 0.3 x^2`, which quadratic cells represent.
#[test]
fn growth_that_varies_and_is_compatible_is_taken_without_energy() -> Outcome {
    for formulation in [Formulation::Standard, Formulation::LinearDilatation] {
        let solid = Solid::new(regular(CellKind::Hex27, [1.0, 0.4, 0.4], [3, 1, 1])?)?
            .material("body", NeoHooke::new(1.0, 3.0)?)?
            .actuate("body", "growth", KinematicGrowth::along(Vec3::x())?)?
            .formulation("body", formulation)?
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .displace("z-", [None, None, Some(0.0)])?;
        let points = solid.discretization().points().positions(solid.mesh(), None);
        let mut controls = solid.controls();
        controls.set(0, 0, &points.iter().map(|x| 0.6 * x[0]).collect::<Vec<_>>())?;
        let state = solid.solve(&controls, &STRICT)?;
        let expected = nodal(solid.mesh(), |x| Vec3::new(0.3 * x.x * x.x, 0.0, 0.0));
        assert_taken(&solid, &state, &expected, &format!("{formulation}"))?;
        // what laws see is F; what they answer is that of F G^-1, nothing
        let fields = solid.cell_fields(&state)?;
        assert!(largest(&fields.cauchy) < 1e-9 && fields.j.iter().any(|j| *j > 1.3), "{:?}", fields.j);
    }
    Ok(())
}

/// Two equal layers of which the upper one grows by e curve by `3 e / (2 h)`; where they grow in all directions, in plane strain, by `1 + nu` more.
///
/// Source: S. Timoshenko, "Analysis of bi-metal thermostats", J. Opt. Soc. Am. 11 (1925) 233-255.
#[test]
fn two_layers_curve_as_a_bimetal() -> Outcome {
    let (h, nu, e) = (0.02, 0.3, 1e-3);
    for (law, factor) in [(KinematicGrowth::along(Vec3::x())?, 1.0), (KinematicGrowth::isotropic(), 1.0 + nu)] {
        let solid = Solid::new(rectangle([1.0, h], [100, 2], CellKind::Quad9)?)?
            .material("body", NeoHooke::from_young_poisson(1e5, nu)?)?
            .actuate("body", "growth", law)?
            .clamp("x-")?;
        let points = solid.discretization().points().positions(solid.mesh(), None);
        let mut controls = solid.controls();
        controls.set(0, 0, &points.iter().map(|x| if x[1] > 0.5 * h { e } else { 0.0 }).collect::<Vec<_>>())?;
        let state = solid.solve(&controls, &SolveOptions::default())?;
        let kappa = factor * 1.5 * e / h;
        let middle = |x: f64| {
            let near = |p: &[f64; 3]| (p[0] - x).abs() < 1e-9 && (p[1] - 0.5 * h).abs() < 1e-9;
            solid.mesh().points().iter().position(near).map(|node| state.u[2 * node + 1]).ok_or("no such node")
        };
        // away from clamp and end, where the layers slide: by three deflections
        let found = -(middle(0.2)? - 2.0 * middle(0.5)? + middle(0.8)?) / 0.09;
        assert!((found / kappa - 1.0).abs() < 2e-3, "curvature {found}, expected {kappa}");
    }
    Ok(())
}

/// A ring that is cut and grows along its hoops by g everywhere stores nothing and spans the angle 2 pi (1 + g): it opens, or overlaps.
#[test]
fn a_cut_ring_takes_the_growth_of_its_hoops() -> Outcome {
    let turn = 2.0 * std::f64::consts::PI;
    let flat = rectangle([1.0, 0.2], [80, 1], CellKind::Quad9)?;
    let around = |x: &[f64; 3]| [(1.0 + x[1]) * (turn * x[0]).cos(), -(1.0 + x[1]) * (turn * x[0]).sin(), 0.0];
    let places = flat.points().to_vec();
    let mesh = flat.with_points(places.iter().map(around).collect())?;
    let bare = Solid::new(mesh.clone())?;
    let hoop = |x: &[f64; 3]| Vec3::new(-x[1], x[0], 0.0).normalize();
    let hoops: Vec<Vec3> = bare.discretization().points().positions(bare.mesh(), None).iter().map(hoop).collect();
    let solid = bare
        .material("body", NeoHooke::from_young_poisson(1.0, 0.3)?)?
        .actuate("body", "growth", KinematicGrowth::along(Field::points(hoops))?)?
        .clamp("x-")?;
    for g in [-0.1, 0.15] {
        let mut controls = solid.controls();
        controls.values_mut(0).fill(g);
        let state = solid.solve(&controls, &STRICT)?;
        let energy = solid.body().evaluate(&state.u, &state.controls, false, false)?.energy;
        // of one with the same strains that were not free
        assert!(energy < 1e-6 * 0.5 * g * g * turn * 0.2, "{g}: {energy:e}");
        for (node, x) in places.iter().enumerate() {
            let (r, angle) = (1.0 + x[1], turn * (1.0 + g) * x[0]);
            let place = [0, 1].map(|c| mesh.points()[node][c] + state.u[2 * node + c]);
            let off = (place[0] - r * angle.cos()).hypot(place[1] + r * angle.sin());
            assert!(off < 2e-4, "{g}: {off:e} at {x:?}");
        }
    }
    Ok(())
}

/// Every law of a cell sees `F G^-1`: a fibre tension in a body that grows freely by G pulls at grown fibres.
#[test]
fn a_fibre_is_longer_in_a_body_that_has_grown() -> Outcome {
    let (g, tension) = (0.25, -0.4);
    let cube = || -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
            .material("body", NeoHooke::new(1.0, 3.0)?)?
            .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .displace("z-", [None, None, Some(0.0)])?)
    };
    let stretches = |solid: Solid, values: &[f64]| -> Outcome<Vec3> {
        let mut controls = solid.controls();
        values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k).fill(*value));
        let state = solid.solve(&controls, &STRICT)?;
        let kinematics = solid.body().kinematics_of_laws(&state.u)?;
        let at = PointBatch { kinematics: &kinematics[..1], cell: 0, first: 0 };
        Ok(at.kinematics[0].f().diagonal())
    };
    let plain = stretches(cube()?, &[tension])?;
    let grown = stretches(cube()?.actuate("body", "growth", KinematicGrowth::isotropic())?, &[tension, g])?;
    assert!((grown - plain * (1.0 + g)).norm() < 1e-11, "{grown} for {plain}");
    Ok(())
}

#[test]
fn a_cell_grows_in_one_way_and_not_away() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [2, 1, 1])?)?
        .material("body", NeoHooke::new(1.0, 3.0)?)?
        .actuate("body", "swell", KinematicGrowth::isotropic())?
        .clamp("x-")?;
    let twice = solid.clone().actuate("body", "again", KinematicGrowth::along(Vec3::x())?);
    assert!(
        matches!(&twice, Err(FemError::Meaningless { what }) if what.contains("\"swell\"") && what.contains("\"again\""))
    );
    let mut controls = solid.controls();
    controls.values_mut(0).fill(-1.0);
    let still = solid.rest().u;
    let gone = solid.body().evaluate(&still, &controls, true, false).err().ok_or("it shrinks to nothing")?.to_string();
    assert!(gone.contains("det G"), "{gone}");
    Ok(())
}

/// A viscous cube grows in half of a time and rests in the other half. Free along x it stores and loses nothing; held there it loses, and never
/// gains, and the work of growth closes the balance.
#[test]
fn growth_of_viscous_bodies_keeps_the_balance_of_energy() -> Outcome {
    for (law, held) in [(0, false), (1, false), (0, true), (1, true)] {
        let branch: Arc<dyn EnergyTerm> = match law {
            0 => Arc::new(MaxwellBranch::new(0.8, 0.2)?),
            _ => Arc::new(KelvinVoigt::new(0.1, 0.1)?),
        };
        let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
            .material("body", NeoHooke::new(1.0, 3.0)?)?
            .viscosity("body", branch)?
            .actuate("body", "growth", KinematicGrowth::along(Vec3::x())?)?
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .displace("z-", [None, None, Some(0.0)])?;
        let solid = if held { solid.displace("x+", [Some(0.0), None, None])? } else { solid };
        let scheme = Scheme::quasi_static();
        let balances = |count: usize| -> Outcome<Vec<EnergyBalance>> {
            let grown = |t: f64| {
                let mut controls = solid.controls();
                controls.values_mut(1).fill(0.2 * t.min(1.0));
                controls
            };
            let mut run = Trajectory::from_given(solid.rest());
            let steps = steps(count, 2.0 / count as f64, grown);
            solid.model().advance(&mut run, &scheme, &steps, &STRICT, &mut Workspace::default())?;
            let mut ledger = EnergyLedger::new(solid.model(), &scheme, &run.end().controls)?;
            run.states().iter().map(|state| Ok(ledger.add(solid.model(), state)?)).collect()
        };
        let all = balances(40)?;
        let end = all[40];
        let largest = all.iter().map(|balance| balance.elastic).fold(0.0, f64::max);
        if !held {
            assert!(largest < 1e-12 && end.viscous_loss.abs() < 1e-12, "{law}: {end:?}");
            continue;
        }
        assert!(all.windows(2).all(|pair| pair[1].viscous_loss >= pair[0].viscous_loss - 1e-12), "{law}: {end:?}");
        assert!(largest > 1e-2 && end.viscous_loss > 1e-3 && end.drive_work > end.elastic, "{law}: {end:?}");
        // what the scheme adds falls with its step
        let finer = balances(80)?[80];
        assert!(
            finer.scheme.abs() < 0.6 * end.scheme.abs() && end.scheme.abs() < 0.1 * end.drive_work,
            "{law}: {end:?} {finer:?}"
        );
        assert!(end.unbalanced.abs() < 1e-9, "{law}: {end:?}");
    }
    Ok(())
}
