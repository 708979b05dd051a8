//! Pictures of start, target and result, for those who do not have ParaView open.

use crate::cut_design::acts_in;
use crate::files::Directory;
use crate::snapshot;
use nastic_case::lower::{Admitted, CaseMember, ControlField, TargetShape, obstacle_shape};
use nastic_control::{ControlBlock, Space};
use nastic_io::WriteError;
use nastic_language::schema::DesignKind;
use nastic_mesh::{NamedArray, Snapshot};
use nastic_picture::{Appearance, Body, Colour, Face, Field, Picture, Sheet};
use nastic_report::record::{PLAIN_LINES, StateRecord, TENSED_LINES, number_of};
use nastic_report::{FIELD, obstacles_label, tension, uniform_field, with_marks};
use std::mem::take;

/// What is drawn.
pub struct Drawing<'a> {
    /// The title.
    pub title: String,
    /// The line below it.
    pub subtitle: String,
    /// The state drawn solid, and its name in the legend.
    pub body: (&'a str, &'a Snapshot),
    /// States drawn as glass behind it.
    pub ghosts: Vec<(&'a str, &'a Snapshot)>,
    /// States of further scenarios, each with the title of its picture.
    pub scenarios: Vec<(String, Snapshot)>,
    /// The mean shape over all scenarios, with `deviation_norm`, and the title of all of them.
    pub mean: Option<(String, Snapshot)>,
}

/// States with their names.
pub fn named(shots: &[(String, Snapshot)]) -> Vec<(&str, &Snapshot)> {
    shots.iter().map(|(name, shot)| (name.as_str(), shot)).collect()
}

/// Further scenarios that are drawn.
pub const SCENARIOS: usize = 2;
/// Load cases that are drawn side by side.
pub const LOAD_CASES: usize = 4;
/// Controlled fields that are drawn.
const FIELDS: usize = 6;
/// Density below which a cell of a body in space is void, and hides what is behind it.
const VOID: f64 = 0.5;

/// Writes `picture.png` and `picture.svg`; their names begin with the member's load case.
///
/// # Errors
/// What the system answers.
pub fn write(member: CaseMember<'_>, pictures: Vec<Picture>, to: &Directory) -> Result<(), WriteError> {
    write_sheet(pictures, |name| member.case_file(name), to)
}

/// The same of several members, under names without a beginning.
///
/// # Errors
/// What the system answers.
pub fn write_together(pictures: Vec<Picture>, to: &Directory) -> Result<(), WriteError> {
    write_sheet(pictures, str::to_owned, to)
}

fn write_sheet(pictures: Vec<Picture>, name: impl Fn(&str) -> String + Sync, to: &Directory) -> Result<(), WriteError> {
    let sheet = Sheet::new(pictures);
    let write = |file: &str| sheet.write(to.own(&name(file))?);
    let (png, svg) = rayon::join(|| write("picture.png"), || write("picture.svg"));
    png.and(svg)
}

/// The pictures of a member: its state, once for every field that is controlled; further scenarios; their mean.
pub fn compose(member: CaseMember<'_>, drawing: &Drawing<'_>) -> Vec<Picture> {
    let (label, whole) = drawing.body;
    let made = standing(member, whole);
    let body = made.as_ref().unwrap_or(whole);
    let mut pictures: Vec<Picture> = appearances(member, body)
        .into_iter()
        .map(|appearance| {
            let ground = ground(member, body, &drawing.title, &drawing.subtitle, &drawing.ghosts);
            ground.body(with_marks(Body::of(label, body).appearance(appearance), body))
        })
        .collect();
    for (title, state) in &drawing.scenarios {
        let made = standing(member, state);
        let state = made.as_ref().unwrap_or(state);
        let Some(appearance) = appearances(member, state).into_iter().next() else { continue };
        let ground = ground(member, state, title, "", &[]);
        pictures.push(ground.body(with_marks(Body::of(label, state).appearance(appearance), state)));
    }
    if let Some((title, mean)) = &drawing.mean
        && let Some(spread) = mean.point_array("deviation_norm")
    {
        let unit = member.problem().units().length().symbol;
        let field = Field::at_nodes("standard deviation", unit, spread.values.clone());
        let title = format!("{title}: mean of the scenarios");
        let ground = ground(member, mean, &title, "coloured by the standard deviation of positions", &[]);
        pictures.push(ground.body(Body::of("mean", mean).appearance(Appearance::Field(field))));
    }
    pictures
}

/// What stands of a body in space whose densities leave voids: a picture of all of it would show its faces alone. `None` of others.
fn standing(member: CaseMember<'_>, body: &Snapshot) -> Option<Snapshot> {
    let is_density = |block: &ControlBlock| {
        member.case().designs().any(|design| design.kind == DesignKind::Density && design.name == block.name)
    };
    if body.mesh.dim() == 2 {
        return None;
    }
    let disc = member.solid().discretization();
    let mut stands = vec![true; body.mesh.cells()];
    for (block, field) in member.fields().filter(|(block, _)| is_density(block)) {
        let acts = acts_in(&block.basis, disc);
        let at_cells = body.cell_array(&field.array);
        let at_nodes = body.point_array(&field.array);
        for (cell, stands) in stands.iter_mut().enumerate().filter(|(cell, _)| acts[*cell]) {
            let nodes = &body.mesh.cell(cell).nodes[..body.mesh.cell(cell).kind.corners()];
            let mean = |array: &NamedArray| {
                nodes.iter().map(|node| array.values[*node as usize]).sum::<f64>() / nodes.len() as f64
            };
            let density = at_cells.map(|array| array.values[cell]).or_else(|| at_nodes.map(mean));
            *stands &= density.is_none_or(|density| density >= VOID);
        }
    }
    if stands.iter().all(|stands| *stands) { None } else { body.of_cells(|cell| stands[cell]) }
}

