//! How thin a design is where it is thinnest: bars of what is filled, gaps of what is left out.

use crate::cut_design::{Cut, CutBody, DesignFiles};
use nastic_case::lower::CaseProblem;
use nastic_case::warning::{THIN, Warning};
use nastic_language::number::short;
use nastic_language::schema::Control;
use nastic_mesh::{LeastWidth, WallKind};
use nastic_report::record::{ControlRecord, WidthRecord, numbers};

/// Finds the least widths of a design at a level at rest, and warns of those below what its control asks for, or below its filter.
pub(crate) fn find(files: &mut DesignFiles<'_>, CutBody { cut, level }: &CutBody, record: &mut ControlRecord) {
    use WallKind::{Cut as Wall, Joint, Skin};
    // what is filled goes on in other cells and ends at the skin; a void the other way round; materials of a mixture end at both
    let (of_bar, of_gap): (&[WallKind], &[WallKind]) = match cut.is_mixture {
        true => (&[Wall, Skin, Joint], &[Wall, Skin, Joint]),
        false => (&[Wall, Skin], &[Wall, Joint]),
    };
    let rest = files.made(&cut.name);
    let (problem, all) = (files.problem, &mut files.told);
    let (dim, unit) = (problem.mesh().dim(), problem.units().length().symbol);
    let bar = cut.body.least_width(rest, *level, of_bar);
    let gap = cut.rest.least_width(rest, -level, of_gap);
    let of_record = |own: LeastWidth| WidthRecord { width: own.width.into(), position: numbers(&own.position) };
    (record.smallest_bar, record.smallest_gap) = (bar.map(of_record), gap.map(of_record));
    let said: Vec<String> = [("bar", bar), ("gap", gap)]
        .into_iter()
        .filter_map(|(what, own)| Some(format!("smallest {what} {}", place(own?, dim, unit))))
        .collect();
    if !said.is_empty() {
        all.lines.push(format!("design      {}: {}", cut.name, said.join(", ")));
    }
    let Some(control) = control_of(problem, cut) else { return };
    for (what, own, least, key) in
        [("bar", bar, control.least_bar, "least_bar"), ("gap", gap, control.least_gap, "least_gap")]
    {
        let asked = least.map(|least| (least, format!("\"{key}\"")));
        let filter = control.filter.map(|length| (length, "the length of its filter".to_owned()));
        let Some((own, (bound, of))) = own.zip(asked.or(filter)) else { continue };
        if own.width < bound {
            let place = place(own, dim, unit);
            let message =
                format!("the smallest {what} of \"{}\" is {place}: below {of}, {} {unit}", cut.name, short(bound));
            all.warnings.push(Warning::new(&THIN, message));
        }
    }
}

fn place(own: LeastWidth, dim: usize, unit: &str) -> String {
    let place = own.position[..dim].iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ");
    format!("{} {unit} at ({place})", short(own.width))
}

/// The block of the case that is the control of a design.
fn control_of<'p>(problem: &'p CaseProblem, cut: &Cut) -> Option<&'p Control> {
    let at = &problem.controls.iter().find(|field| field.name == cut.name)?.at;
    let mut all = problem.members().flat_map(|member| &member.case().controls);
    all.find(|control| control.at == *at)
}
