//! Refinement of the control mesh on a fixed state mesh: problem (8) of the survey, with int |m|^2 and int |grad m|^2, has an optimum that
//! converges in L2; that of problem (9), with bounds alone, varies more and more.

use nastic_control::{ControlNorm, ControlSmoothness, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, rectangle};
use nastic_opt::{Bounds, NewtonCg, Optimizer, Options};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// An optimum: its cost, its tensions at the quadrature points with their weights, its total variation.
struct Optimum {
    cost: f64,
    at_points: Vec<f64>,
    weights: Vec<f64>,
    total_variation: f64,
}

/// A strip of 1 x 0.1 m that is to become a wave, its tension on a grid; M = 2e-14 and eps = 2e-16, or neither.
fn optimum(grid: [u32; 3], regularised: bool, (lower, upper): (f64, f64)) -> Outcome<Optimum> {
    let wave = |x: [f64; 3]| [x[0], x[1] + 0.06 * (1.0 - (2.0 * std::f64::consts::PI * x[0]).cos()), 0.0];
    let body = Solid::new(rectangle([1.0, 0.1], [16, 4], CellKind::Quad8)?)?
        .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let mut problem = Reduced::new(body)
        .control("tension", Space::Grid(grid))?
        .cost(Tracking::surface("y+", Target::position(wave)))?;
    if regularised {
        problem = problem.cost(ControlNorm::of("tension", 2e-14)?)?.cost(ControlSmoothness::of("tension", 2e-16)?)?;
    }
    let options = Options { tolerance: 1e-6, ..Options::default() };
    let mut within = NewtonCg::gauss_newton().within(Bounds::new(lower, upper)?).options(options);
    let best = within.minimize(&problem, 0.0)?;
    assert!(best.stop.is_converged(), "{grid:?}: {}", best.stop);
    let (disc, block) = (problem.solid().discretization(), problem.layout().block("tension")?);
    Ok(Optimum {
        cost: best.cost,
        at_points: problem.layout().to_points(&best.m)?.values(0).to_vec(),
        weights: disc.points().weights().to_vec(),
        total_variation: block.total_variation(disc, block.of(&best.m)),
    })
}

fn distance(a: &Optimum, b: &Optimum) -> f64 {
    let squares = a.at_points.iter().zip(&b.at_points).map(|(a, b)| (a - b).powi(2));
    squares.zip(&a.weights).map(|(square, w)| square * w).sum::<f64>().sqrt()
}

const GRIDS: [[u32; 3]; 3] = [[4, 1, 1], [8, 2, 1], [16, 4, 1]];

/// Bounds that hardly act, and bounds that nearly all values meet without regularisation.
const WIDE: (f64, f64) = (-1e5, 5e4);
const NARROW: (f64, f64) = (-4e4, 2e4);

#[test]
fn the_optimum_of_the_regularised_problem_converges_in_l2() -> Outcome {
    let optima: Vec<Optimum> = GRIDS.iter().map(|&grid| optimum(grid, true, WIDE)).collect::<Outcome<_>>()?;
    // The spaces are nested, so that costs fall.
    assert!(optima.windows(2).all(|w| w[1].cost <= w[0].cost));
    let distances: Vec<f64> = optima.windows(2).map(|w| distance(&w[0], &w[1])).collect();
    // Order 1 at least; 2 for smooth fields.
    assert!(distances[1] < 0.5 * distances[0], "{distances:?}");
    Ok(())
}

#[test]
fn the_total_variation_grows_where_only_bounds_hold_the_control() -> Outcome {
    let bounded: Vec<Optimum> = GRIDS.iter().map(|&grid| optimum(grid, false, NARROW)).collect::<Outcome<_>>()?;
    let variations: Vec<f64> = bounded.iter().map(|best| best.total_variation).collect();
    assert!(variations.windows(2).all(|w| w[1] > 1.05 * w[0]), "{variations:?}");
    let [coarse, fine] = [GRIDS[1], GRIDS[2]].map(|grid| optimum(grid, true, WIDE));
    assert!(fine?.total_variation < coarse?.total_variation);
    Ok(())
}
