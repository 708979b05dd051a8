//! [`CATALOGUE`]: every cost, with examples of it on a given body.

use super::{
    ContactLoad, ContactResultant, ContactSlip, ControlNorm, ControlSmoothness, Cost, CostForm, CostInputs, CostValue,
    Curvature, DesignMean, IntoCost, LargestStretch, MakeCost, Marker, Markers, MeanDisplacement, MeanPosition,
    ObstaclePenetration, Prior, PumpWork, Reaction, ShapeShrinkage, SmoothedHausdorff, Target, Tracking, compliance,
    contact_load, contact_slip, curvature, design, markers, mean_displacement, mean_radius, obstacle, orientation,
    position, pump_work, reaction, regularization, shape_shrinkage, stretch, tracking, volume,
};
use crate::time::When;
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_hausdorff::Phi;
use nastic_mesh::Mesh;
use nastic_mesh::spatial::Obstacle;
use std::sync::Arc;

/// What examples are made on.
#[derive(Debug, Clone, Copy)]
pub struct CostExample<'a> {
    /// The body; its first region and its last surface are used.
    pub solid: &'a Solid,
    /// A control, as the layout names it.
    pub control: &'a str,
    /// Multiplies the cost.
    pub weight: f64,
}

impl CostExample<'_> {
    /// A cost as case files make it, of the values of its keys.
    ///
    /// # Errors
    /// Those of its form.
    pub fn make(
        &self,
        form: &CostForm,
        values: impl IntoIterator<Item = (&'static str, CostValue)>,
    ) -> Result<Vec<Box<dyn Cost>>, ControlError> {
        let values = values.into_iter().collect();
        let (solid, weight, when) = (self.solid, self.weight, &When::End);
        let inputs = CostInputs { solid, weight, in_motion: false, second: false, when, values: &values };
        match form.make {
            MakeCost::OfStates(make) => Ok(vec![make(&inputs)?]),
            MakeCost::OfMotion(_) => Ok(vec![]),
        }
    }

    /// The last surface of the body.
    pub fn surface(&self) -> String {
        self.solid.mesh().surfaces().keys().next_back().cloned().unwrap_or_default()
    }
}

/// Costs on a body, or why there are none.
type ExampleCosts = Result<Vec<Box<dyn Cost>>, ControlError>;

/// A row of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct CostRow {
    /// Name in case files, and of the bound cost.
    pub name: &'static str,
    /// How case files name it and its keys; `None` of a smoothed Hausdorff distance, whose stages are blocks of their own, and of a prior, which is a key of its control.
    pub form: Option<&'static CostForm>,
    /// Whether it has second partials, which second derivatives of the objective take.
    pub second: bool,
    /// Examples that cover its options.
    pub examples: fn(&CostExample) -> ExampleCosts,
}

impl CostRow {
    const fn of(form: &'static CostForm, examples: fn(&CostExample) -> ExampleCosts) -> Self {
        CostRow { name: form.name, form: Some(form), second: true, examples }
    }

    const fn first_order(self) -> Self {
        CostRow { second: false, ..self }
    }
}

/// Every cost of states and controls.
pub const CATALOGUE: &[CostRow] = &[
    CostRow { name: "smoothed_hausdorff", form: None, second: true, examples: smoothed_hausdorff },
    CostRow::of(&tracking::FORM, tracking),
    CostRow::of(&position::FORM, position),
    CostRow::of(&markers::FORM, markers),
    CostRow::of(&mean_displacement::FORM, displacement),
    CostRow::of(&orientation::FORM, orientation),
    CostRow::of(&curvature::FORM, curvature),
    CostRow::of(&mean_radius::FORM, mean_radius),
    CostRow::of(&volume::FORM, volume),
    CostRow::of(&stretch::FORM, largest_stretch),
    CostRow::of(&compliance::FORM, compliance).first_order(),
    CostRow::of(&reaction::FORM, reaction),
    CostRow::of(&contact_load::FORCE, contact_force).first_order(),
    CostRow::of(&contact_load::PRESSURE, |on| contact_load(on, |contact| ContactLoad::pressure(contact, 2)))
        .first_order(),
    CostRow::of(&contact_slip::FORM, contact_slip).first_order(),
    CostRow::of(&obstacle::FORM, obstacle),
    // Controls are stresses of 1e5 Pa, whose squares would drown what else is compared.
    CostRow::of(&regularization::NORM, |on| Ok(vec![Box::new(ControlNorm::of(on.control, 1e-10 * on.weight)?)])),
    CostRow::of(&regularization::SMOOTHNESS, |on| {
        Ok(vec![Box::new(ControlSmoothness::of(on.control, 1e-10 * on.weight)?)])
    }),
    CostRow::of(&design::VOLUME, |on| Ok(vec![Box::new(DesignMean::volume(on.control, 1e-6 * on.weight)?)])),
    CostRow::of(&design::GREYNESS, |on| Ok(vec![Box::new(DesignMean::greyness(on.control, 1e-10 * on.weight)?)])),
    CostRow::of(&shape_shrinkage::FORM, shape_shrinkage),
    CostRow { name: "prior", form: None, second: true, examples: prior },
    // Energies of stiff bodies would drown squares of lengths.
    CostRow::of(&pump_work::FORM, |on| Ok(vec![Box::new(PumpWork::new(1e-4 * on.weight)?)])),
];

