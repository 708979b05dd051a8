//! Dielectric bodies and electrodes: a published tangent, closed forms of films, charges, what is refused.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::dielectric::{LAMBDA, MU, between_plates, block, on_rollers};
use nastic_energy::{MooneyRivlin, NeoHooke, NeoHookeIsochoric};
use nastic_fem::{
    DielectricBody, Electrode, EventKind, Instant, PathOptions, Solid, State, Workspace, check_contribution,
};
use nastic_mesh::CellKind;

/// A body of one dielectric with electrodes on both sides, whose upper one is driven by `drive`.
fn capacitor(solid: Solid, permittivity: f64, drive: Electrode) -> Outcome<Solid> {
    let body = DielectricBody::of("layer", "body", permittivity);
    Ok(solid.electric(&[body], &[Electrode::on("ground", "z-"), drive])?)
}

fn solve(solid: &Solid, values: &[(&str, f64)]) -> Outcome<State> {
    let mut controls = solid.controls();
    for (name, value) in values {
        let block = solid.model().controllable().iter().position(|c| c.name == *name).ok_or("no such control")?;
        controls.values_mut(block)[0] = *value;
    }
    Ok(solid.solve(&controls, &STRICT)?)
}

fn quantity(solid: &Solid, state: &State, name: &str, quantity: &str) -> Outcome<f64> {
    let all = solid.model().quantities(&Instant::of(state))?;
    let found = all.into_iter().find(|(of, what, _)| of == name && *what == quantity);
    Ok(found.ok_or_else(|| format!("no {quantity} of {name}"))?.2)
}

/// One unit cell at rest with phi = x, as HyperFEM.jl has it: the 32 x 32 tangent by displacements, then potentials.
#[test]
fn a_published_tangent() -> Outcome {
    let cell = Solid::new(common::regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", MooneyRivlin::new(0.5, 1.0, 1.5)?)?
        .dielectric_body(&DielectricBody::of("layer", "body", 4.0))?;
    let mut u = vec![0.0; 32];
    cell.mesh().points().iter().enumerate().for_each(|(node, x)| u[4 * node + 3] = x[0]);
    let controls = cell.controls();
    let at = Instant::new(&u, &controls, 1.0);
    let column = |dof: usize| -> Outcome<Vec<f64>> {
        let (mut unit, mut out) = (vec![0.0; 32], vec![0.0; 32]);
        unit[dof] = 1.0;
        assert!(cell.model().tangents().tangent_product(&at, &unit, &mut out)?);
        Ok(out)
    };
    let columns = (0..32).map(column).collect::<Outcome<Vec<_>>>()?;
    let norm = columns.iter().flatten().map(|k| k * k).sum::<f64>().sqrt();
    let (first, last) = (columns[0][0], columns[31][31]);
    assert!((norm / 18.9345852 - 1.0).abs() < 5e-9, "{norm}");
    assert!((first - 7.0 / 9.0).abs() < 1e-9 && (last + 4.0 / 3.0).abs() < 1e-9, "{first} {last}");
    Ok(())
}

/// Residual, tangent and second derivatives on every kind of cell, of a part of the body.
#[test]
fn every_cell_keeps_the_contract() -> Outcome {
    let solids = CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1);
    for kind in solids {
        let Ok(mesh) = common::regular(kind, [1.0, 0.7, 0.6], [2, 1, 1]) else { continue };
        let half: Vec<u32> = (0..mesh.cells() as u32 / 2).collect();
        let solid = Solid::new(mesh.with_region("half", half))?.material("body", NeoHooke::new(MU, LAMBDA)?)?;
        let solid = solid.dielectric_body(&DielectricBody::of("layer", "half", 3.0))?;
        check_contribution(solid.model(), "layer", 7).map_err(|why| format!("{kind}: {why}"))?;
    }
    Ok(())
}

