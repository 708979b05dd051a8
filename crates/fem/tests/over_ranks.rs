//! One body over ranks, which are threads here: the equilibria and gradients of one rank.

use crate::common;

use common::Outcome;
use common::parts::{Divide, Sent, how, on, part, scattered, total};
use nastic_energy::{FiberTension, MooneyRivlin, NeoHooke};
use nastic_fem::{
    Cavity, Contact, Controls, FemError, Formulation, Foundation, Inertia, MovingSupport, Progress, QuadraturePoints,
    Solid, SolveOptions, SolveReport, Spring, State, StateError,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, box_mesh};
use nastic_team::Team;
use nastic_team::threads::Faults;
use nastic_tensor::Vec3;
use std::sync::Mutex;

/// The fibre cantilever of reference.rs.
fn cantilever(solid: Solid) -> Outcome<Solid> {
    Ok(solid
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

fn tension(solid: &Solid, factor: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    let tension: Vec<f64> = at.iter().map(|x| -1.5e5 * factor * x[2] / 0.2).collect();
    controls.set(0, 0, &tension)?;
    Ok(controls)
}

/// The displacement of a node of the whole, where this rank owns it; else zero.
fn displacement(solid: &Solid, state: &State, at: [f64; 3]) -> [f64; 3] {
    let share = solid.model().unknowns().share();
    let owned = share.map_or(usize::MAX, |share| share.owned());
    let node = common::node_at(solid.mesh(), at).filter(|node| *node < owned);
    let own = node.map_or([0.0; 3], |node| [0, 1, 2].map(|k| state.u[3 * node + k]));
    own.map(|u| total(share, u))
}

const CORNER: [f64; 3] = [1.0, 0.2, 0.2];

#[test]
fn the_fibre_cantilever_has_the_digits_of_other_codes_on_any_number_of_ranks() -> Outcome {
    let cases = [
        (CellKind::Hex8, [-0.186179761, 0.008186681, 0.235506464], 1340.90738505),
        (CellKind::Hex27, [-0.221675516, 0.007753715, 0.282876107], 1332.20755217),
    ];
    for (kind, tip, energy) in cases {
        let mesh = box_mesh([1.0, 0.2, 0.2], [10, 2, 2], kind)?;
        let mut newton = Vec::new();
        for ranks in 1..=4 {
            let found = on(ranks, &Faults::default(), |rank| {
                let solid = cantilever(part(&mesh, &rank)?)?;
                let state = solid.solve(&tension(&solid, 1.0)?, &how())?;
                Ok((displacement(&solid, &state, CORNER), state.report.energy, state.report.min_j, state.report.newton))
            });
            let (corner, total, ..) = found[0].clone()?;
            assert!(found.iter().all(|other| *other == found[0]), "all ranks know the same: {found:?}");
            assert!((0..3).all(|k| (corner[k] - tip[k]).abs() < 1e-9), "{kind:?} on {ranks}: {corner:?}");
            assert!((total - energy).abs() < 1e-7, "{total}");
            newton.push(found[0].clone()?.3);
        }
        assert!(newton.iter().all(|count| *count == newton[0]), "{newton:?}");
    }
    Ok(())
}

/// `j = |u_corner - (0, 0, 0.2)|^2 / 2` and its derivative by the factor of the tension.
fn tracking(solid: &Solid, factor: f64, how: &SolveOptions) -> Outcome<(f64, f64)> {
    let state = solid.solve(&tension(solid, factor)?, how)?;
    let mut off = displacement(solid, &state, CORNER);
    off[2] -= 0.2;
    let mut rhs = vec![0.0; state.u.len()];
    if let Some(node) = common::node_at(solid.mesh(), CORNER) {
        (0..3).for_each(|k| rhs[3 * node + k] = -off[k]);
    }
    let adjoint = solid.adjoint(&state, &[&rhs], how)?;
    let at = nastic_fem::Instant::of(&state);
    let found = solid.model().vjp(&at, &adjoint.lambda[0])?;
    let along = tension(solid, 1.0)?;
    let own: f64 = found.controls.values(0).iter().zip(along.values(0)).map(|(a, b)| a * b).sum();
    Ok((0.5 * off.iter().map(|x| x * x).sum::<f64>(), total(solid.model().unknowns().share(), own)))
}

#[test]
fn gradients_are_those_of_one_rank_and_of_differences() -> Outcome {
    for (kind, divide) in [(CellKind::Hex8, part as Divide), (CellKind::Tet10, scattered)] {
        let mesh = box_mesh([1.0, 0.2, 0.2], [6, 2, 2], kind)?;
        let serial = cantilever(Solid::new(mesh.clone())?)?;
        let (j, slope) = tracking(&serial, 0.7, &SolveOptions::default())?;
        for ranks in 1..=4 {
            let found = on(ranks, &Faults::default(), |rank| {
                let solid = cantilever(divide(&mesh, &rank)?)?;
                let step = 1e-4;
                let values = [0.7, 0.7 + step, 0.7 - step].map(|factor| tracking(&solid, factor, &how()));
                let [here, ahead, behind] = values;
                Ok((here?, (ahead?.0 - behind?.0) / (2.0 * step)))
            });
            for found in found {
                let ((own, own_slope), difference) = found?;
                assert!((own - j).abs() < 1e-9 * j.abs(), "{own} {j}");
                assert!((own_slope - slope).abs() < 1e-8 * slope.abs(), "{own_slope} {slope}");
                assert!((own_slope - difference).abs() < 1e-6 * slope.abs(), "{own_slope} {difference}");
            }
        }
    }
    Ok(())
}

/// The finger with two muscles of a file of Gmsh: soft below, stiffer muscles with fibres above.
fn finger(solid: Solid) -> Outcome<Solid> {
    let along = FiberTension::along(Vec3::x())?;
    Ok(solid
        .material("silicone", NeoHooke::from_young_poisson(2e5, 0.4)?)?
        .material(["inner", "outer"], MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate(["inner", "outer"], "muscle", along)?
        .clamp("base")?)
}

/// `j = 1/2 int_skin |u - t|^2 dA`, `t = (0, 0, 5 mm) X / 80 mm`, and its derivative by the tension of the muscles.
fn skin_tracking(solid: &Solid, tension: f64, how: &SolveOptions) -> Outcome<(f64, f64)> {
    let space = solid.model().unknowns().clone();
    let mut controls = solid.controls();
    controls.values_mut(0).fill(tension);
    let state = solid.solve(&controls, how)?;
    let mesh = solid.mesh();
    let skin = QuadraturePoints::of_facets(mesh, mesh.surface("skin")?, |kind| kind.rule().clone());
    let (at, u) = (skin.positions(mesh, None), skin.interpolate(&state.u, 3));
    let gap = |q: usize, k: usize| u[3 * q + k] - if k == 2 { 5e-3 * at[q][0] / 80e-3 } else { 0.0 };
    let weighted = |q: usize, k: usize| skin.weights()[q] * gap(q, k);
    let entries = || (0..skin.len()).flat_map(|q| (0..3).map(move |k| (q, k)));
    let cost = 0.5 * entries().map(|(q, k)| weighted(q, k) * gap(q, k)).sum::<f64>();
    let (forces, mut rhs) = (entries().map(|(q, k)| -weighted(q, k)).collect::<Vec<_>>(), vec![0.0; state.u.len()]);
    skin.spread(&forces, 3, &mut rhs);
    space.add_up(&mut rhs);
    let adjoint = solid.adjoint(&state, &[&rhs], how)?;
    let found = solid.model().vjp(&nastic_fem::Instant::of(&state), &adjoint.lambda[0])?;
    Ok((space.total(cost), space.total(found.controls.values(0).iter().sum())))
}

#[test]
fn a_body_of_two_materials_from_gmsh_has_its_surface_cost_across_five_parts() -> Outcome {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/jointed_finger.msh");
    let mesh = nastic_io::read_mesh(file, 1e-3)?;
    let serial = finger(Solid::new(mesh.clone())?)?;
    let (j, slope) = skin_tracking(&serial, -2e4, &SolveOptions { parallel: false, ..SolveOptions::default() })?;
    let found = on(5, &Faults::default(), |rank| {
        let solid = finger(part(&mesh, &rank)?)?;
        let at = |tension: f64| skin_tracking(&solid, tension, &how());
        let [here, far, near] = [-2e4, -2e4 + 2e3, -2e4 + 1e3].map(at);
        Ok((solid.mesh().surface("skin")?.len(), here?, [far?.0, near?.0]))
    });
    for found in found {
        let (facets, (own, own_slope), [far, near]) = found?;
        assert!(facets > 0, "the skin is in all parts");
        assert!((own - j).abs() < 1e-9 * j && (own_slope - slope).abs() < 1e-8 * slope.abs(), "{own_slope} {slope}");
        let order = ((far - own - 2e3 * own_slope) / (near - own - 1e3 * own_slope)).log2();
        assert!(order > 1.95, "Taylor remainders: {order}");
    }
    Ok(())
}

/// Loads on a surface across parts, a foundation, prescribed displacements; two materials in a mixed formulation by cell.
fn loaded(solid: Solid) -> Outcome<Solid> {
    Ok(solid
        .material("body", NeoHooke::new(1e5, 1e7)?)?
        .formulation("body", Formulation::MeanDilatation)?
        .traction("z+", Vec3::new(0.0, 0.0, -2e3))?
        .body_force("body", Vec3::new(0.0, 1e3, 0.0))?
        .foundation(Foundation::on("z-", 5e5))?
        .displace("x-", [Some(0.0), None, None])?
        .displace("x+", [Some(0.02), None, None])?)
}

#[test]
fn loads_supports_and_foundations_act_once_where_parts_meet() -> Outcome {
    let mesh = box_mesh([1.0, 0.6, 0.4], [5, 3, 2], CellKind::Hex8)?;
    let serial = loaded(Solid::new(mesh.clone())?)?;
    let expected = serial.solve(&serial.controls(), &SolveOptions::default())?;
    for ranks in 2..=5 {
        let found = on(ranks, &Faults::default(), |rank| {
            let own = mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?;
            let nodes = own.nodes().to_vec();
            let solid = loaded(Solid::of_part(own, rank.clone())?)?;
            let state = solid.solve(&solid.controls(), &how())?;
            Ok((nodes, state.u.to_vec(), state.report.energy))
        });
        for found in found {
            let (nodes, u, energy) = found?;
            assert!((energy - expected.report.energy).abs() < 1e-9 * energy.abs(), "{energy}");
            for (u, node) in u.chunks_exact(3).zip(nodes) {
                let whole = &expected.u[3 * node as usize..][..3];
                assert!((0..3).all(|k| (u[k] - whole[k]).abs() < 1e-10), "{u:?} {whole:?}");
            }
        }
    }
    Ok(())
}

/// A grip that shifts and turns, two springs to the ground, one of which alone holds a component, and one between two near places.
fn gripped(solid: Solid) -> Outcome<(Solid, Controls)> {
    let solid = solid
        .material("body", NeoHooke::new(1e5, 1e6)?)?
        .displace("x-", [Some(0.0), None, Some(0.0)])?
        .motion(MovingSupport::of("grip", "x+").components(&[0, 2]))?
        .spring(Spring::to_ground("wire", [0.52, 0.1, 0.1], [0.5, 0.1, -0.5], 5e3).rest_length(0.2))?
        .spring(Spring::to_ground("side", [0.3, 0.2, 0.05], [0.3, 1.0, 0.05], 2e3))?
        .spring(Spring::between("stitch", [0.05, 0.02, 0.0], [0.1, 0.08, 0.2], 4e3).rest_length(0.1))?;
    let mut controls = solid.controls();
    controls.values_mut(0).copy_from_slice(&[0.02, 0.0, -0.05, 0.0, 0.2, 0.0]);
    Ok((solid, controls))
}

#[test]
fn moving_supports_and_springs_act_as_on_one_rank() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 2, 2], CellKind::Hex8)?;
    let (serial, controls) = gripped(Solid::new(mesh.clone())?)?;
    let expected = serial.solve(&controls, &SolveOptions::default())?;
    // a functional that depends on the place of the grip
    let slopes = |solid: &Solid, state: &State, rhs: &[f64], how: &SolveOptions| -> Outcome<Vec<f64>> {
        let adjoint = solid.adjoint(state, &[rhs], how)?;
        let by_u: Vec<f64> = rhs.iter().map(|b| -b).collect();
        let found = solid.model().prescribed_unknowns().sensitivities(
            &nastic_fem::Instant::of(state),
            &by_u,
            &adjoint.lambda[0],
        )?;
        let space = solid.model().unknowns();
        Ok(found.controls.values(0).iter().map(|own| space.total(*own)).collect())
    };
    let rhs = |solid: &Solid, state: &State| -> Vec<f64> {
        let twisted = |(k, u): (usize, &f64)| -u - 0.1 * solid.mesh().points()[k / 3][k % 3];
        state.u.iter().enumerate().map(twisted).collect()
    };
    let by_grip = slopes(&serial, &expected, &rhs(&serial, &expected), &SolveOptions::default())?;
    let size = by_grip.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
    // the grip on one rank; across ranks, and the wire at an edge between them
    for (ranks, divide) in [(1, part as Divide), (3, part), (4, scattered)] {
        let found = on(ranks, &Faults::default(), |rank| {
            let (solid, controls) = gripped(divide(&mesh, &rank)?)?;
            let nodes = solid.discretization().over_ranks().map(|(part, _)| part.nodes().to_vec()).unwrap_or_default();
            let state = solid.solve(&controls, &how())?;
            let slopes = slopes(&solid, &state, &rhs(&solid, &state), &how())?;
            Ok((nodes, state.u.to_vec(), state.report.energy, slopes))
        });
        for found in found {
            let (nodes, u, energy, slopes) = found?;
            assert!((energy - expected.report.energy).abs() < 1e-8 * energy.abs(), "{energy}");
            assert!(slopes.iter().zip(&by_grip).all(|(a, b)| (a - b).abs() < 1e-8 * size), "{slopes:?} {by_grip:?}");
            for (u, node) in u.chunks_exact(3).zip(nodes) {
                let whole = &expected.u[3 * node as usize..][..3];
                assert!((0..3).all(|k| (u[k] - whole[k]).abs() < 1e-9), "{u:?} {whole:?}");
            }
        }
    }
    Ok(())
}

