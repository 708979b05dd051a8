//! What a contact takes where it is not given.

use super::ContactLaw;
use super::layer::Settings;
use nalgebra::Matrix6;
use nastic_body::body_energy::BodyEnergy;
use nastic_energy::{PointBatch, Response, Slots, Want};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{Facet, Mesh};
use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

/// Thickness as a share of the surface's diagonal.
const THICKNESS_RATIO: f64 = 1.0 / 500.0;
/// Stiffness over the one that suits the body.
const MAX_STIFFNESS_RATIO: f64 = 1e6;
/// Thickness over the largest coordinate of the surface: positions, and gaps with them, are rounded to 1e-16 of this coordinate.
const MIN_THICKNESS_RATIO: f64 = 1e-9;
/// Pieces of all facets together.
const MAX_PIECES: f64 = 1e7;
/// Pieces of a facet's edge by default.
const MAX_EDGE_PIECES: usize = 4;
/// Pieces of a facet's edge at an obstacle whose edges are sharper than half of it.
const MIN_SHARP_EDGE_PIECES: usize = 2;
/// Least rounding radius, in thicknesses, at which a box touches where its distance has a continuous gradient.
pub(super) const MIN_ROUNDING_RATIO: f64 = 2.0;

/// 1/500 of the diagonal of the surface's bounding box.
pub(super) fn thickness(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let nodes = mesh.nodes_of_facets(facets);
    let points = nodes.iter().map(|&node| Vec3::from(mesh.points()[node as usize]));
    let (low, high) = points.fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(low, high), x| {
        (low.inf(&x), high.sup(&x))
    });
    THICKNESS_RATIO * (high - low).norm()
}

/// By the mean of Young's modulus behind the facets; `None` where no material is stiff.
pub(super) fn stiffness(law: ContactLaw, body: &BodyEnergy, facets: &[Facet]) -> Option<f64> {
    let factor = match law {
        ContactLaw::Cubic => 100.0,
        ContactLaw::Log => 0.1,
    };
    let moduli: Option<Vec<f64>> = {
        let points = body.discretization().points_of_cells();
        let cell = |facet: &Facet| (facet.cell as usize, points[facet.cell as usize].0);
        facets
            .iter()
            .map(|facet| {
                let (cell, first) = cell(facet);
                young(body, cell, first)
            })
            .collect()
    };
    moduli.map(|moduli| factor * moduli.iter().sum::<f64>() / moduli.len() as f64)
}

/// What is wrong with a given stiffness beside that which fits the body.
pub(super) fn check_stiffness(given: Option<f64>, usual: Option<f64>) -> Result<(), String> {
    match (given, usual) {
        (Some(given), Some(usual)) if given > MAX_STIFFNESS_RATIO * usual => Err(format!(
            "a stiffness of {given:e} Pa is {:.0e} times the {usual:e} Pa that fit the body: rounding would leave nothing of its forces; take at most {:e} Pa, or \
             leave it out",
            given / usual,
            MAX_STIFFNESS_RATIO * usual
        )),
        _ => Ok(()),
    }
}

/// What is wrong with a given thickness or refinement on the facets of a surface.
pub(super) fn check_layer(given: &Settings, mesh: &Mesh, facets: &[Facet]) -> Result<(), String> {
    let nodes = mesh.nodes_of_facets(facets);
    let farthest =
        nodes.iter().flat_map(|&node| mesh.points()[node as usize]).fold(0.0, |far: f64, x| far.max(x.abs()));
    match given.thickness {
        Some(given) if !(given > 0.0 && given.is_finite()) => {
            return Err(format!("its thickness is {given}; it must be positive and finite"));
        }
        Some(given) if given < MIN_THICKNESS_RATIO * farthest => {
            return Err(format!(
                "a thickness of {given:e} m is {:.0e} of coordinates up to {farthest:e} m: rounding of positions would decide its forces; take at least {:e} m, or \
                 leave it out",
                given / farthest,
                MIN_THICKNESS_RATIO * farthest
            ));
        }
        _ => {}
    }
    let pieces = |n: usize| (n as f64).powi(mesh.dim() as i32 - 1) * facets.len() as f64;
    match given.refine {
        Some(0) => Err("refine is 0; it is 1 or more".to_owned()),
        Some(n) if pieces(n) > MAX_PIECES => Err(format!(
            "a refine of {n} cuts {} facets into {:.0e} pieces, and {MAX_PIECES:.0e} is the most: take a smaller one, or a finer mesh",
            facets.len(),
            pieces(n)
        )),
        _ => Ok(()),
    }
}

