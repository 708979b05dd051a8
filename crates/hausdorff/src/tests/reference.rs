//! Values and derivatives against numbers from 60-digit arithmetic and against the formulas written out.

use super::super::lanes::InstructionSet;
use super::super::pairs::Pairs;
use super::{Cloud, Evaluation, Phi, Summation, all_phi, bars, close, distance, smoothing};

const BODY: [[f64; 3]; 5] =
    [[0.0, 0.0, 0.0], [0.5, 0.125, -0.25], [1.0, 0.25, 0.5], [0.25, 0.75, 0.125], [0.875, -0.5, 0.0]];
const WEIGHTS: [f64; 5] = [0.5, 0.25, 1.0, 0.75, 0.375];
const TARGET: [[f64; 3]; 4] = [[0.125, 0.0625, 1.0], [0.75, 0.5, 0.75], [1.5, 0.0, 0.25], [-0.25, 0.25, 0.5]];
const TARGET_WEIGHTS: [f64; 4] = [0.25, 1.0, 0.5, 0.625];
/// A velocity of the points and its divergence: the weights change by dw = w div.
const VELOCITY: [[f64; 3]; 5] =
    [[0.5, -0.25, 1.0], [-1.0, 0.75, 0.25], [0.125, 0.5, -0.5], [0.75, -0.125, 0.375], [-0.25, 1.0, -0.75]];
const DIVERGENCE: [f64; 5] = [0.5, -0.75, 0.25, 1.0, -0.375];

const EXPONENTIAL: Phi = Phi::Exponential { length: 0.25 };
const INVERSE: Phi = Phi::Inverse { eps: 0.125 };
const SMOOTH: Phi = Phi::SmoothInverse { eps: 0.0625 };

/// phi, (alpha, beta, gamma), and from mpmath with 60 digits: rho, D1, D2 from their definitions, d rho[v] by central differences with step 1e-20 and
/// (the same to 1e-37) from the formula with H : grad v.
const ROWS: [(Phi, [f64; 3], [f64; 4]); 15] = [
    (EXPONENTIAL, [1.0, 1.0, 1.0], [1.1519860374486925, 0.7940361742287939, 0.8351181035955872, -0.28216633272695535]),
    (EXPONENTIAL, [4.0, 8.0, 2.0], [1.0031444909603005, 0.8124338895376935, 0.8735403164842117, -0.30426041830774253]),
    (EXPONENTIAL, [60.0, 16.0, 4.0], [0.9869058837782716, 0.8834295882294111, 0.9251235709566943, -0.9146112384543643]),
    (EXPONENTIAL, [2.5, 0.5, 3.5], [0.7879935184830779, 0.6815003442771322, 0.7426367965821057, -0.17549855965244976]),
    (
        EXPONENTIAL,
        [4000.0, 100.0, 50.0],
        [1.0364497717118781, 0.987347554145639, 1.0423135716208605, -0.9553361381061812],
    ),
    (INVERSE, [1.0, 1.0, 1.0], [1.2382447856926229, 0.8634931514664649, 0.8876494179978088, -0.3529385768628074]),
    (INVERSE, [4.0, 8.0, 2.0], [1.0814314419847038, 0.8667738649565515, 0.9500617304285223, -0.32018432142566444]),
    (INVERSE, [60.0, 16.0, 4.0], [1.0003707104722612, 0.8956598010710702, 0.9375911158056477, -0.5313389042711574]),
    (INVERSE, [2.5, 0.5, 3.5], [0.8944439949510556, 0.7906201157028184, 0.828510599441984, -0.22560518069606883]),
    (INVERSE, [4000.0, 100.0, 50.0], [1.0367609820498467, 0.9877259349165185, 1.0426207695177956, -0.9556936110942624]),
    (SMOOTH, [1.0, 1.0, 1.0], [1.221374388547268, 0.8492869777981512, 0.8779972472205415, -0.34393572680848183]),
    (SMOOTH, [4.0, 8.0, 2.0], [1.0713264111591068, 0.8585170219396591, 0.9413279938644777, -0.31877698758892914]),
    (SMOOTH, [60.0, 16.0, 4.0], [0.9990972826459016, 0.8943709372679938, 0.9365271973951474, -0.5636948208441314]),
    (SMOOTH, [2.5, 0.5, 3.5], [0.875526667102188, 0.7696949947598529, 0.8146807530320851, -0.21825008216577685]),
    (SMOOTH, [4000.0, 100.0, 50.0], [1.0367207316844236, 0.9876741316962331, 1.0425812417654707, -0.9556868897616161]),
];

#[test]
fn high_precision_values_and_slopes() {
    let body = Cloud::new(BODY.to_vec(), WEIGHTS.to_vec()).unwrap();
    let target = Cloud::new(TARGET.to_vec(), TARGET_WEIGHTS.to_vec()).unwrap();
    for (phi, [alpha, beta, gamma], [rho, d1, d2, slope]) in ROWS {
        let e = Evaluation::new(&body, &target, smoothing(phi, alpha, beta, gamma), Summation::Direct).unwrap();
        let found = e.distance();
        close(found.rho, rho, 1e-13);
        close(found.target_to_body, d1, 1e-13);
        close(found.body_to_target, d2, 1e-13);
        let partials = e.partials().unwrap();
        let by_points: f64 = (0..5).map(|q| (0..3).map(|d| partials.points[q][d] * VELOCITY[q][d]).sum::<f64>()).sum();
        let by_weights: f64 = (0..5).map(|q| partials.weights[q] * WEIGHTS[q] * DIVERGENCE[q]).sum();
        close(by_points + by_weights, slope, 3e-12);
    }
}