fn compliance(on: &CostExample) -> ExampleCosts {
    let values =
        [("surface", CostValue::Names(on.surface().into())), ("direction", CostValue::Vector([0.2, 0.9, 0.0]))];
    on.make(&compliance::FORM, values)
}

/// Of a surface that is held.
fn reaction(on: &CostExample) -> ExampleCosts {
    // across the load, the force is that of the contacts, which follows the controls
    let along = if on.solid.mesh().dim() == 2 { [0.3, 0.9, 0.0] } else { [0.2, 0.3, 0.9] };
    let held = |name: &&String| Reaction::at(name.as_str(), along, 0.0).bind(on.solid).is_ok();
    let surface = on.solid.mesh().surfaces().keys().find(held).cloned().unwrap_or_default();
    // forces of stiff bodies would drown squares of lengths
    Ok(vec![Reaction::at(surface, along, 20.0).weight(1e-6 * on.weight).bind(on.solid)?])
}

fn tracking(on: &CostExample) -> ExampleCosts {
    let (mesh, size) = (on.solid.mesh(), on.solid.mesh().diagonal());
    let lifted = Target::position(move |x| [x[0], x[1] + 0.3 * x[0] * x[0] / size, x[2]]);
    let place = |names: Option<&String>| names.cloned().unwrap_or_default();
    let (surface, region) = (place(mesh.surfaces().keys().next_back()), place(mesh.regions().keys().next()));
    let displacement: Vec<f64> = (0..on.solid.discretization().dofs()).map(|i| 0.1 * size * (i as f64).sin()).collect();
    [
        Tracking::surface(&surface, lifted.clone()),
        Tracking::region(&region, lifted),
        Tracking::nodes(&surface, Target::Displacement(displacement)),
    ]
    .into_iter()
    .map(|cost| cost.weight(on.weight).bind(on.solid))
    .collect()
}

fn position(on: &CostExample) -> ExampleCosts {
    let (mesh, size) = (on.solid.mesh(), on.solid.mesh().diagonal());
    let place = |names: Option<&String>| names.cloned().unwrap_or_default();
    let (surface, region) = (place(mesh.surfaces().keys().next_back()), place(mesh.regions().keys().next()));
    let centre = mesh.cell_centre(mesh.cells() - 1);
    [
        MeanPosition::surface(&surface, [Some(0.3 * size), None, None]),
        MeanPosition::region(&region, [Some(0.5 * size), Some(0.13 * size), Some(0.12 * size)]),
        MeanPosition::nodes(&surface, [Some(-0.2 * size), Some(0.3 * size), None]),
        MeanPosition::point(centre, [Some(0.1 * size), Some(-0.6 * size), None]),
    ]
    .into_iter()
    .map(|cost| cost.weight(on.weight).bind(on.solid))
    .collect()
}

/// Of a scalar; a vector has none. As little as the norm.
fn prior(on: &CostExample) -> ExampleCosts {
    Ok(vec![Box::new(Prior::of(on.control, 0.01, 1.0)?.weight(1e-10 * on.weight)?)])
}

