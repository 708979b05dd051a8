//! Which of the conditions for a state of least energy hold: J. Ball (1977), survey, theorem 2.

use nastic_case::describe::{Line, line};
use nastic_case::lower::CaseProblem;
use nastic_energy::{Existence, MaterialPoint};
use nastic_language::number::{count, short};
use nastic_report::record::{CellGroupRecord, ExistenceRecord, GrowthRecord};

/// Cells whose laws together state the same.
struct Group {
    cells: usize,
    /// `None` where a law makes no statement.
    stated: Option<Existence>,
    /// Whether designs stand in front of its laws.
    designed: bool,
}

/// One line for each group of cells.
pub fn existence(problem: &CaseProblem) -> Vec<Line> {
    let in_space = problem.solid().mesh().dim() == 3;
    groups(problem).iter().map(|group| line("existence", text(group, in_space))).collect()
}

/// The same for `result.json`.
pub(super) fn records(problem: &CaseProblem) -> Vec<CellGroupRecord> {
    let of = |group: Group| CellGroupRecord { cells: group.cells, conditions: group.stated.map(conditions).into() };
    groups(problem).into_iter().map(of).collect()
}

/// What is stated, in results: with the growth that the stated one implies.
pub fn conditions(stated: Existence) -> ExistenceRecord {
    let growth = stated.growth.implied();
    ExistenceRecord {
        polyconvex: stated.polyconvex,
        resists_collapse: stated.resists_collapse,
        coercive: growth.is_coercive(),
        growth: GrowthRecord { p: growth.p.into(), q: growth.q.into(), r: growth.r.into() },
        balances_pressure: growth.balances_pressure(),
        holds: stated.holds(),
    }
}

/// By what the laws of a cell state together, point by point, in the order of the cells.
fn groups(problem: &CaseProblem) -> Vec<Group> {
    let body = problem.solid().body();
    let mut out: Vec<Group> = Vec::new();
    for (cell, (first, points)) in body.discretization().points_of_cells().into_iter().enumerate() {
        let mut seen: Vec<Option<Existence>> = Vec::new();
        for point in first..first + points {
            let laws = body.materials_of(cell).map(|law| law.existence(MaterialPoint { cell, point }));
            let stated = laws.reduce(|sum, next| Some(sum?.and(next?))).flatten();
            if seen.contains(&stated) {
                continue;
            }
            seen.push(stated);
            let mut slots = body.materials_of(cell).flat_map(|law| law.slots());
            let designed = slots.any(|slot| problem.case.has_design(slot.group));
            match out.iter_mut().find(|group| (group.stated, group.designed) == (stated, designed)) {
                Some(group) => group.cells += 1,
                None => out.push(Group { cells: 1, stated, designed }),
            }
        }
    }
    out
}

/// In plane strain `|F|^2` bounds J: what is said of turgor is true in space.
fn text(group: &Group, in_space: bool) -> String {
    let cells = count(group.cells, "cell");
    let Some(stated) = group.stated else {
        return format!("{cells}: a law makes no statement");
    };
    let growth = stated.growth.implied();
    let polyconvex = if stated.polyconvex { "polyconvex" } else { "not known to be polyconvex" };
    let at = if group.designed { " at every fixed design" } else { "" };
    let collapse = if stated.resists_collapse { "W -> inf as J -> 0" } else { "finite as J -> 0" };
    let exponents = format!("|F|^{}, |cof F|^{}, J^{}", short(growth.p), short(growth.q), short(growth.r));
    let coercive = if growth.is_coercive() { "coercive" } else { "not coercive" };
    let verdict = if stated.holds() {
        "a state of least energy exists without actuation"
    } else {
        "no theorem says that a state of least energy exists; it may"
    };
    let pressure = if growth.balances_pressure() || !in_space {
        ""
    } else {
        "; no turgor is balanced: its energy has no lower bound"
    };
    format!("{cells}: {polyconvex}{at}, {collapse}, {coercive} ({exponents}): {verdict}{pressure}")
}
