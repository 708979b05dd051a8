use nalgebra::{Quaternion, UnitQuaternion};
use nastic_tensor::{Kinematics, Mat3, Vec3};

/// Fixed, rotated, strongly deformed states: `F = R diag(s) Q`, stretches apart by up to 4, `J` from 0.3 to 3.
pub fn states() -> Vec<Kinematics> {
    let mut sequence = Sequence(1);
    (0..24)
        .filter_map(|n| {
            let jacobian = 0.3 * 10f64.powf(n as f64 / 23.0);
            let stretches = Vec3::from_fn(|_, _| 0.5 * 4f64.powf(sequence.next()));
            let scale = (jacobian / stretches.product()).cbrt();
            let f = sequence.rotation() * Mat3::from_diagonal(&(stretches * scale)) * sequence.rotation();
            Kinematics::new(f).ok()
        })
        .collect()
}

/// Fixed rotations about unremarkable axes, none of them small.
pub fn rotations() -> Vec<Mat3> {
    let mut sequence = Sequence(7);
    (0..6).map(|_| sequence.rotation()).collect()
}

/// Unit vectors: axes, diagonals, and some in between.
pub(super) fn directions() -> Vec<Vec3> {
    let mut out = Vec::new();
    for x in -1..=1 {
        for y in -1..=1 {
            for z in -1..=1 {
                let v = Vec3::new(x as f64, y as f64, z as f64);
                if v.norm() > 0.5 {
                    out.push(v.normalize());
                }
            }
        }
    }
    let mut sequence = Sequence(3);
    out.extend((0..20).map(|_| sequence.rotation() * Vec3::x()));
    out
}

/// Uniform numbers in [0, 1), the same on every machine (splitmix64).
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn rotation(&mut self) -> Mat3 {
        let q = Quaternion::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5, self.next() + 0.1);
        UnitQuaternion::from_quaternion(q).to_rotation_matrix().into_inner()
    }
}
