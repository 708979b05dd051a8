//! The catalogue of contributions: a row each, with an example that the contract test holds to [`check_contribution`](nastic_equilibrium::contribution_check::check_contribution).

mod cavity;
mod electric;
mod form;
mod free_shape;
mod key;
mod moving_support;
mod tendon;

use crate::solid::Solid;
use nastic_body::body_energy::free_shape::FreeShape;
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::error::FemError;
use nastic_energy::{FiberTension, NeoHooke, Slot};
use nastic_forces::cavity::Cavity;
use nastic_forces::contact::{Contact, ContactLaw};
use nastic_forces::dielectric_body::DielectricBody;
use nastic_forces::electrode::Electrode;
use nastic_forces::foundation::Foundation;
use nastic_forces::inertia::{BodyInertia, Inertia};
use nastic_forces::medium::Medium;
use nastic_forces::moving_support::MovingSupport;
use nastic_forces::nodal_value::NodalValue;
use nastic_forces::rayleigh_damping::RayleighDamping;
use nastic_forces::rigid_body::RigidBody;
use nastic_forces::spring::Spring;
use nastic_forces::tendon::Tendon;
use nastic_forces::varying_load::VaryingLoad;
use nastic_linear::Field;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_tensor::Vec3;

pub use electric::ELECTRODE;
pub use form::{Form, FormValues};
pub use key::{Key, KeyKind, Need};

/// A row of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// What the contribution is called in messages, and its kind in case files. Rows of one name are forms of one kind, which their
    /// keys distinguish.
    pub name: &'static str,
    /// How it stands in case files, if it is one of the kinds of `actuation` there.
    pub form: Option<Form>,
    /// A body that has it under that name.
    pub example: fn() -> Result<Solid, FemError>,
}

