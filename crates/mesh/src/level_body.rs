//! [`LevelBody`]: the part of a body in which a field is above a level, as a closed surface.

use crate::Mesh;
use crate::level_piece::{Clipped, Clipper, Simplex, WallKind};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How often the level of a volume is bisected: to 1e-6 of the range of the field.
const VOLUME_BISECTIONS: usize = 20;
/// A simplex whose values differ by no more than this share of the largest value is part of a plateau.
const PLATEAU_HEIGHT: f64 = 1e-6;
/// The share of the error of the volume that a level halfway between plateaus may add.
const PLATEAU_MARGIN: f64 = 0.5;
/// Volumes that differ by no more than this share are the same.
const SAME_VOLUME: f64 = 1e-6;

/// A closed surface of triangles, each counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClosedSurface {
    /// Its points.
    pub points: Vec<[f64; 3]>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedSurface {
    /// The volume within: `sum a . (b x c) / 6` over the triangles.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let spat = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        self.triangles.iter().map(|triangle| spat(triangle.map(|k| self.points[k as usize]))).sum::<f64>() / 6.0
    }
}

/// The simplices of a [`LevelBody`], flat.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LevelSimplices {
    /// Points, those of the mesh first.
    pub points: Vec<[f64; 3]>,
    /// The corners of each, three in the plane, four in space.
    pub corners: Vec<Vec<u32>>,
    /// The cell of the mesh that each is a part of.
    pub owners: Vec<u32>,
}

/// A field s on some cells of a mesh, for the surface of what is above a level: `{ x : s(x) >= level }`.
///
/// s is linear on simplices: tetrahedra and triangles are these themselves, hexahedra fall into 24 around the centres of cell and faces, quadrilaterals into 4;
/// the values at nodes are means of those of the cells around, at centres of the corners. Curved edges are straight here. A plane body is as thick as is said, from
/// z = 0 on. The surface is closed at the skin of the cells and has no gaps: neighbours cut an edge at the same place.
#[derive(Clone, Debug)]
pub struct LevelBody {
    /// `None` in space.
    pub(crate) thickness: Option<f64>,
    /// Points of the subdivision behind those of the mesh, as sums of these.
    pub(crate) points: Arc<Vec<Vec<(u32, f64)>>>,
    /// The points of the mesh, which come first.
    pub(crate) nodes: usize,
    pub(crate) simplices: Arc<Vec<Simplex>>,
    /// The cell of the mesh that each simplex is a part of.
    pub(crate) owners: Arc<Vec<u32>>,
    /// The field at all points of the subdivision.
    pub(crate) values: Vec<f64>,
}

/// The corners of a facet, ascending.
fn key(corners: &[u32]) -> Vec<u32> {
    let mut key = corners.to_vec();
    key.sort_unstable();
    key
}

/// The corners of the facets of a cell, outward.
fn facets(mesh: &Mesh, cell: u32) -> impl Iterator<Item = Vec<u32>> {
    let cell = mesh.cell(cell as usize);
    let faces = cell.kind.faces().iter();
    faces.map(move |(kind, local)| local[..kind.corners()].iter().map(|a| cell.nodes[*a]).collect())
}

impl LevelBody {
    /// Of a field by cell, with a weight (a volume) of each for the means at nodes. A plane body has a thickness.
    #[must_use]
    pub fn new(mesh: &Mesh, cells: &[u32], values: &[f64], weights: &[f64], thickness: f64) -> Self {
        Self::of_nodes(mesh, cells, Self::nodal_means(mesh, cells, values, weights), thickness)
    }

    /// At every node of a mesh the mean of a field over these cells around it, by their weights; 0 where none of them is.
    #[must_use]
    pub fn nodal_means(mesh: &Mesh, cells: &[u32], values: &[f64], weights: &[f64]) -> Vec<f64> {
        let nodes = mesh.points().len();
        let (mut sums, mut shares) = (vec![0.0; nodes], vec![0.0; nodes]);
        for ((cell, value), weight) in cells.iter().zip(values).zip(weights) {
            let cell = mesh.cell(*cell as usize);
            for node in &cell.nodes[..cell.kind.corners()] {
                sums[*node as usize] += weight * value;
                shares[*node as usize] += weight;
            }
        }
        sums.iter().zip(&shares).map(|(sum, share)| if *share > 0.0 { sum / share } else { 0.0 }).collect()
    }

