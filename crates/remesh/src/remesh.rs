//! `nastic remesh`: a cut design meshed along its outline, and solved again.

use crate::comparison::{CarriedGroup, DesignVolume, Remeshed, Solved};
use crate::error::RemeshError;
use crate::gmsh::{Groups, Order};
use crate::kept_body::KeptBody;
use crate::new_case::{CASE, CONTROLS, FIELDS, FieldSource, NewCase};
use crate::optimum::Optimum;
use crate::outline::{Outline, TOLERANCE};
use crate::transfer::Transfer;
use nastic_io::write_atomically;
use nastic_language::catalogue::Catalogue;
use nastic_language::number::{count, short};
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, Facet, Mesh, Snapshot};
use nastic_report::console::Console;
use nastic_result::controls::control_values;
use nastic_result::cut_design::cut_case;
use nastic_result::made_body::{MadeBody, made_parts};
use nastic_run::run::{Exit, Options, Outcome, run_document, run_with};
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct RemeshRequest {
    /// The output directory of an optimisation.
    pub directory: PathBuf,
    /// The size of cells in the case's unit of length; the mean edge of the old mesh where absent.
    pub size: Option<f64>,
    /// Where the new case goes; `remeshed` in the directory where absent.
    pub out: Option<PathBuf>,
    /// The program Gmsh.
    pub gmsh: PathBuf,
    /// Of the solves.
    pub options: Options,
}

/// A cut design before it is meshed.
struct Cut {
    made: MadeBody,
    body: KeptBody,
    islands: Vec<f64>,
    /// The regions of the old mesh that the case names.
    regions: Vec<String>,
}

/// Meshes the optimum of a design along the outline at which it is cut, writes it as a case of its own and solves that.
///
/// # Errors
/// A [`RemeshError`], which knows its exit code. A solve of the field or of the cut that fails is none: its cost is missing, and the record says why.
pub fn remesh(
    catalogue: &Catalogue,
    request: &RemeshRequest,
    console: &Console,
) -> Result<(Remeshed, Exit), RemeshError> {
    if let Some(size) = request.size.filter(|size| !(*size > 0.0 && size.is_finite())) {
        return Err(RemeshError::Size { size });
    }
    console.phase("reading");
    let optimum = Optimum::open(catalogue, &request.directory)?;
    let (problem, mesh) = (&optimum.problem, optimum.problem.mesh().clone());
    let size = request.size.unwrap_or_else(|| mean_edge(&mesh));
    let out = request.out.clone().unwrap_or_else(|| request.directory.join("remeshed"));
    console.phase("cutting");
    let (cut, case, names) = cut(&optimum, &mesh)?;
    if cut.made.designs.is_empty() {
        return Err(RemeshError::NoDesign { directory: request.directory.clone() });
    }
    let surfaces: Vec<(&String, &Vec<Facet>)> = mesh.surfaces().iter().collect();
    let facets: Vec<&[Facet]> = surfaces.iter().map(|(_, facets)| facets.as_slice()).collect();
    let border = cut.body.border(&mesh, &facets);
    let at: BTreeMap<u32, u32> = (0..).zip(&cut.body.nodes).filter_map(|(k, node)| Some(((*node)?, k))).collect();
    let on_border: BTreeSet<u32> = border.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
    let mut groups =
        Groups { surfaces: surfaces.iter().map(|(name, _)| (*name).clone()).collect(), ..Groups::default() };
    for (name, nodes) in mesh.node_sets().iter().filter(|(name, _)| names.contains(*name)) {
        let own = nodes.iter().filter_map(|node| at.get(node)).filter(|point| on_border.contains(point));
        groups.nodes.insert(name.clone(), own.copied().collect());
    }
    let kept = groups.nodes.values().flatten().copied().collect();
    let mut outline = Outline::new(cut.body.dim, &cut.body.points, &border, kept, size);
    let removed = outline.simplify();
    groups.regions = regions(&cut, &case, &mesh);
    let carried: BTreeMap<String, CarriedGroup> = surfaces
        .iter()
        .enumerate()
        .map(|(k, (name, facets))| {
            let used = names.contains(*name);
            ((*name).clone(), CarriedGroup { before: mesh.area(facets), after: outline.measure_of(k), used })
        })
        .collect();
    let node_sets: BTreeMap<String, CarriedGroup> = groups
        .nodes
        .iter()
        .map(|(name, nodes)| {
            let before = mesh.node_sets().get(name).map_or(0, Vec::len) as f64;
            (name.clone(), CarriedGroup { before, after: nodes.len() as f64, used: true })
        })
        .collect();
    refuse_gone(&case.json, "surface", &carried)?;
    refuse_gone(&case.json, "nodes", &node_sets)?;

    console.phase("meshing");
    let order = order(&mesh);
    let file = Order { outline: &outline, groups: &groups, size, order }.mesh(&request.gmsh, &out)?;
    let new = Arc::new(nastic_io::read_mesh(&file, 1.0)?);
    write_case(&optimum, &case, &new, &out)?;

    let mut remeshed = Remeshed {
        command: "remesh",
        of: request.directory.display().to_string(),
        case: out.join(CASE).display().to_string(),
        size,
        tolerance: TOLERANCE * size,
        element: new.blocks().first().map_or_else(String::new, |block| block.kind.name().to_owned()),
        cells: new.cells(),
        nodes: new.points().len(),
        volumes: volumes(&cut, &new),
        islands: cut.islands,
        surfaces: carried,
        node_sets,
        field: Solved::default(),
        cut: Solved::default(),
        meshed: Solved::default(),
        told: case.told,
        warnings: Vec::new(),
    };
    tell(&mut remeshed, (&outline, removed), problem.units().length().symbol);
    say(&remeshed, console);
    let exit = solve_all(catalogue, request, &optimum, &mut remeshed, console)?;
    remeshed.compare();
    remeshed.warnings.iter().for_each(|warning| console.say(format!("warning     {warning}")));
    console.say(format!("\n{}\n\ncase        {}", remeshed.table(), remeshed.case));
    write_json(out.join("remesh.json"), &remeshed)?;
    let is_warned = request.options.strict && exit == Exit::Done && !remeshed.warnings.is_empty();
    Ok((remeshed, if is_warned { Exit::Warned } else { exit }))
}

