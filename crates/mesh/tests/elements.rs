//! Contract of every reference element.

use nastic_mesh::CellKind;

/// A few points inside (and one outside: shapes are polynomials) of the reference domain.
fn samples(kind: CellKind) -> Vec<[f64; 3]> {
    let raw = [[0.13, 0.21, 0.34], [0.4, 0.05, 0.3], [0.25, 0.25, 0.1], [1.3, -0.7, 0.45]];
    raw.map(|p| std::array::from_fn(|d| if d < kind.dim() { p[d] } else { 0.0 })).to_vec()
}

fn shapes(kind: CellKind, xi: &[f64; 3]) -> Vec<f64> {
    let mut n = vec![f64::NAN; kind.nodes()];
    kind.shapes(xi, &mut n);
    n
}

fn gradients(kind: CellKind, xi: &[f64; 3]) -> Vec<[f64; 3]> {
    let mut g = vec![[f64::NAN; 3]; kind.nodes()];
    kind.gradients(xi, &mut g);
    g
}

#[test]
fn shapes_sum_to_one_and_gradients_to_zero() {
    for kind in CellKind::ALL {
        for xi in samples(kind) {
            assert!((shapes(kind, &xi).iter().sum::<f64>() - 1.0).abs() < 1e-14, "{kind}");
            for k in 0..3 {
                assert!(gradients(kind, &xi).iter().map(|g| g[k]).sum::<f64>().abs() < 1e-13, "{kind}");
            }
        }
    }
}

#[test]
fn shapes_are_one_at_their_node_and_zero_at_the_others() {
    for kind in CellKind::ALL {
        for (a, node) in kind.reference_nodes().iter().enumerate() {
            for (b, n) in shapes(kind, node).iter().enumerate() {
                assert!((n - f64::from(u8::from(a == b))).abs() < 1e-15, "{kind}: N_{b} at node {a} is {n}");
            }
        }
    }
}

#[test]
fn gradients_are_those_of_the_shapes() {
    let h = 1e-5;
    for kind in CellKind::ALL {
        for xi in samples(kind) {
            let g = gradients(kind, &xi);
            for k in 0..3 {
                let step = |s: f64| shapes(kind, &std::array::from_fn(|d| xi[d] + if d == k { s } else { 0.0 }));
                let (forward, backward) = (step(h), step(-h));
                for (a, g) in g.iter().enumerate() {
                    let slope = if k < kind.dim() { (forward[a] - backward[a]) / (2.0 * h) } else { 0.0 };
                    assert!((g[k] - slope).abs() < 1e-9, "{kind} dN_{a}/dxi_{k}: {} vs {slope}", g[k]);
                }
            }
        }
    }
}

#[test]
fn complete_polynomials_of_the_order_are_reproduced() {
    for kind in CellKind::ALL {
        let power = |x: &[f64; 3], e: [i32; 3]| x[0].powi(e[0]) * x[1].powi(e[1]) * x[2].powi(e[2]);
        for e in exponents(kind.dim(), kind.order()) {
            for xi in samples(kind) {
                let n = shapes(kind, &xi);
                let sum: f64 = n.iter().zip(kind.reference_nodes()).map(|(n, node)| n * power(node, e)).sum();
                assert!((sum - power(&xi, e)).abs() < 1e-13, "{kind} {e:?}");
            }
        }
    }
}

/// Exponents of all monomials of total degree up to `degree`.
fn exponents(dim: usize, degree: usize) -> Vec<[i32; 3]> {
    let d = degree as i32;
    let top = |axis: usize| if axis < dim { d } else { 0 };
    (0..=top(0))
        .flat_map(|i| (0..=top(1)).flat_map(move |j| (0..=top(2)).map(move |k| [i, j, k])))
        .filter(|e| e.iter().sum::<i32>() <= d)
        .collect()
}

#[test]
fn names_and_vtk_numbers_lead_back() {
    for kind in CellKind::ALL {
        assert_eq!(CellKind::from_name(kind.name()), Some(kind));
        assert_eq!(CellKind::from_vtk(kind.vtk()), Some(kind));
        assert_eq!(CellKind::ALL[kind as usize], kind);
        assert_eq!(kind.corner_kind().order(), 1);
    }
    assert_eq!(CellKind::from_name("wedge6"), None);
    assert_eq!(CellKind::from_vtk(13), None);
}

#[test]
fn midside_nodes_stand_in_the_middle_of_their_edges() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.order() == 2) {
        let nodes = kind.reference_nodes();
        for (k, [i, j]) in kind.edges().iter().enumerate() {
            let middle = std::array::from_fn(|d| 0.5 * (nodes[*i][d] + nodes[*j][d]));
            assert_eq!(nodes[kind.corners() + k], middle, "{kind} edge {k}");
        }
    }
}

