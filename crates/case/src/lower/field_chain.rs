//! What stands between the unknowns of a control and its field: values that are held, symmetry, filter, projection, cut.

use super::context::Context;
use super::control_field::Admitted;
use super::{design, material};
use crate::warning::GRID_RESOLUTION;
use nastic_control::{ControlBlock, ControlMap, Plane, Projection, Reduced, Space};
use nastic_fem::Solid;
use nastic_language::expression::Formula;
use nastic_language::number::short;
use nastic_language::schema::{Bound, Case, Control, DesignKind, Parameter, SymmetryPlane};
use nastic_language::syntax::quoted;
use nastic_mesh::GroupNames;

/// Puts the links of a control in front of its field: what is held (once more behind all), symmetry, filter, projection, cut.
pub(super) fn add(case: &Case, control: &Control, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    check_overlaps(control, &reduced, context)?;
    reduced = hold(case, control, reduced, context)?;
    let held = held_alone(control, &reduced);
    for (k, plane) in control.symmetry.iter().enumerate() {
        let plane = match plane {
            SymmetryPlane::Middle(axis) => {
                let mut normal = [0.0; 3];
                normal[*axis] = 1.0;
                Plane { point: None, normal }
            }
            SymmetryPlane::Given(plane) => Plane { point: Some(plane.point.xyz()), normal: plane.normal.xyz() },
        };
        reduced = context.take(&control.at.key("symmetry").index(k), reduced.mirror(&control.of, plane))?;
    }
    let mirrored = held_alone(control, &reduced);
    if held.iter().zip(&mirrored).any(|(own, image)| own.is_finite() && own != image) {
        let message = "what is held is not symmetric about the planes of \"symmetry\": hold its mirror image at the same value too";
        context.complain(&control.at.key("fixed"), message);
        return None;
    }
    if let Some(length) = control.filter {
        let at = control.at.key("filter");
        reduced = context.take(&at, reduced.filter(&control.of, length))?;
        let spacing = reduced.layout().block(&control.of).ok().and_then(|block| spacing(block, &reduced));
        if let Some(spacing) = spacing.filter(|spacing| length < *spacing) {
            let unit = context.units.length().symbol;
            let message = format!(
                "a length of {} {unit} smooths nothing: the unknowns lie {} {unit} apart",
                short(length),
                short(spacing)
            );
            context.warn(&GRID_RESOLUTION, &at, message);
        }
    }
    if let Some(projection) = &control.projection {
        let at = control.at.key("projection");
        let Some(range) = range(case, control) else {
            let message = "a projection goes from the lower end of a control to the upper one: give \"lower\" and \"upper\", each one number";
            context.complain(&at, message);
            return None;
        };
        let of = |sharpness: &f64| Projection { threshold: projection.eta, sharpness: *sharpness };
        let stages: Vec<Projection> = projection.sharpness.0.iter().map(of).collect();
        reduced = context.take(&at, reduced.project(&control.of, &stages, range))?;
    }
    if let Some(level) = control.cut {
        let at = control.at.key("cut");
        if !case.is_made(&control.of) {
            context.complain(&at, not_made(control));
            return None;
        }
        let grey = |value: &&Formula| value.constant().is_some_and(|value| value != 0.0 && value != 1.0);
        if let Some(value) = control.fixed.values().find(grey) {
            let message = format!("\"fixed\" holds {} in a region, which is neither 0 nor 1", value.text());
            context.complain(&at, message);
            return None;
        }
        reduced = context.take(&at, reduced.cut(&control.of, level))?;
    }
    let widths = [("least_bar", control.least_bar), ("least_gap", control.least_gap)];
    let given = widths.into_iter().find(|(_, width)| width.is_some());
    if let Some((key, _)) = given.filter(|_| !case.is_made(&control.of)) {
        context.complain(&control.at.key(key), not_made(control));
        return None;
    }
    if control.symmetry.is_empty() && control.filter.is_none() && control.projection.is_none() && control.cut.is_none()
    {
        return Some(reduced);
    }
    hold(case, control, reduced, context)
}

fn not_made(control: &Control) -> String {
    format!("{} is no density, mixture or electrode, or a filler too: what is made is cut", quoted(&control.of))
}

