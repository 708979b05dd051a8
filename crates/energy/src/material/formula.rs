use std::collections::BTreeMap;
use std::sync::Arc;

use nastic_tensor::{HyperDual, Kinematics, Mat3, Tangent, Vec3, cross};

use crate::formula::{
    Expression, FormulaError, FormulaProblem, Graph, Id, Invariant, LANES, Lanes, MOST_NODES, Node, Number, Step, Tape,
    check_smooth,
};
use crate::slot::lasting;
use crate::{
    EnergyError, EnergyTerm, Field, MaterialPoint, Moduli, Outside, PointBatch, Response, Slot, Slots, Want, check,
};

/// Pairs of invariants, in the order of second derivatives.
const PAIRS: [[usize; 2]; 10] = [[0, 0], [0, 1], [0, 2], [0, 3], [1, 1], [1, 2], [1, 3], [2, 2], [2, 3], [3, 3]];
/// The second derivative by J is part of what is isotropic.
const BY_JACOBIAN: usize = 7;
/// Parameters that vary over the body at most.
const MOST_FIELDS: usize = 8;
/// Energy and stress at rest up to this share of the stiffness there are rounding.
const AT_REST: f64 = 1e-9;

/// A law whose energy is a formula of invariants and parameters.
///
/// **Energy.** `W(y; theta)` with `y = (I1, I2, J, I4)`: `I1 = |F|^2`, `I2 = |H|^2`, `J = det F` and, with a fibre `f`, `I4 = |F f|^2`.
///
/// **Derivatives.** `W_a = dW/dy_a` and `W_ab` are formulas themselves, made by the rules of differentiation and simplified; with `W` they are flat
/// programs in which every common part is computed once. With `y_1' = 2 F`, `y_2' = 2 H x F`, `y_J' = H`, `y_4' = 2 (F f) f`,
///
/// `P = W_a y_a'`, `dP/dF = W_ab y_a' (.) y_b' + W_a y_a''`,
///
/// and the third derivatives from those of `W_a` along two changes in hyper-dual numbers: no differences anywhere.
///
/// **Parameters.** Any, by their names in the formula, each a [`Field`]; the unit vector `fiber` where the formula names it. Formulas with branches (`min`, `max`,
/// `abs`, comparisons) are differentiated in the branch that holds.
///
/// **Checked** when it is made: `W(I) = 0` and `P(I) = 0` up to 1e-9 of the norm of `dP/dF` at rest, wherever parameters differ; with branches, that neither
/// energy nor stress jumps along stretches, shears and changes of volume. A deformation where an operation has no finite value (a logarithm of what is not
/// positive, say) is beyond the domain, [`Outside`].
///
/// **Convexity.** Nothing is stated.
///
/// **Source.** The chain rule of invariants: J. Bonet, A. Gil & R. Ortigosa, CMAME 283 (2015) 1061-1094, doi 10.1016/j.cma.2014.10.002.
#[derive(Clone, Debug)]
pub struct FormulaLaw {
    energy: Tape,
    /// `W_a`
    gradient: Tape,
    /// `W_a`, `W_ab`
    curvature: Tape,
    /// Which of `W_ab` are not zero.
    curved: [bool; 10],
    uses: [bool; 4],
    /// Parameters that vary, in the order of the programs.
    fields: Vec<Field<f64>>,
    fiber: Option<Field<Vec3>>,
    /// Those parameters as slots, where they are some.
    slots: Vec<Slot>,
    source: Arc<(Expression, BTreeMap<String, Field<f64>>)>,
}

impl FormulaLaw {
    /// Name in case files and messages.
    pub const NAME: &str = "formula";

    /// From the energy (J/m^3), the values of its parameters and its fibre.
    ///
    /// # Errors
    /// [`EnergyError::Formula`]: a parameter without value or one that is not used, a fibre likewise, energy or stress at rest, jumps.
    /// [`EnergyError::Parameter`] of one that is not finite, [`EnergyError::Direction`] of no unit vector.
    pub fn new(
        energy: &Expression,
        parameters: &BTreeMap<String, Field<f64>>,
        fiber: Option<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let refuse = |problem| EnergyError::Formula(FormulaError { text: energy.text.clone(), problem });
        let fiber = fiber.map(|fiber| fiber.unit_directions(Self::NAME, "fiber")).transpose()?;
        named(energy, parameters, fiber.is_some()).map_err(refuse)?;
        for field in parameters.values() {
            field.require(Self::NAME, "a parameter", |_| true, "")?;
        }
        let varies = |field: &Field<f64>| !matches!(field, Field::Uniform(_));
        let law = Self::compiled(energy, parameters, fiber, varies).map_err(refuse)?;
        law.places().try_for_each(|at| law.check_rest(at)).map_err(refuse)?;
        let branches = [Step::Less, Step::LessOrEqual, Step::Minimum, Step::Maximum, Step::Abs];
        if branches.iter().any(|step| energy.steps.contains(step)) {
            let here = MaterialPoint { cell: 0, point: 0 };
            let invariants = |k: &Kinematics| law.invariants(here, k);
            check_smooth(&law, invariants, law.fiber.as_ref().map(|f| f.at(here))).map_err(refuse)?;
        }
        Ok(law)
    }

