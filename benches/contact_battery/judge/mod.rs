//! An independent judge of solved problems: it takes from the program the mesh, the states and what is reported of them, and computes the rest
//! itself: shape functions, rules, stresses, masses, distances, crossings.

mod contact;
mod crossing;
mod elasticity;
mod element;
mod energy;
pub mod law;
mod motion;
mod scene;
pub mod shape;
pub mod spoiled;
pub mod stability;

use crate::problem::{Failure, Problem};
use crate::solve::Solved;
use nastic::fem::{Instant, TimeStep, Touch};
use nastic::prelude::*;
use scene::{Forces, Scene};
use spoiled::Spoil;
use std::collections::{BTreeMap, BTreeSet};

/// What was looked at: how far it is off, and how far it may be. Where it is more, the answer is wrong.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    pub name: &'static str,
    pub off: f64,
    pub most: f64,
}

impl Check {
    pub fn fails(&self) -> bool {
        self.off.is_nan() || self.off > self.most
    }
}

/// Residuals over the sum of the sizes of the forces of cells.
const EQUILIBRIUM: f64 = 1e-8;
/// Of distances kept by rigid bodies and of volumes, over their size.
const GEOMETRY: f64 = 1e-8;
/// Of energies that both compute, over their largest value.
const ENERGY: f64 = 1e-8;

/// The worst of every check over the states of a run.
#[derive(Default)]
struct Found(BTreeMap<&'static str, Check>);

impl Found {
    fn add(&mut self, name: &'static str, off: f64, most: f64) {
        let check = Check { name, off, most };
        let worst = self.0.entry(name).or_insert(check);
        if check.off.is_nan() || check.off / check.most > worst.off / worst.most {
            *worst = check;
        }
    }
}

/// A state with what both say of it.
struct At<'a> {
    state: &'a State,
    before: Option<&'a State>,
    u: Vec<Vec3>,
    forces: Forces,
    touches: Vec<(String, Touch)>,
    /// Of all contacts with obstacles.
    carried: Vec3,
}

/// All checks that apply, each with its worst state; of reports that are spoiled, if any are.
///
/// # Errors
/// What the program does not report of its own answer.
pub fn checks(problem: &Problem, solved: &Solved, spoil: Option<Spoil>) -> Result<Vec<Check>, Failure> {
    let scene = Scene::new(problem).ok_or("the judge does not know a region or an element")?;
    let mut found = Found::default();
    let first = usize::from(solved.scheme.is_some());
    let sets = Sets::of(&scene);
    for n in first..solved.states.len() {
        let before = n.checked_sub(1).map(|n| &solved.states[n]);
        let mut at = at(&scene, solved, before, &solved.states[n])?;
        at.spoil(&scene, spoil);
        balance(&scene, &sets, &at, &mut found)?;
        contact::check(&scene, &at, &mut found);
        geometry(&scene, &at, &mut found)?;
    }
    if let Some(scheme) = &solved.scheme {
        motion::check(&scene, solved, scheme, &mut found);
        energy::check(&scene, solved, scheme, &mut found)?;
    }
    Ok(found.0.into_values().collect())
}

impl At<'_> {
    fn spoil(&mut self, scene: &Scene, spoil: Option<Spoil>) {
        let Some(spoil) = spoil else { return };
        let parameters = scene.problem.solid.model().contacts().parameters();
        for ((name, touch), (_, of)) in self.touches.iter_mut().zip(&parameters) {
            let before = Vec3::from(touch.force);
            spoil.touch(touch, of.thickness);
            if scene.facts().touching.iter().any(|touching| touching.name == *name) {
                self.carried += Vec3::from(touch.force) - before;
            }
        }
    }
}

fn at<'a>(scene: &Scene, solved: &Solved, before: Option<&'a State>, state: &'a State) -> Result<At<'a>, Failure> {
    let model = scene.problem.solid.model();
    let step = before.map(|before| TimeStep::between(before, state));
    let instant = Instant::of(state);
    let instant = step.as_ref().map_or(instant, |step| instant.in_step(step));
    let u = scene.vectors(&model.displacement(&state.u));
    let moves = solved.scheme.as_ref().is_some_and(|scheme| !scheme.is_quasi_static());
    let acceleration = state.acceleration.as_ref().filter(|_| moves).map(|a| scene.vectors(a));
    if moves && acceleration.is_none() {
        return Err("a state of a motion without acceleration".into());
    }
    let mut forces = scene.forces(&u, acceleration.as_deref(), pressure(scene, &instant)?);
    let touches = model.contacts().touches(&instant);
    // of a rigid body obstacles may press against each other alone
    forces.scale += touches.iter().map(|(_, touch)| touch.pressing).sum::<f64>();
    let of_obstacle = |name: &str| scene.facts().touching.iter().any(|touching| touching.name == name);
    let carried = touches.iter().filter(|(name, _)| of_obstacle(name)).map(|(_, touch)| Vec3::from(touch.force)).sum();
    Ok(At { state, before, u, forces, touches, carried })
}

fn pressure(scene: &Scene, at: &Instant) -> Result<f64, Failure> {
    let Some(chamber) = &scene.facts().chamber else { return Ok(0.0) };
    let all = scene.problem.solid.model().quantities(at)?;
    let own = all.iter().find(|(name, what, _)| *name == chamber.name && *what == "pressure");
    own.map(|own| own.2).ok_or_else(|| "no pressure of a chamber".into())
}

