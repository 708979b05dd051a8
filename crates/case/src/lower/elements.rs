//! Warnings about mesh and elements: locking, badly shaped cells, interfaces that are not connected.

use super::bending::Bending;
use super::context::Context;
use super::mesh;
use crate::warning::{CELL_SHAPE, LOCKING, UNMATCHED_INTERFACE};
use nastic_energy::{EnergyTerm, MaterialPoint};
use nastic_fem::{Formulation, Solid};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Case;
use nastic_mesh::{CellKind, Column, Domain, GroupNames};

/// Poisson's ratio from which fully integrated first-order quadrilaterals and hexahedra lock.
const NEARLY_INCOMPRESSIBLE: f64 = 0.4;
/// Poisson's ratio from which second-order simplices lose 1.6 to 1.8 times what hexahedra and quadrilaterals do
/// (docs/development/verification.md), rounding included.
const INCOMPRESSIBLE: f64 = 0.499 - 1e-9;
/// Poisson's ratio from which hexahedra and quadrilaterals of second order lose as much: a bar of 8 x 2 x 1 hex20 12 % at 0.4999, one of
/// 3 x 1 x 1 hex27 39 %.
const ALMOST_INCOMPRESSIBLE: f64 = 0.4995 - 1e-9;
/// First-order cells that are so many times too stiff or too soft in bending are reported.
const NOTABLE: f64 = 1.3;

/// Small-strain moduli of all materials of a cell together, in the case's units.
#[derive(Clone, Copy)]
pub(crate) struct Elastic {
    bulk: f64,
    shear: f64,
}

impl Elastic {
    /// Of a cell at a quadrature point; `None` where a law does not give its moduli.
    pub fn of(solid: &Solid, cell: usize, point: usize) -> Option<Self> {
        let mut sum = Self { bulk: 0.0, shear: 0.0 };
        for material in solid.body().materials_of(cell) {
            let moduli = material.moduli(MaterialPoint { cell, point })?;
            sum = Self { bulk: sum.bulk + moduli.bulk(), shear: sum.shear + moduli.mu_t };
        }
        (sum.shear > 0.0).then_some(sum)
    }

    /// The same where no law has fibres.
    pub fn isotropic(solid: &Solid, cell: usize, point: usize) -> Option<Self> {
        let has_fiber =
            |law: &dyn EnergyTerm| law.moduli(MaterialPoint { cell, point }).is_none_or(|own| own.fiber.is_some());
        Self::of(solid, cell, point).filter(|_| !solid.body().materials_of(cell).any(|law| has_fiber(law)))
    }

    /// K, in the case's units.
    pub fn bulk(self) -> f64 {
        self.bulk
    }

