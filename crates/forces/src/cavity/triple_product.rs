//! Integrals of triple products `det(p, q, r)` of vectors that are linear in nodal positions: what volumes are made of.

use nastic_tensor::Vec3;

/// A term `weight det(p, q, r)` with `p = sum_a P_a x_a`, `q = sum_a Q_a x_a`, `r = sum_a R_a x_a + normal`.
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub weight: f64,
    pub p: Vec<f64>,
    pub q: Vec<f64>,
    pub r: Vec<f64>,
    /// A constant part of r: the normal of the plane in plane strain, else zero.
    pub normal: Vec3,
}

/// Value, sum of absolute values, and derivatives of a sum of terms.
#[derive(Debug, Clone)]
pub(super) struct Volume {
    pub value: f64,
    pub scale: f64,
    /// By node.
    pub gradient: Vec<Vec3>,
    /// Entry `3 n (3 a + i) + 3 b + j`; empty unless asked for.
    pub hessian: Vec<f64>,
}

impl Volume {
    pub fn zero(nodes: usize, second: bool) -> Self {
        let hessian = if second { vec![0.0; 9 * nodes * nodes] } else { Vec::new() };
        Volume { value: 0.0, scale: 0.0, gradient: vec![Vec3::zeros(); nodes], hessian }
    }

    /// Adds a term at nodal positions x, its normal times `constants`.
    pub fn add(&mut self, term: &Term, x: &[Vec3], constants: f64) {
        let linear = |c: &[f64]| c.iter().zip(x).map(|(c, x)| *c * x).sum::<Vec3>();
        let (p, q, r) = (linear(&term.p), linear(&term.q), linear(&term.r) + constants * term.normal);
        let w = term.weight;
        let (by_p, by_q, by_r) = (q.cross(&r), r.cross(&p), p.cross(&q));
        let value = w * p.dot(&by_p);
        self.value += value;
        self.scale += value.abs();
        for (a, gradient) in self.gradient.iter_mut().enumerate() {
            *gradient += w * (term.p[a] * by_p + term.q[a] * by_q + term.r[a] * by_r);
        }
        if self.hessian.is_empty() {
            return;
        }
        // d2 det / dp_i dq_j = e_ijk r_k, and cyclically
        let n = x.len();
        let (e_p, e_q, e_r) = (permuted(&p), permuted(&q), permuted(&r));
        for a in 0..n {
            for b in 0..n {
                let pq = w * (term.p[a] * term.q[b] - term.q[a] * term.p[b]);
                let rp = w * (term.r[a] * term.p[b] - term.p[a] * term.r[b]);
                let qr = w * (term.q[a] * term.r[b] - term.r[a] * term.q[b]);
                if pq == 0.0 && rp == 0.0 && qr == 0.0 {
                    continue;
                }
                for (i, j, sign, k) in PERMUTATIONS {
                    self.hessian[3 * n * (3 * a + i) + 3 * b + j] += sign * (pq * e_r[k] + rp * e_q[k] + qr * e_p[k]);
                }
            }
        }
    }
}

/// `(i, j, e_ijk, k)` where it is not zero.
const PERMUTATIONS: [(usize, usize, f64, usize); 6] =
    [(0, 1, 1.0, 2), (1, 2, 1.0, 0), (2, 0, 1.0, 1), (1, 0, -1.0, 2), (2, 1, -1.0, 0), (0, 2, -1.0, 1)];

fn permuted(v: &Vec3) -> [f64; 3] {
    [v.x, v.y, v.z]
}
