//! Titles of pictures.

use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_report::case_name;

/// The title of pictures of a member.
pub fn title(member: CaseMember<'_>) -> String {
    titled(member.problem(), &member.name())
}

/// The title of pictures of all scenarios together.
pub fn title_of_scenarios(lead: CaseMember<'_>) -> String {
    titled(lead.problem(), lead.load_case().unwrap_or(""))
}

pub(crate) fn titled(problem: &CaseProblem, name: &str) -> String {
    let file = || case_name(problem.document.name());
    let title = problem.case.title.clone().unwrap_or_else(file);
    if name.is_empty() { title } else { format!("{title}: {name}") }
}
