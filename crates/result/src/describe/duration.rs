//! How long a trial takes on this machine, from a factorisation, or a box that multigrid solves, and the costs at rest.

use nastic_case::describe::{Line, MultigridPace, line};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{ControlError, Partials};
use nastic_fem::{Solver, available_memory};
use nastic_language::number::count;
use nastic_report::duration as text;
use std::time::Instant;

/// Larger factors take too long for a look at a case, in bytes.
const LARGEST: usize = 1 << 30;
/// A trial's Newton iterations, most of which reuse a factor, and its count of negative pivots, in assemblies and
/// factorisations in double precision: the mean over the shipped cases.
const FACTORISATIONS: f64 = 2.5;
/// The same in Newton iterations by multigrid.
const ITERATIONS: f64 = 4.0;
/// Counts of the shipped cases and of impacts in docs/contact.md.
const CONTACT: &str = "not estimated with contact: a stage of a step takes 3 to 5 Newton iterations while bodies are held or slide, 50 and more where they land or let go, an equilibrium 20 and more; nastic solve tells what they take";

/// How long trials will take, in words. One Newton iteration is measured for it.
pub fn duration(problem: &CaseProblem) -> Vec<Line> {
    let member = problem.member(0);
    let touches = !member.case().contact.is_empty();
    let (told, mut trial) = match newton(member) {
        Ok(found) => found,
        Err(_) if touches => return vec![line("duration", CONTACT)],
        Err(why) => return vec![line("duration", format!("not estimated: {why}"))],
    };
    let mut out = vec![line("duration", told)];
    if touches {
        out.push(line("duration", CONTACT));
        return out;
    }
    if !member.reduced().costs().is_empty() {
        let costs = match costs(problem, member) {
            Ok(seconds) => seconds,
            Err(why) => {
                out.push(line("duration", format!("of the costs not estimated: {why}")));
                return out;
            }
        };
        let points: Vec<String> = member.reduced().costs().iter().filter_map(|cost| cost.size()).collect();
        let points = if points.is_empty() { String::new() } else { format!(": {}", points.join("; ")) };
        out.push(line("duration", format!("the costs and their derivatives at rest: {}{points}", text(costs))));
        trial += costs;
    }
    if problem.lacks_steps() {
        let each = stages(member) as f64 * trial;
        let why = format!(
            "estimated for some four Newton iterations a stage of a step: a step {}; how many there are is not known before they are found",
            text(each)
        );
        out.push(line("duration", why));
        return out;
    }
    let steps = member.reduced().timeline().map(|timeline| timeline.steps() * timeline.scheme().stages());
    let members = problem.members().count();
    let all = trial * members as f64 * steps.unwrap_or(1) as f64;
    let each = if members > 1 { format!(" of {members} members") } else { String::new() };
    let per = if steps.is_some() { "stage of a step" } else { "trial" };
    let mut estimate = format!("estimated for some four Newton iterations a {per}: a trial{each} {}", text(all));
    if problem.has_costs() && !problem.start.is_empty() {
        let iterations = problem.case.optimizer.max_iterations;
        estimate += &format!(", {} {}", count(iterations, "iteration"), text(all * iterations as f64));
    }
    out.push(line("duration", estimate + "; hard problems take several times that"));
    out
}

/// Solves in each step of a motion.
fn stages(member: CaseMember<'_>) -> usize {
    member.reduced().timeline().map_or(1, |timeline| timeline.scheme().stages())
}

/// What solving takes, in words, and the seconds of the Newton iterations of a trial, or why they are not known.
fn newton(member: CaseMember<'_>) -> Result<(String, f64), String> {
    let (solid, structure) = (member.solid(), member.solid().model().tangent_structure());
    let available = available_memory().map_err(|error| error.to_string())?.unwrap_or(usize::MAX);
    if solid.model().solver() == Solver::MULTIGRID {
        let MultigridPace { seconds_per_unknown, unknowns } = MultigridPace::of_body(solid)?;
        let each = seconds_per_unknown * solid.discretization().dofs() as f64;
        let hard = "several times that where a material hardly changes its volume";
        let told =
            format!("a Newton iteration by multigrid, from a box of {unknowns} unknowns: {}, {hard}", text(each));
        return Ok((told, ITERATIONS * each));
    }
    if structure.factorisation_bytes() > available {
        return Err("the memory does not suffice for a factor".to_owned());
    }
    if structure.factor_bytes() > LARGEST {
        let faster = if solid.model().tangents().has_cell_products() {
            "; bodies of hex27 as large as this one are solved in less by multigrid (\"linear_solver\": \"multigrid\")"
        } else {
            ""
        };
        return Err(format!("making a factor as large as this one takes long{faster}"));
    }
    let began = Instant::now();
    solid.negative_pivots(&solid.rest()).map_err(|error| format!("the tangent at rest has no factor: {error}"))?;
    let seconds = began.elapsed().as_secs_f64();
    Ok((format!("the tangent at rest, assembled and factorised: {}", text(seconds)), FACTORISATIONS * seconds))
}

/// Seconds that all costs take for their values and derivatives.
fn costs(problem: &CaseProblem, member: CaseMember<'_>) -> Result<f64, ControlError> {
    let (m, rest) = (member.local(&problem.start), member.solid().rest());
    let began = Instant::now();
    let points = member.reduced().costs_at(&rest, &m, 0)?;
    let mut partials = Partials { u: vec![0.0; rest.u.len()], m: vec![0.0; m.len()] };
    points.iter().try_for_each(|point| point.add_partials(&mut partials))?;
    Ok(began.elapsed().as_secs_f64())
}
