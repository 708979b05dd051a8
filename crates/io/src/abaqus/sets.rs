//! Sets and surfaces.

use super::element::{Family, face};
use super::lines::Keyword;
use super::model::{Scope, Surface};
use super::read::{MOST_MEMBERS, Reader};
use crate::error::ReadError;
use crate::source::brief;

/// A set that meshio (5.3) writes of a mesh of Gmsh.
const MESHIO_ENTITIES: &str = "gmsh:bounding_entities";

impl Reader<'_> {
    /// `*NSET` and `*ELSET`.
    pub fn set(&mut self, keyword: &Keyword, of_nodes: bool) -> Result<(), ReadError> {
        self.listed_here(keyword)?;
        let name = self.named(keyword, if of_nodes { "NSET" } else { "ELSET" })?;
        if name.eq_ignore_ascii_case(MESHIO_ENTITIES) {
            // its numbers are those of Gmsh's entities, some of them negative, and of no elements
            while self.lines.data().is_some() {}
            self.found.foreign.insert(name.to_owned());
            return Ok(());
        }
        let scope = self.scope(keyword)?;
        let mut members = Vec::new();
        while let Some(words) = self.lines.data() {
            if keyword.has("GENERATE") {
                self.generate(&words, scope, of_nodes, &mut members)?;
                continue;
            }
            for word in words.iter().filter(|word| !word.is_empty()) {
                self.member(word, scope, of_nodes, name, &mut members)?;
            }
        }
        // sets of sets grow no longer than what they are of
        members.sort_unstable();
        members.dedup();
        let home = self.instance.unwrap_or(0);
        let model = self.model();
        let sets = if of_nodes { &mut model.node_sets } else { &mut model.element_sets };
        sets.extend(home, name, keyword.has("INTERNAL"), &members);
        Ok(())
    }

    /// Where numbers without an instance are looked up.
    fn scope(&self, keyword: &Keyword) -> Result<Scope, ReadError> {
        match keyword.parameter("INSTANCE") {
            None => Ok(self.instance.unwrap_or(0)),
            Some(name) => {
                let what = || self.lines.malformed(format!("there is no instance \"{}\" before it", brief(name)));
                self.scope_of(name).ok_or_else(what)
            }
        }
    }

    /// `first, last, step`: those that are there.
    fn generate(&mut self, words: &[&str], scope: Scope, of_nodes: bool, to: &mut Vec<u32>) -> Result<(), ReadError> {
        let number =
            |k: usize| words.get(k).filter(|word| !word.is_empty()).map(|word| self.lines.label(word)).transpose();
        let (first, last, step) = (number(0)?, number(1)?, number(2)?.unwrap_or(1));
        let (Some(first), Some(last)) = (first, last) else {
            return Err(self.lines.malformed("GENERATE needs a first and a last number"));
        };
        let model = self.model();
        let at = if of_nodes { &model.node_at } else { &model.element_at };
        let mut looked_at = 0;
        for ((_, label), member) in at.range((scope, first)..=(scope, last.max(first))) {
            looked_at += 1;
            if (label - first) % step == 0 {
                to.push(*member);
            }
        }
        self.count(looked_at)
    }

    /// Counts members that were looked at, so that no file of many sets takes memory or time without bound.
    fn count(&mut self, more: usize) -> Result<(), ReadError> {
        self.members += more;
        if self.members <= MOST_MEMBERS {
            return Ok(());
        }
        let what = format!("more than {MOST_MEMBERS} members of sets");
        Err(self.lines.unsupported(what, "leave out the sets that the case does not name"))
    }

    /// A number or the name of a set, behind the name of an instance or not.
    fn member(
        &mut self,
        word: &str,
        scope: Scope,
        of_nodes: bool,
        set: &str,
        to: &mut Vec<u32>,
    ) -> Result<(), ReadError> {
        let qualified = word.rsplit_once('.').and_then(|(name, rest)| Some((self.scope_of(name)?, rest)));
        let (scope, word) = qualified.unwrap_or((scope, word));
        let model = self.model();
        if let Ok(label) = word.parse::<u64>() {
            let at = if of_nodes { &model.node_at } else { &model.element_at };
            match at.get(&(scope, label)) {
                Some(member) => {
                    to.push(*member);
                    return self.count(1);
                }
                None => *self.found.unknown.entry(brief(set)).or_default() += 1,
            }
            return Ok(());
        }
        let sets = if of_nodes { &model.node_sets } else { &model.element_sets };
        let found = sets.find(scope, word).or_else(|| sets.find(0, word)).map(<[u32]>::to_vec);
        let what = if of_nodes { "nodes" } else { "elements" };
        let found = found
            .ok_or_else(|| self.lines.malformed(format!("there is no set of {what} \"{}\" before it", brief(word))))?;
        let count = found.len();
        to.extend(found);
        self.count(count)
    }

    /// `*SURFACE` of elements or nodes.
    pub fn surface(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        self.listed_here(keyword)?;
        let name = self.named(keyword, "NAME")?.to_owned();
        let kind = keyword.parameter("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
        let scope = self.instance.unwrap_or(0);
        if !["ELEMENT", "NODE"].contains(&kind.as_str()) || keyword.has("COMBINE") {
            self.found.surfaces.insert(format!("\"{}\"", brief(&name)));
            return Ok(());
        }
        let mut surface = Surface { scope, name, ..Surface::default() };
        let mut nodes = Vec::new();
        while let Some(words) = self.lines.data() {
            if kind == "NODE" {
                self.member(words[0], scope, true, &surface.name, &mut nodes)?;
            } else {
                self.facets(&words, scope, &mut surface)?;
            }
        }
        if kind == "NODE" {
            self.model().node_sets.extend(scope, &surface.name, false, &nodes);
        } else {
            self.model().surfaces.push(surface);
        }
        Ok(())
    }

    /// `set or element, face`.
    fn facets(&mut self, words: &[&str], scope: Scope, surface: &mut Surface) -> Result<(), ReadError> {
        let mut members = Vec::new();
        self.member(words[0], scope, false, &surface.name, &mut members)?;
        let label = words.get(1).copied().unwrap_or_default();
        if label.is_empty() || ["SPOS", "SNEG"].contains(&label.to_ascii_uppercase().as_str()) {
            surface.free.extend(members);
            return Ok(());
        }
        for member in members {
            let element = &self.model().elements[member as usize];
            let (kind, number) = (element.kind, element.label);
            // shells have S1 and S2 for their sides
            if element.family == Family::Shell {
                surface.free.push(member);
                continue;
            }
            let Some(face) = face(kind, label) else {
                let what = format!("element {number} ({kind}) has no face \"{}\"", brief(label));
                return Err(self.lines.malformed(what));
            };
            surface.faces.push((member, face));
        }
        Ok(())
    }
}
