//! [`ExcessTension`]: tensions beyond what the laws bear.

/// Tensions beyond what the laws bear while they stay polyconvex, where that is so most.
///
/// At the point where `lambda = lambda_max(B^(-1/2) T B^(-1/2))` is largest, with the tensions
/// `T = sum_k m_k a_k (x) a_k` and the bound `B` of the laws. Source: survey, Prop. 1, for one family.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcessTension {
    /// Name of the actuation with the largest tension there.
    pub actuation: String,
    /// Its tension, Pa.
    pub tension: f64,
    /// What it may reach, Pa: `tension / lambda`, while those beside it change in proportion.
    pub limit: f64,
    /// Names of the other families that lengthen there, and their tensions, Pa.
    pub beside: Vec<(String, f64)>,
}
