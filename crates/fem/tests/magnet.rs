//! Hard-magnetic bodies: strips against the elastica, bent and buckled, and the free cube against its closed form.

use crate::common;

use common::block::{Block, STRICT};
use common::homogeneous::{cases, neo_hooke, relaxed};
use common::{Outcome, distance, kinds, largest, nodal, node_at, regular};
use nastic_energy::{EnergyTerm, Magnet, MagnetIsochoric, MagnetRotation, NeoHooke};
use nastic_fem::{Solid, SolveOptions, State};
use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A magnetised plane strip of unit length and height h with `cells` over its height: `B_r` along it, `mu0 = 1`, `E = 1`
/// without lateral contraction, so that plane strain is no stiffer.
fn strip(h: f64, cells: usize) -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Quad9, [1.0, h, 0.0], [(cells as f64 / h).round() as usize, cells, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .actuate("body", "magnet", Magnet::with_permeability(1.0)?)?
        .clamp("x-")?)
}

/// The strip in a field along a unit vector, `beta = 12 B_r B_a (L/h)^2 / E`.
fn in_field(solid: &Solid, h: f64, beta: f64, along: Vec3, near: Option<&State>) -> Outcome<State> {
    let mut controls = solid.controls();
    for slot in controls.values_mut(0).chunks_exact_mut(6) {
        slot[0] = 1.0;
        slot[3..].copy_from_slice((along * (beta * h * h / 12.0)).as_slice());
    }
    Ok(solid.solve(&controls, &SolveOptions { near, ..STRICT })?)
}

/// Where the tip of the mid-line is.
fn tip(solid: &Solid, h: f64, state: &State) -> Outcome<[f64; 2]> {
    let node = node_at(solid.mesh(), [1.0, 0.5 * h, 0.0]).ok_or("no node on the mid-line")?;
    Ok([1.0 + state.u[2 * node], state.u[2 * node + 1]])
}

fn gap(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Tips of the elastica in a field across it (docs/development/verification.md).
const ELASTICA: [(f64, [f64; 2]); 7] = [
    (1.0, [0.943567, 0.301721]),
    (2.0, [0.839358, 0.493457]),
    (3.0, [0.745580, 0.603253]),
    (4.0, [0.671059, 0.669964]),
    (5.0, [0.612372, 0.713792]),
    (10.0, [0.445004, 0.810609]),
    (20.0, [0.316114, 0.868696]),
];

#[test]
fn magnetised_strips_approach_the_elastica_as_their_height_squared() -> Outcome {
    let heights = [0.1, 0.05, 0.025];
    let strips = [strip(0.1, 2)?, strip(0.05, 2)?, strip(0.025, 2)?];
    for (beta, elastica) in ELASTICA {
        let mut errors = [0.0; 3];
        for ((solid, h), error) in strips.iter().zip(heights).zip(&mut errors) {
            *error = gap(tip(solid, h, &in_field(solid, h, beta, Vec3::y(), None)?)?, elastica);
        }
        let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        println!(
            "| {beta} | {:.2e} | {:.2e} | {:.2e} | {:.2} {:.2} |",
            errors[0], errors[1], errors[2], orders[0], orders[1]
        );
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "beta = {beta}: {errors:?}, orders {orders:?}");
    }
    Ok(())
}

/// Converged values of second-order elements at `h/L` = 0.1 and 0.05 and `beta = 4` (docs/development/verification.md).
#[test]
fn converged_tips_at_two_heights() -> Outcome {
    for (h, expected) in [(0.1, [0.66879, 0.67687]), (0.05, [0.67047, 0.67172])] {
        let solid = strip(h, 6)?;
        let found = tip(&solid, h, &in_field(&solid, h, 4.0, Vec3::y(), None)?)?;
        let off = (0..2).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5, "h/L = {h}: tip of the mid-line at {found:?}");
    }
    Ok(())
}

