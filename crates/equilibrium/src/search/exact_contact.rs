//! [`Stability::exact_contact`]: an equilibrium whose contacts have no layer.

use crate::linear_systems::workspace::Workspace;
use crate::model::views::Stability;
use crate::model::{Feature, Model};
use crate::search::options::SolveOptions;
use nastic_body::contribution::Contribution;
use nastic_body::error::StateError;
use nastic_body::instant::Instant;
use nastic_body::state::{SolveReport, State};
use std::sync::Arc;

/// Largest remaining gap, as a share of the layer's thickness.
const GAP_TOLERANCE: f64 = 1e-6;
/// Equilibria that are solved for.
const MAX_SOLVES: usize = 60;

/// An equilibrium whose contacts have no layer.
#[derive(Debug, Clone)]
pub struct ExactEquilibrium {
    /// The model with the multipliers of its contacts: it knows what they carry.
    pub model: Model,
    /// The equilibrium, with the work of all rounds and of the first one in its report.
    pub state: State,
    /// Equilibria that it took.
    pub rounds: usize,
    /// Largest gap of a sample that is pressed, and depth of one that is not, in thicknesses of the layer.
    pub violation: f64,
    /// Samples that touch almost without a pressure: derivatives have another value on either side there.
    pub weakly_active: usize,
}

impl Model {
    /// The model with the multipliers of a state, how far that is from exact, and the number of weakly active samples.
    fn with_multipliers(&self, at: &Instant) -> (Model, f64, usize) {
        let (mut violation, mut weakly_active) = (0.0_f64, 0);
        let model = self.with_others(at, |contribution, at| {
            let exact = contribution.touches()?.exact(at)?;
            violation = violation.max(exact.violation);
            weakly_active += exact.weakly_active;
            Some(exact.contribution)
        });
        (model, violation, weakly_active)
    }

    /// With other contributions in the place of some, which have the same slots and couplings.
    fn with_others(
        &self,
        at: &Instant,
        mut instead: impl FnMut(&dyn Contribution, &Instant) -> Option<Arc<dyn Contribution>>,
    ) -> Model {
        let mut others = Vec::new();
        let Ok(()) = self.each_other(at, |contribution, at| {
            others.push(instead(contribution, at));
            Ok::<(), std::convert::Infallible>(())
        });
        self.replacing(others)
    }
}

impl Stability<'_> {
    /// From an equilibrium to the one of exact contact, `g >= 0, p >= 0, g p = 0` at every sample, for verification: by multipliers around the
    /// cubic law, until gaps are 1e-6 of its layer. It depends on the layer's thickness and stiffness no longer.
    ///
    /// # Errors
    /// [`FemError::Unsupported`](nastic_body::error::FemError) without a contact, with the log law, friction or surfaces of bodies;
    /// [`StateError::InexactContact`]; as [`Model::solve`].
    pub fn exact_contact(
        &self,
        from: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<ExactEquilibrium, StateError> {
        self.model.properties().supports(Feature::ExactContact)?;
        let (mut model, mut state) = (self.model.clone(), from.clone());
        let mut work = SolveReport::default();
        let mut violation = f64::INFINITY;
        for rounds in 0..MAX_SOLVES {
            let weakly_active;
            (model, violation, weakly_active) = model.with_multipliers(&Instant::of(&state));
            if violation <= GAP_TOLERANCE {
                state.report.add_work(&work);
                return Ok(ExactEquilibrium { model, state, rounds, violation, weakly_active });
            }
            work.add_work(&state.report);
            let controls = state.controls.clone();
            state = model.solve_with(&controls, &SolveOptions { near: Some(&state), ..how.clone() }, workspace)?;
        }
        Err(StateError::InexactContact { violation, rounds: MAX_SOLVES })
    }
}
