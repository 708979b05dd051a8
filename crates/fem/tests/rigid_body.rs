//! Rigid bodies: free flight, an insert in soft material, contact and friction, derivatives, what is refused.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::driven_motion::{DrivenMotion, Part, STEPS, Wanted, block};
use common::motion::motion;
use common::{Outcome, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    Cavity, Contact, Controls, Feature, Inertia, Instant, RigidBody, Scheme, Solid, Solver, State, StepTo, Tendon,
    TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::Vec3;

fn scheme(name: &str) -> Scheme {
    (SCHEMES.iter().find(|row| row.name == name).unwrap().build)().unwrap()
}

/// The same mesh with the regions "soft" and "hard", by the centre of a cell.
pub(crate) fn parts(full: &Mesh, is_hard: impl Fn(Vec3) -> bool) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("parts");
    raw.points = full.points().to_vec();
    for cell in 0..full.cells() {
        let tag = if is_hard(full.cell_centre(cell).into()) { 2 } else { 1 };
        raw.push(full.cell(cell).kind, full.cell(cell).nodes, &[tag]);
    }
    for (tag, (name, facets)) in (3..).zip(full.surfaces()) {
        raw.name_group(full.dim() - 1, tag, name);
        for &facet in facets {
            let (kind, nodes) = full.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    raw.name_group(full.dim(), 1, "soft");
    raw.name_group(full.dim(), 2, "hard");
    Ok(Mesh::build(raw)?)
}

/// `max |F^T F - 1|` over the cells of a rigid body, by the positions of their nodes.
fn strain(mesh: &Mesh, cells: &[u32], u: &[f64]) -> f64 {
    let dim = mesh.dim();
    let at = |node: u32| {
        let x = mesh.points()[node as usize];
        Vec3::from_fn(|i, _| x[i] + if i < dim { u[dim * node as usize + i] } else { 0.0 })
    };
    let mut nodes: Vec<u32> = cells.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes.to_vec()).collect();
    nodes.dedup();
    let length = |a: u32, b: u32| (at(a) - at(b)).norm();
    let rest = |a: u32, b: u32| (Vec3::from(mesh.points()[a as usize]) - Vec3::from(mesh.points()[b as usize])).norm();
    let pairs = nodes.iter().flat_map(|&a| nodes.iter().map(move |&b| (a, b))).filter(|(a, b)| a < b);
    pairs.map(|(a, b)| (length(a, b) / rest(a, b) - 1.0).abs()).fold(0.0, f64::max)
}

fn all_cells(mesh: &Mesh) -> Vec<u32> {
    (0..mesh.cells() as u32).collect()
}

/// A brick of 1 x 2 x 3 and mass 6 that turns and flies.
fn thrown(kind: CellKind, size: [f64; 3], gravity: Vec3, v: Vec3, omega: Vec3) -> Outcome<(Solid, State)> {
    let cells = [1, 2, 2];
    let solid = Solid::new(regular(kind, size, cells)?)?
        .material("body", NeoHooke::new(3.0, 5.0)?)?
        .body_force("body", gravity)?
        .inertia(Inertia::new("body", 1.0))?
        .rigid(&RigidBody::new("brick", "body"))?
        // of the soft cells alone: there are none
        .rayleigh_damping(0.0, 0.1)?;
    let (dim, middle) = (solid.mesh().dim(), 0.5 * Vec3::from(size));
    let mut begin = solid.rest();
    let of = |x: &[f64; 3]| v + omega.cross(&(Vec3::from(*x) - middle));
    let mut velocity: Vec<f64> = solid.mesh().points().iter().flat_map(|x| of(x).as_slice()[..dim].to_vec()).collect();
    velocity.resize(begin.u.len(), 0.0);
    begin.velocity = Some(velocity.into());
    Ok((solid, begin))
}

/// Momentum about the origin: linear and angular.
fn momenta(solid: &Solid, state: &State) -> Outcome<(Vec3, Vec3)> {
    let (dim, points) = (solid.mesh().dim(), solid.mesh().points());
    let n = points.len() * dim;
    let mut p = vec![0.0; n];
    solid.model().energies().mass()?.multiply(&state.velocity.as_ref().unwrap()[..n], &mut p);
    let of = |values: &[f64], a: usize| Vec3::from_fn(|i, _| if i < dim { values[dim * a + i] } else { 0.0 });
    let at = |a: usize| Vec3::from(points[a]) + of(&state.u, a);
    let sum = (0..points.len()).map(|a| of(&p, a)).sum();
    Ok((sum, (0..points.len()).map(|a| at(a).cross(&of(&p, a))).sum()))
}

/// In free fall the centre moves as a point does, exactly as TR-BDF2 integrates a parabola; the brick, thrown about its middle axis, tumbles,
/// and what of its angular momentum a step loses falls with the square of its length. It stays rigid.
#[test]
fn a_thrown_brick_tumbles() -> Outcome {
    let (gravity, v, omega) = (Vec3::new(0.0, 0.0, -9.0), Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.05, 3.0, 0.02));
    let mut lost = Vec::new();
    for count in [100, 200] {
        let (solid, begin) = thrown(CellKind::Hex8, [1.0, 2.0, 3.0], gravity, v, omega)?;
        let (momentum, spin) = momenta(&solid, &begin)?;
        let run = motion(&solid, &scheme("tr_bdf2"), begin, count, 1.0 / count as f64)?;
        for state in run.states() {
            let off = strain(solid.mesh(), &all_cells(solid.mesh()), &state.u);
            assert!(off < 1e-10, "at {}: strained by {off:e}", state.time);
        }
        let end = run.end();
        let quantities = solid.model().quantities(&Instant::of(end))?;
        let of = |name: &str| quantities.iter().find(|(_, own, _)| *own == name).unwrap().2;
        let moved = Vec3::new(of("translation_x"), of("translation_y"), of("translation_z"));
        assert!((moved - (v + 0.5 * gravity)).norm() < 1e-9, "{moved}");
        let (now, turning) = momenta(&solid, end)?;
        assert!((now - (momentum + 6.0 * gravity)).norm() < 1e-8, "{now} after {momentum}");
        // about the centre, which has moved from the middle
        let about = |spin: Vec3, x: Vec3, p: Vec3| spin - x.cross(&p);
        let middle = Vec3::new(0.5, 1.0, 1.5);
        let change = about(turning, middle + moved, now) - about(spin, middle, momentum);
        lost.push(change.norm() / about(spin, middle, momentum).norm());
        let turned = Vec3::new(of("rotation_x"), of("rotation_y"), of("rotation_z")).norm();
        assert!(turned > 1.0 && turned <= std::f64::consts::PI, "turned by {turned}");
    }
    let order = (lost[0] / lost[1]).log2();
    assert!(lost[0] < 2e-3 && order > 1.8, "lost {lost:?}, order {order}");
    Ok(())
}

