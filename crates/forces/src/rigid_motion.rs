//! Controls that move something rigid: a translation, and a rotation vector about a centre.

use nastic_body::controls::Controls;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_tensor::Vec3;

/// The largest angle of a rotation vector: once around.
const MAX_ANGLE: f64 = std::f64::consts::TAU * (1.0 + 1e-12);

const TRANSLATION: [Slot; 3] = Slot::vector("translation", "m");
const ROTATION: [Slot; 3] = Slot::vector("rotation", "1");
/// The first slots of a contribution that moves something.
pub const SLOTS: [Slot; 6] = [TRANSLATION[0], TRANSLATION[1], TRANSLATION[2], ROTATION[0], ROTATION[1], ROTATION[2]];

/// Translation and rotation vector of the contribution that is asked.
pub(crate) fn vectors(at: &Instant, controls: &Controls) -> [Vec3; 2] {
    [0, 3].map(|first| Vec3::from_fn(|i, _| at.slot_of(controls, first + i)))
}

/// Calls with the slots of a translation and a rotation; what leaves the plane of a plane-strain body is no control.
pub(crate) fn each_slot(dim: usize, translation: Vec3, rotation: Vec3, mut call: impl FnMut(usize, f64)) {
    for i in 0..3 {
        let (plane, axis) = (dim == 3 || i < 2, dim == 3 || i == 2);
        call(i, if plane { translation[i] } else { 0.0 });
        call(3 + i, if axis { rotation[i] } else { 0.0 });
    }
}

/// Refuses to turn by more than once around, and to leave the plane of a plane-strain body; `what` is moved.
pub(crate) fn check(what: &str, dim: usize, values: &[f64]) -> Result<(), FemError> {
    let angle = values[3..6].iter().map(|r| r * r).sum::<f64>().sqrt();
    if angle > MAX_ANGLE {
        let what = format!(
            "{what} turns by {angle:.4} rad, more than once around; rotations are in radians, 90 degrees are pi / 2"
        );
        return Err(FemError::Meaningless { what });
    }
    if dim == 3 || [2, 3, 4].into_iter().all(|slot| values[slot] == 0.0) {
        return Ok(());
    }
    let what = format!(
        "{what} leaves the plane of a plane-strain body; its translation has the components x and y, its rotation z"
    );
    Err(FemError::Meaningless { what })
}
