//! Words people try, with what they are called here.

use crate::syntax::At;

/// What stands for some words in some block.
pub(crate) struct Hint {
    /// The block, `""` for the case itself.
    within: &'static str,
    /// The words, in lower case.
    pub(super) words: &'static [&'static str],
    /// What to write.
    pub(super) say: &'static str,
}

/// One of them.
pub(super) const fn hint(within: &'static str, words: &'static [&'static str], say: &'static str) -> Hint {
    Hint { within, words, say }
}

const SUPPORT: &str = "what holds the body stands in \"supports\": [ { \"surface\": \"clamp\", \"fix\": \"all\" } ]";
const WEIGHT: &str =
    "weight is a load: \"loads\": [ { \"gravity\": [0, 0, \"-9.81 m/s^2\"] } ], with the \"density\" of each material";
const AIR: &str = "the pressure of an air chamber is an actuation, as it follows the walls: { \"name\": \
    \"air\", \"kind\": \"cavity\", \
                   \"surface\": \"chamber\", \"pressure\": \"20 kPa\" }; a dead load is a \"traction\": [0, 0, \"-1 kPa\"]";
const FORCE: &str = "forces stand in \"loads\", per reference area or volume: { \"surface\": \"tip\", \
    \"traction\": [0, 0, \"-1 N / 4 cm^2\"] } \
                     (nastic check prints the areas)";
const NO_LAW: &str = "nastic does not have this law yet; \"mooney_rivlin\" and \"neo_hooke\" take large strains \
    too, also by \"young\" and \"poisson\"";
const YOUNG: &str = "write \"young\": \"300 kPa\", with \"poisson\" (the law \"transverse_mooney_rivlin\" takes \
    \"mu1\" to \"mu4\" alone)";
const POISSON: &str = "write \"poisson\": 0.45, with \"young\" (the law \"transverse_mooney_rivlin\" takes \
    \"mu1\" to \"mu4\" alone)";
const RUBBER: &str = "\"neo_hooke\" and \"neo_hooke_isochoric\" take \"c10\" and \"d1\", \"mooney_rivlin\" \
    takes \"c10\", \"c01\" and \"d1\"";
const BOUND: &str = "a bounded functional stands under \"cost\": { \"cost\": { \"kind\": \"design_volume\", \"of\": \"NAME\" }, \"at_most\": 0.4 }";
const KIND: &str = "what it is stands under \"kind\"";
const TIME: &str = "a motion stands in \"time\": { \"end\": \"1 s\", \"step\": \"10 ms\" }, with the \"density\" of each material; damping is \
    \"maxwell\" or \"kelvin_voigt\" of a material, or \"rayleigh\" in \"time\"";

const CONTACT: &str = "what touches the body stands in \"obstacles\": [ { \"name\": \"floor\", \"shape\": { \"half_space\": { \"point\": [0, 0, 0], \"normal\": [0, 0, 1] } } } ], \
    and pushes it by \"contact\": [ { \"surface\": \"skin\", \"obstacle\": \"floor\", \"friction\": 0.5 } ]";
const SHAPE: &str = "the form stands under \"shape\": { \"sphere\": { \"center\": [0, 0, 9], \"radius\": 5 } }, or a \"capsule\", \"box\", \"half_space\", \"mesh\"";
const BETWEEN: &str = "a surface that touches itself or another one is a contact: \"contact\": [ { \"surface\": \"skin\", \"with\": \"skin\" } ]; bodies are regions of one \
    mesh that share no node";
const NOT_YET: &str =
    "nastic has no rigid bodies that move freely yet; \"obstacles\" rest, move as given, or are controlled";

/// All of them; the first that fits counts.
pub(super) const HINTS: &[Hint] = &[
    hint("", &["gravity", "weight", "density", "body_force"], WEIGHT),
    hint("", &["pressure", "air"], AIR),
    hint(
        "",
        &["bc", "bcs", "boundary", "boundary_conditions", "fixed", "fix", "clamp", "dirichlet", "constraints"],
        SUPPORT,
    ),
    hint("constraints", &["kind", "of"], BOUND),
    hint("", &["force", "forces", "load", "traction", "neumann"], FORCE),
    hint("", &["friction", "floor", "ground", "obstacle", "contacts", "collision", "collisions", "touches"], CONTACT),
    hint("", &["self_contact", "self_collision", "bodies"], BETWEEN),
    hint("", &["rigid_bodies", "rigid_body"], NOT_YET),
    hint(
        "obstacles",
        &["sphere", "ball", "capsule", "box", "plane", "half_space", "mesh", "radius", "geometry", "type", "kind"],
        SHAPE,
    ),
    hint("obstacles", &["friction", "mu", "stiffness", "surface"], "what touches it, and how, stands in \"contact\""),
    hint(
        "obstacles",
        &["position", "velocity", "motion", "path", "pose"],
        "where it is stands under \"translation\" and \"rotation\", in motions as formulas of t",
    ),
    hint(
        "contact",
        &["body", "other", "target", "master", "slave"],
        "the rigid thing that it touches stands under \"obstacle\", another surface under \"with\"",
    ),
    hint("contact", &["mu", "friction_coefficient", "coefficient"], "Coulomb's coefficient stands under \"friction\""),
    hint("contact", &["k", "penalty", "epsilon"], "the pressure that closes the gap stands under \"stiffness\""),
    hint("contact", &["gap", "delta", "dhat", "offset"], "the layer in which it acts stands under \"thickness\""),
    hint(
        "contact",
        &["eps_v", "epsv", "slip_velocity", "regularization"],
        "the speed below which friction is smoothed stands under \"slip_speed\"",
    ),
    hint("", &["dynamics", "motion", "damping", "dt", "steps", "time_step", "transient"], TIME),
    hint("time", &["dt", "time_step", "timestep", "h"], "write \"step\": \"10 ms\""),
    hint("time", &["t_end", "tend", "duration", "span", "until"], "write \"end\": \"1 s\""),
    hint(
        "time",
        &["tol", "rtol", "atol", "accuracy"],
        "write \"tolerance\": \"0.1 mm\", the error that a step may add",
    ),
    hint("time", &["method", "integrator", "solver"], "write \"scheme\": \"tr_bdf2\""),
    hint(
        "",
        &["e", "young", "youngs_modulus", "nu", "poisson"],
        "materials stand in \"materials\": [ { \"region\": \"body\", \"law\": \"neo_hooke\", \
        \"young\": \"300 kPa\", \"poisson\": 0.45 } ]",
    ),
    hint(
        "",
        &["objective", "target", "goal"],
        "what shall become of the body stands in \"costs\": [ { \"kind\": \"tracking\", \"surface\": \"tip\", \
        \"target\": [\"X\", \"Y\", \"Z + 10 mm\"] } ]",
    ),
    hint(
        "materials",
        &["e", "young_modulus", "youngs_modulus", "young's_modulus", "elastic_modulus", "modulus"],
        YOUNG,
    ),
    hint("materials", &["nu", "v", "poisson_ratio", "poissons_ratio", "poisson's_ratio"], POISSON),
    hint("materials", &["k", "kappa", "bulk_modulus"], "write \"bulk\", with \"shear\""),
    hint("materials", &["g", "shear_modulus"], "write \"shear\", with \"bulk\""),
    hint("materials", &["c10", "c01", "d1", "c1", "c2"], RUBBER),
    hint("maxwell", &["tau", "time", "relaxation_time", "t"], "write \"relaxation\": \"60 ms\""),
    hint("maxwell", &["g", "mu", "modulus", "shear_modulus"], "write \"shear\": \"50 kPa\""),
    hint("rayleigh", &["beta", "a1", "k"], "write \"stiffness\": \"1 ms\""),
    hint("rayleigh", &["alpha", "a0", "m"], "write \"mass\": \"0.5 / (1 s)\""),
    hint("time", &["rho", "density"], "a \"density\" stands in \"materials\""),
    hint("materials", &["rho", "mass"], "write \"density\": \"1000 kg/m^3\""),
    hint("materials", &["gravity", "weight"], WEIGHT),
    hint(
        "materials",
        &["viscosity", "eta", "damping", "prony", "viscoelastic"],
        "viscosity is \"maxwell\": [ { \"shear\": \"50 kPa\", \"relaxation\": \"60 ms\" } ] or \"kelvin_voigt\": { \"shear\": \"100 Pa * s\" }",
    ),
    hint("materials", &["model", "material", "type", "kind"], "the law stands under \"law\""),
    hint(
        "materials",
        &["fibre", "direction"],
        "the direction of fibres stands under \"fiber\", which \"transverse_mooney_rivlin\" takes",
    ),
    hint(
        "materials",
        &["linear", "linear_elastic", "elastic", "hooke", "isotropic", "st_venant_kirchhoff", "saint_venant_kirchhoff"],
        "bodies bend and stretch much here: take \"neo_hooke\" with \"young\" and \"poisson\"",
    ),
    hint("materials", &["fung"], NO_LAW),
    hint(
        "supports",
        &["fixed", "clamp", "clamped", "constraint", "dofs", "components", "type", "kind"],
        "write \"fix\": \"all\", or a list of \"x\", \"y\" and \"z\"",
    ),
    hint("supports", &["u", "ux", "uy", "uz", "value", "disp"], "write \"displacement\": { \"x\": \"1 mm\" }"),
    hint("loads", &["pressure", "air"], AIR),
    hint("loads", &["weight", "density", "acceleration", "g"], WEIGHT),
    hint("loads", &["force", "forces", "total_force", "point_force", "value", "magnitude"], FORCE),
    hint(
        "actuation",
        &["stress", "activation", "value", "strength"],
        "a constant value stands under the name of the slot, as \"tension\" or \"pressure\"; what the optimiser may \
        change stands in \"controls\"",
    ),
    hint("actuation", &["type"], KIND),
    hint("controls", &["min", "lower_bound", "bounds", "lb"], "bounds are \"lower\" and \"upper\""),
    hint("controls", &["max", "upper_bound", "ub"], "bounds are \"lower\" and \"upper\""),
    hint(
        "controls",
        &["initial", "initial_value", "value", "guess", "x0"],
        "the value to begin with stands under \"start\"",
    ),
    hint("controls", &["actuation", "actuator"], "the name of the actuation stands under \"of\""),
    hint("costs", &["type"], KIND),
    hint(
        "costs",
        &["hausdorff", "shape", "chamfer"],
        "the distance from a target shape is of the \"kind\": \"smoothed_hausdorff\"",
    ),
    hint(
        "costs",
        &["point", "position", "tip", "displacement", "distance", "l2"],
        "target positions of a surface, region or node set are of the \"kind\": \"tracking\", with \
        \"target\": [\"X\", \"Y\", \"Z + 10 mm\"]",
    ),
    hint(
        "costs",
        &["regularization", "regularisation", "tikhonov", "energy"],
        "the size of a control is of the \"kind\": \"control_norm\", its slope of the \"kind\": \
        \"control_smoothness\"",
    ),
    hint("optimizer", &["max_iter", "maxiter", "iterations", "iter", "n_iter"], "write \"max_iterations\": 100"),
    hint("optimizer", &["tol", "gtol", "ftol", "eps"], "write \"tolerance\": 1e-4"),
    hint("optimizer", &["type", "name", "algorithm", "solver"], "write \"method\": \"lbfgs\""),
    hint(
        "optimizer",
        &["bfgs", "l-bfgs", "l-bfgs-b", "l_bfgs", "adam", "sgd", "gradient_descent", "ipopt"],
        "take \"lbfgs\" or \"projected_gradient\"",
    ),
    hint(
        "mesh",
        &["path", "filename", "name"],
        "write \"mesh\": \"body.msh\", or { \"file\": \"body.msh\", \"scale\": 1e-3 }",
    ),
];

/// What to say of a word that means nothing in this block, with the hints of blocks of the case.
pub(crate) fn say(word: &str, at: &At, more: &[&[Hint]]) -> Option<&'static str> {
    let word = word.to_lowercase().replace(' ', "_");
    let within = |block: &str| match block {
        "" => at.as_str().is_empty(),
        block => at.as_str().split('/').any(|step| step == block),
    };
    let mut all = HINTS.iter().chain(more.iter().copied().flatten());
    all.find(|hint| within(hint.within) && hint.words.contains(&word.as_str())).map(|hint| hint.say)
}
