//! A rigid cylinder pressed into a half-space and drawn along it, beside Cattaneo and Mindlin (Johnson, Contact Mechanics (1985), section 7.2).
//! `cargo bench --bench hertz -- what=shear` has finer meshes.

use crate::common;

use common::Outcome;
use common::sheared::Sheared;

/// The part that sticks has the half-width `a (1 - Q/(mu P))^(1/2)`, to a cell, while it shrinks to less than three quarters of the contact.
#[test]
fn the_middle_of_a_sheared_contact_sticks() -> Outcome {
    let of = Sheared { fine: 8, far: 100.0 };
    let all = of.run()?;
    for at in &all {
        let [sticks, slides] = at.found;
        assert!((sticks - at.expected).abs() <= of.cell(), "{at:?}");
        // while less than a cell slides no node does
        assert!(slides.is_infinite() || (slides - at.expected).abs() <= of.cell(), "{at:?}");
    }
    let first = all.first().ok_or("no step")?;
    let last = all.last().ok_or("no step")?;
    assert!(
        first.share < 0.15 && last.share > 0.6 && last.found[1] < 0.75 && last.found[0] < 0.75,
        "{first:?} {last:?}"
    );
    Ok(())
}
