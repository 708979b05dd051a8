//! The body as it is made, of the materials that its designs say: 3MF files, and directions of fields.

use crate::cut_design::{Cut, CutBody, DesignFiles, acts_in};
use nastic_case::lower::CaseProblem;
use nastic_control::ControlMap;
use nastic_io::{PrintedBody, WriteError};
use nastic_language::schema::{Case, Design, DesignKind, Material, MixedLaw};
use nastic_mesh::{LevelBody, LevelSimplices, Mesh};
use std::collections::BTreeMap;

/// A part of the body that is of one material.
struct Part {
    /// The names of the designs that say so, that of a mixture with `_rest` where it is the first law.
    names: Vec<String>,
    /// The mixtures that are the second law there.
    second: Vec<String>,
    body: LevelBody,
}

/// Cells of the same designs and the same regions.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Group {
    cuts: Vec<usize>,
    regions: Vec<usize>,
}

/// Writes `design.3mf`, an object for each part of one material, and for every load case its deformed shape; nothing of a case without densities and mixtures.
pub(crate) fn write(files: &mut DesignFiles<'_>, cuts: &[CutBody]) -> Result<(), WriteError> {
    let DesignFiles { problem, shapes, directory, scale, told } = files;
    let title = crate::title::titled(problem, "");
    let is_own = cuts.iter().any(|own| own.cut.load_case.is_some());
    for (k, shape) in shapes.iter().enumerate() {
        let member = &shape.member;
        let own: Vec<&CutBody> = cuts.iter().filter(|own| shape.has(&own.cut.name)).collect();
        if own.is_empty() {
            continue;
        }
        let parts = parts_of_materials(member.case(), member.mesh(), &own);
        let mut put = |name: String, positions: &[[f64; 3]]| {
            let bodies: Vec<PrintedBody> = parts.iter().filter_map(|(part, of)| printed(part, of, positions)).collect();
            if bodies.is_empty() {
                return Ok(());
            }
            directory.write_3mf(&name, &title, &bodies, *scale)?;
            told.files.push(name);
            Ok(())
        };
        // at rest all load cases are alike that share their designs
        if is_own {
            put(member.case_file("design.3mf"), &shape.made)?;
        } else if k == 0 {
            put("design.3mf".to_owned(), &shape.made)?;
        }
        put(member.case_file("design_deformed.3mf"), &shape.deformed)?;
    }
    Ok(())
}

fn printed(part: &Part, material: &str, positions: &[[f64; 3]]) -> Option<PrintedBody> {
    let surface = part.body.whole(positions);
    let name = if part.names.is_empty() { material.to_owned() } else { part.names.join(", ") };
    (!surface.triangles.is_empty()).then(|| PrintedBody { name, material: material.to_owned(), surface })
}

/// The parts of the body, each with the name of its material.
fn parts_of_materials(case: &Case, mesh: &Mesh, cuts: &[&CutBody]) -> Vec<(Part, String)> {
    let regions: Vec<Vec<u32>> =
        case.materials.iter().map(|material| mesh.cells_of(&material.region).unwrap_or_default()).collect();
    let named = |(part, group): (Part, Group)| {
        let materials = group.regions.iter().map(|k| name_of(&case.materials[*k], &part.second));
        let name = materials.collect::<Vec<_>>().join(" + ");
        (part, name)
    };
    parts(mesh, cuts, &regions).into_iter().map(named).collect()
}

