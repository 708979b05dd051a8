//! Warnings about mesh and elements: locking, badly shaped cells, interfaces that are not connected.

use super::context::Context;
use super::mesh;
use crate::quantity::Dimension;
use crate::schema::Case;
use crate::warning::{CELL_SHAPE, LOCKING, UNMATCHED_INTERFACE};
use nastic_energy::Place;
use nastic_fem::Solid;
use nastic_mesh::CellKind;

/// Poisson's ratio from which fully integrated first-order quadrilaterals and hexahedra lock.
const NEARLY_INCOMPRESSIBLE: f64 = 0.4;

/// Small-strain moduli of all materials of a cell together, in the case's units.
#[derive(Clone, Copy)]
pub(super) struct Elastic {
    bulk: f64,
    shear: f64,
}

impl Elastic {
    /// Of a cell at a quadrature point; `None` where a law does not tell its moduli.
    pub fn of(solid: &Solid, cell: usize, point: usize) -> Option<Self> {
        let mut sum = Self { bulk: 0.0, shear: 0.0 };
        for material in solid.body().materials_of(cell) {
            let moduli = material.moduli(Place { cell, point })?;
            sum = Self { bulk: sum.bulk + moduli.bulk(), shear: sum.shear + moduli.mu_t };
        }
        (sum.shear > 0.0).then_some(sum)
    }

    /// nu = (3 K - 2 mu) / (2 (3 K + mu))
    pub fn poisson(self) -> f64 {
        (3.0 * self.bulk - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk + self.shear))
    }

    /// E = 9 K mu / (3 K + mu)
    pub fn young(self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }
}

pub(super) fn check(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    for material in &case.materials {
        if let Ok(cells) = solid.mesh().region(&material.region)
            && let Some(message) = locking(solid, &material.region, cells, context)
        {
            context.warn(&LOCKING, &material.at.key("region"), message);
        }
    }
    let at = mesh::at(case);
    for warning in solid.mesh().quality().warnings() {
        context.warn(&CELL_SHAPE, &at, warning);
    }
    let twins = solid.mesh().coincident_nodes();
    if twins > 0 {
        let message = format!("{twins} nodes lie on others: the body comes apart there");
        context.warn(&UNMATCHED_INTERFACE, &at, message);
    }
}

/// What is wrong with the elements of a region for its material.
fn locking(solid: &Solid, region: &str, cells: &[u32], context: &Context<'_>) -> Option<String> {
    let points = solid.discretization().points_of_cells();
    let elastic = |cell: u32| Elastic::of(solid, cell as usize, points[cell as usize].0);
    let poisson = |cell: u32| elastic(cell).map(Elastic::poisson);
    let kind = |cell: u32| solid.mesh().cell(cell as usize).kind;
    let locks = |&cell: &u32| match kind(cell) {
        CellKind::Tet4 | CellKind::Tri3 => true,
        CellKind::Hex8 | CellKind::Quad4 => poisson(cell).is_some_and(|nu| nu > NEARLY_INCOMPRESSIBLE),
        _ => false,
    };
    let locking: Vec<u32> = cells.iter().copied().filter(locks).collect();
    let worst = locking.iter().copied().max_by(|&a, &b| {
        let nu = |cell| poisson(cell).unwrap_or(f64::NEG_INFINITY);
        nu(a).total_cmp(&nu(b))
    })?;
    let name = kind(worst).name();
    let at = match elastic(worst) {
        Some(elastic) => {
            let unit = context.units.label(Dimension::PRESSURE);
            let (nu, bulk, shear) = (elastic.poisson(), elastic.bulk, elastic.shear);
            format!(" at Poisson's ratio {nu:.4} (bulk modulus {bulk:.3e} {unit}, shear modulus {shear:.3e} {unit})")
        }
        None => String::new(),
    };
    let why = if kind(worst).is_simplex() {
        "first-order simplices have constant strain: bent, they move too little, nearly incompressible tenfold and more"
    } else {
        "first-order elements cannot bend at nearly constant volume"
    };
    Some(format!("{} {name} cells of \"{region}\"{at}: {why}", locking.len()))
}
