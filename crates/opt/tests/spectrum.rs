//! The spectrum of the reduced Hessian against eigenpairs that problems were made of.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, dot, scale, sub};
use nastic_opt::{
    Admissible, Ball, Bounds, Covariance, Diagonal, Domain, Euclidean, Failed, Hessian, InnerProduct, Objective,
    Product, Request, Spectrum, SpectrumError, SpectrumOptions, Sphere,
};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// j(m) = m . A m / 2 + b . m, A row by row.
#[derive(Clone)]
struct Quadratic {
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
}

impl Quadratic {
    fn times(&self, v: &[f64]) -> Vec<f64> {
        self.a.iter().map(|row| dot(row, v)).collect()
    }

    fn cost(&self, m: &[f64]) -> f64 {
        0.5 * dot(m, &self.times(m)) + dot(&self.b, m)
    }
}

impl Objective for Quadratic {
    type Point = Vec<f64>;
    type Workspace = ();
    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(m.to_vec())
    }
    fn value(&self, m: &Vec<f64>) -> f64 {
        self.cost(m)
    }
    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let mut out = self.times(m);
        axpy(1.0, &self.b, &mut out);
        Ok(out)
    }
    fn hessian_vector(&self, _: &Vec<f64>, v: &[f64], _: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(self.times(v))
    }
    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

/// G = diag(w) + e e^T: not lumped.
#[derive(Debug)]
struct Coupled {
    w: Vec<f64>,
    e: Vec<f64>,
}

impl InnerProduct for Coupled {
    fn len(&self) -> usize {
        self.w.len()
    }
    fn apply(&self, v: &[f64]) -> Vec<f64> {
        let along = dot(&self.e, v);
        (0..v.len()).map(|i| self.w[i] * v[i] + along * self.e[i]).collect()
    }
    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        let of = |x: &[f64]| -> Vec<f64> { x.iter().zip(&self.w).map(|(x, w)| x / w).collect() };
        let (mut out, e) = (of(d), of(&self.e));
        axpy(-dot(&self.e, &out) / (1.0 + dot(&self.e, &e)), &e, &mut out);
        out
    }
}

const N: usize = 40;

fn random(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..n).map(|_| random.symmetric()).collect()
}

fn products() -> [Arc<dyn InnerProduct>; 2] {
    let w: Vec<f64> = (0..N).map(|i| 0.1 + (i % 7) as f64).collect();
    [Arc::new(Diagonal::new(w.clone()).unwrap()), Arc::new(Coupled { w, e: random(77, N) })]
}

fn fixed(i: usize) -> bool {
    i.is_multiple_of(5)
}

/// A quadratic cost whose minimiser within [-1, 1] has every fifth component on a bound and, on the others, this spectrum in this inner
/// product, with its eigenvectors; what the fixed components have to do with it is of another size.
fn quadratic(values: &[f64], metric: &dyn InnerProduct) -> (Quadratic, Vec<f64>, Vec<Vec<f64>>) {
    let free = |mut v: Vec<f64>| {
        v.iter_mut().enumerate().filter(|(i, _)| fixed(*i)).for_each(|(_, v)| *v = 0.0);
        v
    };
    let mut vectors: Vec<Vec<f64>> = Vec::new();
    for k in 0..values.len() {
        let mut v = free(random(100 + k as u64, N));
        for _ in 0..2 {
            vectors.iter().for_each(|q| axpy(-metric.inner(q, &v), q, &mut v));
        }
        scale(1.0 / metric.norm(&v), &mut v);
        vectors.push(v);
    }
    let mut a = vec![vec![0.0; N]; N];
    for (value, v) in values.iter().zip(&vectors) {
        let gv = free(metric.apply(v));
        (0..N).for_each(|i| axpy(value * gv[i], &gv, &mut a[i]));
    }
    for i in (0..N).filter(|i| fixed(*i)) {
        for k in 0..N {
            let entry = 30.0 * ((i * 7 + k * 3) % 11) as f64;
            (a[i][k], a[k][i]) = (entry, entry);
        }
    }
    let m: Vec<f64> = (0..N).map(|i| if fixed(i) { 1.0 } else { 0.02 * i as f64 - 0.4 }).collect();
    let wanted: Vec<f64> = (0..N).map(|i| if fixed(i) { -0.5 } else { 0.0 }).collect();
    let mut out = Quadratic { a, b: vec![0.0; N] };
    out.b = sub(&wanted, &out.times(&m));
    (out, m, vectors)
}

