//! Thick cylinder (plane strain) and thick sphere under a dead radial load on the inner surface, and a thick sphere with
//! turgor in its inner half, against the ordinary differential equation of their radial equilibrium.

mod common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::{MooneyRivlin, Turgor};
use nastic_fem::{QuadraturePoints, Solid};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

const MU: [f64; 3] = [1.0, 0.2, 5.0];
const INNER: f64 = 1.0;
const OUTER: f64 = 2.0;
/// Where the inner half ends.
const MIDDLE: f64 = 1.5;

/// What drives a shell: a load `p` on its inner surface, a turgor `m` inside `MIDDLE`.
#[derive(Clone, Copy)]
struct Drive {
    p: f64,
    m: f64,
}

/// Radial and hoop stress at the stretches `r' = a` and `r/R = b`, for `b` in one direction (cylinder) or two (sphere),
/// under a turgor.
fn stresses(a: f64, b: f64, hoops: i32, turgor: f64) -> (f64, f64) {
    let [mu1, mu2, mu3] = MU;
    let c = if hoops == 1 { 1.0 } else { b };
    // |F|^2 = a^2 + b^2 + c^2, |H|^2 = a^2 b^2 + b^2 c^2 + c^2 a^2, J = a b c
    let volumetric = 2.0 * mu3 * (a * b * c - 1.0) - turgor;
    let log = 2.0 * (mu1 + 2.0 * mu2);
    let radial = 2.0 * mu1 * a + 2.0 * mu2 * a * (b * b + c * c) + volumetric * b * c - log / a;
    let hoop = 2.0 * mu1 * b + 2.0 * mu2 * b * (a * a + c * c) + volumetric * a * c - log / b;
    (radial, hoop)
}

/// `r(R)` at the middle and the outer radius and the stress at the latter, from `r(R_i)` and the stress `-p` at the
/// inner one: `P_R' = n (P_hoop - P_R) / R`, Runge-Kutta of fourth order. `r` and `P_R` are continuous where the turgor
/// ends, `r'` is not.
fn shoot(inner: f64, drive: Drive, hoops: i32) -> [f64; 3] {
    const STEPS: usize = 200;
    let h = (OUTER - INNER) / STEPS as f64;
    let (mut r, mut stress, mut middle) = (inner, -drive.p, f64::NAN);
    for n in 0..STEPS {
        let x = INNER + n as f64 * h;
        // the middle is the end of a step
        let turgor = if x + h / 2.0 < MIDDLE { drive.m } else { 0.0 };
        if n == STEPS / 2 {
            middle = r;
        }
        let slope = |big_r: f64, r: f64, stress: f64| {
            let b = r / big_r;
            let (mut low, mut high) = (1e-3, 10.0);
            for _ in 0..60 {
                let a = 0.5 * (low + high);
                if stresses(a, b, hoops, turgor).0 < stress { low = a } else { high = a }
            }
            (low, f64::from(hoops) * (stresses(low, b, hoops, turgor).1 - stress) / big_r)
        };
        let k1 = slope(x, r, stress);
        let k2 = slope(x + h / 2.0, r + h / 2.0 * k1.0, stress + h / 2.0 * k1.1);
        let k3 = slope(x + h / 2.0, r + h / 2.0 * k2.0, stress + h / 2.0 * k2.1);
        let k4 = slope(x + h, r + h * k3.0, stress + h * k3.1);
        r += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        stress += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
    }
    [middle, r, stress]
}

/// Inner, middle and outer radius: the one inner radius that leaves the outer surface free.
fn radii(drive: Drive, hoops: i32) -> [f64; 3] {
    let (mut low, mut high) = (0.5 * INNER, 2.0 * INNER);
    for _ in 0..50 {
        let inner = 0.5 * (low + high);
        if shoot(inner, drive, hoops)[2] < 0.0 { low = inner } else { high = inner }
    }
    let [middle, outer, _] = shoot(low, drive, hoops);
    [low, middle, outer]
}

/// A quarter of a ring; "inner" is its side x-.
fn ring(kind: CellKind, cells: usize) -> Outcome<Mesh> {
    Ok(regular(kind, [1.0; 3], [cells, 2 * cells, 1])?.mapped(|[x, y, _]| {
        let (r, angle) = (INNER + (OUTER - INNER) * x, 0.5 * PI * y);
        // exactly on the axes, so that rollers hold what they should
        [if y == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
    })?)
}

/// An eighth of a hollow sphere: three cubes, each on the part where one coordinate is the largest. The region "core" is
/// its inner half, for an even number of cells.
fn shell(kind: CellKind, cells: usize) -> Outcome<Mesh> {
    let cube = regular(kind, [1.0; 3], [cells; 3])?;
    let mut raw = RawMesh::new("shell");
    let mut seen = BTreeMap::new();
    for (tag, name) in (1..).zip(["x-", "y-", "z-", "inner"]) {
        raw.name_group(2, tag, name);
    }
    raw.name_group(3, 1, "body");
    raw.name_group(3, 2, "core");
    for turn in 0..3 {
        let mut number = Vec::new();
        for &[x, y, z] in cube.points() {
            let (r, side) = (INNER + (OUTER - INNER) * x, Vec3::new(1.0, (0.25 * PI * y).tan(), (0.25 * PI * z).tan()));
            let at = side * (r / side.norm());
            let point: [f64; 3] = std::array::from_fn(|k| at[(k + turn) % 3]);
            let key = point.map(|x| (x * 1e9).round() as i64);
            number.push(*seen.entry(key).or_insert_with(|| {
                raw.points.push(point);
                raw.points.len() as u32 - 1
            }));
        }
        let renumber = |nodes: &[u32]| nodes.iter().map(|&node| number[node as usize]).collect::<Vec<_>>();
        for cell in cube.blocks()[0].iter() {
            let centre = cell.iter().map(|&node| cube.points()[node as usize][0]).sum::<f64>() / cell.len() as f64;
            let groups: &[i32] = if INNER + (OUTER - INNER) * centre < MIDDLE { &[1, 2] } else { &[1] };
            raw.push(kind, &renumber(cell), groups);
        }
        // the planes y = 0 and z = 0 of the cube, by the axis they are normal to after the turn
        for (side, axis) in [("y-", 1), ("z-", 2), ("x-", 3)] {
            let tag = if axis == 3 { 4 } else { (axis as usize + 3 - turn) % 3 + 1 };
            for &facet in cube.surface(side)? {
                let (kind, nodes) = cube.facet_nodes(facet);
                raw.push(kind, &renumber(&nodes), &[tag as i32]);
            }
        }
    }
    Ok(Mesh::build(raw)?)
}

/// Mean radial position of the nodes at a reference radius.
fn deformed_radius(solid: &Solid, u: &[f64], at: f64) -> f64 {
    let dim = solid.mesh().dim();
    let radii: Vec<f64> = (solid.mesh().points().iter().zip(u.chunks_exact(dim)))
        .filter(|(x, _)| (Vec3::from(**x).norm() - at).abs() < 1e-9)
        .map(|(x, u)| x.iter().zip(u.iter().chain(&[0.0])).map(|(x, u)| (x + u).powi(2)).sum::<f64>().sqrt())
        .collect();
    radii.iter().sum::<f64>() / radii.len() as f64
}

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
    let [inside, _, outside] = radii(Drive { p, m: 0.0 }, dim as i32 - 1);
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
    let expected = radii(Drive { p: 0.0, m }, 2);
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
