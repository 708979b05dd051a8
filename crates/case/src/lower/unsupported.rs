//! What a case may say and this version cannot do: refused by name, never ignored.

use super::context::Context;
use crate::schema::Case;
use nastic_opt::CATALOGUE;

pub(super) fn check(case: &Case, context: &mut Context<'_>) {
    let name = case.optimizer.method.name();
    if CATALOGUE.iter().all(|row| row.name != name) {
        let known: Vec<&str> = CATALOGUE.iter().map(|row| row.name).collect();
        let message = format!("\"{name}\" is not supported yet; take one of {}", known.join(", "));
        context.complain(&case.optimizer.at.key("method"), message);
    }
}
