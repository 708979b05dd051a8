//! The bound of one pair of boxes, as `chebyshev` proves it: interpolation error against it, box by box.

use super::super::bounds::norm;
use super::super::chebyshev::{FarPair, Grid, lebesgue};
use super::super::frame::Frame;
use super::super::kernel::Kernel;
use super::super::lanes::Machine;
use super::super::tile::Slab;
use super::super::transform::{Patch, Proxy, Tables, moments};
use super::{Phi, Stream};

/// Boxes of all shapes, thin ones and flat ones, turned by any angle.
fn frame(stream: &mut Stream, centre: [f64; 3], size: f64) -> Frame {
    let half = std::array::from_fn(|_| if stream.next() < 0.2 { 0.0 } else { size * 10f64.powf(-2.0 * stream.next()) });
    let axes = if stream.next() < 0.3 {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    } else {
        let direction = |stream: &mut Stream| stream.point([-1.0; 3], [2.0; 3]);
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let unit = |x: [f64; 3]| x.map(|c| c / norm(x));
        let first = unit(direction(stream));
        let second = unit(cross(first, direction(stream)));
        [first, second, cross(first, second)]
    };
    Frame { centre, axes, half }
}

/// A point of a box, often a corner.
fn inside(stream: &mut Stream, frame: &Frame) -> ([f64; 3], [f64; 3]) {
    let corner = stream.next() < 0.5;
    let local: [f64; 3] = std::array::from_fn(|d| {
        let u = 2.0 * stream.next() - 1.0;
        frame.half[d] * if corner { u.signum() } else { u }
    });
    let at = std::array::from_fn(|i| frame.centre[i] + (0..3).map(|d| local[d] * frame.axes[d][i]).sum::<f64>());
    (at, local)
}

/// Nodes that stand for a point, with their weights.
fn stand_in(tables: &Tables, frame: &Frame, (wave, orders): Grid, at: [f64; 3]) -> Vec<([f64; 3], f64)> {
    let machine = Machine::detect();
    let x = at.map(|c| vec![c; 8]);
    let mut weight = vec![0.0; 8];
    weight[0] = 1.0;
    let slab = Slab { x: [&x[0], &x[1], &x[2]], weight: &weight };
    let moments = moments(machine, slab, Patch::new(frame, wave, orders));
    let mut proxy = Proxy::default();
    proxy.place(tables, frame, wave, orders);
    proxy.weigh(tables, orders, &moments, orders);
    let rows = proxy.rows();
    (0..proxy.count()).map(|k| ([rows.x[0][k], rows.x[1][k], rows.x[2][k]], rows.weight[k])).collect()
}

/// What is interpolated: E and E g (x - y), over E between the centres.
fn functions(phi: Phi, kernel: &Kernel, centre: f64, x: [f64; 3], y: [f64; 3]) -> [f64; 4] {
    let d: [f64; 3] = std::array::from_fn(|i| x[i] - y[i]);
    let r = norm(d);
    let e = (kernel.at(r) - centre).exp2();
    let g = match phi {
        Phi::Exponential { .. } => 1.0 / r,
        Phi::Inverse { .. } => 1.0 / (r * (1.0 + r)),
        Phi::SmoothInverse { .. } => 1.0 / (1.0 + r * r),
    };
    [e, e * g * d[0], e * g * d[1], e * g * d[2]]
}

#[test]
fn interpolation_errors_stay_below_their_bound() {
    let (mut stream, tables) = (Stream::new(17), Tables::new());
    let (mut tried, mut worst, mut worst_slope): (usize, f64, f64) = (0, 0.0, 0.0);
    let phis = [Phi::Exponential { length: 1.0 }, Phi::Inverse { eps: 1.0 }, Phi::SmoothInverse { eps: 1.0 }];
    for round in 0..4000 {
        let phi = phis[round % 3];
        let alpha = 1000f64.powf(stream.next());
        let kernel = Kernel::new(phi, alpha);
        let [rows, columns] = [0, 1].map(|_| {
            let size = 10f64.powf(2.0 * stream.next() - 1.0);
            let centre = stream.point([-6.0; 3], [12.0; 3]);
            frame(&mut stream, centre, size)
        });
        let budget = -6.0 - 34.0 * stream.next();
        let Some(pair) = FarPair::new(&kernel, [&rows, &columns], stream.point([0.0; 3], [3.0; 3])) else { continue };
        let Some(row_grid) = pair.grid(0, budget, 1.0, 300) else { continue };
        let amplified = lebesgue(row_grid.1);
        let Some(column_grid) = pair.grid(1, budget, amplified, 300) else { continue };
        let rounding = f64::EPSILON * amplified * lebesgue(column_grid.1) * 2f64.powi(4);
        if rounding > budget.exp2() {
            continue;
        }
        tried += 1;
        for _ in 0..4 {
            let ((x, u), (y, w)) = (inside(&mut stream, &rows), inside(&mut stream, &columns));
            let exact = functions(phi, &kernel, pair.centre, x, y);
            let mut found = [0.0; 4];
            let columns_at = stand_in(&tables, &columns, column_grid, y);
            for (x, by_row) in stand_in(&tables, &rows, row_grid, x) {
                for &(y, by_column) in &columns_at {
                    let values = functions(phi, &kernel, pair.centre, x, y);
                    (0..4).for_each(|k| found[k] += by_row * by_column * values[k]);
                }
            }
            let wave = |(wave, _): Grid, frame: &Frame, local: [f64; 3]| -> f64 {
                wave.vector(frame.half).iter().zip(local).map(|(v, u)| v * u).sum()
            };
            let bound = (budget + wave(row_grid, &rows, u) + wave(column_grid, &columns, w)).exp2();
            worst = worst.max((found[0] - exact[0]).abs() / bound);
            let slope = (1..4).map(|k| (found[k] - exact[k]).abs()).fold(0.0, f64::max) / pair.slope();
            worst_slope = worst_slope.max(slope / bound);
        }
    }
    eprintln!("{tried} pairs of boxes, largest error / bound: {worst:.3}, of the slope {worst_slope:.3}");
    assert!(tried > 500, "only {tried} pairs of boxes");
    assert!(worst < 1.0 && worst_slope < 1.0, "error / bound: {worst:.3}, of the slope {worst_slope:.3}");
    // A bound a thousand times too large would be as good as none.
    assert!(worst > 1e-3 && worst_slope > 1e-3, "error / bound: {worst:.1e}, of the slope {worst_slope:.1e}");
}
