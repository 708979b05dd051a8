//! The discrete adjoint of every time scheme against whole motions, by Taylor tests.
//!
//! Every pair of a scheme, a dissipation, a drive and a start is met; with `NASTIC_SLOW=1` (`scripts/slow.sh`) all combinations, over
//! longer motions.

use crate::common;

use common::block::STRICT;
use common::motion::schemes;
use common::own_contributions::swirling;
use common::{Outcome, noise};
use nastic_energy::{FiberTension, KelvinVoigt, Magnet, MaxwellBranch, NeoHooke, Turgor};
use nastic_fem::{
    Cavity, Controls, Formulation, Inertia, Scheme, Solid, State, StatePartials, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_mesh::{CellKind, Mesh, RawMesh, rectangle};
use nastic_tensor::Vec3;
use std::sync::Arc;
use std::time::Instant;

const H: f64 = 0.1;
/// What drives the frame, in the order of its blocks of controls.
const DRIVES: [&str; 4] = ["fibre", "turgor", "magnet", "cavity pressure"];

/// All combinations instead of all pairs.
fn slow() -> bool {
    std::env::var_os("NASTIC_SLOW").is_some()
}

/// Of the Taylor tests. A step runs the same code at any place of a motion: more steps only let errors grow.
fn steps() -> usize {
    if slow() { 200 } else { 40 }
}

/// A plane frame of eight squares, or of twice as many triangles, around a chamber, held at one side, with surfaces "x-" and "inside".
fn frame(kind: CellKind) -> Outcome<Mesh> {
    let full = rectangle([3.0, 3.0], [3, 3], CellKind::Quad4)?;
    let hole = (0..full.cells()).find(|&c| full.cell_centre(c)[..2].iter().all(|x| (x - 1.5).abs() < 0.1)).ok_or("")?;
    let mut raw = RawMesh::new("frame");
    raw.points = full.points().to_vec();
    raw.name_group(2, 1, "body");
    raw.name_group(1, 2, "x-");
    raw.name_group(1, 3, "inside");
    let parts: &[&[usize]] = if kind == CellKind::Tri3 { &[&[0, 1, 2], &[0, 2, 3]] } else { &[&[0, 1, 2, 3]] };
    for cell in (0..full.cells()).filter(|&cell| cell != hole) {
        let nodes = full.cell(cell).nodes;
        parts.iter().for_each(|part| raw.push(kind, &part.iter().map(|&a| nodes[a]).collect::<Vec<u32>>(), &[1]));
    }
    for &facet in full.surface("x-")? {
        let (kind, nodes) = full.facet_nodes(facet);
        raw.push(kind, &nodes, &[2]);
    }
    for (kind, local) in CellKind::Quad4.faces() {
        let nodes: Vec<u32> = local.iter().map(|&a| full.cell(hole).nodes[a]).collect();
        raw.push(*kind, &nodes, &[3]);
    }
    Ok(Mesh::build(raw)?)
}

/// What takes energy out of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Dissipation {
    None,
    Rayleigh,
    Maxwell,
    KelvinVoigt,
}

impl Dissipation {
    const ALL: [Self; 4] = [Self::None, Self::Rayleigh, Self::Maxwell, Self::KelvinVoigt];

    /// Viscous laws give no second derivatives, which the adjoint of a linearised step takes.
    fn goes_with(self, scheme: &Scheme) -> bool {
        scheme.has_adjoint() && (!scheme.is_linearised() || matches!(self, Self::None | Self::Rayleigh))
    }
}

/// Of squares, or of patches of triangles.
fn driven(kind: CellKind, dissipation: Dissipation) -> Outcome<Solid> {
    let formulation = if kind == CellKind::Tri3 { Formulation::MeanDilatation } else { Formulation::Standard };
    let solid = Solid::new(frame(kind)?)?
        .formulation("body", formulation)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", DRIVES[0], FiberTension::along(Vec3::x())?)?
        .actuate("body", DRIVES[1], Turgor)?
        .actuate("body", DRIVES[2], Magnet::with_permeability(1.0)?)?
        .cavity(Cavity::new(DRIVES[3], "inside"))?
        .body_force("body", Vec3::new(0.0, -2e-3, 0.0))?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?;
    Ok(match dissipation {
        Dissipation::None => solid,
        Dissipation::Rayleigh => solid.rayleigh_damping(0.02, 0.05)?,
        Dissipation::Maxwell => {
            solid.viscosity("body", MaxwellBranch::new(0.5, 0.3)?)?.viscosity("body", MaxwellBranch::new(0.2, 3.0)?)?
        }
        Dissipation::KelvinVoigt => solid.viscosity("body", KelvinVoigt::new(0.05, 0.02)?)?,
    })
}