/// In the plane it turns at a constant rate, to the order of the scheme.
#[test]
fn a_plate_turns_evenly() -> Outcome {
    for (name, order, h) in [("backward_euler", 1.0, 0.02), ("bdf2", 2.0, 0.02), ("tr_bdf2", 2.0, 0.02)] {
        let mut errors = Vec::new();
        for halved in [1, 2] {
            let (solid, begin) = thrown(CellKind::Quad9, [1.0, 2.0, 0.0], Vec3::zeros(), Vec3::x(), 1.5 * Vec3::z())?;
            let run = motion(&solid, &scheme(name), begin, 50 * halved, h / halved as f64)?;
            let quantities = solid.model().quantities(&Instant::of(run.end()))?;
            let angle = quantities.iter().find(|(_, own, _)| *own == "rotation_z").unwrap().2;
            errors.push((angle - 1.5).abs());
            assert!(strain(solid.mesh(), &all_cells(solid.mesh()), &run.end().u) < 1e-10);
        }
        let found = (errors[0] / errors[1]).log2();
        assert!(found > order - 0.2, "{name}: errors {errors:?}, order {found}");
    }
    Ok(())
}

/// A beam with a hard piece in its middle, held at one end and pulled across at the other.
fn beam(kind: CellKind, hard: f64) -> Outcome<Solid> {
    let mesh = parts(&regular(kind, [4.0, 1.0, 1.0], [8, 2, 2])?, |x| x.x > 1.0 && x.x < 2.5)?;
    let across = Vec3::new(0.2, 0.5, if kind.dim() == 3 { 0.3 } else { 0.0 });
    Ok(Solid::new(mesh)?
        .material("soft", NeoHooke::new(10.0, 20.0)?)?
        .material("hard", NeoHooke::new(10.0 * hard, 20.0 * hard)?)?
        .clamp("x-")?
        .traction("x+", across)?)
}

