use crate::Mat3;

/// Fourth-order two-point tensor `A_iJkL`, such as `dP/dF` (unit of stress).
///
/// Row-major: entry `9 (3 i + J) + 3 k + L` is `A_iJkL`, so row `3 i + J` holds `dP_iJ / dF`.
/// The `add_*` methods accumulate, because energies do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent(pub [f64; 81]);

/// Pairs of rows `(i, k)` and the third row `m` with `eps_ikm = 1`.
const CYCLIC: [(usize, usize, usize); 3] = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];

type Rows = [[f64; 3]; 3];

impl Default for Tangent {
    fn default() -> Self {
        Self::zero()
    }
}

impl Tangent {
    /// The zero tensor.
    #[inline]
    pub const fn zero() -> Self {
        Self([0.0; 81])
    }

    /// The tensor of a linear map `B -> A : B`, from its nine columns.
    pub fn from_map(map: impl Fn(&Mat3) -> Mat3) -> Self {
        let mut out = Self::zero();
        for k in 0..3 {
            for l in 0..3 {
                let mut unit = Mat3::zeros();
                unit[(k, l)] = 1.0;
                let image = map(&unit);
                for i in 0..3 {
                    for j in 0..3 {
                        out.0[index(i, j, k, l)] = image[(i, j)];
                    }
                }
            }
        }
        out
    }

    /// Entry `A_iJkL`.
    #[inline]
    pub fn get(&self, i: usize, j: usize, k: usize, l: usize) -> f64 {
        self.0[index(i, j, k, l)]
    }

