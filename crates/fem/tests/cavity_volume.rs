//! Cavities of a prescribed volume: the thick sphere through its pressure maximum, the derivative by the added volume, volumes
//! beside pressures, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::shells::{INNER, deformed_radius, pressure, shell};
use common::{Outcome, largest, noise, regular};
use nastic_energy::MooneyRivlin;
use nastic_fem::{Cavity, Instant, Solid, SolveOptions, State, StateError, Tendon, TimeStepping};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_numeric::vector::{norm, sub};

const MU: [f64; 3] = [1.0, 0.0, 10.0];

fn sphere(kind: CellKind, cells: usize, by_volume: bool) -> Outcome<Solid> {
    let room = Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-");
    Ok(Solid::new(shell(kind, cells)?)?
        .material("body", MooneyRivlin::new(MU[0], MU[1], MU[2])?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?
        .cavity(if by_volume { room.by_volume() } else { room })?)
}

/// What a cavity reports: pressure, volume, reference volume.
fn room(solid: &Solid, state: &State, name: &str) -> Outcome<[f64; 3]> {
    let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, state.load))?;
    let of = |what: &str| {
        let found = all.iter().find(|(room, quantity, _)| room == name && *quantity == what);
        found.map(|found| found.2).ok_or(format!("no {what} of {name} is reported"))
    };
    Ok([of("pressure")?, of("volume")?, of("reference_volume")?])
}

fn solve(solid: &Solid, values: &[f64], near: Option<&State>) -> Result<State, StateError> {
    let mut controls = solid.controls();
    values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k)[0] = *value);
    solid.solve(&controls, &SolveOptions { near, ..STRICT })
}

/// Against the radial boundary value problem, past the radius at which the pressure is largest: the state stays stable, though
/// under the pressure as a load it would not be. Pressure control finds the same states.
#[test]
fn a_thick_sphere_is_inflated_through_its_pressure_maximum() -> Outcome {
    for (kind, cells, tolerance) in [(CellKind::Hex20, 2, 8e-3), (CellKind::Hex20, 4, 1e-3), (CellKind::Tet10, 3, 8e-3)]
    {
        let (solid, by_pressure) = (sphere(kind, cells, true)?, sphere(kind, cells, false)?);
        let reference = room(&solid, &solid.rest(), "air")?[2];
        let (mut found, mut last): (Vec<(f64, f64)>, Option<State>) = (Vec::new(), None);
        for factor in [1.5, 3.0, 5.0, 8.0, 11.0, 15.0] {
            let wanted = factor * reference;
            let state = solve(&solid, &[wanted - reference], last.as_ref())?;
            let [p, volume, _] = room(&solid, &state, "air")?;
            assert!((volume / wanted - 1.0).abs() < 1e-10, "{kind}: {volume} instead of {wanted}");
            let radius = deformed_radius(&solid, &state.u, INNER);
            let exact = pressure(MU, radius, 2);
            println!(
                "{kind}, {cells}: V/V0 {factor}, r {radius:.4}, p {p:.6}, exact {exact:.6}, {} Newton",
                state.report.newton
            );
            assert!((p / exact - 1.0).abs() < tolerance, "{kind}: {p} instead of {exact} at r = {radius}");
            assert_eq!(solid.negative_pivots(&state)?, 0);
            let twin = State { u: solid.model().nodal(&state.u).to_vec().into(), ..by_pressure.rest() };
            let same =
                solve(&by_pressure, &[p], Some(&State { controls: pressure_of(&by_pressure, p), load: 1.0, ..twin }))?;
            let apart = largest(&sub(&same.u, solid.model().nodal(&state.u)));
            assert!(apart < 1e-8, "{kind}: pressure control differs by {apart:e}");
            let rises = found.last().is_none_or(|(before, _)| p > *before);
            let negative = by_pressure.negative_pivots(&same)?;
            // between 5 and 8 the maximum lies
            assert_eq!((rises, negative), if factor <= 5.0 { (true, 0) } else { (false, 1) }, "{kind} at {factor}");
            found.push((p, factor));
            last = Some(state);
        }
    }
    Ok(())
}

fn pressure_of(solid: &Solid, p: f64) -> std::sync::Arc<nastic_fem::Controls> {
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = p;
    controls.into()
}

/// A step from rest to a volume far behind the maximum, and one to less than the volume at rest.
#[test]
fn a_volume_is_reached_from_rest() -> Outcome {
    let solid = sphere(CellKind::Hex20, 2, true)?;
    let reference = room(&solid, &solid.rest(), "air")?[2];
    for factor in [0.8, 12.0] {
        let state = solve(&solid, &[(factor - 1.0) * reference], None)?;
        let [p, volume, _] = room(&solid, &state, "air")?;
        assert!((volume / (factor * reference) - 1.0).abs() < 1e-10 && p * (factor - 1.0) > 0.0, "{volume}, {p}");
        assert_eq!(solid.negative_pivots(&state)?, 0);
    }
    Ok(())
}

