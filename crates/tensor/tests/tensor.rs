//! The algebra everything constitutive rests on, against definitions written out with permutation symbols.

use nastic_tensor::{Kinematics, Mat3, SymmetricSpectrum, Tangent, Vec3, cofactor, cross, polar_rotation};

fn permutation(i: usize, j: usize, k: usize) -> f64 {
    let [i, j, k] = [i as f64, j as f64, k as f64];
    (i - j) * (j - k) * (k - i) / 2.0
}

/// Fixed, unremarkable matrices without symmetry.
fn sample(seed: usize) -> Mat3 {
    Mat3::from_fn(|i, j| ((1 + seed) as f64 * 1.7 + 3.1 * i as f64 + 5.3 * j as f64 + (i * j) as f64).sin())
}

fn cross_by_definition(a: &Mat3, b: &Mat3) -> Mat3 {
    Mat3::from_fn(|i, j| {
        let mut sum = 0.0;
        for k in 0..3 {
            for m in 0..3 {
                for l in 0..3 {
                    for n in 0..3 {
                        sum += permutation(i, k, m) * permutation(j, l, n) * a[(k, l)] * b[(m, n)];
                    }
                }
            }
        }
        sum
    })
}

fn close(a: &Mat3, b: &Mat3) -> bool {
    (a - b).norm() <= 1e-13 * (1.0 + b.norm())
}

fn same(a: &Tangent, map: impl Fn(&Mat3) -> Mat3) {
    for seed in 0..4 {
        let b = sample(seed + 10);
        assert!(close(&a.apply(&b), &map(&b)), "{} against {}", a.apply(&b), map(&b));
    }
}

#[test]
fn cross_product_follows_its_definition() {
    for seed in 0..5 {
        let (a, b) = (sample(seed), sample(seed + 5));
        assert!(close(&cross(&a, &b), &cross_by_definition(&a, &b)));
        assert!(close(&cofactor(&a), &(cross_by_definition(&a, &a) / 2.0)));
    }
}

#[test]
fn kinematics_of_an_invertible_gradient() {
    let f = sample(1) + Mat3::identity() * 2.0;
    let k = Kinematics::new(f).unwrap();
    assert!((k.j() - f.determinant()).abs() < 1e-13 * k.j());
    assert!(close(k.h(), &(f.try_inverse().unwrap().transpose() * f.determinant())));
    assert!((k.h().dot(&f) / 3.0 - k.j()).abs() < 1e-13 * k.j());
    assert_eq!(Kinematics::rest(), Kinematics::new(Mat3::identity()).unwrap());
}

#[test]
fn inverted_and_undefined_gradients_are_refused() {
    assert_eq!(Kinematics::new(Mat3::from_diagonal(&Vec3::new(-1.0, 1.0, 1.0))).unwrap_err().jacobian, -1.0);
    assert_eq!(Kinematics::new(Mat3::zeros()).unwrap_err().jacobian, 0.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for entry in 0..9 {
            let mut f = Mat3::identity();
            f[entry] = bad;
            assert!(Kinematics::new(f).is_err(), "{f}");
        }
    }
}

#[test]
fn every_accumulation_is_the_map_it_names() {
    let (f, g, s) = (sample(0), sample(1), 1.3);
    let metric = g * g.transpose();
    let a = Vec3::new(0.3, -0.5, 0.8);
    let build = |fill: &dyn Fn(&mut Tangent)| {
        let mut t = Tangent::zero();
        fill(&mut t);
        t
    };
    same(&build(&|t| t.add_identity(s)), |b| b * s);
    same(&build(&|t| t.add_metric(&metric)), |b| b * metric);
    same(&build(&|t| t.add_fiber(&a, s)), |b| b * a * a.transpose() * s);
    same(&build(&|t| t.add_outer(&f, &g, s)), |b| f * g.dot(b) * s);
    same(&build(&|t| t.add_outer_symmetric(&f, &g, s)), |b| (f * g.dot(b) + g * f.dot(b)) * s);
    same(&build(&|t| t.add_spectral(&f, &g, &metric)), |b| {
        let half = f.transpose() * b * g;
        f * metric.component_mul(&(half + half.transpose())) * g.transpose()
    });
    same(&build(&|t| t.add_cross(&f, s)), |b| cross_by_definition(&f, b) * s);
    same(&build(&|t| t.add_cross_squared(&f, s)), |b| cross(&f, &cross(&f, b)) * s);
    same(&build(&|t| t.add_cross_metric(&f, &metric)), |b| cross(&f, &(cross(&f, b) * metric)));
    let full = Tangent(std::array::from_fn(|n| (n as f64 * 0.7).cos()));
    same(&full.transposed(), |b| {
        Mat3::from_fn(|k, l| (0..9).map(|n| full.get(n / 3, n % 3, k, l) * b[(n / 3, n % 3)]).sum())
    });
    same(&full.times_cross(&f), |b| full.apply(&cross(&f, b)));
    same(&build(&|t| t.add_cross_both(&f, &full)), |b| cross(&f, &full.apply(&cross(&f, b))));
    same(&build(&|t| t.add_cross_mixed(&f, &full)), |b| {
        full.apply(&cross(&f, b)) + cross(&f, &full.transposed().apply(b))
    });
    same(&Tangent::from_map(|b| cross(&f, b)), |b| cross(&f, b));
    same(&build(&|t| (0..2).for_each(|_| t.add(&full))), |b| full.apply(b) * 2.0);
}

