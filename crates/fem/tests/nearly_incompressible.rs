//! Nearly incompressible bodies: a bar and Cook's membrane with every element and formulation.
//!
//! The tables of docs/development/verification.md:
//! `cargo test --release -p nastic-fem --test all nearly_incompressible -- --ignored --nocapture`

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, node_at};
use nastic_energy::NeoHookeIsochoric;
use nastic_fem::{Formulation, Solid, SolveOptions, Solver, State};
use nastic_mesh::{CellKind, Mesh, box_mesh, rectangle};
use nastic_tensor::Vec3;

/// A kind of cells with a formulation.
type Member = (CellKind, Formulation);

const RATIOS: [f64; 5] = [0.3, 0.45, 0.49, 0.499, 0.4999];

/// Every kind as it is, and with the formulations that it can have.
fn members(dim: usize) -> Vec<Member> {
    let of = |formulation: Formulation| formulation.kinds().iter().map(move |kind| (*kind, formulation));
    Formulation::ALL.into_iter().flat_map(of).filter(|(kind, _)| kind.dim() == dim).collect()
}

/// A body under a load, and where it is looked at: a node and a component.
struct Problem {
    solid: Solid,
    node: usize,
    component: usize,
}

impl Problem {
    fn solve(&self, how: &SolveOptions) -> Outcome<(f64, State)> {
        let state = self.solid.solve(&self.solid.controls(), how)?;
        Ok((state.u[self.solid.mesh().dim() * self.node + self.component], state))
    }

    fn moved(&self) -> Outcome<f64> {
        Ok(self.solve(&SolveOptions::default())?.0)
    }
}

/// 100 x 20 x 10 mm, clamped at one end, with a Young's modulus of 100 kPa and 20 Pa across the other: it moves by 8 mm, by slender theory.
fn bar((kind, formulation): Member, cells: [usize; 3], poisson: f64) -> Outcome<Problem> {
    let size = [0.1, 0.02, 0.01];
    let solid = Solid::new(box_mesh(size, cells, kind)?)?
        .material("body", NeoHookeIsochoric::from_young_poisson(1e5, poisson)?)?
        .formulation("body", formulation)?
        .clamp("x-")?
        .traction("x+", Vec3::new(0.0, 0.0, 20.0))?;
    let node = node_at(solid.mesh(), size).ok_or("no corner")?;
    Ok(Problem { solid, node, component: 2 })
}

/// Cook's membrane of 48 x (44 to 60) mm in plane strain, mu = 80.1938 and kappa = 400889.8 N/mm^2 (1 to 5000), under 100 N/mm up its right
/// side; in space as a sheet of one cell whose faces do not move across.
///
/// Parameters: Simo, Armero, "Geometrically non-linear enhanced strain mixed methods and the method of incompatible modes", IJNME 33 (1992).
fn cook((kind, formulation): Member, n: usize) -> Outcome<Problem> {
    let skew = |x: [f64; 3]| [48.0 * x[0], x[1] * (44.0 - 28.0 * x[0]) + 44.0 * x[0], x[2]];
    let mesh: Mesh = match kind.dim() {
        2 => rectangle([1.0, 1.0], [n, n], kind)?.mapped(skew)?,
        _ => box_mesh([1.0, 1.0, 1.0], [n, n, 1], kind)?.mapped(skew)?,
    };
    let mut solid = Solid::new(mesh)?
        .material("body", NeoHookeIsochoric::new(80.1938, 400_889.8)?)?
        .formulation("body", formulation)?
        .clamp("x-")?
        .traction("x+", Vec3::new(0.0, 100.0 / 16.0, 0.0))?;
    if kind.dim() == 3 {
        solid = solid.displace("z-", [None, None, Some(0.0)])?.displace("z+", [None, None, Some(0.0)])?;
    }
    let node = node_at(solid.mesh(), [48.0, 60.0, 0.0]).ok_or("no corner")?;
    Ok(Problem { solid, node, component: 1 })
}

/// Three meshes of the bar.
fn meshes(kind: CellKind) -> [[usize; 3]; 3] {
    match kind {
        CellKind::Tet4 => [[25, 5, 3], [50, 8, 6], [100, 16, 12]],
        CellKind::Hex8 => [[12, 2, 2], [25, 5, 3], [50, 8, 6]],
        CellKind::Tet10 => [[6, 1, 1], [12, 2, 2], [28, 5, 4]],
        _ => [[6, 1, 1], [12, 2, 2], [24, 4, 3]],
    }
}

/// Deflection of the bar at nu = 0.4999 with 30 x 6 x 4 hex27 and linear dilatation, m (in the tables).
const BAR: f64 = 7.6811e-3;

/// The members for nearly incompressible bodies come within two per cent, where the displacement formulation of hex8
/// has not begun to move.
#[test]
fn the_bar_bends_as_it_should() -> Outcome {
    for member in members(3).into_iter().filter(|(_, formulation)| *formulation != Formulation::Standard) {
        let [_, middle, finest] = meshes(member.0);
        let error = |cells| -> Outcome<f64> { Ok((bar(member, cells, 0.4999)?.moved()? / BAR - 1.0).abs()) };
        let (middle, finest) = (error(middle)?, error(finest)?);
        println!("{} {}: {:.3} % {:.3} %", member.0, member.1, 100.0 * middle, 100.0 * finest);
        assert!(finest < 0.02 && finest < 0.6 * middle, "{member:?}: {middle} {finest}");
    }
    let locked = bar((CellKind::Hex8, Formulation::Standard), [25, 5, 3], 0.4999)?.moved()?;
    assert!(locked < 0.3 * BAR, "{locked}");
    Ok(())
}

/// With 64 x 64 quad9 and linear dilatation, mm.
const COOK: f64 = 6.9312;

