//! Smoothed Hausdorff sums by number of points, function phi, and value with or without gradient, at alpha = 60 over a
//! body of length 1: `cargo bench --bench hausdorff`.

#![allow(clippy::expect_used)] // a bench that cannot start stops

mod bent_skins;

use bent_skins::BentSkins;
use divan::Bencher;
use nastic::hausdorff::Summation;

const PHIS: [&str; 3] = ["exp", "rat", "smooth"];
const ALPHA: f64 = 60.0;

fn main() {
    divan::main();
}

fn problem(phi: &str, n: usize) -> BentSkins {
    let phi = BentSkins::phi(phi).expect("a known function");
    BentSkins::new(n, phi, ALPHA).expect("points are finite")
}

#[divan::bench(args = PHIS, consts = [1_000, 10_000, 100_000], sample_count = 5)]
fn value<const N: usize>(bencher: Bencher, phi: &str) {
    let problem = problem(phi, N);
    bencher.bench(|| problem.value(Summation::default()));
}

#[divan::bench(args = PHIS, consts = [1_000, 10_000, 100_000], sample_count = 5)]
fn value_and_gradient<const N: usize>(bencher: Bencher, phi: &str) {
    let problem = problem(phi, N);
    bencher.bench(|| problem.value_and_gradient(Summation::default()));
}
