//! Whether a picture can be drawn.

use super::body::{Appearance, FieldValues};
use super::picture::Picture;
use super::vector::unit;

/// What is wrong with the inputs of a picture, if anything is.
pub(super) fn check(picture: &Picture) -> Result<(), String> {
    if picture.bodies.is_empty() {
        return Err("the picture has no bodies".to_owned());
    }
    if let Some(path) = picture.paths.iter().find(|path| path.points.as_flattened().iter().any(|x| !x.is_finite())) {
        return Err(format!("the path \"{}\" has a point that is not finite", path.label));
    }
    for body in &picture.bodies {
        let (nodes, cells) = (body.mesh.points().len(), body.mesh.cells());
        let fits = |what: &str, found: usize, wanted: usize| {
            if found == wanted {
                return Ok(());
            }
            Err(format!("body \"{}\" has {found} {what} where {wanted} are needed", body.label))
        };
        fits("positions", body.positions.len(), nodes)?;
        if let Appearance::Field(field) = &body.appearance {
            let nodal = matches!(field.values, FieldValues::Nodes(_));
            fits("values", field.values().len(), if nodal { nodes } else { cells })?;
        }
        for arrows in &body.arrows {
            fits("arrows", arrows.vectors.len(), cells)?;
        }
        if body.polylines.iter().flat_map(|(_, points)| points.as_flattened()).any(|x| !x.is_finite()) {
            return Err(format!("body \"{}\" has a line with a point that is not finite", body.label));
        }
        if let Some((normal, offset)) = body.plane {
            if body.mesh.dim() == 2 {
                return Err(format!("body \"{}\" is plane: there is nothing to cut by a plane", body.label));
            }
            if unit(normal).is_none() || !offset.is_finite() {
                return Err(format!("body \"{}\" is cut by a plane whose normal is zero or not finite", body.label));
            }
        }
        if let Some(marked) = &body.part {
            fits("marks", marked.len(), nodes)?;
        }
        if let Some(node) = body.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(format!("body \"{}\" has a position that is not finite, at node {node}", body.label));
        }
    }
    Ok(())
}
