//! [`Placement`]: where an instance is.

/// A translation, then a rotation about an axis.
pub(super) struct Placement {
    translation: [f64; 3],
    rotation: Option<Rotation>,
}

struct Rotation {
    from: [f64; 3],
    /// Of length one.
    axis: [f64; 3],
    sine: f64,
    cosine: f64,
}

impl Placement {
    /// Of the data lines of `*INSTANCE`: none; a translation; and two points of an axis with an angle in degrees.
    pub fn new(rows: &[Vec<f64>]) -> Result<Self, String> {
        let translation = match rows.first().map(Vec::as_slice) {
            None => [0.0; 3],
            Some([x]) => [*x, 0.0, 0.0],
            Some([x, y]) => [*x, *y, 0.0],
            Some([x, y, z]) => [*x, *y, *z],
            Some(_) => return Err("its first line is no translation of three numbers".to_owned()),
        };
        let rotation = match rows.get(1).map(Vec::as_slice) {
            None => None,
            Some(&[a, b, c, d, e, f, degrees]) => {
                let axis = [d - a, e - b, f - c];
                let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length == 0.0 {
                    return Err("the two points of its axis of rotation are one".to_owned());
                }
                let (sine, cosine) = degrees.to_radians().sin_cos();
                Some(Rotation { from: [a, b, c], axis: axis.map(|x| x / length), sine, cosine })
            }
            Some(_) => return Err("its second line is no rotation of seven numbers".to_owned()),
        };
        match rows.len() {
            0..=2 => Ok(Self { translation, rotation }),
            _ => Err("it has more than two lines".to_owned()),
        }
    }

    pub fn of(&self, point: [f64; 3]) -> [f64; 3] {
        let moved: [f64; 3] = std::array::from_fn(|i| point[i] + self.translation[i]);
        let Some(Rotation { from, axis, sine, cosine }) = &self.rotation else { return moved };
        let r: [f64; 3] = std::array::from_fn(|i| moved[i] - from[i]);
        let along = (0..3).map(|i| axis[i] * r[i]).sum::<f64>() * (1.0 - cosine);
        // Rodrigues' formula
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            from[i] + r[i] * cosine + (axis[j] * r[k] - axis[k] * r[j]) * sine + axis[i] * along
        })
    }
}
