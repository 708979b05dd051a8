//! Which cell holds a point: the cells' maps, inverted.

use super::V;
use super::patch::{Patch, SecondBounds};
use super::patch_space::{Conversion, PatchSpace};
use super::subcell::{Containment, SubCell};
use super::tree::{Aabb, Tree};

/// Halvings of a cell in advance, where it is too distorted for its map to be inverted at once.
const MAX_FIRST_HALVINGS: usize = 3;
/// Parts that are examined before an undecided point counts as outside.
const MAX_PARTS: usize = 40;

/// Cells as patches, cut into parts whose maps are easy to invert, in a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    pub second_bounds: Vec<SecondBounds>,
    spaces: Vec<PatchSpace>,
    starts: Vec<u32>,
    control: Vec<V>,
    parts: Vec<(u32, SubCell)>,
    tree: Tree,
}

impl Cells {
    pub fn push(&mut self, conversion: &Conversion, nodes: &[V]) {
        let cell = self.spaces.len();
        self.starts.push(self.control.len() as u32);
        self.spaces.push(conversion.space);
        conversion.append(nodes, &mut self.control);
        self.second_bounds.push(self.patch(cell).second_bounds());
        let mut stack = vec![(SubCell::whole(&self.patch(cell), &self.second_bounds[cell]), MAX_FIRST_HALVINGS)];
        while let Some((part, depth)) = stack.pop() {
            if part.is_nearly_linear() || depth == 0 {
                self.parts.push((cell as u32, part));
            } else {
                stack.extend(part.halves(&self.patch(cell), &self.second_bounds[cell]).map(|half| (half, depth - 1)));
            }
        }
    }

    pub fn finish(&mut self) {
        let boxes: Vec<Aabb> = self.parts.iter().map(|(_, part)| part.bounds).collect();
        self.tree = Tree::build(&boxes);
    }

    pub fn len(&self) -> usize {
        self.spaces.len()
    }

    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    pub fn patch(&self, cell: usize) -> Patch<'_> {
        let space = self.spaces[cell];
        Patch { space, control: &self.control[self.starts[cell] as usize..][..space.controls()] }
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

    /// Whether another cell than `own` holds `p`.
    pub fn is_in_another(&self, p: &V, own: usize) -> bool {
        let mut found = false;
        self.tree.overlapping(&Aabb { lo: *p, hi: *p }, |part| {
            found = self.parts[part].0 as usize != own && self.holds(part, p);
            found
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
            found = patch.space == other.space && patch.control == other.control;
            found
        });
        found
    }

    fn holds(&self, part: usize, p: &V) -> bool {
        let (cell, part) = &self.parts[part];
        let patch = self.patch(*cell as usize);
        match part.find(&patch, p) {
            Containment::Inside => true,
            Containment::Outside => false,
            Containment::Unknown => self.search(part, &patch, &self.second_bounds[*cell as usize], p),
        }
    }

    /// Halves a part until its map is easy to invert where that matters.
    fn search(&self, part: &SubCell, patch: &Patch, second_bounds: &SecondBounds, p: &V) -> bool {
        let mut stack = part.halves(patch, second_bounds).to_vec();
        let mut seen = 0;
        while let Some(part) = stack.pop() {
            seen += 1;
            if seen > MAX_PARTS {
                return false;
            }
            if !part.bounds.contains(p) {
                continue;
            }
            match part.find(patch, p) {
                Containment::Inside => return true,
                Containment::Outside => {}
                Containment::Unknown => stack.extend(part.halves(patch, second_bounds)),
            }
        }
        false
    }
}
