//! [`Supports`]: prescribed unknowns.

use crate::contribution::tied::Tied;
use crate::error::FemError;
use nastic_linear::Ties;
use nastic_mesh::Mesh;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// How far nodes that follow others may be off, as a share of the largest entry: rounding.
const ON_TIES: f64 = 1e-9;

/// The names of displacement components.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Prescribed unknowns on nodes (Dirichlet): displacement components, and those of further fields; and nodes that follow others.
#[derive(Debug, Clone, PartialEq)]
pub struct Supports {
    pub(super) dim: usize,
    /// Unknowns per node, those of the displacement first.
    pub block: usize,
    fixed: Vec<bool>,
    value: Vec<f64>,
    /// Unknowns whose value is a function of controls, by the name of what drives them; `value` is 0 there.
    driven: BTreeMap<u32, String>,
    /// Nodes that motions lead though supports hold them, by the names of both.
    led: BTreeMap<(String, String), BTreeSet<u32>>,
    /// Supported unknowns by the name of the surface or node set, for reactions.
    groups: Vec<(String, Vec<u32>)>,
    /// Nodes that follow others.
    ties: Ties,
    /// All nodes of what is tied, with the components, by its name: nothing else may hold them.
    tied: BTreeMap<(u32, usize), String>,
}

impl Supports {
    /// Without any.
    pub fn new(mesh: &Mesh) -> Self {
        let dofs = mesh.points().len() * mesh.dim();
        Supports {
            dim: mesh.dim(),
            block: mesh.dim(),
            fixed: vec![false; dofs],
            value: vec![0.0; dofs],
            driven: BTreeMap::new(),
            led: BTreeMap::new(),
            groups: vec![],
            ties: Ties::default(),
            tied: BTreeMap::new(),
        }
    }

    /// Prescribes components (`None` stays free) at the nodes.
    pub fn prescribe(&mut self, name: &str, nodes: &[u32], values: [Option<f64>; 3]) -> Result<(), FemError> {
        if let Some(c) = (self.dim..3).find(|&c| values[c].is_some_and(|v| v != 0.0)) {
            let what =
                format!("support on \"{name}\" moves component {} of a plane-strain body; leave it out", AXES[c]);
            return Err(FemError::Meaningless { what });
        }
        for (c, value) in values.iter().enumerate().take(self.dim) {
            if let Some(value) = *value {
                self.hold(name, nodes, c, AXES[c], value)?;
            }
        }
        if values.iter().all(Option::is_none) {
            self.group(name);
        }
        Ok(())
    }

    /// Holds a component of the nodes' blocks at a value.
    pub fn hold(
        &mut self,
        name: &str,
        nodes: &[u32],
        place: usize,
        component: &str,
        value: f64,
    ) -> Result<(), FemError> {
        if !value.is_finite() {
            let what = format!("displacement prescribed on \"{name}\"");
            return Err(FemError::NotFinite { what, index: place, value });
        }
        let mut new = Vec::new();
        for &node in nodes {
            let dof = node as usize * self.block + place;
            if let Some(other) = self.tied.get(&(node, place)) {
                return Err(self.held_and_tied(name, other, node, place));
            }
            if let Some(driver) = self.driven.get(&(dof as u32)) {
                if place >= self.dim {
                    let what = format!(
                        "\"{name}\" holds node {node}, to which \"{driver}\" gives a value already: let one of them go"
                    );
                    return Err(FemError::Meaningless { what });
                }
                // the motion leads what both hold
                let driver = driver.clone();
                self.led(driver, name, node);
                continue;
            }
            if self.fixed[dof] && self.value[dof] != value {
                return Err(FemError::SupportConflict {
                    support: name.to_owned(),
                    node: node as usize,
                    component: component.to_owned(),
                    old: self.value[dof],
                    new: value,
                });
            }
            self.fixed[dof] = true;
            self.value[dof] = value;
            new.push(dof as u32);
        }
        self.group(name).extend(new);
        Ok(())
    }

    /// Refuses a support of which motions leave nothing.
    pub fn check_left(&self, name: &str) -> Result<(), FemError> {
        let left = self.groups.iter().any(|(own, dofs)| own == name && !dofs.is_empty());
        match self.led.iter().find(|((_, support), _)| support == name && !left) {
            None => Ok(()),
            Some(((motion, _), nodes)) => {
                Err(led_wholly(motion, name, nodes.first().copied().unwrap_or_default() as usize))
            }
        }
    }

    fn led(&mut self, motion: String, support: &str, node: u32) {
        self.led.entry((motion, support.to_owned())).or_default().insert(node);
    }

