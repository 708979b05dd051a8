//! Colours and colour maps.

/// A colour by its sRGB bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

impl Colour {
    /// A light neutral grey.
    pub const GREY: Colour = Colour([168, 174, 182]);
    /// Steel blue.
    pub const BLUE: Colour = Colour([58, 124, 196]);
    /// Warm orange.
    pub const ORANGE: Colour = Colour([240, 138, 36]);
    /// Leaf green.
    pub const GREEN: Colour = Colour([64, 156, 92]);
    /// Brick red.
    pub const RED: Colour = Colour([206, 66, 58]);
    /// Near black.
    pub const INK: Colour = Colour([38, 43, 51]);
    /// Colours that can be distinguished, for curves and paths.
    pub const DISTINCT: [Colour; 12] = [
        Colour::BLUE,
        Colour::ORANGE,
        Colour::GREEN,
        Colour::RED,
        Colour([122, 92, 174]),
        Colour([120, 126, 134]),
        Colour([128, 84, 52]),
        Colour([222, 112, 178]),
        Colour([148, 146, 34]),
        Colour([32, 168, 186]),
        Colour([34, 48, 104]),
        Colour([142, 202, 96]),
    ];

    /// Red, green, blue in linear light, 0..1.
    pub(super) fn linear(self) -> Linear {
        self.0.map(|byte| {
            let s = f32::from(byte) / 255.0;
            if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// `#rrggbb`.
    pub(super) fn hex(self) -> String {
        let [r, g, b] = self.0;
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

/// Red, green, blue in linear light.
pub(super) type Linear = [f32; 3];

pub(super) fn to_srgb(linear: Linear) -> Colour {
    Colour(linear.map(|value| {
        let value = value.clamp(0.0, 1.0);
        let s = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0).round() as u8
    }))
}

pub(super) fn mix(a: Linear, b: Linear, share_of_b: f32) -> Linear {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share_of_b)
}

/// Mixes as eyes would: tints keep their hue on a light ground, which linear light would turn pale and pink.
pub(super) fn tint(a: Linear, b: Linear, share_of_b: f32) -> Linear {
    mix(a.map(f32::sqrt), b.map(f32::sqrt), share_of_b).map(|x| x * x)
}

/// From numbers to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColourMap {
    pub low: f64,
    pub high: f64,
    stops: &'static [[u8; 3]],
}

/// Colour of values that are not numbers.
const UNKNOWN: Colour = Colour([120, 120, 120]);

impl ColourMap {
    /// Diverging if the range holds both signs (then centred at zero), else sequential.
    pub fn over(low: f64, high: f64) -> Self {
        let both = low < 0.0 && high > 0.0 && low.abs().min(high.abs()) > 0.02 * (high - low);
        Self { low, high, stops: if both { &COOL_WARM } else { &VIRIDIS } }
    }

    pub fn colour(&self, value: f64) -> Colour {
        if !value.is_finite() {
            return UNKNOWN;
        }
        let at = if self.stops.len() == COOL_WARM.len() {
            let most = self.high.max(-self.low);
            0.5 + 0.5 * (value.clamp(self.low, self.high) / most)
        } else if self.high > self.low {
            ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
        } else {
            0.5
        };
        let last = self.stops.len() - 1;
        let place = at * last as f64;
        let below = (place.floor() as usize).min(last - 1);
        let share = place - below as f64;
        let (a, b) = (self.stops[below], self.stops[below + 1]);
        Colour(std::array::from_fn(|k| (f64::from(a[k]) * (1.0 - share) + f64::from(b[k]) * share).round() as u8))
    }
}

/// K. Moreland, "Diverging color maps for scientific visualization" (2009), at nine places.
const COOL_WARM: [[u8; 3]; 9] = [
    [59, 76, 192],
    [98, 130, 234],
    [141, 176, 254],
    [184, 208, 249],
    [221, 221, 221],
    [245, 196, 173],
    [244, 154, 123],
    [222, 96, 77],
    [180, 4, 38],
];

/// Viridis of matplotlib (CC0), at eleven places.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_neutral_when_both_signs_occur() {
        let map = ColourMap::over(-4e5, 1e5);
        assert_eq!(map.colour(0.0), Colour([221, 221, 221]));
        assert_eq!(map.colour(-4e5), Colour([59, 76, 192]));
        // The weaker sign does not reach the end of the map: strengths compare.
        assert_ne!(map.colour(1e5), Colour([180, 4, 38]));
        assert_eq!(map.colour(f64::NAN), UNKNOWN);
        assert_eq!(ColourMap::over(0.0, 2.0).colour(2.0), Colour([253, 231, 37]));
    }

    #[test]
    fn linear_light_comes_back() {
        for byte in 0..=255 {
            let colour = Colour([byte, 255 - byte, byte / 2]);
            assert_eq!(to_srgb(colour.linear()), colour);
        }
    }
}
