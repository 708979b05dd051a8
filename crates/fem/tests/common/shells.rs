//! Thick cylinders and spheres: meshes of a sector, and the ordinary differential equation of their radial equilibrium.

use super::{Outcome, regular};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, RawMesh};
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

pub const INNER: f64 = 1.0;
pub const OUTER: f64 = 2.0;
/// Where the inner half ends.
pub const MIDDLE: f64 = 1.5;

/// A shell of a Mooney-Rivlin law (a neo-Hookean one for `mu2 = 0`), and what drives it: a load `p` on its inner surface, a
/// turgor `m` inside `MIDDLE`.
#[derive(Clone, Copy)]
pub struct Drive {
    pub mu: [f64; 3],
    pub p: f64,
    /// Whether p is a pressure on the deformed surface, not a dead load.
    pub follower: bool,
    pub m: f64,
}

/// Radial and hoop stress at the stretches `r' = a` and `r/R = b`, for `b` in one direction (cylinder) or two (sphere),
/// under a turgor.
fn stresses([mu1, mu2, mu3]: [f64; 3], a: f64, b: f64, hoops: i32, turgor: f64) -> (f64, f64) {
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
    let area = if drive.follower { (inner / INNER).powi(hoops) } else { 1.0 };
    let (mut r, mut stress, mut middle) = (inner, -drive.p * area, f64::NAN);
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
                if stresses(drive.mu, a, b, hoops, turgor).0 < stress { low = a } else { high = a }
            }
            (low, f64::from(hoops) * (stresses(drive.mu, low, b, hoops, turgor).1 - stress) / big_r)
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
pub fn radii(drive: Drive, hoops: i32) -> [f64; 3] {
    let (mut low, mut high) = (0.5 * INNER, 2.0 * INNER);
    for _ in 0..50 {
        let inner = 0.5 * (low + high);
        if shoot(inner, drive, hoops)[2] < 0.0 { low = inner } else { high = inner }
    }
    let [middle, outer, _] = shoot(low, drive, hoops);
    [low, middle, outer]
}

/// The pressure inside that holds a passive shell at an inner radius.
pub fn pressure(mu: [f64; 3], inner: f64, hoops: i32) -> f64 {
    let (mut low, mut high) = (0.0, 10.0 * mu[0]);
    for _ in 0..50 {
        let p = 0.5 * (low + high);
        if shoot(inner, Drive { mu, p, follower: true, m: 0.0 }, hoops)[2] > 0.0 { low = p } else { high = p }
    }
    low
}

/// A quarter of a ring; "inner" is its side x-.
pub fn ring(kind: CellKind, cells: usize) -> Outcome<Mesh> {
    Ok(regular(kind, [1.0; 3], [cells, 2 * cells, 1])?.mapped(|[x, y, _]| {
        let (r, angle) = (INNER + (OUTER - INNER) * x, 0.5 * PI * y);
        // exactly on the axes, so that rollers hold what they should
        [if y == 1.0 { 0.0 } else { r * angle.cos() }, r * angle.sin(), 0.0]
    })?)
}

/// An eighth of a hollow sphere: three cubes, each on the part where one coordinate is the largest. The region "core" is
/// its inner half, for an even number of cells.
pub fn shell(kind: CellKind, cells: usize) -> Outcome<Mesh> {
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
pub fn deformed_radius(solid: &Solid, u: &[f64], at: f64) -> f64 {
    let dim = solid.mesh().dim();
    let radii: Vec<f64> = (solid.mesh().points().iter().zip(u.chunks_exact(dim)))
        .filter(|(x, _)| (Vec3::from(**x).norm() - at).abs() < 1e-9)
        .map(|(x, u)| x.iter().zip(u.iter().chain(&[0.0])).map(|(x, u)| (x + u).powi(2)).sum::<f64>().sqrt())
        .collect();
    radii.iter().sum::<f64>() / radii.len() as f64
}
