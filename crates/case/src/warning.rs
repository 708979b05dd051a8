//! [`Warning`]: a result or an input that deserves attention although nothing failed.

use nastic_language::syntax::Diagnostic;
use std::fmt;

/// A kind of warning: its code, what it means and what to try. docs/warnings.md explains every one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WarningKind {
    /// The code: in brackets on the terminal, `code` in results.
    pub code: &'static str,
    /// What it means, in one line.
    pub about: &'static str,
    /// What to try; empty where the message of each warning says so itself.
    pub advice: &'static str,
}

/// Every kind of warning.
pub const WARNINGS: &[&WarningKind] = &[
    &INPUT,
    &UNBOUNDED,
    &CONVEXITY,
    &UNBALANCED_TURGOR,
    &UNBOUNDED_ENERGY,
    &BREAKDOWN,
    &BOUNDS,
    &UNITS,
    &LOCKING,
    &EXTREME_DEFORMATION,
    &STILL,
    &FREE_FLIGHT,
    &TRUNCATED_FIELD,
    &LOST_GROUPS,
    &CELL_SHAPE,
    &UNMATCHED_INTERFACE,
    &GRID_RESOLUTION,
    &HAUSDORFF_LENGTH,
    &NEGLIGIBLE_TERM,
    &UNSTABLE,
    &NEARLY_SINGULAR,
    &NOT_COUNTED,
    &BRANCH_CHANGE,
    &BRANCH_UNKNOWN,
    &NO_MOVEMENT,
    &ALL_ON_BOUNDS,
    &IDLE,
    &UNDETERMINED,
    &OTHER_SIGN,
    &SELF_INTERSECTION,
    &NOT_VERIFIED,
    &INSIDE_OBSTACLE,
    &COARSE_GRID,
    &VIOLATED,
    &BETWEEN_NODES,
    &STEP_ERROR,
    &TIME_STEP,
    &ENERGY_BALANCE,
    &NO_CONTACT,
    &PENETRATED,
    &THICK_LAYER,
    &STEPS_PER_CONTACT,
    &CREEPS,
    &FEW_FACETS,
    &CUT_VOLUME,
    &MEDIUM,
    &CUT_UNSOLVED,
    &THIN,
];

/// A design that is thin somewhere.
pub const THIN: WarningKind = WarningKind {
    code: "thin",
    about: "a bar or a gap of a design that is cut is thinner than asked for, or than the length of its filter",
    advice: "see the place in design_NAME.stl; a longer \"filter\", more \"sharpness\", or load cases that set the threshold (\"controls/K/projection/eta\") lower and higher, of which the worst counts",
};

/// An optimum that could not be solved as it is made.
pub const CUT_UNSOLVED: WarningKind = WarningKind {
    code: "cut_unsolved",
    about: "the optimum with every cell of its designs 0 or 1 has no equilibrium that was found: what it costs as it is made is not known",
    advice: "bring the design to 0 or 1 (\"projection\", a larger \"power\"), raise \"least\", or keep voids from folding (\"media\")",
};

/// A medium that does what the body should.
pub const MEDIUM: WarningKind = WarningKind {
    code: "medium",
    about: "a medium of a void stores more than 1 % of the elastic energy: it stiffens the body",
    advice: "lower its \"stiffness\" as long as cells of the void stay sound, or refine the void: it resists to what the deformation gradient varies by within cells",
};

/// A design that its STL file does not show.
pub const CUT_VOLUME: WarningKind = WarningKind {
    code: "cut_volume",
    about: "the body of a design in its STL file has another volume than the design, by more than 1 % of the region",
    advice: "bring the design to 0 or 1 (\"projection\", a larger \"power\"): a value that it has on a whole part is in the body or not; or refine curved \
             cells, which are cut into flat pieces",
};

