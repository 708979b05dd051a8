//! What equilibria of nearly incompressible bodies cost, in Newton iterations and factorisations: chambers by volume against the same by
//! pressure, prescribed displacements, loads.
//!
//! `cargo test --release -p nastic-fem --test all nearly_incompressible_iterations -- --nocapture` prints the table.

#![allow(clippy::print_stdout)] // what solves take is worth reading

use crate::common;

use common::shells::{ring, shell};
use common::{Outcome, largest, regular};
use nastic_energy::{MooneyRivlin, NeoHookeIsochoric, Yeoh};
use nastic_fem::{Cavity, Formulation, Instant, MovingSupport, Solid, SolveOptions, State};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_numeric::vector::sub;
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

const RATIOS: [f64; 4] = [10.0, 500.0, 2000.0, 1e4];

/// The law of a body; its shear modulus at rest is 1.
#[derive(Clone, Copy)]
enum Law {
    NeoHooke,
    MooneyRivlin,
    Yeoh,
}

/// With the formulation for nearly incompressible bodies, where its cells have one.
fn body(mesh: Mesh, law: Law, ratio: f64) -> Outcome<Solid> {
    let kind = mesh.cell(0).kind;
    let solid = Solid::new(mesh)?;
    let solid = match law {
        Law::NeoHooke => solid.material("body", NeoHookeIsochoric::new(1.0, ratio)?)?,
        Law::MooneyRivlin => solid.material("body", MooneyRivlin::from_shear_bulk(1.0, ratio, 0.2)?)?,
        Law::Yeoh => solid.material("body", Yeoh::new(0.5, 0.01, 0.001, ratio)?)?,
    };
    Ok(solid.formulation("body", Formulation::nearly_incompressible(kind).unwrap_or_default())?)
}

/// Half a ring of radii 1 and 1.3, its ends on the x axis; "x-" is its inner side.
fn half_ring() -> Outcome<Mesh> {
    Ok(regular(CellKind::Quad9, [1.0; 3], [2, 16, 1])?.mapped(|[x, y, _]| {
        let (r, angle) = (1.0 + 0.3 * x, PI * y);
        [r * angle.cos(), if y == 0.0 || y == 1.0 { 0.0 } else { r * angle.sin() }, 0.0]
    })?)
}

fn clamped_half_ring(law: Law, ratio: f64, room: fn(Cavity) -> Cavity) -> Outcome<Solid> {
    let air = room(Cavity::new("air", "x-").lid());
    Ok(body(half_ring()?, law, ratio)?.clamp("y-")?.clamp("y+")?.cavity(air)?)
}

fn cylinder((kind, cells): (CellKind, usize), ratio: f64, room: fn(Cavity) -> Cavity) -> Outcome<Solid> {
    Ok(body(ring(kind, cells)?, Law::NeoHooke, ratio)?
        .displace("y-", [None, Some(0.0), None])?
        .displace("y+", [Some(0.0), None, None])?
        .cavity(room(Cavity::new("air", "x-").symmetry("y-").symmetry("y+")))?)
}