/// A rigid insert is the limit of a stiff one: what differs falls with its compliance.
#[test]
fn an_insert_is_the_limit_of_a_stiff_one() -> Outcome {
    for kind in [CellKind::Quad4, CellKind::Tri6, CellKind::Hex8, CellKind::Hex27, CellKind::Tet10] {
        let body = beam(kind, 1.0)?.rigid(&RigidBody::new("insert", "hard"))?;
        let rigid = body.solve(&body.controls(), &STRICT)?;
        let hard = body.mesh().region("hard")?.to_vec();
        assert!(strain(body.mesh(), &hard, &rigid.u) < 1e-11, "{kind:?}");
        let nodal = body.discretization().dofs();
        let size = rigid.u[..nodal].iter().fold(0.0f64, |m, u| m.max(u.abs()));
        assert!(size > 0.5, "{kind:?}: hardly bent, {size}");
        let apart = |stiffness: f64| -> Outcome<f64> {
            let stiff = beam(kind, stiffness)?;
            let state = stiff.solve(&stiff.controls(), &nastic_fem::SolveOptions::default())?;
            Ok(state.u.iter().zip(rigid.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size)
        };
        let (near, nearer) = (apart(1e3)?, apart(1e4)?);
        assert!(near < 1e-2 && (near / nearer).log10() > 0.95, "{kind:?}: {near:e}, {nearer:e}");
    }
    Ok(())
}

/// A rigid block of 1 x 1 x 0.25 m and 250 kg on an incline of `tan = 1/2`: the gravity turns, not the floor.
fn incline(mu: f64) -> Outcome<Solid> {
    let (sine, cosine) = (0.2f64.sqrt(), 0.8f64.sqrt());
    let contact = Contact::of("floor", "z-", Obstacle::half_space([0.0; 3], [0.0, 0.0, 1.0]));
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.25], [2, 2, 1])?)?
        .material("body", NeoHooke::new(4e3, 4e3)?)?
        .body_force("body", 1000.0 * 9.81 * Vec3::new(sine, 0.0, -cosine))?
        .inertia(Inertia::new("body", 1000.0))?
        .contact(contact.thickness(1e-3).stiffness(4e6).friction(mu, 1e-3))?
        .rigid(&RigidBody::new("block", "body"))?)
}

/// It slides as backward Euler sums `a = g (sin - mu cos)`, and creeps at `v = e (1 - sqrt(1 - tan/mu))`.
#[test]
fn a_rigid_block_slides_or_creeps() -> Outcome {
    let (h, n, cosine) = (0.01, 50, 0.8f64.sqrt());
    for mu in [0.4, 0.7] {
        let solid = incline(mu)?;
        let mut begin = solid.rest();
        let gap = 1e-3 * (1.0 - (1000.0 * 9.81 * 0.25 * cosine / 4e6).sqrt());
        let nodal = solid.discretization().dofs();
        let lifted = (0..begin.u.len()).map(|dof| if dof < nodal && dof % 3 == 2 { gap } else { 0.0 });
        begin.u = lifted.collect::<Vec<f64>>().into();
        begin.velocity = Some(vec![0.0; begin.u.len()].into());
        let run = motion(&solid, &scheme("backward_euler"), begin, n, h)?;
        let end = run.end();
        let newton: usize = run.states().iter().map(|state| state.report.newton).sum();
        assert!(newton < 7 * n, "mu {mu}: {newton} Newton iterations in {n} steps");
        let speed = end.velocity.as_ref().unwrap()[0];
        let slides = 9.81 * (0.2f64.sqrt() - mu * cosine) * h * n as f64;
        let wanted = if mu < 0.5 { slides } else { 1e-3 * (1.0 - (1.0 - 0.5 / mu).sqrt()) };
        assert!((speed / wanted - 1.0).abs() < 2e-3, "mu {mu}: {speed} for {wanted}");
        assert!(strain(solid.mesh(), &all_cells(solid.mesh()), &end.u) < 1e-10);
    }
    Ok(())
}

/// What lies on a floor, held by contact and its weight alone, is found as an equilibrium.
#[test]
fn a_rigid_block_rests() -> Outcome {
    rests(0.0)?;
    // beyond the layer of the floor: its weight leads it there
    rests(-0.02)
}