/// Who bears what is left of the forces on nodes.
struct Sets {
    held: BTreeSet<usize>,
    touching: BTreeSet<usize>,
    rigid: BTreeSet<usize>,
}

impl Sets {
    fn of(scene: &Scene) -> Self {
        let facts = scene.facts();
        let pairs = facts.pairs.iter().flat_map(|(_, surfaces)| surfaces);
        let surfaces = facts.touching.iter().map(|touching| &touching.surface).chain(pairs);
        let mut all = Sets {
            held: facts.held.iter().flat_map(|name| scene.nodes_of(name)).collect(),
            touching: surfaces.flat_map(|name| scene.nodes_of(name)).collect(),
            rigid: scene.rigid_nodes().into_iter().flat_map(|(_, nodes)| nodes).collect(),
        };
        // a node of a support that touches too bears both
        all.touching.retain(|node| !all.held.contains(node));
        all
    }
}

/// Equilibrium of nodes that nothing touches, of what touches, and of the body with what is reported of supports and contacts.
fn balance(scene: &Scene, sets: &Sets, at: &At, found: &mut Found) -> Result<(), Failure> {
    let Forces { rest, scale, loads, inertia, .. } = &at.forces;
    let bears = |node: &usize| !(sets.held.contains(node) || sets.touching.contains(node) || sets.rigid.contains(node));
    let free: f64 = (0..rest.len()).filter(bears).map(|node| rest[node].norm_squared()).sum();
    found.add("equilibrium", free.sqrt() / scale, EQUILIBRIUM);
    let x = |node: usize| scene.places[node] + at.u[node];
    if scene.facts().held.is_empty() {
        // nothing but obstacles bears anything
        let total: Vec3 = rest.iter().sum();
        found.add("force of obstacles", (total - at.carried).norm() / scale, EQUILIBRIUM);
    } else {
        let reactions = scene.problem.solid.reactions(at.before, at.state)?;
        let held: Vec3 = reactions.iter().map(|(_, force)| Vec3::from(*force)).sum();
        let outer: Vec3 = loads.iter().sum::<Vec3>() - inertia.iter().sum::<Vec3>();
        found.add("balance of forces", (held + outer + at.carried).norm() / scale, EQUILIBRIUM);
    }
    let facts = scene.facts();
    for (name, surfaces) in &facts.pairs {
        let Some((_, touch)) = at.touches.iter().find(|(own, _)| own == name) else { continue };
        let of = |surface: &str| -> (Vec3, Vec3) {
            let nodes = scene.nodes_of(surface);
            let force = nodes.iter().map(|node| rest[*node]).sum();
            (force, nodes.iter().map(|node| x(*node).cross(&rest[*node])).sum())
        };
        let alone = facts.touching.is_empty() && sets.rigid.is_empty();
        if alone && surfaces[0] == surfaces[1] {
            let (force, moment) = of(&surfaces[0]);
            found.add("a surface on itself", (force.norm() + moment.norm() / scene.size()) / scale, EQUILIBRIUM);
        } else if alone {
            let [(own, turn), (other, back)] = [of(&surfaces[0]), of(&surfaces[1])];
            found.add("force on the first surface", (own - Vec3::from(touch.force)).norm() / scale, EQUILIBRIUM);
            found.add("equal and opposite", (own + other).norm() / scale, EQUILIBRIUM);
            found.add("equal moments", (turn + back).norm() / (scale * scene.size()), EQUILIBRIUM);
        }
    }
    Ok(())
}

/// Rigid regions keep their distances, chambers have the room that is reported and wanted.
fn geometry(scene: &Scene, at: &At, found: &mut Found) -> Result<(), Failure> {
    let x = |node: usize| scene.places[node] + at.u[node];
    for (_, nodes) in scene.rigid_nodes() {
        let some: Vec<usize> = nodes.iter().copied().step_by((nodes.len() / 5).max(1)).collect();
        let off = |a: usize, b: usize| ((x(a) - x(b)).norm() - (scene.places[a] - scene.places[b]).norm()).abs();
        let most = nodes.iter().flat_map(|a| some.iter().map(move |b| off(*a, *b))).fold(0.0, f64::max);
        found.add("distances in a rigid body", most / scene.size(), GEOMETRY);
    }
    if let Some(chamber) = &scene.facts().chamber {
        let own = scene.room(chamber, &at.u);
        let all = scene.problem.solid.model().quantities(&Instant::of(at.state))?;
        let told = all.iter().find(|(name, what, _)| *name == chamber.name && *what == "volume").map(|found| found.2);
        found.add("room of a chamber", (own / told.unwrap_or(f64::NAN) - 1.0).abs(), GEOMETRY);
        if chamber.by_volume {
            let rest = scene.room(chamber, &vec![Vec3::zeros(); at.u.len()]);
            let added =
                crate::problem::block(&scene.problem.solid, &chamber.name).map(|k| at.state.controls.values(k)[0]);
            found.add("volume that is given", ((own - rest - added.unwrap_or(f64::NAN)) / rest).abs(), GEOMETRY);
        }
    }
    Ok(())
}
