//! [`Figure`]: a number that a cost reports beside its value.

use nastic_opt::TRUE_DISTANCE;

/// What a figure is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureKind {
    /// Smoothed Hausdorff distance rho of the deformed body from the target, weight not included.
    SmoothedDistance,
    /// Hausdorff distance of the same two solids without smoothing.
    TrueDistance,
    /// rho(T, T): the smoothed distance of the target from itself.
    SelfDistance,
    /// Root of the mean squared distance of tracked points from their targets.
    RootMeanSquareDistance,
    /// Largest distance of a tracked point from its target.
    LargestDistance,
    /// Distance of one point, or of the mean of a part of the body, from its target.
    PositionDistance,
    /// Smallest distance of a part of the body from an obstacle, negative inside of it.
    ObstacleDistance,
    /// A figure of another cost.
    Other(&'static str),
}

/// How far a point is from its target over a motion, at the instants at which its cost counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceInTime {
    /// The largest distance (m).
    pub largest: f64,
    /// Root of the mean of the squared distances (m), each instant counting once.
    pub root_mean_square: f64,
}

impl DistanceInTime {
    /// Of distances; nothing of none.
    pub(crate) fn of(distances: &[f64]) -> Option<Self> {
        let squares = distances.iter().map(|distance| distance * distance).sum::<f64>();
        let largest = distances.iter().copied().reduce(f64::max)?;
        Some(DistanceInTime { largest, root_mean_square: (squares / distances.len() as f64).sqrt() })
    }
}

impl FigureKind {
    /// Its key in results.
    pub fn name(self) -> &'static str {
        match self {
            FigureKind::SmoothedDistance => "smoothed",
            FigureKind::TrueDistance => "true",
            FigureKind::SelfDistance => "self",
            FigureKind::RootMeanSquareDistance => "root_mean_square",
            FigureKind::LargestDistance => "largest",
            FigureKind::PositionDistance => "position_distance",
            FigureKind::ObstacleDistance => "obstacle_distance",
            FigureKind::Other(name) => name,
        }
    }

    /// Its key in the figures of a control ([`Objective::figures`](nastic_opt::Objective::figures)) and in history lines; `None` of a
    /// figure that is not reported for every iteration.
    pub fn history_name(self) -> Option<&'static str> {
        match self {
            FigureKind::TrueDistance => Some(TRUE_DISTANCE),
            FigureKind::RootMeanSquareDistance => Some("tracking_root_mean_square"),
            FigureKind::LargestDistance => Some("tracking_largest"),
            FigureKind::PositionDistance => Some("position_distance"),
            FigureKind::SmoothedDistance
            | FigureKind::SelfDistance
            | FigureKind::ObstacleDistance
            | FigureKind::Other(_) => None,
        }
    }

    /// Whether it is one of the three Hausdorff distances.
    pub fn is_hausdorff(self) -> bool {
        matches!(self, FigureKind::SmoothedDistance | FigureKind::TrueDistance | FigureKind::SelfDistance)
    }

    /// Whether it is a distance of tracked points from their targets.
    pub fn is_tracking(self) -> bool {
        matches!(self, FigureKind::RootMeanSquareDistance | FigureKind::LargestDistance)
    }
}

/// A number that a cost reports beside its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// What it is.
    pub kind: FigureKind,
    /// Its value, in `unit`.
    pub value: f64,
    /// SI unit, empty for plain numbers.
    pub unit: &'static str,
}

impl Figure {
    /// A length in metres.
    pub fn length(kind: FigureKind, value: f64) -> Self {
        Figure { kind, value, unit: "m" }
    }
}
