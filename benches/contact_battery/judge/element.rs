//! Shape functions of every kind of cell from the monomials that they span, by the inverse of their values at the nodes; quadrature rules from the
//! literature: Gauss, Dunavant (1985), Walkington (2000).

use nastic::tensor::Vec3;

/// A point of a rule.
pub struct Point {
    pub weight: f64,
    pub shapes: Vec<f64>,
    /// By the reference coordinates.
    pub slopes: Vec<Vec3>,
}

/// What integrals over a kind of cell are made of.
pub struct Element {
    pub dim: usize,
    /// Where stresses are integrated.
    pub stiff: Vec<Point>,
    /// Where products of two shape functions are: exact on affine cells.
    pub mass: Vec<Point>,
}

impl Element {
    /// Of a kind by its name.
    pub fn named(name: &str) -> Option<Self> {
        let (dim, order) = match name {
            "line2" | "line3" => (1, if name == "line2" { 1 } else { 2 }),
            "quad4" | "tri3" => (2, 1),
            "quad8" | "quad9" | "tri6" => (2, 2),
            "hex8" | "tet4" => (3, 1),
            "hex20" | "hex27" | "tet10" => (3, 2),
            _ => return None,
        };
        let simplex = name.starts_with("tri") || name.starts_with("tet");
        let serendipity = name == "quad8" || name == "hex20";
        let powers = monomials(dim, order, simplex, serendipity);
        let nodes = nodes(name, dim, simplex, powers.len());
        let inverse = inverse(nodes.iter().map(|x| powers.iter().map(|p| monomial(x, *p)).collect()).collect());
        let tabulate = |rule: Vec<(Vec3, f64)>| -> Vec<Point> {
            rule.iter().map(|(x, weight)| point(x, *weight, &powers, &inverse)).collect()
        };
        let (stiff, mass) = match simplex {
            true => (simplex_rule(dim, if order == 1 { 1 } else { 4 }), simplex_rule(dim, 2 * order)),
            false => (gauss(dim, order), gauss(dim, order)),
        };
        Some(Element { dim, stiff: tabulate(stiff), mass: tabulate(mass) })
    }
}

fn point(x: &Vec3, weight: f64, powers: &[[i32; 3]], inverse: &[Vec<f64>]) -> Point {
    let values: Vec<f64> = powers.iter().map(|p| monomial(x, *p)).collect();
    let slope = |p: &[i32; 3]| Vec3::from_fn(|i, _| along(x, *p, i));
    let slopes: Vec<Vec3> = powers.iter().map(slope).collect();
    let nodes = 0..powers.len();
    Point {
        weight,
        shapes: nodes.clone().map(|a| (0..powers.len()).map(|j| values[j] * inverse[j][a]).sum()).collect(),
        slopes: nodes.map(|a| (0..powers.len()).map(|j| slopes[j] * inverse[j][a]).sum()).collect(),
    }
}

fn monomial(x: &Vec3, p: [i32; 3]) -> f64 {
    (0..3).map(|i| x[i].powi(p[i])).product()
}

fn along(x: &Vec3, mut p: [i32; 3], i: usize) -> f64 {
    let factor = f64::from(p[i]);
    p[i] -= 1;
    if p[i] < 0 { 0.0 } else { factor * monomial(x, p) }
}

fn monomials(dim: usize, order: i32, simplex: bool, serendipity: bool) -> Vec<[i32; 3]> {
    let most = |axis: usize| if axis < dim { order } else { 0 };
    let mut all = Vec::new();
    for i in 0..=most(0) {
        for j in 0..=most(1) {
            for k in 0..=most(2) {
                let p = [i, j, k];
                let squares = p.iter().filter(|q| **q == 2).count();
                if (!simplex || i + j + k <= order) && (!serendipity || squares <= 1) {
                    all.push(p);
                }
            }
        }
    }
    all
}

