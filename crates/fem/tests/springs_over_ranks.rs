//! Springs whose ends are in different parts of a body over ranks, which are threads here, or at node sets: the equilibria and derivatives of one process.

use crate::common;

use common::parts::{how, on, part, valued};
use common::{Outcome, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{FemError, Solid, SolveOptions, Spring, StateError};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_team::Team;
use nastic_team::threads::{Faults, ThreadRank};
use nastic_tensor::Vec3;
use std::sync::Arc;

/// A mesh with the surfaces of a box, and the nodes at `x = 1/2` and `x = 1, z = 1/5` as sets.
fn with_sets(mesh: &Mesh, copies: &[f64]) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("bar");
    for (copy, shift) in (0..).zip(copies) {
        let first = copy * mesh.points().len() as u32;
        raw.points.extend(mesh.points().iter().map(|x| [x[0], x[1] + shift, x[2]]));
        let moved = |nodes: &[u32]| nodes.iter().map(|node| first + node).collect::<Vec<u32>>();
        for block in mesh.blocks() {
            block.iter().for_each(|cell| raw.push(block.kind, &moved(cell), &[1]));
        }
        // the other copies have no support
        for (tag, (_, facets)) in (1..).zip(mesh.surfaces()).filter(|_| copy == 0) {
            for &facet in facets {
                let (kind, nodes) = mesh.facet_nodes(facet);
                raw.push(kind, &moved(&nodes), &[tag]);
            }
        }
        for (node, x) in (0..).zip(mesh.points()) {
            let tags = [((x[0] - 0.5).abs() < 1e-9, 1), (x[0] > 0.999 && x[2] > 0.199, 2)];
            tags.iter().filter(|tag| tag.0).for_each(|tag| raw.vertices.push((first + node, tag.1)));
        }
    }
    (1..).zip(mesh.surfaces()).for_each(|(tag, (name, _))| raw.name_group(2, tag, name));
    raw.name_group(3, 1, "body");
    raw.name_group(0, 1, "middle");
    raw.name_group(0, 2, "tip");
    Ok(Mesh::build(raw)?)
}

/// Between far places, between a set and places of other parts, and from a set to the ground; tightened, and shorter than at rest.
fn springs() -> [Spring; 5] {
    [
        Spring::between("far", [0.07, 0.1, 0.13], [0.91, 0.13, 0.2], 3e3).rest_length(0.6),
        Spring::between("back", [0.97, 0.05, 0.1], "middle", 2e3),
        Spring::between("front", [0.05, 0.15, 0.1], "middle", 1e3).rest_length(0.4),
        Spring::to_ground("edge", "tip", [1.1, 0.1, -0.4], 1e3).rest_length(0.4),
        Spring::between("sets", "tip", "middle", 5e2).rest_length(0.0),
    ]
}

