//! Parts of meshes: their sums are the whole, names are kept, both sides of a pair see the same nodes.

use nastic_mesh::{CellKind, Mesh, MeshError, Part, box_mesh};
use std::collections::BTreeSet;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn parts(mesh: &Mesh, count: usize) -> Result<Vec<Part>, MeshError> {
    let owners = mesh.bisected(count)?;
    (0..count as u32).map(|number| mesh.part(&owners, number)).collect()
}

fn meshes() -> Result<Vec<Mesh>, MeshError> {
    Ok(vec![
        box_mesh([5.0, 1.0, 1.0], [10, 2, 2], CellKind::Hex8)?,
        box_mesh([1.0, 2.0, 1.0], [2, 4, 3], CellKind::Hex27)?,
        box_mesh([1.0, 1.0, 1.0], [3, 3, 3], CellKind::Tet10)?,
    ])
}

#[test]
fn every_cell_and_every_facet_is_in_one_part() -> Outcome {
    for mesh in meshes()? {
        for count in 1..=5 {
            let parts = parts(&mesh, count)?;
            let mut cells: Vec<u32> = parts.iter().flat_map(|part| part.cells()).copied().collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..mesh.cells() as u32).collect::<Vec<_>>());
            let (most, least) =
                (parts.iter().map(|p| p.cells().len()).max(), parts.iter().map(|p| p.cells().len()).min());
            assert!(most.zip(least).is_some_and(|(most, least)| most <= least + 2), "{most:?} {least:?}");
            for name in mesh.surfaces().keys().map(String::as_str).chain(["skin"]) {
                let facets: Result<usize, _> = parts.iter().map(|p| p.mesh().surface(name).map(<[_]>::len)).sum();
                assert_eq!(facets?, mesh.surface(name)?.len(), "{name}");
            }
            for (name, region) in mesh.regions() {
                let own: Result<usize, _> = parts.iter().map(|p| p.mesh().region(name).map(<[_]>::len)).sum();
                assert_eq!(own?, region.len());
            }
        }
    }
    Ok(())
}

#[test]
fn every_node_belongs_to_one_part_and_its_place_is_that_of_the_whole() -> Outcome {
    for mesh in meshes()? {
        for count in 1..=5 {
            let mut owners = vec![0; mesh.points().len()];
            for part in parts(&mesh, count)? {
                part.nodes()[..part.owned()].iter().for_each(|&node| owners[node as usize] += 1);
                for (x, &node) in part.mesh().points().iter().zip(part.nodes()) {
                    assert_eq!(*x, mesh.points()[node as usize]);
                }
                for (local, &cell) in part.cells().iter().enumerate() {
                    let (own, whole) = (part.mesh().cell(local), mesh.cell(cell as usize));
                    let named: Vec<u32> = own.nodes.iter().map(|&node| part.nodes()[node as usize]).collect();
                    assert_eq!((own.kind, &named[..]), (whole.kind, whole.nodes));
                }
            }
            assert!(owners.iter().all(|&owners| owners == 1), "{owners:?}");
        }
    }
    Ok(())
}

#[test]
fn both_sides_of_a_pair_see_the_same_nodes_in_the_same_order() -> Outcome {
    for mesh in meshes()? {
        let parts = parts(&mesh, 4)?;
        for (number, part) in parts.iter().enumerate() {
            for (other, shared) in part.sharers() {
                let of = |part: &Part, nodes: &[u32]| -> Vec<u32> {
                    nodes.iter().map(|&node| part.nodes()[node as usize]).collect()
                };
                let back = parts[*other].sharers().iter().find(|(back, _)| *back == number);
                let back = back.map(|(_, nodes)| of(&parts[*other], nodes));
                assert_eq!(Some(of(part, shared)), back, "{number} {other}");
            }
            let shared: BTreeSet<u32> = part.sharers().iter().flat_map(|(_, nodes)| nodes).copied().collect();
            for (local, node) in part.nodes().iter().enumerate() {
                let holders = parts.iter().filter(|other| other.nodes().contains(node)).count();
                assert_eq!(holders > 1, shared.contains(&(local as u32)), "node {node}");
            }
        }
    }
    Ok(())
}

