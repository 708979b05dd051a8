//! [`PointQuantity`]: what an actuation is judged by at every point.

/// A number at every quadrature point that an actuation has to be judged by, beside the state it drives: the true electric field of
/// a dielectric, say. See [`EnergyTerm::point_values`](crate::EnergyTerm::point_values).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointQuantity {
    /// Its name in results.
    pub name: &'static str,
    /// `V/m` ...
    pub unit: &'static str,
}
