//! Beams that swing under their weight, alone or against something; bars that tumble freely.

use super::{Stuff, block, cells, kind, place};
use crate::common::{between, pick};
use crate::judge::shape::Shape;
use crate::problem::{Failure, Problem, Task, Touching};
use nastic::fem::{Contact, Inertia};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::sync::Arc;

const GRAVITY: f64 = 9.81;
/// Steps of a motion.
const STEPS: usize = 30;

pub fn swinging(random: &mut Random) -> Result<Problem, Failure> {
    let kind = kind(random);
    let length = between(random, 0.6, 1.5);
    let thick = between(random, 0.1, 0.25);
    let mesh = block(kind, [length, thick, thick], cells(kind, [10, 2, 2]))?;
    let stuff = Stuff::of(random, kind);
    let density = stuff.density(10f64.powf(between(random, -3.5, -2.0)), length, GRAVITY);
    let tumbles = random.unit() < 0.3;
    let against = !tumbles && random.unit() < 0.5;
    let scheme = match against {
        true => pick(random, &["backward_euler", "bdf2", "tr_bdf2", "newmark"]),
        false => pick(random, &["backward_euler", "bdf2", "tr_bdf2", "trapezoidal", "newmark"]),
    };
    let mut solid = stuff.on(Solid::new(mesh)?, "body")?;
    let mut facts = stuff.facts(density);
    let down = if kind.dim() == 2 { "y-" } else { "z-" };
    let mut words = String::new();
    if !tumbles {
        solid = solid.clamp("x-")?.body_force("body", place(kind, 0.0, 0.0, -GRAVITY * density))?;
        facts.gravity = place(kind, 0.0, 0.0, -GRAVITY);
        facts.held.push("x-".into());
    }
    if against {
        let radius = between(random, 0.1, 0.4);
        let depth = between(random, 0.01, 0.1) * length;
        let center = place(kind, between(random, 0.6, 1.0) * length, 0.5 * thick, -depth - radius);
        let shape = Shape::Ball { center, radius };
        solid = solid.contact(Contact::of("stop", down, shape.obstacle(kind.dim())?).about(center.into()))?;
        facts.touching.push(Touching { name: "stop".into(), surface: down.into(), shape, centre: center });
        words = format!(", against a sphere of {radius:.2} {depth:.3} below");
    }
    let solid = solid.inertia(Inertia::new("body", density))?;
    // of a cantilever's first mode, and of a wave along the bar
    let wave = (stuff.young / density).sqrt();
    let period = if tumbles { 2.0 * length / wave * 10.0 } else { 6.2 * length * length / (thick * wave) };
    let spin = if tumbles { between(random, 0.2, 2.0) / period * std::f64::consts::TAU } else { 0.0 };
    let at_middle = place(kind, 0.5 * length, 0.5 * thick, 0.5 * thick);
    let axis = if kind.dim() == 2 { Vec3::z() } else { Vec3::new(0.1, 1.0, 0.3).normalize() };
    let turns = |x: &[f64; 3]| spin * axis.cross(&(Vec3::from(*x) - at_middle));
    let mut velocity: Vec<f64> =
        solid.mesh().points().iter().flat_map(|x| turns(x).as_slice()[..kind.dim()].to_vec()).collect();
    velocity.resize(solid.rest().u.len(), 0.0);
    let begin = Box::new(State { velocity: Some(Arc::new(velocity)), ..solid.rest() });
    let dt = period / STEPS as f64;
    let task = Task::Motion { scheme, begin, dt, controls: vec![solid.controls(); STEPS] };
    let about = format!(
        "{}; {length:.2} x {thick:.2}, {}, {scheme}{words}",
        stuff.about,
        if tumbles { format!("tumbles with {spin:.1} rad/s") } else { "swings".to_owned() }
    );
    Ok(Problem { about, solid, facts, task })
}