#[test]
fn nodes_of_a_surface_are_those_of_the_whole_where_its_facets_are_elsewhere() -> Outcome {
    let mesh = box_mesh([1.0, 1.0, 1.0], [3, 3, 3], CellKind::Tet10)?;
    let owners: Vec<u32> = (0..mesh.cells() as u32).map(|cell| cell % 3).collect();
    let mut elsewhere = 0;
    for number in 0..3 {
        let part = mesh.part(&owners, number)?;
        for name in ["x-", "x+", "skin", "y+"] {
            let whole: BTreeSet<u32> = mesh.nodes_of_facets(mesh.surface(name)?).into_iter().collect();
            let nodes = 0..part.nodes().len() as u32;
            let expected: Vec<u32> = nodes.filter(|&node| whole.contains(&part.nodes()[node as usize])).collect();
            assert_eq!(part.nodes_of_surface(name)?, expected, "{name}");
            elsewhere += expected.len() - part.mesh().nodes_of_facets(part.mesh().surface(name)?).len();
        }
        assert!(part.nodes_of_surface("nowhere").is_err());
    }
    assert!(elsewhere > 0, "some tetrahedra touch a surface with an edge alone");
    Ok(())
}

#[test]
fn the_whole_is_remembered() -> Outcome {
    let mesh = box_mesh([5.0, 1.0, 1.0], [10, 2, 2], CellKind::Hex8)?;
    for part in parts(&mesh, 3)? {
        assert_eq!(part.diagonal(), mesh.diagonal());
        assert_eq!(part.piece_bounds(), [mesh.bounds()]);
        assert!(part.mesh().diagonal() < mesh.diagonal());
        assert!(part.pieces().iter().all(|&piece| piece == 0));
    }
    Ok(())
}

#[test]
fn sets_of_nodes_that_parts_have_to_reach_are_in_one_of_them() -> Outcome {
    let mesh = &box_mesh([6.0, 1.0, 1.0], [6, 1, 1], CellKind::Hex8)?;
    let at = |x: f64| (0..mesh.points().len() as u32).filter(move |&node| mesh.points()[node as usize][0] == x);
    // the ends, those of the last part first; the ends and the middle; what the first part has anyway
    let sets = [at(6.0).chain(at(0.0)).collect(), at(0.0).chain(at(6.0)).chain(at(3.0)).collect(), at(0.0).collect()];
    let owners = mesh.bisected(3)?;
    let parts: Vec<Part> = (0..3).map(|k| mesh.part_reaching(&owners, k, &sets)).collect::<Result<_, _>>()?;
    let plain: Vec<Part> = (0..3).map(|k| mesh.part(&owners, k)).collect::<Result<_, _>>()?;
    let further = |part: &Part| -> BTreeSet<u32> {
        part.further_nodes().iter().map(|(node, _)| part.nodes()[*node as usize]).collect()
    };
    assert_eq!(further(&parts[0]), at(3.0).chain(at(6.0)).collect());
    assert_eq!(further(&parts[1]), BTreeSet::new());
    assert_eq!(further(&parts[2]), at(0.0).collect());
    for (part, plain) in parts.iter().zip(&plain) {
        assert_eq!(part.nodes()[..part.owned()], plain.nodes()[..plain.owned()], "they belong where their cells are");
        assert_eq!(part.cells(), plain.cells());
        assert!(part.further_nodes().iter().all(|(node, piece)| *node as usize >= part.owned() && *piece == 0));
        for (node, x) in part.nodes().iter().zip(part.mesh().points()) {
            assert_eq!(*x, mesh.points()[*node as usize]);
        }
        for (other, shared) in part.sharers() {
            let whole = |part: &Part, nodes: &[u32]| -> Vec<u32> {
                nodes.iter().map(|&node| part.nodes()[node as usize]).collect()
            };
            let number = parts.iter().position(|known| known == part);
            let back = parts[*other].sharers().iter().find(|(back, _)| Some(*back) == number);
            assert_eq!(back.map(|(_, nodes)| whole(&parts[*other], nodes)), Some(whole(part, shared)));
            let both = part.nodes().iter().filter(|node| parts[*other].nodes().contains(node)).count();
            assert_eq!(shared.len(), both);
        }
    }
    for wrong in [vec![vec![]], vec![vec![0, 1000]]] {
        assert!(matches!(mesh.part_reaching(&owners, 1, &wrong), Err(MeshError::Part { part: 1, .. })));
    }
    Ok(())
}

