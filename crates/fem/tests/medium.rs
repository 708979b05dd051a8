//! A medium of voids: zero where cells deform affinely, and contact through it.

use crate::common;

use common::block::STRICT;
use common::{Outcome, kinds, node_at, regular, unit};
use nastic_energy::NeoHookeIsochoric;
use nastic_fem::{Instant, Medium, Solid, SolveOptions, State};
use nastic_mesh::{CellKind, Mesh};

/// The energy of a medium at a displacement.
fn energy(solid: &Solid, u: &[f64]) -> Outcome<f64> {
    let all = solid.model().quantities(&Instant::new(u, &solid.controls(), 0.0))?;
    Ok(all
        .into_iter()
        .find(|(name, what, _)| (name.as_str(), *what) == ("void", "energy"))
        .map_or(f64::NAN, |own| own.2))
}

#[test]
fn affine_deformations_are_free_and_folds_are_not() -> Outcome {
    for kind in kinds() {
        let dim = kind.dim();
        let solid = Solid::new(unit(kind, 1)?)?
            .material("body", NeoHookeIsochoric::new(1.0, 3.0)?)?
            .medium(Medium::over("void", "body", 5.0))?;
        let of = |u: &dyn Fn([f64; 3]) -> [f64; 3]| -> Vec<f64> {
            solid.mesh().points().iter().flat_map(|x| u(*x)[..dim].to_vec()).collect()
        };
        let affine = of(&|x| [0.3 * x[0] - 0.2 * x[1], 0.1 * x[0] + 0.4 * x[1], 0.2 * x[1]]);
        assert!(energy(&solid, &affine)?.abs() < 1e-14, "{kind}");
        // u_1 = x y: grad u_1 = (y, x), whose variance over the unit square or cube is 2/12; of simplices over each cell
        let bilinear = energy(&solid, &of(&|x| [x[0] * x[1], 0.0, 0.0]))?;
        let expected = 5.0 / 2.0 / 6.0;
        let is_whole = matches!(kind.corner_kind(), CellKind::Quad4 | CellKind::Hex8);
        if matches!(kind, CellKind::Tri3 | CellKind::Tet4) {
            // each half of a square differs from the mean of both, or the sixth of a cube from that of its patch
            assert!(bilinear > 0.1 * expected, "{kind}: {bilinear}");
            continue;
        }
        assert!(
            if is_whole { (bilinear - expected).abs() < 1e-13 } else { bilinear > 0.1 * expected },
            "{kind}: {bilinear}"
        );
    }
    let negative = Solid::new(unit(CellKind::Quad4, 1)?)?.medium(Medium::over("void", "body", 0.0));
    assert!(negative.is_err_and(|error| error.to_string().contains("must be positive")));
    Ok(())
}

/// Bulk modulus of the body; its shear modulus is 5/14.
const BULK: f64 = 5.0 / 3.0;
/// What is left of the law in the void.
const LEAST: f64 = 2e-6;

/// A C of 1 by 0.5 with arms 0.1 thick, in cells of 0.1/n, and a void inside it and one column of cells behind its mouth.
fn c_of(kind: CellKind, n: usize) -> Outcome<Mesh> {
    let mesh = regular(kind, [1.1, 0.5, 0.0], [11 * n, 5 * n, 1])?;
    let in_arm = |x: [f64; 2]| x[0] < 1.0 && (x[0] < 0.1 || x[1] < 0.1 || x[1] > 0.4);
    let middle = |cell: usize| {
        let own = mesh.gather(mesh.points(), mesh.cell(cell).nodes);
        [0, 1].map(|i| own.iter().map(|x| x[i]).sum::<f64>() / own.len() as f64)
    };
    let (arms, void) = (0..mesh.cells() as u32).partition::<Vec<u32>, _>(|cell| in_arm(middle(*cell as usize)));
    Ok(mesh.with_region("arms", arms).with_region("inside", void))
}

/// Stiffness of the medium: 2e-6 K (L/h)^2 12 for cells of h = L/10, the weight 2e-6 K L^2 of a second gradient.
const STIFFNESS: f64 = 1200.0 * LEAST * BULK;

/// The C with its corner pressed down by d.
fn pressed(mesh: &Mesh, d: f64) -> Outcome<Solid> {
    let law = |scale: f64| NeoHookeIsochoric::new(scale * 5.0 / 14.0, scale * BULK);
    let corner = node_at(mesh, [1.0, 0.5, 0.0]).ok_or("no corner")? as u32;
    Ok(Solid::new(mesh.clone())?
        .material("arms", law(1.0)?)?
        .material("inside", law(LEAST)?)?
        .medium(Medium::over("void", "inside", STIFFNESS))?
        .clamp("x-")?
        .displace_nodes("corner", &[corner], |_, _| [None, Some(-d), None])?)
}

