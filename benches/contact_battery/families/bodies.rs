//! Bodies that press each other, that close on themselves, that collide.

use super::parts::{carve, join, shifted};
use super::{Stuff, block, cells, kind, place, sides};
use crate::common::{between, pick};
use crate::problem::{Facts, Failure, Problem, Task};
use nastic::fem::{Contact, Inertia};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::sync::Arc;

/// Distance of two blocks at rest.
const APART: f64 = 0.02;

/// Blocks above each other; the lower one is clamped at its bottom, the upper one moved down at its top by 5 to 12 % of both heights and sideways.
pub fn pushed(random: &mut Random) -> Result<Problem, Failure> {
    let kind = kind(random);
    let heights = [between(random, 0.4, 1.0), between(random, 0.4, 1.0)];
    let width = between(random, 0.5, 1.6);
    let lower = block(kind, [1.0, 1.0, heights[0]], cells(kind, [5, 3, 4]))?;
    let upper = block(kind, [width, 0.9, heights[1]], cells(kind, [4, 4, 3]))?;
    let across = 0.5 - width / 2.0 + between(random, -0.2, 0.2);
    let mesh = join(&[("low", lower), ("up", shifted(upper, place(kind, across, 0.05, heights[0] + APART))?)])?;
    let depth = between(random, 0.05, 0.12) * (heights[0] + heights[1]) + APART;
    let aside = between(random, -0.3, 0.3) * depth;
    let [down, up] = sides(kind);
    let stuff = [Stuff::of(random, kind), Stuff::of(random, kind)];
    let (low_bottom, up_top) = (format!("low {down}"), format!("up {up}"));
    let surfaces = [format!("low {up}"), format!("up {down}")];
    let to = place(kind, aside, 0.3 * aside, -depth);
    let solid = stuff[1].on(stuff[0].on(Solid::new(mesh)?, "low")?, "up")?;
    let solid = solid.clamp(low_bottom.as_str())?.displace(up_top.as_str(), held(kind, to))?;
    let contact = Contact::between("between", surfaces[0].as_str(), surfaces[1].as_str());
    let solid = solid.contact(contact)?;
    let about = format!(
        "lower {}, upper {}; width {width:.2}, heights {:.2} and {:.2}, down by {depth:.3}, aside by {aside:.3}",
        stuff[0].about, stuff[1].about, heights[0], heights[1]
    );
    let facts = Facts {
        regions: vec![stuff[0].region("low", 0.0), stuff[1].region("up", 0.0)],
        pairs: vec![("between".into(), surfaces)],
        held: vec![low_bottom, up_top],
        ..Facts::default()
    };
    let task = Task::Rest(solid.controls());
    Ok(Problem { about, solid, facts, task })
}

/// All components of a displacement.
fn held(kind: CellKind, to: Vec3) -> [Option<f64>; 3] {
    [Some(to.x), Some(to.y), (kind.dim() == 3).then_some(to.z)]
}

/// A C, held at its bottom, whose upper arm is moved down at its end until the slot touches itself and further.
pub fn closing(random: &mut Random) -> Result<Problem, Failure> {
    let kind = pick(random, &[CellKind::Quad4, CellKind::Quad9, CellKind::Tri6, CellKind::Hex8, CellKind::Hex20]);
    let fine = if kind.order() == 2 { 1 } else { 2 };
    let (arm, slot) = (between(random, 0.15, 0.35), between(random, 0.05, 0.15));
    let full = block(kind, [1.0, 0.3, 1.0], [8 * fine, fine, 10])?;
    // rows of the grid: two arms of four rows with two rows between, whatever their heights
    let level = |y: f64| {
        let row = 10.0 * y;
        if row <= 4.0 {
            row / 4.0 * arm
        } else if row <= 6.0 {
            arm + (row - 4.0) / 2.0 * slot
        } else {
            arm + slot + (row - 6.0) / 4.0 * arm
        }
    };
    let up = if kind.dim() == 2 { 1 } else { 2 };
    let full = full.mapped(|mut x| {
        x[up] = level(x[up]);
        x
    })?;
    let (begin, height) = (0.25, 2.0 * arm + slot);
    let in_slot = move |x: Vec3| x.x > begin && x[up] > arm + 1e-9 && x[up] < arm + slot - 1e-9;
    let near = 1e-9;
    let on_slot =
        move |x: Vec3| x.x > begin - near && x[up] > arm - near && x[up] < arm + slot + near && x.x < 1.0 - near;
    let top = move |x: Vec3| x[up] > height - near && x.x > 0.8;
    let mesh = carve(&full, |x| !in_slot(x), &[("slot", &on_slot), ("bottom", &move |x| x[up] < near), ("top", &top)])?;
    let stuff = Stuff::of(random, kind);
    let depth = slot * between(random, 0.9, 1.4);
    let mut to = [Some(0.0), Some(0.0), (kind.dim() == 3).then_some(0.0)];
    (to[0], to[up]) = (None, Some(-depth));
    let solid = stuff.on(Solid::new(mesh)?, "body")?.clamp("bottom")?.displace("top", to)?;
    let solid = solid.contact(Contact::between("slot", "slot", "slot"))?;
    let about = format!("{}; arms {arm:.2}, slot {slot:.3}, down by {depth:.3}", stuff.about);
    let mut facts = stuff.facts(0.0);
    facts.pairs.push(("slot".into(), ["slot".into(), "slot".into()]));
    facts.held.extend(["bottom".into(), "top".into()]);
    let task = Task::Rest(solid.controls());
    Ok(Problem { about, solid, facts, task })
}