#[test]
fn the_isotropic_tangent_is_the_sum_of_its_parts() {
    for seed in 0..3 {
        let (f, a) = (sample(seed), sample(seed + 3));
        let h = cofactor(&f);
        let (ff, hh, jj) = (0.7, 1.9, -1.3);
        let mut once = Tangent::zero();
        once.add_identity(0.5); // adds to what is there
        once.add_isotropic(&f, &h, &a, [ff, hh, jj]);
        same(&once, |b| b * (0.5 + ff) + cross(&a, b) + cross(&f, &cross(&f, b)) * hh + h * (jj * h.dot(b)));
    }
}

#[test]
fn the_polar_rotation_is_orthogonal_and_leaves_a_symmetric_stretch() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, -1.9, 2.8).into_inner();
    let axes = nalgebra::Rotation3::from_euler_angles(0.3, 0.4, -0.8).into_inner();
    // axes along the coordinates where rounding would be of the size of the smallest stretch
    let cases = [
        ([1.0; 3], axes),
        ([3.0, 0.5, 1.1], axes),
        ([1e-90, 1e-90, 2e-90], axes),
        ([1e8, 1e-8, 1.0], Mat3::identity()),
    ];
    for (stretches, axes) in cases {
        let u = axes * Mat3::from_diagonal(&stretches.into()) * axes.transpose();
        let r = polar_rotation(&(turn * u)).unwrap();
        assert!((r.transpose() * r - Mat3::identity()).norm() < 1e-14, "{stretches:?}");
        assert!((r - turn).norm() < 1e-14, "{stretches:?}");
    }
    assert_eq!(polar_rotation(&Mat3::zeros()), None);
    assert_eq!(polar_rotation(&-Mat3::identity()), None);
    assert_eq!(polar_rotation(&Mat3::repeat(f64::NAN)), None);
}

/// `A = Q diag Q^T` with orthonormal Q, to rounding, for eigenvalues far apart, close, coinciding, of either sign.
#[test]
fn a_spectrum_is_that_of_its_tensor() {
    let near = 1.0 + 3e-13;
    for (k, values) in [
        [2.0, 0.5, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, near, 1.0],
        [1.0, near, 2.0 - near],
        [3.0, 3.0, 1e-8],
        [1e12, 1.0, 1e-12],
        [-1.0, 0.0, 4.0],
        [0.0, 0.0, 0.0],
        [1e-160, 2e-160, 1e-170],
    ]
    .into_iter()
    .enumerate()
    {
        let turn = polar_rotation(&sample(k)).unwrap_or_else(Mat3::identity);
        let diagonal = Mat3::from_diagonal(&Vec3::from(values));
        for a in [diagonal, turn * diagonal * turn.transpose()] {
            let a = (a + a.transpose()) / 2.0;
            let found = SymmetricSpectrum::new(&a);
            let size = values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            let again = found.axes * Mat3::from_diagonal(&found.values) * found.axes.transpose();
            assert!((again - a).norm() <= 4e-15 * size, "{values:?}: {again} {a}");
            assert!((found.axes.transpose() * found.axes - Mat3::identity()).norm() < 4e-15, "{values:?}");
            let mut sorted: Vec<f64> = found.values.iter().copied().collect();
            let mut expected = values.to_vec();
            sorted.sort_by(f64::total_cmp);
            expected.sort_by(f64::total_cmp);
            for (found, expected) in sorted.iter().zip(&expected) {
                assert!((found - expected).abs() <= 4e-15 * size, "{values:?}: {sorted:?}");
            }
        }
    }
    // of a positive definite tensor that is scaled, small eigenvalues to rounding of themselves
    let (scale, inner) =
        (Mat3::from_diagonal(&Vec3::new(1e6, 1.0, 1e-6)), Mat3::new(2.0, 0.5, 0.3, 0.5, 2.0, 0.4, 0.3, 0.4, 2.0));
    let least = SymmetricSpectrum::new(&(scale * inner * scale)).values.min();
    let expected = inner.determinant() / (2.0 * 2.0 - 0.25) * 1e-12;
    assert!((least / expected - 1.0).abs() < 1e-10, "{least:e} {expected:e}");
    assert!(SymmetricSpectrum::new(&Mat3::repeat(f64::NAN)).values.iter().all(|x| !x.is_finite()));
}