/// Two plates pull each other through a body; charge, capacitance, energy and true field follow, and the charge given instead of the voltage leads to the same state.
#[test]
fn a_capacitor_under_voltage_and_under_charge() -> Outcome {
    let (permittivity, voltage, thickness) = (0.7, 0.1, 0.25);
    for kind in [CellKind::Hex8, CellKind::Tet10] {
        let body = || on_rollers(block(kind, [1.0, 0.8, thickness], [2, 2, 3])?);
        let solid = capacitor(body()?, permittivity, Electrode::on("top", "z+"))?;
        let state = solve(&solid, &[("top", voltage)])?;
        let top = common::node_at(solid.mesh(), [0.0, 0.0, thickness]).ok_or("no node")?;
        let along = 1.0 + state.u[4 * top + 2] / thickness;
        let [across, expected] = between_plates(permittivity, along, thickness);
        assert!(along < 0.98 && (expected - voltage).abs() < 1e-10, "{along} {expected}");
        let charge = quantity(&solid, &state, "top", "charge")?;
        let field = voltage / (along * thickness);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert!(near(charge, permittivity * field * 0.8 * across * across), "{charge}");
        assert!(near(quantity(&solid, &state, "top", "capacitance")?, charge / voltage));
        assert!(near(quantity(&solid, &state, "ground", "charge")?, -charge));
        assert!(near(quantity(&solid, &state, "layer", "true_field")?, field));
        assert!(near(quantity(&solid, &state, "layer", "electric_energy")?, 0.5 * charge * voltage));
        let charged = capacitor(body()?, permittivity, Electrode::on("top", "z+").charged())?;
        check_contribution(charged.model(), "top", 3)?;
        let same = solve(&charged, &[("top", charge)])?;
        let apart = common::distance(&same.u, &state.u);
        assert!(apart < 1e-10, "{kind}: {apart:e}");
        assert!(near(quantity(&charged, &same, "top", "voltage")?, voltage));
        assert!(near(quantity(&charged, &same, "top", "charge")?, charge));
        for (solid, state) in [(&solid, &state), (&charged, &same)] {
            assert_eq!(solid.model().stability().negative_pivots(state)?, 0);
        }
    }
    Ok(())
}

/// In SI numbers the unknowns are of sizes that lie fifteen powers of ten apart.
const STIFF: f64 = 1e5;
const EPS: f64 = 2.5e-11;
const THICKNESS: f64 = 1e-4;

/// One cell of a film in SI numbers, of a ratio of bulk to shear modulus, free to widen in the plane, or along x alone.
fn film(equibiaxial: bool, ratio: f64, drive: Electrode) -> Outcome<Solid> {
    let solid = Solid::new(common::regular(CellKind::Hex8, [1e-3, 1e-3, THICKNESS], [1; 3])?)?;
    let solid = on_rollers(solid.material("body", NeoHookeIsochoric::new(STIFF, ratio * STIFF)?)?)?;
    let solid = if equibiaxial { solid } else { solid.displace("y+", [None, Some(0.0), None])? };
    capacitor(solid, EPS, drive)
}

fn stretch(solid: &Solid, state: &State) -> Outcome<f64> {
    let corner = common::node_at(solid.mesh(), [1e-3, 1e-3, THICKNESS]).ok_or("no corner")?;
    Ok(1.0 + state.u[4 * corner] / 1e-3)
}

/// `eps E^2/mu = l^-2 - l^-8` with free sides, `1 - l^-4` in plane strain, `E` the nominal field; under a charge `D^2/(mu eps) = l^6 - 1`, `l^4 - 1`: without pull-in. Both to the
/// share of the volume that the pressure takes, some `mu / kappa`.
#[test]
fn films_follow_their_closed_forms() -> Outcome {
    for equibiaxial in [true, false] {
        let solid = film(equibiaxial, 1e3, Electrode::on("top", "z+"))?;
        let message = |l: f64| if equibiaxial { l.powi(-2) - l.powi(-8) } else { 1.0 - l.powi(-4) };
        for l in [1.1, if equibiaxial { 1.2 } else { 1.5 }] {
            let voltage = THICKNESS * (message(l) * STIFF / EPS).sqrt();
            let state = solve(&solid, &[("top", voltage)])?;
            let found = stretch(&solid, &state)?;
            assert!((found - l).abs() < 2e-3, "{equibiaxial}: {found} {l}");
            assert_eq!(solid.model().stability().negative_pivots(&state)?, 0);
        }
        let charged = film(equibiaxial, 1e3, Electrode::on("top", "z+").charged())?;
        for l in [1.1, 1.3, 1.5_f64] {
            // area 1e-6
            let power = if equibiaxial { 6 } else { 4 };
            let charge = 1e-6 * ((l.powi(power) - 1.0) * STIFF * EPS).sqrt();
            let state = solve(&charged, &[("top", charge)])?;
            let found = stretch(&charged, &state)?;
            assert!((found / l - 1.0).abs() < 5e-3, "charge, {equibiaxial}: {found} {l}");
            assert_eq!(charged.model().stability().negative_pivots(&state)?, 0);
        }
    }
    Ok(())
}

