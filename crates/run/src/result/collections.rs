//! Collections of the files of scenarios.

use crate::result::files::Directory;
pub(crate) use crate::run::error::RunError;
use nastic_case::lower::{CaseMember, CaseProblem};

/// `scenarios.pvd`: the scenarios' files one after the other, for every load case.
pub(crate) fn write_collections(problem: &CaseProblem, what: &str, out: &Directory) -> Result<Vec<String>, RunError> {
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
