//! What Gmsh is given, and what it answers.

use crate::error::RemeshError;
use crate::outline::Outline;
use nastic_io::WriteError;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The geometry.
pub(crate) const GEOMETRY: &str = "outline.geo";
/// Its triangles, of a body in space.
const TRIANGLES: &str = "outline.msh";
/// What Gmsh makes.
pub(crate) const MESH: &str = "mesh.msh";
/// Until it is complete.
const PART: &str = "mesh.part.msh";
/// How many of Gmsh's last lines an error repeats.
const LAST_LINES: usize = 8;

/// Named groups of the new mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    /// Pieces by the name of the region.
    pub regions: BTreeMap<String, BTreeSet<u32>>,
    /// Names of the surfaces, by the numbers that patches have.
    pub surfaces: Vec<String>,
    /// Points of node sets.
    pub nodes: BTreeMap<String, Vec<u32>>,
}

/// What is to be meshed.
pub(crate) struct Order<'a> {
    pub outline: &'a Outline,
    pub groups: &'a Groups,
    /// Of cells.
    pub size: f64,
    /// 1 or 2.
    pub order: usize,
}

impl Order<'_> {
    /// Writes the geometry into a directory and has it meshed; the file of the mesh.
    pub fn mesh(&self, program: &Path, directory: &Path) -> Result<PathBuf, RemeshError> {
        let mut geometry = self.options();
        match self.outline.dim {
            2 => self.plane(&mut geometry)?,
            _ => {
                nastic_io::write_atomically(directory.join(TRIANGLES), |out| {
                    out.write_all(self.triangles().as_bytes())
                })?;
                self.solid(&mut geometry);
            }
        }
        nastic_io::write_atomically(directory.join(GEOMETRY), |out| out.write_all(geometry.as_bytes()))?;
        run(program, directory, self.outline.dim)?;
        Ok(directory.join(MESH))
    }

    fn options(&self) -> String {
        let Order { size, order, .. } = self;
        format!(
            "General.NumThreads = 1;\nMesh.MeshSizeMax = {size};\nMesh.MeshSizeExtendFromBoundary = 1;\nMesh.ElementOrder = {order};\n\
             Mesh.SecondOrderLinear = 1;\nMesh.Optimize = 1;\nMesh.OptimizeNetgen = 1;\nMesh.MshFileVersion = 4.1;\n"
        )
    }

    /// The points that facets have, numbered from 1, and those of node sets.
    fn used(&self) -> BTreeSet<u32> {
        self.outline.facets.iter().flat_map(|(nodes, _)| nodes.iter().copied()).collect()
    }

    fn plane(&self, out: &mut String) -> Result<(), RemeshError> {
        let Outline { points, facets, patches, .. } = self.outline;
        for node in self.used() {
            let [x, y, _] = points[node as usize];
            let _ = writeln!(out, "Point({}) = {{{x}, {y}, 0, {}}};", node + 1, self.size);
        }
        for (k, (nodes, _)) in facets.iter().enumerate() {
            let _ = writeln!(out, "Line({}) = {{{}, {}}};", k + 1, nodes[0] + 1, nodes[1] + 1);
        }
        let mut loops = 0;
        for piece in self.pieces() {
            let mut edges = Vec::new();
            for (k, (nodes, patch)) in facets.iter().enumerate() {
                let (patch, line) = (&patches[*patch], k as i64 + 1);
                if patch.inside == piece {
                    edges.push(Edge { from: nodes[0], to: nodes[1], line });
                } else if patch.outside == Some(piece) {
                    edges.push(Edge { from: nodes[1], to: nodes[0], line: -line });
                }
            }
            let mut closed = closed_loops(edges, points).ok_or(RemeshError::Open)?;
            // the outer one goes counter-clockwise, holes the other way
            closed.sort_by(|a, b| area(b, points).total_cmp(&area(a, points)));
            let first = loops + 1;
            for own in closed {
                loops += 1;
                let lines = listed(own.iter().map(|edge| edge.line));
                let _ = writeln!(out, "Curve Loop({loops}) = {{{lines}}};");
            }
            let _ = writeln!(out, "Plane Surface({}) = {{{}}};", piece + 1, listed(first..=loops));
        }
        let lines = |number: usize| {
            let own = facets.iter().enumerate().filter(|(_, (_, patch))| patches[*patch].surfaces.contains(&number));
            own.map(|(k, _)| k as i64 + 1).collect::<Vec<_>>()
        };
        self.named(out, ["Surface", "Curve"], &lines);
        Ok(())
    }

    fn solid(&self, out: &mut String) {
        let _ = writeln!(out, "Merge \"{TRIANGLES}\";");
        let patches = &self.outline.patches;
        let used: BTreeSet<usize> = self.outline.facets.iter().map(|(_, patch)| *patch).collect();
        for piece in self.pieces() {
            let of = |k: &usize| patches[*k].inside == piece || patches[*k].outside == Some(piece);
            let own = listed(used.iter().filter(|k| of(k)).map(|k| k + 1));
            let number = piece + 1;
            let _ = writeln!(out, "Surface Loop({number}) = {{{own}}};\nVolume({number}) = {{{number}}};");
        }
        let of = |number: usize| {
            let own = used.iter().filter(|k| patches[**k].surfaces.contains(&number));
            own.map(|k| *k as i64 + 1).collect::<Vec<_>>()
        };
        self.named(out, ["Volume", "Surface"], &of);
    }

    fn pieces(&self) -> BTreeSet<u32> {
        let Outline { facets, patches, .. } = self.outline;
        let of = |(_, patch): &(Vec<u32>, usize)| [Some(patches[*patch].inside), patches[*patch].outside];
        facets.iter().flat_map(of).flatten().collect()
    }

    fn named(&self, out: &mut String, [cells, facets]: [&str; 2], of_surface: &dyn Fn(usize) -> Vec<i64>) {
        for (name, pieces) in &self.groups.regions {
            let _ = writeln!(out, "Physical {cells}(\"{name}\") = {{{}}};", listed(pieces.iter().map(|k| k + 1)));
        }
        for (number, name) in self.groups.surfaces.iter().enumerate() {
            let own = of_surface(number);
            if !own.is_empty() {
                let _ = writeln!(out, "Physical {facets}(\"{name}\") = {{{}}};", listed(own));
            }
        }
        for (name, nodes) in self.groups.nodes.iter().filter(|(_, nodes)| !nodes.is_empty()) {
            let _ = writeln!(out, "Physical Point(\"{name}\") = {{{}}};", listed(nodes.iter().map(|k| k + 1)));
        }
    }

    /// The triangles of patches as a mesh file of discrete surfaces.
    fn triangles(&self) -> String {
        let Outline { points, facets, .. } = self.outline;
        let used = self.used();
        let mut out = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", used.len());
        for node in used {
            let [x, y, z] = points[node as usize];
            let _ = writeln!(out, "{} {x} {y} {z}", node + 1);
        }
        let vertices: BTreeSet<u32> = self.groups.nodes.values().flatten().copied().collect();
        let _ = writeln!(out, "$EndNodes\n$Elements\n{}", facets.len() + vertices.len());
        for (k, (nodes, patch)) in facets.iter().enumerate() {
            let _ = writeln!(
                out,
                "{} 2 2 0 {} {}",
                k + 1,
                patch + 1,
                nodes.iter().map(|n| (n + 1).to_string()).collect::<Vec<_>>().join(" ")
            );
        }
        for (k, node) in vertices.iter().enumerate() {
            let _ = writeln!(out, "{} 15 2 0 {} {}", facets.len() + k + 1, node + 1, node + 1);
        }
        out + "$EndElements\n"
    }
}

