//! Sums over the cells do not depend on who computes them.

use crate::common;

use common::{Outcome, kinds, laws, noise, regular};
use nastic_energy::network::{Network, NetworkInput, NetworkLayer};
use nastic_energy::{ConvexNetwork, EnergyTerm, FiberTension, Yeoh};
use nastic_fem::{Controls, Solid};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

/// Enough cells for several waves of every kind, driven, in a configuration without a pattern.
fn driven(kind: CellKind) -> Outcome<(Solid, Vec<f64>, Controls)> {
    let cells = match (kind.dim(), kind.nodes()) {
        (2, _) => [20, 20, 1],
        (_, 0..=8) => [7, 6, 7],
        _ => [4, 4, 4],
    };
    let (_, law) = laws()?.remove(0);
    let solid = Solid::new(regular(kind, [1.0, 0.9, 0.8], cells)?)?.material("body", law)?.actuate(
        "body",
        "tension",
        FiberTension::along(Vec3::new(0.6, 0.8, 0.0))?,
    )?;
    let u = (0..solid.discretization().dofs()).map(|n| 0.004 * noise(n)).collect();
    let mut controls = solid.controls();
    controls.values_mut(0).iter_mut().enumerate().for_each(|(n, m)| *m = 1e3 * noise(n));
    Ok((solid, u, controls))
}

#[test]
fn every_sum_has_the_same_bits_for_any_number_of_threads() -> Outcome {
    let pools = [1, 2, 3].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    for kind in kinds() {
        let (solid, u, controls) = driven(kind)?;
        let sums = |parallel: bool| -> Outcome<_> {
            let mut matrix = solid.model().tangent_structure().matrix();
            let sums = solid.body().evaluate_tangent(&u, &controls, &mut matrix, parallel)?;
            let mut product = vec![0.0; u.len()];
            solid.body().tangent_product(&u, &controls, &u, &mut product, parallel)?;
            let pulled = solid.body().control_vjp(&u, &controls, &u, parallel)?;
            let mut tangent = solid.model().tangent_structure().matrix();
            solid.body().add_tangent(&u, &controls, &mut tangent, parallel)?;
            assert!(tangent.values == matrix.values, "{kind}: the tangent alone differs");
            let numbers = [sums.energy, sums.energy_scale, sums.min_j];
            Ok((numbers, sums.force, sums.force_scale, matrix.values, product, pulled))
        };
        let alone = sums(false)?;
        for pool in &pools {
            let pool = pool.as_ref().map_err(|e| e.to_string())?;
            let together = pool.install(|| sums(true).map_err(|e| e.to_string()))?;
            assert!(alone == together, "{kind}, {} threads", pool.current_num_threads());
        }
    }
    Ok(())
}

/// The same cell is named, the first in the mesh, whichever thread finds another one earlier.
#[test]
fn the_first_inverted_cell_is_blamed_for_any_number_of_threads() -> Outcome {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let (solid, mut u, controls) = driven(CellKind::Hex8)?;
    // one node of the face x = 0 and the last one, at a corner, pushed through the cells behind them
    let (middle, last) = (3 * (u.len() / 6), u.len() - 1);
    u[middle] += 0.5;
    u[last] -= 0.5;
    let blamed = |parallel: bool| solid.body().evaluate(&u, &controls, true, parallel).err();
    let alone = blamed(false).ok_or("nothing is inverted")?;
    let nodes = |cell: usize| solid.mesh().cell(cell).nodes.to_vec();
    let first = (0..solid.mesh().cells()).find(|&c| nodes(c).contains(&(middle as u32 / 3)));
    assert_eq!(alone.cell().map(|at| at.cell), first);
    assert_eq!(Some(alone), pool.install(|| blamed(true)));
    Ok(())
}

/// Assembly of the tangent of a network of two layers of four units beside that of Yeoh's law:
/// `cargo test --release -p nastic-fem --test all -- cost_of_a_network --ignored --nocapture`.
#[test]
#[ignore = "times, which depend on the machine"]
fn cost_of_a_network() -> Outcome {
    let mut random = (0..).map(|n| 0.5 + 0.5 * noise(n));
    let mut rows = |units: usize, columns: usize| -> Vec<Vec<f64>> {
        (0..units).map(|_| random.by_ref().take(columns).collect()).collect()
    };
    let layers = vec![
        NetworkLayer { through: rows(4, 2), before: vec![], bias: vec![-0.5; 4] },
        NetworkLayer { through: vec![], before: rows(4, 4), bias: vec![-1.0; 4] },
        NetworkLayer { through: vec![], before: rows(1, 4), bias: vec![] },
    ];
    let inputs = vec![NetworkInput::FirstIsochoric, NetworkInput::SecondIsochoric];
    let network = ConvexNetwork::new(&Network { inputs, layers }, 1e5, 1e6, None)?;
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        let time = |law: std::sync::Arc<dyn EnergyTerm>| -> Outcome<f64> {
            let solid = Solid::new(regular(kind, [1.0, 0.9, 0.8], [6, 6, 6])?)?.material("body", law)?;
            let u: Vec<f64> = (0..solid.discretization().dofs()).map(|n| 0.004 * noise(n)).collect();
            let (mut matrix, controls) = (solid.model().tangent_structure().matrix(), solid.controls());
            let mut least = f64::INFINITY;
            for _ in 0..20 {
                let start = std::time::Instant::now();
                solid.body().evaluate_tangent(&u, &controls, &mut matrix, false)?;
                least = least.min(start.elapsed().as_secs_f64());
            }
            Ok(least)
        };
        let (own, yeoh) =
            (time(std::sync::Arc::new(network.clone()))?, time(std::sync::Arc::new(Yeoh::new(5e4, 1e3, 1e2, 1e6)?))?);
        println!("{kind}: network {:.2} ms, yeoh {:.2} ms, ratio {:.2}", 1e3 * own, 1e3 * yeoh, own / yeoh);
        assert!(own < 4.0 * yeoh, "{kind}: {own} s beside {yeoh} s");
    }
    Ok(())
}
