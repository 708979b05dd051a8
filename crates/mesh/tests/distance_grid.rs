//! Signed distances on grids: closed forms, derivatives, smoothness, bounds, what they lose.

use nalgebra::{Matrix3, Rotation3, Vector3};
use nastic_mesh::spatial::{DistanceGrid, Obstacle, SignedDistance};
use nastic_mesh::{CellKind, Mesh, box_mesh, rectangle};
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A ball of radius 1 of n cells across.
fn ball(n: usize) -> Outcome<Mesh> {
    let place = |x: [f64; 3]| {
        let p = x.map(|x| x - 1.0);
        let size = p.iter().map(|p| p * p).sum::<f64>().sqrt();
        let largest = p.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        p.map(|p| if size > 0.0 { p * largest / size } else { 0.0 })
    };
    Ok(box_mesh([2.0; 3], [n; 3], CellKind::Hex8)?.mapped(place)?)
}

/// A part of a spherical shell below its centre, of inner radius 1: open above, with a square rim.
fn bowl(n: usize, wall: f64) -> Outcome<Mesh> {
    let place = |x: [f64; 3]| {
        let d = [1.8 * (x[0] - 0.5), 1.8 * (x[1] - 0.5), -1.0];
        let size = d.iter().map(|d| d * d).sum::<f64>().sqrt();
        d.map(|d| d / size * (1.0 + wall * (1.0 - x[2])))
    };
    Ok(box_mesh([1.0; 3], [n, n, 1], CellKind::Hex8)?.mapped(place)?)
}

fn grid(of: Obstacle) -> Outcome<Arc<DistanceGrid>> {
    match of {
        Obstacle::Grid(grid) => Ok(grid),
        _ => Err("no grid".into()),
    }
}

/// Repeatable points within -size and size.
fn points(count: usize, size: f64) -> impl Iterator<Item = [f64; 3]> {
    let at = move |n: f64| size * (n * 12.9898).sin();
    (0..count).map(move |i| std::array::from_fn(|k| at(0.7 + 3.0 * i as f64 + k as f64)))
}

fn norm(v: [f64; 3]) -> f64 {
    Vector3::from(v).norm()
}

fn largest(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Half the spacing leaves a quarter of the error beside the centre, or less; the gradient and the curvature are those of a sphere.
#[test]
fn the_distance_of_a_fine_ball_is_that_of_a_sphere() -> Outcome {
    let mesh = ball(48)?;
    let mut errors = Vec::new();
    for spacing in [0.5, 0.25] {
        let ball = Obstacle::on_grid(&mesh, spacing, 0.0)?;
        let mut worst = [0.0_f64; 3];
        for x in points(400, 1.3).filter(|x| norm(*x) > 0.9 && x.iter().all(|x| x.abs() < 1.2)) {
            let (found, r) = (ball.at(&x), norm(x));
            let n = x.map(|x| x / r);
            let h = (Matrix3::identity() - Vector3::from(n) * Vector3::from(n).transpose()) / r;
            worst[0] = worst[0].max((found.value - (r - 1.0)).abs());
            worst[1] = worst[1].max(largest(found.gradient, n));
            worst[2] = worst[2].max((found.hessian() - h).amax());
            assert!((ball.distance(&x) - found.value).abs() < 1e-14);
        }
        errors.push(worst);
    }
    let [coarse, fine] = [errors[0], errors[1]];
    // what is left is the flat faces of the ball
    assert!(fine[0] < 5e-4 && fine[1] < 5e-3 && fine[2] < 0.05, "{errors:?}");
    assert!((0..2).all(|i| fine[i] < 0.3 * coarse[i]), "{errors:?}");
    Ok(())
}

fn shapes() -> Outcome<Vec<(&'static str, Obstacle, usize)>> {
    let bent = rectangle([2.0, 0.5], [8, 2], CellKind::Quad4)?.mapped(|[x, y, z]| [x, y + 0.4 * (x - 1.0).abs(), z])?;
    Ok(vec![
        ("ball", Obstacle::on_grid(&ball(6)?, 0.15, 0.0)?, 3),
        ("bowl", Obstacle::on_grid(&bowl(6, 0.3)?, 0.1, 0.0)?, 3),
        ("plane", Obstacle::on_grid(&bent, 0.1, 0.0)?, 2),
    ])
}

/// Differences of fourth order.
fn difference(at: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    const H: f64 = 1e-4;
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|s| at(s * H));
    std::array::from_fn(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * H))
}

