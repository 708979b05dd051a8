//! How fast this machine solves by multigrid.

use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Solid, SolveOptions, Solver, SolverFactory, Workspace, available_memory};
use nastic_mesh::{CellKind, box_mesh, rectangle};
use nastic_tensor::Vec3;
use std::error::Error;
use std::time::Instant;

/// Intervals between nodes across the box: 98,553 unknowns in space, whose levels do not fit into caches, as those of large bodies do not.
const ACROSS: usize = 18;
/// The same of a rectangle: 48,010 unknowns.
const ACROSS_PLANE: usize = 68;
/// Memory that the box takes, with a margin.
const BOX: usize = 1 << 30;
/// A tension that bends nothing and strains the material by a hundredth.
const TENSION: f64 = -3e3;

/// What was measured.
#[derive(Debug, Clone, Copy)]
pub struct MultigridPace {
    /// Of a Newton iteration per unknown: its tangent, its levels where they are made anew, cycles and energies.
    pub seconds_per_unknown: f64,
    /// Of the box.
    pub unknowns: usize,
}

impl MultigridPace {
    /// That of a body, by the cells of its first block.
    ///
    /// # Errors
    /// Why there is none.
    pub fn of_body(solid: &Solid) -> Result<Self, String> {
        let available = available_memory().map_err(|error| error.to_string())?.unwrap_or(usize::MAX);
        let kind = solid.mesh().blocks().first().map(|block| block.kind).filter(|_| available > BOX);
        let kind = kind.ok_or("the memory does not suffice for a box to measure by")?;
        Self::measured(kind).map_err(|error| error.to_string())
    }

    /// From one solve of a box of a compressible material with cells of a kind, on the threads at hand.
    ///
    /// # Errors
    /// Why there is none.
    fn measured(kind: CellKind) -> Result<Self, Box<dyn Error>> {
        let solid = Self::body(kind)?;
        let mut controls = solid.controls();
        controls.values_mut(0).fill(TENSION);
        let multigrid: &dyn SolverFactory = Solver::MULTIGRID;
        let how = SolveOptions { solver: Some(multigrid), ..SolveOptions::default() };
        let began = Instant::now();
        let state = solid.solve_with(&controls, &how, &mut Workspace::default())?;
        let unknowns = solid.discretization().dofs();
        let seconds_per_unknown = began.elapsed().as_secs_f64() / (state.report.newton.max(1) * unknowns) as f64;
        Ok(MultigridPace { seconds_per_unknown, unknowns })
    }

    fn body(kind: CellKind) -> Result<Solid, Box<dyn Error>> {
        let mesh = match kind.dim() {
            3 => {
                let n = ACROSS / kind.order();
                box_mesh([1.0, 0.2, 0.2], [5 * n, n, n], kind)
            }
            _ => {
                let n = ACROSS_PLANE / kind.order();
                rectangle([1.0, 0.2], [5 * n, n], kind)
            }
        };
        let solid = Solid::new(mesh?)?.material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?;
        Ok(solid.actuate("body", "tension", FiberTension::along(Vec3::x())?)?.clamp("x-")?)
    }
}
