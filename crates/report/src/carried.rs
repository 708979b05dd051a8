//! Vectors of the reference body as the deformed body carries them.

use nastic_mesh::Mesh;

type V3 = [f64; 3];

/// `|a| F a / |F a|` with F at the centre of the cell: the direction of a material line that lay along `a`, with the
/// length of `a`. Zero where the cell has no volume.
pub(crate) fn carried(mesh: &Mesh, positions: &[V3], cell: u32, a: V3) -> V3 {
    let image = times(&deformation_gradient(mesh, positions, cell), a);
    let (length, now) = (norm(a), norm(image));
    if now > 0.0 && now.is_finite() { image.map(|x| x * length / now) } else { [0.0; 3] }
}

/// F = dx/dxi (dX/dxi)^-1 at the centre of a cell; in plane strain the third axis stays.
fn deformation_gradient(mesh: &Mesh, positions: &[V3], cell: u32) -> [V3; 3] {
    let cell = mesh.cell(cell as usize);
    let mut gradients = vec![[0.0; 3]; cell.kind.nodes()];
    cell.kind.gradients(&cell.kind.centre(), &mut gradients);
    let jacobian = |points: &[V3]| {
        let mut sum = [[0.0; 3]; 3];
        for (node, gradient) in cell.nodes.iter().zip(&gradients) {
            for i in 0..3 {
                for k in 0..mesh.dim() {
                    sum[i][k] += points[*node as usize][i] * gradient[k];
                }
            }
        }
        if mesh.dim() == 2 {
            sum[2] = [0.0, 0.0, 1.0];
        }
        sum
    };
    let (now, rest) = (jacobian(positions), inverse(&jacobian(mesh.points())));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| now[i][k] * rest[k][j]).sum()))
}

fn inverse(a: &[V3; 3]) -> [V3; 3] {
    let minor = |i: usize, j: usize| {
        let (r, s) = ((i + 1) % 3, (i + 2) % 3);
        let (p, q) = ((j + 1) % 3, (j + 2) % 3);
        a[r][p] * a[s][q] - a[r][q] * a[s][p]
    };
    let det: f64 = (0..3).map(|j| a[0][j] * minor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / det))
}

fn times(a: &[V3; 3], v: V3) -> V3 {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

fn norm(v: V3) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_mesh::{CellKind, box_mesh};

    #[test]
    fn vectors_turn_and_shear_with_the_body() {
        let mesh = box_mesh([1.0, 2.0, 0.5], [1, 1, 1], CellKind::Hex20).unwrap();
        // F = [[0, -3, 0], [1, 0, 0], [0, 2, 1]]
        let moved: Vec<V3> = mesh.points().iter().map(|p| [-3.0 * p[1], p[0], 2.0 * p[1] + p[2]]).collect();
        let near = |a: V3, b: V3| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(carried(&mesh, &moved, 0, [5.0, 0.0, 0.0]), [0.0, 5.0, 0.0]));
        let s = 13f64.sqrt();
        assert!(near(carried(&mesh, &moved, 0, [0.0, 1.0, 0.0]), [-3.0 / s, 0.0, 2.0 / s]));
        assert!(near(carried(&mesh, &moved, 0, [0.0; 3]), [0.0; 3]));
    }
}
