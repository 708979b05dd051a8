//! Contacts that are refused, and bodies that begin inside.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{Contact, ContactLaw, Inertia, Solid, StateError, TimeStepping};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;

fn bar() -> Outcome<Solid> {
    let mesh = regular(CellKind::Hex8, [2.0, 0.5, 0.5], [4, 1, 1])?;
    Ok(Solid::new(mesh)?.material("body", NeoHooke::new(4e4, 6e4)?)?.clamp("x-")?)
}

fn floor(height: f64) -> Obstacle {
    Obstacle::half_space([0.0, 0.0, height], [0.0, 0.0, 1.0])
}

#[test]
fn numbers_that_are_none_are_refused() -> Outcome {
    let contact = || Contact::of("floor", "z-", floor(-0.1));
    for (wrong, words) in [
        (contact().thickness(0.0), "thickness"),
        (contact().stiffness(-1.0), "stiffness"),
        (contact().stiffness(1e30), "stiffness of 1e30 Pa"),
        (contact().friction(-0.1, 1e-3), "friction coefficient"),
        (contact().friction(0.1, 0.0), "slip speed"),
        (contact().refine(0), "refine"),
        (contact().about([f64::NAN; 3]), "centre"),
        (Contact::of("ball", "z-", Obstacle::sphere([0.0; 3], -1.0)), "radius"),
        (Contact::of("floor", "nowhere", floor(-0.1)), "nowhere"),
    ] {
        let refused = bar()?.contact(wrong).err().ok_or(words)?.to_string();
        assert!(refused.contains(words), "{refused}");
    }
    Ok(())
}

/// Friction is refused at rest, with the reason.
#[test]
fn friction_has_no_static_equilibrium() -> Outcome {
    let solid = bar()?.contact(Contact::of("floor", "z-", floor(-0.1)).friction(0.5, 1e-3))?;
    let refused = solid.solve(&solid.controls(), &STRICT).err().ok_or("it has one")?.to_string();
    assert!(refused.contains("floor") && refused.contains("quasi_static"), "{refused}");
    Ok(())
}

/// Ends that no solve has seen would be deep in a layer, and linear steps do not begin to slide.
#[test]
fn schemes_that_are_wrong_beside_contact_are_refused() -> Outcome {
    let body = |friction: bool| -> Outcome<Solid> {
        let contact = Contact::of("floor", "z-", floor(-0.1));
        let contact = if friction { contact.friction(0.5, 1e-3) } else { contact };
        Ok(bar()?.inertia(Inertia::new("body", 1000.0))?.contact(contact)?)
    };
    for row in SCHEMES {
        let scheme = (row.build)()?;
        for friction in [false, true] {
            let refused = body(friction)?.model().supports_motion(&scheme).err().map(|error| error.to_string());
            let wrong = scheme.extrapolates() || friction && scheme.is_linearised();
            assert_eq!(refused.is_some(), wrong, "{}, friction {friction}: {refused:?}", row.name);
            assert!(refused.is_none_or(|told| told.contains(row.name) && told.contains("floor")));
        }
        // without contact all are there
        bar()?.inertia(Inertia::new("body", 1000.0))?.model().supports_motion(&scheme)?;
    }
    Ok(())
}

/// A body that begins in an obstacle is refused with place and depth; one within the layer is pushed out.
#[test]
fn a_start_inside_is_refused_with_its_depth() -> Outcome {
    for law in [ContactLaw::Cubic, ContactLaw::Log] {
        let inside = bar()?.contact(Contact::of("floor", "z-", floor(0.1)).law(law).thickness(0.01))?;
        match inside.solve(&inside.controls(), &STRICT) {
            Err(StateError::Start { at }) => {
                assert_eq!(at.code(), "penetrates");
                assert!(at.to_string().contains("1.000e-1"), "{at}");
            }
            other => return Err(format!("{law:?}: {other:?}").into()),
        }
        let near = bar()?.contact(Contact::of("floor", "z-", floor(-0.001)).law(law).thickness(0.01))?;
        let state = near.solve(&near.controls(), &STRICT)?;
        assert!(state.u.iter().any(|u| *u > 1e-5));
    }
    Ok(())
}
