//! Surfaces that touch each other and themselves: patch test, balance, a C that closes, moves that cross nothing, adjoint, impact, refusals.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, cut, largest, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Contact, ContactLaw, Demand, FemError, Inertia, Instant, Scheme, Solid, SolveOptions, State, StateError, StepTo,
    TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::spatial::Shape;
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::Vec3;

/// Young's modulus, Poisson's ratio 0.3.
const E: f64 = 1e5;

fn law() -> NeoHooke {
    NeoHooke::new(E / 2.6, E * 0.3 / (1.3 * 0.4)).unwrap()
}

/// Distance of the blocks at rest.
const GAP: f64 = 0.02;

/// Two unit blocks above each other; the upper one is `wide` times as wide.
pub fn blocks(kind: CellKind, wide: f64) -> Outcome<Mesh> {
    blocks_apart(kind, wide, GAP)
}

fn blocks_apart(kind: CellKind, wide: f64, gap: f64) -> Outcome<Mesh> {
    let full = regular(kind, [1.0, 1.0, 3.0], [3, 3, 9])?;
    let upper = |x: Vec3| Vec3::new(wide * (x.x - 0.5) + 0.5, wide * (x.y - 0.5) + 0.5, x.z - 1.0 + gap);
    let on = |z: f64| move |x: Vec3| (x.z - z).abs() < 1e-9;
    cut(
        &full,
        |x| (x.z - 1.5).abs() > 0.5,
        |x| if x.z > 1.5 { upper(x) } else { x },
        &[
            ("lower", &on(1.0)),
            ("upper", &on(2.0)),
            ("z-", &on(0.0)),
            ("z+", &on(3.0)),
            ("x-", &|x| x.x.abs() < 1e-9),
            ("y-", &|x| x.y.abs() < 1e-9),
        ],
    )
}

fn quantity(solid: &Solid, state: &State, name: &str) -> f64 {
    let all = solid.model().quantities(&Instant::of(state)).unwrap();
    all.into_iter().find(|(_, own, _)| *own == name).unwrap().2
}

fn slow() -> bool {
    std::env::var_os("NASTIC_SLOW").is_some()
}

/// Blocks on rollers press each other to 0.9 of their height: the pressure of the closed form, and as uniform as it is, on every element.
#[test]
fn pressed_blocks_are_uniform() -> Outcome {
    // where the samples of both sides are not opposite to each other, the test holds to their quadrature alone
    let few = [(CellKind::Hex8, 1, 1e-3), (CellKind::Tet4, 4, 1e-2), (CellKind::Tet10, 2, 1e-2)];
    let more = [(CellKind::Hex27, 2, 1e-2), (CellKind::Hex20, 2, 6e-2)].into_iter().filter(|_| slow());
    for (kind, refine, tolerance) in few.into_iter().chain(more) {
        let mut solid = Solid::new(blocks(kind, 1.0)?)?.material("body", law())?;
        for (axis, name) in ["x-", "y-", "z-"].iter().enumerate() {
            let mut values = [None; 3];
            values[axis] = Some(0.0);
            solid = solid.displace(*name, values)?;
        }
        let contact = Contact::between("between", "lower", "upper");
        let thickness = 1e-3;
        // what the gap takes up with the layer
        let pressed = 0.2 + GAP - 2.0 * thickness;
        let solid =
            solid.displace("z+", [None, None, Some(-pressed)])?.contact(contact.thickness(thickness).refine(refine))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let pressing = quantity(&solid, &state, "pressing");
        // nominal pressure at 0.9; the remaining gap of the layer is pressed too
        let remaining = thickness * (1.0 - (10795.4597_f64 / (100.0 * E)).sqrt());
        let expected = 10795.4597 * (1.0 + remaining / 0.2 * 0.9);
        assert!((pressing / expected - 1.0).abs() < 2e-3, "{kind}: {pressing} for {expected}");
        // every block is stretched alike, its sides stay plane
        let widening = |at: Vec3| {
            let node = common::node_at(solid.mesh(), at.into()).unwrap();
            [state.u[3 * node], state.u[3 * node + 1]]
        };
        for z in [0.0, 1.0, 1.0 + GAP, 2.0 + GAP] {
            for at in [Vec3::new(1.0, 0.0, z), Vec3::new(1.0, 1.0, z)] {
                let found = widening(at)[0];
                let expected = 0.0308316 * (1.0 + remaining / 0.2);
                assert!((found / expected - 1.0).abs() < tolerance, "{kind}, {at:?}: {found} for {expected}");
            }
        }
        assert!(state.report.newton <= 160, "{kind}: {} iterations", state.report.newton);
    }
    Ok(())
}

