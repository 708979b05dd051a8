//! [`Inspection`]: what is looked for in a computed state: instability, self-intersection, distorted cells.

use crate::summary;
use nastic_case::inspect::{compression, touches};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{
    BREAKDOWN, CELL_SHAPE, EXTREME_DEFORMATION, MEDIUM, NEARLY_SINGULAR, NOT_COUNTED, SELF_INTERSECTION, UNSTABLE,
    Warning,
};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{FreeMotion, Instant, PointPeak, SolveOptions, State, StateError};
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Actuation, Block};
use nastic_mesh::Mesh;
use nastic_mesh::spatial::{SelfIntersection, Shape};
use nastic_numeric::vector::{norm, sub};
use nastic_report::record::{ContributionRecord, IntersectionRecord, UncountedRecord, number_of};
use rayon::prelude::*;

/// Below this scaled Jacobian a cell is badly shaped.
const POOR: f64 = 0.05;

/// Displacements of so many times the body's diagonal stretch it as much.
const FAR: f64 = 3.0;

/// Chambers with so many times their volume have walls more than twice as long.
const BALLOONED: f64 = 10.0;

/// Share of the elastic energy that the medium of a void may store without a word.
const MOST_IN_A_MEDIUM: f64 = 0.01;

/// What was found in the state of one member.
#[derive(Debug, Clone)]
pub struct Inspection {
    /// Negative pivots of the tangent and, where it is known, whether a factor shows them; or why they were not counted.
    pub inertia: Result<(usize, Option<bool>), Uncounted>,
    /// What may roll or slide on.
    pub free: Option<FreeMotion>,
    /// Where the deformed body intersects itself.
    pub intersection: SelfIntersection,
    /// Deformed volume of the cells whose centres lie in other cells.
    overlap: f64,
    /// Cells that the deformation made badly shaped, and the lowest scaled Jacobian among them with its cell.
    distorted: (usize, Option<(u32, f64)>),
    /// A displacement beyond any material.
    far: Option<String>,
    /// Chambers that have grown beyond what their walls bear.
    ballooned: Vec<String>,
    /// A compression beyond any; that of a motion is said of all instants together.
    compression: Option<Warning>,
    /// True electric fields beyond the breakdown strength.
    breakdowns: Vec<String>,
    /// Media of voids that carry too much.
    media: Vec<String>,
    /// What deserves attention in contacts; those of motions are found in all their steps.
    contacts: Vec<Warning>,
}

/// Why negative pivots were not counted.
#[derive(Debug, Clone)]
pub struct Uncounted {
    /// Whether the tangent is singular; else nothing is known about it.
    singular: bool,
    /// Whether there is nothing to count: a state in motion is no equilibrium.
    moving: bool,
    why: String,
}

impl Uncounted {
    /// As results have it.
    pub fn record(&self) -> UncountedRecord {
        UncountedRecord { singular: self.singular, why: Some(self.why.clone()) }
    }
}

impl Inspection {
    /// Of all members of an evaluated control.
    pub fn of_point(problem: &CaseProblem, point: &EnsemblePoint) -> Vec<Self> {
        let members: Vec<_> = problem.members().zip(&point.members).collect();
        members.par_iter().with_max_len(1).map(|(member, at)| Self::of(*member, at.state())).collect()
    }

    /// Of one state.
    pub fn of(member: CaseMember<'_>, state: &State) -> Self {
        if member.reduced().timeline().is_some() {
            let why = "a state in motion is no equilibrium".to_owned();
            return Self::counted_by(member, state, || Err(Uncounted { singular: false, moving: true, why }));
        }
        let uncounted =
            |error: StateError| Uncounted { singular: error.is_singular(), moving: false, why: error.to_string() };
        let found =
            || member.solid().model().stability().tangent_inertia(state, &SolveOptions::default()).map_err(uncounted);
        Self::counted_by(member, state, || found().map(|found| (found.negative, Some(found.by_factor))))
    }

    /// Of a state whose negative pivots may be known; else the reason is found anew.
    pub fn of_counted(member: CaseMember<'_>, state: &State, negative: Option<usize>) -> Self {
        match negative {
            Some(negative) => Self::counted_by(member, state, || Ok((negative, None))),
            None => Self::of(member, state),
        }
    }

