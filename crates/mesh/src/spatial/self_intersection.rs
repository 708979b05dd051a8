//! Self-intersection of a solid: cells that lie in other cells, boundary faces that cross each other.

use super::V;
use super::boundary::Facet;
use super::shape::Shape;
use super::tree::Aabb;

/// Where a solid intersects itself; cells by their numbers in the mesh, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SelfIntersection {
    /// Cells whose centre lies in another cell.
    pub overlapped: Vec<u32>,
    /// Cells with a boundary face that crosses a boundary face of another cell. Faces with a common node are not compared.
    pub crossed: Vec<u32>,
}

impl SelfIntersection {
    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.overlapped.is_empty() && self.crossed.is_empty()
    }

    /// All cells found, ascending.
    pub fn cells(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.overlapped.iter().chain(&self.crossed).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Least distance of an end of an edge from the other facet's plane, as a share of the edge's length, so that faces that only
/// touch do not count.
const MIN_CROSSING_SHARE: f64 = 1e-6;

impl Shape {
    /// Where the solid intersects itself: boundary faces against each other, cell centres against other cells, both by the
    /// spatial index. Faces are taken as their nearly flat facets; a crossing shallower than their deviation from the curved
    /// faces is not counted. Cost: about that of building the shape.
    pub fn self_intersection(&self) -> SelfIntersection {
        SelfIntersection { overlapped: self.overlapped(), crossed: self.crossed() }
    }

    fn overlapped(&self) -> Vec<u32> {
        let in_another = |&cell: &usize| {
            let patch = self.cells.patch(cell);
            let corners = patch.space.corners();
            let centre = (0..corners).map(|i| V::from(patch.space.corner(i))).sum::<V>() / corners as f64;
            self.cells.is_in_another(&patch.value(&centre.into()), cell)
        };
        (0..self.cells.len()).filter(in_another).map(|cell| self.ids[cell]).collect()
    }

    fn crossed(&self) -> Vec<u32> {
        let facets = &self.boundary.facets;
        let mut crossed = vec![false; self.faces.len()];
        for (k, facet) in facets.iter().enumerate() {
            let range = Aabb::around(&facet.corners).grown(facet.sag);
            self.boundary.tree.overlapping(&range, |other| {
                let (a, b) = (facet.face as usize, facets[other].face as usize);
                if other > k && !(crossed[a] && crossed[b]) && self.are_apart(a, b) && self.cross(facet, &facets[other])
                {
                    (crossed[a], crossed[b]) = (true, true);
                }
                false
            });
        }
        let mut cells: Vec<u32> = (0..crossed.len()).filter(|&f| crossed[f]).map(|f| self.faces[f].cell).collect();
        cells.sort_unstable();
        cells.dedup();
        cells.iter().map(|&cell| self.ids[cell as usize]).collect()
    }

    /// Whether two faces belong to different cells and have no node in common.
    fn are_apart(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.faces[a], &self.faces[b]);
        a.cell != b.cell && a.corners.iter().all(|node| *node == u32::MAX || !b.corners.contains(node))
    }

    fn cross(&self, a: &Facet, b: &Facet) -> bool {
        let margin = a.sag + b.sag;
        if self.boundary.plane {
            let [p, q, _] = a.corners;
            let [r, s, _] = b.corners;
            return straddles(&[p, q], &r, &b.normal, margin) && straddles(&[r, s], &p, &a.normal, margin);
        }
        let pierces =
            |of: &Facet, on: &Facet| (0..3).any(|i| pierces(&[of.corners[i], of.corners[(i + 1) % 3]], on, margin));
        pierces(a, b) || pierces(b, a)
    }
}

/// Whether the ends of an edge lie on two sides of the plane through `x`, by more than the margin.
fn straddles(edge: &[V; 2], x: &V, normal: &V, margin: f64) -> bool {
    let least = margin + MIN_CROSSING_SHARE * (edge[1] - edge[0]).norm();
    let [d, e] = edge.map(|p| normal.dot(&(p - x)));
    d.abs() > least && e.abs() > least && d * e < 0.0
}

/// Whether an edge passes through a triangle.
fn pierces(edge: &[V; 2], triangle: &Facet, margin: f64) -> bool {
    let [a, b, c] = triangle.corners;
    let n = triangle.normal;
    if !straddles(edge, &a, &n, margin) {
        return false;
    }
    let (d, e) = (n.dot(&(edge[0] - a)), n.dot(&(edge[1] - a)));
    let x = edge[0] + (edge[1] - edge[0]) * (d / (d - e));
    [(a, b), (b, c), (c, a)].iter().all(|(p, q)| n.dot(&(q - p).cross(&(x - p))) >= 0.0)
}
