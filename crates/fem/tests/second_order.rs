//! Second derivatives through a state: the linearised state and the linearised adjoint.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::own_contributions::{bar, swirling};
use common::{Outcome, largest, noise};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, Inadmissible, Increment, Instant, Need, SecondDerivativeError,
    SecondOrder, Solid, SolveOptions, State, StateError, StatePartials, Sums, TimeStepping, Trajectory, Workspace,
    check_contribution,
};
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;

/// A vector of the displacements, and one of the controls.
type Change = (Vec<f64>, Controls);

/// Along a change v of the controls, of `g . u` with g fixed: `du`, and the change of the derivative through the state.
fn second_order(solid: &Solid, state: &State, g: &[f64], v: &Controls) -> Outcome<Change> {
    let mut workspace = Workspace::default();
    let (lambda, _) = first_order(solid, state, g)?;
    let mut products = SecondOrder::new(solid.model(), state, &STRICT, &mut workspace)?;
    let du = products.state_change(v)?;
    let zero = vec![0.0; g.len()];
    let change = products.adjoint_change(&lambda, &Increment { u: &du, controls: v }, &zero)?;
    Ok((du, change.controls))
}

/// The adjoint of `g . u`, and its derivative by the controls.
fn first_order(solid: &Solid, state: &State, g: &[f64]) -> Outcome<Change> {
    let partials = StatePartials::by_displacement(g.to_vec());
    let trajectory = Trajectory::from(state.clone());
    let mut swept = solid.model().reverse_sweep(&trajectory, &[partials], &STRICT, &mut Workspace::default())?;
    Ok((swept.lambda.swap_remove(0), swept.controls.swap_remove(0)))
}

/// Differences through solves, with a cavity, fibres and a load, and without a potential; on one thread as on all.
#[test]
fn second_derivatives_through_a_state_are_differences_of_the_first() -> Outcome {
    let cup = CATALOGUE.iter().find(|entry| entry.name == "cavity").ok_or("no cavity")?;
    let cup = (cup.example)()?.traction("x+", Vec3::new(2e3, 1e3, 0.0))?;
    for (solid, sizes) in [(cup, [-4e4, 3e4]), (swirling()?, [-1e2, 6.0])] {
        let (mut controls, mut v) = (solid.controls(), solid.controls());
        for (k, size) in sizes.into_iter().enumerate() {
            controls.values_mut(k).iter_mut().enumerate().for_each(|(q, m)| *m = size * (1.0 + 0.2 * noise(q)));
            v.values_mut(k).iter_mut().enumerate().for_each(|(q, m)| *m = size * noise(q + 77));
        }
        let state = solid.solve(&controls, &STRICT)?;
        let g: Vec<f64> = (0..state.u.len()).map(noise).collect();
        let (du, by_controls) = second_order(&solid, &state, &g, &v)?;
        let first = |s: f64| -> Outcome<Change> {
            let mut moved = controls.clone();
            for k in 0..moved.len() {
                moved.values_mut(k).iter_mut().zip(v.values(k)).for_each(|(m, v)| *m += s * v);
            }
            let state = solid.solve(&moved, &SolveOptions { near: Some(&state), ..STRICT })?;
            let by_controls = first_order(&solid, &state, &g)?.1;
            Ok((state.u.to_vec(), by_controls))
        };
        let h = 0.01;
        let moved = [1.0, -1.0, 2.0, -2.0, 3.0, -3.0].map(|s| first(s * h));
        let moved = moved.into_iter().collect::<Outcome<Vec<_>>>()?;
        let slope = |of: &dyn Fn(&Change) -> f64| -> f64 {
            let pair = |k: usize| of(&moved[2 * k]) - of(&moved[2 * k + 1]);
            (45.0 * pair(0) - 9.0 * pair(1) + pair(2)) / (60.0 * h)
        };
        for (dof, found) in du.iter().enumerate() {
            let expected = slope(&|at| at.0[dof]);
            assert!((found - expected).abs() < 1e-7 * largest(&du), "du {dof}: {found:e}, differences {expected:e}");
        }
        for k in 0..v.len() {
            for (q, found) in by_controls.values(k).iter().enumerate() {
                let (expected, size) = (slope(&|at| at.1.values(k)[q]), largest(by_controls.values(k)));
                let what = format!("block {k}, entry {q}: {found:e}, differences {expected:e}");
                assert!((found - expected).abs() < 1e-6 * size, "{what}");
            }
        }
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        let again = alone.install(|| second_order(&solid, &state, &g, &v).map_err(|error| error.to_string()))?;
        assert_eq!(again, (du, by_controls), "the bits depend on the number of threads");
    }
    Ok(())
}

/// What lacks second derivatives says so, by name and with what to implement.
#[test]
fn contributions_without_second_derivatives_refuse() -> Outcome {
    #[derive(Debug)]
    struct Plain;
    impl Contribution for Plain {
        fn name(&self) -> &str {
            "plain"
        }

        fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
            Ok(Box::new(self))
        }
    }

    impl ContributionPoint for Plain {
        fn add_residual(&self, _: &Instant, _: Demand, _: &mut Sums) -> Result<(), Inadmissible> {
            Ok(())
        }

        fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
            Ok(())
        }
    }
    let solid = bar()?.contribution(Plain)?;
    check_contribution(solid.model(), "plain", 1)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let g: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let error = second_order(&solid, &state, &g, &solid.controls()).err().ok_or("not refused")?;
    let refusal = error.downcast_ref::<StateError>().ok_or("another type")?;
    assert!(matches!(
        refusal,
        StateError::SecondDerivatives(SecondDerivativeError::Contribution { method: "second_vjp", .. })
    ));
    let message = "\"plain\" gives no second derivatives; take a method that needs first ones alone (lbfgs, spectral, projected_gradient); \
                   in the library: `ContributionPoint::second_vjp`";
    assert_eq!(refusal.to_string(), message);
    Ok(())
}