/// A field against the magnetisation buckles the strip at `beta = (pi/2)^2`, a little earlier for thick ones:
/// docs/development/verification.md. The straight state is an equilibrium on both sides; what changes is its inertia.
#[test]
fn a_field_against_the_magnetisation_buckles_the_strip() -> Outcome {
    for (h, critical) in [(0.1, 2.46548), (0.05, 2.46693), (0.025, 2.46728)] {
        let solid = strip(h, 2)?;
        for (shift, expected) in [(-5e-5, 0), (5e-5, 1)] {
            let state = in_field(&solid, h, critical + shift, -Vec3::x(), None)?;
            assert_eq!(solid.negative_pivots(&state)?, expected, "h/L = {h}, beta = {critical} + {shift:e}");
        }
    }
    Ok(())
}

/// Far beyond the buckling load the exactly symmetric state has no residual and is left as it is; only its inertia shows.
/// From a perturbed start, the state of a tilted field, the solver finds the bent branch: `K(k) = sqrt(beta)`, `x = 2 E(k)/K(k) - 1`, `y = 2 k/K(k)` of the
/// buckled elastica, approached as `(h/L)^2`.
#[test]
fn the_bent_branch_is_followed_from_a_perturbed_start_alone() -> Outcome {
    for beta in [2.7, 3.5, 6.0] {
        let mut errors = [0.0; 2];
        for (h, error) in [0.1, 0.05].into_iter().zip(&mut errors) {
            let solid = strip(h, 2)?;
            let straight = in_field(&solid, h, beta, -Vec3::x(), None)?;
            let sideways = (0..solid.mesh().points().len())
                .filter(|&node| solid.mesh().points()[node][1] == 0.5 * h)
                .map(|node| straight.u[2 * node + 1].abs())
                .fold(0.0, f64::max);
            assert!(straight.report.residual < 1e-12 && sideways < 1e-9, "{sideways:e}, {:?}", straight.report);
            assert_eq!(solid.negative_pivots(&straight)?, 1, "beta = {beta}");

            let tilted = in_field(&solid, h, beta, Vec3::new(-1.0, 0.1, 0.0), None)?;
            let bent = in_field(&solid, h, beta, -Vec3::x(), Some(&tilted))?;
            assert_eq!(solid.negative_pivots(&bent)?, 0, "beta = {beta}");
            assert!(bent.report.energy < straight.report.energy);
            *error = gap(tip(&solid, h, &bent)?, buckled(beta));
        }
        let order = (errors[0] / errors[1]).log2();
        println!("| {beta} | {:.2e} | {:.2e} | {order:.2} |", errors[0], errors[1]);
        assert!(errors[1] < 0.02 && (order - 2.0).abs() < 0.1, "beta = {beta}: {errors:?}, order {order}");
    }
    Ok(())
}

/// Where a tangent is indefinite on the way, the step is cut short where that shows, and if that is not enough the tangent
/// is shifted by what bending needs, which is little in slender bodies.
#[test]
fn slender_bodies_find_their_bent_state_without_load_steps() -> Outcome {
    let solid = strip(0.1, 2)?;
    let mut shifted = 0;
    for (beta, tilt) in [(2.7, 0.001), (2.7, 0.01), (3.5, 0.01)] {
        let state = in_field(&solid, 0.1, beta, Vec3::new(-1.0, tilt, 0.0), None)?;
        let report = state.report;
        assert_eq!(
            (solid.negative_pivots(&state)?, report.load_steps),
            (0, 1),
            "beta = {beta}, tilt {tilt}: {report:?}"
        );
        assert!(report.newton < 80, "beta = {beta}, tilt {tilt}: {report:?}");
        shifted += report.shifted;
    }
    assert!(shifted > 0, "none of these needed a shift");
    Ok(())
}

/// The tip of a buckled elastica of unit length.
fn buckled(beta: f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-15 {
        let k = 0.5 * (low + high);
        if elliptic(k).0 < beta.sqrt() { low = k } else { high = k }
    }
    let (k, (first, second)) = (low, elliptic(low));
    [2.0 * second / first - 1.0, 2.0 * k / first]
}

