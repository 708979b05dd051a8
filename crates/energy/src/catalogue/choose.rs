use std::fmt::Write;

use super::inputs::{CheckedInputs, Inputs};
use super::{Parameter, unknown};
use crate::EnergyError;

/// Checks the given names and kinds against the forms, and finds the one that is meant.
///
/// # Errors
/// An [`EnergyError`] that names the parameter: unknown, missing, of the wrong kind, or of another form.
pub fn choose<'a>(
    owner: &'static str,
    forms: &'static [&'static [Parameter]],
    inputs: &'a Inputs,
) -> Result<CheckedInputs<'a>, EnergyError> {
    let all = distinct(forms);
    let mut given: Vec<&'static Parameter> = Vec::new();
    for name in inputs.names() {
        match all.iter().find(|p| p.name == name) {
            Some(parameter) => given.push(parameter),
            None => {
                let known = all.iter().map(|p| p.name).collect();
                return Err(unknown(&format!("parameter of {owner}"), name, known));
            }
        }
    }
    for parameter in &given {
        inputs.check_kind(owner, parameter)?;
    }
    let fits = |form: &&'static [Parameter]| given.iter().all(|p| has(form, p.name));
    let is_given = |p: &Parameter| given.iter().any(|given| given.name == p.name);
    let needs = |form: &'static [Parameter]| form.iter().filter(|p| !p.optional && !is_given(p)).count();
    let Some(form) = forms.iter().copied().filter(fits).min_by_key(|form| needs(form)) else {
        return Err(conflict(owner, forms, &given));
    };
    match form.iter().find(|p| !p.optional && !is_given(p)) {
        Some(missing) => {
            let given = given.iter().map(|p| p.name.to_owned()).collect();
            Err(EnergyError::Missing { owner, name: missing.name, given, forms: describe(forms) })
        }
        None => Ok(CheckedInputs::new(owner, form, inputs)),
    }
}

fn conflict(owner: &'static str, forms: &'static [&'static [Parameter]], given: &[&'static Parameter]) -> EnergyError {
    let together = |a: &str, b: &str| forms.iter().any(|form| has(form, a) && has(form, b));
    let pairs = given.iter().flat_map(|a| given.iter().map(move |b| (a.name, b.name)));
    let mut apart = pairs.filter(|(a, b)| !together(a, b));
    let (first, second) = apart.next().unwrap_or((given[0].name, given[given.len() - 1].name));
    EnergyError::Conflict { owner, first, second, forms: describe(forms) }
}

fn has(form: &[Parameter], name: &str) -> bool {
    form.iter().any(|p| p.name == name)
}

/// All parameters of all forms, each once.
pub fn distinct(forms: &'static [&'static [Parameter]]) -> Vec<&'static Parameter> {
    let mut out: Vec<&'static Parameter> = Vec::new();
    for parameter in forms.iter().copied().flatten() {
        if !out.iter().any(|p| p.name == parameter.name) {
            out.push(parameter);
        }
    }
    out
}

/// `{mu1, mu2, mu3} or {shear, bulk, share}`, optional ones with a question mark.
pub fn describe(forms: &[&[Parameter]]) -> String {
    let mut out = String::new();
    for (n, form) in forms.iter().enumerate() {
        let names: Vec<String> =
            form.iter().map(|p| format!("{}{}", p.name, if p.optional { "?" } else { "" })).collect();
        let _ = write!(out, "{}{{{}}}", if n == 0 { "" } else { " or " }, names.join(", "));
    }
    out
}