/// The path of a film in its voltage turns back at l = 4^(1/6).
#[test]
fn a_film_pulls_in_where_its_closed_form_says() -> Outcome {
    let solid = film(true, 1e5, Electrode::on("top", "z+"))?;
    let at = |voltage: f64| {
        let mut controls = solid.controls();
        let block = solid.model().controllable().iter().position(|c| c.name == "top").unwrap_or_default();
        controls.values_mut(block)[0] = voltage;
        controls
    };
    let critical = 0.687_364_818_5 * THICKNESS * (STIFF / EPS).sqrt();
    let start = solid.solve(&at(0.3 * critical), &STRICT)?;
    let options = PathOptions { to_limit: true, ..PathOptions::default() };
    let (stability, mut workspace) = (solid.model().stability(), Workspace::default());
    let end = at(1.3 * critical);
    let path = stability.path(&start, (&end, 1.0), &options, &STRICT, &mut workspace, &mut |_| ())?;
    let limit = path.events.iter().find(|event| event.kind == EventKind::LimitPoint).ok_or("no limit point")?;
    let (found, l) = (0.3 + limit.s, stretch(&solid, &limit.state)?);
    assert!((found - 1.0).abs() < 1e-4, "{found}");
    assert!((l / 4f64.powf(1.0 / 6.0) - 1.0).abs() < 1e-4, "{l}");
    assert_eq!((limit.before, limit.after), (Some(0), Some(1)));
    for point in &path.points {
        assert_eq!(point.negative, Some(usize::from(point.slope < 0.0)), "{} {}", point.s, point.slope);
    }
    Ok(())
}

/// What cannot be, each in a sentence with its place.
#[test]
fn what_cannot_be_is_said() -> Outcome {
    let body = || -> Outcome<Solid> { on_rollers(block(CellKind::Hex8, [1.0; 3], [2; 3])?) };
    let layer = |name: &str, region: &str| DielectricBody::of(name, region, 2.0);
    let said = |built: Result<Solid, nastic_fem::FemError>| -> Outcome<String> {
        Ok(built.map(drop).err().ok_or("it was built")?.to_string())
    };
    let share =
        said(body()?.electric(&[layer("a", "body")], &[Electrode::on("one", "z+"), Electrode::on("two", "x+")]))?;
    assert!(share.contains("\"one\"") && share.contains("\"two\"") && share.contains("share node"), "{share}");
    let floats = Electrode::on("top", "z+");
    for free in [floats.clone().floating(), floats.clone().charged()] {
        let free = said(body()?.electric(&[layer("a", "body")], &[free]))?;
        assert!(free.contains("a voltage"), "{free}");
    }
    let bare = said(body()?.electric(&[], &[floats]))?;
    assert!(bare.contains("no dielectric"), "{bare}");
    let weak = said(body()?.dielectric_body(&DielectricBody::of("a", "body", 0.0)))?;
    assert!(weak.contains("permittivity of 0"), "{weak}");
    let half: Vec<u32> = (0..4).collect();
    let mesh = body()?.mesh().as_ref().clone().with_region("low", half);
    let two = on_rollers(Solid::new(mesh)?.material("body", NeoHooke::new(MU, LAMBDA)?)?)?;
    let apart =
        said(two.clone().electric(&[layer("a", "low")], &[Electrode::on("ground", "z-"), Electrode::on("top", "z+")]))?;
    assert!(apart.contains("\"top\"") && apart.contains("no node"), "{apart}");
    // the other half has no potential
    let closed = two.electric(&[layer("a", "low")], &[Electrode::on("ground", "z-")])?;
    let state = closed.solve(&closed.controls(), &STRICT)?;
    assert!(closed.model().field("potential", &state.u)?.iter().all(|phi| *phi == 0.0));
    Ok(())
}

