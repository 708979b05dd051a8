// Arrays of the page's data: base64 of little-endian integers.

const bytesOf = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));

const indicesOf = (text) => new Uint32Array(bytesOf(text).buffer);

// Numbers quantised to 16 bits between the least and the largest of each component; 65535 is no number.
function numbersOf(array) {
  const words = new Uint16Array(bytesOf(array.data).buffer);
  const n = array.low.length;
  const out = new Float32Array(words.length);
  for (let i = 0; i < words.length; i++) {
    const k = i % n;
    out[i] = words[i] === 65535 ? NaN : array.low[k] + ((array.high[k] - array.low[k]) * words[i]) / 65534;
  }
  return out;
}

// Decoded once for every array that is looked at.
const decoded = new WeakMap();

function values(array) {
  if (!decoded.has(array)) decoded.set(array, numbersOf(array));
  return decoded.get(array);
}

// Four significant digits, with an exponent only where that reads better.
function short(value) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e6) return String(Number(value.toPrecision(4)));
  return Number(value.toPrecision(4)).toExponential().replace("e+", "e");
}
