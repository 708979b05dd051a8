//! [`SkinMap`]: from the unknowns of a [`FreeShape`] to the displacement of the nodes of the drawn body.

use super::harmonic_extension::{HarmonicExtension, stiffness};
use super::surface_filter::{SurfaceFilter, SurfaceMatrices};
use nastic_body::body_energy::free_shape::FreeShape;
use nastic_body::controls::ControlPoint;
use nastic_body::discretization::Discretization;
use nastic_body::error::FemError;
use nastic_mesh::{CellKind, Facet, GroupNames, Mesh};
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Who holds a component of a node where it is drawn, if anyone does.
pub type DrawnKeeper<'k> = &'k dyn Fn(u32, usize) -> Option<String>;

/// A normal whose part that nothing holds is shorter leads nowhere.
const LEAST_NORMAL: f64 = 1e-6;

/// `s(p)`, linear: the filter of the skin, the normals, the harmonic extension of every component.
#[derive(Debug)]
pub struct SkinMap {
    dim: usize,
    dofs: usize,
    filter: SurfaceFilter,
    /// Of the free nodes of the skin: N, without the components that something holds.
    normals: Vec<Vec3>,
    points: Vec<ControlPoint>,
    /// By component.
    extensions: Vec<Arc<HarmonicExtension>>,
}

/// What is known of a shape before anything is factorised.
struct Parts<'a> {
    mesh: &'a Mesh,
    shape: &'a FreeShape,
    cells: Vec<u32>,
    facets: Vec<Facet>,
    /// Nodes of kept surfaces, and of cells outside of the regions.
    kept: BTreeSet<u32>,
    keeper: DrawnKeeper<'a>,
}

impl Parts<'_> {
    fn refuse<T>(&self, what: &str) -> Result<T, FemError> {
        Err(FemError::Meaningless { what: format!("shape \"{}\" {what}", self.shape.name) })
    }

    /// Who holds a component of a node.
    fn keeper(&self, node: u32, c: usize) -> Option<String> {
        let kept = || self.kept.contains(&node).then(|| "\"keep\", or the border of its region,".to_owned());
        (self.keeper)(node, c).or_else(kept)
    }

    fn stays(&self, node: u32, c: usize) -> bool {
        self.keeper(node, c).is_some()
    }
}

impl SkinMap {
    /// On a body: `keeper` says what holds a component of a node of the drawn body.
    ///
    /// # Errors
    /// Names that the mesh lacks, a skin that is kept or held at all of its nodes or lies outside of the regions, a filter that is shorter than the distance of its nodes, a part of the body
    /// that touches neither the skin nor what stays.
    pub fn new(disc: &Discretization, shape: &FreeShape, keeper: DrawnKeeper<'_>) -> Result<Self, FemError> {
        let parts = parts(disc.mesh(), shape, keeper)?;
        let (mesh, dim) = (parts.mesh, disc.dim());
        let matrices = SurfaceMatrices::new(mesh, &parts.facets);
        let normals = normals(&parts);
        check_names(&parts, &normals)?;
        let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
        matrices.each_diagonal(|node, share| *areas.entry(node).or_default() += share);
        let whole = mesh.area(&parts.facets);
        check_length(&parts, whole, areas.len())?;
        let free: Vec<u32> = normals.keys().copied().collect();
        let diagonal: f64 = areas.values().sum();
        let point = |node: &u32| ControlPoint {
            position: mesh.points()[*node as usize],
            weight: areas.get(node).map_or(0.0, |own| whole * own / diagonal),
        };
        let points = free.iter().map(point).collect();
        let filter = SurfaceFilter::new(&matrices, free, shape.filter, mesh.points())?;
        let (skin, normals) = (areas.into_keys().collect(), normals.into_values().collect());
        let extensions = extensions(&parts, &skin)?;
        Ok(SkinMap { dim, dofs: disc.dofs(), filter, normals, points, extensions })
    }

    /// The nodes of the unknowns, ascending.
    pub fn nodes(&self) -> &[u32] {
        self.filter.free()
    }

    /// Their places, with the area that belongs to each.
    pub fn points(&self) -> &[ControlPoint] {
        &self.points
    }

    /// s of all nodes, flat.
    pub fn displacement(&self, p: &[f64]) -> Vec<f64> {
        let (a, dim) = (self.filter.values(p), self.dim);
        let mut s = vec![0.0; self.dofs];
        for ((node, normal), a) in self.nodes().iter().zip(&self.normals).zip(a) {
            (0..dim).for_each(|c| s[dim * *node as usize + c] = a * normal[c]);
        }
        self.extensions.iter().enumerate().for_each(|(c, own)| own.extend(&mut s, dim, c));
        s
    }

    /// The transpose: by the unknowns, of what has this derivative by s.
    pub fn vjp(&self, mut by_s: Vec<f64>) -> Vec<f64> {
        let dim = self.dim;
        self.extensions.iter().enumerate().for_each(|(c, own)| own.gather(&mut by_s, dim, c));
        let by_node = self.nodes().iter().zip(&self.normals);
        let by_a = by_node.map(|(node, n)| (0..dim).map(|c| n[c] * by_s[dim * *node as usize + c]).sum());
        self.filter.vjp(by_a.collect())
    }
}