fn listed<T: std::fmt::Display>(numbers: impl IntoIterator<Item = T>) -> String {
    numbers.into_iter().map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// An edge of a loop in its direction.
#[derive(Clone, Copy)]
struct Edge {
    from: u32,
    to: u32,
    line: i64,
}

/// Edges with the body on their left as loops; where several meet in a point, each goes on with the edge that turns most to the left, so that loops touch but do
/// not cross. `None` if one does not close.
fn closed_loops(edges: Vec<Edge>, points: &[[f64; 3]]) -> Option<Vec<Vec<Edge>>> {
    let mut from: BTreeMap<u32, Vec<Edge>> = BTreeMap::new();
    edges.iter().for_each(|edge| from.entry(edge.from).or_default().push(*edge));
    let direction = |edge: &Edge| {
        let (a, b) = (points[edge.from as usize], points[edge.to as usize]);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    let mut loops = Vec::new();
    while let Some(start) = from.values_mut().find_map(Vec::pop) {
        let (mut own, mut last) = (vec![start], start);
        while last.to != start.from {
            let next = from.get_mut(&last.to)?;
            let turn = |edge: &Edge| {
                (direction(edge) - direction(&last) + 3.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            };
            let best = (0..next.len()).max_by(|a, b| turn(&next[*a]).total_cmp(&turn(&next[*b])))?;
            last = next.swap_remove(best);
            own.push(last);
        }
        loops.push(own);
    }
    Some(loops)
}

fn area(edges: &[Edge], points: &[[f64; 3]]) -> f64 {
    let of = |edge: &Edge| {
        let (a, b) = (points[edge.from as usize], points[edge.to as usize]);
        0.5 * (a[0] * b[1] - a[1] * b[0])
    };
    edges.iter().map(of).sum()
}

/// Runs Gmsh on the geometry. Its exit code says nothing: it is 0 after errors too.
fn run(program: &Path, directory: &Path, dim: usize) -> Result<(), RemeshError> {
    // an earlier mesh stays until there is another
    let (part, mesh) = (directory.join(PART), directory.join(MESH));
    let system = |source| WriteError::System { file: part.clone(), source };
    match std::fs::remove_file(&part) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(system(error).into()),
        _ => {}
    }
    let dim = format!("-{dim}");
    let output = Command::new(program).current_dir(directory).args([GEOMETRY, &dim, "-o", PART, "-v", "2"]).output();
    let program = program.to_owned();
    let output = match output {
        Err(error) if error.kind() == ErrorKind::NotFound => return Err(RemeshError::NoGmsh { program }),
        Err(source) => return Err(RemeshError::NotRun { program, source }),
        Ok(output) => output,
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    // a summary tells nothing more
    let is_error = |line: &str| {
        let said = line.trim_start().strip_prefix("Error").map(|said| said.trim_start_matches([' ', ':']));
        said.is_some_and(|said| {
            ["---", "Mesh generation error", "Check the full", "1 error"].iter().all(|start| !said.starts_with(start))
        })
    };
    if output.status.success() && part.is_file() && !text.lines().any(is_error) {
        return std::fs::rename(&part, &mesh).map_err(|source| system(source).into());
    }
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    // of its own errors those, else what it said last
    let errors: Vec<&str> = lines.iter().copied().filter(|line| is_error(line)).collect();
    let said = if errors.is_empty() { &lines } else { &errors };
    let said = said[said.len().saturating_sub(LAST_LINES)..].join("\n  ");
    Err(RemeshError::Gmsh { program, geometry: directory.join(GEOMETRY), status: output.status, said })
}