    /// Counts pivots while it looks at the deformed cells.
    fn counted_by(
        member: CaseMember<'_>,
        state: &State,
        count: impl FnOnce() -> Result<(usize, Option<bool>), Uncounted> + Send,
    ) -> Self {
        let mesh = member.mesh();
        let positions = positions(mesh.points(), &member.solid().model().displacement(&state.u), mesh.dim());
        let intersect =
            || Shape::new(mesh, &positions, None).map(|shape| shape.self_intersection()).unwrap_or_default();
        let distort = || distorted(mesh, &positions);
        // that it cannot be told is told of the inertia
        let neutral =
            || member.solid().model().stability().neutral_motion(state, &SolveOptions::default()).ok().flatten();
        let neutral = member.reduced().timeline().is_none().then(neutral).flatten();
        let (inertia, (intersection, distorted)) = rayon::join(count, || rayon::join(intersect, distort));
        let lowest = distorted.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
        Self {
            inertia,
            free: neutral,
            overlap: overlap(member, state, &intersection),
            intersection,
            distorted: (distorted.len(), lowest),
            far: far(member, state),
            ballooned: ballooned(member, state),
            compression: match member.reduced().timeline() {
                None => compression(member, state.report.min_j, None),
                Some(_) => None,
            },
            breakdowns: breakdowns(member, state),
            media: media(member, state),
            contacts: contacts(member, state),
        }
    }

    /// The self-intersection, as results have it.
    pub fn intersection_record(&self) -> IntersectionRecord {
        IntersectionRecord { cells: self.intersection.cells().len(), volume: self.overlap.into() }
    }

    /// One value per cell: 1 where the body intersects itself; `None` if it does not.
    pub fn intersecting(&self, cells: usize) -> Option<Vec<f64>> {
        let found = self.intersection.cells();
        let mut marks = vec![0.0; cells];
        found.iter().for_each(|&cell| marks[cell as usize] = 1.0);
        (!found.is_empty()).then_some(marks)
    }

    /// What deserves attention in the state; the place of the warnings is `what`, behind the member's name.
    pub fn warnings(&self, member: CaseMember<'_>, what: &str) -> Vec<Warning> {
        let mut out = Vec::new();
        match &self.inertia {
            Ok((0, _)) | Err(Uncounted { moving: true, .. }) => {}
            Ok((n, _)) => {
                let pivots = count(*n, "negative pivot");
                out.push(Warning::new(&UNSTABLE, format!("{pivots} of the tangent stiffness")));
            }
            Err(Uncounted { singular, why, .. }) => {
                let kind = if *singular { &NEARLY_SINGULAR } else { &NOT_COUNTED };
                out.push(Warning::new(kind, format!("negative pivots not counted: {why}")));
            }
        }
        if !self.intersection.is_empty() {
            out.push(Warning::new(&SELF_INTERSECTION, self.describe_intersection(member)));
        }
        if let (count, Some((cell, lowest))) = self.distorted {
            let message =
                format!("{count} cells have a scaled Jacobian below {POOR}, the lowest is {lowest:.3} (cell {cell})");
            out.push(Warning::new(&CELL_SHAPE, message));
        }
        let extreme = self.far.iter().chain(&self.ballooned);
        out.extend(extreme.map(|what| Warning::new(&EXTREME_DEFORMATION, what.clone())));
        out.extend(self.compression.clone());
        out.extend(self.breakdowns.iter().map(|found| Warning::new(&BREAKDOWN, found.clone())));
        out.extend(self.media.iter().map(|found| Warning::new(&MEDIUM, found.clone())));
        out.extend(self.contacts.iter().cloned());
        let name = member.name();
        let place = if name.is_empty() { what.to_owned() } else { format!("{name}: {what}") };
        out.into_iter().map(|warning| warning.of(place.clone())).collect()
    }

    fn describe_intersection(&self, member: CaseMember<'_>) -> String {
        let SelfIntersection { overlapped, crossed } = &self.intersection;
        let (cells, unit) = (member.mesh().cells(), member.problem().units().length().symbol);
        let named = |cells: &[u32]| cells.iter().take(3).map(u32::to_string).collect::<Vec<_>>().join(", ");
        match overlapped.len() {
            0 => format!("the surfaces of {} cells cross (cells {} ..)", crossed.len(), named(crossed)),
            n => format!(
                "the centres of {n} of {cells} cells lie in other cells (cells {} ..), whose deformed size is {:.3e} {unit}^{}",
                named(overlapped),
                self.overlap,
                member.mesh().dim()
            ),
        }
    }
}

fn positions(points: &[[f64; 3]], u: &[f64], dim: usize) -> Vec<[f64; 3]> {
    let moved = |(x, u): (&[f64; 3], &[f64])| std::array::from_fn(|k| x[k] + u.get(k).copied().unwrap_or(0.0));
    points.iter().zip(u.chunks_exact(dim)).map(moved).collect()
}

/// A displacement that no law was measured for.
fn far(member: CaseMember<'_>, state: &State) -> Option<String> {
    let mesh = member.mesh();
    let u = &*member.solid().model().displacement(&state.u);
    // a body that flies deforms no more for it
    let carried = if state.velocity.is_some() { mean(u, mesh.dim()) } else { vec![0.0; mesh.dim()] };
    let farthest = u.chunks_exact(mesh.dim()).map(|u| norm(&sub(u, &carried))).fold(0.0, f64::max);
    let sizes = farthest / mesh.diagonal();
    let (unit, sizes_told) = (member.problem().units().length().symbol, short(sizes.round()));
    let message =
        format!("the largest displacement is {} {unit}, {sizes_told} times the size of the body", short(farthest));
    (sizes > FAR).then_some(message)
}

