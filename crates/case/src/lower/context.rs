//! Context of lowering: the document and the diagnostics collected.

use crate::warning::{WARNINGS, WarningKind};
use nastic_language::quantity::Units;
use nastic_language::syntax::{At, Diagnostic, Document};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{Mesh, Snapshot};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

pub(super) struct Context<'a> {
    pub document: &'a Document,
    pub units: Units,
    pub found: Findings,
    /// Whether rigid motions may be free: no equilibrium is looked for.
    pub free: bool,
    files: Rc<RefCell<Files>>,
}

/// What was found out about a case or one of its variants.
#[derive(Default)]
pub(super) struct Findings {
    pub problems: Vec<Diagnostic>,
    pub warnings: Vec<(&'static WarningKind, Diagnostic)>,
    pub notes: Vec<String>,
}

/// Files are read once, however many variants of the case name them.
#[derive(Default)]
struct Files {
    named: Vec<PathBuf>,
    meshes: BTreeMap<String, Arc<Mesh>>,
    snapshots: BTreeMap<PathBuf, Arc<Snapshot>>,
    /// Distances on grids, by mesh, spacing and reach.
    grids: Vec<(Arc<Mesh>, [f64; 2], Obstacle)>,
}

impl<'a> Context<'a> {
    pub fn new(document: &'a Document, units: Units) -> Self {
        Self { document, units, found: Findings::default(), free: false, files: Rc::default() }
    }

    /// The context of a variant of the case: its own findings, the same files.
    pub fn variant<'b>(&self, document: &'b Document) -> Context<'b> {
        Context { document, units: self.units, found: Findings::default(), free: self.free, files: self.files.clone() }
    }

    /// Notes a problem at a path of the case.
    pub fn complain(&mut self, at: &At, message: impl ToString) {
        self.found.problems.push(self.document.complain(at, message.to_string()));
    }

    /// Notes what deserves attention but does not stop anything.
    pub fn warn(&mut self, kind: &'static WarningKind, at: &At, message: impl ToString) {
        self.found.warnings.push((kind, self.document.complain(at, message.to_string())));
    }

    /// Notes what may be good to know.
    pub fn note(&mut self, note: String) {
        self.found.notes.push(note);
    }

    /// The value, or a complaint.
    pub fn take<T>(&mut self, at: &At, result: Result<T, impl ToString>) -> Option<T> {
        result.map_err(|error| self.complain(at, error)).ok()
    }

    /// The place of a file named in the case, which is noted as read.
    pub fn file(&mut self, name: &str) -> PathBuf {
        let path = self.document.resolve(name);
        let named = &mut self.files.borrow_mut().named;
        if !named.contains(&path) {
            named.push(path.clone());
        }
        path
    }

    /// All files named so far.
    pub fn files(&self) -> Vec<PathBuf> {
        self.files.borrow().named.clone()
    }

    /// The mesh known under a key, or the one made now.
    pub fn mesh(&mut self, key: String, make: impl FnOnce(&mut Self) -> Option<Mesh>) -> Option<Arc<Mesh>> {
        let known = self.files.borrow().meshes.get(&key).cloned();
        known.or_else(|| {
            let mesh = Arc::new(make(self)?);
            self.files.borrow_mut().meshes.insert(key, mesh.clone());
            Some(mesh)
        })
    }

    /// The distance from a mesh on a grid of a spacing with a reach, or the one made now.
    pub fn grid<E>(
        &mut self,
        mesh: &Arc<Mesh>,
        key: [f64; 2],
        make: impl FnOnce() -> Result<Obstacle, E>,
    ) -> Result<Obstacle, E> {
        let is_it = |(of, own, _): &&(Arc<Mesh>, [f64; 2], Obstacle)| Arc::ptr_eq(of, mesh) && *own == key;
        let known = self.files.borrow().grids.iter().find(is_it).map(|(.., grid)| grid.clone());
        known.map_or_else(
            || {
                let grid = make()?;
                self.files.borrow_mut().grids.push((mesh.clone(), key, grid.clone()));
                Ok(grid)
            },
            Ok,
        )
    }

    /// What a VTU file holds.
    pub fn snapshot(&mut self, path: &Path, at: &At) -> Option<Arc<Snapshot>> {
        let known = self.files.borrow().snapshots.get(path).cloned();
        known.or_else(|| {
            let snapshot = Arc::new(self.take(at, nastic_io::read_snapshot(path))?);
            self.files.borrow_mut().snapshots.insert(path.to_owned(), snapshot.clone());
            Some(snapshot)
        })
    }

    pub fn is_sound(&self) -> bool {
        self.found.problems.is_empty()
    }
}

impl Findings {
    /// Takes in what was found about variants. What all of them share is reported once; what belongs to some alone names
    /// the first of them.
    pub fn absorb(&mut self, variants: Vec<(String, Findings)>) {
        let names: Vec<&String> = variants.iter().map(|(name, _)| name).collect();
        let problems: Vec<Vec<Diagnostic>> = variants.iter().map(|(_, found)| found.problems.clone()).collect();
        self.problems.extend(merged(&names, &problems));
        for kind in WARNINGS {
            let own = |found: &Findings| -> Vec<Diagnostic> {
                found.warnings.iter().filter(|(of, _)| of == kind).map(|(_, shown)| shown.clone()).collect()
            };
            let lists: Vec<Vec<Diagnostic>> = variants.iter().map(|(_, found)| own(found)).collect();
            self.warnings.extend(merged(&names, &lists).into_iter().map(|shown| (*kind, shown)));
        }
        for note in variants.into_iter().flat_map(|(_, found)| found.notes) {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}

fn merged(names: &[&String], lists: &[Vec<Diagnostic>]) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    let mut kinds: Vec<String> = Vec::new();
    for (name, list) in names.iter().zip(lists) {
        for one in list {
            if lists.iter().all(|list| list.contains(one)) {
                if !out.contains(one) {
                    out.push(one.clone());
                }
                continue;
            }
            // The same with other numbers says nothing new.
            let kind = kind(one);
            if !kinds.contains(&kind) {
                kinds.push(kind);
                out.push(Diagnostic { message: format!("{name}: {}", one.message), ..one.clone() });
            }
        }
    }
    out
}

/// Path and message without numbers.
fn kind(one: &Diagnostic) -> String {
    let words = one.message.split(' ').filter(|word| !word.contains(|c: char| c.is_ascii_digit()));
    format!("{} {}", one.path, words.collect::<Vec<_>>().join(" "))
}
