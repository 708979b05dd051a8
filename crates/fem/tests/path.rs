//! Arc-length continuation: snap-through of shallow arches, buckling loads, paths that turn back.

use crate::common;

use common::block::STRICT;
use common::{Outcome, node_at, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Demand, EquilibriumPath, EventKind, Instant, PathEnd, PathOptions, Solid, SolveOptions, StateError, Workspace,
};
use nastic_mesh::CellKind;
use nastic_numeric::vector::norm;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

const E: f64 = 1e6;
const NU: f64 = 0.3;

fn law() -> Outcome<NeoHooke> {
    Ok(NeoHooke::new(E / (2.0 * (1.0 + NU)), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)))?)
}

/// A clamped arch of span 1, thickness h and rise 2 h under a dead weight.
fn arch(kind: CellKind, h: f64, weight: f64) -> Outcome<Solid> {
    let flat = regular(kind, [1.0, h, 0.0], [(0.32 / h) as usize, 1, 1])?;
    let raised = flat.points().iter().map(|x| [x[0], x[1] + h * (1.0 - (2.0 * PI * x[0]).cos()), 0.0]).collect();
    Ok(Solid::new(flat.with_points(raised)?)?
        .material("body", law()?)?
        .clamp("x-")?
        .clamp("x+")?
        .body_force("body", Vec3::y() * -weight)?)
}

fn follow(solid: &Solid, options: &PathOptions) -> Outcome<EquilibriumPath> {
    let mut seen = 0;
    let to = (&solid.controls(), 1.0);
    let path =
        solid
            .model()
            .stability()
            .path(&solid.rest(), to, options, &STRICT, &mut Workspace::default(), &mut |_| seen += 1)?;
    assert_eq!(seen, path.points.len());
    Ok(path)
}

/// The kinds, places and inertias of all events.
fn message(path: &EquilibriumPath) -> Vec<(EventKind, f64, usize, usize)> {
    let count = |n: Option<usize>| n.unwrap_or(usize::MAX);
    path.events.iter().map(|event| (event.kind, event.s, count(event.before), count(event.after))).collect()
}

/// Up to the first limit point, down to the second, up again on the snapped side; between them antisymmetric branches
/// cross twice.
#[test]
fn an_arch_snaps_through_two_limit_points() -> Outcome {
    use EventKind::{Bifurcation, LimitPoint};
    for (kind, h, weight) in [(CellKind::Quad8, 0.02, 1600.0), (CellKind::Quad9, 0.005, 30.0)] {
        let solid = arch(kind, h, weight)?;
        let middle = 2 * node_at(solid.mesh(), [0.5, 3.0 * h, 0.0]).ok_or("no node in the middle")? + 1;
        let path = follow(&solid, &PathOptions::default())?;
        let fine = follow(&solid, &PathOptions { step: 0.02, points: 2000, ..PathOptions::default() })?;
        assert!(fine.points.len() as f64 > 1.5 * path.points.len() as f64);
        let expected = [(LimitPoint, 0, 1), (Bifurcation, 1, 2), (LimitPoint, 2, 1), (Bifurcation, 1, 0)];
        for found in [&path, &fine] {
            assert!(matches!(found.end, PathEnd::Left), "{:?}", found.end);
            let kinds: Vec<_> =
                message(found).into_iter().map(|(kind, _, before, after)| (kind, before, after)).collect();
            assert_eq!(kinds, expected, "{kind}");
        }
        for (coarse, fine) in path.events.iter().zip(&fine.events) {
            assert!((coarse.s / fine.s - 1.0).abs() < 1e-4, "{kind}: {} and {}", coarse.s, fine.s);
        }
        // a limit point: the tangent is singular, and s is an extreme
        let rest = solid.modes(&path.points[0].state, 1, &STRICT)?.eigenvalues[0];
        for limit in path.events.iter().filter(|event| event.kind == LimitPoint) {
            let lambda = solid.modes(&limit.state, 2, &STRICT)?.eigenvalues;
            let least = lambda.iter().fold(f64::INFINITY, |least, l| least.min(l.abs()));
            assert!(least < 1e-4 * rest, "{kind}: {lambda:?}, at rest {rest}");
        }
        let (top, bottom) = (path.events[0].s, path.events[2].s);
        let between = &path.points[path.events[0].point + 1..=path.events[2].point];
        assert!(between.iter().all(|p| (bottom..top).contains(&p.s) && p.slope < 0.0));
        // snapped through at the end, and stable
        let end = &path.points[path.points.len() - 1];
        assert_eq!((end.s, end.negative, end.state.load), (1.0, Some(0), 1.0));
        assert!(end.state.u[middle] < -4.0 * h, "{}", end.state.u[middle]);
        let again = solid.solve(&solid.controls(), &SolveOptions { near: Some(&end.state), ..STRICT })?;
        assert!(common::distance(&again.u, &end.state.u) < 1e-9);
        // every point is an equilibrium of its load
        for point in &path.points {
            let at = Instant::new(&point.state.u, &point.state.controls, point.state.load);
            let sums = solid.model().evaluate(&at, Demand { energy: false, force: true })?;
            let mut residual = sums.force;
            solid.supports().clear(&mut residual);
            assert!(norm(&residual) <= 2e-10 * norm(&sums.force_scale), "{kind}, s = {}", point.s);
        }
    }
    Ok(())
}