    /// mu, in the case's units.
    pub fn shear(self) -> f64 {
        self.shear
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
    let (columns, all) = (solid.mesh().columns(), Cells::of(solid));
    for material in case.materials.iter().filter(|material| !material.rigid) {
        let Ok(cells) = solid.mesh().cells_of(&material.region) else { continue };
        let (locking, others): (Vec<u32>, Vec<u32>) = cells.iter().partition(|&&cell| all.lock(cell));
        let found = [
            why_locking(&all, &material.region, &locking, context),
            wrong_in_bending(&all, &material.region, &others, &columns, context),
        ];
        for message in found.into_iter().flatten() {
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

/// Kinds and small-strain moduli of the cells.
struct Cells<'a> {
    solid: &'a Solid,
    /// First quadrature point and number of points.
    points: Vec<(usize, usize)>,
}

impl<'a> Cells<'a> {
    fn of(solid: &'a Solid) -> Self {
        Self { solid, points: solid.discretization().points_of_cells() }
    }

    fn kind(&self, cell: u32) -> CellKind {
        self.solid.mesh().cell(cell as usize).kind
    }

    fn formulation(&self, cell: u32) -> Formulation {
        self.solid.body().formulation_of(cell as usize)
    }

    /// At the first quadrature point.
    fn elastic(&self, cell: u32) -> Option<Elastic> {
        Elastic::of(self.solid, cell as usize, self.points[cell as usize].0)
    }

    /// Whether a cell is of a kind that is too stiff for its material, whatever its shape.
    fn lock(&self, cell: u32) -> bool {
        let poisson = || self.elastic(cell).map(Elastic::poisson);
        if self.formulation(cell) != Formulation::Standard {
            return false;
        }
        match self.kind(cell) {
            CellKind::Tet4 | CellKind::Tri3 => true,
            CellKind::Hex8 | CellKind::Quad4 => poisson().is_some_and(|nu| nu > NEARLY_INCOMPRESSIBLE),
            CellKind::Tet10 | CellKind::Tri6 => poisson().is_some_and(|nu| nu >= INCOMPRESSIBLE),
            CellKind::Quad8 | CellKind::Quad9 | CellKind::Hex20 | CellKind::Hex27 => {
                poisson().is_some_and(|nu| nu >= ALMOST_INCOMPRESSIBLE)
            }
            CellKind::Line2 | CellKind::Line3 => false,
        }
    }
}

/// What is wrong with cells that lock, by the one of the largest Poisson's ratio.
fn why_locking(all: &Cells, region: &GroupNames, locking: &[u32], context: &Context<'_>) -> Option<String> {
    let nu = |cell| all.elastic(cell).map_or(f64::NEG_INFINITY, Elastic::poisson);
    let worst = locking.iter().copied().max_by(|&a, &b| nu(a).total_cmp(&nu(b)))?;
    let kind = all.kind(worst);
    let name = kind.name();
    let at = match all.elastic(worst) {
        Some(elastic) => {
            let unit = context.units.label(Dimension::PRESSURE);
            let (nu, bulk, shear) = (elastic.poisson(), elastic.bulk, elastic.shear);
            format!(" at Poisson's ratio {nu:.4} (bulk modulus {bulk:.3e} {unit}, shear modulus {shear:.3e} {unit})")
        }
        None => String::new(),
    };
    let why = if kind.order() > 1 && kind.domain() != Domain::Simplex {
        "fully integrated, second-order hexahedra and quadrilaterals bend too little, by a tenth with two cells over the thickness, by a \
         third with one"
    } else if kind.order() > 1 {
        "second-order simplices bend some per cent too little, 1.6 to 1.8 times as much as hexahedra or quadrilaterals of \
         that size"
    } else if kind.domain() == Domain::Simplex {
        "first-order simplices have constant strain: bent, they move too little, nearly incompressible tenfold and more"
    } else {
        "first-order elements cannot bend at nearly constant volume"
    };
    let cure = match Formulation::nearly_incompressible(kind) {
        Some(formulation) => format!("; take \"formulation\": \"{formulation}\" in the material"),
        None => String::new(),
    };
    Some(format!("{} {name} cells of \"{region}\"{at}: {why}{cure}", locking.len()))
}

/// First-order hexahedra and quadrilaterals that are too long for the thickness of a slender body, or, with the mean dilatation, too thick.
fn wrong_in_bending(
    all: &Cells,
    region: &GroupNames,
    cells: &[u32],
    columns: &[Vec<Column>],
    context: &Context<'_>,
) -> Option<String> {
    let bent = |&cell: &u32| {
        let of_order_one = matches!(all.kind(cell), CellKind::Hex8 | CellKind::Quad4);
        let elastic = all.elastic(cell).filter(|_| of_order_one)?;
        let bending = Bending::worst(&columns[cell as usize], elastic, all.formulation(cell))?;
        (bending.error() > NOTABLE).then_some((cell, bending))
    };
    let wrong: Vec<(u32, Bending)> = cells.iter().filter_map(bent).collect();
    let (cell, worst) = wrong.iter().max_by(|a, b| a.1.error().total_cmp(&b.1.error()))?;
    let Bending { factor, length, thickness, layers, by_shear } = worst;
    let (name, unit) = (all.kind(*cell).name(), context.units.length().symbol);
    let cure = match by_shear {
        true => "shorter cells help most",
        false => "more cells over the thickness help most",
    };
    let over = if *layers == 1 { "1 cell".to_owned() } else { format!("{layers} cells") };
    let (wrongly, factor) = if *factor < 1.0 { ("soft", 1.0 / factor) } else { ("stiff", *factor) };
    Some(format!(
        "{} {name} cells of \"{region}\" are too {wrongly} in bending, cell {cell} about {factor:.3} times ({length:.3e} {unit} long, the \
         body {thickness:.3e} {unit} thick, {over} over it); {cure}",
        wrong.len()
    ))
}
