//! Pictures of start, target and result, for those who do not have ParaView open.

use super::files::Directory;
use super::snapshot;
use crate::lower::CaseMember;
use nastic_control::Space;
use nastic_io::WriteError;
use nastic_mesh::Snapshot;
use nastic_picture::{Appearance, Body, Colour, Field, Picture};

/// What is drawn.
pub(crate) struct Drawing<'a> {
    pub title: String,
    pub subtitle: String,
    /// The state drawn solid, and its name in the legend.
    pub body: (&'a str, &'a Snapshot),
    /// A state drawn as glass behind it.
    pub ghost: Option<(&'a str, &'a Snapshot)>,
}

/// Writes `picture.png` and `picture.svg`; their names begin with the member's load case.
pub(crate) fn write(member: CaseMember<'_>, drawing: &Drawing<'_>, to: &Directory) -> Result<(), WriteError> {
    let picture = compose(member, drawing);
    let write = |name: &str| picture.write(to.file(&member.case_file(name)));
    let (png, svg) = rayon::join(|| write("picture.png"), || write("picture.svg"));
    png.and(svg)
}

/// The picture of a member.
pub(crate) fn compose(member: CaseMember<'_>, drawing: &Drawing<'_>) -> Picture {
    let mut picture =
        Picture::new(&drawing.title).subtitle(&drawing.subtitle).length_unit(member.problem().units().length().symbol);
    if let Some((label, ghost)) = drawing.ghost {
        picture = picture.body(Body::of(label, ghost).appearance(Appearance::Glass(Colour::GREY)));
    }
    for target in member.targets().iter().filter(|target| target.is_whole()) {
        if let Ok(shape) = snapshot::target(target) {
            picture = picture.body(Body::of("target", &shape).appearance(Appearance::Glass(Colour::RED)));
        }
    }
    let (label, body) = drawing.body;
    picture.body(Body::of(label, body).appearance(appearance(member, body)))
}

/// Coloured by the first scalar control, else by J.
fn appearance(member: CaseMember<'_>, body: &Snapshot) -> Appearance {
    for (block, field) in member.fields() {
        if block.components == 1 {
            let array = match block.map.space() {
                Space::Node => {
                    body.point_array(&field.array).map(|a| Field::at_nodes(&a.name, &field.unit, a.values.clone()))
                }
                _ => body.cell_array(&field.array).map(|a| Field::at_cells(&a.name, &field.unit, a.values.clone())),
            };
            if let Some(array) = array {
                return Appearance::Field(array);
            }
        }
    }
    match body.cell_array("J") {
        Some(array) => Appearance::Field(Field::at_cells("J", "", array.values.clone())),
        None => Appearance::Solid(Colour::BLUE),
    }
}
