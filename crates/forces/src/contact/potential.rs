//! Derivatives of the potential `psi(d)` by the slots of a [`Stencil`].

use super::law::Pressure;
use super::slots::{add_scaled, dot, scaled};
use super::stencil::Stencil;

/// The changes of `-p G`, the gradient of the potential, along two changes a and b of the slots.
pub(super) fn potential_changes<S: Stencil>(stencil: &S, pressure: &Pressure, along: [&S::Slots; 2]) -> [S::Slots; 2] {
    potential_seconds(stencil, pressure, along).0
}

/// The same, and the change of the first one along b: with `psi' = -p`
///
/// ```text
/// psi'' (G.a) G + psi' H a
/// psi''' (G.a) (G.b) G + psi'' ((a.H b) G + (G.a) H b + (G.b) H a) + psi' d(H a)
/// ```
pub(super) fn potential_seconds<S: Stencil>(
    stencil: &S,
    pressure: &Pressure,
    [a, b]: [&S::Slots; 2],
) -> ([S::Slots; 2], S::Slots) {
    let (gradient, [of_a, of_b, mut mixed]) = (stencil.gradient(), stencil.second(a, b));
    let (along_a, along_b, bent) = (dot(gradient, a), dot(gradient, b), dot(a, &of_b));
    let Pressure { value, slope, second, .. } = *pressure;
    mixed = scaled(mixed, -value);
    add_scaled(&mut mixed, gradient, -second * along_a * along_b - slope * bent);
    add_scaled(&mut mixed, &of_b, -slope * along_a);
    add_scaled(&mut mixed, &of_a, -slope * along_b);
    let change = |of: S::Slots, along: f64| {
        let mut change = scaled(of, -value);
        add_scaled(&mut change, gradient, -slope * along);
        change
    };
    ([change(of_a, along_a), change(of_b, along_b)], mixed)
}
