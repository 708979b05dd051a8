//! [`Cause`]: why there may be no equilibrium.

use crate::body_energy::excess_tension::ExcessTension;
use crate::discretization::rigid_motions::FreeMotion;
use std::fmt;

/// Why there may be no equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub enum Cause {
    /// Towards this load the displacement grows as towards a limit point: the path of equilibria turns back there.
    LimitPoint {
        /// Estimated load of the limit point.
        load: f64,
    },
    /// Tensions beyond the convexity bound of the laws.
    Convexity(ExcessTension),
    /// Guides of a tendon or spring that run together, where its direction is undetermined.
    GuidesMeet(MeetingGuides),
    /// What contact alone holds moves on: nothing that touches it resists to a rigid motion.
    FreeMotion(FreeMotion),
    /// An equilibrium was found that is not stable, and none below it.
    Saddle {
        /// Negative eigenvalues of its tangent.
        negative: usize,
    },
    /// Nothing is known.
    Unknown,
}

/// Two neighbouring guides of a line that are a small share of their distance in the reference body apart.
#[derive(Debug, Clone, PartialEq)]
pub struct MeetingGuides {
    /// The tendon or spring.
    pub name: String,
    /// Where they are in the reference body.
    pub places: [[f64; 3]; 2],
    /// Their distance over that in the reference body.
    pub share: f64,
    /// The load of a limit point before that, if the path of equilibria was followed to one.
    pub limit: Option<f64>,
}

impl Cause {
    /// A stable name: `limit_point`, `convexity_bound`, `guides_meet`, `free_motion`, `saddle`, `unknown`.
    pub fn code(&self) -> &'static str {
        match self {
            Cause::LimitPoint { .. } => "limit_point",
            Cause::Convexity(_) => "convexity_bound",
            Cause::GuidesMeet(_) => "guides_meet",
            Cause::FreeMotion(_) => "free_motion",
            Cause::Saddle { .. } => "saddle",
            Cause::Unknown => "unknown",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::LimitPoint { load } => write!(
                f,
                "the path of equilibria seems to turn back at a limit point near {load:.4} of the way from the starting state to \
                 the controls and loads asked for: beyond it the body jumps to another equilibrium or has none; try a smaller \
                 control or load"
            ),
            Cause::Convexity(ExcessTension { actuation, tension, limit, beside }) => {
                write!(
                    f,
                    "the tension of \"{actuation}\" reaches {tension:.4e}, beyond {limit:.4e}, up to which the laws stay polyconvex"
                )?;
                for (k, (name, tension)) in beside.iter().enumerate() {
                    let before = if k == 0 { " with that of" } else { " and" };
                    write!(f, "{before} \"{name}\", {tension:.4e} there,")?;
                }
                let change = if beside.is_empty() { "" } else { " in proportion" };
                write!(f, "{change}: the energy may be unbounded below; keep it under the bound")
            }
            Cause::GuidesMeet(MeetingGuides { name, places: [a, b], share, limit }) => {
                if let Some(load) = limit {
                    write!(
                        f,
                        "the path of equilibria turns back at a limit point near {load:.4} of the way, and beyond it "
                    )?;
                }
                let [a, b] = [a, b].map(|x| format!("({:.4e}, {:.4e}, {:.4e})", x[0], x[1], x[2]));
                write!(
                    f,
                    "two guides of \"{name}\", at {a} and {b} in the reference body, run together: {share:.1e} of their distance is \
                     left, the body collapses between them; pull less, lead the cable through fewer points, or refine the mesh there"
                )
            }
            Cause::FreeMotion(FreeMotion { count, what, example }) => write!(
                f,
                "{what} {} held by contact alone, and where the solve ended nothing that touches it resists {count} of its rigid motions \
                 ({example}): give it something to rest on, begin nearer to it, hold it by a support or a weak foundation, or solve it as a \
                 motion, with friction",
                if what.contains("\" and ") { "are" } else { "is" }
            ),
            Cause::Saddle { negative } => write!(
                f,
                "that last one is not stable ({negative} negative pivots), and displacements along its softest mode lead to none of less \
                 potential: seek others by deflation, or try a smaller control or load, or a finer mesh"
            ),
            Cause::Unknown => f.write_str(
                "the body may have no stable equilibrium there: try a smaller control or load, or a finer mesh",
            ),
        }
    }
}
