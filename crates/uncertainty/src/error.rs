//! Errors of random parameters.

use nastic_energy::EnergyError;
use thiserror::Error;

/// A law or a rule that makes no sense, or a node that is no material.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StochasticError {
    /// A parameter of a law out of range.
    #[error("{law} law: {name} is {value}; it {must}")]
    Parameter {
        /// The law.
        law: &'static str,
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A rule that cannot be built as asked.
    #[error("{rule} rule: {what}")]
    Rule {
        /// The rule.
        rule: &'static str,
        /// What is wrong and what to try.
        what: String,
    },
    /// A node whose parameters are no material.
    #[error(
        "node {node} of {nodes} (probability {probability:.3e}) is no material: shear {shear:e}, bulk {bulk:e}, share \
         {share}: {source}; raise the mean of the bulk modulus or narrow the laws, take fewer Gauss nodes, or leave such \
         nodes out (\"inadmissible\": \"truncate\"), which renormalises the probabilities of the others"
    )]
    Inadmissible {
        /// Index of the node.
        node: usize,
        /// How many there are.
        nodes: usize,
        /// Its probability.
        probability: f64,
        /// Shear modulus, Pa.
        shear: f64,
        /// Bulk modulus, Pa.
        bulk: f64,
        /// Share of the shear modulus in the first coefficient.
        share: f64,
        /// Why.
        source: Box<EnergyError>,
    },
    /// No node is left.
    #[error(
        "of {nodes} nodes none is a material (or those that are have no positive weight); check the means of the shear \
         and bulk modulus: the bulk modulus must exceed (8/3 - 2 share) times the shear modulus"
    )]
    NothingLeft {
        /// How many there were.
        nodes: usize,
    },
}