/// The mean over the axes of stress over strain of a bar that is free to contract, at rest, all passive laws of a cell together.
fn young(body: &BodyEnergy, cell: usize, first: usize) -> Option<f64> {
    let rest = [Kinematics::rest()];
    let at = PointBatch { kinematics: &rest, cell, first };
    let mut sum = [Tangent::zero()];
    let want = Want { energy: false, stress: false, tangent: true };
    for term in body.materials_of(cell) {
        let mut response = Response { energy: &mut [], stress: &mut [], tangent: &mut sum };
        term.respond(&at, Slots::none(), want, &mut response);
    }
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    let stiffness = Matrix6::from_fn(|row, column| {
        let ((i, j), (k, l)) = (PAIRS[row], PAIRS[column]);
        let mut strain = Mat3::zeros();
        strain[(k, l)] += 0.5;
        strain[(l, k)] += 0.5;
        sum[0].apply(&strain)[(i, j)]
    });
    let compliance = stiffness.try_inverse()?;
    let mean = (0..3).map(|i| compliance[(i, i)]).sum::<f64>() / 3.0;
    (mean > 0.0 && mean.is_finite()).then_some(1.0 / mean)
}

/// Opposite corners of an obstacle that is not round.
fn bounds(obstacle: &Obstacle) -> Option<([f64; 3], [f64; 3])> {
    match obstacle {
        Obstacle::Box { low, high, .. } => Some((*low, *high)),
        Obstacle::Solid { of, .. } => Some(of.bounds()),
        Obstacle::Grid(grid) => Some(grid.solid().bounds()),
        Obstacle::Sphere { .. } | Obstacle::Capsule { .. } | Obstacle::HalfSpace { .. } => None,
    }
}

/// Half of an obstacle's least width; infinite of a half-space.
fn half_width(obstacle: &Obstacle, dim: usize) -> f64 {
    let least = |(low, high): ([f64; 3], [f64; 3])| (0..dim).map(|i| high[i] - low[i]).fold(f64::INFINITY, f64::min);
    match obstacle {
        Obstacle::Sphere { radius, .. } | Obstacle::Capsule { radius, .. } => *radius,
        _ => bounds(obstacle).map_or(f64::INFINITY, |corners| 0.5 * least(corners)),
    }
}

/// How deep its inside is, as far as that is known: of a grid that of its deepest node, else half of the obstacle's least width.
pub(super) fn half_thickness(obstacle: &Obstacle, dim: usize) -> f64 {
    match obstacle {
        Obstacle::Grid(grid) => grid.deepest(),
        _ => half_width(obstacle, dim),
    }
}

/// Pieces of the longest edge of a facet that are no longer than half of the obstacle's least width; two at least before edges that are rounded by less
/// than half of it, which nodes alone would pass by.
pub(super) fn refine(obstacle: &Obstacle, mesh: &Mesh, facet: &Facet) -> usize {
    let width = half_width(obstacle, mesh.dim());
    let (kind, nodes) = mesh.facet_nodes(*facet);
    let corners: Vec<Vec3> =
        nodes[..kind.corners()].iter().map(|&node| Vec3::from(mesh.points()[node as usize])).collect();
    let next = corners.iter().skip(1).chain(corners.first());
    let longest = corners.iter().zip(next).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
    let sharp = match obstacle {
        Obstacle::Box { rounding, .. } | Obstacle::Solid { rounding, .. } => *rounding < 0.5 * longest,
        _ => false,
    };
    ((longest / width).ceil() as usize).clamp(if sharp { MIN_SHARP_EDGE_PIECES } else { 1 }, MAX_EDGE_PIECES)
}

/// The point about which an obstacle turns.
pub(super) fn centre(obstacle: &Obstacle) -> [f64; 3] {
    let middle = |(a, b): ([f64; 3], [f64; 3])| std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    match obstacle {
        Obstacle::Sphere { center, .. } => *center,
        Obstacle::Capsule { ends: [from, to], .. } => middle((*from, *to)),
        Obstacle::HalfSpace { point, .. } => *point,
        _ => bounds(obstacle).map_or([0.0; 3], middle),
    }
}
