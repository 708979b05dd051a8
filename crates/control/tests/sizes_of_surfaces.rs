//! Mean radii, enclosed volumes and reactions of surfaces: closed forms.

use nastic_control::{Cost, CostContext, IntoCost, LumenVolume, MeanRadius, Reaction, Reduced};
use nastic_energy::MooneyRivlin;
use nastic_fem::{Solid, SolveOptions, State};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn bar() -> Outcome<Reduced> {
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 2, 2], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .clamp("x-")?
        .traction("x+", Vec3::new(1e3, 0.0, -200.0))?;
    Ok(Reduced::new(solid))
}

/// Value and figure of a cost at a displacement.
fn figure(body: &Reduced, cost: &dyn Cost, u: &[f64]) -> Outcome<[f64; 2]> {
    let state = State { u: u.to_vec().into(), load: 1.0, ..body.solid().rest() };
    let context = CostContext {
        solid: body.solid(),
        layout: body.layout(),
        u,
        state: Some(&state),
        m: &[],
        stage: 0,
        step: None,
    };
    let at = cost.at(&context)?;
    Ok([at.value(), at.figures()?.first().ok_or("no figure")?.value])
}

/// An affine displacement changes the volume by det F; half the square of the deviation is the cost.
#[test]
fn the_volume_within_a_skin_grows_by_the_jacobian() -> Outcome {
    let body = bar()?;
    let skin = ["x-", "x+", "y-", "y+", "z-", "z+"].map(str::to_owned).to_vec();
    let cost = LumenVolume::behind(skin, 0.03).weight(2.0).bind(body.solid())?;
    let u: Vec<f64> =
        body.solid().mesh().points().iter().flat_map(|x| [0.2 * x[0] + 0.1 * x[1], -0.1 * x[1], 0.3 * x[2]]).collect();
    let expected = 1.2 * 0.9 * 1.3 * 0.04;
    let [value, volume] = figure(&body, &*cost, &u)?;
    assert!((volume - expected).abs() < 1e-15, "{volume} {expected}");
    assert!((value - (expected - 0.03f64).powi(2)).abs() < 1e-16, "{value}");
    let refused = LumenVolume::behind("x+", 0.03).bind(body.solid()).map(|_| ()).map_err(|e| e.to_string());
    assert!(refused.as_ref().is_err_and(|e| e.contains("encloses no volume")), "{refused:?}");
    Ok(())
}

/// The end face, half a stretch of 1.5 away from its axis: int sqrt(a^2 + s^2) ds.
#[test]
fn the_mean_radius_of_a_face_is_its_integral() -> Outcome {
    let body = bar()?;
    let cost =
        MeanRadius::of_surface("x+", 1.0).about([0.0, 3.0, 0.0]).centre([Some(0.0), None, None]).bind(body.solid())?;
    let u: Vec<f64> = body.solid().mesh().points().iter().flat_map(|x| [0.5 * x[0], 7.0, 0.0]).collect();
    let (a, s): (f64, f64) = (1.5, 0.1);
    let mean = (s * (a * a + s * s).sqrt() + a * a * (s / a).asinh()) / (2.0 * s);
    let [value, radius] = figure(&body, &*cost, &u)?;
    assert!((radius - mean).abs() < 1e-11, "{radius} {mean}");
    assert!((value - 0.5 * (mean - 1.0).powi(2)).abs() < 1e-11);
    let from_itself = MeanRadius::of_surface("x+", 0.1).about([1.0, 0.0, 0.0]).bind(body.solid())?;
    let rest = vec![0.0; u.len()];
    // of a square of the half side b: b (sqrt 2 + log(1 + sqrt 2))/3, up to its quadrature
    let square = 0.1 * (2f64.sqrt() + 1f64.asinh()) / 3.0;
    let [_, radius] = figure(&body, &*from_itself, &rest)?;
    assert!((radius / square - 1.0).abs() < 0.01, "{radius} {square}");
    Ok(())
}

/// A support bears what pulls at the other end.
#[test]
fn a_reaction_is_the_load() -> Outcome {
    let body = bar()?;
    let state = body.solid().solve(&body.solid().controls(), &SolveOptions::default())?;
    for (direction, force) in [([2.0, 0.0, 0.0], -40.0), ([0.0, 0.0, 1.0], 8.0)] {
        let cost = Reaction::at("x-", direction, 0.0).bind(body.solid())?;
        let context = CostContext {
            solid: body.solid(),
            layout: body.layout(),
            u: &state.u,
            state: Some(&state),
            m: &[],
            stage: 0,
            step: None,
        };
        let figures = cost.at(&context)?.figures()?;
        let found = figures.first().ok_or("no figure")?.value;
        assert!((found - force).abs() < 1e-5, "{found} {force}");
    }
    let refused = Reaction::at("x+", [1.0, 0.0, 0.0], 0.0).bind(body.solid()).map(|_| ()).map_err(|e| e.to_string());
    assert!(refused.as_ref().is_err_and(|e| e.contains("nothing holds surface")), "{refused:?}");
    Ok(())
}
