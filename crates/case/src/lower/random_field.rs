//! Random fields of parameters of materials.

use super::context::Context;
use crate::warning::TRUNCATED_FIELD;
use nastic_ensemble::{Kept, Matern};
use nastic_fem::Discretization;
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Case, GaussianLaw, Kernel, LognormalLaw, Material, RandomParameter};
use nastic_language::syntax::At;
use nastic_mesh::GroupNames;
use nastic_uncertainty::{FieldLaw, Modes, RandomField, UnitModes};

/// Share of the variance that the modes of a field hold where their number is left out.
const ENERGY: f64 = 0.9;
/// Modes that hold less than this share of the variance make another field of it.
const HALF: f64 = 0.5;

/// A law of a random parameter that varies over the body.
pub(super) struct FieldBlock<'c> {
    at: At,
    path: &'c str,
    law: FieldLaw,
    mean: f64,
    deviation: f64,
    length: f64,
    modes: Option<f64>,
    kernel: Kernel,
}

impl<'c> FieldBlock<'c> {
    /// The field that a log-normal law is, if it is one.
    pub fn log_normal(one: &'c RandomParameter, law: &LognormalLaw) -> Option<Self> {
        let (mean, deviation, length, modes) = (law.mean, law.deviation, law.length?, law.modes);
        let kernel = law.kernel.clone().unwrap_or(Kernel::Exponential);
        let at = one.at.key("lognormal");
        Some(Self { at, path: &one.path, law: FieldLaw::LogNormal, mean, deviation, length, modes, kernel })
    }

    /// The field that a Gaussian law is, if it is one.
    pub fn gaussian(one: &'c RandomParameter, law: &GaussianLaw) -> Option<Self> {
        let (mean, deviation, length, modes) = (law.mean, law.deviation, law.length?, law.modes);
        let kernel = law.kernel.clone().unwrap_or(Kernel::Exponential);
        let at = one.at.key("gaussian");
        Some(Self { at, path: &one.path, law: FieldLaw::Gaussian, mean, deviation, length, modes, kernel })
    }

    /// The field over the region of its material; `None` after a complaint.
    pub fn build(&self, case: &Case, disc: &Discretization, context: &mut Context<'_>) -> Option<RandomField> {
        let region = self.region(case, context)?;
        match self.kernel {
            Kernel::Exponential => self.dense(region, disc, context),
            Kernel::Matern => self.sparse(region, disc, context),
        }
    }

    /// The region whose material has the parameter.
    fn region<'m>(&self, case: &'m Case, context: &mut Context<'_>) -> Option<&'m GroupNames> {
        let material = material_of(case, self.path);
        if material.is_none() {
            let message = "a random field is possible for a parameter of a material alone, as in \"materials/0/mu1\": leave \
                           out \"length\", or name such a parameter";
            context.complain(&self.at.parent().key("path"), message);
        }
        material.map(|found| &found.material.region)
    }

    fn dense(&self, region: &GroupNames, disc: &Discretization, context: &mut Context<'_>) -> Option<RandomField> {
        let modes = match self.modes {
            None => Modes::Energy(ENERGY),
            Some(share) if share < 1.0 => Modes::Energy(share),
            Some(count) => Modes::Count(count as usize),
        };
        let (mesh, region, mean, length) = (disc.mesh(), region.clone(), self.mean, self.length);
        let field = match self.law {
            FieldLaw::LogNormal => {
                RandomField::log_normal(mesh, region, mean, self.deviation / self.mean, length, modes)
            }
            FieldLaw::Gaussian => RandomField::gaussian(mesh, region, mean, self.deviation, length, modes),
        };
        let field = context.take(&self.at, field)?;
        let share = 100.0 * field.captured();
        let count = field.modes().len();
        let held = format!("{}: {count} modes hold {share:.1} % of the field's variance", self.path);
        match field.captured() < HALF {
            true => context.warn(&TRUNCATED_FIELD, &self.at, held),
            false => context.note(held),
        }
        Some(field)
    }

    fn sparse(&self, region: &GroupNames, disc: &Discretization, context: &mut Context<'_>) -> Option<RandomField> {
        let field = context.take(&self.at.key("length"), Matern::new(disc, region, self.length))?;
        let unit = context.units.label(Dimension::LENGTH);
        if self.length < field.spacing() {
            let message = format!(
                "the correlation length {} {unit} is below the mean size of the cells, {} {unit}: neighbouring cells vary together as the mesh has \
                 it, not as this length says",
                short(self.length),
                short(field.spacing())
            );
            context.warn(&TRUNCATED_FIELD, &self.at.key("length"), message);
        }
        let kept = match self.modes {
            None => Kept::Share(ENERGY),
            Some(share) if share < 1.0 => Kept::Share(share),
            Some(count) => Kept::Count(count as usize),
        };
        let modes =
            context.take(&self.at.key(if self.modes.is_some() { "modes" } else { "length" }), field.modes(kept))?;
        let [share, error] = modes.share;
        let distance = match modes.distance {
            Some(distance) => format!("falls to 0.14 at {} {unit} from the middle", short(distance)),
            None => "is above 0.14 everywhere".to_owned(),
        };
        let held = format!(
            "{}: {} modes hold {:.1} % of the field's variance (+- {:.1} %{}); they are scaled by cell to the deviation asked for, from {} to {} times its \
             variance; the correlation {distance}",
            self.path,
            modes.at_cells.len(),
            100.0 * share,
            100.0 * error,
            if modes.counted { ", none is missing" } else { "" },
            short(modes.before[0]),
            short(modes.before[1]),
        );
        match share < HALF {
            true => context.warn(&TRUNCATED_FIELD, &self.at, held),
            false => context.note(held),
        }
        let unit =
            UnitModes { cells: modes.cells, all_cells: disc.mesh().cells(), modes: modes.at_cells, captured: share };
        context.take(&self.at, RandomField::of_modes(self.law, self.mean, self.deviation, unit))
    }
}

/// The number of a material that a path leads to.
pub(super) struct NumberOfMaterial<'c> {
    pub index: usize,
    pub material: &'c Material,
    pub number: String,
}

/// What a path as `materials/0/mu1` or `materials/0/parameters/mu1` leads to, if it is a number of a material.
pub(super) fn material_of<'c>(case: &'c Case, path: &str) -> Option<NumberOfMaterial<'c>> {
    let steps: Vec<&str> = path.split('/').collect();
    let (index, key, own) = match steps.as_slice() {
        ["materials", k, key] => (k.parse::<usize>().ok()?, *key, None),
        ["materials", k, key, name] => (k.parse::<usize>().ok()?, *key, Some(*name)),
        _ => return None,
    };
    let material = case.materials.get(index)?;
    let input = material.parameters.iter().find(|(name, _)| **name == key).map(|(_, input)| input)?;
    let number = match own {
        None => input.number().map(|_| key),
        Some(name) => input.number_named(name).map(|_| name),
    };
    Some(NumberOfMaterial { index, material, number: number?.to_owned() })
}