/// Forces and moments of blocks of other widths cancel, wherever they are.
#[test]
fn forces_and_moments_balance() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet10] {
        let contact = Contact::between("between", "lower", "upper").thickness(0.009).refine(2);
        let solid = Solid::new(blocks(kind, 1.7)?)?.material("body", law())?.clamp("z-")?.contact(contact)?;
        let u: Vec<f64> = (0..solid.rest().u.len()).map(|i| 0.006 * noise(i)).collect();
        let controls = solid.controls();
        let at = Instant::new(&u, &controls, 1.0);
        let pressing = |name: &str| {
            let all = solid.model().quantities(&at).unwrap();
            all.into_iter().find(|(_, own, _)| *own == name).unwrap().2
        };
        assert!(pressing("pressing") > 100.0, "{}", pressing("pressing"));
        let sums = solid.model().evaluate(&at, Demand { energy: true, force: true })?;
        let (mut force, mut moment, mut scale) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for (node, x) in solid.mesh().points().iter().enumerate() {
            let own = |v: &[f64]| Vec3::from_column_slice(&v[3 * node..][..3]);
            force += own(&sums.force);
            moment += (Vec3::from(*x) + own(&u)).cross(&own(&sums.force));
            scale += own(&sums.force_scale).norm();
        }
        assert!(force.norm() < 1e-13 * scale && moment.norm() < 1e-12 * scale, "{kind}: {force:?} {moment:?} {scale}");
    }
    Ok(())
}

/// The force that is reported is that on the nodes of the first surface; what presses has the derivatives of differences.
#[test]
fn what_is_told_is_what_acts() -> Outcome {
    let contact = Contact::between("between", "lower", "upper").thickness(0.009).refine(2);
    let solid = Solid::new(blocks(CellKind::Hex8, 1.7)?)?.material("body", law())?.clamp("z-")?.contact(contact)?;
    let u: Vec<f64> = (0..solid.rest().u.len()).map(|i| 0.006 * noise(i)).collect();
    let controls = solid.controls();
    let (model, mesh) = (solid.model(), solid.mesh());
    let (_, touch) = model.contacts().touches(&Instant::new(&u, &controls, 1.0)).remove(0);
    let at_stiffness = |factor: f64| {
        let mut controls = controls.clone();
        controls.values_mut(0)[0] *= factor;
        let force = model.evaluate(&Instant::new(&u, &controls, 1.0), Demand { energy: false, force: true });
        force.map(|sums| sums.force)
    };
    // what changes with the stiffness is the contact's alone
    let [one, two] = [at_stiffness(1.0)?, at_stiffness(2.0)?];
    for i in 0..3 {
        let nodes = mesh.nodes_of_facets(&mesh.facets_of(&"lower".into())?);
        let on_lower: f64 = nodes.iter().map(|&node| one[3 * node as usize + i] - two[3 * node as usize + i]).sum();
        assert!((on_lower - touch.force[i]).abs() < 1e-10 * touch.pressing, "{i}: {on_lower} {}", touch.force[i]);
    }
    let by = |p: f64| [p * p, 2.0 * p];
    let pressing = |u: &[f64]| model.contacts().pressing(&Instant::new(u, &controls, 1.0), "between", &by).unwrap();
    let found = pressing(&u)?;
    let along: f64 = found.by_u.iter().map(|by| by * by).sum::<f64>().sqrt();
    let h = 1e-8;
    let moved =
        |sign: f64| -> Vec<f64> { u.iter().zip(&found.by_u).map(|(u, by)| u + sign * h * by / along).collect() };
    let by_differences = (pressing(&moved(1.0))?.value - pressing(&moved(-1.0))?.value) / (2.0 * h);
    assert!((by_differences / along - 1.0).abs() < 1e-4, "{by_differences} and {along}");
    let by_stiffness = found.by_controls.values(0)[0] * controls.values(0)[0];
    assert!((by_stiffness / (2.0 * found.value) - 1.0).abs() < 1e-12);
    let pressures = model.contacts().nodal_pressures(&Instant::new(&u, &controls, 1.0)).unwrap();
    let largest = largest(&pressures);
    assert!(largest > 0.0 && largest <= touch.largest_pressure * (1.0 + 1e-12), "{largest}");
    Ok(())
}