    /// The same law with all of its parameters as slots of the role [`Role::Design`](crate::Role).
    ///
    /// **Derivatives.** `dP/dtheta_k = W_a,k y_a'` and their changes are those of `W_a` in hyper-dual numbers, one of whose changes is that of `theta_k`.
    ///
    /// # Errors
    /// [`EnergyError::Formula`] of more parameters than may vary.
    pub fn parametrised(&self) -> Result<Self, EnergyError> {
        let (energy, parameters) = &*self.source;
        let refuse = |problem| EnergyError::Formula(FormulaError { text: energy.text.clone(), problem });
        let law = Self::compiled(energy, parameters, self.fiber.clone(), |_| true).map_err(refuse)?;
        let slot = |(name, field): (&String, &Field<f64>)| {
            Slot::design(lasting(name), "", field.entries().next().map_or(0.0, |(_, value)| value))
        };
        Ok(Self { slots: parameters.iter().map(slot).collect(), ..law })
    }

    fn compiled(
        energy: &Expression,
        parameters: &BTreeMap<String, Field<f64>>,
        fiber: Option<Field<Vec3>>,
        varies: impl Fn(&Field<f64>) -> bool,
    ) -> Result<Self, FormulaProblem> {
        let varying: Vec<&String> = parameters.iter().filter(|(_, f)| varies(f)).map(|(n, _)| n).collect();
        if varying.len() > MOST_FIELDS {
            return Err(FormulaProblem::TooManyFields { most: MOST_FIELDS });
        }
        let value = |name: &str| match parameters.get(name)? {
            Field::Uniform(x) if !varies(&Field::Uniform(*x)) => Some(Node::Constant((x + 0.0).to_bits())),
            _ => varying.iter().position(|n| *n == name).map(|k| Node::Parameter(k as u16)),
        };
        let too_long = FormulaProblem::TooLong { most: MOST_NODES };
        if energy.steps.len() > MOST_NODES / 50 {
            return Err(too_long);
        }
        let mut graph = Graph::default();
        let whole = graph.of(energy, value).ok_or(FormulaProblem::NoFormula)?;
        let first: Vec<Id> = Invariant::ALL.into_iter().map(|by| graph.derivative(whole, by)).collect();
        let mut both = first.clone();
        for [a, b] in PAIRS {
            both.push(graph.derivative(first[a], Invariant::ALL[b]));
            if graph.len() > MOST_NODES {
                return Err(too_long);
            }
        }
        let zero = |id: Id| graph.value(id) == Some(0.0);
        let tape = |outputs: &[Id]| Tape::new(&graph, outputs).ok_or(FormulaProblem::TooLong { most: MOST_NODES });
        Ok(Self {
            energy: tape(&[whole])?,
            gradient: tape(&first)?,
            curvature: tape(&both)?,
            curved: std::array::from_fn(|n| !zero(both[4 + n])),
            uses: Invariant::ALL.map(|invariant| energy.depends_on(invariant)),
            fields: varying.iter().filter_map(|name| parameters.get(*name).cloned()).collect(),
            fiber,
            slots: Vec::new(),
            source: Arc::new((energy.clone(), parameters.clone())),
        })
    }

    /// One place for every entry of the fields.
    fn places(&self) -> impl Iterator<Item = MaterialPoint> + use<> {
        let lengths = self.fields.iter().map(|field| field.entries().count());
        let directions = self.fiber.iter().map(|field| match field {
            Field::Uniform(_) => usize::MAX,
            field => field.entries().count(),
        });
        let count = lengths.chain(directions).min().unwrap_or(1);
        (0..if count == usize::MAX { 1 } else { count }).map(|n| MaterialPoint { cell: n, point: n })
    }

