//! [`Recovery`]: means of what presses on surfaces over their facets.

use crate::contact::samples::{pieces, rule};
use nastic_body::error::FemError;
use nastic_mesh::{GroupNames, Mesh};
use std::collections::BTreeMap;

/// From loads of the corners of facets of some surfaces, `L_c = int p Phi_c dA`, to pressures there:
///
/// ```text
/// P_c = L_c/A_c,                           a_fc = int_f Phi_c dA,  A_c = sum_f a_fc          of facets of first order
/// P_c = (1/A_c) sum_f a_fc P_f,            P_f = (1/A_f) sum_c a_fc L_c/A_c,  A_f = sum_c a_fc   of second order
/// ```
///
/// `Phi_c` is 1 at the corner c and linear (bilinear) on its facets f. It is a displacement of facets of either order, so that a uniform stress gives its own
/// pressure; the load of a single node would not do, which for a uniform pressure is zero (tri6) or negative (quad8) at a corner. The mean over facets of second order
/// takes out what alternates between their corners and middles. `sum_c A_c P_c = sum_c L_c`.
#[derive(Debug)]
pub(super) struct Recovery {
    /// Of every node of the surfaces the corners between which it is, and its shares of these.
    shares: BTreeMap<u32, Vec<(usize, f64)>>,
    /// `A_c`, m^2; per unit of thickness in plane strain.
    pub areas: Vec<f64>,
    /// Of every corner c the d and factors with `A_c P_c = sum_d m_cd L_d/A_d`: symmetric, with the sum `A_c`.
    means: Vec<Vec<(usize, f64)>>,
}

impl Recovery {
    pub fn new(mesh: &Mesh, surfaces: [&GroupNames; 2]) -> Result<Self, FemError> {
        // a facet that is of both counts once
        let union: Vec<String> = surfaces.iter().flat_map(|names| names.iter()).map(str::to_owned).collect();
        let (mut corners, mut shares) = (BTreeMap::new(), BTreeMap::new());
        let mut of_facets = Vec::new();
        for facet in mesh.facets_of(&union.into())? {
            let (kind, nodes) = mesh.facet_nodes(facet);
            let (corner_kind, count) = (kind.corner_kind(), kind.corners());
            let mut shapes = vec![0.0; count];
            let mut number = |corner: u32| {
                let next = corners.len();
                *corners.entry(corner).or_insert(next)
            };
            let own: Vec<usize> = nodes[..count].iter().map(|&corner| number(corner)).collect();
            for (&node, xi) in nodes.iter().zip(kind.reference_nodes()) {
                corner_kind.shapes(xi, &mut shapes);
                let of_node = own.iter().copied().zip(shapes.iter().copied()).filter(|(_, share)| *share > 0.0);
                shares.insert(node, of_node.collect::<Vec<_>>());
            }
            let (positions, mut areas) = (mesh.gather(mesh.points(), &nodes), vec![0.0; count]);
            for (xi, weight) in pieces(kind, 1).iter().flat_map(|piece| rule(kind, &positions, piece)) {
                corner_kind.shapes(&xi, &mut shapes);
                areas.iter_mut().zip(&shapes).for_each(|(area, shape)| *area += weight * shape);
            }
            of_facets.push((kind.order(), own.into_iter().zip(areas).collect()));
        }
        let (areas, means) = means(&of_facets, corners.len());
        Ok(Recovery { shares, areas, means })
    }

    /// The corners between which a node is, and its shares of these.
    pub fn of(&self, node: u32) -> &[(usize, f64)] {
        self.shares.get(&node).map_or(&[], Vec::as_slice)
    }

    /// Which corner a node is.
    pub fn corner(&self, node: u32) -> Option<usize> {
        match self.of(node) {
            [(corner, _)] => Some(*corner),
            _ => None,
        }
    }

    /// The value at a node of what corners have.
    pub fn at(&self, node: u32, of_corners: &[f64]) -> f64 {
        self.of(node).iter().map(|&(corner, share)| share * of_corners[corner]).sum()
    }

    /// Of every node the value of what corners have.
    pub fn at_nodes(&self, of_corners: &[f64]) -> Vec<(u32, f64)> {
        self.shares.keys().map(|&node| (node, self.at(node, of_corners))).collect()
    }

    /// Pressures by loads. The same map takes derivatives by pressures to those by loads.
    pub fn pressures(&self, loads: &[f64]) -> Vec<f64> {
        let of_corner = |(mean, area): (&Vec<(usize, f64)>, &f64)| {
            mean.iter().map(|&(corner, part)| part * loads[corner] / self.areas[corner]).sum::<f64>() / area
        };
        self.means.iter().zip(&self.areas).map(of_corner).collect()
    }
}

/// `A_c` and `m_cd`, by the order of every facet and its corners with their `a_fc`.
fn means(of_facets: &[(usize, Vec<(usize, f64)>)], corners: usize) -> (Vec<f64>, Vec<Vec<(usize, f64)>>) {
    let (mut areas, mut rows) = (vec![0.0; corners], vec![BTreeMap::new(); corners]);
    for (order, of_facet) in of_facets {
        let whole: f64 = of_facet.iter().map(|(_, area)| area).sum();
        for &(c, of_c) in of_facet {
            areas[c] += of_c;
            if *order == 1 {
                *rows[c].entry(c).or_insert(0.0) += of_c;
            } else {
                of_facet.iter().for_each(|&(d, of_d)| *rows[c].entry(d).or_insert(0.0) += of_c * of_d / whole);
            }
        }
    }
    (areas, rows.into_iter().map(|row| row.into_iter().collect()).collect())
}