    /// Nodes that a motion and a support both hold, which the motion leads in the components that both have: its name, that of the support, how many.
    pub fn shared_with_motions(&self) -> impl Iterator<Item = (&str, &str, usize)> {
        self.led.iter().map(|((motion, support), nodes)| (motion.as_str(), support.as_str(), nodes.len()))
    }

    /// The unknowns of the supports of a name.
    fn group(&mut self, name: &str) -> &mut Vec<u32> {
        let known = self.groups.iter().position(|(known, _)| known == name);
        let at = known.unwrap_or_else(|| {
            self.groups.push((name.to_owned(), Vec::new()));
            self.groups.len() - 1
        });
        &mut self.groups[at].1
    }

    /// Makes room for further components behind those that a node has.
    pub fn widen(&mut self, block: usize) {
        if block == self.block {
            return;
        }
        let all: Vec<usize> = (0..self.block).collect();
        *self = self.relaid(block, |dof| Some(dof / all.len() * block + dof % all.len()));
    }

    /// Those of some of the components of every node, which become its block.
    pub fn restricted(&self, components: &[usize]) -> Self {
        let block = self.block;
        self.relaid(components.len(), |dof| {
            let place = components.iter().position(|c| *c == dof % block)?;
            Some(dof / block * components.len() + place)
        })
    }

    /// The same in blocks of another size; `place` is where an unknown goes, if it stays.
    fn relaid(&self, block: usize, place: impl Fn(usize) -> Option<usize>) -> Self {
        let dofs = self.fixed.len() / self.block * block;
        let (mut fixed, mut value) = (vec![false; dofs], vec![0.0; dofs]);
        for (dof, to) in (0..self.fixed.len()).filter_map(|dof| Some((dof, place(dof)?))) {
            (fixed[to], value[to]) = (self.fixed[dof], self.value[dof]);
        }
        let moved = |dof: &u32| place(*dof as usize).map(|to| to as u32);
        let driven = self.driven.iter().filter_map(|(dof, name)| Some((moved(dof)?, name.clone()))).collect();
        let group = |(name, dofs): &(String, Vec<u32>)| (name.clone(), dofs.iter().filter_map(moved).collect());
        let groups = self.groups.iter().map(group).collect();
        let (ties, tied, led) = (self.ties.clone(), self.tied.clone(), self.led.clone());
        Supports { dim: self.dim, block, fixed, value, driven, led, groups, ties, tied }
    }

    /// Holds unknowns at values that are functions of controls.
    pub fn drive(&mut self, name: &str, dofs: &[u32]) -> Result<(), FemError> {
        if self.groups.iter().any(|(known, _)| known == name) {
            let what = format!(
                "a motion and a support are both named \"{name}\", by which reactions are told; rename the motion"
            );
            return Err(FemError::Meaningless { what });
        }
        for &dof in dofs {
            let (node, c) = (dof as usize / self.block, dof as usize % self.block);
            if let Some(other) = self.tied.get(&(node as u32, c)) {
                return Err(self.held_and_tied(name, other, node as u32, c));
            }
            if let Some(other) = self.driven.get(&dof) {
                let what =
                    format!("motion \"{name}\" moves node {node}, which \"{other}\" moves too; let one of them go");
                return Err(FemError::Meaningless { what });
            }
            if c >= self.dim && self.fixed[dof as usize] {
                let what = format!(
                    "\"{name}\" gives a value to node {node}, which \"{}\" holds already: let one of them go",
                    self.holder(node as u32, c)
                );
                return Err(FemError::Meaningless { what });
            }
        }
        for &dof in dofs.iter().filter(|dof| self.fixed[**dof as usize]).collect::<Vec<_>>() {
            let (node, c) = (dof / self.block as u32, dof as usize % self.block);
            let support = self.holder(node, c).to_owned();
            self.groups.iter_mut().for_each(|(_, group)| group.retain(|own| *own != dof));
            self.value[dof as usize] = 0.0;
            self.led(name.to_owned(), &support, node);
        }
        let supports: BTreeSet<String> = self.led.keys().map(|(_, support)| support.clone()).collect();
        supports.iter().try_for_each(|support| self.check_left(support))?;
        for &dof in dofs {
            self.fixed[dof as usize] = true;
            self.driven.insert(dof, name.to_owned());
        }
        self.groups.push((name.to_owned(), dofs.to_vec()));
        Ok(())
    }

