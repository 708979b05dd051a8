//! [`AssemblyError`]: why a program's problem cannot be run as that of a case file is.

use nastic_opt::Outside;

/// What does not fit the problem.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AssemblyError {
    /// Two members have different meshes.
    #[error(
        "{member} and {other} have different meshes, and probes, pictures and the mean of scenarios need one: make the bodies of all \
         members on one mesh"
    )]
    Mesh {
        /// A member.
        member: String,
        /// The first member.
        other: String,
    },
    /// Two scenarios have different load cases.
    #[error(
        "{member} and {other} are of scenarios with different load cases: that of {other} has no \"{load_case}\"; results are compared \
         by load case, so give every scenario the same"
    )]
    LoadCases {
        /// The member whose load case the other scenario lacks.
        member: String,
        /// A member of the other scenario.
        other: String,
        /// The load case.
        load_case: String,
    },
    /// A set of vectors with another number of components than the control has.
    #[error(
        "the vectors of the set of \"{control}\" have {dim} components, the values of the control {components}: make the set for \
         {components}, or give bounds"
    )]
    Components {
        /// The control.
        control: String,
        /// Components of the set's vectors.
        dim: usize,
        /// Components of the control.
        components: usize,
    },
    /// Vectors of one length at the nodes, which are shorter between them.
    #[error(
        "\"{control}\" is a nodal field on a sphere, whose vectors are shorter than {radius} between the nodes: give them their length \
         everywhere with Reduced::of_length(\"{control}\", {radius:?})"
    )]
    NodalSphere {
        /// The control.
        control: String,
        /// The radius of the sphere.
        radius: f64,
    },
    /// Random starts of a control that is not bounded.
    #[error(
        "random starts are drawn within the bounds, and \"{control}\" has no {missing}: give it one with Study::within"
    )]
    RandomStart {
        /// The control.
        control: String,
        /// What it lacks.
        missing: &'static str,
    },
    /// A value of a control's start lies outside its set, or the set has another number of components than the control has values.
    #[error("the start of \"{control}\" at {place} lies outside its set: {source}")]
    Start {
        /// The control.
        control: String,
        /// Cell, node or region.
        place: String,
        /// What is allowed.
        source: Outside,
    },
    /// A start with another number of values than the control has.
    #[error("\"{control}\" has {expected} values, its start {found}")]
    Length {
        /// The control.
        control: String,
        /// Values of the start.
        found: usize,
        /// Values of the control.
        expected: usize,
    },
    /// A control bears the name of a result.
    #[error("results have an array \"{control}\" already: give the actuation another name")]
    Reserved {
        /// The control.
        control: String,
    },
    /// A probe lies outside the body.
    #[error("probe \"{name}\": {what}")]
    Probe {
        /// Its name.
        name: String,
        /// Where it lies.
        what: String,
    },
}
