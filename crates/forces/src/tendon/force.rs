//! `TendonForce`: the contribution of a tendon under a given tension, and of an elastic one.

use crate::guides::{Guides, Line};
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Cause, FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_mesh::Polyline;
use nastic_numeric::vector::axpy;

/// What is given of a tendon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// Its tension.
    Tension,
    /// By how much it is drawn in, of an elastic one.
    Pull {
        /// Force per elongation of the whole cable.
        stiffness: f64,
    },
}

impl Drive {
    /// The control of a given tension.
    pub const TENSION: [Slot; 1] = [Slot::pulling("tension", "N")];
    /// The control of a length that is drawn in.
    pub const PULL: [Slot; 1] = [Slot::scalar("pull", "m")];
    /// Of a cable that does not stretch, one of both.
    pub const EITHER: [Slot; 2] = [Drive::TENSION[0], Drive::PULL[0]];
}

/// What is drawn of a tendon.
pub(super) fn line(name: &str, guides: &Guides, u: &[f64], tension: f64) -> Polyline {
    Polyline { name: name.to_owned(), points: guides.positions(u), quantities: vec![("tension".to_owned(), tension)] }
}

/// The contribution of a [`Tendon`](super::Tendon) under a given tension, or of an elastic one.
#[derive(Debug)]
pub(super) struct TendonForce {
    name: String,
    guides: Guides,
    reference_length: f64,
    drive: Drive,
}

/// The tension N and its derivatives.
#[derive(Debug, Clone, Copy)]
struct Tension {
    value: f64,
    by_length: f64,
    by_control: f64,
}

impl TendonForce {
    pub(super) fn new(name: &str, guides: Guides, drive: Drive) -> Self {
        let reference_length = guides.reference_length();
        TendonForce { name: name.to_owned(), guides, reference_length, drive }
    }

    /// `L - (L0 - s)`: the elongation of an elastic cable, negative where it is slack.
    fn elongation(&self, length: f64, pull: f64) -> f64 {
        length - self.reference_length + pull
    }

    fn tension(&self, at: &Instant, length: f64) -> Tension {
        let control = at.control(0);
        match self.drive {
            Drive::Tension => Tension { value: control, by_length: 0.0, by_control: 1.0 },
            Drive::Pull { stiffness } => {
                let elongation = self.elongation(length, control);
                if elongation >= 0.0 {
                    Tension { value: stiffness * elongation, by_length: stiffness, by_control: stiffness }
                } else {
                    Tension { value: 0.0, by_length: 0.0, by_control: 0.0 }
                }
            }
        }
    }

    /// The potential, and the sum of absolute values that its rounding is measured against.
    fn potential(&self, at: &Instant, length: f64) -> (f64, f64) {
        let control = at.control(0);
        match self.drive {
            Drive::Tension => (control * length, (control * length).abs()),
            Drive::Pull { stiffness } => {
                let elongation = self.elongation(length, control).max(0.0);
                let value = 0.5 * stiffness * elongation * elongation;
                (value, value + stiffness * elongation * (length + self.reference_length + control.abs()))
            }
        }
    }
}

impl Contribution for TendonForce {
    fn name(&self) -> &str {
        &self.name
    }

    fn stores_energy(&self) -> bool {
        matches!(self.drive, Drive::Pull { .. })
    }

    /// An elastic one has its length at rest from the drawn body.
    fn drawn_nodes(&self) -> Vec<u32> {
        if self.drive == Drive::Tension { Vec::new() } else { self.guides.nodes() }
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        match self.drive {
            Drive::Tension => self.guides.neighbours(),
            Drive::Pull { .. } => vec![self.guides.nodes()],
        }
    }

