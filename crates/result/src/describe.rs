//! A problem as results of `nastic check` have it, and in words where these share what they need with the records.

mod actuation;
mod blocks;
mod contact;
mod duration;
mod existence;
mod members;
mod memory;
mod parameters;

pub use crate::describe::actuation::actuation;
pub use crate::describe::duration::duration;
pub use crate::describe::existence::{conditions, existence};
pub use crate::describe::members::{load_cases, scenarios};
pub use crate::describe::memory::memory;
use crate::describe::parameters::law;
use nastic_case::lower::CaseProblem;
use nastic_fem::Formulation;
use nastic_mesh::CellKind;
use nastic_report::record::{CaseDescription, LawRecord, MeshRecord, QualityRecord, RunRecord, SetRecord, numbers};
use std::collections::BTreeMap;

/// What `nastic check` puts into a result.
pub fn describe(problem: &CaseProblem, record: &mut RunRecord) {
    let material = |m: &nastic_language::schema::Material| {
        let formulation =
            m.formulation.or((!m.law.reinforcing).then(Formulation::default)).map(|f| f.name().to_owned());
        let rigid = m.rigid.then_some(true);
        let design = in_words(&m.design);
        LawRecord { formulation, rigid, design, ..law(problem, &m.region, m.law.name, &m.parameters, m.law.forms) }
    };
    let held = problem.solid().supports().fixed().iter().filter(|fixed| **fixed).count();
    let case = &problem.case;
    record.description = CaseDescription {
        mesh: Some(mesh_record(problem)),
        materials: Some(case.materials.iter().map(material).collect()),
        existence: Some(existence::records(problem)),
        actuation: Some(actuation::records(problem)),
        contact: (!case.contact.is_empty()).then(|| contact::records(problem)),
        blocks: blocks::records(problem),
        held_components: Some(held),
        memory: Some(memory::record(problem)),
        valid: Some(true),
    };
    let mut controls = crate::controls::controls(problem, &problem.start, 0);
    for field in &problem.controls {
        if let Some(entry) = controls.get_mut(&field.name) {
            entry.fiber_limit = field.limit.into();
        }
    }
    record.controls = Some(controls);
    members::describe(problem, &mut record.state);
}

/// Numbers in front of a law in words, where there are any.
fn in_words(design: &[nastic_language::schema::Design]) -> Option<Vec<String>> {
    (!design.is_empty()).then(|| design.iter().map(ToString::to_string).collect())
}

fn mesh_record(problem: &CaseProblem) -> MeshRecord {
    let (mesh, measures, quality) = (problem.mesh(), problem.mesh().measures(), problem.mesh().quality());
    let mut kinds = BTreeMap::<String, usize>::new();
    mesh.blocks()
        .iter()
        .for_each(|block| *kinds.entry(CellKind::name(block.kind).to_owned()).or_default() += block.len());
    let regions = mesh.regions().iter().map(|(name, cells)| {
        let measure = measures.regions.get(name).copied().into();
        (name.clone(), SetRecord { cells: Some(cells.len()), measure, ..SetRecord::default() })
    });
    let surfaces = mesh.surfaces().iter().map(|(name, facets)| {
        let measure = measures.surfaces.get(name).copied().into();
        (name.clone(), SetRecord { facets: Some(facets.len()), measure, ..SetRecord::default() })
    });
    let sets = mesh.node_sets().iter();
    let sets = sets.map(|(name, nodes)| (name.clone(), SetRecord { nodes: Some(nodes.len()), ..SetRecord::default() }));
    MeshRecord {
        name: mesh.name().to_owned(),
        dimensions: mesh.dim(),
        nodes: mesh.points().len(),
        cells: mesh.cells(),
        kinds: Some(kinds.into_iter().collect()),
        unknowns: problem.solid().discretization().dofs(),
        size: numbers(&measures.size),
        measure: measures.volume.into(),
        boundary: measures.boundary.into(),
        quality: QualityRecord {
            scaled_jacobian: quality.scaled_jacobian().into(),
            jacobian_ratio: quality.jacobian_ratio().into(),
            aspect: quality.aspect().into(),
            shortest_edge: quality.shortest_edge.into(),
            longest_edge: quality.longest_edge.into(),
        },
        regions: Some(regions.collect()),
        surfaces: Some(surfaces.collect()),
        node_sets: Some(sets.collect()),
    }
}