fn parts<'a>(mesh: &'a Mesh, shape: &'a FreeShape, keeper: DrawnKeeper<'a>) -> Result<Parts<'a>, FemError> {
    let cells = mesh.cells_of(&shape.regions)?;
    let facets = mesh.facets_of(&shape.skin)?;
    let keep: Vec<Facet> = shape.keep.as_ref().map_or(Ok(Vec::new()), |keep| mesh.facets_of(keep))?;
    let others: Vec<u32> = (0..mesh.cells() as u32).filter(|cell| cells.binary_search(cell).is_err()).collect();
    let mut kept: BTreeSet<u32> = mesh.nodes_of_facets(&keep).into_iter().collect();
    kept.extend(mesh.nodes_of_cells(&others));
    let parts = Parts { mesh, shape, cells, facets, kept, keeper };
    if let Some(facet) = parts.facets.iter().find(|facet| keep.binary_search(facet).is_ok()) {
        let [x, y, z] = mesh.cell_centre(facet.cell as usize);
        return parts.refuse(&format!(
            "moves a surface that is to stay as it is drawn, beside ({x}, {y}, {z}): it is in \"keep\", or has a dead traction, whose force is that of the drawn area; take a pressure, or leave that \
             surface out of the skin"
        ));
    }
    if let Some(facet) = parts.facets.iter().find(|facet| parts.cells.binary_search(&facet.cell).is_err()) {
        let [x, y, z] = mesh.cell_centre(facet.cell as usize);
        return parts.refuse(&format!("has a skin of cells outside of its region, beside ({x}, {y}, {z})"));
    }
    Ok(parts)
}

/// Mean outward normals at the nodes of the skin that are free to move along them, without components that something holds.
fn normals(parts: &Parts<'_>) -> BTreeMap<u32, Vec3> {
    let mut sums: BTreeMap<u32, Vec3> = BTreeMap::new();
    for &facet in &parts.facets {
        let (kind, nodes) = parts.mesh.facet_nodes(facet);
        let places = parts.mesh.gather(parts.mesh.points(), &nodes);
        let (rule, mut shapes): (_, Vec<f64>) = (kind.rule_of_points(kind.order() + 1), vec![0.0; nodes.len()]);
        for (xi, w) in rule.points.iter().zip(&rule.weights) {
            kind.shapes(xi, &mut shapes);
            let area = outward(kind, &places, xi) * *w;
            // positive weights at nodes of all orders
            nodes
                .iter()
                .zip(&shapes)
                .for_each(|(node, shape)| *sums.entry(*node).or_default() += area * (shape * shape));
        }
    }
    let free = |(node, sum): (u32, Vec3)| {
        let mut normal = sum / sum.norm();
        (0..parts.mesh.dim()).filter(|c| parts.stays(node, *c)).for_each(|c| normal[c] = 0.0);
        (normal.norm() > LEAST_NORMAL).then_some((node, normal))
    };
    sums.into_iter().filter_map(free).collect()
}

fn outward(kind: CellKind, places: &[[f64; 3]], xi: &[f64; 3]) -> Vec3 {
    Vec3::from(kind.area_vector(places, xi))
}

/// Refuses a surface of the skin none of whose nodes can move.
fn check_names(parts: &Parts<'_>, free: &BTreeMap<u32, Vec3>) -> Result<(), FemError> {
    for name in parts.shape.skin.iter() {
        let nodes = parts.mesh.nodes_of_facets(&parts.mesh.facets_of(&GroupNames::from(name))?);
        if nodes.iter().any(|node| free.contains_key(node)) {
            continue;
        }
        let held = nodes.iter().flat_map(|node| (0..parts.mesh.dim()).map(move |c| (*node, c)));
        let keeper = held.into_iter().find_map(|(node, c)| parts.keeper(node, c)).unwrap_or_default();
        return parts.refuse(&format!(
            "cannot move \"{name}\": {keeper} holds all of its nodes where they are drawn; name a surface that is free, or let go of it"
        ));
    }
    Ok(())
}

/// Refuses a filter that smooths nothing.
fn check_length(parts: &Parts<'_>, area: f64, nodes: usize) -> Result<(), FemError> {
    let length = parts.shape.filter;
    let spacing = (area / nodes as f64).powf(1.0 / (parts.mesh.dim() - 1) as f64);
    match length.is_finite() && length >= spacing {
        true => Ok(()),
        false => parts.refuse(&format!(
            "has a \"filter\" of {length:.4}, shorter than the distance of the nodes of its skin, {spacing:.4}: shapes would depend on the mesh; take a longer one, or a finer mesh"
        )),
    }
}

/// How the inside follows, by component; components that are held alike share one.
fn extensions(parts: &Parts<'_>, skin: &BTreeSet<u32>) -> Result<Vec<Arc<HarmonicExtension>>, FemError> {
    let (mesh, pieces) = (parts.mesh, stiffness(parts.mesh, &parts.cells)?);
    let own = mesh.nodes_of_cells(&parts.cells);
    let mut found: Vec<Arc<HarmonicExtension>> = Vec::new();
    for c in 0..mesh.dim() {
        let follows = |node: &u32| !skin.contains(node) && !parts.stays(*node, c);
        let free: Vec<u32> = own.iter().copied().filter(follows).collect();
        let known = found.iter().find(|own| own.free() == free).cloned();
        let new = || HarmonicExtension::new(free.clone(), &pieces, mesh.points()).map(Arc::new);
        found.push(known.map_or_else(new, Ok)?);
    }
    Ok(found)
}
