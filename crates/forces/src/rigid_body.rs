//! [`RigidBody`]: a region that moves as a rigid body.

mod held;
mod simplex;

use self::held::Held;
use self::simplex::{Affine, simplex};
use nalgebra::DMatrix;
use nastic_body::contribution::constrains::Constrains;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::tied::Tied;
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_body::rotation::vector;
use nastic_linear::SparseMatrix;
use nastic_mesh::{GroupNames, Mesh};
use nastic_numeric::DisjointSets;
use nastic_tensor::{Mat3, Vec3, polar_rotation};

/// The components of the constraints.
const PLANE: [(usize, usize); 3] = [(0, 0), (1, 1), (0, 1)];
const SPACE: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// A region that moves as a rigid body: an object that is grasped, an insert moulded into silicone.
///
/// ```text
/// u(X) = (N_m(X) u_m summed over the nodes m of a simplex in the region)        an affine motion, d (d + 1) unknowns in d dimensions
/// g_kl = V (F^T F - 1)_kl (half of it for k = l) = 0,   F = 1 + sum_m u_m (x) grad N_m        d (d + 1) / 2 constraints
/// ```
///
/// Left are the three or six unknowns of a rigid motion of any size. All other nodes of the region follow those of the simplex; its mass, and what acts
/// on its surface, act on these, so that momentum and moments are those of the region. The multipliers are the mean second Piola-Kirchhoff stress that
/// holds it rigid, with the opposite sign. Its law is without effect but for the stiffness that contacts take from it. In steps in time
/// the constraints hold at the end of each, so that nothing drifts.
///
/// Supports may hold components of its nodes at zero: planes of symmetry, hinges, a joint. The corners of the simplex are chosen among the nodes that they hold,
/// and constraints that they fulfil by themselves are left out.
///
/// Source: Lan et al., Affine Body Dynamics, ACM Trans. Graph. 41 (2022), section 3, for the affine unknowns, with constraints in the place of a stiff
/// potential; docs/model/equilibrium.md.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    name: String,
    region: GroupNames,
}

impl RigidBody {
    /// A region, or the union of several.
    pub fn new(name: &str, region: impl Into<GroupNames>) -> Self {
        RigidBody { name: name.to_owned(), region: region.into() }
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// An unknown region, one that is flat; supports that hold it at other values than zero, or otherwise than at corners of a simplex.
    pub fn on(&self, mesh: &Mesh, supports: &Supports) -> Result<Rigid, FemError> {
        let cells = mesh.cells_of(&self.region)?;
        let mut nodes: Vec<u32> = cells.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes.to_vec()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.is_empty() {
            let what = format!("the rigid body \"{}\" has no cells: name its region", self.name);
            return Err(FemError::Meaningless { what });
        }
        self.check_connected(mesh, &cells, &nodes)?;
        let place = |node: u32| Vec3::from(mesh.points()[node as usize]);
        let held = |node: u32| (0..mesh.dim()).filter(|&c| supports.holds(node, c)).count();
        let masters = simplex(&nodes, mesh.dim(), place, held);
        let corners: Vec<Vec3> = masters.iter().map(|&node| place(node)).collect();
        let shapes = Affine::of(&corners, mesh.dim()).ok_or_else(|| {
            let what =
                format!("the region of the rigid body \"{}\" is flat: it has no volume that could be rigid", self.name);
            FemError::Meaningless { what }
        })?;
        let volumes = mesh.volumes(mesh.points());
        let volume: f64 = cells.iter().map(|&cell| volumes[cell as usize]).sum();
        let moment = |cell: &u32| volumes[*cell as usize] * Vec3::from(mesh.cell_centre(*cell as usize));
        let centre = cells.iter().map(moment).sum::<Vec3>() / volume;
        let follow = |node: u32| (node, masters.iter().copied().zip(shapes.at(&place(node))).collect());
        let follows = nodes.iter().filter(|node| !masters.contains(node)).map(|&node| follow(node)).collect();
        let (held, implied) = Held::of(&masters, &corners, mesh.dim(), supports);
        let all: &[(usize, usize)] = if mesh.dim() == 2 { &PLANE } else { &SPACE };
        let rigid = Rigid {
            name: self.name.clone(),
            dim: mesh.dim(),
            components: all.to_vec(),
            held,
            centre: shapes.at(&centre),
            gradients: shapes.gradients,
            corners,
            tied: Tied { field: None, masters: masters.clone(), implied, follows },
            masters,
            volume,
        };
        rigid.without_fulfilled()
    }

    /// Refuses parts that share no node: they are bodies of their own.
    fn check_connected(&self, mesh: &Mesh, cells: &[u32], nodes: &[u32]) -> Result<(), FemError> {
        let mut sets = DisjointSets::new(mesh.points().len());
        for &cell in cells {
            let own = mesh.cell(cell as usize).nodes;
            own.iter().for_each(|&node| sets.union(own[0], node));
        }
        let mut parts: Vec<u32> = nodes.iter().map(|&node| sets.find(node)).collect();
        parts.sort_unstable();
        parts.dedup();
        if parts.len() <= 1 {
            return Ok(());
        }
        let what = format!(
            "the region of the rigid body \"{}\" has {} parts that share no node, as those with the nodes {} and {}: name each, it is a body of its own",
            self.name,
            parts.len(),
            parts[0],
            parts[1]
        );
        Err(FemError::Meaningless { what })
    }
}

/// The contribution of a [`RigidBody`].
#[derive(Debug)]
pub struct Rigid {
    name: String,
    dim: usize,
    /// The nodes of the simplex, and where they are at rest.
    masters: Vec<u32>,
    corners: Vec<Vec3>,
    /// grad N_m
    gradients: Vec<Vec3>,
    /// N_m at the centre of the volume.
    centre: Vec<f64>,
    volume: f64,
    tied: Tied,
    /// Rows and columns of the components of the constraints, as many as there are.
    components: Vec<(usize, usize)>,
    held: Held,
}

impl Rigid {
    /// The displacement of a node of the simplex in a vector of all.
    fn of_node(&self, u: &[f64], m: usize) -> Vec3 {
        let first = self.dim * self.masters[m] as usize;
        Vec3::from_fn(|i, _| if i < self.dim { u[first + i] } else { 0.0 })
    }

