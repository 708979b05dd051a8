//! Nearly incompressible matrices by GMRES, with the pressures as unknowns of their own.

use super::conjugate_gradients::{CgEnd, CgReport, relative};
use super::volume_modes::VolumeModes;
use crate::pattern::operator::Preconditioner;
use crate::sums::{self, dot};

/// Vectors between restarts.
const LENGTH: usize = 30;
/// A direction with less curvature than this share of that of its newest part adds nothing but rounding.
const DEPENDENT: f64 = 1e-10;
/// Iterations where A is not positive definite, and K may not be.
const MOST_UNSURE: usize = 60;
/// Share of the residual left by all directions between two restarts beyond which nothing more is expected.
const STAGNATION: f64 = 0.8;
/// Share of the residual that is aimed at where a solution was looked at and not good enough yet, and the most that it falls until the next look.
const MARGIN: f64 = 0.7;
const NEXT_LOOK: f64 = 1e-3;

/// `K x = f` with `K = A + B^T C^-1 B`: the saddle-point system `A u + B^T p = f`, `B u - C p = 0` by flexible GMRES, whose preconditioner
/// is a block triangle of one of A and of `1 / c + 1 / g` per pressure, g being what A has of the bulk modulus: `B A^-1 B^T` is near `1 / g` whatever the mesh,
/// where displacements control pressures. A solution counts by its residual of K, in which an error of the second row is one of the bulk modulus, or by that of
/// the saddle-point system, whose second row is then a force, `|b| / (1 / c + 1 / g)` times the difference of the volumes.
///
/// Elman, Silvester, Wathen, *Finite Elements and Fast Iterative Solvers* (2014), chapter 4.
pub(crate) struct SaddleGmres<'a> {
    /// `out = K v`.
    pub apply: &'a dyn Fn(&[f64], &mut [f64]),
    pub modes: &'a VolumeModes,
    /// Of A.
    pub preconditioner: &'a dyn Preconditioner,
    pub counts: Counts,
}

/// The residual that a solution counts by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Counts {
    /// Of K, as a share of the right-hand side.
    Matrix,
    /// Of the saddle-point system, as a share of this.
    System(f64),
}

/// What an iteration did.
pub(crate) struct SaddleReport {
    pub cg: CgReport,
    /// Whether A had positive curvature along all that was looked at, so that K has.
    pub positive: bool,
}

/// Forces, and differences of volumes in the place of which forces stand.
struct Pair {
    u: Vec<f64>,
    p: Vec<f64>,
}

/// The vectors between restarts.
struct Cycle {
    basis: Vec<Pair>,
    /// Rounded: GMRES does not mind what its preconditioner does.
    directions: Vec<[Vec<f32>; 2]>,
    /// Columns of the triangle that rotations make of Hessenberg's matrix, the rotations, and the right-hand side.
    columns: Vec<Vec<f64>>,
    rotations: Vec<[f64; 2]>,
    rhs: Vec<f64>,
    curvature: Curvature,
}

/// Cholesky's factor of `z_i . A z_j`, by rows; rows of what adds nothing are zero but for an infinite last entry.
#[derive(Default)]
struct Curvature {
    rows: Vec<Vec<f64>>,
}

/// Where an iteration stands.
struct State<'x> {
    u: &'x mut [f64],
    p: &'x mut [f64],
    iterations: usize,
    positive: bool,
    /// Residual of the saddle-point system at the last restart.
    left: f64,
    /// Residual of K that was last looked at, and what the one of the saddle-point system has to fall to before the next look.
    seen: f64,
    next_look: f64,
}

