//! A body as the judge sees it: the mesh as lists, its laws and masses, forces at an instant.

use super::elasticity::Cell;
use super::element::Element;
use super::law::Law;
use super::shape::Pose;
use crate::problem::{Chamber, Facts, Problem, Touching, block};
use nastic::fem::Controls;
use nastic::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Forces count as those of this strain at least: what is smaller is rounding.
const LEAST_STRAIN: f64 = 1e-6;

/// A body.
pub struct Scene<'a> {
    pub problem: &'a Problem,
    pub dim: usize,
    pub places: Vec<Vec3>,
    elements: BTreeMap<&'static str, Element>,
    cells: Vec<(Vec<usize>, &'static str, usize)>,
    /// Products of shape functions, by cell, and the shares of the nodes in its volume.
    products: Vec<(Vec<Vec<f64>>, Vec<f64>)>,
}

/// Forces on nodes at an instant.
pub struct Forces {
    pub elastic: f64,
    /// Internal forces plus inertia less loads: what contacts and supports bear.
    pub rest: Vec<Vec3>,
    pub loads: Vec<Vec3>,
    pub inertia: Vec<Vec3>,
    /// Sum of the sizes of the forces of cells.
    pub scale: f64,
}

impl<'a> Scene<'a> {
    pub fn new(problem: &'a Problem) -> Option<Self> {
        let mesh = problem.solid.mesh();
        let mut region = vec![None; mesh.cells()];
        for (index, own) in problem.facts.regions.iter().enumerate() {
            mesh.regions().get(&own.name)?.iter().for_each(|cell| region[*cell as usize] = Some(index));
        }
        let mut elements = BTreeMap::new();
        let mut cells = Vec::new();
        for (id, region) in region.into_iter().enumerate() {
            let cell = mesh.cell(id);
            let name = cell.kind.name();
            if !elements.contains_key(name) {
                elements.insert(name, Element::named(name)?);
            }
            cells.push((cell.nodes.iter().map(|node| *node as usize).collect(), name, region?));
        }
        let places = mesh.points().iter().map(|x| Vec3::from(*x)).collect();
        let mut scene = Scene { problem, dim: mesh.dim(), places, elements, cells, products: Vec::new() };
        scene.products = (0..scene.cells.len()).map(|c| (scene.cell(c).products(), scene.cell(c).shares())).collect();
        Some(scene)
    }

