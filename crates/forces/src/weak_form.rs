//! [`WeakForm`]: equations of nodal fields by what stands under the integral; [`CellSum`]: the contribution that follows.

use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::discretization::Discretization;
use nastic_body::discretization::quadrature_points::CellGroup;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::{Field, SparseMatrix, Symmetry};
use nastic_tensor::HyperDual;
use std::sync::Arc;

/// `r_ac = int (s_c N_a + q_c . grad N_a) dX` over all cells of a body, for every component c: those of the displacement first, then those of the
/// [`fields`](Self::fields). The sources s and fluxes q are functions of the values and gradients of all components, and of controls.
///
/// They are written once, in numbers that carry their derivatives: tangent, products, derivatives by controls and second derivatives follow.
///
/// ```
/// use nastic_fem::{CellSum, Field, FormDual, FormPoint, Solid, SolveOptions, WeakForm};
/// use nastic_energy::{NeoHooke, Slot};
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_tensor::HyperDual;
///
/// /// `-div grad phi = f`, f a control, with a body force `40 phi` along x.
/// #[derive(Debug)]
/// struct Heated {
///     fields: [Field; 1],
/// }
///
/// const SOURCE: [Slot; 1] = [Slot::scalar("source", "1")];
///
/// impl WeakForm for Heated {
///     fn name(&self) -> &str {
///         "heated"
///     }
///     fn fields(&self) -> &[Field] {
///         &self.fields
///     }
///     fn slots(&self) -> &[Slot] {
///         &SOURCE
///     }
///     fn dual(&self, at: &FormPoint, out: &mut FormDual) {
///         out.sources[0] = at.values[3] * HyperDual::constant(-40.0);
///         out.sources[3] = -at.controls[0];
///         out.fluxes[3] = at.gradients[3];
///     }
/// }
///
/// let body = Solid::new(box_mesh([1.0, 0.3, 0.3], [4, 1, 1], CellKind::Hex20)?)?
///     .material("body", NeoHooke::new(1e2, 2e2)?)?
///     .clamp("x-")?;
/// let heated = CellSum::new(Heated { fields: [Field::nodal("phi", 1)] }, body.discretization());
/// let body = body.contribution(heated)?.hold("phi", 0, "x-", 0.0)?.hold("phi", 0, "x+", 0.0)?;
/// let mut controls = body.controls();
/// controls.set(0, 0, &[0.7])?;
/// let state = body.solve(&controls, &SolveOptions::default())?;
/// // phi = f x (1 - x) / 2
/// let phi = body.model().field("phi", &state.u)?;
/// let middle = body.mesh().points().iter().position(|x| x[0] == 0.5).ok_or("no node in the middle")?;
/// assert!((phi[middle] - 0.7 / 8.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait WeakForm: std::fmt::Debug + Send + Sync {
    /// What it is called in messages and results.
    fn name(&self) -> &str;

    /// Its nodal fields beyond the displacement.
    fn fields(&self) -> &[Field] {
        &[]
    }

    /// Its controls, one number each for the whole body.
    fn slots(&self) -> &[Slot] {
        &[]
    }

    /// Whether `ds_c/d(..)`, `dq_c/d(..)` are symmetric.
    fn symmetry(&self) -> Symmetry {
        Symmetry::General
    }

    /// Whether s and q are the derivatives of [`density`](Self::density).
    fn has_potential(&self) -> bool {
        false
    }

    /// The energy density of which s and q are the derivatives, where there is one.
    fn density(&self, _at: &FormPoint) -> f64 {
        0.0
    }

    /// Sets s and q at a point; they are zero before.
    fn dual(&self, at: &FormPoint, out: &mut FormDual);
}

/// What a [`WeakForm`] knows of a quadrature point. The numbers carry derivatives.
#[derive(Debug, Clone)]
pub struct FormPoint {
    /// The cell of the mesh.
    pub cell: usize,
    /// Quadrature point of the body.
    pub point: usize,
    /// By component.
    pub values: Vec<HyperDual>,
    /// By component and direction of the reference body; zero across a body in the plane.
    pub gradients: Vec<[HyperDual; 3]>,
    /// By slot.
    pub controls: Vec<HyperDual>,
}

/// The sources s and fluxes q of a [`WeakForm`] at a point, by component.
#[derive(Debug, Clone)]
pub struct FormDual {
    /// s
    pub sources: Vec<HyperDual>,
    /// q
    pub fluxes: Vec<[HyperDual; 3]>,
}

const ZERO: HyperDual = HyperDual([0.0; 4]);

/// The sum of a [`WeakForm`] over the cells of a body, on one thread: for fields beside the displacement, not for its own laws.
#[derive(Debug)]
pub struct CellSum<F> {
    form: F,
    disc: Arc<Discretization>,
    components: usize,
}