fn spectrum(
    problem: &Quadratic,
    m: &[f64],
    set: impl Admissible + 'static,
    metric: &Arc<dyn InnerProduct>,
    count: usize,
) -> Result<Spectrum, SpectrumError> {
    let domain = Domain { set: Arc::new(set), metric: metric.clone(), cancel: None };
    Spectrum::at(problem, m, &mut m.to_vec(), &domain, &SpectrumOptions::leading(count), &mut ())
}

fn box_of_one() -> Bounds {
    Bounds::new(-1.0, 1.0).unwrap()
}

/// 32 free directions: a fast decay, a value that is there three times, and many small ones.
fn values() -> Vec<f64> {
    let mut values = vec![900.0, 120.0, 35.0, 35.0, 35.0, 2.0, 0.4];
    values.extend((0..25).map(|k| 1e-3 * 0.8f64.powi(k)));
    values
}

#[test]
fn eigenpairs_of_the_free_block_in_the_inner_product() {
    for metric in products() {
        let (problem, m, vectors) = quadratic(&values(), metric.as_ref());
        let found = spectrum(&problem, &m, box_of_one(), &metric, 7).unwrap();
        assert_eq!((found.values.len(), found.free, found.negative), (7, 32, 0));
        for (k, (value, wanted)) in found.values.iter().zip(values()).enumerate() {
            assert!((value - wanted).abs() < 1e-9 * 900.0, "{k}: {value} for {wanted}");
            assert!(found.residuals[k] < 1e-7, "{k}: {:e}", found.residuals[k]);
            let v = &found.vectors[k];
            assert!((0..N).all(|i| !fixed(i) || v[i] == 0.0));
            // In the span of the eigenvectors of its value, of which there may be several.
            let own = vectors.iter().zip(values()).filter(|(_, other)| *other == wanted);
            let share: f64 = own.map(|(q, _)| metric.inner(q, v).powi(2)).sum();
            assert!((share - 1.0).abs() < 1e-6, "{k}: {share}");
            for (l, other) in found.vectors.iter().enumerate() {
                assert!((metric.inner(v, other) - f64::from(k == l)).abs() < 1e-9);
            }
        }
        assert!(found.lowest > -1e-9 && found.lowest < 1e-2, "{:e}", found.lowest);
        assert!(found.products <= 32 + 7, "{}", found.products);
        assert_eq!((found.above(1e-3), found.above(0.1)), (6, 2));
    }
}

/// Four eigenvalues that are one, above a fast decay: all are found, long before the space is the whole one.
#[test]
fn a_multiple_eigenvalue_is_found_as_often_as_it_is_there() {
    let n = 300;
    let value = |i: usize| if i < 4 { 1.0 } else { 0.5f64.powi(i as i32 - 3) };
    let a = (0..n).map(|i| (0..n).map(|k| if i == k { value((i * 7) % n) } else { 0.0 }).collect()).collect();
    let metric: Arc<dyn InnerProduct> = Arc::new(Euclidean::new(n));
    let found = spectrum(&Quadratic { a, b: vec![0.0; n] }, &vec![0.0; n], Bounds::none(), &metric, 6).unwrap();
    for (found, wanted) in found.values.iter().zip([1.0, 1.0, 1.0, 1.0, 0.5, 0.25]) {
        assert!((found - wanted).abs() < 1e-10, "{found} for {wanted}");
    }
    assert!(found.values.len() == 6 && found.products < 60, "{}", found.products);
}

#[test]
fn a_saddle_within_the_free_directions_is_told() {
    for metric in products() {
        let mut values = values();
        values[31] = -7.0;
        let (problem, m, _) = quadratic(&values, metric.as_ref());
        let found = spectrum(&problem, &m, box_of_one(), &metric, 3).unwrap();
        assert_eq!((found.values.len(), found.negative), (3, 1));
        assert!((found.lowest + 7.0).abs() < 1e-3, "{}", found.lowest);
        // All pairs: the last one is that direction, and has no half-width.
        let found = spectrum(&problem, &m, box_of_one(), &metric, 500).unwrap();
        assert_eq!((found.values.len(), found.half_width(31, 1.0)), (32, None));
        assert!((found.values[31] + 7.0).abs() < 1e-8);
    }
}

