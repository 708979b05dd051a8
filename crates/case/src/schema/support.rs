//! The blocks of `supports`.

use crate::expression::Formula;
use crate::schema::read::Reader;
use nastic_mesh::GroupNames;

object! {
    /// What holds the body: components of the displacement that are zero or prescribed.
    pub struct Support one of [surface, region, nodes] checked by check {
        /// Surface of the mesh.
        pub surface: Option<GroupNames>,
        /// Region of the mesh.
        pub region: Option<GroupNames>,
        /// Node set of the mesh.
        pub nodes: Option<GroupNames>,
        /// Components held at zero.
        pub fix: Vec<Axis> = Vec::new(),
        /// Components with a given displacement.
        pub displacement: Option<Displacement>,
    }
}

object! {
    /// Prescribed displacement; components left out are free, unless fixed.
    pub struct Displacement {
        /// Along x.
        pub x: Option<Formula> as LENGTH,
        /// Along y.
        pub y: Option<Formula> as LENGTH,
        /// Along z.
        pub z: Option<Formula> as LENGTH,
    }
}

choice! {
    /// A component.
    pub enum Axis {
        /// Along x.
        "x" => X,
        /// Along y.
        "y" => Y,
        /// Along z.
        "z" => Z,
    }
}

impl Axis {
    /// 0, 1 or 2.
    #[must_use]
    pub fn index(&self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

impl Displacement {
    /// The components as an array.
    #[must_use]
    pub fn entries(&self) -> [Option<&Formula>; 3] {
        [self.x.as_ref(), self.y.as_ref(), self.z.as_ref()]
    }
}

fn check(support: &Support, reader: &mut Reader<'_>) {
    let moved = support.displacement.as_ref().map_or([None; 3], Displacement::entries);
    if support.fix.is_empty() && moved.iter().all(Option::is_none) {
        reader.complain_at(
            &support.at,
            "this holds nothing: give \"fix\": [\"x\", ...] or \"displacement\": { \"x\": ... }",
        );
    }
    for (i, axis) in support.fix.iter().enumerate() {
        let at = support.at.key("fix").index(i);
        if support.fix[..i].contains(axis) {
            reader.complain_at(&at, format!("\"{}\" is fixed twice", axis.name()));
        }
        if moved[axis.index()].is_some() {
            reader.complain_at(&at, format!("\"{}\" cannot be fixed and displaced", axis.name()));
        }
    }
}
