//! Designs cut into bodies, for STL and 3MF files.

use crate::files::Directory;
use crate::{least_widths, made_body};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{CUT_VOLUME, Warning};
use nastic_control::{Basis, ControlMap, Expansion};
use nastic_fem::{Discretization, State};
use nastic_io::WriteError;
use nastic_language::number::short;
use nastic_language::schema::DesignKind;
use nastic_language::syntax::{Diagnostics, Document};
use nastic_mesh::LevelBody;
use nastic_report::record::{ByName, ControlRecord};

/// A plane body becomes a plate as thick as this share of its diagonal.
const PLATE_THICKNESS: f64 = 0.1;
/// Slicers take millimetres.
const EXPONENT_OF_MILLIMETRE: i32 = -3;
/// Values of a field from 0 to 1 that differ by rounding alone, as those of cells that a symmetry maps to each other: on one side of a level.
const VALUE_ROUNDING: f64 = 1e-9;
/// Share of its region by which the volume of a body may differ from that of the field without a word.
const VOLUME_TOLERANCE: f64 = 0.01;

/// What was cut.
#[derive(Default)]
pub struct CutDesigns {
    /// The names of the files.
    pub files: Vec<String>,
    /// Of bodies that have another volume than the field, or thin parts.
    pub warnings: Vec<Warning>,
    /// What the terminal says of them: how wide they are, files that are not written, as nothing is in them.
    pub lines: Vec<String>,
}

/// What a design is cut into.
pub(crate) struct Cut {
    /// The name of its control.
    pub name: String,
    /// The name of its design.
    pub of: String,
    /// The load case that has it alone.
    pub load_case: Option<usize>,
    /// Its cells, ascending.
    pub cells: Vec<u32>,
    /// The field at the nodes of the mesh.
    pub nodal: Vec<f64>,
    /// Where the field is above the level: what a density fills, the second law of a mixture, what electrodes cover.
    pub body: LevelBody,
    /// The rest, the field with the other sign.
    pub rest: LevelBody,
    /// Whether the rest is a material, as of a mixture or of a film beside its electrodes, and no void.
    pub is_mixture: bool,
    /// Of the whole field: the volume that it stands for.
    volume: f64,
    /// The volume of its region.
    region: f64,
    /// The thickness of plates.
    pub thickness: f64,
    /// Above it lie the cells that have together, as nearly as cells can, the volume that the field stands for; `None` of a field that is not made so.
    cell_level: Option<f64>,
}

impl Cut {
    /// The volume that the field stands for, of a plate.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Those of the designs between 0 and 1 that are fields over the body.
    fn all(problem: &CaseProblem, m: &[f64], stage: usize) -> Vec<Self> {
        let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
        let of = |(block, field): (&nastic_ensemble::EnsembleBlock, &nastic_case::lower::ControlField)| {
            let member = problem.member(block.owner);
            let own = &member.reduced().layout_in_stage(stage).blocks()[block.field];
            let has = |kind: DesignKind| {
                problem.case.designs().any(|own_kind| own_kind.name == own.name && own_kind.kind == kind)
            };
            let is_mixture = !has(DesignKind::Density);
            let is_field = own.components == 1 && !own.log && own.knots.is_none() && !own.basis.is_of_contribution();
            if !is_field || (is_mixture && !has(DesignKind::Mixture) && !has(DesignKind::Electrode)) {
                return None;
            }
            let map = own.field.clone().then(Expansion { basis: own.basis.clone(), components: 1 });
            let (disc, mesh) = (member.solid().discretization(), member.mesh());
            let (values, acts) = (disc.cell_average(&map.values(block.of(m)), 1), acts_in(&own.basis, disc));
            let cells: Vec<u32> = (0..mesh.cells() as u32).filter(|cell| acts[*cell as usize]).collect();
            let volumes = mesh.volumes(mesh.points());
            let of_cells = |all: &[f64]| cells.iter().map(|cell| all[*cell as usize]).collect::<Vec<_>>();
            let (values, volumes) = (of_cells(&values), of_cells(&volumes));
            let thickness = PLATE_THICKNESS * mesh.diagonal();
            let across = if mesh.dim() == 2 { thickness } else { 1.0 };
            let volume = across * values.iter().zip(&volumes).map(|(s, v)| s * v).sum::<f64>();
            let region = across * volumes.iter().sum::<f64>();
            let nodal = LevelBody::nodal_means(mesh, &cells, &values, &volumes);
            let body = LevelBody::of_nodes(mesh, &cells, nodal.clone(), thickness);
            let rest = body.with_values(nodal.iter().map(|s| -s).collect());
            let is_made = problem.case.is_made(&own.name) && own.can_be_cut();
            let cell_level = is_made.then(|| level_of_cells(&values, &volumes));
            let (name, of, load_case) = (field.name.clone(), own.name.clone(), field.load_case);
            Some(Cut {
                name,
                of,
                load_case,
                cells,
                nodal,
                body,
                rest,
                is_mixture,
                volume,
                region,
                thickness,
                cell_level,
            })
        };
        blocks.filter_map(of).collect()
    }
}

