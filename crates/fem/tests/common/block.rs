//! The free block: statically determinate supports under whatever load.

use super::homogeneous::Case;
use super::{Outcome, distorted, node_at, set_name, unit, with_node_sets};
use nastic_energy::EnergyTerm;
use nastic_fem::{Discretization, Solid, SolveOptions, State, Strategies};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// Converged to the last digits.
pub const STRICT: SolveOptions = SolveOptions {
    near: None,
    guess: None,
    solver: None,
    accuracy: 1e-13,
    max_newton: 60,
    budget: None,
    parallel: true,
    strategies: Strategies::ALL,
    cancel: None,
    watch: None,
};

/// The unit block of distorted cells, held at three corners (two, in the plane) so that it neither shifts nor turns
/// and is free otherwise: `F_21 = F_31 = F_32 = 0`.
pub struct Block {
    pub disc: Arc<Discretization>,
    corners: Vec<u32>,
}

impl Block {
    pub fn new(kind: CellKind) -> Outcome<Self> {
        let mesh = distorted(unit(kind, 2)?, 0.08)?;
        let axes: &[[f64; 3]] = &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][..kind.dim()];
        let corner = |&x: &[f64; 3]| node_at(&mesh, x).map(|n| n as u32).ok_or("no such corner");
        let corners: Vec<u32> = axes.iter().map(corner).collect::<Result<_, _>>()?;
        let disc = Discretization::new(Arc::new(with_node_sets(&mesh, &corners)?))?;
        Ok(Block { disc, corners })
    }

    pub fn solid(&self, case: &Case) -> Outcome<Solid> {
        let mut solid = Solid::on(self.disc.clone()).material("body", case.law.clone())?;
        for (free, &corner) in self.corners.iter().enumerate() {
            let held = [0, 1, 2].map(|c| (c >= free && c < self.disc.dim()).then_some(0.0));
            solid = solid.displace(set_name(corner), held)?;
        }
        Ok(solid)
    }

    pub fn driven(&self, case: &Case, law: impl EnergyTerm + 'static, m: f64) -> Outcome<(Solid, State)> {
        let solid = self.solid(case)?.actuate("body", "m", law)?;
        let mut controls = solid.controls();
        controls.values_mut(0).fill(m);
        let state = solid.solve(&controls, &STRICT)?;
        Ok((solid, state))
    }

    /// Dead tractions on the sides `axis+`, opposite ones on `axis-`.
    pub fn pulled(&self, case: &Case, tractions: &[(&str, Vec3)]) -> Outcome<(Solid, State)> {
        let mut solid = self.solid(case)?;
        for (axis, traction) in tractions {
            solid = solid.traction(format!("{axis}+"), *traction)?.traction(format!("{axis}-"), -traction)?;
        }
        let state = solid.solve(&solid.controls(), &STRICT)?;
        Ok((solid, state))
    }
}
