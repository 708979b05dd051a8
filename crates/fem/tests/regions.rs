//! Bodies of several materials and kinds of cells: regions, fields by cell and by point, sums of energies.

use crate::common;

use common::block::STRICT;
use common::homogeneous::{mooney_rivlin, neo_hooke, relaxed};
use common::{Outcome, boundary_nodes, distance, nodal, prescribe, regular, unit, with_node_sets};
use nastic_energy::{FiberTension, Field, MooneyRivlin, NeoHooke, TransverseMooneyRivlin, Turgor};
use nastic_fem::{QuadraturePoints, Solid, State};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::{Mat3, Vec3};

/// A grid whose cells belong to "left" or "right" by where their first node is; the halves of the unit block.
fn halves(kind: CellKind) -> Outcome<Mesh> {
    let mesh = unit(kind, 2)?;
    let mut raw = RawMesh::new("halves");
    raw.points = mesh.points().to_vec();
    for block in mesh.blocks() {
        for cell in block.iter() {
            let centre = cell.iter().map(|&node| mesh.points()[node as usize][0]).sum::<f64>() / cell.len() as f64;
            raw.push(kind, cell, &[if centre < 0.5 { 1 } else { 2 }]);
        }
    }
    for (tag, (name, facets)) in (1..).zip(mesh.surfaces()) {
        raw.name_group(mesh.dim() - 1, tag, name);
        for &facet in facets {
            let (kind, nodes) = mesh.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    raw.name_group(mesh.dim(), 1, "left");
    raw.name_group(mesh.dim(), 2, "right");
    Ok(Mesh::build(raw)?)
}

/// Triangles and quadrilaterals side by side, corner on corner: every other grid cell is split.
fn mixed(second_order: bool) -> Outcome<Mesh> {
    let (quad, tri) = if second_order { (CellKind::Quad9, CellKind::Tri6) } else { (CellKind::Quad4, CellKind::Tri3) };
    let (quads, tris) = (unit(quad, 4)?, unit(tri, 4)?);
    let mut raw = RawMesh::new("mixed");
    raw.points = quads.points().to_vec();
    for (n, cell) in quads.blocks()[0].iter().enumerate() {
        if (n + n / 4).is_multiple_of(2) {
            raw.push(quad, cell, &[]);
            continue;
        }
        for triangle in tris.blocks()[0].iter().skip(2 * n).take(2) {
            let at = |&node: &u32| common::node_at(&quads, tris.points()[node as usize]).map(|node| node as u32);
            let nodes: Vec<u32> = triangle.iter().map(at).collect::<Option<_>>().ok_or("grids differ")?;
            raw.push(tri, &nodes, &[]);
        }
    }
    Ok(Mesh::build(raw)?)
}

#[test]
fn a_mesh_of_two_kinds_passes_the_patch_test() -> Outcome {
    let gradient = Mat3::new(0.3, 0.4, 0.0, -0.2, -0.1, 0.0, 0.0, 0.0, 0.0);
    for second_order in [false, true] {
        let mesh = common::distorted(mixed(second_order)?, 0.05)?;
        assert_eq!(mesh.blocks().len(), 2);
        let held = boundary_nodes(&mesh);
        let solid = Solid::new(with_node_sets(&mesh, &held)?)?.material("body", NeoHooke::new(1.0, 3.0)?)?;
        let solid = prescribe(solid, &held, |x| gradient * x)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let error = distance(&state.u, &nodal(solid.mesh(), |x| gradient * x));
        assert!(error < 1e-12, "second order {second_order}: u is off by {error:e}");
    }
    Ok(())
}

/// Two halves of different stuff, one behind the other, pulled along x with their sides held: each has the stretch of
/// its own scalar equation `P_11(l) = t`.
#[test]
fn halves_in_series_stretch_by_their_own_laws() -> Outcome {
    const T: f64 = 1.2;
    for kind in common::kinds() {
        let mut solid = Solid::new(halves(kind)?)?
            .material("left", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
            .material("right", NeoHooke::new(0.7, 2.0)?)?
            .displace("x-", [Some(0.0), None, None])?
            .traction("x+", Vec3::x() * T)?;
        for (n, side) in ["y-", "y+", "z-", "z+"].into_iter().enumerate().take(2 * kind.dim() - 2) {
            let mut held = [None; 3];
            held[1 + n / 2] = Some(0.0);
            solid = solid.displace(side, held)?;
        }
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let stretch = |slope: &dyn Fn(f64) -> f64| {
            let (mut low, mut high) = (0.5, 3.0);
            for _ in 0..100 {
                let l = 0.5 * (low + high);
                if slope(l) < T { low = l } else { high = l }
            }
            low
        };
        let left = stretch(&|l| 2.0 * l + 0.8 * l + 10.0 * (l - 1.0) - 2.8 / l);
        let right = stretch(&|l| 0.7 * (l - 1.0 / l) + 2.0 * (l - 1.0));
        let expected = |x: Vec3| Vec3::x() * ((left - 1.0) * x.x.min(0.5) + (right - 1.0) * (x.x - 0.5).max(0.0));
        let error = distance(&state.u, &nodal(solid.mesh(), expected));
        assert!(error < 1e-11, "{kind}: u is off by {error:e}");
    }
    Ok(())
}

/// Clamped on one side, every control at m.
fn driven(solid: Solid, m: f64) -> Outcome<State> {
    let solid = solid.clamp("x-")?;
    let mut controls = solid.controls();
    for k in 0..controls.len() {
        controls.values_mut(k).fill(m);
    }
    Ok(solid.solve(&controls, &STRICT)?)
}

/// What regions say, fields by cell and by point say as well.
#[test]
fn regions_and_fields_are_two_ways_to_say_the_same() -> Outcome {
    let angled = |left: bool| if left { Vec3::new(0.6, 0.8, 0.0) } else { Vec3::new(0.0, 0.6, 0.8) };
    let mu3 = |left: bool| if left { 3.0 } else { 1.0 };
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Hex27] {
        let bare = Solid::new(halves(kind)?)?;
        let mesh = bare.mesh().clone();
        let is_left: Vec<bool> = (0..mesh.cells() as u32).map(|c| mesh.regions()["left"].contains(&c)).collect();
        let law = |left| TransverseMooneyRivlin::new(1.0, 0.2, mu3(left), 5.0, angled(left));
        let regions = bare
            .clone()
            .material("left", law(true)?)?
            .material("right", law(false)?)?
            .actuate("left", "a", FiberTension::along(angled(false))?)?
            .actuate("right", "b", FiberTension::along(angled(true))?)?;
        let expected = driven(regions, -0.8)?;
        assert!(common::largest(&expected.u) > 0.05);

        let by_cell: Vec<f64> = is_left.iter().map(|&left| mu3(left)).collect();
        let fiber_by_cell: Vec<Vec3> = is_left.iter().map(|&left| angled(left)).collect();
        let law = TransverseMooneyRivlin::new(1.0, 0.2, Field::cells(by_cell), 5.0, Field::cells(fiber_by_cell))?;
        let of_points = bare.discretization().points().cells();
        let tension: Vec<Vec3> = of_points.iter().map(|&cell| angled(!is_left[cell as usize])).collect();
        let tension = FiberTension::along_field(Field::points(tension))?;
        // one material and one actuation on both regions, attached region by region
        let law = std::sync::Arc::new(law);
        let fields = bare
            .clone()
            .material("left", law.clone())?
            .material("right", law)?
            .actuate("left", "a", tension.clone())?
            .actuate("right", "b", tension)?;
        let found = driven(fields, -0.8)?;
        assert!(distance(&found.u, &expected.u) < 1e-12, "{kind}: {:e}", distance(&found.u, &expected.u));
    }
    Ok(())
}

/// Controls outside the region of an actuation are read by nobody.
#[test]
fn an_actuation_acts_in_its_region_alone() -> Outcome {
    let solid = Solid::new(halves(CellKind::Hex8)?)?
        .material("left", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
        .material("right", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
        .actuate("right", "swelling", Turgor::new())?
        .clamp("x-")?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(1.0);
    let state = solid.solve(&controls, &STRICT)?;
    for (value, cell) in controls.values_mut(0).iter_mut().zip(solid.discretization().points().cells()) {
        if solid.mesh().regions()["left"].contains(&cell) {
            *value = 1e9;
        }
    }
    let other = solid.solve(&controls, &STRICT)?;
    assert_eq!(state.u, other.u);
    let lambda = vec![1.0; state.u.len()];
    let pulled = solid.body().control_vjp(&state.u, &controls, &lambda, false)?;
    let idle = pulled.values(0).iter().zip(solid.discretization().points().cells());
    assert!(idle.filter(|(_, cell)| solid.mesh().regions()["left"].contains(cell)).all(|(v, _)| *v == 0.0));
    Ok(())
}

#[test]
fn several_energies_on_one_region_add_up() -> Outcome {
    let (first, second) = (mooney_rivlin([1.0, 0.2, 5.0])?, neo_hooke(0.7, 2.0)?);
    let solid = Solid::new(unit(CellKind::Hex8, 2)?)?
        .material("body", first.law.clone())?
        .material("body", second.law.clone())?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .actuate("body", "turgor", Turgor::new())?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(-1.0);
    controls.values_mut(1).fill(0.6);
    let state = solid.solve(&controls, &STRICT)?;
    let f = relaxed(3, |f| {
        (first.density)(f) + (second.density)(f) + 0.5 * f.column(0).norm_squared() - 0.6 * (f.determinant() - 1.0)
    });
    let error = distance(&state.u, &nodal(solid.mesh(), |x| (f - Mat3::identity()) * x));
    assert!(error < 1e-10, "u is off by {error:e}");
    // the bounds of the laws on the tension add up as well: 2 mu1 + mu
    let bound = solid.body().fiber_limit(0).ok_or("no bound")?;
    assert!((bound - 2.7).abs() < 1e-12, "{bound}");
    Ok(())
}

/// Cells of a curved annulus and their edges: measures converge to the exact ones, and facets know their lengths.
#[test]
fn curved_cells_and_facets_have_their_measures() -> Outcome {
    use std::f64::consts::PI;
    let bend = |[x, y, z]: [f64; 3]| {
        let (r, angle) = (1.0 + x, 0.5 * PI * y);
        [r * angle.cos(), r * angle.sin(), z]
    };
    for (kind, error) in
        [(CellKind::Quad9, 3e-6), (CellKind::Tri6, 3e-6), (CellKind::Hex27, 3e-6), (CellKind::Tet10, 3e-6)]
    {
        let mesh = regular(kind, [1.0; 3], [4, 12, 2])?.mapped(bend)?;
        let all = QuadraturePoints::of_cells(&mesh, 0..mesh.cells() as u32, |kind| kind.rule().clone())?;
        assert!((all.measure() / (0.75 * PI) - 1.0).abs() < error, "{kind}: volume {}", all.measure());
        for (side, exact) in [("x-", 0.5 * PI), ("x+", PI), ("y-", 1.0)] {
            let facets = mesh.surface(side)?;
            let sampling = QuadraturePoints::of_facets(&mesh, facets, |kind| kind.rule().clone());
            assert!((sampling.measure() / exact - 1.0).abs() < error, "{kind} {side}: {}", sampling.measure());
        }
    }
    Ok(())
}