/// A box of 5 x 3 x 2 grid cells (5 x 2 in the plane) without two of its upper ones: the rooms "left" and "right", open at the top.
fn two_rooms(kind: CellKind, refined: usize) -> Outcome<Mesh> {
    let plane = kind.dim() == 2;
    let up = if plane { 1 } else { 2 };
    let (size, cells) = if plane {
        ([5.0, 2.0, 0.0], [5 * refined, 2 * refined, 1])
    } else {
        ([5.0, 3.0, 2.0], [5 * refined, 3 * refined, 2 * refined])
    };
    let full = regular(kind, size, cells)?;
    let missing = |c: [f64; 3]| {
        let side = [1.0, 3.0].into_iter().position(|low| c[0] > low && c[0] < low + 1.0);
        side.filter(|_| c[up] > 1.0 && (plane || (c[1] > 1.0 && c[1] < 2.0)))
    };
    let mut raw = RawMesh::new("two rooms");
    raw.points = full.points().to_vec();
    raw.name_group(kind.dim(), 9, "body");
    for (tag, name) in (1..).zip(["left", "right", "floor"]) {
        raw.name_group(kind.dim() - 1, tag, name);
    }
    for cell in 0..full.cells() {
        let (nodes, hole) = (full.cell(cell).nodes, missing(full.cell_centre(cell)));
        if hole.is_none() {
            raw.push(kind, nodes, &[9]);
        }
        for (face, local) in kind.faces() {
            let nodes: Vec<u32> = local.iter().map(|&a| nodes[a]).collect();
            let on = |axis: usize, at: f64| nodes.iter().all(|&n| (full.points()[n as usize][axis] - at).abs() < 1e-9);
            let across = (1..5).any(|x| on(0, f64::from(x)));
            let wall = across || on(up, 1.0) || (!plane && (on(1, 1.0) || on(1, 2.0)));
            match hole {
                Some(side) if wall => raw.push(*face, &nodes, &[side as i32 + 1]),
                None if on(up, 0.0) => raw.push(*face, &nodes, &[3]),
                _ => {}
            }
        }
    }
    Ok(Mesh::build(raw)?)
}

/// Rooms whose control is the added volume, by name.
fn body(kind: CellKind, refined: usize, by_volume: &[&str]) -> Outcome<Solid> {
    let mut solid =
        Solid::new(two_rooms(kind, refined)?)?.material("body", MooneyRivlin::new(1.0, 0.2, 2.0)?)?.clamp("floor")?;
    for name in ["left", "right"] {
        let room = Cavity::new(name, name).lid();
        solid = solid.cavity(if by_volume.contains(&name) { room.by_volume() } else { room })?;
    }
    Ok(solid)
}

/// `j = c . (u, p)`: by the adjoint of the bordered system, against the remainder of Taylor's formula, on two meshes; of one cavity
/// by volume and one by pressure, and of two by volume.
#[test]
fn the_derivative_by_the_added_volume_is_that_of_the_solutions() -> Outcome {
    let rooms: [&[&str]; 2] = [&["right"], &["left", "right"]];
    for ((kind, refined), by_volume) in
        [(CellKind::Hex8, 1), (CellKind::Hex8, 2), (CellKind::Quad9, 1), (CellKind::Tet10, 1)]
            .into_iter()
            .flat_map(|mesh| rooms.map(|rooms| (mesh, rooms)))
    {
        let solid = body(kind, refined, by_volume)?;
        let at = if by_volume.len() == 2 { [-0.1, 0.3] } else { [0.15, 0.3] };
        let state = solve(&solid, &at, None)?;
        let mut cost: Vec<f64> = (0..state.u.len()).map(noise).collect();
        solid.supports().clear(&mut cost);
        let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
        let lambda = solid.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
        let slopes = solid.model().vjp(&Instant::new(&state.u, &state.controls, 1.0), &lambda)?.controls;
        let value = |m: [f64; 2]| -> Outcome<f64> {
            let u = solve(&solid, &m, Some(&state))?.u;
            Ok(u.iter().zip(&cost).map(|(u, c)| u * c).sum())
        };
        let direction = [0.7, -1.0];
        let slope: f64 = direction.iter().enumerate().map(|(k, d)| d * slopes.values(k)[0]).sum();
        let base = value(at)?;
        let remainder = |t: f64| -> Outcome<f64> {
            Ok((value([at[0] + t * direction[0], at[1] + t * direction[1]])? - base - t * slope).abs())
        };
        let order = (remainder(4e-3)? / remainder(1e-3)?).log2() / 2.0;
        println!("{kind} {refined}, {by_volume:?}: Taylor order {order:.4}, slope {slope:.4}");
        assert!(order > 1.95 && order < 2.05, "{kind} {refined}, {by_volume:?}: Taylor order {order}");
    }
    Ok(())
}

