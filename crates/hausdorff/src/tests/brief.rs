//! Tiles in brief: one tile, and where tiles are left to full precision.

use super::super::brief::{BriefPull, BriefSums, BriefTile, ERROR, fits};
use super::super::kernel::Kernel;
use super::super::lanes::{Machine, WIDTH};
use super::super::mask::Mask;
use super::super::pull::{PULL, collect};
use super::super::side::Side;
use super::{Phi, Stream, cloud, distance};

#[test]
fn a_tile_within_its_bound() {
    let (kernel, mut stream) = (Kernel::new(Phi::Exponential { length: 1.0 }, std::f64::consts::LN_2), Stream::new(5));
    let (mut worst, mut tried): (f64, usize) = (0.0, 0);
    for round in 0..120 {
        let apart = 5.0 + 90f64.powf(stream.next());
        let body = cloud(round, 1 + (63.0 * stream.next()) as usize, [0.0; 3], [5.0, 5.0, 1.0]);
        let target = cloud(round + 200, 1 + (63.0 * stream.next()) as usize, [apart, 0.0, 0.0], [6.0, 4.0, 3.0]);
        let (rows, columns) = (Side::new(&body, [0.0; 3], kernel.unit), Side::new(&target, [0.0; 3], kernel.unit));
        if !fits(&rows.boxes[0], &columns.boxes[0]) {
            continue;
        }
        tried += 1;
        let gap = rows.boxes[0].gap(&columns.boxes[0]);
        let tile = BriefTile {
            rows: rows.rows(0).x,
            columns: columns.centred.leaf(0..columns.columns(0).weight.len()),
            origin: columns.boxes[0].centre(),
            mask: Mask::ALL,
            shift: -gap.floor(),
        };
        let x = |q: usize| [rows.x[0][q], rows.x[1][q], rows.x[2][q]];
        let y = |t: usize| [columns.x[0][t], columns.x[1][t], columns.x[2][t]];
        let e = |q: usize, t: usize| (gap.floor() - distance(x(q), y(t))).exp2();
        let pull: Vec<f64> = (0..body.len()).map(|_| stream.next()).collect();
        let mut charge: Vec<f64> = (0..target.len()).map(|_| stream.next()).collect();
        charge.resize(columns.columns(0).weight.len(), 0.0);
        for machine in Machine::all() {
            let (mut row_sums, mut column_sums) = (vec![0.0; body.len() * WIDTH], vec![0.0; charge.len()]);
            machine.run(BriefSums {
                tile,
                row_weights: rows.rows(0).weight,
                column_weights: columns.columns(0).weight,
                row_factor: 2.0,
                column_factor: 0.5,
                row_sums: &mut row_sums,
                column_sums: &mut column_sums,
            });
            let mut out = vec![0.0; body.len() * PULL];
            machine.run(BriefPull {
                tile,
                row_weights: rows.rows(0).weight,
                pull: &pull,
                column_weights: columns.columns(0).weight,
                charge: &charge,
                row_factor: 2.0,
                column_factor: 0.5,
                out: &mut out,
            });
            for q in 0..body.len() {
                let exact: f64 = (0..target.len()).map(|t| 2.0 * columns.weight[t] * e(q, t)).sum();
                let found: f64 = row_sums[q * WIDTH..][..WIDTH].iter().sum();
                worst = worst.max((found / exact - 1.0).abs());
                let causes = |t: usize| 0.5 * rows.weight[q] * charge[t] + 2.0 * pull[q] * columns.weight[t];
                let [fx, fy, fz, mass]: [f64; 4] = collect(&out[q * PULL..][..PULL]);
                let all: f64 = (0..target.len()).map(|t| causes(t) * e(q, t)).sum();
                for (d, found) in [fx, fy, fz].into_iter().enumerate() {
                    let term = |t: usize| causes(t) * e(q, t) * (x(q)[d] - y(t)[d]) / distance(x(q), y(t));
                    let exact: f64 = (0..target.len()).map(term).sum();
                    worst = worst.max((found - exact).abs() / all);
                }
                let exact: f64 = (0..target.len()).map(|t| 0.5 * charge[t] * e(q, t)).sum();
                worst = worst.max((mass / exact - 1.0).abs());
            }
            for (t, found) in column_sums[..target.len()].iter().enumerate() {
                let exact: f64 = (0..body.len()).map(|q| 0.5 * rows.weight[q] * e(q, t)).sum();
                worst = worst.max((found / exact - 1.0).abs());
            }
        }
    }
    assert!(tried > 60, "only {tried} tiles");
    // A bound a thousand times too large would be as good as none.
    assert!(worst < ERROR && worst > 1e-3 * ERROR, "{worst:.1e}");
}

#[test]
fn tiles_that_touch_or_reach_far_are_left_to_full_precision() {
    let kernel = Kernel::new(Phi::Exponential { length: 1.0 }, std::f64::consts::LN_2);
    let fits_at = |x: f64| {
        let (body, target) = (cloud(1, 64, [0.0; 3], [2.0; 3]), cloud(2, 64, [x, 0.0, 0.0], [2.0; 3]));
        let (rows, columns) = (Side::new(&body, [0.0; 3], kernel.unit), Side::new(&target, [0.0; 3], kernel.unit));
        fits(&rows.boxes[0], &columns.boxes[0])
    };
    assert!(!fits_at(0.0) && !fits_at(1.9) && fits_at(2.5) && fits_at(80.0) && !fits_at(100.0));
}