    fn check_rest(&self, at: MaterialPoint) -> Result<(), FormulaProblem> {
        let rest = Kinematics::rest();
        let batch = PointBatch { kinematics: &[rest], cell: at.cell, first: at.point };
        let (y, theta) = (self.invariants(at, &rest), self.parameters(&batch, Slots::none(), 0));
        if let Some(fault) = self.energy.fault(y, &theta).or_else(|| self.curvature.fault(y, &theta)) {
            let what = format!("{} = {:e}", fault.measure, fault.value);
            return Err(FormulaProblem::NoValueAtRest(what));
        }
        let here = check::evaluate(self, at, &rest, &[]);
        let stiffness = here.tangent.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        if here.energy.abs() > AT_REST * stiffness {
            return Err(FormulaProblem::EnergyAtRest { energy: here.energy });
        }
        if here.stress.norm() > AT_REST * stiffness {
            let f = self.fiber.as_ref().map(|fiber| fiber.at(at));
            let along = f.map_or(0.0, |f| (3.0 * f.dot(&(here.stress * f)) - here.stress.trace()) / 2.0);
            let along = if along.abs() > AT_REST * stiffness { along } else { 0.0 };
            let pressure = (here.stress.trace() - along) / 3.0;
            return Err(FormulaProblem::StressAtRest { pressure, along, stiffness });
        }
        Ok(())
    }

    /// Those that vary at the q-th point of a cell: what the slots hold, or else the fields.
    #[inline]
    fn parameters(&self, at: &PointBatch, m: Slots, q: usize) -> [f64; MOST_FIELDS] {
        let mut theta = [0.0; MOST_FIELDS];
        let place = at.place(q);
        match m.width {
            0 => theta.iter_mut().zip(&self.fields).for_each(|(value, field)| *value = field.at(place)),
            width => theta[..width].copy_from_slice(m.only(q).values),
        }
        theta
    }

    /// `(I1, I2, J, I4)`; those that the formula does not name are not computed.
    #[inline]
    fn invariants(&self, at: MaterialPoint, k: &Kinematics) -> [f64; 4] {
        let square = |used: bool, m: &Mat3| if used { m.norm_squared() } else { 3.0 };
        let fiber = self.fiber.as_ref().map_or(1.0, |fiber| (k.f() * fiber.at(at)).norm_squared());
        [square(self.uses[0], k.f()), square(self.uses[1], k.h()), k.j(), fiber]
    }

    /// The energies of some points at a time; the last ones stand for those that are missing.
    fn add_energies(&self, at: &PointBatch, m: Slots, energy: &mut [f64]) {
        for (part, out) in energy[..at.len()].chunks_mut(LANES).enumerate() {
            let last = out.len() - 1;
            let (mut y, mut theta) = ([Lanes::constant(0.0); 4], [Lanes::constant(0.0); MOST_FIELDS]);
            for lane in 0..LANES {
                let q = LANES * part + lane.min(last);
                let place = at.place(q);
                let own = self.invariants(place, &at.kinematics[q]);
                y.iter_mut().zip(own).for_each(|(y, own)| y.0[lane] = own);
                theta.iter_mut().zip(self.parameters(at, m, q)).for_each(|(theta, own)| theta.0[lane] = own);
            }
            let [w] = self.energy.evaluate(y, &theta);
            out.iter_mut().zip(w.0).for_each(|(out, w)| *out += w);
        }
    }

