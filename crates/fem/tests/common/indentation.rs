//! [`Indentation`]: a rigid cylinder (plane strain) or ball that is pressed into a half-space, and what Hertz says of it.

use super::half_space::HalfSpace;
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, Controls, Instant, Model, Solid, SolveOptions, State, Touch, Workspace};
use nastic_mesh::spatial::Obstacle;
use std::f64::consts::PI;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Young's modulus, Pa.
pub const YOUNG: f64 = 1e5;
pub const POISSON: f64 = 0.3;

/// Lengths are in contact radii (half-widths) a.
#[derive(Debug, Clone, Copy)]
pub struct Indentation {
    /// 2: cylinder, half of it; 3: ball, a quarter.
    pub dim: usize,
    /// Cells per contact radius: an even number.
    pub fine: usize,
    /// Radius of the obstacle.
    pub radius: f64,
    /// How far the body reaches, where it is clamped.
    pub far: f64,
    /// The depth, in depths at which the contact radius is 1.
    pub deep: f64,
    /// Thickness of the layer as a share of that depth.
    pub thickness: f64,
    /// Stiffness of the layer in largest pressures of Hertz; 100 E if not given.
    pub stiffness: Option<f64>,
}

/// A cylinder of radius 50 in a body of 200, eight cells per half-width.
pub const CYLINDER: Indentation =
    Indentation { dim: 2, fine: 8, radius: 50.0, far: 200.0, deep: 1.0, thickness: 0.01, stiffness: None };
/// A ball, four cells per contact radius.
pub const BALL: Indentation = Indentation { dim: 3, fine: 4, ..CYLINDER };

/// What is found, of the whole contact.
#[derive(Debug, Clone)]
pub struct Carried {
    /// Force, N; of a cylinder N/m.
    pub force: f64,
    pub largest_pressure: f64,
    /// Distances from the middle of the outermost node that is pressed and of the innermost that is not.
    pub radius: [f64; 2],
    pub newton: usize,
}

impl Indentation {
    pub fn effective_modulus() -> f64 {
        YOUNG / (1.0 - POISSON * POISSON)
    }

    /// At which the contact radius is 1: of a ball `a^2/R`, of a cylinder on a layer of depth L `a^2/(4 R) (2 ln(2 L/a) - nu/(1 - nu))`.
    pub fn unit_depth(&self) -> f64 {
        match self.dim {
            3 => 1.0 / self.radius,
            _ => (2.0 * (2.0 * self.far).ln() - POISSON / (1.0 - POISSON)) / (4.0 * self.radius),
        }
    }

    /// How deep it goes.
    pub fn depth(&self) -> f64 {
        self.deep * self.unit_depth()
    }

    /// Thickness of the layer.
    pub fn layer(&self) -> f64 {
        self.thickness * self.unit_depth()
    }

    /// Largest pressure where the contact radius is 1.
    pub fn unit_pressure(&self) -> f64 {
        let share = if self.dim == 3 { 2.0 / PI } else { 0.5 };
        share * Self::effective_modulus() / self.radius
    }

    /// Force and largest pressure of a ball at a depth.
    pub fn of_ball(&self, depth: f64) -> [f64; 2] {
        let modulus = Self::effective_modulus();
        [4.0 / 3.0 * modulus * self.radius.sqrt() * depth.powf(1.5), 2.0 * modulus / PI * (depth / self.radius).sqrt()]
    }

    /// Half-width and largest pressure of a cylinder by its force.
    pub fn of_cylinder(&self, force: f64) -> [f64; 2] {
        let modulus = Self::effective_modulus();
        [(4.0 * force * self.radius / (PI * modulus)).sqrt(), (force * modulus / (PI * self.radius)).sqrt()]
    }

    /// Length of a cell where it is touched.
    pub fn cell(&self) -> f64 {
        1.0 / self.fine as f64
    }

    fn half_space(&self) -> HalfSpace {
        HalfSpace { dim: self.dim, whole: false, cells: 3 * self.fine / 2, fine: 1.5, far: self.far }
    }

    /// With the obstacle above by the thickness of the layer.
    pub fn solid(&self) -> Outcome<Solid> {
        let (up, thickness) = (self.dim - 1, self.layer());
        let mut centre = [0.0; 3];
        centre[up] = self.radius + thickness;
        let contact = Contact::of("obstacle", "top", Obstacle::sphere(centre, self.radius));
        let contact = contact.thickness(thickness).refine(1);
        let contact = match self.stiffness {
            Some(share) => contact.stiffness(share * self.unit_pressure()),
            None => contact,
        };
        let mut solid = Solid::new(self.half_space().mesh()?)?
            .material("body", NeoHooke::from_young_poisson(YOUNG, POISSON)?)?
            .clamp("far")?
            .displace("x-", [Some(0.0), None, None])?;
        if self.dim == 3 {
            solid = solid.displace("y-", [None, Some(0.0), None])?;
        }
        Ok(solid.contact(contact)?)
    }

    /// At its depth with the layer, and without.
    pub fn press(&self) -> Outcome<[Carried; 2]> {
        let (solid, how) = (self.solid()?, SolveOptions::default());
        let layered = solid.solve(&self.pressed(&solid), &how)?;
        let exact = solid.model().stability().exact_contact(&layered, &how, &mut Workspace::default())?;
        Ok([self.carried(solid.model(), &layered), self.carried(&exact.model, &exact.state)])
    }

    fn pressed(&self, solid: &Solid) -> Controls {
        let mut controls = solid.controls();
        controls.values_mut(0)[self.dim - 1] = -self.depth() - self.layer();
        controls
    }

    fn carried(&self, model: &Model, state: &State) -> Carried {
        let at = Instant::of(state);
        let pressures = model.contacts().nodal_pressures(&at).unwrap_or_default();
        let touches: Vec<Touch> = model.contacts().touches(&at).into_iter().map(|(_, touch)| touch).collect();
        let mut radius = [0.0, f64::INFINITY];
        for (x, p) in model.discretization().mesh().points().iter().zip(pressures) {
            let r = (0..self.dim - 1).map(|i| x[i] * x[i]).sum::<f64>().sqrt();
            if p > 0.0 {
                radius[0] = radius[0].max(r);
            } else if x[self.dim - 1] == 0.0 {
                radius[1] = radius[1].min(r);
            }
        }
        let parts = if self.dim == 3 { 4.0 } else { 2.0 };
        let force = touches.iter().map(|touch| parts * touch.force[self.dim - 1].abs()).sum();
        let largest_pressure = touches.iter().map(|touch| touch.largest_pressure).fold(0.0, f64::max);
        Carried { force, largest_pressure, radius, newton: state.report.newton }
    }
}

/// The value at h = 0 of a parabola `c_0 + c_2 h^2` through values at some h, by least squares.
pub fn extrapolated(values: &[(f64, f64)]) -> f64 {
    let n = values.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| values.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|(h, _)| h * h), mean(&|(_, v)| *v));
    let (xy, xx) = (mean(&|(h, v)| (h * h - x) * (v - y)), mean(&|(h, _)| (h * h - x).powi(2)));
    y - xy / xx * x
}