    /// `A : B`, that is `A_iJkL B_kL`.
    pub fn apply(&self, b: &Mat3) -> Mat3 {
        let b = flat(b);
        let row = |r: usize| (0..9).map(|c| self.0[9 * r + c] * b[c]).sum::<f64>();
        Mat3::new(row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7), row(8))
    }

    /// The transpose `A_kLiJ`.
    pub fn transposed(&self) -> Self {
        let mut out = Self::zero();
        for r in 0..9 {
            for c in 0..9 {
                out.0[9 * r + c] = self.0[9 * c + r];
            }
        }
        out
    }

    /// `+ other`.
    #[inline]
    pub fn add(&mut self, other: &Tangent) {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a += b;
        }
    }

    /// `+ s delta_ik delta_JL`.
    #[inline]
    pub fn add_identity(&mut self, s: f64) {
        for d in 0..9 {
            self.0[10 * d] += s;
        }
    }

    /// `+ delta_ik M_JL`: a quadratic form of every spatial row of `F` alike, as in `F M : F`.
    #[inline]
    pub fn add_metric(&mut self, m: &Mat3) {
        let m = rows(m);
        for i in 0..3 {
            self.add_block(i, i, &m);
        }
    }

    /// `+ s delta_ik a_J a_L`, the second derivative of `s |F a|^2 / 2`.
    #[inline]
    pub fn add_fiber(&mut self, a: &crate::Vec3, s: f64) {
        self.add_metric(&(a * (a * s).transpose()));
    }

    /// `+ s A_iJ B_kL`.
    #[inline]
    pub fn add_outer(&mut self, a: &Mat3, b: &Mat3, s: f64) {
        let (a, b) = (flat(a), flat(b));
        for (row, a) in self.0.chunks_exact_mut(9).zip(a) {
            let a = s * a;
            for (t, b) in row.iter_mut().zip(b) {
                *t += a * b;
            }
        }
    }

    /// `+ s (A_iJ B_kL + B_iJ A_kL)`.
    #[inline]
    pub fn add_outer_symmetric(&mut self, a: &Mat3, b: &Mat3, s: f64) {
        let (a, b) = (flat(a), flat(b));
        for (r, row) in self.0.chunks_exact_mut(9).enumerate() {
            let (sa, sb) = (s * a[r], s * b[r]);
            for ((t, a), b) in row.iter_mut().zip(a).zip(b) {
                *t += sa * b + sb * a;
            }
        }
    }

    /// `+ sum_ab c_ab M_ab (x) (M_ab + M_ba)` with symmetric c and `M_ab = l_a (x) r_b` of the columns of two matrices: what an isotropic
    /// function of `F^T F` with the eigenvectors r, changes with where `l_a = F r_a`.
    pub fn add_spectral(&mut self, left: &Mat3, right: &Mat3, c: &Mat3) {
        let product = |a: usize, b: usize| left.column(a) * right.column(b).transpose();
        for a in 0..3 {
            let own = product(a, a);
            self.add_outer(&own, &own, 2.0 * c[(a, a)]);
            for b in 0..a {
                let both = product(a, b) + product(b, a);
                self.add_outer(&both, &both, c[(a, b)]);
            }
        }
    }

    /// `+ s X(A)`, the linear map `B -> s A x B`: `X(A)_iJkL = eps_ikm eps_JLN A_mN`.
    #[inline]
    pub fn add_cross(&mut self, a: &Mat3, s: f64) {
        let a = rows(a);
        for (i, k, m) in CYCLIC {
            let [x, y, z] = a[m];
            let block = spin(&[s * x, s * y, s * z]);
            self.add_block(i, k, &block);
            self.subtract_block(k, i, &block);
        }
    }

    /// `+ s X(F) X(F)`, the linear map `B -> s F x (F x B)`: the second derivative of `s |H|^2 / 2` at fixed `dH`.
    ///
    /// With `r_i` the rows of `F`, block `(i, k)` is `r_i r_k - (r_i . r_k) I`, and block `(i, i)` is the sum of
    /// `|r_m|^2 I - r_m r_m` over the two other rows.
    #[inline]
    pub fn add_cross_squared(&mut self, f: &Mat3, s: f64) {
        let r = rows(f);
        for (i, k, m) in CYCLIC {
            let mut own = dyad(&r[m], &r[m], -s);
            let mut mixed = dyad(&r[i], &r[k], s);
            let (square, product) = (s * dot(&r[m], &r[m]), s * dot(&r[i], &r[k]));
            for d in 0..3 {
                own[d][d] += square;
                mixed[d][d] -= product;
            }
            self.add_block(i, i, &own);
            self.add_block(k, k, &own);
            self.add_block(i, k, &mixed);
            self.add_block(k, i, &transposed(&mixed));
        }
    }

    /// `+ X(A) + ff I + hh X(F) X(F) + jj H(.)H` in one go: the tangent of an energy whose second derivatives by `F` and by
    /// `H` are multiples `ff`, `hh` of the identity, with `A` from its first derivatives.
    ///
    /// Block by block, each written once; see [`add_cross`](Self::add_cross) and [`add_cross_squared`](Self::add_cross_squared).
    #[inline]
    pub fn add_isotropic(&mut self, f: &Mat3, h: &Mat3, a: &Mat3, [ff, hh, jj]: [f64; 3]) {
        let (r, h, a) = (rows(f), rows(h), rows(a));
        let squares = [hh * dot(&r[0], &r[0]), hh * dot(&r[1], &r[1]), hh * dot(&r[2], &r[2])];
        for (i, k, m) in CYCLIC {
            let mut own = dyad(&h[i], &h[i], jj);
            let mut mixed = dyad(&h[i], &h[k], jj);
            let product = hh * dot(&r[i], &r[k]);
            for j in 0..3 {
                for l in 0..3 {
                    own[j][l] -= hh * (r[k][j] * r[k][l] + r[m][j] * r[m][l]);
                    mixed[j][l] += hh * r[i][j] * r[k][l];
                }
                own[j][j] += ff + squares[k] + squares[m];
                mixed[j][j] -= product;
                let (n, o) = ((j + 1) % 3, (j + 2) % 3); // S(a)_jn = a_o
                mixed[j][n] += a[m][o];
                mixed[n][j] -= a[m][o];
            }
            self.add_block(i, i, &own);
            self.add_block(i, k, &mixed);
            self.add_block(k, i, &transposed(&mixed));
        }
    }

    /// `+ X(F) [delta_ik M_JL] X(F)` for symmetric `M`: the second derivative of `H M : H / 2` at fixed `dH`.
    #[inline]
    pub fn add_cross_metric(&mut self, f: &Mat3, metric: &Mat3) {
        let r = rows(f);
        let metric = rows(metric);
        for (i, k, m) in CYCLIC {
            // X_ik = eps_ikm S(r_m), hence block (i, i) -= S(r_m) M S(r_m), and block (i, k) += S(r_k) M S(r_i).
            let own = between_spins(&r[m], &metric, &r[m]);
            self.subtract_block(i, i, &own);
            self.subtract_block(k, k, &own);
            let mixed = between_spins(&r[k], &metric, &r[i]);
            self.add_block(i, k, &mixed);
            self.add_block(k, i, &transposed(&mixed));
        }
    }

    /// `+ X(F) D X(F)`: curvature `D = W_HH` by the cofactor, seen by `F`.
    pub fn add_cross_both(&mut self, f: &Mat3, d: &Tangent) {
        let right = d.times_cross(f);
        // X is symmetric: X (D X) = ((D X)^T X)^T.
        self.add(&right.transposed().times_cross(f).transposed());
    }

    /// `+ D X(F) + X(F) D^T`: mixed curvature `D = W_FH`, seen by `F`.
    pub fn add_cross_mixed(&mut self, f: &Mat3, d: &Tangent) {
        let right = d.times_cross(f);
        self.add(&right);
        self.add(&right.transposed());
    }

    /// `A X(F)`: row `iJ` of the product is `F x A_iJ`.
    pub fn times_cross(&self, f: &Mat3) -> Self {
        let mut out = Self::zero();
        for r in 0..9 {
            let row = Mat3::from_row_slice(&self.0[9 * r..9 * r + 9]);
            out.0[9 * r..9 * r + 9].copy_from_slice(&flat(&crate::cross(f, &row)));
        }
        out
    }

    #[inline(always)]
    fn add_block(&mut self, i: usize, k: usize, block: &Rows) {
        for (j, row) in block.iter().enumerate() {
            for (l, b) in row.iter().enumerate() {
                self.0[index(i, j, k, l)] += b;
            }
        }
    }

    #[inline(always)]
    fn subtract_block(&mut self, i: usize, k: usize, block: &Rows) {
        for (j, row) in block.iter().enumerate() {
            for (l, b) in row.iter().enumerate() {
                self.0[index(i, j, k, l)] -= b;
            }
        }
    }
}