/// The values of a field that hang on no unknown; NaN where others do.
fn held_alone(control: &Control, reduced: &Reduced) -> Vec<f64> {
    let block = reduced.layout().block(&control.of).ok();
    block.map(|block| block.field.values(&vec![f64::NAN; block.size()])).unwrap_or_default()
}

/// Complains of cells in two regions in which the control has different values.
fn check_overlaps(control: &Control, reduced: &Reduced, context: &mut Context<'_>) -> Option<()> {
    let mesh = reduced.solid().mesh();
    let cells = |region: &str| mesh.cells_of(&GroupNames::from(region)).unwrap_or_default();
    let fixed: Vec<_> = control.fixed.iter().map(|(region, value)| (region, value.constant(), cells(region))).collect();
    for (k, (region, value, own)) in fixed.iter().enumerate() {
        let shares = |cells: &[u32]| cells.iter().any(|cell| own.binary_search(cell).is_ok());
        let other = fixed[..k].iter().find(|(_, other, cells)| other != value && shares(cells));
        if let Some((other, ..)) = other {
            let message =
                format!("has another value in {}, and cells are in both regions: let one be enough", quoted(other));
            context.complain(&control.at.key("fixed").key(region), message);
            return None;
        }
    }
    Some(())
}

fn hold(case: &Case, control: &Control, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for (region, value) in &control.fixed {
        let at = control.at.key("fixed").key(region);
        let value = value.constant()?;
        if let Some([low, high]) =
            design::range(case, &control.of).filter(|_| !design::admits(case, &control.of, value))
        {
            let message = format!("{} lies outside what {} may be, {low} to {high}", short(value), quoted(&control.of));
            context.complain(&at, message);
            return None;
        }
        if control.log && value <= 0.0 {
            context.complain(&at, format!("{value} has no logarithm: with \"log\" all values are positive"));
            return None;
        }
        reduced = context.take(&at, reduced.hold(&control.of, GroupNames::from(region.as_str()), value))?;
    }
    Some(reduced)
}

/// Refuses values in regions beyond the bounds, or that the law of a number refuses; those of designs are held against their laws.
pub(super) fn check_fixed(
    case: &Case,
    control: &Control,
    admitted: Admitted,
    solid: &Solid,
    context: &mut Context<'_>,
) -> Option<()> {
    let Admitted::Between { lower, upper } = admitted else { return Some(()) };
    for (region, value) in control.fixed.iter().filter(|_| !case.has_design(&control.of)) {
        let value = value.constant()?;
        let message = match material::refused(case, &control.of, [value; 2], solid, context) {
            Some(refused) => format!("{} is not what its law admits: {refused}", short(value)),
            None if value < lower || value > upper => {
                format!("{} lies outside the bounds, {} to {}", short(value), short(lower), short(upper))
            }
            None => continue,
        };
        context.complain(&control.at.key("fixed").key(region), message);
        return None;
    }
    Some(())
}

/// The ends between which a control is projected: of a design between 0 and 1 these, else its bounds.
fn range(case: &Case, control: &Control) -> Option<[f64; 2]> {
    let mut own = case.designs().filter(|own| own.name == control.of).peekable();
    if own.peek().is_some() && own.all(|own| own.kind != DesignKind::Filler) {
        return Some([0.0, 1.0]);
    }
    let end = |bound: &Option<Bound>| bound.as_ref().and_then(|bound| bound.scalar()).and_then(Parameter::constant);
    Some([end(&control.lower)?, end(&control.upper)?])
}

/// The mean distance of neighbouring unknowns: the side of a cube of the volume that each has; `None` of fields without neighbours.
fn spacing(block: &ControlBlock, reduced: &Reduced) -> Option<f64> {
    if !matches!(block.basis.space(), Space::Cell | Space::Node | Space::Grid(_)) || block.basis.is_empty() {
        return None;
    }
    let disc = reduced.solid().discretization();
    let acting = disc.points().weights().iter().enumerate().filter(|(q, _)| block.basis.acts_at(*q));
    let volume: f64 = acting.map(|(_, weight)| weight).sum();
    Some((volume / block.basis.len() as f64).powf(1.0 / disc.dim() as f64))
}
