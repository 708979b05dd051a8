//! Pads that close on a block and lift it from a floor by friction.

use super::{Stuff, block, cells, kind, place, set, sides};
use crate::common::{between, pick};
use crate::judge::shape::Shape;
use crate::problem::{Failure, Problem, Task, Touching, block as block_of};
use nastic::fem::{Contact, Inertia, RigidBody};
use nastic::numeric::Random;
use nastic::prelude::*;

const GRAVITY: f64 = 9.81;
/// Steps of closing, and of lifting.
const STEPS: usize = 12;
/// Distance of the pads and of the floor before they move.
const CLEAR: f64 = 0.01;

pub fn gripped(random: &mut Random) -> Result<Problem, Failure> {
    let kind = kind(random);
    let size = [between(random, 0.5, 1.0), between(random, 0.5, 1.0), between(random, 0.5, 1.2)];
    let mesh = block(kind, size, cells(kind, [4, 3, 4]))?;
    let stuff = Stuff::of(random, kind);
    let squeeze = between(random, 0.02, 0.1) * size[0];
    let mu = between(random, 0.2, 1.0);
    let density = stuff.density(10f64.powf(between(random, -3.5, -2.0)), size[2], GRAVITY);
    let rigid = random.unit() < 0.2;
    let shapes = [-1.0, 1.0].map(|sign| pad(kind, size, sign));
    let what = pick(random, &[0, 1, 2]);
    let at = |across: f64, up: f64| place(kind, across, 0.5 * size[1], up);
    let floor = Shape::HalfSpace { point: at(0.0, -CLEAR), normal: place(kind, 0.0, 0.0, 1.0) };
    let mut solid = stuff.on(Solid::new(mesh)?, "body")?;
    solid = solid.body_force("body", place(kind, 0.0, 0.0, -GRAVITY * density))?;
    let mut touching = Vec::new();
    let names = ["left", "right", "floor"];
    let surfaces = ["x-", "x+", sides(kind)[0]];
    for (k, shape) in shapes.map(|all| all[what].clone()).into_iter().chain([floor]).enumerate() {
        let centre = at(0.0, 0.0);
        let contact = Contact::of(names[k], surfaces[k], shape.obstacle(kind.dim())?);
        solid = solid.contact(contact.about(centre.into()).friction(mu, 0.01))?;
        touching.push(Touching { name: names[k].into(), surface: surfaces[k].into(), shape, centre });
    }
    if rigid {
        solid = solid.rigid(&RigidBody::new("lump", "body"))?;
    }
    let solid = solid.inertia(Inertia::new("body", density))?;
    let closed = if rigid { CLEAR + 0.001 } else { CLEAR + squeeze };
    let lift = between(random, 0.05, 0.3);
    let controls = |n: usize| {
        let mut controls = solid.controls();
        let closes = (n as f64 / STEPS as f64).min(1.0) * closed;
        let lifts = (n as f64 / STEPS as f64 - 1.0).max(0.0) * lift;
        for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
            set(&mut controls, block_of(&solid, names[k]), place(kind, sign * closes, 0.0, lifts).as_slice());
        }
        controls
    };
    let scheme = pick(random, &["backward_euler", "bdf2", "quasi_dynamic"]);
    let controls = (1..=2 * STEPS).map(controls).collect();
    let task = Task::Motion { scheme, begin: Box::new(solid.rest()), dt: 0.02, controls };
    let about = format!(
        "{}{}; {:.2} x {:.2}, {} squeezed by {squeeze:.3} and lifted by {lift:.2}, friction {mu:.2}, {scheme}",
        if rigid { "rigid, " } else { "" },
        stuff.about,
        size[0],
        size[2],
        touching[0].shape.name()
    );
    let mut facts = stuff.facts(density);
    facts.regions[0].rigid = rigid;
    facts.gravity = place(kind, 0.0, 0.0, -GRAVITY);
    facts.touching = touching;
    facts.friction = mu;
    Ok(Problem { about, solid, facts, task })
}

/// Three shapes of a pad on the left (-1) or the right.
fn pad(kind: CellKind, size: [f64; 3], sign: f64) -> [Shape; 3] {
    let face = if sign < 0.0 { -CLEAR } else { size[0] + CLEAR };
    let middle = 0.5 * size[2];
    let at = |across: f64, deep: f64, up: f64| place(kind, across, deep, up);
    let radius = 0.35 * size[2];
    let ball = Shape::Ball { center: at(face + sign * 2.0 * radius, 0.5 * size[1], middle), radius: 2.0 * radius };
    let end = |deep: f64| at(face + sign * radius, deep, middle);
    let capsule = Shape::Capsule {
        ends: [end(0.0), if kind.dim() == 2 { end(0.0) + 1e-3 * Vec3::y() } else { end(size[1]) }],
        radius,
    };
    let (near, far) = (face, face + sign * 0.3);
    let (mut low, mut high) =
        (at(near.min(far), 0.1 * size[1], 0.3 * size[2]), at(near.max(far), 0.9 * size[1], 0.8 * size[2]));
    if kind.dim() == 2 {
        (low.z, high.z) = (-1.0, 1.0);
    }
    [ball, capsule, Shape::Brick { low, high, rounding: 0.04 * size[2] }]
}