/// A contact without effect.
pub const NO_CONTACT: WarningKind = WarningKind {
    code: "no_contact",
    about: "a contact never acts: the body does not come near the obstacle",
    advice: "see the picture; check the place of the obstacle, its pose and the surface, or leave the contact out",
};

/// A pressure of few facets.
pub const FEW_FACETS: WarningKind = WarningKind {
    code: "few_facets",
    about: "a contact whose largest pressure is a cost or a constraint acts on less than two facets: the pressure is one of the mesh",
    advice: "refine the surface where it touches, or take its force (\"contact_force\")",
};

/// A body inside an obstacle.
pub const PENETRATED: WarningKind = WarningKind {
    code: "penetrated",
    about: "a contact is pressed through: the pressure exceeds its stiffness",
    advice: "give a larger \"stiffness\", a multiple of the largest pressure",
};

/// A layer that changes the force.
pub const THICK_LAYER: WarningKind = WarningKind {
    code: "thick_layer",
    about: "the layer in which a contact acts is thick against the depth that is pressed in: forces are wrong by about this share, or by half more",
    advice: "give a smaller \"thickness\", and see how far the result changes at half of it",
};

/// Impacts in few steps.
pub const STEPS_PER_CONTACT: WarningKind = WarningKind {
    code: "steps_per_contact",
    about: "a touch lasts few time steps: how fast the body parts again is a number of the step",
    advice: "take shorter steps, ten or more for each touch; or a scheme that damps (backward_euler) if only the rest matters",
};

/// A time scheme that makes or takes energy.
pub const ENERGY_BALANCE: WarningKind = WarningKind {
    code: "energy",
    about: "the time scheme creates or takes more than 2 % of the largest energy, work or loss of the motion",
    advice: "",
};

/// Friction that gives way slowly.
pub const CREEPS: WarningKind = WarningKind {
    code: "creeps",
    about: "what sticks creeps, at a share of the slip speed, and adds up to a visible distance",
    advice: "give a smaller \"slip_speed\": the creep falls in proportion, steps get harder",
};

/// An end that the case does not allow, or a state inside of an obstacle that does not push.
pub const VIOLATED: WarningKind = WarningKind {
    code: "violated",
    about: "the optimisation ended where constraints are not met, or the state at the start controls does not meet them or is inside of an obstacle that costs or constraints name",
    advice: "name the obstacle in \"contact\" if the body is to be held by it, press harder where it slips; of an optimum, begin where the body touches if the bound is on a contact, allow more iterations (optimizer/max_iterations), or begin elsewhere (optimizer/starts); see whether bounds and supports allow what is asked",
};

/// Time steps that do not resolve what happens.
pub const TIME_STEP: WarningKind = WarningKind {
    code: "time_step",
    about: "time steps are too long for what changes in them: a drive between two instants, or a vibration that carries energy",
    advice: "give shorter steps (\"time\": { \"step\" }), a dozen or more for each period, or a \"tolerance\"",
};

/// Time steps that were found for another motion.
pub const STEP_ERROR: WarningKind = WarningKind {
    code: "step_error",
    about: "time steps that were found at the start controls are too long for the motion at the optimum",
    advice: "begin again from the optimum (\"start\": { \"file\": \".../controls.json\" }): its steps are found anew; or allow a larger tolerance",
};

/// More than a material bears.
pub const EXTREME_DEFORMATION: WarningKind = WarningKind {
    code: "extreme_deformation",
    about: "the body is deformed far beyond what its law was measured for",
    advice: "check the units of loads, actuations and moduli (nastic check prints them), or bound the control more narrowly",
};

/// Less than anyone sees.
pub const STILL: WarningKind = WarningKind {
    code: "still",
    about: "something acts on the body, and no point of it moves visibly",
    advice: "check the units of moduli, loads and actuations (nastic check prints them): of a modulus in Pa that was meant in kPa, of a force that \
             acts on what is held",
};