/// The parts of the body by the regions and the designs that they belong to.
fn parts(mesh: &Mesh, cuts: &[&CutBody], regions: &[Vec<u32>]) -> Vec<(Part, Group)> {
    let mut groups: BTreeMap<Group, Vec<u32>> = BTreeMap::new();
    for cell in 0..mesh.cells() as u32 {
        let has = |cells: &Vec<u32>| cells.binary_search(&cell).is_ok();
        let cuts = (0..cuts.len()).filter(|k| has(&cuts[*k].cut.cells)).collect();
        let regions = (0..regions.len()).filter(|k| has(&regions[*k])).collect();
        groups.entry(Group { cuts, regions }).or_default().push(cell);
    }
    let mut all = Vec::new();
    for (group, cells) in groups {
        let thickness = cuts.first().map_or(0.0, |own| own.cut.thickness);
        let body = LevelBody::of_nodes(mesh, &cells, vec![0.0; mesh.points().len()], thickness);
        let whole = Part { names: Vec::new(), second: Vec::new(), body };
        let made = group
            .cuts
            .iter()
            .fold(vec![whole], |parts, k| parts.into_iter().flat_map(|part| divided(part, cuts[*k])).collect());
        all.extend(made.into_iter().map(|part| (part, group.clone())));
    }
    all
}

/// The body as its densities, mixtures and electrodes make it, at the levels at which their parts have the volumes that the fields stand for; `regions` are lists
/// of cells, ascending, on whose borders parts end too. Those of load cases alone are left out.
#[must_use]
pub fn made_parts(problem: &CaseProblem, m: &[f64], stage: usize, regions: &[Vec<u32>]) -> MadeBody {
    let cuts: Vec<CutBody> =
        CutBody::all(problem, m, stage).into_iter().filter(|own| own.cut.load_case.is_none()).collect();
    let own: Vec<&CutBody> = cuts.iter().collect();
    let mesh = problem.mesh();
    let made = |(part, group): (Part, Group)| {
        let mixed = group.cuts.iter().filter(|k| cuts[**k].cut.is_mixture).map(|k| cuts[*k].cut.of.clone());
        let simplices = part.body.simplices(mesh.points());
        let Part { names, second, .. } = part;
        MadePart { simplices, regions: group.regions.clone(), names, second, mixed: mixed.collect() }
    };
    let parts = parts(mesh, &own, regions).into_iter().map(made).collect();
    let design = |own: &CutBody| {
        let across = if mesh.dim() == 2 { own.cut.thickness } else { 1.0 };
        let (name, of, level) = (own.cut.name.clone(), own.cut.of.clone(), own.level);
        MadeDesign { name, of, level, volume: own.cut.volume() / across }
    };
    MadeBody { parts, designs: cuts.iter().map(design).collect() }
}

/// A body as its designs make it.
#[derive(Clone, Debug)]
pub struct MadeBody {
    /// Its parts; void is none of them.
    pub parts: Vec<MadePart>,
    /// The designs that were cut.
    pub designs: Vec<MadeDesign>,
}

/// A design that was cut.
#[derive(Clone, Debug)]
pub struct MadeDesign {
    /// The name of its control.
    pub name: String,
    /// Its own name.
    pub of: String,
    /// Where it was cut.
    pub level: f64,
    /// The volume that its field stands for, of a plane body the area.
    pub volume: f64,
}

/// A part of such a body.
#[derive(Clone, Debug)]
pub struct MadePart {
    /// What it is made of.
    pub simplices: LevelSimplices,
    /// Which of the given regions it lies in.
    pub regions: Vec<usize>,
    /// The names of the designs' controls: of what is above its level, with `_rest` of a mixture that is below.
    pub names: Vec<String>,
    /// The mixtures and electrodes that act on it.
    pub mixed: Vec<String>,
    /// Those of them that are above their level there: the second law, what is covered.
    pub second: Vec<String>,
}

/// What a design leaves of a part: of a density what is filled, of a mixture both.
fn divided(part: Part, CutBody { cut, level }: &CutBody) -> Vec<Part> {
    let Part { names, second, body } = part;
    let with = |name: String| names.iter().cloned().chain([name]).collect::<Vec<_>>();
    let above = Part {
        names: with(cut.name.clone()),
        second: second.iter().cloned().chain(cut.is_mixture.then(|| cut.of.clone())).collect(),
        body: body.with_values(cut.nodal.clone()).above(*level),
    };
    if !cut.is_mixture {
        return vec![above];
    }
    let below = body.with_values(cut.nodal.iter().map(|s| -s).collect()).above(-level);
    vec![above, Part { names: with(format!("{}_rest", cut.name)), second, body: below }]
}