/// log of the weighted mean of phi^alpha, straight from its definition (shifted by its largest term).
fn log_mean(phi: Phi, alpha: f64, at: [f64; 3], cloud: &Cloud) -> f64 {
    let logs: Vec<f64> = cloud.points().iter().map(|&x| alpha * phi.log(distance(at, x))).collect();
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = logs.iter().zip(cloud.weights()).map(|(log, w)| w * (log - largest).exp()).sum();
    largest + (sum / cloud.measure()).ln()
}

#[test]
fn log_sums_on_every_instruction_set() {
    for (m, n) in [(1, 1), (3, 7), (64, 65), (150, 391)] {
        let (body, target) = bars(m, n);
        for phi in all_phi(0.1) {
            // From no decay at all to one that leaves the range of numbers between neighbours.
            for alpha in [1e-3, 1.0, 60.0, 1e4, 1e6] {
                for instructions in InstructionSet::all() {
                    let sums =
                        Pairs::on(instructions, &body, &target, phi, alpha, Summation::Direct).unwrap().log_sums();
                    let scale = alpha * phi.log(0.0).abs().max(phi.log(2.0).abs());
                    for (&y, log) in target.points().iter().zip(&sums.target) {
                        let exact = log_mean(phi, alpha, y, &body);
                        assert!((log - exact).abs() < 3e-15 * scale + 1e-14, "{phi:?} {alpha}: {log} {exact}");
                    }
                    for (&x, log) in body.points().iter().zip(&sums.body) {
                        let exact = log_mean(phi, alpha, x, &target);
                        assert!((log - exact).abs() < 3e-15 * scale + 1e-14, "{phi:?} {alpha}: {log} {exact}");
                    }
                }
            }
        }
    }
}

/// rho by powers of plain numbers: good for moderate exponents only.
fn plain(phi: Phi, exponents: [f64; 3], body: &Cloud, target: &Cloud) -> f64 {
    let [alpha, beta, gamma] = exponents;
    let inverse = |value: f64| match phi {
        Phi::Exponential { length } => -length * value.ln(),
        Phi::Inverse { eps } => 1.0 / value - eps,
        Phi::SmoothInverse { eps } => (value.powi(-2) - eps * eps).sqrt(),
    };
    let value = |r: f64| match phi {
        Phi::Exponential { length } => (-r / length).exp(),
        Phi::Inverse { eps } => 1.0 / (r + eps),
        Phi::SmoothInverse { eps } => (r * r + eps * eps).powf(-0.5),
    };
    let one_sided = |from: &Cloud, to: &Cloud| {
        let mut mean = 0.0;
        for (&y, v) in from.points().iter().zip(from.weights()) {
            let terms = to.points().iter().zip(to.weights());
            let sum: f64 = terms.map(|(&x, w)| w * value(distance(x, y)).powf(alpha)).sum();
            mean += v * inverse((sum / to.measure()).powf(1.0 / alpha)).powf(beta) / from.measure();
        }
        mean.powf(1.0 / beta)
    };
    let (d1, d2) = (one_sided(target, body), one_sided(body, target));
    ((d1.powf(gamma) + d2.powf(gamma)) / 2f64.sqrt()).powf(1.0 / gamma)
}

#[test]
fn plain_formula_for_moderate_exponents() {
    let (body, target) = bars(300, 500);
    for phi in all_phi(0.2) {
        for exponents in [[1.0, 1.0, 1.0], [2.0, 4.0, 2.0], [8.0, 6.0, 3.0], [0.5, 2.5, 0.7]] {
            let [alpha, beta, gamma] = exponents;
            for summation in [Summation::Direct, Summation::default(), Summation::Truncated { tolerance: 1e-12 }] {
                let e = Evaluation::new(&body, &target, smoothing(phi, alpha, beta, gamma), summation).unwrap();
                close(e.distance().rho, plain(phi, exponents, &body, &target), 1e-12);
            }
        }
    }
}

#[test]
fn two_dimensions_are_three_with_zero() {
    let flat = |cloud: &Cloud| {
        let points = cloud.points().iter().map(|x| [x[0], x[1], 0.0]).collect();
        Cloud::new(points, cloud.weights().to_vec()).unwrap()
    };
    let (body, target) = bars(200, 210);
    let (body, target) = (flat(&body), flat(&target));
    let e = Evaluation::new(&body, &target, smoothing(EXPONENTIAL, 4.0, 2.0, 2.0), Summation::Direct).unwrap();
    close(e.distance().rho, plain(EXPONENTIAL, [4.0, 2.0, 2.0], &body, &target), 1e-12);
    assert!(e.partials().unwrap().points.iter().all(|x| x[2] == 0.0));
}
