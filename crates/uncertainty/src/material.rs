//! [`StochasticMooneyRivlin`]: random moduli, mapped to materials.

use super::{Beta, Gamma, Law, Sample, StochasticError};
use nastic_energy::MooneyRivlin;

/// A Mooney-Rivlin law of random moduli: shear and bulk modulus Gamma, their share Beta, all independent.
///
/// `mu1 = mu U/2`, `mu2 = mu (1-U)/2`, `mu3 = (kappa + mu (2U - 8/3))/2`
/// ([`MooneyRivlin::from_shear_bulk`]), so `mu1 + mu2 = mu/2`. Under independent Gamma laws `mu3 <= 0` has a positive
/// probability: [`Inadmissible`] says what happens then. Units: Pa; the share has none.
///
/// Source: survey, section 2.1.3 (with the factor 1/2 of docs/model/survey-slips.md).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StochasticMooneyRivlin {
    /// Shear modulus mu.
    pub shear: Gamma,
    /// Bulk modulus kappa.
    pub bulk: Gamma,
    /// Share U of the shear modulus in the first coefficient.
    pub share: Beta,
}

/// What to do with a node that is no material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Inadmissible {
    /// It is an error that names the node and the cure.
    #[default]
    Refuse,
    /// It is left out; the probabilities of the others are scaled up to sum to one.
    Truncate,
}

/// A material with its probability.
#[derive(Clone, Debug)]
pub struct MaterialScenario {
    /// Index of its node in the rule.
    pub node: usize,
    /// Probability (a weight that may be negative, in sparse rules).
    pub probability: f64,
    /// Shear modulus, Pa.
    pub shear: f64,
    /// Bulk modulus, Pa.
    pub bulk: f64,
    /// Share of the shear modulus in the first coefficient.
    pub share: f64,
    /// The law.
    pub law: MooneyRivlin,
}

/// The materials of a rule.
#[derive(Clone, Debug)]
pub struct MaterialScenarios {
    /// The materials, in the order of the nodes.
    pub scenarios: Vec<MaterialScenario>,
    /// Nodes that were left out.
    pub left_out: Vec<usize>,
    /// Their probability, before it was given to the others.
    pub lost: f64,
}

impl StochasticMooneyRivlin {
    /// The three laws in the order of the nodes: shear, bulk, share.
    pub fn laws(&self) -> [&dyn Law; 3] {
        [&self.shear, &self.bulk, &self.share]
    }

    /// The materials at the nodes of a rule over [`laws`](Self::laws).
    ///
    /// # Errors
    /// [`StochasticError::Inadmissible`] at the first node with `mu3 <= 0`, unless such nodes are truncated;
    /// [`StochasticError::NothingLeft`] if none remains.
    pub fn scenarios(&self, rule: &Sample, treat: Inadmissible) -> Result<MaterialScenarios, StochasticError> {
        let mut out = MaterialScenarios { scenarios: vec![], left_out: vec![], lost: 0.0 };
        for (node, (x, &probability)) in rule.nodes.iter().zip(&rule.weights).enumerate() {
            let &[shear, bulk, share] = x.as_slice() else {
                let what = format!("node {node} has {} numbers; shear, bulk and share are three", x.len());
                return Err(StochasticError::Rule { rule: "material", what });
            };
            match MooneyRivlin::from_shear_bulk(shear, bulk, share) {
                Ok(law) => {
                    out.scenarios.push(MaterialScenario { node, probability, shear, bulk, share, law });
                }
                Err(_) if treat == Inadmissible::Truncate => {
                    out.left_out.push(node);
                    out.lost += probability;
                }
                Err(source) => {
                    let (nodes, source) = (rule.len(), Box::new(source));
                    return Err(StochasticError::Inadmissible { node, nodes, probability, shear, bulk, share, source });
                }
            }
        }
        let kept: f64 = out.scenarios.iter().map(|s| s.probability).sum();
        if kept <= 0.0 {
            return Err(StochasticError::NothingLeft { nodes: rule.len() });
        }
        if !out.left_out.is_empty() {
            out.scenarios.iter_mut().for_each(|s| s.probability /= kept);
        }
        Ok(out)
    }
}
