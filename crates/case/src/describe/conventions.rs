//! The signs and conventions that a case uses.

use super::line::{Line, line};
use crate::lower::CaseProblem;
use nastic_language::schema::{CONVENTIONS, Input, Means};
use nastic_numeric::format::scientific;

/// What the signs of the case mean.
pub fn conventions(problem: &CaseProblem) -> Vec<Line> {
    let mut out = vec![line(
        "conventions",
        "x = X + u, F = I + grad u, P = dW/dF; loads are dead: per reference area and volume",
    )];
    if problem.mesh().dim() == 2 {
        out.push(line("conventions", "plane strain: F = diag(F_2x2, 1), forces per unit of depth"));
    }
    let eps0 = scientific(problem.units().permittivity(), 8);
    let has = |kind: &str| problem.case.actuation.iter().any(|a| a.kind() == kind);
    let used = CONVENTIONS.iter().filter(|(kind, _)| has(kind));
    out.extend(used.map(|(_, text)| line("conventions", text.replace("EPS0", &eps0))));
    if has("magnet") {
        let mu0 = problem.units().permeability();
        for magnet in problem.case.actuation.iter().filter(|a| a.kind() == "magnet") {
            let Means::Law { parameters, .. } = &magnet.means else { continue };
            let carrier = match parameters.get("variant") {
                Some(Input::Word("rotation")) => "R of F = R U",
                Some(Input::Word("isochoric")) => "J^(-1/3) F",
                _ => "F",
            };
            out.push(line(
                "conventions",
                format!("{} adds -(1/mu0)(C B_r).B_a to the energy, C = {carrier}", magnet.name),
            ));
        }
        out.push(line(
            "conventions",
            format!("B_r is carried along by C; mu0 = {} in these units unless given", scientific(mu0, 8)),
        ));
    }
    let mut spaces = problem.ensemble.blocks().iter().map(|block| problem.control_block(block).basis.space());
    if spaces.any(|space| space == nastic_control::Space::Node)
        && problem.mesh().blocks().iter().any(|block| block.kind.order() > 1)
    {
        out.push(line(
            "conventions",
            "nodal controls live on corner nodes and are linear between them, so that bounds hold everywhere",
        ));
    }
    if !problem.start.is_empty() {
        out.push(line(
            "conventions",
            "derivative: dj/dm_i; gradient: its Riesz image in the metric; steps go along minus the gradient",
        ));
    }
    out
}