/// A C whose upper arm, shorter and narrower, bends down until it lies on the lower one; its slot touches itself.
fn closing(kind: CellKind, touches: bool) -> Outcome<Solid> {
    let full = regular(kind, [1.0, 1.0, 0.4], [20, 10, 4])?;
    let slot = |x: Vec3| x.x > 0.2 && (x.y - 0.5).abs() < 0.1;
    let beside = |x: Vec3| x.y > 0.6 && (x.x > 0.9 || kind.dim() == 3 && (x.z - 0.2).abs() > 0.1);
    let in_slot = |x: Vec3| x.x > 0.2 - 1e-9 && (x.y - 0.5).abs() < 0.1 + 1e-9;
    let names: [(&str, &dyn Fn(Vec3) -> bool); 3] =
        [("slot", &in_slot), ("bottom", &|x: Vec3| x.y < 1e-9), ("top", &|x: Vec3| x.y > 1.0 - 1e-9 && x.x > 0.6)];
    let solid = Solid::new(cut(&full, |x| !slot(x) && !beside(x), |x| x, &names)?)?
        .material("body", law())?
        .actuate("body", "fibre", FiberTension::along(Vec3::new(0.3, 1.0, 0.0).normalize())?)?
        .clamp("bottom")?
        .traction("top", Vec3::new(0.0, -3e3, 0.0))?;
    let contact = Contact::between("slot", "slot", "slot");
    if touches { Ok(solid.contact(contact)?) } else { Ok(solid) }
}

fn crosses_itself(solid: &Solid, state: &State) -> Outcome<bool> {
    let dim = solid.mesh().dim();
    let place = |(node, x): (usize, &[f64; 3])| {
        std::array::from_fn(|i| if i < dim { x[i] + state.u[dim * node + i] } else { x[i] })
    };
    let positions: Vec<[f64; 3]> = solid.mesh().points().iter().enumerate().map(place).collect();
    Ok(!Shape::new(solid.mesh(), &positions, None)?.self_intersection().is_empty())
}

#[test]
fn a_closing_c_touches_itself_and_does_not_cross() -> Outcome {
    let more = [CellKind::Tet10].into_iter().filter(|_| slow());
    for kind in [CellKind::Quad4, CellKind::Quad9, CellKind::Hex8].into_iter().chain(more) {
        let free = closing(kind, false)?;
        let state = free.solve(&free.controls(), &STRICT)?;
        assert!(crosses_itself(&free, &state)?, "{kind}: the load is too small");
        let solid = closing(kind, true)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        assert!(!crosses_itself(&solid, &state)?, "{kind}");
        let [pressing, gap] = ["pressing", "smallest_gap"].map(|name| quantity(&solid, &state, name));
        assert!(pressing > 1.0 && gap > 0.0, "{kind}: {pressing} N, gap {gap:e}");
        let (newton, made) = (state.report.newton, state.report.factorisations);
        assert!(newton <= 250 && made <= 4 * newton, "{kind}: {newton} iterations, {made} factorisations");
    }
    Ok(())
}

