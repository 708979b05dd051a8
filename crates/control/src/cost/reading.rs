//! [`Reading`]: what was read at a marker, beside what the body shows there.

/// A marker of a shot beside the body: its residuals `(x_i - y_i) / s` are what a least-squares cost sums the squares of.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its name, or its place in the table.
    pub name: String,
    /// `x_i - y_i` of the coordinates that were read, in the body's length.
    pub gap: [Option<f64>; 3],
    /// The standard deviation s of each coordinate, in the body's length; that of the cost's weight w: `s / sqrt(w)`.
    pub deviation: f64,
}

impl Reading {
    /// The distance over the coordinates that were read.
    pub fn distance(&self) -> f64 {
        self.gap.iter().flatten().map(|gap| gap * gap).sum::<f64>().sqrt()
    }

    /// How many coordinates were read.
    pub fn count(&self) -> usize {
        self.gap.iter().flatten().count()
    }
}