/// Cuts the body where its designs are at their levels and where regions of the case end; also the case that goes with it, and the names that it holds.
fn cut(optimum: &Optimum, mesh: &Mesh) -> Result<(Cut, NewCase, BTreeSet<String>), RemeshError> {
    let problem = &optimum.problem;
    let case = NewCase::of(optimum, &made_parts(problem, (&problem.start, 0), &[]))?;
    let mut names = BTreeSet::new();
    names_within(&case.json, &mut names);
    names.extend(case.regions.iter().flat_map(|region| region.within.iter().cloned()));
    let named = mesh.regions().iter().filter(|(name, _)| names.contains(*name));
    let (regions, cells): (Vec<String>, Vec<Vec<u32>>) =
        named.map(|(name, cells)| (name.clone(), cells.clone())).unzip();
    let made = made_parts(problem, (&problem.start, 0), &cells);
    let mut body = KeptBody::of(mesh, &made.parts);
    let islands = body.drop_islands(mesh, &held(&problem.document.json(), mesh));
    if body.pieces.is_empty() {
        return Err(RemeshError::Empty);
    }
    Ok((Cut { made, body, islands, regions }, case, names))
}

/// The nodes that supports hold.
fn held(case: &Value, mesh: &Mesh) -> BTreeSet<u32> {
    let mut nodes = BTreeSet::new();
    for support in case["supports"].as_array().into_iter().flatten() {
        let names = |key: &str| {
            let mut names = BTreeSet::new();
            names_within(&support[key], &mut names);
            names
        };
        for name in names("surface").into_iter().chain(names("nodes")) {
            nodes.extend(mesh.surface(&name).map(|facets| mesh.nodes_of_facets(facets)).unwrap_or_default());
            nodes.extend(mesh.node_set(&name).unwrap_or_default());
        }
        for name in names("region") {
            nodes.extend(mesh.region(&name).map(|cells| mesh.nodes_of_cells(cells)).unwrap_or_default());
        }
    }
    nodes
}

/// All texts within, keys too.
fn names_within(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::String(text) => drop(found.insert(text.clone())),
        Value::Array(all) => all.iter().for_each(|own| names_within(own, found)),
        Value::Object(members) => members.iter().for_each(|(key, own)| {
            found.insert(key.clone());
            names_within(own, found);
        }),
        _ => {}
    }
}