/// Two rooms by pressure, the same by volume, and one of each: the same state.
#[test]
fn volumes_and_pressures_lead_to_the_same_state() -> Outcome {
    let pressures = [0.3, 0.5];
    let reference = body(CellKind::Hex20, 1, &[])?;
    let state = solve(&reference, &pressures, None)?;
    assert!(largest(&state.u) > 0.1, "{:e}", largest(&state.u));
    let rooms = ["left", "right"];
    let mut added = [0.0; 2];
    for (added, name) in added.iter_mut().zip(rooms) {
        let [_, volume, at_rest] = room(&reference, &state, name)?;
        *added = volume - at_rest;
    }
    for by_volume in [&rooms[..1], &rooms[1..], &rooms[..]] {
        let solid = body(CellKind::Hex20, 1, by_volume)?;
        let values: Vec<f64> =
            (0..2).map(|k| if by_volume.contains(&rooms[k]) { added[k] } else { pressures[k] }).collect();
        let found = solve(&solid, &values, None)?;
        let apart = norm(&sub(solid.model().nodal(&found.u), &state.u)) / norm(&state.u);
        assert!(apart < 1e-9, "{by_volume:?}: {apart:e}");
        for (name, pressure) in rooms.iter().zip(pressures) {
            assert!((room(&solid, &found, name)?[0] / pressure - 1.0).abs() < 1e-9, "{by_volume:?}");
        }
        // The pressure is the derivative of the stored energy by the volume.
        assert_eq!(solid.negative_pivots(&found)?, 0);
    }
    Ok(())
}

/// Volumes beside tendons that cannot stretch, one taut and one slack: the pressures and the tension found, given, make the same state.
#[test]
fn volumes_go_with_tendons_that_cannot_stretch() -> Outcome {
    let tendon = |name: &str, y: f64| Tendon::through(name, [[0.0, y, 2.0], [2.5, y, 2.0], [5.0, y, 2.0]]).spacing(0.5);
    let held = body(CellKind::Hex8, 1, &["left", "right"])?
        .tendon(tendon("front", 0.5).inextensible())?
        .tendon(tendon("back", 2.5).inextensible())?;
    let state = solve(&held, &[-0.05, 0.2, 0.1, -0.5], None)?;
    let all = held.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
    let tension = |name: &str| all.iter().find(|(of, what, _)| of == name && *what == "tension").map(|found| found.2);
    let (front, back) = (tension("front").ok_or("no tension")?, tension("back").ok_or("no tension")?);
    let pressures = ["left", "right"].map(|name| room(&held, &state, name).map_or(f64::NAN, |found| found[0]));
    assert!(front > 0.01 && back == 0.0 && held.negative_pivots(&state)? == 0, "{front}, {back}");
    let driven = body(CellKind::Hex8, 1, &[])?.tendon(tendon("front", 0.5))?.tendon(tendon("back", 2.5))?;
    let same = solve(&driven, &[pressures[0], pressures[1], front, 0.0], None)?;
    let u = held.model().nodal(&state.u);
    let apart = norm(&sub(u, &same.u)) / norm(u);
    println!("{pressures:?}, {front}: {apart:.1e}, {} Newton", state.report.newton);
    assert!(apart < 1e-9, "{apart:e}");
    Ok(())
}

/// Prescribed displacements beside a volume, in one step.
#[test]
fn a_volume_goes_with_prescribed_displacements() -> Outcome {
    let solid = body(CellKind::Hex20, 1, &["right"])?.displace("left", [Some(0.0), Some(0.05), None])?;
    let state = solve(&solid, &[0.0, 0.2], None)?;
    let [_, volume, reference] = room(&solid, &state, "right")?;
    assert!((volume - reference - 0.2).abs() < 1e-10 && state.report.residual < 1e-11, "{volume}");
    Ok(())
}

#[test]
fn what_does_not_go_with_a_volume_is_refused() -> Outcome {
    let solid = sphere(CellKind::Hex8, 2, true)?;
    let error = solve(&solid, &[-1.0], None).err().ok_or("a negative volume is taken")?.to_string();
    assert!(error.contains("leaves none of its reference volume"), "{error}");
    let error = solve(&solid, &[1e6], None).err().ok_or("a volume of another unit is taken")?.to_string();
    assert!(error.contains("in another unit"), "{error}");
    // Two volumes of one room depend on each other: reported as that, not as an equilibrium that is hard to find.
    let twice =
        solid.clone().cavity(Cavity::new("again", "inner").symmetry("x-").symmetry("y-").symmetry("z-").by_volume())?;
    let error = solve(&twice, &[0.2, 0.2], None).err().ok_or("two volumes of one room")?.to_string();
    assert!(error.contains("two volumes of one room"), "{error}");
    let held = solid.displace("inner", [Some(0.0); 3])?;
    let error = held.check().err().ok_or("a volume that cannot change is taken")?.to_string();
    assert!(error.contains("control its pressure"), "{error}");
    Ok(())
}

