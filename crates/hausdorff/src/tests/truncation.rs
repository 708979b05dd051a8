//! What is left out of the sums: their error against all pairs, and the lower bounds that decide.

use super::super::kernel::Kernel;
use super::super::lanes::InstructionSet;
use super::super::lower_bounds::LowerBounds;
use super::super::pairs::Pairs;
use super::super::point_set::PointSet;
use super::bodies::{run, skin};
use super::{Cloud, Phi, Stream, Summation, all_phi};

#[test]
fn the_default_keeps_its_bound_on_every_instruction_set() {
    let (body, target) = (skin(1, 1700, 0.6), skin(2, 1500, 1e-6));
    for phi in all_phi(0.5) {
        let alpha = 40.0;
        let (_, exact, vjp_exact) = run(&body, &target, phi, alpha, Summation::Direct);
        let slope = alpha * phi.log_derivative(phi.length()).abs().max(phi.log_derivative(0.0).abs());
        let seeds = (body.len() + target.len()) as f64;
        for instructions in InstructionSet::all() {
            let pairs = Pairs::on(instructions, &body, &target, phi, alpha, Summation::default()).unwrap();
            let counts = pairs.counts();
            if let Phi::Exponential { .. } = phi {
                assert!(counts.summed < 0.95 * counts.all, "{counts:?}");
            }
            let sums = pairs.log_sums();
            let all = sums.target.iter().zip(&exact.target).chain(sums.body.iter().zip(&exact.body));
            let off = all.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "{phi:?} {instructions:?}: {off:.1e}");
            let mut stream = Stream::new(99);
            let mut seed = |n: usize| (0..n).map(|_| 2.0 * stream.next() - 1.0).collect::<Vec<_>>();
            let (by_target, by_body) = (seed(target.len()), seed(body.len()));
            let vjp = pairs.vjp(&sums, &by_target, &by_body).unwrap();
            let pairs_of = vjp.points.iter().flatten().zip(vjp_exact.points.iter().flatten());
            let off: f64 = pairs_of.map(|(a, b)| (a - b).abs()).sum();
            assert!(off < 1e-10 * slope * seeds, "{phi:?} {instructions:?}: {:.1e}", off / (slope * seeds));
            let weights = vjp.weights.iter().zip(&vjp_exact.weights).zip(body.weights());
            let off: f64 = weights.map(|((a, b), w)| (a - b).abs() * w).sum();
            assert!(off < 1e-10 * seeds, "{phi:?} {instructions:?}: {:.1e}", off / seeds);
        }
    }
}

/// A heap at a distance where every pair is small, but not all of them together.
#[test]
fn what_is_left_out_is_added_up() {
    let at = |x: f64, n: usize| (0..n).map(move |k| [x + 1e-9 * k as f64, 0.0, 0.0]);
    let body = Cloud::new(at(0.0, 64).chain(at(36.2, 64)).collect(), vec![1.0; 128]).unwrap();
    // At the first 64 points sums of about 2^-5 from the near ones, and 2^-36.2 from the others.
    let target = Cloud::new(at(0.0, 64).chain(at(36.2, 2048)).collect(), vec![1.0; 2112]).unwrap();
    let (phi, alpha) = (Phi::Exponential { length: 1.0 }, std::f64::consts::LN_2);
    let (_, exact, _) = run(&body, &target, phi, alpha, Summation::Direct);
    let (_, sums, _) = run(&body, &target, phi, alpha, Summation::default());
    let off = sums.body.iter().zip(&exact.body).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-10, "{off:.1e}");
}

#[test]
fn lower_bounds_are_below_the_sums_and_near() {
    let (body, target) = (skin(5, 1000, 0.6), skin(6, 900, 1e-6));
    for phi in all_phi(0.3) {
        for alpha in [1.0, 10.0] {
            let kernel = Kernel::new(phi, alpha);
            let origin = target.centre();
            let (rows, columns) =
                (PointSet::new(&body, origin, kernel.unit), PointSet::new(&target, origin, kernel.unit));
            let bounds = LowerBounds::new(&rows, &columns, &kernel, InstructionSet::detect());
            let (_, sums, _) = run(&body, &target, phi, alpha, Summation::Direct);
            let mut apart = 0.0;
            for (k, &point) in body.tree().order.iter().enumerate() {
                let sum = (sums.body[point as usize] - kernel.log_at_zero) * std::f64::consts::LOG2_E;
                let lower = bounds.scale[k];
                assert!(lower <= sum + 1e-9, "{phi:?} {alpha}: {lower} above {sum}");
                apart += (sum - lower) / body.len() as f64;
            }
            assert!(apart < 6.0, "{phi:?} {alpha}: {apart} powers of two below");
        }
    }
}