/// On the grid and beyond it, of the distance and of what contact takes of it; in axes that are turned, too.
#[test]
fn derivatives_agree_with_differences() -> Outcome {
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.3, -0.7, 0.4)).into_inner();
    for (name, shape, dim) in shapes()? {
        for x in points(60, 1.4) {
            let flat = |v: [f64; 3]| if dim == 2 { [v[0], v[1], 0.0] } else { v };
            let (x, v, w) = (flat(x), flat([0.3, -0.5, 0.2]), flat([-0.1, 0.4, 0.6]));
            let at = |s: f64| -> SignedDistance { shape.at(&std::array::from_fn(|i| x[i] + s * v[i])) };
            let here = at(0.0);
            let along: f64 = here.gradient.iter().zip(&v).map(|(n, v)| n * v).sum();
            assert!((difference(|s| [at(s).value; 3])[0] - along).abs() < 1e-8, "{name} {x:?}");
            assert!(largest(difference(|s| at(s).gradient), here.second(&v)) < 1e-6, "{name} {x:?}");
            assert!(largest(difference(|s| at(s).second(&w)), here.third(v, w)) < 1e-4, "{name} {x:?}");
            let steeper: f64 = here.steepness_change().iter().zip(&v).map(|(h, v)| h * v).sum();
            assert!((difference(|s| [at(s).steepness(); 3])[0] - steeper).abs() < 1e-6, "{name} {x:?}");
            let turned = here.normal_change() * Vector3::from(v);
            assert!(largest(difference(|s| at(s).normal()), turned.into()) < 1e-6, "{name} {x:?}");
            // of R x the derivatives along R v are turned ones
            let (there, to) = (here.turned(&turn), |v: [f64; 3]| -> [f64; 3] { (turn * Vector3::from(v)).into() });
            assert!(largest(there.gradient, to(here.gradient)) < 1e-14, "{name}");
            assert!(largest(there.second(&to(v)), to(here.second(&v))) < 1e-13, "{name}");
            assert!(largest(there.third(to(v), to(w)), to(here.third(v, w))) < 1e-11, "{name}");
        }
    }
    Ok(())
}

/// Along a way over the edges in a bowl the second derivative has no jump, where the gradient of the exact distance does.
#[test]
fn the_second_derivative_has_no_jumps() -> Outcome {
    let mesh = bowl(5, 0.3)?;
    let (smooth, sharp) = (Obstacle::on_grid(&mesh, 0.1, 0.0)?, Obstacle::solid(&mesh)?);
    let (count, mut jumps) = (20_000, [0.0_f64; 2]);
    let place = |i: usize| {
        let s = i as f64 / count as f64 - 0.5;
        [0.9 * s, 0.31 * s + 0.02, -0.9]
    };
    for i in 0..count {
        let [a, b] = [place(i), place(i + 1)];
        jumps[0] = jumps[0].max((smooth.at(&a).hessian() - smooth.at(&b).hessian()).amax());
        jumps[1] = jumps[1].max(largest(sharp.at(&a).gradient, sharp.at(&b).gradient));
    }
    assert!(jumps[0] < 5e-3 && jumps[1] > 0.05, "{jumps:?}");
    Ok(())
}