/// The pictures of modes: a state moved on along each, under its title, and the state itself as glass.
pub fn of_modes(
    member: CaseMember<'_>,
    title: &str,
    about: &str,
    state: &Snapshot,
    modes: &[(String, Snapshot)],
) -> Vec<Picture> {
    let unit = member.problem().units().length().symbol;
    let picture = |(label, shape): &(String, Snapshot)| {
        Picture::new(title)
            .subtitle(label)
            .length_unit(unit)
            .body(Body::of(about, state).appearance(Appearance::Glass(Colour::GREY)))
            .body(Body::of("mode", shape).appearance(Appearance::Solid(Colour::BLUE)))
    };
    modes.iter().map(picture).collect()
}

/// Title, ghosts, targets, and obstacles where a state has them.
fn ground(
    member: CaseMember<'_>,
    state: &Snapshot,
    title: &str,
    subtitle: &str,
    ghosts: &[(&str, &Snapshot)],
) -> Picture {
    let mut picture = Picture::new(title).subtitle(subtitle).length_unit(member.problem().units().length().symbol);
    if let Some(field) = uniform_field(state) {
        picture = picture.vector("field", FIELD, field);
    }
    for (label, ghost) in ghosts {
        picture = picture.body(Body::of(label, ghost).appearance(Appearance::Glass(Colour::GREY)));
    }
    let mut label = obstacles_label(&obstacle_shape::names(member));
    let grey = |shape: &Snapshot| Body::of(&take(&mut label), shape).appearance(Appearance::Solid(Colour::GREY));
    let moved = state.obstacles.clone().map(Snapshot::new);
    let picture = obstacle_shape::all(member).iter().chain(&moved).map(grey).fold(picture, Picture::body);
    member.targets().iter().filter_map(target).fold(picture, Picture::body)
}

/// A target: all of it, or the faces that are tracked; single points are not drawn.
fn target(target: &TargetShape) -> Option<Body> {
    let shape = snapshot::target(target).ok()?;
    let body = Body::of("target", &shape).appearance(Appearance::Glass(Colour::RED));
    if target.is_whole() {
        return Some(body);
    }
    let marked: Vec<bool> = target.displacement.iter().map(|(_, matters)| *matters).collect();
    let is_drawn = |face: &Face| face.nodes.iter().all(|node| marked[*node as usize]);
    Face::all(&shape.mesh).iter().any(is_drawn).then(|| body.part(marked))
}

/// One for every controlled field, vectors by their lengths; J where none is controlled but vectors of one length.
fn appearances(member: CaseMember<'_>, body: &Snapshot) -> Vec<Appearance> {
    let fields = member.fields().filter_map(|(block, field)| controlled(block, field, body));
    let mut out: Vec<Appearance> = fields.take(FIELDS).map(Appearance::Field).collect();
    if out.is_empty() {
        out.push(match body.cell_array("J") {
            Some(array) => Appearance::Field(Field::at_cells("J", "", array.values.clone())),
            None => Appearance::Solid(Colour::BLUE),
        });
    }
    out
}

fn controlled(block: &ControlBlock, field: &ControlField, body: &Snapshot) -> Option<Field> {
    // Vectors of one length have no colours that differ: their arrows say all.
    if matches!(field.admitted, Admitted::Norm(_)) {
        return None;
    }
    let values = |array: &NamedArray| match array.components {
        1 => (array.name.clone(), array.values.clone()),
        n => {
            let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            (format!("|{}|", array.name), array.values.chunks_exact(n).map(length).collect())
        }
    };
    if block.basis.space() == Space::Node {
        let (name, values) = values(body.point_array(&field.array)?);
        return Some(Field::at_nodes(&name, &field.unit, values));
    }
    let (name, values) = values(body.cell_array(&field.array)?);
    Some(Field::at_cells(&name, &field.unit, values))
}

/// What the arrows and lines of a picture are, for its subtitle; empty without any.
pub fn legend(body: &Snapshot) -> String {
    let tensions: Vec<f64> = body.lines.iter().filter_map(tension).collect();
    let tensed = match (tensions.is_empty(), tensions.iter().all(|tension| *tension > 0.0)) {
        (true, _) => String::new(),
        (false, true) => format!("; lines: {TENSED_LINES}"),
        (false, false) => format!("; lines: {TENSED_LINES}, grey where slack"),
    };
    let others = match (tensions.len() < body.lines.len(), tensions.is_empty()) {
        (false, _) => String::new(),
        (true, true) => format!("; lines: {PLAIN_LINES}"),
        (true, false) => format!("; {PLAIN_LINES} green"),
    };
    arrows(body).to_owned() + &tensed + &others
}

fn arrows(body: &Snapshot) -> &'static str {
    let has = |name: &str| body.cell_array(name).is_some_and(|array| array.values.iter().any(|x| *x != 0.0));
    match (has("B_r"), has("B_a")) {
        (true, true) => "; arrows: remanence black, field orange",
        (true, false) => "; arrows: remanence",
        (false, true) => "; arrows: field",
        (false, false) => "",
    }
}

/// Root mean square and true distances in a result or the entry of a member, for subtitles; empty without any.
pub fn distance(state: &StateRecord, unit: &str) -> String {
    let short = nastic_language::number::short;
    if let Some(distance) = state.hausdorff.as_ref().and_then(|distances| *distances.exact) {
        return format!("; true Hausdorff {} {unit}", short(distance));
    }
    match state.tracking.first().and_then(|(_, tracked)| number_of(tracked, "root_mean_square")) {
        Some(distance) => format!("; distance {} {unit} (root mean square)", short(distance)),
        None => String::new(),
    }
}
