use crate::Entry;
use crate::formula::FormulaError;
use crate::network::NetworkError;

/// What can be wrong with an energy term: its parameters, its directions, the size of its fields, its name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EnergyError {
    /// A law or actuation without the derivatives that second derivatives of a cost are made of.
    #[error(
        "{owner} gives no second derivatives of its stress; implement `{method}`, or do without second derivatives of costs"
    )]
    NoSecondDerivatives {
        /// Type of the law or actuation.
        owner: &'static str,
        /// What it would have to implement.
        method: &'static str,
    },
    /// A law without parameters that could be unknowns.
    #[error(
        "the parameters of {owner} cannot be unknowns: a law of your own implements `LinearInModuli` and is made by `Made::linear`"
    )]
    NoParameters {
        /// The law, by its catalogue name.
        owner: &'static str,
    },
    /// A law that was to map strains and has an energy instead.
    #[error("{owner} maps no strains: a growth is a law with a `StrainMap`")]
    NoStrainMap {
        /// The law.
        owner: String,
    },
    /// Displacement fields by which no shape can change.
    #[error("shape: the modes are names with fields of displacements that differ: {why}")]
    ShapeModes {
        /// What is wrong with them.
        why: String,
    },
    /// A law that another one cannot stand around.
    #[error("{owner} cannot stand around this law: {why}")]
    Wrapped {
        /// What was to stand around it.
        owner: &'static str,
        /// Why not.
        why: &'static str,
    },
    /// A number of a law that is no parameter as which unknowns are possible.
    #[error(
        "{name:?} of {owner} cannot be an unknown{}; a law that depends on it otherwise than linearly can be written as a \"formula\", all of whose parameters can",
        if .known.is_empty() { String::new() } else { format!(": {} can", .known.join(", ")) }
    )]
    NotLinear {
        /// The law, by its catalogue name.
        owner: &'static str,
        /// The number.
        name: String,
        /// Those that can.
        known: Vec<&'static str>,
    },
    /// A formula that is no energy of a law.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// Numbers that are no network whose energy is polyconvex.
    #[error("convex_network: {0}")]
    Network(#[from] NetworkError),
    /// A parameter outside the range in which the law is polyconvex, or not finite.
    #[error("{owner}: {name} = {value:e}{entry}, but {requirement}")]
    Parameter {
        /// The law or actuation, by its catalogue name.
        owner: &'static str,
        /// The parameter.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Where in the field it was found.
        entry: Entry,
        /// What it has to satisfy.
        requirement: &'static str,
    },
    /// A direction that is not a unit vector.
    #[error("{owner}: {name} = {found:?}{entry} has length {length}, not 1; {}", offer(.unit))]
    Direction {
        /// The law or actuation, by its catalogue name.
        owner: &'static str,
        /// The direction.
        name: &'static str,
        /// The vector found.
        found: [f64; 3],
        /// Where in the field it was found.
        entry: Entry,
        /// Its length.
        length: f64,
        /// The same direction with length one, where there is one.
        unit: Option<[f64; 3]>,
    },
    /// Engineering constants that no polyconvex member of the family has.
    #[error(
        "{owner}: {name} = {value:e}{entry} must not be {}negative: shear {shear:e}, bulk {bulk:e}, share {share} give \
         bulk/shear = {:.6}, which must exceed 8/3 - 2 share = {:.6}; {}",
        if *.value == 0.0 { "zero or " } else { "" }, .bulk / .shear, 8.0 / 3.0 - 2.0 * .share, better_share(*.shear, *.bulk)
    )]
    Inadmissible {
        /// The law, by its catalogue name.
        owner: &'static str,
        /// The derived parameter that fails.
        name: &'static str,
        /// Its value, unit of stress.
        value: f64,
        /// Where in the fields it was found.
        entry: Entry,
        /// Shear modulus there.
        shear: f64,
        /// Bulk modulus there.
        bulk: f64,
        /// Share of the shear modulus carried by `|F|^2`.
        share: f64,
    },
    /// A field whose length is not the number of cells, or of quadrature points, of its body.
    #[error("{owner}: {name} has {found} values, one per {per}, but the body has {expected} {per}s")]
    Length {
        /// The law or actuation, by its catalogue name.
        owner: &'static str,
        /// The field.
        name: &'static str,
        /// `cell` or `quadrature point`.
        per: &'static str,
        /// How many it should have.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// Fields that have to be combined value by value but are not given on the same entities.
    #[error(
        "{owner}: {first} and {second} must be given alike: {first} has {first_len} values per {first_per}, \
         {second} has {second_len} per {second_per}; sample both per cell, or both per quadrature point"
    )]
    Mixed {
        /// The law, by its catalogue name.
        owner: &'static str,
        /// One field.
        first: &'static str,
        /// Its number of values.
        first_len: usize,
        /// `cell` or `quadrature point`.
        first_per: &'static str,
        /// The other field.
        second: &'static str,
        /// Its number of values.
        second_len: usize,
        /// `cell` or `quadrature point`.
        second_per: &'static str,
    },
    /// A name that is not in the catalogue.
    #[error("no {what} is called `{found}`{}; there are: {}", nearest(.found, .known), .known.join(", "))]
    UnknownName {
        /// `law`, `actuation`, `parameter of mooney_rivlin` ...
        what: String,
        /// The name asked for.
        found: String,
        /// The names there are.
        known: Vec<&'static str>,
    },
    /// A parameter that was not given.
    #[error("{owner} needs {name}{}; it takes {forms}", given_list(.given))]
    Missing {
        /// The law or actuation, by its catalogue name.
        owner: &'static str,
        /// The parameter.
        name: &'static str,
        /// What was given.
        given: Vec<String>,
        /// All parameter sets it takes.
        forms: String,
    },
    /// Parameters of two different sets in one law.
    #[error("{owner}: {first} and {second} belong to different parameter sets; it takes {forms}")]
    Conflict {
        /// The law, by its catalogue name.
        owner: &'static str,
        /// A parameter of one set.
        first: &'static str,
        /// A parameter of another.
        second: &'static str,
        /// All parameter sets it takes.
        forms: String,
    },
    /// A number where a direction belongs, or the other way round.
    #[error("{owner}: {name} must be {expected}")]
    Kind {
        /// The law or actuation, by its catalogue name.
        owner: &'static str,
        /// The parameter.
        name: &'static str,
        /// What it must be.
        expected: &'static str,
    },
}

