//! Shapes by the nodes of the skin: closed forms of the map, derivatives beside every other control, optima that do not depend on the mesh.

use crate::designs::Outcome;
use nastic_control::{
    Consumer, ControlNorm, LumenVolume, MeanDisplacement, PowerLaw, Reduced, ReducedWorkspace, ShapeShrinkage, Space,
    Target, Tracking,
};
use nastic_energy::{FiberTension, NeoHooke, Parametrised};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{Cavity, Controls, FreeShape, Inertia, Instant, SkinMap, Solid, Spring, Tendon, VaryingLoad};
use nastic_mesh::{CellKind, Mesh, box_mesh, rectangle};
use nastic_opt::{Bounds, Lbfgs, Optimizer, Options, Taylor, Verdict};
use nastic_tensor::Vec3;

fn nobody(_: u32, _: usize) -> Option<String> {
    None
}

fn skin(mesh: Mesh, shape: FreeShape) -> Outcome<(Solid, SkinMap)> {
    let solid = Solid::new(mesh)?.material("body", NeoHooke::new(1e5, 4e5)?)?;
    let map = SkinMap::new(solid.discretization(), &shape, &nobody)?;
    Ok((solid, map))
}

/// A wave on the skin shrinks by 1/(1 + R^2 k^2), and decays inside as a harmonic function does; what is kept stays; `x . s(p) = s^T(x) . p`.
#[test]
fn the_skin_is_filtered_and_the_inside_is_harmonic() -> Outcome {
    let (length, depth, k, r) = (2.0, 1.0, std::f64::consts::PI, 0.2);
    for (kind, cells) in [(CellKind::Quad4, [64, 32]), (CellKind::Quad8, [32, 16]), (CellKind::Tri6, [32, 16])] {
        let mesh = rectangle([length, depth], cells, kind)?;
        let (solid, map) = skin(mesh, FreeShape::of("skin", "body", "y+", r).keep("y-"))?;
        let p: Vec<f64> = map.points().iter().map(|point| 0.01 * (k * point.position[0]).cos()).collect();
        let s = map.displacement(&p);
        let size = 0.01 / (1.0 + r * r * k * k);
        let mut worst = 0.0_f64;
        for (x, s) in solid.mesh().points().iter().zip(s.chunks_exact(2)) {
            let expected = size * (k * x[0]).cos() * (k * x[1]).sinh() / (k * depth).sinh();
            worst = worst.max((s[1] - expected).abs().max(s[0].abs()) / size);
        }
        println!("{kind}: {worst:e}");
        assert!(worst < 4e-3, "{kind}: {worst}");
        let most = |v: &[f64]| v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(most(&s) <= most(&p));
        let x: Vec<f64> = (0..s.len()).map(|i| (i as f64 * 0.7).sin()).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (left, right) = (dot(&x, &s), dot(&map.vjp(x.clone()), &p));
        assert!((left - right).abs() < 1e-12 * most(&p) * s.len() as f64, "{left} {right}");
        let area: f64 = map.points().iter().map(|point| point.weight).sum();
        assert!((area - length).abs() < 1e-12 && map.points().iter().all(|point| point.weight > 0.0));
    }
    Ok(())
}

/// A block whose top rises evenly is stretched evenly, by det G = 1 + p/h everywhere; the normals of a curved skin are those of the drawn body.
#[test]
fn even_skins_move_evenly() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10] {
        let mesh = box_mesh([1.0, 1.0, 0.5], [3, 3, 2], kind)?;
        let body = Solid::new(mesh)?
            .material("body", NeoHooke::new(1e5, 4e5)?)?
            .free_shape(FreeShape::of("skin", "body", "z+", 0.5).keep("z-"))?
            .clamp("z-")?;
        let problem = Reduced::new(body).control("skin", Space::Node)?.cost(ShapeShrinkage::default())?;
        let m = vec![-0.1; problem.layout().len()];
        let point = problem.at(&m)?;
        assert!((point.cost() - 1.0 / 0.8).abs() < 1e-12, "{kind}: {}", point.cost());
        let state = point.state();
        let s = problem.solid().model().shape_displacement(&state.controls).ok_or("no shape")?;
        for ((x, s), u) in problem.solid().mesh().points().iter().zip(s.chunks_exact(3)).zip(state.u.chunks_exact(3)) {
            let off = (0..3).map(|i| (s[i] - [0.0, 0.0, -0.2 * x[2]][i]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-13 && (0..3).all(|i| (u[i] - s[i]).abs() < 1e-10), "{kind}: {s:?} {u:?}");
        }
    }
    Ok(())
}

