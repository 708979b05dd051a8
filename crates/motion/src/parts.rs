//! [`Scheme::in_parts`]: a step that is made as several shorter ones.

use crate::scheme::{End, Quantity, Scheme, Stage, Term, TermInstant};

impl Scheme {
    /// The scheme whose step of length h is n steps of this one of length h/n: a table with the stages of all, so that the adjoint is
    /// that of the parts. `None` of a scheme over two steps, of one that ends at no stage, which no solve has seen, that is linearised,
    /// or that needs an acceleration which its steps do not end with.
    pub(crate) fn in_parts(&self, n: usize) -> Option<Scheme> {
        let before = self.terms().any(|term| term.at == TermInstant::Before);
        let given = self.needs_acceleration() && self.end.acceleration.is_empty();
        if before || given || self.linearised || self.extrapolates() {
            return None;
        }
        let mut stages = Vec::new();
        for part in 0..n {
            for stage in &self.stages {
                stages.push(Stage {
                    time: (part as f64 + stage.time) / n as f64,
                    velocity: self.placed(&stage.velocity, Quantity::Velocity, part, n),
                    acceleration: self.placed(&stage.acceleration, Quantity::Acceleration, part, n),
                });
            }
        }
        let of_end = |of: Quantity, terms: &[Term]| self.placed(terms, of, n - 1, n);
        let [displacement, velocity, acceleration] = self.end.combinations().map(|(of, terms)| of_end(of, terms));
        let error = (0..n).flat_map(|part| self.placed(&self.error, Quantity::Displacement, part, n)).collect();
        let end = End { displacement, velocity, acceleration };
        Some(Scheme { stages, end, start: None, error, parts: n * self.parts, ..self.clone() })
    }

    /// A combination of a part as one of the whole step, of n parts.
    fn placed(&self, terms: &[Term], of: Quantity, part: usize, n: usize) -> Vec<Term> {
        let mut out = Vec::new();
        for term in terms {
            let scale = term.factor * (n as f64).powi(of.power() - term.of.power());
            match term.at {
                TermInstant::Stage(k) => {
                    out.push(Term { factor: scale, at: TermInstant::Stage(part * self.stages.len() + k), ..*term });
                }
                _ if part == 0 => out.push(Term { factor: scale, ..*term }),
                // what the part before ends with
                _ => {
                    let [u, v, a] = self.end.combinations();
                    let (_, ended) = [u, v, a].into_iter().find(|(of, _)| *of == term.of).unwrap_or(u);
                    let ended = self.placed(ended, term.of, part - 1, n);
                    out.extend(ended.into_iter().map(|end| Term { factor: scale * end.factor, ..end }));
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // helpers of tests

    use crate::catalogue::SCHEMES;
    use crate::points::Points;
    use crate::scheme::Scheme;
    use nastic_body::controls::Controls;
    use nastic_body::state::{SolveReport, State};
    use std::sync::Arc;

    const MASS: f64 = 2.0;
    const DAMPING: f64 = 0.7;
    const STIFFNESS: f64 = 30.0;

    /// A mass on a spring with a damper after a step.
    fn step(scheme: &Scheme, h: f64, begin: &State) -> State {
        let mut points = Points::new(scheme, h, begin, None, None, 1);
        for _ in &scheme.stages {
            let at = points.next(&begin.controls);
            let ((c_v, b_v), (c_a, b_a)) = (&at.velocity, &at.acceleration);
            let u = -(MASS * b_a[0] + DAMPING * b_v[0]) / (STIFFNESS + DAMPING * c_v + MASS * c_a);
            points.found(Arc::new(vec![u]), &at);
        }
        let end = points.end();
        State { u: end.u.unwrap(), velocity: end.velocity, acceleration: end.acceleration, ..begin.clone() }
    }

    #[test]
    fn parts_are_shorter_steps() {
        let mut in_parts = Vec::new();
        for row in SCHEMES {
            let scheme = (row.build)().unwrap();
            let Some(three) = scheme.in_parts(3) else { continue };
            in_parts.push(row.name);
            let begin = State::equilibrium(vec![0.3], Controls::zeros([]), 1.0, SolveReport::default());
            let given = Some(Arc::new(vec![-1.1]));
            let begin = State { velocity: given, acceleration: Some(Arc::new(vec![0.4])), ..begin };
            let whole = step(&three, 0.12, &begin);
            let parts = (0..3).fold(begin, |begin, _| step(&scheme, 0.04, &begin));
            let all = |state: &State| {
                [Some(&state.u), state.velocity.as_ref(), state.acceleration.as_ref()].map(|q| q.map(|q| q[0]))
            };
            for (a, b) in all(&whole).into_iter().zip(all(&parts)) {
                assert_eq!(a.is_some(), b.is_some(), "{}", row.name);
                let (a, b) = (a.unwrap_or(0.0), b.unwrap_or(0.0));
                assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{}: {a} {b}", row.name);
            }
            assert_eq!(three.in_parts(2).unwrap().parts, 6);
        }
        let expected = ["backward_euler", "tr_bdf2", "trapezoidal", "newmark", "quasi_dynamic", "quasi_static"];
        assert_eq!(in_parts, expected);
    }
}
