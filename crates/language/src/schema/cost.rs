//! The blocks of `costs`.

use crate::quantity::Want;
use crate::schema::cost_term::CostTerm;
use crate::schema::json::Definitions;
use crate::schema::key_value::KeyValue;
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::{Read, Reader, object};
use crate::schema::smoothed_hausdorff::SmoothedHausdorff;
use crate::schema::timing::When;
use crate::syntax::{At, Node};
use serde_json::{Value as Json, json};

/// A term of the cost; the cost is their sum.
#[derive(Clone, PartialEq, Debug)]
pub enum Cost {
    /// Distance between the deformed body and a target shape.
    SmoothedHausdorff(SmoothedHausdorff),
    /// Any other term: its keys are those of its row.
    Term(CostTerm),
}

/// The kind of the one cost that is no [`CostTerm`].
const HAUSDORFF: &str = "smoothed_hausdorff";

impl Cost {
    /// The term, of all but smoothed Hausdorff distances.
    #[must_use]
    pub fn term(&self) -> Option<&CostTerm> {
        match self {
            Self::SmoothedHausdorff(_) => None,
            Self::Term(term) => Some(term),
        }
    }

    /// The name in the case.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.term().map_or(HAUSDORFF, |term| term.form.name)
    }

    /// Whether it is the square of what it measures, with a derivative that vanishes where it does.
    #[must_use]
    pub fn is_square(&self) -> bool {
        self.term().is_some_and(|term| term.form.is_square)
    }

    /// Path of this block in the case.
    #[must_use]
    pub fn at(&self) -> &At {
        match self {
            Self::SmoothedHausdorff(block) => &block.at,
            Self::Term(term) => &term.at,
        }
    }

    /// Name in results: its own, or its kind.
    #[must_use]
    pub fn name(&self) -> &str {
        let own = match self {
            Self::SmoothedHausdorff(block) => &block.name,
            Self::Term(term) => &term.name,
        };
        own.as_deref().unwrap_or(self.kind())
    }

    /// Factor.
    #[must_use]
    pub fn weight(&self) -> f64 {
        match self {
            Self::SmoothedHausdorff(block) => block.weight,
            Self::Term(term) => term.weight,
        }
    }

    /// When it counts in a motion, where the case says so.
    #[must_use]
    pub fn when(&self) -> Option<&When> {
        match self {
            Self::SmoothedHausdorff(block) => block.when.as_ref(),
            Self::Term(term) => term.when.as_ref(),
        }
    }

    /// Whether it is a term of a motion, not of states.
    #[must_use]
    pub fn is_of_motion(&self) -> bool {
        self.term().is_some_and(CostTerm::is_of_motion)
    }

    /// Whether its target changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        self.term().is_some_and(|term| term.values.values().any(KeyValue::uses_time))
    }

    /// The term at an instant, where its target changes in time.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        let mut own = self.clone();
        if let Self::Term(term) = &mut own {
            term.values.values_mut().for_each(|value| *value = value.at_time(t));
        }
        own
    }

    /// The controls it refers to, with their places.
    pub(crate) fn controls(&self) -> impl Iterator<Item = (&str, At)> {
        self.term().into_iter().flat_map(CostTerm::controls)
    }

    /// The obstacles it refers to, with their places.
    pub fn shapes(&self) -> impl Iterator<Item = (&ShapeOrName, At)> {
        self.term().into_iter().flat_map(CostTerm::shapes)
    }
}

impl Read for Cost {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let forms = reader.document.catalogue().costs().to_vec();
        let known: Vec<&str> = [HAUSDORFF].into_iter().chain(forms.iter().map(|form| form.name)).collect();
        let kind = reader.tag(node, at, "kind", &known)?;
        match forms.into_iter().find(|form| form.name == kind) {
            Some(form) => CostTerm::read(form, node, at, reader).map(Self::Term),
            None => object(node, at, Some("kind"), reader).map(Self::SmoothedHausdorff),
        }
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        let mut kinds = vec![definitions.object::<SmoothedHausdorff>(Some(("kind", HAUSDORFF)))];
        let forms = definitions.catalogue.costs().to_vec();
        kinds.extend(forms.into_iter().map(|form| CostTerm::schema(form, definitions)));
        json!({ "oneOf": kinds })
    }
}