#[test]
fn whole_patches_go_to_one_part_each() -> Outcome {
    let mesh = box_mesh([3.0, 1.0, 1.0], [6, 3, 3], CellKind::Tet4)?;
    let (owners, patches) = (mesh.bisected(4)?, mesh.patches());
    let is_cut = |owners: &[u32]| (0..mesh.cells()).any(|cell| owners[cell] != owners[patches[cell] as usize]);
    let whole = mesh.with_whole_patches(&owners)?;
    assert!(is_cut(&owners) && !is_cut(&whole));
    assert_eq!(whole.iter().collect::<BTreeSet<_>>().len(), 4);
    for number in 0..4 {
        let (part, cut) = (mesh.part(&whole, number)?, mesh.part(&owners, number)?);
        for (local, &cell) in part.cells().iter().enumerate() {
            assert_eq!(part.cells()[part.patches()[local] as usize], patches[cell as usize]);
            assert_eq!(part.cuts_patch_of(local as u32), None);
        }
        for (local, &cell) in cut.cells().iter().enumerate() {
            let together = |other: &usize| patches[*other] == patches[cell as usize] && owners[*other] != number;
            let others: BTreeSet<u32> = (0..mesh.cells()).filter(together).map(|other| owners[other]).collect();
            let found = cut.cuts_patch_of(local as u32);
            assert!(found.map_or(others.is_empty(), |other| others.contains(&other)), "{found:?} {others:?}");
        }
    }
    // parts smaller than patches
    let mesh = box_mesh([3.0, 1.0, 1.0], [6, 2, 2], CellKind::Tet4)?;
    let many = mesh.patches().into_iter().collect::<BTreeSet<_>>().len();
    for parts in 2..=many * 3 / 4 {
        let owners = mesh.with_whole_patches(&mesh.bisected(parts)?)?;
        assert_eq!(owners.into_iter().collect::<BTreeSet<_>>().len(), parts, "{many} patches");
    }
    let hexahedra = box_mesh([1.0; 3], [2, 2, 2], CellKind::Hex8)?;
    let owners = hexahedra.bisected(3)?;
    assert_eq!(hexahedra.with_whole_patches(&owners)?, owners);
    assert_eq!(hexahedra.part(&owners, 1)?.patches(), [0, 1, 2]);
    assert!(matches!(mesh.with_whole_patches(&[0]), Err(MeshError::Part { .. })));
    Ok(())
}

#[test]
fn parts_that_are_none_are_refused() -> Outcome {
    let mesh = box_mesh([1.0, 1.0, 1.0], [2, 1, 1], CellKind::Hex8)?;
    for refused in [mesh.bisected(0).map(|_| ()), mesh.bisected(3).map(|_| ())] {
        assert!(matches!(refused, Err(MeshError::Part { .. })));
    }
    assert!(matches!(mesh.part(&[0], 0), Err(MeshError::Part { .. })));
    assert!(matches!(mesh.part(&[0, 0], 1), Err(MeshError::Part { part: 1, .. })));
    Ok(())
}

#[test]
fn every_inner_face_is_within_one_part_or_between_two_once() -> Outcome {
    let mesh = box_mesh([4.0, 2.0, 2.0], [4, 2, 2], CellKind::Hex8)?;
    let owners: Vec<u32> = (0..mesh.cells() as u32).map(|cell| cell % 3).collect();
    let mut faces = Vec::new();
    for number in 0..3 {
        let part = mesh.part(&owners, number)?;
        let whole = |cell: u32| part.cells()[cell as usize];
        faces.extend(part.mesh().neighbours().iter().map(|(a, b)| [whole(a.cell), whole(b.cell)]));
        for (own, behind) in part.outer_faces() {
            assert!(owners[*behind as usize] > number && (part.mesh().area(&[*own]) - 1.0).abs() < 1e-12);
            faces.push([whole(own.cell), *behind]);
        }
    }
    let sorted = |mut faces: Vec<[u32; 2]>| {
        faces.iter_mut().for_each(|pair| pair.sort_unstable());
        faces.sort_unstable();
        faces
    };
    assert_eq!(sorted(faces), sorted(mesh.neighbours().iter().map(|(a, b)| [a.cell, b.cell]).collect()));
    Ok(())
}
