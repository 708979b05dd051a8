//! Numbers of an equilibrium that sensors could read, with their derivatives by the controls.

use super::Reduced;
use crate::cost::{Output, Partials};
use crate::evaluated::Evaluated;
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Controllable, Instant, SecondOrder, SolveOptions, StateError};
use nastic_fields::ControlError;
use nastic_linear::{On, Space};
use nastic_numeric::vector::{axpy, dot};

/// dy/dm of several outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputJacobian {
    /// By rows, shape `[outputs][controls]`.
    pub rows: Vec<Vec<f64>>,
    /// Whether it was found row by row, by adjoints, or column by column, by changes of the state.
    pub by_adjoints: bool,
    /// How much each output would change along the scales of the controls if all it looks at moved as the most that moves there: what rounding of its row is a share of.
    pub sizes: Vec<f64>,
}

impl Reduced {
    /// The numbers of an equilibrium: those that its costs compare with targets or are (`COST`, `COST.PART`), then of contributions what they report and what is an unknown or conjugate to a control:
    /// the pressure of a chamber of given volume, the volume of one of given pressure (`CHAMBER.pressure`, `.volume`), the tension of a cable of given length, the length of a pulled one
    /// (`TENDON.tension`, `.length`). A chamber's potential is -p V, a tendon's T L, so that dV/du = -dr/dp and dL/du = dr/dT with the residual r.
    ///
    /// # Errors
    /// A cost that is not defined there; a motion.
    pub fn outputs(&self, point: &Evaluated) -> Result<Vec<Output>, ControlError> {
        self.refuse_motion("outputs of one state")?;
        let zero = Partials::zero(point.state().u.len(), point.m.len());
        let mut all = Vec::new();
        for (name, cost) in self.term_names().into_iter().zip(self.costs_of(point)?.iter()) {
            for output in cost.outputs(&zero).map_err(|error| error.of(&name))? {
                let name = if output.name.is_empty() { name.clone() } else { format!("{name}.{}", output.name) };
                all.push(Output { name, ..output });
            }
        }
        self.add_outputs_of_contributions(point, &zero, &mut all)?;
        Ok(all)
    }

    /// The names of the costs that give no outputs.
    ///
    /// # Errors
    /// A cost that is not defined there; a motion.
    pub fn without_outputs(&self, point: &Evaluated) -> Result<Vec<String>, ControlError> {
        let zero = Partials::zero(point.state().u.len(), point.m.len());
        let mut all = Vec::new();
        for (name, cost) in self.term_names().into_iter().zip(self.costs_of(point)?.iter()) {
            if cost.outputs(&zero)?.is_empty() {
                all.push(name);
            }
        }
        Ok(all)
    }

    fn add_outputs_of_contributions(
        &self,
        point: &Evaluated,
        zero: &Partials,
        all: &mut Vec<Output>,
    ) -> Result<(), ControlError> {
        let (model, state) = (self.solid().model(), point.state());
        let plane = self.solid().mesh().dim() == 2;
        let (controllable, space) = (model.controllable(), model.unknowns());
        for (name, what, value) in model.quantities(&Instant::of(state))? {
            let named = || format!("{name}.{what}");
            let unit = match what {
                "pressure" => "Pa",
                "tension" => "N",
                "volume" => ["m^3", "m^2"][usize::from(plane)],
                "length" => "m",
                _ => continue,
            };
            let mut partials = zero.clone();
            if matches!(what, "pressure" | "tension") {
                let Some(place) = multiplier(space, &name).filter(|&place| state.u.get(place) == Some(&value)) else {
                    continue;
                };
                partials.u[place] = 1.0;
            } else {
                let (slot, sign) = if what == "volume" { ("pressure", -1.0) } else { ("tension", 1.0) };
                let is_conjugate = |one: &Controllable<'_>| {
                    one.name == name && matches!(one.slots, [own] if own.group == slot && one.points.is_empty())
                };
                let Some(k) = controllable.iter().position(is_conjugate) else { continue };
                let mut v = state.controls.as_ref().clone().zeroed();
                v.values_mut(k).fill(1.0);
                let by_slot = model.control_product(&Instant::of(state), &v);
                axpy(sign, &by_slot.map_err(StateError::from)?, &mut partials.u);
            }
            all.push(Output::watched(named(), value, unit, partials));
        }
        Ok(())
    }

    /// `dy/dm = y_m - y_u K^-1 r_m` of numbers with these partial derivatives, by the factor of one tangent: an adjoint for each number,
    /// or a change of the state for each control, whichever are fewer; one more along `scales`, a change of each control that counts as one. Source: docs/gains.md.
    ///
    /// # Errors
    /// A singular tangent; a motion, a body over ranks, laws with internal variables.
    pub fn output_jacobian(
        &self,
        point: &Evaluated,
        outputs: &[&Partials],
        scales: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<OutputJacobian, ControlError> {
        let what = "derivatives of outputs";
        self.refuse_motion(what)?;
        self.refuse_projection(what)?;
        let layout = self.layout_in_stage(point.stage);
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let mut linear = SecondOrder::new(self.solid.model(), point.state(), &how, &mut workspace.solve)?;
        let mut rows: Vec<Vec<f64>> = outputs.iter().map(|output| output.m.clone()).collect();
        let by_adjoints = outputs.len() <= point.m.len();
        if by_adjoints {
            for (row, output) in rows.iter_mut().zip(outputs) {
                // of what no state changes there is no adjoint
                if output.u.iter().any(|part| *part != 0.0) {
                    let by_points = linear.through_state(&output.u)?.controls;
                    axpy(1.0, &layout.control_vjp(&point.m, &by_points), row);
                }
            }
        } else {
            for k in 0..point.m.len() {
                let mut v = vec![0.0; point.m.len()];
                v[k] = 1.0;
                let du = linear.state_change(&layout.change(&point.m, &v)?)?;
                rows.iter_mut().zip(outputs).for_each(|(row, output)| row[k] += dot(&output.u, &du));
            }
        }
        let moved = linear.state_change(&layout.change(&point.m, scales)?)?;
        self.forget(workspace);
        let space = self.solid.model().unknowns();
        let whole = space.len() - space.multipliers();
        let sizes = outputs.iter().map(|output| size(output, &moved, scales, whole)).collect();
        Ok(OutputJacobian { rows, by_adjoints, sizes })
    }
}

/// `sum |y_u| max |du| + sum |y_m dm|`, fields of the body and multipliers each by themselves.
fn size(output: &Partials, du: &[f64], dm: &[f64], whole: usize) -> f64 {
    let of = |part: &[f64], moved: &[f64]| {
        let most = moved.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        part.iter().map(|own| own.abs()).sum::<f64>() * most
    };
    let (body, numbers) = (of(&output.u[..whole], &du[..whole]), of(&output.u[whole..], &du[whole..]));
    body + numbers + output.m.iter().zip(dm).map(|(own, dm)| (own * dm).abs()).sum::<f64>()
}

/// The place of the only multiplier of a contribution, behind all other unknowns.
fn multiplier(space: &Space, name: &str) -> Option<usize> {
    let mut place = space.len() - space.multipliers();
    for field in space.fields().iter().filter(|field| field.on == On::Whole) {
        if field.name == name {
            return (field.len() == 1).then_some(place);
        }
        place += field.len();
    }
    None
}