/// No move by a length changes what steps are bounded by by more than the bound times that, within the grid and over its border.
#[test]
fn the_bound_of_steps_holds() -> Outcome {
    for (name, shape, dim) in shapes()? {
        let grid = grid(shape.clone())?;
        let (steepest, margin) = (shape.steepest(), grid.margin());
        assert!((1.0..2.2).contains(&steepest) && margin > 0.1, "{name}: {steepest}, {margin}");
        let mut met = [0; 2];
        for (x, w) in points(4000, 1.9).zip(points(4000, 0.2).skip(7)) {
            let y: [f64; 3] = std::array::from_fn(|i| x[i] + w[i]);
            let [x, y] = [x, y].map(|v| if dim == 2 { [v[0], v[1], 0.0] } else { v });
            let change = (shape.guarded(&x) - shape.guarded(&y)).abs();
            let way: [f64; 3] = std::array::from_fn(|i| y[i] - x[i]);
            assert!(change <= steepest * norm(way) * (1.0 + 1e-12), "{name} {x:?} {y:?}: {change}");
            assert!(norm(shape.at(&x).gradient) <= steepest, "{name} {x:?}");
            let d = shape.distance(&x);
            met[usize::from(d < margin)] += 1;
            assert!(if d < margin { shape.guarded(&x) == d } else { shape.guarded(&x) >= margin }, "{name} {x:?}");
        }
        assert!(met.iter().all(|met| *met > 100), "{name}: {met:?}");
    }
    Ok(())
}

#[test]
fn what_the_grid_loses_is_told() -> Outcome {
    let thick = grid(Obstacle::on_grid(&bowl(8, 0.15)?, 0.1, 0.7)?)?;
    assert!(thick.margin() == 0.7, "{}", thick.margin());
    assert!(thick.lost().is_none() && thick.error() < 0.03, "{thick:?}");
    let thin = grid(Obstacle::on_grid(&bowl(8, 0.05)?, 0.1, 0.0)?)?;
    let lost = thin.lost().ok_or("the wall is there")?;
    assert!((lost.thickness - 0.05).abs() < 1e-3, "{lost:?}");
    // an edge is rounded by a share of the spacing
    let cube = box_mesh([1.03; 3], [2; 3], CellKind::Hex8)?;
    for spacing in [0.2, 0.1] {
        let error = grid(Obstacle::on_grid(&cube, spacing, 0.0)?)?.error();
        assert!(error > 0.1 * spacing && error < 0.3 * spacing, "{error}");
    }
    Ok(())
}

#[test]
fn spacings_that_do_not_go_are_refused() -> Outcome {
    let cube = box_mesh([1.0; 3], [2; 3], CellKind::Hex8)?;
    for (spacing, margin, words) in [
        (0.0, 0.0, "the spacing of the grid of a distance is 0"),
        (f64::NAN, 0.0, "the spacing of the grid of a distance is NaN"),
        (0.1, -1.0, "the margin of the grid of a distance is -1"),
        (1e-3, 0.0, "8e6 are the most (64 MB): take a spacing of 0.00"),
        (1e-300, 0.0, "8e6 are the most (64 MB): take a spacing of 0.00"),
        (1e-320, 0.0, "8e6 are the most"),
    ] {
        let refused = Obstacle::on_grid(&cube, spacing, margin).err().ok_or(words)?.to_string();
        assert!(refused.contains(words), "{refused}");
    }
    let plate = box_mesh([1.0, 1.0, 0.01], [2, 2, 1], CellKind::Hex8)?;
    let refused = Obstacle::on_grid(&plate, 0.1, 0.45).err().ok_or("no node is inside")?.to_string();
    assert!(refused.contains("has no node inside of the solid") && refused.contains("0.01"), "{refused}");
    let plane = Obstacle::on_grid(&rectangle([1.0; 2], [2; 2], CellKind::Quad4)?, 0.1, 0.0)?;
    assert!(plane.check(2).is_ok() && plane.check(3).is_err());
    Ok(())
}
