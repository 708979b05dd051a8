//! Blocks that are held at the bottom and pushed by an obstacle from above: in one static solve, with friction in ten quasi-static steps, by
//! multigrid.

use super::{Stuff, block, cells, kind, place, set, sides};
use crate::common::{between, pick};
use crate::judge::shape::Shape;
use crate::problem::{Failure, Problem, Task, Touching, block as block_of};
use nastic::fem::{Contact, Solver};
use nastic::numeric::Random;
use nastic::prelude::*;

/// Steps of a problem with friction.
const STEPS: usize = 10;
/// Distance of an obstacle before it moves.
pub const CLEAR: f64 = 0.05;

pub fn pushed(random: &mut Random, friction: bool) -> Result<Problem, Failure> {
    let kind = kind(random);
    let height = between(random, 0.3, 1.5);
    let up = (2.0 + 4.0 * height) as usize;
    let grid = if kind.dim() == 2 { [6, 1, up] } else { [4, 4, up.min(4)] };
    let mesh = block(kind, [1.0, 1.0, height], grid)?;
    problem(random, (kind, mesh, height), friction, None)
}

pub fn by_multigrid(random: &mut Random) -> Result<Problem, Failure> {
    let kind = pick(random, &[CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10]);
    let height = between(random, 0.4, 1.0);
    let mesh = block(kind, [1.0, 1.0, height], cells(kind, [8, 8, 6]))?;
    problem(random, (kind, mesh, height), false, Some(Solver::MULTIGRID))
}

fn problem(
    random: &mut Random,
    (kind, mesh, height): (CellKind, Mesh, f64),
    friction: bool,
    solver: Option<&'static dyn nastic::fem::SolverFactory>,
) -> Result<Problem, Failure> {
    let [bottom, top] = sides(kind);
    let stuff = Stuff::of(random, kind);
    let depth = between(random, 0.02, 0.3) * height;
    let sideways = between(random, -0.5, 0.5) * depth;
    let shape = shape(random, kind, height + CLEAR);
    let mu = if friction { between(random, 0.1, 1.0) } else { 0.0 };
    let centre = place(kind, 0.5, 0.5, height + 0.5);
    let contact = Contact::of("contact", top, shape.obstacle(kind.dim())?).about(centre.into());
    let contact = if friction { contact.friction(mu, 0.01) } else { contact };
    let solid = stuff.on(Solid::new(mesh)?, "body")?.clamp(bottom)?.contact(contact)?;
    let solid = solver.map_or_else(|| solid.clone(), |solver| solid.clone().solver(solver));
    let way = place(kind, sideways, 0.3 * sideways, -depth - CLEAR);
    let at = |share: f64| {
        let mut controls = solid.controls();
        set(&mut controls, block_of(&solid, "contact"), (share * way).as_slice());
        controls
    };
    let task = match friction {
        false => Task::Rest(at(1.0)),
        true => Task::Motion {
            scheme: "quasi_static",
            begin: Box::new(solid.rest()),
            dt: 0.1,
            controls: (1..=STEPS).map(|n| at(n as f64 / STEPS as f64)).collect(),
        },
    };
    let about = format!(
        "{}; height {height:.2}; {} goes in by {depth:.3} and aside by {sideways:.3}{}",
        stuff.about,
        shape.name(),
        if friction { format!(", friction {mu:.2}") } else { String::new() }
    );
    let mut facts = stuff.facts(0.0);
    facts.friction = mu;
    facts.held.push(bottom.to_owned());
    facts.touching.push(Touching { name: "contact".into(), surface: top.into(), shape, centre });
    Ok(Problem { about, solid, facts, task })
}

/// One above the middle of a unit block's top, whose lowest place is this high.
pub fn shape(random: &mut Random, kind: CellKind, gap: f64) -> Shape {
    let size = between(random, 0.1, 1.0);
    let across = between(random, 0.3, 0.7);
    let at = |across: f64, deep: f64, up: f64| place(kind, across, deep, up);
    let (mut low, mut high) = (at(across - size, 0.5 - size, gap), at(across + size, 0.5 + size, gap + size));
    match pick(random, &["half-space", "sphere", "capsule", "box", "solid"]) {
        "half-space" => {
            let tilt = between(random, -0.1, 0.1);
            Shape::HalfSpace { point: at(0.5, 0.5, gap + 0.05), normal: at(tilt, 0.5 * tilt, -1.0) }
        }
        "sphere" => Shape::Ball { center: at(across, 0.5, gap + size), radius: size },
        "capsule" => Shape::Capsule {
            ends: [at(across - size, 0.2, gap + size), at(across + size, 0.8, gap + size)],
            radius: size,
        },
        "box" => {
            if kind.dim() == 2 {
                (low.z, high.z) = (-size, size);
            }
            Shape::Brick { low, high, rounding: 0.05 * size }
        }
        _ => {
            let rounding = 0.02;
            let up = at(0.0, 0.0, rounding);
            Shape::Meshed { low: low + up, high: high + up, rounding }
        }
    }
}
