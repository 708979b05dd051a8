//! What can be said of a case that is not sound, so that one report has the mistakes of all layers: files, names that the mesh
//! lacks, parameters out of range, probes outside the body.

use super::context::Context;
use super::{actuation, blocks, contact, cost, load, material, mesh, named_groups, probe, support};
use nastic_fem::{Discretization, Solid};
use nastic_language::schema::{Case, group_names};
use nastic_language::syntax::{At, Document, Node, Value};
use nastic_mesh::Mesh;

/// Blocks whose entries name groups of the mesh.
const BLOCKS: [&str; 7] = ["materials", "supports", "contact", "loads", "actuation", "electrodes", "costs"];

/// Looks at everything that can be read of a case with mistakes of form; what is found joins the context's problems.
pub(super) fn look(case: &Case, document: &Document, context: &mut Context<'_>) {
    cost::load_targets(case, context);
    for load_case in &case.load_cases {
        cost::load_targets(&Case { costs: load_case.costs.clone(), ..case.clone() }, context);
    }
    let Some(mesh) = mesh::body(case, context) else { return };
    names(document, &mesh, context);
    probe::locate(case, &mesh, context);
    let Some(disc) = context.take(&mesh::at(case), Discretization::new(mesh)) else { return };
    let mut solid = Solid::on(disc);
    material::add(case, &[], &mut solid, context);
    actuation::add(case, &mut solid, context);
    support::add(case, &mut solid, context);
    blocks::add(case, &mut solid, context);
    load::add(case, &mut solid, context);
    contact::add(case, &mut solid, context);
}

/// Complains about every name that the mesh lacks, also in blocks with other mistakes.
pub(super) fn names(document: &Document, mesh: &Mesh, context: &mut Context<'_>) {
    let root = document.root();
    blocks(root, &At::root(), mesh, context);
    let load_cases = At::root().key("load_cases");
    let count = root.find(load_cases.as_str()).map_or(0, entries);
    for i in 0..count {
        let at = load_cases.index(i);
        if let Some(node) = root.find(at.as_str()) {
            blocks(node, &at, mesh, context);
        }
    }
}

/// The blocks of the case, or of a load case, whose node is given.
fn blocks(node: &Node, at: &At, mesh: &Mesh, context: &mut Context<'_>) {
    for block in BLOCKS {
        let count = node.find(block).map_or(0, entries);
        for i in 0..count {
            let own = At::root().key(block).index(i);
            let at = at.key(block).index(i);
            for key in ["surface", "region", "nodes"] {
                let Some(named) = node.find(own.key(key).as_str()) else { continue };
                let at = at.key(key);
                let Some(names) = group_names(context.document, named, &at) else { continue };
                let _ = match key {
                    "surface" => named_groups::facets(mesh, &names, &at, context).map(|_| ()),
                    "region" => named_groups::cells(mesh, &names, &at, context).map(|_| ()),
                    _ => named_groups::node_sets(mesh, &names, &at, context).map(|_| ()),
                };
            }
        }
    }
}

fn entries(node: &Node) -> usize {
    if let Value::Array(entries) = &node.value { entries.len() } else { 0 }
}
