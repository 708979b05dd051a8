//! `nastic remesh`: a cut design meshed along its outline, and solved again.

use crate::comparison::{CarriedGroup, DesignVolume, Remeshed, Solved};
use crate::cut::Cut;
use crate::error::RemeshError;
use crate::gmsh::{Groups, Order};
use crate::new_case::{CASE, new_region};
use crate::optimum::Optimum;
use crate::outline::{Outline, TOLERANCE};
use crate::vector::{length, minus};
use crate::written::{write_case, write_json};
use nastic_language::catalogue::Catalogue;
use nastic_language::number::{count, short};
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, Facet, Mesh};
use nastic_report::console::Console;
use nastic_result::cut_design::cut_case;
use nastic_run::run::{Exit, Options, Outcome, run_document, run_with};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
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
    let cut = Cut::of(&optimum, &mesh)?;
    let shape = Shape::of(&cut, &mesh, size);
    let (surfaces, node_sets) = shape.carried(&cut, &mesh);
    cut.refuse_gone("surface", &surfaces)?;
    cut.refuse_gone("nodes", &node_sets)?;

    console.phase("meshing");
    let order = order(&mesh);
    let Shape { outline, groups, removed } = &shape;
    let file = Order { outline, groups, size, order }.mesh(&request.gmsh, &out)?;
    let new = Arc::new(nastic_io::read_mesh(&file, 1.0)?);
    write_case(&optimum, &cut.case, &new, &out)?;

    let mut remeshed = Remeshed {
        command: "remesh",
        of: request.directory.display().to_string(),
        case: out.join(CASE).display().to_string(),
        size,
        tolerance: TOLERANCE * size,
        element: new.blocks().first().map_or_else(String::new, |block| block.kind.name().to_owned()),
        cells: new.cells(),
        nodes: new.points().len(),
        volumes: volumes(&cut, &mesh, &new),
        islands: cut.islands,
        surfaces,
        node_sets,
        field: Solved::default(),
        cut: Solved::default(),
        meshed: Solved::default(),
        told: cut.case.told,
        warnings: Vec::new(),
    };
    tell(&mut remeshed, outline, *removed, problem.units().length().symbol);
    say(&remeshed, console);
    let exit = solve_all(catalogue, request, &optimum, &mut remeshed, console)?;
    remeshed.compare();
    remeshed.warnings.iter().for_each(|warning| console.say(format!("warning     {warning}")));
    console.say(format!("\n{}\n\ncase        {}", remeshed.table(), remeshed.case));
    write_json(out.join("remesh.json"), &remeshed)?;
    let is_warned = request.options.strict && exit == Exit::Done && !remeshed.warnings.is_empty();
    Ok((remeshed, if is_warned { Exit::Warned } else { exit }))
}

/// What is meshed.
struct Shape {
    outline: Outline,
    groups: Groups,
    /// How many points the outline has less than the cut.
    removed: usize,
}

impl Shape {
    fn of(cut: &Cut, mesh: &Mesh, size: f64) -> Self {
        let facets: Vec<&[Facet]> = mesh.surfaces().values().map(Vec::as_slice).collect();
        let border = cut.body.border(mesh, &facets);
        let at: BTreeMap<u32, u32> = (0..).zip(&cut.body.nodes).filter_map(|(k, node)| Some(((*node)?, k))).collect();
        let on_border: BTreeSet<u32> = border.iter().flat_map(|facet| facet.nodes.iter().copied()).collect();
        let own = |nodes: &Vec<u32>| {
            let points = nodes.iter().filter_map(|node| at.get(node)).filter(|point| on_border.contains(point));
            points.copied().collect::<Vec<u32>>()
        };
        let named = mesh.node_sets().iter().filter(|(name, _)| cut.names.contains(*name));
        let groups = Groups {
            regions: cut.pieces_of_regions(mesh),
            surfaces: mesh.surfaces().keys().cloned().collect(),
            nodes: named.map(|(name, nodes)| (name.clone(), own(nodes))).collect(),
        };
        let kept = groups.nodes.values().flatten().copied().collect();
        let mut outline = Outline::new(cut.body.dim, &cut.body.points, &border, kept, size);
        let removed = outline.simplify();
        Shape { outline, groups, removed }
    }

    /// What is left of surfaces and node sets.
    fn carried(&self, cut: &Cut, mesh: &Mesh) -> (BTreeMap<String, CarriedGroup>, BTreeMap<String, CarriedGroup>) {
        let surface = |(k, (name, facets)): (usize, (&String, &Vec<Facet>))| {
            let used = cut.names.contains(name);
            (name.clone(), CarriedGroup { before: mesh.area(facets), after: self.outline.measure_of(k), used })
        };
        let nodes = |(name, nodes): (&String, &Vec<u32>)| {
            let before = mesh.node_sets().get(name).map_or(0, Vec::len) as f64;
            (name.clone(), CarriedGroup { before, after: nodes.len() as f64, used: true })
        };
        (mesh.surfaces().iter().enumerate().map(surface).collect(), self.groups.nodes.iter().map(nodes).collect())
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
                sum += length(minus(a, b));
                number += 1.0;
            }
        }
    }
    sum / number
}

fn volumes(cut: &Cut, old: &Mesh, new: &Mesh) -> BTreeMap<String, DesignVolume> {
    let of = |name: &String| {
        let pieces = cut.body.pieces.iter().filter(|piece| cut.made.parts[piece.part].names.contains(name));
        let meshed = new.region_volume(&new_region(old, name.clone())).unwrap_or_default();
        (pieces.map(|piece| piece.volume).sum::<f64>(), meshed)
    };
    let designs = cut.made.designs.iter().map(|design| {
        let (outline, meshed) = of(&design.name);
        (design.name.clone(), DesignVolume { field: design.volume, outline, meshed })
    });
    designs.collect()
}

/// What was lost, and what is odd.
fn tell(remeshed: &mut Remeshed, outline: &Outline, removed: usize, unit: &str) {
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
