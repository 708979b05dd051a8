//! The linear solver, and the memory that a solve takes, predicted.

use nastic_case::describe::{Line, line};
use nastic_case::lower::CaseProblem;
use nastic_fem::{Solver, available_memory};
use nastic_report::record::MemoryRecord;

/// Bytes of a program without a body, with what pictures and pages take.
const PROGRAM: usize = 50_000_000;
/// Bytes beside the levels per unknown, of mesh, vectors and results: at least, and where tangents are indefinite on the way, which takes levels of another
/// tangent as well. Measured with boxes of hex8 and hex27 of 10,000 to 10 million unknowns (docs/development/large-bodies.md).
const BESIDE: [usize; 2] = [700, 1200];

/// What a solve by multigrid takes at its peak, from and to.
fn peak_by_multigrid(levels: usize, unknowns: usize) -> [usize; 2] {
    let [least, most] = BESIDE.map(|bytes| PROGRAM + bytes * unknowns);
    [least + levels, most + 2 * levels]
}

/// The linear solver and the memory that it will take, in words.
pub fn memory(problem: &CaseProblem) -> Vec<Line> {
    let model = problem.solid().model();
    let structure = model.tangent_structure();
    let mut out = vec![line("solver", format!("{}: {}", model.solver(), model.solver().about()))];
    let megabytes = |bytes: usize| format!("{:.1} MB", bytes as f64 / 1e6);
    // steps in time assemble their tangents
    let of_levels = if problem.case.time.is_some() {
        model.tangents().assembled_multigrid_bytes()
    } else {
        model.tangents().multigrid_bytes()
    };
    let (factor, levels) = (megabytes(structure.factor_bytes()), megabytes(of_levels));
    let [least, most] = peak_by_multigrid(of_levels, problem.solid().discretization().dofs());
    let peak = format!("{} to {}", megabytes(least), megabytes(most));
    let members = problem.members().count();
    let each = if members > 1 { format!(" for each of {members} members") } else { String::new() };
    let text = match model.solver() == Solver::MULTIGRID {
        true => {
            format!(
                "multigrid; the tangent and its levels have about {levels}{each}, a solve at its peak {peak}; a factor, which may take over where tangents are indefinite, would have {factor}"
            )
        }
        false => format!(
            "a factor has {factor}{each}, {} while it is made on one thread (in single precision half of it)",
            megabytes(structure.factorisation_bytes())
        ),
    };
    out.push(line("memory", text));
    let starts = problem.case.optimizer.starts;
    if starts > 1 {
        let text = format!(
            "nastic optimize runs as many of the {starts} starts at once as threads and memory allow, each with that"
        );
        out.push(line("memory", text));
    }
    if let Ok(Some(available)) = available_memory() {
        out.push(line("memory", format!("{} are available", megabytes(available))));
        let text = match model.solver() {
            own if own == Solver::DIRECT && structure.factorisation_bytes() > available => {
                format!("too little for a factor; \"linear_solver\": \"multigrid\" takes {peak}{each}")
            }
            own if own == Solver::MULTIGRID && least > available => "too little".to_owned(),
            _ => return out,
        };
        out.push(line("memory", text));
    }
    out
}

/// What does not depend on the machine.
pub(super) fn record(problem: &CaseProblem) -> MemoryRecord {
    let structure = problem.solid().model().tangent_structure();
    MemoryRecord {
        linear_solver: problem.solid().model().solver().to_string(),
        factor: structure.factor_bytes(),
        factorisation: structure.factorisation_bytes(),
    }
}