    /// Of a field by node, one value for each of the mesh.
    #[must_use]
    pub fn of_nodes(mesh: &Mesh, cells: &[u32], values: Vec<f64>, thickness: f64) -> Self {
        let thickness = (mesh.dim() == 2).then_some(thickness);
        let nodes = mesh.points().len();
        let mut body = LevelBody {
            thickness,
            points: Arc::default(),
            nodes,
            simplices: Arc::default(),
            owners: Arc::default(),
            values,
        };
        body.divide(mesh, cells);
        body
    }

    /// The same body with another field, one value for each node of the mesh.
    #[must_use]
    pub fn with_values(&self, mut values: Vec<f64>) -> Self {
        let of = |sum: &Vec<(u32, f64)>| sum.iter().map(|(node, share)| share * values[*node as usize]).sum::<f64>();
        let further: Vec<f64> = self.points.iter().map(of).collect();
        values.extend(further);
        LevelBody { values, ..self.clone() }
    }

    /// Divides the cells; a facet that one of them alone has is skin.
    fn divide(&mut self, mesh: &Mesh, cells: &[u32]) {
        let mut sides: BTreeMap<Vec<u32>, (usize, Option<u32>)> = BTreeMap::new();
        for corners in cells.iter().flat_map(|cell| facets(mesh, *cell)) {
            sides.entry(key(&corners)).or_default().0 += 1;
        }
        let own: BTreeSet<u32> = cells.iter().copied().collect();
        let others = (0..mesh.cells() as u32).filter(|cell| !own.contains(cell));
        let joined: BTreeSet<Vec<u32>> = others.flat_map(|cell| facets(mesh, cell)).map(|facet| key(&facet)).collect();
        for id in cells {
            let owned = self.simplices.len();
            self.divide_cell(mesh, *id, &mut sides, &joined);
            let more = self.simplices.len() - owned;
            Arc::make_mut(&mut self.owners).extend(std::iter::repeat_n(*id, more));
        }
    }

    fn divide_cell(
        &mut self,
        mesh: &Mesh,
        cell: u32,
        sides: &mut BTreeMap<Vec<u32>, (usize, Option<u32>)>,
        joined: &BTreeSet<Vec<u32>>,
    ) {
        let (cell, own) = (mesh.cell(cell as usize), facets(mesh, cell));
        let corners = &cell.nodes[..cell.kind.corners()];
        let of = |facet: &[u32], side: usize| match (side == 1, joined.contains(&key(facet))) {
            (false, _) => WallKind::Within,
            (true, false) => WallKind::Skin,
            (true, true) => WallKind::Joint,
        };
        if corners.len() == mesh.dim() + 1 {
            let side = |facet: &Vec<u32>| of(facet, sides.get(&key(facet)).map_or(0, |side| side.0));
            let own: Vec<_> = own.map(|facet| (side(&facet), facet)).collect();
            Arc::make_mut(&mut self.simplices).extend(Simplex::of(corners, &own));
            return;
        }
        let centre = self.centre(corners);
        for facet in own {
            let Some(side) = sides.get_mut(&key(&facet)) else { continue };
            let kind = of(&facet, side.0);
            if facet.len() == 2 {
                Arc::make_mut(&mut self.simplices).push(Simplex::around(&[facet[0], facet[1]], centre, kind));
                continue;
            }
            let middle = *side.1.get_or_insert_with(|| self.centre(&facet));
            for (k, a) in facet.iter().enumerate() {
                let triangle = [*a, facet[(k + 1) % facet.len()], middle];
                Arc::make_mut(&mut self.simplices).push(Simplex::around(&triangle, centre, kind));
            }
        }
    }

    /// One more point, the mean of these nodes.
    fn centre(&mut self, of: &[u32]) -> u32 {
        let share = 1.0 / of.len() as f64;
        let mean = of.iter().map(|node| self.values[*node as usize]).sum::<f64>() / of.len() as f64;
        Arc::make_mut(&mut self.points).push(of.iter().map(|node| (*node, share)).collect());
        self.values.push(mean);
        (self.nodes + self.points.len() - 1) as u32
    }

    /// The surface at a level, with the points of the mesh at these positions; empty where the field is below the level everywhere.
    #[must_use]
    pub fn surface(&self, positions: &[[f64; 3]], level: f64) -> ClosedSurface {
        let Clipped { points, triangles, .. } = self.clipped(positions, level);
        ClosedSurface { points, triangles }
    }

