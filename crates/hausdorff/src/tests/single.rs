//! What is left out and what is summed in single precision: the functions, one tile, and the sums against all pairs.

use super::super::floor::Floor;
use super::super::kernel::Kernel;
use super::super::lanes::{Lanes, Machine, Task, WIDTH};
use super::super::mask::Mask;
use super::super::pairs::Pairs;
use super::super::side::Side;
use super::super::single::{SingleSums, SingleTile, error};
use super::super::single_lanes::ROUNDING;
use super::far::{run, skin};
use super::{Cloud, Method, Phi, Stream, all_phi, cloud};

/// 2^z or 1 / sqrt z in single precision.
struct Apply<'a>(bool, &'a mut [f32]);

impl Task for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        for x in S::as_mut_simd_f32s(self.1).0 {
            *x = if self.0 { s.exp2_single(*x) } else { s.rsqrt_single(*x) };
        }
    }
}

#[test]
fn elementary_functions_in_single_precision() {
    let errors = |machine: Machine, exponential: bool, x: Vec<f32>, exact: fn(f64) -> f64| {
        let mut y = x.clone();
        machine.run(Apply(exponential, &mut y));
        let off = |(&x, &y): (&f32, &f32)| (f64::from(y) / exact(f64::from(x)) - 1.0).abs();
        x.iter().zip(&y).map(off).fold(0.0, f64::max)
    };
    let numbers = |from: f32, to: f32| (0..1 << 14).map(|k| from + (to - from) * (k as f32 / 16384.0)).collect();
    for machine in Machine::all() {
        assert!(errors(machine, true, numbers(-125.0, 120.0), f64::exp2) < 5.0 * ROUNDING, "{machine:?}");
        assert!(errors(machine, true, numbers(-1.0, 1.0), f64::exp2) < 5.0 * ROUNDING, "{machine:?}");
        assert!(errors(machine, false, numbers(1.0, 4.0), |x| 1.0 / x.sqrt()) < 4.0 * ROUNDING, "{machine:?}");
        assert!(errors(machine, false, numbers(1e-30, 1e30), |x| 1.0 / x.sqrt()) < 4.0 * ROUNDING, "{machine:?}");
        let mut below = [
            -127.0, -1000.0, -1e6, -126.5, -1e5, -150.0, -2e6, -300.0, -127.0, -1e3, -1e6, -126.5, -1e5, -150.0, -2e6,
            -300.0,
        ];
        machine.run(Apply(true, &mut below));
        assert!(below.iter().all(|e| (0.0..=1.2e-38).contains(e)), "{machine:?}: {below:?}");
    }
}

#[test]
fn a_tile_within_its_bound() {
    let (kernel, mut stream) = (Kernel::new(Phi::Exponential { length: 1.0 }, std::f64::consts::LN_2), Stream::new(3));
    let mut worst: f64 = 0.0;
    for round in 0..60 {
        let distance = 9.0 + 60.0 * stream.next();
        let body = cloud(round, 1 + (63.0 * stream.next()) as usize, [0.0; 3], [5.0, 5.0, 1.0]);
        let target =
            cloud(round + 100, 1 + (63.0 * stream.next()) as usize, [5.0 + distance, 0.0, 0.0], [6.0, 4.0, 3.0]);
        let (rows, columns) = (Side::new(&body, [0.0; 3], kernel.unit), Side::new(&target, [0.0; 3], kernel.unit));
        let bound = error(&rows.boxes[0], &columns.boxes[0]).unwrap();
        for machine in Machine::all() {
            let mut row_sums = vec![0.0; body.len() * WIDTH];
            let mut column_sums = vec![0.0; columns.columns(0).weight.len()];
            let gap = rows.boxes[0].gap(&columns.boxes[0]);
            machine.run(SingleSums {
                tile: SingleTile {
                    rows: rows.rows(0).x,
                    columns: columns.local.leaf(0),
                    origin: columns.boxes[0].centre(),
                    mask: Mask::ALL,
                    shift: -gap.floor(),
                },
                row_weights: rows.rounded_weight.leaf(0),
                column_weights: columns.rounded_weight.leaf(0),
                row_factor: 1.0,
                column_factor: 1.0,
                row_sums: &mut row_sums,
                column_sums: &mut column_sums,
            });
            let e = |q: usize, t: usize| {
                let r = super::distance(
                    [rows.x[0][q], rows.x[1][q], rows.x[2][q]],
                    [columns.x[0][t], columns.x[1][t], columns.x[2][t]],
                );
                (gap.floor() - r).exp2()
            };
            for q in 0..body.len() {
                let exact: f64 = (0..target.len()).map(|t| columns.weight[t] * e(q, t)).sum();
                let found: f64 = row_sums[q * WIDTH..][..WIDTH].iter().sum();
                worst = worst.max((found / exact - 1.0).abs() / bound);
            }
            for (t, found) in column_sums[..target.len()].iter().enumerate() {
                let exact: f64 = (0..body.len()).map(|q| rows.weight[q] * e(q, t)).sum();
                worst = worst.max((found / exact - 1.0).abs() / bound);
            }
        }
    }
    // A bound a thousand times too large would be as good as none.
    assert!(worst < 1.0 && worst > 1e-3, "error / bound: {worst:.1e}");
}