/// Whether a field acts in each cell.
pub(crate) fn acts_in(basis: &Basis, disc: &Discretization) -> Vec<bool> {
    let acting: Vec<f64> = (0..disc.points().len()).map(|q| f64::from(u8::from(basis.acts_at(q)))).collect();
    disc.cell_average(&acting, 1).into_iter().map(|share| share > 0.5).collect()
}

/// The level between the values of cells above which the cells have, as nearly as whole cells can, the volume `sum_k s_k V_k`.
fn level_of_cells(values: &[f64], volumes: &[f64]) -> f64 {
    let wanted: f64 = values.iter().zip(volumes).map(|(s, v)| s * v).sum();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    let (Some(most), Some(least)) = (order.first(), order.last()) else { return 0.0 };
    // before the first and behind the last all are on one side
    let (mut best, mut above) = ((wanted, values[*most].max(1.0)), 0.0);
    for (k, cell) in order.iter().enumerate() {
        above += volumes[*cell];
        let level = match order.get(k + 1) {
            Some(next) if values[*cell] - values[*next] <= VALUE_ROUNDING => continue,
            Some(next) => 0.5 * (values[*cell] + values[*next]),
            None => values[*least].min(0.0) - 1.0,
        };
        let error = (above - wanted).abs();
        if error < best.0 {
            best = (error, level);
        }
    }
    best.1
}

/// The case of an optimum with every density and mixture cut into cells of 0 and 1, of the volumes of their fields as nearly as cells allow; `None` where
/// there is none, one by node or on a grid, or no file.
///
/// # Errors
/// Controls that are not in the case where they were.
pub fn cut_case(problem: &CaseProblem, m: &[f64], stage: usize) -> Result<Option<Document>, Diagnostics> {
    let cuts = Cut::all(problem, m, stage);
    let levels: Option<Vec<f64>> = cuts.iter().map(|cut| cut.cell_level).collect();
    let Some(levels) = levels.filter(|levels| !levels.is_empty() && problem.case_file().is_some()) else {
        return Ok(None);
    };
    let mut document = problem.document.clone();
    for (cut, level) in cuts.iter().zip(levels) {
        if let Some(field) = problem.controls.iter().find(|field| field.name == cut.name) {
            document.set(&format!("{}/cut={level}", field.at.as_str()))?;
        }
    }
    Ok(Some(document))
}

/// A design at the level at which its body has the volume that the field stands for.
pub(crate) struct CutBody {
    pub cut: Cut,
    pub level: f64,
}

impl CutBody {
    /// Those of a control vector.
    pub fn all(problem: &CaseProblem, m: &[f64], stage: usize) -> Vec<Self> {
        let level = |cut: &Cut| cut.body.level_of_volume(problem.mesh().points(), cut.volume);
        Cut::all(problem, m, stage).into_iter().map(|cut| CutBody { level: level(&cut), cut }).collect()
    }
}

/// Where the points of the mesh are of a load case, in its first member.
pub struct MemberShape<'a> {
    /// That member.
    pub member: CaseMember<'a>,
    /// As it is made: drawn, or where a change of shape has moved it.
    pub made: Vec<[f64; 3]>,
    /// In its equilibrium.
    pub deformed: Vec<[f64; 3]>,
}

impl<'a> MemberShape<'a> {
    /// Of a state whose points are there.
    #[must_use]
    pub fn new(member: CaseMember<'a>, state: &State, deformed: Vec<[f64; 3]>) -> Self {
        let (mut made, dim) = (member.mesh().points().to_vec(), member.mesh().dim());
        if let Some(s) = member.solid().model().shape_displacement(&state.controls) {
            let moves = made.iter_mut().zip(s.chunks_exact(dim));
            moves.for_each(|(x, s)| x.iter_mut().zip(s).for_each(|(x, s)| *x += s));
        }
        MemberShape { member, made, deformed }
    }