/// u = s without energy, whatever the shape, where supports hold what stays.
#[test]
fn a_body_that_nothing_loads_is_where_its_nodes_are() -> Outcome {
    for kind in [CellKind::Quad8, CellKind::Tri6, CellKind::Hex8, CellKind::Tet10] {
        let flat = kind.dim() == 2;
        let mesh = match flat {
            true => rectangle([1.0, 0.3], [6, 2], kind)?,
            false => box_mesh([1.0, 0.3, 0.3], [4, 2, 2], kind)?,
        };
        let body = Solid::new(mesh)?
            .material("body", NeoHooke::new(1e5, 4e5)?)?
            .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
            .free_shape(FreeShape::of("skin", "body", ["y+", "x+"], 0.3))?
            .clamp("x-")?;
        let problem =
            Reduced::new(body).control("skin", Space::Node)?.cost(Tracking::surface("x+", Target::position(|x| x)))?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| 0.15 * (1.0 + (1.7 * i as f64).sin())).collect();
        let point = problem.at(&m)?;
        let (state, model) = (point.state(), problem.solid().model());
        let s = model.shape_displacement(&state.controls).ok_or("no shape")?;
        let off = s.iter().zip(state.u.iter()).map(|(s, u)| (s - u).abs()).fold(0.0, f64::max);
        let energy = problem.solid().body().evaluate(&state.u, &state.controls, false, false)?.energy;
        let most = s.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        assert!(off < 1e-10 && energy.abs() < 1e-9 && most > 0.05, "{kind}: {off:e} {energy:e} {most}");
        let dim = problem.solid().discretization().dim();
        for (x, s) in problem.solid().mesh().points().iter().zip(s.chunks_exact(dim)) {
            assert!(x[0] > 0.0 || s.iter().all(|s| *s == 0.0), "{kind}: {x:?} {s:?}");
        }
    }
    Ok(())
}

/// A cup with a chamber, a cable, fibres and weight, part of whose skin is free.
fn cup(skin: [&str; 2], volume: bool) -> Outcome<Solid> {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "free_shape").ok_or("no free shape in the catalogue")?;
    let mesh = (entry.example)()?.mesh().clone();
    let body = Solid::new(mesh)?
        .material("body", NeoHooke::new(1e5, 2e5)?)?
        .actuate("body", "stiff", Parametrised::new(NeoHooke::new(5e4, 1e5)?))?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .free_shape(FreeShape::of("wall", "body", skin, 1.0))?
        .clamp("x-")?;
    let weight = VaryingLoad::filled("weight", body.body(), "body", Vec3::new(0.0, 0.0, -3e3))?;
    let cable = Tendon::through("cable", [[0.2, 0.4, 0.3], [1.6, 0.7, 0.5], [2.9, 0.3, 1.9]]);
    let chamber = Cavity::new("chamber", "inside").lid();
    let chamber = if volume { chamber.by_volume() } else { chamber };
    Ok(body.contribution(weight)?.inertia(Inertia::new("body", 300.0))?.tendon(cable)?.cavity(chamber)?)
}

fn everything(volume: bool) -> Outcome<Reduced> {
    let consumers = [
        Consumer::of("stiff.mu").through(PowerLaw { low: 1e3, high: 5e4, exponent: 3.0 }),
        Consumer::of("weight").through(PowerLaw::multiple_of(1.0)),
        Consumer::of("inertia by fill").through(PowerLaw::multiple_of(1.0)),
    ];
    let wider = Target::position(|x| [1.06 * x[0], 1.1 * x[1], x[2] - 0.1]);
    // a chamber of a given volume measures from its drawn wall
    let skin = if volume { ["x+", "x+"] } else { ["x+", "inside"] };
    Ok(Reduced::new(cup(skin, volume)?)
        .control("wall", Space::Node)?
        .control("chamber", Space::Uniform)?
        .control("cable", Space::Uniform)?
        .control("fibre", Space::Uniform)?
        .design("rho", Space::Cell, &consumers)?
        .cost(Tracking::surface("x+", wider))?
        .cost(ShapeShrinkage::default().exponent(6).weight(0.05))?
        .cost(LumenVolume::behind("inside", 1.5).weight(0.1))?)
}

