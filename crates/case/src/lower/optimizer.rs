//! The optimiser and the inner product of controls.

use crate::lower::context::Context;
use nastic_control::Metric;
use nastic_language::schema::{Case, Control, Metric as MetricBlock};
use nastic_opt::{Admissible, Asymptotes, Bounds, Limit, Mma, Optimizer, Options, SetError, Sphere, Unfit, by_name};

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
    let name = block.method.name();
    if name != Mma::default().name() {
        return by_name(name, options);
    }
    let usual = Asymptotes::default();
    let asymptotes = Asymptotes {
        move_limit: block.move_limit.unwrap_or(usual.move_limit),
        initial_distance: block.asymptote_distance.unwrap_or(usual.initial_distance),
        ..usual
    };
    Some(Box::new(Mma { options, asymptotes }))
}

/// Whether the method keeps vectors at one length. Another moves their components between minus and plus that, and the chain behind gives them their length.
pub(super) fn takes_spheres(case: &Case) -> bool {
    let sphere = Sphere::new(3, 1.0);
    build(case).zip(sphere.ok()).is_none_or(|(method, sphere)| method.check_set(&sphere, 3).is_ok())
}

/// The set of vectors of a length: a sphere, or of a method that takes none the cube around it, in front of the chain.
pub(super) fn of_length(case: &Case, dim: usize, norm: f64) -> Result<Box<dyn Admissible>, SetError> {
    let sphere = Sphere::new(dim, norm)?;
    if takes_spheres(case) {
        return Ok(Box::new(sphere));
    }
    Ok(Box::new(Bounds::new(Limit::Uniform(-norm), Limit::Uniform(norm))?))
}

/// Complains of a control in a set that the method is not made for.
pub(super) fn check_set(
    case: &Case,
    control: &Control,
    set: &dyn Admissible,
    len: usize,
    context: &mut Context<'_>,
) -> Option<()> {
    let Err(unfit) = build(case)?.check_set(set, len) else { return Some(()) };
    let (at, message) = match unfit {
        Unfit::Set { method, .. } => {
            let instead = "give \"lower\" and \"upper\" of every component in its place, or a value that is not controlled, or take \"lbfgs\"";
            (control.at.key("max_norm"), format!("\"{method}\" takes controls between bounds alone: {instead}"))
        }
        Unfit::Range { method, .. } => {
            let why = "changes a control by a share of the range between its bounds";
            (control.at.clone(), format!("\"{method}\" {why}: give both \"lower\" and \"upper\", or take \"lbfgs\""))
        }
        other => (control.at.clone(), other.to_string()),
    };
    context.complain(&at, message);
    None
}