/// Chambers of many times their volume.
fn ballooned(member: CaseMember<'_>, state: &State) -> Vec<String> {
    let Ok(all) = summary::contributions(member, state) else { return Vec::new() };
    let case = member.case();
    let is_driven = |slot: &str| {
        let fixed = |own: &Actuation| own.fixed.iter().any(|(key, _)| format!("{}.{key}", own.name) == *slot);
        case.controls.iter().any(|control| control.of == slot) || case.actuation.iter().any(fixed)
    };
    let of = |(name, chamber): (&String, &ContributionRecord)| {
        let [volume, rest] = chamber.volumes()?;
        let times = volume / rest;
        (rest > 0.0 && times > BALLOONED).then(|| {
            let slot = format!("{name}.volume");
            let ramp = format!(". A ramp of its volume (\"{slot}\") shows where that is");
            format!(
                "chamber \"{name}\" has {} times its volume at rest: unless its walls lie on each other at rest it has ballooned, behind the largest \
                 pressure that it bears{}",
                short(times.round()),
                if is_driven(&slot) { "" } else { &ramp }
            )
        })
    };
    all.iter().filter_map(of).collect()
}

/// Media that store more than a share of the elastic energy.
fn media(member: CaseMember<'_>, state: &State) -> Vec<String> {
    let names: Vec<String> = member.case().media.iter().map(Block::name).collect();
    if names.is_empty() {
        return Vec::new();
    }
    let model = member.solid().model();
    let (Ok(stored), Ok(all)) = (model.energies().stored_energy(state), summary::contributions(member, state)) else {
        return Vec::new();
    };
    let of = |name: &String| {
        let energy = number_of(all.get(name)?, "energy")?;
        let message =
            || format!("\"{name}\" stores {} % of the elastic energy", short(100.0 * energy / stored.elastic));
        (energy > MOST_IN_A_MEDIUM * stored.elastic && stored.elastic > 0.0).then(message)
    };
    names.iter().filter_map(of).collect()
}

/// Penetrations and thick layers, of an equilibrium.
fn contacts(member: CaseMember<'_>, state: &State) -> Vec<Warning> {
    if member.reduced().timeline().is_some() {
        return Vec::new();
    }
    touches::warnings(member, state)
}

/// The mean of nodal vectors.
fn mean(u: &[f64], dim: usize) -> Vec<f64> {
    let nodes = u.len() / dim;
    (0..dim).map(|k| u.iter().skip(k).step_by(dim).sum::<f64>() / nodes as f64).collect()
}

/// Actuations beyond what their material bears at a point, in words.
fn breakdowns(member: CaseMember<'_>, state: &State) -> Vec<String> {
    let Ok(peaks) = member.solid().model().point_peaks(&Instant::of(state)) else { return Vec::new() };
    let units = member.problem().units();
    let shown = |peak: PointPeak| {
        let (share, limit) = peak.share.filter(|_| peak.beyond > 0)?;
        let limit = quantity(limit, Dimension::ELECTRIC_FIELD, units);
        let (name, cells) = (peak.actuation, peak.beyond);
        let [x, y, z] = member.mesh().cell_centre(peak.cell as usize).map(short);
        Some(format!(
            "{name}: the true field reaches {} times the breakdown strength {limit}, in {cells} cells beyond it, most in the one at ({x}, {y}, {z})",
            short(share)
        ))
    };
    peaks.into_iter().filter_map(shown).collect()
}

/// int J dX over the cells whose centres lie in others.
fn overlap(member: CaseMember<'_>, state: &State, found: &SelfIntersection) -> f64 {
    let disc = member.solid().discretization();
    let (Ok(fields), points) = (member.solid().cell_fields(state), disc.points_of_cells()) else { return f64::NAN };
    let volume = |&cell: &u32| {
        let (first, count) = points[cell as usize];
        fields.j[cell as usize] * disc.points().weights()[first..first + count].iter().sum::<f64>()
    };
    // Not `sum`, which is -0.0 of nothing.
    found.overlapped.iter().map(volume).fold(0.0, |all, one| all + one)
}

/// The cells that the displacement made badly shaped, with their scaled Jacobians.
fn distorted(mesh: &Mesh, positions: &[[f64; 3]]) -> Vec<(u32, f64)> {
    let (before, now) = rayon::join(|| mesh.quality(), || mesh.quality_at(positions));
    let worse = before.cells.iter().zip(&now.cells);
    worse
        .filter(|(before, now)| before.scaled_jacobian >= POOR && now.scaled_jacobian < POOR)
        .map(|(_, now)| (now.cell, now.scaled_jacobian))
        .collect()
}
