//! Limit points and bifurcations between two points of a path.

use crate::nonlinear::iterate::Stop;
use crate::stability::arc_length::{PathEquations, PathIterate};
use crate::stability::path::{EventKind, PathEvent, too_long};

/// Tolerance of a bifurcation, as a share of the step.
const BISECTION_TOLERANCE: f64 = 1e-3;
/// Largest |s'| at a located limit point, as a share of its values at both ends.
const SLOPE_TOLERANCE: f64 = 1e-6;
/// Iterations after which a limit point counts as located.
const MAX_ITERATIONS: usize = 30;

/// Two neighbours on a path.
pub(crate) struct Between<'a> {
    pub here: &'a PathIterate,
    pub there: &'a PathIterate,
    /// Negative pivots at the first, or at the last before it where they are known.
    pub before: Option<usize>,
    /// Negative pivots at the second.
    pub after: Option<usize>,
    /// Index of the first in the path.
    pub index: usize,
}

/// What happens between two neighbours, in order; too long a step where a limit point and a bifurcation would have
/// to be distinguished and shorter steps can.
pub(crate) fn events(
    equations: &mut PathEquations,
    between: &Between,
    separable: bool,
) -> Result<Vec<PathEvent>, Stop> {
    let &Between { here, there, before, after, index } = between;
    let turns = here.slope() * there.slope() < 0.0;
    let counts = before.zip(after);
    if turns && separable && counts.is_some_and(|(before, after)| before.abs_diff(after) != 1) {
        return Err(too_long());
    }
    if turns {
        let found = limit_point(equations, here, there)?;
        let (s, state, direction) = (found.s(), equations.state(&found), found.direction());
        return Ok(vec![PathEvent { kind: EventKind::LimitPoint, point: index, s, state, direction, before, after }]);
    }
    counts.map_or(Ok(Vec::new()), |counts| bifurcations(equations, here, there, counts.0, counts.1, index))
}

/// Where s' = 0 between two points: regula falsi with the Illinois weights on the step length from the first.
fn limit_point(equations: &mut PathEquations, here: &PathIterate, there: &PathIterate) -> Result<PathIterate, Stop> {
    let (mut low, mut high) = (0.0, equations.along(here, there));
    let (mut at_low, mut at_high) = (here.slope(), there.slope());
    let level = SLOPE_TOLERANCE * at_low.abs().max(at_high.abs());
    let mut best = if at_low.abs() < at_high.abs() { here.clone() } else { there.clone() };
    let mut last_side = 0;
    for _ in 0..MAX_ITERATIONS {
        if best.slope().abs() <= level {
            break;
        }
        let length = (low * at_high - high * at_low) / (at_high - at_low);
        let point = match equations.step(here, length) {
            Err(Stop::Linear(_)) => break,
            done => done?,
        };
        let slope = point.slope();
        let side = if slope * at_low > 0.0 { -1 } else { 1 };
        if side < 0 {
            (low, at_low) = (length, slope);
            at_high *= if last_side == side { 0.5 } else { 1.0 };
        } else {
            (high, at_high) = (length, slope);
            at_low *= if last_side == side { 0.5 } else { 1.0 };
        }
        last_side = side;
        if slope.abs() < best.slope().abs() {
            best = point;
        }
    }
    Ok(best)
}

/// A point between two step lengths; `None` where the matrix is singular wherever it is tried, so near is the
/// bifurcation.
fn divide(
    equations: &mut PathEquations,
    here: &PathIterate,
    low: f64,
    high: f64,
) -> Result<Option<(f64, PathIterate)>, Stop> {
    for share in [0.5, 0.3, 0.7, 0.1, 0.9] {
        let middle = low + share * (high - low);
        match equations.step(here, middle) {
            Err(Stop::Linear(_)) => (),
            done => return Ok(Some((middle, done?))),
        }
    }
    Ok(None)
}

/// Where the number of negative pivots changes, by bisection; several changes one after the other.
fn bifurcations(
    equations: &mut PathEquations,
    here: &PathIterate,
    there: &PathIterate,
    mut before: usize,
    last: usize,
    index: usize,
) -> Result<Vec<PathEvent>, Stop> {
    let end = equations.along(here, there);
    let mut low = 0.0;
    let mut found = Vec::new();
    while before != last {
        let (mut high, mut after, mut at) = (end, last, there.clone());
        while high - low > BISECTION_TOLERANCE * end {
            let Some((middle, point)) = divide(equations, here, low, high)? else { break };
            // A singular tangent is where it is looked for: its other side counts.
            match equations.path_point(&point).negative {
                Some(count) if count == before => low = middle,
                count => (high, after, at) = (middle, count.unwrap_or(after), point),
            }
        }
        let (kind, s, state, direction) = (EventKind::Bifurcation, at.s(), equations.state(&at), at.direction());
        found.push(PathEvent { kind, point: index, s, state, direction, before: Some(before), after: Some(after) });
        (low, before) = (high, after);
    }
    Ok(found)
}