    /// Whether it has a control of that name in results.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.member.fields().any(|(_, field)| field.name == name)
    }
}

/// Where bodies go, and what is told of them.
pub(crate) struct DesignFiles<'a> {
    pub problem: &'a CaseProblem,
    /// Of every load case.
    pub shapes: &'a [MemberShape<'a>],
    pub directory: &'a Directory,
    /// From the case's lengths to millimetres.
    pub scale: f64,
    pub told: CutDesigns,
}

/// Cuts the designs of a control vector at the levels at which their bodies have the volume that the fields stand for, tells levels, volumes and least widths, and
/// writes the bodies: at rest, and deformed as the first member of every load case that has the design.
///
/// # Errors
/// What the system answers.
pub fn write(
    problem: &CaseProblem,
    (m, stage): (&[f64], usize),
    controls: &mut ByName<ControlRecord>,
    shapes: &[MemberShape<'_>],
    out: &Directory,
) -> Result<CutDesigns, WriteError> {
    let scale = 10f64.powi(problem.units().length().exponent - EXPONENT_OF_MILLIMETRE);
    let mut files = DesignFiles { problem, shapes, directory: out, scale, told: CutDesigns::default() };
    let cuts = CutBody::all(problem, m, stage);
    for own in &cuts {
        let mut none = ControlRecord::default();
        let record = controls.get_mut(&own.cut.name).unwrap_or(&mut none);
        files.compare_volumes(own, record);
        least_widths::find(&mut files, own, record);
        files.write_surfaces(own)?;
    }
    made_body::write(&mut files, &cuts)?;
    made_body::write_directions(&mut files, m, stage, &cuts)?;
    Ok(files.told)
}

impl<'a> DesignFiles<'a> {
    /// Where the points of a body are as it is made that has a control of that name.
    pub fn made(&self, name: &str) -> &'a [[f64; 3]] {
        let own = self.shapes.iter().find(|shape| shape.has(name));
        own.map_or(self.problem.mesh().points(), |shape| &shape.made)
    }

    /// The level and the volume, of the drawn body, of a body, with a warning where that is not the volume of the field.
    fn compare_volumes(&mut self, CutBody { cut, level }: &CutBody, record: &mut ControlRecord) {
        let own = cut.body.surface(self.problem.mesh().points(), *level).volume();
        // the volume of nothing is 0, not -0
        let [cut_share, share] = [own, cut.volume].map(|volume| volume / cut.region + 0.0);
        (record.level, record.cut_volume) = ((*level).into(), cut_share.into());
        if (cut_share - share).abs() > VOLUME_TOLERANCE {
            let [name, level] = [&cut.name, &short(*level)];
            let [cut_share, share] = [cut_share, share].map(|share| short(100.0 * share));
            let message = format!("\"{name}\" is {share} % of its region, and above the level {level} {cut_share} %");
            self.told.warnings.push(Warning::new(&CUT_VOLUME, message));
        }
    }

    /// The STL files of a design.
    fn write_surfaces(&mut self, CutBody { cut, level }: &CutBody) -> Result<(), WriteError> {
        let made = self.made(&cut.name);
        let parts = [("", Some(&cut.body), *level), ("_rest", cut.is_mixture.then_some(&cut.rest), -level)];
        for (part, body, level) in parts.into_iter().filter_map(|(part, body, level)| Some((part, body?, level))) {
            let mut put = |name: String, positions: &[[f64; 3]]| {
                let surface = body.surface(positions, level);
                if surface.triangles.is_empty() {
                    return Ok(false);
                }
                self.directory.write_stl(&name, &surface, self.scale)?;
                self.told.files.push(name);
                Ok(true)
            };
            let name = format!("design_{}{part}.stl", cut.name);
            if !put(name.clone(), made)? {
                self.told.lines.push(format!("design      {name} is not written: it is empty"));
                continue;
            }
            for shape in self.shapes.iter().filter(|shape| shape.has(&cut.name)) {
                put(shape.member.case_file(&format!("design_{}{part}_deformed.stl", cut.name)), &shape.deformed)?;
            }
        }
        Ok(())
    }
}
