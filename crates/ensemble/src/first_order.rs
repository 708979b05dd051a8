//! [`FirstOrder`]: mean and deviation of a cost to first order in uncertain numbers, without scenarios.

use crate::error::EnsembleError;
use nastic_numeric::vector::{axpy, dot};

/// The risk `q(m) + c sqrt(D(m)^2 + (s q)^2)` of one scenario: the cost q at the medians of its [uncertain numbers](nastic_control::Reduced::uncertain) x, and its
/// deviation to first order, `D = |S^T q_x|`, `x = median + S xi`, xi independent of variance 1.
///
/// Its derivative is exact: `(1 + c s^2 q/r) q_m + (c/r) q_mx S S^T q_x`, `r = sqrt(D^2 + (s q)^2)`: one adjoint, two linear solves more, however many
/// random numbers there are. D has a kink where it is zero, which s rounds. The expansion is about the median: of log-normal numbers figures about the mean differ by factors
/// `exp(v/2)`.
///
/// Constraints are those at the medians.
///
/// Source: A. Alexanderian, N. Petra, G. Stadler & O. Ghattas, SIAM/ASA J. Uncertainty Quantification 5 (2017) 1166-1192, doi 10.1137/16M106306X, to first order.
#[derive(Debug, Clone)]
pub struct FirstOrder {
    /// c, a number of deviations.
    pub deviations: f64,
    /// s, the width over which the kink is rounded as a share of the cost.
    pub smoothing: f64,
    /// The uncertain numbers, in the order in which every member has them.
    pub sources: Vec<UncertainSource>,
}

/// An uncertain number, or a field of them.
#[derive(Debug, Clone)]
pub struct UncertainSource {
    /// What results call it.
    pub name: String,
    /// The rows of `S^T`: by random number, by value.
    pub slopes: Vec<Vec<f64>>,
    /// Parts of a field that results tell apart, with the places of their values; none of a number.
    pub parts: Vec<(String, Vec<usize>)>,
}

/// Cost and deviation at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrderPoint {
    /// The cost q at the medians, to first order the mean.
    pub mean: f64,
    /// D.
    pub deviation: f64,
    /// What a unit of the deviation D is rounded to, r.
    pub rounded: f64,
    /// `q_x`.
    pub(crate) by_number: Vec<f64>,
    /// `q_m`.
    pub(crate) by_control: Vec<f64>,
}

/// What of the variance `D^2` an uncertain number makes.
#[derive(Debug, Clone, PartialEq)]
pub struct VarianceShare {
    /// The number, or the field.
    pub name: String,
    /// The part of the field, of one that has several.
    pub part: Option<String>,
    /// The share. Of parts of a field, which go together, it may be negative.
    pub share: f64,
}

impl FirstOrder {
    /// `S S^T q_x`, and D.
    fn direction(&self, by_number: &[f64]) -> (Vec<f64>, f64) {
        let (mut out, mut square, mut first) = (vec![0.0; by_number.len()], 0.0, 0);
        for source in &self.sources {
            let len = source.len();
            let (own, out) = (&by_number[first..first + len], &mut out[first..first + len]);
            for slopes in &source.slopes {
                let slope = dot(slopes, own);
                square += slope * slope;
                axpy(slope, slopes, out);
            }
            first += len;
        }
        (out, square.sqrt())
    }

    pub(crate) fn along(&self, point: &FirstOrderPoint) -> Vec<f64> {
        self.direction(&point.by_number).0
    }

    pub(crate) fn point(&self, mean: f64, by_number: Vec<f64>, by_control: Vec<f64>) -> FirstOrderPoint {
        let deviation = self.direction(&by_number).1;
        let rounded = deviation.hypot(self.smoothing * mean);
        FirstOrderPoint { mean, deviation, rounded, by_number, by_control }
    }

    /// The risk.
    pub fn value(&self, point: &FirstOrderPoint) -> f64 {
        point.mean + self.deviations * point.rounded
    }

    /// Factors of `q_m` beyond that of the cost, and of `q_mx S S^T q_x`, in the derivative.
    pub(crate) fn factors(&self, point: &FirstOrderPoint) -> [f64; 2] {
        match point.rounded {
            0.0 => [0.0; 2],
            r => [self.deviations * self.smoothing * self.smoothing * point.mean / r, self.deviations / r],
        }
    }

    /// The uncertain numbers by their shares of the variance, the largest first.
    pub fn shares(&self, point: &FirstOrderPoint) -> Vec<VarianceShare> {
        let direction = self.along(point);
        let total = (point.deviation * point.deviation).max(f64::MIN_POSITIVE);
        let (mut out, mut first) = (Vec::new(), 0);
        for source in &self.sources {
            let share = |at: usize| point.by_number[first + at] * direction[first + at] / total;
            if source.parts.is_empty() {
                let share = (0..source.len()).map(share).sum();
                out.push(VarianceShare { name: source.name.clone(), part: None, share });
            }
            for (part, places) in &source.parts {
                let share = places.iter().map(|at| share(*at)).sum();
                out.push(VarianceShare { name: source.name.clone(), part: Some(part.clone()), share });
            }
            first += source.len();
        }
        out.sort_by(|a, b| b.share.total_cmp(&a.share));
        out
    }

    /// Whether members with these uncertain numbers fit it.
    pub(crate) fn check(&self, who: &str, numbers: &[(&str, usize)]) -> Result<(), EnsembleError> {
        let fail = |what: String| Err(EnsembleError::FirstOrder { who: who.to_owned(), what });
        for (name, value) in [("deviations", self.deviations), ("smoothing", self.smoothing)] {
            if !(value.is_finite() && value >= 0.0) {
                return fail(format!("{name} is {value}; it is not negative"));
            }
        }
        let own: Vec<usize> = self.sources.iter().map(UncertainSource::len).collect();
        if own.is_empty() || own != numbers.iter().map(|(_, len)| *len).collect::<Vec<_>>() {
            return fail(format!("its sources have {own:?} values, the uncertain numbers of the body are {numbers:?}"));
        }
        match self.sources.iter().find(|source| source.slopes.iter().any(|row| row.len() != source.len())) {
            Some(source) => fail(format!("the slopes of \"{}\" are of different lengths", source.name)),
            None => Ok(()),
        }
    }
}

impl UncertainSource {
    /// Number of its values.
    fn len(&self) -> usize {
        self.slopes.first().map_or(0, Vec::len)
    }
}

impl FirstOrderPoint {
    /// The numbers behind the members of a saved point.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let all = [self.mean, self.deviation, self.rounded];
        let all = all.iter().chain(&self.by_number).chain(&self.by_control);
        all.flat_map(|x| x.to_le_bytes()).collect()
    }

    /// Those that a point with so many controls has left.
    pub(crate) fn from_bytes(bytes: &[u8], controls: usize) -> Option<Self> {
        let (chunks, rest) = bytes.as_chunks::<8>();
        let all: Vec<f64> = chunks.iter().map(|own| f64::from_le_bytes(*own)).collect();
        let ([mean, deviation, rounded], behind) = all.split_first_chunk::<3>().filter(|_| rest.is_empty())?;
        let (by_number, by_control) = behind.split_at(behind.len().checked_sub(controls)?);
        let (by_number, by_control) = (by_number.to_vec(), by_control.to_vec());
        Some(FirstOrderPoint { mean: *mean, deviation: *deviation, rounded: *rounded, by_number, by_control })
    }
}