/// The block of controls of something that drives.
fn block(solid: &Solid, name: &str) -> usize {
    solid.model().controllable().iter().position(|known| known.name == name).unwrap_or(usize::MAX)
}

/// Controls at an instant of one motion, plus a multiple of a direction in one of the blocks: random from instant to
/// instant.
fn controls(solid: &Solid, n: usize, (driven, along): (usize, f64)) -> Controls {
    let mut controls = solid.controls();
    let time = H * n as f64;
    let wave = |period: f64| (std::f64::consts::TAU * time / period + period).sin();
    controls.values_mut(0).fill(0.1 * wave(7.0));
    controls.values_mut(1).fill(0.05 + 0.05 * wave(5.0));
    for values in controls.values_mut(2).chunks_exact_mut(6) {
        values.copy_from_slice(&[1.0, 0.2, 0.0, 0.01 * wave(6.0), 0.02 * wave(9.0), 0.0]);
    }
    controls.values_mut(self::block(solid, DRIVES[3]))[0] = 0.03 + 0.03 * wave(8.0);
    for (point, value) in controls.values_mut(driven).iter_mut().enumerate() {
        if free(driven, point) {
            *value += along * direction(n, point);
        }
    }
    controls
}

/// Plane bodies have magnets in their plane.
fn free(block: usize, point: usize) -> bool {
    block != 2 || point % 3 != 2
}

fn direction(n: usize, point: usize) -> f64 {
    noise(1_000_000 + 1000 * n + point)
}

/// How a motion begins.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Start {
    Equilibrium,
    /// With a velocity, from where forces do not balance.
    Given,
}

/// Under the controls of instants numbered from 0.
fn begin(solid: &Solid, start: Start, first: Controls) -> Outcome<Trajectory> {
    if start == Start::Equilibrium {
        return Ok(Trajectory::from(solid.solve(&first, &STRICT)?));
    }
    let mut velocity: Vec<f64> = (0..solid.discretization().dofs()).map(|i| 0.05 * noise(i)).collect();
    solid.supports().fixed().iter().zip(&mut velocity).filter(|(f, _)| **f).for_each(|(_, v)| *v = 0.0);
    let u: Vec<f64> = velocity.iter().map(|v| 0.3 * v).collect();
    let velocity = Some(Arc::new(velocity));
    Ok(Trajectory::from_given(State { u: Arc::new(u), velocity, controls: Arc::new(first), ..solid.rest() }))
}