/// A quarter of two rings, 1 to 1.5 and 1.5 to 2, of permittivities 4 and 1 between cylinders: its capacitance is that of two in series, with errors of order 2 and above 3 in the mesh.
#[test]
fn rings_have_the_capacitance_of_their_closed_form() -> Outcome {
    let exact = 0.5 * std::f64::consts::PI / (1.5_f64.ln() / 4.0 + (2.0_f64 / 1.5).ln());
    for (kind, least) in [(CellKind::Quad4, 1.9), (CellKind::Tri3, 1.9), (CellKind::Quad8, 3.5), (CellKind::Tri6, 3.5)]
    {
        let error = |n: usize| -> Outcome<f64> {
            let square = common::regular(kind, [1.0, 1.0, 0.0], [n, n, 1])?;
            let inner = |cell: &u32| square.cell_centre(*cell as usize)[0] < 0.5;
            let (near, far) = (0..square.cells() as u32).partition::<Vec<u32>, _>(inner);
            let square = square.with_region("near", near).with_region("far", far);
            let ring = square.mapped(|x| {
                let (r, turn) = (1.0 + x[0], 0.5 * std::f64::consts::PI * x[1]);
                [r * turn.cos(), r * turn.sin(), 0.0]
            })?;
            let solid = Solid::new(ring)?.material("body", NeoHooke::new(MU, LAMBDA)?)?.clamp("x-")?;
            let bodies = [DielectricBody::of("inner", "near", 4.0), DielectricBody::of("outer", "far", 1.0)];
            let solid = solid.electric(&bodies, &[Electrode::on("ground", "x-"), Electrode::on("top", "x+")])?;
            // too little to move it
            let state = solve(&solid, &[("top", 1e-6)])?;
            Ok((quantity(&solid, &state, "top", "capacitance")? / exact - 1.0).abs())
        };
        let (coarse, fine) = (error(4)?, error(8)?);
        let order = (coarse / fine).log2();
        assert!(order > least && fine < 5e-3, "{kind}: {coarse:e} {fine:e}, order {order}");
    }
    Ok(())
}

/// A plate on a spring k over a gap d of air pulls in at d/3 and V^2 = 8 k d^3/(27 eps); the softer the air, the nearer. The plate and its spring conduct.
#[test]
fn a_plate_on_a_spring_pulls_in_over_air() -> Outcome {
    let (gap, length, permittivity) = (1.0_f64, 100.0_f64, 0.5_f64);
    let stiffness = (LAMBDA + 2.0 * MU) / length;
    let critical = (8.0 * stiffness * gap.powi(3) / (27.0 * permittivity)).sqrt();
    let error = |soft: f64| -> Outcome<[f64; 2]> {
        let mesh = common::regular(CellKind::Hex8, [1.0, 1.0, 3.0], [1, 1, 3])?;
        let mesh = mesh.with_region("air", vec![0, 1]).with_region("spring", vec![2]);
        let mesh = mesh.mapped(|x| [x[0], x[1], if x[2] > 2.5 { gap + length } else { 0.5 * gap * x[2] }])?;
        let aside = [Some(0.0), Some(0.0), None];
        // of the stiffness over the gap
        let air = soft * stiffness * gap / (LAMBDA + 2.0 * MU);
        let solid = Solid::new(mesh)?
            .material("spring", NeoHooke::new(MU, LAMBDA)?)?
            .material("air", NeoHooke::new(air * MU, air * LAMBDA)?)?
            .clamp("z-")?
            .clamp("z+")?;
        let solid = ["x-", "x+"].into_iter().try_fold(solid, |solid, side| solid.displace(side, aside))?;
        let plate = Electrode::within("plate", "spring");
        let solid = solid
            .electric(&[DielectricBody::of("gap", "air", permittivity)], &[Electrode::on("ground", "z-"), plate])?;
        let at = |voltage: f64| {
            let mut controls = solid.controls();
            let block = solid.model().controllable().iter().position(|c| c.name == "plate").unwrap_or_default();
            controls.values_mut(block)[0] = voltage;
            controls
        };
        let start = solid.solve(&at(0.2 * critical), &STRICT)?;
        let options = PathOptions { to_limit: true, step: 0.003, ..PathOptions::default() };
        let (stability, mut workspace) = (solid.model().stability(), Workspace::default());
        let path =
            stability.path(&start, (&at(1.4 * critical), 1.0), &options, &STRICT, &mut workspace, &mut |_| ())?;
        let limit = path.events.iter().find(|event| event.kind == EventKind::LimitPoint).ok_or("no limit point")?;
        let node = common::node_at(solid.mesh(), [0.0, 0.0, gap]).ok_or("no node")?;
        let voltage = 0.2 + 1.2 * limit.s;
        Ok([voltage - 1.0, -3.0 * solid.model().displacement(&limit.state.u)[3 * node + 2] / gap - 1.0].map(f64::abs))
    };
    let (coarse, fine) = (error(1e-1)?, error(1e-3)?);
    println!("{coarse:?} {fine:?}");
    assert!(fine[0] < 0.01 && fine[1] < 0.01, "{fine:?}");
    assert!(fine[0] < 0.1 * coarse[0], "{coarse:?} {fine:?}");
    Ok(())
}