/// One with all coordinates, one with a single one; with deviations that make their squares those of lengths.
fn markers(on: &CostExample) -> ExampleCosts {
    let (mesh, size) = (on.solid.mesh(), on.solid.mesh().diagonal());
    let marker = |cell: usize, shift: [Option<f64>; 3], deviation: f64| {
        let reference = mesh.cell_centre(cell);
        let position = std::array::from_fn(|i| shift[i].map(|shift| reference[i] + shift * size));
        Marker { name: format!("cell {cell}"), reference, position, deviation }
    };
    let z = (mesh.dim() == 3).then_some(-0.07);
    let all = [
        marker(mesh.cells() - 1, [Some(0.1), Some(-0.2), z], 1.0),
        marker(mesh.cells() / 2, [None, Some(0.15), None], 0.7),
    ];
    Ok(vec![Markers::of(all).weight(on.weight).bind(on.solid)?])
}

/// Upwards, where the examples' bodies bend to.
fn displacement(on: &CostExample) -> ExampleCosts {
    let mesh = on.solid.mesh();
    let along = [0.1, 0.9, 0.0];
    let all = [
        MeanDisplacement::surface(on.surface(), along),
        MeanDisplacement::point(mesh.cell_centre(mesh.cells() - 1), along),
    ];
    all.into_iter().map(|cost| cost.weight(on.weight).bind(on.solid)).collect()
}

fn orientation(on: &CostExample) -> ExampleCosts {
    let values =
        [("surface", CostValue::Names(on.surface().into())), ("direction", CostValue::Vector([0.8, 0.3, 0.0]))];
    on.make(&orientation::FORM, values)
}

/// Of every contact of the body: none where it touches nothing.
fn contact_load(on: &CostExample, of: impl Fn(&str) -> ContactLoad) -> ExampleCosts {
    let contacts = on.solid.model().contacts().parameters();
    contacts.iter().map(|(name, _)| of(name).weight(on.weight).bind(on.solid)).collect()
}

/// Its pressures, and along a direction that is no normal, of an obstacle.
fn contact_force(on: &CostExample) -> ExampleCosts {
    let mut costs = contact_load(on, ContactLoad::force)?;
    for (name, _) in on.solid.model().contacts().parameters() {
        let direction = if on.solid.mesh().dim() == 2 { [0.3, -0.8, 0.0] } else { [0.3, 0.5, -0.8] };
        costs.extend(ContactResultant::along(&name, direction).weight(on.weight).bind(on.solid));
    }
    Ok(costs)
}

/// Of every contact with friction, which static bodies have none of.
fn contact_slip(on: &CostExample) -> ExampleCosts {
    let contacts = on.solid.model().contacts().parameters();
    let rubs = contacts.iter().filter(|(_, own)| own.friction.is_some());
    rubs.map(|(name, _)| ContactSlip::of(name, 2).weight(on.weight).bind(on.solid)).collect()
}

fn curvature(on: &CostExample) -> ExampleCosts {
    let (low, high) = on.solid.mesh().bounds();
    // Not straight, so that a change of size alone bends it.
    let along = |share: f64| {
        let place = [share, 0.9 - 0.8 * share * share, 0.45];
        [0, 1, 2].map(|i| low[i] + (high[i] - low[i]) * place[i])
    };
    let line: Vec<[f64; 3]> = [0.05, 0.3, 0.5, 0.8, 0.95].map(along).into();
    let wanted = 0.7 / on.solid.mesh().diagonal();
    Ok(vec![Curvature::of_line(line, [0.0, 0.0, 1.0], wanted).weight(on.weight).bind(on.solid)?])
}

fn mean_radius(on: &CostExample) -> ExampleCosts {
    let (surface, size) = (CostValue::Names(on.surface().into()), on.solid.mesh().diagonal());
    let wanted = CostValue::Number(0.4 * size);
    // from the surface's own mean, which lies in it: as many points as shapes have do not meet it
    let from_centre = on.make(&mean_radius::FORM, [("surface", surface.clone()), ("radius", wanted.clone())])?;
    let (low, _) = on.solid.mesh().bounds();
    let beside = [Some(low[0] - 0.1 * size), None, Some(low[2] - 0.2 * size)];
    let keys = [("axis", CostValue::Vector([0.3, 1.0, 0.1])), ("centre", CostValue::Position(beside))];
    let about_axis = on.make(&mean_radius::FORM, [("surface", surface), ("radius", wanted)].into_iter().chain(keys))?;
    Ok(from_centre.into_iter().chain(about_axis).collect())
}