#[inline(always)]
const fn index(i: usize, j: usize, k: usize, l: usize) -> usize {
    9 * (3 * i + j) + 3 * k + l
}

#[inline(always)]
fn rows(m: &Mat3) -> Rows {
    [[m[(0, 0)], m[(0, 1)], m[(0, 2)]], [m[(1, 0)], m[(1, 1)], m[(1, 2)]], [m[(2, 0)], m[(2, 1)], m[(2, 2)]]]
}

#[inline(always)]
fn flat(m: &Mat3) -> [f64; 9] {
    let [a, b, c] = rows(m);
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
}

#[inline(always)]
fn transposed(m: &Rows) -> Rows {
    [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]]
}

/// `S(r)_JL = eps_JLN r_N`, so that `S(r) v = v x r`.
#[inline(always)]
fn spin(r: &[f64; 3]) -> Rows {
    [[0.0, r[2], -r[1]], [-r[2], 0.0, r[0]], [r[1], -r[0], 0.0]]
}

#[inline(always)]
fn dyad(a: &[f64; 3], b: &[f64; 3], s: f64) -> Rows {
    // written out: `map` of arrays is not always inlined
    let row = |a: f64| [a * b[0], a * b[1], a * b[2]];
    [row(s * a[0]), row(s * a[1]), row(s * a[2])]
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn vector_cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `S(a) M S(b)` for symmetric `M`.
#[inline(always)]
fn between_spins(a: &[f64; 3], m: &Rows, b: &[f64; 3]) -> Rows {
    // Columns of S(a) M are m_L x a (m_L a row of M, by symmetry); rows v of the product become -(v x b).
    let left = transposed(&[vector_cross(&m[0], a), vector_cross(&m[1], a), vector_cross(&m[2], a)]);
    [vector_cross(b, &left[0]), vector_cross(b, &left[1]), vector_cross(b, &left[2])]
}