#[test]
fn a_body_that_supports_of_no_part_hold_is_refused_by_all_ranks() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, &Faults::default(), |rank| {
        let solid = part(&mesh, &rank)?.material("body", NeoHooke::new(1e5, 1e6)?)?;
        let solid = solid.displace("x-", [Some(0.0), None, None])?;
        let free = match solid.solve(&solid.controls(), &how()) {
            Err(StateError::Problem(FemError::RigidMotion { free, .. })) => free,
            other => return Err(format!("{other:?}").into()),
        };
        // held by different ranks together
        let solid = solid.displace("x+", [None, Some(0.0), Some(0.0)])?.displace("x-", [None, Some(0.0), Some(0.0)])?;
        Ok((free, solid.solve(&solid.controls(), &how()).is_ok()))
    });
    assert!(found.iter().all(|found| *found == Ok((3, true))), "{found:?}");
    Ok(())
}

#[test]
fn what_does_not_span_ranks_is_refused_by_name() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let tets = box_mesh([1.0, 0.2, 0.2], [3, 1, 1], CellKind::Tet4)?;
    let found = on(2, &Faults::default(), |rank| {
        let solid = cantilever(part(&mesh, &rank)?)?;
        let state = solid.solve(&solid.controls(), &how())?;
        let names = |refused: Result<Solid, FemError>, what: &str| match refused {
            Err(FemError::Unsupported { what: found, with, .. }) => found.contains(what) && with == "a body over ranks",
            _ => false,
        };
        let refused = |error: StateError, named: &str| match error {
            StateError::Problem(FemError::Unsupported { what, .. }) => what.contains(named),
            _ => false,
        };
        let patches = part(&tets, &rank)?.material("body", NeoHooke::new(1e5, 1e6)?)?;
        let floor = Obstacle::half_space([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]);
        let alone = SolveOptions { solver: None, ..how() };
        let refusals = [
            names(solid.clone().cavity(Cavity::new("air", "x+")), "cavity"),
            names(solid.clone().spring(Spring::between("wire", [0.0; 3], CORNER, 1.0)), "spring"),
            names(solid.clone().contact(Contact::of("floor", "z-", floor)), "contact"),
            names(solid.clone().inertia(Inertia::new("body", 1e3)), "inertia"),
            names(patches.formulation("body", Formulation::MeanDilatation), "tet4"),
            solid.solve(&solid.controls(), &alone).is_err_and(|error| refused(error, "direct")),
            solid.modes(&state, 2, &how()).is_err_and(|error| refused(error, "modes")),
        ];
        Ok(refusals)
    });
    assert!(found.iter().all(|found| *found == Ok([true; 7])), "{found:?}");
    Ok(())
}

