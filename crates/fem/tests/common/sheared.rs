//! [`Sheared`]: a rigid cylinder that is pressed into a half-space and then drawn along it with friction, and what Cattaneo and Mindlin say of it.

use super::half_space::HalfSpace;
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, Controls, Formulation, Instant, Scheme, Solid, SolveOptions, State, StepTo, TimeStepping};
use nastic_fem::{TimeStep, Trajectory, Workspace};
use nastic_mesh::spatial::Obstacle;
use std::f64::consts::PI;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const YOUNG: f64 = 1e5;
/// Nearly incompressible, as normal and tangential contact with a rigid body then do not act on each other (Dundurs' beta is 0.02).
const POISSON: f64 = 0.49;
const FRICTION: f64 = 0.5;
/// Of the cylinder, in half-widths of the contact.
const RADIUS: f64 = 50.0;
/// Steps down and steps along, of a length in time each.
const STEPS: [u32; 2] = [5, 10];
const STEP: f64 = 0.1;
/// How far it is drawn, and the speed below which a node sticks: a two hundredth of that of the cylinder.
const ALONG: f64 = 0.02;
const SLIP_SPEED: f64 = 1e-4;

#[derive(Debug, Clone, Copy)]
pub struct Sheared {
    /// Cells per half-width: an even number.
    pub fine: usize,
    /// How far the body reaches, where it is clamped.
    pub far: f64,
}

/// One instant of the way along.
#[derive(Debug, Clone, Copy)]
pub struct Instants {
    /// `Q/(mu P)`
    pub share: f64,
    /// Half-width of the part that sticks: `a (1 - Q/(mu P))^(1/2)`, with a by the normal force P.
    pub expected: f64,
    /// The outermost node that sticks, and the innermost that slides.
    pub found: [f64; 2],
    pub newton: usize,
}

impl Sheared {
    pub fn cell(&self) -> f64 {
        1.0 / self.fine as f64
    }

    /// Every step along.
    pub fn run(&self) -> Outcome<Vec<Instants>> {
        let half_space = HalfSpace { dim: 2, whole: true, cells: 3 * self.fine / 2, fine: 1.5, far: self.far };
        // a^2/(4 R) (2 ln(2 L/a) - nu/(1 - nu))
        let depth = (2.0 * (2.0 * self.far).ln() - POISSON / (1.0 - POISSON)) / (4.0 * RADIUS);
        let thickness = 0.02 * depth;
        let cylinder = Obstacle::sphere([0.0, RADIUS + thickness, 0.0], RADIUS);
        let contact = Contact::of("cylinder", "top", cylinder).thickness(thickness).refine(1);
        let solid = Solid::new(half_space.mesh()?)?
            .material("body", NeoHooke::from_young_poisson(YOUNG, POISSON)?)?
            .formulation("body", Formulation::MeanDilatation)?
            .clamp("far")?
            .contact(contact.friction(FRICTION, SLIP_SPEED))?;
        let at = |down: f64, along: f64| -> Controls {
            let mut controls = solid.controls();
            (controls.values_mut(0)[0], controls.values_mut(0)[1]) = (along * ALONG, -down * (thickness + depth));
            controls
        };
        let share = |n: u32, of: u32| f64::from(n) / f64::from(of);
        let down = (1..=STEPS[0]).map(|n| at(share(n, STEPS[0]), 0.0));
        let along = (1..=STEPS[1]).map(|n| at(1.0, share(n, STEPS[1])));
        let steps: Vec<StepTo> = down.chain(along).map(|controls| StepTo { dt: STEP, controls }).collect();
        let mut run = Trajectory::from_given(solid.rest());
        let (how, mut workspace) = (SolveOptions::default(), Workspace::default());
        solid.model().advance(&mut run, &Scheme::quasi_static(), &steps, &how, &mut workspace)?;
        let states = &run.states()[STEPS[0] as usize..];
        states.windows(2).map(|pair| self.at(&solid, &pair[0], &pair[1])).collect()
    }

    fn at(&self, solid: &Solid, before: &State, now: &State) -> Outcome<Instants> {
        let step = TimeStep::between(before, now);
        let instant = Instant::of(now).in_step(&step);
        let touch = solid.model().contacts().touches(&instant).remove(0).1;
        let pressures = solid.model().contacts().nodal_pressures(&instant).unwrap_or_default();
        let speed = ALONG / (f64::from(STEPS[1]) * STEP);
        let mut found = [0.0_f64, f64::INFINITY];
        for (node, x) in solid.mesh().points().iter().enumerate().filter(|(node, _)| pressures[*node] > 0.0) {
            let slides = ((now.u[2 * node] - before.u[2 * node]) / STEP - speed).abs();
            match slides < SLIP_SPEED {
                true => found[0] = found[0].max(x[0].abs()),
                false => found[1] = found[1].min(x[0].abs()),
            }
        }
        let modulus = YOUNG / (1.0 - POISSON * POISSON);
        let share = touch.force[0].abs() / (FRICTION * touch.force[1].abs());
        let width = (4.0 * touch.force[1].abs() * RADIUS / (PI * modulus)).sqrt();
        Ok(Instants { share, expected: width * (1.0 - share).max(0.0).sqrt(), found, newton: now.report.newton })
    }
}
