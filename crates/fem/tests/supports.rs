//! Problems that cannot be solved are refused before anything is computed, with the reason.

#![allow(clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, node_at, regular, set_name, unit, with_node_sets};
use nastic_energy::{EnergyError, FiberTension, Field, MooneyRivlin, Turgor};
use nastic_fem::{FemError, Solid, SolveOptions, StateError};
use nastic_mesh::{CellKind, Mesh, MeshError, RawMesh};
use nastic_tensor::Vec3;

const X: [Option<f64>; 3] = [Some(0.0), None, None];
const Y: [Option<f64>; 3] = [None, Some(0.0), None];
const Z: [Option<f64>; 3] = [None, None, Some(0.0)];

fn law() -> Outcome<MooneyRivlin> {
    Ok(MooneyRivlin::new(1e5, 2e4, 1e6)?)
}

fn body(mesh: Mesh) -> Outcome<Solid> {
    Ok(Solid::new(mesh)?.material("body", law()?)?)
}

fn cube() -> Outcome<Solid> {
    body(unit(CellKind::Hex8, 2)?)
}

fn square() -> Outcome<Solid> {
    body(unit(CellKind::Quad4, 2)?)
}

/// A grid with some corners as node sets.
fn with_corners(kind: CellKind, corners: &[[f64; 3]]) -> Outcome<(Solid, Vec<String>)> {
    let mesh = unit(kind, 2)?;
    let find = |&x: &[f64; 3]| node_at(&mesh, x).map(|node| node as u32).ok_or("no such corner");
    let nodes: Vec<u32> = corners.iter().map(find).collect::<Result<_, _>>()?;
    let solid = body(with_node_sets(&mesh, &nodes)?)?;
    Ok((solid, nodes.iter().map(|&node| set_name(node)).collect()))
}

/// How many rigid motions are free, of what, and an example; none for a body that is held.
fn free(solid: &Solid) -> (usize, String, String) {
    match solid.check() {
        Ok(()) => (0, String::new(), String::new()),
        Err(FemError::RigidMotion { free, what, example }) => (free, what, example),
        Err(other) => panic!("{other}"),
    }
}

fn assert_free(solid: &Solid, expected: usize, example: &str) {
    let (count, what, found) = free(solid);
    assert_eq!((count, what.as_str()), (expected, "the body"), "{found}");
    assert!(found.contains(example), "{found} where {example} is free");
}

#[test]
fn a_body_without_supports_moves_as_it_likes() -> Outcome {
    assert_free(&cube()?, 6, "");
    assert_free(&square()?, 3, "");
    let error = cube()?.solve(&cube()?.controls(), &SolveOptions::default()).err().ok_or("a free body was solved")?;
    assert!(matches!(error, StateError::Problem(FemError::RigidMotion { free: 6, .. })), "{error}");
    assert!(error.to_string().contains("fix more components or clamp a surface"), "{error}");
    Ok(())
}

#[test]
fn a_clamped_surface_holds() -> Outcome {
    assert_eq!(free(&cube()?.clamp("z+")?).0, 0);
    assert_eq!(free(&square()?.clamp("y-")?).0, 0);
    Ok(())
}

#[test]
fn a_clamp_that_leaves_one_component_out_lets_it_shift() -> Outcome {
    assert_free(&cube()?.displace("x-", [Some(0.0), Some(0.0), None])?, 1, "shift along z");
    // and what slides along x also tilts about y and z
    assert_free(&cube()?.displace("x-", [None, Some(0.0), Some(0.0)])?, 3, "");
    assert_free(&square()?.displace("x-", X)?, 1, "shift along y");
    Ok(())
}

