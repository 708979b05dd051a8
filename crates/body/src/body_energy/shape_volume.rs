//! det G of the change of a body's shape, with its derivatives by the controls.

use crate::body_energy::BodyEnergy;
use crate::controls::Controls;
use nastic_energy::{MaterialPoint, StrainMap};
use nastic_tensor::HyperDual;

impl BodyEnergy {
    /// The reference volume of every quadrature point whose shape changes, and det G there, the share of it that is left; empty of a body whose shape stays.
    pub fn shape_volumes(&self, controls: &Controls) -> Vec<[f64; 2]> {
        let weights = self.disc.points().weights();
        let volume = |map: &dyn StrainMap, at, g: &[f64]| map.volume(at, &numbers(g, None, None)).real();
        self.each_shape_point(controls, |map, at, g| [weights[at.point], volume(map, at, g)])
    }

    /// `d det G [v]` at these points.
    pub fn shape_volume_changes(&self, controls: &Controls, v: &Controls) -> Vec<f64> {
        let Some((k, law)) = self.shape() else { return Vec::new() };
        self.each_shape_point(controls, |map, at, g| {
            map.volume(at, &numbers(g, None, Some(law.slots_at(v.values(k), at)))).0[2]
        })
    }

    /// Adds `sum_q b_q d det G_q/dm` for numbers b by point; with a change v `sum_q b_q d2 det G_q/dm2 v`.
    pub fn add_shape_volume_vjp(
        &self,
        controls: &Controls,
        v: Option<&Controls>,
        by_volume: &[f64],
        out: &mut Controls,
    ) {
        let Some((k, law)) = self.shape() else { return };
        let (width, global) = (law.law.slots().len(), law.is_global());
        let mut rows = by_volume.iter();
        self.each_shape_point(controls, |map, at, g| {
            let by = rows.next().copied().unwrap_or_default();
            let v = v.map(|v| law.slots_at(v.values(k), at));
            let first = if global { 0 } else { at.point * width };
            for slot in 0..width {
                let volume = map.volume(at, &numbers(g, Some(slot), v));
                out.values_mut(k)[first + slot] += by * volume.0[if v.is_some() { 3 } else { 1 }];
            }
        });
    }

    /// Something of every point of the change of shape, with its slots there, in their order.
    fn each_shape_point<T>(
        &self,
        controls: &Controls,
        mut each: impl FnMut(&dyn StrainMap, MaterialPoint, &[f64]) -> T,
    ) -> Vec<T> {
        let Some((k, law)) = self.shape() else { return Vec::new() };
        let Some(map) = law.law.strain_map() else { return Vec::new() };
        self.places(k).map(|at| each(map, at, law.slots_at(controls.values(k), at))).collect()
    }
}

/// Slots with derivatives along one of them first, along changes of all second.
fn numbers(g: &[f64], along: Option<usize>, v: Option<&[f64]>) -> Vec<HyperDual> {
    let number =
        |(k, g): (usize, &f64)| HyperDual([*g, f64::from(u8::from(along == Some(k))), v.map_or(0.0, |v| v[k]), 0.0]);
    g.iter().enumerate().map(number).collect()
}
