//! Blocks that are held at their top, pressed on something and dragged over it, in quasi-static steps.

use super::{Stuff, block, cells, kind, place, set, sides};
use crate::common::{between, pick};
use crate::judge::shape::Shape;
use crate::problem::{Chamber, Failure, Problem, Task, Touching, block as block_of};
use nastic::fem::{Contact, MovingSupport};
use nastic::numeric::Random;
use nastic::prelude::*;

/// Steps down, and along.
const STEPS: [usize; 2] = [5, 15];

pub fn dragged(random: &mut Random) -> Result<Problem, Failure> {
    let kind = kind(random);
    let height = between(random, 0.3, 0.8);
    let hollow = kind.dim() == 2 && random.unit() < 0.4;
    let full = block(kind, [1.0, 0.6, height], if hollow { [6, 1, 6] } else { cells(kind, [6, 3, 4]) })?;
    let [bottom, top] = sides(kind);
    let inside = |x: Vec3| (x.x - 0.5).abs() < 0.17 && (x.y / height - 0.5).abs() < 0.17;
    let mesh = match hollow {
        false => full,
        true => {
            let near = 1e-6;
            let on_wall = |x: Vec3| (x.x - 0.5).abs() < 0.17 + near && (x.y / height - 0.5).abs() < 0.17 + near;
            let lies = |x: Vec3| x.y < near;
            let above = move |x: Vec3| x.y > height - near;
            super::parts::carve(&full, |x| !inside(x), &[("wall", &on_wall), ("y-", &lies), ("y+", &above)])?
        }
    };
    let stuff = Stuff::of(random, kind);
    let mu = between(random, 0.1, 1.0);
    let depth = between(random, 0.02, 0.1) * height;
    let way = between(random, 0.1, 0.5);
    let at = |across: f64, up: f64| place(kind, across, 0.3, up);
    let shape = ground(random, kind);
    let centre = at(0.5, -1.0);
    let contact = Contact::of("ground", bottom, shape.obstacle(kind.dim())?).about(centre.into());
    let mut solid = stuff.on(Solid::new(mesh)?, "body")?.motion(MovingSupport::of("top", top))?;
    solid = solid.contact(contact.friction(mu, 0.01))?;
    let by_volume = random.unit() < 0.5;
    if hollow {
        let cavity = Cavity::new("room", "wall");
        solid = solid.cavity(if by_volume { cavity.by_volume() } else { cavity })?;
    }
    let filled = if by_volume { 0.02 * height } else { 0.02 * stuff.young };
    let step = |n: usize| {
        let mut controls = solid.controls();
        let down = (n as f64 / STEPS[0] as f64).min(1.0);
        let along = (n as f64 - STEPS[0] as f64).max(0.0) / STEPS[1] as f64 * way;
        set(&mut controls, block_of(&solid, "top"), place(kind, along, 0.0, -down * (depth + 0.01)).as_slice());
        if hollow {
            set(&mut controls, block_of(&solid, "room"), &[down * filled]);
        }
        controls
    };
    let controls = (1..=STEPS[0] + STEPS[1]).map(step).collect();
    let task = Task::Motion { scheme: "quasi_static", begin: Box::new(solid.rest()), dt: 0.1, controls };
    let about = format!(
        "{}{}; height {height:.2}, pressed by {depth:.3} on {}, dragged by {way:.2}, friction {mu:.2}",
        stuff.about,
        if !hollow {
            ""
        } else if by_volume {
            ", a chamber by volume"
        } else {
            ", a chamber under pressure"
        },
        shape.name()
    );
    let mut facts = stuff.facts(0.0);
    facts.held.push(top.to_owned());
    facts.friction = mu;
    facts.touching.push(Touching { name: "ground".into(), surface: bottom.into(), shape, centre });
    facts.chamber = hollow.then(|| Chamber { name: "room".into(), surface: "wall".into(), by_volume });
    Ok(Problem { about, solid, facts, task })
}

/// A plane, a sphere or a meshed box just below.
fn ground(random: &mut Random, kind: CellKind) -> Shape {
    let at = |across: f64, up: f64| place(kind, across, 0.3, up);
    let radius = between(random, 0.5, 1.5);
    match pick(random, &["plane", "sphere", "solid"]) {
        "plane" => Shape::HalfSpace { point: at(0.0, -0.01), normal: place(kind, 0.0, 0.0, 1.0) },
        "sphere" => Shape::Ball { center: at(between(random, 0.3, 0.7), -0.01 - radius), radius },
        _ => Shape::Meshed { low: place(kind, -4.0, -4.0, -1.0), high: place(kind, 5.0, 5.0, -0.03), rounding: 0.02 },
    }
}