#[test]
fn rollers_hold_when_each_axis_has_one() -> Outcome {
    let rollers = cube()?.displace("x-", X)?.displace("y-", Y)?;
    assert_free(&rollers, 1, "shift along z");
    assert_eq!(free(&rollers.displace("z+", Z)?).0, 0);
    assert_free(&cube()?.displace("x-", X)?.displace("x+", X)?, 3, "");
    assert_free(&cube()?.displace("x-", Y)?.displace("y-", Y)?, 3, "");
    assert_eq!(free(&square()?.displace("x-", X)?.displace("y-", Y)?).0, 0);
    assert_free(&square()?.displace("x-", X)?.displace("x+", X)?, 1, "shift along y");
    Ok(())
}

/// No roller stands on the side it holds, yet together they hold the square.
#[test]
fn rollers_along_the_sides_stop_shifts_and_rotation() -> Outcome {
    // up and down at the left and right
    let sides = ["x-", "x+"].iter().try_fold(square()?, |solid, side| solid.displace(side, Y))?;
    assert_free(&sides, 1, "shift along x");
    assert_eq!(free(&["y-", "y+"].iter().try_fold(sides, |solid, side| solid.displace(side, X))?).0, 0);
    Ok(())
}

#[test]
fn pins_leave_the_rotation_about_their_line() -> Outcome {
    let (solid, names) = with_corners(CellKind::Hex8, &[[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0]])?;
    let one = solid.clamp(&names[0])?;
    assert_free(&one, 3, "");
    let two = one.clamp(&names[1])?;
    assert_free(&two, 1, "");
    assert_eq!(free(&two.clamp(&names[2])?).0, 0);
    let (solid, names) = with_corners(CellKind::Tri3, &[[1.0, 1.0, 0.0], [0.0; 3]])?;
    let one = solid.clamp(&names[0])?;
    assert_free(&one, 1, "");
    // a second pin need only stop the turning: along the line of the two it does nothing
    assert_eq!(free(&one.displace(&names[1], Y)?).0, 0);
    Ok(())
}

/// Small faces far from the centre hold a slender bar as well as large ones hold a cube, in any unit of length.
#[test]
fn slender_bodies_of_any_size_are_held_by_their_ends() -> Outcome {
    for scale in [1e-6, 1.0, 1e6] {
        let bar = body(regular(CellKind::Hex8, [scale, 1e-3 * scale, 1e-3 * scale], [20, 1, 1])?)?;
        assert_eq!(free(&bar.clamp("x-")?).0, 0);
        let strip = body(regular(CellKind::Quad8, [scale, 1e-3 * scale, 0.0], [20, 1, 1])?)?;
        assert_eq!(free(&strip.clamp("x-")?).0, 0);
    }
    Ok(())
}

/// Two cubes that touch nowhere, each a region with a surface.
fn two_cubes() -> Outcome<Solid> {
    let cube = unit(CellKind::Hex8, 1)?;
    let mut raw = RawMesh::new("pair");
    for (tag, shift) in [(1, 0.0), (2, 3.0)] {
        let first = raw.points.len() as u32;
        raw.points.extend(cube.points().iter().map(|[x, y, z]| [x + shift, *y, *z]));
        let nodes: Vec<u32> = cube.cell(0).nodes.iter().map(|node| node + first).collect();
        raw.push(CellKind::Hex8, &nodes, &[tag]);
        raw.name_group(3, tag, format!("cube {tag}"));
        let (kind, face) = cube.facet_nodes(cube.surface("x-")?[0]);
        raw.push(kind, &face.iter().map(|node| node + first).collect::<Vec<_>>(), &[tag]);
        raw.name_group(2, tag, format!("wall {tag}"));
    }
    Ok(Solid::new(Mesh::build(raw)?)?)
}

#[test]
fn every_part_of_a_body_needs_its_own_supports() -> Outcome {
    let solid = two_cubes()?.material("cube 1", law()?)?.material("cube 2", law()?)?.clamp("wall 1")?;
    let (count, what, _) = free(&solid);
    assert_eq!(count, 6);
    assert!(what.contains("connected part 2 of 2") && what.contains("node 8"), "{what}");
    assert_eq!(free(&solid.clamp("wall 2")?).0, 0);
    Ok(())
}

