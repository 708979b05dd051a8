//! Checks that need no geometry: lengths, indices, finite coordinates, repeated nodes.

use super::RawMesh;
use super::raw::Element;
use crate::Fault;
use crate::error::MAX_ENTITIES;

pub(super) fn check(raw: &RawMesh) -> Result<(), Fault> {
    lengths(raw)?;
    for (node, point) in raw.points.iter().enumerate() {
        if !point.iter().all(|x| x.is_finite()) {
            return Err(Fault::NotFinite { node: raw.node_label(node as u32), point: *point });
        }
    }
    for &(node, tag) in &raw.vertices {
        if node as usize >= raw.points.len() {
            return Err(Fault::VertexOutOfRange { tag, node, nodes: raw.points.len() });
        }
    }
    raw.elements().try_for_each(|element| connectivity(raw, &element))
}

fn lengths(raw: &RawMesh) -> Result<(), Fault> {
    let elements = raw.blocks.iter().map(|b| b.nodes.len() / b.kind.nodes()).sum();
    for (what, found) in [("nodes", raw.points.len()), ("elements", elements)] {
        if found > MAX_ENTITIES {
            return Err(Fault::TooMany { what, found });
        }
    }
    if !raw.node_labels.is_empty() && raw.node_labels.len() != raw.points.len() {
        let what = "labels of the nodes".to_owned();
        return Err(Fault::Inconsistent { what, found: raw.node_labels.len(), expected: raw.points.len() });
    }
    for (k, block) in raw.blocks.iter().enumerate() {
        let n = block.kind.nodes();
        let whole = block.nodes.len() / n;
        if block.nodes.len() != whole * n {
            let what = format!("connectivity of element block {k} ({})", block.kind);
            return Err(Fault::Inconsistent { what, found: block.nodes.len(), expected: (whole + 1) * n });
        }
        if !block.labels.is_empty() && block.labels.len() != whole {
            let what = format!("labels of element block {k} ({})", block.kind);
            return Err(Fault::Inconsistent { what, found: block.labels.len(), expected: whole });
        }
    }
    Ok(())
}

fn connectivity(raw: &RawMesh, element: &Element) -> Result<(), Fault> {
    let (cell, kind, nodes) = (element.label, element.kind, raw.points.len());
    for (k, &node) in element.nodes.iter().enumerate() {
        if node as usize >= nodes {
            return Err(Fault::NodeOutOfRange { cell, kind, node, nodes });
        }
        if element.nodes[..k].contains(&node) {
            return Err(Fault::RepeatedNode { cell, kind, node: raw.node_label(node) });
        }
    }
    Ok(())
}