    /// Lets nodes follow others in some components.
    pub fn tie(&mut self, name: &str, components: Range<usize>, tied: &Tied) -> Result<(), FemError> {
        let Tied { masters, implied, follows, .. } = tied;
        let of_displacement = components.end <= self.dim;
        let nodes: Vec<u32> = masters.iter().copied().chain(follows.iter().map(|(node, _)| *node)).collect();
        for &node in &nodes {
            if let Some(other) = components.clone().find_map(|c| self.tied.get(&(node, c))) {
                let what = format!(
                    "node {node} belongs to \"{name}\" and to \"{other}\": let them share no node, or make one of both"
                );
                return Err(FemError::Meaningless { what });
            }
            // supports of a rigid body go to those that its nodes follow
            let handed = |c: usize| of_displacement && self.holds_at_rest(self.dof(node, c));
            if let Some(c) = components.clone().find(|&c| self.holds(node, c) && !handed(c)) {
                return Err(self.held_and_tied(self.holder(node, c), name, node, c));
            }
        }
        for (node, c) in implied {
            self.hold_implied(masters, *node, *c);
        }
        for (node, weights) in follows {
            for c in components.clone() {
                if self.holds(*node, c) {
                    self.hand_over(name, *node, c, weights)?;
                }
            }
        }
        let count = self.fixed.len() / self.block;
        let ties = self.ties.clone();
        let ties = if of_displacement { ties.mixing(masters.clone()) } else { ties };
        self.ties = ties.with(count, components.clone(), follows.clone()).ok_or_else(|| {
            let what = format!("\"{name}\" lets a node follow one that follows another, or that does not exist");
            FemError::Meaningless { what }
        })?;
        let all = nodes.iter().flat_map(|&node| components.clone().map(move |c| (node, c)));
        self.tied.extend(all.map(|at| (at, name.to_owned())));
        Ok(())
    }

    /// Holds a component of a corner for the supports that hold it at others.
    fn hold_implied(&mut self, masters: &[u32], node: u32, c: usize) {
        let own = self.dof(node, c);
        let others: Vec<u32> = masters.iter().map(|&other| self.dof(other, c) as u32).collect();
        self.fixed[own] = true;
        let holding = self.groups.iter_mut().find(|(_, group)| others.iter().any(|other| group.contains(other)));
        if let Some((_, group)) = holding {
            group.push(own as u32);
        }
    }

    /// Lets the nodes that a held one follows be held in its place; they have to be so.
    fn hand_over(&mut self, name: &str, node: u32, c: usize, weights: &[(u32, f64)]) -> Result<(), FemError> {
        let followed: Vec<u32> =
            weights.iter().filter(|(_, weight)| weight.abs() > ON_TIES).map(|(node, _)| *node).collect();
        if let Some(free) = followed.iter().find(|master| !self.holds(**master, c)) {
            let what = format!(
                "\"{}\" holds {} of node {node} of the rigid body \"{name}\", which follows node {free} that is not held in it: of a rigid body supports \
                 can hold points, lines or planes of nodes of one simplex (planes of symmetry, a hinge, a joint); let one of them go, or hold it by springs",
                self.holder(node, c),
                AXES[c]
            );
            return Err(FemError::Meaningless { what });
        }
        let (block, own) = (self.block as u32, node * self.block as u32 + c as u32);
        self.fixed[own as usize] = false;
        for (_, group) in self.groups.iter_mut().filter(|(_, group)| group.contains(&own)) {
            group.retain(|dof| *dof != own);
            group.extend(followed.iter().map(|master| master * block + c as u32));
        }
        Ok(())
    }

    fn held_and_tied(&self, support: &str, other: &str, node: u32, c: usize) -> FemError {
        if c < self.dim {
            return held_and_rigid(support, other, node);
        }
        let what = format!(
            "\"{support}\" holds node {node}, whose value \"{other}\" makes one with that of others: let one of them go"
        );
        FemError::Meaningless { what }
    }

    fn dof(&self, node: u32, c: usize) -> usize {
        node as usize * self.block + c
    }

    /// Whether a component of the displacement of a node is held.
    pub fn holds(&self, node: u32, c: usize) -> bool {
        self.fixed[self.dof(node, c)]
    }

    /// The name of what holds it.
    fn holder(&self, node: u32, c: usize) -> &str {
        let dof = self.dof(node, c) as u32;
        let holds = |(_, group): &&(String, Vec<u32>)| group.contains(&dof);
        self.groups.iter().find(holds).map_or("", |(support, _)| support)
    }

    /// What ties the displacement of a node to that of others, if it is tied.
    pub fn body_of(&self, node: u32) -> Option<&str> {
        self.tied.get(&(node, 0)).map(String::as_str)
    }

    /// The name of what keeps a component of the displacement of a node from being free, if something does: a support, a motion, a rigid body.
    pub fn keeper(&self, node: u32, c: usize) -> Option<&str> {
        let driver = self.driven.get(&(self.dof(node, c) as u32)).or_else(|| self.tied.get(&(node, c)));
        driver.map(String::as_str).or_else(|| self.holds(node, c).then(|| self.holder(node, c)))
    }