#[test]
fn cells_without_material_are_counted_and_named() -> Outcome {
    let solid = two_cubes()?.material("cube 1", law()?)?.clamp("wall 1")?.clamp("wall 2")?;
    let error =
        solid.solve(&solid.controls(), &SolveOptions::default()).err().ok_or("a body without material was solved")?;
    let StateError::Problem(FemError::NoMaterial { mesh, count, first, regions }) = error else { panic!("{error}") };
    assert_eq!((mesh.as_str(), count, first, regions.as_str()), ("pair", 1, 1, "cube 1, cube 2"));
    // an actuation is no material
    let driven = two_cubes()?.actuate("cube 1", "m", Turgor::new())?.actuate("cube 2", "n", Turgor::new())?;
    assert!(matches!(driven.check(), Err(FemError::NoMaterial { count: 2, first: 0, .. })));
    Ok(())
}

#[test]
fn supports_that_contradict_each_other_are_refused() -> Outcome {
    let solid = square()?.displace("x-", [Some(0.0), Some(0.25), None])?;
    assert!(solid.clone().displace("y-", [Some(0.0), None, None]).is_ok());
    let corner = node_at(solid.mesh(), [0.0; 3]).ok_or("no corner")?;
    let error = solid.displace("y-", [None, Some(-0.5), None]).err().ok_or("the conflict went unnoticed")?;
    let FemError::SupportConflict { support, node, component, old, new } = error else { panic!("{error}") };
    assert_eq!((support.as_str(), node, component.as_str(), old, new), ("y-", corner, "y", 0.25, -0.5));
    Ok(())
}

#[test]
fn unknown_names_are_told_with_the_known_ones() -> Outcome {
    let message = |result: Result<Solid, FemError>, what: &str, near: &str| match result.err() {
        Some(FemError::Mesh(error @ MeshError::UnknownName { .. })) => {
            let text = error.to_string();
            assert!(text.contains(what) && text.contains(near), "{text}");
        }
        other => panic!("{other:?}"),
    };
    message(cube()?.clamp("x_-"), "surface \"x_-\" not found in box", "Did you mean \"x-\"?");
    message(cube()?.traction("top", Vec3::x()), "surface \"top\"", "x+, x-, y+");
    message(cube()?.body_force("boddy", Vec3::x()), "region \"boddy\"", "Did you mean \"body\"?");
    message(cube()?.material("bodi", law()?), "region \"bodi\"", "Did you mean \"body\"?");
    message(cube()?.actuate("b", "m", Turgor::new()), "region \"b\"", "it has: body");
    Ok(())
}

#[test]
fn two_actuations_of_one_name_are_refused() -> Outcome {
    let solid = cube()?.actuate("body", "m", Turgor::new())?;
    let error = solid.actuate("body", "m", FiberTension::along(Vec3::x())?).err().ok_or("the name was taken")?;
    assert!(error.to_string().contains("two actuations named \"m\""), "{error}");
    Ok(())
}

#[test]
fn a_plane_body_has_no_z() -> Outcome {
    let meaningless = |result: Result<Solid, FemError>, what: &str| match result.err() {
        Some(error @ FemError::Meaningless { .. }) => assert!(error.to_string().contains(what), "{error}"),
        other => panic!("{other:?}"),
    };
    meaningless(square()?.displace("x-", [None, None, Some(0.1)]), "component z");
    meaningless(square()?.traction("x-", Vec3::z()), "traction on \"x-\" has a z component");
    meaningless(square()?.body_force("body", Vec3::z()), "body force on \"body\" has a z component");
    // what plane strain prescribes anyway
    assert!(square()?.displace("x-", Z).is_ok());
    Ok(())
}

