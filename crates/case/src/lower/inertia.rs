//! What acts in motion alone, and weight: masses, viscous laws, Rayleigh damping.

use super::context::Context;
use super::field::SamplePoints;
use super::named::{attempt, complain_of_law};
use super::{design, gravity, magnitude, named_groups};
use nastic_energy::{EnergyError, Field, KelvinVoigt, MaxwellBranch, SpringMeasure};
use nastic_fem::{Inertia, Solid};
use nastic_language::schema::{Case, MassKind, Material, Parameter, SpringMeasure as MeasureBlock};
use nastic_language::syntax::At;

/// Gives the body its masses, viscous laws and weight; Rayleigh damping comes last, as it knows of all others.
pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for material in &case.materials {
        if named_groups::cells(&solid.mesh().clone(), &material.region, &material.at.key("region"), context).is_some() {
            add_viscosity(case, material, solid, context);
        }
    }
    if !context.is_sound() {
        return;
    }
    add_mass(case, solid, context);
    gravity::add(case, solid, context);
    let rayleigh = case.time.as_ref().and_then(|time| time.rayleigh.as_ref());
    if let Some(damping) = rayleigh.filter(|_| context.is_sound()) {
        attempt(solid, &damping.at, context, |solid| solid.rayleigh_damping(damping.mass, damping.stiffness));
    }
}

fn add_mass(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for material in &case.materials {
        if let Some(density) = material.density {
            magnitude::check_density(density, &material.at.key("density"), context);
        }
    }
    design::check_masses(case, solid, context);
    let follows = case.materials.iter().any(|material| design::mass_map(case, material).is_some());
    let dense = case.materials.iter().filter_map(|material| Some((material, material.density?)));
    let inertia = dense.fold(None, |inertia: Option<Inertia>, (material, density)| {
        Some(match inertia {
            None => Inertia::new(&material.region, density),
            Some(inertia) => inertia.and(&material.region, density),
        })
    });
    let Some(inertia) = inertia else {
        let needed = case.time.as_ref().and_then(|time| time.built_scheme().ok());
        if needed.is_some_and(|scheme| !scheme.is_quasi_static()) {
            let message = "a motion needs masses: give every material a \"density\", as in \"1000 kg/m^3\"";
            context.complain(&At::root().key("materials"), message);
        }
        return;
    };
    let lumped = case.time.as_ref().is_some_and(|time| time.mass == MassKind::Lumped);
    let inertia = if lumped { inertia.lumped() } else { inertia };
    let inertia = if follows { inertia.filled() } else { inertia };
    attempt(solid, &At::root().key("materials"), context, |solid| solid.inertia(inertia));
}

fn add_viscosity(case: &Case, material: &Material, solid: &mut Solid, context: &mut Context<'_>) {
    let mut laws = Vec::new();
    for branch in &material.maxwell {
        let shear = sampled(case, material, &branch.shear, &branch.at.key("shear"), solid, context);
        let relaxation = sampled(case, material, &branch.relaxation, &branch.at.key("relaxation"), solid, context);
        let Some((shear, relaxation)) = shear.zip(relaxation) else { continue };
        let measure = match branch.measure {
            MeasureBlock::Hencky => SpringMeasure::Hencky,
            MeasureBlock::NeoHooke => SpringMeasure::NeoHooke,
        };
        let law = MaxwellBranch::new(shear, relaxation).map(|law| law.measure(measure));
        match law {
            Ok(law) => laws.push(law),
            Err(error) => complain_of_law(&branch.at, &error, context),
        }
    }
    // all at once: there may be thousands
    attempt(solid, &material.at.key("maxwell"), context, |solid| {
        laws.into_iter().try_fold(solid, |solid, law| solid.viscosity(&material.region, law))
    });
    let Some(dashpot) = &material.kelvin_voigt else { return };
    let mut viscosity = |value: &Option<Parameter>, key: &str| match value {
        Some(value) => sampled(case, material, value, &dashpot.at.key(key), solid, context),
        None => Some(Field::Uniform(0.0)),
    };
    let (shear, bulk) = (viscosity(&dashpot.shear, "shear"), viscosity(&dashpot.bulk, "bulk"));
    if let Some((shear, bulk)) = shear.zip(bulk) {
        attach(material, KelvinVoigt::new(shear, bulk), &dashpot.at, solid, context);
    }
}

fn attach<L: nastic_energy::EnergyTerm + 'static>(
    material: &Material,
    law: Result<L, EnergyError>,
    at: &At,
    solid: &mut Solid,
    context: &mut Context<'_>,
) {
    match law {
        Ok(law) => attempt(solid, at, context, |solid| solid.viscosity(&material.region, law)),
        Err(error) => complain_of_law(at, &error, context),
    }
}

fn sampled(
    case: &Case,
    material: &Material,
    value: &Parameter,
    at: &At,
    solid: &Solid,
    context: &mut Context<'_>,
) -> Option<Field<f64>> {
    let disc = solid.discretization();
    let cells = disc.mesh().cells_of(&material.region).ok()?;
    SamplePoints::of_body(case, disc, &cells).number(value, at, context)
}
