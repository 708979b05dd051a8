//! The optimiser and the inner product of controls.

use nastic_control::Metric;
use nastic_language::schema::{Case, Metric as MetricBlock};
use nastic_opt::{Optimizer, Options, by_name};

pub(super) fn metric(case: &Case) -> Metric {
    match case.optimizer.metric {
        MetricBlock::L2 => Metric::L2,
        MetricBlock::H1(length) => Metric::H1 { length },
    }
}

pub(super) fn build(case: &Case) -> Option<Box<dyn Optimizer>> {
    let block = &case.optimizer;
    let options = Options {
        tolerance: block.tolerance,
        stage_tolerance: block.stage_tolerance,
        absolute_tolerance: block.absolute_tolerance,
        max_iterations: block.max_iterations,
        ..Options::default()
    };
    by_name(block.method.name(), options)
}