#[test]
fn what_inverts_on_one_rank_is_inadmissible_on_all() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, &Faults::default(), |rank| {
        let solid = cantilever(part(&mesh, &rank)?)?;
        let (mut u, controls) = (vec![0.0; solid.model().unknowns().len()], solid.controls());
        if let Some(node) = common::node_at(solid.mesh(), CORNER) {
            u[3 * node] = -2.0;
        }
        let at = nastic_fem::Instant::new(&u, &controls, 1.0);
        let found = solid.model().evaluate(&at, nastic_fem::Demand { energy: true, force: true });
        Ok(found.err().map(|error| error.code()))
    });
    let inverted = found.iter().filter(|found| **found == Ok(Some("inverted"))).count();
    let elsewhere = found.iter().filter(|found| **found == Ok(Some("elsewhere"))).count();
    assert_eq!((inverted, elsewhere), (1, 2), "{found:?}");
    Ok(())
}

#[test]
fn a_watch_of_one_rank_alone_sees_every_step() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, &Faults::default(), |rank| {
        let solid = cantilever(part(&mesh, &rank)?)?;
        let seen = Mutex::new(Vec::new());
        let see = |at: &Progress| seen.lock().map_or((), |mut seen| seen.push(at.residual));
        let watch = rank.leads().then_some(&see as &(dyn Fn(&Progress) + Sync));
        let state = solid.solve(&tension(&solid, 0.5)?, &SolveOptions { watch, ..how() })?;
        let seen = seen.lock().map_err(|error| error.to_string())?.clone();
        Ok((seen, state.report.newton, state.report.residual))
    });
    for (rank, found) in found.into_iter().enumerate() {
        let (seen, newton, residual) = found?;
        assert_eq!(seen.len(), if rank == 0 { newton } else { 0 });
        assert!(newton > 2 && seen.last().is_none_or(|last| *last == residual), "{seen:?} {residual}");
    }
    Ok(())
}

