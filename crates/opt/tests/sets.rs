//! The contract of every admissible set of the catalogue.
#![allow(clippy::unwrap_used)]

use nastic_numeric::Random;
use nastic_opt::Admissible;
use nastic_opt::admissible::{CATALOGUE, SetRow};
use std::sync::Arc;

const POINTS: usize = 7;

struct Example {
    row: &'static SetRow,
    set: Arc<dyn Admissible>,
    random: Random,
}

impl Example {
    fn vector(&mut self, size: f64) -> Vec<f64> {
        (0..POINTS * self.row.components).map(|_| size * self.random.symmetric()).collect()
    }

    /// An admissible control: often on the boundary.
    fn control(&mut self) -> Vec<f64> {
        let mut m = self.vector(2.0);
        self.set.project(&mut m);
        m
    }

    /// A step of the local model at m.
    fn step(&mut self, m: &[f64], size: f64) -> Vec<f64> {
        let mut d = self.vector(size);
        self.set.restrict(m, &mut d);
        d
    }
}

/// Calls back many times for every row, with another state of the random generator.
fn for_every_set(mut test: impl FnMut(&mut Example)) {
    for row in CATALOGUE {
        let set = (row.make)(POINTS).unwrap();
        let mut example = Example { row, set, random: Random::new(7) };
        for _ in 0..40 {
            test(&mut example);
        }
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn projections_are_admissible_idempotent_and_nearest() {
    for_every_set(|at| {
        let wild = at.vector(3.0);
        let mut nearest = wild.clone();
        at.set.project(&mut nearest);
        assert!(at.set.check(&nearest).is_ok(), "{}", at.row.name);
        let mut again = nearest.clone();
        at.set.project(&mut again);
        assert!(distance(&again, &nearest) < 1e-15, "{}: not idempotent", at.row.name);
        for _ in 0..20 {
            let other = at.control();
            let (own, others) = (distance(&nearest, &wild), distance(&other, &wild));
            assert!(own <= others * (1.0 + 1e-14), "{}: {own} and {others}", at.row.name);
        }
        // Nor are those that a short step towards it leads to.
        for t in [1e-3, 0.1] {
            let mut d: Vec<f64> = wild.iter().zip(&nearest).map(|(w, n)| t * (w - n)).collect();
            at.set.restrict(&nearest, &mut d);
            let mut near = nearest.clone();
            at.set.retract(&nearest, &d, 1.0, &mut near);
            assert!(distance(&nearest, &wild) <= distance(&near, &wild) * (1.0 + 1e-14), "{}", at.row.name);
        }
    });
}

#[test]
fn controls_outside_are_refused() {
    for_every_set(|at| {
        let mut m = at.control();
        m[0] = 2.5;
        assert!(at.set.check(&m).is_err(), "{}", at.row.name);
        m[0] = f64::NAN;
        assert!(at.set.check(&m).is_err(), "{}", at.row.name);
    });
}

#[test]
fn steps_of_the_local_model_are_its_own_nearest() {
    for_every_set(|at| {
        let m = at.control();
        let wild = at.vector(2.0);
        let mut d = wild.clone();
        at.set.restrict(&m, &mut d);
        let mut again = d.clone();
        at.set.restrict(&m, &mut again);
        assert!(distance(&again, &d) < 1e-14, "{}: not idempotent", at.row.name);
        let other = at.step(&m, 2.0);
        assert!(distance(&d, &wild) <= distance(&other, &wild) * (1.0 + 1e-14), "{}", at.row.name);
        if at.row.convex {
            let mut moved: Vec<f64> = m.iter().zip(&d).map(|(m, d)| m + d).collect();
            let exact = moved.clone();
            at.set.project(&mut moved);
            assert!(distance(&moved, &exact) < 1e-14, "{}: the step leaves the set", at.row.name);
        }
    });
}

#[test]
fn retractions_are_admissible_and_begin_along_the_step() {
    for_every_set(|at| {
        let m = at.control();
        let d = at.step(&m, 1.0);
        let mut out = m.clone();
        for t in [0.0, 1e-8, 0.3, 1.0, 4.0, 1e3] {
            at.set.retract(&m, &d, t, &mut out);
            assert!(at.set.check(&out).is_ok(), "{} at {t}", at.row.name);
        }
        at.set.retract(&m, &d, 0.0, &mut out);
        assert!(distance(&out, &m) < 1e-15, "{}: m(0) = m", at.row.name);
        let t = 1e-6;
        at.set.retract(&m, &d, t, &mut out);
        let moved: Vec<f64> = out.iter().zip(&m).map(|(a, b)| (a - b) / t).collect();
        assert!(distance(&moved, &d) < 1e-4, "{}: m'(0) = d: {:e}", at.row.name, distance(&moved, &d));
    });
}

#[test]
fn tangents_and_transports_are_projections() {
    for_every_set(|at| {
        let (m, to) = (at.control(), at.control());
        let mut v = at.vector(1.0);
        at.set.tangent(&m, &mut v);
        let mut again = v.clone();
        at.set.tangent(&m, &mut again);
        assert!(distance(&again, &v) < 1e-14, "{}: tangent", at.row.name);
        let mut carried = v.clone();
        at.set.transport(&m, &to, &mut carried);
        let mut there = carried.clone();
        at.set.tangent(&to, &mut there);
        assert!(distance(&there, &carried) < 1e-14, "{}: transport", at.row.name);
        // Tangential steps leave a curved set to second order only.
        if !at.row.convex {
            let t = 1e-5;
            let mut moved: Vec<f64> = m.iter().zip(&v).map(|(m, v)| m + t * v).collect();
            let straight = moved.clone();
            at.set.project(&mut moved);
            assert!(distance(&moved, &straight) < 1e-8, "{}: {:e}", at.row.name, distance(&moved, &straight));
        }
    });
}

/// The face's projector is orthogonal, and at a minimiser nothing is left of minus the gradient on it.
#[test]
fn faces_hold_what_pushes_outward() {
    for_every_set(|at| {
        let wild = at.vector(3.0);
        let mut m = wild.clone();
        at.set.project(&mut m);
        // m minimises |m - wild|^2/2 over the set.
        let mut derivative: Vec<f64> = m.iter().zip(&wild).map(|(m, w)| m - w).collect();
        at.set.tangent(&m, &mut derivative);
        let face = at.set.face(&m, &vec![0.0; m.len()], &derivative);
        let left = face.projected(&derivative);
        assert!(left.iter().all(|x| x.abs() < 1e-12), "{}: {left:?}", at.row.name);
        let (a, b) = (at.vector(1.0), at.vector(1.0));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (ab, ba) = (dot(&face.projected(&a), &b), dot(&a, &face.projected(&b)));
        assert!((ab - ba).abs() < 1e-13, "{}", at.row.name);
        let once = face.projected(&a);
        assert!(distance(&face.projected(&once), &once) < 1e-14, "{}", at.row.name);
    });
}

/// Along an inward direction the curve m(t) is not bent by a bound: it is straight in a convex set.
#[test]
fn inward_directions_stay_inside() {
    for_every_set(|at| {
        let m = at.control();
        let mut d = at.vector(0.5);
        at.set.inward(&m, &mut d);
        let mut out = m.clone();
        for t in [0.1, 0.5, 1.0] {
            at.set.retract(&m, &d, t, &mut out);
            assert!(at.set.check(&out).is_ok(), "{}", at.row.name);
            if at.row.convex {
                let straight: Vec<f64> = m.iter().zip(&d).map(|(m, d)| m + t * d).collect();
                assert!(distance(&out, &straight) < 1e-13, "{} at {t}", at.row.name);
            }
        }
        let extent = at.set.extent(&m);
        assert!(extent.len() == m.len() && extent.iter().all(|e| e.is_finite() && *e >= 0.0), "{}", at.row.name);
    });
}

/// Along the curve m(t) of v, a cost c . m changes by t c . v + t^2/2 (curvature along v) . v + O(t^3).
#[test]
fn curvature_is_that_of_the_curve() {
    for row in CATALOGUE {
        let points = 3;
        let set = (row.make)(points).unwrap();
        let n = points * row.components;
        let numbers = |seed: f64| (0..n).map(|i| ((i as f64 + seed) * 12.9898).sin()).collect::<Vec<f64>>();
        // Far out, so that balls are met at their boundary, and pushed on.
        let mut m: Vec<f64> = numbers(0.4).iter().map(|x| 10.0 * x).collect();
        set.project(&mut m);
        let c: Vec<f64> = numbers(0.4).iter().map(|x| -x).collect();
        let mut v = set.face(&m, &vec![0.0; n], &c).projected(&numbers(2.0));
        set.tangent(&m, &mut v);
        let mut curvature = vec![0.0; n];
        set.add_curvature(&m, &c, &v, &mut curvature);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let remainder = |t: f64| {
            let mut at = m.clone();
            set.retract(&m, &v, t, &mut at);
            let change: Vec<f64> = at.iter().zip(&m).map(|(a, b)| a - b).collect();
            (dot(&c, &change) - t * dot(&c, &v) - 0.5 * t * t * dot(&curvature, &v)).abs()
        };
        let (large, small) = (remainder(1e-2), remainder(1e-3));
        assert!(large < 1e-13 || small < large / 500.0, "{}: {large:e} {small:e}", row.name);
        let flat = row.name == "bounds";
        assert!(flat == curvature.iter().all(|x| *x == 0.0), "{}", row.name);
    }
}

/// A step that nothing holds is left alone to the bit: methods show by that whether a bound acts.
#[test]
fn steps_within_the_set_stay_to_the_bit() {
    for row in CATALOGUE.iter().filter(|row| row.convex) {
        let set = (row.make)(5).unwrap();
        let n = 5 * row.components;
        let numbers =
            |seed: f64, size: f64| (0..n).map(|i| size * ((i as f64 + seed) * 12.9898).sin()).collect::<Vec<f64>>();
        let (m, d) = (numbers(0.4, 0.2), numbers(3.0, 0.1));
        let mut restricted = d.clone();
        set.restrict(&m, &mut restricted);
        assert_eq!(restricted, d, "{}", row.name);
        assert_eq!(set.reach(&m, &vec![0.0; n], &d), 1.0, "{}", row.name);
    }
}
