//! [`Block`]: an entry of a case that adds a contribution of its own to the body.

use crate::quantity::Units;
use crate::syntax::At;
use nastic_fem::{BodyPoint, FemError, Instant, Solid};

/// An entry of a block of the case that adds a contribution to the body: all that the program does with one, but for its entry in results. The rows of
/// `schema/case.rs` name the blocks.
pub trait Block {
    /// What it is: `spring`.
    fn kind(&self) -> &'static str;

    /// What `nastic check` writes in front of such entries: `springs`.
    fn head(&self) -> &'static str;

    /// Path of the entry in the case.
    fn at(&self) -> &At;

    /// The name in results.
    fn name(&self) -> String;

    /// The body with the contribution.
    ///
    /// # Errors
    /// What the body lacks, or a number out of range.
    fn attach(&self, solid: Solid) -> Result<Solid, FemError>;

    /// The entry as it was understood, with what it does where the body is at rest.
    fn words(&self, solid: &Solid, units: &Units) -> String;

    /// Its stiffness in all, under the key `stiffness`; nothing of one that has none.
    fn stiffness(&self) -> Option<f64> {
        None
    }

    /// A key whose value looks like one in another unit, and why.
    fn doubt(&self, _solid: &Solid, _units: &Units) -> Option<(&'static str, String)> {
        None
    }

    /// Why it moves nothing, where these points are held.
    fn idle(&self, _is_held: &dyn Fn(&BodyPoint) -> bool) -> Option<&'static str> {
        None
    }
}

/// A number that a contribution reports of itself where the body is at rest.
#[must_use]
pub fn at_rest(solid: &Solid, name: &str, quantity: &str) -> Option<f64> {
    let rest = solid.rest();
    let all = solid.model().quantities(&Instant::new(&rest.u, &rest.controls, 0.0)).ok()?;
    all.into_iter().find(|(of, what, _)| of == name && *what == quantity).map(|(.., value)| value)
}