/// The pieces of all regions of the new mesh: those of the old one that are left, what designs fill, and those that materials need.
fn regions(cut: &Cut, case: &NewCase, mesh: &Mesh) -> BTreeMap<String, BTreeSet<u32>> {
    let mut all: BTreeMap<String, BTreeSet<u32>> = BTreeMap::new();
    for (number, piece) in cut.body.pieces.iter().enumerate() {
        let (part, number) = (&cut.made.parts[piece.part], number as u32);
        let within: Vec<&String> = part.regions.iter().map(|k| &cut.regions[*k]).collect();
        let designs = part.names.iter().filter(|name| !mesh.regions().contains_key(*name));
        let made = case.regions.iter().filter(|region| region.has(part, &within));
        for name in within.iter().copied().chain(designs).chain(made.map(|region| &region.name)) {
            all.entry(name.clone()).or_default().insert(number);
        }
    }
    all
}

/// Complains of groups that the case names and of which nothing is left.
fn refuse_gone(case: &Value, key: &'static str, groups: &BTreeMap<String, CarriedGroup>) -> Result<(), RemeshError> {
    let kind = if key == "surface" { "surface" } else { "node set" };
    for (name, _) in groups.iter().filter(|(_, group)| group.used && group.after <= 0.0) {
        if let Some(at) = place_of(case, key, name) {
            return Err(RemeshError::Gone { at, kind, name: name.clone() });
        }
    }
    Ok(())
}

/// Where a key has a name, or a list with it.
fn place_of(value: &Value, key: &str, name: &str) -> Option<String> {
    let below = |step: &str, own: &Value| {
        place_of(own, key, name).map(|rest| if rest.is_empty() { step.to_owned() } else { format!("{step}/{rest}") })
    };
    match value {
        Value::Object(members) => members.iter().find_map(|(own_key, own)| {
            let has = |own: &Value| own == name || own.as_array().is_some_and(|all| all.iter().any(|one| one == name));
            if own_key == key && has(own) { Some(key.to_owned()) } else { below(own_key, own) }
        }),
        Value::Array(all) => all.iter().enumerate().find_map(|(k, own)| below(&k.to_string(), own)),
        _ => None,
    }
}

/// Simplices of second order but for simplices of first order: those of first order are stiffer than quadrilaterals and hexahedra.
fn order(mesh: &Mesh) -> usize {
    let is_first = |kind: CellKind| matches!(kind, CellKind::Tri3 | CellKind::Tet4);
    if mesh.blocks().iter().all(|block| is_first(block.kind)) { 1 } else { 2 }
}

/// The mean length of the edges between corners, those of simplices alone.
fn mean_edge(mesh: &Mesh) -> f64 {
    let (mut sum, mut number) = (0.0, 0.0);
    for id in 0..mesh.cells() {
        let cell = mesh.cell(id);
        for (kind, local) in cell.kind.faces() {
            let corners = &local[..kind.corners()];
            for (k, a) in corners.iter().enumerate() {
                let [a, b] = [*a, corners[(k + 1) % corners.len()]].map(|at| mesh.points()[cell.nodes[at] as usize]);
                sum += crate::kept_body::length(crate::kept_body::minus(a, b));
                number += 1.0;
            }
        }
    }
    sum / number
}

/// Writes the case and the files that it names.
fn write_case(optimum: &Optimum, case: &NewCase, new: &Arc<Mesh>, out: &Path) -> Result<(), RemeshError> {
    let problem = &optimum.problem;
    let old = problem.mesh();
    if !case.fields.is_empty() {
        let transfer = Transfer::new(old, new.clone());
        let mut snapshot = Snapshot::new(new.clone());
        for (name, field) in &case.fields {
            snapshot = match field {
                FieldSource::Control { values, components, by_node: true } => {
                    snapshot.with_points(name, *components, transfer.nodes(values, *components)?)?
                }
                FieldSource::Control { values, components, .. } => {
                    snapshot.with_cells(name, *components, transfer.cells(values, *components)?)?
                }
                FieldSource::File { file, array } => {
                    let read = nastic_io::read_snapshot(file)?;
                    match (read.point_array(array), read.cell_array(array)) {
                        (Some(own), _) => {
                            snapshot.with_points(name, own.components, transfer.nodes(&own.values, own.components)?)?
                        }
                        (_, Some(own)) => {
                            snapshot.with_cells(name, own.components, transfer.cells(&own.values, own.components)?)?
                        }
                        // complained about when the case was read
                        _ => snapshot,
                    }
                }
            };
        }
        nastic_io::write_vtu(out.join(FIELDS), &snapshot)?;
    }
    let values = control_values(problem, &problem.start);
    for (name, text) in
        [(CONTROLS, serde_json::to_string_pretty(&values)), (CASE, serde_json::to_string_pretty(&case.json))]
    {
        let text = text.unwrap_or_default() + "\n";
        write_atomically(out.join(name), |file| file.write_all(text.as_bytes()))?;
    }
    Ok(())
}