/// By the tension of the fibres and by the stiffness of the contact.
#[test]
fn the_adjoint_of_touching_surfaces_is_that_of_differences() -> Outcome {
    let solid = closing(CellKind::Quad9, true)?;
    let set = |tension: f64, stiffness: f64| {
        let mut controls = solid.controls();
        controls.values_mut(0).fill(tension);
        controls.values_mut(1)[0] *= stiffness;
        controls
    };
    let base = set(500.0, 1.0);
    let state = solid.solve(&base, &STRICT)?;
    assert!(quantity(&solid, &state, "pressing") > 1.0);
    let g: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let adjoint = solid.adjoint(&state, &[&g], &STRICT)?;
    let by = solid.model().vjp(&Instant::new(&state.u, &base, 1.0), &adjoint.lambda[0])?.controls;
    let found = [-by.values(0).iter().sum::<f64>(), -by.values(1)[0] * base.values(1)[0]];
    let value = |tension: f64, stiffness: f64| -> Outcome<f64> {
        let how = SolveOptions { near: Some(&state), ..STRICT };
        let state = solid.solve(&set(tension, stiffness), &how)?;
        Ok(g.iter().zip(state.u.iter()).map(|(g, u)| g * u).sum())
    };
    let slope = |f: &dyn Fn(f64) -> Outcome<f64>, h: f64| -> Outcome<f64> {
        let difference = |s: f64| -> Outcome<f64> { Ok(f(s * h)? - f(-s * h)?) };
        Ok((45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * h))
    };
    let expected = [slope(&|s| value(500.0 + s, 1.0), 0.02)?, slope(&|s| value(500.0, 1.0 + s), 1e-3)?];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found:e}, differences {expected:e}");
    }
    Ok(())
}

/// A block that would go through the other in one move is stopped before it.
#[test]
fn no_move_crosses() -> Outcome {
    let solid = Solid::new(blocks(CellKind::Hex8, 0.8)?)?.material("body", law())?.clamp("z-")?;
    let solid = solid.contact(Contact::between("between", "lower", "upper"))?;
    let (controls, rest) = (solid.controls(), solid.rest().u);
    let down = |by: f64| -> Vec<f64> {
        common::nodal(solid.mesh(), |x| Vec3::new(0.0, 0.0, if x.z > 1.005 { -by } else { 0.0 }))
    };
    let from = Instant::new(&rest, &controls, 1.0);
    for by in [1.0, 2.5] {
        let share = solid.model().moves().admissible_move(&from, &down(by))?;
        assert!(share * by > 0.5 * GAP && share * by < GAP, "{share} of {by}");
    }
    assert_eq!(solid.model().moves().admissible_move(&from, &down(0.5 * GAP))?, 1.0);
    Ok(())
}

/// Random moves of both bodies, oblique and far, and turns: none lets the bodies into each other.
#[test]
fn random_moves_do_not_cross() -> Outcome {
    let solid = Solid::new(blocks(CellKind::Hex8, 0.8)?)?.material("body", law())?.clamp("z-")?;
    let contact = Contact::between("between", ["lower", "upper"], ["lower", "upper"]).refine(2);
    let solid = solid.contact(contact)?;
    let controls = solid.controls();
    let from = Instant::new(&solid.rest().u, &controls, 1.0).u.to_vec();
    let mut shortened = 0;
    for trial in 0..40 {
        let draw = |i: usize| noise(1000 * trial + i);
        let common = Vec3::new(4.0 * draw(0), 4.0 * draw(1), 4.0 * draw(2));
        // the faces tilt by less than what their samples are apart, so that no edge gets between these
        let (own, tilt) = (Vec3::new(0.2 * draw(3), 0.2 * draw(4), -0.3 * draw(5).abs()), 0.05 * draw(6));
        let to = common::nodal(solid.mesh(), |x| {
            let turn = tilt * Vec3::new(0.0, 0.5 - x.z, x.y - 0.5);
            common + if x.z > 1.005 { own + turn } else { Vec3::zeros() }
        });
        let share = solid.model().moves().admissible_move(&Instant::new(&from, &controls, 1.0), &to)?;
        shortened += usize::from(share < 1.0);
        // what both do together brings them no nearer
        let together = common::nodal(solid.mesh(), |_| common);
        assert_eq!(solid.model().moves().admissible_move(&Instant::new(&from, &controls, 1.0), &together)?, 1.0);
        let u: Vec<f64> = from.iter().zip(&to).map(|(from, to)| from + share * (to - from)).collect();
        let state = State { u: u.into(), ..solid.rest() };
        assert!(!crosses_itself(&solid, &state)?, "trial {trial}: {share}");
    }
    assert!(shortened > 10, "{shortened}");
    Ok(())
}