/// It settles in the layer that carries it, until its velocities are rounding.
#[test]
fn a_rigid_block_at_rest_goes_on_resting() -> Outcome {
    let (layer, stiffness, pressure): (f64, f64, f64) = (1e-4, 5e6, 98.1);
    let gap = layer * (1.0 - 0.9 * (pressure / stiffness).sqrt());
    let floor = Obstacle::half_space([0.0, 0.0, -gap], [0.0, 0.0, 1.0]);
    let floor = Contact::of("floor", "z-", floor).thickness(layer).stiffness(stiffness);
    let mesh = regular(CellKind::Hex8, [0.02, 0.02, 0.01], [4, 4, 2])?;
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(2e4, 8e4)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -9810.0))?
        .inertia(Inertia::new("body", 1000.0))?
        .rigid(&RigidBody::new("stone", "body"))?
        .contact(floor.friction(0.5, 1e-3))?;
    let begin = State { velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() };
    let steps = vec![StepTo { dt: 0.01, controls: solid.controls() }; 60];
    let mut run = Trajectory::from_given(begin);
    // each goes on from the last, as a motion that is watched does
    for step in steps.chunks(1) {
        solid.model().advance(&mut run, &scheme("backward_euler"), step, &STRICT, &mut Workspace::default())?;
    }
    let speed = run.end().velocity.iter().flat_map(|v| v.iter()).fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(speed < 1e-12, "{speed}");
    Ok(())
}

fn rests(floor: f64) -> Outcome {
    let wall = |name: &str, side: &str, at: [f64; 3], normal: Vec3| {
        Contact::of(name, side, Obstacle::half_space(at, normal.into())).thickness(0.01).stiffness(4e3).settled()
    };
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.5], [2, 2, 1])?)?
        .material("body", NeoHooke::new(4e3, 4e3)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -40.0))?
        .contact(wall("floor", "z-", [0.0, 0.0, floor], Vec3::z()))?
        .contact(wall("left", "x-", [-0.005, 0.0, 0.0], Vec3::x()))?
        .contact(wall("right", "x+", [1.005, 0.0, 0.0], -Vec3::x()))?
        .contact(wall("front", "y-", [0.0, -0.005, 0.0], Vec3::y()))?
        .contact(wall("back", "y+", [0.0, 1.005, 0.0], -Vec3::y()))?
        .rigid(&RigidBody::new("block", "body"))?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let touches = solid.model().contacts().touches(&Instant::of(&state));
    let up = touches.iter().find(|(name, _)| name == "floor").unwrap().1.force[2];
    assert!((up / 20.0 - 1.0).abs() < 1e-8, "{up}");
    Ok(())
}