/// Node order as VTK prints it (vtkQuadraticTetra.h, vtkTriQuadraticHexahedron.cxx, ...).
#[test]
fn second_order_nodes_stand_in_vtk_order() {
    let at = |kind: CellKind, node: usize| kind.reference_nodes()[node];
    let middle = |kind: CellKind, i: usize, j: usize| {
        let nodes = kind.reference_nodes();
        std::array::from_fn::<f64, 3, _>(|d| 0.5 * (nodes[i][d] + nodes[j][d]))
    };
    for (node, (i, j)) in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)].into_iter().enumerate() {
        assert_eq!(at(CellKind::Tet10, 4 + node), middle(CellKind::Tet10, i, j));
    }
    let hex = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        for (node, (i, j)) in hex.into_iter().enumerate() {
            assert_eq!(at(kind, 8 + node), middle(kind, i, j));
        }
    }
    let centres = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, -1.0), (2, 1.0)];
    for (face, (axis, side)) in centres.into_iter().enumerate() {
        let expected = std::array::from_fn(|d| if d == axis { side } else { 0.0 });
        assert_eq!(at(CellKind::Hex27, 20 + face), expected);
        assert_eq!(CellKind::Hex27.faces()[face].1[8], 20 + face);
    }
    assert_eq!(at(CellKind::Hex27, 26), [0.0; 3]);
    assert_eq!(at(CellKind::Quad9, 8), [0.0; 3]);
    let vtk = [3, 21, 5, 22, 9, 23, 28, 10, 24, 12, 25, 29];
    assert_eq!(CellKind::ALL.map(CellKind::vtk), vtk);
}

#[test]
fn faces_point_outwards_and_close_the_cell() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let nodes = kind.reference_nodes();
        let (centre, mut flux, mut closure) = (kind.centre(), 0.0, [0.0; 3]);
        for (face, local) in kind.faces() {
            assert_eq!((face.dim(), face.order(), face.nodes()), (kind.dim() - 1, kind.order(), local.len()));
            let positions: Vec<_> = local.iter().map(|&a| nodes[a]).collect();
            for (xi, w) in face.rule_of_degree(4).iter() {
                let (x, n) = (face.map(&positions, xi), face.area_vector(&positions, xi));
                let height: f64 = (0..3).map(|i| (x[i] - centre[i]) * n[i]).sum();
                assert!(height > 0.0, "{kind} {local:?} points inwards");
                flux += w * (0..3).map(|i| x[i] * n[i]).sum::<f64>() / kind.dim() as f64;
                (0..3).for_each(|i| closure[i] += w * n[i]);
            }
        }
        assert!((flux - kind.reference_measure()).abs() < 1e-13, "{kind}: volume by the divergence theorem {flux}");
        assert!(closure.iter().all(|c: &f64| c.abs() < 1e-13), "{kind}");
    }
}

/// Midside nodes of a face are the cell's midside nodes between the same corners, centre over centre.
#[test]
fn faces_are_restrictions_of_the_cell() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let nodes = kind.reference_nodes();
        for (face, local) in kind.faces() {
            let corners: Vec<_> = local[..face.corners()].iter().map(|&a| nodes[a]).collect();
            for (b, &a) in local.iter().enumerate() {
                let x = face.corner_kind().map(&corners, &face.reference_nodes()[b]);
                assert!((0..3).all(|i| (x[i] - nodes[a][i]).abs() < 1e-15), "{kind} face node {a}");
            }
            let positions: Vec<_> = local.iter().map(|&a| nodes[a]).collect();
            let xi = std::array::from_fn(|d| if d < face.dim() { 0.2 + 0.1 * d as f64 } else { 0.0 });
            let (on_face, in_cell) = (shapes(*face, &xi), shapes(kind, &face.map(&positions, &xi)));
            for (a, n) in in_cell.iter().enumerate() {
                let expected = local.iter().position(|&l| l == a).map_or(0.0, |b| on_face[b]);
                assert!((n - expected).abs() < 1e-14, "{kind} {face} node {a}");
            }
        }
    }
}

#[test]
fn mirror_reverses_the_orientation_and_nothing_else() {
    for kind in CellKind::ALL {
        let nodes = kind.reference_nodes();
        let mirrored: Vec<_> = kind.mirror().iter().map(|&a| nodes[a]).collect();
        for xi in samples(kind) {
            assert!((kind.jacobian(&mirrored, &xi) + 1.0).abs() < 1e-13, "{kind}");
        }
        let twice: Vec<_> = kind.mirror().iter().map(|&a| mirrored[a]).collect();
        assert_eq!(twice, nodes, "{kind}");
    }
}