/// The force on the corner.
fn force(solid: &Solid, state: &State) -> Outcome<f64> {
    let all = solid.reactions(None, state)?;
    Ok(all.iter().find(|own| own.0 == "corner").map_or(f64::NAN, |own| -own.1[1]))
}

/// The arms meet at d = 0.35, and the lower one gives way; the gap stays open, the medium carries little, and the forces of two meshes are close.
#[test]
fn arms_of_a_c_meet_through_the_void() -> Outcome {
    let (mut forces, mut shares) = (Vec::new(), Vec::new());
    for n in [1, 2] {
        let mesh = c_of(CellKind::Quad9, n)?;
        let node = |at: [f64; 3]| node_at(&mesh, at).ok_or("no node");
        let (upper, lower) = (node([1.0, 0.4, 0.0])?, node([1.0, 0.1, 0.0])?);
        let (mut guess, mut reached, mut share) = (vec![0.0; 2 * mesh.points().len()], 0.0, 0.0);
        for k in 1..=20 {
            let d = 0.025 * f64::from(k);
            let solid = pressed(&mesh, d)?;
            let state = solid.solve(&solid.controls(), &SolveOptions { guess: Some(&guess), ..STRICT })?;
            let (gap, lowered) = (0.3 + state.u[2 * upper + 1] - state.u[2 * lower + 1], -state.u[2 * lower + 1]);
            assert!(gap > 0.01 && state.report.min_j > 0.0, "{n}, {d}: {gap}");
            assert!(if k <= 12 { lowered < 0.035 } else { k == 13 || lowered > 0.045 }, "{n}, {d}: {lowered}");
            (guess, reached) = (state.u.to_vec(), force(&solid, &state)?);
            share = energy(&solid, &state.u)? / state.report.energy;
        }
        forces.push(reached);
        shares.push(share);
    }
    assert!((forces[1] / forces[0] - 1.0).abs() < 0.05, "{forces:?}");
    assert!(shares[0] < 0.05 && shares[1] < 0.5 * shares[0], "{shares:?}");
    Ok(())
}

/// On linear triangles, whose patches of cells the medium holds together: the arms meet as on quadratic cells, with the force as the derivative of the energy.
#[test]
fn arms_meet_through_a_void_of_linear_triangles() -> Outcome {
    let mesh = c_of(CellKind::Tri3, 3)?;
    let node = |at: [f64; 3]| node_at(&mesh, at).ok_or("no node");
    let (upper, lower) = (node([1.0, 0.4, 0.0])?, node([1.0, 0.1, 0.0])?);
    let mut guess = vec![0.0; 2 * mesh.points().len()];
    let mut at = |d: f64| -> Outcome<(State, f64)> {
        let solid = pressed(&mesh, d)?;
        let state = solid.solve(&solid.controls(), &SolveOptions { guess: Some(&guess), ..STRICT })?;
        guess = state.u.to_vec();
        let force = force(&solid, &state)?;
        Ok((state, force))
    };
    for k in 1..=20 {
        let d = 0.025 * f64::from(k);
        let (state, _) = at(d)?;
        let (gap, lowered) = (0.3 + state.u[2 * upper + 1] - state.u[2 * lower + 1], -state.u[2 * lower + 1]);
        assert!(gap > 0.005 && state.report.min_j > 0.0, "{d}: {gap}");
        assert!(if k <= 12 { lowered < 0.035 } else { k <= 14 || lowered > 0.04 }, "{d}: {lowered}");
    }
    let (h, d) = (1e-4, 0.45);
    let ((less, _), (_, force), (more, _)) = (at(d - h)?, at(d)?, at(d + h)?);
    let slope = (more.report.energy - less.report.energy) / (2.0 * h);
    assert!((slope / force - 1.0).abs() < 1e-6, "{slope:e} {force:e}");
    Ok(())
}

/// The force is the derivative of the energy after the arms have met.
#[test]
fn forces_through_the_void_balance_the_energy() -> Outcome {
    let mesh = c_of(CellKind::Quad9, 1)?;
    let mut guess = vec![0.0; 2 * mesh.points().len()];
    for k in 1..=16 {
        let solid = pressed(&mesh, 0.025 * f64::from(k))?;
        guess = solid.solve(&solid.controls(), &SolveOptions { guess: Some(&guess), ..STRICT })?.u.to_vec();
    }
    let at = |d: f64| -> Outcome<[f64; 2]> {
        let solid = pressed(&mesh, d)?;
        let state = solid.solve(&solid.controls(), &SolveOptions { guess: Some(&guess), ..STRICT })?;
        Ok([state.report.energy, force(&solid, &state)?])
    };
    let (h, d) = (1e-4, 0.4);
    let ([less, _], [_, force], [more, _]) = (at(d - h)?, at(d)?, at(d + h)?);
    let slope = (more - less) / (2.0 * h);
    assert!((slope / force - 1.0).abs() < 1e-6, "{slope:e} {force:e}");
    Ok(())
}
