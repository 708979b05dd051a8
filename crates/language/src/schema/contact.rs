//! The blocks of `contact`.

use crate::schema::catalogue::{SlotName, want};
use nastic_mesh::GroupNames;

object! {
    /// A surface of the body that an obstacle, another surface or itself pushes back, with friction or without.
    pub struct Contact one of [obstacle, with] {
        /// Name in results; its stiffness and friction are controlled as "NAME.stiffness" and "NAME.friction". "SURFACE on OBSTACLE" or "SURFACE with SURFACE" if left out.
        pub name: Option<String>,
        /// Surface of the mesh; "skin" is all of it, where no other surface has that name.
        pub surface: GroupNames,
        /// One of the case's obstacles.
        pub obstacle: Option<String>,
        /// Another surface of the mesh, of the same body or another one; or the same surface, which then touches itself.
        pub with: Option<GroupNames>,
        /// Pressure against the gap.
        pub law: PressureLaw = PressureLaw::Cubic,
        /// Thickness of the layer in which it acts; 1/500 of the surface's diagonal if left out; between surfaces no more than a quarter of their distance at rest.
        pub thickness: Option<f64> as POSITIVE_LENGTH,
        /// Pressure that closes the gap ("cubic"), 100 times Young's modulus behind the surface if left out; of "log" a tenth of it.
        pub stiffness: Option<f64> as POSITIVE_PRESSURE,
        /// Coefficient of Coulomb's friction, in motions alone; none if left out.
        pub friction: Option<f64> as NOT_NEGATIVE,
        /// Speed below which friction is smoothed: what sticks creeps at a share of it. 1/100 of the surface's diagonal (between surfaces of the smaller one) over the motion's end if left out.
        pub slip_speed: Option<f64> as POSITIVE_VELOCITY,
        /// Friction takes the normal forces of the instant before: cheaper steps, but a hold whose forces grow slips. For comparison.
        pub lagged: bool = false,
        /// Samples of each facet as of so many pieces squared; 1 to 4 as the obstacle's width and edges ask for if left out, between surfaces 2 in space and 1 in the plane.
        pub refine: Option<u64> as POSITIVE,
    }
}

choice! {
    /// Pressure against the gap d, of a thickness delta and a stiffness k.
    pub enum PressureLaw {
        /// k (1 - d/delta)^2 below delta, also inside of the obstacle.
        "cubic" => Cubic,
        /// The derivative of k delta (d/delta - 1)^2 ln(d/delta): a gap always remains.
        "log" => Log,
    }
}

impl Contact {
    /// Name in results.
    #[must_use]
    pub fn name(&self) -> String {
        let touched = match (&self.obstacle, &self.with) {
            (_, Some(with)) => format!("with {with}"),
            (obstacle, None) => format!("on {}", obstacle.as_deref().unwrap_or_default()),
        };
        self.name.clone().unwrap_or_else(|| format!("{} {touched}", self.surface))
    }

    /// Whether an obstacle is what it touches.
    #[must_use]
    pub fn is_on(&self, obstacle: &str) -> bool {
        self.obstacle.as_deref() == Some(obstacle)
    }

    /// How controls name what can be controlled of it, and that.
    #[must_use]
    pub fn slots(&self) -> Vec<(String, SlotName)> {
        let slot = |key, unit| {
            (format!("{}.{key}", self.name()), SlotName { key, want: want(unit), vector: false, not_negative: false })
        };
        let friction = self.friction.map(|_| slot("friction", "1"));
        [slot("stiffness", "Pa")].into_iter().chain(friction).collect()
    }
}

/// The same of the pose of an obstacle that contacts touch.
pub(crate) fn pose_slots(obstacle: &str) -> [(String, SlotName); 2] {
    [("translation", "m"), ("rotation", "1")].map(|(key, unit)| {
        (format!("{obstacle}.{key}"), SlotName { key, want: want(unit), vector: true, not_negative: false })
    })
}