/// A body that leaves.
pub const FREE_FLIGHT: WarningKind = WarningKind {
    code: "free_flight",
    about: "a part of the body that nothing holds moves by many times its own size",
    advice: "hold it (\"supports\"), give the surface that it shall land on a \"contact\", or end the motion earlier (\"time\": { \"end\" }); check the unit of \
             gravity and loads",
};

/// A random field without most of its variance.
pub const TRUNCATED_FIELD: WarningKind = WarningKind {
    code: "truncated_field",
    about: "the modes kept of a random field hold less than half of its variance, or its length is below the size of the cells: the parameter varies less, or over longer distances, than asked for",
    advice: "keep more modes, or choose a longer correlation length: below the size of the cells it has no effect",
};

/// A block that has no effect or a double one.
pub const INPUT: WarningKind =
    WarningKind { code: "input", about: "a block of the case has no effect, or acts twice", advice: "" };

/// A control without bounds.
pub const UNBOUNDED: WarningKind =
    WarningKind { code: "unbounded", about: "a control has no bound on one side", advice: "" };

/// A tension beyond the convexity bound.
pub const CONVEXITY: WarningKind = WarningKind {
    code: "convexity",
    about: "a tension, or its bound, exceeds what the law carries while it stays polyconvex",
    advice: "lower it, or stiffen the fibre direction of the law",
};

/// A turgor without a counterweight.
pub const UNBALANCED_TURGOR: WarningKind = WarningKind {
    code: "unbalanced_turgor",
    about: "a turgor acts on a law whose energy grows too slowly with the volume: with any positive pressure it has no lower bound",
    advice: "take a law that resists changes of volume: neo_hooke with lambda > 0, or one with a bulk modulus",
};

/// An energy without a lower bound.
pub const UNBOUNDED_ENERGY: WarningKind = WarningKind {
    code: "unbounded_energy",
    about: "an actuation has an energy without a lower bound: theorems on the existence of minimisers do not cover it",
    advice: "judge a state by its inertia: 0 negative pivots is a local minimum; --ramp shows where equilibria end",
};

/// A true electric field that the material does not bear.
pub const BREAKDOWN: WarningKind = WarningKind {
    code: "breakdown",
    about: "the true electric field exceeds the breakdown strength of a dielectric",
    advice: "lower the field's upper bound: a film that thins to a share l of its thickness has 1/l times the nominal field",
};

/// Bounds far beyond the material.
pub const BOUNDS: WarningKind = WarningKind {
    code: "bounds",
    about: "a load, a pressure or the bounds of a control reach far beyond the stiffness of the material",
    advice: "",
};

/// Lengths that look like another unit.
pub const UNITS: WarningKind =
    WarningKind { code: "units", about: "a size looks as if another unit was meant", advice: "" };

/// Elements that are too stiff.
pub const LOCKING: WarningKind = WarningKind {
    code: "locking",
    about: "the elements are too stiff for this material: displacements come out too small",
    advice: "use second-order elements: hex20, hex27 or quad9, below Poisson's ratio 0.499 also tet10 or tri6 (\"element\" of a \
             box; in Gmsh Mesh.ElementOrder = 2); nearly incompressible, \"formulation\": \"mean_dilatation\" (hex8, quad4, tet10, tri6, tet4, \
             tri3) or \"linear_dilatation\" (hex27, quad9, hex20, quad8) in the material",
};

/// Groups without cells.
pub const LOST_GROUPS: WarningKind = WarningKind {
    code: "lost_groups",
    about: "a mesh file lists names of regions, but none of its cells bears one: the program that wrote it lost the groups",
    advice: "write it anew: from Gmsh as 4.1, or as 2.2 without Mesh.SaveAll; from meshio with file_format=\"gmsh22\"",
};

/// Poor cells.
pub const CELL_SHAPE: WarningKind = WarningKind {
    code: "cell_shape",
    about: "cells are badly shaped, in the mesh or after the deformation",
    advice: "refine or smooth the mesh there, or lower the control",
};