#[test]
fn half_widths_reach_the_given_cost() {
    for metric in products() {
        let (problem, m, _) = quadratic(&values(), metric.as_ref());
        let found = spectrum(&problem, &m, box_of_one(), &metric, 500).unwrap();
        let rise = 3e-6;
        for k in 0..7 {
            let mut moved = m.clone();
            axpy(found.half_width(k, rise).unwrap(), &found.vectors[k], &mut moved);
            let risen = problem.cost(&moved) - problem.cost(&m);
            assert!((risen - rise).abs() < 1e-4 * rise, "{k}: {risen:e}");
        }
        // The largest value of component i under the given cost, by Lagrange: sqrt(2 rise (A_FF^-1)_ii).
        let width = found.pointwise_half_width(rise);
        for i in [1, 8, 13] {
            let e: Vec<f64> = (0..N).map(|k| f64::from(k == i)).collect();
            let exact = (2.0 * rise * dot(&e, &solve_free(&problem, &e))).sqrt();
            assert!((width[i] - exact).abs() < 1e-3 * exact, "{i}: {} for {exact}", width[i]);
        }
        assert!(width.iter().enumerate().all(|(i, width)| fixed(i) == (*width == 0.0)));
        let few = spectrum(&problem, &m, box_of_one(), &metric, 3).unwrap().pointwise_half_width(rise);
        assert!(few.iter().zip(&width).all(|(few, all)| few <= all));
    }
}

/// A_FF x = d on the free components, by Gauss elimination.
fn solve_free(problem: &Quadratic, d: &[f64]) -> Vec<f64> {
    let mut a = problem.a.clone();
    let mut x = d.to_vec();
    for i in (0..N).filter(|i| fixed(*i)) {
        (0..N).for_each(|k| (a[i][k], a[k][i]) = (f64::from(i == k), f64::from(i == k)));
    }
    for i in 0..N {
        for k in i + 1..N {
            let factor = a[k][i] / a[i][i];
            let row = a[i].clone();
            axpy(-factor, &row, &mut a[k]);
            x[k] -= factor * x[i];
        }
    }
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|k| a[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / a[i][i];
    }
    x
}

/// j = b . m on spheres and within balls: the second derivative is the curvature of the set alone, |b| / (r w) twice at every point, less
/// than zero at the maximum.
#[test]
fn the_curvature_of_the_set_counts() {
    let (points, radius) = (6, 0.3);
    let w: Vec<f64> = (0..3 * points).map(|i| 0.5 + (i / 3) as f64).collect();
    let b = random(5, 3 * points);
    let mut wanted: Vec<f64> = (0..points)
        .flat_map(|p| {
            let size = dot(&b[3 * p..][..3], &b[3 * p..][..3]).sqrt();
            [size / (radius * w[3 * p]); 2]
        })
        .collect();
    wanted.sort_by(|a, b| b.total_cmp(a));
    let metric: Arc<dyn InnerProduct> = Arc::new(Diagonal::new(w).unwrap());
    let problem = Quadratic { a: vec![vec![0.0; 3 * points]; 3 * points], b: b.clone() };
    let set = Product::new().block(9, Sphere::new(3, radius).unwrap()).block(9, Ball::new(3, radius).unwrap());
    let mut lowest: Vec<f64> = b.iter().map(|b| -b).collect();
    for point in lowest.chunks_mut(3) {
        let size = dot(point, point).sqrt();
        scale(radius / size, point);
    }
    let found = spectrum(&problem, &lowest, set, &metric, 5).unwrap();
    assert_eq!((found.free, found.negative, found.values.len()), (12, 0, 5));
    for (value, wanted) in found.values.iter().zip(&wanted) {
        assert!((value - wanted).abs() < 1e-8 * wanted, "{value} for {wanted}");
    }
    assert!(found.residuals.iter().all(|residual| *residual < 1e-8));

    let highest: Vec<f64> = lowest.iter().map(|m| -m).collect();
    let set = Sphere::new(3, radius).unwrap();
    let found = spectrum(&problem, &highest, set, &metric, 500).unwrap();
    assert_eq!((found.free, found.negative, found.above(1e-3)), (12, 12, 0));
    assert!((found.lowest + wanted[0]).abs() < 1e-8 * wanted[0]);
}

#[test]
fn no_free_direction_and_no_second_derivative_at_all() {
    let metric: Arc<dyn InnerProduct> = Arc::new(Euclidean::new(4));
    let flat = Quadratic { a: vec![vec![0.0; 4]; 4], b: vec![-1.0; 4] };
    let found = spectrum(&flat, &[1.0; 4], box_of_one(), &metric, 3).unwrap();
    assert_eq!((found.free, found.products, found.values.len()), (0, 0, 0));
    assert!(found.pointwise_half_width(1.0).is_empty());
    let found = spectrum(&flat, &[0.0; 4], box_of_one(), &metric, 3).unwrap();
    assert_eq!((found.free, found.negative, &found.values[..], found.half_width(0, 1.0)), (4, 0, &[0.0; 3][..], None));
}

