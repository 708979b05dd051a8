//! A very soft filler with a turgor in the place of a cavity: it converges to the cavity as its stiffness goes to zero.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::{NeoHooke, Turgor};
use nastic_fem::{Cavity, Solid};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_numeric::vector::{norm, sub};

/// A box of 4 x 4 x 4 cells (4 x 4 in the plane) whose middle 2 x 2 x 2 is the region "filler", or missing behind the surface "inside". The
/// nodes are numbered alike but for those inside of the filler, which come last.
fn block(kind: CellKind, filled: bool) -> Outcome<(Mesh, usize)> {
    let plane = kind.dim() == 2;
    let full = regular(kind, [1.0, 1.0, if plane { 0.0 } else { 1.0 }], [4, 4, if plane { 1 } else { 4 }])?;
    let within = |x: [f64; 3]| x[..kind.dim()].iter().all(|x| *x > 0.25 + 1e-9 && *x < 0.75 - 1e-9);
    let (inner, outer): (Vec<u32>, Vec<u32>) =
        (0..full.points().len() as u32).partition(|&node| within(full.points()[node as usize]));
    let mut number = vec![0; full.points().len()];
    outer.iter().chain(&inner).zip(0..).for_each(|(&node, new)| number[node as usize] = new);
    let renumber = |nodes: &[u32]| nodes.iter().map(|&node| number[node as usize]).collect::<Vec<u32>>();
    let mut raw = RawMesh::new("filled block");
    let nodes = if filled { full.points().len() } else { outer.len() };
    raw.points = outer.iter().chain(&inner).take(nodes).map(|&node| full.points()[node as usize]).collect();
    raw.name_group(kind.dim(), 1, "wall");
    if filled {
        raw.name_group(kind.dim(), 2, "filler");
    }
    raw.name_group(kind.dim() - 1, 1, "x-");
    raw.name_group(kind.dim() - 1, 2, "inside");
    for cell in 0..full.cells() {
        let (nodes, is_filler) = (full.cell(cell).nodes, within(full.cell_centre(cell)));
        if filled || !is_filler {
            raw.push(kind, &renumber(nodes), &[if is_filler { 2 } else { 1 }]);
        }
        for (face, local) in kind.faces() {
            let nodes: Vec<u32> = local.iter().map(|&a| nodes[a]).collect();
            let on = |at: f64| {
                (0..kind.dim()).any(|k| nodes.iter().all(|&n| (full.points()[n as usize][k] - at).abs() < 1e-9))
            };
            if !filled && is_filler && (on(0.25) || on(0.75)) {
                raw.push(*face, &renumber(&nodes), &[2]);
            }
            if nodes.iter().all(|&n| full.points()[n as usize][0] == 0.0) {
                raw.push(*face, &renumber(&nodes), &[1]);
            }
        }
    }
    Ok((Mesh::build(raw)?, outer.len() * kind.dim()))
}

/// `int J dX` over the filler is the volume of the room, so the turgor's energy is that of the pressure, and all that differs is the
/// energy of the filler, in proportion to its modulus. Prints the numbers of docs/model/equilibrium.md at four moduli.
#[test]
fn a_soft_filler_with_a_turgor_converges_to_a_cavity() -> Outcome {
    let pressure = 0.05;
    for kind in [CellKind::Quad8, CellKind::Hex8] {
        let (mesh, _) = block(kind, false)?;
        let cavity = Solid::new(mesh)?
            .material("wall", NeoHooke::from_young_poisson(1.0, 0.4)?)?
            .clamp("x-")?
            .cavity(Cavity::new("air", "inside"))?;
        let mut controls = cavity.controls();
        controls.values_mut(0)[0] = pressure;
        let exact = cavity.solve(&controls, &STRICT)?;
        let mut errors = Vec::new();
        for ratio in [1e-1, 1e-2, 1e-3, 1e-4] {
            let (mesh, shared) = block(kind, true)?;
            let filled = Solid::new(mesh)?
                .material("wall", NeoHooke::from_young_poisson(1.0, 0.4)?)?
                .material("filler", NeoHooke::from_young_poisson(ratio, 0.0)?)?
                .clamp("x-")?
                .actuate("filler", "air", Turgor::new())?;
            let mut controls = filled.controls();
            controls.values_mut(0).fill(pressure);
            let state = filled.solve(&controls, &STRICT)?;
            errors.push(norm(&sub(&state.u[..shared], &exact.u)) / norm(&exact.u));
            println!(
                "{kind}, filler {ratio:.0e} of the wall: displacement differs by {:.2e}",
                errors[errors.len() - 1]
            );
        }
        assert!(errors[3] < 1e-3, "{kind}: {errors:?}");
        assert!(errors.windows(2).skip(1).all(|pair| (pair[0] / pair[1] - 10.0).abs() < 1.0), "{kind}: {errors:?}");
    }
    Ok(())
}
