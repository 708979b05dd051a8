// Colour maps, the same as those of picture.png.

// K. Moreland, "Diverging color maps for scientific visualization" (2009), at nine places.
const COOL_WARM = [
  [59, 76, 192], [98, 130, 234], [141, 176, 254], [184, 208, 249], [221, 221, 221],
  [245, 196, 173], [244, 154, 123], [222, 96, 77], [180, 4, 38],
];
// Viridis of matplotlib (CC0), at eleven places.
const VIRIDIS = [
  [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140],
  [34, 168, 132], [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37],
];
const UNKNOWN = [120, 120, 120];

// Diverging and centred at zero if the range holds both signs, else sequential.
class ColourMap {
  constructor(low, high) {
    this.low = low;
    this.high = high;
    const most = Math.max(-low, high);
    const both = low < 0 && high > 0 && Math.min(-low, high) > 0.02 * (high - low);
    this.stops = both ? COOL_WARM : VIRIDIS;
    [this.from, this.to] = both ? [-most, most] : [low, high];
  }

  // Red, green, blue as bytes of sRGB.
  bytes(value) {
    if (!Number.isFinite(value)) return UNKNOWN;
    const range = this.to - this.from;
    const share = range > 0 ? Math.min(1, Math.max(0, (value - this.from) / range)) : 0.5;
    const at = share * (this.stops.length - 1);
    const k = Math.min(this.stops.length - 2, Math.floor(at));
    return this.stops[k].map((a, i) => a + (this.stops[k + 1][i] - a) * (at - k));
  }

  // The same in linear light, as the graphics library wants it.
  linear(value) {
    return this.bytes(value).map((byte) => {
      const s = byte / 255;
      return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
    });
  }
}

const TARGET_COLOUR = "#ce423a";
const START_COLOUR = "#7c8794";
const OBSTACLE_COLOUR = "#9a8f7d";

// Obstacles are shown together with the targets.
function colourOfTarget(target) {
  return target.label === "obstacle" ? OBSTACLE_COLOUR : TARGET_COLOUR;
}