    fn slots(&self) -> &[Slot] {
        match self.drive {
            Drive::Tension => &Drive::TENSION,
            Drive::Pull { .. } => &Drive::PULL,
        }
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        match (self.drive, values) {
            (Drive::Tension, [tension]) if *tension < 0.0 => Err(FemError::Meaningless {
                what: format!(
                    "the tension of tendon \"{}\" is {tension}, but it only pulls: it must not be negative",
                    self.name
                ),
            }),
            _ => Ok(()),
        }
    }

    fn suspect(&self, at: &Instant) -> Option<Cause> {
        self.guides.meeting(&self.name, at.u).map(Cause::GuidesMeet)
    }

    fn measure(&self) -> f64 {
        self.reference_length
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let length = self.guides.at(at.u).length();
        let tension = self.tension(at, length).value;
        let mut out = vec![
            ("tension", tension),
            ("length", length),
            ("reference_length", self.reference_length),
            ("slack", f64::from(tension <= 0.0)),
        ];
        if let Drive::Pull { .. } = self.drive {
            out.push(("pull", at.control(0)));
        }
        out
    }

    fn lines(&self, at: &Instant) -> Vec<Polyline> {
        let tension = self.tension(at, self.guides.at(at.u).length()).value;
        vec![line(&self.name, &self.guides, at.u, tension)]
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(TendonPoint { tendon: self, line: self.guides.at(at.u) }))
    }
}

/// A [`TendonForce`] at one displacement.
struct TendonPoint<'a> {
    tendon: &'a TendonForce,
    line: Line<'a>,
}

impl TendonPoint<'_> {
    fn tension(&self, at: &Instant) -> Tension {
        self.tendon.tension(at, self.line.length())
    }
}

impl ContributionPoint for TendonPoint<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let tension = self.tension(at).value;
        if tension == 0.0 {
            return Ok(());
        }
        if demand.energy {
            let (value, scale) = self.tendon.potential(at, self.line.length());
            sums.energy += value;
            sums.energy_scale += scale;
        }
        if demand.force {
            self.line.add_force(tension, sums);
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let tension = self.tension(at);
        if tension.value != 0.0 {
            self.line.add_curvature(tension.value, tangent)?;
        }
        if tension.by_length != 0.0 {
            self.line.add_gradient_product(tension.by_length, tangent)?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let tension = self.tension(at);
        if tension.value != 0.0 {
            self.line.add_curvature_product(tension.value, v, out);
        }
        if tension.by_length != 0.0 {
            axpy(tension.by_length * self.line.slope(v), &self.line.gradient(), out);
        }
        Ok(true)
    }

    /// No guide passes the next one, where the direction of the tendon jumps.
    fn max_step(&self, _: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(self.line.max_step(du))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, self.tension(at).by_control * self.line.slope(lambda));
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let change = self.tension(at).by_control * at.slot_of(v, 0);
        if change != 0.0 {
            axpy(change, &self.line.gradient(), out);
        }
        Ok(())
    }

    /// With `a = L_u lambda`, `b = L_u du`, `dN = N_L b + N_m v`: the change of `N a` derived by u,
    /// `N L_uuu[lambda, du] + dN L_uu lambda + N_L (a L_uu du + (lambda . L_uu du) L_u)`, and by the control, `N_m lambda . L_uu du`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (tension, line) = (self.tension(at), &self.line);
        let mut of_du = vec![0.0; lambda.len()];
        line.add_curvature_product(1.0, along.u, &mut of_du);
        let mixed = at.space.dot(lambda, &of_du);
        into.add_control(at, 0, tension.by_control * mixed);
        let change = tension.by_length * line.slope(along.u) + tension.by_control * at.slot_of(along.controls, 0);
        line.add_curvature_product(change, lambda, &mut into.u);
        if tension.value != 0.0 {
            line.add_third_product(tension.value, [lambda, along.u], &mut into.u);
        }
        if tension.by_length != 0.0 {
            axpy(tension.by_length * line.slope(lambda), &of_du, &mut into.u);
            axpy(tension.by_length * mixed, &line.gradient(), &mut into.u);
        }
        Ok(())
    }
}
