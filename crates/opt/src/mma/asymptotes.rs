//! [`Asymptotes`]: how far they are from the control.

/// How far the asymptotes are from the control, in shares of the range of each component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymptotes {
    /// In the first two iterations of a stage.
    pub initial_distance: f64,
    /// Factor of a component that turns back.
    pub decrease: f64,
    /// Factor of a component that goes on.
    pub increase: f64,
    /// No turn brings them closer than this.
    pub min_distance: f64,
    /// Nor a move farther than this.
    pub max_distance: f64,
    /// Largest change of a component in an iteration.
    pub move_limit: f64,
}

impl Default for Asymptotes {
    fn default() -> Self {
        Self {
            initial_distance: 0.5,
            decrease: 0.7,
            increase: 1.2,
            min_distance: 0.01,
            max_distance: 10.0,
            move_limit: 0.2,
        }
    }
}
