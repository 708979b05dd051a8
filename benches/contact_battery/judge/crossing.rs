//! Facets of surfaces that cross: segments in a plane, edges and triangles in space.

use super::scene::Scene;
use nastic::prelude::*;
use std::collections::BTreeSet;

type Simplex = Vec<usize>;

/// How many straight pieces of the one surface cross pieces of the other with which they share no node.
pub(super) fn crossings(scene: &Scene, surfaces: &[String; 2], x: &[Vec3]) -> usize {
    let [a, b] = [0, 1].map(|k| pieces(scene, &surfaces[k]));
    let crosses = |p: &Simplex, q: &Simplex| {
        let apart = p.iter().all(|node| !q.contains(node)) && boxes_meet(p, q, x);
        apart && if scene.dim == 2 { segments(p, q, x) } else { triangles(p, q, x) }
    };
    a.iter().map(|p| b.iter().filter(|q| crosses(p, q)).count()).sum()
}

/// Between the corners and the middles of facets.
fn pieces(scene: &Scene, surface: &str) -> Vec<Simplex> {
    let parts = |kind: &str| -> &'static [&'static [usize]] {
        match kind {
            "line2" => &[&[0, 1]],
            "line3" => &[&[0, 2], &[2, 1]],
            "tri3" => &[&[0, 1, 2]],
            "tri6" => &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
            "quad4" => &[&[0, 1, 2], &[0, 2, 3]],
            "quad8" => &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6], &[4, 6, 7]],
            _ => &[&[0, 4, 8], &[0, 8, 7], &[4, 1, 5], &[4, 5, 8], &[8, 5, 2], &[8, 2, 6], &[7, 8, 6], &[7, 6, 3]],
        }
    };
    let of = |(kind, nodes): (&'static str, Vec<usize>)| -> Vec<Simplex> {
        parts(kind).iter().map(|part| part.iter().map(|local| nodes[*local]).collect()).collect()
    };
    scene.facets_of(surface).into_iter().flat_map(of).collect()
}

fn boxes_meet(p: &Simplex, q: &Simplex, x: &[Vec3]) -> bool {
    let bound = |of: &Simplex, i: usize| {
        let values = of.iter().map(|node| x[*node][i]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    (0..3).all(|i| {
        let ((low, high), (least, most)) = (bound(p, i), bound(q, i));
        low <= most && least <= high
    })
}

fn segments(p: &Simplex, q: &Simplex, x: &[Vec3]) -> bool {
    let side = |a: usize, b: usize, c: usize| (x[b] - x[a]).cross(&(x[c] - x[a])).z;
    side(p[0], p[1], q[0]) * side(p[0], p[1], q[1]) < 0.0 && side(q[0], q[1], p[0]) * side(q[0], q[1], p[1]) < 0.0
}

fn triangles(p: &Simplex, q: &Simplex, x: &[Vec3]) -> bool {
    let edges = |t: &Simplex| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    edges(p).iter().any(|edge| pierces(*edge, q, x)) || edges(q).iter().any(|edge| pierces(*edge, p, x))
}

/// By the signs of five volumes.
fn pierces([a, b]: [usize; 2], t: &Simplex, x: &[Vec3]) -> bool {
    let volume = |i: usize, j: usize, k: usize, l: usize| (x[j] - x[i]).cross(&(x[k] - x[i])).dot(&(x[l] - x[i]));
    if volume(t[0], t[1], t[2], a) * volume(t[0], t[1], t[2], b) >= 0.0 {
        return false;
    }
    let signs: BTreeSet<bool> =
        [[0, 1], [1, 2], [2, 0]].iter().map(|[i, j]| volume(a, b, t[*i], t[*j]) > 0.0).collect();
    signs.len() == 1
}
