//! The shape of the body as unknown: free of stress where it is, and the same as a body that is drawn so.

use crate::common;

use common::block::STRICT;
use common::{Outcome, kinds, regular};
use nastic_energy::{FiberTension, KinematicGrowth, MooneyRivlin, NeoHooke, ShapeModes};
use nastic_fem::{
    Cavity, Contact, Formulation, Foundation, Inertia, Instant, MovingSupport, NodalMode, Solid, Spring, State, Tendon,
    VaryingLoad,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::Vec3;

/// A change of shape that leaves the plane x = 0 and is linear in no coordinate.
fn swollen(x: [f64; 3]) -> [f64; 3] {
    [0.4 * x[0] * x[1], 0.5 * x[0] * x[0] + 0.2 * x[0] * x[2], -0.3 * x[0] * x[1]]
}

fn bent(x: [f64; 3]) -> [f64; 3] {
    [0.0, 0.3 * x[0], x[0] * (x[0] - 0.5)]
}

fn bar(kind: CellKind) -> Outcome<Solid> {
    let mesh = regular(kind, [1.0, 0.4, 0.4], [3, 2, 2])?;
    let modes = [NodalMode::new("swollen", &mesh, swollen), NodalMode::new("bent", &mesh, bent)];
    Ok(Solid::new(mesh)?
        .material("body", MooneyRivlin::new(1e4, 3e3, 5e5)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .shape("body", "shape", modes)?
        .clamp("x-")?)
}

fn amplitudes(solid: &Solid, values: &[f64]) -> Outcome<nastic_fem::Controls> {
    let block = solid.model().controllable().iter().position(|own| own.shared.is_some()).ok_or("no shape")?;
    let mut controls = solid.controls();
    controls.values_mut(block).copy_from_slice(values);
    Ok(controls)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// u = s without energy, from rest and from the state of another shape, which is not where it ends.
#[test]
fn a_free_body_takes_its_shape_without_energy() -> Outcome {
    for kind in kinds() {
        let solid = bar(kind)?;
        let (here, there) = (amplitudes(&solid, &[0.3, -0.2])?, amplitudes(&solid, &[-0.2, 0.3])?);
        let from = solid.solve(&there, &STRICT)?;
        for near in [None, Some(&from)] {
            let state = solid.solve(&here, &nastic_fem::SolveOptions { near, ..STRICT })?;
            let s = solid.model().shape_displacement(&here).ok_or("no shape")?;
            let energy = solid.body().evaluate(&state.u, &state.controls, false, false)?.energy;
            assert!(
                apart(&state.u, &s) < 1e-10 && energy.abs() < 1e-14 * 1e4,
                "{kind}: {:e}, {energy:e}",
                apart(&state.u, &s)
            );
            assert!(s.iter().any(|s| s.abs() > 0.05));
        }
    }
    Ok(())
}

const THICK: f64 = 0.1;

/// By how much the underside of a plate goes down: its upper side and its rim stay.
fn thicker(x: [f64; 3]) -> [f64; 3] {
    let bump = 16.0 * x[0] * (1.0 - x[0]) * x[1] * (1.0 - x[1]);
    [0.1 * bump * (x[2] - THICK), 0.0, bump * (x[2] - THICK) / THICK]
}

/// A heavy plate over a chamber under pressure, which presses it against a plane; of a shape that is an unknown, or drawn so.
fn plate(mesh: Mesh, modes: Vec<NodalMode>, law: NeoHooke) -> Outcome<Solid> {
    let plane = Obstacle::half_space([0.0, 0.0, THICK + 0.05], [0.0, 0.0, -1.0]);
    let mut solid = Solid::new(mesh)?.material("body", law)?;
    if !modes.is_empty() {
        solid = solid.shape("body", "shape", modes)?;
    }
    let weight = VaryingLoad::filled("weight", solid.body(), "body", Vec3::new(0.0, 0.0, -2e4))?;
    Ok(solid
        .contribution(weight)?
        .inertia(Inertia::new("body", 1000.0).filled())?
        .cavity(Cavity::new("air", "z-").open())?
        .clamp(["x-", "x+", "y-", "y+"])?
        .contact(Contact::of("lid", "z+", plane).thickness(0.01))?)
}

fn pressed(solid: &Solid, mut controls: nastic_fem::Controls) -> Outcome<State> {
    let air = solid.model().controllable().iter().position(|own| own.name == "air").ok_or("no air")?;
    controls.values_mut(air)[0] = 1.2e4;
    Ok(solid.solve(&controls, &STRICT)?)
}

#[test]
fn an_unknown_shape_and_a_drawn_one_are_one_body() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Hex27] {
        let mesh = regular(kind, [1.0, 1.0, THICK], if kind == CellKind::Hex27 { [3, 3, 1] } else { [4, 4, 1] })?;
        let law = || NeoHooke::from_young_poisson(3e5, 0.35);
        let a = 0.03;
        let shaped = plate(mesh.clone(), vec![NodalMode::new("thicker", &mesh, thicker)], law()?)?;
        let mut controls = amplitudes(&shaped, &[a])?;
        for (k, own) in shaped.model().controllable().iter().enumerate().filter(|(_, own)| own.shared.is_some()) {
            let width = own.slots.len();
            controls.values_mut(k).iter_mut().step_by(width).for_each(|value| *value = a);
        }
        let state = pressed(&shaped, controls)?;
        let there = |x: [f64; 3]| {
            let phi = thicker(x);
            [0, 1, 2].map(|i| x[i] + a * phi[i])
        };
        let drawn = plate(mesh.clone().mapped(there)?, vec![], law()?)?;
        let other = pressed(&drawn, drawn.controls())?;
        let places = |solid: &Solid, state: &State| -> Vec<f64> {
            let u = state.u.chunks_exact(3);
            solid.mesh().points().iter().zip(u).flat_map(|(x, u)| [x[0] + u[0], x[1] + u[1], x[2] + u[2]]).collect()
        };
        let off = apart(&places(&shaped, &state), &places(&drawn, &other));
        let touches = |solid: &Solid, state: &State| -> Outcome<f64> {
            let all = solid.model().quantities(&Instant::of(state))?;
            Ok(all.iter().find(|(_, name, _)| *name == "force_z").ok_or("no contact")?.2)
        };
        let forces = [touches(&shaped, &state)?, touches(&drawn, &other)?];
        println!("{kind}: places apart {off:e}, forces {forces:?}");
        assert!(
            off < 1e-10 && forces[0].abs() > 100.0 && (forces[0] / forces[1] - 1.0).abs() < 1e-8,
            "{kind}: {off:e}, {forces:?}"
        );
        let mass = |solid: &Solid, state: &State| -> Outcome<f64> {
            let all = solid.model().quantities(&Instant::of(state))?;
            Ok(all.iter().find(|(_, name, _)| *name == "mass").ok_or("no mass")?.2)
        };
        let masses = [mass(&shaped, &state)?, mass(&drawn, &other)?];
        assert!((masses[0] / masses[1] - 1.0).abs() < 1e-12 && masses[0] > 100.0 * 1.05, "{masses:?}");
    }
    Ok(())
}

fn refused(solid: Result<Solid, nastic_fem::FemError>) -> String {
    solid
        .and_then(|solid| solid.check().map(|()| solid))
        .map(|_| String::new())
        .unwrap_or_else(|error| error.to_string())
}

#[test]
fn what_measures_from_the_drawn_body_is_refused_where_the_shape_changes() -> Outcome {
    let mesh = regular(CellKind::Hex8, [1.0, 0.4, 0.4], [4, 1, 1])?;
    let body = |phi: fn([f64; 3]) -> [f64; 3]| -> Outcome<Solid> {
        let modes = [NodalMode::new("m", &mesh, phi)];
        Ok(Solid::new(mesh.clone())?.material("body", NeoHooke::new(1e5, 4e5)?)?.shape("body", "wall", modes)?)
    };
    let free = |phi| -> Outcome<Solid> { Ok(body(phi)?.clamp("x-")?) };
    let up = |x: [f64; 3]| [0.0, 0.0, x[0]];
    let cable = |name: &str| Tendon::through(name, [[0.1, 0.2, 0.2], [0.9, 0.2, 0.2]]);
    let cases: Vec<(Result<Solid, nastic_fem::FemError>, &str)> = vec![
        (body(|_| [0.0, 0.0, 1.0])?.clamp("x-"), "holds it where it is drawn"),
        (
            body(|x| [0.0, 0.0, x[0] - 1.0])?.clamp("x-"),
            "moves node 0 at (0, 0, 0) along z by -1.000e0 of its amplitude, but x- holds it where it is drawn",
        ),
        (free(up)?.foundation(Foundation::on("x+", 1e3)), "measures from the drawn body"),
        (free(up)?.spring(Spring::to_ground("thread", [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], 10.0)), "but thread measures"),
        (free(up)?.tendon(cable("stiff").stiffness(10.0)), "but stiff measures"),
        (free(up)?.tendon(cable("rigid").inextensible()), "but rigid measures"),
        (free(up)?.motion(MovingSupport::of("hand", "x+")), "but hand holds it"),
        (
            free(up)?.shape("body", "twice", [NodalMode::new("n", &mesh, bent)]),
            "\"wall\" changes the shape of the body already",
        ),
        (free(up)?.inertia(Inertia::new("body", 1.0).lumped()), "leave out \"lumped\""),
        (
            free(up)?.inertia(Inertia::new("body", 1.0)).and_then(|solid| solid.rayleigh_damping(0.0, 0.1)),
            "does not go with \"rayleigh damping\"",
        ),
    ];
    for (k, (found, expected)) in cases.into_iter().enumerate() {
        let said = refused(found);
        assert!(said.contains(expected), "{k}: {said}");
    }
    // what sees places alone is not
    assert_eq!(refused(free(up)?.tendon(cable("pulled"))), "");
    assert_eq!(refused(free(|x| [0.0, 0.0, x[0] * (1.0 - x[0])])?.foundation(Foundation::on("x+", 1e3))), "");
    let late =
        Solid::new(mesh.clone())?.material("body", NeoHooke::new(1e5, 4e5)?)?.inertia(Inertia::new("body", 1.0))?;
    let said = refused(late.shape("body", "wall", [NodalMode::new("m", &mesh, up)]));
    assert!(said.contains("give it before"), "{said}");
    assert!(ShapeModes::new(vec![]).map(drop).unwrap_err().to_string().contains("there is none"));
    Ok(())
}

/// Beyond the bound of det G a state is a typed failure that says how far.
#[test]
fn a_shape_that_turns_cells_over_is_outside() -> Outcome {
    let mesh = regular(CellKind::Hex8, [1.0, 0.4, 0.4], [4, 1, 1])?;
    let shorter = NodalMode::new("shorter", &mesh, |x| [-x[0], 0.0, 0.0]);
    let solid =
        Solid::new(mesh)?.material("body", NeoHooke::new(1e5, 4e5)?)?.shape("body", "wall", [shorter])?.clamp("x-")?;
    assert!(solid.solve(&amplitudes(&solid, &[0.85])?, &STRICT).is_ok());
    for a in [0.95, 1.2] {
        let failed = solid.solve(&amplitudes(&solid, &[a])?, &STRICT).map(drop).unwrap_err();
        let said = failed.to_string();
        assert!(said.contains("shape: -det G") && said.contains("least share"), "{said}");
        assert!(failed.code() != "cancelled");
    }
    Ok(())
}

/// A body grows in its new shape: both maps one behind the other.
#[test]
fn a_body_grows_in_its_new_shape() -> Outcome {
    let mesh = regular(CellKind::Hex27, [1.0, 0.4, 0.4], [2, 1, 1])?;
    let mode = NodalMode::new("longer", &mesh, |x| [x[0], 0.0, 0.0]);
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(1e5, 4e5)?)?
        .formulation("body", Formulation::LinearDilatation)?
        .actuate("body", "swell", KinematicGrowth::isotropic())?
        .shape("body", "shape", [mode])?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?;
    let mut controls = amplitudes(&solid, &[0.5])?;
    controls.values_mut(0).fill(0.1);
    let state = solid.solve(&controls, &STRICT)?;
    for (x, u) in solid.mesh().points().iter().zip(state.u.chunks_exact(3)) {
        let expected = [(1.5 * 1.1 - 1.0) * x[0], 0.1 * x[1], 0.1 * x[2]];
        assert!(apart(u, &expected) < 1e-9, "{u:?} {expected:?}");
    }
    assert!(solid.body().evaluate(&state.u, &state.controls, false, false)?.energy.abs() < 1e-9);
    Ok(())
}