/// Complete elliptic integrals K(k) and E(k) by the arithmetic-geometric mean (Abramowitz & Stegun 17.6).
fn elliptic(k: f64) -> (f64, f64) {
    let (mut a, mut b, mut c, mut sum, mut power) = (1.0, (1.0 - k * k).sqrt(), k, 0.0, 0.5);
    for _ in 0..12 {
        sum += power * c * c;
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
    }
    let first = PI / (2.0 * a);
    (first, first * (1.0 - sum))
}

/// Name, law, and what carries the remanence.
type Variant = (&'static str, Arc<dyn EnergyTerm>, fn(&Mat3) -> Mat3);

/// What carries the remanence, written once more: `F`, `J^(-1/3) F`, and `R = F (F^T F)^(-1/2)`, of an upper triangular F
/// by the eigenvectors of `F^T F`.
fn carriers() -> Outcome<[Variant; 3]> {
    let rotation = |f: &Mat3| {
        let eigen = (f.transpose() * f).symmetric_eigen();
        let inverse = Mat3::from_diagonal(&eigen.eigenvalues.map(|l| 1.0 / l.sqrt()));
        f * eigen.eigenvectors * inverse * eigen.eigenvectors.transpose()
    };
    Ok([
        ("F", Arc::new(Magnet::with_permeability(2.0)?), |f| *f),
        ("isochoric", Arc::new(MagnetIsochoric::with_permeability(2.0)?), |f| f / f.determinant().cbrt()),
        ("rotation", Arc::new(MagnetRotation::with_permeability(2.0)?), rotation),
    ])
}

/// A free cube magnetised along x in a field along x deforms as the one F in which `W(F) - (1/mu0) (C B_r) . B_a` is least:
/// every law, every variant, every kind of cell. The supports carry nothing.
#[test]
fn a_free_cube_in_a_field_along_its_magnetisation_deforms_as_one_point() -> Outcome {
    const REMANENCE: f64 = 1.6;
    const FIELD: f64 = 0.9;
    for kind in kinds() {
        let block = Block::new(kind)?;
        for case in cases()? {
            for (variant, law, carrier) in carriers()? {
                let energy = |f: &Mat3| (case.density)(f) - REMANENCE * FIELD / 2.0 * carrier(f)[(0, 0)];
                let f = relaxed(kind.dim(), energy);
                let solid = block.solid(&case)?.actuate("body", "magnet", law)?;
                let mut controls = solid.controls();
                for slot in controls.values_mut(0).chunks_exact_mut(6) {
                    (slot[0], slot[3]) = (REMANENCE, FIELD);
                }
                let state = solid.solve(&controls, &STRICT)?;
                let what = format!("{kind}, {}, {variant}", case.name);
                let expected = nodal(solid.mesh(), |x| (f - Mat3::identity()) * x);
                let error = distance(&state.u, &expected);
                assert!(error < 1e-9, "{what}: u is off by {error:e}");
                let carried = largest(&solid.body().evaluate(&state.u, &state.controls, true, false)?.force);
                assert!(carried < 1e-9, "{what}: supports of a free body carry {carried:e}");
            }
        }
    }
    Ok(())
}

/// The same where it is one equation: with `W = mu/2 (|F|^2 - 3) - mu log J` and `C = F` the stretch l along x solves
/// `mu (l - 1/l) = B_r B_a/mu0`, and nothing happens across.
#[test]
fn a_free_cube_of_neo_hooke_meets_its_scalar_equation() -> Outcome {
    let solid = Block::new(CellKind::Hex8)?.solid(&neo_hooke(1.5, 0.0)?)?;
    let solid = solid.actuate("body", "magnet", Magnet::with_permeability(2.0)?)?;
    for pull in [-0.8, 0.7f64, 3.0] {
        let mut controls = solid.controls();
        for slot in controls.values_mut(0).chunks_exact_mut(6) {
            (slot[0], slot[3]) = (2.0, pull);
        }
        let state = solid.solve(&controls, &STRICT)?;
        let stretch = (pull + (pull * pull + 9.0).sqrt()) / 3.0;
        let expected = nodal(solid.mesh(), |x| Vec3::x() * ((stretch - 1.0) * x.x));
        assert!(distance(&state.u, &expected) < 1e-11, "B_r B_a/mu0 = {pull}");
    }
    Ok(())
}