fn sphere((kind, cells, law): (CellKind, usize, Law), ratio: f64, room: fn(Cavity) -> Cavity) -> Outcome<Solid> {
    Ok(body(shell(kind, cells)?, law, ratio)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?
        .cavity(room(Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-")))?)
}

fn solve(solid: &Solid, value: f64) -> Outcome<State> {
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = value;
    Ok(solid.solve(&controls, &SolveOptions::default())?)
}

fn volume(solid: &Solid, state: &State) -> Outcome<f64> {
    let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, state.load))?;
    Ok(all.iter().find(|(_, what, _)| *what == "volume").ok_or("no volume")?.2)
}

/// A chamber under a pressure, and under the volume that it has then: the same state for at most 1.5 times the iterations and twice the
/// factorisations, or one for each iteration and one more where factors of the tangents before serve the pressure nearly all the way.
fn volume_costs_what_pressure_costs(
    name: &str,
    ratio: f64,
    make: impl Fn(fn(Cavity) -> Cavity) -> Outcome<Solid>,
    pressure: f64,
) -> Outcome {
    let (by_pressure, by_volume) = (make(|room| room)?, make(Cavity::by_volume)?);
    let state = solve(&by_pressure, pressure)?;
    let added = volume(&by_pressure, &state)? - volume(&by_pressure, &by_pressure.rest())?;
    let same = solve(&by_volume, added)?;
    let (p, v) = (state.report, same.report);
    let apart = largest(&sub(by_volume.model().nodal(&same.u), &state.u));
    println!(
        "{name}, kappa/mu {ratio:e}, p {pressure}: {}/{} by pressure, {}/{} by volume, apart {apart:.1e}",
        p.newton, p.factorisations, v.newton, v.factorisations
    );
    assert!(apart < 1e-9, "{name} at {ratio}: {apart:e}");
    assert!(2 * v.newton <= 3 * p.newton, "{name} at {ratio}: {p:?} {v:?}");
    let few = v.factorisations <= 2 * p.factorisations || v.factorisations <= v.newton + 1;
    assert!(few && v.newton <= 12, "{name} at {ratio}: {p:?} {v:?}");
    assert_eq!(by_volume.negative_pivots(&same)?, 0, "{name} at {ratio}");
    Ok(())
}

#[test]
fn plane_chambers_by_volume_cost_what_pressure_costs() -> Outcome {
    for ratio in RATIOS {
        for pressure in [0.01, 0.03] {
            for (name, law) in [("half ring", Law::NeoHooke), ("half ring, Mooney-Rivlin", Law::MooneyRivlin)] {
                volume_costs_what_pressure_costs(name, ratio, |room| clamped_half_ring(law, ratio, room), pressure)?;
            }
        }
        for pressure in [0.1, 0.4] {
            let cells = [(CellKind::Quad9, 4), (CellKind::Quad4, 8)].into_iter();
            // eight nodes without a formulation lock, and locked bodies wrinkle
            for mesh in cells.chain((ratio < 1000.0).then_some((CellKind::Quad8, 4))) {
                let name = format!("cylinder, {}", mesh.0);
                volume_costs_what_pressure_costs(&name, ratio, |room| cylinder(mesh, ratio, room), pressure)?;
            }
        }
    }
    Ok(())
}

#[test]
fn spheres_by_volume_cost_what_pressure_costs() -> Outcome {
    for ratio in RATIOS {
        for pressure in [0.3, 0.6] {
            for mesh in [(CellKind::Hex27, 2, Law::NeoHooke), (CellKind::Hex8, 3, Law::Yeoh)] {
                let name = format!("sphere, {}", mesh.0);
                volume_costs_what_pressure_costs(&name, ratio, |room| sphere(mesh, ratio, room), pressure)?;
            }
        }
    }
    Ok(())
}

/// A cylinder of radius 1 along z in 5 layers of 12 cells: 4 inner ones, 8 around them.
fn round_bar(length: f64) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("round bar");
    let mut seen = BTreeMap::new();
    raw.name_group(2, 1, "z-");
    raw.name_group(2, 2, "z+");
    raw.name_group(3, 1, "body");
    for part in 0..5 {
        let block = regular(CellKind::Hex27, [1.0; 3], [if part == 0 { 2 } else { 1 }, 2, 5])?;
        let place = |[x, y, z]: [f64; 3]| {
            let ((sin, cos), inner) = ((0.5 * PI * (y - 0.5)).sin_cos(), [0.5, y - 0.5]);
            let [a, b] = [inner[0] + x * (cos - inner[0]), inner[1] + x * (sin - inner[1])];
            let [x, y] = [[x - 0.5, y - 0.5], [a, b], [-b, a], [-a, -b], [b, -a]][part];
            [x, y, length * z]
        };
        let mut number = |at: [f64; 3]| {
            *seen.entry(at.map(|x| (x * 1e9).round() as i64)).or_insert_with(|| {
                raw.points.push(at);
                raw.points.len() as u32 - 1
            })
        };
        let numbers: Vec<u32> = block.points().iter().map(|point| number(place(*point))).collect();
        let renumber = |nodes: &[u32]| nodes.iter().map(|&node| numbers[node as usize]).collect::<Vec<_>>();
        block.blocks()[0].iter().for_each(|cell| raw.push(CellKind::Hex27, &renumber(cell), &[1]));
        for (side, tag) in [("z-", 1), ("z+", 2)] {
            for &facet in block.surface(side)? {
                let (kind, nodes) = block.facet_nodes(facet);
                raw.push(kind, &renumber(&nodes), &[tag]);
            }
        }
    }
    Ok(Mesh::build(raw)?)
}

