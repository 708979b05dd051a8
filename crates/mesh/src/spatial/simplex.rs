//! Nearest points of flat segments and triangles.

use super::V;

/// Barycentric coordinates of the point of triangle (a, b, c) nearest to p (Ericson, Real-Time Collision Detection,
/// 5.1.5), and the point. Degenerate triangles are treated as their edges; a segment is a triangle with c = b.
pub(super) fn nearest(t: &[V; 3], p: &V) -> ([f64; 3], V) {
    let (ab, ac) = (t[1] - t[0], t[2] - t[0]);
    let area = ab.cross(&ac).norm_squared();
    if area.is_nan() || area <= 1e-24 * ab.norm_squared() * ac.norm_squared() {
        return degenerate(t, p);
    }
    let (ap, bp, cp) = (p - t[0], p - t[1], p - t[2]);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ([1.0, 0.0, 0.0], t[0]);
    }
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return ([0.0, 1.0, 0.0], t[1]);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return ([1.0 - v, v, 0.0], t[0] + ab * v);
    }
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return ([0.0, 0.0, 1.0], t[2]);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return ([1.0 - w, 0.0, w], t[0] + ac * w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return ([0.0, 1.0 - w, w], t[1] + (t[2] - t[1]) * w);
    }
    let sum = va + vb + vc;
    let (v, w) = (vb / sum, vc / sum);
    ([1.0 - v - w, v, w], t[0] + ab * v + ac * w)
}

fn degenerate(t: &[V; 3], p: &V) -> ([f64; 3], V) {
    let mut best = ([1.0, 0.0, 0.0], t[0]);
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let s = along(&t[i], &t[j], p);
        let x = t[i] + (t[j] - t[i]) * s;
        if (x - p).norm_squared() < (best.1 - p).norm_squared() {
            let mut bary = [0.0; 3];
            bary[i] = 1.0 - s;
            bary[j] = s;
            best = (bary, x);
        }
    }
    best
}

fn along(a: &V, b: &V, p: &V) -> f64 {
    let e = b - a;
    let length = e.norm_squared();
    if length > 0.0 { (e.dot(&(p - a)) / length).clamp(0.0, 1.0) } else { 0.0 }
}