#[test]
fn numbers_that_are_none_are_refused() -> Outcome {
    let not_finite = |result: Result<Solid, FemError>, what: &str| match result.err() {
        Some(error @ FemError::NotFinite { .. }) => assert!(error.to_string().contains(what), "{error}"),
        other => panic!("{other:?}"),
    };
    not_finite(cube()?.displace("x-", [Some(f64::NAN), None, None]), "displacement prescribed on \"x-\" is not finite");
    not_finite(cube()?.traction("x+", Vec3::new(0.0, f64::INFINITY, 0.0)), "(entry 1 is inf)");
    not_finite(cube()?.body_force("body", Vec3::new(0.0, 0.0, f64::NAN)), "(entry 2 is NaN)");
    let mut force = vec![0.0; 81];
    force[7] = f64::NEG_INFINITY;
    not_finite(cube()?.nodal_force(&force), "nodal force is not finite (entry 7 is -inf)");
    Ok(())
}

#[test]
fn arrays_of_the_wrong_length_are_refused() -> Outcome {
    let error = cube()?.nodal_force(&[0.0; 80]).err().ok_or("80 entries passed for 81")?;
    assert!(matches!(error, FemError::Length { found: 80, expected: 81, .. }), "{error}");
    let modulus = Field::cells(vec![1e5; 7]);
    let error = Solid::new(unit(CellKind::Hex8, 2)?)?.material("body", MooneyRivlin::new(modulus, 2e4, 1e6)?).err();
    let found = matches!(&error, Some(FemError::Energy(EnergyError::Length { expected: 8, found: 7, .. })));
    assert!(found, "{error:?}");
    let solid = cube()?.actuate("body", "m", Turgor::new())?;
    let error = solid.controls().set(0, 0, &[1.0; 63]).err().ok_or("63 values passed for 64 points")?;
    assert!(matches!(error, FemError::Length { found: 63, expected: 64, .. }), "{error}");
    Ok(())
}

#[test]
fn controls_are_checked_before_a_solve() -> Outcome {
    let solid = cube()?.clamp("x-")?.actuate("body", "swelling", Turgor::new())?;
    let mut controls = solid.controls();
    controls.values_mut(0)[5] = f64::NAN;
    let error = solid.solve(&controls, &SolveOptions::default()).err().ok_or("NaN was solved")?;
    assert!(matches!(error, StateError::Problem(FemError::NotFinite { index: 5, .. })), "{error}");
    assert!(error.to_string().contains("\"swelling\""), "{error}");
    let error =
        solid.solve(&cube()?.controls(), &SolveOptions::default()).err().ok_or("foreign controls were taken")?;
    assert!(matches!(error, StateError::Problem(FemError::Meaningless { .. })), "{error}");
    Ok(())
}

/// Cells hang together whatever the order of their nodes.
#[test]
fn one_body_is_one_part_however_its_nodes_are_numbered() -> Outcome {
    let ordered = regular(CellKind::Hex8, [3.0, 3.0, 1.0], [3, 3, 1])?;
    let count = ordered.points().len();
    for seed in 0..20 {
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&a, &b| common::noise(seed * count + a).total_cmp(&common::noise(seed * count + b)));
        let mut raw = RawMesh::new("scrambled");
        raw.points = order.iter().map(|&node| ordered.points()[node]).collect();
        let mut number = vec![0; count];
        order.iter().enumerate().for_each(|(new, &old)| number[old] = new as u32);
        for cell in ordered.blocks()[0].iter() {
            let nodes: Vec<u32> = cell.iter().map(|&node| number[node as usize]).collect();
            raw.push(CellKind::Hex8, &nodes, &[1]);
        }
        raw.name_group(3, 1, "body");
        raw.name_group(2, 2, "held");
        for &facet in ordered.surface("x-")? {
            let (kind, nodes) = ordered.facet_nodes(facet);
            let nodes: Vec<u32> = nodes.iter().map(|&node| number[node as usize]).collect();
            raw.push(kind, &nodes, &[2]);
        }
        let solid = body(Mesh::build(raw)?)?;
        assert_eq!(free(&solid.clamp("held")?), (0, String::new(), String::new()), "seed {seed}");
    }
    Ok(())
}