/// A body of hex27 at kappa/mu = 1e4 whose face moves by a translation and a rotation vector, in one call.
fn moved(mesh: Mesh, faces: [&str; 2], to: [f64; 6]) -> Outcome<State> {
    let solid = body(mesh, Law::NeoHooke, 1e4)?.clamp(faces[0])?.motion(MovingSupport::of("grip", faces[1]))?;
    let mut controls = solid.controls();
    controls.values_mut(0).copy_from_slice(&to);
    let state = solid.solve(&controls, &SolveOptions::default())?;
    println!("{to:?}: {} Newton, {} factors", state.report.newton, state.report.factorisations);
    assert!(state.report.residual < 1e-9, "{:?}", state.report);
    assert_eq!(solid.negative_pivots(&state)?, 0);
    Ok(state)
}

/// Three threads give the bits of two.
#[test]
fn a_round_bar_is_twisted_by_a_radian() -> Outcome {
    for length in [3.0, 1.5] {
        let twist = || moved(round_bar(length)?, ["z-", "z+"], [0.0, 0.0, 0.0, 0.0, 0.0, 0.99]);
        let state = twist()?;
        assert!(state.report.newton <= 100 && state.report.factorisations <= 100, "{:?}", state.report);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build()?;
        let again = pool.install(|| twist().map_err(|error| error.to_string()))?;
        assert_eq!(state.u, again.u);
    }
    Ok(())
}

#[test]
fn grips_move_far_in_few_iterations() -> Outcome {
    let slender = || box_mesh([10.0, 1.0, 1.0], [10, 1, 1], CellKind::Hex27);
    let block = || box_mesh([1.0; 3], [3; 3], CellKind::Hex27);
    let moves = [
        (slender()?, [-1.0, 0.0, 3.0, 0.0, -1.5, 0.0]),
        (block()?, [-0.3, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (block()?, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ];
    for (mesh, to) in moves {
        let report = moved(mesh, ["x-", "x+"], to)?.report;
        assert!(report.newton <= 60 && report.factorisations <= 70, "{to:?}: {report:?}");
    }
    Ok(())
}

/// Bars that a load across their end bends, little and far, in one load step.
#[test]
fn bars_bend_far_in_few_iterations() -> Outcome {
    for ratio in [1e3, 1e4] {
        for (kind, load) in [CellKind::Hex27, CellKind::Hex20].into_iter().flat_map(|kind| [(kind, 5e-4), (kind, 2e-2)])
        {
            let solid = body(box_mesh([10.0, 2.0, 1.0], [12, 3, 2], kind)?, Law::NeoHooke, ratio)?
                .clamp("x-")?
                .traction("x+", Vec3::new(0.0, 0.0, load))?;
            let state = solid.solve(&solid.controls(), &SolveOptions::default())?;
            let report = state.report;
            println!("{kind}, {ratio:e}, {load}: {} Newton, {} factors", report.newton, report.factorisations);
            assert!(report.newton <= 50 && report.load_steps == 1, "{kind}, {ratio}, {load}: {report:?}");
            assert_eq!(solid.negative_pivots(&state)?, 0);
        }
    }
    Ok(())
}
