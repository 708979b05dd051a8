//! A field in which the potential has a maximum: an electric potential in a soft dielectric.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::dielectric::{Dielectric, block, on_rollers, stretches};
use nastic_fem::{Solid, check_contribution};
use nastic_mesh::CellKind;

const PERMITTIVITY: f64 = 0.7;

fn dielectric(solid: Solid) -> Outcome<Solid> {
    let field = Dielectric::on(solid.discretization(), PERMITTIVITY);
    Ok(solid.contribution(field)?)
}

/// Two plates pull each other through the body with `eps E^2 / 2`; the equilibrium is stable though the tangent is not definite.
#[test]
fn a_capacitor_is_squeezed_as_its_closed_form_says() -> Outcome {
    let (voltage, thickness) = (0.1, 0.25);
    let solid = dielectric(on_rollers(block(CellKind::Hex8, [1.0, 0.8, thickness], [2, 2, 3])?)?)?;
    check_contribution(solid.model(), "dielectric", 3)?;
    let solid = solid.hold("phi", 0, "z-", 0.0)?.hold("phi", 0, "z+", voltage)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    assert_eq!((state.report.shifted, state.report.solver), (0, "direct"));
    let [across, along] = stretches(PERMITTIVITY, voltage, thickness);
    assert!(across > 1.01 && along < 0.98, "{across} {along}");
    let u = solid.model().displacement(&state.u);
    for (x, u) in solid.mesh().points().iter().zip(u.chunks_exact(3)) {
        let expected = [(across - 1.0) * x[0], (across - 1.0) * x[1], (along - 1.0) * x[2]];
        assert!((0..3).all(|i| (u[i] - expected[i]).abs() < 1e-10), "{u:?} {expected:?}");
    }
    let stability = solid.model().stability();
    assert_eq!(stability.negative_pivots(&state)?, 0);
    Ok(())
}

/// A bar that buckles is unstable in as many directions with the field as without it.
#[test]
fn what_buckles_is_counted_beside_the_field() -> Outcome {
    let bar = |shortened: f64| -> Outcome<Solid> {
        let bar = block(CellKind::Hex20, [1.0, 0.1, 0.12], [8, 1, 1])?.clamp("x-")?;
        Ok(bar.displace("x+", [Some(-shortened), Some(0.0), Some(0.0)])?)
    };
    for (shortened, expected) in [(0.02, 0), (0.042, 1), (0.06, 2)] {
        let alone = bar(shortened)?;
        let charged = dielectric(bar(shortened)?)?.hold("phi", 0, "z-", 0.0)?.hold("phi", 0, "z+", 1e-3)?;
        for solid in [alone, charged] {
            let state = solid.solve(&solid.controls(), &STRICT)?;
            assert_eq!(solid.model().stability().negative_pivots(&state)?, expected, "{shortened}");
        }
    }
    Ok(())
}