    /// Calls with every slot of every point, `slots * point + slot`: `W_a` along one unit of the slot (first change) and along a change of F and of
    /// the slots (second change), the slopes `y_a'` and the point.
    fn by_parameter(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        mut each: impl FnMut(usize, [HyperDual; 4], &[Mat3; 4], usize),
    ) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let place = at.place(q);
            let (y, slopes, theta) = (self.invariants(place, k), self.slopes(place, k), self.parameters(at, m, q));
            let inputs: [HyperDual; 4] =
                std::array::from_fn(|n| HyperDual([y[n], 0.0, slopes[n].dot(&change[q]), 0.0]));
            for slot in 0..self.slots.len() {
                let mut numbers = theta.map(HyperDual::constant);
                numbers.iter_mut().take(self.slots.len()).enumerate().for_each(|(l, x)| x.0[2] = v.get(q, l));
                numbers[slot].0[1] = 1.0;
                let w: [HyperDual; 4] = self.gradient.evaluate(inputs, &numbers);
                each(q * self.slots.len() + slot, w, &slopes, q);
            }
        }
    }

    /// `y_a'`
    #[inline]
    fn slopes(&self, at: MaterialPoint, k: &Kinematics) -> [Mat3; 4] {
        let second = if self.uses[1] { cross(k.h(), k.f()) * 2.0 } else { Mat3::zeros() };
        let fiber = self.fiber.as_ref().map_or_else(Mat3::zeros, |fiber| {
            let f = fiber.at(at);
            k.f() * f * f.transpose() * 2.0
        });
        [k.f() * 2.0, second, *k.h(), fiber]
    }

    fn add_tangent(&self, at: MaterialPoint, k: &Kinematics, slopes: &[Mat3; 4], w: &[f64; 14], out: &mut Tangent) {
        let (f, h) = (k.f(), k.h());
        let [first, second, jacobian, fiber, ..] = *w;
        let geometric = h * (2.0 * second) + f * jacobian;
        out.add_isotropic(f, h, &geometric, [2.0 * first, 2.0 * second, w[4 + BY_JACOBIAN]]);
        if let Some(direction) = &self.fiber {
            out.add_fiber(&direction.at(at), 2.0 * fiber);
        }
        for (n, [a, b]) in PAIRS.into_iter().enumerate() {
            if !self.curved[n] || n == BY_JACOBIAN {
                continue;
            }
            match a == b {
                true => out.add_outer(&slopes[a], &slopes[a], w[4 + n]),
                false => out.add_outer_symmetric(&slopes[a], &slopes[b], w[4 + n]),
            }
        }
    }

    /// `sum_a w_a y_a''[G]`
    fn curved_by(&self, at: MaterialPoint, k: &Kinematics, w: &[f64; 4], g: &Mat3) -> Mat3 {
        let (f, h) = (k.f(), k.h());
        let fg = cross(f, g);
        let mut sum = g * (2.0 * w[0]) + fg * w[2];
        if self.uses[1] {
            sum += (cross(&fg, f) + cross(h, g)) * (2.0 * w[1]);
        }
        if let Some(fiber) = &self.fiber {
            let direction = fiber.at(at);
            sum += g * direction * direction.transpose() * (2.0 * w[3]);
        }
        sum
    }
}

/// Whether names and values match.
fn named(energy: &Expression, parameters: &BTreeMap<String, Field<f64>>, fiber: bool) -> Result<(), FormulaProblem> {
    let names = energy.parameters();
    if let Some(name) = names.iter().find(|name| !parameters.contains_key(**name)) {
        return Err(FormulaProblem::NoValue { name: (*name).to_owned(), given: parameters.keys().cloned().collect() });
    }
    if let Some(name) = parameters.keys().find(|name| !names.contains(&name.as_str())) {
        return Err(FormulaProblem::Unused(name.clone()));
    }
    match (energy.depends_on(Invariant::Fiber), fiber) {
        (true, false) => Err(FormulaProblem::NoFiber),
        (false, true) => Err(FormulaProblem::UnusedFiber),
        _ => Ok(()),
    }
}

/// `sum_a w_a m_a`
fn combination(w: &[f64], m: &[Mat3; 4]) -> Mat3 {
    m[0] * w[0] + m[1] * w[1] + m[2] * w[2] + m[3] * w[3]
}

