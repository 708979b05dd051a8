//! [`Chain`]: control maps one after the other.

use super::ControlMap;
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// `f = f_n o .. o f_1`, the first link at the unknowns; without links the identity.
///
/// With `x_k = f_k(x_k-1)`, `d_k = f_k'(x_k-1) d_k-1` and, backwards, `g_k-1 = f_k'(x_k-1)^T g_k`,
///
/// `second_vjp`: `h_n = 0`, `h_k-1 = f_k'(x_k-1)^T h_k + (f_k''(x_k-1) d_k-1)^T g_k`.
#[derive(Debug, Clone, Default)]
pub struct Chain(Vec<Arc<dyn ControlMap>>);

impl Chain {
    /// The same with one more link, at the points' end.
    #[must_use]
    pub fn then(mut self, link: impl ControlMap + 'static) -> Self {
        self.push(Arc::new(link));
        self
    }

    /// Whether it is the identity.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Number of links.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn push(&mut self, link: Arc<dyn ControlMap>) {
        self.0.push(link);
    }

    /// The links as they are in a stage.
    pub(crate) fn in_stage(&self, stage: usize) -> Chain {
        Chain(self.0.iter().map(|link| link.at_stage(stage).unwrap_or_else(|| link.clone())).collect())
    }

    /// The links with what each is evaluated at.
    fn at(&self, x: &[f64]) -> Vec<(&dyn ControlMap, Vec<f64>)> {
        let mut at = Vec::with_capacity(self.0.len());
        let mut here = x.to_vec();
        for (k, link) in self.0.iter().enumerate() {
            let next = if k + 1 < self.0.len() { link.values(&here) } else { vec![] };
            at.push((link.as_ref(), std::mem::replace(&mut here, next)));
        }
        at
    }
}

impl ControlMap for Chain {
    fn describe(&self) -> String {
        self.0.iter().map(|link| link.describe()).collect::<Vec<_>>().join(", ")
    }

    fn shared(&self) -> String {
        self.0.iter().map(|link| link.shared()).collect::<Vec<_>>().join(", ")
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.0.iter().fold(x.to_vec(), |x, link| link.values(&x))
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        self.at(x).into_iter().fold(v.to_vec(), |v, (link, x)| link.change(&x, &v))
    }

    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.at(x).into_iter().rev().fold(g.to_vec(), |g, (link, x)| link.vjp(&x, &g))
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        let at = self.at(x);
        let mut along = Vec::with_capacity(at.len());
        let mut v = v.to_vec();
        for (link, x) in &at {
            let next = link.change(x, &v);
            along.push(std::mem::replace(&mut v, next));
        }
        let (mut g, mut change) = (g.to_vec(), None::<Vec<f64>>);
        for ((link, x), v) in at.iter().zip(&along).rev() {
            let own = link.second_vjp(x, v, &g);
            change = match (change.map(|change| link.vjp(x, &change)), own) {
                (Some(mut change), Some(own)) => {
                    axpy(1.0, &own, &mut change);
                    Some(change)
                }
                (one, other) => one.or(other),
            };
            g = link.vjp(x, &g);
        }
        change
    }

    fn is_affine(&self) -> bool {
        self.0.iter().all(|link| link.is_affine())
    }

    fn stages(&self) -> usize {
        self.0.iter().map(|link| link.stages()).max().unwrap_or(1)
    }

    fn at_stage(&self, stage: usize) -> Option<Arc<dyn ControlMap>> {
        (self.stages() > 1).then(|| Arc::new(self.in_stage(stage)) as Arc<dyn ControlMap>)
    }

    fn length(&self) -> Option<f64> {
        self.0.last().and_then(|link| link.length())
    }
}