#[test]
fn the_automatic_choice_keeps_its_bound_on_every_machine() {
    let (body, target) = (skin(1, 1700, 0.6), skin(2, 1500, 1e-6));
    for phi in all_phi(0.5) {
        let alpha = 40.0;
        let (_, exact, pulled_exact) = run(&body, &target, phi, alpha, Method::Direct);
        let slope = alpha * phi.log_derivative(phi.length()).abs().max(phi.log_derivative(0.0).abs());
        let seeds = (body.len() + target.len()) as f64;
        for machine in Machine::all() {
            let pairs = Pairs::on(machine, &body, &target, phi, alpha, Method::Auto).unwrap();
            let counts = pairs.counts();
            if let Phi::Exponential { .. } = phi {
                assert!(counts.single > 0.1 * counts.all && counts.near < 0.95 * counts.all, "{counts:?}");
            }
            let sums = pairs.log_sums();
            let all = sums.target.iter().zip(&exact.target).chain(sums.body.iter().zip(&exact.body));
            let off = all.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "{phi:?} {machine:?}: {off:.1e}");
            let mut stream = Stream::new(99);
            let mut seed = |n: usize| (0..n).map(|_| 2.0 * stream.next() - 1.0).collect::<Vec<_>>();
            let (by_target, by_body) = (seed(target.len()), seed(body.len()));
            let pulled = pairs.vjp(&sums, &by_target, &by_body).unwrap();
            let pairs_of = pulled.points.iter().flatten().zip(pulled_exact.points.iter().flatten());
            let off: f64 = pairs_of.map(|(a, b)| (a - b).abs()).sum();
            assert!(off < 1e-10 * slope * seeds, "{phi:?} {machine:?}: {:.1e}", off / (slope * seeds));
            let weights = pulled.weights.iter().zip(&pulled_exact.weights).zip(body.weights());
            let off: f64 = weights.map(|((a, b), w)| (a - b).abs() * w).sum();
            assert!(off < 1e-10 * seeds, "{phi:?} {machine:?}: {:.1e}", off / seeds);
        }
    }
}

/// A heap at a distance where every pair may be left out by the raised bound, but not all of them together.
#[test]
fn what_is_left_out_is_added_up() {
    let at = |x: f64, n: usize| (0..n).map(move |k| [x + 1e-9 * k as f64, 0.0, 0.0]);
    let body = Cloud::new(at(0.0, 64).chain(at(36.2, 64)).collect(), vec![1.0; 128]).unwrap();
    // At the first 64 points sums of about 2^-5 from the near ones, and 2^-36.2 from the others.
    let target = Cloud::new(at(0.0, 64).chain(at(36.2, 2048)).collect(), vec![1.0; 2112]).unwrap();
    let (phi, alpha) = (Phi::Exponential { length: 1.0 }, std::f64::consts::LN_2);
    let (_, exact, _) = run(&body, &target, phi, alpha, Method::Direct);
    let (_, sums, _) = run(&body, &target, phi, alpha, Method::Auto);
    let off = sums.body.iter().zip(&exact.body).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-10, "{off:.1e}");
}

#[test]
fn floors_are_below_the_sums_and_near() {
    let (body, target) = (skin(5, 1000, 0.6), skin(6, 900, 1e-6));
    for phi in all_phi(0.3) {
        for alpha in [1.0, 10.0] {
            let kernel = Kernel::new(phi, alpha);
            let origin = target.centre();
            let (rows, columns) = (Side::new(&body, origin, kernel.unit), Side::new(&target, origin, kernel.unit));
            let floor = Floor::new(&rows, &columns, &kernel, Machine::detect());
            let (_, sums, _) = run(&body, &target, phi, alpha, Method::Direct);
            let mut apart = 0.0;
            for (k, &point) in body.tree().order.iter().enumerate() {
                let sum = (sums.body[point as usize] - kernel.log_at_zero) * std::f64::consts::LOG2_E;
                let lower = floor.chunks[k / 16];
                assert!(lower <= sum + 1e-9, "{phi:?} {alpha}: {lower} above {sum}");
                apart += (sum - lower) / body.len() as f64;
            }
            assert!(apart < 3.0, "{phi:?} {alpha}: {apart} powers of two below");
        }
    }
}