/// A deformation beyond the domain of a law: its energy is infinite there.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{law}: {}, {meaning}; take a smaller step", beyond(measure, *value, *limit))]
pub struct Outside {
    /// The law, by its catalogue name.
    pub law: &'static str,
    /// What is bounded.
    pub measure: &'static str,
    /// What was found (NaN where the deformation is).
    pub value: f64,
    /// What it must stay below.
    pub limit: f64,
    /// What the limit is.
    pub meaning: &'static str,
    /// Quadrature point within the cell.
    pub point: usize,
}

fn beyond(measure: &str, value: f64, limit: f64) -> String {
    match value.is_nan() {
        true => format!("{measure} has no value there"),
        false => format!("{measure} = {value:.6e} is beyond {limit:.6e}"),
    }
}

fn offer(unit: &Option<[f64; 3]>) -> String {
    match unit {
        Some(u) => format!("the unit vector along it is {u:?}"),
        None => "it has no direction".to_owned(),
    }
}

impl EnergyError {
    /// The refusal of a law of type `T` that does not implement a method.
    pub(crate) fn no_second_derivatives<T: ?Sized>(method: &'static str) -> Self {
        EnergyError::NoSecondDerivatives { owner: std::any::type_name::<T>(), method }
    }
}

fn better_share(shear: f64, bulk: f64) -> String {
    let least = (8.0 / 3.0 - bulk / shear) / 2.0;
    if least < 1.0 {
        format!("take a share above {least:.6}")
    } else {
        "no share below 1 is enough: take neo_hooke, which allows any bulk/shear >= 2/3".to_owned()
    }
}

fn given_list(given: &[String]) -> String {
    if given.is_empty() { " (nothing was given)".to_owned() } else { format!(" (given: {})", given.join(", ")) }
}

fn nearest(found: &str, known: &[&'static str]) -> String {
    let best = known.iter().map(|name| (edits(found, name), name)).min();
    match best {
        Some((distance, name)) if distance <= 1 + found.len() / 3 => format!(" (did you mean `{name}`?)"),
        _ => String::new(),
    }
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut corner = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let change = corner + usize::from(x != *y);
            corner = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}