/// Steps of a collision.
const STEPS: usize = 30;

/// Two free blocks, one thrown at the other.
pub fn colliding(random: &mut Random) -> Result<Problem, Failure> {
    let kind = pick(random, &[CellKind::Quad4, CellKind::Quad9, CellKind::Tri6, CellKind::Hex8, CellKind::Tet4]);
    let size = [between(random, 0.3, 0.8), between(random, 0.3, 0.8)];
    let lower = block(kind, [0.6, 0.6, size[0]], cells(kind, [4, 3, 4]))?;
    let upper = block(kind, [0.4, 0.5, size[1]], cells(kind, [3, 3, 4]))?;
    let (across, apart) = (between(random, -0.2, 0.4), 0.03);
    let mesh = join(&[("low", lower), ("up", shifted(upper, place(kind, across, 0.05, size[0] + apart))?)])?;
    let stuff = [Stuff::of(random, kind), Stuff::of(random, kind)];
    let [down, up] = sides(kind);
    let surfaces = [format!("low {up}"), format!("up {down}")];
    let density = 1000.0;
    // of the speed of waves in the softer one
    let wave = (stuff[0].young.min(stuff[1].young) / density).sqrt();
    let (speed, aside) = (between(random, 0.02, 0.15) * wave, between(random, -0.3, 0.3));
    let mu = if random.unit() < 0.4 { between(random, 0.1, 1.0) } else { 0.0 };
    let contact = Contact::between("between", surfaces[0].as_str(), surfaces[1].as_str());
    let contact = if mu > 0.0 { contact.friction(mu, 0.05 * speed) } else { contact };
    let solid = stuff[1].on(stuff[0].on(Solid::new(mesh)?, "low")?, "up")?.contact(contact)?;
    let solid = solid.inertia(Inertia::new("low", density).and("up", density))?;
    let scheme = pick(random, &["backward_euler", "bdf2", "tr_bdf2"]);
    let nodes = solid.mesh().points().iter();
    let velocity: Vec<f64> = nodes
        .flat_map(|x| {
            let x = Vec3::from(*x);
            let above = if kind.dim() == 2 { x.y } else { x.z } > size[0] + 0.5 * apart;
            let v = if above { place(kind, aside * speed, 0.0, -speed) } else { Vec3::zeros() };
            v.as_slice()[..kind.dim()].to_vec()
        })
        .collect();
    let begin = Box::new(State { velocity: Some(Arc::new(velocity)), ..solid.rest() });
    let dt = (apart / speed + 2.0 * (size[0] + size[1]) / wave) / STEPS as f64;
    let about = format!(
        "lower {}, upper {}; heights {:.2} and {:.2}, {speed:.2} m/s, aside {aside:.2} of it, {scheme}{}",
        stuff[0].about,
        stuff[1].about,
        size[0],
        size[1],
        if mu > 0.0 { format!(", friction {mu:.2}") } else { String::new() }
    );
    let facts = Facts {
        regions: vec![stuff[0].region("low", density), stuff[1].region("up", density)],
        pairs: vec![("between".into(), surfaces)],
        friction: mu,
        ..Facts::default()
    };
    let task = Task::Motion { scheme, begin, dt, controls: vec![solid.controls(); STEPS] };
    Ok(Problem { about, solid, facts, task })
}