fn write_json(file: PathBuf, value: &impl Serialize) -> Result<(), RemeshError> {
    let text = serde_json::to_string_pretty(value).unwrap_or_default() + "\n";
    Ok(write_atomically(file, |out| out.write_all(text.as_bytes()))?)
}

fn volumes(cut: &Cut, new: &Mesh) -> BTreeMap<String, DesignVolume> {
    let of = |name: &String| {
        let pieces = cut.body.pieces.iter().filter(|piece| cut.made.parts[piece.part].names.contains(name));
        let meshed = new.region_volume(name).unwrap_or_default();
        (pieces.map(|piece| piece.volume).sum::<f64>(), meshed)
    };
    let designs = cut.made.designs.iter().map(|design| {
        let (outline, meshed) = of(&design.name);
        (design.name.clone(), DesignVolume { field: design.volume, outline, meshed })
    });
    designs.collect()
}

/// What was lost, and what is odd.
fn tell(remeshed: &mut Remeshed, (outline, removed): (&Outline, usize), unit: &str) {
    let unit_of_volume = format!("{unit}^{}", outline.dim);
    remeshed.told.push(format!(
        "outline: {} at most {} {unit} off, {} removed, the shortest edge is {} {unit}",
        count(outline.facets.len(), "facet"),
        short(remeshed.tolerance),
        count(removed, "point"),
        short(outline.shortest_edge())
    ));
    if !remeshed.islands.is_empty() {
        let volume: f64 = remeshed.islands.iter().sum();
        let pieces = count(remeshed.islands.len(), "piece");
        remeshed
            .told
            .push(format!("dropped: {pieces} that nothing holds, together {} {unit_of_volume}", short(volume)));
    }
    for (kind, groups) in [("surface", &remeshed.surfaces), ("node set", &remeshed.node_sets)] {
        for (name, own) in groups.iter().filter(|(_, own)| own.used && own.after < 0.999 * own.before) {
            let share = short(100.0 * own.after / own.before);
            remeshed.told.push(format!("{kind} \"{name}\": {share} % of it is left"));
        }
    }
    for (name, own) in &remeshed.volumes {
        if (own.meshed - own.outline).abs() > 0.01 * own.outline {
            let [meshed, outline] = [own.meshed, own.outline].map(short);
            remeshed.warnings.push(format!(
                "\"{name}\" has {meshed} {unit_of_volume} in the new mesh, {outline} {unit_of_volume} as it is cut: take a smaller --size"
            ));
        }
    }
}

fn say(remeshed: &Remeshed, console: &Console) {
    let Remeshed { element, cells, nodes, size, .. } = remeshed;
    console.say(format!("mesh        {cells} cells {element} of the size {}, {nodes} nodes", short(*size)));
    remeshed.told.iter().for_each(|line| console.say(format!("            {line}")));
}

/// Solves the field, the cut and the new case.
fn solve_all(
    catalogue: &Catalogue,
    request: &RemeshRequest,
    optimum: &Optimum,
    remeshed: &mut Remeshed,
    console: &Console,
) -> Result<Exit, RemeshError> {
    let quiet =
        Options { in_memory: true, out: None, no_report: true, without_expect: true, ..request.options.clone() };
    let in_memory = |document| match run_document(Command::Solve, document, &quiet, &Console::silent()) {
        Ok((Outcome { result, .. }, _)) => Solved::of(&result),
        Err(error) => Solved::failed(error.to_string()),
    };
    console.phase("solving the field");
    remeshed.field = in_memory(optimum.document.clone());
    console.phase("solving the cut");
    remeshed.cut = match cut_case(&optimum.problem, &optimum.problem.start, 0) {
        Ok(Some(document)) => in_memory(document),
        Ok(None) => Solved::failed("a design by node or on a grid has no cells of 0 and 1".to_owned()),
        Err(error) => Solved::failed(error.to_string()),
    };
    console.phase("solving along the outline");
    let case = PathBuf::from(&remeshed.case);
    let out = case.parent().map(|out| out.join("solved"));
    let options = Options { out, ..request.options.clone() };
    let outcome = run_with(catalogue, Command::Solve, &case, &options, &Console::silent())?;
    remeshed.meshed = Solved::of(&outcome.result);
    for (what, solved) in [("field", &remeshed.field), ("cut", &remeshed.cut)] {
        if let Some(error) = &solved.error {
            remeshed.warnings.push(format!("no cost of the {what}: {error}"));
        }
    }
    Ok(outcome.exit)
}