#[test]
fn same_bits_twice_and_typed_errors() {
    let [metric, _] = products();
    let (problem, m, _) = quadratic(&values(), metric.as_ref());
    let one = spectrum(&problem, &m, box_of_one(), &metric, 4).unwrap();
    assert_eq!(one, spectrum(&problem, &m, box_of_one(), &metric, 4).unwrap());

    assert!(matches!(spectrum(&problem, &m, box_of_one(), &metric, 0), Err(SpectrumError::Count)));
    let other: Arc<dyn InnerProduct> = Arc::new(Euclidean::new(3));
    let error = spectrum(&problem, &m, box_of_one(), &other, 1);
    assert!(matches!(error, Err(SpectrumError::Lengths { control: N, metric: 3 })));
    let raised = Some(Arc::new(AtomicBool::new(true)));
    let domain = Domain { set: Arc::new(box_of_one()), metric, cancel: raised };
    let error = Spectrum::at(&problem, &m, &mut m.clone(), &domain, &SpectrumOptions::leading(2), &mut ());
    assert!(matches!(error, Err(SpectrumError::Cancelled)));

    // Too few products: what did converge is reported, no more.
    let domain = Domain { cancel: None, ..domain };
    let few = SpectrumOptions { max_products: 9, ..SpectrumOptions::leading(20) };
    let found = Spectrum::at(&problem, &m, &mut m.clone(), &domain, &few, &mut ()).unwrap();
    assert!(found.values.len() < 20 && found.residuals.iter().all(|residual| *residual < 1e-7));
}

/// The covariance at a minimum: the inverse of H whatever the scales; without a direction that is not seen, and without a component on a bound.
#[test]
fn the_covariance_is_the_inverse_on_what_is_seen() {
    let at = |a: [[f64; 3]; 3], set: Bounds, scales: [f64; 3]| {
        let objective = Quadratic { a: a.map(|row| row.to_vec()).to_vec(), b: vec![0.0; 3] };
        let metric = Arc::new(Diagonal::new(scales.map(|scale| scale.powi(-2)).to_vec()).unwrap());
        let domain = Domain { set: Arc::new(set), metric, cancel: None };
        let spectrum =
            Spectrum::at(&objective, &[0.0; 3], &mut vec![0.0; 3], &domain, &SpectrumOptions::leading(3), &mut ());
        Covariance::of(&spectrum.unwrap(), &scales, 1e-8)
    };
    let whole = || Bounds::new(f64::NEG_INFINITY, f64::INFINITY).unwrap();
    // det 28: the inverse by cofactors
    let (a, inverse) = (
        [[4.0, 2.0, 0.0], [2.0, 5.0, 1.0], [0.0, 1.0, 2.0]],
        [[9.0, -4.0, 2.0], [-4.0, 8.0, -4.0], [2.0, -4.0, 16.0]].map(|row| row.map(|x| x / 28.0)),
    );
    for scales in [[1.0; 3], [1.0, 0.3, 2.5]] {
        let found = at(a, whole(), scales);
        for (i, row) in inverse.iter().enumerate() {
            for (j, wanted) in row.iter().enumerate() {
                assert!((found.entries[i][j] - wanted).abs() < 1e-12, "{:?}", found.entries);
            }
        }
        let correlation = -4.0 / (9.0f64 * 8.0).sqrt();
        assert!((found.correlation(0, 1).unwrap() - correlation).abs() < 1e-12);
        assert!((found.deviation(2).unwrap() - (16.0f64 / 28.0).sqrt()).abs() < 1e-12);
        assert_eq!(found.seen(), 3);
        // g = a (1, 0, 0): the minimum is 1 away along the first axis, 2 deviations of the others held
        assert!((found.distance(&a[0]) - 2.0).abs() < 1e-12);
    }
    // the first two together are not seen: their difference is known, and so is the third
    let found = at([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 4.0]], whole(), [1.0; 3]);
    assert_eq!((found.determined.clone(), found.seen()), (vec![false, false, true], 2));
    assert_eq!((found.deviation(0), found.correlation(0, 2)), (None, None));
    assert!((found.deviation(2).unwrap() - 0.5).abs() < 1e-12);
    assert!(
        found.directions[0].deviation.is_none() && (found.directions[0].components[0] - 0.5f64.sqrt()).abs() < 1e-9
    );
    // what is known to many of its scales only is known; so are those beside it, whatever its scale: 4/3 for both
    for scale in [1.0, 1e-3] {
        let found = at([[1.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1e-3]], whole(), [1.0, scale, 1.0]);
        assert_eq!(found.determined, [true; 3]);
        assert!((found.deviation(0).unwrap() - (4.0f64 / 3.0).sqrt()).abs() < 1e-6, "{:?}", found.entries);
    }
    // a small part in what is not seen is enough
    let found = at([[1.0, 1e-4, 0.0], [1e-4, 1e-8, 0.0], [0.0, 0.0, 1.0]], whole(), [1.0; 3]);
    assert_eq!(found.determined, [false, false, true]);
}