impl SaddleGmres<'_> {
    /// Memory of the vectors between restarts, for so many unknowns.
    pub fn bytes(unknowns: usize) -> usize {
        LENGTH * (size_of::<f64>() + size_of::<f32>()) * unknowns
    }

    /// From the given displacements and pressures, which may be zero.
    pub fn solve(&self, f: &[f64], (u, p): (&mut [f64], &mut [f64]), (tolerance, most): (f64, usize)) -> SaddleReport {
        let scale = match self.counts {
            Counts::Matrix => sums::norm(f, self.preconditioner.parallel()),
            Counts::System(scale) => scale,
        };
        let rows = Rows::of(self.modes);
        let (seen, left) = (f64::INFINITY, f64::INFINITY);
        let mut state = State { u, p, iterations: 0, positive: true, seen, left, next_look: tolerance };
        let (end, residual) = loop {
            if let Some(end) = self.cycle((f, scale), &rows, &mut state, (tolerance, most)) {
                break end;
            }
        };
        let cg = CgReport { end, iterations: state.iterations, residual };
        SaddleReport { cg, positive: state.positive }
    }

    /// Until the next restart, or the end with its residual.
    fn cycle(
        &self,
        (f, scale): (&[f64], f64),
        rows: &Rows,
        state: &mut State,
        (tolerance, most): (f64, usize),
    ) -> Option<(CgEnd, f64)> {
        let parallel = self.preconditioner.parallel();
        let first = self.residual(f, rows, state);
        let size = first.norm(parallel);
        if !size.is_finite() {
            return Some((CgEnd::NotFinite, relative(size, scale)));
        }
        if size == 0.0 {
            return Some((CgEnd::Converged, 0.0));
        }
        let stagnates = size > STAGNATION * state.left;
        state.left = size;
        let mut cycle = Cycle::begin(first, size);
        if stagnates {
            return Some((CgEnd::Stagnated, self.look((f, scale), &cycle, state)));
        }
        loop {
            if state.iterations == most || !state.positive && state.iterations >= MOST_UNSURE {
                let residual = self.look((f, scale), &cycle, state);
                self.take(&cycle, state);
                return Some((if residual <= tolerance { CgEnd::Converged } else { CgEnd::Exhausted }, residual));
            }
            state.iterations += 1;
            let found = self.extend(&mut cycle, rows, state);
            if let Some(curvature) = found {
                self.take(&cycle, state);
                return Some((CgEnd::NegativeCurvature { curvature }, f64::INFINITY));
            }
            let left = cycle.left() / scale;
            if !left.is_finite() {
                return Some((CgEnd::NotFinite, left));
            }
            if self.counts != Counts::Matrix && left <= tolerance {
                self.take(&cycle, state);
                return Some((CgEnd::Converged, left));
            }
            if self.counts == Counts::Matrix && left <= state.next_look {
                let before = state.seen;
                state.seen = self.look((f, scale), &cycle, state);
                let stagnated = state.seen > 0.5 * before && left <= f64::EPSILON * NEXT_LOOK.recip();
                if state.seen <= tolerance || stagnated {
                    self.take(&cycle, state);
                    let end = if state.seen <= tolerance { CgEnd::Converged } else { CgEnd::Stagnated };
                    return Some((end, state.seen));
                }
                state.next_look = left * (MARGIN * tolerance / state.seen).clamp(NEXT_LOOK, MARGIN);
            }
            if cycle.directions.len() == LENGTH {
                self.take(&cycle, state);
                return None;
            }
        }
    }

    /// The residual of the saddle-point system.
    fn residual(&self, f: &[f64], rows: &Rows, state: &State) -> Pair {
        let (mut u, mut p) = (vec![0.0; f.len()], vec![0.0; self.modes.len()]);
        let parallel = self.preconditioner.parallel();
        if state.u.iter().any(|&u| u != 0.0) || state.p.iter().any(|&p| p != 0.0) {
            (self.apply)(state.u, &mut u);
            self.modes.of(state.u, &mut p, parallel);
            // A u + B^T p = K u + B^T (p - c B u)
            let excess: Vec<f64> =
                p.iter().zip(&*state.p).zip(self.modes.stiffness()).map(|((bu, p), [c, _])| p - c * bu).collect();
            self.modes.add(&excess, &mut u, parallel);
            let each = p.iter_mut().zip(&excess).zip(self.modes.stiffness().iter().zip(&rows.scale));
            each.for_each(|((p, excess), ([c, _], scale))| *p = excess * scale / c);
        }
        sums::zipped(&mut u, f, parallel, |u, f| *u = f - *u);
        Pair { u, p }
    }

    /// One more direction; a negative curvature of K.
    fn extend(&self, cycle: &mut Cycle, rows: &Rows, state: &mut State) -> Option<f64> {
        let parallel = self.preconditioner.parallel();
        let newest = cycle.basis.last()?;
        let zp: Vec<f64> = newest.p.iter().zip(&rows.size).map(|(p, size)| f64::from((-p / size) as f32)).collect();
        let mut zu = newest.u.clone();
        let negative: Vec<f64> = zp.iter().map(|p| -p).collect();
        self.modes.add(&negative, &mut zu, parallel);
        self.preconditioner.apply(&mut zu);
        let zu: Vec<f32> = zu.iter().map(|&z| z as f32).collect();
        let wide: Vec<f64> = zu.iter().map(|&z| f64::from(z)).collect();
        let (mut image, mut p) = (Pair { u: vec![0.0; wide.len()], p: vec![0.0; zp.len()] }, vec![0.0; zp.len()]);
        (self.apply)(&wide, &mut image.u);
        self.modes.of(&wide, &mut p, parallel);
        let stiffness = self.modes.stiffness();
        let stiff: Vec<f64> = p.iter().zip(stiffness).map(|(bz, [c, _])| -c * bz).collect();
        self.modes.add(&stiff, &mut image.u, parallel);
        cycle.directions.push([zu, zp.iter().map(|&p| p as f32).collect()]);
        let curvature = self.curvature(cycle, (&wide, &image.u), state);
        self.modes.add(&zp, &mut image.u, parallel);
        for (at, out) in image.p.iter_mut().enumerate() {
            *out = (p[at] - zp[at] / stiffness[at][0]) * rows.scale[at];
        }
        cycle.orthogonalise(image, parallel);
        curvature
    }

    /// Looks for negative curvature of A among the directions and, where there is some, of K.
    fn curvature(&self, cycle: &mut Cycle, (z, az): (&[f64], &[f64]), state: &mut State) -> Option<f64> {
        let parallel = self.preconditioner.parallel();
        let (own, earlier) = (dot(z, az, parallel), cycle.directions.len() - 1);
        let products = cycle.directions[..earlier].iter().map(|[u, _]| sums::dot_single(u, az, parallel)).collect();
        let (pivot, along) = cycle.curvature.push(products, own);
        if pivot > -DEPENDENT * own.abs() {
            return None;
        }
        state.positive = false;
        let mut direction = z.to_vec();
        for ([u, _], factor) in cycle.directions.iter().zip(&along) {
            sums::add_single(-factor, u, &mut direction, parallel);
        }
        let mut p = vec![0.0; self.modes.len()];
        self.modes.of(&direction, &mut p, parallel);
        let stiff: f64 = p.iter().zip(self.modes.stiffness()).map(|(p, [c, _])| c * p * p).sum();
        let of_k = pivot + stiff;
        (of_k <= 0.0).then(|| of_k / dot(&direction, &direction, parallel))
    }

    /// The residual that counts of what the directions make.
    fn look(&self, (f, scale): (&[f64], f64), cycle: &Cycle, state: &State) -> f64 {
        if self.counts != Counts::Matrix {
            return cycle.left() / scale;
        }
        let parallel = self.preconditioner.parallel();
        let (mut u, mut r) = (state.u.to_vec(), vec![0.0; f.len()]);
        for (factor, [z, _]) in cycle.coefficients().iter().zip(&cycle.directions) {
            sums::add_single(*factor, z, &mut u, parallel);
        }
        (self.apply)(&u, &mut r);
        sums::zipped(&mut r, f, parallel, |r, f| *r = f - *r);
        relative(sums::norm(&r, parallel), scale)
    }

    /// Adds what the directions make.
    fn take(&self, cycle: &Cycle, state: &mut State) {
        let parallel = self.preconditioner.parallel();
        for (factor, [u, p]) in cycle.coefficients().iter().zip(&cycle.directions) {
            sums::add_single(*factor, u, state.u, parallel);
            sums::add_single(*factor, p, state.p, parallel);
        }
    }
}