/// A drop on a floor: every step is the projection of where it was, and fell to, on the shapes of its volume that do not enter the floor, `min 1/2 |x - x_n -
/// h^2 g|_M^2`; its law is all but nothing.
#[test]
fn a_drop_keeps_its_volume_and_spreads() -> Outcome {
    let (density, gravity, h) = (1000.0, 9.81, 0.01);
    for kind in [CellKind::Quad9, CellKind::Hex8] {
        let dim = kind.dim();
        let size = if dim == 2 { [0.02, 0.02, 0.0] } else { [0.02; 3] };
        let mut up = [0.0; 3];
        up[dim - 1] = 1.0;
        let floor = nastic_mesh::spatial::Obstacle::half_space(up.map(|n| -5e-4 * n), up);
        let solid = Solid::new(regular(kind, size, [4, 4, 4])?)?
            .material("body", nastic_energy::NeoHooke::new(5.0, 0.0)?)?
            .body_force("body", nastic_tensor::Vec3::from(up) * (-gravity * density))?
            .inertia(nastic_fem::Inertia::new("body", density))?
            .contact(nastic_fem::Contact::of("floor", "skin", floor).thickness(2e-4).stiffness(5e3))?
            .cavity(Cavity::new("own", "skin").filled().by_volume())?;
        let mut trajectory = nastic_fem::Trajectory::from_given(solid.rest());
        let steps = vec![nastic_fem::StepTo { dt: h, controls: solid.controls() }; 12];
        let scheme = nastic_fem::Scheme::quasi_dynamic();
        solid.model().advance(&mut trajectory, &scheme, &steps, &STRICT, &mut nastic_fem::Workspace::default())?;
        for state in trajectory.states() {
            let [_, volume, reference] = room(&solid, state, "own")?;
            assert!((volume / reference - 1.0).abs() < 1e-10, "{kind}: {volume} of {reference}");
        }
        let heights = |n: usize| -> Vec<f64> {
            let u = &trajectory.states()[n].u[..solid.discretization().dofs()];
            solid.mesh().points().iter().zip(u.chunks_exact(dim)).map(|(x, u)| x[dim - 1] + u[dim - 1]).collect()
        };
        let lowest = heights(12).into_iter().fold(f64::INFINITY, f64::min);
        let highest = heights(1).into_iter().fold(0.0, f64::max);
        assert!(lowest > -5.5e-4 && highest < size[0] - 0.5 * gravity * h * h, "{kind}: {lowest} {highest}");
        let [p, ..] = room(&solid, trajectory.end(), "own")?;
        assert!(p > 0.0, "{kind}: {p}");
        let wide = |state: &State| {
            let u = &state.u[..solid.discretization().dofs()];
            let x = solid.mesh().points().iter().zip(u.chunks_exact(dim)).map(|(x, u)| x[0] + u[0]);
            x.clone().fold(0.0, f64::max) - x.fold(1.0, f64::min)
        };
        assert!(wide(trajectory.end()) > 0.022, "{kind}: {}", wide(trajectory.end()));
    }
    assert!(
        Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
            .cavity(Cavity::new("own", "skin").filled().lid())
            .is_err()
    );
    Ok(())
}

/// A sealed box takes the same iterations, and has the same volume and pressure, wherever it stands.
#[test]
fn a_chamber_far_away_is_that_at_the_origin() -> Outcome {
    let at = |place: f64| -> Outcome<[f64; 3]> {
        let mesh = regular(CellKind::Hex20, [40.0, 20.0, 20.0], [2, 1, 1])?.mapped(|x| x.map(|x| x + place))?;
        let solid = Solid::new(mesh)?
            .material("body", MooneyRivlin::new(0.02, 0.015, 0.3)?)?
            .clamp("x-")?
            .cavity(Cavity::new("sealed", "skin").filled().by_volume())?;
        let state = solve(&solid, &[500.0], None)?;
        let [pressure, volume, _] = room(&solid, &state, "sealed")?;
        Ok([volume, pressure, state.report.newton as f64])
    };
    let [volume, pressure, newton] = at(0.0)?;
    for place in [1e3, 1e6] {
        let far = at(place)?;
        let off = |found: f64, expected: f64| (found / expected - 1.0).abs();
        assert!(off(far[0], volume) < 1e-9 && off(far[1], pressure) < 1e-8, "{place}: {far:?}, {volume} {pressure}");
        assert!((far[2] - newton).abs() <= 2.0, "{place}: {} iterations, {newton}", far[2]);
    }
    Ok(())
}
