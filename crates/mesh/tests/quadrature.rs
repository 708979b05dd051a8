//! Rules against exact moments.

use nastic_mesh::quadrature::{gauss_jacobi, gauss_legendre};
use nastic_mesh::{CellKind, Domain, Rule};

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// Exact integral of x^i y^j z^k over the reference domain.
fn moment(kind: CellKind, e: [usize; 3]) -> f64 {
    let line = |p: usize| if p.is_multiple_of(2) { 2.0 / (p as f64 + 1.0) } else { 0.0 };
    match kind.domain() {
        Domain::Box => (0..kind.dim()).map(|d| line(e[d])).product(),
        Domain::Simplex => {
            e.iter().map(|&p| factorial(p)).product::<f64>() / factorial(e.iter().sum::<usize>() + kind.dim())
        }
    }
}

fn exponents(kind: CellKind, degree: usize) -> Vec<[usize; 3]> {
    let top = |axis: usize| if axis < kind.dim() { degree } else { 0 };
    (0..=top(0))
        .flat_map(|i| (0..=top(1)).flat_map(move |j| (0..=top(2)).map(move |k| [i, j, k])))
        .filter(|e| match kind.domain() {
            Domain::Box => true,
            Domain::Simplex => e.iter().sum::<usize>() <= degree,
        })
        .collect()
}

fn assert_exact(kind: CellKind, rule: &Rule, degree: usize) {
    for e in exponents(kind, degree) {
        let sum: f64 = rule.iter().map(|(x, w)| w * (0..3).map(|d| x[d].powi(e[d] as i32)).product::<f64>()).sum();
        assert!(
            (sum - moment(kind, e)).abs() < 2e-15 * 4f64.powi(kind.dim() as i32),
            "{kind} degree {degree} {e:?}: {sum}"
        );
    }
}

fn assert_positive_and_inside(kind: CellKind, rule: &Rule) {
    for (x, w) in rule.iter() {
        assert!(w > 0.0, "{kind}");
        let inside = match kind.domain() {
            Domain::Box => x.iter().all(|c| c.abs() < 1.0),
            Domain::Simplex => x[..kind.dim()].iter().all(|c| *c > 0.0) && x.iter().sum::<f64>() < 1.0,
        };
        assert!(inside, "{kind} {x:?}");
        assert!(x[kind.dim()..].iter().all(|c| *c == 0.0));
    }
}

#[test]
fn rules_of_a_degree_are_exact_positive_and_inside() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.order() == 1) {
        for degree in 0..=12 {
            let rule = kind.rule_of_degree(degree);
            assert_exact(kind, &rule, degree);
            assert_positive_and_inside(kind, &rule);
        }
    }
}

#[test]
fn default_rules_have_the_stated_degree_and_size() {
    let stated = [
        (CellKind::Line2, 3, 2),
        (CellKind::Line3, 5, 3),
        (CellKind::Tri3, 1, 1),
        (CellKind::Tri6, 4, 6),
        (CellKind::Quad4, 3, 4),
        (CellKind::Quad8, 5, 9),
        (CellKind::Quad9, 5, 9),
        (CellKind::Tet4, 1, 1),
        (CellKind::Tet10, 4, 14),
        (CellKind::Hex8, 3, 8),
        (CellKind::Hex20, 5, 27),
        (CellKind::Hex27, 5, 27),
    ];
    assert_eq!(stated.map(|row| row.0), CellKind::ALL);
    for (kind, degree, points) in stated {
        assert_exact(kind, kind.rule(), degree);
        assert_positive_and_inside(kind, kind.rule());
        assert_eq!(kind.rule().len(), points, "{kind}");
    }
}

#[test]
fn rules_of_points_reach_twice_the_points_less_one() {
    for kind in [CellKind::Hex8, CellKind::Quad8, CellKind::Tet10, CellKind::Tri6, CellKind::Line2] {
        for n in 1..=6 {
            assert_exact(kind, &kind.rule_of_points(n), 2 * n - 1);
        }
    }
    assert_eq!(CellKind::Hex27.rule_of_points(3).len(), 27);
    assert_eq!(CellKind::Hex8.rule_of_points(0).len(), 1);
}

#[test]
fn gauss_legendre_matches_the_tables() {
    let (x, w) = gauss_legendre(5);
    // Abramowitz & Stegun, table 25.4.
    let nodes = [-0.906_179_845_938_664, -0.538_469_310_105_683, 0.0, 0.538_469_310_105_683, 0.906_179_845_938_664];
    let weights = [0.236_926_885_056_189, 0.478_628_670_499_366, 0.568_888_888_888_889];
    for i in 0..5 {
        assert!((x[i] - nodes[i]).abs() < 1e-15 && (w[i] - weights[i.min(4 - i)]).abs() < 1e-15);
    }
}

#[test]
fn long_gauss_rules_stay_exact() {
    for n in [20, 64, 200] {
        let (x, w) = gauss_legendre(n);
        assert!((0..n).all(|i| x[i] == -x[n - 1 - i] && w[i] == w[n - 1 - i]), "{n} points are symmetric to the bit");
        assert!(x.windows(2).all(|pair| pair[0] < pair[1]), "{n} nodes ascend");
        for p in [0, 2, 10, 2 * n - 2] {
            let sum: f64 = x.iter().zip(&w).map(|(x, w)| w * x.powi(p as i32)).sum();
            assert!((sum - 2.0 / (p as f64 + 1.0)).abs() < 1e-14, "{n} points, x^{p}");
        }
    }
}

#[test]
fn gauss_jacobi_integrates_its_weight() {
    for alpha in 0..4 {
        for n in 1..=10 {
            let (x, w) = gauss_jacobi(n, alpha);
            for p in 0..2 * n {
                // int (1-x)^(alpha+p) dx = 2^(alpha+p+1)/(alpha+p+1)
                let sum: f64 = x.iter().zip(&w).map(|(x, w)| w * (1.0 - x).powi(p as i32)).sum();
                let power = alpha as f64 + p as f64 + 1.0;
                let exact = 2f64.powf(power) / power;
                assert!((sum / exact - 1.0).abs() < 1e-13, "alpha {alpha}, {n} points, degree {p}");
            }
        }
    }
}
