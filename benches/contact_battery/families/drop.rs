//! Bodies under their weight: let down on something, dropped on it, sliding over it.

use super::{Stuff, block, cells, kind, place, set, sides};
use crate::common::{between, pick};
use crate::judge::shape::Shape;
use crate::problem::{Failure, Problem, Task, Touching, block as block_of, options};
use nastic::fem::{Contact, Inertia, MovingSupport, RigidBody};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::sync::Arc;

const GRAVITY: f64 = 9.81;
/// Steps of a motion.
const STEPS: usize = 30;
/// Schemes that go with contact.
const SCHEMES: [&str; 4] = ["backward_euler", "bdf2", "tr_bdf2", "newmark"];

/// A block of a random size over something that lies this far under it.
struct Falling {
    kind: CellKind,
    size: [f64; 3],
    stuff: Stuff,
    density: f64,
    mesh: Mesh,
}

impl Falling {
    fn of(random: &mut Random) -> Result<Self, Failure> {
        let kind = kind(random);
        let size = [between(random, 0.5, 1.5), between(random, 0.5, 1.0), between(random, 0.4, 1.0)];
        let mesh = block(kind, size, cells(kind, [5, 3, 4]))?;
        let stuff = Stuff::of(random, kind);
        let density = stuff.density(10f64.powf(between(random, -3.0, -1.0)), size[2], GRAVITY);
        Ok(Falling { kind, size, stuff, density, mesh })
    }

    fn weight(&self) -> Vec3 {
        place(self.kind, 0.0, 0.0, -GRAVITY * self.density)
    }

    /// With its weight and a contact of its bottom.
    fn on(&self, contact: Contact, rigid: bool) -> Result<Solid, Failure> {
        let solid = self.stuff.on(Solid::new(self.mesh.clone())?, "body")?;
        let solid = solid.body_force("body", self.weight())?.contact(contact)?;
        Ok(if rigid { solid.rigid(&RigidBody::new("lump", "body"))? } else { solid })
    }

    fn problem(&self, solid: Solid, task: Task, (touching, friction): (Touching, f64), words: &str) -> Problem {
        let mut facts = self.stuff.facts(self.density);
        facts.gravity = place(self.kind, 0.0, 0.0, -GRAVITY);
        facts.touching.push(touching);
        facts.friction = friction;
        let about = format!("{}; {:.2} x {:.2}; {words}", self.stuff.about, self.size[0], self.size[2]);
        Problem { about, solid, facts, task }
    }

    /// A plane, a wide box or two of its kinds under it, and the centre it turns about.
    fn ground(&self, random: &mut Random, gap: f64) -> (Shape, Vec3) {
        let at = |across: f64, deep: f64, up: f64| place(self.kind, across, deep, up);
        let shape = match pick(random, &["plane", "box", "solid"]) {
            "plane" => Shape::HalfSpace { point: at(0.0, 0.0, -gap), normal: at(0.0, 0.0, 1.0) },
            name => {
                let (mut low, mut high) = (at(-8.0, -8.0, -gap - 1.0), at(9.0, 9.0, -gap));
                if name == "box" {
                    if self.kind.dim() == 2 {
                        (low.z, high.z) = (-2.0, 2.0);
                    }
                    Shape::Brick { low, high, rounding: 0.05 }
                } else {
                    high -= at(0.0, 0.0, 0.02);
                    Shape::Meshed { low, high, rounding: 0.02 }
                }
            }
        };
        (shape, at(0.5, 0.5, -gap))
    }
}

fn contact(kind: CellKind, (shape, centre): (&Shape, Vec3), friction: Option<(f64, f64)>) -> Result<Contact, Failure> {
    let contact = Contact::of("ground", sides(kind)[0], shape.obstacle(kind.dim())?).about(centre.into());
    Ok(friction.map_or_else(|| contact.clone(), |(mu, slip)| contact.clone().friction(mu, slip)))
}