/// Coincident nodes.
pub const UNMATCHED_INTERFACE: WarningKind = WarningKind {
    code: "unmatched_interface",
    about: "surfaces of cells touch without sharing nodes, so the body is open there",
    advice: "merge coincident nodes (in Gmsh: Coherence Mesh; BooleanFragments for touching volumes)",
};

/// A control grid finer than the mesh.
pub const GRID_RESOLUTION: WarningKind = WarningKind {
    code: "grid_resolution",
    about: "the grid of a control is finer than the mesh: its total variation and regularisation come out too small; or its filter smooths nothing",
    advice: "take no more cells than that, a longer filter, or refine the mesh",
};

/// A Hausdorff length below the spacing of points.
pub const HAUSDORFF_LENGTH: WarningKind = WarningKind {
    code: "hausdorff_length",
    about: "a smoothed Hausdorff distance resolves less than the spacing of its points",
    advice: "",
};

/// A term of the cost that does not count.
pub const NEGLIGIBLE_TERM: WarningKind = WarningKind {
    code: "negligible_term",
    about: "a term of the cost is more than a million times smaller than another",
    advice: "raise its weight, or leave it out",
};

/// Negative pivots.
pub const UNSTABLE: WarningKind = WarningKind {
    code: "unstable",
    about: "the equilibrium is a saddle of the potential energy: a real body would leave it",
    advice: "find a stable state (nastic solve --minimum, --equilibria 3) or the load at which it turns unstable (--path, \
             --ramp); an optimiser rejects such trials with \"optimizer\": { \"unstable\": \"refuse\" }",
};

/// A singular tangent.
pub const NEARLY_SINGULAR: WarningKind = WarningKind {
    code: "nearly_singular",
    about: "the tangent stiffness is singular to working accuracy: a limit or bifurcation point, or a very slender or nearly incompressible body",
    advice: "change the control a little; near such a point gradients mean little",
};

/// Nothing is known of the tangent's signs.
pub const NOT_COUNTED: WarningKind = WarningKind {
    code: "inertia_not_counted",
    about: "the negative pivots of the tangent stiffness were not counted: whether the equilibrium is stable is not known",
    advice: "",
};

/// Two equilibria for neighbouring controls.
pub const BRANCH_CHANGE: WarningKind = WarningKind {
    code: "branch_change",
    about: "an equilibrium lies on another branch than the one before it: the body has snapped, and the cost jumps between them",
    advice: "begin on the branch you want, or bound the control so that it stays there; nastic solve --ramp between the two controls shows the jump",
};

/// Nothing is known of their branches.
pub const BRANCH_UNKNOWN: WarningKind = WarningKind {
    code: "branch_unknown",
    about: "whether an equilibrium lies on the branch of the one before it is not known: the cost may jump between them",
    advice: "compare the two: nastic solve --ramp between the two controls",
};

/// Nothing moved.
pub const NO_MOVEMENT: WarningKind = WarningKind {
    code: "no_movement",
    about: "the optimisation ended where it began, or the cost hardly fell",
    advice: "check that the control moves the body where the cost looks (`nastic gradient`), and the scale of the cost",
};

/// A control without effect at the optimum.
pub const IDLE: WarningKind = WarningKind {
    code: "idle",
    about: "at the optimum the derivative by a control inside its bounds is exactly zero: nothing there depends on it, as on a cable that is slack",
    advice: "begin where it acts (\"start\", or \"optimizer\": { \"starts\" }), and raise a \"lower\" bound to keep a cable taut",
};

/// More controls than the cost determines.
pub const UNDETERMINED: WarningKind = WarningKind {
    code: "undetermined",
    about: "the cost looks at fewer numbers than the control has free values: other controls do as well as the one found",
    advice: "see which directions are determined by nastic optimize --spectrum 10; a \"control_norm\" or \"control_smoothness\" among the costs chooses \
             the smallest or smoothest control, a coarser \"space\" leaves fewer",
};

