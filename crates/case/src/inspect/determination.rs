//! Whether a cost looks at enough of the body to determine the control.

use crate::lower::{Admitted, CaseProblem, ControlField};
use crate::warning::{UNDETERMINED, Warning};
use nastic_ensemble::EnsembleBlock;
use nastic_opt::Constrained;

/// Warns of an optimum m of equilibria with more free control values than numbers that the cost looks at: a sum of squares of n deviations has a second derivative of rank n
/// where they are small. A cost of which that is not known, one of the control or a constraint may determine the others.
pub fn determination(problem: &CaseProblem, m: &[f64]) -> Option<Warning> {
    let ensemble = &problem.ensemble;
    if problem.is_motion() || !ensemble.constraints().is_empty() {
        return None;
    }
    let costs = problem.members().flat_map(|member| member.reduced().costs());
    let numbers = costs.map(|cost| cost.numbers()).sum::<Option<usize>>().filter(|numbers| *numbers > 0)?;
    let blocks = ensemble.blocks().iter().zip(&problem.controls);
    let free: usize = blocks.map(|(block, field)| free(problem, block, field, m)).sum();
    let message = || {
        let values = if numbers == 1 { "1 number".to_owned() } else { format!("{numbers} numbers") };
        format!(
            "the cost looks at {values} of the body, and {free} control values are free between their bounds: along at least {} of {free} \
             directions the control may change and the cost hardly does",
            free - numbers
        )
    };
    (free > numbers).then(|| Warning::new(&UNDETERMINED, message()))
}

/// Values of a control that can change to both sides.
fn free(problem: &CaseProblem, block: &EnsembleBlock, field: &ControlField, m: &[f64]) -> usize {
    let (m, components) = (block.of(m), problem.control_block(block).components.max(1));
    if let Some(bounds) = &field.bounds {
        let inside = |i: &usize| {
            let (lower, upper) = bounds.at(*i);
            lower < m[*i] && m[*i] < upper
        };
        return (0..m.len()).filter(inside).count();
    }
    match field.admitted {
        Admitted::Norm(_) => m.len() - m.len() / components,
        _ => m.len(),
    }
}
