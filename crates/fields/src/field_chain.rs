//! What stands between the unknowns of a field and its expansion over the body: values that are held, symmetry, filter, projection, by stages.

use crate::error::ControlError;
use crate::layout::Layout;
use crate::map::{Chain, ControlMap, Filter, Held, Mirror, Plane, PowerLaw, Projection, Staged, Step};
use nastic_fem::Solid;
use nastic_mesh::GroupNames;
use std::sync::Arc;

impl Layout {
    /// Smooths a field over a length: the [`Filter`] of its space, put there as by [`through`](Self::through).
    ///
    /// # Errors
    /// An unknown name, a length that is not positive, a field over points of a contribution.
    pub fn filter(&mut self, solid: &Solid, of: &str, length: f64) -> Result<(), ControlError> {
        let block = self.block(of)?;
        let filter = Filter::new(solid.discretization(), &block.basis, block.components, length)?;
        self.through(of, filter)
    }

    /// Gives a field one value in regions, whatever its unknowns are there: [`Held`], put there as by [`through`](Self::through); of a field
    /// [by its logarithm](Self::by_logarithm) the value too, not the logarithm.
    ///
    /// # Errors
    /// As of both; a value without a logarithm of a field by it.
    pub fn hold(&mut self, solid: &Solid, of: &str, regions: &GroupNames, value: f64) -> Result<(), ControlError> {
        let block = self.block(of)?;
        if block.log && value <= 0.0 {
            let what = format!("\"{of}\" cannot be {value} in a region: it is positive, by its logarithm");
            return Err(ControlError::Cost { what });
        }
        let value = if block.log { value.ln() } else { value };
        let held = Held::new(solid.discretization(), &block.basis, block.components, regions, value)?;
        self.through(of, held)
    }

    /// Takes the symmetric part of a field about a plane: [`Mirror`], put there as by [`through`](Self::through).
    ///
    /// # Errors
    /// As of both.
    pub fn mirror(&mut self, of: &str, plane: Plane) -> Result<(), ControlError> {
        let block = self.block(of)?;
        let mirror = Mirror::new(&block.basis, block.components, plane)?;
        self.through(of, mirror)
    }

    /// Projects a scalar field between two values, `low + (high - low) p((x - low)/(high - low))` with one [`Projection`] p for each stage, put there as by
    /// [`through`](Self::through).
    ///
    /// # Errors
    /// As there; no projection; a sharpness that is not positive, a threshold beyond 0 to 1, a range that is none; a field of vectors, or one by its logarithm.
    pub fn project(&mut self, of: &str, stages: &[Projection], [low, high]: [f64; 2]) -> Result<(), ControlError> {
        let fail = |what: String| Err(ControlError::Cost { what });
        let block = self.block(of)?;
        if block.components > 1 || block.log {
            return fail(format!("\"{of}\" is a vector, or a logarithm: a projection takes scalar fields"));
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            return fail(format!("the projection of \"{of}\" is between {low} and {high}: it needs two finite bounds"));
        }
        let sound = |p: &Projection| p.sharpness > 0.0 && p.sharpness.is_finite() && (0.0..=1.0).contains(&p.threshold);
        if let Some(p) = stages.iter().find(|p| !sound(p)) {
            let Projection { threshold, sharpness } = p;
            return fail(format!(
                "the projection of \"{of}\" has the threshold {threshold} and the sharpness {sharpness}: the first lies between 0 and 1, the second is positive"
            ));
        }
        let Some((last, first)) = stages.split_last() else {
            return fail(format!("the projection of \"{of}\" has no stage"));
        };
        let between = |projection: &Projection| {
            let (range, mut chain) = (high - low, Chain::default());
            let inner = PowerLaw { low: -low / range, high: (1.0 - low) / range, exponent: 1.0 };
            if [low, high] != [0.0, 1.0] {
                chain.push(Arc::new(inner));
            }
            chain.push(Arc::new(*projection));
            if [low, high] != [0.0, 1.0] {
                chain.push(Arc::new(PowerLaw { low, high, exponent: 1.0 }));
            }
            chain
        };
        match first.is_empty() {
            true => self.through(of, between(last)),
            false => {
                let first = first.iter().map(|own| Arc::new(between(own)) as Arc<dyn ControlMap>);
                self.through(of, Staged::new(first.collect(), between(last)))
            }
        }
    }

    /// Makes a scalar field by cell or region, or a uniform one, 0 or 1, by whether it is above a level: [`Step`], put there as by [`through`](Self::through).
    /// For solves: it has no derivative.
    ///
    /// # Errors
    /// As there; a level that is not finite; a field of another space, of vectors, or by its logarithm.
    pub fn cut(&mut self, of: &str, level: f64) -> Result<(), ControlError> {
        let block = self.block(of)?;
        if !block.can_be_cut() || !level.is_finite() {
            let what = format!(
                "\"{of}\" cannot be cut at {level}: scalar fields by cell or region and uniform ones can, not by their logarithms, at a finite level"
            );
            return Err(ControlError::Cost { what });
        }
        self.through(of, Step { level })
    }

    /// Number of stages in which the maps of its fields differ.
    pub fn stages(&self) -> usize {
        self.blocks().iter().map(|block| block.field.stages()).max().unwrap_or(1)
    }

    /// The same with the maps of a stage.
    pub fn in_stage(&self, stage: usize) -> Layout {
        let mut out = self.clone();
        out.blocks_mut().iter_mut().for_each(|block| block.field = block.field.in_stage(stage));
        out
    }
}
