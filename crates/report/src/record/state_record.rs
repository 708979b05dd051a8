//! [`StateRecord`]: what a result says of a state, or of several together.

use crate::record::{
    ByName, ContributionRecord, EquilibriaRecord, ExactContactRecord, FirstOrderRecord, FreeMotionRecord,
    HalfThicknessRecord, MemberRecord, ModesRecord, Nullable, Number, Numbers, SeriesRecord, TimeRecord,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

records! {
    /// Costs, distances, what a state says of itself, the work it took; below it those of scenarios and load cases.
    StateRecord {
        /// Of a load case: its weight in the cost.
        weight: Option<f64>,
        /// Of a scenario: its probability.
        probability: Option<f64>,
        /// Of a scenario: the values that it sets, by their paths in the case.
        set: Option<ByName<Value>>,
        /// Of a load case (`check`): the controls that are its own.
        own_controls: Option<Vec<String>>,
        /// Of a load case (`check`): its cost terms.
        terms: Option<Vec<String>>,
        /// Stage of the smoothed distances, counted from 0.
        stage: Option<usize>,
        /// The objective.
        cost: CostRecord,
        /// Of scenarios: measures of risk of their costs.
        risk: RiskRecord,
        /// Of a risk of first order: mean, deviation and where it comes from.
        first_order: Option<FirstOrderRecord>,
        /// Hausdorff distances from the target, of the first such term, and of each under its name where there are several.
        hausdorff: Option<HausdorffRecord>,
        /// By term `root_mean_square` and `largest` distance of the tracked points (quadrature points or nodes) from their targets.
        tracking: ByName<Numbers>,
        /// By term what other costs report of themselves, an `angle` say.
        figures: ByName<Numbers>,
        /// Smallest J at a quadrature point; of a motion over all its states.
        #[serde(rename = "min_J")]
        min_j: Number,
        /// Relative residual.
        residual: Number,
        /// Total potential; of a motion that of passive laws, actuations and loads at its end.
        potential: Number,
        /// Of an equilibrium: energies that it has stored. Those of a motion are in `time.energy_balance`.
        energy: Option<StoredEnergyRecord>,
        /// By name, or by load case and name.
        probes: Option<ByName<ProbesRecord>>,
        /// By contribution what it reports: `pressure` and `volume` of a chamber (the part that is modelled), `tension` and `length` of a tendon, what a contact carries.
        #[schemars(with = "ByName<Numbers>")]
        contributions: ByName<ContributionRecord>,
        /// By support, those that move too, the force (x, y, z) that it exerts on the body; at the end of a motion, every instant's are in `motion.csv`.
        reactions: Option<ByName<Vec<Number>>>,
        /// Negative pivots of the tangent: 0 is a stable equilibrium, null where they were not counted.
        inertia: Nullable<usize>,
        /// Whether a factor shows it, by its pivots or by conjugate gradients with it; false where these had none and met no negative curvature, which is no proof.
        inertia_by_factor: Option<bool>,
        /// Why they were not counted.
        inertia_missing: Option<UncountedRecord>,
        /// What contact alone holds and nothing that touches it: it may roll or slide on, and rests where it came to.
        free_motion: Option<FreeMotionRecord>,
        /// Where the deformed body intersects itself.
        self_intersection: Option<IntersectionRecord>,
        /// Load steps of a solve.
        load_steps: Option<usize>,
        /// Newton iterations: of this state, of all members, of all trials of an optimisation.
        newton_iterations: Option<usize>,
        /// Factorisations of the tangent.
        factorisations: Option<usize>,
        /// Factors that were used once more.
        reused_factorisations: Option<usize>,
        /// Solves with a factor.
        back_substitutions: Option<usize>,
        /// Hierarchies of multigrid.
        multigrid_hierarchies: Option<usize>,
        /// Cycles of multigrid.
        multigrid_cycles: Option<usize>,
        /// Systems solved with products of cells in the place of an assembled tangent; 0 where a contribution, the cells or the solver need a matrix.
        unassembled_systems: Option<usize>,
        /// Load or time steps that were cut.
        load_steps_cut: Option<usize>,
        /// What was tried beside Newton's method on the displacement, and how often.
        strategies: ByName<usize>,
        /// The solver of linear systems.
        linear_solver: Option<String>,
        /// The motion.
        time: Option<TimeRecord>,
        /// Equilibria and critical values of `solve --ramp`.
        ramp: Option<SeriesRecord>,
        /// Equilibria, limit points and bifurcations of `solve --path`.
        path: Option<SeriesRecord>,
        /// What `solve --equilibria` found.
        equilibria: Option<EquilibriaRecord>,
        /// The equilibrium without contact layers, of `solve --exact-contact`.
        exact_contact: Option<ExactContactRecord>,
        /// The state whose contact layers are half as thick, of `solve --half-thickness`.
        half_thickness: Option<HalfThicknessRecord>,
        /// Modes of the tangent (`solve --modes`) or of small vibrations (`modes`).
        modes: ModesRecord,
        /// The same of each scenario.
        scenarios: ByName<StateRecord>,
        /// The same of each load case.
        load_cases: ByName<StateRecord>,
    }

    /// The sum of costs and its terms, weights included.
    CostRecord {
        /// The sum; of scenarios their measure of risk.
        total: Number,
        /// By name; of scenarios their expected values.
        terms: Numbers,
    }

    /// Energies that an equilibrium has stored.
    StoredEnergyRecord {
        /// Stored without controls by laws, springs and foundations.
        elastic: Number,
        /// Stored in the layers of contacts.
        contact: Number,
    }

    /// Measures of risk of the scenarios' costs.
    RiskRecord {
        /// The one that is optimised.
        measure: String,
        /// Its value, as it is optimised.
        value: Number,
        /// The same without its smoothing, if it has one: the worst of all costs, say.
        exact: Number,
        /// Standard deviation of the costs.
        deviation: Number,
        /// Every measure by name.
        measures: Option<ByName<MeasureRecord>>,
    }

    /// One of them.
    MeasureRecord {
        /// As it is optimised.
        value: Number,
        /// Without its smoothing, if it has one.
        exact: Number,
        /// The share of scenarios that it does not look at.
        level: Option<f64>,
    }

    /// Distances from a target shape.
    HausdorffRecord {
        /// The smoothed distance rho, weight not included.
        smoothed: Number,
        /// The Hausdorff distance.
        #[serde(rename = "true")]
        exact: Number,
        /// rho of the target with itself.
        #[serde(rename = "self")]
        floor: Number,
        /// The same by term, where there are several.
        #[serde(flatten)]
        terms: ByName<HausdorffRecord>,
    }

    /// Why negative pivots were not counted.
    UncountedRecord {
        /// Whether the tangent is singular; else nothing is known of it.
        singular: bool,
        /// The reason.
        why: Option<String>,
    }

    /// Cells that lie in others.
    IntersectionRecord {
        /// How many.
        cells: usize,
        /// Deformed volume of those whose centres lie in others.
        volume: Number,
    }
}

/// The displacement of a probe; of several scenarios the mean, and its standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProbeRecord {
    /// Its place in the reference body.
    #[serde(default)]
    pub point: Vec<Number>,
    /// Its displacement.
    pub displacement: Vec<Number>,
    /// Its place in the deformed body.
    pub position: Vec<Number>,
    /// Standard deviations of the components.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation: Option<Vec<Number>>,
}

