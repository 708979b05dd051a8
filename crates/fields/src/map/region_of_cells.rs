//! Which region gives each cell of a control by region its value.

use super::whole_body::WholeBody;
use crate::error::ControlError;
use nastic_mesh::{GroupNames, Mesh};
use std::collections::BTreeSet;

/// Number of the region, among those of the mesh, that gives each cell of an actuation its value.
pub(super) fn region_of_cells(
    mesh: &Mesh,
    named: &GroupNames,
    cells: &[u32],
    whole: &WholeBody,
) -> Result<Vec<u32>, ControlError> {
    let acts: BTreeSet<u32> = cells.iter().copied().collect();
    let shared = |of: &[u32]| of.iter().filter(|cell| acts.contains(cell)).count() as f64;
    let is_named = |name: &str| named.iter().any(|one| one == name);
    // whether a region divides the cells is a question about the whole body, of which this may be a part
    let own = mesh.regions().values().map(|of| shared(of)).chain([acts.len() as f64]);
    let counts = whole.counted(own.collect())?;
    let all = counts.last().copied().unwrap_or(0.0);
    // A region that has all the cells does not divide them, one that has none has nothing to do with them.
    let divides = |name: &str, shared: f64| !is_named(name) && shared > 0.0 && shared < all;
    let parts = || mesh.regions().iter().zip(&counts).enumerate();
    let divided = !named.are_several() && parts().any(|(_, ((name, _), shared))| divides(name, *shared));
    let parts =
        parts().filter(|(_, ((name, _), shared))| if divided { divides(name, **shared) } else { is_named(name) });
    let parts: Vec<(u32, &String, &Vec<u32>)> = parts.map(|(r, ((name, of), _))| (r as u32, name, of)).collect();
    whole.agreed(given(mesh, named, cells, &acts, &parts))
}

/// The same of cells that these regions divide.
fn given(
    mesh: &Mesh,
    named: &GroupNames,
    cells: &[u32],
    acts: &BTreeSet<u32>,
    parts: &[(u32, &String, &Vec<u32>)],
) -> Result<Vec<u32>, ControlError> {
    let mut of_cell = vec![u32::MAX; mesh.cells()];
    for (k, (r, name, of)) in parts.iter().enumerate() {
        let own: BTreeSet<u32> = of.iter().filter(|cell| acts.contains(cell)).copied().collect();
        let clash = parts[..k].iter().find(|(_, _, other)| other.iter().any(|cell| own.contains(cell)));
        if let Some((_, first, other)) = clash {
            let cells = other.iter().filter(|cell| own.contains(cell)).count();
            let (first, second) = ((*first).clone(), (*name).clone());
            return Err(ControlError::OverlappingRegions { first, second, cells });
        }
        own.iter().for_each(|&cell| of_cell[cell as usize] = *r);
    }
    let bare = cells.iter().filter(|&&cell| of_cell[cell as usize] == u32::MAX).count();
    if bare > 0 {
        let parts: Vec<&str> = parts.iter().map(|(_, name, _)| name.as_str()).collect();
        let (region, parts) = (named.to_string(), parts.join(", "));
        return Err(ControlError::UndividedRegion { region, parts, cells: bare });
    }
    Ok(of_cell)
}