/// Norm of the residual of the saddle-point system of no displacement and these pressures.
pub(crate) fn residual_of_pressures(modes: &VolumeModes, f: &[f64], p: &[f64], parallel: bool) -> f64 {
    let mut u = f.to_vec();
    let negative: Vec<f64> = p.iter().map(|p| -p).collect();
    modes.add(&negative, &mut u, parallel);
    let rows = Rows::of(modes);
    let scaled = p.iter().zip(modes.stiffness()).zip(&rows.scale).map(|((p, [c, _]), scale)| p * scale / c).collect();
    Pair { u, p: scaled }.norm(parallel)
}

/// By row of the second block.
struct Rows {
    /// `|b|`, 1 where that is zero.
    size: Vec<f64>,
    /// `|b| / (1 / c + 1 / g)`: what makes the difference of a volume a force.
    scale: Vec<f64>,
}

impl Rows {
    fn of(modes: &VolumeModes) -> Self {
        let size: Vec<f64> = modes.norms().map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let scale = size.iter().zip(modes.stiffness()).map(|(size, &[c, g])| size / (1.0 / c + 1.0 / g)).collect();
        Rows { size, scale }
    }
}

impl Pair {
    fn norm(&self, parallel: bool) -> f64 {
        (dot(&self.u, &self.u, parallel) + dot(&self.p, &self.p, parallel)).sqrt()
    }