/// A cell at one of its quadrature points: shapes and their gradients by node.
struct CellPoint<'a> {
    cell: usize,
    point: usize,
    weight: f64,
    nodes: &'a [u32],
    shapes: &'a [f64],
    gradients: Vec<[f64; 3]>,
}

impl CellPoint<'_> {
    /// Value and gradient of a component of a flat vector.
    fn interpolated(&self, v: &[f64], components: usize, c: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for ((&node, shape), slope) in self.nodes.iter().zip(self.shapes).zip(&self.gradients) {
            let value = v[components * node as usize + c];
            sum[0] += shape * value;
            (0..3).for_each(|j| sum[1 + j] += slope[j] * value);
        }
        sum
    }

    /// `N_a` and `grad N_a`.
    fn of_node(&self, a: usize) -> [f64; 4] {
        let [x, y, z] = self.gradients[a];
        [self.shapes[a], x, y, z]
    }
}

impl<F: WeakForm> CellSum<F> {
    /// Over all cells of a body.
    pub fn new(form: F, disc: &Arc<Discretization>) -> Self {
        let components = disc.dim() + form.fields().iter().map(|field| field.components).sum::<usize>();
        CellSum { form, disc: disc.clone(), components }
    }

    /// Calls with every quadrature point, cell by cell.
    fn each(&self, mut call: impl FnMut(&CellPoint)) {
        for part in &self.disc.points().parts {
            for c in 0..part.cells.len() {
                (0..part.table.points).for_each(|q| call(&self.cell_point(part, c, q)));
            }
        }
    }

    fn cell_point<'p>(&'p self, part: &'p CellGroup, c: usize, q: usize) -> CellPoint<'p> {
        let (table, dim, point) = (&part.table, self.disc.dim(), part.first_point(c) + q);
        let inverse = &part.inverse[c * table.points + q];
        let reference = |k: usize, a: usize| table.gradients[(q * dim + k) * table.width + a];
        let slope = |a: usize, j: usize| (0..dim).map(|k| reference(k, a) * inverse[3 * k + j]).sum();
        let gradient = |a: usize| std::array::from_fn(|j| if j < dim { slope(a, j) } else { 0.0 });
        CellPoint {
            cell: part.cells[c] as usize,
            point,
            weight: self.disc.points().weights()[point],
            nodes: part.nodes_of(c),
            shapes: table.shapes_at(q),
            gradients: (0..table.nodes).map(gradient).collect(),
        }
    }

    /// The numbers at a point; changes along vectors and controls are put into the parts of these numbers.
    fn numbers(&self, at: &Instant, here: &CellPoint, along: [Option<Increment>; 2]) -> FormPoint {
        let n = self.components;
        let interpolated = |c: usize| {
            let value = here.interpolated(at.u, n, c);
            let change = along.map(|along| along.map_or([0.0; 4], |along| here.interpolated(along.u, n, c)));
            std::array::from_fn::<_, 4, _>(|k| HyperDual([value[k], change[0][k], change[1][k], 0.0]))
        };
        let all: Vec<[HyperDual; 4]> = (0..n).map(interpolated).collect();
        let control = |slot: usize| {
            let change = along.map(|along| along.map_or(0.0, |along| at.slot_of(along.controls, slot)));
            HyperDual([at.control(slot), change[0], change[1], 0.0])
        };
        FormPoint {
            cell: here.cell,
            point: here.point,
            values: all.iter().map(|own| own[0]).collect(),
            gradients: all.iter().map(|own| [own[1], own[2], own[3]]).collect(),
            controls: (0..self.form.slots().len()).map(control).collect(),
        }
    }

    /// s and the three q of every component.
    fn dual(&self, at: &FormPoint) -> Vec<[HyperDual; 4]> {
        let mut out = FormDual { sources: vec![ZERO; self.components], fluxes: vec![[ZERO; 3]; self.components] };
        self.form.dual(at, &mut out);
        out.sources.iter().zip(&out.fluxes).map(|(s, [x, y, z])| [*s, *x, *y, *z]).collect()
    }

    /// One part of s and q spread over the nodes.
    fn add_part(&self, here: &CellPoint, dual: &[[HyperDual; 4]], part: usize, out: &mut [f64]) {
        for (a, &node) in here.nodes.iter().enumerate() {
            let shape = here.of_node(a);
            for (c, own) in dual.iter().enumerate() {
                out[self.components * node as usize + c] += here.weight * product(&shape, own, part);
            }
        }
    }

    /// The absolute terms of the forces: what their rounding is measured against.
    fn add_scale(&self, here: &CellPoint, dual: &[[HyperDual; 4]], out: &mut [f64]) {
        for (a, &node) in here.nodes.iter().enumerate() {
            let shape = here.of_node(a);
            for (c, own) in dual.iter().enumerate() {
                let terms: f64 = shape.iter().zip(own).map(|(shape, own)| (shape * own.real()).abs()).sum();
                out[self.components * node as usize + c] += here.weight.abs() * terms;
            }
        }
    }