fn body(solid: Solid) -> Outcome<Solid> {
    let solid = solid
        .material("body", NeoHooke::new(1e5, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    springs().into_iter().try_fold(solid, |solid, spring| Ok(solid.spring(spring)?))
}

fn reaching(mesh: &Mesh, rank: &Arc<ThreadRank>, scattered: bool) -> Outcome<Solid> {
    let owners = match scattered {
        true => (0..mesh.cells()).map(|cell| ((7 * cell) % rank.size()) as u32).collect(),
        false => mesh.bisected(rank.size())?,
    };
    let sets: Vec<Vec<u32>> = springs().iter().map(|spring| spring.nodes(mesh)).collect::<Result<_, _>>()?;
    Ok(Solid::of_part(mesh.part_reaching(&owners, rank.rank() as u32, &sets)?, rank.clone())?)
}

#[test]
fn springs_across_parts_act_as_in_one_process() -> Outcome {
    for (kind, scattered) in [(CellKind::Hex8, false), (CellKind::Hex8, true), (CellKind::Tet10, true)] {
        let mesh = with_sets(&regular(kind, [1.0, 0.2, 0.2], [6, 2, 2])?, &[0.0])?;
        let serial = body(Solid::new(mesh.clone())?)?;
        let (j, slope, energy, expected) = valued(&serial, -1e4, &SolveOptions::default())?;
        let size = expected.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        for ranks in [1, 2, 3, 5] {
            let found = on(ranks, &Faults::default(), |rank| {
                let solid = body(reaching(&mesh, &rank, scattered)?)?;
                let part = solid.discretization().over_ranks().map(|(part, _)| part);
                let nodes = part.map(|part| part.nodes().to_vec()).ok_or("no part")?;
                let further = part.map_or(&[] as &[_], |part| part.further_nodes());
                let further: Vec<u32> = further.iter().map(|(node, _)| nodes[*node as usize]).collect();
                let here = valued(&solid, -1e4, &how())?;
                let [far, near] = [2e3, 1e3].map(|step| valued(&solid, -1e4 + step, &how()));
                Ok((here, [far?.0, near?.0], nodes, further))
            });
            let (mut reached, mut at_set) = (0, 0);
            for found in found {
                let ((own, own_slope, own_energy, u), [far, near], nodes, further) = found?;
                reached += further.len();
                at_set += usize::from(further.contains(&mesh.node_set("middle")?[0]));
                assert!((own - j).abs() < 1e-9 * j, "{kind} on {ranks}: {own:e} {j:e}");
                assert!((own_energy - energy).abs() < 1e-9 * energy.abs(), "{own_energy:e} {energy:e}");
                assert!((own_slope - slope).abs() < 1e-8 * slope.abs(), "{kind} on {ranks}: {own_slope:e} {slope:e}");
                let order = ((far - own - 2e3 * own_slope) / (near - own - 1e3 * own_slope)).log2();
                assert!(order > 1.95, "{kind} on {ranks}: Taylor remainders of order {order}");
                for (u, node) in u.chunks_exact(3).zip(nodes) {
                    let whole = &expected[3 * node as usize..];
                    assert!(u.iter().zip(whole).all(|(a, b)| (a - b).abs() < 1e-9 * size), "{kind} on {ranks}");
                }
            }
            assert!(scattered || (reached > 0) == (ranks > 1), "nodes without cells");
            assert!(scattered || (at_set >= 2) == (ranks > 2), "{at_set} parts reach the set of two springs");
        }
    }
    Ok(())
}

/// Beside a face between parts both sides have a place, to rounding: its nodes are those of one process, whichever rank has them.
#[test]
fn places_beside_a_face_between_parts_have_the_nodes_of_one_process() -> Outcome {
    let mesh = regular(CellKind::Hex8, [1.0, 0.2, 0.2], [2, 1, 1])?;
    for beside in [-1e-10, 1e-10] {
        let spring = Spring::between("wire", [0.2, 0.1, 0.1], [0.5 + beside, 0.1, 0.05], 2e3).rest_length(0.1);
        let held = |solid: Solid| -> Outcome<Solid> {
            let solid = solid.material("body", NeoHooke::new(1e5, 1e6)?)?;
            let solid = solid.actuate("body", "tension", FiberTension::along(Vec3::x())?)?.clamp("x-")?;
            Ok(solid.spring(spring.clone())?)
        };
        let (j, _, energy, _) = valued(&held(Solid::new(mesh.clone())?)?, -1e4, &SolveOptions::default())?;
        let sets = [spring.nodes(&mesh)?];
        for owners in [[0, 1], [1, 0]] {
            let found = on(2, &Faults::default(), |rank| {
                let part = mesh.part_reaching(&owners, rank.rank() as u32, &sets)?;
                valued(&held(Solid::of_part(part, rank.clone())?)?, -1e4, &how())
            });
            for found in found {
                let (own, _, own_energy, _) = found?;
                assert!((own - j).abs() < 1e-9 * j, "{beside:e}, {owners:?}: {own:e} {j:e}");
                assert!((own_energy - energy).abs() < 1e-9 * energy.abs(), "{own_energy:e} {energy:e}");
            }
        }
    }
    Ok(())
}

/// Two bars, the second of which springs to the ground at places and at a set of both hold.
fn held(solid: Solid, how_many: usize) -> Outcome<Solid> {
    let solid = solid.material("body", NeoHooke::new(1e5, 1e6)?)?.clamp("x-")?;
    let ground = |k: usize, from: [f64; 3]| {
        Spring::to_ground(&format!("wire {k}"), from, [from[0] + 0.1, from[1] + 0.2, from[2] - 0.3], 1e3)
    };
    let places = [[0.03, 1.0, 0.0], [0.9, 1.1, 0.2], [0.4, 1.2, 0.1]];
    let solid = solid.spring(Spring::to_ground("both", "tip", [1.2, 0.7, 0.7], 1e3).rest_length(0.0))?;
    places.iter().zip(0..how_many).try_fold(solid, |solid, (at, k)| Ok(solid.spring(ground(k, *at).rest_length(0.1))?))
}

#[test]
fn bodies_that_springs_at_sets_of_several_parts_hold_are_found_as_in_one_process() -> Outcome {
    let mesh = with_sets(&regular(CellKind::Hex8, [1.0, 0.2, 0.2], [4, 1, 1])?, &[0.0, 1.0])?;
    let free = |solid: &Solid| match solid.check() {
        Ok(()) => Ok(0),
        Err(FemError::RigidMotion { free, .. }) => Ok(free),
        Err(other) => Err(other),
    };
    for how_many in 0..=3 {
        let expected = free(&held(Solid::new(mesh.clone())?, how_many)?)?;
        let sets = [Spring::to_ground("both", "tip", [1.2, 0.7, 0.7], 1e3).nodes(&mesh)?];
        for ranks in [2, 3, 5] {
            let found = on(ranks, &Faults::default(), |rank| {
                let part = mesh.part_reaching(&mesh.bisected(rank.size())?, rank.rank() as u32, &sets)?;
                Ok(free(&held(Solid::of_part(part, rank.clone())?, how_many)?)?)
            });
            assert!(found.iter().all(|found| *found == Ok(expected)), "{how_many} on {ranks}: {found:?} {expected}");
        }
    }
    Ok(())
}

#[test]
fn springs_that_no_rank_has_or_that_are_none_are_refused_by_all() -> Outcome {
    let mesh = with_sets(&regular(CellKind::Hex8, [1.0, 0.2, 0.2], [6, 2, 2])?, &[0.0])?;
    let found = on(3, &Faults::default(), |rank| {
        let solid = part(&mesh, &rank)?.material("body", NeoHooke::new(1e5, 1e6)?)?.clamp("x-")?;
        let said = |spring: Spring| solid.clone().spring(spring).err().map(|error| error.to_string());
        let place = [0.1, 0.1, 0.1];
        let found = [
            said(Spring::between("far", place, [0.9, 0.1, 0.1], 1.0)),
            said(Spring::between("far", place, "tip", 1.0)),
            said(Spring::to_ground("wire", [0.1, 0.1, 3.0], [0.0; 3], 1.0)),
            said(Spring::to_ground("set", "nowhere", [0.0; 3], 1.0)),
            said(Spring::to_ground("soft", place, [0.0; 3], -1.0)),
            said(Spring::between("short", place, place, 1.0)),
        ];
        let solid = solid.spring(Spring::to_ground("wire", place, [0.1, 0.1, -0.2], 10.0))?;
        let again = solid.clone().spring(Spring::to_ground("wire", place, [0.1, 0.1, -0.2], 10.0)).is_err();
        let goes_on = match solid.solve(&solid.controls(), &how()) {
            Err(StateError::Problem(error)) => return Err(error.into()),
            found => found.is_ok(),
        };
        Ok((found, again && goes_on))
    });
    let mut named_short = 0;
    for found in found {
        let (mut said, goes_on) = found?;
        let short = said[5].take().ok_or("a spring of no length")?;
        named_short += usize::from(short.contains("one point of the body"));
        assert!(short.contains("one point of the body") || short == FemError::Elsewhere.to_string(), "{short}");
        let named = ["part_reaching", "part_reaching", "no rank has the place [0.1, 0.1, 3.0]", "nowhere", "stiffness"];
        let has = |(said, named): (&Option<String>, &str)| said.as_ref().is_some_and(|said| said.contains(named));
        assert!(goes_on && said.iter().zip(named).all(has), "{said:?}");
    }
    assert_eq!(named_short, 1);
    Ok(())
}
