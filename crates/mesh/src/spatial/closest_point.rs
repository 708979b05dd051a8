//! The closest-point projection onto one curved face.

use super::V;
use super::patch::Patch;

const MAX_STEPS: usize = 20;
/// Distance from an edge of the domain up to which a parameter is on it.
const EDGE_TOLERANCE: f64 = 1e-14;

/// Half planes n.u + o >= 0 whose intersection is the face's parameter domain.
type HalfPlane = ([f64; 2], f64);
const BOX: [HalfPlane; 4] = [([1.0, 0.0], 0.0), ([-1.0, 0.0], 1.0), ([0.0, 1.0], 0.0), ([0.0, -1.0], 1.0)];
const TRIANGLE: [HalfPlane; 3] = [([1.0, 0.0], 0.0), ([0.0, 1.0], 0.0), ([-1.0, -1.0], 1.0)];

/// Nearest point of a face to `p` its squared distance and its parameters, by a Newton iteration that keeps to the
/// domain with its edges and corners. It starts at `start` and never moves away from p, so a start in the basin of the global minimum
/// gives the nearest point of all.
pub(super) fn project(patch: &Patch, p: &V, start: [f64; 2]) -> (V, f64, [f64; 2]) {
    let line = patch.space.dim == 1;
    let domain: &[HalfPlane] = match (line, patch.space.simplex) {
        (true, _) => &BOX[..2],
        (_, false) => &BOX,
        _ => &TRIANGLE,
    };
    let mut u = start;
    let mut jet = patch.second(&[u[0], u[1], 0.0]);
    let mut value = (jet.x - p).norm_squared();
    for _ in 0..MAX_STEPS {
        let r = jet.x - p;
        let gradient = [r.dot(&jet.first[0]), r.dot(&jet.first[1])];
        let hessian = curvature(&jet.first, &jet.second, &r, line);
        let Some(step) = direction(domain, &u, &gradient, &hessian, line) else { break };
        let mut t = 1.0f64;
        for &(n, o) in domain {
            let slope = dot(&n, &step);
            let room = dot(&n, &u) + o;
            if slope < 0.0 && room > EDGE_TOLERANCE {
                t = t.min(-room / slope);
            }
        }
        let mut moved = false;
        for _ in 0..10 {
            let trial = [u[0] + t * step[0], u[1] + t * step[1]].map(|v| v.clamp(0.0, 1.0));
            let next = patch.second(&[trial[0], trial[1], 0.0]);
            let squared = (next.x - p).norm_squared();
            if squared < value {
                (u, jet, value, moved) = (trial, next, squared, true);
                break;
            }
            t *= 0.5;
        }
        if !moved || t * step[0].abs().max(step[1].abs()) < 1e-9 {
            break;
        }
    }
    (jet.x, value, u)
}

/// Hessian (00, 11, 01) of |x - p|^2 / 2, or its Gauss-Newton part where that is not positive definite.
fn curvature(first: &[V; 3], second: &[V; 3], r: &V, line: bool) -> [f64; 3] {
    let gauss = [first[0].norm_squared(), first[1].norm_squared(), first[0].dot(&first[1])];
    let full: [f64; 3] = std::array::from_fn(|i| gauss[i] + r.dot(&second[i]));
    let definite = if line {
        full[0] > 0.0
    } else {
        full[0] > 0.0 && full[0] * full[1] - full[2] * full[2] > 1e-12 * gauss[0] * gauss[1]
    };
    if definite { full } else { gauss }
}

/// Newton direction in the domain: free, or along one of the edges `u` lies on. `None` where no direction descends.
fn direction(domain: &[HalfPlane], u: &[f64; 2], g: &[f64; 2], h: &[f64; 3], line: bool) -> Option<[f64; 2]> {
    let feasible = |d: &[f64; 2]| domain.iter().all(|(n, o)| dot(n, u) + o > EDGE_TOLERANCE || dot(n, d) >= 0.0);
    let descends = |d: &[f64; 2]| d.iter().all(|v| v.is_finite()) && dot(d, g) < 0.0;
    if line {
        let d = [-g[0] / h[0], 0.0];
        return (descends(&d) && feasible(&d)).then_some(d);
    }
    let det = h[0] * h[1] - h[2] * h[2];
    let free = [(h[2] * g[1] - h[1] * g[0]) / det, (h[2] * g[0] - h[0] * g[1]) / det];
    if descends(&free) && feasible(&free) {
        return Some(free);
    }
    let steepest = [-g[0], -g[1]];
    if !descends(&free) && feasible(&steepest) && descends(&steepest) {
        let length = h[0].max(h[1]);
        return (length > 0.0).then(|| steepest.map(|v| v / length));
    }
    let mut best: Option<([f64; 2], f64)> = None;
    for (n, _) in domain.iter().filter(|(n, o)| dot(n, u) + o <= EDGE_TOLERANCE) {
        let t = [-n[1], n[0]];
        let along = dot(&t, g);
        let curvature_along = h[0] * t[0] * t[0] + 2.0 * h[2] * t[0] * t[1] + h[1] * t[1] * t[1];
        let d = t.map(|t| -along / curvature_along * t);
        if descends(&d) && feasible(&d) && best.is_none_or(|(_, gain)| along * along / curvature_along > gain) {
            best = Some((d, along * along / curvature_along));
        }
    }
    best.map(|(d, _)| d)
}

fn dot(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
