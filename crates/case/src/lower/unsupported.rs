//! What a case may say and this version cannot do: refused by name, never ignored.

use super::context::Context;
use crate::schema::{Case, Method, Scenarios};
use crate::syntax::At;

pub(super) fn check(case: &Case, context: &mut Context<'_>) {
    let root = At::root();
    let scenarios = match &case.scenarios {
        Scenarios::List(list) => !list.is_empty(),
        Scenarios::Random(_) => true,
    };
    if scenarios {
        context.complain(&root.key("scenarios"), "scenarios are not supported yet; leave them out");
    }
    if !case.load_cases.is_empty() {
        let message = "load cases are not supported yet; write one case per load case";
        context.complain(&root.key("load_cases"), message);
    }
    if matches!(case.optimizer.method, Method::GaussNewton | Method::NewtonCg) {
        let name = case.optimizer.method.name();
        let message = format!("\"{name}\" is not supported yet; take projected_gradient, spectral or lbfgs");
        context.complain(&case.optimizer.at.key("method"), message);
    }
    if case.optimizer.starts > 1 {
        context.complain(&case.optimizer.at.key("starts"), "several starts are not supported yet; leave them out");
    }
    for control in &case.controls {
        if control.direction.is_some() {
            let message = "amplitudes along a direction are not supported yet; control the whole vector";
            context.complain(&control.at.key("direction"), message);
        }
    }
}
