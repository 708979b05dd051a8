//! Which cell holds a point: the cells' maps, inverted.

use super::V;
use super::form::{Conversion, Form};
use super::part::{Answer, Part};
use super::patch::{Bend, Patch};
use super::tree::{Aabb, Tree};

/// Halvings of a cell made ahead, where it is too distorted for its map to be inverted in one go.
const AHEAD: usize = 3;
/// Most parts looked at before a point that cannot be decided counts as outside.
const PARTS: usize = 40;

/// Cells as patches, cut into parts whose maps are easy to invert, in a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    pub bends: Vec<Bend>,
    forms: Vec<Form>,
    starts: Vec<u32>,
    control: Vec<V>,
    parts: Vec<(u32, Part)>,
    tree: Tree,
}

impl Cells {
    pub fn push(&mut self, conversion: &Conversion, nodes: &[V]) {
        let cell = self.forms.len();
        self.starts.push(self.control.len() as u32);
        self.forms.push(conversion.form);
        conversion.append(nodes, &mut self.control);
        self.bends.push(self.patch(cell).bend());
        let mut stack = vec![(Part::whole(&self.patch(cell), &self.bends[cell]), AHEAD)];
        while let Some((part, depth)) = stack.pop() {
            if part.is_easy() || depth == 0 {
                self.parts.push((cell as u32, part));
            } else {
                stack.extend(part.halves(&self.patch(cell), &self.bends[cell]).map(|half| (half, depth - 1)));
            }
        }
    }

    pub fn finish(&mut self) {
        let boxes: Vec<Aabb> = self.parts.iter().map(|(_, part)| part.bounds).collect();
        self.tree = Tree::build(&boxes);
    }

    pub fn len(&self) -> usize {
        self.forms.len()
    }

    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    pub fn patch(&self, cell: usize) -> Patch<'_> {
        let form = self.forms[cell];
        Patch { form, control: &self.control[self.starts[cell] as usize..][..form.controls()] }
    }

    /// The cell that holds `p`, as the number of a part of it, looking first at part `hint`.
    pub fn find(&self, p: &V, hint: Option<u32>) -> Option<u32> {
        let holds =
            |part: usize| self.parts.get(part).is_some_and(|(_, part)| part.bounds.contains(p)) && self.holds(part, p);
        if let Some(hint) = hint.filter(|&part| holds(part as usize)) {
            return Some(hint);
        }
        let mut found = None;
        self.tree.overlapping(&Aabb { lo: *p, hi: *p }, |part| {
            if self.holds(part, p) {
                found = Some(part as u32);
            }
            found.is_some()
        });
        found
    }

    /// Is this very patch, to the last bit, a cell of the solid?
    pub fn same_as(&self, other: &Patch) -> bool {
        // Its first corner is in the box of some part of it.
        let corner = other.control[0];
        let mut found = false;
        self.tree.overlapping(&Aabb { lo: corner, hi: corner }, |part| {
            let patch = self.patch(self.parts[part].0 as usize);
            found = patch.form == other.form && patch.control == other.control;
            found
        });
        found
    }

    fn holds(&self, part: usize, p: &V) -> bool {
        let (cell, part) = &self.parts[part];
        let patch = self.patch(*cell as usize);
        match part.find(&patch, p) {
            Answer::Inside => true,
            Answer::Outside => false,
            Answer::Unknown => self.search(part, &patch, &self.bends[*cell as usize], p),
        }
    }

    /// Halves a part until its map is easy to invert where that matters.
    fn search(&self, part: &Part, patch: &Patch, bend: &Bend, p: &V) -> bool {
        let mut stack = part.halves(patch, bend).to_vec();
        let mut seen = 0;
        while let Some(part) = stack.pop() {
            seen += 1;
            if seen > PARTS {
                return false;
            }
            if !part.bounds.contains(p) {
                continue;
            }
            match part.find(patch, p) {
                Answer::Inside => return true,
                Answer::Outside => {}
                Answer::Unknown => stack.extend(part.halves(patch, bend)),
            }
        }
        false
    }
}
