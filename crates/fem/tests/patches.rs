//! The patches of tet4 and tri3: a partition into connected sets within regions, small ones on every box, and bodies with other formulations beside
//! them.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, distance, largest, noise, regular};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Formulation, Solid, check_contribution};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};

const KINDS: [CellKind; 2] = [CellKind::Tri3, CellKind::Tet4];

/// The same mesh with the cells left and right of x = 1/2 as regions.
fn halves(mesh: &Mesh) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("halves");
    raw.points = mesh.points().to_vec();
    for block in mesh.blocks() {
        for cell in block.iter() {
            let middle = cell.iter().map(|&node| mesh.points()[node as usize][0]).sum::<f64>() / cell.len() as f64;
            raw.push(block.kind, cell, &[if middle < 0.5 { 1 } else { 2 }]);
        }
    }
    raw.name_group(mesh.dim(), 1, "left");
    raw.name_group(mesh.dim(), 2, "right");
    Ok(Mesh::build(raw)?)
}

fn of_mean_dilatation(mesh: Mesh) -> Outcome<Solid> {
    let regions: Vec<String> = mesh.regions().keys().cloned().collect();
    let mut solid = Solid::new(mesh)?;
    for region in regions {
        solid = solid.formulation(region.as_str(), Formulation::MeanDilatation)?;
    }
    Ok(solid)
}

/// Whether cells are connected by facets.
fn connected(mesh: &Mesh, cells: &[u32]) -> bool {
    let inside: BTreeSet<u32> = cells.iter().copied().collect();
    let mut beyond: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (one, other) in mesh.neighbours() {
        beyond.entry(one.cell).or_default().push(other.cell);
        beyond.entry(other.cell).or_default().push(one.cell);
    }
    let mut reached = BTreeSet::from([cells[0]]);
    let mut next = vec![cells[0]];
    while let Some(cell) = next.pop() {
        let new = beyond.get(&cell).into_iter().flatten().filter(|cell| inside.contains(cell));
        next.extend(new.filter(|cell| reached.insert(**cell)));
    }
    reached == inside
}

/// On strips, sheets and blocks, some of two regions: every cell is in one patch, patches are connected, within a region, neither single cells
/// nor large parts of the body.
#[test]
fn patches_divide_every_region_into_small_connected_sets() -> Outcome {
    for (kind, cells) in KINDS
        .into_iter()
        .flat_map(|kind| [[24, 1, 1], [12, 2, 2], [10, 9, 1], [8, 6, 3], [9, 9, 9]].map(|cells| (kind, cells)))
    {
        let whole = regular(kind, [1.0, 0.6, 0.5], cells)?;
        for mesh in [whole.clone(), halves(&whole)?] {
            let solid = of_mean_dilatation(mesh)?;
            let (mesh, patches): (_, Vec<Vec<u32>>) = (solid.mesh(), solid.body().patches().collect());
            let mut all: Vec<u32> = patches.iter().flatten().copied().collect();
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..mesh.cells() as u32), "{kind} {cells:?}");
            let (most, least) = match kind.dim() {
                2 => (16, 2),
                _ => (72, 4),
            };
            for patch in &patches {
                let regions = mesh.regions().values().filter(|of| of.binary_search(&patch[0]).is_ok());
                assert!(regions.clone().count() == 1);
                assert!(
                    regions.flat_map(|of| patch.iter().map(|cell| of.binary_search(cell))).all(|at| at.is_ok()),
                    "{kind} {cells:?}: {patch:?} lies in both regions"
                );
                assert!(connected(mesh, patch), "{kind} {cells:?}: {patch:?}");
                assert!((least..=most).contains(&patch.len()), "{kind} {cells:?}: a patch of {}", patch.len());
            }
        }
    }
    Ok(())
}

/// Patches contain all cells at one of their nodes. Within a regular mesh these are 24 tetrahedra or six triangles, and every fourth or third node has
/// a patch: as many as there can be.
#[test]
fn patches_contain_all_cells_at_a_node() -> Outcome {
    for (kind, n, whole, share) in [(CellKind::Tri3, 24, 6, 3), (CellKind::Tet4, 9, 24, 4)] {
        let solid = of_mean_dilatation(regular(kind, [1.0; 3], [n; 3])?)?;
        let mesh = solid.mesh();
        let mut at_node = vec![0; mesh.points().len()];
        (0..mesh.cells()).for_each(|cell| mesh.cell(cell).nodes.iter().for_each(|&node| at_node[node as usize] += 1));
        let (mut stars, mut others) = (0, 0);
        for patch in solid.body().patches() {
            let mut own: BTreeMap<u32, usize> = BTreeMap::new();
            let nodes = patch.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes);
            nodes.for_each(|&node| *own.entry(node).or_default() += 1);
            let most =
                own.into_iter().filter(|(node, count)| at_node[*node as usize] == *count).map(|(_, count)| count);
            match most.max() {
                Some(count) => stars += usize::from(count == whole),
                None => others += 1,
            }
        }
        let inner = (n - 1_usize).pow(kind.dim() as u32);
        println!(
            "{kind}: {stars} stars of {whole} cells for {inner} inner nodes, {others} patches without a whole star"
        );
        assert!(stars * share >= inner * 9 / 10 && others * 20 < stars, "{kind}: {stars} for {inner}, {others}");
    }
    Ok(())
}

/// Cells of other formulations beside patches: forces of the two regions add up, and are derivatives of a potential. Hexahedra share no patch.
#[test]
fn patches_beside_other_formulations() -> Outcome {
    for kind in KINDS {
        let mesh = halves(&regular(kind, [1.0, 0.6, 0.5], [4, 2, 2])?)?;
        let body = |[left, right]: [Formulation; 2]| -> Outcome<Solid> {
            Ok(Solid::new(mesh.clone())?
                .material("left", MooneyRivlin::new(1e3, 4e2, 8e3)?)?
                .material("right", MooneyRivlin::new(2e3, 1e2, 4e3)?)?
                .formulation("left", left)?
                .actuate("right", "fibre", FiberTension::along(Vec3::new(0.8, 0.6, 0.0))?)?
                .formulation("right", right)?)
        };
        let [mean, standard] = [Formulation::MeanDilatation, Formulation::Standard];
        let force = |formulations| -> Outcome<Vec<f64>> {
            let solid = body(formulations)?;
            let u: Vec<f64> = (0..solid.discretization().dofs()).map(|n| 0.03 * noise(n)).collect();
            let mut controls = solid.controls();
            controls.values_mut(0).iter_mut().enumerate().for_each(|(q, m)| *m = 1e2 * noise(q));
            Ok(solid.body().evaluate(&u, &controls, true, false)?.force)
        };
        let forces = [[mean, standard], [standard, mean], [mean, mean], [standard, standard]].map(force);
        let [left, right, both, none] = forces;
        let (left, right, both, none) = (left?, right?, both?, none?);
        let mixed: Vec<f64> = left.iter().zip(&right).map(|(l, r)| l + r).collect();
        let pure: Vec<f64> = both.iter().zip(&none).map(|(b, n)| b + n).collect();
        assert!(distance(&mixed, &pure) < 1e-12 * largest(&pure), "{kind}: {:e}", distance(&mixed, &pure));
        assert!(distance(&both, &none) > 1e-3 * largest(&none), "{kind}: the formulation changes nothing");
        check_contribution(body([mean, standard])?.model(), "body energy", 3)?;
    }
    let hex = of_mean_dilatation(regular(CellKind::Hex8, [1.0; 3], [2; 3])?)?;
    assert!(hex.body().patches().all(|patch| patch.len() == 1));
    Ok(())
}
