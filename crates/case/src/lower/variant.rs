//! The members of a problem as cases of their own: every load case of every scenario.

use super::context::Context;
use super::scenario::Scenario;
use super::uncertain::Uncertain;
use crate::warning::INPUT;
use nastic_language::quantity::Units;
use nastic_language::schema::{Case, Input, LoadCase, Parameter};
use nastic_language::syntax::{At, Diagnostic, Diagnostics, Document, Setting};
use std::sync::Arc;

/// The case as one member sees it: its values, and all blocks that count for it.
#[derive(Debug)]
pub(super) struct Variant {
    /// Index of its scenario.
    pub scenario: usize,
    /// Index of its load case in the case, if there are any.
    pub load_case: Option<usize>,
    /// Name of its load case, else empty.
    pub case_name: String,
    /// Weight in the cost of its scenario.
    pub weight: f64,
    /// Scenario and load case, for messages.
    pub name: String,
    /// What its files' names begin with.
    pub stem: String,
    /// The same without its scenario.
    pub case_stem: String,
    /// With the values and blocks of this member.
    pub case: Case,
    /// With the values of this member, for messages.
    pub document: Document,
    /// Random parameters that are held at their medians.
    pub uncertain: Arc<Vec<Uncertain>>,
    /// The instants of its time steps, where they were found.
    pub instants: Option<Vec<f64>>,
}

/// All members, scenario by scenario, load case by load case.
pub(super) fn all(
    case: &Case,
    document: &Document,
    scenarios: &[Scenario],
    context: &mut Context<'_>,
) -> Result<Vec<Variant>, Diagnostics> {
    let (mut out, mut problems) = (Vec::new(), Vec::new());
    let load_cases = counted(case, context);
    if load_cases.is_empty() {
        let at = At::root().key("load_cases");
        return Err(document.complain(&at, "every load case has the weight zero: nothing is left").into());
    }
    for (index, scenario) in scenarios.iter().enumerate() {
        for load_case in &load_cases {
            match make(case, document, index, scenario, *load_case) {
                Ok(variant) => out.push(variant),
                Err(found) => problems.extend(found),
            }
        }
    }
    Diagnostics::new(problems).into_result().map(|()| out)
}

/// The load cases that count; none stands for a case without any.
fn counted(case: &Case, context: &mut Context<'_>) -> Vec<Option<usize>> {
    if case.load_cases.is_empty() {
        return vec![None];
    }
    for block in case.load_cases.iter().filter(|block| block.weight == 0.0) {
        context.warn(&INPUT, &block.at.key("weight"), "the weight is zero: the load case is left out");
    }
    (0..case.load_cases.len()).filter(|k| case.load_cases[*k].weight > 0.0).map(Some).collect()
}

fn make(
    case: &Case,
    document: &Document,
    index: usize,
    scenario: &Scenario,
    load_case: Option<usize>,
) -> Result<Variant, Vec<Diagnostic>> {
    let block = load_case.map(|k| &case.load_cases[k]);
    let own = block.map_or(&[][..], |block| &block.set.0);
    let settings: Vec<Setting> = scenario.settings.iter().chain(own).cloned().collect();
    let case_name = block.map_or_else(String::new, |block| block.name.clone());
    let name = match (&scenario.name, case_name.as_str()) {
        (Some(scenario), "") => format!("scenario \"{scenario}\""),
        (Some(scenario), case) => format!("scenario \"{scenario}\", load case \"{case}\""),
        (None, "") => "the case".to_owned(),
        (None, case) => format!("load case \"{case}\""),
    };
    let named = |one: &Diagnostic| Diagnostic { message: format!("{name}: {}", one.message), ..one.clone() };
    let (document, mut own) = read(document, &settings, case.units)
        .map_err(|problems| problems.list().iter().map(named).collect::<Vec<_>>())?;
    for (path, values) in &scenario.fields {
        set_field(&mut own, path, Parameter::Cells(values.clone()));
    }
    if let Some(block) = block {
        add_blocks(&mut own, block);
    }
    let (stem, case_stem) = stems(scenario.name.as_ref().map(|_| index), block.map(|_| case_name.as_str()));
    let weight = block.map_or(1.0, |block| block.weight);
    Ok(Variant {
        scenario: index,
        load_case,
        case_name,
        weight,
        name,
        stem,
        case_stem,
        case: own,
        document,
        uncertain: scenario.uncertain.clone(),
        instants: None,
    })
}

/// The case with other values.
pub(super) fn read(document: &Document, settings: &[Setting], units: Units) -> Result<(Document, Case), Diagnostics> {
    let variant = document.with(settings)?;
    let case = Case::read_variant(&variant, units)?;
    Ok((variant, case))
}

/// What a load case has alone comes after what all share.
fn add_blocks(case: &mut Case, own: &LoadCase) {
    case.supports.extend(own.supports.iter().cloned());
    case.loads.extend(own.loads.iter().cloned());
    case.controls.extend(own.controls.iter().cloned());
    case.costs.extend(own.costs.iter().cloned());
}

/// Puts a field in the place of a parameter, `materials/0/mu1` or `materials/0/parameters/mu1`; paths of other kinds have been refused.
pub(super) fn set_field(case: &mut Case, path: &str, value: Parameter) {
    let mut steps = path.split('/').skip(1);
    let material = steps.next().and_then(|k| k.parse::<usize>().ok()).and_then(|k| case.materials.get_mut(k));
    let parameter = material.zip(steps.next()).and_then(|(material, key)| {
        material.parameters.iter_mut().find(|(name, _)| **name == key).map(|(_, input)| input)
    });
    match (parameter, steps.next()) {
        (Some(Input::Numbers(numbers)), Some(name)) => _ = numbers.insert(name.to_owned(), value),
        (Some(parameter), None) => *parameter = Input::Number(value),
        _ => {}
    }
}

/// What the names of a member's files begin with, and the same without its scenario.
pub(super) fn stems(scenario: Option<usize>, load_case: Option<&str>) -> (String, String) {
    let case_stem = load_case.map_or_else(String::new, |name| format!("{}_", file_name(name)));
    let stem = scenario.map_or_else(String::new, |index| format!("scenario_{index:03}_")) + &case_stem;
    (stem, case_stem)
}

/// A name without what file systems dislike.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' || c == '.' { c } else { '_' }).collect()
}