/// A plane strip with a rigid end that a finger strokes, and a rigid block that lies on it.
fn stroked() -> Outcome<Solid> {
    let mesh = parts(&regular(CellKind::Quad4, [3.0, 1.0, 0.0], [6, 2, 1])?, |x| x.x > 1.5)?;
    let finger = Obstacle::capsule([0.9, 1.42, 0.0], [1.9, 1.46, 0.0], 0.35);
    let floor = Obstacle::half_space([0.0, -0.06, 0.0], [0.05, 1.0, 0.0]);
    Ok(Solid::new(mesh)?
        .material("soft", NeoHooke::new(1.0, 2.0)?)?
        .material("hard", NeoHooke::new(0.5, 0.5)?)?
        .actuate("soft", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force(["soft", "hard"], Vec3::new(0.0, -0.02, 0.0))?
        .displace("x-", [Some(0.0), None, None])?
        .inertia(Inertia::new(["soft", "hard"], 1.0))?
        .contact(Contact::of("floor", "y-", floor).thickness(0.08).stiffness(3.0).friction(0.3, 0.01))?
        .contact(Contact::of("finger", "y+", finger).thickness(0.08).stiffness(3.0).friction(0.6, 0.01))?
        .rigid(&RigidBody::new("end", "hard"))?
        .rayleigh_damping(0.0, 0.05)?)
}

fn controls(solid: &Solid, t: f64) -> Controls {
    let mut controls = solid.controls();
    controls.values_mut(block(solid, "fibre")).fill(0.2 * (2.0 * t).sin());
    let down = 0.16 * (1.5 * t).sin();
    let values = controls.values_mut(block(solid, "finger"));
    (values[0], values[1], values[5]) = (0.15 * t * t * (2.4 - t), -down, 0.1 * (3.0 * t).sin());
    controls
}

/// Along the gradient itself, by what drives the body, by the pose of the finger, by stiffness and friction; the functional sees all nodes.
#[test]
fn the_gradient_of_a_motion_is_exact() -> Outcome {
    const PARTS: [Part; 4] =
        [("fibre", &[0], 1e-2), ("finger", &[0, 1], 1e-3), ("finger", &[5], 1e-3), ("floor", &[7], 1e-2)];
    let wanted = Wanted { error: 1e-7, order: 1.9, steps: &[0.4, 0.2, 0.1, 0.05] };
    let solid = stroked()?;
    let motion = DrivenMotion { solid: &solid, controls, of_velocity: 0.3, first: 0 };
    let all = ["quasi_static", "tr_bdf2", "backward_euler", "bdf2"];
    let schemes = if std::env::var_os("NASTIC_SLOW").is_some() { &all[..] } else { &all[..2] };
    for name in schemes.iter().copied() {
        let base = motion.run(&scheme(name), 0.0, None).map_err(|error| format!("{name}: {error}"))?;
        let end = &base.states()[STEPS];
        let turned = solid.model().quantities(&Instant::of(end))?;
        assert!(turned.iter().any(|(_, own, value)| *own == "rotation_z" && value.abs() > 1e-2), "{name}: {turned:?}");
        motion.check(&scheme(name), &base, &PARTS, &wanted)?;
    }
    Ok(())
}

/// Bodies of one mesh: a rigid block falls on a soft one, which then carries its weight.
#[test]
fn a_rigid_block_falls_on_a_soft_one() -> Outcome {
    let full = regular(CellKind::Quad4, [1.0, 3.0, 0.0], [3, 9, 1])?;
    let mut raw = RawMesh::new("two");
    raw.points =
        full.points().iter().map(|x| if x[1] > 1.5 { [0.6 * x[0] + 0.13, x[1] - 0.95, 0.0] } else { *x }).collect();
    for cell in 0..full.cells() {
        let y = full.cell_centre(cell)[1];
        if (y - 1.5).abs() > 0.5 {
            raw.push(CellKind::Quad4, full.cell(cell).nodes, &[if y > 1.5 { 2 } else { 1 }]);
        }
    }
    for (tag, name) in [(1, "soft"), (2, "hard")] {
        raw.name_group(2, tag, name);
    }
    let floor = Obstacle::half_space([0.0; 3], [0.0, 1.0, 0.0]);
    let (layer, k) = (0.01, 2e5);
    let solid = Solid::new(Mesh::build(raw)?)?
        .material("soft", NeoHooke::new(400.0, 800.0)?)?
        .material("hard", NeoHooke::new(400.0, 800.0)?)?
        .body_force("hard", Vec3::new(0.0, -100.0, 0.0))?
        .inertia(Inertia::new("soft", 1.0).and("hard", 10.0))?
        .contact(Contact::of("floor", "skin", floor).thickness(layer).stiffness(k).settled().friction(0.5, 1e-2))?
        .contact(Contact::between("between", "skin", "skin").thickness(layer).stiffness(k).friction(0.5, 1e-2))?
        .rigid(&RigidBody::new("block", "hard"))?
        .rayleigh_damping(0.0, 0.05)?;
    let mut begin = solid.rest();
    begin.velocity = Some(vec![0.0; begin.u.len()].into());
    let run = motion(&solid, &scheme("backward_euler"), begin, 150, 0.01)?;
    let newton: usize = run.states().iter().map(|state| state.report.newton).sum();
    assert!(newton < 12 * 150, "{newton} Newton iterations");
    let end = run.end();
    let hard = solid.mesh().region("hard")?.to_vec();
    assert!(strain(solid.mesh(), &hard, &end.u) < 1e-10);
    let touches = solid.model().contacts().touches(&Instant::of(end));
    let up = touches.iter().find(|(name, _)| name == "floor").unwrap().1.force[1];
    assert!((up / 60.0 - 1.0).abs() < 2e-3, "{up}");
    Ok(())
}

/// A plane frame around a chamber that is filled, of which one side is rigid: beside a border.
fn frame(hard: Option<f64>) -> Outcome<Solid> {
    let full = regular(CellKind::Quad4, [3.0, 3.0, 0.0], [3, 3, 1])?;
    let hole = (0..full.cells()).find(|&c| (Vec3::from(full.cell_centre(c)) - Vec3::new(1.5, 1.5, 0.0)).norm() < 0.1);
    let mut raw = RawMesh::new("frame");
    raw.points = full.points().to_vec();
    for cell in (0..full.cells()).filter(|&cell| Some(cell) != hole) {
        let tag = if full.cell_centre(cell)[0] > 2.0 { 2 } else { 1 };
        raw.push(CellKind::Quad4, full.cell(cell).nodes, &[tag]);
    }
    for (kind, local) in CellKind::Quad4.faces() {
        let nodes: Vec<u32> = local.iter().map(|&a| full.cell(hole.unwrap()).nodes[a]).collect();
        raw.push(*kind, &nodes, &[3]);
    }
    for &facet in full.surface("x-")? {
        let (kind, nodes) = full.facet_nodes(facet);
        raw.push(kind, &nodes, &[4]);
    }
    for (dim, tag, name) in [(2, 1, "soft"), (2, 2, "hard"), (1, 3, "inside"), (1, 4, "x-")] {
        raw.name_group(dim, tag, name);
    }
    let stiff = hard.unwrap_or(1.0);
    let body = Solid::new(Mesh::build(raw)?)?
        .material("soft", NeoHooke::new(1.0, 2.0)?)?
        .material("hard", NeoHooke::new(stiff, 2.0 * stiff)?)?
        .actuate("soft", "fibre", FiberTension::along(Vec3::new(0.6, 0.8, 0.0))?)?
        .clamp("x-")?
        .cavity(Cavity::new("air", "inside").by_volume())?;
    Ok(if hard.is_none() { body.rigid(&RigidBody::new("side", "hard"))? } else { body })
}

/// The pressure is that of the limit of a stiff side, and first and second derivatives by the volume and a fibre are exact.
#[test]
fn a_rigid_side_of_a_filled_chamber() -> Outcome {
    let filled = |solid: &Solid, t: f64| -> Outcome<State> {
        let mut controls = solid.controls();
        controls.values_mut(block(solid, "fibre")).fill(0.1 + 0.05 * t);
        controls.values_mut(block(solid, "air"))[0] = 0.4 + 0.1 * t;
        Ok(solid.solve(&controls, &STRICT)?)
    };
    let pressure = |solid: &Solid, state: &State| {
        let all = solid.model().quantities(&Instant::of(state)).unwrap();
        all.into_iter().find(|(own, name, _)| own == "air" && *name == "pressure").unwrap().2
    };
    let (rigid, stiff) = (frame(None)?, frame(Some(1e5))?);
    let (state, near) = (filled(&rigid, 0.0)?, filled(&stiff, 0.0)?);
    let (found, expected) = (pressure(&rigid, &state), pressure(&stiff, &near));
    assert!((found / expected - 1.0).abs() < 1e-4 && found > 0.05, "{found}, {expected}");
    // the whole system, constraints too, by its own product
    let dofs = rigid.discretization().dofs();
    let mut all: Vec<f64> = (0..state.u.len()).map(|i| common::noise(300 + i)).collect();
    rigid.supports().restrict(&mut all[..dofs]);
    let solved = rigid.model().adjoint(&state, &[&all], &STRICT)?.lambda.remove(0);
    let mut left = vec![0.0; all.len()];
    assert!(rigid.model().tangents().tangent_product(&Instant::of(&state), &solved, &mut left)?);
    rigid.supports().restrict(&mut left[..dofs]);
    let largest = left.iter().zip(&all).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest < 1e-8, "{largest:e}");
    let cost = |state: &State| (0..dofs).map(|i| common::noise(i) * state.u[i] + 0.5 * state.u[i].powi(2)).sum::<f64>();
    let mut by_u: Vec<f64> = (0..dofs).map(|i| common::noise(i) + state.u[i]).collect();
    by_u.resize(state.u.len(), 0.0);
    let rhs: Vec<f64> = by_u.iter().map(|d| -d).collect();
    let lambda = rigid.model().adjoint(&state, &[&rhs], &STRICT)?.lambda.remove(0);
    let by = rigid.model().prescribed_unknowns().sensitivities(&Instant::of(&state), &by_u, &lambda)?.controls;
    let slope = 0.1 * by.values(block(&rigid, "air"))[0] + 0.05 * by.values(block(&rigid, "fibre")).iter().sum::<f64>();
    let at = |t: f64| filled(&rigid, t).map(|state| cost(&state));
    let h = 0.02;
    let difference = (8.0 * (at(h)? - at(-h)?) - (at(2.0 * h)? - at(-2.0 * h)?)) / (12.0 * h);
    assert!((slope / difference - 1.0).abs() < 1e-7, "{slope}, {difference}");
    Ok(())
}