/// A surface with itself is two surfaces with each other: the same forces, pressures and areas, on any number of threads.
#[test]
fn a_surface_with_itself_is_two_with_each_other() -> Outcome {
    let solid = |contact: Contact| -> Outcome<Solid> {
        let body = Solid::new(blocks(CellKind::Hex8, 1.7)?)?.material("body", law())?.clamp("z-")?.clamp("z+")?;
        Ok(body.contact(contact.thickness(0.009))?)
    };
    let two = solid(Contact::between("between", "lower", "upper"))?;
    let one = solid(Contact::between("between", ["lower", "upper"], ["lower", "upper"]))?;
    let u: Vec<f64> = (0..one.rest().u.len()).map(|i| 0.006 * noise(i)).collect();
    let controls = one.controls();
    let at = Instant::new(&u, &controls, 1.0);
    let message = |solid: &Solid| solid.model().contacts().touches(&at).remove(0).1;
    let (a, b) = (message(&two), message(&one));
    for (a, b) in [(a.pressing, b.pressing), (a.area, b.area), (a.largest_pressure, b.largest_pressure)] {
        assert!(a > 0.0 && (a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }
    let force = |solid: &Solid, parallel: bool| {
        let mut at = Instant::new(&u, &controls, 1.0);
        at.parallel = parallel;
        solid.model().evaluate(&at, Demand { energy: true, force: true }).map(|sums| sums.force)
    };
    let (a, b) = (force(&two, false)?, force(&one, false)?);
    let scale = largest(&a);
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * scale));
    assert_eq!(force(&one, true)?, b);
    let tangent = |parallel: bool| -> Outcome<Vec<f64>> {
        let mut matrix = one.model().tangents().matrix();
        let mut at = Instant::new(&u, &controls, 1.0);
        at.parallel = parallel;
        one.model().tangents().add_tangent(&at, &mut matrix)?;
        let mut out = vec![0.0; u.len()];
        matrix.multiply(&u, &mut out);
        Ok(out)
    };
    assert_eq!(tangent(true)?, tangent(false)?);
    Ok(())
}

/// Bodies that hold each other alone are free together; one that is held holds the other, as far as it pushes.
#[test]
fn contact_between_free_bodies_is_no_support() -> Outcome {
    let body = || -> Outcome<Solid> { Ok(Solid::new(blocks(CellKind::Hex8, 1.0)?)?.material("body", law())?) };
    let contact = || Contact::between("between", ["lower", "upper"], ["lower", "upper"]);
    let free = |solid: &Solid| match solid.solve(&solid.controls(), &STRICT) {
        Err(StateError::Problem(FemError::RigidMotion { free, .. })) => free,
        other => panic!("{other:?}"),
    };
    assert_eq!(free(&body()?), 6);
    // together, as one body
    assert_eq!(free(&body()?.contact(contact())?), 6);
    // without a load the upper one stays where it is, near the lower one or not
    let held = body()?.clamp("z-")?.contact(contact())?;
    let state = held.solve(&held.controls(), &STRICT)?;
    assert!(state.u.iter().all(|u| *u == 0.0) && held.model().stability().neutral_motion(&state, &STRICT)?.is_some());
    let rollers = body()?.displace("x-", [Some(0.0), None, None])?.displace("y-", [None, Some(0.0), None])?;
    let above = rollers.clamp("z-")?.contact(contact())?.body_force("body", Vec3::new(0.0, 0.0, -100.0))?;
    // the upper block of 1 m^3; its nodes lie a little aside of those below
    let state = above.solve(&above.controls(), &STRICT)?;
    let pressing = quantity(&above, &state, "pressing");
    assert!((pressing / 100.0 - 1.0).abs() < 1e-3, "{pressing}");
    Ok(())
}

