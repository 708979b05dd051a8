//! [`VaryingLoad`]: a dead load that changes in time, or with the design of a body.

use crate::fill::Fill;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, OverCells, Sums};
use nastic_body::controls::{ControlPoint, Controls, check_finite};
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_mesh::{GroupNames, Mesh};
use nastic_tensor::Vec3;

/// Forces per reference area of a surface, or per reference volume of a region, with a value t(X_q) at every point of a rule, which a motion gives
/// anew at every instant: the potential
///
/// ```text
/// - l sum_q w_q sum_k m_k(X_q) d_k . u(X_q)
/// ```
///
/// with the share l of the load, the numbers m_k and the vectors d_k along which they act: the components of t and the axes, or a [`Fill`] and the weight of the full body. It keeps its direction, as all dead loads. Its values are data of the problem as those of a constant one are, not work of
/// actuations. In plane strain per unit of thickness.
///
/// Units: t in Pa on surfaces, in N/m^3 on regions; an acceleration in m/s^2 of [`weight`](Self::weight).
#[derive(Debug)]
pub struct VaryingLoad {
    name: String,
    dim: usize,
    slots: Vec<Slot>,
    /// What m_1 is made of, where the slots are not m themselves.
    fill: Option<Fill>,
    /// d_k.
    along: Vec<[f64; 3]>,
    points: Vec<ControlPoint>,
    /// Node, point and shape function of every pair.
    pairs: Vec<(u32, u32, f64)>,
    /// Where the slots are a field over the body: regions, their cells.
    over: Option<(GroupNames, Vec<u32>)>,
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl VaryingLoad {
    /// A load at the points of a rule on a surface or a region.
    pub fn new(name: impl Into<String>, mesh: &Mesh, sampling: &QuadraturePoints, per_area: bool) -> Self {
        let (group, unit) = if per_area { ("traction", "Pa") } else { ("body_force", "N/m^3") };
        // A number of the body to those who ramp and to those who count the work of actuations: it is scaled with the load by itself.
        let of = |k| Slot { component: Some(k), ..Slot::design(group, unit, 0.0) };
        let positions = sampling.positions(mesh, None).into_iter().zip(sampling.weights());
        let mut pairs = Vec::new();
        sampling.for_each_pair(|point, node, shape| pairs.push((node as u32, point as u32, shape)));
        VaryingLoad {
            name: name.into(),
            dim: mesh.dim(),
            slots: (0..3).map(of).collect(),
            fill: None,
            points: positions.map(|(position, weight)| ControlPoint { position, weight: *weight }).collect(),
            along: AXES.to_vec(),
            pairs,
            over: None,
        }
    }

    /// A force per volume of regions (N/m^3 of the full body) times the fill at every quadrature point of the body, 1 at rest, and det G where the shape of the body, which
    /// is known already, changes: weight that follows a density and the shape.
    ///
    /// # Errors
    /// An unknown region; a force that is not finite, or across a body in plane strain.
    pub fn filled(
        name: &str,
        body: &BodyEnergy,
        regions: impl Into<GroupNames>,
        force: Vec3,
    ) -> Result<Self, FemError> {
        check_finite(name, force.as_slice())?;
        let (regions, disc, fill) = (regions.into(), body.discretization(), Fill::of(body));
        let mesh = disc.mesh();
        if mesh.dim() == 2 && force.z != 0.0 {
            return Err(FemError::Meaningless { what: format!("{name} has a z component on a plane-strain body") });
        }
        let cells = mesh.cells_of(&regions)?;
        let of_point = disc.points().cells();
        let mut pairs = Vec::new();
        disc.points().for_each_pair(|point, node, shape| {
            if cells.binary_search(&of_point[point]).is_ok() {
                pairs.push((node as u32, point as u32, shape));
            }
        });
        let weighted = |weight: &f64| ControlPoint { position: [0.0; 3], weight: *weight };
        Ok(VaryingLoad {
            name: name.to_owned(),
            dim: mesh.dim(),
            slots: fill.slots().to_vec(),
            fill: Some(fill),
            along: vec![force.into()],
            points: disc.points().weights().iter().map(weighted).collect(),
            pairs,
            over: Some((regions, cells)),
        })
    }

    /// The weight of a region of one density (kg/m^3) under an acceleration g(t), the same everywhere: `- s rho int g(t) . u dX`, with one point for g.
    pub fn weight(name: impl Into<String>, mesh: &Mesh, sampling: &QuadraturePoints, density: f64) -> Self {
        let of = |k| Slot { component: Some(k), ..Slot::design("gravity", "m/s^2", 0.0) };
        let volume: f64 = sampling.weights().iter().sum();
        let mut middle = [0.0; 3];
        for (x, weight) in sampling.positions(mesh, None).into_iter().zip(sampling.weights()) {
            (0..3).for_each(|i| middle[i] += weight / volume * x[i]);
        }
        let mut shares = vec![0.0; mesh.points().len()];
        sampling.spread(sampling.weights(), 1, &mut shares);
        let shares = shares.into_iter().enumerate().filter(|(_, share)| *share != 0.0);
        VaryingLoad {
            name: name.into(),
            dim: mesh.dim(),
            slots: (0..3).map(of).collect(),
            fill: None,
            points: vec![ControlPoint { position: middle, weight: volume }],
            along: AXES.to_vec(),
            pairs: shares.map(|(node, share)| (node as u32, 0, density * share / volume)).collect(),
            over: None,
        }
    }

    /// Calls with every unknown, the point and the number m of a pair, and `w_q N_a(X_q)` times the component of its vector.
    fn each(&self, mut call: impl FnMut(usize, (usize, usize), f64)) {
        for &(node, point, shape) in &self.pairs {
            let point = point as usize;
            let factor = self.points[point].weight * shape;
            for (k, along) in self.along.iter().enumerate() {
                let acting = along.iter().enumerate().take(self.dim).filter(|(_, along)| **along != 0.0);
                acting.for_each(|(i, along)| call(self.dim * node as usize + i, (point, k), factor * along));
            }
        }
    }

    /// By point and vector the numbers m, or their changes along `v`.
    fn numbers(&self, at: &Instant, v: Option<&Controls>) -> Vec<f64> {
        let own = v.unwrap_or(at.controls);
        let Some(fill) = &self.fill else { return own.values(at.block).to_vec() };
        let of_point = |point: usize| {
            let (m, change) = (|k| at.control_at(point, k), |k| at.slot_at(own, point, k));
            v.map_or_else(|| fill.value(point, &m), |_| fill.change(point, &m, &change))
        };
        (0..self.points.len()).map(of_point).collect()
    }

    /// `-l w_q d_1 . lambda(X_q)` by point.
    fn by_point(&self, at: &Instant, lambda: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.points.len()];
        self.each(|dof, (point, _), factor| out[point] += -at.load * factor * lambda[dof]);
        out
    }
}

