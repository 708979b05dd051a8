//! Collections of the files of scenarios.

use crate::files::Directory;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_io::WriteError;

/// `scenarios.pvd`: the scenarios' files one after the other, for every load case.
///
/// # Errors
/// What the system answers.
pub fn write_collections(problem: &CaseProblem, what: &str, out: &Directory) -> Result<Vec<String>, WriteError> {
    let mut files = Vec::new();
    for lead in problem.leads().filter(|_| problem.has_scenarios()) {
        let own = problem.members().filter(|member| member.load_case() == lead.load_case());
        let entry = |member: CaseMember<'_>| (member.part().scenario() as f64, member.file(&format!("{what}.vtu")));
        let entries: Vec<(f64, String)> = own.map(entry).collect();
        let name = lead.case_file("scenarios.pvd");
        nastic_io::write_pvd(out.own(&name)?, &entries)?;
        files.push(name);
    }
    Ok(files)
}