/// A block thrown at another that is free: the momentum stays, and nothing crosses.
#[test]
fn an_impact_keeps_the_momentum() -> Outcome {
    let solid = Solid::new(blocks(CellKind::Hex8, 0.8)?)?.material("body", law())?;
    let solid = solid.inertia(Inertia::new("body", 1e3).lumped())?;
    let solid = solid.contact(Contact::between("between", "lower", "upper"))?;
    let mut begin = solid.rest();
    let thrown = common::nodal(solid.mesh(), |x| Vec3::new(0.0, 0.0, if x.z > 1.005 { -1.0 } else { 0.0 }));
    begin.velocity = Some(thrown.into());
    let steps: Vec<_> = (0..60).map(|_| StepTo { dt: 5e-3, controls: solid.controls() }).collect();
    let mut trajectory = Trajectory::from_given(begin);
    solid.model().advance(&mut trajectory, &Scheme::backward_euler(), &steps, &STRICT, &mut Workspace::default())?;
    let mass = solid.model().energies().mass()?;
    let momentum = |state: &State| {
        let v = state.velocity.as_ref().unwrap();
        let mut image = vec![0.0; v.len()];
        mass.multiply(v, &mut image);
        image.iter().skip(2).step_by(3).sum::<f64>()
    };
    let states = trajectory.states();
    let begin = momentum(&states[0]);
    let mut pressed = 0;
    for state in states {
        assert!((momentum(state) / begin - 1.0).abs() < 1e-9, "{} for {begin}", momentum(state));
        assert!(!crosses_itself(&solid, state)?);
        pressed += usize::from(quantity(&solid, state, "pressing") > 0.0);
    }
    assert!(pressed > 5, "{pressed}");
    let mean: f64 = states.iter().map(|state| state.report.newton as f64).sum::<f64>() / steps.len() as f64;
    assert!(mean < 12.0, "{mean} iterations a step");
    assert!(largest(&states[60].u) > 0.1);
    Ok(())
}

#[test]
fn what_cannot_touch_is_refused() -> Outcome {
    let body =
        || -> Outcome<Solid> { Ok(Solid::new(blocks(CellKind::Hex8, 1.0)?)?.material("body", law())?.clamp("z-")?) };
    let message =
        |contact: Contact| -> Outcome<String> { Ok(body()?.contact(contact).err().ok_or("not refused")?.to_string()) };
    let between = || Contact::between("between", "lower", "upper");
    let near = message(between().thickness(0.011))?;
    assert!(near.contains("2.000e-2 apart at rest at (0.0") && near.contains("thickness"), "{near}");
    assert!(message(between().thickness(-1.0))?.contains("thickness is -1"));
    assert!(message(between().stiffness(0.0))?.contains("stiffness is 0"));
    assert!(message(between().refine(0))?.contains("refine is 0"));
    assert!(message(Contact::between("between", "lower", "uper"))?.contains("upper"));
    let near = message(between().thickness(0.00996).law(ContactLaw::Log))?;
    assert!(near.contains("at least 2.1 times the thickness"), "{near}");
    for gap in [0.0, -0.1] {
        let body = Solid::new(blocks_apart(CellKind::Hex8, 0.8, gap)?)?.material("body", law())?;
        let meets = body.contact(between()).err().ok_or("not refused")?.to_string();
        assert!(meets.contains("at rest; they are nearest at ("), "{meets}");
    }
    let cell = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1, 1, 1])?)?.material("body", law())?;
    let alone = cell.contact(Contact::between("side", "x-", "x-")).err().ok_or("not refused")?;
    assert!(alone.to_string().contains("neighbours of each other"), "{alone}");
    Ok(())
}
