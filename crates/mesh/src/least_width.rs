//! How thin a body is where it is thinnest.

use crate::LevelBody;
use crate::level_piece::WallKind;
use crate::spatial::{Aabb, Tree};

/// Walls whose directions differ by more from opposite ones, 30 degrees, are the sides of an edge, not of a bar: the cosine of that.
const OPPOSITE: f64 = 0.866_025_403_784_438_6;
/// Triangles of less than this share of their mean area do not say where a wall looks: edges are cut a little beside their ends.
const LEAST_AREA: f64 = 0.02;
/// Shares of a triangle and of a length within which a ray meets a triangle's edge, and its own.
const ROUNDING: f64 = 1e-9;

type V = nalgebra::Vector3<f64>;

/// The least distance of two opposite walls through the body between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastWidth {
    /// The distance.
    pub width: f64,
    /// Halfway between the walls; of a plane body in its plane.
    pub position: [f64; 3],
}

struct Wall {
    corners: [V; 3],
    /// Outward, of length 1.
    normal: V,
    beyond: WallKind,
}

impl Wall {
    fn area(&self) -> f64 {
        let [a, b, c] = &self.corners;
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    fn centre(&self) -> V {
        self.corners.iter().sum::<V>() / 3.0
    }

    /// How far along a ray from within the body it leaves through this wall.
    fn met_by(&self, from: &V, along: &V) -> Option<f64> {
        let leaving = self.normal.dot(along);
        if leaving <= 0.0 {
            return None;
        }
        let distance = (self.corners[0] - from).dot(&self.normal) / leaving;
        let point = from + along * distance;
        let [a, b, c] = &self.corners;
        let area = (b - a).cross(&(c - a)).dot(&self.normal);
        let is_in = [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(p, q)| (q - p).cross(&(point - p)).dot(&self.normal) >= -ROUNDING * area);
        (is_in && distance > ROUNDING * area.sqrt()).then_some(distance)
    }
}

impl LevelBody {
    /// The least width of what lies above a level, at these positions of the mesh's points: from the middle of every triangle of the cut straight inward to where the
    /// body ends, if the wall there is one of these kinds and looks the other way to 30 degrees. Edges that are blunter, as where a bar meets the skin aslant, do not
    /// count; sharper ones are as thin as the triangles next to them say. Exact for parallel walls; else with an error of second order in the size of cells. Plates
    /// are looked at along their plane. `None` where no wall of the cut has one opposite to it.
    #[must_use]
    pub fn least_width(&self, positions: &[[f64; 3]], level: f64, kinds: &[WallKind]) -> Option<LeastWidth> {
        let clipped = self.clipped(positions, level);
        let points: Vec<V> = clipped.points.iter().map(|x| V::from(*x)).collect();
        let sides = clipped.triangles.iter().zip(&clipped.beyond).filter(|(_, beyond)| **beyond != WallKind::Face);
        let walls: Vec<Wall> = sides
            .filter_map(|(triangle, beyond)| {
                let corners = triangle.map(|k| points[k as usize]);
                let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).try_normalize(0.0)?;
                Some(Wall { corners, normal, beyond: *beyond })
            })
            .collect();
        let boxes: Vec<Aabb> = walls.iter().map(|wall| Aabb::around(&wall.corners)).collect();
        let tree = Tree::build(&boxes);
        let whole = Aabb::around(&points).diagonal();
        let cut = || walls.iter().filter(|wall| wall.beyond == WallKind::Cut);
        let mean_area = cut().map(Wall::area).sum::<f64>() / cut().count().max(1) as f64;
        let mut least: Option<LeastWidth> = None;
        for wall in cut().filter(|wall| wall.area() >= LEAST_AREA * mean_area) {
            let ray = Ray { from: wall.centre(), along: -wall.normal };
            let most = least.map_or(whole, |own| own.width);
            let Some((width, hit)) = ray.first_met(&walls, &tree, most) else { continue };
            let is_opposite = hit.normal.dot(&ray.along) >= OPPOSITE && kinds.contains(&hit.beyond);
            if is_opposite && least.is_none_or(|own| width < own.width) {
                let mut position: [f64; 3] = (ray.from + 0.5 * width * ray.along).into();
                if self.thickness.is_some() {
                    position[2] = 0.0;
                }
                least = Some(LeastWidth { width, position });
            }
        }
        least
    }
}

struct Ray {
    from: V,
    /// Of length 1.
    along: V,
}

impl Ray {
    /// The first wall that a ray leaves through within a distance. Searched in boxes that double: the first walls are mostly near.
    fn first_met<'w>(&self, walls: &'w [Wall], tree: &Tree, most: f64) -> Option<(f64, &'w Wall)> {
        const FIRST_SHARE: f64 = 1.0 / 64.0;
        let mut reach = FIRST_SHARE * most;
        loop {
            let range = Aabb::around(&[self.from, self.from + self.along * reach]).grown(ROUNDING * most);
            let mut first: Option<(f64, &Wall)> = None;
            tree.overlapping(&range, |k| {
                let met = walls[k].met_by(&self.from, &self.along);
                if let Some(distance) = met.filter(|own| *own <= reach && first.is_none_or(|(least, _)| *own < least)) {
                    first = Some((distance, &walls[k]));
                }
                false
            });
            if first.is_some() || reach >= most {
                return first;
            }
            reach = (2.0 * reach).min(most);
        }
    }
}