/// `P = pi^2 E' I / (4 L^2)`, `E' = E / (1 - nu^2)`, of a cantilever in plane strain; nine times that for its second
/// mode.
#[test]
fn a_compressed_cantilever_bifurcates_at_eulers_load() -> Outcome {
    let h = 0.02_f64;
    let euler = PI.powi(2) * E / (1.0 - NU * NU) * h * h / 48.0;
    // on a mesh without the symmetry of the column, as of triangles, there is no straight branch
    for kind in [CellKind::Quad8, CellKind::Quad9] {
        let solid = Solid::new(regular(kind, [1.0, h, 0.0], [20, 1, 1])?)?
            .material("body", law()?)?
            .clamp("x-")?
            .traction("x+", Vec3::x() * -10.0 * euler)?;
        let path = follow(&solid, &PathOptions::default())?;
        assert!(matches!(path.end, PathEnd::Left), "{:?}", path.end);
        let events = message(&path);
        assert_eq!(events.len(), 2, "{kind}: {events:?}");
        for (k, ((event, s, before, after), expected)) in events.into_iter().zip([0.1, 0.9]).enumerate() {
            assert_eq!((event, before, after), (EventKind::Bifurcation, k, k + 1));
            assert!((s / expected - 1.0).abs() < 0.02, "{kind}: {s} instead of {expected}");
        }
    }
    Ok(())
}

/// With prescribed displacements and a control on the way: the end is the equilibrium that a solve finds.
#[test]
fn supports_and_controls_go_along() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, 0.1, 0.0], [10, 2, 1])?)?
        .material("body", law()?)?
        .actuate("body", "fiber", FiberTension::along(Vec3::new(0.8, 0.6, 0.0))?)?
        .clamp("x-")?
        .displace("x+", [Some(0.05), Some(0.02), None])?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(5e4);
    let to = (&controls, 1.0);
    let options = PathOptions::default();
    let path =
        solid.model().stability().path(&solid.rest(), to, &options, &STRICT, &mut Workspace::default(), &mut |_| ())?;
    assert!(matches!(path.end, PathEnd::Left) && path.events.is_empty());
    let end = &path.points[path.points.len() - 1];
    let alone = solid.solve(&controls, &STRICT)?;
    assert!(common::distance(&alone.u, &end.state.u) < 1e-9);
    assert!(path.points.iter().all(|point| point.state.report.newton <= 5), "the tangent is exact");
    // back from there
    let rest = (&solid.controls(), 0.0);
    let back =
        solid.model().stability().path(&end.state, rest, &options, &STRICT, &mut Workspace::default(), &mut |_| ())?;
    assert!(common::largest(&back.points[back.points.len() - 1].state.u) < 1e-9);
    Ok(())
}

#[test]
fn what_cannot_be_followed_is_told() -> Outcome {
    let solid = arch(CellKind::Quad8, 0.02, 1600.0)?;
    let few = follow(&solid, &PathOptions { points: 4, ..PathOptions::default() })?;
    assert!(matches!(few.end, PathEnd::Points) && few.points.len() == 4);
    let to = (&solid.controls(), 1.0);
    for options in [
        PathOptions { step: 0.0, ..PathOptions::default() },
        PathOptions { range: [0.0, 1.0], ..PathOptions::default() },
        PathOptions { range: [-1.0, f64::NAN], ..PathOptions::default() },
    ] {
        let refused = solid.model().stability().path(
            &solid.rest(),
            to,
            &options,
            &STRICT,
            &mut Workspace::default(),
            &mut |_| (),
        );
        assert!(matches!(refused, Err(StateError::Problem(_))), "{refused:?}");
    }
    let cancel = std::sync::atomic::AtomicBool::new(true);
    let stopped = SolveOptions { cancel: Some(&cancel), ..STRICT };
    let refused = solid.model().stability().path(
        &solid.rest(),
        to,
        &PathOptions::default(),
        &stopped,
        &mut Workspace::default(),
        &mut |_| (),
    );
    assert!(matches!(refused, Err(StateError::Cancelled)));
    Ok(())
}
