//! [`Edges`]: edges of one surface before those of another, which no move lets go through each other.

use super::moves::advance_within;
use super::pieces::Pieces;
use crate::contact::samples::place;
use nastic_mesh::Mesh;
use nastic_mesh::spatial::{Aabb, Tree};
use nastic_tensor::Vec3;
use std::sync::Arc;

/// The edges of the flat pieces of two surfaces in space, or twice those of one. They carry nothing: samples do. In the plane there are none.
#[derive(Debug)]
pub(super) struct Edges {
    mesh: Arc<Mesh>,
    /// With the facets of the other surface that are their neighbours in the body, ascending.
    own: Vec<([u32; 2], Vec<u32>)>,
    /// With the facets that they are of.
    others: Vec<([u32; 2], Vec<u32>)>,
    /// Both are those of one surface.
    same: bool,
}

impl Edges {
    pub fn new(mesh: &Arc<Mesh>, own: &Pieces, others: &Pieces, same: bool) -> Self {
        let of = |pieces: &Pieces| if mesh.dim() == 3 { pieces.edges() } else { Vec::new() };
        let nodes: Vec<[u32; 2]> = of(own).into_iter().map(|(nodes, _)| nodes).collect();
        let neighbours = others.around(nodes.iter().map(|nodes| nodes.iter().copied().collect()));
        Edges { mesh: mesh.clone(), own: nodes.into_iter().zip(neighbours).collect(), others: of(others), same }
    }

    /// Two edges that are nearer to each other than a distance: a place between them, and how near they are.
    pub fn nearer(&self, u: &[f64], least: f64) -> Option<(Vec3, f64)> {
        let around = |nodes: &[u32; 2]| Aabb::around(&self.ends(nodes, u)).grown(0.5 * least);
        let mut found = None;
        self.each_near(around, |pair| {
            let (x, y) = nearest(&pair.map(|nodes| self.ends(nodes, u)));
            let distance = (x - y).norm();
            if distance < least && found.is_none_or(|(_, known)| distance < known) {
                found = Some((0.5 * (x + y), distance));
            }
        });
        found
    }

    /// The longest share, `most` at most, of a straight move that leaves a tenth of the distance between every two edges.
    pub fn longest_move(&self, [u, end]: [&[f64]; 2], most: f64) -> f64 {
        let swept = |nodes: &[u32; 2]| {
            let [[a, b], [c, d]] = [u, end].map(|u| self.ends(nodes, u));
            Aabb::around(&[a, b, c, d])
        };
        let mut share = most;
        self.each_near(swept, |pair| {
            let [from, to] = [u, end].map(|u| pair.map(|nodes| self.ends(nodes, u)));
            share = advance(&from, &to, share);
        });
        share
    }

    fn ends(&self, nodes: &[u32; 2], u: &[f64]) -> [Vec3; 2] {
        nodes.map(|node| place(&self.mesh, u, node))
    }

    /// Calls with the pairs of edges whose boxes overlap, but for neighbours.
    fn each_near(&self, around: impl Fn(&[u32; 2]) -> Aabb, mut call: impl FnMut([&[u32; 2]; 2])) {
        let boxes =
            |edges: &[([u32; 2], Vec<u32>)]| -> Vec<Aabb> { edges.iter().map(|(nodes, _)| around(nodes)).collect() };
        let [own, others] = [boxes(&self.own), boxes(&self.others)];
        let all = |boxes: &[Aabb]| boxes.iter().copied().reduce(|all, one| all.union(&one));
        let (Some(of_own), Some(of_others)) = (all(&own), all(&others)) else { return };
        // none is tested for bodies that are far from each other
        let near_own: Vec<usize> = (0..others.len()).filter(|&other| others[other].overlaps(&of_own)).collect();
        if near_own.is_empty() {
            return;
        }
        let tree = Tree::build(&near_own.iter().map(|&other| others[other]).collect::<Vec<_>>());
        for (k, (nodes, neighbours)) in self.own.iter().enumerate().filter(|(k, _)| own[*k].overlaps(&of_others)) {
            let mut near = Vec::new();
            tree.overlapping(&own[k], |other| {
                near.push(near_own[other]);
                false
            });
            near.sort_unstable();
            for other in near {
                let (of_other, facets) = &self.others[other];
                let is_neighbour = facets.iter().any(|facet| neighbours.binary_search(facet).is_ok());
                if !(is_neighbour || self.same && other <= k) {
                    call([nodes, of_other]);
                }
            }
        }
    }
}

/// Additive advancement of two edges.
fn advance(from: &[[Vec3; 2]; 2], to: &[[Vec3; 2]; 2], most: f64) -> f64 {
    let moves: [[Vec3; 2]; 2] = std::array::from_fn(|i| std::array::from_fn(|j| to[i][j] - from[i][j]));
    let mean = 0.25 * moves.iter().flatten().sum::<Vec3>();
    let speed = moves.iter().map(|ends| ends.iter().map(|by| (by - mean).norm()).fold(0.0, f64::max)).sum();
    let distance = |s: f64| {
        let (x, y) = nearest(&std::array::from_fn(|i| std::array::from_fn(|j| from[i][j] + s * moves[i][j])));
        (x - y).norm()
    };
    advance_within(distance, speed, most)
}

/// The nearest points of two segments. Ericson, Real-Time Collision Detection (2005), section 5.1.9.
fn nearest([[a, b], [c, d]]: &[[Vec3; 2]; 2]) -> (Vec3, Vec3) {
    let (along, across, apart) = (b - a, d - c, a - c);
    let (aa, cc, ac) = (along.norm_squared(), across.norm_squared(), along.dot(&across));
    let (on_a, on_c) = (along.dot(&apart), across.dot(&apart));
    let share = |value: f64, of: f64| if of > 0.0 { (value / of).clamp(0.0, 1.0) } else { 0.0 };
    // nearly parallel ones have their nearest points at an end of one of them
    let first = share(ac * on_c - cc * on_a, aa * cc - ac * ac);
    let second = share(ac * first + on_c, cc);
    let first = share(ac * second - on_a, aa);
    (a + first * along, c + second * across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of edges that cross, that end beside each other, and of parallel ones; two edges that fall through each other stop where a tenth of their
    /// distance is left, 0.45 of the way (as the IPC toolkit's additive advancement, 1.6.1).
    #[test]
    fn edges_stop_before_they_cross() {
        let v = Vec3::new;
        let distance = |one: [Vec3; 2], two: [Vec3; 2]| {
            let (x, y) = nearest(&[one, two]);
            (x - y).norm()
        };
        let one = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0)];
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}, {expected}");
        close(distance(one, [v(0.5, -1.0, 0.3), v(0.5, 1.0, 0.3)]), 0.3);
        close(distance(one, [v(2.0, 0.0, 0.0), v(2.0, 1.0, 0.0)]), 1.0);
        close(distance(one, [v(0.2, 0.4, 0.0), v(0.7, 0.4, 0.0)]), 0.4);
        close(distance(one, [v(3.0, 1.0, 0.0), v(2.0, 1.0, 0.0)]), f64::sqrt(2.0));
        let above = [v(0.5, -1.0, 0.5), v(0.5, 1.0, 0.5)];
        let below = [v(0.5, -1.0, -0.5), v(0.5, 1.0, -0.5)];
        let found = advance(&[one, above], &[one, below], 1.0);
        assert!((found - 0.45).abs() < 1e-3, "{found}");
        assert_eq!(
            advance(&[one, above], &[one, [v(0.5, -1.0, 0.2), v(0.5, 1.0, 0.2)]], 1.0).to_bits(),
            1f64.to_bits()
        );
    }
}
