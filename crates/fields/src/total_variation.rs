//! The total variation of a control field.

use crate::control_block::ControlBlock;
use crate::field_operator::for_each_face;
use crate::map::{Scaling, Space};
use nastic_fem::Discretization;
use nastic_numeric::vector::norm;

impl ControlBlock {
    /// The total variation `int |Dm|` of this field with these values, its part of a control vector: `int |grad m| dX`
    /// (Frobenius norm) of a field between nodes or on a grid, of its vectors as
    /// [`Layout::fix_length`](crate::Layout::fix_length) leaves them; of a field that is constant in cells or regions the sum
    /// over inner faces of `area |jump|`. Zero of one value; not a number by point, where there are no neighbours, nor of a body over ranks. Of a field in time the mean over the time. Unit: the values' times
    /// an area (of a plane body a length).
    ///
    /// Where it grows without bound as the control mesh is refined, the fields have no limit of bounded variation.
    ///
    /// Source: Ambrosio, Fusco, Pallara, Functions of Bounded Variation, 2000, section 3.1.
    pub fn total_variation(&self, disc: &Discretization, values: &[f64]) -> f64 {
        match &self.knots {
            _ if disc.over_ranks().is_some() => f64::NAN,
            None => self.total_variation_at(disc, values),
            Some(knots) => {
                let of_knots = values.chunks_exact(self.size().max(1)).zip(knots.shares());
                of_knots.map(|(values, share)| share * self.total_variation_at(disc, values)).sum()
            }
        }
    }

    fn total_variation_at(&self, disc: &Discretization, values: &[f64]) -> f64 {
        let n = self.components;
        match self.basis.space() {
            Space::Uniform => 0.0,
            Space::Point => f64::NAN,
            Space::Cell | Space::Region => {
                let mut sum = 0.0;
                for_each_face(disc, &self.basis, |[a, b], area, _| {
                    let jump = |c: usize| values[a as usize * n + c] - values[b as usize * n + c];
                    sum += area * norm(&(0..n).map(jump).collect::<Vec<_>>());
                });
                sum
            }
            Space::Node | Space::Grid(_) => self.gradient_integral(disc, values),
        }
    }

    /// `int |grad m| dX` by the quadrature points.
    fn gradient_integral(&self, disc: &Discretization, values: &[f64]) -> f64 {
        let n = self.components;
        let mut sum = 0.0;
        for (q, basis) in self.basis.gradients(disc).into_iter().enumerate() {
            let mut value = vec![0.0; n];
            let mut slopes = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
            for (i, shape, gradient) in basis {
                for c in 0..n {
                    let m = values[i as usize * n + c];
                    value[c] += shape * m;
                    slopes.iter_mut().zip(gradient).for_each(|(slope, g)| slope[c] += g * m);
                }
            }
            if let Some(length) = self.length() {
                let scaling = Scaling::new(length, &value);
                slopes.iter_mut().for_each(|slope| *slope = scaling.derivative(slope));
            }
            sum += self.basis.weights(disc)[q] * norm(&slopes.concat());
        }
        sum
    }
}