fn run(solid: &Solid, scheme: &Scheme, change: (usize, f64)) -> Outcome<Trajectory> {
    let mut trajectory = begin(solid, Start::Equilibrium, controls(solid, 0, change))?;
    let steps: Vec<StepTo> = (1..=steps()).map(|n| StepTo { dt: H, controls: controls(solid, n, change) }).collect();
    solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

/// `sum_n h (w_n . u_n + |u_n|^2 / 2 + z_n . v_n)`
fn weight(n: usize, i: usize) -> f64 {
    noise(77 + 100 * n + i)
}

fn functional(trajectory: &Trajectory) -> f64 {
    let mut sum = 0.0;
    for (n, state) in trajectory.states().iter().enumerate() {
        for (i, u) in state.u.iter().enumerate() {
            let v = state.velocity.as_ref().filter(|_| n > 0).map_or(0.0, |v| v[i]);
            sum += H * (weight(n, i) * u + 0.5 * u * u + weight(n + 7, i) * v);
        }
    }
    sum
}

fn partials(trajectory: &Trajectory) -> Vec<StatePartials> {
    let of = |(n, state): (usize, &State)| {
        let u = state.u.iter().enumerate().map(|(i, u)| H * (weight(n, i) + u)).collect();
        let velocity = (0..state.u.len()).map(|i| if n > 0 { H * weight(n + 7, i) } else { 0.0 }).collect();
        StatePartials { u, velocity, ..StatePartials::default() }
    };
    trajectory.states().iter().enumerate().map(of).collect()
}

fn sweep(solid: &Solid, trajectory: &Trajectory) -> Outcome<Vec<Controls>> {
    Ok(solid.model().reverse_sweep(trajectory, &partials(trajectory), &STRICT, &mut Workspace::default())?.controls)
}

/// Orders of the remainder of the linear model in the blocks of controls of some drives, and the time of a gradient in forward runs.
fn taylor(solid: &Solid, scheme: &Scheme, drives: &[&str]) -> Outcome<(Vec<f64>, f64)> {
    let clock = Instant::now();
    let base = run(solid, scheme, (0, 0.0))?;
    let forward = clock.elapsed();
    let value = functional(&base);
    let clock = Instant::now();
    let swept = sweep(solid, &base)?;
    let ratio = clock.elapsed().as_secs_f64() / forward.as_secs_f64();
    let order = |block: usize| -> Outcome<f64> {
        let along = |(n, by): (usize, &Controls)| -> f64 {
            let at = |(point, d): (usize, &f64)| if free(block, point) { d * direction(n, point) } else { 0.0 };
            by.values(block).iter().enumerate().map(at).sum()
        };
        let slope: f64 = swept.iter().enumerate().map(along).sum();
        let change = |t: f64| -> Outcome<f64> { Ok(functional(&run(solid, scheme, (block, t))?) - value) };
        let [coarse, fine] = [5e-3, 5e-4].map(|t| change(t).map(|change| (change, (change - t * slope).abs())));
        let ((whole, coarse), (_, fine)) = (coarse?, fine?);
        assert!(coarse < 0.5 * whole.abs() && coarse > 1e-10, "a remainder of {coarse:e} in a change of {whole:e}");
        Ok((coarse / fine).log10())
    };
    Ok((drives.iter().map(|name| order(block(solid, name))).collect::<Outcome<_>>()?, ratio))
}

#[test]
fn the_adjoint_of_every_scheme_is_exact_over_long_motions() -> Outcome {
    for (row, dissipation) in Dissipation::ALL.into_iter().enumerate() {
        let solid = driven(CellKind::Quad4, dissipation)?;
        for (column, (scheme, _)) in schemes()?.into_iter().enumerate() {
            if !dissipation.goes_with(&scheme) {
                continue;
            }
            // A Latin square: every scheme and every dissipation meets every drive. Linearised schemes go with half of the dissipations.
            let drive = DRIVES[(row + column) % 4];
            let drives = match (slow(), scheme.is_linearised()) {
                (true, _) => DRIVES.to_vec(),
                (false, true) => vec![drive, DRIVES[(row + column + 2) % 4]],
                (false, false) => vec![drive],
            };
            let (orders, ratio) = taylor(&solid, &scheme, &drives)?;
            println!(
                "{:<24} {dissipation:?}, {drives:?}: orders {orders:.3?}, gradient / run {ratio:.2}",
                scheme.name()
            );
            let least = orders.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least > 1.95, "{}, {dissipation:?}, orders {orders:?}", scheme.name());
        }
    }
    Ok(())
}

/// The derivative by the controls of each instant by itself, the first included, from an equilibrium or from a given
/// state, over a change of the step's length and of the scheme (after the midpoint rule an acceleration has to be
/// found).
#[test]
fn every_instant_has_its_derivative() -> Outcome {
    let quads = [Dissipation::Rayleigh, Dissipation::Maxwell, Dissipation::KelvinVoigt].map(|d| (CellKind::Quad4, d));
    let bodies = quads.into_iter().chain([(CellKind::Tri3, Dissipation::Maxwell)]);
    bodies.enumerate().try_for_each(|(row, (kind, dissipation))| every_instant(row, kind, dissipation))
}

