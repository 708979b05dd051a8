//! The blocks of `constraints`.

use crate::schema::cost::Cost;
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::Reader;
use crate::schema::timing::HoldsWhen;
use nastic_mesh::GroupNames;

object! {
    /// A condition that the optimum must fulfil: nodes keep clear of an obstacle, or a bound on a functional.
    pub struct Constraint one of [obstacle, cost] checked by check_bound {
        /// Name in results; "obstacle" or the kind of the functional if left out.
        pub name: Option<String>,
        /// Nodes keep clear of an obstacle.
        pub obstacle: Option<KeepOut>,
        /// A functional, as a term of the cost is written.
        pub cost: Option<Cost>,
        /// Its upper bound.
        pub at_most: Option<f64> as NUMBER,
        /// Its lower bound.
        pub at_least: Option<f64> as NUMBER,
        /// The value that it must have.
        pub equal: Option<f64> as NUMBER,
        /// At which instants of a motion it holds: an obstacle always, a bound on a functional at the end, if left out.
        pub when: Option<HoldsWhen>,
        /// A value that counts as large, in which violations of the bound are measured; the bound's absolute value if left out.
        pub scale: Option<f64> as POSITIVE,
    }
}

object! {
    /// Every node keeps at least the clearance from an obstacle.
    pub struct KeepOut one of [surface, region, nodes] {
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// The obstacle: a shape, or the name of one of `obstacles`, where it is not moved.
        pub shape: ShapeOrName,
        /// The distance to keep.
        pub clearance: f64 as LENGTH = 0.0,
    }
}

impl Constraint {
    /// Name in results.
    #[must_use]
    pub fn name(&self) -> &str {
        let kind = self.cost.as_ref().map_or("obstacle", Cost::name);
        self.name.as_deref().unwrap_or(kind)
    }
}

fn check_bound(block: &Constraint, reader: &mut Reader<'_>) {
    let bounds = [block.at_most, block.at_least, block.equal].iter().flatten().count();
    if block.cost.is_some() && bounds != 1 {
        let message = "a bounded functional needs exactly one of \"at_most\", \"at_least\" and \"equal\"";
        reader.complain_at(&block.at, message);
    }
    if block.obstacle.is_some() && (bounds > 0 || block.scale.is_some()) {
        let message = "an obstacle has no bound: \"clearance\" in its block is the distance to keep";
        reader.complain_at(&block.at, message);
    }
    let bound = block.at_most.or(block.at_least).or(block.equal);
    if block.cost.is_some() && bound == Some(0.0) && block.scale.is_none() {
        let message = "a bound of zero needs a \"scale\": a value of the functional that counts as large";
        reader.complain_at(&block.at, message);
    }
    if let Some(cost) = block.cost.as_ref().filter(|cost| bound == Some(0.0) && cost.is_square()) {
        let kind = cost.kind();
        let never_below = format!("\"{kind}\" is a square, which is never below zero: leave this bound out");
        let message = format!(
            "\"{kind}\" is a square: where it is zero its derivative is zero too, and no multiplier can hold it there; bound it by the \
             square of what is near enough: \"at_most\""
        );
        reader.complain_at(&block.at, if block.at_least.is_some() { never_below } else { message });
    }
    if block.cost.as_ref().is_some_and(|cost| cost.weight() == 0.0) {
        reader.complain_at(&block.at.key("cost"), "the weight is zero: the functional is zero, whatever the state");
    }
}