/// A probe, or those of a load case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ProbesRecord {
    /// A probe.
    One(ProbeRecord),
    /// Those of a load case.
    OfLoadCase(ByName<ProbeRecord>),
}

impl HausdorffRecord {
    /// The three distances, of the first such term.
    #[must_use]
    pub fn distances(&self) -> [Option<f64>; 3] {
        [self.smoothed, self.exact, self.floor].map(|distance| *distance)
    }
}

impl RiskRecord {
    /// The value without smoothing, of a measure that is smoothed.
    #[must_use]
    pub fn unsmoothed(&self) -> Option<f64> {
        *self.exact
    }

    /// What it measures: `worst case over 5 scenarios`.
    #[must_use]
    pub fn words(&self, scenarios: usize) -> String {
        let level = self.measures.as_ref().and_then(|all| all.get(&self.measure)?.level);
        format!("{} over {scenarios} scenarios", crate::tables::measure(&self.measure, level))
    }
}

impl MeasureRecord {
    /// Without its smoothing, if it has one, else as it is.
    #[must_use]
    pub fn plain(&self) -> Option<f64> {
        (*self.exact).or(*self.value)
    }
}

impl StateRecord {
    /// What is said of a member; nothing where its scenario or load case is missing.
    #[must_use]
    pub fn member(&self, member: &MemberRecord) -> Option<&Self> {
        let scenario = member.scenario.as_ref().map_or(Some(self), |name| self.scenarios.get(name))?;
        member.load_case.as_ref().map_or(Some(scenario), |name| scenario.load_cases.get(name))
    }

    /// What is known of an equilibrium without negative pivots.
    pub fn no_negative(&self) -> &'static str {
        match self.inertia_by_factor {
            Some(false) => {
                "conjugate gradients met no negative curvature of the tangent; without a factor that is no proof"
            }
            _ => "no negative pivot of the tangent",
        }
    }

    /// The entries of a member, made where there are none yet.
    pub fn member_mut(&mut self, scenario: Option<&str>, load_case: Option<&str>) -> &mut Self {
        let scenario = match scenario {
            Some(name) => self.scenarios.entry(name.to_owned()).or_default(),
            None => self,
        };
        match load_case {
            Some(name) => scenario.load_cases.entry(name.to_owned()).or_default(),
            None => scenario,
        }
    }

    /// All members with their names, of a case that is not plain.
    #[must_use]
    pub fn members(&self) -> Vec<(String, &Self)> {
        let mut out = Vec::new();
        for (name, scenario) in &self.scenarios {
            if scenario.load_cases.is_empty() {
                out.push((name.clone(), scenario));
            }
            out.extend(scenario.load_cases.iter().map(|(case, state)| (format!("{name}/{case}"), state)));
        }
        out.extend(self.load_cases.iter().map(|(name, state)| (name.clone(), state)));
        out
    }
}