/// Of a corner, closed by a lid: that within the whole skin hardly changes.
fn volume(on: &CostExample) -> ExampleCosts {
    let mesh = on.solid.mesh();
    let all: Vec<String> =
        [mesh.surfaces().keys().next(), mesh.surfaces().keys().next_back()].into_iter().flatten().cloned().collect();
    let wanted = 0.1 * mesh.diagonal().powi(mesh.dim() as i32);
    on.make(&volume::FORM, [("surface", CostValue::Names(all.into())), ("volume", CostValue::Number(wanted))])
}

fn largest_stretch(on: &CostExample) -> ExampleCosts {
    let region = on.solid.mesh().regions().keys().next().cloned().unwrap_or_default();
    let of = |cost: LargestStretch| cost.weight(on.weight).bind(on.solid);
    Ok(vec![of(LargestStretch::default())?, of(LargestStretch::default().region(&region).exponent(1))?])
}

/// Of a body whose shape changes.
fn shape_shrinkage(on: &CostExample) -> ExampleCosts {
    on.solid.body().shape().map(|_| ShapeShrinkage::default().weight(on.weight).bind(on.solid)).into_iter().collect()
}

fn smoothed_hausdorff(on: &CostExample) -> ExampleCosts {
    let (mesh, size) = (on.solid.mesh(), on.solid.mesh().diagonal());
    // Bent and shifted, so that no points of body and target coincide.
    let bent = |x: [f64; 3]| [0.97 * x[0] + 0.013 * size, x[1] + 0.2 * x[0] * x[0] / size, 1.02 * x[2]];
    let target = Arc::new(Mesh::clone(mesh).mapped(bent)?);
    let region = mesh.regions().keys().next().cloned().unwrap_or_default();
    let example = |phi: Phi| SmoothedHausdorff::to(target.clone()).phi(phi).weight(on.weight);
    let mut all: Vec<SmoothedHausdorff> =
        nastic_hausdorff::CATALOGUE.iter().map(|row| example((row.make)(0.1 * size))).collect();
    let phi = Phi::Exponential { length: 0.1 * size };
    all.push(example(phi).region(&region).target_region(&region).quadrature(3).stages([(2.0, 3.0, 2.0)]));
    all.into_iter().map(|cost| cost.bind(on.solid)).collect()
}

fn obstacle(on: &CostExample) -> ExampleCosts {
    let (mesh, size) = (on.solid.mesh(), on.solid.mesh().diagonal());
    let place = |names: Option<&String>| names.cloned().unwrap_or_default();
    let (surface, region) = (place(mesh.surfaces().keys().next_back()), place(mesh.regions().keys().next()));
    // All points lie inside, away from centers and axes, so that second derivatives exist; of the half-space with a clearance some.
    let sphere = Obstacle::sphere([-0.3 * size, 0.6 * size, -0.2 * size], 3.0 * size);
    let capsule =
        Obstacle::capsule([0.31 * size, 0.8 * size, -size], [0.33 * size, 0.7 * size, 1.1 * size], 3.0 * size);
    let half_space = Obstacle::half_space([0.5 * size, 0.0, 0.0], [1.0, 0.4, -0.2]);
    [
        ObstaclePenetration::surface(&surface, half_space).clearance(0.0137 * size),
        ObstaclePenetration::region(&region, sphere),
        ObstaclePenetration::nodes(&surface, capsule),
        ObstaclePenetration::region(
            &region,
            Obstacle::aligned_box([-9.0 * size; 3], [1.9 * size, 3.0 * size, 3.0 * size]),
        ),
        // All around a corner of it, and an edge, within the clearance.
        ObstaclePenetration::region(&region, Obstacle::aligned_box([-size; 3], [-0.13 * size; 3]))
            .clearance(2.0 * size),
        ObstaclePenetration::region(&region, Obstacle::aligned_box([-size; 3], [-0.13 * size, -0.17 * size, size]))
            .clearance(2.0 * size),
    ]
    .into_iter()
    .map(|cost| cost.weight(on.weight).bind(on.solid))
    .collect()
}
