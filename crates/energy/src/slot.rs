use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// One number of a law beside F: a scalar, or a component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Name of the quantity: `tension`, `pressure`, `remanence` ... Slots of one vector stand in a row and share it.
    pub group: &'static str,
    /// Which component of the vector (0 to 2); `None` for a scalar.
    pub component: Option<usize>,
    /// `Pa`, `T` ...
    pub unit: &'static str,
    /// Whether it only pulls: case files refuse values below zero, and zero is the lower bound unless one is given.
    pub not_negative: bool,
    /// What it is to the body.
    pub role: Role,
    /// Where its values are.
    pub scope: Scope,
}

/// The group of the three slots of a direction.
pub(crate) const DIRECTION: &str = "direction";

/// Where a slot has values; all slots of a law have one scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// One at every quadrature point.
    Point,
    /// One for all points of the body, as weights of a network: derivatives are sums over the points.
    Global,
}

/// What a slot is to the body while it is loaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// A load: zero at rest, applied in load steps.
    Load,
    /// An internal variable, which follows the deformation by the law's [`Evolution`](crate::Evolution): nobody controls it.
    Internal,
    /// A number of the body itself, such as a modulus: it holds from the first load step on.
    Design {
        /// Its value where nobody gives another.
        rest: f64,
    },
}

impl Slot {
    /// The slot of a scalar.
    pub const fn scalar(group: &'static str, unit: &'static str) -> Self {
        Slot { group, component: None, unit, not_negative: false, role: Role::Load, scope: Scope::Point }
    }

    /// The slot of a scalar that only pulls.
    pub const fn pulling(group: &'static str, unit: &'static str) -> Self {
        Slot { not_negative: true, ..Slot::scalar(group, unit) }
    }

    /// The same with one value for all points of the body.
    pub const fn global(self) -> Self {
        Slot { scope: Scope::Global, ..self }
    }

    /// Whether it has one value for all points.
    pub const fn is_global(&self) -> bool {
        matches!(self.scope, Scope::Global)
    }

    /// The slot of an internal variable.
    pub const fn internal(group: &'static str, unit: &'static str) -> Self {
        Slot { role: Role::Internal, ..Slot::scalar(group, unit) }
    }

    /// The slot of a scalar that belongs to the body, with its value where nobody gives another.
    pub const fn design(group: &'static str, unit: &'static str, rest: f64) -> Self {
        Slot { role: Role::Design { rest }, ..Slot::scalar(group, unit) }
    }

    /// Whether it belongs to the body: [`Role::Design`].
    pub const fn is_design(&self) -> bool {
        matches!(self.role, Role::Design { .. })
    }

    /// Whether it is a component of a direction as a control: see [`EnergyTerm::with_direction_slots`](crate::EnergyTerm::with_direction_slots).
    pub fn is_direction(&self) -> bool {
        self.is_design() && self.group == DIRECTION
    }

    /// Whether it is an internal variable.
    pub const fn is_internal(&self) -> bool {
        matches!(self.role, Role::Internal)
    }

    /// Its value at rest: zero of a load and of an internal variable.
    pub const fn rest(&self) -> f64 {
        match self.role {
            Role::Load | Role::Internal => 0.0,
            Role::Design { rest } => rest,
        }
    }

    /// The three slots of a vector.
    pub const fn vector(group: &'static str, unit: &'static str) -> [Self; 3] {
        let scalar = Slot::scalar(group, unit);
        [
            Slot { component: Some(0), ..scalar },
            Slot { component: Some(1), ..scalar },
            Slot { component: Some(2), ..scalar },
        ]
    }
}

/// Slots of one quantity: a scalar alone, or the components of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlotGroup {
    /// Name of the quantity.
    pub name: &'static str,
    /// Its first slot.
    pub first: usize,
    /// Number of slots.
    pub len: usize,
    /// `Pa`, `T` ...
    pub unit: &'static str,
    /// Whether it only pulls.
    pub not_negative: bool,
}

impl SlotGroup {
    /// The groups of slots, in their order.
    pub fn of(slots: &[Slot]) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for (first, slot) in slots.iter().enumerate() {
            match groups.last_mut() {
                Some(last) if last.name == slot.group => last.len += 1,
                _ => groups.push(SlotGroup {
                    name: slot.group,
                    first,
                    len: 1,
                    unit: slot.unit,
                    not_negative: slot.not_negative,
                }),
            }
        }
        groups
    }

    /// Whether it is a vector of space.
    pub fn is_vector(&self) -> bool {
        self.len == 3
    }
}

static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// The name of a [`Slot`] that a user chose, such as that of a formula's parameter: kept to the end of the program, each once.
pub(crate) fn lasting(name: &str) -> &'static str {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let new: &'static str = Box::leak(name.to_owned().into_boxed_str());
    names.insert(new);
    new
}