    /// Whether something with these slopes by unknowns of the displacement can change: not where supports hold them all, nor in one rigid body.
    pub fn lets_change(&self, slopes: impl Iterator<Item = (usize, f64)>) -> bool {
        let acting: Vec<usize> = slopes.filter(|(_, slope)| *slope != 0.0).map(|(dof, _)| dof).collect();
        let bodies: BTreeSet<Option<&str>> = acting.iter().map(|dof| self.body_of((dof / self.block) as u32)).collect();
        let in_one = bodies.len() == 1 && bodies.first().is_some_and(Option::is_some);
        !in_one && acting.iter().any(|&dof| !self.fixed[dof])
    }

    /// Refuses a vector in which nodes are not where those that they follow lead them; `what` it is.
    pub fn check_tied(&self, what: &str, u: &[f64]) -> Result<(), FemError> {
        // without multipliers, which are of another size
        let u = &u[..u.len().min(self.fixed.len())];
        let mut led = u.to_vec();
        self.extend(&mut led);
        let size = u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let far = |dof: &usize| (led[*dof] - u[*dof]).abs() > ON_TIES * size;
        match (0..u.len()).find(far) {
            None => Ok(()),
            Some(dof) => {
                let node = (dof / self.block) as u32;
                let what = format!(
                    "{what} of node {node} is {:.3e} off what \"{}\" leads it to: begin at rest, or with a state of this body",
                    (led[dof] - u[dof]).abs(),
                    self.tied.get(&(node, dof % self.block)).map_or("", String::as_str)
                );
                Err(FemError::Meaningless { what })
            }
        }
    }

    /// The nodes that follow others.
    pub fn ties(&self) -> &Ties {
        &self.ties
    }

    /// Forces by all unknowns as those by the free ones: those on nodes that follow others act on these, those on supports are zero.
    pub fn restrict(&self, forces: &mut [f64]) {
        self.ties.restrict(self.block, forces);
        self.clear(forces);
    }

    /// Puts nodes that follow others where these lead them.
    pub fn extend(&self, u: &mut [f64]) {
        self.ties.extend(self.block, u);
    }

    /// Whether each unknown is prescribed.
    pub fn fixed(&self) -> &[bool] {
        &self.fixed
    }

    /// Whether an unknown is neither held nor that of a node that follows others.
    pub fn is_free(&self, dof: usize) -> bool {
        !self.fixed[dof] && self.ties.masters((dof / self.block) as u32, dof % self.block).is_empty()
    }

    /// Whether an unknown is held, and by no control.
    pub fn holds_still(&self, dof: usize) -> bool {
        self.fixed[dof] && !self.driven.contains_key(&(dof as u32))
    }

    /// Whether an unknown is held at zero, and by no control.
    pub fn holds_at_rest(&self, dof: usize) -> bool {
        self.holds_still(dof) && self.value[dof] == 0.0
    }

    /// The prescribed value of each unknown at load 1 (0 where free, and where controls decide).
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    /// Sets the entries of prescribed unknowns to zero.
    pub fn clear(&self, vector: &mut [f64]) {
        for (v, &fixed) in vector.iter_mut().zip(&self.fixed) {
            if fixed {
                *v = 0.0;
            }
        }
    }

    /// Sum over each support's nodes of an internal-force vector: the reactions of the displacement, by support.
    pub fn reactions(&self, force: &[f64]) -> Vec<(String, [f64; 3])> {
        let mut force = force.to_vec();
        self.ties.restrict(self.block, &mut force);
        let sum = |dofs: &[u32]| {
            let mut total = [0.0; 3];
            // a component that two supports of one name prescribe counts once
            let dofs: BTreeSet<u32> = dofs.iter().copied().collect();
            for dof in dofs.into_iter().map(|dof| dof as usize).filter(|dof| dof % self.block < self.dim) {
                total[dof % self.block] += force[dof];
            }
            total
        };
        let of_displacement = |dofs: &[u32]| dofs.iter().any(|dof| *dof as usize % self.block < self.dim);
        let groups = self.groups.iter().filter(|(_, dofs)| dofs.is_empty() || of_displacement(dofs));
        groups.map(|(name, dofs)| (name.clone(), sum(dofs))).collect()
    }
}

fn led_wholly(motion: &str, other: &str, node: usize) -> FemError {
    let what = format!(
        "motion \"{motion}\" moves node {node}, which \"{other}\" holds too, as all else that it holds; let one of them go"
    );
    FemError::Meaningless { what }
}

fn held_and_rigid(support: &str, body: &str, node: u32) -> FemError {
    let what = format!(
        "\"{support}\" moves node {node} of the rigid body \"{body}\", or came behind it: supports that hold components at zero, added before it, may have nodes of rigid bodies; \
         else let one of them go: hold its surface with a law in the place of \"rigid\", or by a foundation or springs"
    );
    FemError::Meaningless { what }
}