fn somewhere(problem: &Reduced, volume: bool) -> Vec<f64> {
    let shape = problem.layout().blocks()[0].len();
    let mut m: Vec<f64> = (0..shape).map(|i| 0.08 * (1.3 * i as f64).sin()).collect();
    m.extend([if volume { 0.05 } else { 3e3 }, 800.0, -2e3]);
    m.extend((m.len()..problem.layout().len()).map(|i| 0.6 + 0.2 * (i as f64).cos()));
    m
}

/// Of a chamber by its pressure and by its volume, with fibres, a cable and a layout, first and second derivatives.
#[test]
fn shape_layout_and_control_have_exact_derivatives_together() -> Outcome {
    for volume in [false, true] {
        let problem = everything(volume)?;
        let m = somewhere(&problem, volume);
        let near = |share: f64| m.iter().map(|m: &f64| m + share * m.abs().max(0.01)).collect::<Vec<f64>>();
        let taylor = Taylor { directions: 3, second: true, ..Taylor::default() };
        let report = taylor.test(&problem, &Bounds::new(near(-0.4), near(0.4))?, &m)?;
        println!("{report}");
        assert_eq!(report.verdict(), Verdict::Right, "{report}");
        assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
        assert!(report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
        let second = report.directions.iter().filter_map(|along| along.second.as_ref());
        assert!(second.map(|second| second.order).all(|order| order > 2.95), "{report}");
    }
    // by the shape alone, on a grid over the skin
    let alone = Reduced::new(cup(["x+", "inside"], false)?)
        .control("wall", Space::Grid([2, 2, 2]))?
        .cost(LumenVolume::behind("inside", 1.5))?
        .cost(ShapeShrinkage::default().weight(0.1))?;
    let m: Vec<f64> = (0..alone.layout().len()).map(|i| 0.05 * (i as f64).cos()).collect();
    let report = Taylor { second: true, ..Taylor::default() }.test(&alone, &Bounds::new(-0.3, 0.3)?, &m)?;
    assert!(report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
    Ok(())
}

/// Volume of the chamber and length of the cable, by nodes of the skin.
#[test]
fn volumes_and_lengths_change_with_the_skin_as_differences_do() -> Outcome {
    let problem = everything(false)?;
    let m = somewhere(&problem, false);
    let measured = |m: &[f64]| -> Outcome<[f64; 2]> {
        let point = problem.at(m)?;
        let all = problem.solid().model().quantities(&Instant::of(point.state()))?;
        let of = |owner: &str, name: &str| all.iter().find(|own| own.0 == owner && own.1 == name).map(|own| own.2);
        Ok([of("chamber", "volume").ok_or("no volume")?, of("cable", "length").ok_or("no length")?])
    };
    let point = problem.at(&m)?;
    let model = problem.solid().model();
    for (what, name) in ["chamber", "cable"].into_iter().enumerate() {
        let block = model.controllable().iter().position(|own| own.name == name).ok_or("no such contribution")?;
        let mut unit: Controls = model.zero_controls();
        unit.values_mut(block)[0] = if name == "chamber" { -1.0 } else { 1.0 };
        let w = model.control_product(&Instant::of(point.state()), &unit)?;
        let gradient = problem.displacement_vjp(&point, &w, &mut ReducedWorkspace::default())?;
        let scale = gradient[..12].iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        for k in [0, 5, 11] {
            let step = 1e-4;
            let moved =
                |by: f64| -> Vec<f64> { m.iter().enumerate().map(|(i, m)| if i == k { m + by } else { *m }).collect() };
            let slope = (measured(&moved(step))?[what] - measured(&moved(-step))?[what]) / (2.0 * step);
            println!("{name} by {k}: {} {slope}", gradient[k]);
            assert!((gradient[k] - slope).abs() < 1e-6 * scale, "{name} by {k}: {} {slope}", gradient[k]);
        }
    }
    Ok(())
}

/// Where a heavy beam, held on the left, is to be drawn thinner and thicker so that its tip hangs least: one optimum on two meshes.
#[test]
fn two_meshes_of_one_body_have_one_optimum() -> Outcome {
    let best = |cells: [usize; 2], kind: CellKind| -> Outcome<(f64, Vec<f64>)> {
        let mesh = rectangle([1.0, 0.1], cells, kind)?;
        let body = Solid::new(mesh)?
            .material("body", NeoHooke::from_young_poisson(1e6, 0.3)?)?
            .free_shape(FreeShape::of("beam", "body", "y+", 0.1).keep("y-"))?
            .clamp("x-")?;
        let weight = VaryingLoad::filled("weight", body.body(), "body", Vec3::new(0.0, -1.5e3, 0.0))?;
        let problem = Reduced::new(body.contribution(weight)?)
            .control("beam", Space::Node)?
            .cost(MeanDisplacement::point([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]))?
            .cost(ControlNorm::of("beam", 40.0)?)?;
        let found = Lbfgs { options: Options { tolerance: 1e-7, ..Options::default() }, ..Lbfgs::default() }
            .within(Bounds::new(-0.03, 0.03)?)
            .minimize(&problem, 0.0)?;
        let s = problem.solid().model().shape_displacement(&problem.layout().to_points(&found.m)?).ok_or("no shape")?;
        let at = |x: f64| -> Outcome<f64> {
            let points = problem.solid().mesh().points();
            let near = points.iter().position(|p| (p[0] - x).abs() < 1e-9 && (p[1] - 0.1).abs() < 1e-9);
            Ok(s[2 * near.ok_or("no such node")? + 1])
        };
        Ok((found.cost, [0.2, 0.4, 0.6, 0.8, 1.0].into_iter().map(at).collect::<Outcome<_>>()?))
    };
    let (one, other) = (best([30, 2], CellKind::Quad8)?, best([20, 3], CellKind::Tri6)?);
    println!("{one:?} {other:?}");
    assert!((one.0 / other.0 - 1.0).abs() < 1e-2, "{one:?} {other:?}");
    let most = one.1.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
    assert!(most > 5e-3 && one.1.iter().zip(&other.1).all(|(a, b)| (a - b).abs() < 0.03 * most), "{one:?} {other:?}");
    Ok(())
}

#[test]
fn skins_that_cannot_move_are_refused() -> Outcome {
    let body = |shape: FreeShape| -> Outcome<Solid> {
        let mesh = box_mesh([1.0, 0.4, 0.4], [4, 2, 2], CellKind::Hex8)?;
        Ok(Solid::new(mesh)?.material("body", NeoHooke::new(1e5, 4e5)?)?.free_shape(shape)?.clamp("x-")?)
    };
    let of = |skin: &str| FreeShape::of("wall", "body", skin, 0.4);
    let refused = |solid: Solid, space: Space| -> String {
        Reduced::new(solid).control("wall", space).map(drop).map_or_else(|error| error.to_string(), |()| String::new())
    };
    let spring = Spring::to_ground("thread", [1.0, 0.2, 0.2], [2.0, 0.2, 0.2], 10.0);
    let cases = [
        (body(of("x-"))?, Space::Node, "cannot move \"x-\": x- holds all of its nodes"),
        (body(FreeShape { skin: ["y+", "x-"].into(), ..of("y+") })?, Space::Node, "cannot move \"x-\""),
        (body(of("y+").keep("y+"))?, Space::Node, "take a pressure, or leave that surface out"),
        (body(FreeShape::of("wall", "body", "y+", 0.05))?, Space::Node, "shorter than the distance of the nodes"),
        (body(FreeShape::of("wall", "body", "y+", f64::NAN))?, Space::Node, "shorter than the distance of the nodes"),
        (body(of("nowhere"))?, Space::Node, "nowhere"),
        (body(of("y+"))?, Space::Cell, "\"cell\""),
        (body(of("y+"))?, Space::Node, ""),
        (body(of("y+"))?.spring(spring)?, Space::Node, ""),
    ];
    for (k, (solid, space, expected)) in cases.into_iter().enumerate() {
        let said = refused(solid, space);
        assert!(said.contains(expected) && said.is_empty() == expected.is_empty(), "{k}: {said}");
    }
    let twice = Reduced::new(body(of("y+"))?).control("wall", Space::Node)?.control("wall", Space::Uniform);
    assert!(twice.map(drop).unwrap_err().to_string().contains("wall"));
    let other = body(of("y+"))?.free_shape(FreeShape::of("more", "body", "z+", 0.4));
    assert!(other.map(drop).unwrap_err().to_string().contains("changes the shape of the body already"));
    assert!(body(of("y+").least_volume(1.2)).map(drop).unwrap_err().to_string().contains("below 1"));
    let none = Reduced::new(Solid::new(box_mesh([1.0; 3], [1; 3], CellKind::Hex8)?)?).cost(ShapeShrinkage::default());
    assert!(none.map(drop).unwrap_err().to_string().contains("does not change"));
    Ok(())
}