/// Every contribution of this crate.
pub const CATALOGUE: &[Entry] = &[
    Entry { name: "body energy", form: None, example: block },
    Entry {
        name: "foundation on x+",
        form: None,
        example: || block()?.foundation(Foundation::on("x+", 3e3).normal_only()),
    },
    Entry {
        name: FreeShape::KIND,
        form: Some(free_shape::FORM),
        example: || block()?.free_shape(FreeShape::of(FreeShape::KIND, "body", "x+", 1.5)),
    },
    Entry { name: "dead load", form: None, example: || block()?.traction("x+", Vec3::new(3.0, -2.0, 1.0)) },
    Entry {
        name: "load that varies",
        form: None,
        example: || {
            let (solid, mesh) = (block()?, block()?.mesh().clone());
            let sampling =
                QuadraturePoints::of_facets(&mesh, &mesh.facets_of(&"x+".into())?, |kind| kind.rule().clone());
            solid.contribution(VaryingLoad::new("load that varies", &mesh, &sampling, true))
        },
    },
    Entry {
        name: "weight that varies",
        form: None,
        example: || {
            let (solid, mesh) = (block()?, block()?.mesh().clone());
            let cells = 0..mesh.cells() as u32;
            let sampling = QuadraturePoints::of_cells(&mesh, cells, |kind| kind.rule().clone())?;
            solid.contribution(VaryingLoad::weight("weight that varies", &mesh, &sampling, 20.0))
        },
    },
    Entry {
        name: "weight by fill",
        form: None,
        example: || {
            let solid = block()?;
            let force = VaryingLoad::filled("weight by fill", solid.body(), "body", Vec3::new(3.0, 0.0, -20.0))?;
            solid.contribution(force)
        },
    },
    Entry {
        name: "cavity",
        form: Some(cavity::FORM),
        example: || block()?.cavity(Cavity::new("cavity", "inside").lid()),
    },
    Entry {
        name: "tendon",
        form: Some(tendon::INEXTENSIBLE),
        example: || block()?.tendon(Tendon::through("tendon", TENDON)),
    },
    Entry {
        name: "tendon",
        form: Some(tendon::ELASTIC),
        example: || block()?.tendon(Tendon::through("tendon", TENDON).spacing(0.8).stiffness(50.0)),
    },
    Entry {
        name: "tendon that cannot stretch",
        form: None,
        example: || block()?.tendon(Tendon::through("tendon that cannot stretch", TENDON).spacing(0.8).inextensible()),
    },
    Entry { name: "medium", form: None, example: || block()?.medium(Medium::over("medium", "body", 400.0)) },
    Entry {
        name: "spring",
        form: None,
        example: || block()?.spring(Spring::between("spring", TENDON[0], TENDON[2], 40.0).rest_length(2.5)),
    },
    Entry {
        name: "spring of rest length 0",
        form: None,
        example: || {
            let ground = [3.3, -0.4, 0.9];
            block()?.spring(Spring::to_ground("spring of rest length 0", TENDON[1], ground, 40.0).rest_length(0.0))
        },
    },
    Entry {
        name: "motion",
        form: Some(moving_support::FORM),
        example: || block()?.motion(MovingSupport::of("motion", "x+").about([2.8, 1.0, 0.5])),
    },
    Entry {
        name: "motion of one component",
        form: None,
        example: || block()?.motion(MovingSupport::of("motion of one component", "x+").components(&[0])),
    },
    Entry {
        name: "voltage",
        form: None,
        example: || {
            block()?.nodal_value(NodalValue::driven("voltage", potential(), "x+", Slot::scalar("voltage", "V")))
        },
    },
    Entry {
        name: "floating electrode",
        form: None,
        example: || block()?.nodal_value(NodalValue::floating("floating electrode", potential(), "inside")),
    },
    Entry {
        name: "electrode with a charge",
        form: None,
        example: || {
            let body = DielectricBody::of("layer", "body", 40.0);
            block()?.dielectric_body(&body)?.electrode(&Electrode::on("electrode with a charge", "x+").charged())
        },
    },
    Entry {
        name: DielectricBody::KIND,
        form: Some(electric::DIELECTRIC_BODY),
        example: || block()?.dielectric_body(&DielectricBody::of(DielectricBody::KIND, "body", 40.0)),
    },
    Entry {
        name: "cavity of a volume",
        form: None,
        example: || block()?.cavity(Cavity::new("cavity of a volume", "inside").lid().by_volume()),
    },
    Entry {
        name: "contact",
        form: None,
        example: || block()?.contact(Contact::of("contact", "x+", pad()).thickness(3.0).stiffness(2e3)),
    },
    Entry {
        name: "contact with the log law",
        form: None,
        example: || {
            let floor = Obstacle::half_space([3.9, 0.0, 0.0], [-1.0, 0.2, 0.1]);
            let contact = Contact::of("contact with the log law", ["x+", "inside"], floor).law(ContactLaw::Log);
            block()?.contact(contact.thickness(9.0).stiffness(2e3).refine(2))
        },
    },
    Entry {
        name: "contact with friction",
        form: None,
        example: || {
            let contact = Contact::of("contact with friction", "x+", pad()).friction(0.4, 9.0).refine(1);
            block()?.contact(contact.thickness(3.0).stiffness(2e3).about([7.0, -6.0, 5.0]))
        },
    },
    Entry {
        name: "contact with lagged friction",
        form: None,
        example: || {
            let contact =
                Contact::of("contact with lagged friction", "x+", pad()).friction(0.4, 9.0).lagged().refine(1);
            block()?.contact(contact.thickness(3.0).stiffness(2e3).about([5.0, 3.0, 3.0]))
        },
    },
    Entry {
        name: "contact on a grid",
        form: None,
        example: || {
            let contact = Contact::of("contact on a grid", "x+", hollow_pad()?);
            block()?.contact(contact.thickness(6.0).stiffness(2e3).about([5.0, 3.0, 3.0]))
        },
    },
    Entry {
        name: "contact on a grid with friction",
        form: None,
        example: || {
            let contact = Contact::of("contact on a grid with friction", "x+", hollow_pad()?).friction(0.4, 9.0);
            block()?.contact(contact.refine(1).thickness(6.0).stiffness(2e3).about([5.0, 3.0, 3.0]))
        },
    },
    Entry {
        name: "contact on a grid with lagged friction",
        form: None,
        example: || {
            let contact = Contact::of("contact on a grid with lagged friction", "x+", hollow_pad()?).friction(0.4, 9.0);
            block()?.contact(contact.lagged().refine(1).thickness(6.0).stiffness(2e3).about([5.0, 3.0, 3.0]))
        },
    },
    Entry {
        name: "contact of surfaces",
        form: None,
        example: || {
            let contact = Contact::between("contact of surfaces", "lower", "upper");
            bodies()?.contact(contact.thickness(0.24).stiffness(2e4))
        },
    },
    Entry {
        name: "contact of surfaces by the log law",
        form: None,
        example: || {
            let both = Contact::between("contact of surfaces by the log law", ["lower", "upper"], ["lower", "upper"]);
            // gaps of more samples are smaller, and what differences round away of this law larger
            bodies()?.contact(both.thickness(0.2).stiffness(2e3).law(ContactLaw::Log).refine(1))
        },
    },
    Entry {
        name: "friction of surfaces",
        form: None,
        example: || {
            let contact = Contact::between("friction of surfaces", "lower", "upper").friction(1e3, 9e3);
            bodies()?.contact(contact.thickness(0.24).stiffness(2e4))
        },
    },
    Entry {
        name: "friction of surfaces by the log law",
        form: None,
        example: || {
            let both = ["lower", "upper"];
            let contact = Contact::between("friction of surfaces by the log law", both, both).friction(1e3, 9e3);
            // as above
            bodies()?.contact(contact.thickness(0.2).stiffness(2e3).law(ContactLaw::Log).refine(1))
        },
    },
    Entry { name: "rigid body", form: None, example: || loose()?.rigid(&RigidBody::new("rigid body", "body")) },
    Entry { name: BodyInertia::NAME, form: None, example: || block()?.inertia(Inertia::new("body", 1e3)) },
    Entry { name: BodyInertia::FILLED, form: None, example: || block()?.inertia(Inertia::new("body", 1e3).filled()) },
    Entry {
        name: RayleighDamping::NAME,
        form: None,
        example: || block()?.inertia(Inertia::new("body", 1e3))?.rayleigh_damping(0.3, 0.02),
    },
];