/// A free block that comes to rest on a ground; or one let down by its top on a sphere, a capsule or a box in ten quasi-static steps.
pub fn let_down(random: &mut Random) -> Result<Problem, Failure> {
    let body = Falling::of(random)?;
    let [bottom, top] = sides(body.kind);
    if random.unit() < 0.5 {
        let gap = between(random, 0.0, 0.3);
        let (shape, centre) = body.ground(random, gap);
        let solid = body.on(contact(body.kind, (&shape, centre), None)?, false)?;
        let words = format!("at rest on {}, {gap:.2} under it", shape.name());
        let touching = Touching { name: "ground".into(), surface: bottom.into(), shape, centre };
        let task = Task::Rest(solid.controls());
        return Ok(body.problem(solid, task, (touching, 0.0), &words));
    }
    let (radius, across) = (between(random, 0.1, 0.8), between(random, 0.3, 0.7) * body.size[0]);
    let middle = 0.5 * body.size[1];
    let shape = match random.unit() < 0.5 {
        true => Shape::Ball { center: place(body.kind, across, middle, -radius - 0.02), radius },
        false => {
            let end = |deep: f64| place(body.kind, across + 0.2 * deep, deep, -radius - 0.02);
            Shape::Capsule { ends: [end(0.0), end(body.size[1])], radius }
        }
    };
    let centre = place(body.kind, 0.0, 0.0, -1.0);
    let mu = between(random, 0.1, 1.0);
    let solid = body.on(contact(body.kind, (&shape, centre), Some((mu, 0.01)))?, false)?;
    let solid = solid.motion(MovingSupport::of("top", top))?;
    // hanging: what does not move feels no friction
    let smooth = body.on(contact(body.kind, (&shape, centre), None)?, false)?.motion(MovingSupport::of("top", top))?;
    let hanging = smooth.solve(&smooth.controls(), &options())?;
    let begin = Box::new(State { controls: Arc::new(solid.controls()), ..hanging });
    let depth = between(random, 0.03, 0.15) * body.size[2];
    let at = |n: usize| {
        let mut controls = solid.controls();
        let share = n as f64 / 10.0;
        set(&mut controls, block_of(&solid, "top"), place(body.kind, 0.0, 0.0, -share * (depth + 0.02)).as_slice());
        controls
    };
    let task = Task::Motion { scheme: "quasi_static", begin, dt: 0.1, controls: (1..=10).map(at).collect() };
    let words = format!("let down by {depth:.3} into {}, friction {mu:.2}", shape.name());
    let touching = Touching { name: "ground".into(), surface: bottom.into(), shape, centre };
    let mut problem = body.problem(solid, task, (touching, mu), &words);
    problem.facts.held.push(top.to_owned());
    Ok(problem)
}

/// Falls by a random height on a ground, soft or rigid.
pub fn dropped(random: &mut Random) -> Result<Problem, Failure> {
    let body = Falling::of(random)?;
    let height = 10f64.powf(between(random, -2.0, -0.3));
    let (shape, centre) = body.ground(random, height);
    let mu = if random.unit() < 0.5 { between(random, 0.1, 1.0) } else { 0.0 };
    let speed = (2.0 * GRAVITY * height).sqrt();
    let rigid = random.unit() < 0.2;
    let friction = (mu > 0.0).then_some((mu, 0.02 * speed));
    let solid = body.on(contact(body.kind, (&shape, centre), friction)?, rigid)?;
    let solid = solid.inertia(Inertia::new("body", body.density))?;
    let scheme = pick(random, &SCHEMES);
    let wave = (body.stuff.young / body.density).sqrt();
    let dt = (height / speed * 2.0 + 4.0 * body.size[2] / wave) / STEPS as f64;
    let words = format!(
        "{}falls by {height:.3} on {}, {scheme}{}",
        if rigid { "rigid, " } else { "" },
        shape.name(),
        if mu > 0.0 { format!(", friction {mu:.2}") } else { String::new() }
    );
    let aside = if mu > 0.0 { between(random, -0.5, 0.5) * speed } else { 0.0 };
    let task = thrown(&solid, scheme, place(body.kind, aside, 0.0, 0.0), dt);
    let touching = Touching { name: "ground".into(), surface: sides(body.kind)[0].into(), shape, centre };
    let mut problem = body.problem(solid, task, (touching, mu), &words);
    problem.facts.regions[0].rigid = rigid;
    Ok(problem)
}

/// Thrown along a plane that leans, with friction.
pub fn sliding(random: &mut Random) -> Result<Problem, Failure> {
    let body = Falling::of(random)?;
    let (mu, lean) = (between(random, 0.1, 1.0), between(random, -0.3, 0.3));
    let at = |across: f64, up: f64| place(body.kind, across, 0.0, up);
    let normal = at(lean, 1.0);
    // the lowest corner is just above
    let clear = 0.003 + lean.min(0.0).abs() * body.size[0];
    let shape = Shape::HalfSpace { point: at(0.0, -clear), normal };
    let centre = at(0.0, -clear);
    let speed = 10f64.powf(between(random, -1.0, 0.5));
    let solid = body.on(contact(body.kind, (&shape, centre), Some((mu, 0.02 * speed)))?, false)?;
    let solid = solid.inertia(Inertia::new("body", body.density))?;
    let scheme = pick(random, &SCHEMES);
    let dt = (speed / (GRAVITY * mu)).min(1.0) / STEPS as f64;
    let words = format!("thrown by {speed:.2} m/s over a plane of slope {lean:.2}, friction {mu:.2}, {scheme}");
    let along = at(1.0, -lean).normalize() * speed;
    let task = thrown(&solid, scheme, along, dt);
    let touching = Touching { name: "ground".into(), surface: sides(body.kind)[0].into(), shape, centre };
    Ok(body.problem(solid, task, (touching, mu), &words))
}

/// From rest in shape with one velocity.
fn thrown(solid: &Solid, scheme: &'static str, velocity: Vec3, dt: f64) -> Task {
    let dim = solid.mesh().dim();
    let mut values: Vec<f64> = solid.mesh().points().iter().flat_map(|_| velocity.as_slice()[..dim].to_vec()).collect();
    values.resize(solid.rest().u.len(), 0.0);
    let begin = Box::new(State { velocity: Some(Arc::new(values)), ..solid.rest() });
    Task::Motion { scheme, begin, dt, controls: vec![solid.controls(); STEPS] }
}