#[test]
fn cooks_membrane_moves_as_it_should() -> Outcome {
    for member in members(2).into_iter().chain(members(3)).filter(|(_, f)| *f != Formulation::Standard) {
        let coarse = if member.0.order() == 1 { 16 } else { 8 };
        let error = |n: usize| -> Outcome<f64> { Ok((cook(member, n)?.moved()? / COOK - 1.0).abs()) };
        let (coarse, fine) = (error(coarse)?, error(2 * coarse)?);
        println!("{} {}: {:.3} % {:.3} %", member.0, member.1, 100.0 * coarse, 100.0 * fine);
        assert!(fine < 0.02 && fine < 0.6 * coarse, "{member:?}: {coarse} {fine}");
    }
    Ok(())
}

/// Newton's method where the bulk modulus is ten thousand times the shear modulus; two threads give the bits of one.
#[test]
fn states_are_found_at_ten_thousand_times_the_shear_modulus() -> Outcome {
    let nu = (3e4 - 2.0) / (2.0 * (3e4 + 1.0));
    for member in members(3).into_iter().filter(|(_, formulation)| *formulation != Formulation::Standard) {
        let problem = bar(member, [12, 2, 2], nu)?;
        let (moved, state) = problem.solve(&SolveOptions::default())?;
        assert!(state.report.newton < 30 && state.report.load_steps == 1, "{member:?}: {:?}", state.report);
        assert_eq!(problem.solid.negative_pivots(&state)?, 0, "{member:?}");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build()?;
        let again = pool.install(|| problem.solve(&SolveOptions::default()).map_err(|e| e.to_string()))?.0;
        assert!(moved == again, "{member:?}: {moved} {again}");
    }
    Ok(())
}

#[test]
#[ignore = "prints the tables, in minutes"]
fn tables() -> Outcome {
    let finest = (CellKind::Hex27, Formulation::LinearDilatation);
    for poisson in RATIOS {
        let limit = bar(finest, [30, 6, 4], poisson)?.moved()?;
        println!("bar, nu {poisson}: {:.4} mm", 1e3 * limit);
        for member in members(3) {
            let bars = meshes(member.0).into_iter().map(|cells| bar(member, cells, poisson));
            println!("{}", errors(member, limit, bars)?);
        }
    }
    let limit = cook((CellKind::Quad9, Formulation::LinearDilatation), 64)?.moved()?;
    println!("Cook's membrane: {limit:.4} mm");
    for member in members(2).into_iter().chain(members(3)) {
        let first = if member.0.order() == 1 { 8 } else { 4 };
        println!("{}", errors(member, limit, [1, 2, 4].into_iter().map(|k| cook(member, first * k)))?);
    }
    Ok(())
}

/// Errors of the deflection, and Newton iterations, on finer and finer meshes.
fn errors(member: Member, limit: f64, problems: impl Iterator<Item = Outcome<Problem>>) -> Outcome<String> {
    let mut line = format!("  {} {}:", member.0, member.1);
    for problem in problems {
        let (moved, state) = problem?.solve(&SolveOptions::default())?;
        line += &format!(" {:+.2} % ({})", 100.0 * (moved / limit - 1.0), state.report.newton);
    }
    Ok(line)
}

#[test]
#[ignore = "prints the work of the solvers, in minutes"]
fn solvers() -> Outcome {
    for ratio in [1e0, 1e2, 1e4] {
        let nu = (3.0 * ratio - 2.0) / (2.0 * (3.0 * ratio + 1.0));
        println!("bulk modulus {ratio:e} times the shear modulus");
        for member in members(3) {
            let mut line = format!("  {} {}:", member.0, member.1);
            let cells = if member.0.order() == 1 { [40, 8, 4] } else { [20, 4, 2] };
            let problem = bar(member, cells, nu)?;
            for solver in [Solver::DIRECT, Solver::MULTIGRID] {
                let outcome = problem.solve(&SolveOptions { solver: Some(solver), ..Default::default() });
                line += &match outcome {
                    Ok((_, state)) => {
                        let report = state.report;
                        format!(
                            " {solver}: {} Newton, {} factors, {} substitutions, {} cycles;",
                            report.newton, report.factorisations, report.back_substitutions, report.cycles
                        )
                    }
                    Err(error) => format!(" {solver}: {error};"),
                };
            }
            println!("{line}");
        }
    }
    Ok(())
}

/// A silicone strip of 200 x 10 x 4 mm that is pushed along its axis by five times its buckling load and stays straight. A change of volume by rounding alone is a force
/// of `eps kappa`, 2e-10 of those that it bears or more: no iteration becomes better than that, and each of these steps is by an indefinite tangent.
#[test]
fn a_straight_strip_beyond_buckling_ends_where_rounding_does() -> Outcome {
    let solid = Solid::new(box_mesh([0.2, 0.01, 0.004], [50, 3, 2], CellKind::Hex27)?)?
        .material("body", NeoHookeIsochoric::new(3e5, 3e8)?)?
        .formulation("body", Formulation::LinearDilatation)?
        .clamp("x-")?
        .traction("x+", Vec3::new(-500.0, 0.0, 0.0))?;
    let state = solid.solve(&solid.controls(), &SolveOptions { budget: Some(40), ..SolveOptions::default() })?;
    assert!(state.report.newton <= 12 && state.report.cuts == 0, "{} iterations", state.report.newton);
    assert!(state.report.residual < 1e-9, "residual {:.1e}", state.report.residual);
    assert_eq!(solid.negative_pivots(&state)?, 2);
    let aside = state.u.chunks_exact(3).map(|u| u[2].abs()).fold(0.0, f64::max);
    assert!(aside < 1e-6, "it went {aside:.1e} m aside");
    Ok(())
}
