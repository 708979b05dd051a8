//! [`ControlRecord`]: what became of a control.

use crate::record::{Absent, ByName, Nullable, Number};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

records! {
    /// A control; lengths of vectors where it is one.
    ControlRecord {
        /// Its array in VTU files.
        array: Option<String>,
        /// What it drives.
        slot: Nullable<String>,
        /// Its space.
        space: Option<String>,
        /// The unit of its values.
        unit: Option<String>,
        /// Number of its values.
        unknowns: Option<usize>,
        /// The least of them.
        min: Number,
        /// The greatest.
        max: Number,
        /// Lower bound; null where there is none.
        lower: Number,
        /// Upper bound.
        upper: Number,
        /// How many values lie on a bound; vectors count once.
        active: Option<usize>,
        /// `active` as a share of the values, of vectors of their number.
        active_share: Number,
        /// Of an electric field, uniform or by region: least and largest voltage over the films at rest.
        voltage: Option<RangeRecord>,
        /// Total variation of a field over the body, int |grad m| dX with its jumps.
        total_variation: Number,
        /// Of a design: its mean over its region, of a density the share that is filled.
        volume: Number,
        /// Of a design s: the mean of 4 s (1 - s), 0 where it is 0 or 1 everywhere.
        greyness: Number,
        /// Of a density or a mixture at the optimum: the level above which the body in `design_NAME.stl` lies, so that it has the volume of the field.
        level: Number,
        /// The volume of that body as a share of its region, as `volume` of the field: another one where no level has that of the field.
        cut_volume: Number,
        /// Of that body its thinnest bar: of a mixture of its second law.
        smallest_bar: Option<WidthRecord>,
        /// The narrowest gap of what is left out of it; of a mixture the thinnest bar of its first law.
        smallest_gap: Option<WidthRecord>,
        /// Cells of a grid along its axes.
        grid: Option<Vec<u32>>,
        /// Instants of a control in time.
        instants: Option<Vec<Number>>,
        /// Of the spaces `uniform` and `region` the values: a number or vector, or by region one for each; in time a list of them.
        values: Option<ControlValues>,
        /// Of `check`: the tension up to which the law stays polyconvex.
        fiber_limit: Nullable<f64>,
    }

    /// The least distance of two opposite walls of a design at rest.
    WidthRecord {
        /// The distance.
        width: Number,
        /// Halfway between the walls.
        position: Vec<Number>,
    }

    /// Least and largest value of a control.
    RangeRecord {
        /// The least.
        min: Number,
        /// The largest.
        max: Number,
        /// Their unit, where it is not reported elsewhere.
        unit: Option<String>,
    }
}

/// The values of a control that has few.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ControlValues {
    /// One.
    One(Number),
    /// Components of a vector, or values at the instants of a control in time.
    List(Vec<ControlValues>),
    /// One for each region.
    ByRegion(ByName<ControlValues>),
}

impl Absent for ControlValues {
    fn is_absent(&self) -> bool {
        false
    }
}