    pub fn facts(&self) -> &'a Facts {
        &self.problem.facts
    }

    pub fn cell(&self, index: usize) -> Cell<'_> {
        let (nodes, element, region) = &self.cells[index];
        let region = &self.problem.facts.regions[*region];
        Cell {
            element: &self.elements[element],
            places: nodes.iter().map(|node| self.places[*node]).collect(),
            law: region.law,
            mean_dilatation: region.mean_dilatation,
        }
    }

    /// Nodes of the cells that are not rigid, with their numbers.
    pub fn soft_cells(&self) -> impl Iterator<Item = (usize, &Vec<usize>)> {
        let facts = self.facts();
        self.cells.iter().enumerate().filter(|(_, cell)| !facts.regions[cell.2].rigid).map(|(c, cell)| (c, &cell.0))
    }

    /// A nodal field of the program.
    pub fn vectors(&self, flat: &[f64]) -> Vec<Vec3> {
        let at = |node: usize| Vec3::from_fn(|i, _| if i < self.dim { flat[self.dim * node + i] } else { 0.0 });
        (0..self.places.len()).map(at).collect()
    }

    pub fn nodes_of(&self, surface: &str) -> BTreeSet<usize> {
        self.facets_of(surface).into_iter().flat_map(|(_, nodes)| nodes).collect()
    }

    /// The nodes of facets with the name of their kind.
    pub fn facets_of(&self, surface: &str) -> Vec<(&'static str, Vec<usize>)> {
        let mesh = self.problem.solid.mesh();
        let facets = mesh.surfaces().get(surface).cloned().unwrap_or_default();
        let of = |facet| {
            let (kind, nodes) = mesh.facet_nodes(facet);
            (kind.name(), nodes.into_iter().map(|node| node as usize).collect())
        };
        facets.into_iter().map(of).collect()
    }

    /// Nodes of a rigid region, one list for each.
    pub fn rigid_nodes(&self) -> Vec<(String, BTreeSet<usize>)> {
        let facts = self.facts();
        let of = |(index, region): (usize, &crate::problem::Region)| {
            let own = self.cells.iter().filter(|cell| cell.2 == index).flat_map(|cell| cell.0.iter().copied());
            (region.name.clone(), own.collect())
        };
        facts.regions.iter().enumerate().filter(|(_, region)| region.rigid).map(of).collect()
    }

    pub fn pose(&self, of: &Touching, controls: &Controls) -> Pose {
        let values = block(&self.problem.solid, &of.name).map(|k| controls.values(k)).unwrap_or_default();
        let vector = |first: usize| Vec3::from_fn(|i, _| values.get(first + i).copied().unwrap_or(0.0));
        Pose::new(of.centre, vector(0), vector(3))
    }

    /// `M v`
    pub fn momentum(&self, v: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); v.len()];
        for ((nodes, _, region), (products, _)) in self.cells.iter().zip(&self.products) {
            let density = self.facts().regions[*region].density;
            for (a, row) in nodes.iter().zip(products) {
                out[*a] += density * nodes.iter().zip(row).map(|(b, p)| v[*b] * *p).sum::<Vec3>();
            }
        }
        out
    }

    /// Of the weight alone.
    pub fn weight(&self) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); self.places.len()];
        for ((nodes, _, region), (_, shares)) in self.cells.iter().zip(&self.products) {
            let density = self.facts().regions[*region].density;
            nodes.iter().zip(shares).for_each(|(a, share)| out[*a] += density * *share * self.facts().gravity);
        }
        out
    }

    pub fn forces(&self, u: &[Vec3], acceleration: Option<&[Vec3]>, pressure: f64) -> Forces {
        let mut elastic = 0.0;
        let (mut rest, mut scale) = (vec![Vec3::zeros(); u.len()], 0.0);
        for (c, nodes) in self.soft_cells() {
            let own: Vec<Vec3> = nodes.iter().map(|node| u[*node]).collect();
            let (energy, forces) = self.cell(c).forces(&own);
            elastic += energy;
            for (node, force) in nodes.iter().zip(forces) {
                rest[*node] += force;
                scale += force.norm();
            }
        }
        let mut loads = self.weight();
        if let Some(chamber) = &self.facts().chamber {
            let pressed = self.pressed(chamber, u);
            loads.iter_mut().zip(pressed).for_each(|(load, by)| *load += pressure * by);
        }
        let inertia = acceleration.map_or_else(|| vec![Vec3::zeros(); u.len()], |a| self.momentum(a));
        scale += loads.iter().chain(&inertia).map(|force| force.norm()).sum::<f64>();
        scale = scale.max(LEAST_STRAIN * self.stiffness());
        for (node, rest) in rest.iter_mut().enumerate() {
            *rest += inertia[node] - loads[node];
        }
        Forces { elastic, rest, loads, inertia, scale }
    }

    /// Vectors of area of the deformed facets of a chamber, outwards of the solid negative: what a unit pressure bears on the nodes.
    fn pressed(&self, chamber: &Chamber, u: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); u.len()];
        self.on_facets(&chamber.surface, u, |nodes, shapes, _, area| {
            nodes.iter().zip(shapes).for_each(|(node, shape)| out[*node] -= area * *shape);
        });
        out
    }

    /// The room that a closed surface encloses, whose normal points into it.
    pub fn room(&self, chamber: &Chamber, u: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        self.on_facets(&chamber.surface, u, |_, _, x, area| sum -= x.dot(&area) / self.dim as f64);
        sum
    }

    /// Calls with nodes, shapes, the place and the vector of area, out of the solid, of every point of a surface.
    fn on_facets(&self, surface: &str, u: &[Vec3], mut call: impl FnMut(&[usize], &[f64], Vec3, Vec3)) {
        for (kind, nodes) in self.facets_of(surface) {
            let Some(element) = Element::named(kind) else { continue };
            let now: Vec<Vec3> = nodes.iter().map(|node| self.places[*node] + u[*node]).collect();
            for point in &element.mass {
                let along = |axis: usize| now.iter().zip(&point.slopes).map(|(x, slope)| x * slope[axis]).sum::<Vec3>();
                let across = if self.dim == 2 { along(0).cross(&Vec3::z()) } else { along(0).cross(&along(1)) };
                let x = now.iter().zip(&point.shapes).map(|(x, shape)| x * *shape).sum();
                call(&nodes, &point.shapes, x, across * point.weight);
            }
        }
    }
}

impl Scene<'_> {
    /// The diagonal of the body.
    pub fn size(&self) -> f64 {
        self.problem.solid.mesh().diagonal()
    }

    /// The moduli of shear and volume times a section.
    fn stiffness(&self) -> f64 {
        let moduli = self.facts().regions.iter().map(|region| match region.law {
            Law::NeoHooke { mu, lambda } => mu + lambda,
            Law::Mooney { a, b, c } => 2.0 * (a + b + c),
        });
        moduli.fold(0.0, f64::max) * self.size().powi(self.dim as i32 - 1)
    }
}