    /// `sum_m u_m (x) grad N_m`
    fn gradient(&self, u: &[f64]) -> Mat3 {
        (0..self.masters.len()).map(|m| self.of_node(u, m) * self.gradients[m].transpose()).sum()
    }

    fn f(&self, u: &[f64]) -> Mat3 {
        Mat3::identity() + self.gradient(u)
    }

    /// V P, P the symmetric matrix of one number for each constraint.
    fn symmetric(&self, of: impl Fn(usize) -> f64) -> Mat3 {
        let mut p = Mat3::zeros();
        for (k, &(i, j)) in self.components.iter().enumerate() {
            (p[(i, j)], p[(j, i)]) = (self.volume * of(k), self.volume * of(k));
        }
        p
    }

    /// Calls with the unknowns of the simplex and the entries of `H P grad N_m`.
    fn each(&self, h: &Mat3, p: &Mat3, mut call: impl FnMut(usize, f64)) {
        for (m, gradient) in self.gradients.iter().enumerate() {
            let force = h * (p * gradient);
            (0..self.dim).for_each(|i| call(self.dim * self.masters[m] as usize + i, force[i]));
        }
    }

    /// `g_kl = V sym(A^T B)_kl`, half of it on the diagonal when A = B = F.
    fn pairs(&self, a: &Mat3, b: &Mat3) -> Vec<f64> {
        let both = a.transpose() * b;
        let half = |(i, j): &(usize, usize)| if i == j { 0.5 } else { 1.0 };
        let of = |at: &(usize, usize)| self.volume * half(at) * 0.5 * (both[*at] + both[(at.1, at.0)]);
        self.components.iter().map(of).collect()
    }
}

impl Constrains for Rigid {
    fn count(&self) -> usize {
        self.components.len()
    }

    /// The rigid motion nearest to the affine one: its centre stays, F becomes its rotation.
    fn restored(&self, u: &[f64]) -> Option<Vec<(usize, f64)>> {
        if !self.held.is_empty() {
            return self.restored_beside_supports(u);
        }
        let turn = polar_rotation(&self.f(u))?;
        let weighted =
            |of: &dyn Fn(usize) -> Vec3| (0..self.masters.len()).map(|m| of(m) * self.centre[m]).sum::<Vec3>();
        let (rest, moved) = (weighted(&|m| self.corners[m]), weighted(&|m| self.of_node(u, m)));
        let nodes = self.masters.iter().zip(&self.corners);
        let place = |(node, corner): (&u32, &Vec3)| {
            let to = rest + moved + turn * (corner - rest) - corner;
            (0..self.dim).map(|i| (self.dim * *node as usize + i, to[i])).collect::<Vec<_>>()
        };
        Some(nodes.flat_map(place).collect())
    }

    /// Translations, and rotations about the middle of the simplex; with supports those that these leave free, and the held ones.
    fn local(&self, at: &Instant) -> Option<(Vec<u32>, DMatrix<f64>)> {
        let motions = self.motions(|m| self.of_node(at.u, m));
        Some((self.masters.clone(), self.held.let_go(&motions)))
    }
}

impl Rigid {
    /// Rigid motions at a displacement of the corners: changes of their unknowns, by columns.
    fn motions(&self, displacement: impl Fn(usize) -> Vec3) -> DMatrix<f64> {
        let places: Vec<Vec3> = (0..self.masters.len()).map(|m| self.corners[m] + displacement(m)).collect();
        let middle = places.iter().sum::<Vec3>() / places.len() as f64;
        let (dim, size) = (self.dim, places.iter().map(|x| (x - middle).norm()).fold(0.0, f64::max));
        let axes = if dim == 2 { vec![Vec3::z()] } else { vec![Vec3::x(), Vec3::y(), Vec3::z()] };
        let motion = |i: usize, j: usize| match j.checked_sub(dim) {
            None => f64::from(u8::from(i % dim == j)),
            Some(axis) => axes[axis].cross(&(places[i / dim] - middle))[i % dim] / size,
        };
        DMatrix::from_fn(dim * places.len(), dim + axes.len(), motion)
    }
}

impl Contribution for Rigid {
    fn name(&self) -> &str {
        &self.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        let mut masters = self.masters.clone();
        masters.sort_unstable();
        vec![masters]
    }