impl Contribution for VaryingLoad {
    fn name(&self) -> &str {
        &self.name
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn shared_slots(&self) -> Option<(&str, usize)> {
        self.fill.as_ref().and_then(Fill::shared_slots)
    }

    fn control_points(&self) -> &[ControlPoint] {
        if self.over.is_some() { &[] } else { &self.points }
    }

    fn over_cells(&self) -> Option<OverCells<'_>> {
        self.over.as_ref().map(|(regions, cells)| OverCells { regions, cells, points: self.points.len() })
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn energy_role(&self) -> EnergyRole {
        EnergyRole::Load
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for VaryingLoad {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let numbers = self.numbers(at, None);
        self.each(|dof, (point, k), factor| {
            let force = at.load * factor * numbers[point * self.along.len() + k];
            if demand.energy {
                sums.energy -= force * at.u[dof];
                sums.energy_scale += (force * at.u[dof]).abs();
            }
            if demand.force {
                sums.force[dof] -= force;
                sums.force_scale[dof] += force.abs();
            }
        });
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let Some(fill) = self.fill.as_ref().filter(|fill| fill.follows_shape()) else {
            self.each(|dof, (point, k), factor| into.add_control_at(at, point, k, -at.load * factor * lambda[dof]));
            return Ok(());
        };
        for (point, by) in self.by_point(at, lambda).into_iter().enumerate().filter(|(_, by)| *by != 0.0) {
            let m = |k| at.control_at(point, k);
            fill.each_derivative(point, &m, |slot, own| into.add_control_at(at, point, slot, own * by));
        }
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let changes = self.numbers(at, Some(v));
        self.each(|dof, (point, k), factor| out[dof] -= at.load * factor * changes[point * self.along.len() + k]);
        Ok(())
    }

    /// The residual does not depend on the displacement, nor otherwise than linearly on the slots but by a change of shape.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let Some(fill) = self.fill.as_ref().filter(|fill| fill.follows_shape()) else { return Ok(()) };
        for (point, by) in self.by_point(at, lambda).into_iter().enumerate().filter(|(_, by)| *by != 0.0) {
            let (m, v) = (|k| at.control_at(point, k), |k| at.slot_at(along.controls, point, k));
            fill.each_second(point, &m, &v, |slot, own| into.add_control_at(at, point, slot, own * by));
        }
        Ok(())
    }
}