    /// One part of `lambda . r` at a point.
    fn along(&self, here: &CellPoint, lambda: &[f64], dual: &[[HyperDual; 4]], part: usize) -> f64 {
        let of = |(c, own)| product(&here.interpolated(lambda, self.components, c), own, part);
        here.weight * dual.iter().enumerate().map(of).sum::<f64>()
    }
}

fn product(shape: &[f64; 4], dual: &[HyperDual; 4], part: usize) -> f64 {
    shape.iter().zip(dual).map(|(shape, dual)| shape * dual.0[part]).sum()
}

/// The number that a column of the derivative is by: of a component value (0) or gradient (1 to 3).
fn entry(at: &mut FormPoint, c: usize, k: usize) -> &mut HyperDual {
    match k {
        0 => &mut at.values[c],
        _ => &mut at.gradients[c][k - 1],
    }
}

impl<F: WeakForm> Contribution for CellSum<F> {
    fn name(&self) -> &str {
        self.form.name()
    }

    fn fields(&self) -> &[Field] {
        self.form.fields()
    }

    fn slots(&self) -> &[Slot] {
        self.form.slots()
    }

    fn symmetry(&self) -> Symmetry {
        self.form.symmetry()
    }

    fn has_potential(&self) -> bool {
        self.form.has_potential()
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl<F: WeakForm> ContributionPoint for CellSum<F> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        self.each(|here| {
            let numbers = self.numbers(at, here, [None; 2]);
            if demand.energy {
                let energy = here.weight * self.form.density(&numbers);
                sums.energy += energy;
                sums.energy_scale += energy.abs();
            }
            if demand.force {
                let dual = self.dual(&numbers);
                self.add_part(here, &dual, 0, &mut sums.force);
                self.add_scale(here, &dual, &mut sums.force_scale);
            }
        });
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let n = self.components;
        for part in &self.disc.points().parts {
            for c in 0..part.cells.len() {
                let nodes = part.nodes_of(c);
                let mut element = vec![0.0; (n * nodes.len()).pow(2)];
                for q in 0..part.table.points {
                    let here = self.cell_point(part, c, q);
                    let numbers = self.numbers(at, &here, [None; 2]);
                    for (d, k) in (0..n).flat_map(|d| (0..=self.disc.dim()).map(move |k| (d, k))) {
                        let mut moved = numbers.clone();
                        entry(&mut moved, d, k).0[1] = 1.0;
                        let dual = self.dual(&moved);
                        for (a, b) in (0..nodes.len()).flat_map(|a| (0..nodes.len()).map(move |b| (a, b))) {
                            let (left, right) = (here.of_node(a), here.weight * here.of_node(b)[k]);
                            for (row, own) in dual.iter().enumerate() {
                                element[(n * a + row) * n * nodes.len() + n * b + d] += right * product(&left, own, 1);
                            }
                        }
                    }
                }
                tangent.add_pairs(nodes, &element)?;
            }
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let along = Increment { u: v, controls: &at.controls.clone().zeroed() };
        self.each(|here| {
            let dual = self.dual(&self.numbers(at, here, [Some(along), None]));
            self.add_part(here, &dual, 1, out);
        });
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        self.each(|here| {
            for slot in 0..self.form.slots().len() {
                let mut moved = self.numbers(at, here, [None; 2]);
                moved.controls[slot].0[1] = 1.0;
                into.add_control(at, slot, self.along(here, lambda, &self.dual(&moved), 1));
            }
        });
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let along = Increment { u: &vec![0.0; at.u.len()], controls: v };
        self.each(|here| {
            let dual = self.dual(&self.numbers(at, here, [Some(along), None]));
            self.add_part(here, &dual, 1, out);
        });
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        self.each(|here| {
            let numbers = self.numbers(at, here, [None, Some(*along)]);
            for (d, k) in (0..self.components).flat_map(|d| (0..=self.disc.dim()).map(move |k| (d, k))) {
                let mut moved = numbers.clone();
                entry(&mut moved, d, k).0[1] = 1.0;
                let second = self.along(here, lambda, &self.dual(&moved), 3);
                for (b, &node) in here.nodes.iter().enumerate() {
                    into.u[self.components * node as usize + d] += here.of_node(b)[k] * second;
                }
            }
            for slot in 0..self.form.slots().len() {
                let mut moved = numbers.clone();
                moved.controls[slot].0[1] = 1.0;
                into.add_control(at, slot, self.along(here, lambda, &self.dual(&moved), 3));
            }
        });
        Ok(())
    }
}