/// Bounds decide.
pub const ALL_ON_BOUNDS: WarningKind = WarningKind {
    code: "all_on_bounds",
    about: "every value of a control lies on a bound: the bounds decide the answer, not the cost",
    advice: "widen the bounds if the body allows it, or move the target within reach",
};

/// The wrong sign.
pub const OTHER_SIGN: WarningKind = WarningKind {
    code: "other_sign",
    about: "the cost falls in the direction that a bound at zero forbids",
    advice: "turn the sign of the bounds: a positive tension lengthens, a negative one contracts; a positive pressure inflates; a muscle only pulls, \
             by a positive contraction, a tendon by a positive tension: put it on the other side of the body",
};

/// The body intersects itself.
pub const SELF_INTERSECTION: WarningKind = WarningKind {
    code: "self_intersection",
    about: "the deformed body intersects itself: parts pass through each other where no contact keeps them apart",
    advice: "give the surface a contact with itself (\"contact\": [ { \"surface\": \"skin\", \"with\": \"skin\" } ]), lower the control, or look at the cells marked in the \
             VTU file (array `intersecting`)",
};

/// The cold solve disagrees.
pub const NOT_VERIFIED: WarningKind = WarningKind {
    code: "not_verified",
    about: "solved again from rest, the optimum is another state: the answer depends on the path to it",
    advice: "drive the real body along the same path, or begin from rest in steps",
};

/// The body at rest, or a support, is inside of an obstacle.
pub const INSIDE_OBSTACLE: WarningKind = WarningKind {
    code: "inside_obstacle",
    about: "the body at rest, or its supports, lie inside of an obstacle that a constraint keeps it away from, or that it touches",
    advice: "move the obstacle, or name the part of the surface that is free to move",
};

/// The distance on a grid is not that of the mesh.
pub const COARSE_GRID: WarningKind = WarningKind {
    code: "coarse_grid",
    about: "the grid on which the distance from a meshed obstacle is interpolated is coarse: it loses a thin wall, or moves the surface by more than the layer of a contact",
    advice: "give a smaller \"grid\", or a \"rounding\" instead, by which the solid grows and with which the distance is exact",
};

/// Nodes keep their distance, the surface between them does not.
pub const BETWEEN_NODES: WarningKind = WarningKind {
    code: "between_nodes",
    about: "every node keeps its distance from an obstacle, or what its contact allows, but the body between nodes is inside of it",
    advice: "refine the mesh there, to smaller cells than the obstacle where it slips between nodes, and see how far the result changes; of a constraint raise the clearance by twice the depth told; of a contact a larger \"refine\" finds small obstacles, but makes forces on coarse cells too large",
};

/// Something that deserves attention.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What kind it is.
    pub kind: &'static WarningKind,
    /// Where: a place of the case file, a scenario; empty for the case as a whole.
    pub place: String,
    /// What was found, with its numbers.
    pub message: String,
}

impl Warning {
    /// About the case or its result as a whole.
    pub fn new(kind: &'static WarningKind, message: impl Into<String>) -> Self {
        Self { kind, place: String::new(), message: message.into() }
    }

    /// The same, of a scenario or load case.
    #[must_use]
    pub fn of(mut self, place: impl Into<String>) -> Self {
        self.place = place.into();
        self
    }

    /// At a place of the case.
    #[must_use]
    pub fn at(kind: &'static WarningKind, diagnostic: &Diagnostic) -> Self {
        Self { kind, place: diagnostic.place(), message: diagnostic.message.clone() }
    }
}

/// `[locking] case.json:3:5: materials/0: ...; try: ...`
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] ", self.kind.code)?;
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.message)?;
        if self.kind.advice.is_empty() { Ok(()) } else { write!(f, "; try: {}", self.kind.advice) }
    }
}