#[test]
fn what_does_not_go_with_rigid_bodies_is_refused() -> Outcome {
    let says = |error: &dyn std::fmt::Display, words: &str| {
        let said = error.to_string();
        assert!(said.contains(words), "{said}");
    };
    let insert = RigidBody::new("insert", "hard");
    says(&beam(CellKind::Hex8, 1.0)?.rigid(&RigidBody::new("insert", "none")).unwrap_err(), "none");
    let twice = beam(CellKind::Hex8, 1.0)?.rigid(&insert)?.rigid(&RigidBody::new("other", "hard"));
    says(&twice.unwrap_err(), "belongs to \"other\" and to \"insert\"");
    let moved = beam(CellKind::Hex8, 1.0)?.displace_nodes("tip", &[77], |_, _| [Some(0.1), None, None])?.rigid(&insert);
    let moved = moved.map(|_| ()).unwrap_err();
    says(&moved, "\"tip\" moves node 77");
    let held = beam(CellKind::Hex8, 1.0)?.rigid(&insert)?.displace("y-", [None, Some(0.0), None]);
    says(&held.unwrap_err(), "of the rigid body \"insert\"");
    let body = beam(CellKind::Hex8, 1.0)?.rigid(&insert)?;
    for feature in [Feature::Modes, Feature::Deflation, Feature::Descent] {
        says(&body.model().properties().supports(feature).unwrap_err(), "insert");
    }
    says(&body.model().supports_motion(&scheme("siere")).unwrap_err(), "insert");
    let inside = [[1.2, 0.5, 0.5], [2.2, 0.5, 0.5]];
    let cable = beam(CellKind::Hex8, 1.0)?.tendon(Tendon::through("cable", inside).inextensible())?.rigid(&insert)?;
    says(&cable.check().unwrap_err(), "one rigid body has it all");
    let (thrown, mut begin) = thrown(CellKind::Hex8, [1.0, 2.0, 3.0], Vec3::zeros(), Vec3::x(), Vec3::zeros())?;
    let mut velocity = begin.velocity.clone().unwrap().to_vec();
    // affine, as the nodes that follow have it: stretched along x at rate 1, beside the translation
    thrown.mesh().points().iter().zip(velocity.chunks_mut(3)).for_each(|(x, v)| v[0] += x[0]);
    begin.velocity = Some(velocity.into());
    let flown = |begin: &State| motion(&thrown, &scheme("bdf2"), begin.clone(), 1, 0.1);
    says(flown(&begin).unwrap_err().as_ref(), "changes the shape of \"brick\"");
    assert!(flown(&State { time: 1.0, ..begin.clone() }).is_ok(), "a state of a motion goes on");
    let mut velocity = vec![0.0; begin.u.len()];
    velocity[3 * thrown.supports().ties().nodes()[0] as usize] += 1e-3;
    begin.velocity = Some(velocity.into());
    says(flown(&begin).unwrap_err().as_ref(), "the velocity of node");
    let nothing: [&str; 0] = [];
    says(&beam(CellKind::Hex8, 1.0)?.rigid(&RigidBody::new("insert", nothing)).unwrap_err(), "no cells");
    let damped = beam(CellKind::Hex8, 1.0)?.inertia(Inertia::new(["soft", "hard"], 1.0))?.rayleigh_damping(0.0, 0.1)?;
    says(&damped.rigid(&insert).unwrap_err(), "add the damping last");
    let by_multigrid = body.solver(Solver::MULTIGRID);
    says(&by_multigrid.solve(&by_multigrid.controls(), &STRICT).unwrap_err(), "multigrid");
    Ok(())
}
