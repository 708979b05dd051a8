//! [`Layer`]: what contacts with obstacles and of surfaces are given alike.

use super::ContactLaw;
use super::friction::Friction;

/// What was given; `None` what is to be found.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Layer {
    pub law: ContactLaw,
    pub thickness: Option<f64>,
    pub stiffness: Option<f64>,
    pub friction: Option<Friction>,
    /// Friction takes its normal forces where the step begins.
    pub lagged: bool,
    pub refine: Option<usize>,
}

/// The methods of a builder whose `layer` is a [`Layer`].
macro_rules! layer_methods {
    () => {
        /// Another law of the pressure.
        #[must_use]
        pub fn law(mut self, law: ContactLaw) -> Self {
            self.layer.law = law;
            self
        }

        /// Thickness delta of the layer in which it acts, m; 1/500 of the surface's diagonal if not given; between surfaces of the smaller one, and no more
        /// than a quarter of their distance at rest.
        #[must_use]
        pub fn thickness(mut self, thickness: f64) -> Self {
            self.layer.thickness = Some(thickness);
            self
        }

        /// Stiffness k, Pa: of the cubic law the pressure that closes the gap, 100 times Young's modulus at rest behind the surface (of two the
        /// softer one) if not given; of the log law a tenth of that modulus.
        #[must_use]
        pub fn stiffness(mut self, stiffness: f64) -> Self {
            self.layer.stiffness = Some(stiffness);
            self
        }

        /// Coulomb's friction with a coefficient, smoothed below a slip speed (m/s).
        #[must_use]
        pub fn friction(mut self, coefficient: f64, slip_speed: f64) -> Self {
            self.layer.friction = Some($crate::contact::friction::Friction { coefficient, slip_speed });
            self
        }

        /// Friction takes normal forces, normals and places where the step begins, not where it ends: the tangent is symmetric and a step the minimum
        /// of a potential, but a hold whose forces grow by more than `1/r - 1` a step slips, r the share of the cone that it takes. For comparison.
        #[must_use]
        pub fn lagged(mut self) -> Self {
            self.layer.lagged = true;
            self
        }

        /// Samples of each facet as of `refine^2` pieces. If not given, between surfaces 2 in space, where edges that cross between samples carry nothing, and 1 in the plane, and before an obstacle of each facet as many (4 at most) as leave its samples no
        /// further apart than half of its least width, two at least where its edges are sharper than half of the facet: a sphere of radius R enters by
        /// `h^2/(8 R)` where they are h apart, and [`Touch::between`](nastic_body::contribution::touches::Touch::between) tells what is inside between them.
        #[must_use]
        pub fn refine(mut self, refine: usize) -> Self {
            self.layer.refine = Some(refine);
            self
        }
    };
}
pub(super) use layer_methods;