/// The name of a material where some mixtures are their second law.
fn name_of(material: &Material, second: &[String]) -> String {
    let own = || material.name.clone().unwrap_or_else(|| material.law.name.to_owned());
    let is_other = |design: &&Design| design.kind == DesignKind::Mixture && second.contains(&design.name);
    match material.design.iter().rev().find(is_other).and_then(|design| design.with.as_ref()) {
        Some(MixedLaw::Name(name)) => name.clone(),
        Some(MixedLaw::Law(law)) if law.law.name == material.law.name => format!("{} (second)", own()),
        Some(MixedLaw::Law(law)) => law.law.name.to_owned(),
        None => own(),
    }
}

/// Writes the vector fields among the controls that vary over the body, as remanences: `directions_NAME.csv`, of each cell that is not void its centre and volume at
/// rest, the unit vector and the length.
pub(crate) fn write_directions(
    files: &mut DesignFiles<'_>,
    m: &[f64],
    stage: usize,
    cuts: &[CutBody],
) -> Result<(), WriteError> {
    let (problem, mesh, scale) = (files.problem, files.problem.mesh(), files.scale);
    let is_void = |cell: u32, load_case: Option<usize>| {
        let is_of = |cut: &Cut| !cut.is_mixture && (cut.load_case.is_none() || cut.load_case == load_case);
        let mut densities = cuts.iter().filter(|own| is_of(&own.cut));
        densities.any(|own| {
            own.cut.cells.binary_search(&cell).is_ok() && mean_of(mesh, cell, |node| own.cut.nodal[node]) < own.level
        })
    };
    for (block, field) in problem.ensemble.blocks().iter().zip(&problem.controls) {
        let member = problem.member(block.owner);
        let own = &member.reduced().layout_in_stage(stage).blocks()[block.field];
        let Some(target) = own.targets.first().filter(|target| target.slots == 3 && !target.adds) else { continue };
        if own.basis.is_of_contribution() || own.basis.len() < 2 || own.knots.is_some() {
            continue;
        }
        let disc = member.solid().discretization();
        let acts = acts_in(&own.basis, disc);
        let vectors = disc.cell_average(&target.map.values(&own.field.values(block.of(m))), 3);
        let cells = (0..mesh.cells() as u32).filter(|cell| acts[*cell as usize] && !is_void(*cell, field.load_case));
        let made = files.made(&field.name);
        let head = format!("x_mm,y_mm,z_mm,volume_mm{},e_x,e_y,e_z,length_{}\n", mesh.dim(), field.unit);
        let name = format!("directions_{}.csv", field.name);
        files.directory.write_text(&name, &(head + &rows(mesh, made, cells, &vectors, scale)))?;
        files.told.files.push(name);
    }
    Ok(())
}

/// Centre, volume, unit vector and length of cells, a line each.
fn rows(mesh: &Mesh, made: &[[f64; 3]], cells: impl Iterator<Item = u32>, vectors: &[f64], scale: f64) -> String {
    let volumes = mesh.volumes(made);
    let row = |cell: u32| {
        let vector = [0, 1, 2].map(|k| vectors[3 * cell as usize + k]);
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit = vector.map(|x| if length > 0.0 { x / length } else { 0.0 });
        let centre = [0, 1, 2].map(|k| scale * mean_of(mesh, cell, |node| made[node][k]));
        let volume = volumes[cell as usize] * scale.powi(mesh.dim() as i32);
        let numbers = centre.into_iter().chain([volume]).chain(unit).chain([length]);
        numbers.map(|x| x.to_string()).collect::<Vec<_>>().join(",") + "\n"
    };
    cells.map(row).collect()
}

/// The mean over the corners of a cell.
fn mean_of(mesh: &Mesh, cell: u32, value: impl Fn(usize) -> f64) -> f64 {
    let cell = mesh.cell(cell as usize);
    let corners = &cell.nodes[..cell.kind.corners()];
    corners.iter().map(|node| value(*node as usize)).sum::<f64>() / corners.len() as f64
}
