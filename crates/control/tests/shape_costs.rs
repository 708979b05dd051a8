//! Costs of positions, directions, curvatures and stretches against closed forms, in space and in plane strain.

use nastic_control::{
    Compliance, Cost, CostContext, Curvature, IntoCost, LargestStretch, MeanPosition, Orientation, Partials, Reduced,
    Space,
};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, box_mesh, rectangle};
use nastic_opt::{Bounds, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const SIZE: [f64; 3] = [1.0, 0.2, 0.1];

fn mesh(kind: CellKind, n: usize) -> Outcome<Mesh> {
    Ok(match kind.dim() {
        2 => rectangle([SIZE[0], SIZE[1]], [6 * n, n], kind)?,
        _ => box_mesh(SIZE, [6 * n, n, n], kind)?,
    })
}

fn body(kind: CellKind, n: usize) -> Outcome<Reduced> {
    let solid = Solid::new(mesh(kind, n)?)?
        .material("body", NeoHooke::new(1e5, 4e5)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    Ok(Reduced::new(solid).control("tension", Space::Cell)?)
}

const KINDS: [CellKind; 5] = [CellKind::Quad9, CellKind::Tri6, CellKind::Hex20, CellKind::Tet10, CellKind::Hex8];

/// The displacement that takes every node to a position.
fn moved(body: &Reduced, to: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    let (mesh, dim) = (body.solid().mesh(), body.solid().mesh().dim());
    mesh.points().iter().flat_map(|x| (0..dim).map(|i| to(*x)[i] - x[i]).collect::<Vec<_>>()).collect()
}

/// Value and figures.
fn message(body: &Reduced, cost: &dyn Cost, u: &[f64]) -> Outcome<(f64, Vec<(&'static str, f64)>)> {
    let m = vec![0.0; body.layout().len()];
    let at = cost.at(&CostContext {
        solid: body.solid(),
        layout: body.layout(),
        u,
        state: None,
        m: &m,
        stage: 0,
        step: None,
    })?;
    Ok((at.value(), at.figures()?.iter().map(|figure| (figure.kind.name(), figure.value)).collect()))
}

/// A turn by an angle about z through the origin.
fn turn(angle: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    move |x| [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]]
}

fn area(kind: CellKind, thickness: f64) -> f64 {
    if kind.dim() == 2 { thickness } else { thickness * SIZE[2] }
}

#[test]
fn a_turned_body_has_turned_normals() -> Outcome {
    for kind in KINDS {
        let body = body(kind, 1)?;
        let end = Orientation::surface("x+", [2.0, 0.0, 0.0]).weight(3.0).bind(body.solid())?;
        let top = Orientation::surface("y+", [0.0, 1.0, 0.0]).bind(body.solid())?;
        for angle in [0.0, 0.3, -1.2, 3.0] {
            let u = moved(&body, turn(angle));
            let expected = 3.0 * area(kind, SIZE[1]) * (1.0 - f64::cos(angle));
            let (value, figures) = message(&body, &*end, &u)?;
            assert!((value - expected).abs() < 1e-14, "{kind:?} turned by {angle}: {value}, not {expected}");
            assert!((figures[0].1 - angle.abs()).abs() < 1e-7, "{kind:?}: {figures:?} for {angle}");
            let (value, _) = message(&body, &*top, &u)?;
            let expected = area(kind, SIZE[0]) * (1.0 - f64::cos(angle));
            assert!((value - expected).abs() < 1e-14, "{kind:?}, above: {value}, not {expected}");
        }
    }
    Ok(())
}

#[test]
fn positions_are_means_of_what_is_named() -> Outcome {
    for kind in KINDS {
        let body = body(kind, 2)?;
        let u = moved(&body, |x| [1.1 * x[0] + 0.05, x[1] - 0.3 * x[0] * x[0], x[2]]);
        let free = [None, None, None];
        // the end at X = 1; the mean of X^2 over the region is 1/3, its mean of X a half
        let cases = [
            (MeanPosition::surface("x+", [Some(1.0), Some(0.0), None]), [0.15, -0.2]),
            (MeanPosition::region("body", [Some(0.0), Some(0.0), None]), [0.6, 0.0]),
            (MeanPosition::nodes("x+", [Some(1.0), None, None]), [0.15, 0.0]),
            (MeanPosition::point([1.0, 0.1, 0.0], [None, Some(0.1), None]), [0.0, -0.3]),
        ];
        for (cost, gap) in cases {
            let named = format!("{kind:?} {cost:?}");
            let cost = cost.weight(2.0).bind(body.solid())?;
            let (value, figures) = message(&body, &*cost, &u)?;
            let expected = gap[0] * gap[0] + gap[1] * gap[1];
            // hex8 has no quadratic displacements, but exact ones at its nodes; the region's mean is that of the trapezoidal rule
            let tolerance = if kind == CellKind::Hex8 { 3e-3 } else { 1e-13 };
            assert!((value - expected).abs() < tolerance, "{named}: {value}, not {expected}");
            assert!((figures[0].1 - expected.sqrt()).abs() < 2.0 * tolerance, "{named}: {figures:?}");
        }
        assert!(MeanPosition::surface("x+", free).bind(body.solid()).is_err());
        let outside = MeanPosition::point([2.0, 0.0, 0.0], [Some(1.0), None, None]).bind(body.solid());
        assert!(outside.is_err_and(|error| error.to_string().contains("is outside")));
    }
    Ok(())
}

/// The body bent on an arc of radius R: 1/R to order h^2 of the points of the line, from the left (+) and from the right (-).
#[test]
fn a_body_on_an_arc_has_its_curvature() -> Outcome {
    for kind in KINDS {
        let body = body(kind, 4)?;
        let radius = 0.8;
        let arc = |x: [f64; 3]| {
            let (s, c) = (x[0] / radius).sin_cos();
            [(radius - x[1] + 0.1) * s, radius - (radius - x[1] + 0.1) * c + 0.1, x[2]]
        };
        let u = moved(&body, arc);
        let depth = if kind.dim() == 2 { 0.0 } else { 0.05 };
        let line = |n: usize| -> Vec<[f64; 3]> { (0..=n).map(|k| [k as f64 / n as f64, 0.1, depth]).collect() };
        let mean = |axis: f64, n: usize| -> Outcome<f64> {
            let cost = Curvature::of_line(line(n), [0.0, 0.0, axis], 0.0).bind(body.solid())?;
            Ok(message(&body, &*cost, &u)?.1[0].1)
        };
        let errors = [6, 12].map(|n| mean(1.0, n).map(|kappa| (kappa * radius - 1.0).abs()));
        let [coarse, fine] = errors;
        let (coarse, fine) = (coarse?, fine?);
        assert!(coarse < 1e-2 && fine < 0.3 * coarse, "{kind:?}: errors {coarse:e}, {fine:e}");
        assert!((mean(-3.0, 12)? + mean(1.0, 12)?).abs() < 1e-13, "{kind:?}: the other way round");
        // what is wanted has no cost
        let exact = Curvature::of_line(line(6), [0.0, 0.0, 1.0], mean(1.0, 6)?).bind(body.solid())?;
        assert!(message(&body, &*exact, &u)?.0 < 1e-4, "{kind:?}");
    }
    assert!(
        Curvature::of_line([[0.1, 0.1, 0.0]; 3], [0.0, 0.0, 1.0], 0.0).bind(body(CellKind::Quad9, 1)?.solid()).is_err()
    );
    Ok(())
}

/// `((l^2p + 2)/3)^(1/2p)` of a body stretched by l along one axis: below l, the nearer the larger p.
#[test]
fn a_stretched_body_has_its_power_mean() -> Outcome {
    for kind in KINDS {
        let body = body(kind, 1)?;
        let u = moved(&body, |x| [1.5 * x[0], x[1], x[2]]);
        let mut last = 1.0;
        for p in [1, 4, 8, 32] {
            let cost = LargestStretch::default().exponent(p).bind(body.solid())?;
            let (value, figures) = message(&body, &*cost, &u)?;
            let expected = ((1.5f64.powi(2 * p as i32) + 2.0) / 3.0).powf(0.5 / f64::from(p));
            assert!((value - expected).abs() < 1e-13, "{kind:?}, p = {p}: {value}, not {expected}");
            assert!(value > last && value < 1.5, "{kind:?}: {value}");
            assert!((figures[1].1 - 1.5).abs() < 1e-13, "{figures:?}");
            last = value;
        }
        assert!(
            (message(&body, &*LargestStretch::default().bind(body.solid())?, &vec![0.0; u.len()])?.0 - 1.0).abs()
                < 1e-14
        );
        assert!(LargestStretch::default().exponent(0).bind(body.solid()).is_err());
    }
    Ok(())
}

/// A cantilever gives way by `L^3 / (3 E I) + ..` to a force at its end: at rest to 3 % of beam theory with shear; the pulled one less.
#[test]
fn a_cantilever_gives_way_as_a_beam_does() -> Outcome {
    let (young, poisson) = (3e5, 0.3);
    let solid = Solid::new(box_mesh(SIZE, [16, 4, 2], CellKind::Hex20)?)?
        .material("body", NeoHooke::from_young_poisson(young, poisson)?)?
        .clamp("x-")?;
    let pulled = solid.clone().traction("x+", Vec3::x() * 3e3)?;
    let compliance = |solid: Solid| -> Outcome<f64> {
        let problem = Reduced::new(solid.actuate("body", "tension", FiberTension::along(Vec3::x())?)?)
            .control("tension", Space::Uniform)?
            .cost(Compliance::surface("x+", [0.0, 0.0, -2.0]))?;
        Ok(problem.at(&[0.0])?.cost())
    };
    let [length, width, height] = SIZE;
    let (inertia, area, shear) = (width * height.powi(3) / 12.0, width * height, young / (2.0 * (1.0 + poisson)));
    let beam = length.powi(3) / (3.0 * young * inertia) + length / (5.0 / 6.0 * shear * area);
    let found = compliance(solid)?;
    assert!((found / beam - 1.0).abs() < 0.03, "{found} where beam theory has {beam}");
    let stiffer = compliance(pulled)?;
    assert!(stiffer < 0.8 * found, "{stiffer} under tension, {found} at rest");
    Ok(())
}

/// Through a solve: the derivative of the tangent by displacement and controls.
#[test]
fn the_derivative_of_a_compliance_is_exact() -> Outcome {
    for n in [1, 2] {
        let problem = body(CellKind::Quad9, n)?.cost(Compliance::surface("x+", [0.1, 1.0, 0.0]))?;
        let start: Vec<f64> = (0..problem.layout().len()).map(|k| -2e4 - 9e3 * ((k * k) as f64).sin()).collect();
        let report = Taylor::default().test(&problem, &Bounds::new(-1e5, 5e4)?, &start)?;
        assert_eq!(report.verdict(), Verdict::Right, "{report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{report}");
    }
    let held = Compliance::surface("x-", [0.0, 1.0, 0.0]).bind(body(CellKind::Quad9, 1)?.solid());
    assert!(held.is_err_and(|error| error.to_string().contains("no force moves it")));
    Ok(())
}

/// First and second partials in plane strain, where the second tangent of a surface does not change.
#[test]
fn partials_in_plane_strain_are_differences() -> Outcome {
    let body = body(CellKind::Quad9, 1)?;
    let solid = body.solid();
    let costs: Vec<Box<dyn Cost>> = vec![
        MeanPosition::surface("x+", [Some(0.7), Some(0.4), None]).bind(solid)?,
        Orientation::surface("x+", [0.3, 1.0, 0.0]).bind(solid)?,
        Curvature::of_line([[0.1, 0.1, 0.0], [0.4, 0.1, 0.0], [0.9, 0.12, 0.0]], [0.0, 0.0, 1.0], 0.3).bind(solid)?,
        LargestStretch::default().bind(solid)?,
    ];
    let u = moved(&body, |x| [x[0] + 0.1 * x[0] * x[1], x[1] + 0.3 * x[0] * x[0], 0.0]);
    let wave = |k: f64| -> Vec<f64> { (0..u.len()).map(|i| 0.01 * (i as f64 * 1.3 + k).sin()).collect() };
    let (m, v, w) = (vec![0.0; body.layout().len()], wave(0.4), wave(2.1));
    let partials = |cost: &dyn Cost, u: &[f64]| -> Outcome<(f64, Vec<f64>, Vec<f64>)> {
        let at = cost.at(&CostContext { solid, layout: body.layout(), u, state: None, m: &m, stage: 0, step: None })?;
        let (mut first, mut second) = (Partials::zero(u.len(), m.len()), Partials::zero(u.len(), m.len()));
        at.add_partials(&mut first)?;
        at.add_second_partials(&Partials { u: v.clone(), m: m.clone() }, &mut second)?;
        Ok((at.value(), first.u, second.u))
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for cost in &costs {
        let along = |t: f64| partials(&**cost, &u.iter().zip(&v).map(|(u, v)| u + t * v).collect::<Vec<_>>());
        let (here, there, back) = (along(0.0)?, along(1e-3)?, along(-1e-3)?);
        let slope = (there.0 - back.0) / 2e-3;
        assert!((slope - dot(&here.1, &v)).abs() < 1e-5 * slope.abs(), "{}: {slope}", cost.name());
        let bent = (dot(&there.1, &w) - dot(&back.1, &w)) / 2e-3;
        assert!((bent - dot(&here.2, &w)).abs() < 1e-5 * bent.abs(), "{}: {bent}", cost.name());
    }
    Ok(())
}

/// Through a solve, on two meshes.
#[test]
fn taylor_orders_through_a_solve() -> Outcome {
    for n in [1, 2] {
        let line: Vec<[f64; 3]> = (0..=6).map(|k| [k as f64 / 6.0, 0.1, 0.0]).collect();
        let problem = body(CellKind::Quad9, n)?
            .cost(MeanPosition::surface("x+", [Some(0.9), None, None]))?
            .cost(Orientation::surface("x+", [0.9, 0.1, 0.0]))?
            .cost(Curvature::of_line(line, [0.0, 0.0, 1.0], 0.2))?
            .cost(LargestStretch::default())?;
        let start: Vec<f64> = (0..problem.layout().len()).map(|k| -2e4 - 9e3 * ((k * k) as f64).sin()).collect();
        let report = Taylor::default().test(&problem, &Bounds::new(-1e5, 5e4)?, &start)?;
        assert_eq!(report.verdict(), Verdict::Right, "{report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{report}");
    }
    Ok(())
}