    fn scaled(mut self, by: f64) -> Self {
        self.u.iter_mut().chain(&mut self.p).for_each(|x| *x *= by);
        self
    }
}

impl Cycle {
    fn begin(first: Pair, size: f64) -> Self {
        Cycle {
            basis: vec![first.scaled(1.0 / size)],
            directions: Vec::new(),
            columns: Vec::new(),
            rotations: Vec::new(),
            rhs: vec![size],
            curvature: Curvature::default(),
        }
    }

    /// What is left of the residual.
    fn left(&self) -> f64 {
        self.rhs.last().map_or(0.0, |last| last.abs())
    }

    /// Makes the image of the newest direction the next vector of the basis.
    fn orthogonalise(&mut self, mut image: Pair, parallel: bool) {
        let mut column = Vec::with_capacity(self.basis.len() + 1);
        for v in &self.basis {
            let share = dot(&v.u, &image.u, parallel) + dot(&v.p, &image.p, parallel);
            sums::zipped(&mut image.u, &v.u, parallel, |w, v| *w -= share * v);
            sums::zipped(&mut image.p, &v.p, parallel, |w, v| *w -= share * v);
            column.push(share);
        }
        let length = image.norm(parallel);
        for (k, &[c, s]) in self.rotations.iter().enumerate() {
            let (a, b) = (column[k], column[k + 1]);
            (column[k], column[k + 1]) = (c * a + s * b, c * b - s * a);
        }
        let last = column.len() - 1;
        let size = column[last].hypot(length);
        let [c, s] = if size > 0.0 { [column[last] / size, length / size] } else { [1.0, 0.0] };
        column[last] = size;
        let rhs = self.rhs[last];
        self.rhs[last] = c * rhs;
        self.rhs.push(-s * rhs);
        self.rotations.push([c, s]);
        self.columns.push(column);
        self.basis.push(image.scaled(if length > 0.0 { 1.0 / length } else { 0.0 }));
    }

    /// The factors of the directions that leave the least residual.
    fn coefficients(&self) -> Vec<f64> {
        let mut y = self.rhs[..self.columns.len()].to_vec();
        for i in (0..y.len()).rev() {
            let known: f64 = (i + 1..y.len()).map(|j| self.columns[j][i] * y[j]).sum();
            y[i] = if self.columns[i][i] == 0.0 { 0.0 } else { (y[i] - known) / self.columns[i][i] };
        }
        y
    }
}

impl Curvature {
    /// The curvature along a new direction less its parts along the earlier ones, and the factors of these.
    fn push(&mut self, products: Vec<f64>, own: f64) -> (f64, Vec<f64>) {
        let mut row: Vec<f64> = products;
        for i in 0..row.len() {
            let known: f64 = (0..i).map(|k| self.rows[i][k] * row[k]).sum();
            row[i] = (row[i] - known) / self.rows[i][i];
        }
        let pivot = own - row.iter().map(|r| r * r).sum::<f64>();
        let mut along = row.clone();
        for i in (0..along.len()).rev() {
            let known: f64 = (i + 1..along.len()).map(|k| self.rows[k][i] * along[k]).sum();
            along[i] = (along[i] - known) / self.rows[i][i];
        }
        match pivot > DEPENDENT * own.abs() {
            true => row.push(pivot.sqrt()),
            false => {
                row.fill(0.0);
                row.push(f64::INFINITY);
            }
        }
        self.rows.push(row);
        (pivot, along)
    }
}
