//! Twelve families of seeded random problems.

mod bodies;
mod drag;
mod drop;
mod grip;
mod parts;
mod press;
mod swing;

use crate::common::{between, pick};
use crate::judge::law::Law;
use crate::problem::{Facts, Failure, Problem, Region};
use nastic::energy::FormulaLaw;
use nastic::energy::formula::{Expression, Invariant, Step};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::collections::BTreeMap;

/// A family and what makes the problem of a seed.
pub struct Family {
    pub name: &'static str,
    pub make: fn(&mut Random) -> Result<Problem, Failure>,
}

/// All of them.
pub const FAMILIES: [Family; 12] = [
    Family { name: "press", make: |random| press::pushed(random, false) },
    Family { name: "drive", make: |random| press::pushed(random, true) },
    Family { name: "bodies", make: bodies::pushed },
    Family { name: "self", make: bodies::closing },
    Family { name: "let_down", make: drop::let_down },
    Family { name: "drop", make: drop::dropped },
    Family { name: "slide", make: drop::sliding },
    Family { name: "grip", make: grip::gripped },
    Family { name: "collide", make: bodies::colliding },
    Family { name: "drag", make: drag::dragged },
    Family { name: "swing", make: swing::swinging },
    Family { name: "multigrid", make: press::by_multigrid },
];

/// What a body is made of.
pub struct Stuff {
    pub law: Law,
    pub young: f64,
    pub mean_dilatation: bool,
    pub about: String,
}

/// Kinds with one pressure for each cell.
const WITH_MEAN: [CellKind; 4] = [CellKind::Quad4, CellKind::Tri6, CellKind::Hex8, CellKind::Tet10];
/// Least, and most, Young's modulus (powers of ten).
const MODULI: [f64; 2] = [4.0, 6.0];

impl Stuff {
    /// One in six a formula law, one in six nearly incompressible where cells take that.
    pub fn of(random: &mut Random, kind: CellKind) -> Self {
        let young = 10f64.powf(between(random, MODULI[0], MODULI[1]));
        let choice = random.unit();
        let stiff = choice < 1.0 / 6.0 && WITH_MEAN.contains(&kind);
        let poisson = if stiff { 0.5 - 10f64.powf(between(random, -3.3, -2.0)) } else { between(random, 0.1, 0.45) };
        let (mu, lambda) = (young / 2.0 / (1.0 + poisson), young * poisson / (1.0 + poisson) / (1.0 - 2.0 * poisson));
        let law = if choice > 5.0 / 6.0 {
            let share = between(random, 0.2, 0.8);
            let (a, b) = (share * mu / 2.0, (1.0 - share) * mu / 2.0);
            // of the same moduli at small strains
            Law::Mooney { a, b, c: lambda / 2.0 + a + 2.0 * b - mu / 2.0 }
        } else {
            Law::NeoHooke { mu, lambda }
        };
        let formula = if matches!(law, Law::Mooney { .. }) { ", a formula law" } else { "" };
        let mean = if stiff { ", mean dilatation" } else { "" };
        let about = format!("{}, E = {young:.1e}, nu = {poisson:.4}{mean}{formula}", kind.name());
        Stuff { law, young, mean_dilatation: stiff, about }
    }

    /// With the material of a region.
    pub fn on(&self, solid: Solid, region: &str) -> Result<Solid, Failure> {
        let solid = match self.law {
            Law::NeoHooke { mu, lambda } => solid.material(region, NeoHooke::new(mu, lambda)?)?,
            Law::Mooney { a, b, c } => solid.material(region, formula(a, b, c)?)?,
        };
        Ok(if self.mean_dilatation { solid.formulation(region, Formulation::MeanDilatation)? } else { solid })
    }

    pub fn region(&self, name: &str, density: f64) -> Region {
        let (law, mean_dilatation) = (self.law, self.mean_dilatation);
        Region { name: name.to_owned(), law, density, mean_dilatation, rigid: false }
    }

    pub fn facts(&self, density: f64) -> Facts {
        Facts { regions: vec![self.region("body", density)], ..Facts::default() }
    }

    /// A density for which a body of a height yields by a share of it under its weight.
    pub fn density(&self, share: f64, height: f64, g: f64) -> f64 {
        share * self.young / (g * height)
    }
}

/// `a (I1 - 3) + b (I2 - 3) + c (J - 1)^2 - 2 (a + 2 b) ln J` as a formula of the program.
fn formula(a: f64, b: f64, c: f64) -> Result<FormulaLaw, Failure> {
    let (named, number) = (|name: &'static str| Step::Parameter(name.into()), Step::Number);
    let of = Step::Invariant;
    let mut steps = vec![named("a"), of(Invariant::First), number(3.0), Step::Subtract, Step::Multiply];
    steps.extend([named("b"), of(Invariant::Second), number(3.0), Step::Subtract, Step::Multiply, Step::Add]);
    let less_one = [of(Invariant::Jacobian), number(1.0), Step::Subtract, number(2.0), Step::Power];
    steps.push(named("c"));
    steps.extend(less_one);
    steps.extend([Step::Multiply, Step::Add, named("d"), of(Invariant::Jacobian), Step::Log, Step::Multiply]);
    steps.push(Step::Subtract);
    let text = "a*(I1 - 3) + b*(I2 - 3) + c*(J - 1)^2 - d*log(J)";
    let values = [("a", a), ("b", b), ("c", c), ("d", 2.0 * (a + 2.0 * b))];
    let parameters: BTreeMap<String, _> =
        values.into_iter().map(|(name, value)| (name.to_owned(), value.into())).collect();
    Ok(FormulaLaw::new(&Expression::new(text, steps), &parameters, None)?)
}

/// Kinds of cells that problems take; simplices are not rarer than they are in meshes of users.
pub const PLANE: [CellKind; 4] = [CellKind::Quad4, CellKind::Quad8, CellKind::Quad9, CellKind::Tri6];
pub const SPACE: [CellKind; 5] = [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10];

/// One of them: in a plane as often as in space.
pub fn kind(random: &mut Random) -> CellKind {
    if random.unit() < 0.5 { pick(random, &PLANE) } else { pick(random, &SPACE) }
}

/// Names of the sides of a block, down and up.
pub fn sides(kind: CellKind) -> [&'static str; 2] {
    if kind.dim() == 2 { ["y-", "y+"] } else { ["z-", "z+"] }
}

/// A place by how far across, deep and up it is.
pub fn place(kind: CellKind, across: f64, deep: f64, up: f64) -> Vec3 {
    if kind.dim() == 2 { Vec3::new(across, up, 0.0) } else { Vec3::new(across, deep, up) }
}

/// A block with cells across, deep and up.
pub fn block(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Result<Mesh, Failure> {
    Ok(match kind.dim() {
        2 => rectangle([size[0], size[2]], [cells[0], cells[2]], kind)?,
        _ => box_mesh(size, cells, kind)?,
    })
}

/// Cells in as many pieces as second-order kinds need fewer.
pub fn cells(kind: CellKind, [across, deep, up]: [usize; 3]) -> [usize; 3] {
    let fewer = |n: usize| if kind.order() == 2 { n.div_ceil(2) } else { n };
    [fewer(across), fewer(deep), fewer(up)]
}

/// Controls with values from the first slot of a block on.
pub fn set(controls: &mut nastic::fem::Controls, k: Option<usize>, values: &[f64]) {
    if let Some(k) = k {
        controls.values_mut(k)[..values.len()].copy_from_slice(values);
    }
}