/// What was refused: here, or by another rank.
fn refused<T>(found: Result<T, StateError>) -> &'static str {
    match found {
        Err(StateError::Problem(FemError::Elsewhere)) => "elsewhere",
        Err(StateError::Problem(FemError::NoMaterial { .. })) => "no material",
        Err(StateError::Problem(FemError::NotFinite { .. })) => "not finite",
        Err(StateError::Problem(FemError::Length { .. })) => "length",
        Err(_) => "another error",
        Ok(_) => "nothing",
    }
}

#[test]
fn what_one_rank_refuses_ends_the_calls_of_all_and_they_go_on() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, &Faults::default(), |rank| {
        let (own, bare) = (rank.rank(), part(&mesh, &rank)?.clamp("x-")?);
        let bare = if own == 1 { bare } else { bare.material("body", NeoHooke::new(1e5, 1e6)?)? };
        let without = refused(bare.solve(&bare.controls(), &how()));
        let solid = cantilever(part(&mesh, &rank)?)?;
        let (good, mut bad) = (tension(&solid, 0.1)?, tension(&solid, 0.1)?);
        if own == 2 {
            bad.values_mut(0)[0] = f64::NAN;
        }
        let not_finite = refused(solid.solve(&bad, &how()));
        let guess = vec![0.0; if own == 0 { 1 } else { solid.model().unknowns().len() }];
        let guessed = refused(solid.solve(&good, &SolveOptions { guess: Some(&guess), ..how() }));
        let state = solid.solve(&good, &how())?;
        let rhs = vec![1.0; if own == 1 { 1 } else { state.u.len() }];
        Ok([without, not_finite, guessed, refused(solid.adjoint(&state, &[&rhs], &how()))])
    });
    let (at, away) = (["no material", "not finite", "length", "length"], "elsewhere");
    let expected: Vec<Sent<_>> =
        vec![Ok([away, away, at[2], away]), Ok([at[0], away, away, at[3]]), Ok([away, at[1], away, away])];
    assert_eq!(found, expected);
    Ok(())
}