/// A capsule beside the cup, which its whole side is near to.
fn pad() -> Obstacle {
    Obstacle::capsule([4.6, -0.4, 0.9], [4.4, 3.6, 1.5], 1.0)
}

/// A large bent block beside it, hollow towards it, whose distance is on a grid so coarse that the side is in one cell, which third derivatives do not
/// jump in; its gradient is no unit vector.
fn hollow_pad() -> Result<Obstacle, FemError> {
    let bent = |x: [f64; 3]| [x[0] + 3.5 - 0.02 * (x[1] - 9.5).powi(2), x[1] - 8.5, x[2] - 8.5];
    let pad = box_mesh([17.7, 19.0, 18.0], [2, 6, 2], CellKind::Hex8)?.mapped(bent)?;
    Obstacle::on_grid(&pad, 10.0, 0.0).map_err(|error| FemError::Meaningless { what: error.to_string() })
}

/// Two bodies above each other, 0.5 apart, with the surfaces "lower" and "upper" between them.
fn bodies() -> Result<Solid, FemError> {
    let full = box_mesh([1.0, 1.0, 2.5], [1, 1, 5], CellKind::Hex8)?;
    let mut raw = RawMesh::new("two bodies");
    // no sample is above a node or an edge, where the tangent jumps
    raw.points = full.points().to_vec();
    raw.points.iter_mut().filter(|x| x[2] > 1.25).for_each(|x| (x[0], x[1]) = (x[0] + 0.33, x[1] + 0.12));
    raw.names.insert((3, 4), "body".to_owned());
    for (tag, name) in [(1, "lower"), (2, "upper"), (3, "z-")] {
        raw.names.insert((2, tag), name.to_owned());
    }
    for cell in 0..full.cells() {
        let (nodes, height) = (full.cell(cell).nodes, full.cell_centre(cell)[2]);
        if (height - 1.25).abs() > 0.2 {
            raw.push(CellKind::Hex8, nodes, &[4]);
        }
        for (kind, local) in CellKind::Hex8.faces() {
            let nodes: Vec<u32> = local.iter().map(|&a| nodes[a]).collect();
            let on = |z: f64| nodes.iter().all(|&node| (full.points()[node as usize][2] - z).abs() < 1e-9);
            let tag = [(1.0, 0.75, 1), (1.5, 1.75, 2), (0.0, 0.25, 3)]
                .iter()
                .find(|(z, of, _)| on(*z) && (height - of).abs() < 0.1);
            if let Some((.., tag)) = tag {
                raw.push(*kind, &nodes, &[*tag]);
            }
        }
    }
    Solid::new(Mesh::build(raw)?)?.material("body", NeoHooke::new(1e5, 2e5)?)?.clamp("z-")
}

/// An electric potential.
fn potential() -> Field {
    Field::saddle("phi", 1)
}

/// A way through the cup of the examples, between its nodes.
const TENDON: [[f64; 3]; 3] = [[0.2, 0.4, 0.3], [1.6, 0.7, 0.5], [2.9, 0.3, 1.9]];

/// A cup that is held at one side and pulled along its fibres.
fn block() -> Result<Solid, FemError> {
    loose()?.clamp("x-")
}

/// The same without supports.
fn loose() -> Result<Solid, FemError> {
    Solid::new(pocket()?)?.material("body", NeoHooke::new(1e5, 2e5)?)?.actuate(
        "body",
        "fibre",
        FiberTension::along(Vec3::x())?,
    )
}

/// A box of 3 x 3 x 2 hexahedra, each 1 x 1 x 1.2, whose upper middle one is missing: a cup with the surfaces "x-", "x+" and "inside".
fn pocket() -> Result<Mesh, FemError> {
    let full = box_mesh([3.0, 3.0, 2.4], [3, 3, 2], CellKind::Hex8)?;
    let mut raw = RawMesh::new("cup");
    raw.points = full.points().to_vec();
    for (tag, name) in [(1, "x-"), (2, "x+"), (3, "inside")] {
        raw.names.insert((2, tag), name.to_owned());
    }
    raw.names.insert((3, 4), "body".to_owned());
    let missing = |cell: usize| {
        let c = full.cell_centre(cell);
        (c[0] - 1.5).abs() < 0.1 && (c[1] - 1.5).abs() < 0.1 && c[2] > 1.2
    };
    for cell in (0..full.cells()).filter(|&cell| !missing(cell)) {
        raw.push(CellKind::Hex8, full.cell(cell).nodes, &[4]);
    }
    let hole = (0..full.cells()).find(|&cell| missing(cell)).unwrap_or_default();
    for (kind, local) in CellKind::Hex8.faces() {
        let nodes: Vec<u32> = local.iter().map(|&a| full.cell(hole).nodes[a]).collect();
        if nodes.iter().any(|&node| full.points()[node as usize][2] < 1.8) {
            raw.push(*kind, &nodes, &[3]);
        }
    }
    for (tag, name) in [(1, "x-"), (2, "x+")] {
        for &facet in full.surface(name)? {
            let (kind, nodes) = full.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}
