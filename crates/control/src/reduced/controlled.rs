//! What a [`Reduced`] problem controls.

use super::Reduced;
use nastic_fields::{Consumer, ControlError, ControlMap, Plane, Projection, Shown, Space};
use nastic_mesh::GroupNames;

impl Reduced {
    /// Adds a control field on an actuation (`NAME`, or `NAME.SLOT` where it has several).
    ///
    /// # Errors
    /// Unknown names, a field given twice, a space that does not fit.
    pub fn control(mut self, of: &str, space: Space) -> Result<Self, ControlError> {
        self.layout.control(&self.solid, of, space)?;
        self.update_layout();
        Ok(self)
    }

    /// Gives the vectors of a control field one length at every point, also between the nodes: a magnetisation. To be
    /// minimised over a [`Sphere`](nastic_opt::Sphere) of that radius.
    ///
    /// # Errors
    /// As [`Layout::fix_length`](crate::Layout::fix_length).
    pub fn of_length(mut self, control: &str, length: f64) -> Result<Self, ControlError> {
        self.layout.fix_length(control, length)?;
        self.update_layout();
        Ok(self)
    }

    /// Makes the logarithm of a positive control field the unknown: [`Layout::by_logarithm`](crate::Layout::by_logarithm).
    ///
    /// # Errors
    /// As there.
    pub fn by_logarithm(mut self, control: &str) -> Result<Self, ControlError> {
        self.layout.by_logarithm(control)?;
        self.update_layout();
        Ok(self)
    }

    /// Puts a map between the unknowns of a control field and their expansion: [`Layout::through`](crate::Layout::through).
    ///
    /// # Errors
    /// As there.
    pub fn through(mut self, control: &str, map: impl ControlMap + 'static) -> Result<Self, ControlError> {
        self.layout.through(control, map)?;
        self.check_stages(control)?;
        self.update_layout();
        Ok(self)
    }

    /// Smooths a control field over a length: [`Layout::filter`](crate::Layout::filter).
    ///
    /// # Errors
    /// As there.
    pub fn filter(mut self, control: &str, length: f64) -> Result<Self, ControlError> {
        self.layout.filter(&self.solid, control, length)?;
        self.update_layout();
        Ok(self)
    }

    /// Gives a control field one value in regions: [`Layout::hold`](crate::Layout::hold).
    ///
    /// # Errors
    /// As there.
    pub fn hold(mut self, control: &str, regions: impl Into<GroupNames>, value: f64) -> Result<Self, ControlError> {
        self.layout.hold(&self.solid, control, &regions.into(), value)?;
        self.update_layout();
        Ok(self)
    }

    /// Takes the symmetric part of a control field: [`Layout::mirror`](crate::Layout::mirror).
    ///
    /// # Errors
    /// As there.
    pub fn mirror(mut self, control: &str, plane: Plane) -> Result<Self, ControlError> {
        self.layout.mirror(control, plane)?;
        self.update_layout();
        Ok(self)
    }

    /// Projects a control field, from stage to stage more sharply: [`Layout::project`](crate::Layout::project).
    ///
    /// # Errors
    /// As there; several stages of a problem in time.
    pub fn project(mut self, control: &str, stages: &[Projection], range: [f64; 2]) -> Result<Self, ControlError> {
        self.layout.project(control, stages, range)?;
        self.check_stages(control)?;
        self.update_layout();
        Ok(self)
    }

    /// Makes a control field 0 or 1, by whether it is above a level: [`Layout::cut`](crate::Layout::cut).
    ///
    /// # Errors
    /// As there.
    pub fn cut(mut self, control: &str, level: f64) -> Result<Self, ControlError> {
        self.layout.cut(control, level)?;
        self.update_layout();
        Ok(self)
    }

    /// Refuses maps that change from stage to stage in a problem in time.
    fn check_stages(&self, control: &str) -> Result<(), ControlError> {
        let stages = self.layout.stages();
        if stages == 1 || self.motion.is_none() {
            return Ok(());
        }
        let what = format!(
            "a map of \"{control}\" has {stages} stages, which a motion has not: give one, of a projection one sharpness"
        );
        Err(ControlError::Cost { what })
    }

    /// Adds the amplitude of a vector along a fixed direction as a control field.
    ///
    /// # Errors
    /// As [`control`](Self::control); a slot that is no vector, a direction without a length.
    pub fn control_along(mut self, of: &str, space: Space, direction: [f64; 3]) -> Result<Self, ControlError> {
        self.layout.control_along(&self.solid, of, space, direction)?;
        self.update_layout();
        Ok(self)
    }

    /// Adds a design field, a scalar without unit from which the slots of several actuations and contributions follow: [`Layout::design`](crate::Layout::design).
    ///
    /// # Errors
    /// As there.
    pub fn design(mut self, name: &str, space: Space, consumers: &[Consumer]) -> Result<Self, ControlError> {
        self.layout.design(&self.solid, name, space, consumers)?;
        self.update_layout();
        Ok(self)
    }

    /// How messages are to call a control field: [`Layout::show`](crate::Layout::show).
    ///
    /// # Errors
    /// As there.
    pub fn show(mut self, control: &str, shown: Shown) -> Result<Self, ControlError> {
        self.layout.show(control, shown)?;
        self.update_layout();
        Ok(self)
    }

    /// Weighs a control field against the others in the inner product: [`Layout::weigh`](crate::Layout::weigh).
    ///
    /// # Errors
    /// As there.
    pub fn weigh(mut self, control: &str, weight: f64) -> Result<Self, ControlError> {
        self.layout.weigh(control, weight)?;
        self.update_layout();
        Ok(self)
    }

    /// Fixes a slot of an actuation that is not controlled, from one value per quadrature point.
    ///
    /// # Errors
    /// Wrong length or values that are not finite.
    pub fn fix(mut self, actuation: usize, slot: usize, at_points: &[f64]) -> Result<Self, ControlError> {
        self.layout.fixed_mut().set(actuation, slot, at_points)?;
        self.update_layout();
        Ok(self)
    }
}