#[test]
fn a_start_that_displaces_the_parts_of_some_ranks_alone_is_one() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let found = on(3, &Faults::default(), |rank| {
        let solid = cantilever(part(&mesh, &rank)?)?;
        let controls = tension(&solid, 0.2)?;
        let expected = solid.solve(&controls, &how())?.report.energy;
        let u: Vec<f64> = solid.mesh().points().iter().flat_map(|x| [0.0, 0.0, 0.01 * (x[0] - 0.6).max(0.0)]).collect();
        let rests = u.iter().all(|u| *u == 0.0);
        let near = State::equilibrium(u, solid.controls(), 0.0, SolveReport::default());
        let energy = solid.solve(&controls, &SolveOptions { near: Some(&near), ..how() })?.report.energy;
        Ok((rests, (energy / expected - 1.0).abs() < 1e-8))
    });
    assert_eq!(found.iter().filter(|found| **found == Ok((true, true))).count(), 1, "{found:?}");
    assert_eq!(found.iter().filter(|found| **found == Ok((false, true))).count(), 2, "{found:?}");
    Ok(())
}

#[test]
fn supports_are_not_said_to_hold_where_messages_fail() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    for message in [1, 6] {
        let faults = Faults { lost: Some((1, message)), ..Faults::default() };
        let found = on(3, &faults, |rank| {
            let solid = cantilever(part(&mesh, &rank)?)?;
            Ok(matches!(solid.check(), Err(FemError::Team(_))))
        });
        assert!(found.iter().all(|found| *found == Ok(true)), "{message}: {found:?}");
    }
    Ok(())
}

#[test]
fn a_lost_rank_ends_the_solves_of_the_others() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    for message in [3, 60, 400] {
        let faults = Faults { lost: Some((1, message)), ..Faults::default() };
        let found = on(3, &faults, |rank| {
            let solid = cantilever(part(&mesh, &rank)?)?;
            let solved = solid.solve(&tension(&solid, 0.5)?, &how());
            Ok(matches!(solved, Err(StateError::Problem(FemError::Team(_)))))
        });
        assert!(found.iter().all(|found| *found == Ok(true)), "{message}: {found:?}");
    }
    Ok(())
}
