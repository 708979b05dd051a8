//! Thick cylinder (plane strain) and thick sphere under a dead radial load on the inner surface, and a thick sphere with
//! turgor in its inner half, against the ordinary differential equation of their radial equilibrium.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::shells::{Drive, INNER, MIDDLE, OUTER, deformed_radius, radii, ring, shell};
use nastic_energy::{MooneyRivlin, Turgor};
use nastic_fem::{QuadraturePoints, Solid};
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::Vec3;

const MU: [f64; 3] = [1.0, 0.2, 5.0];

fn assert_inflated(mesh: Mesh, inner: &str, p: f64, tolerance: f64) -> Outcome {
    let dim = mesh.dim();
    let facets = mesh.surface(inner)?;
    let sampling = QuadraturePoints::of_facets(&mesh, facets, |kind| kind.rule_of_degree(6));
    let push = |(x, w): ([f64; 3], &f64)| (Vec3::from(x).normalize() * p * *w).as_slice()[..dim].to_vec();
    let values: Vec<f64> = sampling.positions(&mesh, None).into_iter().zip(sampling.weights()).flat_map(push).collect();
    let mut force = vec![0.0; dim * mesh.points().len()];
    sampling.spread(&values, dim, &mut force);
    let mut solid = Solid::new(mesh)?.material("body", MooneyRivlin::new(MU[0], MU[1], MU[2])?)?.nodal_force(&force)?;
    solid = match dim {
        2 => solid.displace("y-", [None, Some(0.0), None])?.displace("y+", [Some(0.0), None, None])?,
        _ => solid
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .displace("z-", [None, None, Some(0.0)])?,
    };
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let [inside, _, outside] = radii(Drive { mu: MU, p, follower: false, m: 0.0 }, dim as i32 - 1);
    let found = (deformed_radius(&solid, &state.u, INNER), deformed_radius(&solid, &state.u, OUTER));
    assert!(inside > 1.15 * INNER, "the load hardly inflates it: {inside}");
    let error = (found.0 - inside).abs().max((found.1 - outside).abs());
    assert!(error < tolerance, "p = {p}: radii {found:?} instead of {:?}", (inside, outside));
    Ok(())
}

#[test]
fn a_thick_cylinder_inflates_as_its_radial_equation_says() -> Outcome {
    for (kind, tolerance) in [(CellKind::Quad8, 5e-7), (CellKind::Quad9, 5e-7), (CellKind::Tri6, 1e-5)] {
        assert_inflated(ring(kind, 8)?, "x-", 1.5, tolerance)?;
    }
    Ok(())
}

#[test]
fn a_thick_sphere_inflates_as_its_radial_equation_says() -> Outcome {
    for (kind, tolerance) in [(CellKind::Hex20, 3e-5), (CellKind::Hex27, 2e-5), (CellKind::Tet10, 3e-4)] {
        assert_inflated(shell(kind, 4)?, "inner", 2.5, tolerance)?;
    }
    Ok(())
}

/// Largest error of the inner, middle and outer radius of a sphere with turgor in its inner half alone.
fn swelling_error(kind: CellKind, cells: usize, m: f64) -> Outcome<f64> {
    let solid = Solid::new(shell(kind, cells)?)?
        .material("body", MooneyRivlin::new(MU[0], MU[1], MU[2])?)?
        .actuate("core", "turgor", Turgor::new())?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(m);
    let state = solid.solve(&controls, &STRICT)?;
    let expected = radii(Drive { mu: MU, p: 0.0, follower: false, m }, 2);
    assert!((expected[1] / MIDDLE - 1.0).abs() > 0.02, "the turgor hardly moves it: {expected:?}");
    let off = |(at, r): (f64, &f64)| (deformed_radius(&solid, &state.u, at) - r).abs();
    Ok([INNER, MIDDLE, OUTER].into_iter().zip(&expected).map(off).fold(0.0, f64::max))
}

#[test]
fn turgor_in_the_inner_half_swells_a_thick_sphere_as_its_radial_equation_says() -> Outcome {
    // Inflated and shrunk. Radii are integrals of the solution and converge with twice the order of the element.
    for m in [3.0, -2.0] {
        for kind in [CellKind::Hex20, CellKind::Hex27] {
            let (coarse, fine) = (swelling_error(kind, 2, m)?, swelling_error(kind, 4, m)?);
            assert!(fine < coarse / 8.0 && fine < 5e-5, "{kind}, m = {m}: errors {coarse:e} and {fine:e}");
        }
    }
    Ok(())
}
