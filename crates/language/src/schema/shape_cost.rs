//! Costs of positions, directions, curvatures and stretches.

use crate::expression::Formula;
use crate::schema::direction::Direction;
use crate::schema::read::Reader;
use crate::schema::timing::When;
use crate::schema::value::Vector;
use crate::syntax::quoted;
use nastic_mesh::GroupNames;

object! {
    /// weight/2 |x - target|^2 of the mean x of a surface, region or node set, or of one point.
    pub struct Position one of [surface, region, nodes, point] checked by check_target {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// A point of the body, at rest.
        pub point: Option<Vector> as LENGTH,
        /// Where it shall be; components left out are free.
        pub target: Box<Coordinates>,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// Coordinates of a position; those left out are free.
    pub struct Coordinates {
        /// x
        pub x: Option<Formula> as LENGTH_IN_TIME,
        /// y
        pub y: Option<Formula> as LENGTH_IN_TIME,
        /// z
        pub z: Option<Formula> as LENGTH_IN_TIME,
    }
}

object! {
    /// weight/2 int |n - direction|^2 over a surface, n its outward unit normal in the deformed body.
    pub struct Orientation {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Surface of the mesh.
        pub surface: GroupNames,
        /// Where its normals shall point.
        pub direction: Direction,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight/2 int (kappa - curvature)^2 along a line through points of the body, kappa its curvature about an axis.
    pub struct Curvature {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// The line at rest, at least three points of the body.
        pub line: Vec<Vector> as LENGTH,
        /// What is counted as positive turns about it; in plane strain z.
        pub axis: Option<Direction>,
        /// The curvature that is wanted, 1 over a radius.
        pub curvature: f64 as CURVATURE,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight times a smoothed maximum of the principal stretches, the power mean of exponent 2p over a region.
    pub struct LargestStretch {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Region of the mesh; the body if left out.
        pub region: Option<GroupNames>,
        /// p, from 1 to 32.
        pub exponent: usize as POSITIVE = 24,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight times the compliance of a surface: its mean displacement along a direction for each unit of force along it.
    pub struct Compliance {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// Surface of the mesh, on which the force is spread evenly.
        pub surface: GroupNames,
        /// Direction of force and displacement.
        pub direction: Direction,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

impl Coordinates {
    /// As an array.
    #[must_use]
    pub fn entries(&self) -> [Option<&Formula>; 3] {
        [self.x.as_ref(), self.y.as_ref(), self.z.as_ref()]
    }

    /// Those at an instant.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        let at = |entry: &Option<Formula>| entry.as_ref().map(|formula| formula.at_time(t));
        Self { x: at(&self.x), y: at(&self.y), z: at(&self.z), at: self.at.clone() }
    }

    /// Whether they change in time.
    #[must_use]
    pub fn use_time(&self) -> bool {
        self.entries().into_iter().flatten().any(Formula::uses_time)
    }
}

fn check_target(block: &Position, reader: &mut Reader<'_>) {
    for (axis, entry) in ["x", "y", "z"].into_iter().zip(block.target.entries()) {
        if let Some(formula) = entry.filter(|formula| formula.varies_in_space()) {
            let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(formula.text()));
            reader.complain_at(&block.target.at.key(axis), message);
        }
    }
    if block.target.entries().iter().all(Option::is_none) {
        reader.complain_at(&block.at.key("target"), "at least one coordinate is wanted: { \"x\": ..., \"z\": ... }");
    }
}
