//! What is asked of a [`Model`], by subject: each a value that [`Model`] hands out.

use super::Model;

macro_rules! subjects {
    ($($about:literal $accessor:ident $name:ident;)*) => {
        $(
            #[doc = concat!($about, ": [`Model::", stringify!($accessor), "`].")]
            #[derive(Debug, Clone, Copy)]
            pub struct $name<'a> {
                pub(crate) model: &'a Model,
            }
        )*

        impl Model {
            $(
                #[doc = concat!($about, ".")]
                pub fn $accessor(&self) -> $name<'_> {
                    $name { model: self }
                }
            )*
        }
    };
}

subjects! {
    "What is asked of the stability of a model: pivots, modes, paths, other equilibria" stability Stability;
    "The internal variables of a model: those of a step, how they go on, and the transpose" memory InternalVariables;
    "The unknowns of a model that contributions hold at values of their controls" prescribed_unknowns PrescribedUnknowns;
    "The tangents of a model, assembled or by products" tangents Tangents;
    "A model over ranks" ranks OverRanks;
    "Which moves every contribution of a model bears, and where one leads" moves Moves;
    "Whether a model, a state, controls are complete for what is asked" checks Checks;
    "What holds of all contributions of a model" properties Properties;
    "Mass, energies and damping of a model" energies Energies;
}
