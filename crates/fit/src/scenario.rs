use crate::Fit;

/// One of several materials that stand for an uncertain one.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its probability.
    pub probability: f64,
    /// Parameters in the order of the law, without the bulk modulus.
    pub parameters: Vec<f64>,
}

/// Materials of equal probability with mean and covariance of the fit in its free numbers, along the principal directions of their covariance:
/// `x +- sqrt(d) s_k v_k` for the d directions that the data determine (S. J. Julier & J. K. Uhlmann, Proc. IEEE 92, 2004, 401-422,
/// doi 10.1109/JPROC.2003.823141). Directions in which x is uncertain by more than 1, a factor of e, are left out: there the data decide nothing,
/// and the linearisation that the covariance is says nothing. All are admissible, for the free numbers are. Empty without a covariance.
pub fn scenarios(fit: &Fit) -> Vec<Scenario> {
    let free = &fit.free;
    let Some(covariance) = &free.covariance else { return vec![] };
    let eigen = covariance.clone().symmetric_eigen();
    let largest = eigen.eigenvalues.iter().filter(|value| **value < 1.0).fold(0.0f64, |most, value| most.max(*value));
    let determined = |value: f64| value < 1.0 && value > 1e-12 * largest;
    let mut directions: Vec<usize> = (0..free.x.len()).filter(|k| determined(eigen.eigenvalues[*k])).collect();
    directions.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let count = directions.len() as f64;
    let mut out = Vec::new();
    for k in directions {
        let length = (count * eigen.eigenvalues[k]).sqrt();
        // Either sign of an eigenvector is one: the one whose largest entry is positive.
        let vector = eigen.eigenvectors.column(k);
        let turn = if vector[vector.icamax()] < 0.0 { -1.0 } else { 1.0 };
        for sign in [-1.0, 1.0] {
            let x: Vec<f64> = free.x.iter().zip(vector.iter()).map(|(x, v)| x + sign * turn * length * v).collect();
            let parameters = fit.law.decode(&x, &free.scale, &free.signs);
            out.push(Scenario { probability: 0.5 / count, parameters });
        }
    }
    out
}