/// Of a body with one of the starts for each mixture of schemes, in turn, so that every mixture and every body has both.
fn every_instant(row: usize, kind: CellKind, dissipation: Dissipation) -> Outcome {
    let solid = driven(kind, dissipation)?;
    let pressure = block(&solid, DRIVES[3]);
    let mut mixtures: Vec<Vec<Scheme>> = schemes()?.into_iter().map(|(scheme, _)| vec![scheme]).collect();
    mixtures.push(vec![Scheme::implicit_midpoint(), Scheme::trapezoidal(), Scheme::bdf2()]);
    let starts = [Start::Equilibrium, Start::Given];
    let of_mixture = |(column, mixture)| starts.map(|start| (mixture, start, start == starts[(row + column) % 2]));
    for (mixture, start, is_next) in mixtures.iter().enumerate().flat_map(of_mixture) {
        if !dissipation.goes_with(&mixture[0]) {
            continue;
        }
        // these have one start alone, or are met by one body alone
        let both =
            mixture[0].is_quasi_static() || mixture[0].is_linearised() || dissipation == Dissipation::KelvinVoigt;
        if !(slow() || both || is_next) {
            continue;
        }
        // some schemes begin with an acceleration, which is not known of a body that moves then
        let moves = start == Start::Given || mixture.len() > 1;
        if dissipation == Dissipation::KelvinVoigt && moves {
            continue;
        }
        // without inertia no velocity
        if mixture[0].is_quasi_static() && start == Start::Given {
            continue;
        }
        let run = |changed: usize, change: (usize, f64)| -> Outcome<Trajectory> {
            let of = |n: usize| controls(&solid, 10 * n, if n == changed { change } else { (0, 0.0) });
            let mut trajectory = begin(&solid, start, of(0))?;
            for (part, scheme) in mixture.iter().cycle().take(3).enumerate() {
                let dt = [0.4, 0.4, 0.7][part];
                let steps: Vec<StepTo> = (2 * part + 1..2 * part + 3).map(|n| StepTo { dt, controls: of(n) }).collect();
                solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
            }
            Ok(trajectory)
        };
        let swept = sweep(&solid, &run(0, (0, 0.0))?)?;
        for (n, by) in swept.iter().enumerate() {
            let block = if n % 2 == 0 { pressure } else { 2 }; // or the magnet
            let slope: f64 = by
                .values(block)
                .iter()
                .enumerate()
                .filter(|(p, _)| free(block, *p))
                .map(|(p, d)| d * direction(10 * n, p))
                .sum();
            let value = |t: f64| -> Outcome<f64> { Ok(functional(&run(n, (block, t))?)) };
            let difference = |t: f64| -> Outcome<f64> { Ok(value(t)? - value(-t)?) };
            let expected = (8.0 * difference(0.01)? - difference(0.02)?) / 0.12;
            let scheme = mixture[0].name();
            let error = (slope - expected).abs();
            assert!(
                error < 1e-6 * expected.abs() + 1e-9,
                "{scheme}, {dissipation:?}, {start:?}, instant {n}: {slope:e}, {expected:e}"
            );
        }
    }
    Ok(())
}

#[test]
fn a_linearised_step_has_no_adjoint_with_viscous_laws() -> Outcome {
    let solid = driven(CellKind::Quad4, Dissipation::Maxwell)?;
    let mut run = begin(&solid, Start::Equilibrium, controls(&solid, 0, (0, 0.0)))?;
    let step = [StepTo { dt: H, controls: controls(&solid, 1, (0, 0.0)) }];
    solid.model().advance(&mut run, &Scheme::linearly_implicit_euler(), &step, &STRICT, &mut Workspace::default())?;
    let refused = sweep(&solid, &run).err().ok_or("an adjoint")?.to_string();
    assert!(refused.contains("second derivatives") && refused.contains("backward_euler"), "{refused}");
    Ok(())
}

/// A force that turns with its point, whose tangent is not symmetric.
#[test]
fn forces_without_a_potential_have_an_adjoint_in_motion() -> Outcome {
    let solid = swirling()?.inertia(Inertia::new("body", 50.0).lumped())?.rayleigh_damping(0.1, 0.01)?;
    let block = solid.controls().len() - 1;
    for (scheme, _) in schemes()? {
        let run = |changed: usize, change: f64| -> Outcome<Trajectory> {
            let of = |n: usize| {
                let mut controls = solid.controls();
                controls.values_mut(0).fill(-100.0);
                controls.values_mut(block)[0] = 6.0 + n as f64 + if n == changed { change } else { 0.0 };
                controls
            };
            let mut trajectory = Trajectory::from_given(State { controls: Arc::new(of(0)), ..solid.rest() });
            let steps: Vec<StepTo> = (1..=4).map(|n| StepTo { dt: 0.2, controls: of(n) }).collect();
            solid.model().advance(&mut trajectory, &scheme, &steps, &STRICT, &mut Workspace::default())?;
            Ok(trajectory)
        };
        if !scheme.has_adjoint() {
            let refused = run(0, 0.0).err().ok_or("no error")?.to_string();
            assert!(refused.contains("symmetric stiffness"), "{refused}");
            continue;
        }
        let swept = sweep(&solid, &run(0, 0.0)?)?;
        for (n, by) in swept.iter().enumerate() {
            let difference = |t: f64| -> Outcome<f64> { Ok(functional(&run(n, t)?) - functional(&run(n, -t)?)) };
            let expected = (8.0 * difference(0.2)? - difference(0.4)?) / 2.4;
            let error = (by.values(block)[0] - expected).abs();
            assert!(error < 1e-6 * expected.abs() + 1e-10, "{}, instant {n}: {error:e} of {expected:e}", scheme.name());
        }
    }
    Ok(())
}