impl EnergyTerm for FormulaLaw {
    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        self.fields[slot].at(at)
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        let still = vec![Mat3::zeros(); at.len()];
        self.by_parameter(at, m, &still, Slots::none(), |n, w, slopes, _| {
            let first = w.map(|w| w.along(0));
            out[n] = combination(&first, slopes);
        });
    }

    /// `W_a,k` changes by `W_a,kb (y_b' : A) + W_a,kl v_l`, its factor `y_a'` by `y_a''[A]`.
    fn control_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        self.by_parameter(at, m, change, v, |n, w, slopes, q| {
            let curved = self.curved_by(at.place(q), &at.kinematics[q], &w.map(|w| w.along(0)), &change[q]);
            out[n] = combination(&w.map(|w| w.both()), slopes) + curved;
        });
        Ok(())
    }

    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        if want.energy {
            self.add_energies(at, m, out.energy);
        }
        if !want.stress && !want.tangent {
            return;
        }
        for (q, k) in at.kinematics.iter().enumerate() {
            let place = at.place(q);
            let (y, theta) = (self.invariants(place, k), self.parameters(at, m, q));
            if want.tangent {
                let slopes = self.slopes(place, k);
                let w: [f64; 14] = self.curvature.evaluate(y, &theta);
                self.add_tangent(place, k, &slopes, &w, &mut out.tangent[q]);
                if want.stress {
                    out.stress[q] += combination(&w[..4], &slopes);
                }
            } else if want.stress {
                let w: [f64; 4] = self.gradient.evaluate(y, &theta);
                out.stress[q] += combination(&w, &self.slopes(place, k));
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, (k, g)) in at.kinematics.iter().zip(change).enumerate() {
            let place = at.place(q);
            let slopes = self.slopes(place, k);
            let w: [f64; 14] = self.curvature.evaluate(self.invariants(place, k), &self.parameters(at, m, q));
            let along: [f64; 4] = std::array::from_fn(|a| slopes[a].dot(g));
            let mut by_slope = [0.0; 4];
            for (n, [a, b]) in PAIRS.into_iter().enumerate() {
                by_slope[a] += w[4 + n] * along[b];
                by_slope[b] += if a == b { 0.0 } else { w[4 + n] * along[a] };
            }
            out[q] += combination(&by_slope, &slopes) + self.curved_by(place, k, &[w[0], w[1], w[2], w[3]], g);
        }
    }

    /// With `d` the changes of `W_a` along `A`, along `B` and along both, all from one evaluation in hyper-dual numbers:
    /// `d_AB,a y_a' + d_A,a y_a''[B] + d_B,a y_a''[A] + W_a y_a'''[A, B]`.
    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        [first, second]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for (q, (k, (a, b))) in at.kinematics.iter().zip(first.iter().zip(second)).enumerate() {
            let place = at.place(q);
            let (y, slopes) = (self.invariants(place, k), self.slopes(place, k));
            let inputs: [HyperDual; 4] = std::array::from_fn(|n| {
                let mut one = [0.0; 4];
                one[n] = 1.0;
                let both = self.curved_by(place, k, &one, a).dot(b);
                HyperDual([y[n], slopes[n].dot(a), slopes[n].dot(b), both])
            });
            let w: [HyperDual; 4] = self.gradient.evaluate(inputs, &self.parameters(at, m, q).map(HyperDual::constant));
            out[q] += combination(&w.map(|w| w.both()), &slopes);
            out[q] += self.curved_by(place, k, &w.map(|w| w.along(0)), b);
            out[q] += self.curved_by(place, k, &w.map(|w| w.along(1)), a);
            let ab = cross(a, b);
            out[q] += ab * w[2].real();
            if self.uses[1] {
                let (fa, fb) = (cross(k.f(), a), cross(k.f(), b));
                out[q] += (cross(&ab, k.f()) + cross(&fa, b) + cross(&fb, a)) * (2.0 * w[1].real());
            }
        }
        Ok(())
    }

    fn check_domain(&self, at: &PointBatch, m: Slots) -> Result<(), Outside> {
        if self.curvature.is_safe() && self.energy.is_safe() {
            return Ok(());
        }
        for (point, k) in at.kinematics.iter().enumerate() {
            let place = at.place(point);
            let (y, theta) = (self.invariants(place, k), self.parameters(at, m, point));
            let [w] = self.energy.evaluate::<f64, 1>(y, &theta);
            let slopes: [f64; 14] = self.curvature.evaluate(y, &theta);
            if w.is_finite() && slopes.iter().all(|w| w.is_finite()) {
                continue;
            }
            let fault = self.energy.fault(y, &theta).or_else(|| self.curvature.fault(y, &theta));
            let (measure, value, limit) = fault.map_or(("its energy", w, f64::MAX), |f| (f.measure, f.value, f.limit));
            let meaning = "where the energy of the formula is no number";
            return Err(Outside { law: Self::NAME, measure, value, limit, meaning, point });
        }
        Ok(())
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.fields.iter().try_for_each(|field| field.check_len(Self::NAME, "a parameter", cells, points))?;
        self.fiber.as_ref().map_or(Ok(()), |fiber| fiber.check_len(Self::NAME, "fiber", cells, points))
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        self.fiber.as_ref().map(|fiber| fiber.at(at))
    }

    /// Spencer's five constants, read off `dP/dF` at rest.
    fn moduli(&self, at: MaterialPoint) -> Option<Moduli> {
        let tangent = check::evaluate(self, at, &Kinematics::rest(), &[]).tangent;
        Some(Moduli::of_rest(&tangent, self.direction(at)))
    }
}
