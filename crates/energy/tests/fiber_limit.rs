//! The tension limits are the best possible: at the limit the sum is polyconvex (contract tests), just above it even
//! ellipticity is lost at some deformation.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_energy::{
    EnergyTerm, FiberTension, MaterialPoint, MooneyRivlin, NeoHooke, NeoHookeIsochoric, TensionBound,
    TransverseMooneyRivlin, Yeoh, check,
};
use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

/// Second derivative of the energy at `f` along `b n`, the smallest over unit vectors `b`.
fn least_wave(law: &dyn EnergyTerm, a: &Vec3, tension: f64, f: Mat3, n: &Vec3) -> f64 {
    let k = Kinematics::new(f).unwrap();
    let mut tangent = check::evaluate(law, HERE, &k, &[]).tangent;
    tangent.add(&check::evaluate(&FiberTension::along(*a).unwrap(), HERE, &k, &[tension]).tangent);
    least_eigenvalue(&tangent, n)
}

/// Of the acoustic tensor for waves along `n`.
fn least_eigenvalue(tangent: &Tangent, n: &Vec3) -> f64 {
    let acoustic = Mat3::from_fn(|i, j| {
        let mut unit = Mat3::zeros();
        unit.set_row(j, &n.transpose());
        (tangent.apply(&unit) * n)[i]
    });
    acoustic.symmetric_eigenvalues().min()
}

/// Stretch 1 along `n`, nearly none across it: `F x (b n)`, and with it what `|H|^2` resists, all but vanishes for `b`
/// across `n`, while `J` takes no part.
fn thin(n: &Vec3) -> Mat3 {
    let along = n * n.transpose();
    along + (Mat3::identity() - along) * 1e-3
}

fn assert_sharp(law: &dyn EnergyTerm, a: Vec3, n: Vec3, f: Mat3) {
    let limit = law.fiber_limit(HERE, &a).unwrap();
    assert!(least_wave(law, &a, limit, f, &n) >= -1e-2, "{law:?} is not elliptic at its limit");
    let above = least_wave(law, &a, limit + 10.0, f, &n);
    assert!(above < -1.0, "{law:?} is still elliptic above its limit along {a:?}: {above}");
}

#[test]
fn mooney_rivlin() {
    let law = MooneyRivlin::new(1e5, 2e4, 1e6).unwrap();
    let a = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    assert_eq!(law.fiber_limit(HERE, &a), Some(2e5));
    assert_sharp(&law, a, a, thin(&a));
}

#[test]
fn neo_hooke() {
    let law = NeoHooke::new(1e5, 1e6).unwrap();
    let a = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    assert_eq!(law.fiber_limit(HERE, &a), Some(1e5));
    assert_sharp(&law, a, a, thin(&a));
}

#[test]
fn neo_hooke_isochoric() {
    let law = NeoHookeIsochoric::new(1e5, 1e6).unwrap();
    assert_eq!(law.fiber_limit(HERE, &Vec3::x()), Some(0.0));
    // Its curvature in F fades as J grows: no positive tension survives everywhere.
    assert_sharp(&law, Vec3::x(), Vec3::x(), Mat3::identity() * 1e8);
}

#[test]
fn transverse_mooney_rivlin_at_any_angle() {
    let (mu1, mu3) = (1e5, 3e5);
    let f = Vec3::new(0.0, 0.6, 0.8);
    let law = TransverseMooneyRivlin::new(mu1, 2e4, mu3, 1e6, f).unwrap();
    let across = Vec3::x();
    assert_eq!(law.fiber_limit(HERE, &across), Some(2.0 * mu1));
    assert!((law.fiber_limit(HERE, &f).unwrap() - 2.0 * (mu1 + mu3)).abs() < 1e-6);
    for angle in [0.0f64, 0.3, 0.8, 1.2, std::f64::consts::FRAC_PI_2] {
        let a = f * angle.cos() + across * angle.sin();
        // The weakest direction is (mu1 I + mu3 f f)^-1 a.
        let n = (f * (angle.cos() / (mu1 + mu3)) + across * (angle.sin() / mu1)).normalize();
        let limit = law.fiber_limit(HERE, &a).unwrap();
        assert!((2e5 - 1e-6..=8e5 + 1e-6).contains(&limit));
        assert_sharp(&law, a, n, thin(&n));
    }
}

/// Two families at the same tension are weakest along the line halfway between them, where each counts by the squared cosine.
#[test]
fn two_families_together() {
    let law = NeoHooke::new(1e5, 1e6).unwrap();
    let n = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    let across = Vec3::new(1.0, 2.0, 0.0) / 5.0f64.sqrt();
    for half_angle in [0.0f64, 0.3, std::f64::consts::FRAC_PI_6, 0.7] {
        let [a, b] = [1.0, -1.0].map(|side| n * half_angle.cos() + across * (side * half_angle.sin()));
        let bound = law.fiber_bound(HERE).unwrap();
        let limit = bound.largest_multiple(&(a * a.transpose() + b * b.transpose()));
        assert!((limit / (1e5 / (1.0 + (2.0 * half_angle).cos())) - 1.0).abs() < 1e-12, "{half_angle}: {limit}");
        let both = |tension: f64| {
            let k = Kinematics::new(thin(&n)).unwrap();
            let mut tangent = check::evaluate(&law, HERE, &k, &[]).tangent;
            for family in [a, b] {
                tangent.add(&check::evaluate(&FiberTension::along(family).unwrap(), HERE, &k, &[tension]).tangent);
            }
            least_eigenvalue(&tangent, &n)
        };
        assert!(
            both(limit) >= -1e-2 && both(limit + 10.0) < -1.0,
            "{half_angle}: {} {}",
            both(limit),
            both(limit + 10.0)
        );
    }
}

#[test]
fn a_bound_of_zero_bears_contraction_alone() {
    let (bound, x) = (TensionBound::isotropic(0.0), Vec3::x());
    let along_x = x * x.transpose();
    assert_eq!(
        [bound.along(&x), bound.largest_multiple(&along_x), bound.largest_multiple(&-along_x)],
        [0.0, 0.0, f64::INFINITY]
    );
}

#[test]
fn a_law_that_is_not_polyconvex_states_no_bound() {
    let (stiff, soft) = (Yeoh::new(1.0, 0.01, 2e-3, 1e3).unwrap(), Yeoh::new(1.0, -0.01, 2e-3, 1e3).unwrap());
    assert_eq!(stiff.fiber_limit(HERE, &Vec3::x()), Some(0.0));
    assert_eq!(soft.fiber_limit(HERE, &Vec3::x()), None);
}
