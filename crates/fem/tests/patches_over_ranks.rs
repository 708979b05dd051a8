//! Formulations over patches of cells in bodies over ranks, which are threads here: the patches, energies, equilibria and derivatives of one process.

use crate::common;

use common::parts::{how, on, valued};
use common::{Outcome, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Demand, FemError, Formulation, Instant, Solid, SolveOptions};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_team::Team;
use nastic_team::threads::{Faults, ThreadRank};
use nastic_tensor::Vec3;
use std::sync::Arc;

/// A bar of two regions, in patches near its support alone, in patches of its own far from it.
fn bar(kind: CellKind) -> Outcome<Mesh> {
    let box_of = regular(kind, [1.0, 0.3, 0.3], if kind.dim() == 2 { [16, 6, 1] } else { [7, 3, 3] })?;
    let mut raw = RawMesh::new("bar");
    raw.points = box_of.points().to_vec();
    for block in box_of.blocks() {
        for cell in block.iter() {
            let middle = cell.iter().map(|&node| box_of.points()[node as usize][0]).sum::<f64>() / cell.len() as f64;
            raw.push(block.kind, cell, &[if middle < 0.4 { 1 } else { 2 }]);
        }
    }
    for (tag, (name, facets)) in (1..).zip(box_of.surfaces()) {
        raw.name_group(kind.dim() - 1, tag, name);
        for &facet in facets {
            let (kind, nodes) = box_of.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    raw.name_group(kind.dim(), 1, "near");
    raw.name_group(kind.dim(), 2, "far");
    Ok(Mesh::build(raw)?)
}

fn body(solid: Solid, patches: &[&str]) -> Outcome<Solid> {
    let mut solid = solid
        .material(["near", "far"], NeoHooke::new(1e5, 5e6)?)?
        .actuate(["near", "far"], "tension", FiberTension::along(Vec3::x())?)?
        .traction("x+", Vec3::new(0.0, -1e3, 0.0))?
        .clamp("x-")?;
    for region in patches {
        solid = solid.formulation(*region, Formulation::MeanDilatation)?;
    }
    Ok(solid)
}

fn whole_patches(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Solid> {
    let owners = mesh.with_whole_patches(&mesh.bisected(rank.size())?)?;
    Ok(Solid::of_part(mesh.part(&owners, rank.rank() as u32)?, rank.clone())?)
}

/// A displacement of every node by its place.
fn bent(mesh: &Mesh) -> Vec<f64> {
    let of = |x: &[f64; 3]| [0.02 * x[0] * x[1] + 0.01 * (9.0 * x[0]).sin(), 0.1 * x[0] * x[0], 0.05 * x[0] * x[2]];
    mesh.points().iter().flat_map(|x| of(x).into_iter().take(mesh.dim())).collect()
}

/// Energy and force there, and the patches by the numbers of the whole.
fn displaced(solid: &Solid) -> Outcome<(f64, Vec<f64>, Vec<Vec<u32>>)> {
    let (u, controls) = (bent(solid.mesh()), solid.controls());
    let sums = solid.model().evaluate(&Instant::new(&u, &controls, 1.0), Demand { energy: true, force: true })?;
    let part = solid.discretization().over_ranks().map(|(part, _)| part);
    let whole = |cell: &u32| part.map_or(*cell, |part| part.cells()[*cell as usize]);
    let patches = solid.body().patches().map(|patch| patch.iter().map(whole).collect()).collect();
    Ok((sums.energy, sums.force, patches))
}

const CASES: [(CellKind, &[&str]); 3] =
    [(CellKind::Tet4, &["near", "far"]), (CellKind::Tet4, &["far"]), (CellKind::Tri3, &["near", "far"])];

#[test]
fn patches_and_energies_are_those_of_one_process() -> Outcome {
    for (kind, regions) in CASES {
        let mesh = bar(kind)?;
        let (energy, force, mut patches) = displaced(&body(Solid::new(mesh.clone())?, regions)?)?;
        assert!(patches.iter().any(|patch| patch.len() > 1) && energy > 0.0);
        patches.sort_unstable();
        for ranks in [1, 2, 3, 5] {
            let found = on(ranks, &Faults::default(), |rank| {
                let solid = body(whole_patches(&mesh, &rank)?, regions)?;
                let nodes = solid.discretization().over_ranks().map(|(part, _)| part.nodes().to_vec());
                Ok((displaced(&solid)?, nodes.unwrap_or_default()))
            });
            let (mut all, size) = (Vec::new(), force.iter().fold(0.0_f64, |most, f| most.max(f.abs())));
            for found in found {
                let ((own, own_force, own_patches), nodes) = found?;
                assert!((own - energy).abs() < 1e-12 * energy, "{kind} on {ranks}: {own:e} {energy:e}");
                for (forces, node) in own_force.chunks_exact(mesh.dim()).zip(nodes) {
                    let whole = &force[mesh.dim() * node as usize..];
                    assert!(forces.iter().zip(whole).all(|(a, b)| (a - b).abs() < 1e-11 * size), "{kind} on {ranks}");
                }
                all.extend(own_patches);
            }
            all.sort_unstable();
            assert_eq!(all, patches, "{kind} on {ranks}");
        }
    }
    Ok(())
}

#[test]
fn equilibria_and_derivatives_over_patches_are_those_of_one_process() -> Outcome {
    for (kind, regions) in CASES {
        let mesh = bar(kind)?;
        let serial = body(Solid::new(mesh.clone())?, regions)?;
        let (j, slope, _, expected) = valued(&serial, -1e3, &SolveOptions::default())?;
        let size = expected.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        for ranks in [1, 2, 3, 5] {
            let found = on(ranks, &Faults::default(), |rank| {
                let solid = body(whole_patches(&mesh, &rank)?, regions)?;
                let nodes = solid.discretization().over_ranks().map(|(part, _)| part.nodes().to_vec());
                let here = valued(&solid, -1e3, &how())?;
                let [far, near] = [2e2, 1e2].map(|step| valued(&solid, -1e3 + step, &how()));
                Ok((here, [far?.0, near?.0], nodes.unwrap_or_default()))
            });
            for found in found {
                let ((own, own_slope, _, u), [far, near], nodes) = found?;
                assert!((own - j).abs() < 1e-9 * j, "{kind} on {ranks}: {own:e} {j:e}");
                assert!((own_slope - slope).abs() < 1e-8 * slope.abs(), "{kind} on {ranks}: {own_slope:e} {slope:e}");
                let order = ((far - own - 2e2 * own_slope) / (near - own - 1e2 * own_slope)).log2();
                assert!(order > 1.95, "{kind} on {ranks}: Taylor remainders of order {order}");
                for (u, node) in u.chunks_exact(mesh.dim()).zip(nodes) {
                    let whole = &expected[mesh.dim() * node as usize..];
                    assert!(u.iter().zip(whole).all(|(a, b)| (a - b).abs() < 1e-9 * size), "{kind} on {ranks}");
                }
            }
        }
    }
    Ok(())
}

#[test]
fn patches_that_parts_cut_are_refused_by_all_ranks() -> Outcome {
    let mesh = bar(CellKind::Tet4)?;
    let owners = mesh.with_whole_patches(&mesh.bisected(3)?)?;
    // a cell of a patch of the first rank goes to the second one
    let patches = mesh.patches();
    let taken = (0..mesh.cells()).rev().find(|&cell| owners[cell] == 0 && patches[cell] as usize != cell);
    let taken = taken.ok_or("no patch of several cells")?;
    let cut: Vec<u32> = (0..mesh.cells()).map(|cell| if cell == taken { 1 } else { owners[cell] }).collect();
    let found = on(3, &Faults::default(), |rank| {
        let solid = Solid::of_part(mesh.part(&cut, rank.rank() as u32)?, rank.clone())?;
        let refused = |region: &str| match solid.clone().formulation(region, Formulation::MeanDilatation) {
            Err(FemError::Unsupported { what, with, why }) => format!("{what} {with} {why}"),
            Err(error) => error.to_string(),
            Ok(_) => "nothing".to_owned(),
        };
        let region = if mesh.region("near")?.contains(&(taken as u32)) { ["near", "far"] } else { ["far", "near"] };
        Ok(region.map(refused))
    });
    for (rank, found) in found.into_iter().enumerate() {
        let [cut, whole] = found?;
        let named = match rank {
            0 | 1 => cut.contains("ranks 0 and 1") || cut.contains("ranks 1 and 0"),
            _ => cut == FemError::Elsewhere.to_string(),
        };
        assert!(named && (rank == 2 || cut.contains("with_whole_patches") && cut.contains("tet4")), "{rank}: {cut}");
        assert_eq!(whole, "nothing", "the other region has whole patches");
    }
    Ok(())
}
