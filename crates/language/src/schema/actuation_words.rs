//! What is said of kinds of actuation: what people try in their place, what they add to the energy, why some only pull.

use crate::schema::hints::{Hint, hint};

const MUSCLE: &str = "a muscle is an actuation of the \"kind\": \"muscle\" with a \"region\" and a \"direction\"; a \
    positive \"contraction\" pulls";
const CHAMBER: &str = "an air chamber is an actuation of the \"kind\": \"cavity\", with the \"surface\" of its walls";
const TENDON: &str = "a cable is an actuation of the \"kind\": \"tendon\" with the \"points\" that it passes; its control is the \"tension\" (\"of\": \"NAME\") \
    or the \"pull\" (\"of\": \"NAME.pull\"), with a \"stiffness\" the pull alone";
const MAGNET: &str = "a magnet is an actuation of the \"kind\": \"magnet\" with the vectors \"remanence\" (mu0 \
    times the magnetisation, in T) and \
                      \"field\" (in T)";
const HEAT: &str = "what a given temperature expands is of the \"kind\": \"heat\" with an \"expansion\", \"2e-4 / K\"; its \"temperature\" is the \
    difference to that without stress, \"60 K\"; conduction is not solved";
const LCE: &str = "a liquid crystal elastomer is of the \"kind\": \"lce\" with its director as \"direction\"; a \"strain\" of -0.3 makes it shorter by \
    three tenths";
const SHAPE_MEMORY: &str = "a strain without stress is of the \"kind\": \"growth\", in all directions, \"stretch_along\" one, or \"growth_tensor\"";
const SHAPE: &str = "a shape of the body that is an unknown is an actuation of the \"kind\": \"shape\" with a \"region\" and \"modes\": { \"thickness\": [0, 0, \"Z / 10 mm\"] }; \
    the control { \"of\": \"NAME.thickness\", \"space\": \"uniform\" } is its amplitude; \
    of the \"kind\": \"free_shape\" with a \"surface\" and a \"filter\" the nodes of that surface are";
const ELECTRIC: &str = "a dielectric elastomer is an actuation of the \"kind\": \"dielectric\" with a \"region\", a \
    \"relative_permittivity\" and the \"direction\" across the film; its \"field\" is the voltage over the thickness, \"3 kV / 100 um\"; with the potential as an unknown it is of the \"kind\": \
    \"dielectric_body\", with \"electrodes\"";

/// What people try in their place.
pub(super) const HINTS: &[Hint] = &[
    hint("", &["muscle", "muscles", "fiber", "fibre", "tension"], MUSCLE),
    hint("", &["chamber", "chambers", "air_chamber", "cavity", "pneumatics"], CHAMBER),
    hint("", &["tendon", "tendons", "cable", "cables"], TENDON),
    hint("", &["magnet", "magnets", "magnetization", "magnetisation", "field"], MAGNET),
    hint("actuation", &["muscle", "fiber", "fibre", "active_stress", "tension", "contraction"], MUSCLE),
    hint("actuation", &["chamber", "air_chamber", "air", "pneumatic", "pneunet", "balloon", "pressure"], CHAMBER),
    hint(
        "actuation",
        &["swelling", "osmosis", "inflation", "expansion"],
        "a pressure inside the material itself is of the \"kind\": \"turgor\", swelling by a given part of lengths \"growth\"",
    ),
    hint("actuation", &["cable", "wire", "string", "rope", "tendons"], TENDON),
    hint("actuation", &["magnetic", "magnetization", "magnetisation", "b", "b_r", "m"], MAGNET),
    hint("actuation", &["electric", "voltage", "electrode", "electrodes", "dea", "eps"], ELECTRIC),
    hint("actuation", &["thermal", "thermal_expansion", "temperature", "heating"], HEAT),
    hint("actuation", &["liquid_crystal", "nematic", "light", "director"], LCE),
    hint("", &["shape", "shapes", "morphing"], SHAPE),
    hint("actuation", &["shape_memory", "prestrain", "eigenstrain"], SHAPE_MEMORY),
];

/// What kinds of actuation add to the energy; `EPS0` stands for the permittivity of vacuum in the case's units.
pub const CONVENTIONS: [(&str, &str); 7] = [
    (
        "fiber_tension",
        "fibre tension m adds -(m/2)|F a|^2 to the energy: m < 0 contracts the fibre, m > 0 lengthens it",
    ),
    ("muscle", "muscle contraction c adds (c/2)|F a|^2 to the energy: c > 0 pulls"),
    ("turgor", "turgor m adds -m (J - 1) to the energy: m > 0 inflates"),
    (
        "dielectric",
        "dielectric E adds -(eps/2) J |F^-T E e|^2 to the energy, E the voltage over the film's reference thickness; eps0 = EPS0 in these units unless given",
    ),
    (
        "dielectric_body",
        "dielectric_body adds -(eps/2) J |F^-T grad phi|^2 to the energy, phi the potential of the electrodes, an unknown; eps0 = EPS0 in these units unless given",
    ),
    ("cavity", "cavity p adds -p V to the energy, V its volume: p > 0 inflates"),
    (
        "tendon",
        "tendon T adds T L to the energy, L its length; by its pull s it keeps L <= L0 - s, with a stiffness k the energy is (k/2) max(0, L - L0 + s)^2: both pull if positive",
    ),
];

/// An actuation that only pulls.
pub struct Pulling {
    /// What it is.
    pub noun: &'static str,
    /// Why a negative value is refused.
    pub why: &'static str,
}

/// Of a slot that only pulls.
#[must_use]
pub fn pulling(slot: &str) -> Pulling {
    match slot {
        "shortening" => Pulling {
            noun: "muscle",
            why: "a muscle only shortens: its shortening is positive or zero; what lengthens is of the kind \"lce\", with a positive strain",
        },
        "contraction" => Pulling {
            noun: "muscle",
            why: "a muscle only pulls: its contraction is positive or zero; fibres that lengthen are of the kind \"fiber_tension\", \
                  with a positive tension",
        },
        _ => Pulling { noun: "tendon", why: "a tendon only pulls: its tension is positive or zero" },
    }
}