/// Reference coordinates of the nodes in VTK's order.
fn nodes(name: &str, dim: usize, simplex: bool, count: usize) -> Vec<Vec3> {
    let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let mut all = match (dim, simplex) {
        (1, _) => vec![corner(-1.0, 0.0, 0.0), corner(1.0, 0.0, 0.0)],
        (2, true) => vec![Vec3::zeros(), Vec3::x(), Vec3::y()],
        (3, true) => vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()],
        _ => {
            let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let levels: &[f64] = if dim == 2 { &[0.0] } else { &[-1.0, 1.0] };
            levels.iter().flat_map(|z| ring.map(|[x, y]| corner(x, y, *z))).collect()
        }
    };
    let edges: &[[usize; 2]] = match (dim, simplex) {
        (1, _) => &[[0, 1]],
        (2, true) => &[[0, 1], [1, 2], [2, 0]],
        (3, true) => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
        (2, _) => &[[0, 1], [1, 2], [2, 3], [3, 0]],
        _ => &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
    };
    if count > all.len() {
        let middles: Vec<Vec3> = edges.iter().map(|[a, b]| (all[*a] + all[*b]) / 2.0).collect();
        all.extend(middles);
    }
    if name == "hex27" {
        all.extend(
            (0..6).map(|side| Vec3::from_fn(|i, _| if i == side / 2 { 2.0 * (side % 2) as f64 - 1.0 } else { 0.0 })),
        );
    }
    if count > all.len() {
        all.push(Vec3::zeros());
    }
    all
}

/// By Gauss and Jordan with pivots.
fn inverse(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for (i, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap_or(k);
        a.swap(k, pivot);
        let scale = 1.0 / a[k][k];
        a[k].iter_mut().for_each(|x| *x *= scale);
        let row = a[k].clone();
        for (i, other) in a.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = other[k];
            debug_assert!(i < n);
            other.iter_mut().zip(&row).for_each(|(x, r)| *x -= factor * r);
        }
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// With two points along each axis for order 1, three for order 2.
fn gauss(dim: usize, order: i32) -> Vec<(Vec3, f64)> {
    let line: Vec<(f64, f64)> = match order {
        1 => [-1.0, 1.0].map(|sign| (sign / 3f64.sqrt(), 1.0)).to_vec(),
        _ => vec![(-0.6f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6f64.sqrt(), 5.0 / 9.0)],
    };
    let mut rule = vec![(Vec3::zeros(), 1.0)];
    for axis in 0..dim {
        let step = |(x, w): &(Vec3, f64)| -> Vec<(Vec3, f64)> {
            line.iter().map(|(at, weight)| (x + *at * Vec3::ith(axis, 1.0), w * weight)).collect()
        };
        rule = rule.iter().flat_map(step).collect();
    }
    rule
}

fn simplex_rule(dim: usize, degree: i32) -> Vec<(Vec3, f64)> {
    let thirds =
        |a: f64, w: f64| [[a, a], [a, 1.0 - 2.0 * a], [1.0 - 2.0 * a, a]].map(|[x, y]| (Vec3::new(x, y, 0.0), w / 2.0));
    let quarters = |a: f64, w: f64| {
        let b = 1.0 - 3.0 * a;
        [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|x| (Vec3::from(x), w / 6.0))
    };
    match (dim, degree) {
        (2, 1) => vec![(Vec3::new(1.0, 1.0, 0.0) / 3.0, 0.5)],
        (2, 2) => thirds(1.0 / 6.0, 1.0 / 3.0).to_vec(),
        (2, _) => {
            let inner = thirds(0.445_948_490_915_964_9, 0.223_381_589_678_011_47);
            [thirds(0.091_576_213_509_770_74, 0.109_951_743_655_321_87), inner].concat()
        }
        (_, 1) => vec![(Vec3::repeat(0.25), 1.0 / 6.0)],
        (_, 2) => quarters((5.0 - 5f64.sqrt()) / 20.0, 0.25).to_vec(),
        _ => {
            let a = 0.045_503_704_125_649_65;
            let (b, w) = (0.5 - a, 0.042_546_020_777_081_47 / 6.0);
            let pairs = [[a, a, b], [a, b, a], [b, a, a], [b, b, a], [b, a, b], [a, b, b]].map(|x| (Vec3::from(x), w));
            let corners = quarters(0.092_735_250_310_891_23, 0.073_493_043_116_361_95);
            [&quarters(0.310_885_919_263_300_6, 0.112_687_925_718_015_85)[..], &corners, &pairs].concat()
        }
    }
}