    /// Its simplices, with the points of the mesh at these positions: triangles of a plane body, counter-clockwise, tetrahedra in space, the fourth corner on the
    /// inner side of the first three, which are counter-clockwise seen from outside.
    #[must_use]
    pub fn simplices(&self, positions: &[[f64; 3]]) -> LevelSimplices {
        let corners = self.simplices.iter().map(|simplex| simplex.corners().copied().collect()).collect();
        LevelSimplices { points: self.places(positions), corners, owners: self.owners.to_vec() }
    }

    /// The surface of all of it.
    #[must_use]
    pub fn whole(&self, positions: &[[f64; 3]]) -> ClosedSurface {
        self.surface(positions, f64::NEG_INFINITY)
    }

    /// Where all points of the subdivision are.
    fn places(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut places = positions.to_vec();
        places.extend(self.points.iter().map(|of| {
            of.iter().fold([0.0; 3], |sum, (node, share)| {
                let x = &positions[*node as usize];
                [0, 1, 2].map(|k| sum[k] + share * x[k])
            })
        }));
        places
    }

    pub(crate) fn clipped(&self, positions: &[[f64; 3]], level: f64) -> Clipped {
        let places = self.places(positions);
        let mut clipper = Clipper::new(&places, &self.values, level, self.thickness);
        for simplex in self.simplices.iter() {
            match simplex {
                Simplex::Tetrahedron { corners, sides } => clipper.tetrahedron(corners, sides),
                Simplex::Triangle { corners, sides } => clipper.triangle(corners, sides),
            }
        }
        clipper.clipped()
    }

    /// The level at which the surface encloses a volume; 1/2 of a field without values. None may: a plateau of the field is above a level as a whole or not at all.
    /// Then it is the level on the side of the plateau whose volume is nearer (below it of equal ones), halfway to the next plateau or, without one, to the end of
    /// the range where that costs at most half of the error more; beyond the range that is half of it farther, of a uniform field 1/2.
    #[must_use]
    pub fn level_of_volume(&self, positions: &[[f64; 3]], volume: f64) -> f64 {
        let used = || self.simplices.iter().flat_map(Simplex::corners).map(|point| self.values[*point as usize]);
        let (least, most) = used().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
        if least > most {
            return 0.5;
        }
        let of = |level: f64| self.surface(positions, level).volume();
        let (mut low, mut high) = (least, most);
        for _ in 0..VOLUME_BISECTIONS {
            let middle = 0.5 * (low + high);
            match of(middle) > volume {
                true => low = middle,
                false => high = middle,
            }
        }
        let level = 0.5 * (low + high);
        let rounding = (PLATEAU_HEIGHT * least.abs().max(most.abs())).max(f64::MIN_POSITIVE);
        let plateaus = self.plateaus(rounding);
        let next = plateaus.partition_point(|s| *s < level - 2.0 * rounding);
        let before = next.checked_sub(1).map(|k| plateaus[k]);
        let error = |level: f64| (of(level) - volume).abs();
        match plateaus.get(next).copied() {
            Some(plateau) if plateau <= level + 2.0 * rounding => {
                let beyond = if most - least > rounding { 0.5 * (most - least) } else { 0.5 };
                let away = |other: Option<f64>, end: f64, step: f64| match other {
                    Some(other) => 0.5 * (plateau + other),
                    None if (plateau - end).abs() > rounding => 0.5 * (plateau + end),
                    None => plateau + step,
                };
                let sides = [
                    (away(before, least, -beyond), plateau - 2.0 * rounding),
                    (away(plateaus.get(next + 1).copied(), most, beyond), plateau + 2.0 * rounding),
                ];
                let [below, above] = sides.map(|(_, beside)| error(beside));
                let ((far, beside), own) = if below <= above { (sides[0], below) } else { (sides[1], above) };
                if error(far) <= (1.0 + PLATEAU_MARGIN) * own + SAME_VOLUME * volume.abs() { far } else { beside }
            }
            Some(after) => {
                let middle = before.map(|before| 0.5 * (before + after));
                let same = |middle: &f64| error(*middle) <= error(level) + SAME_VOLUME * volume.abs();
                middle.filter(same).unwrap_or(level)
            }
            None => level,
        }
    }

    /// The values that the field has on whole simplices, ascending.
    fn plateaus(&self, rounding: f64) -> Vec<f64> {
        let of = |simplex: &Simplex| {
            let values = || simplex.corners().map(|point| self.values[*point as usize]);
            let (least, most) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
            (most - least <= rounding).then_some(0.5 * (least + most))
        };
        let mut all: Vec<f64> = self.simplices.iter().filter_map(of).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.dedup_by(|next, kept| *next - *kept <= 2.0 * rounding);
        all
    }
}
