//! Cavities: volumes, the thick sphere and cylinder under inner pressure, the derivative by the pressure, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::shells::{Drive, INNER, OUTER, deformed_radius, radii, ring, shell};
use common::{Outcome, largest, noise, regular};
use nastic_energy::{EnergyTerm, MooneyRivlin, NeoHooke};
use nastic_fem::{Cavity, Controls, Demand, Instant, Solid, SolveOptions, check_contribution};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::{Mat3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A box of 3 x 3 x 2 grid cells (3 x 2 in the plane) without the one above the middle of its floor: a cup, open at the top.
/// With `half`, only what lies on the side y > 1.5 (x > 1.5), whose cut is the surface "cut".
fn cup(kind: CellKind, half: bool) -> Outcome<Mesh> {
    let plane = kind.dim() == 2;
    let (size, cells) = if plane { ([3.0, 2.0, 0.0], [6, 2, 1]) } else { ([3.0, 3.0, 2.0], [3, 6, 2]) };
    let full = regular(kind, size, cells)?;
    let up = if plane { 1 } else { 2 };
    let cut = if plane { 0 } else { 1 };
    let within = |x: f64| x > 1.0 && x < 2.0;
    let missing = |c: [f64; 3]| within(c[0]) && c[up] > 1.0 && (plane || within(c[1]));
    let there = |c: [f64; 3]| !missing(c) && (!half || c[cut] > 1.5);
    let mut raw = RawMesh::new("cup");
    raw.points = full.points().to_vec();
    raw.name_group(kind.dim(), 9, "body");
    let facet_dim = kind.dim() - 1;
    for (tag, name) in [(1, "inside"), (2, "floor"), (3, "cut")] {
        raw.name_group(facet_dim, tag, name);
    }
    for cell in 0..full.cells() {
        let nodes = full.cell(cell).nodes;
        if there(full.cell_centre(cell)) {
            raw.push(kind, nodes, &[9]);
        }
        for (face, local) in kind.faces() {
            let nodes: Vec<u32> = local.iter().map(|&a| nodes[a]).collect();
            let centre =
                (0..3).map(|k| nodes.iter().map(|&n| full.points()[n as usize][k]).sum::<f64>() / nodes.len() as f64);
            let centre: Vec<f64> = centre.collect();
            let on = |axis: usize, at: f64| nodes.iter().all(|&n| (full.points()[n as usize][axis] - at).abs() < 1e-9);
            let wall = on(0, 1.0) || on(0, 2.0) || on(up, 1.0) || (!plane && (on(1, 1.0) || on(1, 2.0)));
            let of_hole = missing(full.cell_centre(cell)) && wall && centre[up] < 2.0;
            if of_hole && (!half || centre[cut] > 1.5) {
                raw.push(*face, &nodes, &[1]);
            } else if there(full.cell_centre(cell)) && on(up, 0.0) {
                raw.push(*face, &nodes, &[2]);
            } else if half && there(full.cell_centre(cell)) && on(cut, 1.5) {
                raw.push(*face, &nodes, &[3]);
            }
        }
    }
    Ok(Mesh::build(raw)?)
}

fn solids() -> impl Iterator<Item = CellKind> {
    common::kinds()
}

fn volume(solid: &Solid, u: &[f64]) -> Outcome<f64> {
    let controls = solid.controls();
    let all = solid.model().quantities(&Instant::new(u, &controls, 1.0))?;
    let found = all.iter().find(|(name, quantity, _)| name == "air" && *quantity == "volume");
    Ok(found.ok_or("no volume is reported")?.2)
}

/// An affine map takes the cup's room to `det F` times its volume, the lid included, whatever the elements; half of it with a
/// plane of symmetry is a half.
#[test]
fn volumes_of_a_cup_are_exact() -> Outcome {
    for kind in solids() {
        for half in [false, true] {
            let spec = Cavity::new("air", "inside").lid();
            let spec = if half { spec.symmetry("cut") } else { spec };
            let solid = Solid::new(cup(kind, half)?)?.cavity(spec)?;
            let expected = if half { 0.5 } else { 1.0 };
            let rest = volume(&solid, &solid.rest().u)?;
            assert!((rest - expected).abs() < 1e-12, "{kind}, half {half}: {rest}");
            let mut f = Mat3::new(1.1, 0.2, 0.1, -0.1, 0.9, 0.3, 0.2, -0.2, 1.3);
            if kind.dim() == 2 {
                f = Mat3::new(1.1, 0.2, 0.0, -0.1, 0.9, 0.0, 0.0, 0.0, 1.0);
            }
            if half {
                // a map that keeps the plane in its place and is its own mirror image
                let cut = if kind.dim() == 2 { 0 } else { 1 };
                f.row_mut(cut).fill(0.0);
                f.column_mut(cut).fill(0.0);
                f[(cut, cut)] = 0.9;
            }
            let dim = kind.dim();
            let shift = |x: &[f64; 3]| {
                let from = if half { [1.5, 1.5, 0.0] } else { [0.0; 3] };
                let x = Vec3::from(*x) - Vec3::from(if dim == 2 { [from[0], 0.0, 0.0] } else { [0.0, from[1], 0.0] });
                (f * x - x).as_slice()[..dim].to_vec()
            };
            let u: Vec<f64> = solid.mesh().points().iter().flat_map(shift).collect();
            let moved = volume(&solid, &u)?;
            assert!((moved - expected * f.determinant()).abs() < 1e-12, "{kind}, half {half}: {moved}");
        }
    }
    Ok(())
}

/// Curved walls: the room of a hollow sphere, to the order of its elements.
#[test]
fn the_room_of_a_hollow_sphere_is_found() -> Outcome {
    let eighth = PI / 6.0 * INNER.powi(3);
    for (kind, tolerance) in
        [(CellKind::Hex8, 4e-2), (CellKind::Hex20, 4e-4), (CellKind::Hex27, 2e-4), (CellKind::Tet10, 6e-4)]
    {
        let solid = sphere(shell(kind, 3)?, NeoHooke::new(1.0, 2.0)?)?;
        let found = volume(&solid, &solid.rest().u)?;
        assert!((found / eighth - 1.0).abs() < tolerance, "{kind}: {found} instead of {eighth}");
    }
    Ok(())
}

fn sphere(mesh: Mesh, law: impl EnergyTerm + 'static) -> Outcome<Solid> {
    Ok(Solid::new(mesh)?
        .material("body", law)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?
        .cavity(Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-"))?)
}

/// Largest error of inner and outer radius under a pressure, and the volume it encloses beside that of the exact sphere.
fn error(solid: &Solid, mu: [f64; 3], p: f64, hoops: i32) -> Outcome<(f64, f64)> {
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = p;
    let state = solid.solve(&controls, &STRICT)?;
    let [inner, _, outer] = radii(Drive { mu, p, follower: true, m: 0.0 }, hoops);
    assert!(inner > 1.15 * INNER, "the pressure hardly inflates it: {inner}");
    let off = |(at, r): (f64, f64)| (deformed_radius(solid, &state.u, at) - r).abs();
    let room = if hoops == 2 { PI / 6.0 * inner.powi(3) } else { 0.25 * PI * inner.powi(2) };
    assert_eq!(solid.negative_pivots(&state)?, 0);
    Ok((off((INNER, inner)).max(off((OUTER, outer))), (volume(solid, &state.u)? / room - 1.0).abs()))
}

/// Against the radial boundary value problem with `P_R = -p (r/R)^2` inside; errors fall with the element's order.
#[test]
fn a_thick_sphere_under_pressure_is_that_of_its_radial_equation() -> Outcome {
    for (law, mu, p) in [("neo-Hookean", [0.5, 0.0, 1.0], 0.5), ("Mooney-Rivlin", [1.0, 0.2, 5.0], 1.8)] {
        for (kind, order, tolerance) in [
            (CellKind::Hex8, 1.8, 3e-2),
            (CellKind::Hex20, 3.0, 1e-4),
            (CellKind::Hex27, 3.2, 1e-4),
            (CellKind::Tet10, 3.0, 1e-3),
        ] {
            let run = |cells: usize| -> Outcome<(f64, f64)> {
                let term: Arc<dyn EnergyTerm> = match law {
                    "neo-Hookean" => Arc::new(NeoHooke::new(2.0 * mu[0], 2.0 * mu[2])?),
                    _ => Arc::new(MooneyRivlin::new(mu[0], mu[1], mu[2])?),
                };
                let solid = Solid::new(shell(kind, cells)?)?
                    .material("body", term)?
                    .displace("x-", [Some(0.0), None, None])?
                    .displace("y-", [None, Some(0.0), None])?
                    .displace("z-", [None, None, Some(0.0)])?
                    .cavity(Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-"))?;
                error(&solid, mu, p, 2)
            };
            let (coarse, fine) = (run(2)?, run(4)?);
            let found = (coarse.0 / fine.0).log2();
            println!("{law}, {kind}: errors {:.2e} {:.2e}, order {found:.2}, volume {:.1e}", coarse.0, fine.0, fine.1);
            assert!(found > order && fine.0 < tolerance, "{law}, {kind}: {coarse:?}, {fine:?}, order {found:.2}");
        }
    }
    Ok(())
}

#[test]
fn a_thick_cylinder_under_pressure_is_that_of_its_radial_equation() -> Outcome {
    let mu = [1.0, 0.2, 5.0];
    for (kind, tolerance) in [(CellKind::Quad8, 5e-7), (CellKind::Quad9, 5e-7), (CellKind::Tri6, 1e-5)] {
        let solid = Solid::new(ring(kind, 8)?)?
            .material("body", MooneyRivlin::new(mu[0], mu[1], mu[2])?)?
            .displace("y-", [None, Some(0.0), None])?
            .displace("y+", [Some(0.0), None, None])?
            .cavity(Cavity::new("air", "x-").symmetry("y-").symmetry("y+"))?;
        let (radius, volume) = error(&solid, mu, 1.2, 1)?;
        assert!(radius < tolerance && volume < 10.0 * tolerance, "{kind}: {radius:e}, {volume:e}");
    }
    Ok(())
}

/// The volume counts on a rim that stays in its plane.
#[test]
fn a_plane_of_symmetry_that_is_not_held_is_refused() -> Outcome {
    let solid = Solid::new(ring(CellKind::Quad8, 4)?)?
        .material("body", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
        .clamp("x+")?
        .displace("y-", [None, Some(0.0), None])?
        .cavity(Cavity::new("air", "x-").symmetry("y-").symmetry("y+"))?;
    let error = solid.check().err().ok_or("it is taken")?.to_string();
    assert!(error.contains("plane of symmetry across x"), "{error}");
    assert!(solid.solve(&solid.controls(), &STRICT).is_err());
    solid.displace("y+", [Some(0.0), None, None])?.check()?;
    Ok(())
}

/// Pressure on the lid loads the rim: the cup's floor, held, takes up nothing in sum.
#[test]
fn a_closed_room_exerts_no_force_in_sum() -> Outcome {
    let solid = Solid::new(cup(CellKind::Hex20, false)?)?
        .material("body", NeoHooke::new(1e5, 2e5)?)?
        .clamp("floor")?
        .cavity(Cavity::new("air", "inside").lid())?;
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = 4e3;
    let state = solid.solve(&controls, &STRICT)?;
    assert!(largest(&state.u) > 1e-2, "{:e}", largest(&state.u));
    let force = solid.body().evaluate(&state.u, &controls, true, true)?.force;
    for (_, reaction) in solid.supports().reactions(&force) {
        assert!(reaction.iter().all(|r| r.abs() < 1e-6 * 4e3), "{reaction:?}");
    }
    Ok(())
}

/// `dj/dp` of `j = c . u(p)` by the adjoint: against differences, and the remainder of Taylor's formula falls with order 2.
#[test]
fn the_derivative_by_the_pressure_is_that_of_the_solutions() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Quad9, CellKind::Hex27] {
        let solid = Solid::new(cup(kind, false)?)?
            .material("body", MooneyRivlin::new(1e5, 2e4, 2e5)?)?
            .clamp("floor")?
            .cavity(Cavity::new("air", "inside").lid())?;
        let at = |p: f64| -> Outcome<_> {
            let mut controls = solid.controls();
            controls.values_mut(0)[0] = p;
            Ok(controls)
        };
        let state = solid.solve(&at(1e4)?, &STRICT)?;
        let mut cost: Vec<f64> = (0..state.u.len()).map(noise).collect();
        solid.supports().clear(&mut cost);
        let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
        let lambda = solid.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
        let sensitivities = solid.model().vjp(&Instant::new(&state.u, &state.controls, 1.0), &lambda)?;
        let slope = sensitivities.controls.values(0)[0];
        let value = |p: f64| -> Outcome<f64> {
            let u = solid.solve(&at(p)?, &SolveOptions { near: Some(&state), ..STRICT })?.u;
            Ok(u.iter().zip(&cost).map(|(u, c)| u * c).sum())
        };
        let base = value(1e4)?;
        let remainder = |t: f64| -> Outcome<f64> { Ok((value(1e4 + t)? - base - t * slope).abs()) };
        let order = (remainder(1e3)? / remainder(2.5e2)?).log2() / 2.0;
        println!("{kind}: Taylor order {order:.4}");
        assert!((order - 2.0).abs() < 0.05, "{kind}: Taylor order {order}");
        let expected = (value(1.01e4)? - value(0.99e4)?) / 200.0;
        assert!((slope / expected - 1.0).abs() < 1e-4, "{kind}: {slope:e} where differences give {expected:e}");
    }
    Ok(())
}

#[test]
fn rooms_that_are_none_are_refused() -> Outcome {
    let solid = Solid::new(cup(CellKind::Hex8, false)?)?;
    let message = |spec: Cavity, word: &str| {
        let error = solid.clone().cavity(spec).err().unwrap_or_else(|| panic!("{word}: it is taken")).to_string();
        assert!(error.contains(word), "{error}");
    };
    message(Cavity::new("air", "inside"), "lid");
    message(Cavity::new("air", "insdie"), "inside");
    message(Cavity::new("air", "inside").symmetry("inside"), "plane");
    message(Cavity::new("air", "floor").lid(), "encloses no cavity");
    let tube = Solid::new(regular(CellKind::Hex8, [1.0; 3], [2; 3])?)?;
    let both = tube.cavity(Cavity::new("air", "x-").symmetry("z-").symmetry("z+").lid());
    assert!(both.err().is_some_and(|error| error.to_string().contains("two parallel planes")));
    let twice = solid.cavity(Cavity::new("air", "inside").lid())?.cavity(Cavity::new("air", "inside").lid());
    assert!(twice.is_err(), "two cavities of one name");
    let shell = |x: f64| -> Outcome<Solid> {
        Ok(Solid::new(shell(CellKind::Hex8, 2)?)?
            .material("body", NeoHooke::new(1e5, 2e5)?)?
            .displace("x-", [Some(x), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .displace("z-", [None, None, Some(0.0)])?
            .cavity(Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-"))?)
    };
    shell(0.0)?.check()?;
    let moved = shell(0.3)?.check().err().ok_or("a plane of symmetry that moves is taken")?.to_string();
    assert!(moved.contains("is moved out of it"), "{moved}");
    Ok(())
}

/// A plate that is held at its edge, under a follower pressure from below: at rest the load is that of a traction; the tangent is
/// symmetric (the contract), and a rim that is not held is refused.
#[test]
fn an_open_surface_with_a_held_rim_is_a_plate_under_pressure() -> Outcome {
    for kind in [CellKind::Hex20, CellKind::Quad8] {
        let low = if kind.dim() == 2 { "y-" } else { "z-" };
        let plate = || -> Outcome<Solid> {
            let mesh = regular(
                kind,
                [1.0, if kind.dim() == 2 { 0.1 } else { 1.0 }, 0.1],
                [4, if kind.dim() == 2 { 1 } else { 4 }, 1],
            )?;
            let mut solid = Solid::new(mesh)?.material("body", MooneyRivlin::new(1e5, 2e4, 2e5)?)?;
            for side in if kind.dim() == 2 { &["x-", "x+"][..] } else { &["x-", "x+", "y-", "y+"] } {
                solid = solid.clamp(*side)?;
            }
            Ok(solid)
        };
        let p = 2e3;
        let solid = plate()?.cavity(Cavity::new("air", low).open())?;
        check_contribution(solid.model(), "air", 3)?;
        let mut controls = solid.controls();
        controls.values_mut(0)[0] = p;
        let forces = |solid: &Solid, controls: &Controls| -> Outcome<Vec<f64>> {
            let at = Instant::new(&solid.rest().u, controls, 1.0).u.to_vec();
            let demand = Demand { energy: false, force: true };
            let mut force = solid.model().evaluate(&Instant::new(&at, controls, 1.0), demand)?.force;
            solid.supports().clear(&mut force);
            Ok(force)
        };
        let up = if kind.dim() == 2 { Vec3::new(0.0, p, 0.0) } else { Vec3::new(0.0, 0.0, p) };
        let pulled = plate()?.traction(low, up)?;
        let (found, expected) = (forces(&solid, &controls)?, forces(&pulled, &pulled.controls())?);
        let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12 * p && largest(&expected) > 1e-3 * p, "{kind}: {apart:e}");
        let state = solid.solve(&controls, &STRICT)?;
        let swept = solid.model().quantities(&Instant::new(&state.u, &controls, 1.0))?;
        assert!(swept.iter().any(|(_, what, value)| *what == "swept_volume" && *value > 1e-3), "{swept:?}");
        // The area vector of a surface is that of its rim, whatever it does between: 1 upwards.
        let axis = if kind.dim() == 2 { "force_y" } else { "force_z" };
        let force = swept.iter().find(|(_, what, _)| *what == axis).ok_or("no force is reported")?.2;
        assert!((force / p - 1.0).abs() < 1e-12, "{kind}: the pressure pushes with {force}");
        // A rim that slides within its plane: stretched in that, the plate is pushed across it alone, by the pressure times its area.
        let slides = |held: &[usize]| -> Outcome<Solid> {
            let mut solid = Solid::new(regular(
                kind,
                [1.0, if kind.dim() == 2 { 0.1 } else { 1.0 }, 0.1],
                [4, if kind.dim() == 2 { 1 } else { 4 }, 1],
            )?)?
            .material("body", MooneyRivlin::new(1e5, 2e4, 2e5)?)?;
            let mut nodes = solid.nodes_of(low)?;
            nodes.retain(|&node| {
                let x = solid.mesh().points()[node as usize];
                (0..kind.dim() - 1).any(|i| x[i] < 1e-9 || x[i] > 1.0 - 1e-9)
            });
            solid = solid.displace_nodes("rim", &nodes, |_, _| {
                std::array::from_fn(|i| (i < kind.dim() && held.contains(&i)).then_some(0.0))
            })?;
            Ok(solid.cavity(Cavity::new("air", low).open())?)
        };
        let across = kind.dim() - 1;
        let sliding = slides(&[across])?;
        check_contribution(sliding.model(), "air", 5)?;
        let mut u = sliding.rest().u.to_vec();
        for (node, x) in sliding.mesh().points().iter().enumerate() {
            (0..across).for_each(|i| u[kind.dim() * node + i] = [0.3, -0.2][i] * x[i] + 0.05 * x[(i + 1) % across]);
        }
        let mut controls = sliding.controls();
        controls.values_mut(0)[0] = p;
        let demand = Demand { energy: false, force: true };
        let zero = sliding.controls();
        let [with, without] = [&controls, &zero]
            .map(|controls| sliding.model().evaluate(&Instant::new(&u, controls, 1.0), demand).map(|sums| sums.force));
        let push: Vec<f64> = with?.iter().zip(&without?).map(|(a, b)| a - b).collect();
        let fixed = sliding.supports().fixed();
        let within =
            (0..push.len()).filter(|dof| dof % kind.dim() != across && !fixed[*dof]).map(|dof| push[dof].abs());
        assert!(within.fold(0.0, f64::max) < 1e-12 * p, "{kind}: the pressure pushes within the plane");
        if kind.dim() == 3 {
            assert!(
                slides(&[0])?.clamp("z+")?.check().is_err_and(|error| error.to_string().contains("across an axis"))
            );
        }
        let loose = Solid::new(regular(
            kind,
            [1.0, 1.0, if kind.dim() == 2 { 0.0 } else { 1.0 }],
            [2, 2, if kind.dim() == 2 { 1 } else { 2 }],
        )?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 2e5)?)?
        .clamp("x-")?
        .cavity(Cavity::new("air", low).open())?;
        let error = loose.check().err().ok_or("a rim that moves is taken")?.to_string();
        assert!(error.contains("of its rim may move along") && error.contains("lid"), "{error}");
        assert!(plate()?.cavity(Cavity::new("air", low).open().by_volume()).is_err());
        assert!(plate()?.cavity(Cavity::new("air", low).open().lid()).is_err());
    }
    Ok(())
}