    fn tied(&self) -> Option<&Tied> {
        Some(&self.tied)
    }

    /// The motion of the centre of its volume, and its turn: a rotation vector.
    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let moved: Vec3 = (0..self.masters.len()).map(|m| self.of_node(at.u, m) * self.centre[m]).sum();
        let turned = polar_rotation(&self.f(at.u)).map_or_else(Vec3::zeros, |r| vector(&r));
        let mut found = vec![("translation_x", moved[0]), ("translation_y", moved[1])];
        if self.dim == 3 {
            found.extend([("translation_z", moved[2]), ("rotation_x", turned[0]), ("rotation_y", turned[1])]);
        }
        found.push(("rotation_z", turned[2]));
        found
    }

    fn constrains(&self) -> Option<&dyn Constrains> {
        Some(self)
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(RigidPoint { body: self, f: self.f(at.u) }))
    }
}

/// A [`RigidBody`] at one displacement.
struct RigidPoint<'a> {
    body: &'a Rigid,
    f: Mat3,
}

impl RigidPoint<'_> {
    /// V P of the multipliers.
    fn multipliers(&self, at: &Instant) -> Mat3 {
        self.body.symmetric(|k| at.multiplier(k))
    }

    /// What the multipliers in a vector of all unknowns are.
    fn behind(&self, at: &Instant, v: &[f64]) -> Mat3 {
        self.body.symmetric(|k| v[at.place(k)])
    }

    fn add_products(&self, h: &Mat3, p: &Mat3, factor: f64, out: &mut [f64]) {
        self.body.each(h, p, |dof, entry| out[dof] += factor * entry);
    }
}

impl ContributionPoint for RigidPoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (body, rest) = (self.body, Mat3::identity());
        let own = body.pairs(&self.f, &self.f).into_iter().zip(body.pairs(&rest, &rest));
        let scale = body.volume * (self.f.norm_squared() + 1.0);
        for (k, (now, rest)) in own.enumerate() {
            let p = at.multiplier(k);
            if demand.energy {
                sums.energy -= p * (now - rest);
                sums.energy_scale += p.abs() * scale;
            }
            if demand.force {
                sums.force[at.place(k)] -= now - rest;
                sums.force_scale[at.place(k)] += scale;
            }
        }
        if demand.force {
            body.each(&self.f, &self.multipliers(at), |dof, force| {
                sums.force[dof] -= force;
                sums.force_scale[dof] += force.abs();
            });
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let (body, p) = (self.body, self.multipliers(at));
        let (dim, n) = (body.dim, body.dim * body.masters.len());
        let mut element = vec![0.0; n * n];
        for (a, row) in body.gradients.iter().enumerate() {
            for (b, column) in body.gradients.iter().enumerate() {
                let entry = -row.dot(&(p * column));
                (0..dim).for_each(|i| element[n * (dim * a + i) + dim * b + i] = entry);
            }
        }
        Ok(tangent.add_pairs(&body.masters, &element)?)
    }

    fn add_border(&self, _: &Instant, columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        for (k, column) in columns.iter_mut().enumerate() {
            let unit = self.body.symmetric(|other| f64::from(u8::from(other == k)));
            self.add_products(&self.f, &unit, -1.0, column);
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let dv = self.body.gradient(v);
        self.add_products(&dv, &self.multipliers(at), -1.0, out);
        self.add_products(&self.f, &self.behind(at, v), -1.0, out);
        // g is quadratic: its change is twice the form with both
        let change = self.body.pairs(&self.f, &dv).into_iter().map(|half| 2.0 * half);
        change.enumerate().for_each(|(k, change)| out[at.place(k)] -= change);
        Ok(true)
    }

    /// It has no controls.
    fn vjp(&self, _: &Instant, _: &[f64], _: &mut Sensitivities) -> Result<(), Inadmissible> {
        Ok(())
    }

    /// With `lambda = (l, n)` and `du = (d, q)`: `-q g_uu l - n g_uu d` and, by the multipliers, `-l . g_uu d`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (l, d) = (self.body.gradient(lambda), self.body.gradient(along.u));
        self.add_products(&l, &self.behind(at, along.u), -1.0, &mut into.u);
        self.add_products(&d, &self.behind(at, lambda), -1.0, &mut into.u);
        let change = self.body.pairs(&l, &d).into_iter().map(|half| 2.0 * half);
        change.enumerate().for_each(|(k, change)| into.u[at.place(k)] -= change);
        Ok(())
    }
}
