//! What a case may say and this version cannot do: refused by name, never ignored.

use super::context::Context;
use crate::schema::{Case, Method};

pub(super) fn check(case: &Case, context: &mut Context<'_>) {
    if matches!(case.optimizer.method, Method::GaussNewton | Method::NewtonCg) {
        let name = case.optimizer.method.name();
        let message = format!("\"{name}\" is not supported yet; take projected_gradient, spectral or lbfgs");
        context.complain(&case.optimizer.at.key("method"), message);
    }
}
